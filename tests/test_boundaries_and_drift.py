"""Regime boundaries and stationary drift against the impact map and 50-digit arithmetic."""

import mpmath
import numpy as np
import pytest
from mpmath import mpf

import impact
from figures.theory import stationary
from impact import ContactGeometry, Regime

from . import sampling
from .reference import reference_collide

EPS = np.finfo(float).eps


def ulps(got, want) -> float:
    """Distance in units in the last place of the exact value."""
    return float(abs(mpf(float(got)) - want) / mpf(np.spacing(abs(float(want)))))


def exact_tangents(mu):
    """Both roots of mu (1 + 3 cos^2) = 3 sin cos, a quadratic in the tangent."""
    root = mpmath.sqrt(9 - 16 * mu**2)
    return mpmath.atan((3 - root) / (2 * mu)), mpmath.atan((3 + root) / (2 * mu))


def test_critical_tilts_to_2_ulp_for_every_friction():
    rng = np.random.default_rng(1)
    friction = np.concatenate(
        [
            10 ** rng.uniform(-300, np.log10(0.75), 1000),
            0.75 - 10 ** rng.uniform(-16, -1, 1000),
            0.75 * rng.uniform(size=1000),
            [0.75, np.nextafter(0.75, 0), 1e-300, 0.6],
        ]
    )
    lower, upper = impact.critical_tilts(friction)
    for mu, *got in zip(friction, lower, upper, strict=True):
        with mpmath.workdps(700 if mu < 1e-15 else 60):  # a small root cancels
            assert max(map(ulps, got, exact_tangents(mpf(float(mu))))) <= 2, mu


def test_critical_tilts_at_the_ends():
    np.testing.assert_array_equal(
        impact.critical_tilts(np.array([0.0, 0.75, np.nextafter(0.75, 1)])),
        [[0.0, np.arctan(2), np.nan], [np.pi / 2, np.arctan(2), np.nan]],
    )


def test_critical_friction_separates_stick_from_reversal():
    rng = np.random.default_rng(2)
    X, Z, k = sampling.geometries(rng, 5000)
    geometry = ContactGeometry(X, Z, k)
    critical = impact.critical_friction(geometry)
    for factor, regime in ((1 + 1e-12, Regime.SLIP_STICK), (1 - 1e-12, Regime.SLIP_REVERSAL)):
        # no slip at first, so the contact has to decide at once
        got = impact.classify(
            0.0, -1.0, geometry=geometry, friction=factor * critical, restitution=0.5
        )
        assert (got[critical > 1e-12] == regime).all()


def test_painleve_friction_is_where_an_impact_needs_no_approach():
    """Beyond it slip towards -x presses the contact in, as far as the slip goes; any geometry."""
    rng = np.random.default_rng(7)
    X, Z, k = sampling.geometries(rng, 2000)
    geometry = ContactGeometry(X, Z, k)
    friction = impact.painleve_friction(geometry)
    with mpmath.workdps(50):
        for got, x, z, r in zip(friction, *(map(mpf, part) for part in geometry), strict=True):
            assert x == 0 or ulps(got, (r * r + x * x) / abs(x * z)) <= 3
    ways, backwards = {"geometry": geometry, "restitution": 0.5}, -np.sign(X * Z)
    for factor, pressed in ((1.01, True), (0.99, False)):
        hit = impact.collide(backwards, -1e-9, friction=factor * friction, **ways)
        np.testing.assert_array_equal((hit.P_z > 1e-5)[friction < 1e3], pressed)
    assert impact.painleve_friction((-0.0, 0.5, 0.3)) == np.inf


def test_slide_friction_is_where_the_slide_ends():
    """Of all shapes and tilts, upright and lying rods among them."""
    rng = np.random.default_rng(3)
    n = 5000
    X, Z, k = sampling.geometries(rng, n)
    X[:50], Z[50:100] = 0, 0
    ratio, restitution = 10 ** rng.uniform(-2, 2, n), rng.uniform(0, 1, n)
    setting = {"geometry": ContactGeometry(X, Z, k), "restitution": restitution}
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


