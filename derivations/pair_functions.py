"""Generated functions of two bodies that meet: outputs and rewriting rules."""

import sympy as sp

from . import pairs
from .newton import spin_jump, velocity_change
from .pairs import FIRST, SECOND
from .rewrites import Function
from .symbols import P_x, P_z, X, Z, k, m


def _of_levers(form: sp.Expr) -> sp.Expr:
    """A form of a rod or of two bodies, in inverse masses and levers over k."""
    for letters, names in (
        ({x: x for x in (m, k, X, Z)}, "s x z"),
        (FIRST, "s_1 x_1 z_1"),
        (SECOND, "s_2 x_2 z_2"),
    ):
        K, (s, x, z) = letters[k], sp.symbols(names, real=True)
        form = form.subs({letters[m]: 1 / s, letters[X]: x * K, letters[Z]: z * K})
    return sp.expand(form)


FUNCTIONS: tuple[Function, ...] = (
    Function.read(
        "pair_mobility",
        lambda: {
            letter: _of_levers(form)
            for letter, form in {**pairs.mobility(), "D": pairs.determinant()}.items()
        },
    ),
    Function.read(
        "pair_change",
        lambda: {
            "dc_x": _of_levers(velocity_change(P_x)),
            "dc_z": _of_levers(velocity_change(P_z)),
            "turn": _of_levers(k * spin_jump(P_x, P_z)),
        },
    ),
)
