"""Contact forces in space, compiled: plate, cylindrical walls, pairs of rods.

Forces are those of `md.contact`. A tangential spring is a vector that stays in the tangent plane of
its contact. Every function adds force and torque to `total`.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ..cache import kernel
from ..contact import Friction, Motion, Normal, push, tangential_constants
from ..integrators import DEEP
from ..row import Between
from .geometry import (
    CROSSING,
    NEARER,
    UP,
    ZERO,
    along,
    at_end,
    between_ends,
    cross,
    dot,
    from_axis,
    gap_vector,
    rise,
    to_inner,
)

PLACE, DIRECTOR, VELOCITY, TURN = 0, 3, 6, 9  # first columns of the rods' state
PLATE_CAPS, INNER, OUTER = 0, 2, 5  # places of a rod's springs: two caps, two ends and between, two
SINGLE = 7
ENDS, BETWEEN_ENDS = 1, 2  # bits: what of two rods touches
SHARED = (1 + NEARER) ** 2 - 1  # squared lever beyond which no end shares a contact between ends


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
def inverse(spin, lightness, lever, director):
    """What a torque per force adds to the inverse of a contact's mass."""
    if spin is None:
        return lightness * (dot(lever, lever) - dot(lever, director) ** 2)
    return lightness * (dot(lever, lever) + spin * dot(lever, director) ** 2)


@kernel
def drag(friction, spin, lightness, others, arm, director, spring, normal, overlap, force, v, dt):
    """Tangential force and the new spring, as `contact.pull` does it, for vectors.

    The spring is first turned into the tangent plane. `others`: inverse mass but for the rotation
    of this rod, whose lever is that about its stretch; `v`: velocities of the contact point half a
    step before and now.
    """
    old = along(spring, -dot(spring, normal), normal)
    stretched = along(old, dt, along(v[0], -dot(v[0], normal), normal))
    slip = along(v[1], -dot(v[1], normal), normal)
    size = sqrt(dot(stretched, stretched))
    mass = 1.0 / others
    if size > 0.0:
        lever = cross(arm, stretched)
        mass = 1.0 / (others + inverse(spin, lightness, lever, director) / (size * size))
    k, g = tangential_constants(friction.spring, overlap, mass)
    f = (
        -k * stretched[0] - g * slip[0],
        -k * stretched[1] - g * slip[1],
        (-k * stretched[2] - g * slip[2]),
    )
    limit, size = friction.coefficient * force, sqrt(dot(f, f))
    if size <= limit:
        return f, stretched
    f = along(ZERO, limit / size, f)
    return f, along(along(ZERO, g / (g + k * dt), old), -dt / (g + k * dt), f)


@kernel
def rubbed(
    friction, spin, lightness, others, arm, director, springs, at, normal, overlap, force, v, dt
):
    """Tangential force of a contact whose spring is kept in `springs[at]`."""
    if friction is None:
        return ZERO
    row, k = at
    kept = springs[row, k, 0], springs[row, k, 1], springs[row, k, 2]
    f, new = drag(
        *(friction, spin, lightness, others, arm, director, kept),
        *(normal, overlap, force, v, dt),
    )
    springs[row, k, 0], springs[row, k, 1], springs[row, k, 2] = new
    return f


@kernel
def forget(springs, at):
    """Of a contact that is open."""
    if springs is not None:
        row, k = at
        springs[row, k, 0], springs[row, k, 1], springs[row, k, 2] = ZERO


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
    overlap = 0.5 - reach
    director = vector(rods, i, DIRECTOR)
    arm = along(along(ZERO, s, director), -reach, normal)
    v = along(moving(world, rods, i, director, arm), -climb, UP)
    now = along(v, dt / 2, gaining(world, before, i, director, arm))
    lever = cross(arm, normal)
    mass = 1.0 / (1.0 + inverse(world.spin, world.lightness, lever, director))
    force = weight * push(law, overlap, dot(now, normal), mass, dt)
    f = rubbed(
        *(friction, world.spin, world.lightness, 1.0, arm, director, springs, (i, place)),
        *(normal, overlap, force, (v, now), dt),
    )
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
def beyond(point):
    """Squared distance of a point from the axis of the annulus."""
    return point[0] * point[0] + point[1] * point[1]


