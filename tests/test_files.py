"""A full disk ends a run in one line; what was saved before stays and goes on."""

import errno
import os
from unittest.mock import Mock

import pytest

import md
from md import simulation, trajectory
from md.__main__ import main

from .rows import ROW, row, sets

SCENE = ["step.size=3e-4", "plate.acceleration=5"]
FULL = Mock(side_effect=OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))  # a disk


@pytest.mark.parametrize(
    ("where", "what", "file"),
    [
        (simulation.np, "savez", "w.npz"),
        (trajectory.Trajectory, "write", "a.xyz"),
        (trajectory.Trajectory, "flush", "a.xyz"),
    ],
)
def test_a_run_that_a_full_disk_has_ended_goes_on(tmp_path, monkeypatch, capsys, where, what, file):
    """The command names the file; the checkpoint before holds, and the frames are filled in."""
    command = ["run", "quasi2d", *sets(*ROW, *SCENE), "--frames", "6"]
    command += ["--checkpoint", str(tmp_path / "w.npz"), "--trajectory"]
    assert main([*command, str(tmp_path / "a.xyz"), "--periods", "2"]) == 0
    saved = (tmp_path / "w.npz").read_bytes()
    longer = [str(tmp_path / "a.xyz"), "--periods", "3"]
    with monkeypatch.context() as patch:
        patch.setattr(where, what, FULL)
        assert main([*command, *longer]) == 2
    said = f"python -m md run: cannot write: {tmp_path}/{file}: No space left on device\n"
    rest = capsys.readouterr().err.removeprefix(said)  # the result, if only the last save failed
    assert rest[:5] == ("" if what == "write" else "rods ")
    assert (tmp_path / "w.npz").read_bytes() == saved
    assert main([*command, *longer]) == 0
    how = {"trajectory": tmp_path / "once.xyz", "frames": 6}
    once = md.run(row(*SCENE), periods=3, **how)
    assert f"c_x = {once.c_x:.4g} sqrt(g d)" in capsys.readouterr().out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.xyz", "once.xyz", "w.npz"]
    assert (tmp_path / "a.xyz").read_text() == (tmp_path / "once.xyz").read_text()
