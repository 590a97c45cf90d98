"""Generated functions of two bodies that meet: outputs and rewriting rules."""

import sympy as sp

from . import pairs
from .newton import spin_jump, velocity_change
from .pairs import FIRST, SECOND
from .rewrites import Function, recast
from .symbols import P_x, P_z, X, Z, k, m

_s, _x, _z, _across, _along, _cross, _turn, _D = sp.symbols(
    "s x z across along cross turn D", real=True
)
(_s_1, _x_1, _z_1), (_s_2, _x_2, _z_2) = (
    sp.symbols(f"s_{i} x_{i} z_{i}", real=True) for i in (1, 2)
)


def _of_levers(form: sp.Expr) -> sp.Expr:
    """A form of a rod or of two bodies, in inverse masses and levers over k."""
    rods = (
        ({x: x for x in (m, k, X, Z)}, _s, _x, _z),
        (FIRST, _s_1, _x_1, _z_1),
        (SECOND, _s_2, _x_2, _z_2),
    )
    for letters, s, x, z in rods:
        K = letters[k]
        form = form.subs({letters[m]: 1 / s, letters[X]: x * K, letters[Z]: z * K})
    return sp.expand(form)


FUNCTIONS: tuple[Function, ...] = (
    Function(
        name="pair_mobility",
        summary="Mobilities $A$, $B$, $C$ of two bodies at their contact, and $D = A C - B^2$.",
        detail="$s$ inverse masses, $x = X/k$, $z = Z/k$; $A$, $B$, $C$ in the unit of $s$.",
        arguments=(_s_1, _x_1, _z_1, _s_2, _x_2, _z_2),
        derived=lambda: {
            letter: _of_levers(form)
            for letter, form in {**pairs.mobility(), _D: pairs.determinant()}.items()
        },
        rules=(
            recast(
                "sums of positive terms",
                "$A$, $C$ and $D$ cannot cancel",
                s=_s_1 + _s_2,
                across=_s_1 * _x_1**2 + _s_2 * _x_2**2,
                along=_s_1 * _z_1**2 + _s_2 * _z_2**2,
                A=_s + _across,
                B=_s_1 * _x_1 * _z_1 + _s_2 * _x_2 * _z_2,
                C=_s + _along,
                cross=_x_1 * _z_2 - _x_2 * _z_1,
                D=_s * (_s + _across + _along) + _s_1 * _s_2 * _cross**2,
            ),
        ),
        returned=("A", "B", "C", "D"),
    ),
    Function(
        name="pair_change",
        summary=r"Change of $c_x$, $c_z$ and $k \omega$ of a body under an impulse at its contact.",
        detail="$s$ inverse mass, $x = X/k$, $z = Z/k$.",
        arguments=(_s, _x, _z, P_x, P_z),
        derived=lambda: {
            sp.Symbol("dc_x"): _of_levers(velocity_change(P_x)),
            sp.Symbol("dc_z"): _of_levers(velocity_change(P_z)),
            _turn: _of_levers(k * spin_jump(P_x, P_z)),
        },
        rules=(
            recast(
                "inverse mass last",
                "an infinite mass stays as it is",
                dc_x=P_x * _s,
                dc_z=P_z * _s,
                turn=_s * (P_z * _x - P_x * _z),
            ),
        ),
    ),
)
