"""Many rods in a plane, compiled: pair forces, plate forces, Verlet's method.

Two rods touch where an end of one comes close to the axis of the other. Each of the four ends of
a pair is a contact of its own, with its own spring: two parallel rods that lie against each other
touch at two places, and as they turn the force passes from one place to the other without a jump,
which the single closest point of two segments could not do. Where two ends meet, their contacts are
one place and count once (`joints`). All forces derive from distances of ends, so that without
dashpots energy is kept.

Velocities are kept half a step before the places. A contact sees them at the step: with its own
force of that step, and all else as of the step before (`contact`). With velocities half a step old,
the drift of strongly tilted rods would be off by more than a tenth at 20 steps a contact.

An effect is an argument that may be `None`; each has one function that does nothing then, and that
Numba compiles to nothing. The guide to a new effect is in `md.kernels`.
"""

from math import atan, sqrt
from typing import Any, NamedTuple

import numpy as np

from ..cache import kernel
from .batch import MOST, Batch, acted, collect
from .codes import (
    C_X,
    COSINE,
    DEEP,
    DONE,
    FELL,
    FULL_LIST,
    FULL_RECORD,
    MEAN_X,
    NOT_FINITE,
    PAIR_TOO_DEEP,
    PLATE_FRICTION,
    PLATE_NORMAL,
    PLATE_WORK,
    SAMPLED,
    SINE,
    TILT_SUM,
    TOO_DEEP,
    TOO_FAST,
    UPRIGHT,
    X,
    Z,
)
from .contact import ContactForces, Effects, term
from .joints import joint
from .neighbours import (
    PAIR,
    Listed,
    apart,
    clearance,
    current,
    gap,
    meetings,
    open_at_least,
    places,
    too_fast,
)
from .plate import FORGOTTEN, Clock, Kept, Moving, field, keeps, plate_at, plate_forces
from .single import turned
from .touches import Record, cleared, full, recorded
from .vectors import ZERO, add, along, put, vector


class RowEffects(NamedTuple):
    """All that acts on the rods of a row; `None`: absent."""

    alone: Effects  # on one rod: plate and gravity; its `normal` is None without a plate
    between: ContactForces | None
    period: float | None  # d; of the box along x; None: open


class Scratch(NamedTuple):
    """Arrays that hold nothing from one step to the next."""

    total: np.ndarray  # (rods, 3): accelerations of a step, in g and g/d
    speed: np.ndarray  # (rods,)
    place: np.ndarray | None  # (rods,): for a list of pairs
    found: np.ndarray | None  # (capacity, 3): the same
    batch: Batch | None  # contacts of rods with each other


class State(NamedTuple):
    """Rods of a row under way; `None` for what they do without."""

    rods: np.ndarray  # (rods, 7): columns X to OMEGA of `codes`, in d, sqrt(g d), sqrt(g/d)
    before: np.ndarray  # (rods, 3): accelerations of the step before, in g and g/d
    forces: (
        np.ndarray | None
    )  # (rods, 4), m g: F_t and F_n of the plate, cap by cap; no friction: None
    springs: np.ndarray | None  # (rods, 2), d: of the plate's contacts
    listed: Listed | None
    scratch: Scratch


class Series(NamedTuple):
    """What is sampled, a row a period."""

    rows: np.ndarray  # (periods + 1, ROW_SERIES): columns of `codes`
    sides: np.ndarray  # (rods, 2): sin and cos of the tilts at the last sample
    per: int  # steps of a row
    every: int  # steps between two samples


class Watchers(NamedTuple):
    """What looks on and acts on nothing; `None`: absent."""

    ledger: np.ndarray | None  # (5,), m g d: to add to, columns of `codes`
    record: Record | None
    series: Any | None  # `Series`, or `space.march.Series` in an annulus


@kernel
def one_spring(springs, pair, end, other, first, second):
    """Keep one spring at the contacts of two ends where one has no foot of its own."""
    if springs is None or (first > 0.0 and second > 0.0):
        return
    now, k = pair
    length = springs[now, k, end]
    if first == 0.0:
        length = springs[now, k, other]
        if second == 0.0:
            length = 0.5 * (length + springs[now, k, end])
    springs[now, k, end] = springs[now, k, other] = length


@kernel
def repel(total, light, pair, s, t, force):
    """Add a force that drives a place on one axis and a place on the other apart."""
    i, j, dx, dz, a, b = pair
    r_x, r_z = apart(dx, dz, a, b, s, t)
    force /= sqrt(r_x * r_x + r_z * r_z)
    f_x, f_z = force * r_x, force * r_z
    add(total, i, 0, (f_x, f_z, s * (a[1] * f_x - a[0] * f_z) * light))
    add(total, j, 0, (-f_x, -f_z, t * (b[0] * f_z - b[1] * f_x) * light))


@kernel
def forgotten(kept, now, k, first, last):
    """Clear what is kept of a contact that has opened."""
    if kept is not None:
        for c in range(first, last):
            kept[now, k, c] = 0.0


