"""One impact: error-free sums, branch rule, three laws; for arrays and compiled.

This is the source, and `derivations.kernel` proves it: that module runs this file on SymPy symbols
and on 60 digits with every rounding followed. `derivations.languages` makes C and JavaScript of it.
So it keeps to assignments, calls, + - * /, comparisons, `&` and tuples; a name is assigned once;
a function stands before those that call it.

No branch is there to mispredict: both ways on from a stop are computed, and the right one selected.
N, T and their like are k^2 times the response of the contact velocity to a normal impulse, j is a
normal impulse over k^2, while sticking over k^2 + Z^2, and a name that ends in `_low` is what the
rounded number before it lacks; all is per unit mass.
"""

from numpy import copysign, sqrt
from numpy import maximum as larger
from numpy import minimum as smaller

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
from ._select import select

SPLIT = 2.0**27 + 1
HUGE_FRICTION = 2.0**500
TINY = 2.0**-500  # a speed that stands for 0 as a divisor


def split(a):
    """A number with its upper and lower half, whose products with other halves are exact.

    After Veltkamp. Where a product and a sum can be had with one rounding, it is not needed.
    """
    t = SPLIT * a
    high = t - (t - a)
    rest = a - high
    return a, high, rest


def two_product(first, second):
    """Rounded product of two split numbers and its error, exact together.

    After Dekker.
    """
    a, a_high, a_rest = first
    b, b_high, b_rest = second
    p = a * b
    error = ((a_high * b_high - p) + a_high * b_rest + a_rest * b_high) + a_rest * b_rest
    return p, error


def two_sum(a, b):
    """Rounded sum of two numbers and its error, exact together.

    After Knuth.
    """
    s = a + b
    part = s - a
    error = (a - (s - part)) + (b - part)
    return s, error


def carried(s, small):
    """s + small, rounded, and what it lacks, where `small` is about a rounding of s."""
    whole = s + small
    lack = small - (whole - s)
    return whole, lack


def total(a, b, rest):
    """a + b + rest for a small rest: the rounded sum and what it lacks."""
    s, error = two_sum(a, b)
    return carried(s, error + rest)


def twofold_sum(a, a_low, b, b_low):
    """Sum of two numbers in twice the digits; `carried` where the first part is used alone."""
    s, error = two_sum(a, b)
    low = error + (a_low + b_low)
    return s, low


def twofold_of_product(p, error, a, a_low, b, b_low):
    """Product of two numbers in twice the digits, from that of the rounded ones."""
    low = error + (a * b_low + a_low * b)
    return p, low


def twofold_product(a, a_low, b, b_low):
    """Product of two numbers in twice the digits."""
    p, error = two_product(split(a), split(b))
    return twofold_of_product(p, error, a, a_low, b, b_low)


def lack_of_quotient(a, b, ratio, divisor):
    """What a rounded quotient of two numbers lacks, by it and the divisor as they are split."""
    p, error = two_product(ratio, divisor)
    return ((a - p) - error) / b


def twofold_quotient(a, b):
    """Quotient of two rounded numbers in twice the digits."""
    q = a / b
    low = lack_of_quotient(a, b, split(q), split(b))
    return q, low


def lacking(q, a_low, b, b_low):
    """What a quotient q = a/b lacks for the low parts of a and b, to first order."""
    return (a_low - b_low * q) * (1 / b)  # a reciprocal need not wait for q


def contact_velocity(c_x, c_z, omega, V_z, X, Z):
    """Velocity (u_0, v_0) of the contact point, (3), and what the rounded numbers lack.

    What the centre of mass does and what the spin adds may nearly cancel.
    """
    spin = split(omega)
    turn, turn_error = two_product(spin, split(Z))
    lift, lift_error = two_product(spin, split(X))
    fall, fall_error = two_sum(c_z, -V_z)
    u_0, u_low = total(c_x, -turn, -turn_error)
    v_0, v_low = total(fall, lift, fall_error + lift_error)
    return u_0, v_0, u_low, v_low


