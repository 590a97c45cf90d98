"""Which rods may touch: a list that misses none, built in time linear in their number.

The list holds every pair whose axes come closer than 1 + SKIN; it is built again before any point
of an axis has moved by half of SKIN. A bound on that, the sum of the largest speeds, saves looking
at every rod in every step. Rods are sorted along the box, or by azimuth around an annulus. A
periodic box repeats the closest points, not the centres: an entry is a pair with the image of its
second rod, so that two rods of a short box may stand in the list several times, and a rod beside
its own image.

What cannot touch is not looked at: a pair and an end of a touching pair sleep until rods may have
travelled half of their gap.
"""

from typing import NamedTuple

import numpy as np

from ..cache import kernel
from .codes import COSINE, DEEP, SINE, SKIN, X, Z

PAIR = 4  # column of `Listed.asleep`, after those of the four ends
CHORD = 0.4142  # less than sqrt(2) - 1


class Listed(NamedTuple):
    """The list in use stands at `turn[0]` along the first axis, the one before it at the other.

    Entries are sorted by first rod; those of rod i stand in `start[i]:start[i + 1]`.
    """

    turn: np.ndarray  # (1,): 0 or 1
    travelled: np.ndarray  # (1,), d: how far any rod may have moved since the list was built
    start: np.ndarray  # (2, rods + 1)
    # (capacity, 5), d: until rods may have travelled so far, an end or the pair does not touch
    asleep: np.ndarray
    # (2, capacity, 4): first rod, second >= first, image of the second: its x plus so many
    # periods, whether they touch
    index: np.ndarray  # type: ignore[assignment]
    # (2, capacity, 4): first rod's lower and upper end, second rod's; in space (.., PAIR_SLOTS, 3)
    springs: np.ndarray | None
    # (2, capacity, 8), m g: F_n and F_t a step before, end by end; in space (.., PAIR_SLOTS, 4)
    forces: np.ndarray
    built: np.ndarray  # (rods, 4): place and direction of the rods when the list was built
    order: np.ndarray  # (rods,): by place in the box, or by azimuth


def nothing_listed(
    rods: int, capacity: int, springs: bool, kept: tuple[tuple[int, ...], ...] = ((8,), (4,))
) -> Listed:
    """A list that is out of date; `kept`: numbers of an entry's forces and springs."""
    forces, lengths = kept
    return Listed(
        np.zeros(1, np.int64),
        np.full(1, np.inf),
        np.zeros((2, rods + 1), np.int64),
        np.zeros((capacity, 5)),
        np.zeros((2, capacity, 4), np.int64),
        np.zeros((2, capacity, *lengths)) if springs else None,
        np.zeros((2, capacity, *forces)),
        np.full((rods, 4), 1e300),  # far away; inf times no length would be nan
        np.arange(rods),
    )


@kernel
def span(period):
    """Length after which the box repeats."""
    if period is None:
        return np.inf
    return period


@kernel
def meetings(upper):
    """Contacts that two rods may have: one at each of their ends; two spheres have one."""
    if upper is None:
        return 1
    return 4


@kernel
def places(dx, dz, a, b, half, end):
    """Places s, t along both axes of the contact at one of four ends, 0 and 1 the first rod's.

    `dx`, `dz` lead from the second centre to the first; `a`, `b` are the rods' directions.
    """
    across = a[0] * b[0] + a[1] * b[1]
    side = half if end & 1 else -half
    if end < 2:
        return side, min(max(dx * b[0] + dz * b[1] + side * across, -half), half)
    return min(max(side * across - (dx * a[0] + dz * a[1]), -half), half), side


@kernel
def apart(dx, dz, a, b, s, t):
    """Vector from a place on the second axis to one on the first."""
    return dx + s * a[0] - t * b[0], dz + s * a[1] - t * b[1]


