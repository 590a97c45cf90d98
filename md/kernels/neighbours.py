"""Closest points of rods, and which rods may touch, compiled.

A rod's axis is the segment of all centre + s director, |s| <= half. Each of the four ends of two
rods, 0 and 1 of the first, 2 and 3 of the second, has a closest point on the other axis, and is a
contact of its own. Rods that cross in space are closest between their ends.

The list of pairs holds every pair whose axes are closer than 1 + SKIN. It is built again before any
point of an axis has moved by half of SKIN, so that it misses no pair. A bound on that motion, the
sum of the largest speeds, saves looking at every rod in every step. Rods are sorted along the box,
in space by azimuth around the annulus. A periodic box repeats the closest points, not the centres:
an entry is a pair with the image of its second rod, so that two rods of a short box may stand in
the list several times, and a rod beside its own image.

What cannot touch is not looked at: a pair and an end of a touching pair sleep until rods may have
travelled half of their gap.
"""

from math import asin, atan2, pi, sqrt
from typing import Any, NamedTuple

import numpy as np

from ..cache import kernel
from . import DEEP, SKIN
from .contact import Memory
from .vectors import along, dot, vector

CHORD = 0.4142  # < sqrt(2) - 1: of the square root between 1 and 2, so a bound from below


class Axes(NamedTuple):
    """Axes of two rods, and how they lie."""

    apart: tuple  # d; from the second centre to the first
    a: tuple  # director of the first rod
    b: tuple  # director of the second rod


class Near(NamedTuple):
    """Point on each axis of two rods, and the distance of the points."""

    s: float  # d; from the first centre
    t: float  # d; from the second
    gap: tuple  # d; from the second place to the first
    square: float  # d^2; of the gap


@kernel
def near_at(axes, s, t):
    """`Near` of the point s on the first axis and the point t on the second."""
    gap = along(along(axes.apart, s, axes.a), -t, axes.b)
    return Near(s, t, gap, dot(gap, gap))


@kernel
def near_end(axes, half, end):
    """`Near` of the contact at one of the four ends of two rods."""
    apart, a, b = axes
    across, side = dot(a, b), half if end & 1 else -half
    if end < 2:
        s, t = side, min(max(dot(apart, b) + side * across, -half), half)
    else:
        s, t = min(max(side * across - dot(apart, a), -half), half), side
    return near_at(axes, s, t)


@kernel
def between_ends(axes, half):
    """`Near` of two lines' closest points, whether both lie on the rods, sin^2 of the lines' angle.

    The lines carry the rods' axes. Where they are nearly parallel the second point may be far off;
    the first is the nearest to it, so that their distance is hardly wrong.
    """
    apart, a, b = axes
    across = dot(a, b)
    skew = 1.0 - across * across
    if skew < 1e-12:
        return Near(0.0, 0.0, apart, np.inf), False, 0.0
    p, q = dot(apart, a), dot(apart, b)
    t = (q - across * p) / skew
    s = across * t - p
    return near_at(axes, s, t), abs(s) < half and abs(t) < half, skew


@kernel
def nearest(axes, half):
    """Squared distance of two axes, d^2; in the plane they do not cross."""
    least = np.inf
    for end in range(4):
        least = min(least, near_end(axes, half, end).square)
    if len(axes.a) == 3:
        near, inside, _ = between_ends(axes, half)
        if inside:
            least = min(least, near.square)
    return least


@kernel
def clearance(axes, half):
    """Quick lower bound of the distance of two axes beyond 1, d; negative where there is no bound.

    In the plane it is the distance of the second axis from the first one's line.
    """
    apart, a, b = axes
    if len(a) == 2:
        off = abs(apart[0] * a[1] - apart[1] * a[0])
        return off - half * abs(a[0] * b[1] - a[1] * b[0]) - 1.0
    near, inside, _ = between_ends(axes, half)
    return sqrt(near.square) - 1.0 if inside else -1.0


PAIR = 5  # column of the pair in `Listed.asleep`, after the four ends and the contact between them


