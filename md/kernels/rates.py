"""Equations of one contact between two switches, compiled, for `md.reference`."""

from math import cos, pi, sin, sqrt
from typing import NamedTuple

from ..cache import kernel
from .codes import STICK
from .contact import dashpot, tangential_constants
from .state import weight


class Slip(NamedTuple):
    """What friction acts on in a contact."""

    now: float  # sqrt(g d)
    drive: float  # g; its acceleration without friction
    mass: float  # m; the contact's tangential mass


@kernel
def plate_after(vibration, t):
    """Displacement of the plate since t = 0, and its velocity."""
    if vibration is None:
        return 0.0, 0.0
    amplitude, frequency, phase = vibration
    half = pi * frequency * t  # sin(a + 2 b) - sin(a) = 2 cos(a + b) sin(b)
    velocity = 2 * pi * frequency * amplitude * cos(phase + 2 * half)
    return 2 * amplitude * cos(phase + half) * sin(half), velocity


@kernel
def held(spring, mode, overlap, limit, length, slip):
    """F_t, the spring's rate and what is left of the friction before the mode changes."""
    if spring is None:
        stick = -slip.drive * slip.mass
        if mode == STICK:
            return stick, 0.0, limit - abs(stick)
        return -mode * limit, 0.0, mode * slip.now
    k, g = tangential_constants(spring, overlap, slip.mass)
    free = -(k * length + g * slip.now)
    if mode == STICK:
        return free, slip.now, limit - abs(free)
    return -mode * limit, (mode * limit - k * length) / g, -mode * free - limit


@kernel
def rubbing(friction, mode, overlap, force, length, slip):
    """The same, with or without friction."""
    if friction is None:
        return 0.0, 0.0, 1.0
    return held(friction.spring, mode, overlap, friction.coefficient * force, length, slip)


@kernel
def end_of(plastic, left, rate):
    """What crosses zero where the force ends; a plastic contact ends with the approach."""
    return left if plastic is None else -rate


@kernel
def rates(effects, vibration, start, mode, t, y, out):
    """Derivatives of y = (x, z and tilt since the touch, c_x, c_z, omega, spring, P_z).

    Returns what signals the end of the force, what is left before the mode changes, the overlap
    and the slip. `start`: sin and cos of the tilt and height over the contact point at the touch.
    """
    sine, cosine, height = start
    g_x, g_z = weight(effects.gravity, (0.0, 0.0))
    rise, plate = plate_after(vibration, t)
    bend, lag = sin(y[2] / 2), cos(y[2] / 2)
    lean = sine * lag + cosine * bend  # sin(tilt_0 + turn/2)
    overlap = rise - y[1] - 2 * effects.half_length * lean * bend
    a_x = -effects.half_length * (sine * cos(y[2]) + cosine * sin(y[2]))
    a_z = rise - y[1] - height
    rate = y[4] - y[5] * a_x - plate
    slip = y[3] + y[5] * a_z
    force, left, rub, stretch, spare = 0.0, overlap, 0.0, 0.0, 1.0
    if overlap > 0:
        root, normal = sqrt(overlap), effects.normal
        mass = 1 / (1 + a_x * a_x * effects.lightness)
        c = dashpot(normal, overlap, root, mass)
        left = overlap - c * rate / (normal.stiffness * root)
        force = max(normal.stiffness * root * left, 0.0)
        left = end_of(normal.plastic, left, rate)
        drive = g_x + -a_x * force * effects.lightness * a_z + y[5] * (plate - y[4])
        seen = Slip(slip, drive, 1 / (1 + a_z * a_z * effects.lightness))
        rub, stretch, spare = rubbing(effects.friction, mode, overlap, force, y[6], seen)
    out[0], out[1], out[2] = y[3], y[4], y[5]
    out[3], out[4] = g_x + rub, g_z + force
    out[5] = (a_z * rub - a_x * force) * effects.lightness
    out[6], out[7] = stretch, force
    return left, spare, overlap, slip
