"""The branch rule and the three laws of one impact, as one body for arrays and compiled scalars.

In the mirror frame in which the contact point slips forward (u_0 >= 0), with N and T of
`slip_response`, and without a division:

    slide          N > 0, u_0 > 0 and u_0 N + (1 + restitution) v_0 T >= 0
    slip-stick     else, where X Z <= mu (k^2 + Z^2)
    slip reversal  else

It holds inside the Painleve region (N <= 0) too, where slip always stops and friction always
holds. Where u_0 = 0 the mirror is chosen such that X Z >= 0. Every regime is computed for every
impact and the right one selected: no branch to mispredict, and the same text for NumPy and Numba.
"""

from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from ._compensated import approach, responses
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


class Approach(NamedTuple):
    """What decides the regime, in the mirror frame (side = +-1 leads back)."""

    side: Any
    X: Any
    u_0: Any
    v_0: Any
    mu: Any
    N: Any
    T: Any
    N_back: Any
    T_back: Any
    K_x: Any
    K_z: Any
    hits: Any
    slides: Any
    sticks: Any


def ordinary(c_x, c_z, omega, V_z, X, Z, k, mu, epsilon):
    """Whether an impact is valid and far from over- and underflow; false if there is a nan."""
    size = np.abs(X) + np.abs(Z) + k
    speed = np.abs(c_x) + np.abs(c_z) + np.abs(V_z) + np.abs(omega) * size
    sized = (k > 0) & (size > SMALL) & (size < LARGE) & (speed > SMALL) & (speed < LARGE)
    return sized & (mu >= 0) & (mu < LARGE_FRICTION) & (epsilon >= 0) & (epsilon <= 1)


def mirrored(c_x, c_z, omega, V_z, X, Z, k, mu, epsilon):
    """Mirror the impact to u_0 >= 0 and apply the branch rule."""
    u_0, v_0 = approach(c_x, c_z, omega, V_z, X, Z)
    side = np.copysign(1.0, select(u_0 == 0, X * Z, u_0))
    X, u_0 = side * X, np.abs(u_0)
    mu = smaller(mu, HUGE_FRICTION)
    N, T, N_back, T_back, K_x, K_z = responses(X, Z, k, mu)
    hits = v_0 < 0
    slides = (u_0 * N + (1 + epsilon) * v_0 * T >= 0) & (u_0 > 0) & (N > 0)
    sticks = T_back <= 0
    return Approach(side, X, u_0, v_0, mu, N, T, N_back, T_back, K_x, K_z, hits, slides, sticks)


def regime_of(a):
    """Codes of `Regime`."""
    stopped = select(a.sticks, 2, 3)
    return select(a.hits, select(a.slides, 1, stopped), 0)


def newton(a, Z, k, epsilon, v_1):
    """v_f of an impact in which the slip stops: kinematic restitution."""
    return -epsilon * a.v_0


def _slopes(a, Z, k, epsilon, v_1):
    """w, r of the phase after the stop, and v_1 as far as a late stop allows."""
    w, r = slopes(a.u_0, a.N, a.T, select(a.sticks, stick_response(Z, k, a.K_x, a.K_z), a.N_back))
    w = select(a.u_0 > 0, w, 0.0)
    late = smaller(larger(v_1, 0.0), -epsilon * a.v_0)  # rounding at the slide's edge
    return w, r, late


def poisson(a, Z, k, epsilon, v_1):
    """v_f of an impact in which the slip stops: kinetic restitution."""
    w, r, late = _slopes(a, Z, k, epsilon, v_1)
    early = poisson_early(epsilon, v_1, w)
    return select(v_1 < 0, early, poisson_late(epsilon, a.v_0, late, r))


def stronge(a, Z, k, epsilon, v_1):
    """v_f of an impact in which the slip stops: energetic restitution."""
    w, r, late = _slopes(a, Z, k, epsilon, v_1)
    early = stronge_early(epsilon, a.v_0, v_1, w)
    return np.sqrt(select(v_1 < 0, early, stronge_late(epsilon, a.v_0, late, r)))


def impact(final_velocity, c_x, c_z, omega, V_z, X, Z, k, mu, epsilon):
    """State after an impact under the law `final_velocity`; the fields of `Collision`."""
    a = mirrored(c_x, c_z, omega, V_z, X, Z, k, mu, epsilon)
    X, u_0, v_0 = a.X, a.u_0, a.v_0
    held = a.sticks & ~a.slides
    T = select(u_0 > 0, a.T, 1.0)  # without slip nothing is divided by T, which may be 0

    j_slide, u_slide = slide(epsilon, u_0, v_0, a.N, a.T)
    j_stop, v_1 = stop(u_0, v_0, a.N, T)
    v_stop = final_velocity(a, Z, k, epsilon, v_1)
    j_back, u_back = reverse(v_1, v_stop, a.N_back, a.T_back)
    slip_x, slip_z, slip_spin = slip(
        X, Z, k, a.mu, select(a.slides, j_slide, j_stop), select(a.slides, 0.0, j_back)
    )
    stick_x, stick_z, stick_spin = stick(X, Z, a.K_x, a.K_z, u_0, v_0, v_stop)
    # The contact cannot end with less impulse than it took to stop; keeps P_z > 0 in rounding.
    stick_z = select(X * Z > 0, larger(stick_z, k * k * j_stop), stick_z)

    P_x = select(held, stick_x, slip_x)
    P_z = select(held, stick_z, slip_z)
    spin = select(held, stick_spin, slip_spin)
    u_f = select(held, 0.0, select(a.slides, larger(u_slide, 0.0), smaller(u_back, 0.0)))
    v_f = select(a.slides, -epsilon * v_0, v_stop)
    energy = select(a.hits, energy_change(P_x, P_z, u_0, v_0, u_f, v_f), 0.0)
    P_x = select(a.hits, a.side * P_x, 0.0)
    P_z = select(a.hits, P_z, 0.0)
    return (
        c_x + P_x,
        c_z + P_z,
        omega + select(a.hits, a.side * spin, 0.0),
        regime_of(a),
        P_x,
        P_z,
        a.side * select(a.hits, u_f, u_0),
        select(a.hits, v_f, v_0),
        energy,
    )