@pytest.mark.parametrize("shape", [impact.thin_rod, impact.spherocylinder, impact.flat_ended_rod])
def test_drift_repeats_itself(shape):
    """One landing gives back c_x and turns c_z round: the definition, through `collide`."""
    rng = np.random.default_rng(4)
    n = 2000
    tilt = np.append(rng.uniform(-1.5, 1.5, n - 3), [0.0, -np.pi / 2, np.pi / 2])
    geometry = shape(tilt, 1 + 10 ** rng.uniform(-1, 1, n))
    settings = {"friction": rng.uniform(0.01, 2, n), "restitution": rng.uniform(0, 0.99, n)}
    found = impact.drift(geometry, plate_velocity=0.7, **settings)
    hit = impact.collide(found.c_x, -found.c_z, geometry=geometry, plate_velocity=0.7, **settings)
    scale = np.abs(found.c_x) + found.c_z + 0.7
    assert (np.abs(hit.c_x - found.c_x) <= 64 * EPS * scale).all()
    assert (np.abs(hit.c_z - found.c_z) <= 64 * EPS * scale).all()
    sticks = settings["friction"] >= impact.critical_friction(geometry)
    np.testing.assert_array_equal(found.regime == Regime.SLIP_STICK, sticks)
    assert not (hit.regime == Regime.SLIDE).any()


def test_drift_without_friction_is_undetermined():
    rod = impact.thin_rod(0.4)
    none, little, much = (impact.drift(rod, friction=f, restitution=0.65) for f in (0, 1e-12, 10))
    assert np.isnan(none.c_x)
    assert np.isfinite(none.c_z)
    assert none.regime == Regime.INVALID
    assert little.c_x == pytest.approx(much.c_x / 2, rel=1e-11)


def steady(X, Z, k, e):
    return tuple(impact.drift((X, Z, k), friction=0.3, restitution=e))


def energy(X, Z, k, mu):
    return impact.energy_restitution((X, Z, k), mu)


EXTREME = [
    *((steady, (far, far, 1, 0.5), steady(1e100, 1e100, 1, 0.5)) for far in (1e155, 1e200)),
    *(
        (steady, (0.3, 0.4, k, 0.65), (1.54, 0, Regime.SLIP_REVERSAL))
        for k in (1e-60, 1e-155, 1e-320)
    ),
    (lambda *rod: impact.critical_friction(rod), (1e300, 1.0, 1.0), 5e299),
    (lambda *rod: impact.critical_friction(rod), (1.0, 1e-200, 1e-200), 5e199),
    (lambda *rod: 1e200 * impact.painleve_friction(rod), (1e-200, 1.0, 1e-200), 2),
    *(
        (energy, (X, Z, k, mu), energy(X, Z, 1e-60, mu))
        for X, Z, mu in ((1.0, 1.0, 0.1), (0.3, 0.4, 0.0), (0.3, 0.4, 0.3), (0.3, 0.4, 5.0))
        for k in (1e-70, 1e-100, 1e-155, 1e-320)
    ),
    (
        lambda x: impact.relaxation((x, 3 * x, 1.0), friction=1.0, restitution=0.5),
        (1e200,),
        impact.relaxation((1e20, 3e20, 1.0), friction=1.0, restitution=0.5),
    ),
    *(
        (lambda q: impact.landing_density(0.0, fall_speed=q), (q,), 1 / (2 * np.pi))
        for q in (1e200, 1e308, 1.7e308)
    ),
]


@pytest.mark.parametrize(("function", "extreme", "wanted"), EXTREME)
def test_extreme_numbers_have_the_answer_of_large_ones(function, extreme, wanted):
    """Where squares of levers far beyond k, or of k far below them, are no numbers."""
    assert function(*extreme) == pytest.approx(wanted, rel=1e-14, abs=1e-59)


