"""What packages may import; no module imports itself by way of others."""

import ast
from graphlib import TopologicalSorter
from importlib.util import resolve_name

import pytest

from .command_line import PACKAGES, ROOT

BORDERS = {  # that `impact` does not load Numba by itself, `test_help` shows
    "impact": "sympy derivations md scipy matplotlib figures",
    "derivations": "impact md figures matplotlib numba",
    "md": "impact derivations sympy matplotlib figures",
}


def modules(package):
    """Files of a package by the names of their modules."""
    files = sorted((ROOT / package).rglob("*.py"))
    return {".".join(f.relative_to(ROOT).with_suffix("").parts): f for f in files}


def imported(name, known):
    """Modules and packages of any import statement, those inside of functions included.

    A package of ours stands for its `__init__`, which imports what it collects: only its own import
    of a module makes an edge, not that a module lies in it.
    """
    found = set()
    for node in ast.walk(ast.parse(known[name].read_text("utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = resolve_name("." * node.level + (node.module or ""), name.rpartition(".")[0])
            inner = {f"{base}.{alias.name}" for alias in node.names}
            found |= {one if {one, f"{one}.__init__"} & known.keys() else base for one in inner}
    return {f"{one}.__init__" if f"{one}.__init__" in known else one for one in found}


@pytest.mark.parametrize("package", PACKAGES)
def test_no_circular_import(package):
    known = modules(package)
    graph = {name: imported(name, known) & known.keys() for name in known}
    TopologicalSorter(graph).prepare()  # names a circle


@pytest.mark.parametrize("package", BORDERS)
def test_import_borders(package):
    known = modules(package)
    for name in known:
        roots = {one.partition(".")[0] for one in imported(name, known)}
        drawings = {"matplotlib"} if name == "derivations.drawings" else set()
        assert not ({*BORDERS[package].split()} - drawings) & roots
