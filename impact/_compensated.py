"""The sums of an impact that may cancel, as if computed in twice the digits.

The contact velocity is the difference of what the centre of mass does and what the spin does. And
at the edge of the Painleve region, where friction cancels the squares in k^2 + X^2 + mu X Z, the
impulse of a slide is a quotient by that sum: every digit lost in it is lost in the answer.
Error-free products (Veltkamp, Dekker) and sums (Knuth) carry the rounding errors along; plain
arithmetic, so it runs on floats and arrays. Numbers must stay within about 1e+-140.
"""

_SPLIT = 134217729.0  # 2^27 + 1


def _halves(a):
    """Number a with its upper and lower half: (a, high, low), a = high + low exactly."""
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


def approach(c_x, c_z, omega, V_z, X, Z):
    """(u_0, v_0) of `_generated.approach`, from products and differences without their rounding."""
    omega = _halves(omega)
    turn, turn_error = _product(omega, _halves(Z))
    lift, lift_error = _product(omega, _halves(X))
    fall, fall_error = _sum(c_z, -V_z)
    return (c_x - turn) - turn_error, (fall + lift) + (fall_error + lift_error)


def responses(X, Z, k, mu):
    """N, T, N_back, T_back, k^2 + X^2 and k^2 + Z^2, relatively accurate where terms cancel.

    The first four are `_generated.slip_response` for +mu and for -mu. Their last sum needs no
    compensation: a difference of two floats is rounded by its own size, however much cancels;
    what it inherits from its terms is what counts.
    """
    X, Z, k, mu_halves = _halves(X), _halves(Z), _halves(k), _halves(mu)
    kk, kk_error = _product(k, k)
    xx, xx_error = _product(X, X)
    zz, zz_error = _product(Z, Z)
    xz, xz_error = _product(X, Z)
    across, error = _sum(kk, xx)
    across_error = error + (kk_error + xx_error)
    along, error = _sum(kk, zz)
    along_error = error + (kk_error + zz_error)
    press, error = _product(mu_halves, _halves(xz))
    press_error = error + mu * xz_error
    hold, error = _product(mu_halves, _halves(along))
    hold_error = error + mu * along_error
    return (
        (across + press) + (across_error + press_error),
        (xz + hold) + (xz_error + hold_error),
        (across - press) + (across_error - press_error),
        (xz - hold) + (xz_error - hold_error),
        across + across_error,
        along + along_error,
    )
