"""The guide in the packages' docstrings: it names every file, and its recipes do what they say.

A recipe is applied to a copy of the packages as its numbered steps read, and what stands behind
`Try it` is run there; what takes longer only by the slow tests.
"""

import ast
import importlib
import os
import re
import shlex
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from derivations import registry
from figures import FIGURES

ROOT = Path(__file__).parents[1]
PACKAGES = ("derivations", "figures", "impact", "md")
LONG = "pytest", "check", "report"  # commands that take longer


def guide(package: str) -> dict[str, str]:
    """Parts of a package's docstring, by their underlined titles."""
    parts = re.split(r"^(\S.*)\n-+\n", importlib.import_module(package).__doc__, flags=re.M)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def named(package: str) -> set[str]:
    """Files in the left column of the layout; a folder holds for the rest of its line."""
    rows = re.findall(r"^(\S.*?)  +\S", guide(package)["Files, as one reads them"], re.M)
    found = set()
    for row in rows:
        folder = ""
        for name in row.split(", ") if "`" not in row else ():
            folder = name.rpartition("/")[0] or folder
            found.add(f"{folder}/{name.rpartition('/')[2]}".strip("/"))
    return found


@pytest.mark.parametrize("package", PACKAGES)
def test_the_layout_names_every_file(package):
    folder = ROOT / package
    paths = (path.relative_to(folder) for path in folder.rglob("*.py"))
    modules = {path.with_suffix("").as_posix().removesuffix("/__init__") for path in paths}
    modules -= {"__init__", "space", *(FIGURES if package == "figures" else ())}
    others = {name for name in named(package) if (folder / name).is_file()}
    assert named(package) - others == modules


class Step(NamedTuple):
    """Code, and where it goes."""

    path: str
    how: str  # in the words of `WAYS`, before the name
    name: str  # of what stands there, or its text
    code: str


WAYS = (
    *("a new file", "at the end", "last in", "first in the function"),
    *("after the function", "after the class", "after the line", "before the line"),
    "for the line that begins",
)
STEP = re.compile(rf"^\d\. (\S+), ({'|'.join(WAYS)})(?: `([^`]+)`)?(?:: .*)?$")


def blocks(text: str) -> list[tuple[str, str]]:
    """Every indented block with the line above it."""
    found = re.findall(r"^(\S.*)\n\n?((?:(?: {4}.*)?\n)+)", text, re.M)
    return [(line, textwrap.dedent(code).strip("\n")) for line, code in found if code.strip()]


def recipe(package: str, subject: str) -> tuple[list[Step], list[str]]:
    """Steps, and what to try then."""
    (text,) = (text for title, text in guide(package).items() if title.startswith(subject))
    steps, trials = [], []
    for line, code in blocks(text):
        if line.startswith("Try it"):
            trials.append(code)
        else:
            steps.append(Step(*STEP.match(line).groups(""), code))
    return steps, trials


def statements(text: str) -> dict[str, ast.stmt]:
    """Functions, classes and constants by their names."""
    found = {}
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found[node.name] = node
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            target = node.targets[0] if isinstance(node, ast.Assign) else node.target
            found[getattr(target, "id", "")] = node
    return found


def line_of(text: str, name: str, begins: bool) -> int:
    """Number of the only line that is `name` or begins so; comments and docstring do not count."""
    lines, start = text.splitlines(), ast.parse(text).body[0].end_lineno
    codes = {n: lines[n].partition("  #")[0].strip() for n in range(start, len(lines))}
    (number,) = (n for n, c in codes.items() if c == name or (begins and c.startswith(name)))
    return number


def place(text: str, step: Step) -> tuple[int, int, int, int]:
    """Lines that the code replaces, from and to; its indentation, and empty lines before it."""
    lines = text.splitlines()
    match step.how:
        case "at the end":
            return len(lines), len(lines), 0, 2
        case "last in":
            end = statements(text)[step.name].end_lineno - 1
            return end, end, 4, 0
        case "first in the function":  # behind its docstring
            first = statements(text)[step.name].body[1]
            return first.lineno - 1, first.lineno - 1, first.col_offset, 0
        case "after the function" | "after the class":
            node = statements(text)[step.name]
            return node.end_lineno, node.end_lineno, node.col_offset, 2
    start = line_of(text, step.name, step.how.endswith("begins"))
    indent = len(lines[start]) - len(lines[start].lstrip())
    match step.how:
        case "before the line":
            return start, start, indent, 0
        case "after the line":
            return start + 1, start + 1, indent, 0
        case "for the line that begins":
            return start, start + 1, indent, 0
    raise ValueError(step.how)


