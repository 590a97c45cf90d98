"""Regime boundaries and stationary drift against the impact map and 50-digit arithmetic."""

from functools import partial

import mpmath
import numpy as np
import pytest
from mpmath import mpf
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal

import impact
from figures.theory import stationary
from impact import ContactGeometry, Regime

from . import sampling
from .reference import reference_collide
from .sampling import EPS, ulps


@pytest.fixture
def rods():
    """Rods of all shapes and tilts, upright and lying ones among them."""
    lengths = sampling.geometries(default_rng(3), 5000)
    lengths[0, :50] = lengths[1, 50:100] = 0.0
    return ContactGeometry(*lengths)


@pytest.fixture
def how():
    """Friction and restitution of as many impacts as there are rods."""
    friction, restitution = default_rng(4).uniform([[0.01], [0]], [[2], [0.99]], (2, 5000))
    return {"friction": friction, "restitution": restitution}


def test_painleve_friction_is_where_an_impact_needs_no_approach(rods):
    """Beyond it slip towards -x presses the contact in, as far as the slip goes; any geometry."""
    friction = impact.painleve_friction(rods)
    with mpmath.workdps(50):
        for got, x, z, k in zip(friction, *(map(mpf, part) for part in rods), strict=True):
            assert got == np.inf if x * z == 0 else ulps(got, (k * k + x * x) / abs(x * z)) <= 3
    for factor, pressed in ((1.01, True), (0.99, False)):
        hit = impact.collide(
            -np.sign(rods.X * rods.Z),
            -1e-9,
            geometry=rods,
            friction=factor * friction,
            restitution=0.5,
        )
        assert ((hit.P_z > 1e-5) == pressed)[friction < 1e3].all()


def test_slide_friction_is_where_the_slide_ends(rods, how):
    ratio = 10 ** default_rng(5).uniform(-2, 2, 5000)
    setting = {"geometry": rods, "restitution": how["restitution"]}
    edge = impact.slide_friction(**setting, approach_ratio=ratio)

    def slides(friction):
        return impact.classify(1.0, -ratio, friction=friction, **setting) == Regime.SLIDE

    always, never = np.isinf(edge), edge == 0
    inside = (edge > 1e-9) & ~always
    assert min(inside.sum(), always.sum(), never.sum()) > 20
    assert slides(edge * (1 - 1e-9))[inside].all()
    assert not slides(edge * (1 + 1e-9))[inside].any()
    assert (slides(1e6) & slides(np.inf))[always].all()
    assert not slides(1e-12)[never].any()


def test_drift_repeats_itself(rods, how):
    """One landing gives back c_x and turns c_z round, by an impulse of twice as much."""
    found = impact.drift(rods, plate_velocity=0.7, **how)
    hit = impact.collide(found.c_x, -found.c_z, geometry=rods, plate_velocity=0.7, **how)
    scale = np.abs(found.c_x) + found.c_z + 0.7
    assert (np.abs(np.subtract(hit[:2], found[:2])) <= 64 * EPS * scale).all()
    sticks = how["friction"] >= impact.critical_friction(rods)
    assert_array_equal(found.regime == Regime.SLIP_STICK, sticks)
    assert not (hit.regime == Regime.SLIDE).any()
    assert_allclose(hit.P_z, 2 * found.c_z, rtol=128 * EPS)


def test_extreme_numbers_have_the_answer_of_large_ones():
    """Levers far beyond k, whose squares are no numbers, give the limit; so does a tiny k."""
    far, short = np.array([1e100, 1e155, 1e200]), 10.0 ** -np.array([60, 70, 100, 155, 320])
    X, Z, mu = np.array([(1, 0.3, 0.3, 0.3), (1, 0.4, 0.4, 0.4), (0.1, 0, 0.3, 5)])[..., None]
    how = {"friction": 0.3, "restitution": 0.65}
    alike = [
        *impact.drift((far, far, 1.0), **how),
        *impact.drift((0.3, 0.4, short), **how),
        *impact.energy_restitution((X, Z, short), mu),
        impact.relaxation((far, 3 * far, 1.0), friction=1.0, restitution=0.5),
        impact.landing_density(0.0, fall_speed=far * [1e100, 1e153, 1e108]),
    ]
    for values in alike:
        assert_allclose(values, values[0], rtol=1e-14, atol=1e-59)
    rods = np.array([(1e300, 1, 1e200, 1e200), (1, 1e-200, 1e-300, 0), (1, 1e-200, 1e-200, 1e-200)])
    assert impact.critical_friction(rods) == pytest.approx([5e299, 5e199, 1e300, 0.0], rel=1e-14)
    assert impact.painleve_friction((1e-200, 1.0, 1e-200)) == pytest.approx(2e-200, rel=1e-14)
    assert impact.painleve_friction((0.0, 1e200, 1e-200)) == np.inf
    steep = {"approach_ratio": 1.7e308, "restitution": 1.0}
    assert impact.slide_friction((0.0, 1.0, 1.0), **steep) < 1e-308
    ends = np.pi / 2 + np.arange(9) * 2.0**-52
    assert impact.landing_density(ends, fall_speed=1e-15).min() == 0


def test_nothing_is_stationary_without_friction():
    given = {"friction": [0.0, 0.3], "restitution": 0.5}
    for found in (impact.drift(impact.thin_rod(tilt=0.4), **given), impact.optimal_tilt(**given)):
        assert np.isnan(found.c_x).tolist() == [True, False]
        assert (found.regime == Regime.INVALID).tolist() == [True, False]


