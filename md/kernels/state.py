"""State of moving rods, the effects on them, and the motion of their points, compiled.

Rods are in a vertical plane, (x, z), or in space, (x, y, z): `Effects.up` has two numbers or three.
A row of `State.rods` holds four vectors: centre and director at a step, velocity and turn half a
step before. The turn is w = (angular momentum)/I, about which the director turns. Without rolling
it is across the director and is the angular velocity itself; with it, a free rod is a symmetric
top, whose director turns about w all the same, while its surface also rolls by `rolling` (w .
director). In the plane the turn is one number, positive as it turns z towards x.
"""

from typing import Any, NamedTuple

import numpy as np

from ..cache import kernel
from .contact import ContactForces, Friction, Inertia, Kept, Memory, Normal, turning
from .neighbours import Listed
from .vectors import (
    IN_PLANE,
    add,
    along,
    axial,
    nothing,
    nothing_across,
    put,
    raised,
    swing,
    torque,
    vector,
)


class Motion(NamedTuple):
    """Height and velocity of the plate at each step of one period."""

    height: Any  # d
    velocity: Any  # sqrt(g d)


class Walls(NamedTuple):
    """Walls of an annulus: vertical cylinders about the axis x = y = 0."""

    normal: Normal
    friction: Friction | None
    inner: float  # d; radius of the convex wall
    outer: float  # d; of the concave one


class Effects(NamedTuple):
    """All effects on the rods, as the kernels take them; `None`: absent."""

    half_length: float  # d, from centre to centre of a cap, (l - 1)/2
    inertia: Inertia
    normal: Normal | None = None  # of the plate; None: no plate
    friction: Friction | None = None
    gravity: Any = None  # g; in the plane along x and z, in space a number, along z
    plate: Motion | None = None  # None: at rest at z = 0
    upper: bool | None = True  # None: a sphere, which has no second cap
    flat: bool | None = None  # True: flat ends, half_length to them; None: round ones
    between: ContactForces | None = None  # of rods with each other
    period: float | None = None  # d; of the box along x; None: open
    up: tuple = IN_PLANE  # unit vector upwards: of two numbers in the plane, of three in space
    walls: Walls | None = None
    shaken: bool | None = None  # True: the walls move with the plate; None: they are at rest


class Scratch(NamedTuple):
    """Work arrays, whose contents do not last from one step to the next."""

    total: np.ndarray  # (rods, 3), in space 6: force and torque of a step, m g and m g d
    speed: np.ndarray  # (rods,)
    place: np.ndarray | None  # (rods,): to build a list of pairs
    found: np.ndarray | None  # (capacity, 3): pairs found for that list
    batch: Any  # `batch.Batch`; None where no rods or walls are met


class State(NamedTuple):
    """State of moving rods; an array is `None` if no effect needs it."""

    rods: np.ndarray  # (rods, 7), in space 12; d, sqrt(g d), sqrt(g/d)
    before: np.ndarray  # (rods, 3), in space 6: accelerations of the step before, in g and g/d
    memory: Memory  # of contacts with plate and walls; that in slot s of rod i has row s rods + i
    listed: Listed | None
    scratch: Scratch


class Moving(NamedTuple):
    """Place and motion of a rod in one step."""

    place: tuple  # d
    director: tuple  # unit vector along the axis
    velocity: tuple  # sqrt(g d); half a step before
    turn: tuple  # sqrt(g/d); w, half a step before


class Clock(NamedTuple):
    """Number of a step, and the step size."""

    step: int
    dt: float  # sqrt(d/g)


@kernel
def rod_of(up, rods, i):
    """`Moving` of rod i."""
    dims = len(up)
    place, director = vector(rods, i, 0, up), vector(rods, i, dims, up)
    return Moving(place, director, vector(rods, i, 2 * dims, up), axial(rods, i, 3 * dims, up))


@kernel
def forces_at(up, array, i):
    """Force and torque on rod i, or the accelerations by them."""
    return vector(array, i, 0, up), axial(array, i, len(up), up)


@kernel
def point(inertia, velocity, turn, director, arm):
    """Velocity of a point of a rod, at an arm from the centre.

    Given accelerations in place of velocity and turn, it is the acceleration of the point without
    the part by the motion of the arm.
    """
    return along(velocity, 1.0, swing(turning(inertia.rolling, turn, director), arm))


@kernel
def gravity_force(gravity, like):
    """Force of gravity on a rod, m g, with as many components as `like`; zero without gravity."""
    if gravity is None:
        return nothing(like)
    if len(like) == 3:
        return raised(nothing(like), gravity)
    return gravity


@kernel
def field(effects, velocity):
    """Force on a rod by all effects but contacts, m g."""
    return gravity_force(effects.gravity, velocity)


@kernel
def pull(total, i, arm, force):
    """Add a force at an arm, and its torque, to rod i."""
    add(total, i, 0, force)
    add(total, i, len(force), torque(arm, force))


@kernel
def kept_of(up, memory, row):
    """`Kept` of a contact from its row."""
    return Kept(
        memory.forces[row, 0],
        axial(memory.forces, row, 1, up),
        spring_of(up, memory.springs, row),
    )


@kernel
def spring_of(up, springs, row):
    """Length of the spring of a contact; zero without springs."""
    if springs is None:
        return nothing_across(up)
    return axial(springs, row, 0, up)


@kernel
def nothing_kept(up):
    """`Kept` of an open contact: zeros."""
    return Kept(0.0, nothing_across(up), nothing_across(up))


@kernel
def keep(memory, row, kept):
    """Keep forces and spring of a contact for the next step."""
    put(memory.forces, row, 0, (kept.force, *kept.rub))
    keep_spring(memory.springs, row, kept.spring)


@kernel
def keep_spring(springs, row, length):
    """Keep the length of a spring, if there are springs."""
    if springs is not None:
        put(springs, row, 0, length)


@kernel
def forget(up, memory, row):
    """Clear what is kept of a contact that is open."""
    keep(memory, row, nothing_kept(up))
