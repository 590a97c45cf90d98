"""Exercises of the report; each answer is computed from the derived equations."""

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

from .bodies import THIN
from .laws import a_1, a_2
from .lookup import equation
from .newton import approach
from .symbols import P_1, V_z, c_x, c_z, diameter, epsilon, length, m, mu, omega, phi, u_0, v_0

Values = dict[sp.Symbol, sp.Expr]

_SLIDING: Values = {mu: sp.Rational(3, 10), epsilon: sp.Rational(13, 20)}  # of the paper's Fig. 11
_LANDING: Values = {c_x: sp.Integer(1), c_z: sp.Integer(-2), omega: sp.Integer(0), V_z: sp.S.Zero}


@dataclass(frozen=True, slots=True)
class Exercise:
    """A question, and its answer; sentences with formulas between dollar signs."""

    question: str
    answer: Callable[[], str]


def _number(value: sp.Expr, digits: int = 3) -> str:
    return str(sp.N(value, digits)).rstrip("0").rstrip(".") if value else "0"


def _degrees(tangent: sp.Expr) -> str:
    return _number(sp.deg(sp.atan(tangent)))


def _thin(tag: str, tilt: int, **more: sp.Expr) -> sp.Expr:
    """An equation of a thin rod of length and mass one, tilt in degrees, before numbers go in."""
    return equation(tag).subs(THIN).subs({phi: sp.rad(tilt), length: 1, m: 1})


def _between() -> str:
    low, high = (root.subs(mu, _SLIDING[mu]) for root in equation("23: both roots"))
    return f"Between {_degrees(low)} and {_degrees(high)} degrees."


def _largest() -> str:
    friction = equation("IV: no reversal above 3/5")
    tangent = equation("23: both roots")[0].subs(mu, friction)
    return (
        rf"Both roots are real up to $\mu = {friction}$, where they meet at $\tan\phi = "
        rf"{tangent}$, "
        f"{_degrees(tangent)} degrees."
    )


def _product() -> str:
    low, high = equation("23: both roots")
    return rf"${sp.simplify(low * high)}$, and their sum is ${sp.latex(sp.simplify(low + high))}$."


def _contact() -> str:
    at = {length: 8, diameter: 1, phi: sp.rad(20)}
    x, z = (part.subs(at) for part in equation("bodies: contact")[:2])
    square = equation("bodies: gyration radius")[0].subs(at)
    critical = x * z / (square + z**2)
    return (
        f"$X = {_number(x)} d$, $Z = {_number(z)} d$, $k^2 = {_number(square)} d^2$: it slips back "
        rf"below $\mu = {_number(critical)}$."
    )


def _one_impact() -> str:
    start = {name: value.subs(_LANDING) for name, value in approach().items()}
    at = {**_LANDING, **_SLIDING}
    left = _thin("14", 20).subs(start).subs(at)
    condition = _thin("16", 20).subs(at)
    after = [_thin(tag, 20).subs(at) for tag in ("18", "19")]
    return (
        f"$u_* = {_number(left)}$, so the slip stops, and (16) "
        f"{'holds' if condition else 'fails'}: "
        f"slip-stick. $c_x' = {_number(after[0])}$, $c_z' = {_number(after[1])}$."
    )


def _best() -> str:
    tangent, drift = (part.subs(_SLIDING) for part in equation("V: optimum, slip-stick"))
    return f"{_degrees(tangent)} degrees, where $c_x = {_number(drift)} V_z$."


def _laws() -> str:
    at = {u_0: sp.Rational(11, 10), v_0: -1, mu: _SLIDING[mu], epsilon: sp.Rational(1, 2)}
    slopes = [part.subs(at) for part in _thin("laws: slopes", 12)]
    stop = {P_1: _thin("B1", 12).subs(at), a_1: slopes[0], a_2: slopes[1]}
    late = bool(_thin("15", 12).subs(at) > 0)
    poisson, stronge = (
        equation(f"laws: {law}")[late].subs(stop).subs(at) for law in ("Poisson", "Stronge")
    )
    newton = equation("IV: restitution").subs(at)
    return (
        f"The slip stops {('before', 'after')[late]} the deepest point. $v_f$ is {_number(newton)} "
        f"by Newton, {_number(poisson)} by Poisson and {_number(stronge)} by Stronge."
    )


def _gain() -> str:
    edge = sp.simplify(equation("laws: energy, thin rod").subs(phi, sp.pi / 4))
    return rf"Above $\epsilon = {edge}$."


def _pressed() -> str:
    tangent, friction = equation("Painleve: thin rod")
    return rf"$\mu_P = {friction}$ at $\tan\phi = {tangent}$, {_degrees(tangent)} degrees."


def _flat() -> str:
    tilt = equation("V: flat end").subs({length: 8, diameter: 1})
    return f"Below {_number(sp.deg(tilt))} degrees."


EXERCISES = (
    Exercise(
        r"A thin rod slides with $\mu = 0.3$. At which tilts does its contact point slip back?",
        _between,
    ),
    Exercise(
        r"Above which friction does a thin rod never slip back, and which tilt is the last to do "
        r"so?",
        _largest,
    ),
    Exercise(
        "Show that the product of the tangents of the two critical tilts does not depend on "
        "friction. "
        "What is it?",
        _product,
    ),
    Exercise(
        "A spherocylinder of length $l = 8 d$ leans by 20 degrees. Compute $X$, $Z$ and $k^2$, "
        "and the "
        "friction below which its contact point slips back.",
        _contact,
    ),
    Exercise(
        r"A thin rod at 20 degrees lands on a plate at rest with $c_x = 1$, $c_z = -2$, $\omega "
        r"= 0$, "
        r"$\mu = 0.3$, $\epsilon = 0.65$. Which regime is it, and how does the rod leave?",
        _one_impact,
    ),
    Exercise(
        r"Thin rod, $\mu = 0.3$, $\epsilon = 0.5$, 12 degrees, $u_0 = 1.1$, $v_0 = -1$, as in "
        r"the drawing "
        "of slip-stick: compare $v_f$ under the three laws.",
        _laws,
    ),
    Exercise(
        "Above which restitution can Newton's law create energy in slip-stick of a thin rod at "
        "45 degrees?",
        _gain,
    ),
    Exercise(
        "From which friction, and at which tilt, can a thin rod be thrown up by friction alone?",
        _pressed,
    ),
    Exercise(
        r"At which tilt does a thin rod with $\epsilon = 0.65$ drift fastest in slip-stick?", _best
    ),
    Exercise(
        "A flat-ended rod has $l = 8 d$. Below which tilt does it drift against its tilt?", _flat
    ),
)
