"""M15: what rods keep as they move, in the plane and in space: energy, momentum, symmetries."""

from dataclasses import replace
from functools import partial
from math import cos, pi

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

import md
from md.host import plate_motion, prepare
from md.kernels import (
    C_X,
    C_Z,
    COSINE,
    DIRECTOR,
    FELL,
    PAIR_FRICTION,
    PAIR_NORMAL,
    PLATE_FRICTION,
    PLATE_NORMAL,
    PLATE_WORK,
    REGIMES,
    SINE,
    TURN,
    VELOCITY,
    X,
    Z,
)
from md.kernels.contact import Friction
from md.kernels.state import Walls
from md.kernels.touches import REGIME
from md.placement import placed

from .rows import (
    AT_REST,
    CONSTRAINT,
    ELASTIC_PLANE,
    ELASTIC_RODS,
    EXPERIMENT,
    HALF,
    HELD,
    PLANE,
    ROLLING,
    ROLLS,
    SPACE,
    around,
    go,
    in_plane,
    in_space,
    kinetic,
    momenta,
    recorded,
    resting_overlap,
    ring,
    row,
    seeded,
    started,
    tip_on_side,
    unit,
    vectors,
)
from .sampling import EPS, power
from .track import CONTACT, LAWS, damped, effects, track

LOSSLESS = ELASTIC_RODS._asdict()


def two(seed):
    """Rods in space that will meet, crossing or nearly parallel."""
    random = default_rng(seed)
    place = random.uniform(-2, 2), 1.6, random.uniform(-2, 2)
    slants = [(random.uniform(-0.5, 0.5), random.uniform(-0.05, 0.05), 1) for _ in range(2)]
    first = (0, 0, 0), slants[0], (0, 0.4, 0)
    return in_space(first, (place, slants[1], (0.05, -0.4, 0.02)), aside=20.0)


def thrown(lean):
    """Rods in the plane of which the end of one meets the side of the other, both turning."""
    first, second = tip_on_side(lean, 1.7)
    return in_plane((*first, 0.3, -1.0, 0.1), (*second, -0.2, 0.4, -0.2))


def beside_the_plate(*rod):
    """A rod in the plane over the plate, and one far from it: one alone has another kernel."""
    return in_plane(rod, (1e3, 1e3, 0.0))


def alone(scene, *rod, dt=1e-4):
    """A rod in the plane over the plate, and no other: its kernel compiles sooner."""
    return started(scene._replace(between=None, period=None), in_plane(rod), dt)


# Momentum and symmetries


@pytest.mark.parametrize(
    ("scene", "rods", "steps", "rounding"),
    [
        *((PLANE, thrown(lean), 500, 1e-12) for lean in (0.0, 0.3, 1.2, 1.56)),
        *((SPACE, two(seed), 40_000, 1.0) for seed in range(4)),  # which leaves axial turns out
        *((ROLLS, two(seed), 40_000, 1e-8) for seed in range(4)),
    ],
)
def test_momentum_and_angular_momentum_are_kept(scene, rods, steps, rounding):
    """Both are kept with friction, springs and dashpots: a force acts on both rods at one point.

    Each of some 500 steps rounds the sum of two velocities of at most 2, the moment arms are at
    most 5: 500 * 2 * 5 * EPS = 1e-12.
    """
    engine = started(scene, rods)
    before, energy = momenta(engine), kinetic(engine)
    after = momenta(go(engine, steps))
    assert abs(kinetic(engine) / energy - 1) > 1e-3
    assert engine.ledger[PAIR_NORMAL] > 0.01
    assert abs(engine.ledger[PAIR_FRICTION]) > 1e-4
    assert_allclose(after[0], before[0], rtol=0, atol=1e-12)
    assert_allclose(after[1], before[1], rtol=0, atol=rounding)


FLOATING = "gravity.z=0", "start.speed=0.3"


@pytest.mark.parametrize(
    "scene",
    [row(*FLOATING), row(*FLOATING, "box=none", "start.tilt_deg=30"), md.load("annulus", FLOATING)],
    ids=["row", "open row", "annulus"],
)
def test_rods_start_apart_and_with_no_momentum(scene):
    """Nothing acts in the first step without gravity, and seeded velocities have no mean.

    Where rods touch, rounding pushes them. The mean is that along the plate, or around the annulus.
    """
    engine, moving = prepare(scene), VELOCITY if scene.annulus else C_X
    if not scene.annulus:
        engine.effects = engine.effects._replace(period=engine.effects.period or 1e6)
    before = engine.rods.copy()
    velocity = before[:, moving:]
    assert_array_equal(go(engine, 1).rods[:, moving:], velocity)
    along = around(before, velocity) if scene.annulus else velocity[:, 0]
    assert np.abs(along).max() > 0.1
    assert abs(along.mean()) < EPS


