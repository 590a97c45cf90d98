"""The balance of a landing: touches made by the theory give its drift back, each error its step."""

from functools import partial

import numpy as np
import pytest

import md
from figures.checks import closure
from figures.checks.balance import ENOUGH, Landing, balanced, balancing, mean_drift, measures
from figures.lib import runs
from impact import ContactGeometry, collide, drift, thin_rod
from md.kernels import touches
from md.scene import from_tables

from .quick_figures import MOST_PERIODS, data

SCENE = from_tables(runs.ROW)
SPEED = SCENE.plate_speed
PER = 1000
TILTS_DEG = (8.0, 15.0, 30.0, 50.0)  # slip-stick, slip reversal


def touched(before, plate, rod, restitution=runs.RESTITUTION, kick=0.0, pushed=0.0, rods=5):
    """Touches as the map makes them, of rods in turn; kick: of c_x, beyond the map.

    Flights and touches last so long that each lies where the last one left.
    """
    n = len(before)
    rows = np.zeros((n, touches.WIDTH))
    how = {"friction": runs.FRICTION, "restitution": restitution, "plate_velocity": plate}
    hit = collide(*before.T, geometry=rod, **how)
    after = np.column_stack([hit.c_x + kick, hit.c_z, hit.omega])
    rows[:, touches.ROD] = np.arange(n) % rods
    rows[:, touches.STEP] = 100 * (np.arange(n) // rods)
    rows[:, touches.DURATION], rows[:, touches.FLIGHT] = 10, 90
    rows[:, touches.A_X], rows[:, touches.A_Z] = -rod.X, -rod.Z
    rows[:, touches.BEFORE : touches.AFTER] = before
    rows[:, touches.AFTER : touches.PLATE] = after
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


def known(found):
    """Measured values of the closure, as the figure takes them."""
    of = {name: np.array(found.get(name, (np.nan, np.nan))) for name in closure.MEANS}
    values = {name: float(value) for name, value in closure._closures(of).items()}
    return values | {"speed": SPEED}


def steps(found, tilt_deg):
    """Drifts after each step but the printed one."""
    first = closure.replaced(tilt_deg, known(found))[1 : closure.FIRST + len(closure.ASSUMED)]
    return np.array([*first, *(found[name] for name in closure.DISTRIBUTED)])


@pytest.mark.parametrize("tilt_deg", TILTS_DEG)
def test_touches_of_the_closure_itself_give_its_drift_at_every_step(tilt_deg):
    rod = runs.paper_rod(np.radians(tilt_deg))
    theory = drift(rod, **runs.SETTING, plate_velocity=SPEED / 2)
    before = np.tile([theory.c_x, -theory.c_z, 0.0], (2 * ENOUGH, 1))
    found = measures(touched(before, SPEED / 2, rod), SCENE, PER)
    np.testing.assert_allclose(steps(found, tilt_deg), theory.c_x, rtol=1e-9)
    assert found["isolated"] == pytest.approx(found["isolated_pushed"], rel=1e-9)
    printed = closure.replaced(tilt_deg, known(found))[0]
    thin = drift(thin_rod(np.radians(tilt_deg)), **runs.SETTING, plate_velocity=SPEED / 2)
    assert printed == pytest.approx(thin.c_x, rel=1e-9)


@pytest.mark.parametrize("name", closure.ASSUMED)
def test_an_assumption_moves_its_own_curve_and_no_earlier_one(name):
    """Of a mean landing: together with the ones before it, and by itself."""
    true = {**closure.ASSUMED, "V_z": SPEED / 2, "speed": SPEED}
    other = {"V_z": 0.7 * SPEED, "turned": 0.4, "gain": 0.02, "spin": 0.01, "restitution": 0.5}
    found = np.array(closure.replaced(30.0, true | {name: other[name]}))
    rest = np.array(closure.replaced(30.0, true))
    together, single = np.split(found - rest, [closure.FIRST + len(closure.ASSUMED)])
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
    found = measures(touched(before, plate, rod), SCENE, PER)
    *_, restitution, each, soft, pushed, _ = steps(found, tilt_deg)
    assert abs(steps(found, tilt_deg)[0] / pushed - 1) > 0.1
    np.testing.assert_allclose([restitution, each, soft], pushed, rtol=1e-9)


@pytest.mark.parametrize("tilt_deg", TILTS_DEG)
def test_pushes_are_left_to_the_last_but_one_step(tilt_deg):
    """What the map misses in all touches alike is the contact's, the rest the pushes'."""
    before, plate, rod = scattered(tilt_deg)
    pushed = np.arange(len(before)) % 2
    written = partial(touched, before, plate, rod, restitution=0.6)
    gain = np.diff(written()[:, [touches.BEFORE + 1, touches.AFTER + 1]])[:, 0]

    exact = measures(written(pushed=pushed), SCENE, PER)
    assert exact["each"] == pytest.approx(exact["pushed"], rel=1e-9)
    assert exact["isolated"] == pytest.approx(exact["isolated_pushed"], rel=1e-9)
    assert exact["alone"][0] == 0.5

    soft = measures(written(kick=0.01 * gain, pushed=pushed), SCENE, PER)
    assert abs(soft["each"] - soft["pushed"]) > 1e-3 * SPEED
    assert soft["soft"] == pytest.approx(soft["pushed"], rel=1e-9)

    kick = 0.01 * gain * pushed
    kicked = measures(written(kick=kick, pushed=pushed), SCENE, PER)
    assert abs(kicked["soft"] - kicked["pushed"]) > 1e-3 * SPEED
    assert kicked["soft"] == pytest.approx(kicked["each"], rel=1e-9)
    assert kicked["isolated"] == pytest.approx(kicked["isolated_pushed"], rel=1e-9)


def test_restitution_is_that_of_unpushed_touches_where_there_are_enough():
    before, plate, rod = scattered(30.0, 4 * ENOUGH)
    for few, expected in ((ENOUGH, 0.6), (ENOUGH - 1, None)):
        pushed = np.arange(len(before)) >= few
        rows = touched(before, plate, rod, np.where(pushed, 0.4, 0.6), pushed=pushed)
        found = measures(rows, SCENE, PER)
        if expected is None:
            expected = rows[:, touches.LEAVING].sum() / -rows[:, touches.APPROACH].sum()
            assert np.isnan(found["isolated"])
            assert found["soft"] == found["each"]
        assert found["restitution"][0] == pytest.approx(expected)


def test_errors_are_over_the_periods_in_which_there_were_touches():
    before, plate, rod = scattered(30.0, 600)  # five in each of 120 periods
    rows = touched(before, plate, rod)
    found = measures(rows, SCENE, 100)
    rows[:, touches.STEP] += 2400
    assert measures(rows, SCENE, 100) == found
    mean, error = found["V_z"]
    assert mean == pytest.approx(plate.mean())
    assert error == pytest.approx(plate.std() / np.sqrt(len(plate)), rel=0.3)


def test_time_counts_each_flight_as_it_lasts():
    """One rod: slow in a long flight, fast in a short one."""
    rows = np.zeros((3, touches.WIDTH))
    rows[:, touches.STEP] = 1000, 3000, 4000
    rows[:, touches.DURATION], rows[:, touches.FLIGHT] = 100, (np.nan, 1900, 900)
    rows[:, touches.BEFORE], rows[:, touches.AFTER] = (0, 0.1, 0.3), (0.1, 0.3, 0.3)
    rows[:, touches.BEFORE + 1], rows[:, touches.AFTER + 1] = -0.5, 0.3
    rows[:, [touches.A_X, touches.A_Z]] = -1.5, -4.0
    rows[:, touches.APPROACH], rows[:, touches.LEAVING] = -0.5, 0.3
    rows = np.concatenate([rows, [[1, *rows[-1, 1:]]]])  # a second rod, of one touch
    found = measures(rows, SCENE, PER)
    way = 900 * 0.3 + 100 * (0.2 + 0.3 + 0.3)  # behind the first touch that ended a flight
    assert found["in_time"] == pytest.approx(way / (900 + 3 * 100))


def test_no_balance_that_friction_cannot_keep():
    rod = ContactGeometry(1.0, 4.0, 2.7)
    one = Landing(0.0, -0.5, 0.0, 0.1, rod, 0.3, 0.65)
    most = 0.3 * float(collide(50.0, -0.6, geometry=rod, friction=0.3, restitution=0.65).P_z)
    assert np.isfinite(balancing(one, -0.99 * most))
    assert np.isnan(balancing(one, -1.01 * most))
    assert np.isnan(mean_drift(rod, 0.3, restitution=0.65, V_z=0.1, gain=-10.0))


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
    rows = [balanced(scene, MOST_PERIODS) for scene in scenes]
    for name in closure.DISTRIBUTED:
        mean = np.mean([row[name] for row in rows]) * SCENE.cm_per_s
        assert d["step"][[*closure.STEPS].index(name), 0] == pytest.approx(mean)
