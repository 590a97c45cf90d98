"""Rods in space: closest points, conserved quantities, the plane found again, placement."""

from functools import partial
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import md
from figures.claims.measure_annulus import largest_tilt_of_flat
from md import placement
from md.host import prepare
from md.kernels import walls as geometry
from md.kernels.closest import nearest
from md.kernels.codes import (
    DIRECTOR,
    LEDGER_COLUMNS,
    PLACE,
    REGIMES,
    SKIN,
    SPACE_COLUMNS,
    TURN,
    VELOCITY,
)
from md.kernels.contact import ContactForces, Friction
from md.kernels.neighbours import pair_up
from md.kernels.state import Motion, Wall
from md.kernels.touches import REGIME
from md.kernels.vectors import IN_SPACE
from md.laws import deepest_overlap

from .rows import LIGHT, free
from .space import (
    ELASTIC,
    HALF,
    LOSSY,
    ROUGH,
    SMOOTH,
    Rods,
    effects,
    meeting,
    states,
    tuples,
    unit,
    within,
)
from .test_annulus import ring
from .test_row_limits import largest

INNER_RADIUS = 5.0
GAP = md.Annulus(7.28 / 2 / 0.635, 9.45 / 2 / 0.635)  # the experiment's, in rod diameters


def two(seed):
    """Rods that will meet, crossing or nearly parallel."""
    random = np.random.default_rng(seed)
    place = random.uniform(-2, 2), 1.6, random.uniform(-2, 2)
    slants = [(random.uniform(-0.5, 0.5), random.uniform(-0.05, 0.05), 1) for _ in range(2)]
    first = (0, 0, 0), slants[0], (0, 0.4, 0)
    return states(first, (place, slants[1], (0.05, -0.4, 0.02)))


# Closest points


@pytest.mark.parametrize("seed", range(25))
def test_two_axes_are_as_far_apart_as_brute_force_says(seed):
    random = np.random.default_rng(seed)
    apart, a, b = random.uniform(-3, 3, 3), unit(random.normal(size=3)), unit(random.normal(size=3))
    if seed % 5 == 0:
        b = a if seed % 2 else unit(a + 1e-9 * random.normal(size=3))
    found = np.sqrt(nearest(*tuples(apart, a, b), HALF))

    def distance(places):
        return np.linalg.norm(apart + places[0] * a - places[1] * b)

    starts = [(s, t) for s in (-HALF, 0, HALF) for t in (-HALF, 0, HALF)]
    best = min(minimize(distance, s, bounds=[(-HALF, HALF)] * 2, tol=1e-12).fun for s in starts)
    assert found == pytest.approx(best, abs=1e-6)
    assert found <= best + 1e-12


def test_the_inner_wall_is_as_near_as_brute_force_says():
    random, between = np.random.default_rng(3), 0
    for _ in range(50):
        place, a = random.uniform(-8, 8, 3), unit(random.normal(size=3))
        seen = geometry.from_above(*tuples(place, a))
        along = np.linspace(-HALF, HALF, 20001)[:, None]
        rho = np.hypot(*(place + along * a).T[:2])
        ends = [np.sqrt(geometry.beyond(seen, s)) for s in (-HALF, HALF)]
        np.testing.assert_allclose(ends, rho[[0, -1]], rtol=1e-12)
        least = rho.min()  # the grid is 4e-4 wide
        if least < min(ends) - 1e-9:
            between += 1
            assert geometry.passes(seen, HALF, least + 1e-12)
            assert not geometry.passes(seen, HALF, least - 3e-4)
            assert geometry.beyond(seen, -seen[1] / seen[2]) == pytest.approx(least**2, abs=2e-3)
        else:
            assert not geometry.passes(seen, HALF, 1e3)
    assert 10 < between < 40


def total_force(scene, rods):
    """On the first rod: force and torque."""
    one = Rods(scene, rods.copy(), dt=1e-9)
    one.go(1)
    return one.state.scratch.total


def round_an_end(x):
    end, director = (0.1, 0.98 * np.sin(5 * x), 4.25 + 0.98 * np.cos(5 * x)), unit((0.3, 0, 1))
    return states(((0, 0, 0), (0, 0, 1)), (end + HALF * director, director))


PATHS = {  # name: rods at a place of the path
    "through parallel": lambda x: states(((0, 0, 0), (x, 0.001, 1)), ((0, -0.98, 0), (0, 0, 1))),
    "off the end": lambda x: states(
        ((0, 0, 0), (0.7, 0, 1)), ((0, -0.98, 5.6 + 2 * x), (-0.7, 0, 1))
    ),
    "end past end": lambda x: states(((0, 0, 0), (0, 0.001, 1)), ((0, -0.98, 8.5 + x), (0, 0, 1))),
    "round an end": round_an_end,
    "past the inner wall": lambda x: states(((5.49, 0, 0), (0.001, x, 1))),
}


