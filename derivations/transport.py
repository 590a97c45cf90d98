"""Beyond the paper: the drift of short rods, and the work of the plate on a rod that drifts."""

import sympy as sp

from . import second_routes
from .bodies import round_contact, spherocylinder_gyration
from .drift import CASES, stationary
from .lecture import PAPER, degrees, negative, number, percent
from .newton import g, velocity_change
from .proof import Equation
from .symbols import V_z, X, Z, c_z, diameter, epsilon, h_0, k, length, m, mu, phi
from .trace import derived, solve

_ROUND = {length: 1 + h_0, diameter: sp.Integer(1)}  # h_0 = l/d - 1, lengths in d


@derived("c_x/V_z")
def round_drift() -> sp.Expr:
    """c_x/V_z of a spherocylinder in slip-stick, over h_0 = l/d - 1."""
    x, z = round_contact()
    lengths = {X: x, Z: z, k: sp.sqrt(spherocylinder_gyration())}
    return sp.factor((stationary("stick")[0] / V_z).subs(lengths).subs(_ROUND))


@derived("c_x/(V_z h_0)")
def slope_of_short_rods() -> sp.Expr:
    """c_x/V_z over l/d - 1 as the length goes to the diameter."""
    return sp.factor(sp.limit(round_drift() / h_0, h_0, 0))


@derived("p(h_0)")
def best_length() -> sp.Expr:
    """Polynomial in h_0 whose positive root is the length of the largest drift; 1 at h_0 = 0."""
    steepness = sp.numer(sp.together(round_drift().diff(h_0)))
    (factor,) = (f for f, _ in sp.factor_list(steepness)[1] if sp.degree(f, h_0) > 1)
    return sp.collect(sp.expand(sp.cancel(factor / factor.subs(h_0, 0))), h_0)


@derived("P_z")
def landing_impulse(case: str) -> sp.Expr:
    """Normal impulse of the stationary landing, from the change of the centre's velocity."""
    _, up = stationary(case)
    p_z = sp.Symbol("p_z")
    (impulse,) = solve(c_z + velocity_change(p_z, "dc_z") - up, p_z)
    return sp.factor(impulse.subs(c_z, -up))


@derived("[W/(m g s)]_{%(case)s}")
def cost_of_transport(case: str) -> sp.Expr:
    """Work of the plate per distance and weight; a flight lasts 2 c_z'/g."""
    along, up = stationary(case)
    distance = along * 2 * up / g
    return sp.factor(landing_impulse(case) * V_z / (m * g * distance))


def _length_checks(form: sp.Expr) -> list[sp.Expr]:
    """The drift from whole landings has its extrema there, and nowhere else."""
    x, z = (part.subs(_ROUND) for part in round_contact())
    square = spherocylinder_gyration().subs(_ROUND)
    drift = second_routes.landing("stick")[0].subs({V_z: 1, X: x, Z: z, k: sp.sqrt(square)})
    steepness = sp.numer(sp.cancel(drift.diff(h_0)))
    rest = sp.cancel(steepness / form)
    return [form.subs(h_0, 0) - 1, rest.diff(h_0)]


def _short_checks(form: sp.Expr) -> list[sp.Expr]:
    """A ball's gyration and height, and a centre of mass a little aside: the whole landing."""
    aside = sp.Symbol("x", positive=True)
    ball = {V_z: 1, X: aside, Z: sp.Rational(1, 2), k: sp.sqrt(sp.Rational(1, 10))}
    drift = second_routes.landing("stick")[0].subs(ball)
    return [(drift - form * aside * 2 / sp.sin(phi)).diff(aside).subs(aside, 0)]


def _cost_checks(form: sp.Matrix) -> list[sp.Expr]:
    """Per period of flight and landing the plate carries the weight at its velocity."""
    return [cost * stationary(case)[0] - V_z for case, cost in zip(CASES, form, strict=True)]


_lossy = (1 - epsilon) * k**2 + 2 * X**2
_slant = sp.sin(phi) ** 2 / (1 - epsilon)


def _gain(tilt: int) -> sp.Expr:
    """Drift of the best length over that of a thin rod, both in slip-stick, less one."""
    along = round_drift().subs({phi: sp.rad(tilt), epsilon: PAPER[epsilon]})
    return along.subs(h_0, _best(tilt)) / sp.limit(along, h_0, sp.oo) - 1


def _best(tilt: int) -> sp.Expr:
    """Best length, less the diameter, over it; the tilt in degrees."""
    curve = best_length().subs({phi: sp.rad(tilt), epsilon: PAPER[epsilon]})
    return max(root for root in sp.Poly(curve.evalf(40), h_0).nroots(30) if root.is_real)


def _lengths_told() -> str:
    """From which tilt on there is a best length; two of them."""
    cosine = sp.Symbol("c")
    last = best_length().coeff(h_0, 4).subs(PAPER)
    turns = sp.expand(last.subs(sp.sin(phi) ** 2, 1 - cosine**2).subs(sp.cos(phi), cosine))
    first = sp.acos(max(sp.Poly(turns, cosine).nroots(30)))
    best = "; ".join(
        f"{tilt} degrees: $l = {number(1 + _best(tilt))} d$, {percent(_gain(tilt))}"
        for tilt in (15, 30)
    )
    return (
        f"for the paper's restitution, {number(PAPER[epsilon])}, {negative(last, phi, first)} "
        f"{degrees(first)}. Best length, and what it adds to the drift of a thin rod that sticks: "
        f"{best}"
    )


EQUATIONS = (
    Equation(
        "V: short rods",
        "drift of a spherocylinder as its length goes to its diameter, $h_0 = l/d - 1$",
        "c_x/(V_z h_0)",
        derive=slope_of_short_rods,
        shown=5 * (1 + epsilon) / (1 - epsilon) * sp.sin(phi),
        check=_short_checks,
        note=lambda: (
            rf"${number((slope_of_short_rods() / sp.sin(phi)).subs(PAPER))} \sin\phi$ for the "
            rf"paper's restitution, {number(PAPER[epsilon])}"
        ),
    ),
    Equation(
        "V: best length",
        (
            "the drift of a spherocylinder in slip-stick is largest where this is zero, "
            "$h_0 = l/d - 1$"
        ),
        "p(h_0)",
        derive=best_length,
        shown=1
        + (3 + 2 * sp.cos(phi)) * h_0
        + ((55 + 234 * sp.cos(phi)) / 32 - 5 * _slant) * h_0**2
        + ((135 * sp.cos(phi) - 40) / 16 - 15 * _slant) * h_0**3
        + (5 * (4 * sp.cos(phi) - 3) / 8 - sp.Rational(45, 4) * _slant) * h_0**4,
        check=_length_checks,
        note=_lengths_told,
    ),
    Equation(
        "V: cost of transport",
        "work of the plate per weight and distance travelled: slip-stick, slip reversal",
        "([W/(m g s)]_{stick}, [W/(m g s)]_{back})",
        derive=lambda: tuple(cost_of_transport(case) for case in CASES),
        shown=(
            _lossy / (2 * (1 + epsilon) * X * Z),
            _lossy / ((1 + epsilon) * (X * Z + mu * (k**2 + Z**2))),
        ),
        check=_cost_checks,
    ),
)
