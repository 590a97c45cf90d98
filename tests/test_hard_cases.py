"""Where a straightforward implementation breaks (T1-T15 and more), and that ours does not.

A case is a function of an implementation (a module with `collide`, `critical_tilts`, `drift`).
Every case passes on `impact` and, where it is not in PASSES, is seen to fail on the
straightforward formulas beside it.
"""

import warnings

import mpmath
import numpy as np
import pytest

import impact
from impact import ContactGeometry, Regime

from . import sampling, straightforward
from .reference import error_in_ulp, reference_collide

EPS = np.finfo(float).eps
ROD = impact.thin_rod(np.radians(30))
AT = {"geometry": ROD, "friction": 0.3, "restitution": 0.5}
PLAIN = ContactGeometry(1.0, 1.0, 1.0)  # numbers of which products and sums are exact


def laws_of(theirs):
    """Laws of an implementation; the straightforward one has Newton's."""
    return ("newton", "poisson", "stronge") if theirs is impact else ("newton",)


def exact(c_x, c_z, omega=0.0, *, geometry, law="newton", **rest):
    """The integration of the same impact."""
    return reference_collide(c_x, c_z, omega, **geometry._asdict(), **rest, law=law)


def assert_accurate(theirs, c_x, c_z, omega=0.0, *, geometry, limit=8, law="newton", **rest):
    """Value and regime (away from boundaries) against the integration, in ulp."""
    got = theirs.collide(c_x, c_z, omega, geometry=geometry, law=law, **rest)
    want = exact(c_x, c_z, omega, geometry=geometry, law=law, **rest)
    plate = rest.get("plate_velocity", 0.0)
    values = {name: float(getattr(got, name)) for name in got._fields if name != "regime"}
    errors = error_in_ulp(values, want, c_x, c_z, omega, **geometry._asdict(), plate_velocity=plate)
    assert errors["maximum"] <= limit, (values, want)
    if min(want.margins) > 1e-13:
        assert int(got.regime) == want.regime


def t1_grazing(theirs):
    """Impulses go to zero linearly with v_0, down to subnormal numbers."""
    for c_x, friction in ((1.0, 0.3), (0.0, 0.9), (-1.0, 0.1)):
        at, tiny = AT | {"friction": friction}, 2.0**-60
        one = theirs.collide(c_x * tiny, -tiny, **at)
        for exponent in (1, 300, 900, 1000):
            small = 2.0**-exponent
            hit = theirs.collide(c_x * tiny * small, -tiny * small, **at)
            assert hit.regime == one.regime
            assert abs(hit.P_z - small * one.P_z) <= 5e-324
            assert abs(hit.P_x - small * one.P_x) <= 5e-324
    for exponent in (100, 500, 1000, 1074):  # slip of order one, vanishing approach
        v_0 = -(2.0**-exponent)
        hit = theirs.collide(1.0, v_0, **AT)
        assert hit.regime == Regime.SLIDE
        assert hit.P_z == pytest.approx(float(exact(1.0, v_0, **AT).P_z), rel=4 * EPS, abs=5e-324)


def t2_separating_pair(theirs):
    """No adhesive impulse: v_0 >= 0 comes back unchanged, to the bit, whatever the scales."""
    for c_x, c_z, omega in (
        (1.0, 0.0, 0.0),
        (1.0, 0.5, -1.0),
        (1e-300, 1e300, 0.0),
        (-3.0, 5e-324, 0.0),
        (0.1, 1.7e308, 1e-300),
    ):
        hit = theirs.collide(c_x, c_z, omega, **AT)
        assert hit.regime == Regime.NO_IMPACT
        assert (hit.c_x, hit.c_z, hit.omega) == (c_x, c_z, omega)
        assert hit.P_x == hit.P_z == hit.energy_change == 0