@pytest.mark.parametrize("path", PATHS)
def test_no_force_jumps(path):
    """Ten times finer steps along the path: changes from place to place ten times smaller."""
    biggest, scene = [], meeting(ELASTIC, SMOOTH)
    if path == "past the inner wall":
        scene = within(inner=Wall(5.0, ELASTIC, SMOOTH))
    for points in (2001, 20001):
        places = np.linspace(-0.3, 0.3, points)
        found = np.array([total_force(scene, PATHS[path](x)) for x in places])
        assert np.ptp(found, axis=0).max() > 1
        biggest.append(np.abs(np.diff(found, axis=0)).max())
    assert biggest[1] < 0.15 * biggest[0]


# What is conserved


@pytest.mark.parametrize("rolling", [None, 15.0])
@pytest.mark.parametrize("seed", range(4))
def test_momentum_and_angular_momentum_are_kept(seed, rolling):
    """With losses and friction; and the rods did meet."""
    scene = Rods(meeting(rolling=rolling), two(seed))
    momentum, turning = scene.moments()
    energy = scene.kinetic()
    scene.go(40_000)
    assert abs(scene.kinetic() / energy - 1) > 1e-3
    np.testing.assert_allclose(scene.moments()[0], momentum, rtol=0, atol=1e-12)
    if rolling is None:  # the axial part is what the scene leaves out
        return
    np.testing.assert_allclose(scene.moments()[1], turning, rtol=0, atol=1e-8)


@pytest.mark.parametrize("seed", range(6))
def test_elastic_rods_keep_their_energy(seed):
    """Better than 2e-6 of it at this step, whether they cross or touch at their ends."""
    scene = Rods(meeting(ELASTIC, SMOOTH), two(seed), dt=2e-4)
    energy = scene.kinetic()
    scene.go(20_000)
    assert np.abs(scene.rods[:, TURN:]).max() > 1e-3
    assert scene.kinetic() == pytest.approx(energy, rel=1e-5)
    scene = Rods(meeting(ELASTIC, SMOOTH), two(seed), dt=5e-5)
    scene.go(80_000)
    assert scene.kinetic() == pytest.approx(energy, rel=1e-6)


@pytest.mark.parametrize("length", [1.0, 3.0])
def test_caps_head_on_have_the_restitution_asked_for(length):
    """Ends that meet are one contact, as spheres are."""
    half, velocity = (length - 1) / 2, (0, 0, 0.5)
    rods = states(
        ((0, 0, 0), (0, 0, 1), velocity), ((0, 0, length), (0, 0, 1), np.negative(velocity))
    )
    scene = Rods(effects(half, between=ContactForces(LOSSY.normal, None)), rods, dt=6e-5).go(3000)
    assert scene.rods[1, VELOCITY + 2] - scene.rods[0, VELOCITY + 2] == pytest.approx(
        0.65, abs=2e-3
    )


def test_rods_in_a_plane_do_in_space_as_in_the_plane():
    """Two that slide past each other's end under losses and friction, to rounding."""
    ends_meet = [(0, 0, 0, 0, 0, 0), (1.001, 8.38, 1e-3, -2.0, 10.0, 0)]
    law = md.constant_restitution(stiffness=1e5)
    plane = free(law, ends_meet, dt=1e-4, friction=0.3)
    rods = [((x, 0, z), (np.sin(t), 0, np.cos(t)), (u, 0, w)) for x, z, t, u, w, _ in ends_meet]
    between = ContactForces(law.normal, Friction(0.3, law.spring))
    scene = Rods(effects(lightness=LIGHT, between=between), states(*rods), dt=1e-4)
    for _ in range(6):
        plane.go(50)
        scene.go(50)
        np.testing.assert_allclose(scene.rods[:, [6, 8, 10]], plane.rods[:, 4:], atol=1e-9)
    assert np.abs(plane.rods[:, 6]).min() > 0.1


