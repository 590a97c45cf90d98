"""Contacts of two rods of a row, computed side by side.

The contacts of a step are collected first, number by number, and their forces found in a loop
without a branch or a place that depends on a number: the compiler puts several contacts into
one instruction. Then each is added to its rods, in the order in which it was found.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ..cache import kernel
from .codes import C_X, PAIR_FRICTION, PAIR_NORMAL
from .contact import Inertia, Meeting, contact, losses, total
from .vectors import add, along, dot, swing, times, torque

SIZE = 64  # contacts; fixed, so that the compiler knows how far apart numbers lie
MOST = SIZE - 4  # that may be there before a pair is looked at
WIDTH = 8  # contacts that one instruction may hold, at most

# Numbers of a contact: given,
R = 0  # vector from the place on the second axis to the one on the first
ARM, OTHER_ARM = 2, 4  # from both centres to the contact point
FIRST, SECOND = 6, 9  # velocities of both rods half a step ago
GAIN, OTHER_GAIN = 12, 15  # their accelerations at the step before
SHARE = 18  # of the contact, if ends are joined
SPRING = 19  # its length, before and after
# and found.
FORCE, TORQUE, OTHER_TORQUE = 20, 22, 23  # on the first rod; angular accelerations
LAST = 24  # F_n and F_t, before and after, as if the contact had all of its share
NORMAL_LOSS, FRICTION_LOSS = 26, 27  # of this step
NUMBERS = 28


class Batch(NamedTuple):
    """Contacts of a step."""

    numbers: np.ndarray  # (NUMBERS SIZE,): SIZE values of each number
    place: np.ndarray  # (SIZE, 4): rods, entry of the list of pairs, end


def no_contacts() -> Batch:
    """An empty batch."""
    return Batch(np.ones(NUMBERS * SIZE), np.zeros((SIZE, 4), np.int64))


@kernel
def get(numbers, what, c):
    """A number of contact c; without a sign, the place needs no check for one below zero."""
    return numbers[np.uint64(what * SIZE + c)]


@kernel
def keep(numbers, what, c, value):
    """Put a number of contact c."""
    numbers[np.uint64(what * SIZE + c)] = value


@kernel
def kept_spring(springs, now, k, end):
    """Length of a spring."""
    return 0.0 if springs is None else springs[now, k, end]


@kernel
def collect(state, n, pair, now, k, end, near, share):
    """Put a contact at place n of the batch."""
    i, j, _, _, a, b = pair
    s, t, r_x, r_z, _ = near
    rods, before, (numbers, place) = state.rods, state.before, state.scratch.batch
    at = np.uint64(n)
    place[at, 0], place[at, 1], place[at, 2], place[at, 3] = i, j, k, end
    keep(numbers, R, n, r_x)
    keep(numbers, R + 1, n, r_z)
    keep(numbers, ARM, n, s * a[0] - 0.5 * r_x)
    keep(numbers, ARM + 1, n, s * a[1] - 0.5 * r_z)
    keep(numbers, OTHER_ARM, n, t * b[0] + 0.5 * r_x)
    keep(numbers, OTHER_ARM + 1, n, t * b[1] + 0.5 * r_z)
    for c in range(3):
        keep(numbers, FIRST + c, n, rods[i, C_X + c])
        keep(numbers, SECOND + c, n, rods[j, C_X + c])
        keep(numbers, GAIN + c, n, before[i, c])
        keep(numbers, OTHER_GAIN + c, n, before[j, c])
    keep(numbers, LAST, n, state.listed.forces[now, k, 2 * end])
    keep(numbers, LAST + 1, n, state.listed.forces[now, k, 2 * end + 1])
    keep(numbers, SHARE, n, share)
    keep(numbers, SPRING, n, kept_spring(state.listed.springs, now, k, end))


@kernel
def two(numbers, what, c):
    """A vector of contact c."""
    return get(numbers, what, c), get(numbers, what + 1, c)


@kernel
def keep_two(numbers, what, c, v):
    """Put a vector of contact c."""
    keep(numbers, what, c, v[0])
    keep(numbers, what + 1, c, v[1])


@kernel
def moving(numbers, what, c, arm):
    """Velocity of a point of a rod, or its acceleration but for that towards the centre."""
    return along(two(numbers, what, c), 1.0, swing((get(numbers, what + 2, c),), arm))


@kernel
def accounted(ledger, law, numbers, c, meeting, found, dt):
    """What is lost in this step."""
    if ledger is not None:
        share = get(numbers, SHARE, c)
        normal, friction = losses(law, meeting, found, dt)
        keep(numbers, NORMAL_LOSS, c, share * normal)
        keep(numbers, FRICTION_LOSS, c, share * friction)


@kernel
def act_on(between, light, ledger, numbers, c, dt):
    """What acts in contact c."""
    r, p, q = two(numbers, R, c), two(numbers, ARM, c), two(numbers, OTHER_ARM, c)
    distance = sqrt(dot(r, r))
    half = along(moving(numbers, FIRST, c, p), -1.0, moving(numbers, SECOND, c, q))
    gain = along(moving(numbers, GAIN, c, p), -1.0, moving(numbers, OTHER_GAIN, c, q))
    meeting = Meeting(
        ((p, p), (q, q)), times(1 / distance, r), 1.0 - distance, half, gain,
        get(numbers, LAST, c), (get(numbers, LAST + 1, c),), (get(numbers, SPRING, c),),
        None, None, half,
    )  # fmt: skip
    found = contact(between.normal, between.friction, Inertia(light, None), meeting, dt)
    accounted(ledger, between.normal, numbers, c, meeting, found, dt)
    keep(numbers, SPRING, c, found.spring[0])
    keep_two(numbers, LAST, c, (found.normal, found.rub[0]))
    f = times(get(numbers, SHARE, c), total(found, meeting.out))
    keep_two(numbers, FORCE, c, f)
    keep(numbers, TORQUE, c, light * torque(p, f)[0])
    keep(numbers, OTHER_TORQUE, c, -light * torque(q, f)[0])


@kernel
def spring_kept(springs, numbers, c, place):
    """Keep the spring for the next step."""
    if springs is not None:
        springs[place] = get(numbers, SPRING, c)


@kernel
def booked(ledger, numbers, count):
    """Add the losses of this step."""
    if ledger is not None:
        normal, friction = ledger[PAIR_NORMAL], ledger[PAIR_FRICTION]
        for c in range(count):
            normal += get(numbers, NORMAL_LOSS, c)
            friction += get(numbers, FRICTION_LOSS, c)
        ledger[PAIR_NORMAL], ledger[PAIR_FRICTION] = normal, friction


@kernel(inline=False)
def act(between, light, accelerations, batch, kept, ledger, count, dt):
    """Add the accelerations by the first contacts of the batch.

    `kept`: list in use, springs and forces.
    """
    (numbers, places), (now, springs, forces) = batch, kept
    for c in range(min((count + WIDTH - 1) // WIDTH * WIDTH, SIZE)):  # the last ones are idle
        act_on(between, light, ledger, numbers, c, dt)
    for c in range(count):
        i, j = np.uint64(places[c, 0]), np.uint64(places[c, 1])
        f_x, f_z = get(numbers, FORCE, c), get(numbers, FORCE + 1, c)
        add(accelerations, i, 0, (f_x, f_z, get(numbers, TORQUE, c)))
        add(accelerations, j, 0, (-f_x, -f_z, get(numbers, OTHER_TORQUE, c)))
        k, end = np.uint64(places[c, 2]), np.uint64(places[c, 3])
        spring_kept(springs, numbers, c, (now, k, end))
        forces[now, k, 2 * end] = get(numbers, LAST, c)
        forces[now, k, 2 * end + 1] = get(numbers, LAST + 1, c)
    booked(ledger, numbers, count)


@kernel
def acted(effects, state, ledger, count, dt):
    """Add the accelerations by the contacts that are collected."""
    kept = state.listed.turn[0], state.listed.springs, state.listed.forces
    scratch, light = state.scratch, effects.alone.lightness
    act(effects.between, light, scratch.total, scratch.batch, kept, ledger, count, dt)
