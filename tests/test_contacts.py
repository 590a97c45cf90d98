"""Forces of two rods and of walls: distances, no jumps, an energy, and the rigid limit."""

import re
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_allclose
from scipy.optimize import lsq_linear

import md
from impact import Body, collide_pair
from md.kernels import C_X, OMEGA, PAIR_NORMAL
from md.kernels.batch import SIZE
from md.kernels.contact import ContactForces, Inertia
from md.kernels.neighbours import Axes, between_ends, near_end
from md.kernels.state import Walls

from .command_line import DOCS
from .rows import (
    ELASTIC_PLANE,
    ELASTIC_RODS,
    HALF,
    LIGHT,
    LOSSY,
    PLANE,
    ROUGH,
    ROW_DIRECTION,
    ROW_PLACE,
    ROW_VELOCITY,
    SMOOTH,
    SOFT,
    SPACE,
    distance,
    elastic,
    forces,
    go,
    in_plane,
    in_space,
    meetings,
    motion,
    overlap,
    pushed,
    started,
    tip_on_side,
    unit,
)
from .sampling import EPS, power
from .track import damped

DEEP = 0.02  # overlap; ends reach each other up to 0.2 along the axes
ONE = SOFT * DEEP**1.5  # force of such a contact
IN_SPACE = SPACE._replace(between=ELASTIC_RODS, walls=Walls(*ELASTIC_RODS, 5.0, 1e3))


# Distances


@pytest.mark.parametrize("seed", range(25))
def test_two_axes_are_as_far_apart_as_least_squares_say(seed):
    random = default_rng(seed)
    apart, a, b = random.uniform(-3, 3, 3), unit(random.normal(size=3)), unit(random.normal(size=3))
    if seed % 5 == 0:
        b = a if seed % 2 else unit(a + 1e-9 * random.normal(size=3))
    best = lsq_linear(np.column_stack([a, -b]), -apart, (-HALF, HALF), tol=1e-14).cost
    found = distance(in_space((apart, a), ((0, 0, 0), b)), 0, 1)
    assert found == pytest.approx(sqrt(2 * best), abs=1e-6)
    assert found <= sqrt(2 * best) + 1e-12


def test_m7_distances_of_nearly_parallel_rods_are_accurate():
    """Each end's distance is that of extended precision, to 4 ulp of the largest that cancels."""
    random, worst = default_rng(5), 0.0
    for _ in range(400):
        tilt = random.uniform(-pi, pi)
        turn = random.choice([0, 1e-16, 1e-12, 1e-8, 1e-4, 1]) * random.uniform(-1, 1)
        x, z = random.uniform(-9, 9), random.uniform(0.5, 1.5)
        place = x * sin(tilt) + z * cos(tilt), x * cos(tilt) - z * sin(tilt)
        rods = in_plane((*place, tilt), (0, 0, tilt + turn))
        apart, a, b = (tuple(v) for v in (place, *rods[:, ROW_DIRECTION]))
        for end, (p, q) in enumerate(meetings(rods.astype(np.longdouble))[0]):
            got = np.hypot(*near_end(Axes(apart, a, b), HALF, end).gap)
            worst = max(worst, abs(got - np.hypot(*(p - q))))
    assert 0 < worst <= 4 * EPS * 9


def test_m7_the_distance_of_rods_that_nearly_cross_is_exact():
    """It is right to 4 ulp of their lengths, down to the angle from which ends alone count.

    Where they are closest is known to a rounding over the squared angle, no better.
    """
    random = default_rng(8)
    for angle in 10.0 ** default_rng(1).uniform(-9, 0, 200):
        a, b = np.array([1.0, 0, 0]), np.array([np.cos(angle), 0, np.sin(angle)])
        s, t = random.uniform(-1, 1, 2)
        apart = np.array([0, 0.97, 0]) - s * a + t * b
        near, inside, skew = between_ends(Axes(*map(tuple, (apart, a, b))), HALF)
        if angle < 0.9e-6:
            assert not inside
        elif angle > 1.1e-6:
            assert inside
            assert abs(np.linalg.norm(near.gap) - 0.97) <= 4 * np.spacing(HALF)
            assert abs(near.s - s) < 4e-15 / skew


# No jumps


def beside(beyond, turn=0.0):
    """A rod along z, and one beside it that overlaps it by `beyond` along the axes."""
    x, z = 1 - DEEP + HALF * sin(turn), HALF - beyond + HALF * cos(turn)
    return [(0.0, 0.0, 0.0), (x, z, turn)]


