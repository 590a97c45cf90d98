"""Stationary translation of bouncing rods, Section V, Eqs. (24)-(31)."""

import sympy as sp

from . import second_routes, slide, slip_reversal, slip_stick
from .axioms import CLOSURE, LANDING_PHASES, after_x, after_z
from .bodies import THIN, cylinder_gyration, flat_contact, flat_tilt
from .proof import Equation
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


def _flat_landing(form: sp.Expr) -> list[sp.Expr]:
    """c_x of a landing on the edge at (-d/2, l/2), from whole impacts."""
    gyration = sp.sqrt(length**2 / 12 + diameter**2 / 16)
    edge = {X: -diameter / 2, Z: length / 2, k: gyration}
    return [second_routes.landing("stick")[0].subs(edge) - form]


def _onset_flight(form: sp.Expr) -> list[sp.Expr]:
    """Gap at the landing phase x = -form by one integration: zero where the flight ends."""
    x, start = sp.Symbol("x", positive=True), -sp.sqrt(2) * eta
    weight = (-form - x) * (eta**2 - x**2 / 2)  # double integral by parts
    return [sp.integrate(sp.expand(weight), (x, start, -form))]


_denominator = k**2 * (1 - epsilon) + 2 * X**2
_thin_denominator = 1 - epsilon + 6 * sp.sin(phi) ** 2
_sc = sp.sin(phi) * sp.cos(phi)
_printed_24 = 2 * (1 + epsilon) * X * Z * V_z / _denominator
_printed_27 = ((1 + epsilon) * mu * (k**2 + Z**2) * V_z + (1 + epsilon) * X * Z * V_z) / (
    _denominator
)
_printed_29 = (1 + epsilon) * (mu * (1 + 3 * sp.cos(phi) ** 2) + 3 * _sc) / _thin_denominator * V_z
_EXAMPLE_29 = {epsilon: sp.Rational(13, 20), phi: 89 * sp.pi / 180}
_printed_28 = (1 + epsilon) * k**2 * V_z / _denominator


def _thin(form: sp.Expr) -> sp.Expr:
    return form.subs(THIN)