@kernel
def gap(dx, dz, a, b, half, end):
    """Places of the contact at one end, vector between them, its square."""
    s, t = places(dx, dz, a, b, half, end)
    r_x, r_z = apart(dx, dz, a, b, s, t)
    return s, t, r_x, r_z, r_x * r_x + r_z * r_z


@kernel
def clearance(dx, dz, a, b, half):
    """How far beyond 1 all of the second axis is off the first one's line: a quick bound."""
    off = abs(dx * a[1] - dz * a[0])
    return off - half * abs(a[0] * b[1] - a[1] * b[0]) - 1.0


@kernel
def open_at_least(square):
    """A lower bound of a distance beyond 1, given its square >= 1: a chord of the root."""
    return CHORD * (min(square, 2.0) - 1.0)


@kernel
def nearest_squared(dx, dz, a, b, half):
    """Squared distance of two axes that do not cross."""
    least = np.inf
    for end in range(4):
        s, t = places(dx, dz, a, b, half, end)
        r_x, r_z = apart(dx, dz, a, b, s, t)
        least = min(least, r_x * r_x + r_z * r_z)
    return least


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
    return 0 if period is None else int(np.round(distance / period))


@kernel(inline=False)
def pair_up(rods, half, period, order, place, found):
    """All pairs of axes closer than 1 + SKIN, into `found`; their number, -1 if there are more."""
    n, count, box = rods.shape[0], 0, span(period)
    for p in range(n):
        i = order[p]
        q, ahead = p, 0.0
        while True:
            q += 1
            if q == n:
                q, ahead = 0, ahead + box
            j = order[q]
            gap = place[j] - place[i] + ahead
            if not gap <= 2 * half + 1 + SKIN:
                break
            dz = rods[i, Z] - rods[j, Z]
            a, b = (rods[i, SINE], rods[i, COSINE]), (rods[j, SINE], rods[j, COSINE])
            if nearest_squared(-gap, dz, a, b, half) >= (1 + SKIN) ** 2:
                continue
            if count == found.shape[0]:
                return -1
            shift = image(gap - rods[j, X] + rods[i, X], period)
            found[count, 0], found[count, 1] = min(i, j), max(i, j)
            found[count, 2] = shift if i <= j else -shift
            count += 1
    return count


@kernel
def carry(kept, old, before, new, k):
    """Take over what an entry kept; nothing if there was none."""
    if kept is not None:
        for c in range(kept.shape[2]):
            if kept.ndim == 3:
                kept[new, k, c] = kept[old, before, c] if before >= 0 else 0.0
            else:
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
def build(rods, half, period, listed, place, found):
    """Renew the list of a row; number of entries, -1 if they are too many.

    `place`, (rods,), and `found`, (capacity, 3), are scratch.
    """
    n = rods.shape[0]
    for i in range(n):
        place[i] = wrapped(rods[i, X], period)
    sort_along(listed.order, place)
    count = pair_up(rods, half, period, listed.order, place, found)
    if count >= 0:
        listed_anew(n, listed, found, count)
        for i in range(n):
            for c in range(4):
                listed.built[i, c] = rods[i, c]
    return count


@kernel(inline=False)
def farthest(rods, built, half):
    """How far any point of an axis has moved since the list was built, or somewhat more."""
    far = 0.0
    for i in range(rods.shape[0]):
        dx, dz = rods[i, X] - built[i, X], rods[i, Z] - built[i, Z]
        turn = abs(rods[i, SINE] - built[i, SINE]) + abs(rods[i, COSINE] - built[i, COSINE])
        far = max(far, abs(dx) + abs(dz) + half * turn)
    return far


@kernel
def current(rods, half, period, listed, place, found):
    """Renew the list if it may miss a pair; whether it holds all. All its pairs are awake then."""
    if listed.travelled[0] < 0.5 * SKIN:
        return True
    listed.asleep[:] = 0.0
    listed.travelled[0] = farthest(rods, listed.built, half)
    if listed.travelled[0] < 0.5 * SKIN:
        return True
    return build(rods, half, period, listed, place, found) >= 0


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
