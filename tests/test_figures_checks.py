"""Figures of the checks: readings of Appendix A, touches one by one, states and sizes of rows."""

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import solve_ivp

import md
from figures.checks import (
    closure,
    landing_census,
    rigid_limit,
    row_motion,
    row_size,
    states,
    two_codes,
)
from figures.checks.census import census, compared, measures
from figures.checks.states import BLOCK, FALLEN, MISSING, SINGLE, ZIGZAG
from figures.lib import runs
from impact import ContactGeometry, Regime, classify, collide, drift, spherocylinder, thin_rod
from md.kernels import C_Z, COSINE, ROW_COLUMNS, SINE, Z, touches
from md.scene import from_tables, put

from .quick_figures import (
    MOST_PERIODS,
    check_figure,
    data,
    each_of,
    thick,
    tiny,
    watched_engine,
)
from .rows import HALF


@each_of("checks")
def test_every_figure(name):
    check_figure(name)


# One soft impact


def head_on(normal_force):
    """Restitution of m d'' = -F(d, d'), m = 1, by a general-purpose solver."""

    def ends(t, y):
        return min(normal_force(*y), y[0]) if t > 1e-6 else 1.0

    ends.terminal = True
    done = solve_ivp(
        lambda t, y: (y[1], -normal_force(*y)),
        (0, 0.1),
        (0.0, 1.0),
        rtol=1e-10,
        atol=1e-13,
        events=ends,
        max_step=1e-5,
    )
    return -done.y[1, -1]


def test_restitution_of_readings_head_on():
    """Of the printed law and of the one without the overlap's factor, for the rod and M/2.

    The figure's impacts have friction, which turns the rod a little even at tilt 0.
    """
    d = data("appendix_a")
    printed = head_on(lambda x, v: 5e6 * abs(x) ** 1.5 + 200 * x * v)
    plain = head_on(lambda x, v: 5e6 * abs(x) ** 1.5 + 200 * v)
    found = d["restitution"][:, 0, 0, 0]
    assert_allclose(found, [printed, plain, plain], atol=3e-4)


def test_no_reading_does_what_the_paper_says():
    """The printed law's spring is soft and undamped: stiffness and damping each bring it nearer."""
    d = data("appendix_a")
    assert np.all(d["compared"][0, ..., 1] > 0.1)  # as printed
    assert np.all(d["compared"][2, ..., 1] < 0.03)  # the units' reading: near the rigid theory
    for axis in (0, 1):
        assert np.all(np.diff(d["why"], axis=axis) < 0)
    stiff = d["why"][0, -3:]
    assert_allclose(stiff[1:] / stiff[:-1], 10**-0.5, rtol=0.25)


def test_errors_fall_with_stiffness_and_those_of_springs_with_the_root_of_their_ratio():
    """Coulomb's as k_n^(-2/5), located as with steps; stiffness alone does not help springs."""
    d = data("rigid_limit")
    expected = [(d["slope"], -0.4), *((slope, -0.5) for slope in d["slope_by_ratio"][1:])]
    for (slope, error), power in expected:
        assert abs(slope - power) < max(3 * error, 2e-3)
    assert_array_equal(d["right"][0], 17)
    assert_allclose(d["located"], d["error"][0, ::3], rtol=2e-3)
    assert d["error"][0, -1] < 1e-6
    assert np.all(d["half_step"] < 2e-2)
    assert d["error"][list(rigid_limit.BY_STIFFNESS).index("Appendix A")].min() > 0.1
    _, damped, undamped = d["error_by_ratio"]
    assert np.all(undamped > 2.5 * damped)


# Touches beside the impact map

SETTINGS = ["contacts.plate.law=coulomb", "contacts.rods.tangential_ratio=5"]


