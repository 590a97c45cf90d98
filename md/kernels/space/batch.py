"""Contacts of two rods in space, computed side by side as those in a plane (`kernels.batch`)."""

from math import sqrt

import numpy as np

from ...cache import kernel
from ..batch import SIZE, WIDTH, Batch, get, keep
from ..codes import DIRECTOR, PAIR_FRICTION, PAIR_NORMAL
from ..contact import Meeting, contact, losses, swung, total
from ..vectors import ZERO, add, along, cross, dot, put, times, vector
from .forces import inertia_of, keeps, keeps_forces, kept, kept_number

# Numbers of a contact: given,
S, T, R, SHARE = 0, 1, 2, 5  # places on both axes; vector from the second to the first
SPRING, LAST, RUB = 6, 9, 10  # before and after: length of the spring; F_n, F_t of all of it
FIRST, SECOND = 13, 28  # of each rod: director, velocity, w, and both accelerations
STATE, GAIN = 9, 6  # columns of a rod and of what it gained
# and found: force, torques on the first and the second rod, losses.
FORCE, NORMAL_LOSS, FRICTION_LOSS, WORK = 43, 52, 53, 54
NUMBERS = 55


def no_contacts() -> Batch:
    """An empty batch."""
    return Batch(np.ones(NUMBERS * SIZE), np.zeros((SIZE, 4), np.int64))


@kernel
def three(numbers, what, c):
    """A vector of contact c."""
    return get(numbers, what, c), get(numbers, what + 1, c), get(numbers, what + 2, c)


@kernel
def keep_three(numbers, what, c, v):
    """Put a vector of contact c."""
    keep(numbers, what, c, v[0])
    keep(numbers, what + 1, c, v[1])
    keep(numbers, what + 2, c, v[2])


@kernel
def given(forces, springs, numbers, n, row, slot):
    """Put what is kept of a contact at place n."""
    keep(numbers, LAST, n, kept_number(forces, row, slot))
    keep_three(numbers, RUB, n, kept(forces, row, slot, 1))
    keep_three(numbers, SPRING, n, kept(springs, row, slot, 0))


@kernel
def taken(forces, springs, numbers, c, row, slot):
    """Keep it for the next step."""
    keeps_forces(forces, row, slot, get(numbers, LAST, c), three(numbers, RUB, c))
    keeps(springs, row, slot, three(numbers, SPRING, c))


@kernel
def given_spring(springs, numbers, n, now, k, slot):
    """Put the spring of two rods at place n."""
    length = ZERO if springs is None else vector(springs[now, k], slot, 0)
    keep_three(numbers, SPRING, n, length)


@kernel
def taken_spring(springs, numbers, c, now, k, slot):
    """Keep it for the next step."""
    if springs is not None:
        put(springs[now, k], slot, 0, three(numbers, SPRING, c))


@kernel
def given_rod(state, numbers, what, n, i):
    """Put a rod at place n."""
    for c in range(STATE):
        keep(numbers, what + c, n, state.rods[i, DIRECTOR + c])
    for c in range(GAIN):
        keep(numbers, what + STATE + c, n, state.before[i, c])


@kernel
def collect(state, n, pair, near, share, slot):
    """Put a contact at place n of the batch; the number of contacts then."""
    (numbers, place), at, listed = state.scratch.batch, np.uint64(n), state.listed
    place[at, 0], place[at, 1], place[at, 2], place[at, 3] = pair.i, pair.j, pair.entry, slot
    keep(numbers, S, n, near.s)
    keep(numbers, T, n, near.t)
    keep_three(numbers, R, n, near.gap)
    keep(numbers, SHARE, n, share)
    now = listed.turn[0]
    keep(numbers, LAST, n, listed.forces[now, pair.entry, slot, 0])
    keep_three(numbers, RUB, n, vector(listed.forces[now, pair.entry], slot, 1))
    given_spring(listed.springs, numbers, n, now, pair.entry, slot)
    given_rod(state, numbers, FIRST, n, pair.i)
    given_rod(state, numbers, SECOND, n, pair.j)
    return n + 1