def round_the_end(place):
    """A rod along z, and one that leans and goes round its upper end at the overlap DEEP.

    First its end is on the first one's side, `place` < 0 from the end; then end on end, over an
    arc; then the first one's end is on its side.
    """
    lean, reach = 2.0, 1 - DEEP
    arc = reach * (pi - lean)
    angle = pi / 2 - min(max(place, 0.0), arc) / reach
    x, z = reach * sin(angle), HALF + reach * cos(angle) + min(place, 0.0)
    along = HALF - max(place - arc, 0.0)
    return [(0.0, 0.0, 0.0), (x + along * sin(lean), z + along * cos(lean), lean)]


def crossing(first, second):
    """Rods in space far from walls, each its place and its director."""
    return in_space(first, second, aside=30.0)


def round_an_end(x):
    """A rod goes round the upper end of an upright one, leaning out of the plane."""
    end, director = (0.1, 0.98 * sin(5 * x), HALF + 0.98 * cos(5 * x)), unit((0.3, 0, 1))
    return crossing(((0, 0, 0), (0, 0, 1)), (end + HALF * director, director))


PATHS = {  # rods at a place of the path, from where to where
    "cap past the end": (lambda x: in_plane(*tip_on_side(0.4, x, -DEEP)), 3.5, 5.5),
    "slide past": (lambda x: in_plane(*beside(x)), -0.2, 0.4),
    "turn over at the end": (lambda a: in_plane(*beside(1e-3, a)), -0.01, 0.01),
    "round the end": (lambda x: in_plane(*round_the_end(x)), -0.3, 1.4),
    "through parallel": (
        lambda x: crossing(((0, 0, 0), (x, 0.001, 1)), ((0, -0.98, 0), (0, 0, 1))),
        -0.3,
        0.3,
    ),
    "off the end": (
        lambda x: crossing(((0, 0, 0), (0.7, 0, 1)), ((0, -0.98, 5.6 + 2 * x), (-0.7, 0, 1))),
        -0.3,
        0.3,
    ),
    "end past end": (
        lambda x: crossing(((0, 0, 0), (0, 0.001, 1)), ((0, -0.98, 8.5 + x), (0, 0, 1))),
        -0.3,
        0.3,
    ),
    "round an end": (round_an_end, -0.3, 0.3),
    "past the inner wall": (lambda x: in_space(((5.49, 0, 0), (0.001, x, 1))), -0.3, 0.3),
}


@pytest.mark.parametrize("path", PATHS)
def test_m7_no_force_jumps(path):
    """Steps of force and torque halve with those of the path: no jump, however small."""
    rods_at, *limits = PATHS[path]
    engine = started(ELASTIC_PLANE if rods_at(0.0).shape[1] == 7 else IN_SPACE, rods_at(0.0))
    found = np.array([forces(engine, rods_at(x)) for x in np.linspace(*limits, 4001)])
    fine, coarse = (np.abs(np.diff(found[::n], axis=0)).max() for n in (1, 2))
    assert np.abs(found).max() > 50
    assert np.ptp(found, axis=0).max() > 1
    assert fine < 0.52 * coarse


# One place or two


TO_ROUNDING = (  # ends whose squared distance is less than 1 as a sum of squares alone
    (0.9494358832968327, -0.9836358090748183, 0.1728756875894829),
    (0, 0, 0.2853928232566878),
)


@pytest.mark.parametrize(
    ("rods", "count"),
    [
        *((beside(4.0), 2), (beside(0.201), 2), (beside(0.0), 1), (TO_ROUNDING, None)),
        *((tip_on_side(0.0, HALF - x, -DEEP), 1) for x in (1e-3, 0.15, 0.5)),
    ],
)
def test_rods_touch_at_one_place_or_two(rods, count):
    """Rods side by side touch at two, in full if ends do not reach each other; others at one."""
    rods = in_plane(*rods)
    found = pushed(rods)
    if count:
        assert np.hypot(*found[1, :2]) == pytest.approx(count * ONE, rel=1e-9)
    assert_allclose(found, elastic(rods), rtol=1e-9, atol=1e-9 * ONE)


