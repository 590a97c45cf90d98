"""Many rods, compiled: the steps of a row in a plane and of an annulus in space, and their samples.

Verlet's method: velocities are kept half a step before the places. A contact sees them at the step:
with its own force of that step, and all else as of the step before (`contact`). With velocities
half a step old, the drift of strongly tilted rods would be off by more than a tenth at 20 steps a
contact. All forces but dashpots and friction derive from `energy`, which weights contacts as they
do: where two ends meet, and between two ends (`pairs`, `surfaces`).

An effect is an argument that may be `None`; each has one function, which then does nothing and
which Numba compiles to nothing. The guide to a new effect is in `md.kernels`.
"""

from math import acos, atan2, pi, sqrt
from typing import NamedTuple

import numpy as np

from ..cache import kernel
from . import (
    ADVANCE,
    DEEP,
    DONE,
    FELL,
    FULL_RECORD,
    MEAN_X,
    NOT_FINITE,
    PLATE_FRICTION,
    PLATE_NORMAL,
    PLATE_WORK,
    SAMPLED,
    TILT_COSINE,
    TILT_SINE,
    TILT_SUM,
    TOO_DEEP,
    TOO_FAST,
    WALL_TOO_DEEP,
)
from .contact import elastic_energy, free_turn, size, turn_by, turning
from .neighbours import Axes, between_ends, near_at, near_end, too_fast
from .pairs import ends_of, nearer, pair_forces, seen_through
from .state import (
    Clock,
    field,
    forces_at,
    forget,
    gravity_force,
    keep,
    kept_of,
    rod_of,
)
from .surfaces import (
    beside,
    from_above,
    from_axis,
    passes,
    plate_at,
    plate_forces,
    wall_forces,
)
from .touches import Record, cleared, full, recorded
from .vectors import IN_PLANE, IN_SPACE, along, dot, height, nothing, put, rotated


class Series(NamedTuple):
    """Samples of a run, one row per period."""

    rows: np.ndarray  # (periods + 1, ROW_SERIES or ANNULUS_SERIES): columns of `md.kernels`
    last: np.ndarray  # (rods,): at the last sample, cos of the tilt; of an annulus azimuth, rad
    per: int  # steps of a period
    every: int  # steps from one sample to the next


class Watchers(NamedTuple):
    """Diagnostics of a run, which act on nothing; `None`: absent."""

    ledger: np.ndarray | None  # (5,), in space 7, m g d: sums so far, columns of `md.kernels`
    record: Record | None
    series: Series | None


# Samples
@kernel(inline=False)
def sample_row(series, rods, row, start):
    """Add a sample of a row to its series; `start`: whether it is the first of a period."""
    n, x, rows = rods.shape[0], 0.0, series.rows
    for i in range(n):
        sine, cosine = rod_of(IN_PLANE, rods, i).director
        x += rods[i, 0]
        rows[row, TILT_SINE] += 2.0 * sine * cosine
        rows[row, TILT_COSINE] += cosine * cosine - sine * sine
        if cosine * series.last[i] < 0:
            rows[row, FELL] += 1
        series.last[i] = cosine
    if start:
        rows[row, MEAN_X] = x / n


@kernel(inline=False)
def sample_annulus(series, rods, row):
    """Add a sample of an annulus to its series."""
    n, advance, tilt, rows = rods.shape[0], 0.0, 0.0, series.rows
    for i in range(n):
        place, director = rod_of(IN_SPACE, rods, i)[:2]
        azimuth = atan2(place[1], place[0])
        step_on = azimuth - series.last[i]
        advance += step_on - 2.0 * pi * np.floor(step_on / (2.0 * pi) + 0.5)
        series.last[i] = azimuth
        tilt += acos(min(abs(director[2]), 1.0))  # a rod has no head
    rows[row, ADVANCE] += advance / n
    rows[row, TILT_SUM] += tilt / n
    rows[row, SAMPLED] += 1


@kernel
def sample(series, up, rods, step):
    """Add a sample to the series, if there is one and this is a sampling step."""
    if series is None:
        return
    row, part = divmod(step, series.per)
    if part % series.every == 0:
        if len(up) == 2:
            sample_row(series, rods, row, part == 0)
        else:
            sample_annulus(series, rods, row)


# The plate


