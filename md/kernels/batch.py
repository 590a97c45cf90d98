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
from .contact import Slip, add, normal_force, spring_friction, tangential_constants

SIZE = 64  # contacts; fixed, so that the compiler knows how far apart numbers lie
MOST = SIZE - 4  # that may be there before a pair is looked at
WIDTH = 4  # contacts that one instruction may hold, at most

# Numbers of a contact: given,
R = 0  # vector from the place on the second axis to the one on the first
ARM, OTHER_ARM = 2, 4  # from both centres to the contact point
FIRST, SECOND = 6, 9  # velocities of both rods half a step ago
GAIN, OTHER_GAIN = 12, 15  # their accelerations at the step before
SHARE = 18  # of the contact, if ends are joined
SPRING = 19  # its length, before and after
# and found.
FORCE, TORQUE, OTHER_TORQUE = 20, 22, 23  # on the first rod; angular accelerations
LOST, RUB = 24, 25  # normal force by dashpots and friction force, before and after
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
def past_losses(losses, numbers, n, now, k, end):
    """Put the losses of the step before at place n."""
    if losses is not None:
        keep(numbers, LOST, n, losses[now, k, 2 * end])
        keep(numbers, RUB, n, losses[now, k, 2 * end + 1])


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
    past_losses(state.listed.losses, numbers, n, now, k, end)
    keep(numbers, SHARE, n, share)
    keep(numbers, SPRING, n, kept_spring(state.listed.springs, now, k, end))


@kernel
def pair_friction(friction, numbers, c, overlap, force, slip, dt):
    """F_t between two rods, and its spring."""
    if friction is None:
        return 0.0
    k, g = tangential_constants(friction.spring, overlap, slip.mass)
    limit = friction.coefficient * force
    rub, length = spring_friction(k, g, get(numbers, SPRING, c), slip, limit, dt)
    keep(numbers, SPRING, c, length)
    return rub


@kernel
def accounted(ledger, numbers, c, forces, velocities, dt):
    """Half of this step's losses and half of the last one's, with the velocity between them.

    `forces`: lost normal force and friction; `velocities`: opening rate and slip half a step ago.
    """
    if ledger is not None:
        (lost, rub), (rate, slip) = forces, velocities
        keep(numbers, NORMAL_LOSS, c, 0.5 * dt * rate * (lost + get(numbers, LOST, c)))
        keep(numbers, FRICTION_LOSS, c, 0.5 * dt * slip * (rub + get(numbers, RUB, c)))
        keep(numbers, LOST, c, lost)
        keep(numbers, RUB, c, rub)


@kernel
def contact(between, light, ledger, numbers, c, dt):
    """What acts in contact c."""
    r_x, r_z = get(numbers, R, c), get(numbers, R + 1, c)
    p_x, p_z = get(numbers, ARM, c), get(numbers, ARM + 1, c)
    q_x, q_z = get(numbers, OTHER_ARM, c), get(numbers, OTHER_ARM + 1, c)
    r = sqrt(r_x * r_x + r_z * r_z)
    n_x, n_z, overlap = r_x / r, r_z / r, 1.0 - r
    spin, other = get(numbers, FIRST + 2, c), get(numbers, SECOND + 2, c)
    v_x = get(numbers, FIRST, c) + spin * p_z - get(numbers, SECOND, c) - other * q_z
    v_z = get(numbers, FIRST + 1, c) - spin * p_x - get(numbers, SECOND + 1, c) + other * q_x
    lever_i, lever_j = p_z * n_x - p_x * n_z, q_z * n_x - q_x * n_z
    mass = 1 / (2 + (lever_i * lever_i + lever_j * lever_j) * light)
    rate, slip = v_x * n_x + v_z * n_z, v_x * n_z - v_z * n_x  # tangent (n_z, -n_x)
    spin, other = get(numbers, GAIN + 2, c), get(numbers, OTHER_GAIN + 2, c)
    gain_x = get(numbers, GAIN, c) + spin * p_z - get(numbers, OTHER_GAIN, c) - other * q_z
    gain_z = get(numbers, GAIN + 1, c) - spin * p_x - get(numbers, OTHER_GAIN + 1, c) + other * q_x
    v_x, v_z = v_x + gain_x * dt / 2, v_z + gain_z * dt / 2
    force = normal_force(between.normal, overlap, v_x * n_x + v_z * n_z, mass, dt)
    across_i, across_j = p_z * n_z + p_x * n_x, q_z * n_z + q_x * n_x
    mass = 1 / (2 + (across_i * across_i + across_j * across_j) * light)
    seen, share = Slip(slip, v_x * n_z - v_z * n_x, 0.0, mass), get(numbers, SHARE, c)
    rub = share * pair_friction(between.friction, numbers, c, overlap, force, seen, dt)
    lost = share * (between.normal.stiffness * overlap * sqrt(overlap) - force)
    force *= share
    accounted(ledger, numbers, c, (lost, rub), (rate, slip), dt)
    f_x, f_z = force * n_x + rub * n_z, force * n_z - rub * n_x
    keep(numbers, FORCE, c, f_x)
    keep(numbers, FORCE + 1, c, f_z)
    keep(numbers, TORQUE, c, (p_z * f_x - p_x * f_z) * light)
    keep(numbers, OTHER_TORQUE, c, (q_x * f_z - q_z * f_x) * light)


@kernel
def spring_kept(springs, numbers, c, place):
    """Keep the spring for the next step."""
    if springs is not None:
        springs[place] = get(numbers, SPRING, c)


@kernel
def losses_kept(losses, numbers, c, place):
    """Keep the losses for the next step."""
    if losses is not None:
        now, k, end = place
        losses[now, k, 2 * end] = get(numbers, LOST, c)
        losses[now, k, 2 * end + 1] = get(numbers, RUB, c)


@kernel
def booked(ledger, numbers, count):
    """Add the losses of this step."""
    if ledger is not None:
        normal, friction = ledger[PAIR_NORMAL], ledger[PAIR_FRICTION]
        for c in range(count):
            normal += get(numbers, NORMAL_LOSS, c)
            friction -= get(numbers, FRICTION_LOSS, c)
        ledger[PAIR_NORMAL], ledger[PAIR_FRICTION] = normal, friction


@kernel(inline=False)
def act(between, light, total, batch, kept, ledger, count, dt):
    """Add the accelerations by the first contacts of the batch.

    `kept`: list in use, springs and losses.
    """
    (numbers, places), (now, springs, losses) = batch, kept
    for c in range(min((count + WIDTH - 1) // WIDTH * WIDTH, SIZE)):  # the last ones are idle
        contact(between, light, ledger, numbers, c, dt)
    for c in range(count):
        i, j = np.uint64(places[c, 0]), np.uint64(places[c, 1])
        f_x, f_z = get(numbers, FORCE, c), get(numbers, FORCE + 1, c)
        add(total, i, 0, (f_x, f_z, get(numbers, TORQUE, c)))
        add(total, j, 0, (-f_x, -f_z, get(numbers, OTHER_TORQUE, c)))
        place = now, places[c, 2], places[c, 3]
        spring_kept(springs, numbers, c, place)
        losses_kept(losses, numbers, c, place)
    booked(ledger, numbers, count)


@kernel
def acted(effects, state, ledger, count, dt):
    """Add the accelerations by the contacts that are collected."""
    kept = state.listed.turn[0], state.listed.springs, state.listed.losses
    scratch, light = state.scratch, effects.alone.lightness
    act(effects.between, light, scratch.total, scratch.batch, kept, ledger, count, dt)
