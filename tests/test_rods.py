"""One name for all commands; what is not installed costs one line."""

import subprocess
import sys
from pathlib import Path

import pytest

from figures.rods import COMMANDS

SCRIPT = "from figures.rods import main; main()"


def ran(*words, **options):
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, **options)


def test_each_command_has_the_same_name_under_rods():
    for name in COMMANDS:
        done = ran("-c", SCRIPT, name, "--version")
        assert (done.returncode, done.stderr) == (0, "")
        assert done.stdout == ran("-m", name, "--version").stdout != ""
    unknown = ran("-c", SCRIPT, "rod")
    assert (unknown.returncode, unknown.stderr) == (1, "rods: no command 'rod'\n")
    assert all(name in unknown.stdout for name in COMMANDS)


@pytest.mark.parametrize(
    ("package", "module"),
    [("md", "numba"), ("derivations", "sympy"), ("figures", "click"), ("impact", "click")],
)
def test_what_is_not_installed_costs_one_line(tmp_path, monkeypatch, package, module):
    """It names the extra that holds it."""
    missing = f"raise ModuleNotFoundError('No module named {module}', name={module!r})\n"
    (tmp_path / f"{module}.py").write_text(missing)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    done = ran("-m", package, "--version", cwd=Path(__file__).parents[1])
    assert done.returncode == 2
    assert done.stderr == (
        f"python -m {package}: {module} is missing: pip install 'rod-impact[{package}]'\n"
    )
