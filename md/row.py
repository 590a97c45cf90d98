"""Many rods in a plane, compiled: pair forces, plate forces, leapfrog.

Two rods touch where an end of one comes close to the axis of the other. Each of the four ends of
a pair is a contact of its own, with its own spring: two parallel rods that lie against each other
touch at two places, and as they turn the force passes from one place to the other without a jump,
which the single closest point of two segments could not do. Each contact force derives from the
distance of its end, so that without dashpots energy is kept.
"""

from math import sqrt
from typing import NamedTuple

from .cache import kernel
from .contact import (
    Friction,
    Normal,
    Scene,
    accelerations,
    plate_at,
    pull,
    push,
    tangential_constants,
    weight,
)
from .integrators import DEEP, DONE, NOT_FINITE, TOO_DEEP, turned
from .neighbours import COSINE, SINE, X, Z, apart, build, nearest_squared, places, strayed

C_X, C_Z, OMEGA = 4, 5, 6  # columns of the rods' state after place and direction
COLUMNS = 7
FULL = 4  # why a run ended: the list of pairs is full
PAIR_TOO_DEEP = 5


class Between(NamedTuple):
    """Contacts of rods with each other."""

    normal: Normal
    friction: Friction | None


class Crowd(NamedTuple):
    """All that acts on many rods; `None`: absent."""

    alone: Scene  # one rod, plate and gravity
    between: Between | None
    period: float | None  # of the box along x; None: open
    skin: float


@kernel
def beyond(period, image):
    """Distance of an image from its rod."""
    if period is None:
        return 0.0
    return image * period


@kernel
def pair_friction(friction, overlap, force, length, slip, mass, dt):
    """F_t between two rods and the spring's new length."""
    if friction is None:
        return 0.0, 0.0
    k, g = tangential_constants(friction.spring, overlap, mass)
    return pull(k, g, length, slip, slip, friction.coefficient * force, dt)


@kernel(inline=False)
def pair_forces(crowd, between, rods, listed, total, dt):
    """Add the accelerations by all touching pairs to `total`; number of a pair that is too deep."""
    half, light = crowd.alone.half_length, crowd.alone.lightness
    now, index, springs = listed.turn[0], listed.index, listed.springs
    for k in range(listed.start[now, rods.shape[0]]):
        i, j = index[now, k, 0], index[now, k, 1]
        dx = rods[i, X] - rods[j, X] - beyond(crowd.period, index[now, k, 2])
        dz = rods[i, Z] - rods[j, Z]
        a, b = (rods[i, SINE], rods[i, COSINE]), (rods[j, SINE], rods[j, COSINE])
        if nearest_squared(dx, dz, a, b, half) >= 1.0:
            for end in range(4):
                springs[now, k, end] = 0.0
            continue
        for end in range(4):
            s, t = places(dx, dz, a, b, half, end)
            r_x, r_z = apart(dx, dz, a, b, s, t)
            square = r_x * r_x + r_z * r_z
            if square >= 1.0:
                springs[now, k, end] = 0.0
                continue
            if square < (1 - DEEP) ** 2:
                return k
            r = sqrt(square)
            n_x, n_z, overlap = r_x / r, r_z / r, 1.0 - r
            p_x, p_z = s * a[0] - 0.5 * r_x, s * a[1] - 0.5 * r_z  # arms to the contact point
            q_x, q_z = t * b[0] + 0.5 * r_x, t * b[1] + 0.5 * r_z
            v_x = rods[i, C_X] + rods[i, OMEGA] * p_z - rods[j, C_X] - rods[j, OMEGA] * q_z
            v_z = rods[i, C_Z] - rods[i, OMEGA] * p_x - rods[j, C_Z] + rods[j, OMEGA] * q_x
            lever_i, lever_j = p_z * n_x - p_x * n_z, q_z * n_x - q_x * n_z
            mass = 1 / (2 + (lever_i * lever_i + lever_j * lever_j) * light)
            force = push(between.normal, overlap, v_x * n_x + v_z * n_z, mass, dt)
            # Tangent (n_z, -n_x); its levers are p.n and q.n.
            across_i, across_j = p_z * n_z + p_x * n_x, q_z * n_z + q_x * n_x
            mass = 1 / (2 + (across_i * across_i + across_j * across_j) * light)
            drag, springs[now, k, end] = pair_friction(
                between.friction,
                *(overlap, force, springs[now, k, end], v_x * n_z - v_z * n_x, mass, dt),
            )
            f_x, f_z = force * n_x + drag * n_z, force * n_z - drag * n_x
            total[i, 0] += f_x
            total[i, 1] += f_z
            total[i, 2] += (p_z * f_x - p_x * f_z) * light
            total[j, 0] -= f_x
            total[j, 1] -= f_z
            total[j, 2] -= (q_z * f_x - q_x * f_z) * light
    return -1


@kernel
def crowded(between, crowd, rods, listed, scratch, total, dt):
    """Pair forces from a list kept up to date; why the run cannot go on, and where."""
    if between is None:
        return DONE, 0
    half = crowd.alone.half_length
    if strayed(rods, listed.built, half, crowd.skin):
        place, found = scratch
        if build(rods, half, crowd.period, crowd.skin, listed, place, found) < 0:
            return FULL, 0
    deep = pair_forces(crowd, between, rods, listed, total, dt)
    return (DONE, 0) if deep < 0 else (PAIR_TOO_DEEP, deep)


@kernel(inline=False)
def march(crowd, rods, springs, listed, scratch, total, first, steps, dt):
    """`steps` steps of all rods from step number `first`; steps made, why it ended, which rod.

    `rods`, shape (N, 7): x, z, sin and cos of the tilt at a step; c_x, c_z, omega half a step
    before. `springs`, (N, 2): of the plate's contacts. `total`, (N, 3), is scratch.
    """
    scene = crowd.alone
    g = weight(scene.gravity)
    for n in range(steps):
        plate = plate_at(scene.plate, first + n)
        total[:, 0], total[:, 1], total[:, 2] = g
        why, where = crowded(crowd.between, crowd, rods, listed, scratch, total, dt)
        if why != DONE:
            return n, why, where
        for i in range(rods.shape[0]):
            half = (rods[i, C_X], rods[i, C_Z], rods[i, OMEGA])
            direction = (rods[i, SINE], rods[i, COSINE])
            others = (total[i, 0], total[i, 1], total[i, 2])
            lowest = rods[i, Z] - abs(direction[1]) * scene.half_length - 0.5
            if lowest < plate[0]:
                a, lower, upper = accelerations(
                    scene,
                    *(others, plate, rods[i, Z], direction, half, half),
                    *((springs[i, 0], springs[i, 1]), dt),
                )
                springs[i, 0], springs[i, 1] = lower.spring, upper.spring
                if not max(lower.overlap, upper.overlap) <= DEEP:
                    return n, TOO_DEEP, i
            else:
                a = others
                springs[i, 0], springs[i, 1] = 0.0, 0.0
            c_x, c_z, omega = half[0] + dt * a[0], half[1] + dt * a[1], half[2] + dt * a[2]
            if not abs(c_x + c_z + omega) < 1e100:
                return n, NOT_FINITE, i
            rods[i, X] += dt * c_x
            rods[i, Z] += dt * c_z
            rods[i, SINE], rods[i, COSINE] = turned(direction, omega * dt)
            rods[i, C_X], rods[i, C_Z], rods[i, OMEGA] = c_x, c_z, omega
    return steps, DONE, 0
