"""Contact forces in space, compiled: friction, plate, cylindrical walls. Pairs: `pairs`.

Forces are those of `md.contact`. A tangential spring is a vector that stays in the tangent plane of
its contact. Every function adds force and torque to `total`.
"""

from math import sqrt
from typing import NamedTuple

from ...cache import kernel
from ..contact import Friction, Motion, Normal, push, tangential_constants
from ..plane import Between
from .geometry import (
    NEARER,
    UP,
    ZERO,
    along,
    beyond,
    cross,
    dot,
    from_axis,
    passes,
    rise,
)

PLACE, DIRECTOR, VELOCITY, TURN = 0, 3, 6, 9  # first columns of the rods' state
PLATE_CAPS, INNER, OUTER = 0, 2, 5  # places of a rod's springs: two caps, two ends and between, two
SINGLE = 7


class Wall(NamedTuple):
    """A vertical cylinder about the axis x = y = 0."""

    radius: float
    normal: Normal
    friction: Friction | None


class Space(NamedTuple):
    """All that acts; `None`: absent."""

    half_length: float
    lightness: float  # 1/k^2
    spin: float | None  # I/I_axial - 1; None: no spin about the axis
    gravity: float | None  # along z
    plate: Motion | None  # at rest at z = 0
    normal: Normal | None  # of the plate; None: no plate
    friction: Friction | None
    inner: Wall | None
    outer: Wall | None
    between: Between | None


@kernel
def vector(array, i, first):
    """Three numbers of row i."""
    return array[i, first], array[i, first + 1], array[i, first + 2]


@kernel
def add(array, i, first, v):
    """Add a vector to row i."""
    array[i, first] += v[0]
    array[i, first + 1] += v[1]
    array[i, first + 2] += v[2]


@kernel
def put(array, i, first, v):
    """Put a vector into row i."""
    array[i, first], array[i, first + 1], array[i, first + 2] = v


@kernel
def turning(spin, w, director):
    """Angular velocity."""
    if spin is None:
        return w
    return along(w, spin * dot(w, director), director)


@kernel
def inverse(spin, lightness, arm, director, push):
    """What a force at an arm adds to the inverse of a contact's mass, times the force squared."""
    lever = cross(arm, push)
    axial = dot(lever, director)
    if spin is None:
        return lightness * (dot(lever, lever) - axial * axial)
    return lightness * (dot(lever, lever) + spin * axial * axial)


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
def kept(springs, at):
    """Spring of a contact."""
    row, k = at
    return springs[row, k, 0], springs[row, k, 1], springs[row, k, 2]


@kernel
def keep(springs, at, spring):
    """Keep it for the next step."""
    row, k = at
    springs[row, k, 0], springs[row, k, 1], springs[row, k, 2] = spring


@kernel
def drag(friction, mass, spring, stretched, slip, overlap, force, dt):
    """Tangential force and the new spring, as `contact.pull` does it, for vectors.

    `stretched` is the `spring` after the slip of a step.
    """
    k, g = tangential_constants(friction.spring, overlap, mass)
    f = along(along(ZERO, -k, stretched), -g, slip)
    limit, square = friction.coefficient * force, dot(f, f)
    if square <= limit * limit:
        return f, stretched
    f = along(ZERO, limit / sqrt(square), f)
    relaxed = 1.0 / (g + k * dt)
    return f, along(along(ZERO, g * relaxed, spring), -dt * relaxed, f)


@kernel
def forget(springs, at):
    """Of a contact that is open."""
    if springs is not None:
        keep(springs, at, ZERO)


@kernel
def moving(world, rods, i, director, arm):
    """Velocity of a point of the rod half a step before."""
    omega = turning(world.spin, vector(rods, i, TURN), director)
    return along(vector(rods, i, VELOCITY), 1.0, cross(omega, arm))


@kernel
def gaining(world, before, i, director, arm):
    """Its acceleration in the last step, but for that towards the centre."""
    alpha = turning(world.spin, vector(before, i, 3), director)
    return along(vector(before, i, 0), 1.0, cross(alpha, arm))


@kernel
def rubbed(friction, world, bodies, springs, at, n, overlap, force, v, now, dt):
    """Tangential force between a fixed surface and a body, or on the first of two.

    `bodies`: arm and director of each; `v`, `now`: velocity of the contact point half a step
    before and now.
    """
    if friction is None:
        return ZERO
    spring = tangential(kept(springs, at), n)
    stretched = along(spring, dt, tangential(v, n))
    square, light, turned = dot(stretched, stretched), 1.0 * len(bodies), 0.0
    for arm, director in bodies:
        turned += inverse(world.spin, world.lightness, arm, director, stretched)
    mass = square / (light * square + turned) if square > 0.0 else 1.0 / light
    f, spring = drag(friction, mass, spring, stretched, tangential(now, n), overlap, force, dt)
    keep(springs, at, spring)
    return f


