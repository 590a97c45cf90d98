"""No module imports itself by way of others; kernels take few arguments."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = "md", "impact", "figures", "derivations"
MOST = 8  # positional parameters of a function


def modules(root: Path, package: str) -> dict[str, Path]:
    """Files of a package by the names of their modules."""
    files = sorted((root / package).rglob("*.py"))
    return {".".join(f.relative_to(root).with_suffix("").parts): f for f in files}


def imported(name: str, path: Path, known: dict[str, Path]) -> set[str]:
    """Modules that a module names in any import statement, those inside of functions included.

    A package stands for its `__init__`, which imports what it collects: only its own import of a
    module makes an edge, not that a module lies in it.
    """
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            here = name.split(".")[: -node.level] if node.level else []
            base = ".".join([*here, *(node.module or "").split(".")]).strip(".")
            inner = {f"{base}.{alias.name}" for alias in node.names}
            found |= {one if {one, f"{one}.__init__"} & known.keys() else base for one in inner}
    names = {one if one in known else f"{one}.__init__" for one in found}
    return names & known.keys()


def circle(root: Path, package: str) -> list[str]:
    """Modules that import each other in a circle; empty if there is none."""
    known = modules(root, package)
    graph = {name: imported(name, path, known) for name, path in known.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return error.args[1]
    return []


@pytest.mark.parametrize("package", PACKAGES)
def test_no_circular_import(package):
    assert circle(ROOT, package) == []


def test_a_circle_inside_of_functions_is_found(tmp_path):
    (tmp_path / "some" / "inner").mkdir(parents=True)
    (tmp_path / "some" / "a.py").write_text("from .inner import b\n")
    (tmp_path / "some" / "inner" / "b.py").write_text("def f():\n    from .. import a\n    a.g()\n")
    assert set(circle(tmp_path, "some")) == {"some.a", "some.inner.b"}


@pytest.mark.parametrize("room", ["md", "impact"])
def test_no_function_takes_more_than_eight_positional_parameters(room):
    """More is grouped in named tuples, whose fields name their units; nested kernels count too."""
    found = {
        f"{name}:{node.lineno} {node.name}": len(node.args.posonlyargs + node.args.args)
        for name, path in modules(ROOT, room).items()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef)
    }
    assert len(found) > 80
    assert {key: n for key, n in found.items() if n > MOST} == {}