def test_forces_of_any_two_rods_are_those_of_brute_force():
    """They agree at all angles, for nearly parallel rods and where ends meet."""
    random, touching = default_rng(2), 0
    for number in range(80):
        lean, other = random.uniform(-pi, pi), random.choice([1e-9, 1e-3, 1]) * random.normal()
        off, along = random.uniform(0.95, 1.0), random.uniform(-9, 9)
        if number % 2:  # ends that meet
            along = np.copysign(random.uniform(8.2, 8.6), along)
        place = off * cos(lean) + along * sin(lean), along * cos(lean) - off * sin(lean)
        rods = in_plane((0.0, 0.0, lean), (*place, lean + other))
        if max(map(overlap, meetings(rods)[0])) > 0.3:
            continue
        got = pushed(rods)
        touching += bool(got.any())
        assert_allclose(got, elastic(rods), rtol=1e-9, atol=1e-9 * ONE)
    assert touching > 40


def test_one_spring_goes_round_the_end():
    """Friction neither ends nor doubles as end on side becomes end on end, and that side on end.

    The rods are at rest: the spring keeps its length. In a step of 1e-7 they stay so, to the 2e-4
    by which a dashpot lessens the force.
    """
    places, stretched = np.linspace(-0.3, 1.4, 1701), 1e-3
    rough = PLANE._replace(between=ContactForces(LOSSY.normal, ROUGH._replace(coefficient=10.0)))
    engine = started(rough, in_plane(*round_the_end(0.0)), dt=1e-7)
    forces(engine, in_plane(*round_the_end(places[0])))
    listed, touching = engine.state.listed, [overlap(at) > 0 for at in meetings(engine.rods)[0]]
    first = 4 * listed.turn[0]
    listed.memory.springs[first : first + 4, 0] = stretched * np.array(touching)
    found = np.array([forces(engine, in_plane(*round_the_end(x)))[0, :2] for x in places])
    one = np.hypot(ONE, LOSSY.spring.root * sqrt(DEEP) * stretched)
    assert np.hypot(*found.T) == pytest.approx(one, rel=3e-4)
    assert np.ptp(np.hypot(*found.T)) < 3e-4 * one


# Restitution


def normal(restitution, stiffness=SOFT):
    """The law's normal force, whose dashpot may be zero."""
    return damped(md.coulomb(restitution, stiffness).normal)


SIDE = in_plane((0, HALF + 1 + 1e-12, 0, 0, -0.5, 0), (0, 0, pi / 2, 0, 0.5, 0))
STACKED = ((0, 0, 3), (0, 0, 1), (0, 0, -0.5)), ((0, 0, 0), (0, 0, 1), (0, 0, 0.5))


def end_on(length):
    """Rods end to end in the plane that meet at a speed of one."""
    return in_plane((0, 0, pi / 2, 0.5, 0, 0), (length, 0, pi / 2, -0.5, 0, 0))


@pytest.mark.parametrize(
    ("effects", "rods", "e", "contacts"),
    [
        *((PLANE, SIDE, e, 1) for e in (0.2, 0.65, 0.9)),
        (PLANE._replace(half_length=0.0, upper=None), end_on(1), 0.65, 1),
        (PLANE._replace(half_length=1.0), end_on(3), 0.65, 2),
        (SPACE._replace(half_length=1.0), in_space(*STACKED, aside=20.0), 0.65, 2),
    ],
)
def test_a_head_on_collision_has_the_restitution_asked_for(effects, rods, e, contacts):
    """Caps on caps, or on the middle of a side, turn neither rod; ends that meet are one place.

    500 steps a contact, first order where the force ends: 1/500 of the velocity at most. Once the
    contacts are open, their last forces are forgotten: the next touch begins without.
    """
    effects = effects._replace(between=ContactForces(normal(e), SMOOTH))
    engine = go(started(effects, rods, dt=6e-5), 300)
    assert np.count_nonzero(engine.state.listed.memory.forces) == contacts
    go(engine, 2700)
    assert not engine.state.listed.memory.forces.any()
    _, velocity, turn = motion(engine)
    assert np.linalg.norm(velocity[0] - velocity[1]) == pytest.approx(e, abs=2e-3)
    assert np.abs(turn).max() < 1e-12
    lost = (1 - e * e) / 4  # half the reduced mass times the velocity squared
    assert engine.ledger[PAIR_NORMAL] == pytest.approx(lost, abs=2e-3)


def rigid(rods, e):
    """Velocities after a frictionless impact with restitution e at the contact point."""
    p, q = max(meetings(rods)[0], key=overlap)
    normal = np.arctan2(*(p - q))
    first, second = (
        Body(1.0, LIGHT**-0.5, *(rod[ROW_PLACE] - (p + q) / 2), *rod[ROW_VELOCITY]).turned(normal)
        for rod in rods
    )
    hit = collide_pair(first, second, friction=0.0, restitution=e)
    return [body.turned(-normal)[4:] for body in (hit.first, hit.second)]


