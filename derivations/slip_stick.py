"""Slip-stick: the slip stops and friction holds the contact, Eqs. (16)-(19), (B1)-(B5)."""

from collections.abc import Callable

import sympy as sp

from .axioms import RESTITUTION, STICK, held
from .equality import Pair
from .newton import contact_change, contact_force
from .proof import Equation, Repair
from .slide import by_speeds, cm_velocity, stop
from .symbols import (
    P_1,
    F_x,
    F_z,
    P_z,
    m,
    mu,
    v_1,
)
from .trace import derived, only_root, say
from .typeset import latex

P_2 = sp.Symbol("P_2", positive=True)  # normal impulse after the slip has stopped


@derived("F_x")
def sticking_force() -> sp.Expr:
    """The friction force that keeps the contact point at rest: (5) without acceleration."""
    sentence = "The contact point rests, so that (5) is zero; solved for $F_x$"
    return only_root(contact_force(0), F_x, sentence)


@derived(r"\mu - |F_x|/F_z")
def stick_margin() -> sp.Expr:
    """The margin of sticking for $XZ > 0$, by the force (17)."""
    return sp.together(STICK({held: sticking_force() / F_z}))


@derived("v_f - v_1")
def sticking_velocity(p_z: sp.Expr) -> sp.Expr:
    """Change of the normal contact velocity while the contact sticks: the force (17) in (6)."""
    return contact_change(sticking_force().subs(F_z, p_z), p_z)[1]


def until_parting(rise: Callable[[sp.Expr], sp.Expr], push: Callable[[sp.Expr], sp.Expr]) -> Pair:
    """The impulse of an impact whose slip stops.

    Parameters
    ----------
    rise : change of the normal velocity under a normal impulse after the stop
    push : the tangential impulse that goes with it
    """
    p_x, p_z, v = stop()
    parting = v + rise(P_2), RESTITUTION({})
    sentence = f"The contact parts at $v_f = {latex(parting[1])}$"
    extra = only_root(parting, P_2, f"{sentence}; solved for $P_2 = P_z(t_f) - P_z(t_1)$")
    extra = by_speeds(extra)
    say("The impulse after the stop", "P_2", extra)
    return by_speeds(p_x + push(extra)), by_speeds(p_z + extra)


@derived("P_x(t_f)", "P_z(t_f)")
def impulse() -> Pair:
    """The impulse until the stop and the one after it, $P_2$ times the ratio of (17) along $x$."""
    return until_parting(sticking_velocity, lambda p_z: sticking_force().subs(F_z, p_z))


EQUATIONS = (
    Equation("17", "friction force while sticking", derive=sticking_force),
    Equation("16", "condition of sticking", derive=lambda: sp.Gt(stick_margin(), 0)),
    Equation("B1", "normal impulse until the slip stops", derive=lambda: stop()[1]),
    Equation("B2", "tangential impulse until the slip stops", derive=lambda: stop()[0]),
    Equation(
        "B3",
        "normal contact velocity at separation, first line",
        "v_f",
        derive=lambda: v_1 + sticking_velocity(P_z - P_1),
        at={m: 2, v_1: 0, P_1: 0, P_z: 1},
        repair=(Repair(r"\int", r"\frac{1}{m} \int"),),
        contradicted_by=("B3: second line",),
        contradiction=lambda line: v_1 + line - line.subs(P_z, P_1),
    ),
    Equation(
        "B3: second line",
        "normal contact velocity at separation, second line",
        "v_f",
        derive=lambda: stop()[2] + sticking_velocity(P_z - P_1),
    ),
    Equation("B4", "normal impulse of slip-stick", derive=lambda: impulse()[1]),
    Equation("B5", "tangential impulse of slip-stick", derive=lambda: impulse()[0]),
    Equation(
        "18",
        "horizontal velocity of the centre of mass after slip-stick",
        derive=lambda: cm_velocity(*impulse())[0],
    ),
    Equation(
        "19",
        "vertical velocity of the centre of mass after slip-stick",
        derive=lambda: cm_velocity(*impulse())[1],
    ),
    Equation(
        "IV: stick without mu",
        r"change of (18) and (19) with $\mu$",
        r"(\partial_\mu c'_x, \partial_\mu c'_z)",
        where=lambda: dict(zip(("c'_x", "c'_z"), cm_velocity(*impulse()), strict=True)),
        said=(0, 0),
        derive=lambda: tuple(c.diff(mu) for c in cm_velocity(*impulse())),
    ),
)
