"""The README: its numbers are those of generated files, its examples and commands run."""

import ast
import os
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from figures.pages import readme as measured

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", TEXT, re.DOTALL)
COMMANDS = re.findall(r"^    (python -m .*?)(?: {2,}#.*)?$", TEXT, re.M)
# Run elsewhere, in a smaller form, by the tests of these files.
ELSEWHERE = {"python -m figures claims --quick": "test_claims.py"}
SLOW = ("sweep", "results")  # the second needs what the first leaves


def test_what_is_measured_is_of_the_gallery():
    assert measured.refreshed(TEXT) == TEXT


def test_no_number_is_measured_outside_of_the_generated_parts():
    """No times, percentages or errors but those of generated parts and outputs of examples."""
    text = re.sub(r"<!-- (\w+): begin -->.*?<!-- \1: end -->", "", TEXT, flags=re.DOTALL)
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    found = re.findall(r"\d[\d.]*(?:e-?\d+)? ?(?:%|ns|ms|s|microseconds|cm/s)(?![\w/])|±.*", text)
    assert set(found) <= {"20 %"}  # of an example


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
    assert len(EXAMPLES) == len(re.findall("```python", TEXT)) == 2
    assert len(COMMANDS) > 8


def run(command, folder):
    words = shlex.split(command)
    assert words[:2] == ["python", "-m"]
    here = {key: value for key, value in os.environ.items() if "DISPLAY" not in key}
    return subprocess.run(
        [sys.executable, *words[1:]],
        **{"cwd": folder, "capture_output": True, "text": True, "timeout": 300},
        env=here | {"PYTHONPATH": str(ROOT)},
    )


def quick(command):
    return command not in ELSEWHERE and not set(SLOW) & set(command.split())


@pytest.mark.parametrize("command", list(filter(quick, COMMANDS)))
def test_commands_run(command, tmp_path):
    done = run(command, tmp_path)
    if command == "python -m figures explore":  # there is no display
        assert done.returncode == 2
        assert "--out FILE.png" in done.stderr
        return
    assert done.returncode == 0, done.stderr
    assert done.stdout


@pytest.mark.slow
def test_longer_commands_run(tmp_path):
    for command in COMMANDS:
        if set(SLOW) & set(command.split()):
            assert run(command, tmp_path).returncode == 0
    assert len((tmp_path / "drift.csv").read_text().splitlines()) == 22


@pytest.mark.parametrize("command, file", ELSEWHERE.items())  # noqa: PT006
def test_others_are_run_by_other_tests(command, file):
    """With these very words."""
    words = shlex.split(command)[3:]
    calls = [
        [part.value for part in node.elts if isinstance(part, ast.Constant)]
        for node in ast.walk(ast.parse((ROOT / "tests" / file).read_text(encoding="utf-8")))
        if isinstance(node, ast.List)
    ]
    assert command in COMMANDS
    assert any(call[: len(words)] == words for call in calls)


def test_every_command_that_is_named_exists():
    named = set()
    for package, first, others in re.findall(r"`python -m (\w+) (\w+)`((?:, `\w+`)*)", TEXT):
        named |= {(package, name) for name in (first, *re.findall(r"\w+", others))}
    assert len(named) > 15
    for package, name in named:
        done = run(f"python -m {package} {name} --help", ROOT)
        assert done.returncode == 0, (package, name)


def test_make_has_both_targets():
    for target in re.findall(r"^    make (\w+)", TEXT, re.M):
        assert subprocess.run(["make", "-n", target], cwd=ROOT, capture_output=True).returncode == 0


def test_pictures_and_files_exist():
    for target in re.findall(r"\]\((?!http)([^)#]+)\)", TEXT):
        assert (ROOT / target).is_file(), target


def test_hard_cases_are_where_it_says():
    """The files hold tests of the names that the table gives them."""
    found = set()
    for names, file in re.findall(r"\[([TM]\d[TM\d, -]*)\]\((tests/\w+\.py)\)", TEXT):
        numbers = [int(number) for number in re.findall(r"\d+", names)]
        if "-" in names:
            numbers = range(numbers[0], numbers[1] + 1)
        text = (ROOT / file).read_text(encoding="utf-8")
        for name in (f"{names[0]}{number}" for number in numbers):
            assert re.search(rf"\b(test_)?{name.lower()}_|\b{name}\b", text), (name, file)
            found.add(name)
    assert len(found) > 20


def test_no_file_names_a_registry_or_an_address_of_one():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    needs = project["project"]["dependencies"]
    assert all(re.fullmatch(r"[a-z0-9]+>=[\d.]+", need) for need in needs)
