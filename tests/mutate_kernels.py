"""Mutate compiled kernels at seeded places: the tests must kill every mutant.

    python -m pytest tests/mutate_kernels.py [-k KEY]

A place is known by package, function and its number in that function, never by its file, and drawn
by a hash of these and the seed: a tree in which kernels have moved keeps its mutants, and one in
which a few kernels have changed keeps the others. MUTANTS and SEED of the environment draw others
than the first 30. Each mutant is a copy of the tree with one change, on which the tests of its
package run until the first failure: the test files that import the package, but not those that
`NOT_OF_KERNELS` names; those that name the function or its module come first. Before that they
must pass on the unchanged code, with an idle line in each file of kernels, so that no test objects
to any edit at all. A mutant on which they take longer than `SECONDS` is killed, too.
"""

import ast
import hashlib
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from copy import deepcopy
from pathlib import Path
from typing import NamedTuple

import pytest

from .command_line import ROOT

PACKAGES = "md", "impact"
PAIRS = (ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.Lt, ast.LtE), (ast.Gt, ast.GtE)
SWAPS = dict(PAIRS) | {second: first for first, second in PAIRS}
NUMBERS = {0.5: 0.4, 2: 3}
NAMES = {"min": "max", "max": "min"}
NOT_OF_KERNELS = re.compile(
    "figure|claim|readme|guide|report|index|explore|wheel|help|label|document|coverage|lookup|public|"
    "interrupt|cache|store|sweep|files|units|command|refus"
)
LEFT_OUT = "*.pyc", "__pycache__", ".git", ".venv", "out", "build", ".*_cache"
SEED = os.environ.get("SEED", "1")
MUTANTS = int(os.environ.get("MUTANTS", "30"))
SECONDS = 1800


class Place(NamedTuple):
    """One change of one kernel."""

    key: str  # package, function, number of the change in it
    path: Path  # in the tree
    module: ast.Module
    old: ast.expr
    new: ast.AST

    def __str__(self):
        old, new = map(ast.unparse, (self.old, self.new))
        return f"{self.path}:{self.old.lineno} {self.key}: {old} -> {new}"


def changed(node, **parts):
    """A copy of a node with some parts replaced."""
    return type(node)(**vars(node) | parts)


def mutants(node):
    """What a change replaces at a node, and by what."""
    match node:
        case ast.BinOp() | ast.AugAssign() if type(node.op) in SWAPS:
            yield node, changed(node, op=SWAPS[type(node.op)]())
        case ast.Compare(ops=[one]) if type(one) in SWAPS:
            yield node, changed(node, ops=[SWAPS[type(one)]()])
        case ast.Constant(int() | float() as value) if value in NUMBERS:
            yield node, ast.Constant(type(value)(NUMBERS[value]))
        case ast.UnaryOp(op=ast.Not()):
            yield node, node.operand
        case ast.Call(func=ast.Name(id=name)) if name in NAMES:
            yield node, changed(node, func=ast.Name(NAMES[name]))
        case ast.If(test=test) | ast.IfExp(test=test) | ast.While(test=test):
            if not isinstance(test, ast.UnaryOp) and " None" not in ast.unparse(test):
                yield test, ast.UnaryOp(ast.Not(), test)  # `is None` only picks what is compiled


def body(node):
    """All nodes inside a node, in order; no indices and ranges: wrong ones break memory."""
    for child in ast.iter_child_nodes(node):
        called = getattr(getattr(child, "func", None), "id", "")
        if not isinstance(child, ast.Subscript | ast.FunctionDef) and called != "range":
            yield child
            yield from body(child)


def is_kernel(node):
    """Whether a decorator is `kernel`, `kernel(...)` or `module.kernel`."""
    made = map(ast.unparse, getattr(node, "decorator_list", []))
    return any(re.fullmatch(r"(\w+\.)*kernel(\(.*\))?", decorator) for decorator in made)


def places():
    """All places; functions of one name are numbered in the order of their files."""
    count = Counter()
    for path in sorted(p for package in PACKAGES for p in (ROOT / package).rglob("*.py")):
        module = ast.parse(path.read_text())
        for function in filter(is_kernel, ast.walk(module)):
            here = path.relative_to(ROOT)
            name = f"{here.parts[0]}.{function.name}"
            count[name] += 1
            name += f"({count[name]})" if count[name] > 1 else ""
            changes = (new for node in body(ast.Module(function.body)) for new in mutants(node))
            for number, (old, new) in enumerate(changes, 1):
                yield Place(f"{name}#{number}", here, module, old, new)


def files_of(place):
    """Test files that test the kernel's package, the likeliest to notice the change first."""
    package, function = re.match(r"(\w+)\.(\w+)", place.key).groups()
    found = []
    for path in ROOT.glob("tests/test_*.py"):
        text = path.read_text()
        imported = set(re.findall(r"^\s*(?:from|import) (\w+)", text, re.M))
        of_package = package in imported and (package == "md" or "md" not in imported)
        if of_package and not NOT_OF_KERNELS.search(path.name):
            words = set(re.findall(r"\w+", text))
            found.append((function not in words, place.path.stem not in words, path.name))
    return [f"tests/{name}" for *_, name in sorted(found)]


def exit_status(folder, files, edit):
    """Exit status of the tests on an edited copy, None if they take too long."""
    clone = folder / "tree"
    shutil.copytree(ROOT, clone, ignore=shutil.ignore_patterns(*LEFT_OUT))
    edit(clone)
    environment = os.environ | {"PYTHONPATH": str(clone), "XDG_CACHE_HOME": str(folder)}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *files]
    try:
        return subprocess.run(command, cwd=clone, env=environment, timeout=SECONDS).returncode
    except subprocess.TimeoutExpired:
        return None
    finally:
        shutil.rmtree(clone)


def idle(tree):
    """Write files of kernels in the form of a mutant's, with a line without effect."""
    for path in {tree / place.path for place in PLACES}:
        path.write_text(f"{ast.unparse(ast.parse(path.read_text()))}\n_ = None\n")


PLACES = sorted(places(), key=lambda place: hashlib.sha256(f"{SEED} {place.key}".encode()).digest())


@pytest.mark.parametrize("package", PACKAGES)
def test_without_a_mutant_all_tests_pass(package, tmp_path):
    one = next(place for place in PLACES if place.key.startswith(package))
    assert exit_status(tmp_path, files_of(one), idle) == 0


@pytest.mark.parametrize("place", PLACES[:MUTANTS], ids=str)
def test_a_mutant_is_killed(place, tmp_path):
    def mutate(tree):
        mutant = deepcopy(place.module, {id(place.old): place.new})
        (tree / place.path).write_text(ast.unparse(mutant))

    assert exit_status(tmp_path, files_of(place), mutate) != 0
