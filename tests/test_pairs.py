"""Impacts of two bodies: against a walk in impulse space, limits, symmetries, bad input."""

import numpy as np
import pytest
from mpmath import mpf

import impact
from impact import Body, Regime, collide_pair

from .reference import reference_pair

LAWS = ("newton", "poisson", "stronge")
MOBILITIES = (lambda x, z: 1 + x * x, lambda x, z: x * z, lambda x, z: 1 + z * z)
ULP = np.finfo(float).eps


def pairs(n, seed, decades=3.0, alike=0.0):
    """Bodies of masses, sizes and speeds over twice the decades; some share lever and speed."""
    rng = np.random.default_rng(seed)

    def sizes():
        return 10 ** rng.uniform(-decades, decades, n)

    def signed():
        return sizes() * rng.choice([-1, 1], n)

    bodies = []
    for _ in range(2):
        spin = signed() * (rng.uniform(size=n) < 0.9)
        bodies.append(Body(sizes(), sizes(), signed(), signed(), signed(), signed(), spin))
    second = bodies[1]
    near = rng.uniform(size=n) < alike  # speeds and levers that cancel all but a little
    for name in ("X", "Z", "c_x", "c_z", "omega"):
        value = getattr(bodies[0], name) * (1 + rng.choice([0, 1e-15 if name in "XZ" else 1e-6], n))
        second = second._replace(**{name: np.where(near, value, getattr(second, name))})
    heavy = rng.uniform(size=n) < 0.1
    second = second._replace(mass=np.where(heavy, np.inf, second.mass))
    how = {"friction": sizes(), "restitution": rng.uniform(0, 1, n)}
    how["friction"][rng.uniform(size=n) < 0.05] = np.inf
    if alike:  # friction at which the slip all but lasts, or the normal response vanishes
        A, B, C = mobilities(bodies[0], second)
        edge = np.where(rng.uniform(size=n) < 0.5, A / np.abs(B), np.abs(B) / C)
        how["friction"] = np.where(
            near, edge * (1 + rng.choice([0, 1e-14, 1e-9], n)), how["friction"]
        )
    return bodies[0], second, how


def mobilities(first, second):
    """A, B, C as anybody would sum them."""
    turned = [(1 / b.mass, b.X / b.k, b.Z / b.k) for b in (first, second)]
    A, B, C = (sum(s * f(x, z) for s, x, z in turned) for f in MOBILITIES)
    return A, B, C


def one_of(first, second, how, i):
    """One of many pairs, as numbers."""
    bodies = (Body(*(float(column[i]) for column in body)) for body in (first, second))
    return *bodies, {name: float(column[i]) for name, column in how.items()}


def errors(hit, want, i):
    """Errors of an outcome in units in the last place of what cancels in each of its numbers."""
    got = hit.P_x, hit.P_z, hit.energy_change, *hit.first[4:], *hit.second[4:]
    return [
        float(abs(mpf(float(g[i])) - w) / (s * mpf(ULP))) if s else float(g[i] != w)
        for g, w, s in zip(got, want.outcome, want.scales, strict=True)
    ]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("alike", [0.0, 0.99])
def test_impulses_are_those_of_a_walk_in_impulse_space(law, alike):
    """Masses, sizes and speeds over six decades; and where speeds, levers or responses cancel."""
    first, second, how = pairs(300, seed=41, alike=alike)
    hit = collide_pair(first, second, **how, law=law)
    assert np.bincount(hit.regime, minlength=4).min() > 0
    for i in range(300):
        *bodies, numbers = one_of(first, second, how, i)
        want = reference_pair(*bodies, **numbers, law=law)
        assert max(errors(hit, want, i)) <= 16, i
        assert hit.regime[i] == want.regime or min(want.margins) < 1e-13, i


@pytest.mark.parametrize("law", LAWS)
def test_a_body_on_an_infinitely_heavy_one_is_a_rod_on_a_plate(law):
    """The plate's own shape and place do not matter; its velocity does."""
    body, plate, how = pairs(20_000, seed=42, decades=2.0)
    body, how["friction"] = body._replace(mass=1.0), np.minimum(how["friction"], 1e3)
    moving = plate._replace(mass=np.inf, c_x=0.0, omega=0.0)
    hit = collide_pair(body, moving, **how, law=law)
    rod = impact.ContactGeometry(body.X, body.Z, body.k)
    want = impact.collide(*body[4:], geometry=rod, plate_velocity=moving.c_z, **how, law=law)
    np.testing.assert_array_equal(hit.regime, want.regime)
    size = np.abs(want.P_x) + np.abs(want.P_z)
    assert (np.hypot(hit.P_x - want.P_x, hit.P_z - want.P_z) <= 1e-9 * size).all()
    np.testing.assert_array_equal(np.broadcast_arrays(*hit.second), np.broadcast_arrays(*moving))


def turned(body):
    """A body, seen after half a turn."""
    return Body(*body[:2], *(-part for part in body[2:6]), body.omega)


