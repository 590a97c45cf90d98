"""Where a straightforward implementation breaks (T1-T15 and more), and that ours does not.

A case is a function of an implementation (a module with `collide`, `critical_tilts`, `drift`).
Every case passes on `impact` and is seen to fail on the straightforward formulas beside it.
"""

import mpmath
import numpy as np
import pytest
from mpmath import mpf
from numpy.random import default_rng
from numpy.testing import assert_array_equal

import impact
from impact import Regime

from . import sampling, straightforward
from .sampling import EPS, LAWS, every, ulps

ROD = impact.thin_rod(np.radians(30))
AT = {"geometry": ROD, "friction": 0.3, "restitution": 0.5}
PLAIN = {"X": 1.0, "Z": 1.0, "k": 1.0}  # numbers of which products and sums are exact
SIDES = [1.0, 0.0, -1.0]


def laws_of(theirs):
    """Laws of an implementation; the straightforward one has Newton's."""
    return LAWS if theirs is impact else LAWS[:1]


def assert_accurate(theirs, impacts, limit=8):
    """Values, in ulp, and regimes against the integration; P_z > 0; and mirrored bit for bit."""
    for law in laws_of(theirs):
        errors, wrong = sampling.compare(impacts, law, theirs.collide)
        assert not wrong
        assert (errors <= limit).all()
        hit = impacts.collide(law, theirs.collide)
        assert (hit.P_z[hit.regime > Regime.NO_IMPACT] > 0).all()
        sampling.assert_mirror_symmetric(impacts, law, theirs.collide)


def assert_digits(theirs, impacts, *fields, limit=8):
    """Regimes, and fields that are no sums to their own last digits, against the integration."""
    for law in laws_of(theirs):
        hit = impacts.collide(law, theirs.collide)
        for index, regime in enumerate(hit.regime):
            want = impacts.reference(index, law)
            assert regime == want.regime
            for name in fields:
                exact = pytest.approx(float(getattr(want, name)), rel=limit * EPS, abs=5e-324)
                assert getattr(hit, name)[index] == exact


def t1_grazing(theirs):
    """Impulses go to zero with v_0, down to subnormal numbers, whether or not the slip does."""
    tiny = 2.0**-1060
    slow = every(c_x=[tiny, 0.0, -tiny], c_z=-tiny, friction=[0.1, 0.3, 0.9])
    assert_accurate(theirs, slow, limit=1)
    assert_digits(
        theirs, every(c_z=-(0.5 ** np.array([100, 500, 1000, 1074]))), "P_x", "P_z", limit=4
    )


def t2_separating_pair(theirs):
    """No adhesive impulse: v_0 >= 0 comes back unchanged, to the bit, whatever the scales."""
    c_x = np.array([1.0, 1.0, 1e-300, -3.0, 0.1])
    c_z, omega = np.array([(0.0, 0.5, 1e300, 5e-324, 1.7e308), (0.0, -1.0, 0.0, 0.0, 1e-300)])
    hit = theirs.collide(c_x, c_z, omega, **AT)
    assert (hit.regime == Regime.NO_IMPACT).all()
    assert_array_equal(hit[:3], [c_x, c_z, omega])
    assert not np.any([hit.P_x, hit.P_z, hit.energy_change])


def t3_no_slip(theirs):
    """Friction still acts at u_0 = 0; the map is continuous there."""
    resting = every(
        c_x=[0.0, -0.0, 1e-300, -1e-300, 1e-17, -1e-17], friction=[0.2, 0.9], restitution=0.6
    )
    assert_accurate(theirs, resting)


def t4_boundaries(theirs):
    """Branches meet in value: u_* = 0, mu (k^2 + Z^2) = XZ, and both at once."""
    frictions = np.nextafter(0.5, [0.5, 0, 1])
    for c_x, regime in ((1.0, Regime.SLIDE), (0.5, Regime.SLIP_STICK)):
        speeds = np.nextafter(c_x, [c_x, 0, 2])
        near = every(**PLAIN, c_x=speeds, friction=frictions, restitution=0.25)
        assert_accurate(theirs, near)
        assert near.collide(collide=theirs.collide).regime[0] == regime


def t5_tilts_at_the_ends(theirs):
    """Tilt 0, tiny, 90 degrees, negative: exact mirror symmetry; X or Z exactly zero."""
    tilts = [0.0, 1e-300, 1e-17, 0.3, np.pi / 2 - 1e-9, np.pi / 2]
    assert_accurate(theirs, every(tilt=tilts, c_x=SIDES, omega=[0.0, 0.7], c_z=-1.5))
    assert_accurate(theirs, every(X=[0.0, 0.5], Z=[0.0, 0.5], k=0.3, c_x=SIDES, friction=0.2))


