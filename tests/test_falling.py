"""The rod that keeps its spin: impacts, energy, toppling, and that it ends."""

from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import impact
from impact.bouncing import record
from impact.falling import Falls, _Free, _loop, fall
from impact.flight import TURN

PAPER = {"friction": 0.3, "restitution": 0.65}
UNIT = 981 / (2 * pi * 60) ** 2  # g/Omega^2 at 60 Hz, cm
ROD = {"length": 5.7 / UNIT, "diameter": 0.6 / UNIT}
STEP = 1e-3 * TURN


# Landings


@pytest.mark.parametrize("law", ["newton", "poisson", "stronge"])
@pytest.mark.parametrize(("tilt_deg", "gamma"), [(3, 3.3), (-20, 2.0), (40, 5.0)])
def test_landings_follow_from_one_another(law, tilt_deg, gamma):
    """Every impact again from `impact.collide`, every flight from the parabola and the turn."""
    run = fall(radians(tilt_deg), **ROD, gamma=gamma, **PAPER, law=law, rods=30)
    there = ~np.isnan(run.phase)
    np.testing.assert_array_equal(there.sum(1), run.landings)
    plate = gamma * np.cos(run.phase)
    hit = impact.collide(
        *(gamma * run.c_x, gamma * run.c_z, run.omega),
        geometry=_tip(run.tilt),
        **PAPER,
        plate_velocity=plate,
        law=law,
    )
    for got, exact in (
        (gamma * run.c_x_after, hit.c_x),
        (gamma * run.c_z_after, hit.c_z),
        (run.omega_after, hit.omega),
    ):
        np.testing.assert_allclose(got[there], exact[there], atol=1e-12)
    np.testing.assert_array_equal(run.regime, hit.regime)

    flown = there[:, 1:] & (run.rest[:, 1:] == 0)
    assert flown.any()
    t = TURN * run.flight[:, 1:]
    fallen = gamma * run.c_z_after[:, :-1] * t - t * t / 2
    z = gamma * np.sin(run.phase) + _tip(run.tilt).Z
    for change, exact in (
        (run.c_x[:, 1:], run.c_x_after[:, :-1]),
        (run.omega[:, 1:], run.omega_after[:, :-1]),
        (gamma * run.c_z[:, 1:], gamma * run.c_z_after[:, :-1] - t),
        (run.tilt[:, 1:], run.tilt[:, :-1] + run.omega_after[:, :-1] * t),
        (np.diff(z), fallen),
    ):
        np.testing.assert_allclose(change[flown], exact[flown], atol=1e-10)
    clock = run.period + run.phase / TURN
    np.testing.assert_allclose(
        np.diff(clock)[there[:, 1:]], (run.flight + run.rest)[:, 1:][there[:, 1:]], atol=1e-11
    )
    assert np.all(run.flight[there] >= 1e-3)


def _tip(tilt):
    return impact.spherocylinder(np.where(np.isnan(tilt), 0, tilt), **ROD)


def test_a_sphere_bounces_as_under_the_closure():
    """X = 0: spin changes neither landings nor c_z. So it is for the rod upright, friction 0."""
    setting = {"gamma": 1.6, "restitution": 0.5, "rods": 20, "shortest_flight": 1e-3}
    sphere = {"length": 2.0, "diameter": 2.0}
    for friction, tilt, size in ((0.3, 0.3, sphere), (0.0, 0.0, ROD)):
        rod = impact.spherocylinder(tilt, **size)
        closure = record(rod, friction=friction, **setting, landings=60)
        run = fall(tilt, **size, friction=friction, **setting, landings=50, transient=110)
        assert not run.fallen.any()
        flown = np.cumsum(run.rest > 0, axis=1) == 0  # up to the first rest
        assert flown.sum() > 300
        for name in ("phase", "c_z", "c_z_after", "flight"):
            got, exact = getattr(run, name), getattr(closure, name)[:, 10:]
            np.testing.assert_allclose(got[flown], exact[flown], atol=1e-7)