@kernel
def surface(
    law,
    friction,
    world,
    rods,
    before,
    i,
    s,
    reach,
    normal,
    weight,
    climb,
    springs,
    place,
    total,
    dt,
):
    """Add what a fixed surface does to rod i at place s of the axis, at a distance `reach` from it.

    `climb`: the surface's velocity along z.
    """
    overlap = max(0.5 - reach, 0.0)  # a rounding may have told a touch
    director = vector(rods, i, DIRECTOR)
    arm = along(along(ZERO, s, director), -reach, normal)
    v = along(moving(world, rods, i, director, arm), -climb, UP)
    now = along(v, dt / 2, gaining(world, before, i, director, arm))
    mass = 1.0 / (1.0 + across_normal(world.lightness, s, director, normal))
    force = weight * push(law, overlap, dot(now, normal), mass, dt)
    bodies = ((arm, director),)
    f = rubbed(friction, world, bodies, springs, (i, place), normal, overlap, force, v, now, dt)
    f = along(f, force, normal)
    add(total, i, 0, f)
    add(total, i, 3, cross(arm, f))


@kernel
def on_plate(law, world, rods, before, i, plate, springs, total, dt):
    """Plate forces at both caps; the deepest overlap."""
    if law is None:
        return 0.0
    deepest = 0.0
    for cap in range(2):
        s = world.half_length if cap else -world.half_length
        reach = rods[i, PLACE + 2] + s * rods[i, DIRECTOR + 2] - plate[0]
        if reach >= 0.5:
            forget(springs, (i, PLATE_CAPS + cap))
            continue
        surface(
            *(law, world.friction, world, rods, before, i, s, reach, UP, 1.0, plate[1]),
            *(springs, PLATE_CAPS + cap, total, dt),
        )
        deepest = max(deepest, 0.5 - reach)
    return deepest


@kernel
def at_outer(wall, world, rods, before, i, seen, springs, total, dt):
    """Forces of the concave wall, which only caps can touch; the deepest overlap."""
    if wall is None:
        return 0.0
    deepest = 0.0
    for cap in range(2):
        s = world.half_length if cap else -world.half_length
        if beyond(seen, s) <= (wall.radius - 0.5) ** 2:
            forget(springs, (i, OUTER + cap))
            continue
        rho, out = from_axis(along(vector(rods, i, PLACE), s, vector(rods, i, DIRECTOR)))
        reach = wall.radius - rho
        inwards = -out[0], -out[1], 0.0
        surface(
            *(wall.normal, wall.friction, world, rods, before, i, s, reach, inwards, 1.0, 0.0),
            *(springs, OUTER + cap, total, dt),
        )
        deepest = max(deepest, 0.5 - reach)
    return deepest


@kernel
def at_inner(wall, world, rods, before, i, seen, springs, total, dt):
    """Forces of the convex wall, on the ends and between them; the deepest overlap."""
    if wall is None:
        return 0.0
    half, deepest = world.half_length, 0.0
    for cap in range(2):
        s = half if cap else -half
        if beyond(seen, s) >= (wall.radius + 0.5) ** 2:
            forget(springs, (i, INNER + cap))
            continue
        rho, out = from_axis(along(vector(rods, i, PLACE), s, vector(rods, i, DIRECTOR)))
        reach = rho - wall.radius
        surface(
            *(wall.normal, wall.friction, world, rods, before, i, s, reach, out, 1.0, 0.0),
            *(springs, INNER + cap, total, dt),
        )
        deepest = max(deepest, 0.5 - reach)
    if not passes(seen, half, wall.radius + 0.5):
        forget(springs, (i, INNER + 2))
        return deepest
    s = -seen[1] / seen[2]
    return max(deepest, beside(wall, world, rods, before, i, s, springs, total, dt))


@kernel
def beside(wall, world, rods, before, i, s, springs, total, dt):
    """Forces of the convex wall at a place between the ends; the overlap."""
    place, director, half = vector(rods, i, PLACE), vector(rods, i, DIRECTOR), world.half_length
    rho, out = from_axis(along(place, s, director))
    reach = rho - wall.radius
    lower, out_l = from_axis(along(place, -half, director))
    upper, out_u = from_axis(along(place, half, director))
    w_l, slope_l = rise((lower - rho) * (1 / NEARER))
    w_u, slope_u = rise((upper - rho) * (1 / NEARER))
    surface(
        *(wall.normal, wall.friction, world, rods, before, i, s, reach, out, w_l * w_u, 0.0),
        *(springs, INNER + 2, total, dt),
    )
    overlap = max(0.5 - reach, 0.0)
    if slope_l + slope_u == 0.0:
        return overlap
    energy = 0.4 * wall.normal.stiffness * overlap * overlap * sqrt(overlap) * (1 / NEARER)
    pulled(rods, i, s, out, energy * (slope_l * w_u + w_l * slope_u), total)
    pulled(rods, i, -half, out_l, -energy * slope_l * w_u, total)
    pulled(rods, i, half, out_u, -energy * w_l * slope_u, total)
    return overlap


@kernel
def pulled(rods, i, s, normal, force, total):
    """Add a force along a normal at place s of the axis of rod i."""
    f = along(ZERO, force, normal)
    add(total, i, 0, f)
    add(total, i, 3, cross(along(ZERO, s, vector(rods, i, DIRECTOR)), f))
