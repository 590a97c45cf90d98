"""One impact under Newton's law, written by hand: what the generated kernel is measured against.

Used by the benchmark alone. `collide` does the arithmetic of `compiled.collide_newton` in the same
order, and so gives the same bits; `collide_plain` leaves out the compensated sums and products, and
so shows what the last digits cost. Both are compiled with the options of the generated kernel.
"""

from math import copysign

from numba import njit

from ._kernel import HUGE_FRICTION
from .compiled import _fused as fma
from .compiled import collide_newton

_options = {key: on for key, on in collide_newton.targetoptions.items() if key != "nopython"}
_compiled = njit(**_options)


@_compiled
def _sum_error(a, b, s):
    part = s - a
    return (a - (s - part)) + (b - part)


@_compiled
def _approach(c_x, c_z, omega, V_z, X, Z):
    turn, lift, fall = omega * Z, omega * X, c_z - V_z
    fall_error = _sum_error(c_z, -V_z, fall)
    u = (c_x - turn) - fma(omega, Z, -turn)
    return u, (fall + lift) + (fall_error + fma(omega, X, -lift))


@_compiled
def _responses(X, Z, k, mu):
    kk, xx, zz, xz = k * k, X * X, Z * Z, X * Z
    kk_error, xz_error = fma(k, k, -kk), fma(X, Z, -xz)
    across, along = kk + xx, kk + zz
    across_error = _sum_error(kk, xx, across) + (kk_error + fma(X, X, -xx))
    along_error = _sum_error(kk, zz, along) + (kk_error + fma(Z, Z, -zz))
    press, hold = mu * xz, mu * along
    press_error = fma(mu, xz, -press) + mu * xz_error
    hold_error = fma(mu, along, -hold) + mu * along_error
    return (
        (across + press) + (across_error + press_error),
        (xz + hold) + (xz_error + hold_error),
        (across - press) + (across_error - press_error),
        (xz - hold) + (xz_error - hold_error),
        across + across_error,
        along + along_error,
    )


@_compiled
def _plain_approach(c_x, c_z, omega, V_z, X, Z):
    return c_x - omega * Z, (c_z - V_z) + omega * X


@_compiled
def _plain_responses(X, Z, k, mu):
    across, along = k * k + X * X, k * k + Z * Z
    press, hold = mu * (X * Z), mu * along
    return across + press, X * Z + hold, across - press, X * Z - hold, across, along


def _kernel(approach, responses):
    @_compiled
    def collide(c_x, c_z, omega, V_z, X, Z, k, mu, e):
        u, v = approach(c_x, c_z, omega, V_z, X, Z)
        side = copysign(1.0, X * Z if u == 0 else u)
        X, u = side * X, abs(u)
        mu = mu if mu < HUGE_FRICTION else HUGE_FRICTION
        N, T, N_back, T_back, K_x, K_z = responses(X, Z, k, mu)
        hits, sticks = v < 0, T_back <= 0
        slides = (u * N + (1 + e) * v * T >= 0) & (u > 0) & (N > 0)
        held = sticks & (not slides)
        kk, xz, v_f = k * k, X * Z, -e * v

        j_slide = -((1 + e) * v / N)  # quotients by k^2 + X^2 +- mu X Z or mu (k^2 + Z^2) + X Z
        j_stop = u / (T if u > 0 else 1.0)
        j_back = (v_f - (v + N * j_stop)) / N_back
        first = j_slide if slides else j_stop
        second = 0.0 if slides else j_back
        slip_x, slip_z = kk * mu * (second - first), kk * (first + second)
        slip_spin = first * (X + Z * mu) + second * (X - Z * mu)

        gain, inertia = v_f - v, K_x + Z * Z
        stick_x = (xz * gain - u * K_x) / inertia
        stick_z = (gain * K_z - xz * u) / inertia
        stick_spin = (X * gain + Z * u) / inertia
        least = kk * j_stop
        at_least = stick_z if stick_z > least else least
        stick_z = at_least if xz > 0 else stick_z

        P_x = stick_x if held else slip_x
        P_z = stick_z if held else slip_z
        spin = stick_spin if held else slip_spin
        u_slide, u_back = u - T * j_slide, -T_back * j_back
        u_slide = u_slide if u_slide > 0 else 0.0
        u_back = u_back if u_back < 0 else 0.0
        u_f = u_slide if slides else u_back
        u_f = 0.0 if held else u_f
        energy = 0.5 * (P_x * (u + u_f) + P_z * (v + v_f))
        stopped = 2 if sticks else 3
        regime = 1 if slides else stopped

        P_x = side * P_x if hits else 0.0
        P_z = P_z if hits else 0.0
        spin = side * spin if hits else 0.0
        regime = regime if hits else 0
        slip = side * (u_f if hits else u)
        normal = v_f if hits else v
        energy = energy if hits else 0.0
        return c_x + P_x, c_z + P_z, omega + spin, regime, P_x, P_z, slip, normal, energy

    return collide


collide = _kernel(_approach, _responses)
collide_plain = _kernel(_plain_approach, _plain_responses)