@kernel
def joined(effects, stiffness, state, k, pair, end):
    """Shares of two ends that meet in their place; adds the forces that keep energy.

    `pair`: both rods, from the second's centre to the first's, both directions; `end`: of the first
    rod. Third, which end of the second rod.
    """
    _, _, dx, dz, a, b = pair
    half, light, total = effects.half_length, effects.lightness, state.scratch.total
    s, foot = places(dx, dz, a, b, half, end)
    other = 3 if foot > 0 else 2
    back, t = places(dx, dz, a, b, half, other)
    first, second = abs(t - foot), abs(s - back)
    r_x, r_z = apart(dx, dz, a, b, s, t)
    met = joint(r_x * r_x + r_z * r_z, first, second)
    one_spring(state.listed.springs, (state.listed.turn[0], k), end, other, first, second)
    if first > 0.0 and second > 0.0:
        force = stiffness * met.force
        repel(total, light, pair, s, foot, met.part * force)
        repel(total, light, pair, back, t, (1.0 - met.part) * force)
        repel(total, light, pair, s, t, -force)
    return met.first, met.second, other


@kernel
def meets(upper, end, near, half):
    """Whether an end of the first rod, near its foot on the second, touches the second's end."""
    if upper is None:
        return False
    beyond = half - abs(near[1])
    return end < 2 and near[4] + beyond * beyond < 1.0


@kernel
def opened(listed, now, k, end):
    """Clear what is kept of a contact that is open."""
    forgotten(listed.springs, now, k, end, end + 1)
    forgotten(listed.forces, now, k, 2 * end, 2 * end + 2)


@kernel(inline=False)
def joined_ends(effects, state, ledger, k, pair, first, dt):
    """Add the accelerations by the ends from the `first` on, which meets another one.

    Whether one is too deep.
    """
    alone, listed, now = effects.alone, state.listed, state.listed.turn[0]
    half, stiffness = alone.half_length, effects.between.normal.stiffness
    _, _, dx, dz, a, b = pair
    lower = upper = 1.0  # shares left to the ends of the second rod
    for end in range(first, 4):
        near = gap(dx, dz, a, b, half, end)
        if near[4] >= 1.0:
            opened(listed, now, k, end)
            continue
        if near[4] < (1 - DEEP) ** 2:
            return True
        share = (1.0, 1.0, lower, upper)[end]
        if meets(alone.upper, end, near, half):
            share, left, other = joined(alone, stiffness, state, k, pair, end)
            if other == 2:
                lower += left - 1.0
            else:
                upper += left - 1.0
        collect(state, 0, pair, now, k, end, near, share)
        acted(effects, state, ledger, 1, dt)
    return False


@kernel
def pair_forces(effects, state, ledger, dt):
    """Add the accelerations by all touching pairs; number of a pair that is too deep, or -1."""
    alone, rods, listed = effects.alone, state.rods, state.listed
    half, now, index, asleep = alone.half_length, listed.turn[0], listed.index, listed.asleep
    travelled, n = listed.travelled[0], 0
    for k in range(listed.start[now, rods.shape[0]]):
        if travelled < asleep[k, PAIR]:
            continue
        i, j = np.uint64(index[now, k, 0]), np.uint64(index[now, k, 1])  # never negative
        dx = rods[i, X] - rods[j, X] - term(effects.period, index[now, k, 2])
        dz = rods[i, Z] - rods[j, Z]
        a, b = (rods[i, SINE], rods[i, COSINE]), (rods[j, SINE], rods[j, COSINE])
        if index[now, k, 3] == 0:
            open_by = clearance(dx, dz, a, b, half)
            if open_by >= 0.0:
                asleep[k, PAIR] = travelled + 0.5 * open_by
                continue
        index[now, k, 3], pair = 0, (i, j, dx, dz, a, b)
        if n > MOST:
            acted(effects, state, ledger, n, dt)
            n = 0
        for end in range(meetings(alone.upper)):
            if travelled < asleep[k, end]:
                continue
            near = gap(dx, dz, a, b, half, end)
            if near[4] >= 1.0:
                opened(listed, now, k, end)
                asleep[k, end] = travelled + 0.5 * open_at_least(near[4])
                continue
            if near[4] < (1 - DEEP) ** 2:
                return k
            index[now, k, 3] = 1
            if meets(alone.upper, end, near, half):
                acted(effects, state, ledger, n, dt)
                n = 0
                if joined_ends(effects, state, ledger, k, pair, end, dt):
                    return k
                break
            collect(state, n, pair, now, k, end, near, 1.0)
            n += 1
    acted(effects, state, ledger, n, dt)
    return -1


@kernel
def between_rods(between, effects, state, ledger, dt):
    """Pair forces from a list kept up to date; why the run cannot go on, and where."""
    if between is None:
        return DONE, 0
    half, scratch = effects.alone.half_length, state.scratch
    if not current(state.rods, half, effects.period, state.listed, scratch.place, scratch.found):
        return FULL_LIST, 0
    deep = pair_forces(effects, state, ledger, dt)
    return (DONE, 0) if deep < 0 else (PAIR_TOO_DEEP, deep)


