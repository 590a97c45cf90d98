"""Flights of a turning rod: the first contact of either tip, never the take-off, none missed."""

from math import cos, sin, sqrt

import mpmath
import numpy as np
import pytest
from numba import njit

from impact.falling import _gaps, _Swing, _touch
from impact.flight import TURN, departure

from .test_flight import around_the_jump


def _gaps_with(sin, cos):
    """Both gaps as one would write them: centre over the tips' heights, in the laboratory."""

    def gaps(speed, phase, gamma, reach, tilt, omega, t):
        rise = speed + gamma * cos(phase) - omega * reach * sin(tilt)
        z = gamma * sin(phase) + reach * cos(tilt) + rise * t - t * t / 2
        z -= gamma * sin(phase + t)
        axis = reach * cos(tilt + omega * t)
        return z - axis, z + axis

    return gaps


_plain_gaps = njit(error_model="numpy")(_gaps_with(sin, cos))
_exact_gaps = _gaps_with(mpmath.sin, mpmath.cos)  # at the working precision


@njit(error_model="numpy")
def _scan(speed, phase, gamma, reach, tilt, omega, samples):
    """Worst residual at the contact found, and how many flights were in contact before it."""
    worst, missed = 0.0, 0
    for i in range(speed.size):
        take_off = speed[i], phase[i], gamma[i]
        turn = reach[i], tilt[i], omega[i]
        d = departure(*take_off)
        swing = _Swing(reach[i] * np.sin(tilt[i]), reach[i] * np.cos(tilt[i]), omega[i])
        bend = 1 + gamma[i] + reach[i] * omega[i] ** 2
        start = 1e-4 * speed[i] / bend  # certainly in the air: the hop lasts at least 2 speed/bend
        end, _, other = _touch(d, swing, bend, start)
        size = (speed[i] + gamma[i] + reach[i] * abs(omega[i])) * end + end * end
        size += 2 * (reach[i] + gamma[i])
        left = _plain_gaps(*take_off, *turn, end)
        worst = max(worst, abs(left[1] if other else left[0]) / size)
        for j in range(1, samples):
            t = start + (end - start) * j / samples
            missed += min(_plain_gaps(*take_off, *turn, t)) < -1e-14 * size
    return worst, missed


def _flights(number, seed):
    """Take-offs of every kind: short and long rods, slow and fast turns, both ways."""
    random = np.random.default_rng(seed)
    gamma = 10 ** random.uniform(-1, 1.3, number)
    reach = 10 ** random.uniform(-1, 3, number)
    tilt = random.uniform(-1.5, 1.5, number)
    omega = random.normal(size=number) * 10 ** random.uniform(-2, 0.5, number) / np.sqrt(reach)
    speed = gamma * 10 ** random.uniform(-2, 0.7, number)
    phase = random.uniform(0, TURN, number)
    return speed, phase, gamma, reach, tilt, omega


@pytest.mark.parametrize(
    ("number", "seed"), [(3000, 3), pytest.param(1_000_000, 4, marks=pytest.mark.slow)]
)
def test_no_landing_of_either_tip_is_missed(number, seed):
    worst, missed = _scan(*_flights(number, seed), 2000)
    assert missed == 0
    assert worst < 8 * np.finfo(float).eps


def test_contacts_against_many_digits():
    for take_off in np.transpose(_flights(40, 5)).tolist():
        speed, phase, gamma, reach, tilt, omega = take_off
        swing = _Swing(reach * sin(tilt), reach * cos(tilt), omega)
        bend = 1 + gamma + reach * omega**2
        d = departure(speed, phase, gamma)
        t, slope, other = _touch(d, swing, bend, 1e-4 * speed / bend)
        with mpmath.workdps(40):
            take_off = list(map(mpmath.mpf, take_off))
            exact = mpmath.findroot(lambda x: _exact_gaps(*take_off, x)[other], t)  # noqa: B023
            steep = mpmath.diff(lambda x: _exact_gaps(*take_off, x)[0], exact)  # noqa: B023
        # the data are rounded, reach cos(tilt) among them; divided by the slope of the gap
        size = (speed + gamma + reach * abs(omega)) * t + t * t + 2 * (reach + gamma)
        steepness = abs(_gaps(d, swing, t)[3 if other else 1])
        assert abs(t - exact) < 8 * np.finfo(float).eps * size / steepness
        assert slope == pytest.approx(float(steep), rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("speed", [1e-3, 1e-6, 1e-9])
def test_small_hop_is_not_the_take_off(speed):
    """The hop 2 r/|h''(0)| of a turning rod."""
    gamma, phase, reach, tilt, omega = 2.5, 4.7, 300.0, 0.5, 0.03
    swing = _Swing(reach * sin(tilt), reach * cos(tilt), omega)
    curvature = 1 - gamma * sin(phase) - reach * cos(tilt) * omega**2
    bend = 1 + gamma + reach * omega**2
    t, slope, other = _touch(departure(speed, phase, gamma), swing, bend, speed / bend)
    assert not other
    assert t == pytest.approx(2 * speed / curvature, rel=10 * speed + 1e-6)
    assert slope == pytest.approx(-speed, rel=10 * speed + 1e-6)


def test_grazing():
    """Across the take-off at which the tip just misses the plate: touched there without a speed."""
    gamma, phase, reach, tilt, omega = 3.0, 3.8, 50.0, 0.4, 0.02
    swing = _Swing(reach * sin(tilt), reach * cos(tilt), omega)
    bend = 1 + gamma + reach * omega**2

    def lands(speed):
        return _touch(departure(speed, phase, gamma), swing, bend, 1e-3)

    low, high = around_the_jump(lands)
    t, slope, _ = lands(low)
    assert abs(slope) < 10 * sqrt(np.finfo(float).eps * bend * reach)
    assert abs(_plain_gaps(high, phase, gamma, reach, tilt, omega, t)[0]) < 1e-12
    assert lands(high)[0] > t + 0.5
