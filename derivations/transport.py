"""Beyond the paper: the drift of short rods, and what stationary translation costs in energy."""

import sympy as sp

from . import second_routes
from .bodies import round_contact, spherocylinder_gyration
from .drift import CASES, stationary
from .lecture import PAPER, compared, degrees, number, percent, sign
from .newton import g, spin_jump, velocity_change
from .proof import Equation
from .slide import cm_velocity
from .symbols import V_z, X, Z, c_x, c_z, diameter, epsilon, h_0, k, length, m, mu, omega, phi
from .trace import derived, solve
from .typeset import latex

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


@derived("P_x", "P_z")
def landing_impulse(case: str) -> tuple[sp.Expr, sp.Expr]:
    """(P_x, P_z) of the stationary landing, from the change of the centre's velocity."""
    along, up = stationary(case)
    p_x, p_z = sp.symbols("p_x p_z")
    landed = {c_x: along, c_z: -up, omega: 0}
    after_x, after_z = (
        part.subs(landed) for part in (c_x + velocity_change(p_x), c_z + velocity_change(p_z))
    )
    along, up = solve([after_x - along, after_z - up], [p_x, p_z])
    return along, sp.factor(up)


@derived("W_{%(case)s}", "E_{%(case)s}")
def energies(case: str) -> tuple[sp.Expr, sp.Expr]:
    """Work of the plate in a stationary landing, and what goes into the spin, per unit mass."""
    p_x, p_z = landing_impulse(case)
    return sp.factor(p_z * V_z / m), sp.factor(k**2 * spin_jump(p_x, p_z) ** 2 / 2)


@derived("[W/(m g s)]_{%(case)s}")
def cost_of_transport(case: str) -> sp.Expr:
    """Work of the plate per distance and weight; a flight lasts 2 c_z'/g."""
    along, up = stationary(case)
    distance = along * 2 * up / g
    return sp.factor(energies(case)[0] / (g * distance))


@derived(r"[\partial c'_x/\partial\omega]_{%(case)s}", r"[\partial c'_z/\partial\omega]_{%(case)s}")
def spin_response(case: str) -> tuple[sp.Expr, sp.Expr]:
    """Derivatives of the stationary c_x' and c_z' by a spin omega at every landing."""
    after_x, after_z = cm_velocity(*CASES[case]())
    before_x, before_z = solve([after_x - c_x, after_z + c_z], [c_x, c_z])
    return sp.factor(before_x.diff(omega)), sp.factor(-before_z.diff(omega))


def _spin_checks(form: sp.Matrix) -> list[sp.Expr]:
    """A landing of spin 1 on a plate at rest, at just these velocities, repeats itself."""
    checks = []
    for case, along, up in zip(CASES, form[::2], form[1::2], strict=True):
        landed = {c_x: along, c_z: -up, omega: 1, V_z: 0}
        v_x, v_z, _ = (part.subs(landed, simultaneous=True) for part in second_routes.impact(case))
        checks += [v_x - along, v_z - up]
    return checks


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


def _energy_checks(form: sp.Matrix) -> list[sp.Expr]:
    """Kinetic energies before and after whole landings: the difference is the spin's.

    The plate's work is also what its frame and the laboratory's differ by.
    """
    checks = []
    for case, work, spin in zip(CASES, form[::2], form[1::2], strict=True):
        along, up = stationary(case)
        landed = {c_x: along, c_z: -up, omega: 0}
        v_x, v_z, turn = (
            part.subs(landed, simultaneous=True) for part in second_routes.impact(case)
        )
        before, after = along**2 + up**2, v_x**2 + v_z**2 + k**2 * turn**2
        in_plate = (v_z - V_z) ** 2 - (up + V_z) ** 2  # change of the same in the plate's frame
        checks += [(after - before) / 2 - spin, (v_z**2 - up**2 - in_plate) / 2 - work]
    return checks


def _cost_checks(form: sp.Matrix) -> list[sp.Expr]:
    """Per period of flight and landing the plate carries the weight at its velocity."""
    return [cost * stationary(case)[0] - V_z for case, cost in zip(CASES, form, strict=True)]


_lossy = (1 - epsilon) * k**2 + 2 * X**2
_slant = sp.sin(phi) ** 2 / (1 - epsilon)
_spin_up = -(1 + epsilon) * k**2 * X / _lossy
_up = (1 + epsilon) * k**2 * V_z / _lossy


