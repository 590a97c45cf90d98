"""Stationary translation of bouncing rods, Section V, Eqs. (24)-(31)."""

from typing import Any

import mpmath
import sympy as sp

from . import second_routes, slide, slip_reversal, slip_stick
from .axioms import CLOSURE, LANDING_PHASES, after_x, after_z
from .bodies import THIN, cylinder_gyration, flat_contact, flat_tilt
from .proof import DIGITS, Equation
from .symbols import (
    V_0,
    Gamma,
    V_z,
    X,
    Z,
    c_x,
    c_z,
    diameter,
    epsilon,
    k,
    length,
    mu,
    omega,
    phi,
    theta,
)
from .thin_rod import (
    critical_friction,
    largest_reversal_tilt,
    overlooking_the_second_root,
    printed_upper_tilt,
)
from .trace import derived, solve

eta = sp.Symbol("eta", positive=True)  # sqrt(Gamma - 1)
CASES = {"stick": slip_stick.impulse, "back": slip_reversal.impulse}


def spin_at_landing() -> sp.Expr:
    """Omega before the mean landing, by the closure."""
    (spin,) = solve(CLOSURE({})[0], omega)
    return spin


@derived
def landing(case: str) -> tuple[sp.Expr, sp.Expr]:
    """(c_x', c_z') after a landing with the closure's spin."""
    return tuple(c.subs(omega, spin_at_landing()) for c in slide.cm_velocity(*CASES[case]()))


@derived
def stationary(case: str) -> tuple[sp.Expr, sp.Expr]:
    """(c_x', c_z') of stationary translation: c_x' = c_x, c_z' = -c_z, omega = 0."""
    _, along, across = CLOSURE(dict(zip((after_x, after_z), landing(case), strict=True)))
    before_x, before_z = solve([along, across], [c_x, c_z])
    return sp.factor(before_x), sp.factor(-before_z)


@derived
def landing_velocity(case: str) -> sp.Expr:
    """v_0 of the stationary landing; it must be negative for an impact to happen."""
    return sp.factor(-stationary(case)[1] - V_z)


@derived
def relaxation(case: str) -> sp.Expr:
    """What one landing leaves of a deviation from the stationary drift, d c_x'/d c_x."""
    return sp.factor(landing(case)[0].diff(c_x))


@derived
def slide_loss() -> sp.Expr:
    """c_x' - c_x of a continuous slide; in stationary translation it is zero."""
    loss = slide.cm_velocity(*slide.impulse())[0] - c_x
    return sp.factor(loss.subs(omega, spin_at_landing()))


@derived
def from_printed() -> sp.Expr:
    """c_x' by the closure from (21) and (22) as they are printed."""
    printed: dict[str, Any] = {e.tag: e.printed for e in slip_reversal.EQUATIONS}
    along, across = (printed[tag].subs(omega, spin_at_landing()) for tag in ("21", "22"))
    return sp.factor(solve([along - c_x, across + c_z], [c_x, c_z])[0])


@derived
def plate_velocity() -> sp.Expr:
    """Mean of V_0 cos(theta) over the density of landing phases."""
    return sp.integrate(V_0 * sp.cos(theta) * LANDING_PHASES({}), (theta, 0, 2 * sp.pi))


@derived
def onset_velocity() -> sp.Expr:
    """Leading V_z/V_0 at the first landing of a perfectly inelastic rod, eta^2 = Gamma - 1.

    The rod leaves where Gamma sin(theta) = 1 and lands where height and plate meet again; close
    to Gamma = 1 both happen near theta = pi/2, where sin is a parabola.
    """
    y, x = sp.symbols("y x", positive=True)
    start = -sp.sqrt(2) * eta  # theta - pi/2 at take-off: 1 - x^2/2 = 1/Gamma to leading order
    falling = eta**2 - x**2 / 2  # Gamma sin(theta) - 1: plate acceleration over gravity
    speed = sp.integrate(falling, (x, start, x))
    gap = sp.expand(sp.integrate(speed, (x, start, y)))
    landings = [
        root
        for root in solve(gap, y, r"$y = \theta - \pi/2$ at the landing")
        if sp.simplify(root - start) != 0
    ]
    return -landings[0]  # cos(pi/2 + x) = -x