def test_m15_horizontal_momentum_where_nothing_acts():
    """Horizontal velocity without friction stays, to 1e-12, however many impacts there are."""
    dt, steps = 4e-5, 1_000_000
    scene = effects(md.coulomb(), 0.0, (0.0, -1.0))
    start = 0.0, 5.0, 0.1, 0.3, 0.0, 0.0
    samples = track(scene, start, dt, steps, every=1000)
    assert np.abs(samples[:, 5]).max() > 0.1  # it was hit
    assert np.abs(samples[:, 3] - 0.3).max() <= 1e-12
    flown = samples[-1, 0] - samples[0, 0]
    assert flown == pytest.approx(0.3 * dt * steps, rel=1e-10)  # the sum of a million parts


def test_a_free_top_precesses_as_it_should():
    """The spin w is conserved, and the director turns about it at |w|."""
    rods, w = in_space(((0, 0, 0), (1, 2, 3)), aside=20.0), np.array([0.3, -0.2, 0.5])
    rods[0, TURN:] = w
    [found] = go(started(ROLLS, rods, dt=1e-3), 5000).rods
    assert_array_equal(found[TURN:], w)
    expected = Rotation.from_rotvec(w * 5.0).apply(unit([1, 2, 3]))
    assert_allclose(found[DIRECTOR:VELOCITY], expected, atol=1e-10)


SHAKEN = plate_motion(row("plate.acceleration=5"), 6739)


@pytest.mark.parametrize("space", [SPACE, ROLLS], ids=["spring", "constraint"])
def test_rods_in_a_plane_do_in_space_as_in_the_plane(space):
    """Motion, ledger and records of rods in space are those of the row; y stays as it is.

    With friction and losses, in a crowd and each alone at its own tilt.
    """
    tilts = np.radians([20] * 6 + [-5, 10, 30, 50, 70, 85])
    x = np.r_[1.0653 * np.arange(6), 32.0 * np.arange(1, 7)]  # rods at 20 degrees touch at 1.0642
    z = SHAKEN.height[0] + 0.51 + HALF * np.cos(tilts)
    along, up = 0.3 * default_rng(1).uniform(-1, 1, (2, 12))
    along[6:] = 0.7, 0.5, 0.3, 0, 1, -1
    flat = in_plane(*np.column_stack([x, z, tilts, along, up, 0 * x]))
    row_of_them = PLANE._replace(gravity=(0.0, -1.0), plate=SHAKEN, friction=space.friction)
    plane = started(row_of_them, flat)
    place, director, velocity, _ = vectors(plane, flat)
    rods = in_space(*zip(place, director, velocity, strict=True), aside=500.0)  # between the walls
    engine = go(started(space._replace(gravity=-1.0, plate=SHAKEN), rods), 6000)
    found, expected = (np.array(vectors(e, e.rods)) for e in (engine, go(plane, 6000)))
    found[0, :, 1] += 500.0
    assert (plane.ledger[:4] > 1e-4).all()  # they met
    assert_allclose(found, expected, rtol=0, atol=1e-8)
    assert np.abs(found[expected == 0]).max() < 1e-12  # y, and turns about other axes
    assert_allclose(engine.ledger, [*plane.ledger, 0, 0], rtol=0, atol=1e-4)
    touches, of_row = map(recorded, (engine, plane))
    assert len(of_row) > 12
    assert set(of_row[:, REGIME]) == set(REGIMES)
    assert_allclose(touches, of_row, rtol=1e-7, atol=1e-8)


# The order of the energy


def passing(dt, offset):
    """Two rods that are pressed together while they slide past each other's end."""
    x, z = 1.001 + HALF * np.sin(1e-3), HALF - 0.12 - 10 * offset * dt + HALF * cos(1e-3)
    rods = in_plane((0.0, 0.0, 0.0), (x, z, 1e-3, -2.0, 10.0, 0.0))
    return started(ELASTIC_PLANE, rods, dt)


def meeting(dt, offset):
    """The end of a rod meets the side of another one."""
    first, second = tip_on_side(0.7, 2.0, (1 + offset) * dt)
    rods = in_plane((*first, 0.0, -1.0, 0.0), second)
    return started(ELASTIC_PLANE, rods, dt)


def near_ends(height, slant):
    """Rods in space within each other's reach, near their ends."""
    first = (0, 0, 0), (slant, 0, 1), (0, -0.1, 0.3)
    return in_space(first, ((0, -0.985, height), (-slant, 0.001, 1), (0.4, 0.1, -0.3)), aside=20.0)


def lively():
    """Rods in the gap over the plate, thrown about."""
    rods = np.zeros((44, TURN + 3))
    rods[:, :VELOCITY] = placed(EXPERIMENT, len(rods), 2 * HALF + 1, tilt=0.3)
    rods[:, Z + 1] += 0.01
    rods[:, VELOCITY:TURN] = default_rng(1).uniform(-1, 1, (len(rods), 3))
    return rods


