"""What decides whether something that was kept is stale: all of it stands here.

A run in a store is found by its `key`, of the scene, the length and the sources; a checkpoint is
of the same scene and the same `code`; compiled kernels lie in a folder named after
`digest_of_kernels`; data of figures carry `code_of` the files of `md` (`figures.lib.data`).

A `digest` is taken of syntax trees without docstrings, comments, annotations and the text of
exceptions: an edit of these keeps what is stored, an edit of a formula, of a constant or of any
other string does not. It covers the modules that a run imports, and those which they import.
"""

import ast
import hashlib
from functools import cache
from pathlib import Path
from typing import Any

RUN, WITH_TOLERANCE = "simulation", "accuracy"  # modules where a run begins
OF_ANNULUS = ("kernels.walls", "placement")  # a row does not use them
# Imported by a run, without a part in its numbers.
APART = {"cache", "files", "interrupt", "sources", "trajectory"}
_LEFT_OUT = {"annotation", "ctx", "kind", "returns", "type_comment", "type_params"}


def read(folder: Path) -> dict[str, bytes]:
    """Sources of a package by the names of its modules, as "kernels.contact"."""
    paths = {path.relative_to(folder): path for path in sorted(folder.rglob("*.py"))}
    names = {".".join(p.with_suffix("").parts).removesuffix(".__init__"): p for p in paths}
    return {name: paths[p].read_bytes() for name, p in names.items()}


SOURCES = read(Path(__file__).parent)  # what this process runs, whatever is edited meanwhile


def imported(module: str) -> set[str]:
    """Modules of this package that a module imports, also within functions."""
    return _named(module, SOURCES[module]) & SOURCES.keys()


@cache
def _named(module: str, source: bytes) -> set[str]:
    """Modules of this package, and names in them, that the source of a module imports."""
    folders = {name.rpartition(".")[0] for name in SOURCES}
    here = module.split(".") if module in folders else module.split(".")[:-1]
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.level:
            above = here[: len(here) + 1 - node.level]
            name = ".".join([*above, *filter(None, [node.module])])
            found |= {name, *(f"{name}.{alias.name}".lstrip(".") for alias in node.names)}
    return found


@cache
def used(*roots: str, annulus: bool = True) -> tuple[str, ...]:
    """Modules that `roots` need, themselves included, but for those of `APART`.

    Parameters
    ----------
    roots : names of modules, as "simulation" or "kernels.contact"
    annulus : False leaves out what only an annulus needs
    """
    found: set[str] = set()
    todo = set(roots)
    while todo:
        module = todo.pop()
        apart = module in APART or (not annulus and module.startswith(OF_ANNULUS))
        if module not in found and not apart:
            found.add(module)
            todo |= imported(module)
    return tuple(sorted(found))


def essence(node: object) -> str:
    """What of a syntax tree decides what it computes, alike in all versions of Python."""
    match node:
        case ast.Expr(value=ast.Constant(value=str())) | ast.If(test=ast.Name(id="TYPE_CHECKING")):
            return ""
        case ast.Raise(exc=ast.Call(func=kind)):
            return f"Raise({essence(kind)})"
        case ast.Assert(test=test):
            return f"Assert({essence(test)})"
        case ast.AnnAssign(target=target, value=value):
            return f"Assign({essence([target])}, {essence(value)})" if value else ""
        case ast.Assign(targets=targets, value=value):
            return f"Assign({essence(targets)}, {essence(value)})"
        case ast.AST():
            parts = [
                (name, essence(x)) for name, x in ast.iter_fields(node) if name not in _LEFT_OUT
            ]
            if isinstance(node, ast.ClassDef):  # annotations make fields of a dataclass
                fields = [x.target for x in node.body if isinstance(x, ast.AnnAssign)]
                parts.append(("fields", essence(fields)))
            return f"{type(node).__name__}({', '.join(f'{n}={x}' for n, x in parts if x)})"
        case list():
            return f"[{' '.join(filter(None, map(essence, node)))}]" if node else ""
    return "" if node is None else repr(node)


@cache
def code_of(source: bytes) -> str:
    """`essence` of a source file; each is read once, for however many digests."""
    return essence(ast.parse(source))


@cache
def digest(*, annulus: bool = False, tolerance: bool = False) -> str:
    """Twelve hexadecimal digits that stand for the sources which decide what a run gives.

    Parameters
    ----------
    annulus : whether the scene is in an annulus
    tolerance : whether step and length follow from a tolerance
    """
    content = hashlib.sha256()
    for module in used(WITH_TOLERANCE if tolerance else RUN, annulus=annulus):
        content.update(f"{module}\0{code_of(SOURCES[module])}\0".encode())
    return content.hexdigest()[:12]


def code(scene: Any, *, tolerance: bool = False) -> str:
    """Digest of the sources that decide what a run of the scene gives."""
    return digest(annulus=scene.annulus is not None, tolerance=tolerance)


def key(scene: Any, length: dict[str, Any], measure: Any = None) -> str:
    """Key of a run in a store, which holds no other one for it.

    Digest of the scene, the length, the sources (`code`) and the measure: a stored run is stale,
    and computed again, where one of these has changed.

    Parameters
    ----------
    scene : of the run
    length : arguments of `md.run` that say how long it is
    measure : `sweep.Measure`; None: the results of `md.run`
    """
    said = f"{scene.contents} {length} {code(scene, tolerance='tolerance' in length)} "
    if measure is not None:
        said += f"{measure.function.__qualname__} {measure.code}"
    return hashlib.sha256(said.encode()).hexdigest()[:24]


@cache
def digest_of_kernels() -> str:
    """Of the bytes of all files with compiled functions and of what these use."""
    roots = (name for name, source in SOURCES.items() if b"\n@kernel" in source)
    content = hashlib.sha256(SOURCES["cache"])
    for module in used(*sorted(roots)):
        content.update(module.encode() + b"\0" + SOURCES[module] + b"\0")
    return content.hexdigest()[:12]
