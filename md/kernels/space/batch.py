"""Contacts of two rods in space, computed side by side as those in a plane (`kernels.batch`)."""

from math import sqrt

import numpy as np

from ...cache import kernel
from ..batch import SIZE, WIDTH, Batch, get, keep
from ..codes import DIRECTOR, PAIR_FRICTION, PAIR_NORMAL, PLATE_WORK
from ..contact import add, along, normal_force, put, vector
from .forces import Rubbing, across_normal, spring_force, turning
from .geometry import cross, dot, times

# Numbers of a contact: given,
S, T, R, SHARE = 0, 1, 2, 5  # places on both axes; vector from the second to the first
SPRING = 6  # before and after
FIRST, SECOND = 9, 24  # of each rod: director, velocity, w, and both accelerations
STATE, GAIN = 9, 6  # columns of a rod and of what it gained
# and found: force, torques on the first and the second rod; of all, and of what takes off energy.
FORCE, NORMAL_LOST, FRICTION_LOST = 39, 48, 57
NUMBERS = 66


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
def given_spring(springs, numbers, n, number, slot):
    """Put a spring at place n."""
    if springs is not None:
        keep_three(numbers, SPRING, n, vector(springs[number], slot, 0))


@kernel
def spring_kept(springs, numbers, c, number, slot):
    """Keep it for the next step."""
    if springs is not None:
        put(springs[number], slot, 0, three(numbers, SPRING, c))


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
    (numbers, place), at = state.batch, np.uint64(n)
    place[at, 0], place[at, 1], place[at, 2], place[at, 3] = pair.i, pair.j, pair.number, slot
    keep(numbers, S, n, near.s)
    keep(numbers, T, n, near.t)
    keep_three(numbers, R, n, near.gap)
    keep(numbers, SHARE, n, share)
    given_spring(state.pair_springs, numbers, n, pair.number, slot)
    given_rod(state, numbers, FIRST, n, pair.i)
    given_rod(state, numbers, SECOND, n, pair.j)
    return n + 1


@kernel
def moves(rolling, numbers, rod, c, arm):
    """Velocity of a point of a rod half a step before, and its acceleration in the last step."""
    director = three(numbers, rod, c)
    omega = turning(rolling, three(numbers, rod + 6, c), director)
    alpha = turning(rolling, three(numbers, rod + 12, c), director)
    v = along(three(numbers, rod + 3, c), 1.0, cross(omega, arm))
    return v, along(three(numbers, rod + 9, c), 1.0, cross(alpha, arm))


@kernel
def friction_force(friction, effects, bodies, numbers, c, rubbing, dt):
    """Friction force of contact c."""
    if friction is None:
        return 0.0, 0.0, 0.0
    length = three(numbers, SPRING, c)
    f, _, length = spring_force(friction, effects, bodies, length, rubbing, dt)
    keep_three(numbers, SPRING, c, length)
    return f


@kernel
def found(numbers, what, c, arms, f):
    """Keep a force and its torques."""
    keep_three(numbers, what, c, f)
    keep_three(numbers, what + 3, c, cross(arms[0], f))
    keep_three(numbers, what + 6, c, cross(f, arms[1]))


@kernel
def contact(between, effects, lost, numbers, c, dt):
    """What acts in contact c."""
    s, t, r = get(numbers, S, c), get(numbers, T, c), three(numbers, R, c)
    a, b, light = three(numbers, FIRST, c), three(numbers, SECOND, c), effects.lightness
    distance = sqrt(dot(r, r))
    normal, overlap = times(1.0 / distance, r), 1.0 - distance
    p, q = along(times(s, a), -0.5, r), along(times(t, b), 0.5, r)
    v, gain = moves(effects.rolling, numbers, FIRST, c, p)
    u, other = moves(effects.rolling, numbers, SECOND, c, q)
    v, gain = along(v, -1.0, u), along(gain, -1.0, other)
    now = along(v, dt / 2, gain)
    turned = across_normal(light, s, a, normal) + across_normal(light, t, b, normal)
    force = normal_force(between.normal, overlap, dot(now, normal), 1.0 / (2.0 + turned), dt)
    rubbing, bodies = Rubbing(normal, overlap, force, v, now), ((p, a), (q, b))
    rub = friction_force(between.friction, effects, bodies, numbers, c, rubbing, dt)
    share = get(numbers, SHARE, c)
    found(numbers, FORCE, c, (p, q), times(share, along(rub, force, normal)))
    force -= between.normal.stiffness * overlap * sqrt(overlap)
    if lost is not None:
        found(numbers, NORMAL_LOST, c, (p, q), times(share * force, normal))
        found(numbers, FRICTION_LOST, c, (p, q), times(share, rub))


@kernel
def act_on_both(total, i, j, numbers, what, c):
    """Add a force and its torques to two rods."""
    f = three(numbers, what, c)
    add(total, i, 0, f)
    add(total, i, 3, three(numbers, what + 3, c))
    add(total, j, 0, times(-1.0, f))
    add(total, j, 3, three(numbers, what + 6, c))


@kernel
def lost_by_both(lost, i, j, numbers, c):
    """Note the forces that take off energy, as `forces.lose` does."""
    if lost is not None:
        act_on_both(lost[PAIR_NORMAL], i, j, numbers, NORMAL_LOST, c)
        act_on_both(lost[PAIR_FRICTION], i, j, numbers, FRICTION_LOST, c)
        lost[PLATE_WORK, i, 0] = lost[PLATE_WORK, j, 0] = 1.0


@kernel(inline=False)
def acted(between, effects, state, count, dt):
    """Add what the first contacts of the batch do; none is left."""
    (numbers, place), lost = state.batch, state.lost
    for c in range(min((count + WIDTH - 1) // WIDTH * WIDTH, SIZE)):  # the last ones are idle
        contact(between, effects, lost, numbers, c, dt)
    for c in range(count):
        i, j = np.uint64(place[c, 0]), np.uint64(place[c, 1])
        act_on_both(state.scratch, i, j, numbers, FORCE, c)
        spring_kept(state.pair_springs, numbers, c, np.uint64(place[c, 2]), np.uint64(place[c, 3]))
        lost_by_both(lost, i, j, numbers, c)
    return 0
