"""Pairs of rods in space, compiled: which may touch, and the forces between them."""

from math import asin, atan2, pi, sqrt
from typing import NamedTuple

import numpy as np

from ...cache import kernel
from ..batch import MOST
from ..codes import (
    CROSSING,
    DEEP,
    DIRECTOR,
    DONE,
    FULL_LIST,
    PAIR_TOO_DEEP,
    PLACE,
    SKIN,
)
from ..joints import joint
from ..neighbours import listed_anew, sort_along
from ..vectors import add, along, cross, dot, put, times, vector
from .batch import acted, collect
from .forces import opened
from .geometry import NEARER, at_end, between_ends, gap_vector, rise

ENDS, BETWEEN_ENDS = 1, 2  # bits: what of two rods touches
SHARED = (1 + NEARER) ** 2 - 1  # squared lever beyond which no end shares a contact between ends


class Pair(NamedTuple):
    """Two rods."""

    i: np.uint64
    j: np.uint64
    entry: np.uint64  # of the list
    a: tuple[float, float, float]  # director of the first
    b: tuple[float, float, float]


class Closest(NamedTuple):
    """Closest points of the axes of two rods, or of an end of one and the axis of the other."""

    s: float  # d; place on the first axis, from its centre
    t: float  # d; on the second
    gap: tuple[float, float, float]  # d; from the second place to the first
    distance: float  # d


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


@kernel
def window(rods, reach):
    """Azimuths farther apart than that belong to centres more than `reach` apart."""
    least = np.inf
    for i in range(rods.shape[0]):
        least = min(least, rods[i, PLACE] ** 2 + rods[i, PLACE + 1] ** 2)
    if 4.0 * least <= reach * reach:
        return pi
    return 2.0 * asin(reach / (2.0 * sqrt(least)))


@kernel(inline=False)
def pair_up(rods, half, order, place, found):
    """All pairs of axes closer than 1 + SKIN, into `found`; their number, -1 if there are more."""
    n, count, reach = rods.shape[0], 0, 2.0 * half + 1.0 + SKIN
    for i in range(n):
        place[i] = atan2(rods[i, PLACE + 1], rods[i, PLACE])
    sort_along(order, place)
    most = window(rods, reach)
    for p in range(n):
        i = order[p]
        for step in range(1, n):
            q = p + step
            ahead = 0.0 if q < n else 2.0 * pi
            j = order[q if q < n else q - n]
            gap = place[j] - place[i] + ahead
            if gap > most:
                break
            if gap == pi and i > j:  # found from the other one
                continue
            apart = along(vector(rods, i, PLACE), -1.0, vector(rods, j, PLACE))
            if dot(apart, apart) >= reach * reach:
                continue
            if (
                nearest(apart, vector(rods, i, DIRECTOR), vector(rods, j, DIRECTOR), half)
                < 1.0 + SKIN
            ):
                if count == found.shape[0]:
                    return -1
                found[count, 0], found[count, 1], found[count, 2] = min(i, j), max(i, j), 0
                count += 1
    return count


@kernel
def current(rods, half, listed, place, found):
    """Renew the list if it may miss a pair; whether it holds all."""
    if listed.travelled[0] < 0.5 * SKIN:
        return True
    count = pair_up(rods, half, listed.order, place, found)
    if count < 0:
        return False
    listed_anew(rods.shape[0], listed, found, count)
    listed.asleep[:] = 0.0
    return True


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
def one_spring(springs, now, k, end, other, first, second):
    """Keep one spring at the contacts of two ends where one has no foot of its own."""
    if springs is None or (first > 0.0 and second > 0.0):
        return
    own = springs[now, k]
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
    total = state.scratch.total
    s, foot, gap, _ = ends[end]
    other = 3 if foot > 0.0 else 2
    back, t, second_gap, _ = ends[other]
    first, second, across = abs(t - foot), abs(s - back), along(gap, foot - t, pair.b)
    met = joint(dot(across, across), first, second)
    listed = state.listed
    one_spring(listed.springs, listed.turn[0], pair.entry, end, other, first, second)
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
                opened(state.listed, pair.entry, end)
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
def pair_forces(between, effects, state, ledger, dt):
    """Forces of all listed pairs; number of a pair that is too deep, or -1.

    Where two axes are closest between their ends, by so much that no end can touch or share the
    contact, the ends need no look.
    """
    rods, listed, half = state.rods, state.listed, effects.half_length
    travelled, now, index, n = listed.travelled[0], listed.turn[0], listed.index, 0
    for k in range(listed.start[now, rods.shape[0]]):
        if travelled < listed.asleep[k, 0]:
            continue
        i, j = np.uint64(index[now, k, 0]), np.uint64(index[now, k, 1])  # never negative
        apart = along(vector(rods, i, PLACE), -1.0, vector(rods, j, PLACE))
        a, b = vector(rods, i, DIRECTOR), vector(rods, j, DIRECTOR)
        pair, was, touches = Pair(i, j, np.uint64(k), a, b), index[now, k, 3], 0
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
                touches, deep, n = ends_met(effects, state, pair, ends, was, n, dt)
                if deep:
                    return k
        elif was & ENDS:
            for end in range(4):
                opened(listed, k, end)
        if inside and nearest < 1.0:
            if nearest < (1.0 - DEEP) ** 2:
                return k
            touches |= BETWEEN_ENDS
            share, near = 1.0, Closest(s, t, r, sqrt(nearest))
            if not clear and least < (near.distance + NEARER) ** 2:
                share = shared(between.normal, state.scratch.total, pair, near, ends)
            n = collect(state, n, pair, near, share, CROSSING)
        elif was & BETWEEN_ENDS:
            opened(listed, k, CROSSING)
        if not clear:
            nearest = min(nearest, least) if inside else least
        index[now, k, 3] = touches
        if nearest > 1.0:  # each of the two may come half of the gap closer
            listed.asleep[k, 0] = travelled + 0.5 * (sqrt(nearest) - 1.0)
        if n >= MOST:
            n = acted(between, effects, state, ledger, n, dt)
    acted(between, effects, state, ledger, n, dt)
    return -1


@kernel
def between_rods(between, effects, state, ledger, dt):
    """Pair forces from a list kept up to date; why the run cannot go on, and where."""
    if between is None:
        return DONE, 0
    listed, scratch = state.listed, state.scratch
    if not current(state.rods, effects.half_length, listed, scratch.place, scratch.found):
        return FULL_LIST, 0
    deep = pair_forces(between, effects, state, ledger, dt)
    return (DONE, 0) if deep < 0 else (PAIR_TOO_DEEP, deep)
