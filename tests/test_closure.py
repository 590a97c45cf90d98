"""The balance of a mean landing: touches made by the theory give its drift back."""

import numpy as np
import pytest

import md
from figures.checks import closure
from figures.checks.closure import ENOUGH, balanced, mean_drift, measures
from figures.lib import runs
from impact import ContactGeometry, collide, drift, thin_rod
from md.kernels import touches
from md.scene import from_tables

from .quick_figures import MOST_PERIODS, data

SCENE = from_tables(runs.ROW)
SPEED = SCENE.plate_speed
PER = 1000
TILTS_DEG = (8.0, 15.0, 30.0, 50.0)  # slip-stick, slip reversal


def touched(before, plate, rod, restitution=runs.RESTITUTION, pushed=0.0, rods=5):
    """Touches as the map makes them, of rods in turn."""
    n = len(before)
    rows = np.zeros((n, touches.WIDTH))
    how = {"friction": runs.FRICTION, "restitution": restitution, "plate_velocity": plate}
    hit = collide(*before.T, geometry=rod, **how)
    rows[:, touches.STEP] = 100 * (np.arange(n) // rods)
    rows[:, touches.BEFORE : touches.AFTER] = before
    rows[:, touches.AFTER : touches.PLATE] = np.column_stack([hit.c_x, hit.c_z, hit.omega])
    rows[:, touches.PLATE], rows[:, touches.PUSHED] = plate, pushed
    rows[:, touches.APPROACH] = before[:, 1] + before[:, 2] * rod.X - plate
    rows[:, touches.LEAVING] = hit.c_z + hit.omega * rod.X - plate
    return rows


def scattered(tilt_deg, n=400):
    """States before touches, near the theory's, all of which approach the plate."""
    rod, random = runs.paper_rod(np.radians(tilt_deg)), np.random.default_rng(1)
    mean = drift(rod, **runs.SETTING, plate_velocity=SPEED / 2)
    middle = (1.2 * mean.c_x, -0.8 * mean.c_z, 0.01)
    before = random.normal(middle, (0.02, 0.05, 0.005), (n, 3))
    return before, SPEED * random.uniform(0.5, 0.8, n), rod


def steps(found, tilt_deg):
    """Drifts after each step."""
    of = {name: np.array(found.get(name, (np.nan, np.nan))) for name in closure.MEANS}
    known = {name: float(value) for name, value in closure.closures_of(of).items()}
    return closure.replaced(tilt_deg, known | {"speed": SPEED})[: len(closure.STEPS)]


@pytest.mark.parametrize("tilt_deg", TILTS_DEG)
def test_touches_of_the_closure_itself_give_its_drift_at_every_step(tilt_deg):
    rod = runs.paper_rod(np.radians(tilt_deg))
    theory = drift(rod, **runs.SETTING, plate_velocity=SPEED / 2)
    before = np.tile([theory.c_x, -theory.c_z, 0.0], (2 * ENOUGH, 1))
    printed, *others = steps(measures(touched(before, SPEED / 2, rod), PER), tilt_deg)
    np.testing.assert_allclose(others, theory.c_x, rtol=1e-9)
    thin = drift(thin_rod(np.radians(tilt_deg)), **runs.SETTING, plate_velocity=SPEED / 2)
    assert printed == pytest.approx(thin.c_x, rel=1e-9)


@pytest.mark.parametrize("name", closure.ASSUMED)
def test_an_assumption_moves_its_own_curve_and_no_earlier_one(name):
    """Of a mean landing: together with the ones before it, and by itself."""
    true = {**closure.ASSUMED, "V_z": SPEED / 2, "speed": SPEED}
    other = {"V_z": 0.7 * SPEED, "turned": 0.4, "gain": 0.02, "spin": 0.01, "restitution": 0.5}
    found = np.array(closure.replaced(30.0, true | {name: other[name]}))
    rest = np.array(closure.replaced(30.0, true))
    together, single = np.split(found - rest, [len(closure.STEPS)])
    at = [*closure.ASSUMED].index(name)
    assert np.all(together[: closure.FIRST + at] == 0)
    moved = together[closure.FIRST + at :]
    assert np.all(np.abs(moved) > 1e-3 * SPEED)
    np.testing.assert_allclose(moved, moved[0], rtol=1e-9)
    assert np.flatnonzero(single).tolist() == [at]


@pytest.mark.parametrize("tilt_deg", TILTS_DEG[:2])
def test_where_the_contact_sticks_the_mean_landing_is_the_mean_of_the_landings(tilt_deg):
    """However the touches scatter: with all means known, the drift at the touches comes out."""
    before, plate, rod = scattered(tilt_deg)
    rows = touched(before, plate, rod)
    _, thick, *_, last = steps(measures(rows, PER), tilt_deg)
    at_touches = rows[:, [touches.BEFORE, touches.AFTER]].mean()
    assert abs(thick / at_touches - 1) > 0.1
    assert last == pytest.approx(at_touches, rel=1e-9)


def test_restitution_is_that_of_unpushed_touches_where_there_are_enough():
    before, plate, rod = scattered(30.0, 4 * ENOUGH)
    for few, expected in ((ENOUGH, 0.6), (ENOUGH - 1, None)):
        pushed = np.arange(len(before)) >= few
        rows = touched(before, plate, rod, np.where(pushed, 0.4, 0.6), pushed=pushed)
        found = measures(rows, PER)
        if expected is None:
            expected = rows[:, touches.LEAVING].sum() / -rows[:, touches.APPROACH].sum()
        assert found["restitution"][0] == pytest.approx(expected)
        assert found["alone"][0] == few / len(before)


def test_errors_are_over_the_periods_in_which_there_were_touches():
    before, plate, rod = scattered(30.0, 600)  # five in each of 120 periods
    rows = touched(before, plate, rod)
    found = measures(rows, 100)
    rows[:, touches.STEP] += 2400
    assert measures(rows, 100) == found
    mean, error = found["V_z"]
    assert mean == pytest.approx(plate.mean())
    assert error == pytest.approx(plate.std() / np.sqrt(len(plate)), rel=0.3)


def test_no_balance_that_friction_cannot_keep():
    """The most it gives is 0.3 P_z, P_z = 2 c_z', which depends on the gain itself."""
    rod, given = ContactGeometry(1.0, 4.0, 2.7), {"restitution": 0.65, "V_z": 0.1}
    x_z, inverse = 4.0 / 2.7**2, 0.6 / (1 - 0.65 + 2 / 2.7**2)
    most = inverse * 1.65 * 0.1 / (1 + inverse * x_z)
    assert np.isfinite(mean_drift(rod, 0.3, **given, gain=-0.99 * most))
    assert np.isnan(mean_drift(rod, 0.3, **given, gain=-1.01 * most))


def test_what_is_left_is_the_distance_over_the_row():
    row = np.array([[3.0, 1.0], [4.0, 1.0]])  # over tilt, then starts
    off = np.stack([row, row + np.array([[3.0, 0.0], [4.0, 1.0]])])
    np.testing.assert_allclose(closure.left(row, off), [[0, 0], [1, np.sqrt(0.5)]])


def test_the_figure_holds_what_a_run_measures():
    """Means over the starts, in cm/s; a curve for each step."""
    d = data("closure")
    assert d["step"].shape == (len(closure.STEPS), len(closure.QUICK_TILTS_DEG))
    np.testing.assert_allclose(d["nominal_deg"], closure.QUICK_TILTS_DEG)
    assert d["left"].shape == d["left_larger"].shape == (len(closure.STEPS),)
    scenes = [point.scene for point in closure.sweeps(True)["tilt"].points[:2]]  # starts
    drifts = [md.run(scene, periods=MOST_PERIODS).c_x for scene in scenes]
    assert d["drift"][0] == pytest.approx(np.mean(drifts) * SCENE.cm_per_s)
    alone = [balanced(scene, MOST_PERIODS)["alone"][0] for scene in scenes]
    assert d["alone"][0] == pytest.approx(np.mean(alone))