@kernel
def plate_accounted(ledger, touch, plate, dt):
    """Plate work and losses at one cap."""
    if ledger is not None:
        ledger[PLATE_WORK] += touch.force[1] * plate[1] * dt
        ledger[PLATE_NORMAL] += touch.lost[0]
        ledger[PLATE_FRICTION] += touch.lost[1]


@kernel
def kept_of(forces, springs, i, cap):
    """What a cap of rod i keeps."""
    if forces is None:
        return FORGOTTEN
    return Kept((forces[i, 2 * cap], forces[i, 2 * cap + 1]), (kept_spring(springs, i, cap),))


@kernel
def kept_spring(springs, i, cap):
    """Length of the spring of a cap."""
    return 0.0 if springs is None else springs[i, cap]


@kernel
def keep_of(forces, springs, i, cap, kept):
    """Keep it for the next step."""
    if forces is not None:
        forces[i, 2 * cap], forces[i, 2 * cap + 1] = kept.force
    if springs is not None:
        springs[i, cap] = kept.spring[0]


@kernel
def on_plate(normal, effects, state, watchers, i, others, plate, clock):
    """Accelerations of rod i with those by the plate; whether it is too deep."""
    if normal is None:
        return others, False
    rods, ledger, record = state.rods, watchers.ledger, watchers.record
    direction = (rods[i, SINE], rods[i, COSINE])
    if rods[i, Z] - abs(direction[1]) * effects.half_length - 0.5 >= plate[0]:
        keep_of(state.forces, state.springs, i, 0, FORGOTTEN)
        keep_of(state.forces, state.springs, i, 1, FORGOTTEN)
        cleared(record, effects, rods, i, plate, clock.step)
        return others, False
    forces, springs = state.forces, state.springs
    kept = kept_of(forces, springs, i, 0), kept_of(forces, springs, i, 1)
    rod = Moving(rods[i, Z], direction, vector(rods, i, C_X), kept, None, ZERO)
    a, lower, upper = plate_forces(effects, rod, plate, others, clock.dt)
    keep_of(forces, springs, i, 0, keeps(lower))
    keep_of(forces, springs, i, 1, keeps(upper))
    plate_accounted(ledger, lower, plate, clock.dt)
    plate_accounted(ledger, upper, plate, clock.dt)
    recorded(record, effects, rods, i, others, (lower, upper), plate, clock)
    return a, not max(lower.overlap, upper.overlap) <= DEEP


@kernel
def sample(series, rods, step):
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
    rows[row, TILT_SUM] += tilt / n
    rows[row, SAMPLED] += 1


@kernel
def fastest_rod(rods, total, speed, half_length, dt):
    """Upper bound of all speeds after the step, and a rod that has none, or -1."""
    for i in range(rods.shape[0]):
        c_x, c_z, omega = along(vector(rods, i, C_X), dt, vector(total, i, 0))
        speed[i] = abs(c_x) + abs(c_z) + half_length * abs(omega)
    fastest = 0.0
    for i in range(rods.shape[0]):
        if not speed[i] < 1e100:
            return fastest, i
        fastest = max(fastest, speed[i])
    return fastest, -1


@kernel
def move(rods, before, total, i, dt):
    """Kick and drift of rod i."""
    a = vector(total, i, 0)
    c_x, c_z, omega = along(vector(rods, i, C_X), dt, a)
    rods[i, X] += dt * c_x
    rods[i, Z] += dt * c_z
    rods[i, SINE], rods[i, COSINE] = turned((rods[i, SINE], rods[i, COSINE]), omega * dt)
    put(rods, i, C_X, (c_x, c_z, omega))
    put(before, i, 0, a)


@kernel(inline=False)
def march(effects, state, watchers, clock, steps):
    """Up to `steps` steps of all rods of a row; steps made, why it ended, where.

    Parameters
    ----------
    effects : RowEffects
    state : State, which is changed
    watchers : Watchers, to which is added
    clock : Clock of the first step
    steps : int
    """
    alone, rods, before, total = effects.alone, state.rods, state.before, state.scratch.total
    dt = clock.dt
    for n in range(steps):
        now = Clock(clock.step + n, dt)
        if full(watchers.record):
            return n, FULL_RECORD, 0
        plate = plate_at(alone.plate, now.step)
        for i in range(rods.shape[0]):
            put(total, i, 0, field(alone, vector(rods, i, C_X)))
        why, where = between_rods(effects.between, effects, state, watchers.ledger, dt)
        if why != DONE:
            return n, why, where
        sample(watchers.series, rods, now.step)
        for i in range(rods.shape[0]):
            others = vector(total, i, 0)
            a, deep = on_plate(alone.normal, alone, state, watchers, i, others, plate, now)
            if deep:
                return n, TOO_DEEP, i
            put(total, i, 0, a)
        fastest, unfit = fastest_rod(rods, total, state.scratch.speed, alone.half_length, dt)
        if unfit >= 0:
            return n, NOT_FINITE, unfit
        for i in range(rods.shape[0]):
            move(rods, before, total, i, dt)
        if too_fast(effects.between, state.listed, fastest * dt):
            return n + 1, TOO_FAST, 0
    return steps, DONE, 0
