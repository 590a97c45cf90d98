"""Beyond the paper: two bodies that meet at a point, by the theory of a rod on a plate.

The contact point is the origin, z points from the second body to the first; the impulse P acts on
the first, its opposite on the second. The contact velocity of the first relative to the second
answers to P with mobilities A, B, C, as that of a rod on a plate does. Nothing else of the bodies
enters an impact, so the branch rule and the three laws are those of the rod.
"""

from functools import cache

import sympy as sp

from . import laws
from .equality import Forms, Residuals
from .laws import A, B, C
from .newton import approach, contact_change
from .proof import Equation
from .symbols import P_x, P_z, X, Z, c_x, c_z, k, m, omega, u_f, v_f
from .trace import derived

# Letters of each body, by those of a rod.
FIRST, SECOND = (
    {
        x: sp.Symbol(f"{x}_{i}", real=True, positive=x.is_positive)
        for x in (m, k, X, Z, c_x, c_z, omega)
    }
    for i in (1, 2)
)


@derived(r"\Delta u", r"\Delta v")
def response() -> sp.Matrix:
    """Change of the relative contact velocity under the impulse."""
    first = sp.Matrix(contact_change(P_x, P_z)).subs(FIRST)
    return (first - sp.Matrix(contact_change(-P_x, -P_z)).subs(SECOND)).expand()


@derived()
def mobility() -> Forms:
    r"""Read off $\Delta u = C P_x - B P_z$ and $\Delta v = A P_z - B P_x$."""
    return laws.read_off(*response())


@derived("A C - B^2")
def determinant() -> sp.Expr:
    """Determinant of the response of two bodies."""
    return sp.expand((A * C - B**2).subs(mobility()))


# ---- second routes ----------------------------------------------------------------------------


@cache
def _kinetic_energy() -> sp.Expr:
    """Kinetic energy of both bodies after P; each keeps its spin about the contact point."""
    energy = 0
    for letters, sign in ((FIRST, 1), (SECOND, -1)):
        M, K, x, z, v_x, v_z, spin = letters.values()
        after_x, after_z = v_x + sign * P_x / M, v_z + sign * P_z / M
        turning = K * spin + (z * (v_x - after_x) - x * (v_z - after_z)) / K  # k omega
        energy += M * (after_x**2 + after_z**2 + turning**2) / 2
    return energy


def _answers() -> sp.Matrix:
    """Response (C, -B; -B, A) of the contact velocity, the gradient of the energy by P, to P."""
    return sp.hessian(_kinetic_energy(), (P_x, P_z))


def _kinetic_energies(form: sp.Expr) -> Residuals:
    """Residual of the energy change: kinetic energy of both bodies after minus before.

    The gradient of the kinetic energy by P is the contact velocity.
    """
    energy, nothing = _kinetic_energy(), {P_x: 0, P_z: 0}
    before = {x: form.subs(FIRST) - form.subs(SECOND) for x, form in approach().items()}
    contact = {**before, u_f: energy.diff(P_x), v_f: energy.diff(P_z)}
    return [energy - energy.subs(nothing) - form.subs(contact, simultaneous=True)]


def _sum(form: sp.Expr) -> sp.Expr:
    """Sum of a form of one body over both bodies."""
    return form.subs(FIRST) + form.subs(SECOND)


_turn = 1 / (m * k**2)
CROSS = FIRST[X] * SECOND[Z] - SECOND[X] * FIRST[Z]
EQUATIONS = (
    Equation(
        "pairs: mobilities",
        "mobilities of two bodies: an impulse changes the contact velocity of the first relative "
        r"to the second by $\Delta u = C P_x - B P_z$ and $\Delta v = A P_z - B P_x$",
        "(A, B, C)",
        derive=lambda: tuple(mobility().values()),
        check=lambda form: sp.Matrix([[form[2], -form[1]], [-form[1], form[0]]]) - _answers(),
    ),
    Equation(
        "pairs: determinant",
        "$A C - B^2$ of two bodies",
        "A C - B^2",
        derive=determinant,
        shown=_sum(1 / m) ** 2
        + _sum(1 / m) * _sum(_turn * (X**2 + Z**2))
        + _turn.subs(FIRST) * _turn.subs(SECOND) * CROSS**2,
        check=lambda form: (form - _answers().det(),),
    ),
    Equation(
        "pairs: energy",
        "change of the kinetic energy of both bodies",
        r"\Delta E",
        derive=laws.energy_of_impulse,
        check=_kinetic_energies,
    ),
)