def responses(X, Z, k, mu):
    """N, T, N_back, T_back, K = k^2 + X^2 + Z^2, K_z = k^2 + Z^2; low parts of N, T.

    N and T are k^2 times dv/dP_z and -du/dP_z in forward slip, (5), (6); the two after them the
    same for -mu. All are relatively accurate where terms cancel.
    """
    x = split(X)
    z = split(Z)
    radius = split(k)
    factor = split(mu)
    kk, kk_error = two_product(radius, radius)
    xx, xx_error = two_product(x, x)
    zz, zz_error = two_product(z, z)
    xz, xz_error = two_product(x, z)
    across, across_rest = two_sum(kk, xx)
    across_error = across_rest + (kk_error + xx_error)
    along, along_rest = two_sum(kk, zz)
    along_error = along_rest + (kk_error + zz_error)
    press, press_rest = two_product(factor, split(xz))
    press_error = press_rest + mu * xz_error
    hold, hold_rest = two_product(factor, split(along))
    hold_error = hold_rest + mu * along_error
    N, N_low = total(across, press, across_error + press_error)
    T, T_low = total(xz, hold, xz_error + hold_error)
    # what follows a stop needs no low parts, but sums that are rounded once
    K, _ = total(across, zz, across_error + zz_error)
    N_back, _ = total(across, -press, across_error - press_error)
    T_back = (xz - hold) + (xz_error - hold_error)
    K_z = along + along_error
    return N, T, N_back, T_back, K, K_z, N_low, T_low


def branches(velocities, contact, epsilon):
    """The branch rule: what a slide would do, whether the contact closes, slides, sticks.

    In the mirror frame; u_* = u_slide. For a contact of any mobilities A, B, C the rod's k^2
    counts as one, K as A C - B^2 and K_z as C.
    """
    u_0, v_0, u_low, v_low = velocities
    N, T, N_back, T_back, K, K_z, N_low, T_low = contact
    v_slide = -epsilon * v_0
    gain_slide = v_slide - v_0
    gain_low = (v_slide - (gain_slide + v_0)) - (1 + epsilon) * v_low
    j_rounded, u_rounded = slide(gain_slide, u_0, N, T)
    j_low = lacking(j_rounded, gain_low, N, N_low)
    j_slide = j_rounded + j_low
    u_slide = u_rounded + ((u_low - T_low * j_rounded) - T * j_low)
    hits = v_0 < 0
    slides = (u_slide >= 0) & (u_0 > 0) & (N > 0)
    sticks = T_back <= 0
    return v_slide, gain_slide, gain_low, j_slide, u_slide, hits, slides, sticks


def regime_of(hits, slides, sticks):
    """Code of the regime: 0 no impact, 1 slide, 2 slip-stick, 3 slip reversal."""
    return select(hits, select(slides, 1, select(sticks, 2, 3)), 0)


def mirrored(given):
    """An impact mirrored to u_0 >= 0: side, X, friction, velocities, contact.

    Where u_0 = 0 the mirror is chosen such that XZ >= 0. Friction beyond the constant, which
    stands for infinity, gives the same impact to the last digit, but where v_0 is that much
    smaller than u_0, or k^2 + Z^2 than X^2.
    """
    c_x, c_z, omega, V_z, X, Z, k, friction, epsilon = given
    u, v_0, u_low, v_low = contact_velocity(c_x, c_z, omega, V_z, X, Z)
    side = copysign(1.0, select(u == 0, X * Z, u))
    mu = smaller(friction, HUGE_FRICTION)
    ahead = side * X
    u_0 = abs(u)
    side_low = side * u_low
    velocities = (u_0, v_0, side_low, v_low)
    contact = responses(ahead, Z, k, mu)
    return side, ahead, mu, velocities, contact


def newton(velocities, contact, k, epsilon, sliding, stopped):
    """v_f and v_f - v_1, if the slip stops, under kinematic restitution."""
    v_slide, left, sticks = sliding
    return v_slide, left


def after_stop(velocities, contact, k, sticks, stopped):
    """w and r of the phase after the stop, v_1 and what it lacks."""
    u_0, v_0, u_low, v_low = velocities
    N, T, N_back, T_back, K, K_z, N_low, T_low = contact
    j_stop, rise, rise_low = stopped
    after = select(sticks, stick_response(k, K, K_z), N_back)
    w, r = slopes(j_stop, N, after)
    v_1, v_1_low = total(v_0, rise, v_low + rise_low)
    return w, r, v_1, v_1_low


