"""Soft scenes of rows and annuli for the tests, rods without a scene, and forces by brute force.

What a test does without is there and does nothing, zero or far away: `go` takes the kernel of a
run, so that the tests of the plane share one kernel, and those of space another.
"""

from dataclasses import replace
from itertools import product
from math import ceil, cos, floor, sin, sqrt

import numpy as np

import md
from md.host import Engine, at_start
from md.kernels import (
    ANNULUS_LEDGER,
    C_X,
    DIRECTOR,
    LEDGER_COLUMNS,
    PLACE,
    ROW_COLUMNS,
    SINE,
    SPACE_COLUMNS,
    TURN,
    VELOCITY,
    X,
)
from md.kernels.contact import ContactForces, Friction, Inertia, Normal
from md.kernels.march import Watchers
from md.kernels.neighbours import Axes, nearest
from md.kernels.state import Effects, Motion, Walls
from md.kernels.touches import new_record
from md.kernels.vectors import IN_SPACE
from md.laws import Rod

ROW_PLACE, ROW_DIRECTION, ROW_VELOCITY = slice(X, SINE), slice(SINE, C_X), slice(C_X, ROW_COLUMNS)
SOFT = 1e5  # k_n of most tests: contacts fifty times as long as the paper's allow long steps
HALF = 4.25  # of the paper's rods
EXPERIMENT = md.Annulus(7.28 / 2 / 0.635, 9.45 / 2 / 0.635)  # in rod diameters
LIGHT = 1 / Rod(9.5).gyration_squared
LOSSY = md.constant_restitution(0.65, SOFT, tangential_ratio=3)
ELASTIC = Normal(SOFT, 0.0)  # with a dashpot of zero
ROUGH = Friction(0.3, LOSSY.spring)
SMOOTH = ROUGH._replace(coefficient=0.0)
HELD = ROUGH._replace(spring=None)
CONSTRAINT = ("contacts.plate.law=coulomb", "contacts.plate.tangential_ratio=none")
# Rods of the paper's row, few and soft
ROW = f"""
    rods.count=5 rods.length=5 box.length=5.5
    start.speed=0.1 step.size=none step.coarse=true
    contacts.plate.stiffness={SOFT} contacts.rods.stiffness={SOFT}
""".split()
# A few short soft rods in a narrow gap
RING = f"""
    rods.count=6 rods.length=4 annulus.inner=1 annulus.outer=2.8 step.size=none
    contacts.plate.stiffness={SOFT} contacts.rods.stiffness={SOFT} contacts.wall.stiffness={SOFT}
""".split()
DRIVEN = "plate.acceleration=5"
LIVELY = "step.size=3e-4", DRIVEN
ROLLING = ("rods.rolling=true", "annulus.shaken=false", *CONSTRAINT)


def sets(*assignments):
    """Options of a command that change keys of a scene."""
    return [part for one in assignments for part in ("--set", one)]


def seeded(scene, seed):
    """A scene with another start."""
    return replace(scene, start=replace(scene.start, seed=seed))


def row(*assignments):
    """The row with some keys changed."""
    return md.load("quasi2d", [*ROW, *assignments])


def ring(*assignments):
    """The annulus with some keys changed."""
    return md.load("annulus", [*RING, *assignments])


# Rods without a scene

AT_REST = Motion(np.zeros(1), np.zeros(1))
FAR_BELOW = AT_REST._replace(height=np.full(1, -1e3))
LOSSY_FORCES = ContactForces(LOSSY.normal, ROUGH)
ELASTIC_RODS = ContactForces(ELASTIC, SMOOTH)
FREE = Effects(HALF, Inertia(LIGHT), *LOSSY_FORCES, plate=FAR_BELOW, between=LOSSY_FORCES)
PLANE = FREE._replace(gravity=(0.0, 0.0), period=1e6)
SPACE = FREE._replace(
    gravity=0.0,
    up=IN_SPACE,
    walls=Walls(*LOSSY_FORCES, 1.0, 1e3),
    shaken=True,
)
ROLLS = SPACE._replace(friction=HELD, inertia=Inertia(LIGHT, 15.0), shaken=None)
ELASTIC_PLANE = PLANE._replace(between=ELASTIC_RODS)


def unit(v):
    """The unit vector along v."""
    return np.asarray(v, float) / np.linalg.norm(v)


def in_plane(*rods):
    """States of rods, each (x, z, tilt) or (x, z, tilt, c_x, c_z, omega)."""
    found = np.zeros((len(rods), ROW_COLUMNS), order="F")
    for rod, (x, z, tilt, *motion) in zip(found, rods, strict=True):
        rod[:] = x, z, sin(tilt), cos(tilt), *(motion or (0.0, 0.0, 0.0))
    return found


def in_space(*rods, aside=0.0):
    """States of rods, each (place, director) or (place, director, velocity).

    The director is made a unit vector; all are `aside` of the axis, along -y.
    """
    found = np.zeros((len(rods), SPACE_COLUMNS))
    for rod, (place, director, *velocity) in zip(found, rods, strict=True):
        rod[:VELOCITY] = *place, *unit(director)
        rod[VELOCITY:TURN] = velocity[0] if velocity else 0.0
    found[:, PLACE + 1] -= aside
    return found


def started(effects, rods, dt=1e-4):
    """An engine of these rods, which accounts for their energy and records touches."""
    plane = len(effects.up) == 2
    rods = np.array(rods, order="F" if plane else "C")
    columns = LEDGER_COLUMNS if plane else ANNULUS_LEDGER
    watchers = Watchers(np.zeros(columns), new_record(len(rods), 4096 + len(rods)), None)
    plate, state = effects.plate, at_start(effects, rods)
    per = plate.height.size if plate else 1
    return Engine(None, effects, state, watchers, plate, dt, per)