@kernel
def accounted(ledger, touch, plate, dt):
    """Add work of the plate and losses at one cap to the ledger, if there is one."""
    if ledger is not None:
        ledger[PLATE_WORK] += touch.kept.force * plate[1] * dt
        ledger[PLATE_NORMAL] += touch.lost[0]
        ledger[PLATE_FRICTION] += touch.lost[1]


@kernel
def on_plate(normal, effects, state, watchers, i, plate, clock):
    """Add force and torque of the plate on rod i; return whether it is too deep in the plate."""
    if normal is None:
        return False
    up, rods, total = effects.up, state.rods, state.scratch.total
    memory, rod, n = state.memory, rod_of(up, rods, i), rods.shape[0]
    lowest = height(rod.place) - abs(height(rod.director)) * effects.half_length - 0.5
    if lowest >= plate[0]:
        for cap in range(2):
            forget(up, memory, cap * n + i)
        cleared(watchers.record, effects, rods, i, plate, clock.step)
        return False
    others = forces_at(up, total, i)
    kept = kept_of(up, memory, i), kept_of(up, memory, n + i)
    (force, torque), caps = plate_forces(effects, rod, kept, plate, others, clock.dt)
    put(total, i, 0, (*force, *torque))
    for cap in range(2):
        keep(memory, cap * n + i, caps[cap].kept)
        accounted(watchers.ledger, caps[cap], plate, clock.dt)
    pushed = others[0] != field(effects, rod.velocity)
    recorded(watchers.record, effects, rods, i, pushed, caps, plate, clock)
    return not max(caps[0].overlap, caps[1].overlap) <= DEEP


# The step


@kernel
def kicked(effects, rods, before, i, dt):
    """Velocity and turn of rod i half a step on; `before`: accelerations of this step."""
    rod, (gain, bend) = rod_of(effects.up, rods, i), forces_at(effects.up, before, i)
    w = along(rod.turn, dt, bend)
    return along(rod.velocity, dt, gain), free_turn(effects.inertia.rolling, w, rod.director)


@kernel
def fastest_rod(effects, rods, before, speed, dt):
    """Upper bound of the speeds of all points after the step; a rod of no finite speed, or -1."""
    for i in range(rods.shape[0]):
        c, w = kicked(effects, rods, before, i, dt)
        speed[i] = size(c) + effects.half_length * size(w)
    fastest = 0.0
    for i in range(rods.shape[0]):
        if not speed[i] < 1e100:
            return fastest, i
        fastest = max(fastest, speed[i])
    return fastest, -1


@kernel(entry=True)
def march(effects, state, watchers, clock, steps):
    """Make up to `steps` steps of all rods; return the steps made, the stop code, and the place.

    Parameters
    ----------
    effects : Effects
    state : State, which is changed
    watchers : Watchers, whose arrays are added to
    clock : Clock of the first step
    steps : int

    The place is the number of a rod, or of an entry of the list of pairs.
    """
    rods, before, total, ledger = state.rods, state.before, state.scratch.total, watchers.ledger
    up, inertia, dt = effects.up, effects.inertia, clock.dt
    for n in range(steps):
        now = Clock(clock.step + n, dt)
        if full(watchers.record):
            return n, FULL_RECORD, 0
        plate = plate_at(effects.plate, now.step)
        for i in range(rods.shape[0]):
            rod = rod_of(up, rods, i)
            put(total, i, 0, (*field(effects, rod.velocity), *nothing(rod.turn)))
        why, where = pair_forces(effects.between, effects, state, ledger, dt)
        if why != DONE:
            return n, why, where
        climb = 0.5 * (plate_at(effects.plate, now.step - 1)[1] + plate[1]), plate[1]
        where = wall_forces(effects.walls, effects, state, ledger, climb, dt)
        if where >= 0:
            return n, WALL_TOO_DEEP, where
        sample(watchers.series, up, rods, now.step)
        for i in range(rods.shape[0]):
            if on_plate(effects.normal, effects, state, watchers, i, plate, now):
                return n, TOO_DEEP, i
        for i in range(rods.shape[0]):
            force, torque = forces_at(up, total, i)
            put(before, i, 0, (*force, *turn_by(inertia, torque, rod_of(up, rods, i).director)))
        fastest, unfit = fastest_rod(effects, rods, before, state.scratch.speed, dt)
        if unfit >= 0:
            return n, NOT_FINITE, unfit
        for i in range(rods.shape[0]):  # no rod moves unless all have finite speeds
            rod, (c, w) = rod_of(up, rods, i), kicked(effects, rods, before, i, dt)
            put(rods, i, 0, (*along(rod.place, dt, c), *rotated(rod.director, w, dt), *c, *w))
        if too_fast(effects.between, state.listed, fastest * dt):
            return n + 1, TOO_FAST, 0
    return steps, DONE, 0


