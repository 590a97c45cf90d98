"""A rod left alone on the plate z = A sin(Omega t): it keeps its spin, turns in flight, and falls.

The paper's closure (`impact.bouncing`) has neighbours that take the spin and hold the tilt. Here
they let go: what a single rod does then shows how much of the closure is due to neighbours.

>>> from math import pi, radians
>>> from impact.falling import fall
>>> unit = 981 / (2 * pi * 60) ** 2  # g/Omega^2 at 60 Hz, in cm
>>> rod = {"length": 5.7 / unit, "diameter": 0.6 / unit}
>>> run = fall(radians(20), **rod, gamma=3.3, friction=0.3, restitution=0.65, rods=50)
>>> bool(run.fallen.all())
True

What is assumed:

- A free rigid rod in the plane. In flight its centre falls and its tilt turns uniformly; it lands
  where one of its two tips meets the plate, and the impact is the exact map with the spin it has.
- It has fallen when its other end touches the plate. A rod that is long against its hops then lies
  flat; a short one that is thrown high may instead have turned over (`fall` gives the last tilt).
  There the record ends: what follows is a clatter of both ends, with no tilt left to keep.
- A tilted rod on one tip has no rest: it topples while the tip presses, slips or sticks. A hop that
  may be shorter than `shortest_flight` is not followed; for that time the tip keeps to the plate,
  and one impact without restitution gives the impulse of normal and friction force. The error
  is of first order in `shortest_flight`, and a sequence of ever smaller hops ends.

It needs Numba, and seconds to compile: import it on request. Units inside: Omega = g = 1.
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ._arguments import POSITIVE, Domain, count, number
from ._impacts import LARGE_FRICTION, Regime
from ._jit import kernel
from .bouncing import record
from .compiled import KERNELS, Impacts
from .flight import TURN, advance, departure, gap
from .geometry import ContactGeometry, spherocylinder, thin_rod, tilt_domain

__all__ = ["Falls", "fall"]

_LENGTH = Domain(1e-3, 1e9, "between 1e-3 and 1e9 (g/Omega^2)")
_DIAMETER = Domain(0.0, 1e9, ">= 0 and at most length")
_FLIGHTS_A_CALL = 20_000  # some 40 ms: signals are seen between calls
_SHORTEST = Domain(1e-5, 0.1, "between 1e-5 and 0.1 (periods)")


class Falls(NamedTuple):
    """Fate of every rod, and its landings on the tip on which it was released.

    Shape (rods,) down to `tilt_end`, then (rods, landings) with nan (regime -1) after the last.
    Velocities in V_0 = A Omega and in the frame of the laboratory, omega in Omega, tilts in rad.
    """

    fallen: np.ndarray  # whether the other end touched the plate; else the record ended before
    landings: np.ndarray  # on the tip, until then
    time: np.ndarray  # from the release until then, in periods
    travel: np.ndarray  # distance in x from the release until then, in V_0 times a period
    tilt_end: np.ndarray  # then
    period: np.ndarray  # whole periods since the release's, exact
    phase: np.ndarray  # of the plate, theta in [0, 2 pi); its velocity is V_0 cos(theta)
    tilt: np.ndarray  # at the landing
    c_x: np.ndarray  # along the plate, before the landing
    c_z: np.ndarray  # across, before
    omega: np.ndarray  # before
    c_x_after: np.ndarray  # after it
    c_z_after: np.ndarray  # after it
    omega_after: np.ndarray  # after it
    flight: np.ndarray  # from take-off to this landing, in periods
    rest: np.ndarray  # with the tip on the plate before that take-off, in periods
    regime: np.ndarray  # codes of `impact.Regime`


class _Free(NamedTuple):
    """A rod that is let go and the plate under it."""

    gamma: float  # A Omega^2/g
    reach: float  # g/Omega^2, from the centre of mass to the centre of a cap
    cap: float  # g/Omega^2, its radius
    k: float  # g/Omega^2
    friction: float
    restitution: float
    shortest: float  # flight, rad of the plate's phase
    periods: float  # the most to follow


class _Swing(NamedTuple):
    """Rotation of a rod from a take-off on: its half axis, centre to centre of the tip's cap."""

    across: float  # reach sin(tilt)
    up: float  # reach cos(tilt)
    omega: float