def unread(engine):
    """A series of samples that nobody reads, so that the kernel is that of a run."""
    return engine.series(0)._replace(per=2**62, every=2**62)


def go(engine, steps):
    """Make all of these steps, with samples, as a run does."""
    assert engine.go(steps, unread(engine)) == steps
    return engine


def recorded(engine):
    """Touches in the record of an engine."""
    return engine.record.rows[: engine.record.count[0]]


def forces(engine, rods):
    """Force and torque on each of these rods, in place of its own, at rest; springs stay."""
    state = engine.state
    engine.rods[:], state.listed.travelled[:] = rods, np.inf
    for last in (state.before, state.memory.forces, state.listed.memory.forces):
        last[:] = 0
    return go(engine, 1).state.scratch.total.copy()


def vectors(engine, rods):
    """Places, directors, velocities and turns of rods as vectors in space."""
    *parts, turn = engine._parts(rods)
    if turn.shape[1] == 1:
        parts, turn = [np.insert(v, 1, 0.0, axis=1) for v in parts], turn * (0.0, 1.0, 0.0)
    return *parts, turn


def pushed(rods, period=PLANE.period):
    """Force and torque on each of some elastic rods at rest in the plane."""
    return forces(started(ELASTIC_PLANE._replace(period=period), rods, 1e-6), rods)


def motion(engine):
    """Places, velocities and turns half a step ago as vectors in space."""
    place, _, velocity, turn = vectors(engine, engine.rods)
    return place - engine.dt / 2 * velocity, velocity, turn


def momenta(engine):
    """Momentum and angular momentum of all rods about the origin, in units of d, m and g."""
    place, velocity, turn = motion(engine)
    return velocity.sum(0), (np.cross(place, velocity) + turn / LIGHT).sum(0)


def kinetic(engine):
    """Kinetic energy of rods that do not roll, in m g d."""
    _, velocity, turn = motion(engine)
    return ((velocity**2).sum() + (turn**2).sum() / LIGHT) / 2


def around(places, v):
    """Parts of vectors along an annulus, each at its place."""
    (x, y), (v_x, v_y) = places.T[:2], v.T[:2]
    return (x * v_y - y * v_x) / np.hypot(x, y)


def radii(rods, half=HALF):
    """Distances of places along each rod, ends and middle included, from the axis of an annulus."""
    lever = np.linspace(-half, half, 401)[:, None]
    along = rods[:, None, PLACE:DIRECTOR] + lever * rods[:, None, DIRECTOR:VELOCITY]
    return np.hypot(along[..., 0], along[..., 1])


def resting_overlap(load, stiffness=SOFT):
    """Overlap at which Hertz's force carries a load, in d."""
    return (load / stiffness) ** (2 / 3)


def distance(rods, i, j, half=HALF):
    """Distance of the axes of two rods in space, as the kernels find it."""
    places, directors = rods[:, PLACE:DIRECTOR], rods[:, DIRECTOR:VELOCITY]
    vectors = places[i] - places[j], directors[i], directors[j]
    return sqrt(nearest(Axes(*map(tuple, vectors)), half))


# Two rods in the plane, without a look at the engine


def tip_on_side(lean, place, gap=1e-12):
    """Rod 0's lower cap `gap` off rod 1, which lies along x, at x = `place`."""
    reach = 1 + gap
    return [(place + HALF * sin(lean), reach + HALF * cos(lean), lean), (0.0, 0.0, np.pi / 2)]


def meetings(rods, i=0, j=1, half=HALF, shift=0.0):
    """Two places where rods may touch, on the axis of i and of j: of each end, of every two ends.

    The nearest place on a segment is the foot of the perpendicular, held between its ends. Rod j
    stands `shift` further along x.
    """
    x, y = rods[i, ROW_PLACE], rods[j, ROW_PLACE] + (shift, 0.0)
    a, b = rods[i, ROW_DIRECTION], rods[j, ROW_DIRECTION]
    tips, others = (x - half * a, x + half * a), (y - half * b, y + half * b)

    def foot(tip, x, a):
        return x + np.clip((tip - x) @ a / (a @ a), -half, half) * a

    ends = [(tip, foot(tip, y, b)) for tip in tips]
    ends += [(foot(tip, x, a), tip) for tip in others]
    return ends, [*product(tips, others)]


def overlap(places):
    """How deep rods are in each other at two places of their axes, in d; negative: apart."""
    return 1 - np.hypot(*np.subtract(*places))


def images(rods, half, period):
    """Every pair (i, j, n) of which rod j, n periods further along x, might touch rod i."""
    reach = 2 * half + 3
    for i, j in product(range(len(rods)), repeat=2):
        apart = rods[i, X] - rods[j, X]
        nearest = range(ceil((apart - reach) / period), floor((apart + reach) / period) + 1)
        yield from ((i, j, n) for n in nearest if i < j or (i == j and n > 0))


def elastic(rods, period=1e6):
    """Forces and torques on all rods without dashpots, by brute force.

    The contacts of all ends with the other axis, less those of all ends with each other.
    """
    total = np.zeros((len(rods), 3))
    for i, j, n in images(rods, HALF, period):
        ends, corners = meetings(rods, i, j, HALF, n * period)
        contacts = [(1, places) for places in ends] + [(-1, places) for places in corners]
        for count, (p, q) in contacts:
            deep = max(overlap((p, q)), 0.0)
            push = count * SOFT * deep**1.5 * unit(p - q)
            for rod, shift, (f_x, f_z) in ((i, 0, push), (j, n * period, -push)):
                x, z = (p + q) / 2 - rods[rod, ROW_PLACE] - (shift, 0)
                total[rod] += f_x, f_z, z * f_x - x * f_z
    return total
