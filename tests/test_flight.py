"""Flights over the plate: the first contact, never the take-off, never one missed; phase; rest."""

from math import asin, copysign, cos, pi, sin, sqrt

import mpmath
import numpy as np
import pytest
from numba import njit
from numpy.random import default_rng
from scipy.integrate import quad
from scipy.optimize import brentq

from impact.flight import TURN, advance, departure, landing, slide_to_lift

from .sampling import EPS

# Flights (M13)


@njit(error_model="numpy")
def _plain_gap(speed, phase, gamma, t):
    """Gap and slope as one would write them, in the frame of the laboratory."""
    rise = speed + gamma * np.cos(phase)
    height = gamma * np.sin(phase) + rise * t - t * t / 2
    return height - gamma * np.sin(phase + t), rise - t - gamma * np.cos(phase + t)


@njit(error_model="numpy")
def _certify(speed, phase, gamma):
    """Worst residual of landings, and how many are not the first contact.

    h'' >= -(1 + gamma) everywhere, so that from a gap h with slope h' the contact cannot come
    sooner than the parabola of that curvature falls to zero: steps of that length miss nothing.
    """
    worst, missed = 0.0, 0
    for i in range(speed.size):
        r, theta, fall = speed[i], phase[i], 1 + gamma[i]
        end, v = landing(departure(r, theta, gamma[i]), theta, gamma[i])
        h, slope = _plain_gap(r, theta, gamma[i], end)
        size = gamma[i] + (r + gamma[i]) * end + end * end
        worst = max(worst, abs(h) / size, abs(v - slope) / (fall + r + end))
        last = end - abs(v) / fall  # from here on the gap closes, by the same argument
        t = r / fall  # up to twice this time it opens
        missed += not (end > t and v <= 0)
        while t < last:
            h, slope = _plain_gap(r, theta, gamma[i], t)
            step = (slope + np.sqrt(slope * slope + 2 * fall * h)) / fall
            if not (h > 0 and t + step > t):  # stalls before a contact
                missed += 1
                break
            t += step
    return worst, missed


@pytest.mark.parametrize("number", [20_000, 1_000_000])
def test_no_landing_is_missed(number):
    """Departures are random, log-uniform in velocity and in gamma - 1."""
    random = default_rng(number)
    gamma = 1 + 10 ** random.uniform(-3, 1.5, number)
    speed = gamma * 10 ** random.uniform(-4, 1, number)
    worst, missed = _certify(speed, random.uniform(0, TURN, number), gamma)
    assert missed == 0
    assert worst < 16 * EPS  # a few roundings of the plain formula's terms


@pytest.mark.parametrize("speed", [1e-2, 1e-5, 1e-8, 1e-12])
@pytest.mark.parametrize("phase", [3.3, 4.7, 6.1])
def test_small_hop_is_not_the_take_off(speed, phase):
    """The hop 2 r/|h''(0)| is right to its last digits where the plain gap is rounding alone."""
    gamma = 2.5
    t, v = landing(departure(speed, phase, gamma), phase, gamma)
    guess = -2 * speed / (gamma * sin(phase) - 1)
    with mpmath.workdps(60):
        start = mpmath.mpf(phase)
        rise, height = speed + gamma * mpmath.cos(start), gamma * mpmath.sin(start)

        def rest(t):
            """The gap over t, which is not zero at the take-off."""
            return rise - t / 2 + (height - gamma * mpmath.sin(start + t)) / t

        exact = mpmath.findroot(rest, guess)
    # h''(0) = gamma sin(theta) - 1 and its slope are the data; two roundings of size (1 + gamma)
    assert abs(t - exact) < 4 * EPS * (1 + gamma) * exact
    assert v == pytest.approx(-speed, rel=6 * speed + 1e-14)


def test_grazing():
    """Time, not the state, jumps at the take-off velocity at which a rod just touches the plate.

    A touch costs nothing, so that the flight that continues from it ends where the other one ends;
    velocities there differ by the square root of the gap of some roundings.
    """
    gamma, touch = 3.0, 7.5  # where the rod is as fast as the plate, which falls away from it
    before = brentq(lambda t: _plain_gap(0.0, touch, gamma, t)[0], -2.6, -2.4, xtol=1e-15)
    phase = touch + before
    _, speed = _plain_gap(0.0, touch, gamma, before)
    early, late = (
        landing(departure(speed * (1 + way * 16 * EPS), phase, gamma), phase, gamma)
        for way in (-1, 1)
    )
    limit = 10 * sqrt(EPS * gamma * early[0] * 2 * (1 + gamma))
    assert early == pytest.approx((touch - phase, 0), abs=limit)
    assert early[1] <= 0
    rest_of_it, _ = landing(departure(0.0, touch, gamma), touch, gamma)
    # a change v of velocity, over rest_of_it, displaces by v rest_of_it; slope at the end is O(1)
    assert late[0] == pytest.approx(touch - phase + rest_of_it, abs=limit * rest_of_it)
    assert rest_of_it > 0.5


# Phase (M11)


@pytest.mark.parametrize("t", [0.1, 7.0, 2 * pi * 1e3, 1e6, 2 * pi * 1e6, 9e7])
@pytest.mark.parametrize("phase", [0.0, 1e-9, 1.0, 6.283185307179586])
def test_phase_of_a_long_step(t, phase):
    """The phase is that of exact arithmetic, without a multiple of the rounding error of 2 pi."""
    periods, there = advance(phase, t)
    with mpmath.workdps(60):
        exact = mpmath.mpf(t) + phase - 2 * mpmath.pi * periods
        assert abs(there - exact) < 1e-15 * TURN
    assert 0 <= there < TURN


# Rest


@pytest.mark.parametrize(
    ("phase", "c_x"), [(2.8, 0.2), (2.8, -0.9), (4.0, 5.0), (0.1, 1e-3), (5.5, -0.3)]
)
def test_friction_while_resting(phase, c_x):
    """Velocity and distance are those of integration, whether the slip stops on the way or not."""
    gamma, friction = 1.8, 0.3
    wait, end, distance = slide_to_lift(c_x, phase, gamma, friction)
    lift = asin(1 / gamma) + TURN * (phase > pi / 2)
    assert phase + wait == pytest.approx(lift, abs=1e-14)

    def speed(t):
        pressed = t + gamma * (cos(phase + t) - cos(phase))
        return max(abs(c_x) - friction * pressed, 0.0)

    assert end == pytest.approx(copysign(speed(wait), c_x), abs=1e-13)
    covered = quad(speed, 0, wait, limit=200, epsabs=1e-11)[0]
    assert distance == pytest.approx(copysign(covered, c_x), abs=1e-7)
    assert slide_to_lift(c_x, phase, gamma, 0.0)[1] == c_x  # without friction it slides on
    assert slide_to_lift(c_x, phase, gamma, 1e60)[1:] == (0.0, pytest.approx(0, abs=1e-50))
