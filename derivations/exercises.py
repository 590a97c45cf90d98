"""Exercises of the report: questions from lecture.toml, answers computed from the equations."""

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

from .bodies import THIN
from .laws import a_1, a_2
from .lecture import TEXTS
from .lookup import equation
from .newton import approach
from .symbols import P_1, V_z, c_x, c_z, diameter, epsilon, length, m, mu, omega, phi, u_0, v_0
from .typeset import latex

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
    where = rf"$\tan\phi = {tangent}$, {_degrees(tangent)} degrees"
    return rf"Both roots are real up to $\mu = {friction}$, where they meet at {where}."


def _product() -> str:
    low, high = equation("23: both roots")
    return f"It is ${sp.simplify(low * high)}$; their sum is ${latex(sp.simplify(low + high))}$."


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
    regime = "holds: slip-stick" if condition else "fails: slip reversal"
    velocities = f"$c_x' = {_number(after[0])}$, $c_z' = {_number(after[1])}$"
    return f"$u_* = {_number(left)}$, so the slip stops, and (16) {regime}. {velocities}."


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


_ANSWERS = (
    _between,
    _largest,
    _product,
    _contact,
    _one_impact,
    _laws,
    _gain,
    _pressed,
    _best,
    _flat,
)
EXERCISES = tuple(Exercise(TEXTS["exercises"][of.__name__.strip("_")], of) for of in _ANSWERS)
