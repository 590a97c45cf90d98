"""Branch rule and three laws of one impact: one text for arrays and for compiled scalars.

In the mirror frame in which the contact point slips forward (u_0 >= 0), with N and T of
`slip_response`, and u_f what a slide would leave of the slip:

    slide          N > 0, u_0 > 0 and u_f = u_0 + (1 + restitution) v_0 T/N >= 0
    slip-stick     else, where X Z <= mu (k^2 + Z^2)
    slip reversal  else

It holds inside the Painleve region (N <= 0) too, where slip always stops and friction always
holds. Where u_0 = 0 the mirror is chosen such that X Z >= 0. An impact is the impulse of one phase
of forward slip and of what follows its stop, if it does: sticking or backward slip. All phases are
computed for every impact and the right ones selected: no branch to mispredict, and the same text
for NumPy and Numba.

A name with `_low` is what the rounded number of that name lacks; it enters to first order.
"""

from collections.abc import Callable
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from ._compensated import approach, lacking, responses
from ._generated import (
    energy_change,
    poisson_early,
    poisson_late,
    reverse,
    slide,
    slip,
    slopes,
    stick,
    stick_response,
    stop,
    stronge_early,
    stronge_late,
)
from .geometry import ContactGeometry

# Friction beyond this gives the same impact to the last digit; it stands in for infinity, which
# is thereby the limit of large friction.
HUGE_FRICTION = 2.0**960

# Plain arithmetic neither over- nor underflows while lengths and speeds lie between these and
# friction is below the last.
SMALL, LARGE, LARGE_FRICTION = 1e-70, 1e70, 1e60

select, larger, smaller = np.where, np.maximum, np.minimum


class Regime(IntEnum):
    """What the contact point does during an impact."""

    INVALID = -1  # an argument is nan or out of its domain
    NO_IMPACT = 0  # the contact point does not approach the plate
    SLIDE = 1  # slips until it separates
    SLIP_STICK = 2  # stops and is held by friction
    SLIP_REVERSAL = 3  # stops and slips back


def as_regime(codes: Any) -> Any:
    """One code as a `Regime`; an array of them as it is."""
    return Regime(int(codes)) if np.ndim(codes) == 0 else codes


class Impacts(NamedTuple):
    """Arguments of one impact, or of many as arrays; a unit of length and one of time of choice."""

    c_x: Any  # length/time
    c_z: Any  # length/time
    omega: Any  # rad/time
    plate_velocity: Any  # length/time
    X: Any  # length
    Z: Any  # length
    k: Any  # length
    friction: Any  # Coulomb coefficient
    restitution: Any  # 0 to 1

    def collide(self, function: Callable, law: str = "newton") -> Any:
        """What a function with the signature of `impact.collide` makes of them.

        Parameters
        ----------
        function : `impact.collide` or its like
        law : of restitution
        """
        c_x, c_z, omega, V_z, *arms, mu, epsilon = self
        given = {"geometry": ContactGeometry(*arms), "friction": mu, "restitution": epsilon}
        return function(c_x, c_z, omega, plate_velocity=V_z, law=law, **given)


class Approach(NamedTuple):
    """What decides the regime, in the mirror frame (side = +-1 leads back)."""

    side: Any
    u_0: Any
    v_0: Any
    mu: Any
    N: Any
    T: Any
    N_back: Any
    T_back: Any
    K: Any
    K_z: Any
    u_low: Any
    v_low: Any
    N_low: Any
    T_low: Any
    v_f: Any  # of a slide, and of Newton's law; gain = v_f - v_0
    gain: Any
    gain_low: Any
    j_slide: Any
    u_slide: Any
    hits: Any
    slides: Any
    sticks: Any


def ordinary(given):
    """Whether an impact is valid and far from over- and underflow; false if there is a nan."""
    c_x, c_z, omega, V_z, X, Z, k, mu, epsilon = given
    size = np.abs(X) + np.abs(Z) + k
    speed = np.abs(c_x) + np.abs(c_z) + np.abs(V_z) + np.abs(omega) * size
    sized = (k > 0) & (size > SMALL) & (size < LARGE) & (speed > SMALL) & (speed < LARGE)
    return sized & (mu >= 0) & (mu < LARGE_FRICTION) & (epsilon >= 0) & (epsilon <= 1)


def judged(side, velocities, mu, epsilon, found):
    """Apply the branch rule to a contact in the mirror frame.

    `found` are its responses, as `_compensated.responses` gives them. For a contact of any
    mobilities A, B, C the rod's k^2 counts as one, K as A C - B^2 and K_z as C.
    """
    u_0, v_0, u_low, v_low = velocities
    N, T, N_back, T_back, K, K_z, N_low, T_low = found
    v_f = -epsilon * v_0
    gain = v_f - v_0
    gain_low = (v_f - (gain + v_0)) - (1 + epsilon) * v_low
    j_slide, u_slide = slide(gain, u_0, N, T)
    j_low = lacking(j_slide, gain_low, N, N_low)
    u_slide = u_slide + ((u_low - T_low * j_slide) - T * j_low)
    j_slide = j_slide + j_low
    hits = v_0 < 0
    slides = (u_slide >= 0) & (u_0 > 0) & (N > 0)
    sticks = T_back <= 0
    # fmt: off
    return Approach(
        side, u_0, v_0, mu, N, T, N_back, T_back, K, K_z,
        u_low, v_low, N_low, T_low,
        v_f, gain, gain_low, j_slide, u_slide, hits, slides, sticks,
    )
    # fmt: on


