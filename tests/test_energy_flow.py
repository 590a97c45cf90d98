"""Energy and momentum that flow through a row: the ledger closes, forces along x cancel."""

from functools import cache
from types import SimpleNamespace

import matplotlib.pyplot as plt
import numpy as np
import pytest

from figures.checks import energy_flow
from figures.checks.flows import LOSSES, WAYS, flows, gains
from md.host import prepare
from md.kernels import touches
from md.kernels.codes import C_X
from md.kernels.neighbours import current
from md.kernels.plane import pair_forces

from .quick_figures import data
from .rows import row

PERIODS = 125
CLOSE = {"rtol": 0, "atol": 1e-10}


@cache
def of_few_rods(periods=PERIODS, step="none"):
    return flows(row("box.length=6.5", f"step.size={step}"), periods)


@pytest.fixture(scope="module")
def followed():
    """A row step by step: touches, and what plate and neighbours give each rod along x until then.

    The kernel leaves the accelerations of its last step; those between rods are computed from the
    same state beforehand. Sums over steps begin with 0, before the first one.
    """
    engine = prepare(row("box.length=6.5"))
    effects, (*_, listed, scratch) = engine.effects, engine.state
    start, every, others, kept = engine.rods[:, C_X].sum(), [], [], []
    for _ in range(PERIODS * engine.per):
        place = effects.alone.half_length, effects.period, listed, scratch.place, scratch.found
        assert current(engine.rods, *place)  # the list of pairs
        springs = listed.springs.copy()
        scratch.total[:] = 0
        pair_forces(effects, engine.state, None, engine.dt)
        others.append(scratch.total[:, 0] * engine.dt)
        listed.springs[:] = springs
        engine.go(1)
        every.append(engine.state.before[:, 0] * engine.dt)
        kept.append(engine.record.rows[: engine.record.count[0]].copy())
        engine.record.count[0] = 0
    given = np.array([np.subtract(every, others), others]).cumsum(axis=1)
    plate, neighbours = np.insert(given, 0, 0.0, axis=1)
    gained = engine.rods[:, C_X].sum() - start
    rows = np.concatenate(kept)
    return SimpleNamespace(
        rows=rows, plate=plate, neighbours=neighbours, gained=gained, per=engine.per
    )


def test_the_ledger_closes_as_the_step_shrinks():
    """Work, losses and change of energy: nothing is left over but the error of the step."""
    missing = [abs(of_few_rods(12, step)["residual"]) for step in (8e-4, 4e-4, 2e-4)]
    assert missing[0] < 0.005
    assert missing[2] < 0.15 * missing[0]


def test_parts_of_the_work():
    """Four losses and what is left; a mean part of the weight."""
    found = of_few_rods()
    parts = [found[name][0] for name in LOSSES]
    assert min(parts) > 0.1
    assert sum(parts) + found["change"] + found["residual"] == pytest.approx(1, abs=1e-12)
    assert found["rods"][0] == pytest.approx(parts[2] + parts[3])
    assert 0 < found["carried"][0] < 1


def test_touches_tell_who_gave_the_momentum(followed):
    """Free touches: the plate alone; between touches: neighbours alone; in pushed ones: both."""
    rows, gained = gains(followed.rows)
    rod, begun = rows[:, touches.ROD].astype(int), rows[:, touches.STEP].astype(int)
    ended, free = begun + rows[:, touches.DURATION].astype(int), rows[:, touches.PUSHED] == 0
    assert 0.1 < free.mean() < 0.9
    both = followed.plate, followed.neighbours
    plate, neighbours = (given[ended, rod] - given[begun, rod] for given in both)
    np.testing.assert_allclose(gained["free"], np.where(free, plate, 0), **CLOSE)
    np.testing.assert_allclose(neighbours[free], 0, **CLOSE)
    np.testing.assert_allclose(gained["pushed"], np.where(free, 0, plate + neighbours), **CLOSE)
    assert np.abs(neighbours[~free]).max() > 0.01
    last = np.flatnonzero(np.diff(rod) == 0)
    start, end, rod = ended[last], begun[last + 1], rod[last]
    plate, neighbours = (given[end, rod] - given[start, rod] for given in both)
    np.testing.assert_allclose(plate, 0, **CLOSE)
    np.testing.assert_allclose(gained["aloft"][last + 1], neighbours, **CLOSE)


def test_forces_along_x_cancel(followed):
    """Those between rods at each step; so the plate's, and all on a rod, in the mean."""
    np.testing.assert_allclose(followed.neighbours.sum(axis=1), 0, **CLOSE)
    assert followed.plate[-1].sum() == pytest.approx(followed.gained, abs=1e-9)
    each = np.diff(followed.plate[:: followed.per].sum(axis=1))[PERIODS // 5 :]
    assert each.std() > 0.1
    assert abs(each.mean()) < 2 * each.std() / np.sqrt(len(each))
    found = of_few_rods()
    mean, error = found["together"]
    assert mean == pytest.approx(sum(found[way][0] for way in WAYS))
    assert abs(mean) < 3 * error < found["free"][0]


def test_bars_hold_the_whole_work():
    """One bar a tilt and a loss, each on top of the one before."""
    d = data("energy_flow")
    whole = sum(d[name] for name in LOSSES) + d["change"] + d["residual"]
    np.testing.assert_allclose(whole, 1, atol=1e-9)
    figure = energy_flow.draw(d)
    for law, ax in zip(range(len(d["law"])), figure.axes, strict=False):
        heights = [[bar.get_height() for bar in bars] for bars in ax.containers]
        np.testing.assert_allclose(heights, [d[name][law] for name in LOSSES])
        tops = [bar.get_y() + bar.get_height() for bar in ax.containers[-1]]
        np.testing.assert_allclose(tops, np.sum(heights, axis=0))
    plt.close(figure)
