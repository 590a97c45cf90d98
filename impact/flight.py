"""Flight of a point over the plate z = Gamma sin(theta), from one contact to the next, compiled.

Units: Omega = g = 1, so that time is phase, the plate's largest acceleration is Gamma and its
largest velocity V_0 = Gamma. With r the velocity with which the contact leaves the plate at the
phase theta, the gap after a time t and its slope are

    h(t)  = r t - t^2/2 + Gamma (sin(theta) + t cos(theta) - sin(theta + t)),   h(0) = 0,
    h'(t) = r - t + Gamma (cos(theta) - cos(theta + t)),

and h'' = Gamma sin(theta + t) - 1 changes sign only at the phases `lift` = asin(1/Gamma) and
pi - `lift`: between them the plate falls faster than the rod (h convex), elsewhere h is concave. On
each such interval the number of roots is known from its ends and tangents, and Newton's method
from the proper side runs monotonically into the first one; no root is missed and the one at t = 0
is never returned. It needs Numba: import it on request.
"""

from typing import NamedTuple

import numpy as np

from ._jit import kernel

TURN = 2 * np.pi
# 2 pi in two parts, of which multiples below 2^24 of the first are exact.
_TURN_HIGH = 6.283185303211212
_TURN_LOW = 3.968374318722162e-09
_STEPS = 500  # never reached: a root of order four, 1e-8 after take-off, takes 80


class Departure(NamedTuple):
    """State at the start of a flight; from rest on the plate `speed` is zero.

    `lift` is the first second derivative of the gap, Gamma sin(theta) - 1, kept apart because it is
    exactly zero where a resting rod takes off.
    """

    speed: float  # of the contact point, relative to the plate
    lift: float
    height: float  # Gamma sin(theta)
    climb: float  # Gamma cos(theta), the plate's velocity


@kernel
def departure(speed, phase, gamma):
    """Start of a flight at a phase; `speed`: velocity with which the rod leaves the plate."""
    height = gamma * np.sin(phase)
    return Departure(speed, height - 1, height, gamma * np.cos(phase))


@kernel
def lift_off(gamma):
    """Phase asin(1/gamma) at which a resting rod takes off, and that flight's start; gamma >= 1."""
    climb = np.sqrt((gamma - 1) * (gamma + 1))
    return np.arctan2(1.0, climb), Departure(0.0, 0.0, 1.0, climb)


@kernel
def gap(d, t):
    """Gap h and its slope h' a time t >= 0 after the departure d; to the last digits of small t."""
    if t >= 1:
        sine, cosine = np.sin(t), np.cos(t)
        h = d.speed * t - t * t / 2 + d.climb * (t - sine) + d.height * (1 - cosine)
        return h, d.speed - t + d.climb * (1 - cosine) + d.height * sine
    q = t * t
    f3 = 1 - q / 110 * (1 - q / 156 * (1 - q / 210 * (1 - q / 272)))
    f3 = t * q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * f3)))  # t - sin(t)
    f4 = 1 - q / 90 * (1 - q / 132 * (1 - q / 182 * (1 - q / 240)))
    f4 = q * q / 24 * (1 - q / 30 * (1 - q / 56 * f4))  # t^2/2 - 1 + cos(t)
    h = d.speed * t + d.lift * q / 2 + d.climb * f3 - d.height * f4
    return h, d.speed + d.lift * t + d.climb * (q / 2 - f4) - d.height * f3


@kernel
def _concave_root(d, guess, end):
    """Root in a concave interval with h(end) <= 0, other than the one at its start.

    The tangent lies above h, so that it cuts zero at or behind the root: from there on every step
    of Newton's method leads back towards it and never past it.
    """
    t = min(guess, end)
    h, slope = gap(d, t)
    if not slope < 0:
        t = end
        h, slope = gap(d, t)
    if h > 0:
        t = min(t - h / slope, end)
        h, slope = gap(d, t)
    for _ in range(_STEPS):
        step = h / slope
        if not (step > 0 and t - step < t):
            break
        t -= step
        h, slope = gap(d, t)
    return t, slope