def t3_no_slip(theirs):
    """At u_0 = 0 friction still acts; the map is continuous there."""
    for friction, regime in ((0.9, Regime.SLIP_STICK), (0.2, Regime.SLIP_REVERSAL)):
        for law in laws_of(theirs):
            rest = {"geometry": ROD, "friction": friction, "restitution": 0.6, "law": law}
            at_rest = theirs.collide(0.0, -1.0, **rest)
            assert at_rest.regime == regime
            assert at_rest.P_x != 0
            for u_0 in (-0.0, 1e-300, -1e-300, 1e-17, -1e-17):
                near = theirs.collide(u_0, -1.0, **rest)
                assert near.P_z == pytest.approx(at_rest.P_z, rel=64 * EPS)
                assert near.P_x == pytest.approx(at_rest.P_x, rel=64 * EPS)


def t4_boundaries(theirs):
    """Branches meet in value: u_* = 0, mu (k^2 + Z^2) = XZ, and both at once."""
    at = {"geometry": PLAIN, "restitution": 0.25}
    for c_x, regime in ((1.0, Regime.SLIDE), (0.5, Regime.SLIP_STICK)):
        middle = theirs.collide(c_x, -1.0, friction=0.5, **at)
        assert middle.regime == regime
        for friction in (np.nextafter(0.5, 0), np.nextafter(0.5, 1)):
            for speed in (c_x, np.nextafter(c_x, 0), np.nextafter(c_x, 2)):
                near = theirs.collide(speed, -1.0, friction=friction, **at)
                for name in ("c_x", "c_z", "omega", "P_x", "P_z"):
                    assert abs(getattr(near, name) - getattr(middle, name)) <= 16 * EPS
        assert_accurate(theirs, c_x, -1.0, friction=0.5, **at)


def t5_tilts_at_the_ends(theirs):
    """Tilt 0, tiny, 90 degrees, negative: exact mirror symmetry; X or Z exactly zero."""
    for tilt in (0.0, 1e-300, 1e-17, 0.3, np.pi / 2 - 1e-9, np.pi / 2):
        right, left = impact.thin_rod(tilt), impact.thin_rod(-tilt)
        for c_x, omega in ((1.0, 0.0), (0.0, 0.7), (0.0, 0.0)):
            rest = {"friction": 0.3, "restitution": 0.6}
            a = theirs.collide(c_x, -1.5, omega, geometry=right, **rest)
            b = theirs.collide(-c_x, -1.5, -omega, geometry=left, **rest)
            assert (a.c_x, a.c_z, a.omega, a.P_x) == (-b.c_x, b.c_z, -b.omega, -b.P_x)
            assert_accurate(theirs, c_x, -1.5, omega, geometry=right, **rest)
    for geometry in (ContactGeometry(0.0, 0.5, 0.3), ContactGeometry(0.5, 0.0, 0.3)):
        for c_x in (1.0, 0.0, -1.0):
            assert_accurate(theirs, c_x, -2.0, geometry=geometry, friction=0.2, restitution=0.5)


def t6_friction_at_the_ends(theirs):
    """Zero, tiny, huge and infinite friction."""
    for geometry in (ROD, impact.thin_rod(0.0), impact.thin_rod(-0.4)):
        for c_x in (1.0, 0.0, -1.0):
            rest = {"geometry": geometry, "restitution": 0.5}
            assert theirs.collide(c_x, -1.0, friction=0.0, **rest).P_x == 0
            for friction in (0.0, 1e-300, 1e-16, 1e16, 1e300, 1.7e308, np.inf):
                assert_accurate(theirs, c_x, -1.0, friction=friction, **rest)
            held = theirs.collide(c_x, -1.0, friction=np.inf, **rest)
            assert held.slip_velocity == 0
            assert held.P_z > 0
    # thrown off before the slip can stop, however large the friction
    thrown = theirs.collide(5.0, -1.0, geometry=PLAIN, friction=np.inf, restitution=0.5)
    assert thrown.regime == Regime.SLIDE
    assert thrown.P_x == pytest.approx(-1.5, rel=4 * EPS)


