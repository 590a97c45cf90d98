"""Beyond the paper: landing phases weighted by the flux of impacts, and V_z with them.

A rod that falls with velocity w meets the plate at the phase theta in proportion to the velocity
at which they approach each other, w + V_0 cos(theta), where that is positive. With q = w/V_0:
below q = 1 the plate runs away from the rod beyond theta_0 = arccos(-q). The paper's H is q = 1.
"""

import mpmath
import sympy as sp

from .bodies import THIN
from .drift import stationary
from .proof import DIGITS, Equation
from .symbols import V_z, epsilon, phi, theta
from .trace import derived, solve

q = sp.Symbol("q", positive=True)  # |c_z|/V_0
theta_0 = sp.Symbol("theta_0", positive=True)  # arccos(-q)
bounce = sp.Symbol("b", positive=True)  # c_z'/V_z by the closure


@derived
def flux(closed: bool) -> tuple[sp.Expr, sp.Expr]:
    """Total flux over a period, in V_0, and alpha = V_z/V_0.

    `closed` where the plate runs away from the rod in a part of the period.
    """
    end = theta_0 if closed else sp.pi
    speed = (-sp.cos(theta_0) if closed else q) + sp.cos(theta)
    total = sp.integrate(speed, (theta, -end, end))
    return total, sp.simplify(sp.integrate(speed * sp.cos(theta), (theta, -end, end)) / total)


@derived
def density() -> sp.Expr:
    """H(theta) for q >= 1."""
    return sp.factor((q + sp.cos(theta)) / flux(False)[0])


@derived
def consistent_alpha() -> tuple[sp.Expr, sp.Expr]:
    """alpha with q = b alpha, q >= 1; and the least b for which that holds."""
    fitting = sp.Symbol("alpha", positive=True)
    (alpha,) = solve(flux(False)[1].subs(q, bounce * fitting) - fitting, fitting)
    (least,) = solve(bounce * alpha - 1, bounce)
    return alpha, least


@derived
def tilt_of_one_half() -> sp.Expr:
    """sin^2 of the tilt at which a thin rod lands with V_z = V_0/2 by the closure."""
    square = sp.Symbol(r"{\sin^2\phi}", positive=True)
    up = (stationary("stick")[1] / V_z).subs(THIN)
    up = sp.simplify(up).subs(sp.cos(phi) ** 2, 1 - square).subs(sp.sin(phi) ** 2, square)
    (value,) = solve(sp.simplify(up) - consistent_alpha()[1], square)
    return sp.factor(value)


def _quadrature(form: sp.Expr, letter: sp.Symbol, value: str) -> list[sp.Expr]:
    """alpha as a mean over the phases in which the two approach, by numbers."""
    with mpmath.workdps(DIGITS + 30):
        at = mpmath.mpf(value)
        ratio = at if letter == q else -mpmath.cos(at)
        end = mpmath.pi if letter == q else at

        def mean(power: int) -> mpmath.mpf:
            return mpmath.quad(
                lambda x: (ratio + mpmath.cos(x)) * mpmath.cos(x) ** power, [-end, end]
            )

        number = sp.Float(str(mean(1) / mean(0)), DIGITS + 25)
    return [form.subs(letter, sp.Rational(value)) - number]


def _consistent_checks(form: sp.Matrix) -> list[sp.Expr]:
    """The fall that goes with alpha gives that alpha; at the edge it is as fast as the plate."""
    alpha, least = form
    fall = bounce * alpha
    mean = sp.integrate(density().subs(q, fall) * sp.cos(theta), (theta, 0, 2 * sp.pi))
    return [mean - alpha, fall.subs(bounce, least) - 1]


def _half_checks(form: sp.Expr) -> list[sp.Expr]:
    """There the rod leaves and lands as fast as the plate moves: c_z' = V_0 = 2 V_z, by (30)."""
    up = (1 + epsilon) / (1 - epsilon + 6 * form)
    return [up - 2]


def _density_checks(form: sp.Expr) -> list[sp.Expr]:
    """One in all, a first harmonic alone, even, and top to bottom as the velocities there."""
    return [
        sp.integrate(form, (theta, 0, 2 * sp.pi)) - 1,
        form.diff(theta, 3) + form.diff(theta),
        form.diff(theta).subs(theta, 0),
        form.subs(theta, sp.pi) * (q + 1) - form.subs(theta, 0) * (q - 1),
    ]


EQUATIONS = (
    Equation.read(
        "V: flux of impacts",
        derive=density,
        shown=(1 + sp.cos(theta) / q) / (2 * sp.pi),
        check=_density_checks,
    ),
    Equation.read(
        "V: alpha by flux",
        derive=lambda: flux(False)[1],
        check=lambda form: _quadrature(form, q, "1.7"),
    ),
    Equation.read(
        "V: alpha by flux, slow",
        derive=lambda: flux(True)[1],
        shown=(theta_0 - sp.sin(theta_0) * sp.cos(theta_0))
        / (2 * (sp.sin(theta_0) - theta_0 * sp.cos(theta_0))),
        check=lambda form: _quadrature(form, theta_0, "2.3"),
    ),
    Equation.read("V: alpha and closure", derive=consistent_alpha, check=_consistent_checks),
    Equation.read("V: tilt of one half", derive=tilt_of_one_half, check=_half_checks),
)
