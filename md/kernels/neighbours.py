"""Which rods may touch: a list that misses none, built in time linear in their number.

The list holds every pair whose axes come closer than 1 + SKIN; it is built again before any point
of an axis has moved by half of SKIN. A bound on that, the sum of the largest speeds, saves looking
at every rod in every step. Rods are sorted along the box, in space by azimuth around the annulus. A
periodic box repeats the closest points, not the centres: an entry is a pair with the image of its
second rod, so that two rods of a short box may stand in the list several times, and a rod beside
its own image.

What cannot touch is not looked at: a pair and an end of a touching pair sleep until rods may have
travelled half of their gap.
"""

from math import asin, atan2, pi, sqrt
from typing import NamedTuple

import numpy as np

from ..cache import kernel
from .closest import nearest
from .codes import DEEP, SKIN
from .vectors import along, dot, vector

PAIR = 5  # column of `Listed.asleep`, after those of the four ends and of what is between


class Listed(NamedTuple):
    """The list in use stands at `turn[0]` along the first axis, the one before it at the other.

    Entries are sorted by first rod; those of rod i stand in `start[i]:start[i + 1]`. A pair has a
    contact at each of four ends, and in space one between them.
    """

    turn: np.ndarray  # (1,): 0 or 1
    travelled: np.ndarray  # (1,), d: how far any rod may have moved since the list was built
    start: np.ndarray  # (2, rods + 1)
    # (capacity, 6), d: until rods may have travelled so far, a contact or the pair does not touch
    asleep: np.ndarray
    # (2, capacity, 4): first rod, second >= first, image of the second: its x plus so many
    # periods, whether they touch
    index: np.ndarray  # type: ignore[assignment]
    springs: np.ndarray | None  # (2, capacity, contacts, part), d: part across the normal, 1 or 3
    forces: np.ndarray  # (2, capacity, contacts, 1 + part), m g: F_n and F_t a step before
    built: np.ndarray  # (rods, 4), in space 6: centre and director when the list was built
    order: np.ndarray  # (rods,): by place in the box, or by azimuth


def nothing_listed(rods: int, capacity: int, springs: bool, space: bool) -> Listed:
    """A list that is out of date."""
    contacts, part, dimensions = (5, 3, 3) if space else (4, 1, 2)
    return Listed(
        np.zeros(1, np.int64),
        np.full(1, np.inf),
        np.zeros((2, rods + 1), np.int64),
        np.zeros((capacity, 6)),
        np.zeros((2, capacity, 4), np.int64),
        np.zeros((2, capacity, contacts, part)) if springs else None,
        np.zeros((2, capacity, contacts, 1 + part)),
        np.full((rods, 2 * dimensions), 1e300),  # far away; inf times no length would be nan
        np.arange(rods),
    )


@kernel(inline=False)
def sort_along(order, place):
    """Sort by place; linear where little has changed since the last time."""
    for p in range(1, order.size):
        i = order[p]
        key, q = place[i], p - 1
        while q >= 0 and place[order[q]] > key:
            order[q + 1] = order[q]
            q -= 1
        order[q + 1] = i


@kernel
def wrapped(x, period):
    """Place in the box."""
    return x if period is None else x - np.floor(x / period) * period


@kernel
def image(distance, period):
    """How many periods a distance between a rod and an image holds beyond that of the rods."""
    return 0 if period is None else int(np.floor(distance / period + 0.5))


@kernel
def place_along(centre, period):
    """What rods are sorted by: the place in the box, in space the azimuth."""
    if len(centre) == 2:
        return wrapped(centre[0], period)
    return atan2(centre[1], centre[0])


@kernel
def around(up, period):
    """Distance after which the rods come again."""
    if len(up) == 3:
        return 2.0 * pi
    if period is None:
        return np.inf
    return period


@kernel
def window(up, rods, reach):
    """So far apart in that order are rods whose centres are more than `reach` apart."""
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
    """From the second centre to the first, and how many periods the second's image is away."""
    apart = along(centre, -1.0, other)
    if len(centre) == 2:
        return (-gap, apart[1]), image(gap + apart[0], period)
    return apart, 0


@kernel(inline=False)
def pair_up(up, rods, half, period, order, place, found):
    """All pairs of axes closer than 1 + SKIN, into `found`; their number, -1 if there are more."""
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
            if dot(apart, apart) >= reach * reach or nearest(apart, a, b, half) >= (1 + SKIN) ** 2:
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
def carry(kept, old, before, new, k):
    """Take over what an entry kept; nothing if there was none."""
    if kept is not None:
        for c in range(kept.shape[2]):
            for d in range(kept.shape[3]):
                kept[new, k, c, d] = kept[old, before, c, d] if before >= 0 else 0.0


@kernel(inline=False)
def listed_anew(n, listed, found, count):
    """Renew the list of n rods by the pairs `found`, with what its entries keep."""
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
        k = start[new, i]
        for c in range(3):
            index[new, k, c] = found[m, c]
        before, index[new, k, 3] = -1, 0
        for o in range(start[old, i], start[old, i + 1]):
            if index[old, o, 1] == found[m, 1] and index[old, o, 2] == found[m, 2]:
                before, index[new, k, 3] = o, index[old, o, 3]
        carry(listed.springs, old, before, new, k)
        carry(listed.forces, old, before, new, k)
    listed.turn[0] = new
    listed.travelled[0] = 0.0


@kernel(inline=False)
def farthest(rods, built, half):
    """How far any point of an axis has moved since the list was built, or somewhat more."""
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
    """Renew the list if it may miss a pair; whether it holds all. All its pairs are awake then.

    `place`, (rods,), and `found`, (capacity, 3), are scratch.
    """
    listed.asleep[:] = 0.0
    listed.travelled[0] = farthest(rods, listed.built, half)
    if not outdated(listed):
        return True
    count = pair_up(up, rods, half, period, listed.order, place, found)
    if count >= 0:
        listed_anew(rods.shape[0], listed, found, count)
        for i in range(rods.shape[0]):
            for c in range(listed.built.shape[1]):
                listed.built[i, c] = rods[i, c]
    return count >= 0


@kernel
def outdated(listed):
    """Whether the list may miss a pair, unless rods have moved less than they might have."""
    return listed.travelled[0] >= 0.5 * SKIN


@kernel
def too_fast(between, listed, distance):
    """Note how far rods have moved in a step; whether two may have passed each other unseen.

    An end is stopped within DEEP on either side of an axis; two rods that move half of DEEP each
    do not leap over that.
    """
    if between is None:
        return False
    listed.travelled[0] += distance
    return distance > 0.5 * DEEP