def poisson(velocities, contact, k, epsilon, sliding, stopped):
    """v_f and v_f - v_1, if the slip stops, under kinetic restitution."""
    v_slide, left, sticks = sliding
    w, r, v_1, v_1_low = after_stop(velocities, contact, k, sticks, stopped)
    soon = v_1 < 0
    early = poisson_early(epsilon, v_1, w)
    late, late_rest = poisson_late(v_1, left, r)
    v_f = select(soon, early, late)
    rest = select(soon, (early - v_1) - v_1_low, late_rest)
    return v_f, rest


def stronge(velocities, contact, k, epsilon, sliding, stopped):
    """v_f and v_f - v_1, if the slip stops, under energetic restitution."""
    u_0, v_0, u_low, v_low = velocities
    v_slide, left, sticks = sliding
    w, r, v_1, v_1_low = after_stop(velocities, contact, k, sticks, stopped)
    soon = v_1 < 0
    early = stronge_early(epsilon, v_0, v_1, w)
    late, more = stronge_late(v_1, v_slide, left, r)
    square = select(soon, early, late)
    v_f = sqrt(square)
    rest = select(soon, (v_f - v_1) - v_1_low, more / larger(v_f + v_1, TINY))
    return v_f, rest


def phases(law, velocities, contact, k, epsilon):
    """Impulses, as j, of forward slip and of what follows; contact velocities after."""
    u_0, v_0, u_low, v_low = velocities
    N, T, N_back, T_back, K, K_z, N_low, T_low = contact
    v_slide, gain_slide, gain_low, j_slide, u_slide, hits, slides, sticks = branches(
        velocities, contact, epsilon
    )
    slips = u_0 > 0
    T_slip = select(slips, T, 1.0)  # without slip nothing is divided by T, which may be 0
    j_rounded, rise = stop(u_0, N, T_slip)
    j_low = lacking(j_rounded, u_low, T_slip, T_low)
    rise_low = N_low * j_rounded + N * j_low
    j_stop = j_rounded + j_low
    # v_slide - v_1: nothing pulls, though rounding may; so P_z > 0, and no slip back is forward
    left = larger((gain_slide - rise) + (gain_low - rise_low), 0.0)
    sliding = (v_slide, left, sticks)
    stopped = (j_stop, rise, rise_low)
    v_stopped, rest = law(velocities, contact, k, epsilon, sliding, stopped)
    j_after, u_back = reverse(rest, select(sticks, K, N_back), larger(T_back, 0.0))
    j_1 = select(slides, j_slide, j_stop)
    j_2 = select(slides, 0.0, j_after)
    u_end = select(slides, u_slide, u_back)
    v_end = select(slides, v_slide, v_stopped)
    u_f = select(hits, u_end, u_0)
    v_f = select(hits, v_end, v_0)
    return j_1, j_2, u_f, v_f, hits, slides, sticks


def added(hits, sticks, j_1, j_2, forward, back, held):
    """Sum over the phases of what a unit of each one's impulse gives; 0 without an impact."""
    return select(hits, select(sticks, held, back) * j_2 + forward * j_1, 0.0)


def impact(law, given):
    """State of a rod after an impact under a law; the fields of `Collision`."""
    c_x, c_z, omega, V_z, X, Z, k, friction, epsilon = given
    side, ahead, mu, velocities, contact = mirrored(given)
    u_0, v_0, u_low, v_low = velocities
    N, T, N_back, T_back, K, K_z, N_low, T_low = contact
    j_1, j_2, u_f, v_f, hits, slides, sticks = phases(law, velocities, contact, k, epsilon)
    push, lift, turn, back = slip(ahead, Z, k, mu)
    push_held, lift_held, turn_held = stick(ahead, Z, K_z)
    P_ahead = added(hits, sticks, j_1, j_2, -push, push, push_held)
    P_z = added(hits, sticks, j_1, j_2, lift, lift, lift_held)
    spin = added(hits, sticks, j_1, j_2, turn, back, turn_held)
    regime = regime_of(hits, slides, sticks)
    energy = energy_change(P_ahead, P_z, u_0, v_0, u_f, v_f)
    P_x = side * P_ahead
    c_x_after = c_x + P_x
    c_z_after = c_z + P_z
    omega_after = omega + side * spin
    slip_after = side * u_f
    return c_x_after, c_z_after, omega_after, regime, P_x, P_z, slip_after, v_f, energy