def t6_friction_at_the_ends(theirs):
    """Zero, tiny, huge and infinite friction."""
    for friction in (0.0, 1e-300, 1e-16, 1e16, 1e300, 1.7e308, np.inf):
        impacts = every(tilt=[ROD.X, 0.0, -0.4], c_x=SIDES, friction=friction)
        assert_accurate(theirs, impacts)
        hit = impacts.collide(collide=theirs.collide)
        assert friction != 0 or not hit.P_x.any()
        assert friction != np.inf or not hit.slip_velocity.any()
    # thrown off before the slip can stop, however large the friction
    assert_digits(theirs, every(**PLAIN, c_x=5.0, friction=np.inf), "P_x", limit=4)


def t7_painleve(theirs):
    """Through k^2 + X^2 + mu X Z = 0: P_z positive and continuous, no digit lost."""
    adverse = -np.arctan(0.5)  # paradox from mu = 4/3 on
    steps = 10.0 ** np.arange(-16, 0)
    edge = impact.painleve_friction(impact.thin_rod(adverse))
    through = every(
        tilt=adverse,
        friction=[*edge * (1 - steps), *edge * (1 + steps)],
        c_z=[-1.0, -1e-3, -1e-8, -1e-15],
        restitution=0.6,
    )
    assert_accurate(theirs, through)


def t8_impact_without_collision(theirs):
    """Inside the Painleve region the impulse stays finite as v_0 -> 0-; at 0 there is none."""
    pressed = every(
        tilt=-np.arctan(0.5), friction=2.0, c_z=[-1e-17, -1e-200, -5e-324, 0.0], restitution=0.6
    )
    assert_digits(theirs, pressed, "P_z", "normal_velocity")
    hit = pressed.collide(collide=theirs.collide)
    assert (hit.P_z > 0.1).tolist() == [True, True, True, False]


def t9_drift_that_loses_nothing(theirs):
    """1 - e + 6 sin^2 -> 0: a signed infinity at tilt +-0, and no underflow beside it."""
    for tilt in (0.0, -0.0, 1e-200, -1e-170, 1e-9):
        found = theirs.drift(impact.thin_rod(tilt), friction=0.5, restitution=1.0)
        wanted = np.copysign(np.inf, tilt) if tilt == 0 else 2 / tilt
        assert found[0] == pytest.approx(wanted, rel=1e-14)
        assert tilt != 0 or found.c_z == np.inf


def t10_energy(theirs):
    """Newton's law gains up to B^2/(2 A D) of v_0^2 while sticking; the others nothing."""
    sticking = every(tilt=np.pi / 4, c_x=0.6, friction=1.0, restitution=1.0)
    gained, *kept = (sticking.collide(law, theirs.collide).energy_change for law in LAWS)
    assert gained == pytest.approx(0.1125, rel=8 * EPS)
    assert max(kept) <= 4 * EPS


def t11_scales(theirs):
    """Lengths and speeds of 1e-300 ... 1e300 give the answer of unit scale."""
    for scale in (1e-300, 1e-155, 1e155, 1e300):
        assert_accurate(theirs, every(length=scale, c_z=-2.0))
        assert_accurate(theirs, every(length=scale, c_x=scale, c_z=-2 * scale, omega=[0.0, 0.5]))
        assert_accurate(theirs, every(c_x=scale, c_z=-2 * scale, omega=[0.0, 0.5 * scale]))


def t12_odd_numbers(theirs):
    """nan and inf are INVALID, not a regime; float32 stays float32, to 4 of its ulp."""
    hit = theirs.collide(np.array([np.nan, np.inf, -np.inf, 1.0]), -1.0, **AT)
    assert (hit.regime == Regime.INVALID).tolist() == [True, True, True, False]
    assert np.isnan(hit.P_z).tolist() == [True, True, True, False]
    impacts = sampling.everyday(300, seed=31)
    single = impacts._make(column.astype(np.float32) for column in impacts)
    assert single.collide(collide=theirs.collide).c_x.dtype == np.float32
    errors, wrong = sampling.compare(single, collide=theirs.collide, digits=24)
    assert not wrong
    assert errors.max() <= 4