def touched(before, plate, rod, restitution, pushed=0.0):
    """Touches as the map makes them, of four rods in turn, one every 100 steps."""
    rows = np.zeros((len(before), touches.WIDTH))
    hit = collide(
        *before.T,
        geometry=rod,
        friction=runs.FRICTION,
        restitution=restitution,
        plate_velocity=plate,
    )
    rows[:, touches.BEFORE : touches.PLATE] = np.column_stack([before, *hit[:3]])
    for at, value in {
        touches.STEP: 100 * (1 + np.arange(len(before)) // 4),
        touches.A_X: -rod.X,
        touches.A_Z: -rod.Z,
        touches.PLATE: plate,
        touches.PUSHED: pushed,
        touches.REGIME: hit.regime,
        touches.APPROACH: before[:, 1] + before[:, 2] * rod.X - plate,
        touches.LEAVING: hit.normal_velocity,
    }.items():
        rows[:, at] = value
    return rows


@pytest.mark.parametrize(("kick", "duration"), [(0, 0), (0.01, 0), (0, 50)])
def test_what_the_map_makes_is_found_without_error(kick, duration):
    """Arms, signs, plate velocity and restitution, for both ends of the rod.

    A turn about the contact point, which the plate cannot give, is found as it was given, and the
    map misses by no less; gravity during the contact is no such kick.
    """
    scene = md.load("single_rod", [] if duration else ["gravity=none"])
    # The last stands on its other end, at a tilt of 130 degrees.
    rod = spherocylinder(np.radians([20, 40, -35, -50]), scene.rods.length)
    before = np.array([[0.5, -1, 0], [0.1, -0.9, 0], [0.9, -0.2, -0.05], [0.4, -1, 0.02]])
    plate, restitution = scene.plate_speed * np.sin(np.pi / 5), np.array([0.65, 0.3, 0.9, 0])
    rows = touched(before, plate, rod, restitution)
    # In the direction that no force at the contact point can move.
    turn = np.array([rod.Z, -rod.X, np.ones(4)]) / np.sqrt(rod.X**2 + rod.Z**2 + rod.k**2)
    rows[:, touches.AFTER : touches.PLATE] += kick * turn.T
    rows[:, touches.STEP] -= duration
    rows[:, touches.DURATION] = duration
    rows[:, touches.AFTER + 1] -= duration * 1e-4
    found = compared(rows, scene, 1e-4, 1000)
    assert_allclose(found["kick"], kick, rtol=1e-12, atol=1e-14)
    assert np.all(found["residual"] >= kick * (1 - 1e-12))
    if not (kick or duration):
        assert_allclose([found["residual"], found["allowed"]], 0, atol=1e-14)
        assert_allclose(found["restitution"], restitution, atol=1e-14)
        assert_array_equal(found["mapped"], found["seen"])
        assert set(found["seen"]) == {1, 2, 3}


def test_isolated_touches_of_a_row_follow_the_map_and_pushed_ones_do_not():
    """Of 500 at most one has an error below half of what other rods gave.

    Twenty rods at 33 degrees, friction of the plate as a constraint.
    """
    settings = ["rods.count=20", "box.length=24", "step.size=none"]
    with tiny():
        row, _ = census(md.load("quasi2d", settings + SETTINGS), 125)
    found, alone = {name: mean for name, (mean, _) in measures(row).items()}, row.isolated
    assert alone.sum() > 100
    assert found["isolated_residual"] < 0.06
    assert found["isolated_allowed"] < 3e-4
    assert found["isolated_kick"] < 1e-3
    assert np.mean((row.mapped == row.seen)[alone]) > 0.96
    assert 0.6 < found["shared"] < 0.95
    assert found["pushed_residual"] > 5 * found["isolated_residual"]
    assert found["pushed_allowed"] > 0.2
    assert found["pushed_kick"] > 100 * found["isolated_kick"]
    some = row.duration < 0.1  # longer, and gravity weighs more than the impact
    assert np.mean(row.residual[some] > 0.5 * row.kick[some]) > 0.998
    assert found["shared"] == pytest.approx(row.jump[~alone].sum() / row.jump.sum())
    shares = [found[f"pushed_{name}"] for name in ("slide", "stick", "reversal")]
    assert sum(shares) == pytest.approx(1, abs=1e-12)


def test_the_data_are_those_of_the_census():
    """Shares of the touches; where nothing was isolated, nan; reversal begins at the line drawn."""
    d = data("landing_census")
    scene = md.load("quasi2d", ["step.size=none", *SETTINGS, "plate.acceleration=2"])
    with tiny():
        assert d["gamma_slide"][0] == measures(census(scene, MOST_PERIODS)[0])["slide"][0]
    assert np.isnan(d["constraint_isolated_residual"][0])
    beside = thick(np.radians(landing_census.reversal_tilt() + np.array([-0.1, 0.1])))
    regimes = classify(0.1, -1.0, geometry=beside, friction=0.3, restitution=0.65)
    assert regimes.tolist() == [Regime.SLIP_STICK, Regime.SLIP_REVERSAL]


# The balance of a mean landing

SPEED = from_tables(runs.ROW).plate_speed
CLOSURE = {**runs.SETTING, "plate_velocity": SPEED / 2}


def scattered(tilt_deg, n=400):
    """States before touches, near the theory's, all of which approach the plate."""
    rod, random = runs.paper_rod(np.radians(tilt_deg)), default_rng(1)
    mean = drift(rod, **CLOSURE)
    middle = 1.2 * mean.c_x, -0.8 * mean.c_z, 0.01
    before = random.normal(middle, (0.02, 0.05, 0.005), (n, 3))
    return before, SPEED * random.uniform(0.5, 0.8, n), rod


def steps(rows, tilt_deg):
    """Drifts after each step of the figure."""
    means = {name: np.array(mean) for name, mean in closure.measures(rows).items()}
    drifts = closure.drifts(np.array(tilt_deg), SPEED, closure.closures_of(means))
    return drifts[: len(closure.STEPS)]


@pytest.mark.parametrize("tilt_deg", [15.0, 30.0], ids=["slip-stick", "slip reversal"])
def test_touches_of_the_closure_itself_give_its_drift_at_every_step(tilt_deg):
    tilt = np.radians(tilt_deg)
    rod = runs.paper_rod(tilt)
    theory = drift(rod, **CLOSURE)
    before = np.tile([theory.c_x, -theory.c_z, 0.0], (2 * closure.ENOUGH, 1))
    printed, *others = steps(touched(before, SPEED / 2, rod, runs.RESTITUTION), tilt_deg)
    assert_allclose(others, theory.c_x, rtol=1e-9)
    assert printed == pytest.approx(drift(thin_rod(tilt), **CLOSURE).c_x, rel=1e-9)


@pytest.mark.parametrize("name", closure.ASSUMED)
def test_an_assumption_moves_its_own_curve_and_no_earlier_one(name):
    """Of a mean landing: together with the ones before it, and by itself."""
    true = {**closure.ASSUMED, "V_z": SPEED / 2, "speed": SPEED}
    other = {"V_z": 0.7 * SPEED, "turned": 0.4, "gain": 0.02, "spin": 0.01, "restitution": 0.5}
    changed = true | {name: other[name]}
    apart = np.subtract(*(closure.replaced(30.0, known) for known in (changed, true)))
    together, single = np.split(apart, [len(closure.STEPS)])
    at = [*closure.ASSUMED].index(name)
    assert np.all(together[: closure.FIRST + at] == 0)
    moved = together[closure.FIRST + at :]
    assert np.all(np.abs(moved) > 1e-3 * SPEED)
    assert_allclose(moved, moved[0], rtol=1e-9)
    assert np.flatnonzero(single).tolist() == [at]


def test_where_the_contact_sticks_the_mean_landing_is_the_mean_of_the_landings():
    """However the touches scatter: with all means known, the drift at the touches comes out."""
    rows = touched(*scattered(15.0), runs.RESTITUTION)
    _, assumed, *_, last = steps(rows, 15.0)
    at_touches = rows[:, [touches.BEFORE, touches.AFTER]].mean()
    assert abs(assumed / at_touches - 1) > 0.1
    assert last == pytest.approx(at_touches, rel=1e-9)


def test_restitution_is_that_of_unpushed_touches_where_there_are_enough():
    before, plate, rod = scattered(30.0, 4 * closure.ENOUGH)
    for few in (closure.ENOUGH, closure.ENOUGH - 1):
        pushed = np.arange(len(before)) >= few
        rows = touched(before, plate, rod, np.where(pushed, 0.4, 0.6), pushed)
        of_all = rows[:, touches.LEAVING].sum() / -rows[:, touches.APPROACH].sum()
        expected = 0.6 if few == closure.ENOUGH else of_all
        assert closure.measures(rows)["restitution"] == pytest.approx(expected)


def test_no_balance_that_friction_cannot_keep():
    """The most it gives is 0.3 P_z, P_z = 2 c_z', which depends on the gain itself."""
    rod, given = ContactGeometry(1.0, 4.0, 2.7), {"restitution": 0.65, "V_z": 0.1}
    x_z, inverse = 4.0 / 2.7**2, 0.6 / (1 - 0.65 + 2 / 2.7**2)
    most = inverse * 1.65 * 0.1 / (1 + inverse * x_z)
    assert np.isfinite(closure.mean_drift(rod, 0.3, **given, gain=-0.99 * most))
    assert np.isnan(closure.mean_drift(rod, 0.3, **given, gain=-1.01 * most))


def test_the_figure_holds_what_a_run_measures():
    """Means over the starts, in cm/s; a curve for each step; what is left is over the row."""
    d = data("closure")
    scenes = [point.scene for point in closure.sweeps(True)["tilt"].points[:2]]  # starts
    with tiny():
        drifts = [closure.balanced(scene, MOST_PERIODS)["c_x_cm_s"] for scene in scenes]
    assert d["c_x"][0] == pytest.approx(np.mean(drifts))
    row = np.array([[3.0, 1.0], [4.0, 1.0]])  # over tilt, then starts
    off = row + np.array([[3.0, 0.0], [4.0, 1.0]])
    assert_allclose(closure.left(row, np.stack([row, off])), [[0, 0], [1, 0.5**0.5]])


# States of a row


def motion(apart=0.0, lean=0.0, rise=0.0, turn=0.0):
    """States (looks, rods, columns) of a row at 9 degrees that bounces as one, but for departures.

    Phases at random; tilts and heights of neighbours to either side; one rod that is turned over.
    """
    looks, rods = 400, 40
    phase = 2 * np.pi * np.arange(looks)[:, None] / 37
    phase = phase + apart * default_rng(4).uniform(0, 2 * np.pi, rods)
    by_turns = (-1.0) ** np.arange(rods)
    tilt = np.radians(9) + lean / HALF * by_turns + turn * (np.arange(rods) == 0)
    state = np.zeros((looks, rods, ROW_COLUMNS))
    state[..., SINE], state[..., COSINE] = np.sin(tilt), np.cos(tilt)
    state[..., Z] = HALF * np.cos(tilt) + 0.5 + 0.2 * np.sin(phase) + rise * by_turns
    state[..., C_Z] = 0.2 * np.cos(phase)
    return state


@pytest.mark.parametrize(
    ("departures", "state"),
    [
        ({}, BLOCK),
        ({"apart": 1}, SINGLE),
        ({"rise": 0.05}, ZIGZAG),
        ({"rise": 1e-3}, BLOCK),  # too small to be seen
        ({"lean": 0.05}, ZIGZAG),
        ({"turn": np.radians(166)}, FALLEN),
    ],
)
def test_the_state_of_a_made_up_row(departures, state):
    found = row_motion.seen(motion(**departures), HALF)
    assert states.states(dict(zip(row_motion.SEEN, found, strict=True))) == state


def test_a_run_has_the_state_of_its_second_half():
    """As most parts of it; a change in the first half does not count, a missing run has none."""
    of_parts = [[2, 2, 2, 0, 0, 0], [0, 0, 0, 0, 1, 1], [1, 1, 1, 2, 2, 0], [MISSING] * 6]
    state, changed = states.settled(np.array(of_parts))
    assert state.tolist() == [BLOCK, ZIGZAG, SINGLE, MISSING]
    assert changed.tolist() == [False, True, True, False]
    assert states.states(dict.fromkeys(row_motion.SEEN, np.nan)) == MISSING


def test_a_start_is_still_there_until_it_first_leaves_its_state():
    of_parts = np.array([[[0, 0, 2, 2, 2], [0, 2, 0, 0, 0], [2, 2, 2, 2, 2]]])
    assert_allclose(states.still_there(of_parts)[0], [1, 2 / 3, 1 / 3, 1 / 3, 1 / 3])


@pytest.mark.parametrize("ends", [(20.0, 26.0), (26.0, 20.0)], ids=["up", "down"])
def test_a_row_follows_its_box(ends, monkeypatch):
    monkeypatch.setattr(row_motion, "ENDS_DEG", ends)
    scene = from_tables(put(runs.ROW, {"box.length": runs.boxes(ends)[0]}))
    monkeypatch.setattr(row_motion, "prepare", watched_engine)
    tilt = row_motion.driven(scene, 60)["tilt_deg"]
    assert_allclose(tilt, np.linspace(*ends, 13)[1::2], atol=1)


# Sizes of a row


def test_a_followed_row_drifts_as_a_run_does():
    """The tiny runs of the figures, beside `md.run`."""
    scene = row_size.sweeps(True)["5"].points[0].scene
    result = md.run(scene, periods=8)
    with tiny():
        found, rods = row_motion.watched(scene, 8)
    assert_allclose(found["c_x"], result.c_x_series * scene.cm_per_s, rtol=1e-9)
    assert_array_equal(rods[:, Z], result.rods[:, Z])
    assert found["tilt_deg"] == pytest.approx(result.tilt_series, abs=0.5)


# Two programs


def test_the_table_of_the_other_program_is_of_whole_sets_of_starts():
    _, found = two_codes.other()
    assert found[:, 0, 1].tolist() == [7.07588, 0.53119, 0.91108, 1.26100]  # 18 degrees, seed 2
    assert_allclose(data("two_codes")["other_c_x"], found[0].mean(axis=-1))


def test_two_programs_give_one_answer(tmp_path, monkeypatch):
    """Within four errors; touches within 6 %, as each program ends a touch by a rule of its own."""
    monkeypatch.setattr(runs, "STORE", tmp_path / "rows.db")
    d = two_codes.data()
    for name in two_codes.MEASURED:
        apart = np.abs(d[name] - d[f"other_{name}"])
        error = np.hypot(d[f"{name}_error"], d[f"other_{name}_error"])
        alike = 0.06 * d[name] if name == "touches" else 0.0
        assert np.all(apart < alike + 4 * error)
