"""Forces of cylindrical walls in space, compiled: contacts computed side by side."""

from math import sqrt

import numpy as np

from ...cache import kernel
from ..batch import MOST, SIZE, WIDTH, get, keep
from ..codes import DEEP, DIRECTOR, INNER, OUTER, PLACE, PLATE_WORK, WALL_FRICTION, WALL_NORMAL
from ..contact import add, along, vector
from .batch import (
    FIRST,
    FORCE,
    FRICTION_LOST,
    NORMAL_LOST,
    SHARE,
    R,
    S,
    T,
    friction_force,
    given_rod,
    given_spring,
    keep_three,
    moves,
    spring_kept,
    three,
)
from .forces import At, act, carried, ends, forget, pressed
from .geometry import NEARER, UP, beyond, cross, from_above, from_axis, passes, rise, times

REACH = T  # of a contact with a wall; its `R` is the unit vector from the wall to the rod


@kernel
def collect(state, n, i, at):
    """Put a contact of rod i at place n of the batch; the number of contacts then."""
    numbers, place = state.batch
    place[np.uint64(n), 0], place[np.uint64(n), 1] = i, at.slot
    keep(numbers, S, n, at.s)
    keep(numbers, REACH, n, at.reach)
    keep_three(numbers, R, n, at.out)
    keep(numbers, SHARE, n, at.share)
    given_spring(state.springs, numbers, n, i, at.slot)
    given_rod(state, numbers, FIRST, n, i)
    return n + 1


@kernel
def found(numbers, what, c, arm, f):
    """Keep a force and its torque."""
    keep_three(numbers, what, c, f)
    keep_three(numbers, what + 3, c, cross(arm, f))


@kernel
def against(shaken, v, climb):
    """Velocity against a wall that climbs, or is at rest."""
    return v if shaken is None else along(v, -climb, UP)


@kernel
def contact(wall, effects, lost, numbers, climb, c, dt):
    """What acts in contact c."""
    out, director = (get(numbers, R, c), get(numbers, R + 1, c), 0.0), three(numbers, FIRST, c)
    at = At(get(numbers, S, c), get(numbers, REACH, c), out, climb, get(numbers, SHARE, c), 0)
    arm = along(times(at.s, director), -at.reach, out)
    v, gain = moves(effects.rolling, numbers, FIRST, c, arm)
    v = against(effects.shaken, v, climb)
    rubbing = pressed(wall.normal, effects, at, director, v, gain, dt)
    bodies = ((arm, director),)
    f = friction_force(wall.friction, effects, bodies, numbers, c, rubbing, dt)
    found(numbers, FORCE, c, arm, along(f, rubbing.force, out))
    elastic = at.share * wall.normal.stiffness * rubbing.overlap * sqrt(rubbing.overlap)
    if lost is not None:
        found(numbers, NORMAL_LOST, c, arm, times(rubbing.force - elastic, out))
        found(numbers, FRICTION_LOST, c, arm, f)


@kernel
def act_on(total, i, numbers, what, c):
    """Add a force and its torque."""
    add(total, i, 0, three(numbers, what, c))
    add(total, i, 3, three(numbers, what + 3, c))


@kernel
def lost_on(shaken, lost, i, numbers, climb, c):
    """Note the forces that take off energy, as `forces.lose` does."""
    if lost is not None:
        act_on(lost[WALL_NORMAL], i, numbers, NORMAL_LOST, c)
        act_on(lost[WALL_FRICTION], i, numbers, FRICTION_LOST, c)
        lost[PLATE_WORK, i, 0] = 1.0
        carried(shaken, lost, i, climb * get(numbers, FRICTION_LOST + 2, c))


@kernel(inline=False)
def acted(wall, effects, state, climb, count, dt):
    """Add what the first contacts of the batch do; none is left."""
    numbers, place = state.batch
    for c in range(min((count + WIDTH - 1) // WIDTH * WIDTH, SIZE)):  # the last ones are idle
        contact(wall, effects, state.lost, numbers, climb, c, dt)
    for c in range(count):
        i = np.uint64(place[c, 0])
        act_on(state.scratch, i, numbers, FORCE, c)
        spring_kept(state.springs, numbers, c, i, np.uint64(place[c, 1]))
        lost_on(effects.shaken, state.lost, i, numbers, climb, c)
    return 0


@kernel
def wall_forces(wall, effects, state, side, climb, dt):
    """Add the forces of a wall; a rod that is too deep, or -1. `side`: 1 convex, -1 concave."""
    if wall is None:
        return -1
    rods, half, n, slot = state.rods, effects.half_length, 0, INNER if side > 0 else OUTER
    touching = wall.radius + 0.5 * side
    for i in range(rods.shape[0]):
        place, director = vector(rods, i, PLACE), vector(rods, i, DIRECTOR)
        seen = from_above(place, director)
        for cap in range(ends(half)):
            s = half if cap else -half
            if side * (beyond(seen, s) - touching**2) >= 0:
                forget(state.springs, i, slot + cap)
                continue
            rho, out = from_axis(along(place, s, director))
            reach = side * (rho - wall.radius)
            if not 0.5 - reach <= DEEP:
                return i
            out = side * out[0], side * out[1], 0.0
            n = collect(state, n, i, At(s, reach, out, climb, 1.0, slot + cap))
        if side > 0:
            if passes(seen, half, touching):
                at = beside(wall, state, i, half, -seen[1] / seen[2])
                if not 0.5 - at.reach <= DEEP:
                    return i
                n = collect(state, n, i, at)
            else:
                forget(state.springs, i, slot + 2)
        if n > MOST:
            n = acted(wall, effects, state, climb, n, dt)
    acted(wall, effects, state, climb, n, dt)
    return -1


@kernel
def beside(wall, state, i, half, s):
    """Contact of the convex wall at a place between the ends; adds what keeps energy."""
    place, director = vector(state.rods, i, PLACE), vector(state.rods, i, DIRECTOR)
    rho, out = from_axis(along(place, s, director))
    lower, out_l = from_axis(along(place, -half, director))
    upper, out_u = from_axis(along(place, half, director))
    w_l, slope_l = rise((lower - rho) * (1 / NEARER))
    w_u, slope_u = rise((upper - rho) * (1 / NEARER))
    at = At(s, rho - wall.radius, out, 0.0, w_l * w_u, INNER + 2)
    if slope_l + slope_u != 0.0:
        overlap = max(0.5 - at.reach, 0.0)
        energy = 0.4 * wall.normal.stiffness * overlap * overlap * sqrt(overlap) * (1 / NEARER)
        attracted(state, i, s, out, energy * (slope_l * w_u + w_l * slope_u))
        attracted(state, i, -half, out_l, -energy * slope_l * w_u)
        attracted(state, i, half, out_u, -energy * w_l * slope_u)
    return at


@kernel
def attracted(state, i, s, normal, force):
    """Add a force along a normal at place s of the axis of rod i."""
    arm = times(s, vector(state.rods, i, DIRECTOR))
    act(state.scratch, i, arm, times(force, normal))
