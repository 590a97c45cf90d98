"""How large a row must be, and its states at small tilts: made-up motions and numbers."""

import numpy as np
import pytest

import md
from figures.checks import row_motion, row_size, small_tilts
from figures.checks.small_tilts import BLOCK, SINGLE, ZIGZAG
from md.kernels.codes import C_Z, COSINE, ROW_COLUMNS, SINE, Z

from .quick_figures import data

HALF, RODS, LOOKS = 4.25, 40, 400


def motion(kind: str, amplitude: float = 0.05) -> np.ndarray:
    """States (looks, rods, columns) of a row that bounces in one of the ways."""
    random, states = np.random.default_rng(4), np.zeros((LOOKS, RODS, ROW_COLUMNS))
    phase = 2 * np.pi * np.arange(LOOKS)[:, None] / 37
    turns = (-1.0) ** np.arange(RODS)
    shift = random.uniform(0, 2 * np.pi, RODS) if kind == "independent" else 0.0
    tilt = np.radians(9) + np.zeros((LOOKS, RODS))
    if kind == "leaning by turns":
        tilt += amplitude / HALF * turns
    states[..., SINE], states[..., COSINE] = np.sin(tilt), np.cos(tilt)
    states[..., Z] = HALF * np.cos(tilt) + 0.5 + 0.2 * np.sin(phase + shift)
    states[..., Z] += amplitude * turns * (kind == "standing by turns")
    states[..., C_Z] = 0.2 * np.cos(phase + shift)
    return states


def state_of(states: np.ndarray) -> int:
    """State by the rule of the figure."""
    found = dict(zip(row_motion.SEEN, row_motion.seen(states, HALF), strict=True))
    return int(small_tilts.states(found))


@pytest.mark.parametrize(
    ("kind", "state"),
    [
        ("together", BLOCK),
        ("independent", SINGLE),
        ("standing by turns", ZIGZAG),
        ("leaning by turns", ZIGZAG),
    ],
)
def test_the_state_of_a_made_up_row(kind, state):
    assert state_of(motion(kind)) == state


def test_a_zigzag_too_small_to_be_seen_is_a_block():
    assert state_of(motion("standing by turns", 1e-3)) == BLOCK


def test_departures_are_those_of_the_rods_from_the_row():
    """Of the mean height and tilt nothing is left; neighbours by turns are opposite."""
    found = row_motion.seen(motion("standing by turns"), HALF)
    common, spread, order, tilt_spread, _, tilt_deg = found
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
    runs = [[2, 2, 2, 0, 0, 0], [0, 0, 0, 0, 1, 1], [1, 1, 1, 2, 2, 0], [-1] * 6]
    state, changed = small_tilts.settled(np.array(runs))
    assert state.tolist() == [BLOCK, ZIGZAG, SINGLE, -1]
    assert changed.tolist() == [False, True, True, False]
    missing = {name: np.full((1, 6), np.nan) for name in small_tilts.FOLLOWED}
    assert (small_tilts.states(missing) == -1).all()


def test_the_tilt_is_shown_at_which_runs_differ_most_in_state():
    """The first of equals; states of two starts of three seeds each."""
    alike, few, many = [[0, 0, 0], [0, 0, 0]], [[0, 0, 1], [0, 0, 0]], [[0, 1, 2], [0, 0, 1]]
    assert small_tilts.most_mixed(np.array([alike, few, many, many])) == 2


def test_drifts_are_over_that_of_the_largest_row():
    c_x = np.array([[14.0, 9.0], [10.4, 12.0], [10.2, 9.0], [10.0, 10.0]])
    error = np.array([[0.1, 0.9], [0.1, 0.1], [0.1, 0.9], [0.1, 0.1]])
    part, off = row_size.over_largest({"c_x": c_x, "c_x_error": error})
    assert part[0] == pytest.approx([1.4, 0.9])
    assert off[0, 0] == pytest.approx(np.hypot(0.1, 1.4 * 0.1) / 10)
    assert np.isnan(off[-1]).all()


def test_rows_of_all_sizes_are_equally_dense():
    for count, sweep in row_size.sweeps().items():
        scenes = [point.scene for point in sweep.points]
        assert {scene.rods.count for scene in scenes} == {int(count)}
        tilts = sorted({round(float(np.degrees(scene.tilt)), 2) for scene in scenes})
        assert tilts == [*row_size.SIZE_TILTS_DEG[False]]
    work = {
        p.periods * int(n) * s.shape[-1] for n, s in row_size.sweeps().items() for p in s.points
    }
    assert len(work) == 1  # rods x starts x periods


def test_a_followed_row_drifts_as_a_run_does():
    """The tiny runs of the figures, beside `md.run`."""
    d = data("row_size")
    points = row_size.sweeps(True)["5"].points
    scene = points[0].scene
    result = md.run(scene, periods=8, ledger=False)
    found, rods = row_motion.watched(scene, 8)
    np.testing.assert_allclose(found["c_x"], result.c_x_series * scene.cm_per_s, rtol=1e-9)
    np.testing.assert_array_equal(rods[:, Z], result.rods[:, Z])
    assert found["tilt_deg"] == pytest.approx(result.tilt_series, abs=0.5)
    assert d["c_x"].shape == (3, 1)
    spread = np.mean([row_motion.averaged(point.scene, 8)["tilt_spread"] for point in points])
    assert d["spread_deg"][0, 0] == pytest.approx(np.degrees(spread / HALF))
