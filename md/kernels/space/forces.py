"""Rods in space, compiled: what acts on them, their state, and the motion of their points.

A tangential spring is a vector that stays across the normal of its contact.
"""

from typing import NamedTuple

import numpy as np

from ...cache import kernel
from ..batch import Batch
from ..codes import TURN, VELOCITY
from ..contact import ContactForces, Friction, Inertia, Motion, Normal, swung
from ..neighbours import Listed
from ..vectors import ZERO, add, along, cross, put, vector


class Wall(NamedTuple):
    """A vertical cylinder about the axis x = y = 0."""

    radius: float  # d
    normal: Normal
    friction: Friction | None


class SpaceEffects(NamedTuple):
    """All that acts on rods in space; `None`: absent."""

    half_length: float  # d
    lightness: float  # 1/k^2, 1/d^2
    rolling: float | None = None  # I/I_axial - 1; None: no rotation of a rod about its axis
    gravity: float | None = None  # along z, g
    plate: Motion | None = None  # at rest at z = 0
    normal: Normal | None = None  # of the plate; None: no plate
    friction: Friction | None = None
    inner: Wall | None = None
    outer: Wall | None = None
    shaken: bool | None = None  # True: both walls move with the plate; None: they are at rest
    between: ContactForces | None = None


class Scratch(NamedTuple):
    """Arrays that hold nothing from one step to the next."""

    total: np.ndarray  # (N, 6): force and torque of a step, in m g and m g d
    place: np.ndarray | None  # (N,): for a list of pairs
    found: np.ndarray | None  # (capacity, 3): the same
    batch: Batch  # contacts of a step


class State(NamedTuple):
    """Rods in space under way; `None` for what they do without."""

    rods: np.ndarray  # (N, 12): columns PLACE to TURN of `codes`, in d, sqrt(g d), sqrt(g/d)
    before: np.ndarray  # (N, 6): accelerations of the step before, of the centre and of w
    forces: np.ndarray | None  # (N, SLOTS, 4), m g: F_n and F_t by plate and walls a step before
    springs: np.ndarray | None  # (N, SLOTS, 3), d: of plate and walls
    listed: Listed | None
    scratch: Scratch
    flat: np.ndarray | None = None  # (N, touches.FLAT): rods as of a row. None: no record


@kernel
def inertia_of(effects):
    """How the rods turn."""
    return Inertia(effects.lightness, effects.rolling)


@kernel
def act(total, i, arm, f):
    """Add a force at an arm, and its torque, to rod i."""
    add(total, i, 0, f)
    add(total, i, 3, cross(arm, f))


@kernel
def kept(array, row, slot, first):
    """A vector that is kept of a contact; zero where nothing is."""
    return ZERO if array is None else vector(array[row], slot, first)


@kernel
def kept_number(array, row, slot):
    """The first number that is kept of a contact; zero where nothing is."""
    return 0.0 if array is None else array[row, slot, 0]


@kernel
def opened(listed, k, slot):
    """Clear what is kept of a contact of two rods that is open."""
    now = listed.turn[0]
    keeps_forces(listed.forces[now], k, slot, 0.0, ZERO)
    if listed.springs is not None:
        put(listed.springs[now, k], slot, 0, ZERO)


@kernel
def keeps_forces(array, row, slot, normal, rub):
    """Keep F_n and F_t for the next step."""
    if array is not None:
        array[row, slot, 0] = normal
        put(array[row], slot, 1, rub)


@kernel
def keeps(array, row, slot, v):
    """Keep it for the next step."""
    if array is not None:
        put(array[row], slot, 0, v)


@kernel
def forget(forces, springs, row, slot):
    """Clear what is kept of a contact that is open."""
    keeps_forces(forces, row, slot, 0.0, ZERO)
    keeps(springs, row, slot, ZERO)


@kernel
def moving(effects, state, i, director, arm):
    """Velocity of a point of the rod half a step before."""
    w = vector(state.rods, i, TURN)
    return along(vector(state.rods, i, VELOCITY), 1.0, swung(effects.rolling, w, director, arm))


@kernel
def ends(half):
    """How many ends a rod has; a sphere has one."""
    return 2 if half > 0.0 else 1
