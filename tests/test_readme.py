"""The README: its tables come from the registry, its example runs, its pictures are there."""

import re
import tomllib
from pathlib import Path

import numba

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


EXAMPLES = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


def test_example_of_one_impact(capsys):
    assert len([line for line in EXAMPLES[0].splitlines() if line]) <= 8
    exec(compile(EXAMPLES[0], "README.md", "exec"), {})
    assert "SLIP_STICK" in capsys.readouterr().out


def test_example_of_a_row(capsys):
    exec(compile(EXAMPLES[1], "README.md", "exec"), {})
    c_x, error, _ = capsys.readouterr().out.split(maxsplit=2)
    assert float(c_x) > 3 * float(error) > 0


def test_example_of_an_effect():
    """It acts, and without it there is nothing of it."""
    scope = {"kernel": numba.njit}
    exec(compile(EXAMPLES[2], "README.md", "exec"), scope)
    dragged, a = scope["dragged"], (1.0, 2.0, 3.0)
    assert dragged(0.5, a, 2.0, 4.0) == (0.0, 0.0, 3.0)
    assert dragged(None, a, 2.0, 4.0) == a
    assert len(EXAMPLES) == 3


def test_pictures_and_files_exist():
    for target in re.findall(r"\]\((?!http)([^)#]+)\)", TEXT):
        assert (ROOT / target).is_file(), target


def test_no_file_names_a_registry_or_an_address_of_one():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    needs = project["project"]["dependencies"]
    assert all(re.fullmatch(r"[a-z]+>=[\d.]+", need) for need in needs)
