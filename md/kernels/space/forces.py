"""Contact forces in space, compiled: friction, fixed surfaces, and what takes off energy.

Forces are those of `kernels.contact`. A tangential spring is a vector that stays in the tangent
plane of its contact. Every function adds force and torque to the total.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ...cache import kernel
from ..batch import Batch
from ..codes import (
    DIRECTOR,
    PLATE_FRICTION,
    PLATE_NORMAL,
    PLATE_WORK,
    TURN,
    VELOCITY,
    WALL_FRICTION,
)
from ..contact import (
    ZERO,
    ContactForces,
    Friction,
    Motion,
    Normal,
    add,
    along,
    normal_force,
    put,
    tangential_constants,
    vector,
)
from .geometry import UP, cross, dot, times


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


class Pairs(NamedTuple):
    """Pairs of axes closer than 1 + SKIN, and of every two rods whether they touch."""

    count: np.ndarray  # type: ignore[assignment]  # (1,); a tuple has a method of this name
    index: np.ndarray  # type: ignore[assignment]  # (N (N - 1)/2, 3): first rod, second, number of the pair
    asleep: np.ndarray  # (N (N - 1)/2,), d: until so much was travelled, the entry cannot touch
    touched: np.ndarray  # (N (N - 1)/2,)
    travelled: np.ndarray  # (1,), d: how far any rod may have moved since the list was made


class State(NamedTuple):
    """Rods in space under way; `None` for what they do without."""

    rods: np.ndarray  # (N, 12): columns PLACE to TURN of `codes`, in d, sqrt(g d), sqrt(g/d)
    before: np.ndarray  # (N, 6): accelerations of the step before, of the centre and of w
    # (N, SLOTS, 3), d: of plate and walls; of a constraint the force at the upper cap, m g
    springs: np.ndarray | None
    pairs: Pairs | None
    pair_springs: np.ndarray | None  # (pairs, PAIR_SLOTS, 3), d
    scratch: np.ndarray  # (N, 6): force and torque of a step, in m g and m g d
    # (ANNULUS_LEDGER, N, 6): of them, what takes off energy; see `lose`. None: no ledger
    lost: np.ndarray | None = None
    flat: np.ndarray | None = None  # (N, touches.FLAT): rods as of a row. None: no record
    batch: Batch | None = None  # contacts of a step


class At(NamedTuple):
    """Where a fixed surface may touch a rod."""

    s: float  # d; place on the axis, from the centre
    reach: float  # d; from there to the surface
    out: tuple[float, float, float]  # unit vector from the surface to the rod
    climb: float  # sqrt(g d); the surface's velocity along z
    share: float  # weight of the contact, 0 to 1
    slot: int  # of the contact's spring


class Rubbing(NamedTuple):
    """What friction acts on in a contact in space."""

    normal: tuple[float, float, float]  # unit vector
    overlap: float  # d
    force: float  # F_n, m g
    half: tuple[float, float, float]  # sqrt(g d); velocity of the contact half a step before
    now: tuple[float, float, float]  # the same at the step


@kernel
def act(total, i, arm, f):
    """Add a force at an arm, and its torque, to rod i."""
    add(total, i, 0, f)
    add(total, i, 3, cross(arm, f))


@kernel
def lose(lost, kind, i, arm, f):
    """Note a force at an arm that takes energy off rod i; `settle` accounts for it."""
    if lost is not None:
        act(lost[kind], i, arm, f)
        lost[PLATE_WORK, i, 0] = 1.0  # there is something to settle


@kernel
def lifted(lost, i, force, elastic, climb):
    """Note what a surface that moves along its normal works, and its part of what is lost."""
    if lost is not None:
        lost[PLATE_WORK, i, 1] += force * climb
        lost[PLATE_WORK, i, 2] += (elastic - force) * climb


@kernel
def carried(shaken, lost, i, power):
    """Note what a wall that moves along its surface works, all of it by friction."""
    if shaken is None:
        return
    if lost is not None:
        lost[PLATE_WORK, i, 1] += power
        lost[PLATE_WORK, i, 3] += power


@kernel
def climbing(shaken, climb):
    """Velocity of the walls along z, that of the plate or none."""
    return 0.0 if shaken is None else climb


@kernel
def settle(shaken, ledger, lost, i, velocity, omega, dt):
    """Add to the ledger what rod i lost in a step, with the velocities of its moment."""
    if ledger is None or lost is None:
        return
    if lost[PLATE_WORK, i, 0] == 0.0:
        return
    ledger[PLATE_WORK] += dt * lost[PLATE_WORK, i, 1]
    ledger[PLATE_NORMAL] -= dt * lost[PLATE_WORK, i, 2]
    if shaken is not None:
        ledger[WALL_FRICTION] += dt * lost[PLATE_WORK, i, 3]
    for kind in range(PLATE_WORK, lost.shape[0]):
        if kind != PLATE_WORK:
            power = dot(vector(lost[kind], i, 0), velocity) + dot(vector(lost[kind], i, 3), omega)
            ledger[kind] -= dt * power
        put(lost[kind], i, 0, ZERO)
        put(lost[kind], i, 3, ZERO)


@kernel
def turning(rolling, w, director):
    """Angular velocity."""
    if rolling is None:
        return w
    return along(w, rolling * dot(w, director), director)


@kernel
def across(rolling, w, director):
    """Without rolling w stays across the director."""
    if rolling is None:
        return along(w, -dot(w, director), director)
    return w


@kernel
def inverse(rolling, lightness, arm, director, force):
    """What a force at an arm adds to the inverse of a contact's mass, times the force squared."""
    lever = cross(arm, force)
    axial = dot(lever, director)
    if rolling is None:
        return lightness * (dot(lever, lever) - axial * axial)
    return lightness * (dot(lever, lever) + rolling * axial * axial)