def follow(steps: list[Step], folder: Path) -> None:
    """Do what the steps say."""
    for step in steps:
        path = folder / step.path
        if step.how == "a new file":
            assert not path.exists()
            path.write_text(f"{step.code}\n", encoding="utf-8")
            continue
        text = path.read_text(encoding="utf-8")
        start, end, indent, empty = place(text, step)
        lines = text.splitlines()
        lines[start:end] = [""] * empty + textwrap.indent(step.code, " " * indent).splitlines()
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def run(command: list[str], folder: Path) -> str:
    """What a command prints in a copy."""
    told = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
    done = subprocess.run(
        [sys.executable, *command], cwd=folder, env=told, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def tried(trials: list[str], folder: Path, long: bool = False) -> None:
    """Run what is Python as it stands; then the commands, the long ones or the others."""
    assert trials
    for trial in trials:
        lines = trial.splitlines()
        commands = [line for line in lines if line.startswith("python -m ")]
        if not long:
            run(["-c", "\n".join(line for line in lines if line not in commands)], folder)
        for command in commands:
            words = shlex.split(command)[1:]
            if long == bool(set(LONG) & set(words)):
                run(words, folder)


def copied(folder: Path) -> Path:
    """A copy of all that recipes change."""
    for name in (*PACKAGES, "tests"):
        left = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, folder / name, ignore=left)
    for name in ("README.md", "pyproject.toml"):
        shutil.copy(ROOT / name, folder)
    return folder


def tidy(folder: Path) -> None:
    """Nothing for the linter to say."""
    run(["-m", "ruff", "check"], folder)
    run(["-m", "ruff", "format", "--check"], folder)


@pytest.fixture
def copy(tmp_path) -> Path:
    return copied(tmp_path)


def test_an_effect(copy):
    """Drag by the air: a falling rod obeys the exact solution; an annulus refuses it."""
    steps, trials = recipe("md", "To add an effect")
    follow(steps, copy)
    tried(trials, copy)
    refuse = "import md; md.load('annulus', ['air.drag=1'])"
    with pytest.raises(AssertionError, match="air must be absent from an annulus"):
        run(["-c", refuse], copy)
    tidy(copy)


def test_a_contact_law(copy):
    """In `md.impact`, at the command line, in a scene."""
    steps, trials = recipe("md", "To add a contact law")
    follow(steps, copy)
    tried(trials, copy)
    impact = "-m md impact --law constant_dashpot --tilt-deg 20 --c-x 1 --c-z -1 --friction 0"
    assert "slide" in run(impact.split(), copy)
    settings = ["contacts.plate.law=constant_dashpot", "contacts.plate.restitution=none"]
    scene = f"import md; print(md.load('quasi2d', {settings}).contacts.plate.law.name)"
    assert run(["-c", scene], copy) == "constant_dashpot\n"
    tidy(copy)


def test_a_figure(copy):
    """Drawn; what it shows is there in numbers."""
    steps, trials = recipe("figures", "To add a figure")
    follow(steps, copy)
    tried(trials, copy)
    with np.load(copy / "out" / "critical.npz") as stored:
        assert np.tan([stored["lower"][-1], stored["upper"][-1]]) == pytest.approx(2)
    assert (copy / "out" / "critical.png").read_bytes().startswith(b"\x89PNG")
    tidy(copy)


PROVED = """
from derivations import registry
(entry,) = (entry for entry in registry.ENTRIES if entry.tag == "V: rebound")
proof = entry.prove()
assert proof.ok, proof
"""
AT_ENDS = """
import impact, numpy as np
rod = impact.ContactGeometry(np.array([0.0, 1e-200, 2.0, 1e300]), 1.0, np.array([1, 1, 1, 1e-9]))
print(*impact.rebound(rod, 0.65))
"""


@pytest.fixture(scope="module")
def with_equation(tmp_path_factory) -> tuple[Path, list[str], list[str]]:
    """A copy in which both recipes are followed, and what to try of either."""
    folder = copied(tmp_path_factory.mktemp("equation"))
    derived, to_derive = recipe("derivations", "To add an equation")
    public, to_use = recipe("impact", "To add a function")
    follow(derived + public, folder)
    return folder, to_derive, to_use


def test_an_equation(with_equation):
    """Proved, generated, public; right at the ends of its domain."""
    folder, to_derive, to_use = with_equation
    run(["-c", PROVED], folder)
    tried(to_derive, folder)
    tried(to_use, folder)
    assert run(["-c", AT_ENDS], folder) == "0.65 0.65 -0.67 -1.0\n"
    readme = (folder / "README.md").read_text(encoding="utf-8")
    assert f"{len(registry.ENTRIES) + 1} entries" in readme
    tidy(folder)


@pytest.mark.slow
def test_all_proofs_the_report_and_the_suite_with_an_equation(with_equation):
    folder, to_derive, to_use = with_equation
    tried(to_derive, folder)
    tried(to_derive, folder, long=True)
    assert "leaves of the centre" in (folder / "out" / "report.html").read_text(encoding="utf-8")
    tried(to_use, folder, long=True)


@pytest.mark.slow
@pytest.mark.parametrize("what", ["an effect", "a contact law"])
def test_the_suite_with(what, copy):
    steps, trials = recipe("md", f"To add {what}")
    follow(steps, copy)
    tried(trials, copy, long=True)
