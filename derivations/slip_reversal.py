"""Slip reversal: the slip stops and starts again backwards, Eqs. (20)-(22), (B6)-(B12)."""

import sympy as sp

from . import paper
from .equality import Pair
from .newton import approach, contact_change
from .proof import Equation, Repair
from .slide import by_speeds, cm_velocity, friction, stop
from .slip_stick import stick_margin, until_parting
from .symbols import P_1, P_z, v_1
from .trace import derived, only_root


@derived("u_f", "v_f - v_1")
def reversed_change(p_z: sp.Expr) -> Pair:
    """Change of the contact velocity in backward slip from $u = 0$: (5), (6), its friction."""
    return contact_change(friction(p_z, -1), p_z)


@derived("P_x(t_f)", "P_z(t_f)")
def impulse() -> Pair:
    r"""The impulse until the stop and the one after it, $P_2$, with $\mu P_2$ along $x$."""
    return until_parting(lambda p_z: reversed_change(p_z)[1], lambda p_z: friction(p_z, -1))


@derived("u_f")
def final_slip() -> sp.Expr:
    """Slip velocity at separation: the impulse of the reversal, (B8) less (B1), put into (B6)."""
    return by_speeds(reversed_change(impulse()[1] - stop()[1])[0])


_UNTIL_STOP = "B1"  # impulse until the slip stops

EQUATIONS = (
    Equation("20", "condition of slip reversal", derive=lambda: sp.Lt(stick_margin(), 0)),
    Equation(
        "B6",
        "slip velocity at separation after reversal",
        derive=lambda: reversed_change(P_z - P_1)[0],
    ),
    Equation(
        "B7",
        "normal contact velocity at separation after reversal",
        "v_f",
        derive=lambda: v_1 + reversed_change(P_z - P_1)[1],
    ),
    Equation("B8", "normal impulse of slip reversal", derive=lambda: impulse()[1]),
    Equation("B9", "tangential impulse of slip reversal", derive=lambda: impulse()[0]),
    Equation("B10", "slip velocity at separation after reversal", derive=final_slip),
    Equation(
        "B11",
        "horizontal velocity of the centre of mass after slip reversal",
        put=approach,
        derive=lambda: cm_velocity(*impulse())[0],
    ),
    Equation(
        "B12",
        "vertical velocity of the centre of mass after slip reversal",
        put=approach,
        derive=lambda: cm_velocity(*impulse())[1],
    ),
    Equation(
        "21",
        "horizontal velocity of the centre of mass after slip reversal",
        derive=lambda: cm_velocity(*impulse())[0],
        repair=(Repair(r"+ (c_x - \omega Z)", r"- (c_x - \omega Z)"),),
        contradicted_by=("B11",),
        contradiction=lambda whole: whole.subs(approach()),
    ),
    Equation(
        "22",
        "vertical velocity of the centre of mass after slip reversal",
        derive=lambda: cm_velocity(*impulse())[1],
    ),
    Equation(
        "B8: text",
        r"the impulse $P_z(t_f) - P_z(t_1)$",
        "P_z(t_f) - P_z(t_1)",
        formulas=("B8",),
        where=lambda: {"P_z(t_f)": impulse()[1], "P_z(t_1)": stop()[1]},
        derive=lambda: impulse()[1] - stop()[1],
        repair=(
            Repair(rf"{paper.EQUATIONS[_UNTIL_STOP].right} - ", "- ", f"without ({_UNTIL_STOP})"),
        ),
        contradicted_by=("B7", "15", "IV: restitution"),
        contradiction=lambda end, stopped, parting: (
            only_root(end.subs(v_1, stopped) - parting, P_z) - P_1
        ),
    ),
)
