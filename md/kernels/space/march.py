"""Many rods in space, compiled: samples, Verlet's method.

The state of a rod is its centre, its director, its velocity and the vector w = (angular momentum)/I
about which the director turns. Without rolling w is across the director and is the angular velocity
itself; with it, a free rod is a symmetric top, whose director turns about w all the same, while its
surface also rolls by `rolling` (w . director).

As in the plane (`kernels.plane`), an effect is an argument that may be `None`, and is then compiled
to nothing, and dashpots see velocities that are extrapolated to the step.
"""

from math import acos, atan2, cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from ...cache import kernel
from ..codes import (
    ADVANCE,
    DEEP,
    DIRECTOR,
    DONE,
    FULL_RECORD,
    LEAN_SUM,
    NOT_FINITE,
    PLACE,
    SAMPLED,
    TILT_SUM,
    TOO_DEEP,
    TOO_FAST,
    TURN,
    VELOCITY,
    WALL_TOO_DEEP,
)
from ..contact import free_turn
from ..neighbours import too_fast
from ..plate import Clock, plate_at, plate_before
from ..touches import full
from ..vectors import ZERO, along, cross, dot, put, times, vector
from .pairs import between_rods
from .plate import on_plate
from .touches import recorded_in_space
from .walls import wall_forces


class Series(NamedTuple):
    """What is sampled, a row a period."""

    rows: np.ndarray  # (periods + 1, ANNULUS_SERIES): columns of `codes`
    azimuth: np.ndarray  # (N,), rad, at the last sample
    per: int  # steps of a row
    every: int  # steps between two samples


@kernel
def rotated(v, w, dt):
    """A director after it has turned about w for a time dt, kept at length one."""
    square = dot(w, w) * dt * dt
    one, two = dt, 0.5 * dt * dt
    if square > 1e-4:
        angle = sqrt(square)
        one, two = dt * sin(angle) / angle, dt * dt * (1.0 - cos(angle)) / square
    else:
        one *= 1.0 - square * (1 / 6 - square * (1 / 120))
        two *= 1.0 - square * (1 / 12 - square * (1 / 360))
    first = cross(w, v)
    v = along(along(v, one, first), two, cross(w, first))
    return along(v, 0.5 * (1.0 - dot(v, v)), v)


@kernel
def sample(series, rods, step):
    """Add to the series at a sampling step."""
    if series is None:
        return
    row, part = divmod(step, series.per)
    if part % series.every != 0:
        return
    n, advance, tilt, lean = rods.shape[0], 0.0, 0.0, 0.0
    for i in range(n):
        x, y = rods[i, PLACE], rods[i, PLACE + 1]
        azimuth = atan2(y, x)
        step_on = azimuth - series.azimuth[i]
        advance += step_on - 2.0 * pi * np.round(step_on / (2.0 * pi))
        series.azimuth[i] = azimuth
        a = vector(rods, i, DIRECTOR)
        side = 1.0 if a[2] >= 0.0 else -1.0  # a rod has no head
        along_gap = side * (x * a[1] - y * a[0]) / sqrt(x * x + y * y)
        tilt += acos(min(abs(a[2]), 1.0))
        lean += atan2(along_gap, abs(a[2]))
    rows = series.rows
    rows[row, ADVANCE] += advance / n
    rows[row, TILT_SUM] += tilt / n
    rows[row, LEAN_SUM] += lean / n
    rows[row, SAMPLED] += 1.0


@kernel
def within_walls(effects, state, ledger, climb, dt):
    """Add the forces of both walls; a rod that is too deep, or -1. `climb`: of shaken ones."""
    deep = wall_forces(effects.inner, effects, state, ledger, 1, climb, dt)
    return max(deep, wall_forces(effects.outer, effects, state, ledger, -1, climb, dt))


@kernel
def move(rolling, rods, before, i, dt):
    """Kick and drift of rod i; squares of its velocity and w."""
    director = vector(rods, i, DIRECTOR)
    c = along(vector(rods, i, VELOCITY), dt, vector(before, i, 0))
    w = free_turn(rolling, along(vector(rods, i, TURN), dt, vector(before, i, 3)), director)
    put(rods, i, PLACE, along(vector(rods, i, PLACE), dt, c))
    put(rods, i, DIRECTOR, rotated(director, w, dt))
    put(rods, i, VELOCITY, c)
    put(rods, i, TURN, w)
    return dot(c, c), dot(w, w)


@kernel
def gravity(g):
    """Acceleration along z."""
    return 0.0 if g is None else g


@kernel(inline=False)
def march(effects, state, watchers, clock, steps):
    """Up to `steps` steps of all rods in space; steps made, why it ended, where.

    Parameters
    ----------
    effects : forces.SpaceEffects
    state : forces.State, which is changed
    watchers : plane.Watchers, to which is added
    clock : plate.Clock of the first step
    steps : int
    """
    rods, before, total = state.rods, state.before, state.scratch.total
    g, rolling, dt, ledger = gravity(effects.gravity), effects.rolling, clock.dt, watchers.ledger
    for n in range(steps):
        step = clock.step + n
        if full(watchers.record):
            return n, FULL_RECORD, 0
        plate = plate_at(effects.plate, step)
        for i in range(rods.shape[0]):
            put(total, i, 0, (0.0, 0.0, g))
            put(total, i, 3, ZERO)
        why, where = between_rods(effects.between, effects, state, ledger, dt)
        if why != DONE:
            return n, why, where
        climb = plate_before(effects.plate, step), plate[1]
        where = within_walls(effects, state, ledger, climb, dt)
        if where >= 0:
            return n, WALL_TOO_DEEP, where
        sample(watchers.series, rods, step)
        for i in range(rods.shape[0]):
            pushed = vector(total, i, 0) != (0.0, 0.0, g)
            touch = on_plate(effects.normal, effects, state, ledger, i, plate, dt)
            if not max(touch[0].overlap, touch[1].overlap) <= DEEP:
                return n, TOO_DEEP, i
            recorded_in_space(
                watchers.record, effects, state, i, pushed, touch, plate,
                Clock(step, dt),
            )  # fmt: skip
            gain_c, turned = vector(total, i, 0), times(effects.lightness, vector(total, i, 3))
            gain_w = free_turn(rolling, turned, vector(rods, i, DIRECTOR))
            c, w = vector(rods, i, VELOCITY), vector(rods, i, TURN)
            if not dot(c, c) + dot(w, w) + dot(gain_c, gain_c) + dot(gain_w, gain_w) < 1e200:
                return n, NOT_FINITE, i
            put(before, i, 0, gain_c)
            put(before, i, 3, gain_w)
        fastest, quickest = 0.0, 0.0  # squared
        for i in range(rods.shape[0]):  # none before all are found fit
            travel, turn = move(rolling, rods, before, i, dt)
            fastest, quickest = max(fastest, travel), max(quickest, turn)
        way = (sqrt(fastest) + effects.half_length * sqrt(quickest)) * dt
        if too_fast(effects.between, state.listed, way):
            return n + 1, TOO_FAST, 0
    return steps, DONE, 0
