"""Pairs of rods in space, compiled: which may touch, and the forces between them."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ...cache import kernel
from ..batch import MOST
from ..codes import (
    CROSSING,
    DEEP,
    DIRECTOR,
    DONE,
    PAIR_TOO_DEEP,
    PLACE,
    SKIN,
)
from ..contact import add, along, put, vector
from ..joints import joint
from .batch import acted, collect
from .forces import Pairs, forget
from .geometry import NEARER, at_end, between_ends, cross, dot, gap_vector, rise, times

ENDS, BETWEEN_ENDS = 1, 2  # bits: what of two rods touches
SHARED = (1 + NEARER) ** 2 - 1  # squared lever beyond which no end shares a contact between ends


class Pair(NamedTuple):
    """Two rods."""

    i: np.uint64
    j: np.uint64
    number: np.uint64  # of the pair: row of its springs
    a: tuple[float, float, float]  # director of the first
    b: tuple[float, float, float]


class Closest(NamedTuple):
    """Closest points of the axes of two rods, or of an end of one and the axis of the other."""

    s: float  # d; place on the first axis, from its centre
    t: float  # d; on the second
    gap: tuple[float, float, float]  # d; from the second place to the first
    distance: float  # d


def no_pairs(rods: int) -> Pairs:
    """A list that is out of date."""
    most = max(rods * (rods - 1) // 2, 1)
    return Pairs(
        np.zeros(1, np.int64), np.zeros((most, 3), np.int64), np.zeros(most),
        np.zeros(most, np.int8), np.full(1, np.inf),
    )  # fmt: skip


@kernel
def nearest(apart, a, b, half):
    """Distance of two axes."""
    least = np.inf
    for end in range(4):
        s, t = at_end(apart, a, b, half, end)
        r = gap_vector(apart, a, b, s, t)
        least = min(least, dot(r, r))
    s, t, _, inside = between_ends(apart, a, b, half)
    if inside:
        r = gap_vector(apart, a, b, s, t)
        least = min(least, dot(r, r))
    return sqrt(least)


@kernel(inline=False)
def list_pairs(rods, half, pairs):
    """Make the list again; every pair is looked at."""
    n, count, number = rods.shape[0], 0, 0
    for i in range(n):
        for j in range(i + 1, n):
            apart = along(vector(rods, i, PLACE), -1.0, vector(rods, j, PLACE))
            if dot(apart, apart) < (2.0 * half + 1.0 + SKIN) ** 2:
                a, b = vector(rods, i, DIRECTOR), vector(rods, j, DIRECTOR)
                if nearest(apart, a, b, half) < 1.0 + SKIN:
                    pairs.index[count, 0], pairs.index[count, 1] = i, j
                    pairs.index[count, 2], pairs.asleep[count] = number, 0.0
                    count += 1
            number += 1
    pairs.count[0] = count
    pairs.travelled[0] = 0.0


@kernel
def shared(law, total, pair, near, ends):
    """Weight of a contact near an end, or of nearly parallel rods; adds what keeps energy.

    The forces are the slopes of the weight: each end is pushed off, the contact pulled in.
    """
    i, j, _, a, b = pair
    s, t, r, distance = near
    (w_0, pull_0), (w_1, pull_1) = nearer(ends[0], distance), nearer(ends[1], distance)
    (w_2, pull_2), (w_3, pull_3) = nearer(ends[2], distance), nearer(ends[3], distance)
    first, second = w_0 * w_1, w_2 * w_3
    overlap = 1.0 - distance
    energy = 0.4 * law.stiffness * overlap * overlap * sqrt(overlap) * (1 / NEARER)
    pulls = (
        energy * pull_0 * w_1 * second,
        energy * pull_1 * w_0 * second,
        energy * pull_2 * w_3 * first,
        energy * pull_3 * w_2 * first,
    )
    towards = (pulls[0] + pulls[1] + pulls[2] + pulls[3]) / distance
    f = times(towards, r)
    at_i, at_j = times(s, f), times(t, f)
    for end in range(4):
        x, y, e, square = ends[end]
        away = times(-pulls[end] / sqrt(square), e)
        f, at_i, at_j = along(f, 1.0, away), along(at_i, x, away), along(at_j, y, away)
    add(total, i, 0, f)
    add(total, i, 3, cross(a, at_i))
    add(total, j, 0, times(-1.0, f))
    add(total, j, 3, cross(at_j, b))
    return first * second


@kernel
def nearer(end, distance):
    """How much nearer than an end a contact is: its weight, and the slope."""
    return rise((sqrt(end[3]) - distance) * (1 / NEARER))


@kernel
def end_gap(apart, a, b, half, end):
    """Places on both axes of the contact at one of four ends, the gap vector, its square."""
    s, t = at_end(apart, a, b, half, end)
    r = gap_vector(apart, a, b, s, t)
    return s, t, r, dot(r, r)


@kernel
def end_gaps(apart, a, b, half):
    """Those of all four."""
    return (
        end_gap(apart, a, b, half, 0),
        end_gap(apart, a, b, half, 1),
        end_gap(apart, a, b, half, 2),
        end_gap(apart, a, b, half, 3),
    )


@kernel
def one_spring(springs, number, end, other, first, second):
    """Keep one spring at the contacts of two ends where one has no foot of its own."""
    if springs is None or (first > 0.0 and second > 0.0):
        return
    own = springs[number]
    length = vector(own, end, 0)
    if first == 0.0:
        length = vector(own, other, 0)
        if second == 0.0:
            length = along(times(0.5, length), 0.5, vector(own, end, 0))
    put(own, end, 0, length)
    put(own, other, 0, length)


@kernel
def repel(total, pair, s, t, gap, force):
    """Add a force that drives a place on one axis and a place on the other apart."""
    i, j, _, a, b = pair
    f = times(force / sqrt(dot(gap, gap)), gap)
    add(total, i, 0, f)
    add(total, i, 3, cross(a, times(s, f)))
    add(total, j, 0, times(-1.0, f))
    add(total, j, 3, cross(times(t, f), b))


@kernel(inline=False)
def joined(effects, state, pair, ends, end):
    """Shares of two ends that meet in their place; adds the forces that keep energy.

    `end`: of the first rod. Third, which end of the second rod.
    """
    total = state.scratch
    s, foot, gap, _ = ends[end]
    other = 3 if foot > 0.0 else 2
    back, t, second_gap, _ = ends[other]
    first, second, across = abs(t - foot), abs(s - back), along(gap, foot - t, pair.b)
    met = joint(dot(across, across), first, second)
    one_spring(state.pair_springs, pair.number, end, other, first, second)
    if first > 0.0 and second > 0.0:
        force = effects.between.normal.stiffness * met.force
        repel(total, pair, s, foot, gap, met.part * force)
        repel(total, pair, back, t, second_gap, (1.0 - met.part) * force)
        repel(total, pair, s, t, across, -force)
    return met.first, met.second, other


@kernel
def ends_met(effects, state, pair, ends, was, n, dt):
    """Contacts of four ends: what touches, whether too deep, how many there are now.

    Spheres have one.
    """
    touches, half = 0, effects.half_length
    lower = upper = 1.0  # shares left to the ends of the second rod
    for end in range(4 if half > 0.0 else 1):
        s, t, r, square = ends[end]
        if square >= 1.0:
            if was & ENDS:
                forget(state.pair_springs, pair.number, end)
            continue
        if square < (1.0 - DEEP) ** 2:
            return touches, True, n
        touches, share, beyond = ENDS, (1.0, 1.0, lower, upper)[end], half - abs(t)
        if end < 2 and half > 0.0 and square + beyond * beyond < 1.0:
            share, left, other = joined(effects, state, pair, ends, end)
            if other == 2:
                lower += left - 1.0
            else:
                upper += left - 1.0
        n = collect(state, n, pair, Closest(s, t, r, sqrt(square)), share, end)
    return touches, False, n


@kernel(inline=False)
def pair_forces(between, effects, state, dt):
    """Forces of all listed pairs; number of a pair that is too deep, or -1.

    Where two axes are closest between their ends, by so much that no end can touch or share the
    contact, the ends need no look.
    """
    rods, pairs, springs, half = state.rods, state.pairs, state.pair_springs, effects.half_length
    travelled, n = pairs.travelled[0], 0
    for k in range(pairs.count[0]):
        if travelled < pairs.asleep[k]:
            continue
        i, j = np.uint64(pairs.index[k, 0]), np.uint64(pairs.index[k, 1])  # never negative
        number = np.uint64(pairs.index[k, 2])
        apart = along(vector(rods, i, PLACE), -1.0, vector(rods, j, PLACE))
        a, b = vector(rods, i, DIRECTOR), vector(rods, j, DIRECTOR)
        pair, was, now = Pair(i, j, number, a, b), pairs.touched[number], 0
        s, t, skew, inside = between_ends(apart, a, b, half)
        r = gap_vector(apart, a, b, s, t)
        nearest, clear = dot(r, r), False
        if inside:
            margin = half - max(abs(s), abs(t))
            clear = nearest >= 1.0 or margin * margin * skew >= max(SHARED, 1.0 - nearest)
        if not clear:
            ends = end_gaps(apart, a, b, half)
            least = min(ends[0][3], ends[1][3], ends[2][3], ends[3][3])
            if least < 1.0 or was & ENDS:
                now, deep, n = ends_met(effects, state, pair, ends, was, n, dt)
                if deep:
                    return k
        elif was & ENDS:
            for end in range(4):
                forget(springs, number, end)
        if inside and nearest < 1.0:
            if nearest < (1.0 - DEEP) ** 2:
                return k
            now |= BETWEEN_ENDS
            share, near = 1.0, Closest(s, t, r, sqrt(nearest))
            if not clear and least < (near.distance + NEARER) ** 2:
                share = shared(between.normal, state.scratch, pair, near, ends)
            n = collect(state, n, pair, near, share, CROSSING)
        elif was & BETWEEN_ENDS:
            forget(springs, number, CROSSING)
        if not clear:
            nearest = min(nearest, least) if inside else least
        pairs.touched[number] = now
        if nearest > 1.0:  # each of the two may come half of the gap closer
            pairs.asleep[k] = travelled + 0.5 * (sqrt(nearest) - 1.0)
        if n >= MOST:
            n = acted(between, effects, state, n, dt)
    acted(between, effects, state, n, dt)
    return -1


@kernel
def between_rods(between, effects, state, dt):
    """Pair forces from a list kept up to date; why the run cannot go on, and where."""
    if between is None:
        return DONE, 0
    if state.pairs.travelled[0] >= 0.5 * SKIN:
        list_pairs(state.rods, effects.half_length, state.pairs)
    deep = pair_forces(between, effects, state, dt)
    return (DONE, 0) if deep < 0 else (PAIR_TOO_DEEP, deep)