@kernel
def _convex_root(d, t, end):
    """First root in a convex interval with h > 0 at its start t, or nan.

    The tangent lies below h: there is no root before it cuts zero, and where the slope is not
    negative any more there is none at all.
    """
    h, slope = gap(d, t)
    for _ in range(_STEPS):
        if h <= 0:
            return t, slope
        if slope >= 0:
            break
        step = h / slope
        if t - step > end:
            break
        if t - step == t:
            return t, slope
        t -= step
        h, slope = gap(d, t)
    return np.nan, np.nan


@kernel
def landing(d, phase, gamma):
    """Time from the departure d, at `phase`, to the next contact, and h' <= 0 there.

    Needs gamma > 1 and a departure that leaves the plate: speed > 0, or speed = 0 where the plate
    falls away. A contact that only grazes the plate may or may not count, within rounding.
    """
    lift, free = lift_off(gamma)
    top = np.arctan(free.climb)  # convex within +-top of pi/2
    if d.lift > 0 or (d.lift == 0 and d.climb > 0):
        start = max(np.pi / 2 + top - phase, 0.0)  # the gap only grows before
        end = lift + TURN - phase
    else:
        start = 0.0
        end = lift - phase if phase < lift else lift + TURN - phase
    while True:
        h, slope = gap(d, end)
        if not h > 0:  # a nan ends here too
            if start == 0:
                guess = -2 * d.speed / d.lift
            else:
                h_start, _ = gap(d, start)
                guess = start + (end - start) * (h_start / (h_start - h))
            return _concave_root(d, guess if guess > 0 else end, end)
        if h + 1 > gamma:  # above the plate's highest place: skip the periods that pass there
            fall = slope + free.climb
            above = fall + np.sqrt(fall * fall + 2 * (h + 1 - gamma))
            periods = np.floor(above / TURN)
            if periods >= 1:
                end += periods * TURN
        t, slope = _convex_root(d, end, end + 2 * top)
        if t == t:
            return t, slope
        start = end + 2 * top
        end += TURN


@kernel
def advance(phase, t):
    """Whole periods passed and phase in [0, 2 pi) after a time t; the phase is rounded once."""
    total = phase + t
    lost = t - (total - phase) if phase > t else phase - (total - t)
    periods = np.floor(total / TURN)
    phase = (total - periods * _TURN_HIGH) - periods * _TURN_LOW + lost
    if phase < 0:
        return periods - 1, max(phase + TURN, 0.0)
    if phase >= TURN:
        return periods + 1, phase - TURN
    return periods, phase


@kernel
def slide_to_lift(c_x, phase, gamma, friction):
    """Motion at rest on the plate until it falls away: waiting time, final c_x, distance slid.

    The tilt is held, the contact presses with 1 - gamma sin(theta) per unit mass, and Coulomb
    friction slows c_x down: in units of the friction coefficient |c_x| obeys the equation of the
    slope h', and the distance that of the gap h.
    """
    lift, _ = lift_off(gamma)
    wait = max(lift - phase, 0.0) if phase < np.pi / 2 else lift + TURN - phase
    if friction == 0 or c_x == 0:
        return wait, c_x, c_x * wait
    side = np.copysign(friction, c_x)
    d = departure(abs(c_x) / friction, phase, gamma)
    distance, speed = gap(d, wait)
    if speed > 0:
        return wait, side * speed, side * distance
    low, high = 0.0, wait  # it stops on the way: Newton's method, halving where that leads out
    t = min(d.speed / max(-d.lift, d.speed / wait), wait)
    for _ in range(100):
        distance, speed = gap(d, t)
        if speed > 0:
            low = t
        else:
            high = t
        there = t - speed / (d.height * np.cos(t) + d.climb * np.sin(t) - 1)
        if not low <= there <= high:
            there = (low + high) / 2
        if abs(there - t) <= 1e-15 * t:
            break
        t = there
    return wait, 0.0, side * distance