def t7_painleve(theirs):
    """Through k^2 + X^2 + mu X Z = 0: P_z positive and continuous, no digit lost."""
    adverse = impact.thin_rod(-np.arctan(0.5))  # paradox from mu = 4/3 on
    edge = float((adverse.k**2 + adverse.X**2) / -(adverse.X * adverse.Z))
    steps = 10.0 ** np.arange(-16, 0)
    for friction in np.concatenate([edge * (1 - steps), edge * (1 + steps)]):
        for c_z in (-1.0, -1e-3, -1e-8, -1e-15):
            rest = {"geometry": adverse, "friction": friction, "restitution": 0.6}
            assert theirs.collide(1.0, c_z, **rest).P_z > 0
            for law in laws_of(theirs):
                assert_accurate(theirs, 1.0, c_z, law=law, **rest)


def t8_impact_without_collision(theirs):
    """Inside the Painleve region the impulse stays finite as v_0 -> 0-; at 0 there is none."""
    adverse = impact.thin_rod(-np.arctan(0.5))
    for law in laws_of(theirs):
        rest = {"geometry": adverse, "friction": 2.0, "restitution": 0.6, "law": law}
        limit = exact(1.0, mpmath.mpf("-1e-2000"), **rest)
        assert limit.P_z > 0.1
        for c_z in (-1e-17, -1e-200, -5e-324):
            hit = theirs.collide(1.0, c_z, **rest)
            assert hit.P_z == pytest.approx(float(limit.P_z), rel=32 * EPS)
            assert hit.normal_velocity == pytest.approx(float(limit.normal_velocity), abs=32 * EPS)
        assert theirs.collide(1.0, 0.0, **rest).regime == Regime.NO_IMPACT


def t9_drift_that_loses_nothing(theirs):
    """1 - e + 6 sin^2 -> 0: a signed infinity at tilt +-0, and no underflow beside it."""
    for tilt in (0.0, -0.0, 1e-200, -1e-170, 1e-9):
        found = theirs.drift(impact.thin_rod(tilt), friction=0.5, restitution=1.0)
        wanted = np.copysign(np.inf, tilt) if tilt == 0 else 2 / tilt
        assert found[0] == pytest.approx(wanted, rel=1e-14)
        assert tilt != 0 or found.c_z == np.inf


def t10_energy(theirs):
    """Newton's law gains up to B^2/(2 A D) of v_0^2 while sticking; the others nothing."""
    rod = impact.thin_rod(np.pi / 4)
    rest = {"geometry": rod, "friction": 1.0, "restitution": 1.0}
    assert theirs.collide(0.6, -1.0, **rest).energy_change == pytest.approx(0.1125, rel=8 * EPS)
    for law in ("poisson", "stronge"):
        assert theirs.collide(0.6, -1.0, law=law, **rest).energy_change <= 4 * EPS


def t11_scales(theirs):
    """Lengths and speeds of 1e-300 ... 1e300 give the answer of unit scale."""
    for law in laws_of(theirs):
        rest = {"friction": 0.3, "restitution": 0.6, "law": law}
        one = theirs.collide(1.0, -2.0, 0.5, geometry=ROD, **rest)
        for a in (-990, -400, 0, 400, 990):  # exponents of length and of speed
            for b in (-990, 0, 990):
                if abs(b - a) > 990:
                    continue
                rod = ContactGeometry(*(2.0**a * part for part in ROD))
                c_z, omega = -(2.0 ** (b + 1)), 2.0 ** (b - a - 1)
                hit = theirs.collide(2.0**b, c_z, omega, geometry=rod, **rest)
                assert hit.regime == one.regime
                assert (hit.c_x, hit.c_z) == (2.0**b * one.c_x, 2.0**b * one.c_z)
                assert (hit.P_x, hit.P_z) == (2.0**b * one.P_x, 2.0**b * one.P_z)
    for scale in (1e-300, 1e-155, 1e155, 1e300):
        rod = ContactGeometry(*(float(part * scale) for part in ROD))
        assert_accurate(theirs, 1.0, -2.0, geometry=rod, friction=0.3, restitution=0.6)
        assert_accurate(theirs, scale, -2 * scale, geometry=ROD, friction=0.3, restitution=0.6)