def test_phase_after_a_million_periods():
    """An upright rod on a stable orbit of one period: cos(theta) = pi (1 - e)/((1 + e) gamma)."""
    gamma, restitution, out = 1.3, 0.5, np.full((1_000_000, 12), np.nan)
    exact = np.arccos(pi * (1 - restitution) / ((1 + restitution) * gamma))
    start = (exact, 2 * pi * restitution / (1 + restitution) + 1e-3, 0.0, 0.0)
    free = _Free(gamma, 300.0, 40.0, 200.0, 0.3, restitution, STEP, 1e9)
    fallen, landings, *_ = _loop("newton")(start, free, out)
    assert (fallen, landings) == (False, 1_000_000)
    assert np.abs(out[1000:, 1] - exact).max() < 1e-14 * TURN
    np.testing.assert_array_equal(np.diff(out[:, 0]), 1)


# Energy, plate at rest


def _energies(out, reach, k):
    """Energy per unit mass before and after every landing; the cap's radius left out."""
    z = reach * np.cos(out[:, 2])
    return [
        z + (out[:, i] ** 2 + out[:, i + 1] ** 2 + (k * out[:, i + 2]) ** 2) / 2 for i in (3, 6)
    ]


def _thrown(random):
    """Random reach of a rod's centre, and a start: height, velocity, spin and tilt."""
    reach = 10 ** random.uniform(-1, 2)
    return reach, (0.0, random.uniform(1, 3), random.normal(), random.uniform(-1.5, 1.5))


def test_energy_is_kept_without_losses():
    random, landings = np.random.default_rng(2), 0
    for _ in range(200):
        out, (reach, start) = np.full((100, 12), np.nan), _thrown(random)
        k = reach / sqrt(3)
        _, n, *_ = _loop("newton")(start, _Free(0.0, reach, 0.0, k, 0.0, 1.0, STEP, 1e4), out)
        before, after = _energies(out[:n], reach, k)
        landings += n
        np.testing.assert_allclose(after, before, rtol=1e-13)
        flown = out[1:n, 10] == 0
        np.testing.assert_allclose(before[1:][flown], after[:-1][flown], rtol=1e-13)
    assert landings > 200


@pytest.mark.parametrize("law", ["poisson", "stronge"])
def test_energy_never_grows(law):
    """Not in an impact, not in flight; at rest by no more than the time step's error."""
    random = np.random.default_rng(4)
    for _ in range(200):
        out, (reach, start) = np.full((200, 12), np.nan), _thrown(random)
        cap, k = 0.1 * reach, 0.6 * reach
        losses = random.choice([0, 0.3, 1, 5, 1e60]), random.uniform(0, 1)
        _, n, *_ = _loop(law)(start, _Free(0.0, reach, cap, k, *losses, STEP, 1e4), out)
        before, after = _energies(out[:n], reach, k)
        assert np.all(after <= before * (1 + 1e-13))
        allowed = np.where(out[1:n, 10] > 0, STEP * reach, 1e-12 * before[1:])
        assert np.all(before[1:] - after[:-1] <= allowed)


# Toppling


def _pivot(tilt, reach, k, slides):
    """Periods in which a rod on a plate at rest topples, its tip held or without friction."""

    def turn(_, state):
        phi, omega = state
        X, Z = reach * sin(phi), reach * cos(phi)
        press = (1 - omega**2 * Z) / (1 + (X / k) ** 2)
        return [omega, X * press / k**2 if slides else X / (k * k + reach * reach)]

    def flat(_, state):
        return state[0] - pi / 2

    flat.terminal = True
    return solve_ivp(turn, (0, 1e4), [tilt, 0], events=flat, rtol=1e-10, atol=1e-12).t[-1] / TURN


@pytest.mark.parametrize(("friction", "slides"), [(0.0, True), (np.inf, False)])
def test_topples_as_a_pendulum(friction, slides):
    """On a plate all but at rest; the error falls with the time step, to first order."""
    length, tilt = 300.0, radians(20)
    exact = _pivot(tilt, length / 2, length / sqrt(12), slides)
    errors = []
    for step in (4e-3, 1e-3):
        run = fall(
            tilt,
            **{"length": length, "gamma": 1e-9, "friction": friction, "restitution": 0.5},
            shortest_flight=step,
        )
        assert run.fallen.all()
        assert run.landings == 0
        errors.append(abs(run.time[0] - exact))
    assert errors[1] < errors[0] / 3
    assert errors[1] < 4e-3


