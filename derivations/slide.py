"""Slide: the contact point slips forward until it separates, Eqs. (7)-(15)."""

import sympy as sp

from .axioms import RESTITUTION, SLIP, sigma
from .equality import Pair, Triple
from .newton import approach, contact_change, velocity_change
from .paper import LETTERS
from .proof import Equation, Repair
from .symbols import F_z, P_x, P_z, c_x, c_z, u_0, v_0
from .trace import derived, only_root, say
from .typeset import latex


def friction(p_z: sp.Expr, direction: int) -> sp.Expr:
    """Tangential impulse of friction under the normal impulse p_z, in a slip of one direction."""
    return SLIP({F_z: p_z, sigma: direction}, "P_x")


@derived("u")
def slip_velocity(p_z: sp.Expr = P_z) -> sp.Expr:
    """Slip velocity in forward slip: $u_0$ plus its change, by (5)."""
    return u_0 + contact_change(friction(p_z, 1), p_z)[0]


@derived("v")
def normal_velocity(p_z: sp.Expr = P_z) -> sp.Expr:
    """Normal contact velocity in forward slip: $v_0$ plus its change, by (6)."""
    return v_0 + contact_change(friction(p_z, 1), p_z)[1]


@derived("P_x(t_f)", "P_z(t_f)")
def impulse() -> Pair:
    """The total impulse of a slide."""
    parting = normal_velocity(), RESTITUTION({})
    sentence = f"The contact parts at $v = {latex(parting[1])}$; solved for $P_z$"
    p_z = only_root(parting, P_z, sentence)
    return friction(p_z, 1), p_z


def by_speeds(form: sp.Expr) -> sp.Expr:
    """A form that is linear in u_0 and v_0, written with one factored coefficient of each."""
    alone = form.subs({u_0: 0, v_0: 0})
    return alone + sum(sp.factor(form.diff(speed)) * speed for speed in (u_0, v_0))


@derived("P_x(t_1)", "P_z(t_1)", "v_1")
def stop() -> Triple:
    """The impulse at which the slip stops, put into the normal velocity."""
    p_z = only_root(slip_velocity(), P_z, "The slip stops at $u = 0$; solved for $P_z$")
    return friction(p_z, 1), p_z, by_speeds(normal_velocity(p_z))


@derived("c'_x", "c'_z")
def cm_velocity(p_x: sp.Expr, p_z: sp.Expr) -> Pair:
    """Velocity of the centre of mass after this impulse."""
    dc_x, dc_z = velocity_change(p_x, "dc_x"), velocity_change(p_z, "dc_z")
    after = tuple(map(by_speeds, (c_x + dc_x, c_z + dc_z)))
    if not any(c.has(u_0, v_0) for c in after):
        return after
    say("The impulse put into (10) and (11)", "c'_x", "c'_z", after)
    sentence = "Before the impact, by (3) with the lever $(-X, -Z)$"
    say(sentence, *map(latex, approach()), tuple(approach().values()))
    return tuple(c.subs(approach()) for c in after)


@derived("u_*")
def slide_excess() -> sp.Expr:
    """What is left of the slip when the contact parts: the impulse (8) put into (7)."""
    return by_speeds(slip_velocity(impulse()[1]))


_REPAIR = Repair(r"{\mu(k^2 + Z^2) + XZ}", r"{k^2 + X^2 + \mu XZ}")


def _impulse_put_in(impulse_of: sp.Expr, velocity: sp.Expr) -> sp.Expr:
    """Velocity of the centre by its printed equation, with a printed impulse put in."""
    return velocity.subs({P_x: impulse_of, P_z: impulse_of}).subs(approach())


EQUATIONS = (
    Equation("7", "slip velocity left at separation", derive=slip_velocity),
    Equation("8", "normal impulse of a slide", derive=lambda: impulse()[1]),
    Equation("9", "tangential impulse of a slide", derive=lambda: impulse()[0]),
    Equation(
        "10",
        "horizontal velocity of the centre of mass from the impulse",
        derive=lambda: cm_velocity(P_x, P_z)[0],
    ),
    Equation(
        "11",
        "vertical velocity of the centre of mass from the impulse",
        derive=lambda: cm_velocity(P_x, P_z)[1],
    ),
    Equation(
        "12",
        "horizontal velocity of the centre of mass after a slide",
        derive=lambda: cm_velocity(*impulse())[0],
        contradicted_by=("9", "10"),
        contradiction=_impulse_put_in,
        repair=(_REPAIR,),
    ),
    Equation(
        "13",
        "vertical velocity of the centre of mass after a slide",
        derive=lambda: cm_velocity(*impulse())[1],
        contradicted_by=("8", "11"),
        contradiction=_impulse_put_in,
        at={LETTERS[r"\omega_x"]: sp.Rational(1, 10)},
        repair=(_REPAIR, Repair(r"\omega_x", r"\omega X")),
    ),
    Equation("14", "condition of continuous slide", derive=slide_excess),
    Equation("15", "normal contact velocity when the slip stops", derive=lambda: stop()[2]),
)