@kernel
def at_outer(wall, world, rods, before, i, springs, total, dt):
    """Forces of the concave wall, which only caps can touch; the deepest overlap."""
    if wall is None:
        return 0.0
    deepest = 0.0
    for cap in range(2):
        s = world.half_length if cap else -world.half_length
        point = along(vector(rods, i, PLACE), s, vector(rods, i, DIRECTOR))
        if beyond(point) <= (wall.radius - 0.5) ** 2:
            forget(springs, (i, OUTER + cap))
            continue
        rho, out = from_axis(point)
        reach = wall.radius - rho
        inwards = -out[0], -out[1], 0.0
        surface(
            *(wall.normal, wall.friction, world, rods, before, i, s, reach, inwards, 1.0, 0.0),
            *(springs, OUTER + cap, total, dt),
        )
        deepest = max(deepest, 0.5 - reach)
    return deepest


@kernel
def at_inner(wall, world, rods, before, i, springs, total, dt):
    """Forces of the convex wall, on the ends and between them; the deepest overlap."""
    if wall is None:
        return 0.0
    place, director, half = vector(rods, i, PLACE), vector(rods, i, DIRECTOR), world.half_length
    deepest = 0.0
    for cap in range(2):
        s = half if cap else -half
        point = along(place, s, director)
        if beyond(point) >= (wall.radius + 0.5) ** 2:
            forget(springs, (i, INNER + cap))
            continue
        rho, out = from_axis(point)
        reach = rho - wall.radius
        surface(
            *(wall.normal, wall.friction, world, rods, before, i, s, reach, out, 1.0, 0.0),
            *(springs, INNER + cap, total, dt),
        )
        deepest = max(deepest, 0.5 - reach)
    s, inside = to_inner(place, director, half)
    point = along(place, s, director)
    if not inside or beyond(point) >= (wall.radius + 0.5) ** 2:
        forget(springs, (i, INNER + 2))
        return deepest
    rho, out = from_axis(point)
    reach = rho - wall.radius
    lower, out_l = from_axis(along(place, -half, director))
    upper, out_u = from_axis(along(place, half, director))
    w_l, slope_l = rise((lower - rho) / NEARER)
    w_u, slope_u = rise((upper - rho) / NEARER)
    surface(
        *(wall.normal, wall.friction, world, rods, before, i, s, reach, out, w_l * w_u, 0.0),
        *(springs, INNER + 2, total, dt),
    )
    overlap = 0.5 - reach
    energy = 0.4 * wall.normal.stiffness * overlap * overlap * sqrt(overlap) / NEARER
    pulled(rods, i, s, out, energy * (slope_l * w_u + w_l * slope_u), total)
    pulled(rods, i, -half, out_l, -energy * slope_l * w_u, total)
    pulled(rods, i, half, out_u, -energy * w_l * slope_u, total)
    return max(deepest, overlap)


@kernel
def pulled(rods, i, s, normal, force, total):
    """Add a force along a normal at place s of the axis of rod i."""
    f = along(ZERO, force, normal)
    add(total, i, 0, f)
    add(total, i, 3, cross(along(ZERO, s, vector(rods, i, DIRECTOR)), f))


@kernel
def met(law, friction, world, rods, before, i, j, s, t, r, weight, springs, at, total, dt):
    """Add what two rods do to each other where places s and t of their axes are closest."""
    a, b = vector(rods, i, DIRECTOR), vector(rods, j, DIRECTOR)
    distance = sqrt(dot(r, r))
    normal, overlap = along(ZERO, 1.0 / distance, r), 1.0 - distance
    p, q = along(along(ZERO, s, a), -0.5, r), along(along(ZERO, t, b), 0.5, r)
    v = along(moving(world, rods, i, a, p), -1.0, moving(world, rods, j, b, q))
    gain = along(gaining(world, before, i, a, p), -1.0, gaining(world, before, j, b, q))
    now = along(v, dt / 2, gain)
    slip = along(v, -dot(v, normal), normal)
    light_i = inverse(world.spin, world.lightness, cross(p, normal), a)
    light_j = inverse(world.spin, world.lightness, cross(q, normal), b)
    mass = 1.0 / (2.0 + light_i + light_j)
    force = weight * push(law, overlap, dot(now, normal), mass, dt)
    f = ZERO
    if friction is not None:
        size = dot(slip, slip)
        others = 2.0
        if size > 0.0:
            others += inverse(world.spin, world.lightness, cross(q, slip), b) / size
        f = rubbed(
            *(friction, world.spin, world.lightness, others, p, a, springs, at),
            *(normal, overlap, force, (v, now), dt),
        )
    f = along(f, force, normal)
    add(total, i, 0, f)
    add(total, i, 3, cross(p, f))
    f = along(ZERO, -1.0, f)
    add(total, j, 0, f)
    add(total, j, 3, cross(q, f))


