"""The README: its tables come from the registry, its example runs, its pictures are there."""

import re
import tomllib
from pathlib import Path

from derivations import readme, registry

ROOT = Path(__file__).parent.parent
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def test_tables_are_those_of_the_registry():
    assert readme.refreshed(TEXT) == TEXT


def test_every_numbered_equation_and_every_mistake_is_listed():
    for tag in [*range(1, 32), *(f"B{n}" for n in range(1, 13))]:
        assert f"| ({tag}) |" in TEXT
    for entry in registry.mistakes():
        assert f"| {entry.tag} |" in TEXT


def test_example_runs(capsys):
    (example,) = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    assert len([line for line in example.splitlines() if line]) <= 8
    exec(compile(example, "README.md", "exec"), {})
    assert "SLIP_STICK" in capsys.readouterr().out


def test_pictures_and_files_exist():
    for target in re.findall(r"\]\((?!http)([^)#]+)\)", TEXT):
        assert (ROOT / target).is_file(), target


def test_no_file_names_a_registry_or_an_address_of_one():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    needs = project["project"]["dependencies"]
    assert all(re.fullmatch(r"[a-z]+>=[\d.]+", need) for need in needs)
