"""Dimensions of the material constants in Appendix A's force law.

Dimensions are monomials in mass M, length L and time T; a constant's dimension is solved from the
force law in which it stands.
"""

from collections.abc import Callable

import sympy as sp

from .proof import Equation
from .trace import solve

M, L, T = sp.symbols("M L T", positive=True)

FORCE, SPEED = M * L / T**2, L / T
GRAVITY, DIAMETER, MASS = L / T**2, L, M
OVERLAP, SPRING, REDUCED_MASS = L, L, M


def _constant(term: Callable[[sp.Expr], sp.Expr], dimension: sp.Expr = FORCE) -> sp.Expr:
    """Dimension of the one constant in `term`, so that the term is a force."""
    unknown = sp.Symbol("q", positive=True)
    (value,) = solve(term(unknown) - dimension, unknown)
    return sp.simplify(value)


def normal_stiffness() -> sp.Expr:
    """Dimension of k_n in F_n = k_n delta^(3/2)."""
    return _constant(lambda q: q * OVERLAP ** sp.Rational(3, 2))


def tangential_stiffness() -> sp.Expr:
    """Dimension of k_t in F_t = -k_t delta s."""
    return _constant(lambda q: q * OVERLAP * SPRING)


def damping() -> sp.Expr:
    """Dimension of gamma_n in F_n = -gamma_n M_e delta v_n."""
    return _constant(lambda q: q * REDUCED_MASS * OVERLAP * SPEED)


_common = sp.Symbol("v", real=True)


def _normal_part(first: sp.Expr, second: sp.Expr) -> sp.Expr:
    """Normal part of the relative velocity of two grains that move along the normal."""
    normal = sp.Matrix([0, 0, 1])
    return ((first - second) * normal).dot(normal)


_LENGTHS = {M: sp.Integer(1), L: sp.Integer(4), T: sp.Integer(1)}

EQUATIONS = (
    Equation.read(
        "A: unit of k_n",
        printed=MASS * GRAVITY / DIAMETER,
        derive=normal_stiffness,
        contradiction=lambda: MASS * GRAVITY / DIAMETER ** sp.Rational(3, 2),
        mistaken=lambda: _constant(lambda q: q * OVERLAP),
        at=_LENGTHS,
    ),
    Equation.read(
        "A: k_t = 95 k_n",
        printed=sp.S.One,
        derive=lambda: sp.simplify(tangential_stiffness() / normal_stiffness()),
        contradiction=lambda: sp.simplify(
            (FORCE / (OVERLAP * SPRING)) / (FORCE / OVERLAP ** sp.Rational(3, 2))
        ),
        mistaken=lambda: sp.simplify(
            _constant(lambda q: q * sp.sqrt(OVERLAP) * SPRING) / normal_stiffness()
        ),
        at=_LENGTHS,
    ),
    Equation.read(
        "A: unit of gamma",
        printed=sp.sqrt(GRAVITY / DIAMETER),
        derive=damping,
        contradiction=lambda: sp.sqrt(GRAVITY / DIAMETER**3),
        mistaken=lambda: _constant(lambda q: q * REDUCED_MASS * SPEED),
        at=_LENGTHS,
    ),
    Equation.read("A: time step", printed=sp.sqrt(DIAMETER / GRAVITY), derive=lambda: T),
    Equation.read(
        "A: v_n",
        printed=_common,
        derive=lambda: _normal_part(_common, _common),
        at={_common: sp.Integer(1)},
        contradiction=lambda: sp.S.Zero,
        mistaken=lambda: _normal_part(_common, sp.S.Zero),
    ),
)
