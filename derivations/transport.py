"""Beyond the paper: the drift of short rods, and what stationary translation costs in energy."""

import sympy as sp

from . import second_routes
from .bodies import round_contact, spherocylinder_gyration
from .drift import CASES, stationary
from .newton import g, spin_jump, velocity_change
from .proof import Equation
from .slide import cm_velocity
from .symbols import V_z, X, Z, c_x, c_z, diameter, epsilon, h_0, k, length, m, mu, omega, phi
from .trace import derived, solve

_ROUND = {length: 1 + h_0, diameter: sp.Integer(1)}  # h_0 = l/d - 1, lengths in d


@derived
def round_drift() -> sp.Expr:
    """c_x/V_z of a spherocylinder in slip-stick, over h_0 = l/d - 1."""
    x, z = round_contact()
    lengths = {X: x, Z: z, k: sp.sqrt(spherocylinder_gyration())}
    return sp.factor((stationary("stick")[0] / V_z).subs(lengths).subs(_ROUND))


@derived
def slope_of_short_rods() -> sp.Expr:
    """c_x/V_z over l/d - 1 as the length goes to the diameter."""
    return sp.factor(sp.limit(round_drift() / h_0, h_0, 0))


@derived
def best_length() -> sp.Expr:
    """Polynomial in h_0 whose positive root is the length of the largest drift; 1 at h_0 = 0."""
    steepness = sp.numer(sp.together(round_drift().diff(h_0)))
    (factor,) = (f for f, _ in sp.factor_list(steepness)[1] if sp.degree(f, h_0) > 1)
    return sp.collect(sp.expand(sp.cancel(factor / factor.subs(h_0, 0))), h_0)


@derived
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


@derived
def energies(case: str) -> tuple[sp.Expr, sp.Expr]:
    """Work of the plate in a stationary landing, and what goes into the spin, per unit mass."""
    p_x, p_z = landing_impulse(case)
    return sp.factor(p_z * V_z / m), sp.factor(k**2 * spin_jump(p_x, p_z) ** 2 / 2)


@derived
def cost_of_transport(case: str) -> sp.Expr:
    """Work of the plate per distance and weight; a flight lasts 2 c_z'/g."""
    along, up = stationary(case)
    distance = along * 2 * up / g
    return sp.factor(energies(case)[0] / (g * distance))


@derived
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

EQUATIONS = (
    Equation.read(
        "V: short rods",
        derive=slope_of_short_rods,
        shown=5 * (1 + epsilon) / (1 - epsilon) * sp.sin(phi),
        check=_short_checks,
    ),
    Equation.read(
        "V: best length",
        derive=best_length,
        shown=1
        + (3 + 2 * sp.cos(phi)) * h_0
        + ((55 + 234 * sp.cos(phi)) / 32 - 5 * _slant) * h_0**2
        + ((135 * sp.cos(phi) - 40) / 16 - 15 * _slant) * h_0**3
        + (5 * (4 * sp.cos(phi) - 3) / 8 - sp.Rational(45, 4) * _slant) * h_0**4,
        check=_length_checks,
    ),
    Equation.read(
        "V: landing with spin",
        derive=lambda: tuple(part for case in CASES for part in spin_response(case)),
        shown=(
            Z * ((1 - epsilon) * k**2 - 2 * epsilon * X**2) / _lossy,
            _spin_up,
            ((1 - epsilon) * Z * (k**2 + X**2) - (1 + epsilon) * mu * X * (k**2 + Z**2)) / _lossy,
            _spin_up,
        ),
        check=_spin_checks,
    ),
    Equation.read(
        "V: energy of a landing",
        derive=lambda: tuple(part for case in CASES for part in energies(case)),
        shown=sp.Matrix([2 * _up * V_z, 2 * X**2 * _up**2 / k**2] * 2),
        check=_energy_checks,
    ),
    Equation.read(
        "V: cost of transport",
        derive=lambda: tuple(cost_of_transport(case) for case in CASES),
        shown=(
            _lossy / (2 * (1 + epsilon) * X * Z),
            _lossy / ((1 + epsilon) * (X * Z + mu * (k**2 + Z**2))),
        ),
        check=_cost_checks,
    ),
)