@kernel
def across_normal(lightness, s, director, normal):
    """The same for a normal force of one at place s of the axis, which passes through the axis."""
    slant = dot(director, normal)
    return lightness * s * s * (1.0 - slant * slant)


@kernel
def tangential(v, normal):
    """Part of a vector across the normal."""
    return along(v, -dot(v, normal), normal)


@kernel
def forget(springs, row, place):
    """Clear the spring of a contact that is open."""
    if springs is not None:
        put(springs[row], place, 0, ZERO)


@kernel
def moving(effects, state, i, director, arm):
    """Velocity of a point of the rod half a step before."""
    omega = turning(effects.rolling, vector(state.rods, i, TURN), director)
    return along(vector(state.rods, i, VELOCITY), 1.0, cross(omega, arm))


@kernel
def gaining(effects, state, i, director, arm):
    """Its acceleration in the last step, but for that towards the centre."""
    alpha = turning(effects.rolling, vector(state.before, i, 3), director)
    return along(vector(state.before, i, 0), 1.0, cross(alpha, arm))


@kernel
def spring_friction(constants, limit, length, stretched, slip, dt):
    """Friction force, its size and the spring's new length, as `contact.spring_friction` has.

    Vectors; `stretched` is the `length` after the slip of a step.
    """
    k, g = constants
    f = along(times(-k, stretched), -g, slip)
    square = dot(f, f)
    if square <= limit * limit:
        return f, sqrt(square), stretched
    f = times(limit / sqrt(square), f)
    relaxed = 1.0 / (g + k * dt)
    return f, limit, along(times(g * relaxed, length), -dt * relaxed, f)


@kernel
def friction_force(friction, effects, bodies, springs, at, rubbing, dt):
    """Friction force between a fixed surface and a body, and its size.

    `bodies`: arm and director; `at`: where the contact's spring is kept. None where friction is a
    constraint, which comes later (`plate.held`).
    """
    if friction is None:
        return ZERO, 0.0
    return sprung(friction.spring, friction, effects, bodies, springs, at, rubbing, dt)


@kernel
def sprung(spring, friction, effects, bodies, springs, at, rubbing, dt):
    """The same, of any friction."""
    if spring is None:
        return ZERO, 0.0
    own = springs[at[0]]
    f, size, length = spring_force(friction, effects, bodies, vector(own, at[1], 0), rubbing, dt)
    put(own, at[1], 0, length)
    return f, size


@kernel
def spring_force(friction, effects, bodies, length, rubbing, dt):
    """Friction force on the first of one or two bodies, its size and the spring's new length."""
    n = rubbing.normal
    length = tangential(length, n)
    stretched = along(length, dt, tangential(rubbing.half, n))
    square, light, turned = dot(stretched, stretched), 1.0 * len(bodies), 0.0
    for arm, director in bodies:
        turned += inverse(effects.rolling, effects.lightness, arm, director, stretched)
    mass = square / (light * square + turned) if square > 0.0 else 1.0 / light
    constants = tangential_constants(friction.spring, rubbing.overlap, mass)
    limit = friction.coefficient * rubbing.force
    return spring_friction(constants, limit, length, stretched, tangential(rubbing.now, n), dt)


@kernel
def pressed(normal, effects, at, director, v, gain, dt):
    """What friction acts on at a fixed surface; `v`, `gain`: of the contact against it."""
    overlap = max(0.5 - at.reach, 0.0)  # a rounding may have told a touch
    now = along(v, dt / 2, gain)
    mass = 1.0 / (1.0 + across_normal(effects.lightness, at.s, director, at.out))
    force = at.share * normal_force(normal, overlap, dot(now, at.out), mass, dt)
    return Rubbing(at.out, overlap, force, v, now)


@kernel
def surface(normal, friction, effects, state, i, at, dt):
    """Add what the plate does to rod i at the place `at`; the arm, `Rubbing`, F_t's size."""
    director = vector(state.rods, i, DIRECTOR)
    arm = along(times(at.s, director), -at.reach, at.out)
    v = along(moving(effects, state, i, director, arm), -at.climb, UP)
    gain = gaining(effects, state, i, director, arm)
    rubbing, bodies = pressed(normal, effects, at, director, v, gain, dt), ((arm, director),)
    force, overlap = rubbing.force, rubbing.overlap
    f, size = friction_force(friction, effects, bodies, state.springs, (i, at.slot), rubbing, dt)
    act(state.scratch, i, arm, along(f, force, at.out))
    elastic = at.share * normal.stiffness * overlap * sqrt(overlap)
    lose(state.lost, PLATE_NORMAL, i, arm, times(force - elastic, at.out))
    lose(state.lost, PLATE_FRICTION, i, arm, f)
    lifted(state.lost, i, force, elastic, at.climb)
    return arm, rubbing, size


@kernel
def ends(half):
    """How many ends a rod has; a sphere has one."""
    return 2 if half > 0.0 else 1
