"""Many rods in a plane, compiled: pair forces, plate forces, Verlet's method.

Two rods touch where an end of one comes close to the axis of the other. Each of the four ends of
a pair is a contact of its own, with its own spring: two parallel rods that lie against each other
touch at two places, and as they turn the force passes from one place to the other without a jump,
which the single closest point of two segments could not do. Each contact force derives from the
distance of its end, so that without dashpots energy is kept. The price is that a place where two
ends meet counts twice, from either rod: twice the stiffness, and cap on cap head on less
restitution than was asked (0.555 for 0.65).

Velocities are kept half a step before the places. The dashpots see them extrapolated to the step by
the last accelerations: with velocities half a step old, the drift of strongly tilted rods would be
off by more than a tenth at 20 steps a contact, and in the first order of the step.

An effect is an argument that may be `None`; each has one function that does nothing then, and that
Numba compiles to nothing. A new effect is one more such function, called in `march`.
"""

from math import atan, sqrt
from typing import NamedTuple

import numpy as np

from ..cache import kernel
from .contact import (
    Effects,
    Friction,
    Normal,
    accelerations,
    plate_at,
    pull,
    push,
    tangential_constants,
    weight,
)
from .neighbours import COSINE, SINE, X, Z, apart, clear, current, meetings, places
from .single import DEEP, DONE, NOT_FINITE, TOO_DEEP, plus, turned
from .touches import landed, watched_landing

C_X, C_Z, OMEGA = 4, 5, 6  # columns of the rods' state after place and direction
COLUMNS = 7
# Why a run ended, beyond `integrators`.
FULL_LIST, PAIR_TOO_DEEP, FULL_RECORD, TOO_FAST = 4, 5, 6, 7
PLATE_WORK, PLATE_NORMAL, PLATE_FRICTION, PAIR_NORMAL, PAIR_FRICTION = range(5)  # of the ledger
MEAN_X, TILTS, SAMPLES, FELL, UPRIGHT = range(5)  # columns of the series


class Between(NamedTuple):
    """Contacts of rods with each other."""

    normal: Normal
    friction: Friction | None


class Crowd(NamedTuple):
    """All that acts on many rods; `None`: absent."""

    alone: Effects  # one rod, plate and gravity; its `normal` is None without a plate
    between: Between | None
    period: float | None  # of the box along x; None: open
    skin: float | None


class Series(NamedTuple):
    """What is sampled, a row a period."""

    rows: np.ndarray  # (periods + 1, 5): mean x at the start, sum of mean tilts, their number,
    # rods that passed the horizontal, rods that passed the vertical
    sides: np.ndarray  # (N, 2): sin and cos of the tilts at the last sample
    per: int  # steps of a row
    every: int  # steps between two samples


@kernel
def beyond(period, image):
    """Distance of an image from its rod."""
    if period is None:
        return 0.0
    return image * period


@kernel
def pair_friction(friction, springs, place, overlap, force, half, now, mass, dt):
    """F_t between two rods from their slip half a step before and now; its spring is kept."""
    if friction is None:
        return 0.0
    k, g = tangential_constants(friction.spring, overlap, mass)
    limit = friction.coefficient * force
    drag, springs[place] = pull(k, g, springs[place], half, now, limit, dt)
    return drag


@kernel
def forgotten(kept, now, k, first, last):
    """What is kept of a contact that has opened."""
    if kept is not None:
        for c in range(first, last):
            kept[now, k, c] = 0.0


@kernel
def pair_accounted(ledger, kept, now, k, end, lost, drag, rate, slip, dt):
    """Add half of this step's losses and half of the last one's, with the velocity between them."""
    if ledger is not None:
        ledger[PAIR_NORMAL] += 0.5 * dt * rate * (lost + kept[now, k, 2 * end])
        ledger[PAIR_FRICTION] -= 0.5 * dt * slip * (drag + kept[now, k, 2 * end + 1])
        kept[now, k, 2 * end], kept[now, k, 2 * end + 1] = lost, drag


