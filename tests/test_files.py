"""What runs and commands write: never onto an input or another's file; full disks end no run."""

import errno
import json
import os
import socket
from pathlib import Path

import numpy as np
import pytest

import md
from md import calibration, files, trajectory
from md import simulation as runner
from md.__main__ import main
from md.store import Store, table, write_csv

from .command_line import refused
from .rows import row
from .test_store import ABOUT

SCENE = ["step.size=3e-4", "plate.acceleration=5"]


def full(*_args, **_options):
    """A disk that takes no more."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A store with a run, and files of other kinds."""
    monkeypatch.chdir(tmp_path)
    with Store("a.db") as store:
        store.put("k", ABOUT, {"c_x": 0.5}, None)
    Path("notes.csv").write_text("day,hours\n1,8\n")
    Path("other.json").write_text('{"order": 1}')
    Path("other.xyz").write_text('1\nLattice="1 0 0 0 1 0 0 0 1" Properties=pos:R:3\n0 0 0\n')
    Path("mine.toml").write_text('scene = "my_rods"\n')
    Path("empty.toml").touch()
    write_csv("more.csv", *table("a.db"))  # and a column of one's own
    Path("more.csv").write_text(Path("more.csv").read_text().replace("\n", ",mine\n"))
    np.save("array.npy", np.zeros(3))
    np.savez("arrays.npz", about="{}")
    np.savez("old.npz", about=json.dumps({"code": "other", "scene": "other"}))
    Path("cut.npz").write_bytes(b"PK\x03\x04 cut short")
    Path("link").symlink_to("a.db")
    Path("hard").hardlink_to("a.db")
    with socket.socket(socket.AF_UNIX) as device:  # as /dev/null, without the harm
        device.bind("socket")
    return tmp_path


def contents(folder):
    """Of all files but those that SQLite reads with."""
    mine = (path for path in folder.glob("*") if "db-" not in path.name)
    return {path.name: path.read_bytes() if path.is_file() else None for path in mine}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("results a.db --csv a.db", "csv must be another file than store, got 'a.db'"),
        ("results a.db --csv ./a.db", "csv must be another file than store"),
        ("results a.db --csv link", "csv must be another file than store"),
        ("results link --csv hard", "csv must be another file than store"),
        ("results a.db --csv notes.csv", "csv must be a new file or one of runs, got 'notes.csv'"),
        ("results a.db --csv a.db-wal", "csv must be another file than store-wal"),
        ("results a.db --csv more.csv", "csv must be a new file or one of runs, got 'more.csv'"),
        ("results a.db --csv array.npy", "csv must be a new file or one of runs"),
        ("results a.db --csv socket", "csv must be a plain file, got 'socket'"),
        ("results a.db --csv nowhere/a.csv", "csv must be in a folder that exists"),
        ("calibrate --store a.db --out a.db", "out must be another file than store"),
        ("calibrate --store a.db --out other.json", "out must be a new file or one of a calib"),
        ("calibrate --store a.db --out notes.csv", "out must be a new file or one of a calib"),
        ("sweep mine.toml --store mine.toml", "store must be another file than sweep"),
        ("run empty.toml --trajectory empty.toml", "trajectory must be another file than scene"),
        ("run empty.toml --checkpoint empty.toml", "checkpoint must be another file than scene"),
        ("run my_rods --trajectory t --checkpoint ./t", "checkpoint must be another file than tra"),
        ("run my_rods --trajectory other.xyz", "trajectory must be a new file or one of frames"),
        ("run my_rods --trajectory a.db", "trajectory must be a new file or one of frames"),
        ("run my_rods --checkpoint empty.toml", "checkpoint empty.toml cannot be read: not one"),
        ("run my_rods --checkpoint cut.npz", "checkpoint cut.npz cannot be read: not one"),
        ("run my_rods --checkpoint notes.csv", "checkpoint notes.csv cannot be read: not one"),
        ("run my_rods --checkpoint array.npy", "checkpoint array.npy cannot be read: not one"),
        ("run my_rods --checkpoint old.npz", "old.npz belongs to an earlier version of md or"),
        ("run my_rods --checkpoint arrays.npz", "checkpoint arrays.npz cannot be read: not one"),
    ],
)
def test_no_file_of_another_kind_is_replaced(folder, monkeypatch, capsys, arguments, words):
    """By its own name or another one; refused before any work."""
    monkeypatch.setattr(calibration, "calibrate", lambda *_, **__: pytest.fail("work begun"))
    before = contents(folder)
    refused(lambda: main(arguments.split()), words, capsys)
    assert contents(folder) == before