def test_a_free_top_precesses_as_it_should():
    """w is conserved, and the director turns about it at |w|."""
    rods = np.zeros((1, SPACE_COLUMNS))
    w = np.array([0.3, -0.2, 0.5])
    rods[0, DIRECTOR:VELOCITY], rods[0, TURN:] = unit([1, 2, 3]), w
    first = rods[0, DIRECTOR:VELOCITY].copy()
    scene = Rods(meeting(rolling=15.0), rods, dt=1e-3).go(5000)
    np.testing.assert_array_equal(scene.rods[0, TURN:], w)
    expected = Rotation.from_rotvec(w * 5.0).apply(first)
    np.testing.assert_allclose(scene.rods[0, DIRECTOR:VELOCITY], expected, atol=1e-10)


def annulus(friction=SMOOTH):
    """Rods in the gap, thrown about, without a plate."""
    inner, outer = (Wall(radius, LOSSY.normal, friction) for radius in (GAP.inner, GAP.outer))
    rods = np.zeros((44, SPACE_COLUMNS))
    rods[:, :VELOCITY] = placement.placed(GAP, len(rods), 2 * HALF + 1, tilt=0.3)
    rods[:, VELOCITY:TURN] = np.random.default_rng(1).uniform(-0.5, 0.5, (len(rods), 3))
    between = ContactForces(LOSSY.normal, friction)
    return within(inner=inner, outer=outer, between=between), rods


def test_smooth_walls_keep_the_angular_momentum_about_the_axis():
    scene = Rods(*annulus())
    before = scene.moments()
    scene.go(5000)
    momentum, turning = scene.moments()
    assert np.abs(momentum - before[0]).max() > 0.1
    assert turning[2] == pytest.approx(before[1][2], abs=1e-12 * 44 * 7)


def test_turning_the_whole_scene_changes_nothing():
    """By a quarter of a circle and some: all vectors turn along, to what rounding grows into."""
    turn = Rotation.from_rotvec([0, 0, 1.9])
    scene, rods = annulus(friction=ROUGH)
    turned = turn.apply(rods.reshape(-1, 3)).reshape(rods.shape)
    one, other = Rods(scene, rods.copy()).go(300), Rods(scene, turned).go(300)
    assert np.abs(one.rods - rods).max() > 1e-3
    expected = turn.apply(one.rods.reshape(-1, 3)).reshape(rods.shape)
    np.testing.assert_allclose(other.rods, expected, atol=1e-7)


def lifted(*changes):
    """A row that falls onto a plate, and the same rods in space where x leads around the axis."""
    flat = md.load(
        "quasi2d",
        [
            *("rods.count=6", "box=none", "start.tilt_deg=20", "start.speed=0.3"),
            *("start.drop=0.01", "step.size=1e-4", "step.coarse=true", "plate.acceleration=5"),
            *(f"contacts.{part}.stiffness=1e5" for part in ("plate", "rods")),
            *changes,
        ],
    )
    engine = prepare(flat)
    alone, rods = engine.effects, np.zeros((6, SPACE_COLUMNS))
    rods[:, 1] = -500.0  # between the walls
    acting = within(
        **{"gravity": alone.gravity[1], "plate": alone.plate, "normal": alone.normal},
        **{"friction": alone.friction, "between": engine.effects.between},
    )
    return engine, Rods(acting, rods, engine.dt, watched=True)


IN_PLANE = [0, 2, 3, 5, 6, 8, 10]
CONSTRAINT = "contacts.plate.law=coulomb", "contacts.plate.tangential_ratio=none"


@pytest.mark.parametrize("regimes", [False, True], ids=["crowd", "regimes"])
@pytest.mark.parametrize("law", [(), CONSTRAINT], ids=["spring", "constraint"])
def test_rods_in_a_plane_do_what_the_plane_kernel_says(law, regimes):
    """With friction and losses, in a crowd or each alone at its own tilt; y stays as it is.

    Motion, ledger and records are those of the row.
    """
    engine, scene = lifted(*law)
    engine.rods[:, 0] *= 30 if regimes else 1.001  # else some touch just so, and rounding decides
    if regimes:
        tilts = np.radians([-5, 10, 30, 50, 70, 85])
        engine.rods[:, 1] += HALF * (np.cos(tilts) - engine.rods[:, 3])
        engine.rods[:, 2:5] = np.array([np.sin(tilts), np.cos(tilts), [0.7, 0.5, 0.3, 0, 1, -1]]).T
    scene.rods[:, IN_PLANE] = engine.rods
    for _ in range(60):
        engine.go(100)
        scene.go(100)
    assert (engine.ledger[: 3 if regimes else 4] > 1e-4).all()  # they met
    np.testing.assert_allclose(scene.rods[:, IN_PLANE], engine.rods, rtol=0, atol=1e-8)
    assert np.abs(scene.rods[:, [1, 4, 7, 9, 11]] - (-500, 0, 0, 0, 0)).max() < 1e-12
    ledger = scene.watchers.ledger
    np.testing.assert_allclose(ledger[:LEDGER_COLUMNS], engine.ledger, rtol=0, atol=1e-4)
    assert (ledger[LEDGER_COLUMNS:] == 0).all()
    records = (record.rows[: record.count[0]] for record in (engine.record, scene.watchers.record))
    of_row, in_space = records
    assert len(of_row) > 6
    assert not regimes or set(of_row[:, REGIME]) == set(REGIMES)
    np.testing.assert_allclose(in_space, of_row, rtol=1e-7, atol=1e-8)