@derived
def flat_start() -> sp.Expr:
    """Drift of a flat-ended rod in slip-stick on its edge, at the smallest positive tilt."""
    contact = [part.subs(phi, 0) for part in flat_contact()]
    flat = {X: contact[0], Z: contact[1], k: sp.sqrt(cylinder_gyration())}
    return sp.factor(stationary("stick")[0].subs(flat))


def _exponent(form: sp.Expr) -> sp.Expr:
    """Exponent of a power law in Gamma - 1."""
    return sp.limit((Gamma - 1) * form.diff(Gamma) / form, Gamma, 1, "+")


# ---- second routes ----------------------------------------------------------------------------


def _landed(value: sp.Expr) -> list[sp.Expr]:
    """What c_z before the landing, from whole impacts, differs by from a value."""
    return [second_routes.landing(case)[1] - value for case in CASES]


def _left_of_a_deviation(form: sp.Matrix) -> list[sp.Expr]:
    """Difference of two landings whose c_x differ by one."""
    after = [second_routes.impact(case)[0].subs(omega, 0) for case in CASES]
    return [v.subs(c_x, 1) - v.subs(c_x, 0) - left for v, left in zip(after, form, strict=True)]


def _balance_of_impulses(form: sp.Expr) -> list[sp.Expr]:
    """Stationary: friction forward and backward cancel, under the same total normal impulse p.

    In slip reversal without much friction the slip then stops at p/2. Sticking takes the same
    tangential impulse back, so that it stops at p s/(mu + s), s = XZ/(k^2 + Z^2). Slip lost up to
    there: (XZ + mu (k^2 + Z^2))/(m k^2) per impulse.
    """
    s = X * Z / (k**2 + Z**2)
    lost = X * Z + mu * (k**2 + Z**2)
    back, stick = sp.Rational(1, 2) * lost.subs(mu, 0), s / (mu + s) * lost
    return [form - back / stick]


def _by_the_wrong_sign(form: sp.Expr) -> list[sp.Expr]:
    """A whole impact, with what it takes of c_x put in twice the other way."""
    v_x, v_z, _ = (part.subs(omega, 0) for part in second_routes.impact("back"))
    (fall,) = sp.solve(v_z + c_z, c_z)
    taken = 1 - v_x.diff(c_x)
    landed = (v_x + 2 * taken * c_x - c_x).subs(c_z, fall)
    return [landed.subs(c_x, form)]


def _flat_landing(form: sp.Expr) -> list[sp.Expr]:
    """c_x of a landing on the edge at (-d/2, l/2), from whole impacts."""
    gyration = sp.sqrt(length**2 / 12 + diameter**2 / 16)
    edge = {X: -diameter / 2, Z: length / 2, k: gyration}
    return [second_routes.landing("stick")[0].subs(edge) - form]


def _onset_by_numbers(form: sp.Expr) -> list[sp.Expr]:
    """One flight just above Gamma = 1, on the plate's sine and the parabola, without a series."""
    with mpmath.workdps(200):
        small = mpmath.mpf(10) ** -30
        gamma = 1 + small**2
        start = mpmath.asin(1 / gamma)  # where the plate's acceleration is -g

        def gap(flown: mpmath.mpf) -> mpmath.mpf:
            rod = mpmath.sin(start) + mpmath.cos(start) * flown - flown**2 / (2 * gamma)
            return rod - mpmath.sin(start + flown)

        flown = mpmath.findroot(gap, (small, 100 * small), solver="bisect", maxsteps=500)
        number = sp.Float(str(mpmath.cos(start + flown) / small), DIGITS + 25)
    return [form / eta - number]


_denominator = k**2 * (1 - epsilon) + 2 * X**2
_thin_denominator = 1 - epsilon + 6 * sp.sin(phi) ** 2
_flat_denominator = 4 * (1 - epsilon) * length**2 + 3 * (9 - epsilon) * diameter**2
_stop, _reverse = mu * (k**2 + Z**2) + X * Z, k**2 + X**2 - mu * X * Z
_sc = sp.sin(phi) * sp.cos(phi)
_printed_24 = 2 * (1 + epsilon) * X * Z * V_z / _denominator
_printed_27 = ((1 + epsilon) * mu * (k**2 + Z**2) * V_z + (1 + epsilon) * X * Z * V_z) / (
    _denominator
)
_printed_29 = (1 + epsilon) * (mu * (1 + 3 * sp.cos(phi) ** 2) + 3 * _sc) / _thin_denominator * V_z
_printed_integral = sp.Integral(sp.cos(theta) * (1 + sp.cos(theta)), (theta, 0, 2 * sp.pi))
_printed_28 = (1 + epsilon) * k**2 * V_z / _denominator