@kernel
def _gaps(d, swing, t):
    """Gap and slope of the tip that left the plate, then of the other, a time t after departure.

    `d.speed` is the tip's velocity over the plate's, turning included. To the gap of a point comes
    up (1 - cos(omega t)) - across (omega t - sin(omega t)); both gaps are smooth functions of time,
    while the lower of them has a kink where the rod turns through 90 degrees.
    """
    h, slope = gap(d, t)
    turned = swing.omega * t
    sine, versine = np.sin(turned), 2 * np.sin(turned / 2) ** 2
    h += swing.up * versine - swing.across * (turned - sine)
    slope += swing.omega * (swing.up * sine - swing.across * versine)
    axis = swing.up * (1 - versine) - swing.across * sine  # reach cos(tilt) by now
    fall = swing.omega * (swing.up * sine + swing.across * (1 - versine))
    return h, slope, h + 2 * axis, slope - 2 * fall


@kernel
def _sure(h, slope, bend):
    """Time for which a gap stays open, its second derivative being at least -bend."""
    root = np.sqrt(slope * slope + 2 * bend * max(h, 0.0))
    return (slope + root) / bend if slope > 0 else 2 * h / (root - slope)


@kernel
def _touch(d, swing, bend, t):
    """First contact of either tip after t, where both are off the plate; |h''| <= bend.

    Steps of the time for which both gaps surely stay open miss nothing; towards a contact they
    converge as Newton's method does. Returns the time, h' of the tip and whether the other touches.
    """
    while True:
        h, slope, h_other, slope_other = _gaps(d, swing, t)
        step = min(_sure(h, slope, bend), _sure(h_other, slope_other, bend))
        if not t + step > t:  # a nan ends here too
            return t, slope, h_other < h
        t += step


@cache
def _loop(law: str):
    """Compile the motion of one rod under one law from release to fall; Omega = g = 1."""
    collide = KERNELS[law]

    @kernel
    def rod(state, free, out):
        """Fill one row of `out` per landing, from `Falls.period` on.

        Returns the `state` for the next call, whether the rod has fallen, whether it goes on.
        """
        phase, speed, c_x, tilt, period, omega, travel, rest, n = state
        gamma, reach, cap, k, friction, restitution, shortest, periods = free
        fallen, going = False, True
        for _ in range(_FLIGHTS_A_CALL):
            swing = _Swing(reach * np.sin(tilt), reach * np.cos(tilt), omega)
            d = departure(speed, phase, gamma)
            lift = d.lift + swing.up * omega * omega  # h''(0); |h'''| <= change
            change = gamma + reach * np.abs(omega) ** 3
            flies = speed + shortest * (lift / 2 - shortest * change / 6) > 0
            if flies:
                bend = 1 + gamma + reach * omega * omega
                t, v, fallen = _touch(d, swing, bend, shortest)
            else:
                t, v = shortest, speed + shortest * lift
                rest += t
            turns, phase = advance(phase, t)
            period += turns
            travel += c_x * t
            tilt += omega * t
            X, Z = reach * np.sin(tilt), reach * np.cos(tilt)
            fallen |= not flies and Z < 0  # lain down with the tip on the plate
            if fallen:
                going = False
                break
            before, spin, v = c_x, omega, v - omega * X
            epsilon = restitution if flies else 0.0
            hit = Impacts(before, v, spin, 0.0, X, Z + cap, k, friction, epsilon)
            c_x, c_z, omega, regime, _, _, _, speed, _ = collide(hit)
            if flies:
                plate = gamma * np.cos(phase)
                out[n, 0], out[n, 1], out[n, 2] = period, phase, tilt
                out[n, 3], out[n, 4], out[n, 5] = before, v + plate, spin
                out[n, 6], out[n, 7], out[n, 8] = c_x, c_z + plate, omega
                out[n, 9], out[n, 10], out[n, 11] = t / TURN, rest / TURN, regime
                n, rest = n + 1, 0.0
            going = n < out.shape[0] and period < periods
            if not going:
                break
        return (phase, speed, c_x, tilt, period, omega, travel, rest, n), fallen, going

    def whole(start, free, out):
        """Follow a rod from its release; returns the fields of `Falls` before `period`."""
        state, going = (*map(float, start), 0.0, 0.0, 0.0, 0.0, 0), True
        while going:
            state, fallen, going = rod(state, free, out)
        phase, _, _, tilt, period, _, travel, _, n = state
        return fallen, n, period + (phase - start[0]) / TURN, travel / TURN, tilt

    return whole