def t13_critical_tilts(theirs):
    """Eq. (23) cancels: nine digits are lost at mu = 1e-4, all of them at 1e-9. To 2 ulp."""
    rng = default_rng(1)
    small, close, any_of_them = rng.uniform(
        [[-300], [-16], [0]], [[np.log10(0.75)], [-1], [0.75]], (3, 1000)
    )
    ends = [0.75, np.nextafter(0.75, 0), 1e-300, 1e-150, 1e-9, 1e-4, 0.6]
    for friction in (*10**small, *0.75 - 10**close, *any_of_them, *ends):
        with mpmath.workdps(700 if friction < 1e-15 else 60):  # a small root cancels
            root = mpmath.sqrt(9 - 16 * mpf(friction) ** 2)
            exact = (mpmath.atan((3 + sign * root) / (2 * mpf(friction))) for sign in (-1, 1))
            for got, want in zip(theirs.critical_tilts(friction), exact, strict=True):
                assert ulps(got, want) <= 2
    assert_array_equal(
        theirs.critical_tilts(np.array([0.0, 0.75, np.nextafter(0.75, 1)])),
        [[0.0, np.arctan(2), np.nan], [np.pi / 2, np.arctan(2), np.nan]],
    )


def t14_long_levers(theirs):
    """With X, Z up to 100 k errors grow no faster than the condition number AC/(AC - B^2)."""
    rng = default_rng(32)
    X, Z = 10 ** rng.uniform(-1, 2, (2, 400)) * rng.choice([-1, 1], (2, 400))
    A, B, C = 1 + X * X, X * Z, 1 + Z * Z
    impacts = sampling.everyday(400, seed=32)._replace(
        X=X,
        Z=Z,
        k=np.ones(400),
        omega=np.zeros(400),
        friction=10 ** rng.uniform(-2, 2, 400),
        plate_velocity=np.full(400, 2.0),
    )
    assert_accurate(theirs, impacts, 8 + 2 * A * C / (A * C - B * B))


def t15_edges_inside_arrays(theirs):
    """The branch not taken divides by zero; nobody hears of it."""
    edges = PLAIN | {"X": SIDES, "friction": [0.0, 0.5, 2.5, np.inf], "restitution": 0.25}
    with np.errstate(all="raise"):
        hit = every(**edges, c_x=SIDES).collide(collide=theirs.collide)
    assert np.isfinite(hit).all()


def t16_nothing_moves_nothing_holds(theirs):
    """No slip, no friction, no lever: nothing to divide by, and the contact simply stays."""
    assert_digits(theirs, every(c_x=0.0, tilt=0.0, friction=0.0), "P_x", "P_z", limit=4)


def t19_infinite_friction(theirs):
    """Impacts that graze, hardly approach or begin at rest but for that have the limit."""
    grazing = {"c_z": [-1e-15, -1e-40, -1e-100], "friction": np.inf}
    for impacts in (every(**grazing, **PLAIN, c_x=[0.0, 1.0]), every(**grazing, X=[0.0, ROD.X])):
        assert_digits(theirs, impacts, "P_x", "omega", "normal_velocity")


def t20_a_mass_in_a_point(theirs):
    """A k down to the smallest number, against lever and speed, has a regime and no nan."""
    slide = every(X=0.0, Z=1.0, k=1e-155, friction=0.0).collide(collide=theirs.collide)
    assert (slide.regime, slide.c_z, slide.P_z) == (Regime.SLIDE, 0.5, 1.5)
    rng = default_rng(34)
    odd = np.array([0.0, 1.0, -1.0, 1e-5, -1e-60, 1e60, 1e-155, -1e-300])
    c_x, c_z, omega, X, Z = rng.choice(odd, (5, 20_000))
    k = rng.choice([5e-324, 1e-300, 1e-155, 1e-80, 1e-60, 1.0], 20_000)
    friction = rng.choice([0.0, 0.3, 1e-20, 1e40, 1e300, np.inf], 20_000)
    for law in laws_of(theirs):
        impacts = sampling.Impacts(c_x, c_z, omega, 0.0, X, Z, k, friction, 0.5)
        assert not np.isnan(impacts.collide(law, theirs.collide)).any()


CASES = [value for name, value in list(globals().items()) if name[0] == "t" and name[1].isdigit()]


@pytest.mark.parametrize("case", CASES)
def test_hard_case(case):
    """Ours passes, the straightforward formulas do not."""
    case(impact)
    with np.errstate(all="ignore"), pytest.raises((AssertionError, FloatingPointError)):
        case(straightforward)
