"""States of a row, how long they last, hysteresis: made-up motions and states."""

import numpy as np
import pytest

from figures.checks import row_motion, states
from figures.checks.states import BLOCK, FALLEN, MISSING, SINGLE, ZIGZAG
from figures.lib import runs
from md.kernels.codes import C_Z, COSINE, ROW_COLUMNS, SINE, X, Z
from md.scene import from_tables, put

HALF, RODS, LOOKS = 4.25, 40, 400


def motion(kind: str, amplitude: float = 0.05) -> np.ndarray:
    """States (looks, rods, columns) of a row that bounces in one of the ways."""
    random, state = np.random.default_rng(4), np.zeros((LOOKS, RODS, ROW_COLUMNS))
    phase = 2 * np.pi * np.arange(LOOKS)[:, None] / 37
    turns = (-1.0) ** np.arange(RODS)
    shift = random.uniform(0, 2 * np.pi, RODS) if kind == "independent" else 0.0
    tilt = np.radians(9) + np.zeros((LOOKS, RODS))
    if kind == "leaning by turns":
        tilt += amplitude / HALF * turns
    if kind == "fallen":
        tilt[:, 0] = np.radians(175)
    state[..., SINE], state[..., COSINE] = np.sin(tilt), np.cos(tilt)
    state[..., Z] = HALF * np.cos(tilt) + 0.5 + 0.2 * np.sin(phase + shift)
    state[..., Z] += amplitude * turns * (kind == "standing by turns")
    state[..., C_Z] = 0.2 * np.cos(phase + shift)
    return state


def state_of(looks: np.ndarray) -> int:
    """State by the rule of the figure."""
    found = dict(zip(row_motion.SEEN, row_motion.seen(looks, HALF), strict=True))
    return int(states.states(found))


@pytest.mark.parametrize(
    ("kind", "state"),
    [
        ("together", BLOCK),
        ("independent", SINGLE),
        ("standing by turns", ZIGZAG),
        ("leaning by turns", ZIGZAG),
        ("fallen", FALLEN),
    ],
)
def test_the_state_of_a_made_up_row(kind, state):
    assert state_of(motion(kind)) == state


def test_a_zigzag_too_small_to_be_seen_is_a_block():
    assert state_of(motion("standing by turns", 1e-3)) == BLOCK


def test_departures_are_those_of_the_rods_from_the_row():
    """Of the mean height and tilt nothing is left; neighbours by turns are opposite."""
    found = row_motion.seen(motion("standing by turns"), HALF)
    common, spread, order, tilt_spread, _, tilt_deg, _ = found
    assert common == pytest.approx(1)
    assert (spread, order) == pytest.approx((0.05, -1))
    assert tilt_spread == pytest.approx(0, abs=1e-12)
    assert tilt_deg == pytest.approx(9)
    assert row_motion.seen(motion("independent"), HALF)[0] < 0.1
    np.testing.assert_allclose(
        row_motion.lower_ends(motion("standing by turns"), HALF)[0, 1], -0.05
    )


def test_a_run_has_the_state_of_its_second_half():
    """As most parts of it; a change in the first half does not count, a missing run has none."""
    runs = [[2, 2, 2, 0, 0, 0], [0, 0, 0, 0, 1, 1], [1, 1, 1, 2, 2, 0], [MISSING] * 6]
    state, changed = states.settled(np.array(runs))
    assert state.tolist() == [BLOCK, ZIGZAG, SINGLE, MISSING]
    assert changed.tolist() == [False, True, True, False]
    missing = {name: np.full((1, 6), np.nan) for name in row_motion.SEEN}
    assert (states.states(missing) == MISSING).all()


def test_a_life_is_the_time_in_a_state_for_each_time_it_was_left():
    """Three starts of one tilt in parts of 10 periods; what is never left lives for ever."""
    runs = np.array([[[0, 0, 2, 2, 2], [0, 2, 0, 0, 0], [2, 2, 2, 2, 2]]])
    times, exits = states.life_times(runs, window=10)
    assert exits.tolist() == [[2, 0, 1, 0]]
    assert times[0, BLOCK] == 10 * 5 / 2  # five parts begin in it, the last ones apart
    assert times[0, SINGLE] == 10 * 7
    assert np.isnan(times[0, [ZIGZAG, FALLEN]]).all()
    np.testing.assert_allclose(states.still_there(runs)[0], [1, 2 / 3, 1 / 3, 1 / 3, 1 / 3])


def test_a_box_that_changes_stretches_the_row():
    """Neither velocities nor the order of the rods change."""
    point = states.sweeps(True)["driven"].points[0]
    engine = row_motion.prepare(point.scene, ledger=False, touches=False)
    engine.go(engine.per)
    before = engine.rods.copy()
    row_motion.stretched(engine, 1.02 * point.scene.box.length)
    np.testing.assert_array_equal(engine.rods[:, X + 1 :], before[:, X + 1 :])
    box = engine.effects.period / point.scene.box.length
    np.testing.assert_allclose(engine.rods[:, X], box * before[:, X])


@pytest.mark.parametrize("ends", [(20.0, 26.0), (26.0, 20.0)], ids=["up", "down"])
def test_a_row_follows_its_box(ends, monkeypatch):
    monkeypatch.setattr(row_motion, "ENDS_DEG", ends)
    scene = from_tables(put(runs.ROW, {"box.length": runs.boxes(ends)[0]}))
    tilt = row_motion.driven(scene, 60)["tilt_deg"]
    np.testing.assert_allclose(tilt, np.linspace(*ends, 13)[1::2], atol=1)