MET = SPACE._replace(between=ELASTIC_RODS)
GAP = Walls(*ELASTIC_RODS, EXPERIMENT.inner, EXPERIMENT.outer)
WALLED = MET._replace(**LOSSLESS, walls=GAP, plate=AT_REST, gravity=-1.0)
ALONG, LEANING = (  # where it leans more, the weight of its contact between the ends has a slope
    in_space(((EXPERIMENT.inner + 0.49, 0, 10), (0.001, lean, 1), (-0.3, 0.5, 0)))
    for lean in (0.05, 0.22)
)
IN_SPACE = {
    "crowd": (WALLED, lively()),
    "along the wall": (WALLED, ALONG),
    "leaning on the wall": (WALLED, LEANING),
    "ends that meet": (MET, near_ends(8.45, 0.01)),
    "crossing at an end": (MET, near_ends(5.6, 0.7)),
}
ORDERS = {  # how they begin, time, samples of it, places of the touch in a step, steps, order
    "end on side": (meeting, 0.12, 1, 24, (2e-3, 1e-3, 5e-4, 2.5e-4), 1.75),
    "past each other": (passing, 0.06, 1, 12, (2e-4, 1e-4, 5e-5, 2.5e-5), 1.75),
    **{
        name: (lambda dt, _, rods=rods: started(*rods, dt), 0.08, 20, 1, (4e-4, 1e-4), 1.7)
        for name, rods in IN_SPACE.items()
    },
}


def energy_error(begin, time, samples, places, dt):
    """Largest change of energy and losses, range of the kinetic energy, and the last engine."""
    off, moving = [], []
    for place in range(places):
        engine = go(begin(dt, place / places), 1)
        before = engine.energy() + engine.ledger.sum()
        for _ in range(samples):
            go(engine, round(time / samples / dt))
            off.append(engine.energy() + engine.ledger.sum() - before)
            moving.append(kinetic(engine))
    return np.abs(off).max(), np.ptp(moving), engine


@pytest.mark.parametrize("name", ORDERS)
def test_m15_elastic_contacts_keep_energy_to_second_order(name):
    """It holds whichever part of a step the touch falls in, and amid contacts, with samples."""
    *how, steps, least = ORDERS[name]
    found, moved, engines = zip(*(energy_error(*how, dt) for dt in steps), strict=True)
    assert np.abs(engines[0].ledger).max() < 1e-12
    assert how[2] == 1 or moved[0] > 0.03  # the contacts hold energy
    assert found[0] < 1e-2 * engines[0].energy()
    assert power(steps, found) > least


def after_a_period(scene, per, lossy):
    """Places of rods after a period of `per` steps, from velocities half a step before it."""
    scene = replace(scene, step=md.Step((1 + 1e-9) / scene.frequency / per, coarse=True))
    engine = prepare(scene)
    if not lossy:
        lossless = engine.effects._replace(**LOSSLESS, between=ELASTIC_RODS)
        walls = lossless.walls and lossless.walls._replace(**LOSSLESS)
        engine.effects = lossless._replace(walls=walls)
    engine.rods[:, VELOCITY + 2 if scene.annulus else C_Z] += engine.dt / 2
    return vectors(go(engine, per), engine.rods)[0]


PERIODS = {  # the scene, whether contacts lose energy, the least order
    "row, elastic": (row(), False, 1.9),
    "row": (row(), True, 1.5),
    "row, constraint": (row(*CONSTRAINT), True, 1.5),
    "walls, elastic": (ring(), False, 1.8),
    "walls": (ring(), True, 1.1),
    "walls, constraint": (ring(*ROLLING), True, 0.95),
}


@pytest.mark.parametrize("name", PERIODS)
def test_m15_places_after_a_period_converge(name):
    """Places of eight starts approach, in the mean square, those of far shorter steps.

    The longest steps are a run's. A dashpot, whose force begins as the overlap to 1/4, and a slide
    that ends within a step have a lower order.
    """
    scene, lossy, least = PERIODS[name]
    pers, errors = np.array([1000, 2000, 4000, 32_000]), []
    for seed in range(8):
        *coarse, fine = (after_a_period(seeded(scene, seed), n, lossy) for n in pers.tolist())
        errors.append([np.mean((places - fine) ** 2) for places in coarse])
    errors = np.sqrt(np.mean(errors, axis=0))
    assert errors[0] < 3e-4  # of some tenths that the rods move
    assert -power(pers[:-1], errors) > least