def test_mirror_symmetry():
    """Bit for bit: tilt, c_x and spin change sign together."""
    flips = np.ones(12)
    flips[[2, 3, 5, 6, 8]] = -1
    for tilt_deg in (0.0, 1.0, 20.0, 50.0):
        rows = np.full((2, 200, 12), np.nan)
        free = _Free(3.3, 370.0, 43.0, 230.0, 0.3, 0.65, STEP, 1000.0)
        ends = [
            _loop("newton")((2.0, 4.0, side * 1.3, side * radians(tilt_deg)), free, row)
            for side, row in zip((1, -1), rows, strict=True)
        ]
        np.testing.assert_array_equal(rows[0], flips * rows[1])
        np.testing.assert_array_equal(ends[0], np.array([1, 1, 1, -1, -1]) * ends[1])


# It ends


@pytest.mark.parametrize("law", ["newton", "poisson", "stronge"])
def test_any_rod_ends(law):
    """Short and long rods, jammed contacts, no losses, a plate that never throws: all finite."""
    random = np.random.default_rng(6)
    for seed in range(150):
        length = 10 ** random.uniform(0, 4)
        run = fall(
            random.uniform(-pi / 2, pi / 2),
            length=length,
            diameter=random.choice([0, 0.1, 0.5]) * length,
            gamma=10 ** random.uniform(-2, 1.5),
            friction=random.choice([0, 0.1, 1, 10, np.inf]),
            restitution=random.choice([0, 0.5, 1]),
            **{"law": law, "seed": seed, "transient": 20, "periods": 100, "rods": 2},
            shortest_flight=0.01,
        )
        for column in run[1:5]:
            assert np.all(np.isfinite(column))
        held = np.arange(500) < run.landings[:, None]
        for column in run[5:-1]:
            np.testing.assert_array_equal(np.isfinite(column), held)
        np.testing.assert_array_equal(run.regime >= 0, held)


@pytest.mark.parametrize("gamma", [0.5, 1.1, 3.3])
@pytest.mark.parametrize("tilt_deg", [0.5, 20.0, -60.0])
def test_every_rod_of_the_paper_falls_the_way_it_leans(tilt_deg, gamma):
    run = fall(radians(tilt_deg), **ROD, gamma=gamma, **PAPER, rods=100)
    assert run.fallen.all()
    assert np.all(run.landings < 500)
    side = np.sign(tilt_deg) if gamma < 1 or abs(tilt_deg) > 1 else np.sign(run.tilt_end)
    assert np.all(side * run.tilt_end > radians(89))
    assert np.all(run.time > 1)


def test_an_upright_rod_need_not_fall():
    still = fall(0.0, **ROD, gamma=0.9, **PAPER, periods=5.0)
    assert not still.fallen.any()
    assert still.landings == 0
    assert still.time == pytest.approx(5, abs=1.001)
    bouncing = fall(0.0, **ROD, gamma=3.0, friction=0.0, restitution=0.5, landings=30)
    assert (bouncing.fallen[0], bouncing.landings[0]) == (False, 30)
    for tilt in (pi / 2, np.float32(pi / 2)):
        assert fall(tilt, **ROD, gamma=0.9, **PAPER).time == pytest.approx(0, abs=0.002)


def test_rods_do_not_depend_on_their_number():
    few, many = (fall(0.2, **ROD, gamma=2.7, **PAPER, seed=9, rods=rods) for rods in (2, 5))
    for name in Falls._fields:
        np.testing.assert_array_equal(getattr(few, name), getattr(many, name)[:2])
    assert np.unique(many.time).size == 5
    other = fall(0.2, **ROD, gamma=2.7, **PAPER, seed=10, rods=2)
    assert not np.any(other.time == few.time)


def test_travel_is_that_of_the_landings():
    """Distance by the velocities between landings, and the last stretch to the fall."""
    run = fall(radians(5), **ROD, gamma=3.3, **PAPER, rods=40)
    last = np.take_along_axis(run.c_x_after, run.landings[:, None] - 1, 1)[:, 0]
    left = run.time - np.nansum(run.flight + run.rest, axis=1)
    moved = np.nansum(run.c_x * run.flight, axis=1) + last * left
    flown = np.nansum(run.rest, axis=1) == 0
    assert flown.sum() > 10
    np.testing.assert_allclose(run.travel[flown], moved[flown], rtol=1e-9)