@pytest.mark.parametrize("law", LAWS)
def test_which_body_is_the_first_does_not_matter(law):
    """Bit for bit: exchanged and turned by half a turn; and mirrored."""
    first, second, how = pairs(20_000, seed=44, alike=0.5)
    hit = collide_pair(first, second, **how, law=law)
    other = collide_pair(turned(second), turned(first), **how, law=law)
    odd = {"X": -1, "c_x": -1, "omega": -1}
    flipped = [
        body._replace(**{name: -getattr(body, name) for name in odd}) for body in (first, second)
    ]
    mirrored = collide_pair(*flipped, **how, law=law)
    for part in ("regime", "P_x", "P_z", "energy_change"):
        np.testing.assert_array_equal(getattr(hit, part), getattr(other, part))
        sign = -1 if part == "P_x" else 1
        np.testing.assert_array_equal(getattr(hit, part), sign * getattr(mirrored, part))
    for mine, theirs in ((hit.first, other.second), (hit.second, other.first)):
        np.testing.assert_array_equal(mine[4:], turned(theirs)[4:])


def scaled(body, mass, length, speed):
    """A body in other units: powers of two."""
    powers = (mass, length, length, length, speed, speed, speed - length)
    return Body(*(np.ldexp(part, power) for part, power in zip(body, powers, strict=True)))


def test_units_do_not_matter():
    """Powers of two change exponents alone; each body may have a unit of length of its own."""
    first, second, how = pairs(2_000, seed=45)
    one = collide_pair(first, second, **how)
    units = (300, -800, -300), (300, 300, -300)
    bodies = (scaled(body, *powers) for body, powers in zip((first, second), units, strict=True))
    other = collide_pair(*bodies, **how)
    for mine, theirs, powers in zip(one[:2], other[:2], units, strict=True):
        np.testing.assert_array_equal(scaled(mine, *powers)[4:], theirs[4:])
    np.testing.assert_array_equal(one.P_z, other.P_z)
    np.testing.assert_array_equal(np.ldexp(one.energy_change, -300), other.energy_change)


BALL = Body(mass=2.0, k=0.6, X=0.1, Z=1.0, c_x=1.0, c_z=-1.0, omega=0.5)
REST = Body(mass=1.0, k=0.5, X=-0.2, Z=-1.0, c_x=0.0, c_z=0.0)
HOW = {"friction": 0.3, "restitution": 0.5}


def test_a_mass_in_a_point_on_a_lever_gives_way_like_one_that_is_nearly_so():
    lever = BALL._replace(k=np.array([1e-20, 1e-40, 1e-300]), Z=0.0)
    first = np.array(collide_pair(lever, REST, **HOW).first[4:])
    np.testing.assert_allclose(first[:, 1:], first[:, :1] * [1, 1], rtol=1e-15)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"first": BALL._replace(mass=0.0)}, "first.mass must be > 0 .* got 0.0"),
        ({"second": REST._replace(k=-1.0)}, "second.k must be > 0, got -1.0"),
        ({"first": BALL[:6]}, "first must be .mass, k, X, Z, c_x, c_z, omega"),
        ({"second": None}, "second must be .mass, k"),
        ({"first": BALL._replace(c_x="fast")}, "first.c_x must be a real number"),
        ({"friction": -1.0}, "friction must be >= 0"),
        ({"law": "hooke"}, "law must be one of newton"),
        (
            {"first": BALL._replace(mass=np.inf), "second": REST._replace(mass=np.inf)},
            "must not both be inf",
        ),
    ],
)
def test_bad_input_is_named(changed, message):
    with pytest.raises(impact.InputError, match=message):
        collide_pair(**{"first": BALL, "second": REST, **HOW, **changed})


def test_bad_elements_are_invalid_and_the_others_as_they_were():
    masses = np.array([2.0, -1.0, 0.0, np.nan, np.inf, -np.inf])
    heavy = REST._replace(mass=np.array([1.0, 1.0, 1.0, 1.0, np.inf, np.inf]))
    hit = collide_pair(BALL._replace(mass=masses), heavy, **HOW)
    want = collide_pair(BALL, REST, **HOW)
    assert hit.regime.tolist() == [want.regime] + [Regime.INVALID] * 5
    for part, scalar in zip(
        (hit.P_x, hit.P_z, hit.energy_change, *hit.first[4:], *hit.second[4:]),
        (want.P_x, want.P_z, want.energy_change, *want.first[4:], *want.second[4:]),
        strict=True,
    ):
        assert part[0] == scalar
        assert np.isnan(part[1:]).all()
    assert isinstance(want.regime, Regime)
    assert hit.first.mass is masses


def test_separating_bodies_come_back_unchanged_even_if_none_can_move():
    away = BALL._replace(c_z=5.0, mass=np.inf), REST._replace(mass=np.inf)
    for first, second in ((away[0], REST), away, (BALL._replace(c_z=1e-300, omega=0.0), REST)):
        hit = collide_pair(first, second, **HOW)
        assert hit == (first, second, Regime.NO_IMPACT, 0, 0, 0)


def test_shapes_broadcast():
    tall = collide_pair(BALL._replace(c_x=np.ones((3, 1))), REST._replace(X=np.zeros(4)), **HOW)
    assert tall.P_z.shape == tall.second.omega.shape == tall.regime.shape == (3, 4)
