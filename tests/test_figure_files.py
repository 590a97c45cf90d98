"""Files of the figures' commands: refused before the work, and nothing else is ever replaced."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import pytest

from figures.__main__ import main
from figures.pages import index
from md.scene import SCENES

from .command_line import ROOT, refused
from .test_help import GROUPS

WORK = (  # what takes the time of the commands
    *("claims.judge.judge", "cost.effect_prices.data", "pages.everything.estimate"),
    *("pages.movie.record", "paper.fig10.data"),
)


@pytest.fixture
def idle(monkeypatch):
    """A command that begins to work has failed."""
    for work in (*(f"figures.{name}" for name in WORK), "derivations.registry.check"):
        monkeypatch.setattr(work, Mock(side_effect=AssertionError("began to work")))


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="no folder that nobody can write to")
@pytest.mark.parametrize(
    "command",
    [
        *("figures draw fig10 --out /proc", "figures claims --out /proc"),
        *("figures movie quasi2d --out /proc", "figures movie quasi2d --out /proc/a.gif"),
        *("figures paper --out /proc", "figures paper --estimate --out /proc"),
        *("figures prices --out /proc", "figures explore --html /proc/a.html"),
        *("figures index --out /proc", "derivations report --out /proc"),
    ],
)
def test_nowhere_to_write_is_noticed_at_the_start(command, idle, monkeypatch, capsys):
    """By root as well."""
    monkeypatch.setattr(index, "files", lambda out: {"index.html": b""})
    package, *words = command.split()
    refused(lambda: GROUPS[package](words), "/proc", capsys)


@pytest.mark.parametrize(
    ("command", "name"),
    [
        ("draw fig10 --out .", "fig10.npz"),
        ("draw fig10 --out .", "fig10.png"),
        ("draw fig10 --out .", "fig10.pdf"),
        ("movie quasi2d --out .", "quasi2d.gif"),
        ("movie quasi2d --out a.gif", "a.gif"),
        ("claims --out .", "claims.md"),
        ("claims --out .", "claims.json"),
        ("paper --out .", "fig13.npz"),
        ("paper --out .", "index.html"),
        ("paper --estimate --out .", "quasi2d.gif"),
        ("prices --out .", "prices.png"),
        ("explore --html a.html", "a.html"),
        ("index --out .", "index.html"),
    ],
)
def test_a_file_of_another_kind_is_not_replaced(command, name, idle, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    kept = "<title>My garden</title>"
    Path(name).write_text(kept)
    if name.endswith(".json"):
        kept = '{"my": "data"}'
        Path(name).write_text(kept)
    Path("prices.txt").touch()  # something to show
    refused(lambda: main(command.split()), name, capsys)
    assert Path(name).read_text() == kept
    assert {path.name for path in tmp_path.iterdir()} == {name, "prices.txt"}


def test_a_movie_is_not_written_over_its_scene(idle, tmp_path, capsys):
    scene = tmp_path / "mine.gif"
    shutil.copy(SCENES / "quasi2d.toml", scene)
    for out in (scene, tmp_path):
        refused(lambda out=out: main(["movie", str(scene), "--out", str(out)]), "mine.gif", capsys)
    assert scene.read_text() == (SCENES / "quasi2d.toml").read_text()
    assert list(tmp_path.iterdir()) == [scene]


@pytest.mark.parametrize(
    ("command", "backend"),
    [
        ("figures draw fig10 fig11 --quick --jobs 2", "module://no.such.notebook"),
        ("figures movie single_rod --periods 1 --frames 1", "nonsense"),
    ],
)
def test_commands_need_no_window(command, backend, tmp_path):
    """Whatever the environment says, in their processes as well."""
    done = subprocess.run(
        [sys.executable, "-m", *command.split()],
        **{"cwd": tmp_path, "capture_output": True, "text": True, "check": False},
        env=os.environ | {"PYTHONPATH": str(ROOT), "MPLBACKEND": backend},
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_figures_keep_the_backend_that_was_chosen(tmp_path):
    """As a notebook's own."""
    code = "import figures; f = figures.load('fig11'); p = f.draw(f.data(quick=True)); "
    code += "print(type(p.canvas).__module__)"
    done = subprocess.run(
        [sys.executable, "-c", code],
        **{"cwd": tmp_path, "capture_output": True, "text": True, "check": True},
        env=os.environ | {"PYTHONPATH": str(ROOT), "MPLBACKEND": "svg"},
    )
    assert done.stdout.strip() == "matplotlib.backends.backend_svg"