def elastic_crowd():
    """Rods thrown about between walls and over a plate at rest, without losses."""
    walls = {n: Wall(r, ELASTIC, SMOOTH) for n, r in (("inner", GAP.inner), ("outer", GAP.outer))}
    at_rest, rods = Motion(np.zeros(1), np.zeros(1)), annulus()[1]
    rods[:, PLACE + 2] += 0.01
    rods[:, VELOCITY:TURN] *= 2
    above = {"plate": at_rest, "normal": ELASTIC, "friction": SMOOTH, "gravity": -1.0}
    return within(**walls, **above, between=ContactForces(ELASTIC, SMOOTH)), rods


def elastic_two(height, slant):
    """Two rods within each other's reach, near their ends."""
    first, second = [0, 0, 0], [0, -0.985, height]
    rods = (first, (slant, 0, 1), (0, -0.1, 0.3)), (second, (-slant, 0.001, 1), (0.4, 0.1, -0.3))
    return meeting(ELASTIC, SMOOTH), states(*rods)


def elastic_along():
    """A rod nearly along the convex wall, whose ends share the contact between them."""
    scene, _ = elastic_crowd()
    rod = (GAP.inner + 0.49, 0, 10), (0.001, 0.05, 1), (-0.3, 0.5, 0)
    return scene, states(rod)


@pytest.mark.parametrize(
    "begin",
    [
        elastic_crowd,
        elastic_along,
        partial(elastic_two, 8.45, 0.01),
        partial(elastic_two, 5.6, 0.7),
    ],
    ids=["all", "along the wall", "ends that meet", "crossing at an end"],
)
def test_m15_elastic_contacts_keep_the_energy(begin):
    """In the middle of contacts too: second order in the step."""
    found = []
    for dt in (4e-4, 1e-4):
        scene, rods = begin()
        crowd = Rods(scene, rods, dt, watched=bool(scene.normal))
        first, off, kinetic = crowd.energy(), [], []
        for _ in range(20):
            crowd.go(round(0.004 / dt))
            off.append(crowd.energy() - first)
            kinetic.append(crowd.kinetic())
        assert not scene.normal or np.abs(crowd.watchers.ledger).max() < 1e-12
        assert np.ptp(kinetic) > 0.03  # the contacts hold energy
        found.append(np.abs(off).max())
    assert found[0] < 1e-2 * first
    assert np.log2(found[0] / found[-1]) / 2 > 1.7, found


def test_m5_a_lying_rod_that_a_wall_pushes_does_not_creep():
    """With a third of the friction there is: less than 1e-10 d in 1e3 units of time."""
    force, held = 0.1, Friction(0.3, None)
    deep, pressed = (force / 1e5) ** (2 / 3), (0.5 / 1e5) ** (2 / 3)
    x = INNER_RADIUS + 0.5 - deep
    rods = states(((x, 0, 0.5 - pressed), (0, 1, 0)))
    walls = {"inner": Wall(INNER_RADIUS, ELASTIC, None), "outer": Wall(1e3, ELASTIC, None)}
    scene = within(**walls, plate=None, gravity=-1.0, friction=held, normal=LOSSY.normal)
    lying = Rods(scene, rods.copy(), dt=1e-3).go(3000)  # settles
    before = lying.rods.copy()
    lying.go(1_000_000)
    assert np.abs(lying.rods - before).max() < 1e-10
    assert np.abs(lying.rods[:, :2] - rods[:, :2]).max() < 1e-6
    slips = scene._replace(friction=Friction(0.9 * force, None))
    assert Rods(slips, rods, dt=1e-3).go(1000).rods[0, 0] > x + 5e-6


