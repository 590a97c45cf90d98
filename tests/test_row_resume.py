"""M17: Stop and go on: bit for bit the numbers of a run that never stopped."""

import json
import re
import signal
from pathlib import Path

import numpy as np
import pytest

import md
from md import simulation

from .command_line import ended
from .rows import ROW, row

PERIODS = 4
LEDGER = ("ledger",)
SCENE = ("step.size=3e-4", "plate.acceleration=5")


def bits(result):
    """All that a run measured but the time it took."""
    numbers = result.as_dict()
    for key in ("run_seconds", "compile_seconds"):
        del numbers[key]
    arrays = (result.rods, result.c_x_series, result.tilt_series)
    return json.dumps(numbers, sort_keys=True), *(array.tobytes() for array in arrays)


@pytest.fixture(scope="module")
def whole():
    """A run in one go, with its landings."""
    rows = []
    result = md.run(row(*SCENE), periods=PERIODS, observe=rows.append)
    assert result.finished
    assert len(np.concatenate(rows)) > 3
    return bits(result), np.concatenate(rows)


def test_the_same_seed_gives_the_same_bits(whole):
    """And another seed others."""
    assert bits(md.run(row(*SCENE), periods=PERIODS)) == whole[0]
    other = md.run(row(*SCENE, "start.seed=2"), periods=PERIODS)
    assert all(a != b for a, b in zip(bits(other), whole[0], strict=True))


@pytest.mark.parametrize("seconds", [1e-4, 10.0])
def test_how_a_run_is_cut_into_calls_does_not_matter(whole, monkeypatch, seconds):
    """Landings included; the calls' lengths follow the clock, which no two runs share."""
    monkeypatch.setattr(md.host, "CALL_SECONDS", seconds)
    rows = []
    result = md.run(row(*SCENE), periods=PERIODS, observe=rows.append)
    assert bits(result) == whole[0]
    np.testing.assert_array_equal(np.concatenate(rows), whole[1])


@pytest.fixture
def impatient(monkeypatch):
    """Calls of at most 97 steps, however slow the machine: a run can be stopped many times."""
    monkeypatch.setattr(md.host, "CALL_SECONDS", 1e3)
    monkeypatch.setattr(md.host, "_MOST_A_CALL", 97 * row(*SCENE).rods.count)


def interrupted(path, **options):
    """The run, stopped as by Ctrl-C at its first landings."""
    return md.run(
        row(*SCENE),
        periods=PERIODS,
        checkpoint=path,
        observe=lambda _: signal.raise_signal(signal.SIGINT),
        **options,
    )


@pytest.mark.usefixtures("impatient")
def test_a_run_that_was_stopped_goes_on(whole, tmp_path):
    """Stopped in the middle of a period, again and again; told are the whole periods so far.

    The trajectory is in the end that of a run in one go, frame by frame.
    """
    path, once, often = (tmp_path / name for name in ("row.npz", "once.xyz", "often.xyz"))
    steps = []
    md.run(row(*SCENE), periods=PERIODS, trajectory=once, frames=6)
    while not (result := interrupted(path, trajectory=often, frames=6)).finished:
        assert len(result.c_x_series) == len(result.tilt_series) == result.periods < PERIODS
        head = result.c_x_series.tobytes()
        assert whole[0][2][: len(head)] == head
        with np.load(path) as saved:
            steps.append(json.loads(str(saved["about"]))["step"])
    assert any(step % result.steps_per_period for step in steps)
    assert len(set(steps)) > 1
    assert bits(result) == whole[0]
    assert often.read_text() == once.read_text()


def test_a_longer_run_begins_with_a_shorter_one(whole, tmp_path):
    """Two periods, kept, and then two more."""
    path = tmp_path / "row.npz"
    md.run(row(*SCENE), periods=2, checkpoint=path)
    assert bits(md.run(row(*SCENE), periods=PERIODS, checkpoint=path)) == whole[0]
    with pytest.raises(ValueError, match="is 4 periods long already"):
        md.run(row(*SCENE), periods=3, checkpoint=path)
    for other in (row("start.seed=5"), row(*SCENE, "step.size=1e-4")):
        with pytest.raises(ValueError, match="belongs to another scene, or to another step of it"):
            md.run(other, periods=PERIODS, checkpoint=path)