EQUATIONS = (
    Equation(
        tag="V: no slide",
        what='"the sliding regime cannot be realized": $c_x\' - c_x$ of a slide',
        symbol="c_x'-c_x",
        derive=slide_loss,
        check=lambda form: (second_routes.impact("slide")[0].subs(omega, 0) - c_x - form,),
        verdict="new",
        note=r"negative for every $\mu > 0$ ($v_0 < 0$, $u_0 > 0$), so the closure excludes slide "
        "in the stationary landing itself; it does not exclude single slides in a scatter of "
        "landings, and without friction nothing is excluded",
    ),
    Equation(
        tag="24",
        what="drift in slip-stick",
        symbol="c_x'",
        printed=_printed_24,
        derive=lambda: stationary("stick")[0],
    ),
    Equation(
        tag="25",
        what="vertical velocity in slip-stick",
        symbol="c_z'",
        printed=_printed_28,
        derive=lambda: stationary("stick")[1],
    ),
    Equation(
        tag="26",
        what="drift of a thin rod in slip-stick",
        symbol="c_x'",
        printed=6 * (1 + epsilon) * _sc / _thin_denominator * V_z,
        derive=lambda: _thin(stationary("stick")[0]),
    ),
    Equation(
        tag="27",
        what="drift in slip reversal",
        symbol="c_x'",
        printed=_printed_27,
        derive=lambda: stationary("back")[0],
    ),
    Equation(
        tag="28",
        what="vertical velocity in slip reversal",
        symbol="c_z'",
        printed=_printed_28,
        derive=lambda: stationary("back")[1],
    ),
    Equation(
        tag="V: continuity",
        what=r"(27) minus (24) where $XZ = \mu (k^2 + Z^2)$",
        symbol="c_x'(27) - c_x'(24)",
        printed=sp.S.Zero,
        derive=lambda: sp.cancel(
            (stationary("back")[0] - stationary("stick")[0]).subs(mu, critical_friction())
        ),
        note="the drift is continuous at both critical tilts; its slope is not",
    ),
    Equation(
        tag="29",
        what="drift of a thin rod in slip reversal",
        symbol="c_x'",
        printed=_printed_29,
        derive=lambda: _thin(stationary("back")[0]),
        note="holds between the two critical tilts only; beyond the upper one (26) holds again",
    ),
    Equation(
        tag="30",
        what="vertical velocity of a thin rod, both regimes",
        symbol="c_z'",
        printed=sp.Matrix([(1 + epsilon) / _thin_denominator * V_z] * 2),
        derive=lambda: sp.Matrix([_thin(stationary(case)[1]) for case in CASES]),
    ),
    Equation(
        tag="V: range of (29)",
        what=r'"in the slip-reversal regime ($\phi > \phi_c$)": where (27), (29) hold up to',
        symbol="\\phi_{max}",
        printed=sp.pi / 2,
        derive=largest_reversal_tilt,
        at={mu: sp.Rational(3, 10)},
        verdict="erratum",
        contradicted_by=r"condition for $\phi_c$: its larger root",
        contradiction=printed_upper_tilt,
        mistaken=overlooking_the_second_root,
        mistake="the second root of the condition is overlooked",
        note="above arctan of the larger root (84.04 degrees for Fig. 11) the contact sticks and "
        "(26) holds: the drift goes to zero at 90 degrees, where (29) would leave "
        r"$(1 + \epsilon) \mu/(7 - \epsilon)$",
    ),
    Equation(
        tag="V: H(theta), normalised",
        what="the approximate density of landing phases is normalised",
        symbol="\\int H d\\theta",
        printed=sp.S.One,
        derive=lambda: sp.integrate(LANDING_PHASES({}), (theta, 0, 2 * sp.pi)),
    ),
    Equation(
        tag="31",
        what="mean plate velocity at landing",
        symbol="V_z",
        printed=V_0
        / (2 * sp.pi)
        * sp.Integral(sp.cos(theta) * (1 + sp.cos(theta)), (theta, 0, 2 * sp.pi)),
        derive=plate_velocity,
        note="for the assumed $H$; the density itself is a fit to simulations",
    ),
    Equation(
        tag="31: value",
        what="mean plate velocity at landing, integrated",
        symbol="V_z",
        printed=V_0 / 2,
        derive=plate_velocity,
    ),
    Equation(
        tag="V: V_z at onset",
        what=r'"one can expect that $V_z$ is proportional to $\Gamma - 1$ at small $\Gamma$": the '
        "exponent",
        symbol="d\\ln V_z/d\\ln(\\Gamma - 1)",
        printed=sp.S.One,
        derive=lambda: _exponent(V_0 * (Gamma - 1)),
        verdict="assumed",
        note="an expectation for many rods, not derived; a single perfectly inelastic rod has "
        "another exponent, see the next entry",
    ),
    Equation(
        tag="V: exponent at onset",
        what="exponent of $V_z$ of a single perfectly inelastic rod",
        symbol="d\\ln V_z/d\\ln(\\Gamma - 1)",
        derive=lambda: _exponent(V_0 * onset_velocity().subs(eta, sp.sqrt(Gamma - 1))),
        # take-off and landing phase scale alike: x^2/(Gamma - 1) is a number
        check=lambda form: (sp.diff((Gamma - 1) ** (2 * form) / (Gamma - 1), Gamma),),
        verdict="new",
    ),
    Equation(
        tag="V: inelastic onset",
        what="$V_z/V_0$ of the first landing of a perfectly inelastic rod, "
        r"$\eta = \sqrt{\Gamma - 1}$",
        symbol="V_z/V_0",
        derive=onset_velocity,
        check=_onset_flight,
        verdict="new",
        note="negative, and a square root, not a line: a landing on the falling plate, which the "
        "closure cannot turn into a drift",
    ),
    Equation(
        tag="V: landing",
        what="$v_0$ of the stationary landing",
        symbol="v_0",
        derive=lambda: landing_velocity("stick"),
        shown=-2 * (k**2 + X**2) * V_z / _denominator,
        check=lambda form: _landed(form + V_z),
        verdict="new",
        note=r"negative only for $V_z > 0$: with $V_z \le 0$ the closure has no impact at all, so "
        "a small negative $V_z$ cannot by itself explain the reverse drift (Section VI)",
    ),
    Equation(
        tag="V: hit again at once",
        what="$c_z' - V_z$ of the stationary landing: does the centre leave faster than the plate?",
        symbol="c_z'-V_z",
        derive=lambda: sp.factor(stationary("stick")[1] - V_z),
        shown=2 * (epsilon * k**2 - X**2) * V_z / _denominator,
        check=lambda form: _landed(-form - V_z),
        verdict="new",
        note=r"negative from $X^2 = \epsilon k^2$ on (27.7 degrees for a thin rod at "
        r"$\epsilon = 0.65$): there the rod separates only because it spins, and without spin it "
        "is hit again at once; beyond it (24)-(30) hold formally, not as one isolated landing a "
        "flight",
    ),
    Equation(
        tag="V: relaxation",
        what="what a landing leaves of a deviation in $c_x$: slip-stick, slip reversal",
        symbol="([\\partial c_x'/\\partial c_x]_{stick}, [\\partial c_x'/\\partial c_x]_{back})",
        derive=lambda: sp.Matrix([relaxation("stick"), relaxation("back")]),
        shown=sp.Matrix(
            [
                Z**2 / (k**2 + X**2 + Z**2),
                1
                - 2
                * mu
                * k**2
                * (k**2 + X**2)
                / ((mu * (k**2 + Z**2) + X * Z) * (k**2 + X**2 - mu * X * Z)),
            ]
        ),
        check=_left_of_a_deviation,
        verdict="new",
        note=r"as $\mu \to 0$ the drift (29) tends to half of (26), not to zero, but the number of "
        r"landings needed to reach it grows as $XZ/(2 \mu k^2)$",
    ),
    Equation(
        tag="V: friction to zero",
        what=r"(27) at $\mu \to 0$ over (24)",
        symbol="c_x'(27)/c_x'(24)",
        derive=lambda: sp.cancel(stationary("back")[0].subs(mu, 0) / stationary("stick")[0]),
        check=_balance_of_impulses,
        verdict="new",
    ),
    Equation(
        tag="V: flat end",
        what="tilt below which a flat-ended rod drifts against its tilt",
        symbol="\\phi_{flat}",
        derive=flat_tilt,
        shown=sp.atan(diameter / length),
        check=lambda form: (flat_contact()[1].diff(phi).subs(phi, form),),  # highest there
        verdict="new",
        note=r"$\arctan(d/l)$, from $X = 0$: 7.1 degrees for the experiment's $l = 8 d$, which "
        "reports motion from 8 degrees on",
    ),
    Equation(
        tag="V: flat end at tilt 0",
        what="drift of a flat-ended rod in slip-stick as its tilt goes to 0 from above",
        symbol="c_x'",
        derive=flat_start,
        shown=-24
        * (1 + epsilon)
        * diameter
        * length
        * V_z
        / (4 * (1 - epsilon) * length**2 + 3 * (9 - epsilon) * diameter**2),
        check=_flat_landing,
        verdict="new",
        note="finite and backwards; it changes sign as the contact jumps from edge to edge",
    ),
)
