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
    Equation(
        tag="A: unit of k_n",
        what=r"unit of $k_n$, given as $m g/D$, that $F_n = k_n \delta^{3/2}$ needs",
        symbol="[k_n]",
        printed=MASS * GRAVITY / DIAMETER,
        derive=normal_stiffness,
        verdict="erratum",
        contradicted_by=r"$F_n = k_n \delta^{3/2}$ with $m g/d^{3/2}$",
        contradiction=lambda: MASS * GRAVITY / DIAMETER ** sp.Rational(3, 2),
        mistaken=lambda: _constant(lambda q: q * OVERLAP),
        mistake="the spring is taken for a linear one",
        at=_LENGTHS,
        note="$m g/d^{3/2}$; the printed unit is that of a linear spring (and $D$ stands for $d$). "
        "In reduced units, $d = m = g = 1$, the number is the same",
    ),
    Equation(
        tag="A: k_t = 95 k_n",
        what="dimension of $k_t$ over that of $k_n$",
        symbol="[k_t/k_n]",
        printed=sp.S.One,
        derive=lambda: sp.simplify(tangential_stiffness() / normal_stiffness()),
        verdict="erratum",
        contradicted_by=r"$F_t = -k_t \delta s$ with $F_n = k_n \delta^{3/2}$",
        contradiction=lambda: sp.simplify(
            (FORCE / (OVERLAP * SPRING)) / (FORCE / OVERLAP ** sp.Rational(3, 2))
        ),
        mistaken=lambda: sp.simplify(
            _constant(lambda q: q * sp.sqrt(OVERLAP) * SPRING) / normal_stiffness()
        ),
        mistake=r"as if the tangential force were $-k_t \delta^{1/2} s$",
        at=_LENGTHS,
        note=r"$k_t \delta s$ is a force only if $k_t$ is in $m g/d^2$; 95 is $k_t d^{1/2}/k_n$",
    ),
    Equation(
        tag="A: unit of gamma",
        what=r"unit of $\gamma_n$, given as $(g/D)^{1/2}$, that $\gamma_n M_e \delta v_n$ needs",
        symbol="[\\gamma_n]",
        printed=sp.sqrt(GRAVITY / DIAMETER),
        derive=damping,
        verdict="erratum",
        contradicted_by=r"$\gamma_n M_e \delta v_n$ with $(g/d^3)^{1/2}$",
        contradiction=lambda: sp.sqrt(GRAVITY / DIAMETER**3),
        mistaken=lambda: _constant(lambda q: q * REDUCED_MASS * SPEED),
        mistake="as if the damping force had no factor of overlap",
        at=_LENGTHS,
        note="$(g/d^3)^{1/2}$: the overlap in the damping term asks for another length",
    ),
    Equation(
        tag="A: time step",
        what="unit of the time step, $(d/g)^{1/2}$",
        symbol="[\\Delta t]",
        printed=sp.sqrt(DIAMETER / GRAVITY),
        derive=lambda: T,
    ),
    Equation(
        tag="A: v_n",
        what=r"normal velocity printed as $v_i \cdot n_{ij}$: what a common velocity $v$ adds to "
        '"$v_n$"',
        symbol="\\delta v_n",
        printed=_common,
        derive=lambda: _normal_part(_common, _common),
        at={_common: sp.Integer(1)},
        verdict="erratum",
        contradicted_by=r'"relative velocity" of the same sentence, $v_{ij} \cdot n_{ij} = 0$ for '
        "$v_i = v_j$",
        contradiction=lambda: sp.S.Zero,
        mistaken=lambda: _normal_part(_common, sp.S.Zero),
        mistake="the second grain's velocity is left out",
        note=r"it must be $v_{ij} \cdot n_{ij}$; as printed two grains that travel together damp "
        "each other",
    ),
)