def t12_odd_numbers(theirs):
    """nan and inf are INVALID, not a regime; float32 stays float32, to 4 of its ulp."""
    for odd in (np.nan, np.inf, -np.inf):
        hit = theirs.collide(np.array([odd, 1.0]), -1.0, **AT)
        assert hit.regime[0] == Regime.INVALID
        assert np.isnan(hit.P_z[0])
        assert hit.P_z[1] > 0
    i = sampling.everyday(300, seed=31)
    single = type(i)(*(column.astype(np.float32) for column in i))
    got = single.collide(dtype=np.float32)
    assert got.c_x.dtype == np.float32
    for n in range(300):
        want = single.reference(n)
        row = {name: float(column[n]) for name, column in single._asdict().items()}
        del row["friction"], row["restitution"]
        values = {name: float(getattr(got, name)[n]) for name in got._fields if name != "regime"}
        assert error_in_ulp(values, want, digits=24, **row)["maximum"] <= 4


def t13_small_critical_tilts(theirs):
    """Eq. (23) cancels: nine digits are lost at mu = 1e-4, all of them at 1e-9."""
    for friction in (1e-4, 1e-9, 1e-150, 1e-300):
        lower, upper = theirs.critical_tilts(friction)
        assert lower == pytest.approx(4 * friction / 3, rel=2 * friction**2 + 4 * EPS)
        assert upper == pytest.approx(np.pi / 2 - friction / 3, rel=4 * EPS)


def t14_long_levers(theirs):
    """X, Z up to 100 k: the error grows no faster than the condition number AC/(AC - B^2)."""
    rng = np.random.default_rng(32)
    for _ in range(400):
        X, Z = 10 ** rng.uniform(-1, 2, 2) * rng.choice([-1, 1], 2)
        A, B, C = 1 + X * X, X * Z, 1 + Z * Z
        c_x, c_z, mu = rng.uniform(-1, 1), rng.uniform(-2, 0), 10 ** rng.uniform(-2, 2)
        rest = {"geometry": ContactGeometry(X, Z, 1.0), "restitution": rng.uniform()}
        limit = 8 + 2 * A * C / (A * C - B * B)
        assert_accurate(theirs, c_x, c_z, friction=mu, limit=limit, **rest)


def t15_edges_inside_arrays(theirs):
    """The branch not taken divides by zero; nobody hears of it."""
    friction = np.array([0.0, 0.5, 0.5, 2.5, 2.5, np.inf])
    X = np.array([0.0, 1.0, -1.0, -1.0, 1.0, -1.0])
    with warnings.catch_warnings(), np.errstate(all="raise"):
        warnings.simplefilter("error")
        for c_x in (1.0, 0.0, -1.0):
            rest = {"geometry": ContactGeometry(X, 1.0, 1.0), "friction": friction}
            hit = theirs.collide(c_x, -1.0, restitution=0.25, **rest)
            assert all(np.isfinite(part).all() for part in hit)


def t16_nothing_moves_nothing_holds(theirs):
    """No slip, no friction, no lever: nothing to divide by, and the contact simply stays."""
    hit = theirs.collide(0.0, -1.0, geometry=impact.thin_rod(0.0), friction=0.0, restitution=0.5)
    assert hit.regime == Regime.SLIP_STICK
    assert hit.P_x == 0
    assert hit.P_z == pytest.approx(1.5, rel=4 * EPS)


def t17_friction_that_hardly_stops_the_slip(theirs):
    """T -> 0: the slip stops after an impulse that is a quotient of vanishing numbers."""
    adverse = impact.thin_rod(-0.6)
    edge = float(impact.critical_friction(adverse))
    for step in 10.0 ** np.arange(-15, -1):
        for law in laws_of(theirs):
            for c_z in (-1.0, -3.0, -0.3 / step, -0.5 / step):
                rest = {"geometry": adverse, "friction": edge * (1 + step), "restitution": 0.7}
                assert_accurate(theirs, 1.0, c_z, law=law, **rest)


