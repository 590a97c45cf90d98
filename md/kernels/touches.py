"""Every landing of every rod on the plate, compiled: from the first force to the last.

A landing begins with the first step in which the plate pushes the rod and ends with the first in
which it does so no longer. A row of the record holds what the theory of one impact needs, before
and after, and what it leaves out.
"""

from typing import NamedTuple

import numpy as np

from ..cache import kernel
from .neighbours import SINE
from .single import STOPPED, STUCK, TOUCHED, TURNED, WATCHED, watched

# Columns of a row.
ROD = 0
STEP = 1  # at which it touched
CAP = 2  # -1 or 1: the end that did, along the axis
DURATION = 3  # in steps
FLIGHT = 4  # steps since the last landing of this rod ended; nan before its first one
A_X, A_Z = 5, 6  # arm from the centre to the contact point, at the touch
BEFORE = 7  # c_x, c_z, omega
AFTER = 10
PLATE = 13  # velocity of the plate at the touch
APPROACH = 14  # normal velocity v_0 of the contact point relative to the plate, at the touch
LEAVING = 15  # the same as the force ends
REGIME = 16  # 1 slide, 2 slip-stick, 3 slip reversal
SHARED = 17  # part of the steps in which another rod pushed as well
DEEPEST = 18  # overlap
WIDTH = 19
LEFT = 19  # step at which the last landing ended, beyond the columns of a row
_OPEN = 20


class Record(NamedTuple):
    """Finished landings, and those under way."""

    rows: np.ndarray  # (capacity, WIDTH)
    count: np.ndarray  # (1,)
    open: np.ndarray  # (rods, WIDTH + 1): rows in the making
    watch: np.ndarray  # (rods, integrators.WATCHED)


def new_record(rods: int, capacity: int) -> Record:
    """An empty record; at least two rows for each rod."""
    under_way = np.zeros((rods, _OPEN))
    under_way[:, LEFT] = np.nan
    rows = np.zeros((max(capacity, 2 * rods), WIDTH))
    return Record(rows, np.zeros(1, np.int64), under_way, np.zeros((rods, WATCHED)))


@kernel
def pushed(others, gravity):
    """Whether other rods push this one."""
    if gravity is None:
        return others[0] != 0.0 or others[1] != 0.0
    return others[0] != gravity[0] or others[1] != gravity[1]


@kernel(inline=False)
def ended(record, half_length, rods, i, plate, step):
    """Write the row of the landing of rod i."""
    row, watch, n = record.open[i], record.watch[i], record.count[0]
    for c in range(3):
        row[AFTER + c] = rods[i, 4 + c]
    a_x = row[CAP] * half_length * rods[i, SINE]
    row[LEAVING] = row[AFTER + 1] - row[AFTER + 2] * a_x - plate[1]
    row[DURATION] = step - row[STEP]
    row[SHARED] /= row[DURATION]
    row[REGIME] = 1.0
    if watch[STOPPED] > 0:
        row[REGIME] = 2.0 if watch[3 + STUCK] >= watch[3 + TURNED] else 3.0
    row[DEEPEST] = watch[6]
    for c in range(WIDTH):
        record.rows[n, c] = row[c]
    record.count[0] = n + 1
    row[LEFT] = step
    for c in range(WATCHED):
        watch[c] = 0.0


@kernel
def landed(record, effects, rods, i, plate, step):
    """End the landing of a rod that is clear of the plate."""
    if record is not None and record.watch[i, TOUCHED] > 0:
        ended(record, effects.half_length, rods, i, plate, step)


@kernel(inline=False)
def begun(record, half_length, rods, i, cap, a_z, plate, step):
    """Start a row as rod i touches the plate."""
    row = record.open[i]
    row[ROD], row[STEP], row[CAP] = i, step, cap
    row[FLIGHT] = step - row[LEFT]
    row[A_X], row[A_Z] = cap * half_length * rods[i, SINE], a_z
    for c in range(3):
        row[BEFORE + c] = rods[i, 4 + c]
    row[PLATE] = plate[1]
    row[APPROACH] = row[BEFORE + 1] - row[BEFORE + 2] * row[A_X] - plate[1]
    row[SHARED] = 0.0


@kernel
def watched_landing(record, effects, rods, i, others, lower, upper, plate, step, dt):
    """Follow the landing of a rod that the plate may push."""
    if record is None:
        return
    before = record.watch[i, TOUCHED]
    over = watched(record.watch[i], effects, lower, upper, dt)
    if over:
        ended(record, effects.half_length, rods, i, plate, step)
    elif record.watch[i, TOUCHED] > 0:
        if before == 0:
            cap = -1.0 if lower.normal >= upper.normal else 1.0
            begun(record, effects.half_length, rods, i, cap, lower.a_z, plate, step)
        if pushed(others, effects.gravity):
            record.open[i, SHARED] += 1
