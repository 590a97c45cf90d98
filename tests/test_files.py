"""A full disk ends a run in one line; what was saved before stays and goes on."""

import errno
import os
from unittest.mock import Mock

import pytest

import md
from md import records, simulation

from .command_line import enter, names_in
from .rows import LIVELY, ROW, row, sets

FULL = Mock(side_effect=OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))  # a disk


@pytest.mark.parametrize(
    ("where", "what", "file"),
    [
        (simulation.np, "savez", "w.npz"),
        (records.Trajectory, "write", "a.xyz"),
        (records.Trajectory, "flush", "a.xyz"),
    ],
)
def test_a_run_that_a_full_disk_has_ended_goes_on(tmp_path, monkeypatch, where, what, file):
    """The command names the file; the checkpoint before holds, and the frames are filled in."""
    kept = "--checkpoint", tmp_path / "w.npz", "--trajectory", tmp_path / "a.xyz"
    command = "md run quasi2d --frames 6", *sets(*ROW, *LIVELY), *kept, "--periods"
    enter(*command, 2)
    saved = (tmp_path / "w.npz").read_bytes()
    with monkeypatch.context() as patch:
        patch.setattr(where, what, FULL)
        err = enter(*command, 3, code=2).err
    said = f"python -m md run: cannot write: {tmp_path}/{file}: No space left on device\n"
    rest = err.removeprefix(said)  # the result, if only the last save failed
    assert rest[:5] == ("" if what == "write" else "rods ")
    assert (tmp_path / "w.npz").read_bytes() == saved
    printed = enter(*command, 3).out
    once = md.run(row(*LIVELY), periods=3, trajectory=tmp_path / "once.xyz", frames=6)
    assert f"c_x = {once.c_x:.4g} sqrt(g d)" in printed
    assert names_in(tmp_path) == {"a.xyz", "once.xyz", "w.npz"}
    assert (tmp_path / "a.xyz").read_text() == (tmp_path / "once.xyz").read_text()
