"""Every touch of the plate by every rod, compiled: from the first force to the last.

A touch begins with the first step in which the plate presses the rod and ends with the first in
which it no longer does. A row of the record holds what the theory of one impact needs, before and
after, and what it leaves out.

In space a row refers to the vertical plane through the rod's axis as the touch begins, until it
ends. The x axis of this plane is horizontal; its component around the annulus, counter-clockwise,
is positive. For an upright rod, which lies in all vertical planes, x is the direction around the
annulus itself. Slip, spin and velocity have the parts that lie in the plane; friction has its full
size.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ..cache import kernel
from . import (
    IMPULSE,
    SLIDE,
    SLIDING,
    SLIP_REVERSAL,
    SLIP_STICK,
    STUCK,
    TURNED,
    WATCH_DEEPEST,
    WATCH_SIDE,
    WATCH_STOPPED,
    WATCH_TOUCHED,
    WATCHED,
)
from .contact import size, turning
from .state import point, rod_of
from .vectors import height, put, times

NEARLY = 1 - 1e-12  # of a limit that rounding may have missed

# Columns of a row.
ROD = 0
STEP = 1  # at which it touched
CAP = 2  # -1 or 1: the end that did, along the axis
DURATION = 3  # in steps
FLIGHT = 4  # steps since the last touch of this rod ended; nan before its first one
A_X, A_Z = 5, 6  # d; arm from the centre to the contact point, at the touch
BEFORE = 7  # c_x, c_z, omega
AFTER = 10  # c_x, c_z, omega, as the force ends
PLATE = 13  # velocity of the plate at the touch
APPROACH = 14  # normal velocity v_0 of the contact point relative to the plate, at the touch
LEAVING = 15  # normal velocity of that point relative to the plate, as the force ends
REGIME = 16  # SLIDING, SLIP_STICK or SLIP_REVERSAL of `md.kernels`
PUSHED = 17  # part of the steps in which another rod or a wall pushed as well
DEEPEST = 18  # overlap, d
WIDTH = 19
_LEFT = 19  # step at which the last touch ended, beyond the columns of a row
_PLANE = 20  # x and y of the plane's direction
LAST = 22  # what was watched of the last touch
_OPEN = LAST + WATCHED


class Record(NamedTuple):
    """Rows of finished touches, and of touches under way."""

    rows: np.ndarray  # (capacity, WIDTH)
    count: np.ndarray  # type: ignore[assignment]  # (1,); a tuple has a method of this name
    open: np.ndarray  # (rods, _OPEN): rows in the making
    watch: np.ndarray  # (rods, WATCHED)


def new_record(rods: int, capacity: int) -> Record:
    """Create an empty record, with room for so many rows, one for each rod at least."""
    under_way = np.zeros((rods, _OPEN))
    under_way[:, _LEFT] = np.nan
    rows = np.zeros((capacity, WIDTH))
    return Record(rows, np.zeros(1, np.int64), under_way, np.zeros((rods, WATCHED)))


def since_touch(record: Record, step: int) -> np.ndarray:
    """Steps since the touch of each rod began, or its last one ended, or since the start."""
    last = np.where(record.watch[:, WATCH_TOUCHED] > 0, record.open[:, STEP], record.open[:, _LEFT])
    return step - np.nan_to_num(last)


# One contact


@kernel
def along_plane(v, plane):
    """Component of a vector along the x axis of the plane of a touch."""
    if len(v) == 2:
        return v[0]
    return v[0] * plane[0] + v[1] * plane[1]


@kernel
def at_limit(friction, kept):
    """Whether friction is at its limit mu F_n, within rounding; without friction it always is."""
    if friction is None:
        return True
    return size(kept.rub) >= NEARLY * friction.coefficient * kept.force


@kernel
def stops(friction, kept):
    """Whether friction as a constraint ends the slip in this step: it needs less than mu F_n."""
    if friction is None:
        return False
    return friction.spring is None and not at_limit(friction, kept)


@kernel
def spent(plastic, touch, dt):
    """Whether a cap is no longer pressed; a plastic contact is over as it rests, to rounding."""
    if touch.overlap <= 0:
        return True
    if plastic is not None:
        return touch.rate * dt >= -1e-12 * touch.overlap
    return touch.kept.force <= 0 and touch.rate > 0


@kernel
def watched(watch, effects, caps, plane, dt):
    """Add a step to the numbers watched of a touch; return whether the touch is over.

    `caps`: `surfaces.Touch` of the lower and the upper one; `plane`: direction of x in space.
    """
    lower, upper = caps
    touch = lower if lower.kept.force >= upper.kept.force else upper
    kept, slip = touch.kept, along_plane(touch.half, plane)
    if spent(effects.normal.plastic, lower, dt) and spent(effects.normal.plastic, upper, dt):
        return watch[WATCH_TOUCHED] > 0
    if kept.force <= 0:
        return False
    if watch[WATCH_TOUCHED] == 0:
        watch[WATCH_TOUCHED], watch[WATCH_SIDE] = 1, np.sign(slip)
    watch[WATCH_DEEPEST] = max(watch[WATCH_DEEPEST], touch.overlap)
    if slip * watch[WATCH_SIDE] <= 0:
        watch[WATCH_STOPPED] = 1
    phase = SLIDE
    if watch[WATCH_STOPPED] > 0:
        phase = TURNED if at_limit(effects.friction, kept) else STUCK
    watch[phase] += dt
    watch[IMPULSE + phase] += kept.force * dt
    if stops(effects.friction, kept):  # the little slip that is left has any sign
        watch[WATCH_STOPPED] = 1
    return False


@kernel
def regime_of(watch):
    """Regime of a contact: slide, or of the phase of larger normal impulse after the slip stopped.

    `watch`: numbers watched of it.
    """
    if watch[WATCH_STOPPED] == 0:
        return SLIDING
    return SLIP_STICK if watch[IMPULSE + STUCK] >= watch[IMPULSE + TURNED] else SLIP_REVERSAL


# The record


@kernel
def full(record):
    """Whether the record may lack room for the touches that end in another step."""
    if record is None:
        return False
    return record.count[0] + record.open.shape[0] > record.rows.shape[0]


@kernel
def choose_plane(row, place, director):
    """Choose the plane of a touch in space; store the direction of its x axis in the open row."""
    if len(place) == 3:
        x, y, a, b = place[0], place[1], director[0], director[1]
        if a == 0.0 and b == 0.0:
            a, b = -y, x
        scale = 1.0 / sqrt(a * a + b * b)
        if x * b - y * a < 0.0:
            scale = -scale
        row[_PLANE], row[_PLANE + 1] = scale * a, scale * b


@kernel
def in_plane(rolling, velocity, turn, director, plane):
    """Velocity (c_x, c_z, omega) of a rod in the plane of its touch."""
    if len(velocity) == 2:
        return velocity[0], velocity[1], turn[0]
    omega = turning(rolling, turn, director)
    spin = omega[1] * plane[0] - omega[0] * plane[1]
    return along_plane(velocity, plane), velocity[2], spin


@kernel
def motion_of(effects, rods, i, plane, cap, plate):
    """Velocity (c_x, c_z, omega) of rod i in the plane, and that of its end off the plate."""
    rod = rod_of(effects.up, rods, i)
    arm = times(cap * effects.half_length, rod.director)
    rate = height(point(effects.inertia, rod.velocity, rod.turn, rod.director, arm)) - plate[1]
    return in_plane(effects.inertia.rolling, rod.velocity, rod.turn, rod.director, plane), rate


@kernel(inline=False)
def ended(record, effects, rods, i, plate, step):
    """Finish the touch of rod i: complete its row, store it, and clear what was watched."""
    row, watch, n = record.open[i], record.watch[i], record.count[0]
    plane = row[_PLANE], row[_PLANE + 1]
    motion, row[LEAVING] = motion_of(effects, rods, i, plane, row[CAP], plate)
    put(record.open, i, AFTER, motion)
    row[DURATION] = step - row[STEP]
    row[PUSHED] /= row[DURATION]
    row[REGIME] = regime_of(watch)
    row[DEEPEST] = watch[WATCH_DEEPEST]
    for c in range(WIDTH):
        record.rows[n, c] = row[c]
    record.count[0] = n + 1
    row[_LEFT] = step
    for c in range(WATCHED):
        row[LAST + c], watch[c] = watch[c], 0.0


@kernel
def cleared(record, effects, rods, i, plate, step):
    """End the touch of a rod that is clear of the plate, if there is one under way."""
    if record is not None and record.watch[i, WATCH_TOUCHED] > 0:
        ended(record, effects, rods, i, plate, step)


@kernel(inline=False)
def begun(record, effects, rods, i, cap, a_z, plate, step):
    """Begin the row of a touch of rod i."""
    row = record.open[i]
    plane = row[_PLANE], row[_PLANE + 1]
    row[ROD], row[STEP], row[CAP] = i, step, cap
    row[FLIGHT] = step - row[_LEFT]
    side = along_plane(rod_of(effects.up, rods, i).director, plane)
    row[A_X], row[A_Z] = cap * effects.half_length * side, a_z
    motion, row[APPROACH] = motion_of(effects, rods, i, plane, cap, plate)
    put(record.open, i, BEFORE, motion)
    row[PLATE], row[PUSHED] = plate[1], 0.0


@kernel
def recorded(record, effects, rods, i, pushed, caps, plate, clock):
    """Follow the touch of a rod that the plate may press, if there is a record.

    `caps`: as of `watched`; `pushed`: whether another rod or a wall pushes it.
    """
    if record is None:
        return
    (lower, upper), row, before = caps, record.open[i], record.watch[i, WATCH_TOUCHED]
    if before == 0:
        if lower.overlap <= 0.0 and upper.overlap <= 0.0:
            return
        rod = rod_of(effects.up, rods, i)
        choose_plane(row, rod.place, rod.director)
    plane, a_z = (row[_PLANE], row[_PLANE + 1]), height(lower.arm)
    if watched(record.watch[i], effects, caps, plane, clock.dt):
        ended(record, effects, rods, i, plate, clock.step)
    elif record.watch[i, WATCH_TOUCHED] > 0:
        if before == 0:
            cap = -1.0 if lower.kept.force >= upper.kept.force else 1.0
            begun(record, effects, rods, i, cap, a_z, plate, clock.step)
        if pushed:
            row[PUSHED] += 1