def test_functions_are_guarded_as_commands_are(folder):
    before = contents(folder)
    with pytest.raises(ValueError, match="csv must be a new file or one of runs"):
        write_csv("a.db", *table("a.db"))
    with pytest.raises(ValueError, match="trajectory must be a new file or one of frames"):
        md.run(row(*SCENE), periods=1, trajectory="a.db")
    with pytest.raises(ValueError, match="checkpoint must be another file than trajectory"):
        md.run(row(*SCENE), periods=1, trajectory="t", checkpoint=folder / "t")
    assert contents(folder) == before


def test_what_a_command_wrote_it_may_replace(folder, monkeypatch, capsys):
    """A table, of no runs as well, and a calibration; behind a link, the file itself."""
    Store("none.db").database.close()
    Path("to").symlink_to("b.csv")
    for _ in range(2):
        assert main(["results", "none.db", "--csv", "b.csv"]) == 0
        assert main(["results", "a.db", "--csv", "to"]) == 0
    assert Path("to").is_symlink()
    assert len(Path("b.csv").read_text().splitlines()) == 2
    measured = json.loads(md.accuracy.CALIBRATION.read_text())
    monkeypatch.setattr(calibration, "calibrate", lambda *_, **__: measured)
    for _ in range(2):
        assert main(["calibrate", "--store", "a.db", "--out", "c.json"]) == 0
    assert json.loads(Path("c.json").read_text()) == measured
    assert not list(folder.glob("*.part*"))


# A full disk


def test_a_result_is_given_before_the_checkpoint_that_failed(tmp_path, monkeypatch, capsys):
    """By the command, then one line and an exit code; by the function, with a warning."""
    monkeypatch.setattr(runner.np, "savez", full)
    command = ["run", "single_rod", "--periods", "2", "--json", "--checkpoint"]
    assert main([*command, str(tmp_path / "w.npz")]) == 2
    printed = capsys.readouterr()
    assert json.loads(printed.out)["periods"] == 2
    assert printed.err == (
        f"python -m md run: cannot write: checkpoint {tmp_path}/w.npz: No space left on device\n"
    )
    with pytest.warns(files.NotWritten, match=r"w.npz: No space left"):
        result = md.run(row(*SCENE), periods=2, checkpoint=tmp_path / "w.npz")
    assert result.finished
    assert result.periods == 2
    (why,) = result.unwritten
    assert why.startswith("checkpoint ")
    assert list(tmp_path.iterdir()) == []


def test_a_disk_with_room_again_takes_the_next_checkpoint(tmp_path, monkeypatch):
    """Told once while the run goes on; in the end all is written."""
    save, calls = np.savez, []

    def at_first_full(*args, **options):
        calls.append(args)
        return full() if len(calls) < 3 else save(*args, **options)

    monkeypatch.setattr(runner.np, "savez", at_first_full)
    monkeypatch.setattr(runner, "_SAVED", 0.0)
    how = {"checkpoint": tmp_path / "w.npz", "trajectory": tmp_path / "a.xyz", "frames": 6}
    with pytest.warns(RuntimeWarning, match="No space left on device; the run goes on") as told:
        result = md.run(row(*SCENE), periods=2, **how)  # saved at each frame at least
    assert len(told) == 1
    assert result.unwritten == ()
    assert md.run(row(*SCENE), periods=2, **how).c_x == result.c_x


@pytest.mark.parametrize("what", ["write", "state"])
def test_a_trajectory_cut_off_by_a_full_disk_is_filled_later(tmp_path, monkeypatch, what):
    """The run ends well; its checkpoint stays where the trajectory is whole."""
    how = {"checkpoint": tmp_path / "w.npz", "trajectory": tmp_path / "a.xyz", "frames": 6}
    md.run(row(*SCENE), periods=2, **how)
    with monkeypatch.context() as patch:
        patch.setattr(trajectory.Trajectory, what, full)
        with pytest.warns(RuntimeWarning, match="No space left") as told:
            result = md.run(row(*SCENE), periods=3, **how)
    assert result.finished
    assert len(result.unwritten) == 2
    assert any(isinstance(one.message, files.NotWritten) for one in told)
    once = md.run(row(*SCENE), periods=3, trajectory=tmp_path / "once.xyz", frames=6)
    assert result.c_x == once.c_x == md.run(row(*SCENE), periods=3, **how).c_x
    assert (tmp_path / "a.xyz").read_text() == (tmp_path / "once.xyz").read_text()