@pytest.mark.parametrize("unit", [2.0**-900, 2.0**900])
def test_units_of_length_cancel(unit):
    """Bit for bit."""
    rod, scaled = np.array([0.3, 0.4, 0.2]), unit * np.array([0.3, 0.4, 0.2])
    setting = {"friction": 0.1, "restitution": 0.5}
    for function, how in (
        (impact.drift, setting),
        (impact.relaxation, setting),
        (impact.critical_friction, {}),
        (impact.painleve_friction, {}),
        (impact.slide_friction, {"approach_ratio": 2.0, "restitution": 0.5}),
        (impact.energy_restitution, {"friction": 0.1}),
    ):
        assert function(scaled, **how) == function(rod, **how), function


def test_no_tilt_drifts_faster_than_the_optimal_one():
    """Against the drift on a fine grid of tilts, and at the optimum itself."""
    rng = np.random.default_rng(6)
    n, tilts = 400, np.linspace(1e-3, np.pi / 2, 4001)
    settings = {"friction": 10 ** rng.uniform(-2, 0.3, n), "restitution": rng.uniform(0, 0.99, n)}
    best = impact.optimal_tilt(**settings)
    columns = {name: value[:, None] for name, value in settings.items()}
    other = impact.drift(impact.thin_rod(tilts), **columns)
    assert (other.c_x <= best.c_x[:, None] * (1 + 8 * EPS)).all()
    assert (other.c_x.max(axis=1) > best.c_x * (1 - 1e-3)).all()
    found = impact.drift(impact.thin_rod(best.tilt), **settings)
    np.testing.assert_allclose(found.c_x, best.c_x, rtol=32 * EPS)
    corner = np.abs(best.tilt - impact.critical_tilts(settings["friction"])[0]) < 1e-6
    assert set(best.regime[~corner]) == {Regime.SLIP_STICK, Regime.SLIP_REVERSAL}
    assert set(best.regime[corner]) == {Regime.SLIP_STICK}
    np.testing.assert_array_equal(found.regime[~corner], best.regime[~corner])


@pytest.mark.parametrize("friction", [1e-3, 0.05, 0.09, 0.12, 0.16, 0.2, 0.75, 0.8, np.inf])
def test_optimal_tilt_to_the_last_digits(friction):
    """Against a search at 50 digits on the formulas of the paper, (26) and (29)."""
    with mpmath.workdps(50):
        e, mu = mpf("0.65"), mpf(friction)

        def drift(t):
            back = (1 + e) * (mu * (4 + t * t) + 3 * t) if 3 * t > mu * (4 + t * t) else None
            top = 6 * (1 + e) * t if back is None else back
            return top / (1 - e + (7 - e) * t * t)

        low, high = mpf(0), mpf(1)
        golden = (mpmath.sqrt(5) - 1) / 2
        for _ in range(260):
            a, b = high - golden * (high - low), low + golden * (high - low)
            low, high = (a, high) if drift(a) < drift(b) else (low, b)
        found = impact.optimal_tilt(friction=friction, restitution=float(e))
        assert ulps(found.c_x, drift(low)) <= 8
        assert abs(found.tilt - float(mpmath.atan(low))) < 1e-15


def test_optimal_tilt_at_the_ends():
    lossless = impact.optimal_tilt(friction=0.3, restitution=1.0)
    assert (lossless.tilt, lossless.c_x) == (0, np.inf)
    undetermined = impact.optimal_tilt(friction=0.0, restitution=0.5)
    assert np.isnan(undetermined.c_x)
    assert undetermined.regime == Regime.INVALID


def exact_relaxation(geometry, **how):
    """The same from whole impacts at 50 digits, and how far apart the eigenvalues are."""
    start = impact.drift(geometry, **how)
    c_x, c_z, step = mpf(float(start.c_x)), -mpf(float(start.c_z)), mpf(10) ** -12
    after = []
    for moved in ((c_x, c_z), (c_x + step, c_z), (c_x, c_z + step)):
        hit = reference_collide(*moved, 0, **geometry._asdict(), **how, plate_velocity=1, dps=50)
        after.append(mpmath.matrix([hit.c_x, -hit.c_z]))
    a, c, b, d = (x / step for moved in after[1:] for x in moved - after[0])
    root = mpmath.sqrt((a - d) ** 2 + 4 * b * c)
    largest = max(abs(a + d + root), abs(a + d - root)) / 2
    return -1 / mpmath.log(largest), abs(root)


