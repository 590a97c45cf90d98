"""Touches of the plate in space, compiled: recorded by `kernels.touches` in a vertical plane.

The plane is the one through the rod's axis as the touch begins, and stays until it ends. Its x axis
is horizontal and points around the annulus, counter-clockwise: its component that way is positive.
Of an upright rod, which lies in all vertical planes, x is the direction around the annulus itself.
Slip, spin and velocity have the parts that lie in the plane; friction has its full size.
"""

from math import sqrt

from ...cache import kernel
from ..codes import (
    C_X,
    C_Z,
    DIRECTOR,
    OMEGA,
    PLACE,
    ROW_COLUMNS,
    SINE,
    TURN,
    VELOCITY,
    WATCH_TOUCHED,
)
from ..contact import Effects, size, turning
from ..plate import Touch
from ..touches import CAP, LEAVING, recorded
from ..vectors import ZERO, along, cross, vector

ALONG = ROW_COLUMNS  # and the next: x and y of the plane's direction
FLAT = ROW_COLUMNS + 2  # columns of `forces.State.flat`: those of a row, then these


@kernel
def plane_of(flat, rods, i):
    """Choose the plane."""
    x, y, a, b = rods[i, PLACE], rods[i, PLACE + 1], rods[i, DIRECTOR], rods[i, DIRECTOR + 1]
    if a == 0.0 and b == 0.0:
        a, b = -y, x
    scale = 1.0 / sqrt(a * a + b * b)
    if x * b - y * a < 0.0:
        scale = -scale
    flat[i, ALONG], flat[i, ALONG + 1] = scale * a, scale * b


@kernel
def flatten(flat, effects, rods, i):
    """Put into `flat` what a record takes of the rod, and its angular velocity out."""
    x, y = flat[i, ALONG], flat[i, ALONG + 1]
    omega = turning(effects.rolling, vector(rods, i, TURN), vector(rods, i, DIRECTOR))
    flat[i, SINE] = rods[i, DIRECTOR] * x + rods[i, DIRECTOR + 1] * y
    flat[i, C_X] = rods[i, VELOCITY] * x + rods[i, VELOCITY + 1] * y
    flat[i, C_Z], flat[i, OMEGA] = rods[i, VELOCITY + 2], omega[1] * x - omega[0] * y
    return omega


@kernel
def in_plane(flat, i, cap, a_z):
    """What acts at a cap, as a row has it."""
    slip = cap.half[0] * flat[i, ALONG] + cap.half[1] * flat[i, ALONG + 1]
    force = size(cap.rub), cap.force
    return Touch(cap.overlap, (0.0, a_z), force, (0.0,), cap.rate, slip, cap.lost)


@kernel
def recorded_in_space(record, effects, state, i, pushed, touch, plate, clock):
    """Follow the touch of a rod; `pushed`: whether another rod or a wall pushes it."""
    if record is None:
        return
    (lower, upper), rods, flat = touch, state.rods, state.flat
    if record.watch[i, WATCH_TOUCHED] == 0:
        if lower.overlap <= 0.0 and upper.overlap <= 0.0:
            return
        plane_of(flat, rods, i)
    omega, count = flatten(flat, effects, rods, i), record.count[0]
    half, others = effects.half_length, (1.0 if pushed else 0.0, 0.0, 0.0)
    alone = Effects(half, effects.lightness, effects.normal, effects.friction, None, None)
    a_z = plate[0] - rods[i, PLACE + 2]
    caps = in_plane(flat, i, lower, a_z), in_plane(flat, i, upper, a_z)
    recorded(record, alone, flat, i, others, caps, plate, clock)
    if record.count[0] > count:  # the rod may have left the plane a little
        arm = along(ZERO, record.rows[count, CAP] * half, vector(rods, i, DIRECTOR))
        swing = cross(omega, arm)
        record.rows[count, LEAVING] = rods[i, VELOCITY + 2] + swing[2] - plate[1]