class Listed(NamedTuple):
    """List of pairs that may touch; of two copies `turn[0]` is in use, the other the last one.

    Pairs are sorted by first rod; those of rod i are `start[i]:start[i + 1]`. Pair k has the entry
    2 k + `turn[0]`. It has a contact at each of four ends, and in space one between them.
    """

    turn: np.ndarray  # (1,): 0 or 1
    travelled: np.ndarray  # (1,), d: how far any rod may have moved since the list was built
    start: np.ndarray  # (2, rods + 1)
    # (capacity, 6), d: a contact or the pair does not touch until rods may have travelled this far
    asleep: np.ndarray
    # (entries, 4): first rod; second rod >= first; image of the second, in periods added to its x;
    # what of them touches
    index: np.ndarray  # type: ignore[assignment]
    memory: Memory  # of the contacts of all entries, as `row_of` says
    built: np.ndarray  # (rods, 4), in space 6: centre and director when the list was built
    order: np.ndarray  # (rods,): by place in the box, or by azimuth


def new_memory(contacts: int, part: int, forces: Any, springs: Any) -> Memory:
    """Create an empty memory; `part`: numbers of a tangential part; forces, springs: if any."""
    return Memory(
        np.zeros((contacts, 1 + part)) if forces else None,
        np.zeros((contacts, part)) if springs else None,
    )


def nothing_listed(rods: int, capacity: int, springs: bool, space: bool) -> Listed:
    """Create a list of pairs that is empty and out of date."""
    part, dimensions = (3, 3) if space else (1, 2)
    return Listed(
        np.zeros(1, np.int64),
        np.full(1, np.inf),
        np.zeros((2, rods + 1), np.int64),
        np.zeros((capacity, PAIR + 1)),
        np.zeros((2 * capacity, 4), np.int64),
        new_memory(2 * capacity * (2 + dimensions), part, True, springs),
        np.full((rods, 2 * dimensions), 1e300),  # far away; inf times a zero length would be nan
        np.arange(rods),
    )


@kernel
def row_of(up, entry, slot):
    """Row of a contact in the memory of a list; `slot`: which one of its entry."""
    return (2 + len(up)) * entry + slot


@kernel(inline=False)
def sort_along(order, place):
    """Sort the rods in `order` by `place`; linear if little has changed since the last time."""
    for p in range(1, order.size):
        i = order[p]
        key, q = place[i], p - 1
        while q >= 0 and place[order[q]] > key:
            order[q + 1] = order[q]
            q -= 1
        order[q + 1] = i


@kernel
def place_along(centre, period):
    """Coordinate by which rods are sorted: the place in the box, in space the azimuth."""
    if len(centre) == 3:
        return atan2(centre[1], centre[0])
    if period is None:
        return centre[0]
    return centre[0] - np.floor(centre[0] / period) * period


@kernel
def around(up, period):
    """Period of the sorting coordinate: 2 pi in space, length of the box in the plane, or inf."""
    if len(up) == 3:
        return 2.0 * pi
    if period is None:
        return np.inf
    return period


@kernel
def window(up, rods, reach):
    """Largest difference of sorting coordinates of rods with centres closer than `reach`."""
    if len(up) == 2:
        return reach
    least = np.inf
    for i in range(rods.shape[0]):
        least = min(least, rods[i, 0] ** 2 + rods[i, 1] ** 2)
    if 4.0 * least <= reach * reach:
        return pi
    return 2.0 * asin(reach / (2.0 * sqrt(least)))


@kernel
def apart_by(centre, other, gap, period):
    """Vector from the second centre or its image to the first, and that image in periods.

    `gap`: difference of the sorting coordinates.
    """
    apart = along(centre, -1.0, other)
    if len(centre) == 3:
        return apart, 0
    if period is None:
        return (-gap, apart[1]), 0
    return (-gap, apart[1]), int(np.floor((gap + apart[0]) / period + 0.5))


