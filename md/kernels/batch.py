"""Contacts of rods with each other, or with a wall, computed side by side.

The contacts of a step are collected first, number by number, and their forces found in a loop
without a branch or a place that depends on a number: the compiler puts several contacts into
one instruction. Then each is added to its rods, in the order in which it was found.
"""

from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from ..cache import kernel
from .contact import Inertia, Meeting, contact, losses, total
from .state import Kept, keep, kept_of
from .vectors import add, dot, times, torque

SIZE = 64  # contacts; fixed, so that the compiler knows how far apart numbers lie
MOST = SIZE - 8  # that may be there before a pair or a rod is looked at
WIDTH = 8  # contacts that one instruction may hold, at most

# Numbers of a contact, three places for each vector: given,
GAP = 0  # 1 - overlap along the normal
ARM, OTHER_ARM = 3, 6  # from both centres to the contact point
DIRECTOR, OTHER_DIRECTOR = 9, 12  # in space
HALF, GAIN = 15, 18  # velocity of the first rod against the other half a step before; acceleration
SHARE = 21  # of the contact, if several are one
# of the step before, then of this one, as if the contact had all of its share,
PRESSED, RUB, SPRING = 22, 23, 26  # F_n, F_t, length of the spring
# and found.
FORCE, TORQUE, OTHER_TORQUE = 29, 32, 35
NORMAL_LOSS, FRICTION_LOSS = 38, 39  # of this step
NUMBERS = 40

ONE, TWO = (1,), (1, 1)  # rods of a contact, told by a length


class Batch(NamedTuple):
    """Contacts of a step."""

    numbers: np.ndarray  # (NUMBERS SIZE,): SIZE values of each number
    place: np.ndarray  # (SIZE, 4): rods, row and slot of what is kept of the contact


class Given(NamedTuple):
    """A contact to be computed."""

    first: np.uint64  # rods; of a wall, the first counts
    second: np.uint64
    row: np.uint64  # of what is kept
    slot: int
    gap: tuple  # d; 1 - overlap along the normal
    bodies: tuple  # as of `contact.Meeting`
    half: tuple  # the same
    gain: tuple
    share: float  # of the contact, 0 to 1


class Alike(NamedTuple):
    """What the contacts of a batch have in common."""

    law: Any  # `normal` and `friction`
    rods: tuple  # `ONE` at a wall, or `TWO`
    inertia: Inertia
    up: tuple
    columns: tuple[int, int]  # of the ledger


def no_contacts() -> Batch:
    """An empty batch."""
    return Batch(np.ones(NUMBERS * SIZE), np.zeros((SIZE, 4), np.int64))


@kernel
def get(numbers, what, c):
    """A number of contact c; without a sign, the place needs no check for one below zero."""
    return numbers[np.uint64(what * SIZE + c)]


@kernel
def fill(numbers, what, c, value):
    """Put a number of contact c."""
    numbers[np.uint64(what * SIZE + c)] = value


@kernel
def get_vector(numbers, what, c, up):
    """A vector of contact c."""
    if len(up) == 2:
        return get(numbers, what, c), get(numbers, what + 1, c)
    return get(numbers, what, c), get(numbers, what + 1, c), get(numbers, what + 2, c)


@kernel
def get_axial(numbers, what, c, up):
    """A torque of contact c, or a part across its normal."""
    if len(up) == 2:
        return (get(numbers, what, c),)
    return get(numbers, what, c), get(numbers, what + 1, c), get(numbers, what + 2, c)


@kernel
def fill_all(numbers, what, c, v):
    """Put a vector of contact c."""
    fill(numbers, what, c, v[0])
    if len(v) > 1:
        fill(numbers, what + 1, c, v[1])
    if len(v) > 2:
        fill(numbers, what + 2, c, v[2])


@kernel
def get_kept(numbers, c, up):
    """What is kept of contact c, as if it had all of its share."""
    rub, spring = get_axial(numbers, RUB, c, up), get_axial(numbers, SPRING, c, up)
    return Kept(get(numbers, PRESSED, c), rub, spring)


@kernel
def fill_kept(numbers, c, kept):
    """Put it."""
    fill(numbers, PRESSED, c, kept.force)
    fill_all(numbers, RUB, c, kept.rub)
    fill_all(numbers, SPRING, c, kept.spring)


@kernel
def fill_body(numbers, what, n, arm, director):
    """Put a body of contact n; `what`: places of its arm and, in space, of its director."""
    fill_all(numbers, what[0], n, arm)
    if len(arm) == 3:
        fill_all(numbers, what[1], n, director)


