"""k^2 + X^2 + mu X Z without losing digits where the friction term cancels the squares.

There, at the edge of the Painleve region, the impulse of a slide is a quotient by this sum, and
every digit lost in it is lost in the answer. Error-free products (Veltkamp, Dekker) and sums
(Knuth) carry the rounding errors along; plain arithmetic, so it runs on floats and arrays.
"""

_SPLIT = 134217729.0  # 2^27 + 1


def _two_sum(a, b):
    """s + e = a + b exactly, s the rounded sum."""
    s = a + b
    part = s - a
    return s, (a - (s - part)) + (b - part)


def _two_product(a, b):
    """p + e = a b exactly (no under- or overflow), p the rounded product."""
    p = a * b
    t = _SPLIT * a
    a_high = t - (t - a)
    a_low = a - a_high
    t = _SPLIT * b
    b_high = t - (t - b)
    b_low = b - b_high
    return p, ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low


def normal_response(X, Z, k, mu):
    """N = k^2 + X^2 + mu X Z to nearly full precision, as if computed in twice the digits."""
    kk, kk_error = _two_product(k, k)
    xx, xx_error = _two_product(X, X)
    xz, xz_error = _two_product(X, Z)
    friction, friction_error = _two_product(mu, xz)
    total, error = _two_sum(kk, xx)
    total, more = _two_sum(total, friction)
    return total + (more + error + kk_error + xx_error + friction_error + mu * xz_error)
