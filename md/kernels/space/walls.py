"""Forces of cylindrical walls in space, compiled: contacts computed side by side."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ...cache import kernel
from ..batch import MOST, SIZE, WIDTH, get, keep
from ..codes import DEEP, DIRECTOR, INNER, OUTER, PLACE, PLATE_WORK, WALL_FRICTION, WALL_NORMAL
from ..contact import Meeting, contact, losses, total
from ..vectors import UP, add, along, cross, times, vector
from .batch import (
    FIRST,
    FORCE,
    FRICTION_LOSS,
    LAST,
    NORMAL_LOSS,
    RUB,
    SHARE,
    SPRING,
    WORK,
    R,
    S,
    T,
    booked,
    given,
    given_rod,
    keep_three,
    moves,
    taken,
    three,
)
from .forces import act, ends, forget, inertia_of
from .geometry import NEARER, beyond, from_above, from_axis, passes, rise

REACH = T  # of a contact with a wall; its `R` is the unit vector from the wall to the rod


class At(NamedTuple):
    """Where a wall may touch a rod."""

    s: float  # d; place on the axis, from the centre
    reach: float  # d; from there to the wall
    out: tuple[float, float, float]  # unit vector from the wall to the rod
    share: float  # weight of the contact, 0 to 1
    slot: int  # of what is kept of it


@kernel
def collect(state, n, i, at):
    """Put a contact of rod i at place n of the batch; the number of contacts then."""
    numbers, place = state.scratch.batch
    place[np.uint64(n), 0], place[np.uint64(n), 1] = i, at.slot
    keep(numbers, S, n, at.s)
    keep(numbers, REACH, n, at.reach)
    keep_three(numbers, R, n, at.out)
    keep(numbers, SHARE, n, at.share)
    given(state.forces, state.springs, numbers, n, i, at.slot)
    given_rod(state, numbers, FIRST, n, i)
    return n + 1


@kernel
def against(shaken, v, gain, climb, dt):
    """Velocity and acceleration against a wall that climbs, or is at rest.

    `climb`: its velocity half a step before, and at the step.
    """
    if shaken is None:
        return v, gain
    before, now = climb
    return along(v, -before, UP), along(gain, (before - now) * 2 / dt, UP)


@kernel
def accounted(ledger, law, numbers, c, meeting, found, climb, dt):
    """What is lost in this step, and what a wall that moves along itself works by friction."""
    if ledger is not None:
        share, rub = get(numbers, SHARE, c), found.rub[2]  # the normal is level
        normal, friction = losses(law, meeting, found, dt)
        keep(numbers, NORMAL_LOSS, c, share * normal)
        keep(numbers, FRICTION_LOSS, c, share * friction)
        keep(numbers, WORK, c, share * dt * climb[1] * rub)


@kernel
def act_on(wall, effects, ledger, numbers, climb, c, dt):
    """What acts in contact c."""
    out, director = (get(numbers, R, c), get(numbers, R + 1, c), 0.0), three(numbers, FIRST, c)
    reach = get(numbers, REACH, c)
    arm = along(times(get(numbers, S, c), director), -reach, out)
    v, gain = moves(effects.rolling, numbers, FIRST, c, arm)
    overlap = max(0.5 - reach, 0.0)  # a rounding may have told a touch
    half, gain = against(effects.shaken, v, gain, climb, dt)
    pressed, rubbed, spring = (
        get(numbers, LAST, c),
        three(numbers, RUB, c),
        three(numbers, SPRING, c),
    )
    meeting = Meeting(
        ((arm, director),), out, overlap, half, gain, pressed, rubbed, spring, None, None, half
    )
    found = contact(wall.normal, wall.friction, inertia_of(effects), meeting, dt)
    accounted(ledger, wall.normal, numbers, c, meeting, found, climb, dt)
    keep_three(numbers, SPRING, c, found.spring)
    keep(numbers, LAST, c, found.normal)
    keep_three(numbers, RUB, c, found.rub)
    f = times(get(numbers, SHARE, c), total(found, out))
    keep_three(numbers, FORCE, c, f)
    keep_three(numbers, FORCE + 3, c, cross(arm, f))


@kernel
def worked(shaken, ledger, numbers, count):
    """Add the work of the shaken walls."""
    if shaken is None:
        return
    if ledger is not None:
        for c in range(count):
            ledger[PLATE_WORK] += get(numbers, WORK, c)


@kernel(inline=False)
def acted(wall, effects, state, ledger, climb, count, dt):
    """Add what the first contacts of the batch do; none is left."""
    numbers, place = state.scratch.batch
    for c in range(min((count + WIDTH - 1) // WIDTH * WIDTH, SIZE)):  # the last ones are idle
        act_on(wall, effects, ledger, numbers, climb, c, dt)
    for c in range(count):
        i = np.uint64(place[c, 0])
        add(state.scratch.total, i, 0, three(numbers, FORCE, c))
        add(state.scratch.total, i, 3, three(numbers, FORCE + 3, c))
        taken(state.forces, state.springs, numbers, c, i, np.uint64(place[c, 1]))
    booked(ledger, numbers, WALL_NORMAL, WALL_FRICTION, count)
    worked(effects.shaken, ledger, numbers, count)
    return 0


@kernel
def wall_forces(wall, effects, state, ledger, side, climb, dt):
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
                forget(state.forces, state.springs, i, slot + cap)
                continue
            rho, out = from_axis(along(place, s, director))
            reach = side * (rho - wall.radius)
            if not 0.5 - reach <= DEEP:
                return i
            out = side * out[0], side * out[1], 0.0
            n = collect(state, n, i, At(s, reach, out, 1.0, slot + cap))
        if side > 0:
            if passes(seen, half, touching):
                at = beside(wall, state, i, half, -seen[1] / seen[2])
                if not 0.5 - at.reach <= DEEP:
                    return i
                n = collect(state, n, i, at)
            else:
                forget(state.forces, state.springs, i, slot + 2)
        if n > MOST:
            n = acted(wall, effects, state, ledger, climb, n, dt)
    acted(wall, effects, state, ledger, climb, n, dt)
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
    at = At(s, rho - wall.radius, out, w_l * w_u, INNER + 2)
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
    act(state.scratch.total, i, arm, times(force, normal))