def impact(law, friction, dt, offset):
    """A rod at a tilt of 20 degrees that is about to meet the plate."""
    normal, rub, tilt = damped(law.normal), Friction(friction, law.spring), pi / 9
    scene = PLANE._replace(plate=AT_REST, normal=normal, friction=rub)
    height = HALF * cos(tilt) + 0.5 + (1 + offset) * dt
    rod = 0.0, height, tilt, 0.5, -1.0, 0.0
    if law == LAWS["constant_restitution"]:  # as in other tests
        return started(scene, beside_the_plate(*rod), dt)
    return alone(scene, *rod, dt=dt)


@pytest.mark.parametrize(
    ("law", "friction"), [*((law, 0.3) for law in LAWS), ("coulomb", 0.0), ("elastic", 0.0)]
)
def test_m15_energy_ledger_closes_to_second_order(law, friction):
    """Energy and ledger add to that before, (1 + 0.5^2)/2, at the worst of 16 places of the touch.

    After the contact and in the midst of it, where the overlap holds energy.
    """
    begin, steps = partial(impact, LAWS[law], friction), CONTACT / 200 / 2 ** np.arange(4)
    for contacts in (0.4, 2.0):
        worst = [energy_error(begin, contacts * CONTACT, 1, 16, dt)[0] for dt in steps]
        assert worst[-1] < 4e-6
        assert power(steps, worst) >= 1.8


# The ledger of runs


THROWN = "plate.acceleration=5", "start.speed=0.5", "step.coarse=true"


@pytest.mark.parametrize(
    ("scene", "periods", "steps", "most"),
    [
        (partial(row, "start.speed=0.5"), 2, (3.6e-4, 1.8e-4, 9e-5, 4.5e-5), 1e-3),
        (partial(ring, *THROWN), 3, (4e-4, 1e-4), 2e-3),
        (partial(ring, *THROWN, *ROLLING), 3, (4e-4, 1e-4), 2e-3),
    ],
    ids=["row", "shaken walls", "rolling"],
)
def test_m15_the_ledger_closes_as_the_step_shrinks(scene, periods, steps, most):
    """The residual over all the energy that went in, out and over falls in second order.

    Losses go with the velocities of their step. The runs part ways at contacts, which scatters
    single halvings; over all of them the order holds to a quarter.
    """
    found = []
    for step in steps:
        energy = md.run(scene(f"step.size={step}"), periods=periods).energy
        residual = abs(energy.pop("residual"))
        found.append(residual / np.abs([*energy.values()]).sum())
    del energy["change"]
    assert min(energy.values()) > 1e-3  # what was put in, and what was lost
    assert power(steps, found) > 1.75
    assert found[0] < most


# Closed forms


def test_each_part_of_the_ledger_is_what_the_closed_form_says():
    """A rod that bounces upright loses (1 - e^2) c_z^2/2; one that slides flat, all its c_x^2/2.

    First order: steps of 1e-4, contacts of about 0.03.
    """
    scene = PLANE._replace(plate=AT_REST, friction=HELD)
    ledger = go(alone(scene, 0, HALF + 0.5 + 1e-6, 0, 0, -1, 0), 1000).ledger
    assert ledger[PLATE_NORMAL] == pytest.approx((1 - 0.65**2) / 2, rel=3e-3)
    assert abs(ledger[[PLATE_WORK, PLATE_FRICTION]]).max() < 1e-12

    z = 0.5 - resting_overlap(0.5)  # two caps carry the weight
    engine = go(alone(scene._replace(gravity=(0.0, -1.0)), 0, z, pi / 2, 0.1, 0, 0), 10_000)
    assert abs(engine.rods[0, C_X]) < 1e-6  # it rocks a little still
    assert engine.ledger[PLATE_FRICTION] == pytest.approx(0.1**2 / 2, rel=3e-3)
    assert engine.rods[0, X] == pytest.approx(0.1**2 / (2 * 0.3), abs=0.1 * 1e-4 * 2)


def test_the_mean_tilt_of_rods_that_lie_is_horizontal():
    """A rod has no head: 89 and -89 degrees are next to each other, also from period to period."""
    lying = row("rods.count=1", "box.length=20", "start.tilt_deg=90", "plate.acceleration=4.5")
    result = md.run(lying, periods=30)
    assert result.fell > 3
    assert np.ptp(result.tilt_series) < 30
    assert abs(result.tilt_deg) == pytest.approx(90, abs=10)


def test_falls_are_counted():
    """A rod that spins freely once around passes the horizontal twice."""
    per = 4000
    engine = started(PLANE, beside_the_plate(0, 0, np.radians(10), 0, 0, 2 * pi / per / 1e-3), 1e-3)
    series = engine.series(1)._replace(per=per, every=10)
    engine.go(per, series)
    assert series.rows[:, FELL].sum() == 2
    sine, cosine = engine.rods[0, [SINE, COSINE]]
    assert sine == pytest.approx(np.sin(np.radians(10)), abs=1e-9)
    assert np.hypot(sine, cosine) == pytest.approx(1, abs=4 * EPS)