@kernel
def fill_bodies(numbers, n, bodies):
    """Put both bodies, or the one at a wall."""
    fill_body(numbers, (ARM, DIRECTOR), n, bodies[0][0], bodies[0][1])
    if len(bodies) == 2:
        fill_body(numbers, (OTHER_ARM, OTHER_DIRECTOR), n, bodies[1][0], bodies[1][1])


@kernel
def collect(batch, n, given, forces, springs, up):
    """Put a contact at place n, with what is kept of it; the number of contacts then."""
    (numbers, place), at, row, slot = batch, np.uint64(n), given.row, given.slot
    place[at, 0], place[at, 1], place[at, 2], place[at, 3] = given.first, given.second, row, slot
    fill_all(numbers, GAP, n, given.gap)
    fill_bodies(numbers, n, given.bodies)
    fill_all(numbers, HALF, n, given.half)
    fill_all(numbers, GAIN, n, given.gain)
    fill(numbers, SHARE, n, given.share)
    fill_kept(numbers, n, kept_of(up, forces, springs, row, slot))
    return n + 1


@kernel
def bodies_of(rods, numbers, c, up):
    """Of each of the `rods` of contact c, the arm and the director."""
    first = get_vector(numbers, ARM, c, up), get_vector(numbers, DIRECTOR, c, up)
    if len(rods) == 1:
        return (first,)
    second = get_vector(numbers, OTHER_ARM, c, up), get_vector(numbers, OTHER_DIRECTOR, c, up)
    return first, second


@kernel
def fill_torques(numbers, c, bodies, force):
    """Put the torques on both bodies, by a force on the first."""
    fill_all(numbers, TORQUE, c, torque(bodies[0][0], force))
    if len(bodies) == 2:
        fill_all(numbers, OTHER_TORQUE, c, times(-1.0, torque(bodies[1][0], force)))


@kernel
def accounted(ledger, law, numbers, c, meeting, found, dt):
    """What is lost in this step."""
    if ledger is not None:
        share = get(numbers, SHARE, c)
        normal, friction = losses(law, meeting, found, dt)
        fill(numbers, NORMAL_LOSS, c, share * normal)
        fill(numbers, FRICTION_LOSS, c, share * friction)


@kernel
def act_on(alike, ledger, numbers, c, dt):
    """What acts in contact c."""
    law, rods, inertia, up, _ = alike
    gap, bodies = get_vector(numbers, GAP, c, up), bodies_of(rods, numbers, c, up)
    kept = get_kept(numbers, c, up)
    distance = sqrt(dot(gap, gap))
    half, gain = get_vector(numbers, HALF, c, up), get_vector(numbers, GAIN, c, up)
    meeting = Meeting(
        bodies, times(1.0 / distance, gap), max(1.0 - distance, 0.0), half, gain,
        kept.force, kept.rub, kept.spring, None, None, half,
    )  # fmt: skip
    found = contact(law.normal, law.friction, inertia, meeting, dt)
    accounted(ledger, law.normal, numbers, c, meeting, found, dt)
    fill_kept(numbers, c, Kept(found.normal, found.rub, found.spring))
    force = times(get(numbers, SHARE, c), total(found, meeting.out))
    fill_all(numbers, FORCE, c, force)
    fill_torques(numbers, c, bodies, force)


@kernel
def booked(ledger, numbers, columns, count):
    """Add the losses of this step to two columns."""
    if ledger is not None:
        normal, friction = 0.0, 0.0
        for c in range(count):
            normal += get(numbers, NORMAL_LOSS, c)
            friction += get(numbers, FRICTION_LOSS, c)
        ledger[columns[0]] += normal
        ledger[columns[1]] += friction


@kernel(inline=False)
def acted(alike, kept, sums, batch, ledger, count, dt):
    """Add force and torque of the first contacts of the batch to `sums`.

    `kept`: forces and springs.
    """
    (numbers, place), (forces, springs), up = batch, kept, alike.up
    for c in range(min((count + WIDTH - 1) // WIDTH * WIDTH, SIZE)):  # the last ones are idle
        act_on(alike, ledger, numbers, c, dt)
    for c in range(count):
        i, force = np.uint64(place[c, 0]), get_vector(numbers, FORCE, c, up)
        add(sums, i, 0, force)
        add(sums, i, len(force), get_axial(numbers, TORQUE, c, up))
        if len(alike.rods) == 2:
            j = np.uint64(place[c, 1])
            add(sums, j, 0, times(-1.0, force))
            add(sums, j, len(force), get_axial(numbers, OTHER_TORQUE, c, up))
        row, slot = np.uint64(place[c, 2]), np.uint64(place[c, 3])
        keep(forces, springs, row, slot, get_kept(numbers, c, up))
    booked(ledger, numbers, alike.columns, count)
