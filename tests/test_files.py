"""A full disk ends no run."""

import errno
import json
import os
from unittest.mock import Mock

import pytest

import md
from md import files, trajectory
from md import simulation as runner
from md.__main__ import main

from .rows import ROW, row, sets

SCENE = ["step.size=3e-4", "plate.acceleration=5"]
FULL = Mock(side_effect=OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))  # a disk


def test_a_result_is_given_before_the_checkpoint_that_failed(tmp_path, monkeypatch, capsys):
    """The command gives it, then one line and an exit code; the function warns."""
    monkeypatch.setattr(runner.np, "savez", FULL)
    command = ["run", "quasi2d", *sets(*ROW, *SCENE), "--periods", "2", "--json", "--checkpoint"]
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


@pytest.mark.parametrize("what", ["write", "flush"])
def test_a_trajectory_cut_off_by_a_full_disk_is_filled_later(tmp_path, monkeypatch, what):
    """The run ends well; its checkpoint stays where the trajectory is whole."""
    how = {"checkpoint": tmp_path / "w.npz", "trajectory": tmp_path / "a.xyz", "frames": 6}
    md.run(row(*SCENE), periods=2, **how)
    with monkeypatch.context() as patch:
        patch.setattr(trajectory.Trajectory, what, FULL)
        with pytest.warns(RuntimeWarning, match="No space left") as told:
            result = md.run(row(*SCENE), periods=3, **how)
    assert result.finished
    assert len(result.unwritten) == 2
    assert any(isinstance(one.message, files.NotWritten) for one in told)
    once = md.run(row(*SCENE), periods=3, trajectory=tmp_path / "once.xyz", frames=6)
    assert result.c_x == once.c_x == md.run(row(*SCENE), periods=3, **how).c_x
    assert (tmp_path / "a.xyz").read_text() == (tmp_path / "once.xyz").read_text()
