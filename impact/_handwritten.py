"""One impact under Newton's law, written by hand: what the generated kernel is measured against.

Used by the benchmark alone. `collide` does the arithmetic of `compiled.collide_newton` in the same
order, and so gives the same bits; `collide_plain` leaves out the compensated sums and products, and
so shows what the last digits cost.
"""

from math import copysign

from numba import njit

from ._kernel import HUGE_FRICTION
from .compiled import _fused as fma
from .compiled import collide_newton

_options = {k: v for k, v in collide_newton.targetoptions.items() if k != "nopython"}
_same_options = njit(**_options)


@_same_options
def _sum_error(a, b, s):
    part = s - a
    return (a - (s - part)) + (b - part)


@_same_options
def _approach(c_x, c_z, omega, V_z, X, Z):
    turn, lift = omega * Z, omega * X
    u, fall = c_x - turn, c_z - V_z
    v = fall + lift
    u_error = _sum_error(c_x, -turn, u) - fma(omega, Z, -turn)
    v_error = _sum_error(fall, lift, v) + _sum_error(c_z, -V_z, fall) + fma(omega, X, -lift)
    return u + u_error, v + v_error


@_same_options
def _responses(X, Z, k, mu):
    kk, xx, zz, xz = k * k, X * X, Z * Z, X * Z
    kk_error, xz_error = fma(k, k, -kk), fma(X, Z, -xz)
    across, along = kk + xx, kk + zz
    across_error = _sum_error(kk, xx, across) + (kk_error + fma(X, X, -xx))
    along_error = _sum_error(kk, zz, along) + (kk_error + fma(Z, Z, -zz))
    press, hold = mu * xz, mu * along
    press_error = fma(mu, xz, -press) + mu * xz_error
    hold_error = fma(mu, along, -hold) + mu * along_error
    N, N_back = across + press, across - press
    T, T_back = xz + hold, xz - hold
    return (
        N + (_sum_error(across, press, N) + (across_error + press_error)),
        T + (_sum_error(xz, hold, T) + (xz_error + hold_error)),
        N_back + (_sum_error(across, -press, N_back) + (across_error - press_error)),
        T_back + (_sum_error(xz, -hold, T_back) + (xz_error - hold_error)),
    )


@_same_options
def _plain_approach(c_x, c_z, omega, V_z, X, Z):
    return c_x - omega * Z, (c_z - V_z) + omega * X


@_same_options
def _plain_responses(X, Z, k, mu):
    across, along = k * k + X * X, k * k + Z * Z
    press, hold = mu * (X * Z), mu * along
    return across + press, X * Z + hold, across - press, X * Z - hold


def _kernel(approach, responses):
    @_same_options
    def collide(c_x, c_z, omega, V_z, X, Z, k, mu, e):
        u, v = approach(c_x, c_z, omega, V_z, X, Z)
        side = copysign(1.0, X * Z if u == 0 else u)
        X, u = side * X, abs(u)
        mu = mu if mu < HUGE_FRICTION else HUGE_FRICTION
        N, T, N_back, T_back = responses(X, Z, k, mu)
        hits, sticks = v < 0, T_back <= 0
        slides = (u * N + (1 + e) * v * T >= 0) & (u > 0) & (N > 0)
        held = sticks & (not slides)
        kk, xz = k * k, X * Z

        j_slide = -((1 + e) * v / N)
        j_stop = u / (T if u > 0 else 1.0)
        v_f = -e * v
        j_back = (v_f - (v + N * j_stop)) / N_back
        first, second = (j_slide, 0.0) if slides else (j_stop, j_back)
        gain, inertia = v_f - v, X * X + Z * Z + kk
        if held:
            P_x = (xz * gain - u * (X * X + kk)) / inertia
            P_z = (gain * (Z * Z + kk) - xz * u) / inertia
            spin = (X * gain + Z * u) / inertia
            least = kk * j_stop
            P_z = least if (xz > 0) & (P_z <= least) else P_z
            u_f = 0.0
        else:
            P_x = kk * mu * (second - first)
            P_z = kk * (first + second)
            spin = first * (X + Z * mu) + second * (X - Z * mu)
            u_slide, u_back = u - T * j_slide, -T_back * j_back
            u_back = u_back if u_back < 0 else 0.0
            u_f = (u_slide if u_slide > 0 else 0.0) if slides else u_back
        if hits:
            energy = 0.5 * (P_x * (u + u_f) + P_z * (v + v_f))
            regime = 1 if slides else (2 if sticks else 3)
            P_x, spin = side * P_x, side * spin
            return c_x + P_x, c_z + P_z, omega + spin, regime, P_x, P_z, side * u_f, v_f, energy
        return c_x, c_z, omega, 0, 0.0, 0.0, side * u, v, 0.0

    return collide


collide = _kernel(_approach, _responses)
collide_plain = _kernel(_plain_approach, _plain_responses)
