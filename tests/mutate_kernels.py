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
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

from .command_line import ROOT

PACKAGES = "md", "impact"
# What a mutant changes in a line, and to what
SWAPS = {
    " + ": " - ",
    " - ": " + ",
    " += ": " -= ",
    " -= ": " += ",
    " * ": " / ",
    " / ": " * ",
    " < ": " <= ",
    " <= ": " < ",
    " > ": " >= ",
    " >= ": " > ",
    "min(": "max(",
    "max(": "min(",
    "0.5": "0.4",
    "2": "3",
    "not ": "",
    "if ": "if not ",
    "while ": "while not ",
}
OLD = re.compile(
    r" [-+*/<>] | [-+<>]= |\b(?:min|max)\(|(?<![\w.])(?:0\.5|2)(?!\d)"
    r"|\bnot |\b(?:if|while) (?!not )"
)
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
    row: int  # of the file, from 0
    old: re.Match  # in that line

    def __str__(self):
        new = SWAPS[self.old[0]]
        return f"{self.path}:{self.row + 1} {self.key}: {self.old[0].strip()} -> {new.strip()}"

    def mutate(self, tree):
        """Make the change in a tree."""
        lines = (tree / self.path).read_text().splitlines(keepends=True)
        (begin, end), line = self.old.span(), lines[self.row]
        lines[self.row] = line[:begin] + SWAPS[self.old[0]] + line[end:]
        (tree / self.path).write_text("".join(lines))


def kernels(text):
    """Names of the kernels in a file's text, and the rows below their docstrings."""
    for node in ast.walk(ast.parse(text)):
        made = map(ast.unparse, getattr(node, "decorator_list", []))
        if any(re.fullmatch(r"(\w+\.)*kernel(\(.*\))?", decorator) for decorator in made):
            yield node.name, range(node.body[0].end_lineno, node.end_lineno)


def changes(line):
    """What a mutant may change in a line; no indices and ranges: wrong ones break memory."""
    if " None" in line or "range(" in line:  # `is None` only picks what is compiled
        return
    for old in OLD.finditer(line.partition("  #")[0]):
        before = line[: old.start()]
        if before.count("[") == before.count("]"):
            yield old


def places():
    """All places; functions of one name are numbered in the order of their files."""
    count = Counter()
    for path in sorted(p for package in PACKAGES for p in (ROOT / package).rglob("*.py")):
        text, here = path.read_text(), path.relative_to(ROOT)
        lines = text.splitlines()
        for function, rows in kernels(text):
            name = f"{here.parts[0]}.{function}"
            count[name] += 1
            name += f"({count[name]})" if count[name] > 1 else ""
            found = [(row, old) for row in rows for old in changes(lines[row])]
            for number, (row, old) in enumerate(found, 1):
                yield Place(f"{name}#{number}", here, row, old)


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
    """Write a line without effect into each file of kernels."""
    for path in {tree / place.path for place in PLACES}:
        path.write_text(f"{path.read_text()}\n_ = None\n")


PLACES = sorted(places(), key=lambda place: hashlib.sha256(f"{SEED} {place.key}".encode()).digest())


@pytest.fixture(scope="module")
def unchanged(tmp_path_factory):
    """Check, once for each package, that its tests pass without a mutant."""

    @cache
    def check(package):
        one = next(place for place in PLACES if place.key.startswith(package))
        assert exit_status(tmp_path_factory.mktemp("unchanged"), files_of(one), idle) == 0

    return check


@pytest.mark.parametrize("place", PLACES[:MUTANTS], ids=str)
def test_a_mutant_is_killed(place, tmp_path, unchanged):
    unchanged(place.key.partition(".")[0])
    assert exit_status(tmp_path, files_of(place), place.mutate) != 0