@kernel(inline=False)
def pair_forces(crowd, between, rods, before, listed, total, ledger, dt):
    """Add the accelerations by all touching pairs to `total`; number of a pair that is too deep."""
    half, light = crowd.alone.half_length, crowd.alone.lightness
    now, index, springs, kept = listed.turn[0], listed.index, listed.springs, listed.losses
    for k in range(listed.start[now, rods.shape[0]]):
        i, j = index[now, k, 0], index[now, k, 1]
        dx = rods[i, X] - rods[j, X] - beyond(crowd.period, index[now, k, 2])
        dz = rods[i, Z] - rods[j, Z]
        a, b = (rods[i, SINE], rods[i, COSINE]), (rods[j, SINE], rods[j, COSINE])
        if index[now, k, 3] == 0 and clear(dx, dz, a, b, half):
            continue
        index[now, k, 3] = 0
        for end in range(meetings(crowd.alone.upper)):
            s, t = places(dx, dz, a, b, half, end)
            r_x, r_z = apart(dx, dz, a, b, s, t)
            square = r_x * r_x + r_z * r_z
            if square >= 1.0:
                forgotten(springs, now, k, end, end + 1)
                forgotten(kept, now, k, 2 * end, 2 * end + 2)
                continue
            if square < (1 - DEEP) ** 2:
                return k
            index[now, k, 3] = 1
            r = sqrt(square)
            n_x, n_z, overlap = r_x / r, r_z / r, 1.0 - r
            p_x, p_z = s * a[0] - 0.5 * r_x, s * a[1] - 0.5 * r_z  # arms to the contact point
            q_x, q_z = t * b[0] + 0.5 * r_x, t * b[1] + 0.5 * r_z
            v_x = rods[i, C_X] + rods[i, OMEGA] * p_z - rods[j, C_X] - rods[j, OMEGA] * q_z
            v_z = rods[i, C_Z] - rods[i, OMEGA] * p_x - rods[j, C_Z] + rods[j, OMEGA] * q_x
            lever_i, lever_j = p_z * n_x - p_x * n_z, q_z * n_x - q_x * n_z
            mass = 1 / (2 + (lever_i * lever_i + lever_j * lever_j) * light)
            rate, slip = v_x * n_x + v_z * n_z, v_x * n_z - v_z * n_x  # tangent (n_z, -n_x)
            v_x += (before[i, 0] + before[i, 2] * p_z - before[j, 0] - before[j, 2] * q_z) * dt / 2
            v_z += (before[i, 1] - before[i, 2] * p_x - before[j, 1] + before[j, 2] * q_x) * dt / 2
            force = push(between.normal, overlap, v_x * n_x + v_z * n_z, mass, dt)
            slip_now = v_x * n_z - v_z * n_x
            across_i, across_j = p_z * n_z + p_x * n_x, q_z * n_z + q_x * n_x
            mass = 1 / (2 + (across_i * across_i + across_j * across_j) * light)
            drag = pair_friction(
                *(
                    between.friction,
                    springs,
                    (now, k, end),
                    overlap,
                    force,
                    slip,
                    slip_now,
                    mass,
                    dt,
                )
            )
            lost = between.normal.stiffness * overlap * sqrt(overlap) - force
            pair_accounted(ledger, kept, now, k, end, lost, drag, rate, slip, dt)
            f_x, f_z = force * n_x + drag * n_z, force * n_z - drag * n_x
            total[i, 0] += f_x
            total[i, 1] += f_z
            total[i, 2] += (p_z * f_x - p_x * f_z) * light
            total[j, 0] -= f_x
            total[j, 1] -= f_z
            total[j, 2] -= (q_z * f_x - q_x * f_z) * light
    return -1


@kernel
def crowded(between, crowd, rods, before, listed, scratch, total, ledger, dt):
    """Pair forces from a list kept up to date; why the run cannot go on, and where."""
    if between is None:
        return DONE, 0
    half = crowd.alone.half_length
    place, found = scratch
    if not current(rods, half, crowd.period, crowd.skin, listed, place, found):
        return FULL_LIST, 0
    deep = pair_forces(crowd, between, rods, before, listed, total, ledger, dt)
    return (DONE, 0) if deep < 0 else (PAIR_TOO_DEEP, deep)


@kernel
def travelled(between, listed, distance):
    """Note how far a rod may have moved."""
    if between is not None:
        listed.travelled[0] += distance


@kernel
def fast(between, distance):
    """Whether a rod moved so far in a step that it may have passed through another one unseen.

    An end is stopped within DEEP on either side of an axis; two rods that move half of DEEP each
    do not leap over that.
    """
    if between is None:
        return False
    return distance > 0.5 * DEEP


@kernel
def plate_accounted(ledger, effects, touch, plate, velocity, dt):
    """Plate work and losses at one cap, with the velocity of the moment of its force."""
    if ledger is not None and touch.overlap > 0:
        opens = velocity[1] - velocity[2] * touch.a_x - plate[1]
        spring = effects.normal.stiffness * touch.overlap * sqrt(touch.overlap)
        slip = velocity[0] + velocity[2] * touch.a_z
        ledger[PLATE_WORK] += touch.normal * plate[1] * dt
        ledger[PLATE_NORMAL] += (spring - touch.normal) * opens * dt
        ledger[PLATE_FRICTION] -= touch.tangential * slip * dt


@kernel
def kept_springs(springs, i):
    """Springs of the plate's contacts of rod i."""
    if springs is None:
        return 0.0, 0.0
    return springs[i, 0], springs[i, 1]


@kernel
def keep_springs(springs, i, lower, upper):
    """Keep them for the next step."""
    if springs is not None:
        springs[i, 0], springs[i, 1] = lower, upper


