"""Mutate compiled kernels at seeded places and count how many mutants the tests kill.

    python tests/mutate_kernels.py TREE [--count 30] [--seed 1] [--jobs 1] [--only KEY]
                                   [--tests FILE ...] [--timeout SECONDS] [--list]

A place is known by package, function and its number in that function, never by its file, and drawn
by a hash of these and the seed: a tree in which kernels have moved keeps its mutants, and one in
which a few kernels have changed keeps the others. Each mutant is a copy of TREE with one change, on
which the tests of its package run until the first failure: the test files that import the package,
but not those that `NOT_OF_KERNELS` names; those that name the function or its module come first. A
mutant survives if all of them pass; a timeout kills it. Before that they must pass on the unchanged
code, with an idle line in each file of kernels, so that no test objects to any edit at all.

Exit status: 0 after all mutants, 2 for bad input or if tests fail on the unchanged code.
"""

import argparse
import ast
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

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


class Place(NamedTuple):
    """One change of one kernel."""

    key: str  # package, function, number of the change in it
    path: Path  # in the tree
    old: ast.expr
    new: ast.AST

    @property
    def words(self):
        """File, line and change."""
        change = " -> ".join(ast.unparse(node) for node in (self.old, self.new))
        return f"{self.path}:{self.old.lineno} {self.key}: {change}"


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
        case ast.Constant() if type(node.value) in (int, float) and node.value in NUMBERS:
            yield node, ast.Constant(type(node.value)(NUMBERS[node.value]))
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
    made = (d.func if isinstance(d, ast.Call) else d for d in node.decorator_list)
    return any(getattr(d, "attr", getattr(d, "id", "")) == "kernel" for d in made)


def places(tree):
    """All places of a tree; functions of one name are numbered in the order of their files."""
    count = Counter()
    for path in sorted(p for package in PACKAGES for p in (tree / package).rglob("*.py")):
        nodes = ast.walk(ast.parse(path.read_text())) if path.name != "__main__.py" else ()
        for function in (n for n in nodes if isinstance(n, ast.FunctionDef) and is_kernel(n)):
            here = path.relative_to(tree)
            name = f"{here.parts[0]}.{function.name}"
            count[name] += 1
            name += f"({count[name]})" if count[name] > 1 else ""
            changes = (new for node in body(ast.Module(function.body)) for new in mutants(node))
            for number, (old, new) in enumerate(changes, 1):
                yield Place(f"{name}#{number}", here, old, new)


def test_files(tree, place):
    """Test files that test the kernel's package, the likeliest to notice the change first."""
    package, function = re.match(r"(\w+)\.(\w+)", place.key).groups()
    found = []
    for path in sorted(
        p for p in tree.glob("tests/test_*.py") if not NOT_OF_KERNELS.search(p.name)
    ):
        text = path.read_text()
        imported = set(re.findall(r"^\s*(?:from|import) (\w+)", text, re.M))
        if package in imported and (package == "md" or "md" not in imported):
            words = set(re.findall(r"\w+", text))
            found.append((function not in words, place.path.stem not in words, path.name))
    return [f"tests/{name}" for *_, name in sorted(found)]


def mutate(tree, place):
    """Write the change into the source."""
    path, old = tree / place.path, place.old
    lines = path.read_bytes().splitlines(keepends=True)
    first, last = old.lineno - 1, old.end_lineno - 1
    text = ast.unparse(place.new)
    text = text if isinstance(place.new, ast.stmt) else f"({text})"
    after = lines[last][old.end_col_offset :]
    lines[first : last + 1] = [lines[first][: old.col_offset] + text.encode() + after]
    path.write_bytes(b"".join(lines))


def tested(tree, files, timeout, edit):
    """Exit status of the tests on an edited copy, None after a timeout, and their output."""
    with tempfile.TemporaryDirectory() as temporary:
        clone = Path(temporary) / "tree"
        shutil.copytree(tree, clone, ignore=shutil.ignore_patterns(*LEFT_OUT))
        edit(clone)
        python = tree / ".venv" / "bin" / "python"
        command = [str(python if python.exists() else sys.executable), "-m", "pytest", "-x", "-q"]
        environment = os.environ | {"PYTHONPATH": str(clone), "XDG_CACHE_HOME": temporary}
        command += ["-p", "no:cacheprovider", *files]
        with (Path(temporary) / "output").open("w+") as output:
            both = {"stdout": output, "stderr": subprocess.STDOUT}
            try:
                done = subprocess.run(command, cwd=clone, env=environment, timeout=timeout, **both)
                status = done.returncode
            except subprocess.TimeoutExpired:
                status = None
            output.seek(0)
            return status, output.read()


def idle(paths, tree):
    """Append a line without effect to files."""
    for path in paths:
        with (tree / path).open("a") as file:
            file.write("_ = None\n")


def verdict(tree, options, place):
    """Print what became of a mutant; whether it survived."""
    files = options.tests or test_files(tree, place)
    begin = perf_counter()
    status, output = tested(tree, files, options.timeout, partial(mutate, place=place))
    failed = re.search(r"^(?:FAILED|ERROR) (\S+)", output, re.M)
    by = "timeout" if status is None else failed.group(1) if failed else f"exit status {status}"
    word = "survived" if status == 0 else "killed"
    print(f"{word:8} {perf_counter() - begin:4.0f} s  {place.words}", end="", flush=True)
    print(f"  [{by}]" if status != 0 else "", flush=True)
    return status == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tree", type=Path)
    parser.add_argument("--count", type=int, default=30, help="mutants")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="mutants at a time")
    parser.add_argument("--timeout", type=float, default=1800, help="seconds for a mutant")
    parser.add_argument("--only", default="", help="regular expression that keys match: md.march")
    parser.add_argument("--tests", nargs="+", metavar="FILE", help="in place of the chosen ones")
    parser.add_argument("--list", action="store_true", help="print the mutants, run nothing")
    options = parser.parse_args()
    tree = options.tree.resolve()
    found = [p for p in places(tree) if re.match(options.only, p.key)]
    if not found or options.count < 1 or options.jobs < 1:
        parser.error(f"{tree}: {len(found)} places, --count and --jobs must be at least 1")
    found.sort(key=lambda p: hashlib.sha256(f"{options.seed} {p.key}".encode()).digest())
    chosen = found[: options.count]
    print(f"{len(chosen)} of {len(found)} places, seed {options.seed}", flush=True)
    if options.list:
        print(*(place.words for place in chosen), sep="\n")
        return
    for package in sorted({place.key.partition(".")[0] for place in chosen}):
        one = next(place for place in chosen if place.key.startswith(package))
        files = options.tests or test_files(tree, one)
        begin, edit = perf_counter(), partial(idle, {p.path for p in found})
        status, output = tested(tree, files, options.timeout, edit)
        if status != 0:
            parser.error(f"tests fail on the unchanged {package} ({status}):\n{output[-2000:]}")
        print(
            f"unchanged {package}: {len(files)} test files pass in {perf_counter() - begin:.0f} s"
        )
    with ThreadPoolExecutor(options.jobs) as pool:
        survived = sum(pool.map(partial(verdict, tree, options), chosen))
    print(f"{len(chosen) - survived} killed, {survived} survived")


if __name__ == "__main__":
    main()
