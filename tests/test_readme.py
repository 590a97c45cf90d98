"""The README and the guide: numbers are those of generated files, examples and commands run."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

import md
from figures.pages import gallery

from .test_help import ALL

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
GUIDE = (gallery.GALLERY / "GUIDE.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", TEXT, re.DOTALL)
SCRIPTS = re.findall(r"```python\n(.*?)```", GUIDE, re.DOTALL)
COMMANDS, LONGER = (
    re.findall(r"^    (python -m .*?)(?: {2,}#.*)?$", text, re.M) for text in (TEXT, GUIDE)
)
# The second needs what the first leaves; a test of claims runs the third in a smaller form.
SLOW = ("sweep", "search", "results", "claims")


def test_pages_are_of_the_numbers_in_the_gallery():
    for path, text in gallery.pages().items():
        assert path.read_text(encoding="utf-8") == text, path.name


def test_the_readme_is_short():
    assert len(TEXT.splitlines()) <= 150
    assert len(TEXT.split()) <= 1500


def test_no_number_is_measured_outside_of_the_generated_parts():
    """No times, percentages or errors but those of generated parts and outputs of examples."""
    text = re.sub(r"<!-- (\w+): begin -->.*?<!-- \1: end -->", "", TEXT + GUIDE, flags=re.DOTALL)
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    found = re.findall(r"\d[\d.]*(?:e-?\d+)? ?(?:%|ns|ms|s|microseconds|cm/s)(?![\w/])|±.*", text)
    assert set(found) <= {"5 %"}  # of an example


@pytest.mark.parametrize("code, output", EXAMPLES)  # noqa: PT006
def test_examples_print_what_stands_below(code, output, capsys):
    """To the letter; a simulated number, which rounding may change, within four of its errors."""
    exec(compile(code, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    if "+-" not in output:
        assert printed == output
        return
    (now, error, *_), (then, before, *_) = (re.findall(r"[\d.]+", t) for t in (printed, output))
    assert abs(float(now) - float(then)) <= 4 * max(float(error), float(before))
    assert float(now) > 3 * float(error) > 0


def test_there_are_examples_and_commands():
    assert len(EXAMPLES) == len(re.findall("```python", TEXT)) == 3
    assert len(COMMANDS) > 2


@pytest.mark.parametrize("code", SCRIPTS)
def test_scripts_of_the_guide_run(code, tmp_path, monkeypatch):
    """In an empty folder, short; a law that one adds is gone behind it."""
    for extra, module in {"md": "xarray", "cluster": "distributed"}.items():
        if f"[{extra}]" not in code.splitlines()[0]:
            monkeypatch.setitem(sys.modules, module, None)  # as if it were not installed
    monkeypatch.chdir(tmp_path)
    laws = {**md.LAWS}
    try:
        exec(compile(code.replace("130", "5"), "GUIDE.md", "exec"), {})
    finally:
        plt.close("all")
        for added in md.LAWS.keys() - laws.keys():
            del md.LAWS[added]
    assert len(SCRIPTS) == 3


def run(command, folder):
    words = shlex.split(command)
    assert words[:2] == ["python", "-m"]
    return subprocess.run(
        [sys.executable, *words[1:]],
        **{"cwd": folder, "capture_output": True, "text": True, "timeout": 300},
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )


@pytest.mark.parametrize("command", [c for c in COMMANDS if not set(SLOW) & set(c.split())])
def test_commands_run(command, tmp_path):
    done = run(command, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout


@pytest.mark.slow
def test_longer_commands_run(tmp_path):
    for command in LONGER:
        done = run(command, tmp_path)
        assert done.returncode == 0, done.stderr
    assert len((tmp_path / "drift.csv").read_text().splitlines()) == 22


def test_every_command_that_is_named_exists():
    named = set(re.findall(r"python -m (\w+) (\w+)", TEXT + GUIDE))
    assert len(named) > 8
    assert named <= {tuple(name.split()) for name in ALL}


def test_make_has_the_targets():
    for target in re.findall(r"(?:^    |`)make (\w+)", TEXT + GUIDE, re.M):
        assert subprocess.run(["make", "-n", target], cwd=ROOT, capture_output=True).returncode == 0


@pytest.mark.parametrize("page", [ROOT / "README.md", *sorted(gallery.GALLERY.glob("*.md"))])
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for target, label in re.findall(r"\]\((?!http)([^)#]*)(?:#([^)]+))?\)", text):
        other = (page.parent / target).resolve() if target else page
        assert other.is_file(), target
        heads = re.findall(r"^#+ (.*)$", other.read_text(encoding="utf-8"), re.M) if label else []
        assert not label or label in [
            re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in heads
        ]


def test_hard_cases_are_where_it_says():
    """The files hold tests of the names that the table gives them."""
    found = set()
    for names, file in re.findall(r"\[([TM]\d[TM\d, -]*)\]\(../../(tests/\w+\.py)\)", GUIDE):
        numbers = [int(number) for number in re.findall(r"\d+", names)]
        if "-" in names:
            numbers = range(numbers[0], numbers[1] + 1)
        text = (ROOT / file).read_text(encoding="utf-8")
        for name in (f"{names[0]}{number}" for number in numbers):
            assert re.search(rf"\b(test_)?{name.lower()}_|\b{name}\b", text), (name, file)
            found.add(name)
    assert len(found) > 20
