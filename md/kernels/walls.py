"""Forces of cylindrical walls, compiled: `side` is 1 of the convex inner wall, -1 of the outer one.

A rod touches a wall with its ends. One that lies along the convex wall touches it between them as
well, with a weight as of rods that cross (`pairs`).
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ..cache import kernel
from .batch import FORCE, MOST, ONE, Alike, Given, acted, enter, get
from .codes import DEEP, INNER, OUTER, PLATE_WORK, WALL_FRICTION, WALL_NORMAL
from .contact import elastic_energy
from .pairs import NEARER, moving, pull, rise
from .state import director_of, forget, inertia_of, place_of
from .vectors import IN_SPACE, along, raised, times


class At(NamedTuple):
    """Contact of a rod with a wall: place on the axis, distance, direction and weight."""

    s: float  # d; place on the axis, from the centre
    reach: float  # d; from there to the wall
    out: tuple[float, float, float]  # unit vector from the wall to the rod
    share: float  # weight of the contact, 0 to 1
    slot: int  # of its kept force and spring


@kernel
def from_above(place, director):
    """Products x.x, x.u and u.u of the horizontal parts of a rod's centre x and director u."""
    x, y, u, v = place[0], place[1], director[0], director[1]
    return x * x + y * y, x * u + y * v, u * u + v * v


@kernel
def beyond(seen, s):
    """Squared distance of a point s of a rod from the axis of the annulus.

    `seen`: the products of `from_above`.
    """
    return seen[0] + s * (2.0 * seen[1] + s * seen[2])


@kernel
def passes(seen, half, distance):
    """Whether a rod comes closer than `distance` to the axis of the annulus between its ends.

    It is closest at s = -x.u/u.u.
    """
    square, slope, flat = seen
    if abs(slope) >= half * flat or flat < 1e-12:
        return False
    return (square - distance * distance) * flat < slope * slope


@kernel
def from_axis(point):
    """Horizontal distance of a point from the axis of the annulus, and the unit vector outwards."""
    rho = sqrt(point[0] * point[0] + point[1] * point[1])
    return rho, (point[0] / rho, point[1] / rho, 0.0)


@kernel
def against(shaken, v, gain, climb, dt):
    """Velocity and acceleration of a point against a wall, which is shaken or at rest.

    `climb`: velocity of the shaken wall half a step before, and at the step.
    """
    if shaken is None:
        return v, gain
    before, now = climb
    return raised(v, -before), raised(gain, (before - now) * 2 / dt)


@kernel
def collect(effects, state, n, i, at, climb, dt):
    """Store a contact of rod i with a wall at place n of the batch; return the contact count."""
    director, rod = director_of(IN_SPACE, state.rods, i), np.uint64(i)
    arm = along(times(at.s, director), -at.reach, at.out)
    v, gain = moving(effects, state, i, director, arm)
    half, gain = against(effects.shaken, v, gain, climb, dt)
    # a rounding may have told a touch
    gap = times(0.5 + min(at.reach, 0.5), at.out)
    given = Given(rod, rod, rod, at.slot, gap, ((arm, director),), half, gain, at.share)
    return enter(state.scratch.batch, n, given, state.forces, state.springs, IN_SPACE)


@kernel
def act(wall, effects, state, ledger, climb, count, dt):
    """Compute the collected contacts of a wall and add their forces; return 0, as none is left."""
    total, batch = state.scratch.total, state.scratch.batch
    kept, columns = (state.forces, state.springs), (WALL_NORMAL, WALL_FRICTION)
    alike = Alike(wall, ONE, inertia_of(effects), IN_SPACE, columns)
    acted(alike, kept, total, batch, ledger, count, dt)
    worked(effects.shaken, ledger, batch.numbers, climb[1] * dt, count)
    return 0


@kernel
def worked(shaken, ledger, numbers, climbed, count):
    """Add the work of a shaken wall to the ledger, by friction alone: the normal is level."""
    if shaken is None:
        return
    if ledger is not None:
        for c in range(count):
            ledger[PLATE_WORK] += climbed * get(numbers, FORCE + 2, c)


@kernel
def beside(wall, state, i, half, s):
    """`At` of rod i on the convex wall, between its ends; adds the forces that keep energy."""
    place, director = place_of(IN_SPACE, state.rods, i), director_of(IN_SPACE, state.rods, i)
    rho, out = from_axis(along(place, s, director))
    lower, out_l = from_axis(along(place, -half, director))
    upper, out_u = from_axis(along(place, half, director))
    w_l, slope_l = rise((lower - rho) * (1 / NEARER))
    w_u, slope_u = rise((upper - rho) * (1 / NEARER))
    at = At(s, rho - wall.radius, out, w_l * w_u, INNER + 2)
    if slope_l + slope_u != 0.0:
        total = state.scratch.total
        energy = elastic_energy(wall.normal, 0.5 - at.reach) * (1 / NEARER)
        pulled = energy * (slope_l * w_u + w_l * slope_u)
        pull(total, i, times(s, director), times(pulled, out))
        pull(total, i, times(-half, director), times(-energy * slope_l * w_u, out_l))
        pull(total, i, times(half, director), times(-energy * w_l * slope_u, out_u))
    return at


@kernel(inline=False)
def wall_forces(wall, effects, state, ledger, side, climb, dt):
    """Add the forces of a wall on all rods; return a rod that is too deep in it, or -1."""
    rods, half, n, slot = state.rods, effects.half_length, 0, INNER if side > 0 else OUTER
    touching = wall.radius + 0.5 * side
    for i in range(rods.shape[0]):
        place, director = place_of(IN_SPACE, rods, i), director_of(IN_SPACE, rods, i)
        seen = from_above(place, director)
        if n > MOST:
            n = act(wall, effects, state, ledger, climb, n, dt)
        for cap in range(1 if effects.upper is None else 2):
            s = half if cap else -half
            if side * (beyond(seen, s) - touching**2) >= 0:
                forget(IN_SPACE, state.forces, state.springs, i, slot + cap)
                continue
            rho, out = from_axis(along(place, s, director))
            reach = side * (rho - wall.radius)
            if not 0.5 - reach <= DEEP:
                return i
            at = At(s, reach, times(side, out), 1.0, slot + cap)
            n = collect(effects, state, n, i, at, climb, dt)
        if side > 0:
            if passes(seen, half, touching):
                at = beside(wall, state, i, half, -seen[1] / seen[2])
                if not 0.5 - at.reach <= DEEP:
                    return i
                n = collect(effects, state, n, i, at, climb, dt)
            else:
                forget(IN_SPACE, state.forces, state.springs, i, slot + 2)
    act(wall, effects, state, ledger, climb, n, dt)
    return -1


@kernel
def within(wall, effects, state, ledger, side, climb, dt):
    """Add the forces of a wall, which may be absent; return a rod that is too deep in it, or -1."""
    if wall is None:
        return -1
    return wall_forces(wall, effects, state, ledger, side, climb, dt)
