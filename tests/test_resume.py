"""M17: stop and go on: bit for bit the numbers of a run that never stopped."""

import json
import re
import signal
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

import md

from .command_line import each_signal, ended
from .rows import DRIVEN, LIVELY, ROW, ring, row, sets

PERIODS = 4
SCENES = {"row": partial(row, *LIVELY), "annulus": partial(ring, DRIVEN)}


class Whole(NamedTuple):
    """A run in one go."""

    scene_with: Any  # the scene with some keys changed
    bits: tuple
    touches: bytes

    def again(self, *changes, periods=PERIODS, **options):
        """Bits of a run of the same scene, but for changes."""
        return bits(md.run(self.scene_with(*changes), periods=periods, **options))


def bits(result):
    """All that a run measured but the time it took."""
    numbers = replace(result, run_seconds=0.0, compile_seconds=0.0).as_dict()
    arrays = (result.rods, result.c_x_series, result.tilt_series)
    return json.dumps(numbers, sort_keys=True), *(array.tobytes() for array in arrays)


@pytest.fixture(scope="module", params=SCENES.values(), ids=SCENES)
def whole(request):
    rows = []
    result = md.run(request.param(), periods=PERIODS, observe=rows.append)
    assert result.finished
    assert len(np.concatenate(rows)) > 3
    return Whole(request.param, bits(result), np.concatenate(rows).tobytes())


@pytest.fixture
def path(tmp_path):
    return tmp_path / "rods.npz"


def test_another_seed_gives_other_bits(whole):
    """And the same one the same, as the next test shows."""
    assert not set(whole.again("start.seed=2")) & set(whole.bits)


@pytest.mark.parametrize("seconds", [1e-4, 10.0])
def test_how_a_run_is_cut_into_calls_does_not_matter(whole, monkeypatch, seconds):
    """Touches included; the calls' lengths follow the clock, which no two runs share."""
    monkeypatch.setattr(md.host, "CALL_SECONDS", seconds)
    rows = []
    assert whole.again(observe=rows.append) == whole.bits
    assert np.concatenate(rows).tobytes() == whole.touches


def test_a_run_that_was_stopped_goes_on(whole, path, monkeypatch):
    """Stopped in the middle of a period, again and again; told are the whole periods so far.

    The trajectory is in the end that of a run in one go, frame by frame. Calls have at most 97
    steps, however slow the machine: a run can be stopped many times.
    """
    scene, steps, finished = whole.scene_with(), [], False
    monkeypatch.setattr(md.host, "CALL_SECONDS", 1e3)
    monkeypatch.setattr(md.host, "_MOST_A_CALL", 97 * scene.rods.count)
    once, often = path.with_name("once.xyz"), path.with_name("often.xyz")
    md.run(scene, periods=PERIODS, trajectory=once, frames=6)
    while not finished:
        result = md.run(
            scene, periods=PERIODS, checkpoint=path, trajectory=often, frames=6,
            observe=lambda _: signal.raise_signal(signal.SIGINT),
        )  # fmt: skip
        assert len(result.c_x_series) == len(result.tilt_series) == result.periods
        assert whole.bits[2].startswith(result.c_x_series.tobytes())
        finished = result.finished
        with np.load(path) as saved:
            steps.append(json.loads(str(saved["about"]))["step"])
    assert any(step % result.steps_per_period for step in steps)
    assert len(set(steps)) > 1
    assert bits(result) == whole.bits
    assert often.read_text() == once.read_text()


def test_a_longer_run_begins_with_a_shorter_one(whole, path):
    """Two periods, kept, and then two more."""
    whole.again(periods=2, checkpoint=path)
    assert whole.again(checkpoint=path) == whole.bits
    with pytest.raises(ValueError, match="is 4 periods long already"):
        whole.again(periods=3, checkpoint=path)
    for other in ("start.seed=5", "step.size=1e-4"):
        with pytest.raises(ValueError, match="belongs to another scene, or to another step of it"):
            whole.again(other, checkpoint=path)


def test_a_run_without_an_account_of_the_energy_goes_on_without_one(path):
    """A rod that flies: its kernels, with the account and without, compile in a moment."""
    scene, bare = md.Scene(start=md.Start(tilt_deg=10.0)), {"ledger": False, "checkpoint": path}
    md.run(scene, periods=1, **bare)
    with pytest.raises(md.InputError, match=r"ledger must be False, .*; or remove it"):
        md.run(scene, periods=2, checkpoint=path)
    assert bits(md.run(scene, periods=2, **bare)) == bits(md.run(scene, periods=2, ledger=False))


# Trajectories of resumed runs


def run(periods, **options):
    md.run(row(*LIVELY), periods=periods, checkpoint="w.npz", **options)


def times(file):
    """Of its frames, in periods."""
    return [float(time) for time in re.findall(r" Time=(\S+) ", Path(file).read_text())]


@pytest.mark.parametrize("part", [b"5\n", b'5\nLattice="1" Time=', b"5\nsomething else\n"])
def test_what_a_killed_run_left_of_a_frame_is_cut_off(here, part):
    run(20, trajectory="a.xyz")
    with (here / "a.xyz").open("ab") as file:
        file.write(part)
    run(21, trajectory="a.xyz")
    assert times("a.xyz") == [*range(21)]


@pytest.mark.usefixtures("here")
def test_a_trajectory_may_begin_with_a_resumed_run():
    run(20)
    for periods, name in ((23, "new.xyz"), (24, "./new.xyz")):
        run(periods, trajectory=name)
        assert times(name) == [*range(20, periods)]


@each_signal
def test_ctrl_c_at_the_prompt(path, number):
    """Exit code 130, a result of what was done, and a checkpoint from which the run goes on."""
    trajectory = path.with_suffix(".xyz")
    command = "md run quasi2d --periods 100000 --checkpoint rods.npz --trajectory rods.xyz --json"
    changes = sets(*ROW, *LIVELY)
    code, out, err = ended(number, path.parent, command, *changes, begun=trajectory)
    found = json.loads(out)
    assert (code, err, found["finished"]) == (130, "", False)
    more = found["periods"] + 2
    went_on = md.run(row(*LIVELY), periods=more, checkpoint=path, trajectory=trajectory)
    assert bits(went_on) == bits(md.run(row(*LIVELY), periods=more))
