"""One impact under Newton's law, written by hand: what the generated kernel is measured against.

Used by the benchmark alone. `collide` does the arithmetic of `compiled.collide_newton` in the same
order, and so gives the same bits; `collide_plain` leaves out the error-free sums and products and
the low parts, and so shows what the last digits cost. Both are compiled with the options of the
generated kernel.
"""

from math import copysign

from ._jit import kernel
from ._kernel import HUGE_FRICTION
from .compiled import _fused as fma

_compiled = kernel(forceinline=True)


@_compiled
def _sum_error(a, b, s):
    part = s - a
    return (a - (s - part)) + (b - part)


@_compiled
def _total(a, b, rest):
    s = a + b
    rest = _sum_error(a, b, s) + rest
    total = s + rest
    return total, rest - (total - s)


@_compiled
def _approach(c_x, c_z, omega, V_z, X, Z):
    turn, lift, fall = omega * Z, omega * X, c_z - V_z
    u, u_low = _total(c_x, -turn, -fma(omega, Z, -turn))
    v, v_low = _total(fall, lift, _sum_error(c_z, -V_z, fall) + fma(omega, X, -lift))
    return u, v, u_low, v_low


@_compiled
def _responses(X, Z, k, mu):
    kk, xx, zz, xz = k * k, X * X, Z * Z, X * Z
    kk_error, xz_error = fma(k, k, -kk), fma(X, Z, -xz)
    zz_error = fma(Z, Z, -zz)
    across, along = kk + xx, kk + zz
    across_error = _sum_error(kk, xx, across) + (kk_error + fma(X, X, -xx))
    along_error = _sum_error(kk, zz, along) + (kk_error + zz_error)
    press, hold = mu * xz, mu * along
    press_error = fma(mu, xz, -press) + mu * xz_error
    hold_error = fma(mu, along, -hold) + mu * along_error
    N, N_low = _total(across, press, across_error + press_error)
    T, T_low = _total(xz, hold, xz_error + hold_error)
    K, _ = _total(across, zz, across_error + zz_error)
    N_back, _ = _total(across, -press, across_error - press_error)
    T_back = (xz - hold) + (xz_error - hold_error)
    return N, T, N_back, T_back, K, along + along_error, N_low, T_low


@_compiled
def _plain_approach(c_x, c_z, omega, V_z, X, Z):
    return c_x - omega * Z, (c_z - V_z) + omega * X, 0.0, 0.0


@_compiled
def _plain_responses(X, Z, k, mu):
    across, along, xz = k * k + X * X, k * k + Z * Z, X * Z
    press, hold = mu * xz, mu * along
    K = across + Z * Z
    return across + press, xz + hold, across - press, xz - hold, K, along, 0.0, 0.0


@_compiled
def _lacking(q, a_low, b, b_low):
    return (a_low - b_low * q) * (1 / b)


@_compiled
def _not_lacking(q, a_low, b, b_low):
    return 0.0


def _kernel(approach, responses, lacking):
    @_compiled
    def collide(c_x, c_z, omega, V_z, X, Z, k, mu, e):
        u, v, u_low, v_low = approach(c_x, c_z, omega, V_z, X, Z)
        side = copysign(1.0, X * Z if u == 0 else u)
        X, u, u_low = side * X, abs(u), side * u_low
        mu = mu if mu < HUGE_FRICTION else HUGE_FRICTION
        N, T, N_back, T_back, K, K_z, N_low, T_low = responses(X, Z, k, mu)
        v_f = -e * v
        gain = v_f - v
        gain_low = (v_f - (gain + v)) - (1 + e) * v_low

        j_slide = gain / N
        j_low = lacking(j_slide, gain_low, N, N_low)
        u_slide = (u - T * j_slide) + ((u_low - T_low * j_slide) - T * j_low)
        j_slide += j_low
        hits, sticks = v < 0, T_back <= 0
        slides = (u_slide >= 0) & (u > 0) & (N > 0)

        T = T if u > 0 else 1.0
        j_stop = u / T
        j_low = lacking(j_stop, u_low, T, T_low)
        rest = (gain - N * j_stop) + (gain_low - (N_low * j_stop + N * j_low))
        rest = rest if rest > 0 else 0.0
        j_stop += j_low

        j_2 = rest / (K if sticks else N_back)
        u_back = -(T_back if T_back > 0 else 0.0) * j_2
        j_1 = j_slide if slides else j_stop
        j_2 = 0.0 if slides else j_2

        lift = k * k
        push = lift * mu
        P_x = (X * Z if sticks else push) * j_2 - push * j_1
        P_z = (K_z if sticks else lift) * j_2 + lift * j_1
        spin = (X if sticks else X - Z * mu) * j_2 + (X + Z * mu) * j_1
        P_x = P_x if hits else 0.0
        P_z = P_z if hits else 0.0
        spin = spin if hits else 0.0
        u_f = u_slide if slides else u_back
        u_f = u_f if hits else u
        v_f = v_f if hits else v
        stopped = 2 if sticks else 3
        regime = 1 if slides else stopped
        regime = regime if hits else 0
        energy = 0.5 * (P_x * (u + u_f) + P_z * (v + v_f))
        P_x, spin, slip = side * P_x, side * spin, side * u_f
        return c_x + P_x, c_z + P_z, omega + spin, regime, P_x, P_z, slip, v_f, energy

    return collide


collide = _kernel(_approach, _responses, _lacking)
collide_plain = _kernel(_plain_approach, _plain_responses, _not_lacking)
