"""Rods under way: what acts on them, their state, and the motion of their points, compiled.

Rods are in a vertical plane, (x, z), or in space, (x, y, z): `Effects.up` has two numbers or three.
A row of `State.rods` holds four vectors: centre and director at a step, velocity and turn half a
step before. The turn is w = (angular momentum)/I, about which the director turns. Without rolling
it is across the director and is the angular velocity itself; with it, a free rod is a symmetric
top, whose director turns about w all the same, while its surface also rolls by `rolling` (w .
director). In the plane it is one number, positive as it turns z towards x.
"""

from typing import Any, NamedTuple

import numpy as np

from ..cache import kernel
from .contact import ContactForces, Friction, Inertia, Normal, swung
from .neighbours import Listed
from .vectors import IN_PLANE, along, axial, nothing, put, raised, vector


class Motion(NamedTuple):
    """One period of the plate's height and velocity, step by step."""

    height: Any  # d
    velocity: Any  # sqrt(g d)


class Wall(NamedTuple):
    """A vertical cylinder about the axis x = y = 0."""

    radius: float  # d
    normal: Normal
    friction: Friction | None


class Effects(NamedTuple):
    """All that acts on rods; `None`: absent."""

    half_length: float  # d, from centre to centre of a cap, (l - 1)/2
    lightness: float  # 1/d^2: 1/k^2, k the gyration radius
    normal: Normal | None = None  # of the plate; None: no plate
    friction: Friction | None = None
    gravity: Any = None  # g; in the plane along x and z, in space a number, along z
    plate: Motion | None = None  # None: at rest at z = 0
    upper: bool | None = True  # None: a sphere, which has no second cap
    flat: bool | None = None  # True: flat ends, half_length to them; None: round ones
    between: ContactForces | None = None  # of rods with each other
    period: float | None = None  # d; of the box along x; None: open
    up: tuple = IN_PLANE  # unit vector upwards: of two numbers in the plane, of three in space
    rolling: float | None = None  # I/I_axial - 1; None: no rotation of a rod about its axis
    inner: Wall | None = None
    outer: Wall | None = None
    shaken: bool | None = None  # True: both walls move with the plate; None: they are at rest


class Kept(NamedTuple):
    """What a contact keeps of a step for the next one."""

    force: float  # F_n, m g
    rub: tuple  # F_t, m g: across the normal
    spring: tuple  # its length, d


class Scratch(NamedTuple):
    """Arrays that hold nothing from one step to the next."""

    total: np.ndarray  # (rods, 3), in space 6: force and torque of a step, m g and m g d
    speed: np.ndarray  # (rods,)
    place: np.ndarray | None  # (rods,): for a list of pairs
    found: np.ndarray | None  # (capacity, 3): the same
    batch: Any  # `batch.Batch`; None where no rods or walls are met


class State(NamedTuple):
    """Rods under way; `None` for what they do without.

    A part across a normal has one number in the plane, and three in space.
    """

    rods: np.ndarray  # (rods, 7), in space 12; d, sqrt(g d), sqrt(g/d)
    before: np.ndarray  # (rods, 3), in space 6: accelerations of the step before, in g and g/d
    forces: np.ndarray | None  # (rods, slots, 1 + part), m g: F_n and F_t of plate and walls
    springs: np.ndarray | None  # (rods, slots, part), d: theirs
    listed: Listed | None
    scratch: Scratch


class Clock(NamedTuple):
    """Number of a step, and its size."""

    step: int
    dt: float  # sqrt(d/g)


@kernel
def dimensions(up):
    """Numbers of a vector."""
    return 2 if len(up) == 2 else 3


@kernel
def place_of(up, rods, i):
    """Centre of a rod."""
    return vector(rods, i, 0, up)


@kernel
def director_of(up, rods, i):
    """Unit vector along a rod's axis."""
    return vector(rods, i, dimensions(up), up)


@kernel
def velocity_of(up, rods, i):
    """Velocity of a rod half a step before."""
    return vector(rods, i, 2 * dimensions(up), up)


@kernel
def turn_of(up, rods, i):
    """Its turn then."""
    return axial(rods, i, 3 * dimensions(up), up)


@kernel
def inertia_of(effects):
    """How the rods turn."""
    return Inertia(effects.lightness, effects.rolling)


@kernel
def point(effects, velocity, turn, director, arm):
    """Velocity of a point of a rod; of rates of both, its acceleration but for that by its path."""
    return along(velocity, 1.0, swung(effects.rolling, turn, director, arm))


@kernel
def weight(gravity, like):
    """Force of gravity on a rod, of as many numbers as `like`."""
    if gravity is None:
        return nothing(like)
    if len(like) == 3:
        return raised(nothing(like), gravity)
    return gravity


@kernel
def field(effects, velocity):
    """Force on a rod by all but contacts."""
    return weight(effects.gravity, velocity)


@kernel
def kept_of(up, forces, springs, row, slot):
    """What is kept of a contact; arrays that are `None` keep nothing."""
    force = 0.0 if forces is None else forces[row, slot, 0]
    rub, spring = kept_part(up, forces, row, slot, 1), kept_part(up, springs, row, slot, 0)
    return Kept(force, rub, spring)


@kernel
def kept_part(up, array, row, slot, first):
    """Part across the normal that is kept."""
    if array is None:
        return nothing_across(up)
    return axial(array[row], slot, first, up)


@kernel
def nothing_across(up):
    """No part across a normal."""
    if len(up) == 2:
        return (0.0,)
    return 0.0, 0.0, 0.0


@kernel
def nothing_kept(up):
    """Of a contact that is open."""
    return Kept(0.0, nothing_across(up), nothing_across(up))


@kernel
def keep(forces, springs, row, slot, kept):
    """Keep it for the next step, as far as there are arrays."""
    if forces is not None:
        forces[row, slot, 0] = kept.force
        put(forces[row], slot, 1, kept.rub)
    if springs is not None:
        put(springs[row], slot, 0, kept.spring)


@kernel
def forget(up, forces, springs, row, slot):
    """Clear what is kept of a contact that is open."""
    keep(forces, springs, row, slot, nothing_kept(up))