_RNG = default_rng(6)
OPTIMA = [
    *((friction, 0.65) for friction in (1e-3, 0.05, 0.09, 0.12, 0.16, 0.2, 0.75, 0.8, np.inf)),
    *zip(10 ** _RNG.uniform(-2, 0.3, 60), _RNG.uniform(0, 0.99, 60), strict=True),
]


def test_optimal_tilt_to_the_last_digits():
    """A search at 50 digits on the formulas of the paper, (26) and (29), finds the same."""
    for friction, restitution in OPTIMA:
        with mpmath.workdps(50):
            e, mu = mpf(restitution), mpf(friction)

            def drift(t, e=e, mu=mu):
                # held, or slipping back where it is less
                top = min(6 * t, mu * (4 + t * t) + 3 * t)
                return (1 + e) * top / (1 - e + (7 - e) * t * t)

            low, high = mpf(0), mpf(1)
            for _ in range(310):
                third = (high - low) / 3
                a, b = low + third, high - third
                low, high = (a, high) if drift(a) < drift(b) else (low, b)
            found = impact.optimal_tilt(friction=friction, restitution=restitution)
            assert ulps(found.c_x, drift(low)) <= 8
            assert abs(found.tilt - float(mpmath.atan(low))) < 1e-15
            back = 3 * low > mu * (4 + low * low) * (1 + mpf(10) ** -20)
            assert (found.regime == Regime.SLIP_REVERSAL) == back


def exact_relaxation(geometry, **how):
    """Relaxation from whole impacts at 50 digits, and how far apart the eigenvalues are."""
    start = impact.drift(geometry, **how)
    c_x, c_z, step = mpf(start.c_x), -mpf(start.c_z), mpf(10) ** -12
    after = []
    for moved in ((c_x, c_z), (c_x + step, c_z), (c_x, c_z + step)):
        hit = reference_collide(*moved, 0, **geometry._asdict(), **how, plate_velocity=1, dps=50)
        after.append(mpmath.matrix([hit.c_x, -hit.c_z]))
    change = mpmath.matrix([list((moved - after[0]) / step) for moved in after[1:]])
    one, other = mpmath.eig(change, right=False)
    return -1 / mpmath.log(max(abs(one), abs(other))), abs(one - other)


def test_relaxation_by_whole_impacts(rods, how):
    """It holds where a deviation lasts for millions of landings: slippery, or upright, lossless."""
    numbers = np.array([*rods, *how.values()])[:, 100:280]
    numbers[:3, 120:] = impact.thin_rod(10 ** default_rng(8).uniform(-9, -6, 60))
    numbers[3, 60:120] *= 1e-9
    numbers[4, 120:] = 1 - 1e-12 * numbers[4, 120:]
    got = impact.relaxation(numbers[:3], friction=numbers[3], restitution=numbers[4])
    assert got[60:].min() > 1e6
    with mpmath.workdps(60):
        for found, (*rod, mu, e) in zip(got, numbers.T.tolist(), strict=True):
            want, apart = exact_relaxation(ContactGeometry(*rod), friction=mu, restitution=e)
            assert abs(found - want) <= 8 * EPS * want / apart


def test_relaxation_at_the_ends():
    tilt, friction, restitution = np.transpose(
        [(0, 0.3, 0.65), (0, 0.3, 1), (0, 0, 0.6), (1, 0, 1)]
    )
    found = impact.relaxation(impact.thin_rod(tilt), friction=friction, restitution=restitution)
    assert_allclose(found, [1 / np.log(4 / 3), np.inf, np.inf, np.inf], rtol=4 * EPS)
    e, k = default_rng(10).uniform(0.1, 1, (2, 1000))  # a lying rod forgets at once
    at_once = impact.relaxation((np.sqrt(e) * k, 0.0, k), friction=0.3, restitution=e)
    assert ((at_once >= 0) & (at_once < 0.04)).all()


@pytest.mark.parametrize("fall", [0.01, 0.05, 0.4, 0.6, 0.999, 1.0, 1.7, 50.0])
def test_landing_density(fall):
    """It sums to one, is proportional to the approach or zero, and has the derived mean."""
    phase = np.linspace(-np.pi, np.pi, 200_001)
    density = impact.landing_density(phase, fall_speed=fall)
    assert np.trapezoid(density, phase) == pytest.approx(1, abs=1e-4)
    lit = density > 0
    assert_allclose(density[lit] * 2 * np.pi * fall, (fall + np.cos(phase))[lit])
    mean = impact.mean_plate_velocity(
        partial(impact.landing_density, fall_speed=fall), points=1_000_000
    )
    assert mean == pytest.approx(stationary.alpha_of_fall(np.array(fall)), abs=2e-5)


def test_mean_plate_velocity():
    """Means of the paper's density, an even one and the upstroke; of slow rods as derived."""
    of_paper = impact.mean_plate_velocity(plate_speed=np.array([2.0, -4.0]))
    assert of_paper == pytest.approx([1, -2], rel=1e-14)
    assert impact.mean_plate_velocity(np.ones_like) == pytest.approx(0, abs=1e-15)
    upstroke = impact.mean_plate_velocity(lambda phase: (np.cos(phase) > 0).astype(float))
    assert upstroke == pytest.approx(2 / np.pi, abs=1e-6)
    slow = np.array([1e-6, 1e-8])
    assert_allclose(stationary.alpha_of_fall(slow), 4 / 3 * np.sqrt(np.pi * slow), rtol=1e-2)