def _gain(tilt: int, length_less_1: sp.Expr) -> sp.Expr:
    """Drift over that of a thin rod, both in slip-stick, less one."""
    at = {phi: sp.rad(tilt), epsilon: PAPER[epsilon]}
    along = round_drift().subs(at)
    return along.subs(h_0, length_less_1) / sp.limit(along, h_0, sp.oo) - 1


def _best(tilt: int) -> sp.Expr:
    curve = best_length().subs({phi: sp.rad(tilt), epsilon: PAPER[epsilon]})
    return max(root for root in sp.Poly(curve.evalf(40), h_0).nroots(30) if root.is_real)


def _lengths_told() -> str:
    """From which tilt on there is a best length, and what it gains."""
    cosine = sp.Symbol("c")
    last = best_length().coeff(h_0, 4).subs(PAPER)
    turns = sp.expand(last.subs(sp.sin(phi) ** 2, 1 - cosine**2).subs(sp.cos(phi), cosine))
    first = sp.acos(max(sp.Poly(turns, cosine).nroots(30)))
    behind = _gain(10, sp.Integer(2))
    slower = compared(behind, 0, ("faster", "slower"))
    return (
        f"for the paper's restitution, {number(PAPER[epsilon])}, from {degrees(first)} on; below, "
        f"a longer rod is always faster. At 30 degrees the best is $l = {number(1 + _best(30))} "
        f"d$, with {number(1 + _gain(30, _best(30)), 3)} times the drift of a thin rod that "
        f"sticks; at 15 degrees, as in Fig. 13(c), the gain is {percent(_gain(15, _best(15)))}, "
        f"and at 10 degrees $l = 3 d$ is {percent(abs(behind))} {slower} than a thin rod"
    )


def _spin_told() -> str:
    """The sign of what a spin adds, on both sides of the bound."""
    added = spin_response("stick")[0]
    (bound,) = sp.solve(sp.numer(added), X**2)
    sides = [
        added.subs(X, sp.sqrt(bound) * x).subs({epsilon: sp.S.Half, k: 1, Z: 1}) for x in (0, 2)
    ]
    first, beyond = (compared(side, 0, ("faster", "slower")) for side in sides)
    return (
        f"a rod that sticks and still turns forward when it lands drifts {first} where $X^2 < "
        f"{latex(bound)}$, at small tilt, and {beyond} beyond"
    )


def _cost_told() -> str:
    grows = sign(stationary("back")[0].diff(mu))
    if grows != "positive" or stationary("stick")[0].has(mu):
        raise ValueError("the drift depends otherwise on friction")
    return (
        "$V_z/c_x$ whatever the rod: the fastest rod is the cheapest. The drift grows with "
        "friction up to the one at which the contact holds, and not beyond"
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
            rf"paper's restitution, {number(PAPER[epsilon])}: steep, as in Fig. 13(c)"
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
        "V: landing with spin",
        (
            r"what a spin $\omega$ at every landing adds to $c_x'$ and $c_z'$, over "
            r"$\omega$: slip-stick, then slip reversal"
        ),
        (
            r"([\partial c_x'/\partial\omega]_{stick}, [\partial c_z'/\partial\omega]_{stick}, "
            r"[\partial c_x'/\partial\omega]_{back}, [\partial c_z'/\partial\omega]_{back})"
        ),
        derive=lambda: tuple(part for case in CASES for part in spin_response(case)),
        shown=(
            Z * ((1 - epsilon) * k**2 - 2 * epsilon * X**2) / _lossy,
            _spin_up,
            ((1 - epsilon) * Z * (k**2 + X**2) - (1 + epsilon) * mu * X * (k**2 + Z**2)) / _lossy,
            _spin_up,
        ),
        check=_spin_checks,
        note=_spin_told,
    ),
    Equation(
        "V: energy of a landing",
        (
            "per unit mass in a stationary landing: work $W$ of the plate and energy $E$ of"
            " the spin, in slip-stick, then in slip reversal"
        ),
        "(W_{stick}, E_{stick}, W_{back}, E_{back})",
        derive=lambda: tuple(part for case in CASES for part in energies(case)),
        shown=sp.Matrix([2 * _up * V_z, 2 * X**2 * _up**2 / k**2] * 2),
        check=_energy_checks,
        note="the closure takes the spin away in flight; all else is lost at the contact",
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
        note=_cost_told,
    ),
)
