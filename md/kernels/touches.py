"""Every touch of the plate by every rod, compiled: from the first force to the last.

A touch begins with the first step in which the plate presses the rod and ends with the first in
which it no longer does. A row of the record holds what the theory of one impact needs, before and
after, and what it leaves out.
"""

from typing import NamedTuple

import numpy as np

from ..cache import kernel
from .codes import (
    C_X,
    IMPULSE,
    SINE,
    STUCK,
    TURNED,
    WATCH_DEEPEST,
    WATCH_STOPPED,
    WATCH_TOUCHED,
    WATCHED,
)
from .plate import field
from .single import regime_of, watched
from .vectors import put, vector

# Columns of a row.
ROD = 0
STEP = 1  # at which it touched
CAP = 2  # -1 or 1: the end that did, along the axis
DURATION = 3  # in steps
FLIGHT = 4  # steps since the last touch of this rod ended; nan before its first one
A_X, A_Z = 5, 6  # d; arm from the centre to the contact point, at the touch
BEFORE = 7  # c_x, c_z, omega
AFTER = 10  # the same
PLATE = 13  # velocity of the plate at the touch
APPROACH = 14  # normal velocity v_0 of the contact point relative to the plate, at the touch
LEAVING = 15  # the same as the force ends
REGIME = 16  # SLIDING, SLIP_STICK or SLIP_REVERSAL of `codes`
PUSHED = 17  # part of the steps in which another rod touched as well
DEEPEST = 18  # overlap, d
WIDTH = 19
_LEFT = 19  # step at which the last touch ended, beyond the columns of a row
_OPEN = 20


class Record(NamedTuple):
    """Finished touches, and those under way."""

    rows: np.ndarray  # (capacity, WIDTH)
    count: np.ndarray  # type: ignore[assignment]  # (1,); a tuple has a method of this name
    open: np.ndarray  # (rods, WIDTH + 1): rows in the making
    watch: np.ndarray  # (rods, codes.WATCHED)


def new_record(rods: int, capacity: int) -> Record:
    """An empty record; at least two rows for each rod."""
    under_way = np.zeros((rods, _OPEN))
    under_way[:, _LEFT] = np.nan
    rows = np.zeros((max(capacity, 2 * rods), WIDTH))
    return Record(rows, np.zeros(1, np.int64), under_way, np.zeros((rods, WATCHED)))


def since_touch(record: Record, step: int) -> np.ndarray:
    """Steps since the last touch of each rod, or since the start; 0 of one that touches."""
    left = np.nan_to_num(record.open[:, _LEFT])
    return np.where(record.watch[:, WATCH_TOUCHED] > 0, 0, step - left)


@kernel
def full(record):
    """Whether the record might not hold another step."""
    if record is None:
        return False
    return record.count[0] + record.open.shape[0] > record.rows.shape[0]


@kernel
def pushed_by_others(others, effects, rods, i):
    """Whether other rods push rod i: `others` are accelerations by all but the plate."""
    alone = field(effects, vector(rods, i, C_X))
    return others[0] != alone[0] or others[1] != alone[1]


@kernel(inline=False)
def ended(record, half_length, rods, i, plate, step):
    """Write the row of the touch of rod i."""
    row, watch, n = record.open[i], record.watch[i], record.count[0]
    put(record.open, i, AFTER, vector(rods, i, C_X))
    a_x = row[CAP] * half_length * rods[i, SINE]
    row[LEAVING] = row[AFTER + 1] - row[AFTER + 2] * a_x - plate[1]
    row[DURATION] = step - row[STEP]
    row[PUSHED] /= row[DURATION]
    stuck, turned = watch[IMPULSE + STUCK], watch[IMPULSE + TURNED]
    row[REGIME] = regime_of(watch[WATCH_STOPPED] > 0, stuck, turned)
    row[DEEPEST] = watch[WATCH_DEEPEST]
    for c in range(WIDTH):
        record.rows[n, c] = row[c]
    record.count[0] = n + 1
    row[_LEFT] = step
    for c in range(WATCHED):
        watch[c] = 0.0


@kernel
def cleared(record, effects, rods, i, plate, step):
    """End the touch of a rod that is clear of the plate."""
    if record is not None and record.watch[i, WATCH_TOUCHED] > 0:
        ended(record, effects.half_length, rods, i, plate, step)


@kernel(inline=False)
def begun(record, half_length, rods, i, cap, a_z, plate, step):
    """Start a row as rod i touches the plate."""
    row = record.open[i]
    row[ROD], row[STEP], row[CAP] = i, step, cap
    row[FLIGHT] = step - row[_LEFT]
    row[A_X], row[A_Z] = cap * half_length * rods[i, SINE], a_z
    put(record.open, i, BEFORE, vector(rods, i, C_X))
    row[PLATE] = plate[1]
    row[APPROACH] = row[BEFORE + 1] - row[BEFORE + 2] * row[A_X] - plate[1]
    row[PUSHED] = 0.0


@kernel
def recorded(record, effects, rods, i, others, touch, plate, clock):
    """Follow the touch of a rod that the plate may press; `touch`: of its lower and upper cap."""
    if record is None:
        return
    lower, upper = touch
    before = record.watch[i, WATCH_TOUCHED]
    over = watched(record.watch[i], effects, lower, upper, clock.dt)
    if over:
        ended(record, effects.half_length, rods, i, plate, clock.step)
    elif record.watch[i, WATCH_TOUCHED] > 0:
        if before == 0:
            cap = -1.0 if lower.force[1] >= upper.force[1] else 1.0
            begun(record, effects.half_length, rods, i, cap, lower.arm[1], plate, clock.step)
        if pushed_by_others(others, effects, rods, i):
            record.open[i, PUSHED] += 1
