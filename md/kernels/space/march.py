"""Many rods in space, compiled: samples, Verlet's method.

The state of a rod is its centre, its director, its velocity and the vector w = (angular momentum)/I
about which the director turns. Without axial spin w is across the director and is the angular
velocity itself; with it, a free rod is a symmetric top, whose director turns about w all the same,
while its surface also spins by `spin` (w . director).

As in the plane (`kernels.plane`), an effect is an argument that may be `None`, and is then compiled
to nothing, and dashpots see velocities that are extrapolated to the step.
"""

from math import acos, atan2, cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from ...cache import kernel
from ..contact import plate_at
from ..plane import TOO_FAST, fast, travelled
from ..single import DEEP, DONE, NOT_FINITE, TOO_DEEP
from .forces import (
    DIRECTOR,
    PLACE,
    TURN,
    VELOCITY,
    at_inner,
    at_outer,
    on_plate,
    put,
    turning,
    vector,
)
from .geometry import UP, ZERO, along, cross, dot, from_above
from .pairs import crowded

COLUMNS = 12  # of the rods' state
WALL_TOO_DEEP = 8  # why a run ended, beyond those of the plane
# Columns of the series, a row a period.
ADVANCE, TILTS, LEANS, SAMPLES, TOUCHES, PLATE_SUM, PUSHING, APPROACH = range(8)
SERIES = 8


class Samples(NamedTuple):
    """What is sampled, a row a period, and the touches of the plate."""

    rows: np.ndarray  # (periods + 1, SERIES): sums over samples of the mean advance about the axis
    # [rad], mean tilt and mean lean along the annulus, number of samples; touches of the plate, its
    # velocity at them, the same weighted by the speed of approach, and that speed
    azimuth: np.ndarray  # (N,) at the last sample
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
def across(spin, w, director):
    """Without axial spin w stays across the director."""
    if spin is None:
        return along(w, -dot(w, director), director)
    return w


@kernel
def sample(samples, rods, step):
    """Add to the series at a sampling step."""
    if samples is None:
        return
    row, part = divmod(step, samples.per)
    if part % samples.every != 0:
        return
    n, advance, tilt, lean = rods.shape[0], 0.0, 0.0, 0.0
    for i in range(n):
        x, y = rods[i, PLACE], rods[i, PLACE + 1]
        azimuth = atan2(y, x)
        step_on = azimuth - samples.azimuth[i]
        advance += step_on - 2.0 * pi * np.round(step_on / (2.0 * pi))
        samples.azimuth[i] = azimuth
        a = vector(rods, i, DIRECTOR)
        side = 1.0 if a[2] >= 0.0 else -1.0  # a rod has no head
        along_ring = side * (x * a[1] - y * a[0]) / sqrt(x * x + y * y)
        tilt += acos(min(abs(a[2]), 1.0))
        lean += atan2(along_ring, abs(a[2]))
    rows = samples.rows
    rows[row, ADVANCE] += advance / n
    rows[row, TILTS] += tilt / n
    rows[row, LEANS] += lean / n
    rows[row, SAMPLES] += 1.0


@kernel
def touched(samples, world, rods, i, deepest, plate, step):
    """Note a new touch of the plate."""
    if samples is None:
        return
    if deepest > 0.0 and samples.resting[i] == 0:
        director = vector(rods, i, DIRECTOR)
        s = -world.half_length if director[2] > 0.0 else world.half_length
        arm = along(along(ZERO, s, director), -0.5, UP)
        spin = cross(turning(world.spin, vector(rods, i, TURN), director), arm)
        approach = plate[1] - rods[i, VELOCITY + 2] - spin[2]
        row, rows = step // samples.per, samples.rows
        rows[row, TOUCHES] += 1.0
        rows[row, PLATE_SUM] += plate[1]
        rows[row, PUSHING] += approach * plate[1]
        rows[row, APPROACH] += approach
    samples.resting[i] = deepest > 0.0


@kernel
def down(gravity):
    """Acceleration along z."""
    return 0.0 if gravity is None else gravity


@kernel(inline=False)
def march(
    world, rods, before, springs, pair_springs, pairs, skin, total, sampled, first, steps, dt
):
    """`steps` steps of all rods from step number `first`; steps made, why it ended, where.

    Parameters
    ----------
    world : Space
    rods : (N, 12): centre and director at a step; velocity and w half a step before
    before : (N, 6): accelerations of the step before, of the centre and of w
    springs : (N, 7, 3) of plate and walls, or None; pair_springs : (pairs, 5, 3), or None
    pairs : Pairs, or None
    total : (N, 6), scratch
    sampled : Samples, or None
    """
    g = down(world.gravity)
    for n in range(steps):
        plate = plate_at(world.plate, first + n)
        for i in range(rods.shape[0]):
            put(total, i, 0, (0.0, 0.0, g))
            put(total, i, 3, ZERO)
        why, where = crowded(
            world.between, world, rods, before, pairs, pair_springs, skin, total, dt
        )
        if why != DONE:
            return n, why, where
        sample(sampled, rods, first + n)
        fastest, quickest = 0.0, 0.0  # squared
        for i in range(rods.shape[0]):
            deepest = on_plate(world.normal, world, rods, before, i, plate, springs, total, dt)
            if not deepest <= DEEP:
                return n, TOO_DEEP, i
            touched(sampled, world, rods, i, deepest, plate, first + n)
            seen = from_above(vector(rods, i, PLACE), vector(rods, i, DIRECTOR))
            deepest = max(
                at_inner(world.inner, world, rods, before, i, seen, springs, total, dt),
                at_outer(world.outer, world, rods, before, i, seen, springs, total, dt),
            )
            if not deepest <= DEEP:
                return n, WALL_TOO_DEEP, i
            director = vector(rods, i, DIRECTOR)
            push_c = vector(total, i, 0)
            push_w = across(world.spin, along(ZERO, world.lightness, vector(total, i, 3)), director)
            c = along(vector(rods, i, VELOCITY), dt, push_c)
            w = across(world.spin, along(vector(rods, i, TURN), dt, push_w), director)
            travel, turn = dot(c, c), dot(w, w)
            if not travel + turn < 1e200:
                return n, NOT_FINITE, i
            fastest, quickest = max(fastest, travel), max(quickest, turn)
            put(rods, i, PLACE, along(vector(rods, i, PLACE), dt, c))
            put(rods, i, DIRECTOR, rotated(director, w, dt))
            put(rods, i, VELOCITY, c)
            put(rods, i, TURN, w)
            put(before, i, 0, push_c)
            put(before, i, 3, push_w)
        way = (sqrt(fastest) + world.half_length * sqrt(quickest)) * dt
        travelled(world.between, pairs, way)
        if fast(world.between, way):
            return n + 1, TOO_FAST, 0
    return steps, DONE, 0