@kernel
def moves(rolling, numbers, rod, c, arm):
    """Velocity of a point of a rod half a step before, and its acceleration in the last step."""
    director = three(numbers, rod, c)
    v = swung(rolling, three(numbers, rod + 6, c), director, arm)
    gain = swung(rolling, three(numbers, rod + 12, c), director, arm)
    velocity, acceleration = three(numbers, rod + 3, c), three(numbers, rod + 9, c)
    return along(velocity, 1.0, v), along(acceleration, 1.0, gain)


@kernel
def accounted(ledger, law, numbers, c, meeting, found, dt):
    """What is lost in this step."""
    if ledger is not None:
        share = get(numbers, SHARE, c)
        normal, friction = losses(law, meeting, found, dt)
        keep(numbers, NORMAL_LOSS, c, share * normal)
        keep(numbers, FRICTION_LOSS, c, share * friction)


@kernel
def act_on(between, effects, ledger, numbers, c, dt):
    """What acts in contact c."""
    r, a, b = three(numbers, R, c), three(numbers, FIRST, c), three(numbers, SECOND, c)
    distance = sqrt(dot(r, r))
    p = along(times(get(numbers, S, c), a), -0.5, r)
    q = along(times(get(numbers, T, c), b), 0.5, r)
    v, gain = moves(effects.rolling, numbers, FIRST, c, p)
    u, other = moves(effects.rolling, numbers, SECOND, c, q)
    half, gain = along(v, -1.0, u), along(gain, -1.0, other)
    meeting = Meeting(
        ((p, a), (q, b)), times(1.0 / distance, r), 1.0 - distance, half, gain,
        get(numbers, LAST, c), three(numbers, RUB, c), three(numbers, SPRING, c), None, None, half,
    )  # fmt: skip
    found = contact(between.normal, between.friction, inertia_of(effects), meeting, dt)
    accounted(ledger, between.normal, numbers, c, meeting, found, dt)
    keep_three(numbers, SPRING, c, found.spring)
    keep(numbers, LAST, c, found.normal)
    keep_three(numbers, RUB, c, found.rub)
    f = times(get(numbers, SHARE, c), total(found, meeting.out))
    keep_three(numbers, FORCE, c, f)
    keep_three(numbers, FORCE + 3, c, cross(p, f))
    keep_three(numbers, FORCE + 6, c, cross(f, q))


@kernel
def booked(ledger, numbers, normal, friction, count):
    """Add the losses of this step to two columns."""
    if ledger is not None:
        for c in range(count):
            ledger[normal] += get(numbers, NORMAL_LOSS, c)
            ledger[friction] += get(numbers, FRICTION_LOSS, c)


@kernel(inline=False)
def acted(between, effects, state, ledger, count, dt):
    """Add what the first contacts of the batch do; none is left."""
    (numbers, place), sums, listed = state.scratch.batch, state.scratch.total, state.listed
    now = listed.turn[0]
    for c in range(min((count + WIDTH - 1) // WIDTH * WIDTH, SIZE)):  # the last ones are idle
        act_on(between, effects, ledger, numbers, c, dt)
    for c in range(count):
        i, j = np.uint64(place[c, 0]), np.uint64(place[c, 1])
        f = three(numbers, FORCE, c)
        add(sums, i, 0, f)
        add(sums, i, 3, three(numbers, FORCE + 3, c))
        add(sums, j, 0, times(-1.0, f))
        add(sums, j, 3, three(numbers, FORCE + 6, c))
        k, slot = np.uint64(place[c, 2]), np.uint64(place[c, 3])
        keeps_forces(listed.forces[now], k, slot, get(numbers, LAST, c), three(numbers, RUB, c))
        taken_spring(listed.springs, numbers, c, now, k, slot)
    booked(ledger, numbers, PAIR_NORMAL, PAIR_FRICTION, count)
    return 0