def t18_rounding_at_the_edge_of_a_slide(theirs):
    """Just beyond u_* = 0 the impulse stays positive, just inside the slip keeps its sense."""
    rng = np.random.default_rng(33)
    n = 20_000
    X, Z, k = rng.uniform(0.1, 2, (3, n))
    restitution, friction = rng.uniform(0, 1, n), 10 ** rng.uniform(-2, 18, n)
    N, T = k**2 + X**2 + friction * X * Z, friction * (k**2 + Z**2) + X * Z
    c_x = (1 + restitution) * T / N * (1 + rng.integers(-4, 5, n) * EPS)  # u_* = 0 for c_z = -1
    rest = {"geometry": ContactGeometry(X, Z, k), "friction": friction}
    hit = theirs.collide(c_x, -1.0, restitution=restitution, **rest)
    slides = hit.regime == Regime.SLIDE
    assert 0.2 < slides.mean() < 0.8
    assert (hit.slip_velocity[slides] >= 0).all()
    assert (hit.P_z > 0).all()
    assert (hit.P_z >= 0.99 * k**2 * c_x / T).all()


def t19_infinite_friction(theirs):
    """Of an impact that grazes, hardly approaches, or begins at rest but for that: the limit."""
    for c_x, geometry in ((0.0, PLAIN), (1.0, PLAIN), (1.0, PLAIN._replace(X=0.0)), (1.0, ROD)):
        for c_z in (-1e-15, -1e-40, -1e-100):
            for law in laws_of(theirs):
                rest = {"geometry": geometry, "friction": np.inf, "restitution": 0.5, "law": law}
                hit, want = theirs.collide(c_x, c_z, **rest), exact(c_x, c_z, **rest)
                assert hit.regime == want.regime
                got = hit.P_x, hit.omega, hit.normal_velocity
                wanted = map(float, (want.P_x, want.omega, want.normal_velocity))
                assert got == pytest.approx(tuple(wanted), rel=8 * EPS, abs=0)


def t20_a_mass_in_a_point(theirs):
    """k against the lever and the speed down to the smallest number: a regime, and no nan."""
    slide = theirs.collide(
        1.0, -1.0, geometry=ContactGeometry(0.0, 1.0, 1e-155), friction=0.0, restitution=0.5
    )
    assert (slide.regime, slide.c_z, slide.P_z) == (Regime.SLIDE, 0.5, 1.5)
    rng = np.random.default_rng(34)
    odd = np.array([0.0, 1.0, -1.0, 1e-5, -1e-60, 1e60, 1e-155, -1e-300])
    c_x, c_z, omega, X, Z = rng.choice(odd, (5, 20_000))
    k = rng.choice([5e-324, 1e-300, 1e-155, 1e-80, 1e-60, 1.0], 20_000)
    friction = rng.choice([0.0, 0.3, 1e-20, 1e40, 1e300, np.inf], 20_000)
    rest = {"geometry": ContactGeometry(X, Z, k), "friction": friction, "restitution": 0.5}
    for law in laws_of(theirs):
        hit = theirs.collide(c_x, c_z, omega, **rest, law=law)
        assert not any(np.isnan(part).any() for part in hit)


CASES = [value for name, value in list(globals().items()) if name[0] == "t" and name[1].isdigit()]
# where the straightforward formulas are good enough, or (t17) Newton's law is not the hard one
PASSES = {t14_long_levers, t17_friction_that_hardly_stops_the_slip}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.__name__)
def test_hard_case(case):
    """Ours passes, the straightforward formulas do not."""
    case(impact)
    if case not in PASSES:
        with np.errstate(all="ignore"), pytest.raises((AssertionError, FloatingPointError)):
            case(straightforward)