@pytest.mark.parametrize("kind", ["any", "slippery", "lossless"])
def test_relaxation_by_whole_impacts(kind):
    """Also where a deviation lasts for millions of landings."""
    rng = np.random.default_rng(8)
    n = 60
    geometry = ContactGeometry(*sampling.geometries(rng, n))
    friction, restitution = rng.uniform(0.01, 1.5, n), rng.uniform(0, 1, n)
    if kind == "slippery":
        friction *= 1e-9
    elif kind == "lossless":
        restitution = 1 - 1e-12 * restitution
        geometry = impact.thin_rod(10 ** rng.uniform(-9, -6, n))
    how = {"friction": friction, "restitution": restitution}
    got = impact.relaxation(geometry, **how)
    with mpmath.workdps(60):
        for found, mu, e, *lengths in zip(got, friction, restitution, *geometry, strict=True):
            rod = ContactGeometry(*map(float, lengths))
            want, apart = exact_relaxation(rod, friction=float(mu), restitution=float(e))
            assert abs(found - want) <= 8 * EPS * want / apart
    assert kind == "any" or got.min() > 1e6
    mirrored = impact.relaxation(geometry._replace(X=-geometry.X), **how)
    np.testing.assert_array_equal(mirrored, got)


def test_relaxation_and_cost_at_the_ends():
    tilt, friction, restitution = np.transpose(
        [(0, 0.3, 0.65), (0, 0.3, 1), (0, 0, 0.6), (1, 0, 1)]
    )
    rod, how = impact.thin_rod(tilt), {"friction": friction, "restitution": restitution}
    kept = [1 / np.log(4 / 3), np.inf, np.inf, np.inf]
    np.testing.assert_allclose(impact.relaxation(rod, **how), kept, rtol=4 * EPS)
    np.testing.assert_array_equal(impact.transport_cost(rod, **how), [np.inf, 0, np.nan, np.nan])
    assert impact.transport_cost((0.5, 0.0, 0.3), friction=0.3, restitution=0.65) == np.inf
    e, k = np.random.default_rng(10).uniform(0.1, 1, (2, 1000))  # a lying rod forgets at once
    at_once = impact.relaxation((np.sqrt(e) * k, 0.0, k), friction=0.3, restitution=e)
    assert ((at_once >= 0) & (at_once < 0.04)).all()


def test_cost_is_the_work_of_the_plate_on_the_way_of_a_flight():
    rng = np.random.default_rng(9)
    geometry = ContactGeometry(*sampling.geometries(rng, 2000))
    friction, restitution = rng.uniform(0.01, 2, 2000), rng.uniform(0, 0.99, 2000)
    how = {"geometry": geometry, "friction": friction, "restitution": restitution}
    found = impact.drift(**how)
    work = impact.collide(found.c_x, -found.c_z, plate_velocity=1.0, **how).P_z
    way = np.abs(2 * found.c_x * found.c_z)  # times the acceleration of gravity
    np.testing.assert_allclose(impact.transport_cost(**how), work / way, rtol=128 * EPS)


def test_flat_end_drifts_backwards_below_its_threshold():
    """The sign turns at arctan(d/l): 7.125 degrees for l = 8 d."""
    threshold = np.arctan(1 / 8)
    tilt = threshold * np.array([1e-6, 0.5, 1 - 1e-9, 1 + 1e-9, 2.0])
    found = impact.drift(impact.flat_ended_rod(tilt, 8.0), friction=0.3, restitution=0.65)
    assert (np.sign(found.c_x) == [-1, -1, -1, 1, 1]).all()
    mirrored = impact.drift(impact.flat_ended_rod(-tilt, 8.0), friction=0.3, restitution=0.65)
    np.testing.assert_array_equal(mirrored.c_x, -found.c_x)
    edges = [impact.flat_ended_rod(zero, 8.0).X for zero in (0.0, -0.0)]
    assert edges == [-0.5, 0.5]


