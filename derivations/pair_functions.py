"""Generated functions of two bodies that meet: outputs and rewriting rules."""

import sympy as sp

from . import pairs
from .laws import A, B, C
from .newton import spin_jump, velocity_change
from .pairs import FIRST, SECOND
from .rewrites import Function, recast
from .symbols import P_x, P_z, X, Z, k, m, mu

_s, _x, _z, _D, _N, _T, _turn = sp.symbols("s x z D N T turn", real=True)
_s_1, _s_2 = sp.symbols("s_1 s_2", positive=True)
_x_1, _z_1, _x_2, _z_2 = sp.symbols("x_1 z_1 x_2 z_2", real=True)
_across, _along, _both, _cross = sp.symbols("across along both cross", real=True)
_LEVERS = {
    FIRST[m]: 1 / _s_1,
    FIRST[X]: _x_1 * FIRST[k],
    FIRST[Z]: _z_1 * FIRST[k],
    SECOND[m]: 1 / _s_2,
    SECOND[X]: _x_2 * SECOND[k],
    SECOND[Z]: _z_2 * SECOND[k],
}


def _of_levers(expr: sp.Expr) -> sp.Expr:
    """In inverse masses and levers over k."""
    return sp.expand(expr.subs(_LEVERS))


def _of_body(expr: sp.Expr) -> sp.Expr:
    return sp.expand(expr.subs({m: 1 / _s, X: _x * k, Z: _z * k}, simultaneous=True))


FUNCTIONS: tuple[Function, ...] = (
    Function(
        name="pair_mobility",
        summary="Mobilities $A$, $B$, $C$ of two bodies at their contact, and $D = A C - B^2$.",
        detail="$s$ inverse masses, $x = X/k$, $z = Z/k$; $A$, $B$, $C$ in the unit of $s$.",
        arguments=(_s_1, _x_1, _z_1, _s_2, _x_2, _z_2),
        outputs={
            **{letter: _of_levers(form) for letter, form in pairs.mobility().items()},
            _D: _of_levers(pairs.determinant()),
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
                both=_s_1 * _s_2,
                cross=_x_1 * _z_2 - _x_2 * _z_1,
                D=_s * (_s + _across + _along) + _both * _cross**2,
            ),
        ),
        returned=("A", "B", "C", "D"),
    ),
    Function(
        name="pair_response",
        summary="$(N, T)$: $dv/dP_z$ and $-du/dP_z$ in forward slip, of any mobilities.",
        detail=r"In the unit of $A$, $B$, $C$. Backward slip: the same with $-\mu$.",
        arguments=(A, B, C, mu),
        outputs={
            _N: sp.expand((A * P_z - B * P_x).subs(P_x, -mu * P_z) / P_z),
            _T: sp.expand((B * P_z - C * P_x).subs(P_x, -mu * P_z) / P_z),
        },
        rules=(),
    ),
    Function(
        name="pair_change",
        summary=r"Change of $c_x$, $c_z$ and $k \omega$ of a body under an impulse at its contact.",
        detail="$s$ inverse mass, $x = X/k$, $z = Z/k$.",
        arguments=(_s, _x, _z, P_x, P_z),
        outputs={
            sp.Symbol("dc_x"): _of_body(velocity_change(P_x)),
            sp.Symbol("dc_z"): _of_body(velocity_change(P_z)),
            _turn: _of_body(k * spin_jump(P_x, P_z)),
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
