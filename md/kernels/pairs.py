"""Forces between rods, compiled.

Two rods touch where an end of one comes close to the axis of the other. Each of the four ends of
a pair is a contact of its own, with its own spring: two parallel rods that lie against each other
touch at two places, and as they turn the force passes from one place to the other without a jump,
which the single closest point of two segments could not do. All forces derive from distances of
places, so that without dashpots energy is kept.

Two ends that meet are one place, though each has a contact with the other rod's axis. Between an
end of one rod and an end of the other the energy of a contact at the distance of the two, U(ends),
is taken off again:

    V = sum over ends U(end to axis) - sum over two ends that are near U(end to end).

Where an end finds the other rod's end nearest, its energy is U(ends) as well and drops out: one
contact is left of cap on cap, and of an end on a side close to the side's own end. Rods that lie
side by side touch at two places, in full once they overlap by more than sqrt(2 overlap): there the
ends no longer reach each other. As they slide off each other, the two places become one without a
jump. No length is chosen, and V has continuous forces. What is taken off is divided between the two
contacts, so that dashpot and friction, too, count the place once: by the squares of how far each
foot lies from the end, which is how U(ends) differs from either energy. At the one place, where the
shares add up to 1, there is one spring.

Rods that cross in space touch between their ends as well. As they turn parallel, or slide off each
other's end, that contact becomes one with an end's, and counts by how much nearer it is than each
of the four, so that no force jumps.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ..cache import kernel
from . import CROSSING, DEEP, DONE, FULL_LIST, PAIR_NORMAL, PAIR_TOO_DEEP
from .batch import MOST, TWO, Alike, Given, acted, enter
from .contact import elastic_energy
from .neighbours import (
    CHORD,
    PAIR,
    Axes,
    between_ends,
    clearance,
    near_at,
    near_end,
    outdated,
    renewed,
    row_of,
)
from .state import forces_at, forget, point, pull, rod_of
from .vectors import along, axial, put, times

BELOW_ONE = 1.0 - 2.0**-53  # next to 1
NEARER = 0.1  # d; by so much nearer than all ends, a contact between them counts in full
SHARED = (1 + NEARER) ** 2 - 1  # squared lever beyond which no end shares a contact between ends
TOUCHED = 3  # column of `Listed.index`: sum of these two
ENDS, BETWEEN = 1, 2  # two rods touch at their ends, or between them


class Pair(NamedTuple):
    """Two rods of an entry of the list, and their relative place."""

    i: np.uint64  # first rod
    j: np.uint64  # second rod
    entry: int  # of the list
    axes: Axes


class Joint(NamedTuple):
    """Shares of the two contacts where an end of one rod meets an end of another."""

    force: float  # elastic force over the stiffness, of a contact at the distance of the two ends
    part: float  # part of it that is taken off the first contact; the rest, off the second
    first: float  # share that remains of the contact at the first rod's end
    second: float  # share that remains of the contact at the second rod's end


@kernel
def pair_of(effects, rods, index, k):
    """`Pair` of entry k of the list."""
    i, j, up = np.uint64(index[k, 0]), np.uint64(index[k, 1]), effects.up  # never negative
    first, second = rod_of(up, rods, i), rod_of(up, rods, j)
    apart = seen_through(effects.period, along(first.place, -1.0, second.place), index[k, 2])
    return Pair(i, j, k, Axes(apart, first.director, second.director))


@kernel
def seen_through(period, apart, image):
    """Vector from an image of the second rod to the first; `apart`: from the second rod itself.

    `image`: periods by which the image lies further along x.
    """
    if period is None:
        return apart
    return apart[0] - period * image, apart[1]


@kernel
def moving(effects, state, i, arm):
    """Velocity of a point of rod i half a step before, and its acceleration in the last step."""
    rod, (gain, bend) = rod_of(effects.up, state.rods, i), forces_at(effects.up, state.before, i)
    v = point(effects.inertia, rod.velocity, rod.turn, rod.director, arm)
    return v, point(effects.inertia, gain, bend, rod.director, arm)


@kernel
def collect(effects, state, n, pair, near, share, slot):
    """Store a contact of two rods at place n of the batch; return the contact count."""
    i, j, entry, (_, a, b) = pair
    s, t, gap, _ = near
    p, q = along(times(s, a), -0.5, gap), along(times(t, b), 0.5, gap)
    v, gain = moving(effects, state, i, p)
    u, other = moving(effects, state, j, q)
    half, gain = along(v, -1.0, u), along(gain, -1.0, other)
    where = i, j, np.uint64(row_of(effects.up, entry, slot))
    given = Given(where, gap, ((p, a), (q, b)), half, gain, share)
    return enter(state.scratch.batch, n, given, state.listed.memory, effects.up)


@kernel
def act(effects, state, ledger, count, dt):
    """Compute the collected contacts and add their forces to rods; return 0, as none is left."""
    scratch = state.scratch
    alike = Alike(effects.between, TWO, effects.inertia, effects.up, PAIR_NORMAL)
    acted(alike, state.listed.memory, scratch.total, scratch.batch, ledger, count, dt)
    return 0


@kernel
def repel(total, pair, near, force):
    """Add a force that drives points of two axes apart, or together if it is < 0."""
    f = times(force / sqrt(near.square), near.gap)
    pull(total, pair.i, times(near.s, pair.axes.a), f)
    pull(total, pair.j, times(near.t, pair.axes.b), times(-1.0, f))


# Ends that meet


@kernel
def joint(square, first, second):
    """`Joint` of two ends with the squared distance `square` < 1, d^2.

    `first`, `second`: how far the foot of the first rod's end lies from the other end along the
    second axis, and the reverse, in d.
    """
    square = min(square, BELOW_ONE)  # a rounding may have told that they touch
    first, second = first * first, second * second
    total = first + second
    part = second / total if total > 0.0 else 0.5
    overlap = 1.0 - sqrt(square)
    ratio, other = overlap / (1.0 - sqrt(square - first)), overlap / (1.0 - sqrt(square - second))
    return Joint(
        overlap * sqrt(overlap),
        part,
        1.0 - part * ratio * sqrt(ratio),
        1.0 - (1.0 - part) * other * sqrt(other),
    )


@kernel
def one_spring(springs, own, other, first, second, up):
    """Give both contacts of two ends that meet one spring, where one has no foot of its own.

    `own`, `other`: their rows.
    """
    if springs is None or (first > 0.0 and second > 0.0):
        return
    length = axial(springs, own, 0, up)
    if first == 0.0:
        length = axial(springs, other, 0, up)
        if second == 0.0:
            length = along(times(0.5, length), 0.5, axial(springs, own, 0, up))
    put(springs, own, 0, length)
    put(springs, other, 0, length)


@kernel(inline=False)
def joined_ends(effects, state, pair, near, end):
    """Shares of the contacts of two ends that meet, and the second end; add their joint forces.

    These forces keep energy. `end`: of the first rod, with its `near`; the second end is 2 or 3.
    """
    total, listed, up = state.scratch.total, state.listed, effects.up
    other = 3 if near.t > 0.0 else 2
    back = near_end(pair.axes, effects.half_length, other)
    ends = near_at(pair.axes, near.s, back.t)
    first, second = abs(ends.t - near.t), abs(ends.s - back.s)
    met = joint(ends.square, first, second)
    row = row_of(up, pair.entry, 0)
    one_spring(listed.memory.springs, row + end, row + other, first, second, up)
    if first > 0.0 and second > 0.0:
        force = effects.between.normal.stiffness * met.force
        repel(total, pair, near, met.part * force)
        repel(total, pair, back, (1.0 - met.part) * force)
        repel(total, pair, ends, -force)
    return met.first, met.second, other


@kernel
def meets(upper, end, near, half):
    """Whether an end of the first rod overlaps with the end of the second that is next to its foot.

    `near`: of the contact at this end.
    """
    if upper is None:
        return False
    beyond = half - abs(near.t)
    return end < 2 and near.square + beyond * beyond < 1.0


# Rods that cross


@kernel
def rise(x):
    """Smooth step from 0 at x = 0 to 1 at x = 1, x^2 (3 - 2 x), and its slope."""
    x = min(max(x, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x)


@kernel
def nearer(end, distance):
    """Weight of a contact by how much nearer than an end it is, and the slope of the weight."""
    return rise((sqrt(end.square) - distance) * (1 / NEARER))


@kernel
def shared(law, total, pair, near, half):
    """Weight of a contact between ends where an end may share it; adds the forces that keep energy.

    It is below 1 near an end, and where rods are nearly parallel. The forces are the slopes of the
    weight: each end is pushed off, the contact pulled in.
    """
    distance = sqrt(near.square)
    ends = (
        near_end(pair.axes, half, 0),
        near_end(pair.axes, half, 1),
        near_end(pair.axes, half, 2),
        near_end(pair.axes, half, 3),
    )
    (w_0, pull_0), (w_1, pull_1) = nearer(ends[0], distance), nearer(ends[1], distance)
    (w_2, pull_2), (w_3, pull_3) = nearer(ends[2], distance), nearer(ends[3], distance)
    first, second = w_0 * w_1, w_2 * w_3
    energy = elastic_energy(law, 1.0 - distance) * (1 / NEARER)
    pulls = (
        energy * pull_0 * w_1 * second,
        energy * pull_1 * w_0 * second,
        energy * pull_2 * w_3 * first,
        energy * pull_3 * w_2 * first,
    )
    repel(total, pair, near, pulls[0] + pulls[1] + pulls[2] + pulls[3])
    for end in range(4):
        repel(total, pair, ends[end], -pulls[end])
    return first * second


@kernel
def crossing(up, effects, state, pair, was, n):
    """Collect the contact of two rods between their ends, in space; in the plane there is none.

    Returns the number of contacts, whether the ends need no look, as they can neither touch nor
    share that contact, and the squared distance between the ends, inf where rods are not closest
    there.
    """
    if len(up) == 2:
        return n, False, np.inf
    half = effects.half_length
    near, inside, skew = between_ends(pair.axes, half)
    if not inside or near.square >= 1.0:
        if was & BETWEEN:
            forget(up, state.listed.memory, row_of(up, pair.entry, CROSSING))
        return n, inside, near.square if inside else np.inf
    margin = half - max(abs(near.s), abs(near.t))
    clear, share = margin * margin * skew >= max(SHARED, 1.0 - near.square), 1.0
    if not clear:
        share = shared(effects.between.normal, state.scratch.total, pair, near, half)
    return collect(effects, state, n, pair, near, share, CROSSING), clear, near.square


# All pairs


@kernel
def ends_of(upper):
    """Number of ends with a contact of two rods: 4, or 1 for two spheres."""
    return 1 if upper is None else 4


@kernel
def pair_forces(between, effects, state, ledger, dt):
    """Add the forces of all touching pairs; return the stop code, and the entry of the pair."""
    if between is None:
        return DONE, 0
    rods, listed, half, scratch, n = state.rods, state.listed, effects.half_length, state.scratch, 0
    if outdated(listed) and not renewed(
        effects.up, rods, half, effects.period, listed, scratch.place, scratch.found
    ):
        return FULL_LIST, 0
    travelled, now, asleep = listed.travelled[0], listed.turn[0], listed.asleep
    up, index, memory = effects.up, listed.index, listed.memory
    for k in range(listed.start[now, rods.shape[0]]):
        if travelled < asleep[k, PAIR]:
            continue
        entry = 2 * k + now
        pair, was = pair_of(effects, rods, index, entry), index[entry, TOUCHED]
        if was == 0:
            open_by = clearance(pair.axes, half)
            if open_by >= 0.0:
                asleep[k, PAIR] = travelled + 0.5 * open_by
                continue
        if n > MOST:
            n = act(effects, state, ledger, n, dt)
        n, clear, square = crossing(up, effects, state, pair, was, n)
        if square < (1 - DEEP) ** 2:
            return PAIR_TOO_DEEP, entry
        touches, until = BETWEEN if square < 1.0 else 0, np.inf
        lower = upper = 1.0  # shares left to the contacts at the ends of the second rod
        if clear and was & ENDS:
            for end in range(4):
                forget(up, memory, row_of(up, entry, end))
        for end in range(0 if clear else ends_of(effects.upper)):
            if travelled < asleep[k, end]:
                until = min(until, asleep[k, end])
                continue
            near = near_end(pair.axes, half, end)
            if near.square >= 1.0:
                forget(up, memory, row_of(up, entry, end))
                asleep[k, end] = travelled + 0.5 * CHORD * (min(near.square, 2.0) - 1.0)
                until = min(until, asleep[k, end])
                continue
            if near.square < (1 - DEEP) ** 2:
                return PAIR_TOO_DEEP, entry
            touches |= ENDS
            share = (1.0, 1.0, lower, upper)[end]
            if meets(effects.upper, end, near, half):
                share, left, other = joined_ends(effects, state, pair, near, end)
                if other == 2:
                    lower += left - 1.0
                else:
                    upper += left - 1.0
            n = collect(effects, state, n, pair, near, share, end)
        index[entry, TOUCHED] = touches
        if touches == 0 and not clear:
            asleep[k, PAIR] = until
    act(effects, state, ledger, n, dt)
    return DONE, 0