@pytest.mark.parametrize("shape", [impact.spherocylinder, impact.flat_ended_rod])
def test_gyration_radius(shape):
    """Against numerical integration over the solid, at 30 digits."""
    with mpmath.workdps(30):
        half = mpf("2.75")

        def radius(z):
            past = max(abs(z) - (half - mpf(1) / 2), 0) if shape is impact.spherocylinder else 0
            return mpmath.sqrt(mpf(1) / 4 - past**2)

        nodes = [-half, -half + 0.5, 0, half - 0.5, half]
        mass = mpmath.quad(lambda z: radius(z) ** 2, nodes)
        moment = mpmath.quad(lambda z: radius(z) ** 2 * z**2 + radius(z) ** 4 / 4, nodes)
        assert ulps(shape(0.3, 5.5).k, mpmath.sqrt(moment / mass)) <= 4


def first_contacts(fall, rods):
    """Landing phases of rods that fall one behind the other, each followed until it is met."""
    phase = np.linspace(-6 * np.pi, 6 * np.pi, 200_001)
    highest = np.maximum.accumulate(fall * phase + np.sin(phase))  # rods below it have been met
    lines = 1 + 2 * np.pi * fall * (np.arange(rods) + 0.5) / rods
    return phase[np.searchsorted(highest, lines)]


@pytest.mark.parametrize("fall", [0.01, 0.05, 0.4, 0.6, 0.999, 1.0, 1.7, 50.0])
def test_landing_density_counts_every_rod_once(fall):
    """One in all, in proportion to the approach or zero, and as rods counted one by one."""
    phase = np.linspace(-np.pi, np.pi, 200_001)
    density = impact.landing_density(phase, fall_speed=fall)
    assert np.trapezoid(density, phase) == pytest.approx(1, abs=1e-4)
    lit = density > 0
    np.testing.assert_allclose(density[lit] * 2 * np.pi * fall, (fall + np.cos(phase))[lit])
    counted = first_contacts(fall, 20_000)
    for name in (np.cos, np.sin):
        mean = np.trapezoid(density * name(phase), phase)
        assert np.mean(name(counted)) == pytest.approx(mean, abs=3e-4)


@pytest.mark.parametrize(
    ("fall", "alpha"), [(0.6, 0.709), (0.4, 0.769), (0.05, 0.458), (1.0, 0.5), (2.0, 0.25)]
)
def test_mean_plate_velocity_of_first_contacts(fall, alpha):
    """As derived, and as counted by hand; sqrt(q) 4/3 sqrt(pi) for the slowest."""
    derived = stationary.alpha_of_fall(np.array(fall))
    mean = impact.mean_plate_velocity(
        lambda x: impact.landing_density(x, fall_speed=fall), points=200_000
    )
    assert derived == pytest.approx(alpha, abs=5e-4)
    assert mean == pytest.approx(derived, abs=2e-5)
    slow = stationary.alpha_of_fall(np.array([1e-6, 1e-8]))
    assert slow / np.sqrt([1e-6, 1e-8]) == pytest.approx(4 / 3 * np.sqrt(np.pi), rel=1e-2)


def test_mean_plate_velocity():
    assert impact.mean_plate_velocity() == pytest.approx(0.5, rel=1e-14)
    assert impact.mean_plate_velocity(plate_speed=np.array([2.0, -4.0])) == pytest.approx([1, -2])
    assert impact.mean_plate_velocity(np.ones_like) == pytest.approx(0, abs=1e-15)
    upstroke = impact.mean_plate_velocity(lambda phase: (np.cos(phase) > 0).astype(float))
    assert upstroke == pytest.approx(2 / np.pi, abs=1e-6)