@kernel(inline=False)
def shared(law, rods, i, j, apart, s, t, distance, half, total):
    """Weight of a contact near an end, or of nearly parallel rods; adds what keeps energy."""
    a, b = vector(rods, i, DIRECTOR), vector(rods, j, DIRECTOR)
    weight = 1.0
    for end in range(4):
        x, y = at_end(apart, a, b, half, end)
        e = gap_vector(apart, a, b, x, y)
        weight *= rise((sqrt(dot(e, e)) - distance) / NEARER)[0]
    overlap, towards = 1.0 - distance, 0.0
    energy = 0.4 * law.stiffness * overlap * overlap * sqrt(overlap) / NEARER
    for end in range(4):
        x, y = at_end(apart, a, b, half, end)
        e = gap_vector(apart, a, b, x, y)
        far = sqrt(dot(e, e))
        w, slope = rise((far - distance) / NEARER)
        if slope > 0.0:
            pull = energy * slope * weight / w
            towards += pull
            normal = along(ZERO, 1.0 / far, e)
            pulled(rods, i, x, normal, -pull, total)
            pulled(rods, j, y, normal, pull, total)
    normal = along(ZERO, 1.0 / distance, gap_vector(apart, a, b, s, t))
    pulled(rods, i, s, normal, towards, total)
    pulled(rods, j, t, normal, -towards, total)
    return weight


@kernel
def ends_met(between, world, rods, before, i, j, apart, a, b, springs, number, was, total, dt):
    """Contacts of four ends: what touches, nearest squared distance, whether too deep."""
    touched, nearest = 0, np.inf
    for end in range(4):
        s, t = at_end(apart, a, b, world.half_length, end)
        r = gap_vector(apart, a, b, s, t)
        square = dot(r, r)
        nearest = min(nearest, square)
        if square >= 1.0:
            if was & ENDS:
                forget(springs, (number, end))
            continue
        if square < (1.0 - DEEP) ** 2:
            return touched, nearest, True
        touched = ENDS
        met(
            *(between.normal, between.friction, world, rods, before, i, j, s, t, r, 1.0),
            *(springs, (number, end), total, dt),
        )
    return touched, nearest, False


@kernel(inline=False)
def pair_forces(between, world, rods, before, pairs, springs, total, dt):
    """Forces of all listed pairs; number of a pair that is too deep, or -1.

    Where two axes are closest between their ends, by so much that no end can touch or share the
    contact, the ends need no look.
    """
    half, travelled = world.half_length, pairs.travelled[0]
    for k in range(pairs.count[0]):
        if travelled < pairs.asleep[k]:
            continue
        i, j, number = pairs.index[k, 0], pairs.index[k, 1], pairs.index[k, 2]
        apart = along(vector(rods, i, PLACE), -1.0, vector(rods, j, PLACE))
        a, b = vector(rods, i, DIRECTOR), vector(rods, j, DIRECTOR)
        was, now = pairs.touched[number], 0
        s, t, skew, inside = between_ends(apart, a, b, half)
        r = gap_vector(apart, a, b, s, t)
        nearest, clear = dot(r, r), False
        if inside:
            margin = half - max(abs(s), abs(t))
            clear = nearest >= 1.0 or margin * margin * skew >= max(SHARED, 1.0 - nearest)
        if inside and nearest < 1.0:
            if nearest < (1.0 - DEEP) ** 2:
                return k
            now, weight = BETWEEN_ENDS, 1.0
            if not clear:
                distance = sqrt(nearest)
                weight = shared(between.normal, rods, i, j, apart, s, t, distance, half, total)
            met(
                *(between.normal, between.friction, world, rods, before, i, j, s, t, r, weight),
                *(springs, (number, CROSSING), total, dt),
            )
        elif was & BETWEEN_ENDS:
            forget(springs, (number, CROSSING))
        if not clear:
            touched, other, deep = ends_met(
                *(between, world, rods, before, i, j, apart, a, b, springs, number, was, total, dt),
            )
            if deep:
                return k
            now |= touched
            nearest = min(nearest, other) if inside else other
        elif was & ENDS:
            for end in range(4):
                forget(springs, (number, end))
        pairs.touched[number] = now
        if nearest > 1.0:  # each of the two may come half of the gap closer
            pairs.asleep[k] = travelled + 0.5 * (sqrt(nearest) - 1.0)
    return -1