@pytest.mark.parametrize("restitution", [1.0, 0.65])
def test_stiff_contacts_collide_as_rigid_rods(restitution):
    """The rods turn and slide by the overlap during the contact: the error falls as k_n^(-2/5).

    Other powers of the overlap, at most 0.05, bend the line by as much.
    """
    errors, stiffnesses = [], (1e4, 1e5, 1e6, 1e7)
    first, second = tip_on_side(0.7, 2.0)
    rods = in_plane((*first, 0.3, -1.0, 0.1), (*second, 0.0, 0.2, 0.05))
    for stiffness in stiffnesses:
        law = ContactForces(normal(restitution, stiffness), SMOOTH)
        dt = 3 * (1.25 / stiffness) ** 0.4 / 2400
        found = go(started(PLANE._replace(between=law), rods, dt), 5600).rods
        errors.append(np.abs(found[:, ROW_VELOCITY] - rigid(rods, restitution)).max())
    assert errors[-1] < 1e-4
    assert power(stiffnesses, errors) == pytest.approx(-0.4, abs=0.02)


TABLE = re.search(
    r"\| restitution of the law \|(.*)\n.*\n((?:\|.*\n)+)", (DOCS / "own_rods.md").read_text()
)
OVERLAPPED = {"end on": 0, "side by side": 1, "3/4": 3 / 4, "1/2": 1 / 2, "1/4": 1 / 4}


def cells(line):
    """Cells of a line of a table."""
    return line.strip(" |").split(" | ")


def restitution_of_rods(law, overlapped):
    """Restitution of two rods that meet along a part of their axes; 0: end on."""
    shift, speed, lying = (1 - overlapped) * 2 * HALF, 0.35, 0.0 if overlapped else pi / 2
    x, z = (1, shift) if overlapped else (2 * HALF + 1, 0)
    rods = in_plane((0, 0, lying, speed, 0, 0), (x + 1e-6, z, lying, -speed, 0, 0))
    law = ContactForces(normal(law, md.laws.STIFFNESS), SMOOTH)
    effects = PLANE._replace(between=law, inertia=Inertia(12 / 9.5**2))
    rods = go(started(effects, rods, 1e-5), 15_000).rods
    turned = shift / 2 * rods[:, OMEGA].sum() if overlapped else 0.0
    return (rods[1, C_X] - rods[0, C_X] - turned) / (2 * speed)


@pytest.mark.parametrize("place", cells(TABLE[1]))
def test_the_restitution_of_a_law_is_that_of_one_contact_point(place):
    """Restitution in each place is what the guide's table says, to its last digit."""
    column = cells(TABLE[1]).index(place) + 1
    (overlapped,) = (part for name, part in OVERLAPPED.items() if place.startswith(name))
    for line in TABLE[2].splitlines():
        law, *_ = told = [*map(float, cells(line))]
        assert restitution_of_rods(law, overlapped) == pytest.approx(told[column], abs=0.0075)


# Many contacts

THREE = in_plane((0, 0, 0.1), (0.99, 0.2, 0.1, -1, 0, 0), (1.98, 0.1, 0.12, -2, 0.5, 0))
ON_WALL = in_space(((0, 1.49, 0.0), (0.6, 0, 1), (0, -1, 0)))


@pytest.mark.parametrize(
    ("scene", "rods", "z", "copies", "rounding"),
    [
        (PLANE, THREE, 1, 100, 1e-9),
        (SPACE, ON_WALL, 2, 2 * SIZE, 0.0),
    ],
    ids=["plane", "wall"],
)
def test_contacts_beyond_a_batch(scene, rods, z, copies, rounding):
    """Copies of a few rods, one over the other, move as the few do."""
    many = np.concatenate([rods] * copies)
    many[:, z] += 64.0 * np.repeat(np.arange(copies), len(rods))
    few, many = (go(started(scene, states), 300) for states in (rods, many))
    assert np.abs(many.ledger).max() > 1
    assert_allclose(many.ledger, copies * few.ledger, rtol=1e-9, atol=1e-9)
    expected = np.tile(few.rods, (copies, 1))
    expected[:, z] = many.rods[:, z]
    assert_allclose(many.rods, expected, rtol=0, atol=rounding)
