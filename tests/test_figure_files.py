"""Files of the figures' commands: refused before the work, and nothing else is ever replaced."""

import shutil
from pathlib import Path

import pytest

from derivations.__main__ import main as derive
from figures.__main__ import main
from figures.claims import judge
from figures.cost import effect_prices
from figures.pages import everything, explore, gallery, index, movie
from figures.paper import fig10
from md.scene import SCENES

from .command_line import refused

UNWRITABLE = Path("/proc")  # for root as well
WORK = {  # what takes the time, of each command
    "draw fig10": (fig10, "data"),
    "movie quasi2d": (movie, "record"),
    "claims": (judge, "judge"),
    "paper": (everything, "estimate"),
    "paper --estimate": (everything, "estimate"),
    "prices": (effect_prices, "data"),
    "explore": (explore, "write"),
    "index": (index, "files"),
}


@pytest.fixture
def idle(monkeypatch):
    """A command that begins to work has failed."""

    def begun(*_arguments, **_options):
        pytest.fail("began to work")

    for module, name in WORK.values():
        if module is not index:
            monkeypatch.setattr(module, name, begun)
    monkeypatch.setattr("derivations.registry.check", begun)


@pytest.mark.skipif(not UNWRITABLE.is_dir(), reason="no folder that nobody can write to")
@pytest.mark.parametrize("command", [*WORK, "movie quasi2d GIF", "derivations report"])
def test_nowhere_to_write_is_noticed_at_the_start(command, idle, monkeypatch, capsys):
    monkeypatch.setattr(index, "files", lambda out: {"index.html": b""})
    program, *arguments = command.split()
    out = UNWRITABLE
    if "explore" in command:
        out /= "a.png"
    if "GIF" in command:
        arguments, out = arguments[:-1], out / "a.gif"
    if program == "derivations":
        refused(lambda: derive([*arguments, "--out", str(out)]), "/proc", capsys)
    else:
        refused(lambda: main([program, *arguments, "--out", str(out)]), "/proc", capsys)


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
        ("explore --out a.png", "a.png"),
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


def test_the_pages_need_a_checkout(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(gallery, "README", tmp_path / "README.md")
    refused(lambda: main(["pages"]), f"needs a source checkout; there is no {tmp_path}", capsys)
    assert not list(tmp_path.iterdir())