@kernel(inline=False)
def pair_up(up, rods, half, period, order, place, found):
    """Find all pairs of axes closer than 1 + SKIN; return how many, or -1 if too many.

    `found` is filled with them: both rods, and the image of the second.
    """
    n, count, box, reach = rods.shape[0], 0, around(up, period), 2 * half + 1 + SKIN
    for i in range(n):
        place[i] = place_along(vector(rods, i, 0, up), period)
    sort_along(order, place)
    most = window(up, rods, reach)
    for p in range(n):
        i = order[p]
        q, ahead = p, 0.0
        while True:
            q += 1
            if q == n:
                q, ahead = 0, ahead + box
            j = order[q]
            gap = place[j] - place[i] + ahead
            if not gap <= most:
                break
            x, y = vector(rods, i, 0, up), vector(rods, j, 0, up)
            a, b = vector(rods, i, len(x), up), vector(rods, j, len(x), up)
            apart, shift = apart_by(x, y, gap, period)
            axes = Axes(apart, a, b)
            if dot(apart, apart) >= reach * reach or nearest(axes, half) >= (1 + SKIN) ** 2:
                continue
            if len(up) == 3 and gap == box / 2 and i > j:  # found from the other one
                continue
            if count == found.shape[0]:
                return -1
            found[count, 0], found[count, 1] = min(i, j), max(i, j)
            found[count, 2] = shift if i <= j else -shift
            count += 1
    return count


@kernel
def carry(up, kept, entry, before):
    """Copy forces or springs of an entry from the entry `before`; zeros if it is -1."""
    if kept is not None:
        row, last = row_of(up, entry, 0), row_of(up, before, 0)
        for c in range(2 + len(up)):
            for d in range(kept.shape[1]):
                kept[row + c, d] = kept[last + c, d] if before >= 0 else 0.0


@kernel(inline=False)
def rebuilt(up, n, listed, found, count):
    """Rebuild the list of n rods from the pairs `found`; entries keep their forces and springs."""
    old = listed.turn[0]
    new, start, index = 1 - old, listed.start, listed.index
    for i in range(n + 1):
        start[new, i] = 0
    for m in range(count):
        start[new, found[m, 0]] += 1
    total = 0
    for i in range(n + 1):  # where the entries of rod i end, counted down below to where they begin
        total += start[new, i]
        start[new, i] = total
    for m in range(count - 1, -1, -1):
        i = found[m, 0]
        start[new, i] -= 1
        k, before = 2 * start[new, i] + new, -1
        for c in range(3):
            index[k, c] = found[m, c]
        index[k, 3] = 0
        for o in range(2 * start[old, i] + old, 2 * start[old, i + 1], 2):
            if index[o, 1] == found[m, 1] and index[o, 2] == found[m, 2]:
                before, index[k, 3] = o, index[o, 3]
        carry(up, listed.memory.springs, k, before)
        carry(up, listed.memory.forces, k, before)
    listed.turn[0] = new
    listed.travelled[0] = 0.0


@kernel(inline=False)
def farthest(rods, built, half):
    """Upper bound of how far any point of an axis has moved since the list was built, d."""
    far, n = 0.0, built.shape[1] // 2
    for i in range(rods.shape[0]):
        moved, turned = 0.0, 0.0
        for c in range(n):
            moved += abs(rods[i, c] - built[i, c])
            turned += abs(rods[i, n + c] - built[i, n + c])
        far = max(far, moved + half * turned)
    return far


@kernel(inline=False)
def renewed(up, rods, half, period, listed, place, found):
    """Rebuild the list if it may miss a pair, and wake all pairs; return whether it holds all.

    `place`, (rods,), and `found`, (capacity, 3), are scratch.
    """
    for k in range(listed.asleep.shape[0]):
        for c in range(PAIR + 1):
            listed.asleep[k, c] = 0.0
    listed.travelled[0] = farthest(rods, listed.built, half)
    if not outdated(listed):
        return True
    count = pair_up(up, rods, half, period, listed.order, place, found)
    if count >= 0:
        rebuilt(up, rods.shape[0], listed, found, count)
        for i in range(rods.shape[0]):
            for c in range(2 * len(up)):
                listed.built[i, c] = rods[i, c]
    return count >= 0


@kernel
def outdated(listed):
    """Whether the list may miss a pair, as rods may have moved by half of SKIN."""
    return listed.travelled[0] >= 0.5 * SKIN


@kernel
def too_fast(between, listed, distance):
    """Add how far rods may have moved in a step; return whether two may have passed unseen.

    An end is stopped within DEEP on either side of an axis; two rods that move half of DEEP each
    do not leap over that.
    """
    if between is None:
        return False
    listed.travelled[0] += distance
    return distance > 0.5 * DEEP
