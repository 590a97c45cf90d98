"""Contact forces in space, compiled: friction, plate, cylindrical walls. Pairs: `pairs`.

Forces are those of `kernels.contact`. A tangential spring is a vector that stays in the tangent
plane of its contact. Every function adds force and torque to the total.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ...cache import kernel
from ..codes import DIRECTOR, INNER, OUTER, PLACE, PLATE_CAPS, TURN, VELOCITY
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
from .geometry import NEARER, UP, beyond, cross, dot, from_axis, passes, rise


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
    springs: np.ndarray | None  # (N, SLOTS, 3), d: of plate and walls
    pairs: Pairs | None
    pair_springs: np.ndarray | None  # (pairs, PAIR_SLOTS, 3), d
    scratch: np.ndarray  # (N, 6): force and torque of a step, in m g and m g d


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
def turning(rolling, w, director):
    """Angular velocity."""
    if rolling is None:
        return w
    return along(w, rolling * dot(w, director), director)


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
def spring_friction(friction, mass, spring, stretched, slip, rubbing, dt):
    """Friction force and the new spring, as `contact.spring_friction` has them, for vectors.

    `stretched` is the `spring` after the slip of a step.
    """
    k, g = tangential_constants(friction.spring, rubbing.overlap, mass)
    f = along(along(ZERO, -k, stretched), -g, slip)
    limit, square = friction.coefficient * rubbing.force, dot(f, f)
    if square <= limit * limit:
        return f, stretched
    f = along(ZERO, limit / sqrt(square), f)
    relaxed = 1.0 / (g + k * dt)
    return f, along(along(ZERO, g * relaxed, spring), -dt * relaxed, f)


@kernel
def friction_force(friction, effects, bodies, springs, at, rubbing, dt):
    """Friction force between a fixed surface and a body, or on the first of two.

    `bodies`: arm and director of each; `at`: where the contact's spring is kept.
    """
    if friction is None:
        return ZERO
    n, row, place = rubbing.normal, at[0], at[1]
    spring = tangential(vector(springs[row], place, 0), n)
    stretched = along(spring, dt, tangential(rubbing.half, n))
    square, light, turned = dot(stretched, stretched), 1.0 * len(bodies), 0.0
    for arm, director in bodies:
        turned += inverse(effects.rolling, effects.lightness, arm, director, stretched)
    mass = square / (light * square + turned) if square > 0.0 else 1.0 / light
    slip = tangential(rubbing.now, n)
    f, spring = spring_friction(friction, mass, spring, stretched, slip, rubbing, dt)
    put(springs[row], place, 0, spring)
    return f


@kernel
def surface(normal, friction, effects, state, i, at, dt):
    """Add what a fixed surface does to rod i at the place `at`."""
    overlap = max(0.5 - at.reach, 0.0)  # a rounding may have told a touch
    director = vector(state.rods, i, DIRECTOR)
    arm = along(along(ZERO, at.s, director), -at.reach, at.out)
    v = along(moving(effects, state, i, director, arm), -at.climb, UP)
    now = along(v, dt / 2, gaining(effects, state, i, director, arm))
    mass = 1.0 / (1.0 + across_normal(effects.lightness, at.s, director, at.out))
    force = at.share * normal_force(normal, overlap, dot(now, at.out), mass, dt)
    rubbing, bodies = Rubbing(at.out, overlap, force, v, now), ((arm, director),)
    f = friction_force(friction, effects, bodies, state.springs, (i, at.slot), rubbing, dt)
    act(state.scratch, i, arm, along(f, force, at.out))


@kernel
def on_plate(law, effects, state, i, plate, dt):
    """Add the plate's forces at both caps; the deepest overlap."""
    if law is None:
        return 0.0
    deepest, rods = 0.0, state.rods
    for cap in range(2):
        s = effects.half_length if cap else -effects.half_length
        reach = rods[i, PLACE + 2] + s * rods[i, DIRECTOR + 2] - plate[0]
        if reach >= 0.5:
            forget(state.springs, i, PLATE_CAPS + cap)
            continue
        at = At(s, reach, UP, plate[1], 1.0, PLATE_CAPS + cap)
        surface(law, effects.friction, effects, state, i, at, dt)
        deepest = max(deepest, 0.5 - reach)
    return deepest


@kernel
def at_caps(wall, effects, state, i, seen, side, dt):
    """Add a wall's forces at both caps; the deepest overlap. `side`: 1 convex wall, -1 concave."""
    if wall is None:
        return 0.0
    deepest, rods, slot = 0.0, state.rods, INNER if side > 0 else OUTER
    touching = wall.radius + 0.5 * side
    for cap in range(2):
        s = effects.half_length if cap else -effects.half_length
        if side * (beyond(seen, s) - touching**2) >= 0:
            forget(state.springs, i, slot + cap)
            continue
        rho, out = from_axis(along(vector(rods, i, PLACE), s, vector(rods, i, DIRECTOR)))
        out = side * out[0], side * out[1], 0.0
        at = At(s, side * (rho - wall.radius), out, 0.0, 1.0, slot + cap)
        surface(wall.normal, wall.friction, effects, state, i, at, dt)
        deepest = max(deepest, 0.5 - at.reach)
    return deepest


@kernel
def at_inner(wall, effects, state, i, seen, dt):
    """Add the forces of the convex wall, on caps and between them; the deepest overlap."""
    if wall is None:
        return 0.0
    deepest = at_caps(wall, effects, state, i, seen, 1, dt)
    if not passes(seen, effects.half_length, wall.radius + 0.5):
        forget(state.springs, i, INNER + 2)
        return deepest
    return max(deepest, beside(wall, effects, state, i, -seen[1] / seen[2], dt))


@kernel
def beside(wall, effects, state, i, s, dt):
    """Add the forces of the convex wall at a place between the ends; the overlap."""
    rods, half = state.rods, effects.half_length
    place, director = vector(rods, i, PLACE), vector(rods, i, DIRECTOR)
    rho, out = from_axis(along(place, s, director))
    lower, out_l = from_axis(along(place, -half, director))
    upper, out_u = from_axis(along(place, half, director))
    w_l, slope_l = rise((lower - rho) * (1 / NEARER))
    w_u, slope_u = rise((upper - rho) * (1 / NEARER))
    at = At(s, rho - wall.radius, out, 0.0, w_l * w_u, INNER + 2)
    surface(wall.normal, wall.friction, effects, state, i, at, dt)
    overlap = max(0.5 - at.reach, 0.0)
    if slope_l + slope_u == 0.0:
        return overlap
    energy = 0.4 * wall.normal.stiffness * overlap * overlap * sqrt(overlap) * (1 / NEARER)
    attracted(state, i, s, out, energy * (slope_l * w_u + w_l * slope_u))
    attracted(state, i, -half, out_l, -energy * slope_l * w_u)
    attracted(state, i, half, out_u, -energy * w_l * slope_u)
    return overlap


@kernel
def attracted(state, i, s, normal, force):
    """Add a force along a normal at place s of the axis of rod i."""
    arm = along(ZERO, s, vector(state.rods, i, DIRECTOR))
    act(state.scratch, i, arm, along(ZERO, force, normal))
