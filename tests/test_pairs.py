"""Impacts of two bodies: against a walk in impulse space, limits, symmetries, bad input."""

import numpy as np
import pytest
from mpmath import mpf
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal

from impact import Body, Regime, collide_pair

from .reference import reference_pair
from .sampling import EPS, each_law


def pairs(n, seed, decades=3.0, alike=0.0):
    """Bodies of masses, sizes and speeds over twice the decades; some share lever and speed."""
    rng = default_rng(seed)
    bodies, frictions = rng.uniform(-decades, decades, (2, 7, n)), rng.uniform(-decades, decades, n)
    mass, k, X, Z, c_x, c_z, omega = 10 ** bodies.swapaxes(0, 1)
    near = rng.uniform(size=n) < alike  # speeds and levers that cancel all but a little
    for part, little in ((X, 1e-15), (Z, 1e-15), (c_x, 1e-6), (c_z, 1e-6), (omega, 1e-6)):
        part *= rng.choice([-1, 1], (2, n))
        part[1] = np.where(near, part[0] * (1 + rng.choice([0, little], n)), part[1])
    omega[:, rng.uniform(size=n) < 0.1] = 0.0
    mass[1, rng.uniform(size=n) < 0.1] = np.inf
    x, z = X / k, Z / k
    A, B, C = ((part / mass).sum(0) for part in (1 + x * x, x * z, 1 + z * z))
    # friction at which the slip all but lasts, or the normal response vanishes
    edge = np.where(rng.uniform(size=n) < 0.5, A / np.abs(B), np.abs(B) / C)
    friction = np.where(near, edge * (1 + rng.choice([0, 1e-14, 1e-9], n)), 10**frictions)
    friction[rng.uniform(size=n) < 0.05] = np.inf
    first, second = (Body(*body) for body in zip(mass, k, X, Z, c_x, c_z, omega, strict=True))
    return first, second, {"friction": friction, "restitution": rng.uniform(0, 1, n)}


@each_law
@pytest.mark.parametrize("alike", [0.0, 0.99])
def test_impulses_are_those_of_a_walk_in_impulse_space(law, alike):
    """They are, over six decades, and where speeds, levers or responses cancel."""
    first, second, how = pairs(300, seed=41, alike=alike)
    hit = collide_pair(first, second, **how, law=law)
    found = np.array([hit.P_x, hit.P_z, hit.energy_change, *hit.first[4:], *hit.second[4:]])
    assert np.bincount(hit.regime, minlength=4).min() > 0
    for i in range(300):
        bodies = np.array([first, second])[..., i].tolist()
        numbers = {name: float(column[i]) for name, column in how.items()}
        want = reference_pair(*bodies, **numbers, law=law)
        for got, exact, scale in zip(found[:, i], want.outcome, want.scales, strict=True):
            assert abs(mpf(float(got)) - exact) <= 16 * EPS * scale
        assert hit.regime[i] == want.regime or min(want.margins) < 1e-13


@each_law
def test_which_body_is_the_first_does_not_matter(law):
    """Exchanged and turned by half a turn, or mirrored, they have the same bits."""
    *bodies, how = pairs(20_000, seed=44, alike=0.5)
    bodies = np.array(bodies)
    # of mass, k, X, Z, c_x, c_z, omega
    turn = np.array([[1, 1, -1, -1, -1, -1, 1]]).T
    mirror = np.array([[1, 1, -1, 1, -1, 1, -1]]).T
    hit, other, mirrored = (
        collide_pair(*(Body(*body) for body in pair), **how, law=law)
        for pair in (bodies, turn * bodies[::-1], mirror * bodies)
    )
    assert_array_equal(hit[2:], other[2:])
    assert_array_equal(hit[:2], turn * other[1::-1])
    assert_array_equal(hit[2:], mirrored._replace(P_x=-mirrored.P_x)[2:])


def scaled(body, mass, length, speed):
    """A body in other units: powers of two."""
    powers = np.array([[mass, length, length, length, speed, speed, speed - length]]).T
    return Body(*np.ldexp(body, powers))


def test_units_do_not_matter():
    """Powers of two change exponents alone; each body may have a unit of length of its own."""
    first, second, how = pairs(2_000, seed=45)
    one = collide_pair(first, second, **how)
    ours, theirs = (600, -800, -600), (600, 300, -600)
    other = collide_pair(scaled(first, *ours), scaled(second, *theirs), **how)
    assert_array_equal(scaled(one.first, *ours)[4:], other.first[4:])
    assert_array_equal(scaled(one.second, *theirs)[4:], other.second[4:])
    assert_array_equal(one.P_z, other.P_z)
    assert_array_equal(np.ldexp(one.energy_change, -600), other.energy_change)


BALL = Body(mass=2.0, k=0.6, X=0.1, Z=1.0, c_x=1.0, c_z=-1.0, omega=0.5)
REST = Body(mass=1.0, k=0.5, X=-0.2, Z=-1.0, c_x=0.0, c_z=0.0)
HOW = {"friction": 0.3, "restitution": 0.5}


def test_a_mass_in_a_point_on_a_lever_gives_way_like_one_that_is_nearly_so():
    lever = BALL._replace(k=np.array([1e-20, 1e-40, 1e-300]), Z=0.0)
    first = np.array(collide_pair(lever, REST, **HOW).first[4:])
    assert_allclose(first[:, 1:], first[:, :1] * [1, 1], rtol=1e-15)


def test_a_turned_body_has_the_normal_of_that_angle_upright():
    """Levers and velocities turn by it, which brings (sin, cos) to (0, 1); all else stays."""
    angle = np.linspace(-3, 3, 13)
    turned, turn = BALL.turned(angle), np.exp(1j * angle)
    assert_allclose(turned.X + 1j * turned.Z, (BALL.X + 1j * BALL.Z) * turn, rtol=4 * EPS)
    assert_allclose(turned.c_x + 1j * turned.c_z, (BALL.c_x + 1j * BALL.c_z) * turn, rtol=4 * EPS)
    assert turned._replace(X=BALL.X, Z=BALL.Z, c_x=BALL.c_x, c_z=BALL.c_z) == BALL
    single, listed = (REST._replace(X=X) for X in (np.ones(2, np.float32), [0.0, 3.0]))
    assert single.turned(0.0).X.dtype == np.float32
    assert listed.turned(0.0).X.tolist() == [0.0, 3.0]


def test_two_bodies_that_nothing_moves_cannot_hit_each_other():
    """Of infinite mass both; what parts stays as it is."""
    driven = Body(np.inf, 1.0, 0.0, 1.0, 0.0, np.array([-1.0, 1.0]))
    hit = collide_pair(
        driven, Body(np.inf, 1.0, 0.0, -1.0, 0.0, 0.0), friction=0.3, restitution=0.5
    )
    assert hit.regime.tolist() == [Regime.INVALID, Regime.NO_IMPACT]
    assert_array_equal(hit.first.c_z, [np.nan, 1.0])