def mirrored(given):
    """Mirror the impact of a rod to u_0 >= 0 and apply the branch rule."""
    c_x, c_z, omega, V_z, X, Z, k, mu, epsilon = given
    u_0, v_0, u_low, v_low = approach(c_x, c_z, omega, V_z, X, Z)
    side = np.copysign(1.0, select(u_0 == 0, X * Z, u_0))
    mu = smaller(mu, HUGE_FRICTION)
    velocities = np.abs(u_0), v_0, side * u_low, v_low
    return judged(side, velocities, mu, epsilon, responses(side * X, Z, k, mu))


def regime_of(a):
    """Codes of `Regime` that the branch rule gives."""
    return select(a.hits, select(a.slides, 1, 3 - a.sticks), 0)


def newton(a, k, epsilon, j_1, rise, rise_low):
    """v_f, v_f - v_0 and its low part under kinematic restitution."""
    return a.v_f, a.gain, a.gain_low


def _gain(a, v_f):
    """v_f, v_f - v_0 and its low part under a law that gives v_f where the slip stops."""
    v_f = select(a.slides, a.v_f, v_f)
    gain = v_f - a.v_0
    return v_f, gain, (v_f - (gain + a.v_0)) - a.v_low


def _slopes(a, k, j_1, rise, rise_low):
    """Coefficients w, r of the phase after the stop; v_1, and v_1 within its bounds."""
    after = select(a.sticks, stick_response(k, a.K, a.K_z), a.N_back)
    w, r = slopes(j_1, a.N, after)
    v_1 = (a.v_0 + rise) + (a.v_low + rise_low)
    return w, r, v_1, smaller(larger(v_1, 0.0), a.v_f)  # rounding at the slide's edge


def poisson(a, k, epsilon, j_1, rise, rise_low):
    """v_f, v_f - v_0 and its low part under kinetic restitution."""
    w, r, v_1, late = _slopes(a, k, j_1, rise, rise_low)
    early = poisson_early(epsilon, v_1, w)
    return _gain(a, select(v_1 < 0, early, poisson_late(epsilon, a.v_0, late, r)))


def stronge(a, k, epsilon, j_1, rise, rise_low):
    """v_f, v_f - v_0 and its low part under energetic restitution."""
    w, r, v_1, late = _slopes(a, k, j_1, rise, rise_low)
    early = stronge_early(epsilon, a.v_0, v_1, w)
    return _gain(a, np.sqrt(select(v_1 < 0, early, stronge_late(epsilon, a.v_0, late, r))))


def phases(final_velocity, a, k, epsilon):
    """Impulses over k^2 of forward slip and of what follows it; contact velocities afterwards."""
    u_0, v_0 = a.u_0, a.v_0
    T = select(u_0 > 0, a.T, 1.0)  # without slip nothing is divided by T, which may be 0

    j_stop, rise = stop(u_0, a.N, T)
    j_low = lacking(j_stop, a.u_low, T, a.T_low)
    rise_low = a.N_low * j_stop + a.N * j_low
    j_stop = j_stop + j_low
    v_f, gain, gain_low = final_velocity(a, k, epsilon, j_stop, rise, rise_low)
    # v_f - v_1: nothing pulls, though rounding may; so P_z > 0, and the way back is backward
    rest = larger((gain - rise) + (gain_low - rise_low), 0.0)
    j_2, u_back = reverse(rest, select(a.sticks, a.K, a.N_back), larger(a.T_back, 0.0))
    j_1, j_2 = select(a.slides, a.j_slide, j_stop), select(a.slides, 0.0, j_2)
    u_f = select(a.hits, select(a.slides, a.u_slide, u_back), u_0)
    return j_1, j_2, u_f, select(a.hits, v_f, v_0)


def added(a, j_1, j_2, forward, back, held):
    """Sum over the phases of what a unit of each one's impulse gives; 0 without an impact."""
    return select(a.hits, select(a.sticks, held, back) * j_2 + forward * j_1, 0.0)


def impact(final_velocity, given):
    """State after an impact under the law `final_velocity`; the fields of `Collision`."""
    c_x, c_z, omega, _, X, Z, k, _, epsilon = given
    a = mirrored(given)
    X = a.side * X
    j_1, j_2, u_f, v_f = phases(final_velocity, a, k, epsilon)

    push, lift, turn, back = slip(X, Z, k, a.mu)
    push_held, lift_held, turn_held = stick(X, Z, a.K_z)
    P_x = added(a, j_1, j_2, -push, push, push_held)
    P_z = added(a, j_1, j_2, lift, lift, lift_held)
    spin = added(a, j_1, j_2, turn, back, turn_held)
    return (
        c_x + a.side * P_x,
        c_z + P_z,
        omega + a.side * spin,
        regime_of(a),
        a.side * P_x,
        P_z,
        a.side * u_f,
        v_f,
        energy_change(P_x, P_z, a.u_0, a.v_0, u_f, v_f),
    )