def _released(
    geometry: ContactGeometry, gamma: float, rods: int, transient: int, **setting: Any
) -> np.ndarray:
    """Phase, velocity over the plate's and c_x of every rod after `transient` held landings."""
    held = record(geometry, gamma=gamma, rods=rods, landings=1, transient=transient - 1, **setting)
    if not held.phase.size:
        return np.zeros((rods, 3))  # rests without end
    speed = gamma * (held.c_z_after - np.cos(held.phase))
    return np.hstack([held.phase, np.maximum(speed, 0), gamma * held.c_x_after])


def fall(
    tilt: float,
    *,
    length: float,
    diameter: float = 0.0,
    gamma: float,
    friction: float,
    restitution: float,
    rods: int = 1,
    seed: int = 0,
    law: str = "newton",
    transient: int = 100,
    landings: int = 500,
    periods: float = 1000.0,
    shortest_flight: float = 1e-3,
) -> Falls:
    """Release rods that have bounced at held tilt, and follow each until it has fallen.

    Parameters
    ----------
    tilt : at which the rod is held, from the vertical, rad, between -pi/2 and pi/2
    length : of the rod, caps included, in g/Omega^2 (A is gamma of them); 1e-3 to 1e9
    diameter : of its round caps, at most `length`, in the same unit; 0 is the thin rod
    gamma : A Omega^2/g, > 0 and at most 1e6
    friction : Coulomb coefficient, >= 0, inf allowed
    restitution : between 0 and 1, in the sense of `law`
    rods : independent rods, >= 1, given by `seed` and number as in `impact.bouncing.bounce`
    seed : >= 0
    law : "newton", "poisson" or "stronge", as in `impact.collide`
    transient : landings under the closure before the release, >= 1; the release follows the last
        of them, without spin. For gamma <= 1 rods are released at rest, at phase 0
    landings : the most of each rod that are followed, >= 1
    periods : time after which a rod that has not fallen is left, > 0
    shortest_flight : 1e-5 to 0.1 periods, the time step of a tip that stays on the plate. Small
        hops count as landings, before the release too, so that their number depends on it; times
        do within a few per cent

    Returns
    -------
    Falls
        All rods, with their single landings.

    Raises
    ------
    ValueError
        If an argument is out of its domain, nan included, or `law` is unknown.
    TypeError
        If an argument is not a single real number.

    Notes
    -----
    Not in the paper, whose rods are many. With restitution 1, or exactly upright, a rod need not
    fall; it is then left after `landings` or `periods`, with `fallen` false.
    """
    tilt = float(np.clip(number("tilt", tilt, tilt_domain(tilt)), -np.pi / 2, np.pi / 2))
    length = number("length", length, _LENGTH)
    diameter = number("diameter", diameter, _DIAMETER)
    landings, transient = count("landings", landings, 1), count("transient", transient, 1)
    periods = number("periods", periods, POSITIVE)
    shortest = TURN * number("shortest_flight", shortest_flight, _SHORTEST)
    geometry = spherocylinder(tilt, length, diameter) if diameter else thin_rod(tilt, length)
    setting = {"friction": friction, "restitution": restitution, "law": law, "seed": seed}
    setting["shortest_flight"] = shortest_flight
    starts = _released(geometry, gamma, rods, transient, **setting)

    reach, cap = (length - diameter) / 2, diameter / 2
    mu = min(float(friction), LARGE_FRICTION)
    free = _Free(float(gamma), reach, cap, geometry.k, mu, float(restitution), shortest, periods)
    out = np.full((len(starts), landings, 12), np.nan)
    ends = [_loop(law)((*start, tilt), free, row) for start, row in zip(starts, out, strict=True)]
    out[..., 3:5] /= gamma  # c_x, c_z
    out[..., 6:8] /= gamma
    fallen, landed, time, travel, tilt_end = map(np.array, zip(*ends, strict=True))
    *columns, regime = np.moveaxis(out, -1, 0)
    regime = np.where(np.isnan(regime), Regime.INVALID, regime).astype(np.int8)
    return Falls._make([fallen, landed, time, travel / gamma, tilt_end, *columns, regime])