@pytest.fixture
def begun(tmp_path, monkeypatch):
    """Checkpoints of four of one's own rods after 20 periods, with a trajectory and without."""
    monkeypatch.chdir(tmp_path)
    md.run(own(), periods=20, checkpoint="w.npz", trajectory="a.xyz")
    md.run(own(), periods=20, checkpoint="alone.npz")
    return tmp_path


def own():
    return md.load("my_rods", ["rods.count=4", "box.length_cm=3.2"])


def times(path):
    """Of the frames of a trajectory, in periods."""
    return [float(time) for time in re.findall(r" Time=(\S+) ", Path(path).read_text())]


def contents(folder):
    """Of all files, with the time of the last change."""
    return {path.name: (path.read_bytes(), path.stat().st_mtime_ns) for path in folder.iterdir()}


def test_an_account_of_the_energy_cannot_begin_late(tmp_path):
    """A checkpoint without one, as ledger=False leaves it, is refused, and stays as it is."""
    path = tmp_path / "row.npz"
    md.run(row(*SCENE), periods=1, checkpoint=path)
    with np.load(path) as saved:
        np.savez(path, **{name: saved[name] for name in saved if name not in LEDGER})
    before = contents(tmp_path)
    with pytest.raises(md.InputError, match=r"ledger must be False, .*; or remove it"):
        md.run(row(*SCENE), periods=2, checkpoint=path)
    assert contents(tmp_path) == before


def test_an_older_checkpoint_cuts_no_frames(begun):
    """Frames behind it are made again, or it is refused."""
    (begun / "older.npz").write_bytes((begun / "w.npz").read_bytes())
    md.run(own(), periods=24, checkpoint="w.npz", trajectory="a.xyz")
    before = contents(begun)
    with pytest.raises(ValueError, match="goes on to period 23, beyond the 22 asked for"):
        md.run(own(), periods=22, checkpoint="older.npz", trajectory="a.xyz")
    assert contents(begun) == before
    md.run(own(), periods=24, checkpoint="older.npz", trajectory="a.xyz")
    assert contents(begun)["a.xyz"][0] == before["a.xyz"][0]


@pytest.mark.parametrize("part", [b"4\n", b'4\nLattice="1" Time=', b"4\nsomething else\n"])
def test_what_a_killed_run_left_of_a_frame_is_cut_off(begun, part):
    with (begun / "a.xyz").open("ab") as file:
        file.write(part)
    md.run(own(), periods=21, checkpoint="w.npz", trajectory="a.xyz")
    assert times(begun / "a.xyz") == [*range(21)]


@pytest.mark.usefixtures("begun")
def test_a_trajectory_may_begin_with_a_resumed_run():
    md.run(own(), periods=23, checkpoint="alone.npz", trajectory="new.xyz")
    assert times("new.xyz") == [20, 21, 22]
    md.run(own(), periods=24, checkpoint="alone.npz", trajectory="./new.xyz")
    assert times("new.xyz") == [20, 21, 22, 23]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_at_the_prompt(tmp_path, number):
    """Exit code 130, a result of what was done, and a checkpoint from which the run goes on.

    SIGTERM is the same.
    """
    path, trajectory = tmp_path / "row.npz", tmp_path / "row.xyz"
    changes = [part for change in (*ROW, *SCENE) for part in ("--set", change)]
    files = "--checkpoint", str(path), "--trajectory", str(trajectory)
    command = ["md", "run", "quasi2d", *changes, *files, "--json", "--periods", "100000"]
    code, out, err = ended(command, number, tmp_path, begun=trajectory)
    assert (code, err) == (130, "")
    found = json.loads(out)
    assert found["finished"] is False
    more = found["periods"] + 2
    went_on = md.run(row(*SCENE), periods=more, checkpoint=path, trajectory=trajectory)
    assert bits(went_on) == bits(md.run(row(*SCENE), periods=more))


def test_a_checkpoint_that_is_not_finished_leaves_the_old_one(whole, tmp_path, monkeypatch):
    """From which the run goes on."""
    path = tmp_path / "row.npz"
    md.run(row(*SCENE), periods=1, checkpoint=path)
    old = path.read_bytes()

    def half(file, **_):
        file.write(b"PK half a checkpoint")
        raise MemoryError

    with monkeypatch.context() as patch:
        patch.setattr(simulation.np, "savez", half)
        with pytest.raises(MemoryError):
            md.run(row(*SCENE), periods=3, checkpoint=path)
    assert path.read_bytes() == old
    assert bits(md.run(row(*SCENE), periods=PERIODS, checkpoint=path)) == whole[0]