@kernel
def of_plate(law, upper, half, place, director, plate):
    """Elastic energy of the caps of a rod in the plate; `plate`: its height, d."""
    total = 0.0
    if law is None:
        return total
    for cap in range(1 if upper is None else 2):
        end = half if cap else -half
        total += elastic_energy(law, plate + 0.5 - height(place) - end * height(director))
    return total


@kernel
def of_wall(radius, law, upper, half, place, director, side):
    """Elastic energy of a rod in a wall; `side`: 1 the convex wall, -1 the concave one."""
    total = 0.0
    for cap in range(1 if upper is None else 2):
        rho, _ = from_axis(along(place, half if cap else -half, director))
        total += elastic_energy(law, 0.5 - side * (rho - radius))
    seen = from_above(place, director)
    if side > 0 and passes(seen, half, radius + 0.5):
        at, _, _ = beside(radius, place, director, half, -seen[1] / seen[2])
        total += at.share * elastic_energy(law, 0.5 - at.reach)
    return total


@kernel
def of_walls(walls, upper, half, place, director):
    """Elastic energy of a rod in the walls of an annulus."""
    if walls is None:
        return 0.0
    total = of_wall(walls.inner, walls.normal, upper, half, place, director, 1)
    return total + of_wall(walls.outer, walls.normal, upper, half, place, director, -1)


@kernel
def of_crossing(law, half, axes):
    """Elastic energy of two rods that touch between their ends, in space."""
    if len(axes.a) == 2:
        return 0.0
    near, inside, _ = between_ends(axes, half)
    if not inside:
        return 0.0
    distance, share = sqrt(near.square), 1.0
    for end in range(4):
        share *= nearer(near_end(axes, half, end), distance)[0]
    return share * elastic_energy(law, 1.0 - distance)


@kernel
def of_pair(law, upper, half, axes):
    """Elastic energy of all contacts of two rods."""
    total = 0.0
    for end in range(ends_of(upper)):
        total += elastic_energy(law, 1.0 - sqrt(near_end(axes, half, end).square))
    if upper is None:
        return total
    for end in range(2):
        near = near_end(axes, half, end)
        ends = near_at(axes, near.s, half if near.t > 0.0 else -half)
        total -= elastic_energy(law, 1.0 - sqrt(ends.square))
    return total + of_crossing(law, half, axes)


@kernel
def of_pairs(between, effects, rods, listed, dt):
    """Elastic energy of all listed pairs half a step ago."""
    total = 0.0
    if between is None:
        return total
    now = listed.turn[0]
    for k in range(now, 2 * listed.start[now, rods.shape[0]], 2):
        i, j, image = listed.index[k, 0], listed.index[k, 1], listed.index[k, 2]
        place, a = earlier(effects.up, rods, i, dt)
        other, b = earlier(effects.up, rods, j, dt)
        apart = seen_through(effects.period, along(place, -1.0, other), image)
        axes = Axes(apart, a, b)
        total += of_pair(between.normal, effects.upper, effects.half_length, axes)
    return total


@kernel
def earlier(up, rods, i, dt):
    """Centre and director of rod i half a step ago."""
    rod, back = rod_of(up, rods, i), -dt / 2
    return along(rod.place, back, rod.velocity), rotated(rod.director, rod.turn, back)


@kernel(entry=True)
def energy(effects, rods, listed, plate, dt):
    """Kinetic, potential and elastic energy half a step ago, m g d; `plate`: its height then, d."""
    half, upper, up = effects.half_length, effects.upper, effects.up
    total = of_pairs(effects.between, effects, rods, listed, dt)
    for i in range(rods.shape[0]):
        place, director = earlier(up, rods, i, dt)
        rod = rod_of(up, rods, i)
        c, w = rod.velocity, rod.turn
        spin = turning(effects.inertia.rolling, w, director)
        total += 0.5 * (dot(c, c) + dot(spin, w) / effects.inertia.lightness)
        total -= dot(gravity_force(effects.gravity, place), place)
        total += of_plate(effects.normal, upper, half, place, director, plate)
        total += of_walls(effects.walls, upper, half, place, director)
    return total