def _thin(form: sp.Expr) -> sp.Expr:
    return form.subs(THIN)


EQUATIONS = (
    Equation.read(
        "V: no slide",
        derive=slide_loss,
        check=lambda form: (second_routes.impact("slide")[0].subs(omega, 0) - c_x - form,),
    ),
    Equation.read("24", printed=_printed_24, derive=lambda: stationary("stick")[0]),
    Equation.read("25", printed=_printed_28, derive=lambda: stationary("stick")[1]),
    Equation.read(
        "26",
        printed=6 * (1 + epsilon) * _sc / _thin_denominator * V_z,
        derive=lambda: _thin(stationary("stick")[0]),
    ),
    Equation.read("27", printed=_printed_27, derive=lambda: stationary("back")[0]),
    Equation.read("V: (27) from (21)", derive=from_printed, check=_by_the_wrong_sign),
    Equation.read("28", printed=_printed_28, derive=lambda: stationary("back")[1]),
    Equation.read(
        "V: continuity",
        printed=sp.S.Zero,
        derive=lambda: sp.cancel(
            (stationary("back")[0] - stationary("stick")[0]).subs(mu, critical_friction())
        ),
    ),
    Equation.read("29", printed=_printed_29, derive=lambda: _thin(stationary("back")[0])),
    Equation.read(
        "30",
        printed=sp.Matrix([(1 + epsilon) / _thin_denominator * V_z] * 2),
        derive=lambda: tuple(_thin(stationary(case)[1]) for case in CASES),
    ),
    Equation.read(
        "V: range of (29)",
        printed=sp.pi / 2,
        derive=largest_reversal_tilt,
        at={mu: sp.Rational(3, 10)},
        contradiction=printed_upper_tilt,
        mistaken=overlooking_the_second_root,
    ),
    Equation.read(
        "V: H(theta), normalised",
        printed=sp.S.One,
        derive=lambda: sp.integrate(LANDING_PHASES({}), (theta, 0, 2 * sp.pi)),
    ),
    Equation.read("31", printed=V_0 / (2 * sp.pi) * _printed_integral, derive=plate_velocity),
    Equation.read("31: value", printed=V_0 / 2, derive=plate_velocity),
    Equation.read("V: V_z at onset", printed=sp.S.One, derive=lambda: _exponent(V_0 * (Gamma - 1))),
    Equation.read(
        "V: exponent at onset",
        derive=lambda: _exponent(V_0 * onset_velocity().subs(eta, sp.sqrt(Gamma - 1))),
        # take-off and landing phase scale alike: x^2/(Gamma - 1) is a number
        check=lambda form: (sp.diff((Gamma - 1) ** (2 * form) / (Gamma - 1), Gamma),),
    ),
    Equation.read("V: inelastic onset", derive=onset_velocity, check=_onset_by_numbers),
    Equation.read(
        "V: landing",
        derive=lambda: landing_velocity("stick"),
        shown=-2 * (k**2 + X**2) * V_z / _denominator,
        check=lambda form: _landed(form + V_z),
    ),
    Equation.read(
        "V: hit again at once",
        derive=lambda: sp.factor(stationary("stick")[1] - V_z),
        shown=2 * (epsilon * k**2 - X**2) * V_z / _denominator,
        check=lambda form: _landed(-form - V_z),
    ),
    Equation.read(
        "V: relaxation",
        derive=lambda: (relaxation("stick"), relaxation("back")),
        shown=(Z**2 / (k**2 + X**2 + Z**2), 1 - 2 * mu * k**2 * (k**2 + X**2) / (_stop * _reverse)),
        check=_left_of_a_deviation,
    ),
    Equation.read(
        "V: friction to zero",
        derive=lambda: sp.cancel(stationary("back")[0].subs(mu, 0) / stationary("stick")[0]),
        check=_balance_of_impulses,
    ),
    Equation.read(
        "V: flat end",
        derive=flat_tilt,
        shown=sp.atan(diameter / length),
        check=lambda form: (flat_contact()[1].diff(phi).subs(phi, form),),
    ),
    Equation.read(
        "V: flat end at tilt 0",
        derive=flat_start,
        shown=-24 * (1 + epsilon) * diameter * length * V_z / _flat_denominator,
        check=_flat_landing,
    ),
)
