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
    APPROACH_SUM,
    DEEP,
    DIRECTOR,
    DONE,
    LEAN_SUM,
    NOT_FINITE,
    PLACE,
    PLATE_SUM,
    PUSHING,
    SAMPLED,
    TILT_SUM,
    TOO_DEEP,
    TOO_FAST,
    TOUCHES,
    TURN,
    VELOCITY,
    WALL_TOO_DEEP,
)
from ..contact import ZERO, along, plate_at, put, vector
from ..neighbours import too_fast
from .forces import at_caps, at_inner, on_plate, turning
from .geometry import UP, cross, dot, from_above
from .pairs import between_rods


class Series(NamedTuple):
    """What is sampled, a row a period, and the touches of the plate."""

    rows: np.ndarray  # (periods + 1, ANNULUS_SERIES): columns of `codes`
    azimuth: np.ndarray  # (N,), rad, at the last sample
    resting: np.ndarray  # (N,): whether the plate pushed in the last step
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
def across(rolling, w, director):
    """Without rolling w stays across the director."""
    if rolling is None:
        return along(w, -dot(w, director), director)
    return w


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
def count_touch(series, effects, rods, i, deepest, plate, step):
    """Count a new touch of the plate."""
    if series is None:
        return
    if deepest > 0.0 and series.resting[i] == 0:
        director = vector(rods, i, DIRECTOR)
        s = -effects.half_length if director[2] > 0.0 else effects.half_length
        arm = along(along(ZERO, s, director), -0.5, UP)
        swing = cross(turning(effects.rolling, vector(rods, i, TURN), director), arm)
        approach = plate[1] - rods[i, VELOCITY + 2] - swing[2]
        row, rows = step // series.per, series.rows
        rows[row, TOUCHES] += 1.0
        rows[row, PLATE_SUM] += plate[1]
        rows[row, PUSHING] += approach * plate[1]
        rows[row, APPROACH_SUM] += approach
    series.resting[i] = deepest > 0.0


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
    watchers : plane.Watchers, of which the series is added to
    clock : contact.Clock of the first step
    steps : int
    """
    rods, before, total = state.rods, state.before, state.scratch
    g, rolling, dt = gravity(effects.gravity), effects.rolling, clock.dt
    for n in range(steps):
        step = clock.step + n
        plate = plate_at(effects.plate, step)
        for i in range(rods.shape[0]):
            put(total, i, 0, (0.0, 0.0, g))
            put(total, i, 3, ZERO)
        why, where = between_rods(effects.between, effects, state, dt)
        if why != DONE:
            return n, why, where
        sample(watchers.series, rods, step)
        fastest, quickest = 0.0, 0.0  # squared
        for i in range(rods.shape[0]):
            deepest = on_plate(effects.normal, effects, state, i, plate, dt)
            if not deepest <= DEEP:
                return n, TOO_DEEP, i
            count_touch(watchers.series, effects, rods, i, deepest, plate, step)
            seen = from_above(vector(rods, i, PLACE), vector(rods, i, DIRECTOR))
            deepest = max(
                at_inner(effects.inner, effects, state, i, seen, dt),
                at_caps(effects.outer, effects, state, i, seen, -1, dt),
            )
            if not deepest <= DEEP:
                return n, WALL_TOO_DEEP, i
            director = vector(rods, i, DIRECTOR)
            gain_c = vector(total, i, 0)
            gain_w = across(rolling, along(ZERO, effects.lightness, vector(total, i, 3)), director)
            c = along(vector(rods, i, VELOCITY), dt, gain_c)
            w = across(rolling, along(vector(rods, i, TURN), dt, gain_w), director)
            travel, turn = dot(c, c), dot(w, w)
            if not travel + turn < 1e200:
                return n, NOT_FINITE, i
            fastest, quickest = max(fastest, travel), max(quickest, turn)
            put(rods, i, PLACE, along(vector(rods, i, PLACE), dt, c))
            put(rods, i, DIRECTOR, rotated(director, w, dt))
            put(rods, i, VELOCITY, c)
            put(rods, i, TURN, w)
            put(before, i, 0, gain_c)
            put(before, i, 3, gain_w)
        way = (sqrt(fastest) + effects.half_length * sqrt(quickest)) * dt
        if too_fast(effects.between, state.pairs, way):
            return n + 1, TOO_FAST, 0
    return steps, DONE, 0
