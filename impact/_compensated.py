"""Sums of an impact that may cancel, evaluated as if in twice the digits.

The contact velocity is the difference of what the centre of mass does and what the spin does. And
at the edge of the Painleve region, where friction cancels the squares in k^2 + X^2 + mu X Z, the
impulse of a slide is a quotient by that sum: every digit lost in it is lost in the answer.
Error-free products (Veltkamp, Dekker) and sums (Knuth) carry the rounding errors along; plain
arithmetic, so it runs on floats and arrays. Numbers must stay within about 1e+-140.

What a rounded number still lacks, its low part, is returned beside it where it counts: left out,
the roundings of some ten such numbers add up to six units in the last place of the result.
"""

_SPLIT = 134217729.0  # 2^27 + 1


def _halves(a):
    """A number with its upper and lower half: (a, high, low), a = high + low exactly."""
    t = _SPLIT * a
    high = t - (t - a)
    return a, high, a - high


def _product(a, b):
    """Rounded product and its error, exact together; a and b come from `_halves`."""
    (a, a_high, a_low), (b, b_high, b_low) = a, b
    p = a * b
    return p, ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low


def _sum(a, b):
    """Rounded sum and its error, exact together."""
    s = a + b
    part = s - a
    return s, (a - (s - part)) + (b - part)


def _total(a, b, rest):
    """a + b + rest for a small rest: the rounded sum and what it lacks."""
    s, error = _sum(a, b)
    rest = error + rest
    total = s + rest
    return total, rest - (total - s)


class Twofold:
    """A number as the sum of a rounded one and what that lacks: arithmetic in twice the digits.

    The functions of `_generated` run on it as on any number.
    """

    def __init__(self, high, low=None):
        self.high, self.low = high, 0.0 * high if low is None else low

    def __getitem__(self, index):
        return Twofold(self.high[index], self.low[index])

    def __neg__(self):
        return Twofold(-self.high, -self.low)

    def __add__(self, other):
        return Twofold(*_total(self.high, other.high, self.low + other.low))

    def __sub__(self, other):
        return self + -other

    def __mul__(self, other):
        product, error = _product(_halves(self.high), _halves(other.high))
        return Twofold(
            *_total(product, 0.0, error + (self.high * other.low + self.low * other.high))
        )


def quotient(a, b):
    """a/b of two rounded numbers, in twice their digits."""
    q = a / b
    product, error = _product(_halves(q), _halves(b))
    return Twofold(*_total(q, 0.0, ((a - product) - error) / b))


def lacking(q, a_low, b, b_low):
    """What the quotient q = a/b lacks for the low parts of a and b, to first order."""
    return (a_low - b_low * q) * (1 / b)  # a reciprocal need not wait for q


def approach(c_x, c_z, omega, V_z, X, Z):
    """u_0, v_0 of `_generated.approach` and their low parts: what the rounded numbers lack."""
    omega = _halves(omega)
    turn, turn_error = _product(omega, _halves(Z))
    lift, lift_error = _product(omega, _halves(X))
    fall, fall_error = _sum(c_z, -V_z)
    u_0, u_low = _total(c_x, -turn, -turn_error)
    v_0, v_low = _total(fall, lift, fall_error + lift_error)
    return u_0, v_0, u_low, v_low


def responses(X, Z, k, mu):
    """N, T, N_back, T_back, K = k^2 + X^2 + Z^2, K_z = k^2 + Z^2; low parts of N, T.

    The first four are `_generated.slip_response` for +mu and for -mu; all are relatively accurate
    where terms cancel.
    """
    X, Z, k, mu_parts = _halves(X), _halves(Z), _halves(k), _halves(mu)
    kk, kk_error = _product(k, k)
    xx, xx_error = _product(X, X)
    zz, zz_error = _product(Z, Z)
    xz, xz_error = _product(X, Z)
    across, error = _sum(kk, xx)
    across_error = error + (kk_error + xx_error)
    along, error = _sum(kk, zz)
    along_error = error + (kk_error + zz_error)
    press, error = _product(mu_parts, _halves(xz))
    press_error = error + mu * xz_error
    hold, error = _product(mu_parts, _halves(along))
    hold_error = error + mu * along_error
    N, N_low = _total(across, press, across_error + press_error)
    T, T_low = _total(xz, hold, xz_error + hold_error)
    # What follows a stop needs no low parts, but sums that are rounded once.
    K, _ = _total(across, zz, across_error + zz_error)
    N_back, _ = _total(across, -press, across_error - press_error)
    T_back = (xz - hold) + (xz_error - hold_error)
    return N, T, N_back, T_back, K, along + along_error, N_low, T_low