@pytest.mark.parametrize("rolling", [False, True])
def test_the_largest_step_is_stable_for_rods_side_by_side(rolling):
    """Upright, touching both neighbours at both ends, as deep as impacts go; friction holds."""
    tables = [f"contacts.{part}.stiffness=1e5" for part in ("plate", "rods", "wall")]
    tables += ["rods.length=9.5", "rods.inertia=thin", f"rods.rolling={str(rolling).lower()}"]
    asked = md.load("annulus", [*tables, "step.coarse=false"])
    deep = deepest_overlap(LOSSY, asked.impact_speed)
    rods = states(*(((i * (1 - deep), 0, 0), (0, 0, 1)) for i in range(5)))
    rods[:, VELOCITY:] = np.random.default_rng(2).uniform(-1e-6, 1e-6, (5, 6))
    rods[:, TURN + 2] *= rolling
    top = 1 / (LIGHT * md.Rod(9.5).axial_gyration_squared) - 1 if rolling else None
    scene = Rods(meeting(friction=Friction(1e3, LOSSY.spring), rolling=top), rods, largest(asked))
    for _ in range(100):
        scene.go(1)
        rods[:, PLACE], rods[:, VELOCITY] = np.arange(5) * (1 - deep), 0  # they are held
    assert np.abs(rods[:, VELOCITY:]).max() < 1e-5


# Placement


def test_the_largest_tilt_of_one_rod():
    """sin = sqrt((R_o - 1/2)^2 - (R_i + 1/2)^2)/(l/2 - 1/2); a flat end leaves less (E1)."""
    reach = np.sqrt((GAP.outer - 0.5) ** 2 - (GAP.inner + 0.5) ** 2)
    round_ends = placement.largest_tilt(GAP, 8.0)
    assert np.sin(round_ends) == pytest.approx(reach / 3.5)
    flat = largest_tilt_of_flat(GAP, 8.0)
    assert np.radians(53) < flat < round_ends
    assert placement.largest_tilt(GAP, 3.0) == np.pi / 2
    assert largest_tilt_of_flat(GAP, 3.0) == np.pi / 2


@pytest.mark.parametrize("count", [1, 2, 23, 44])
def test_placed_rods_touch_neither_each_other_nor_a_wall(count):
    """Beyond 1e-4 d; they stand on the plate and lean one way along the annulus."""
    rods = placement.placed(GAP, count, 8.0)
    half, least = 3.5, np.inf
    x, a = rods[:, PLACE:DIRECTOR], rods[:, DIRECTOR:]
    for i, j in combinations(range(count), 2):
        least = min(least, nearest(*tuples(x[i] - x[j], a[i], a[j]), half))
    assert least > 1 - 1e-4
    along = np.linspace(-half, half, 201)[:, None]
    for place, director in zip(x, a, strict=True):
        rho = np.hypot(*(place + along * director).T[:2])
        assert rho.min() > GAP.inner + 0.5 - 1e-4
        assert rho.max() < GAP.outer - 0.5 + 1e-4
    np.testing.assert_allclose(x[:, 2] - half * np.abs(a[:, 2]), 0.5, atol=1e-3)
    lean = x[:, 0] * a[:, 1] - x[:, 1] * a[:, 0]
    assert (lean > 0).all() or (lean < 0).all()


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match=r"rods.count 60 do not fit into the annulus"):
        prepare(ring("rods.count=60"))
    with pytest.raises(ValueError, match="length must be at least 1"):
        placement.largest_tilt(GAP, 0.5)


@pytest.mark.parametrize(("radius", "count"), [(30.0, 60), (3.0, 12)])
def test_neighbours_by_azimuth_are_all_close_pairs(radius, count):
    """Against brute force; in the second case a rod spans more than half of the circle."""
    random = np.random.default_rng(4)
    azimuth = random.uniform(-np.pi, np.pi, count)
    rods = np.zeros((count, SPACE_COLUMNS))
    rods[:, 0], rods[:, 1] = radius * np.cos(azimuth), radius * np.sin(azimuth)
    rods[:, 2] = random.uniform(0, 5, count)
    rods[:, DIRECTOR:VELOCITY] = [unit(v) for v in random.normal(size=(count, 3))]
    found = np.zeros((count**2, 3), np.int64)
    listed = pair_up(IN_SPACE, rods, HALF, None, np.arange(count), np.zeros(count), found)
    close = {
        (i, j)
        for i, j in combinations(range(count), 2)
        if nearest(
            *tuples(
                rods[i, :3] - rods[j, :3], rods[i, DIRECTOR:VELOCITY], rods[j, DIRECTOR:VELOCITY]
            ),
            HALF,
        )
        < (1 + SKIN) ** 2
    }
    assert len(close) > 10
    assert sorted(map(tuple, found[:listed, :2])) == sorted(close)