@kernel
def on_plate(normal, effects, rods, before, i, others, springs, plate, ledger, record, step, dt):
    """Accelerations of rod i with those by the plate; whether it is too deep."""
    if normal is None:
        return others, False
    direction = (rods[i, SINE], rods[i, COSINE])
    if rods[i, Z] - abs(direction[1]) * effects.half_length - 0.5 >= plate[0]:
        keep_springs(springs, i, 0.0, 0.0)
        landed(record, effects, rods, i, plate, step)
        return others, False
    half = (rods[i, C_X], rods[i, C_Z], rods[i, OMEGA])
    now = plus(half, (before[i, 0], before[i, 1], before[i, 2]), dt / 2)
    a, lower, upper = accelerations(
        effects, others, plate, rods[i, Z], direction, half, now, kept_springs(springs, i), dt
    )
    keep_springs(springs, i, lower.spring, upper.spring)
    now = plus(half, a, dt / 2)
    plate_accounted(ledger, effects, lower, plate, now, dt)
    plate_accounted(ledger, effects, upper, plate, now, dt)
    watched_landing(record, effects, rods, i, others, lower, upper, plate, step, dt)
    return a, not max(lower.overlap, upper.overlap) <= DEEP


@kernel
def sampled(series, rods, step):
    """Add to the series at a sampling step."""
    if series is None:
        return
    row, part = divmod(step, series.per)
    if part % series.every != 0:
        return
    n, x, tilt, rows, sides = rods.shape[0], 0.0, 0.0, series.rows, series.sides
    for i in range(n):
        sine, cosine = rods[i, SINE], rods[i, COSINE]
        x += rods[i, X]
        tilt += atan(sine / cosine) if cosine != 0.0 else np.pi / 2  # a rod has no head
        if cosine * sides[i, 1] < 0:
            rows[row, FELL] += 1
        elif sine * sides[i, 0] < 0:
            rows[row, UPRIGHT] += 1
        sides[i, 0], sides[i, 1] = sine, cosine
    if part == 0:
        rows[row, MEAN_X] = x / n
    rows[row, TILTS] += tilt / n
    rows[row, SAMPLES] += 1


@kernel
def full(record):
    """Whether the record might not hold another step."""
    if record is None:
        return False
    return record.count[0] + record.open.shape[0] > record.rows.shape[0]


@kernel(inline=False)
def march(
    crowd, rods, before, springs, listed, scratch, total, ledger, record, series, first, steps, dt
):
    """`steps` steps of all rods from step number `first`; steps made, why it ended, where.

    Parameters
    ----------
    crowd : Crowd
    rods : (N, 7): x, z, sin and cos of the tilt at a step; c_x, c_z, omega half a step before
    before : (N, 3): accelerations of the step before
    springs : (N, 2) of the plate's contacts, or None
    listed, scratch : the list of pairs, and arrays for its making, or None
    total : (N, 3), scratch
    ledger : (5,) to add to, or None
    record : `landings.Record`, or None
    series : Series, or None
    """
    effects = crowd.alone
    g = weight(effects.gravity)
    for n in range(steps):
        if full(record):
            return n, FULL_RECORD, 0
        plate = plate_at(effects.plate, first + n)
        for i in range(rods.shape[0]):
            total[i, 0], total[i, 1], total[i, 2] = g
        why, where = crowded(crowd.between, crowd, rods, before, listed, scratch, total, ledger, dt)
        if why != DONE:
            return n, why, where
        sampled(series, rods, first + n)
        fastest = 0.0
        for i in range(rods.shape[0]):
            others = (total[i, 0], total[i, 1], total[i, 2])
            a, deep = on_plate(
                *(effects.normal, effects, rods, before, i, others, springs, plate),
                *(ledger, record, first + n, dt),
            )
            if deep:
                return n, TOO_DEEP, i
            c_x = rods[i, C_X] + dt * a[0]
            c_z = rods[i, C_Z] + dt * a[1]
            omega = rods[i, OMEGA] + dt * a[2]
            speed = abs(c_x) + abs(c_z) + effects.half_length * abs(omega)
            if not speed < 1e100:
                return n, NOT_FINITE, i
            fastest = max(fastest, speed)
            rods[i, X] += dt * c_x
            rods[i, Z] += dt * c_z
            rods[i, SINE], rods[i, COSINE] = turned((rods[i, SINE], rods[i, COSINE]), omega * dt)
            rods[i, C_X], rods[i, C_Z], rods[i, OMEGA] = c_x, c_z, omega
            before[i, 0], before[i, 1], before[i, 2] = a
        travelled(crowd.between, listed, fastest * dt)
        if fast(crowd.between, fastest * dt):
            return n + 1, TOO_FAST, 0
    return steps, DONE, 0
