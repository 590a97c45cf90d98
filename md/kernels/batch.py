"""Contacts of rods with each other, or with a wall, computed side by side.

The contacts of a step are collected first, in an array for each number, and their forces computed
in a loop without a branch or an index that depends on data: the compiler puts several contacts
into one instruction. Then the forces are added to the rods, in the order of collection.
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from ..cache import kernel
from .contact import Inertia, Kept, Meeting, contact
from .state import keep, kept_of, pull
from .vectors import along, dot, nothing, nothing_across, put, spread, times

SIZE = 64  # contacts; fixed, so that the compiler knows how far apart numbers lie
MOST = SIZE - 8  # contacts collected at most before the next pair or rod is looked at
WIDTH = 4  # contacts that one instruction holds

# Numbers of a contact, three of them for each vector. Input:
GAP = 0  # 1 - overlap along the normal
ARM, OTHER_ARM = 3, 6  # from both centres to the contact point
DIRECTOR, OTHER_DIRECTOR = 9, 12  # in space
HALF, GAIN = 15, 18  # velocity of the first rod against the other half a step before; acceleration
SHARE = 21  # weight of the contact, 0 to 1, if several are one
# Kept, of the step before, then of this one, for a contact of the weight 1:
PRESSED, RUB, SPRING = 22, 23, 26  # F_n, F_t, length of the spring
# Results:
FORCE = 29  # on the first rod
LOST = 32  # in this step: in the normal dashpot, and by friction
NUMBERS = 34

ONE, TWO = (1,), (1, 1)  # number of rods of a contact, as the length of a tuple


class Batch(NamedTuple):
    """Contacts collected in a step."""

    numbers: np.ndarray  # (NUMBERS SIZE,): SIZE values of each number
    place: np.ndarray  # (SIZE, 3): both rods, row of the memory


class Given(NamedTuple):
    """Contact that is to be computed, before it is stored in a batch."""

    where: tuple  # both rods, of a wall twice the one; row of the memory
    gap: tuple  # d; 1 - overlap along the normal
    bodies: tuple  # this and the next two: as in `contact.Meeting`
    half: tuple
    gain: tuple
    share: float  # weight of the contact, 0 to 1


class Alike(NamedTuple):
    """Parameters that all contacts of a batch share."""

    law: Any  # `normal` and `friction`
    rods: tuple  # `ONE` at a wall, or `TWO`
    inertia: Inertia
    up: tuple  # unit vector upwards: of two numbers in the plane, of three in space
    column: int  # of the ledger, for losses in normal dashpots; the next one, by friction


def no_contacts() -> Batch:
    """Create an empty batch."""
    return Batch(np.ones(NUMBERS * SIZE), np.zeros((SIZE, 3), np.int64))


@kernel
def get(numbers, what, c):
    """Number `what` of contact c.

    The index is unsigned, so that it needs no check for a negative one.
    """
    return numbers[np.uint64(what * SIZE + c)]


@kernel
def get_vector(numbers, what, c, like):
    """Vector of contact c, from number `what` on; as many components as `like`."""
    if len(like) == 1:
        return (get(numbers, what, c),)
    if len(like) == 2:
        return get(numbers, what, c), get(numbers, what + 1, c)
    return get(numbers, what, c), get(numbers, what + 1, c), get(numbers, what + 2, c)


@kernel
def fill(numbers, what, c, v):
    """Store a vector of contact c, from number `what` on."""
    for k in range(len(v)):
        numbers[np.uint64((what + k) * SIZE + c)] = v[k]


@kernel
def get_kept(numbers, c, up):
    """`Kept` of contact c, as for the weight 1."""
    part = nothing_across(up)
    rub, spring = get_vector(numbers, RUB, c, part), get_vector(numbers, SPRING, c, part)
    return Kept(get(numbers, PRESSED, c), rub, spring)


@kernel
def fill_kept(numbers, c, kept):
    """Store the `Kept` of contact c, as for the weight 1."""
    fill(numbers, PRESSED, c, (kept.force,))
    fill(numbers, RUB, c, kept.rub)
    fill(numbers, SPRING, c, kept.spring)


@kernel
def enter(batch, n, given, memory, up):
    """Store a contact at place n, with what the memory has of it; return the contact count."""
    numbers, place = batch
    put(place, np.uint64(n), 0, given.where)
    fill(numbers, GAP, n, given.gap)
    for rod in range(len(given.bodies)):
        arm, director = given.bodies[rod]
        fill(numbers, ARM + 3 * rod, n, arm)
        if len(arm) == 3:
            fill(numbers, DIRECTOR + 3 * rod, n, director)
    fill(numbers, HALF, n, given.half)
    fill(numbers, GAIN, n, given.gain)
    fill(numbers, SHARE, n, (given.share,))
    fill_kept(numbers, n, kept_of(up, memory, given.where[2]))
    return n + 1


@kernel
def bodies_of(rods, numbers, c, up):
    """Arm and director of each rod of contact c; `rods`: `ONE` or `TWO`."""
    first = get_vector(numbers, ARM, c, up), get_vector(numbers, DIRECTOR, c, up)
    if len(rods) == 1:
        return (first,)
    second = get_vector(numbers, OTHER_ARM, c, up), get_vector(numbers, OTHER_DIRECTOR, c, up)
    return first, second


@kernel
def act_on(alike, ledger, numbers, c, dt):
    """Compute contact c and store its force, spring and, if there is a ledger, its losses."""
    law, rods, inertia, up, _ = alike
    gap, bodies = get_vector(numbers, GAP, c, up), bodies_of(rods, numbers, c, up)
    distance = sqrt(dot(gap, gap))
    half, gain = get_vector(numbers, HALF, c, up), get_vector(numbers, GAIN, c, up)
    out, overlap = times(1.0 / distance, gap), max(1.0 - distance, 0.0)
    kept = get_kept(numbers, c, up)
    meeting = Meeting(bodies, out, overlap, half, gain, kept, nothing(half))
    found = contact(law.normal, law.friction, inertia, meeting, dt)
    fill_kept(numbers, c, found.kept)
    push, share = along(spread(found.kept.rub, out), found.kept.force, out), get(numbers, SHARE, c)
    fill(numbers, FORCE, c, times(share, push))
    if ledger is not None:
        fill(numbers, LOST, c, times(share, found.lost))


@kernel(inline=False)
def acted(alike, memory, sums, batch, ledger, count, dt):
    """Compute the first `count` contacts; add forces and torques to `sums`, losses to the ledger.

    `sums`: force and torque on each rod; the memory is renewed.
    """
    (numbers, place), up = batch, alike.up
    for c in range(min((count + WIDTH - 1) // WIDTH * WIDTH, SIZE)):  # beyond `count` idle ones
        act_on(alike, ledger, numbers, c, dt)
    for c in range(count):
        force = get_vector(numbers, FORCE, c, up)
        for rod in range(len(alike.rods)):
            sign = 1.0 - 2.0 * rod  # the opposite force acts on the second
            arm = get_vector(numbers, ARM + 3 * rod, c, up)
            pull(sums, np.uint64(place[c, rod]), arm, times(sign, force))
        keep(memory, np.uint64(place[c, 2]), get_kept(numbers, c, up))
    if ledger is not None:
        for k in range(2):
            lost = 0.0
            for c in range(count):
                lost += get(numbers, LOST + k, c)
            ledger[alike.column + k] += lost
