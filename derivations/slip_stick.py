"""Slip-stick: the slip stops and friction holds the contact, Eqs. (16)-(19), (B1)-(B5)."""

import sympy as sp

from .axioms import RESTITUTION, STICK, q
from .newton import contact_change
from .proof import Equation, Repair
from .slide import cm_velocity, stop
from .symbols import (
    P_1,
    F_x,
    F_z,
    P_z,
    V_z,
    X,
    Z,
    c_x,
    c_z,
    epsilon,
    k,
    m,
    mu,
    omega,
    u_0,
    v_0,
    v_1,
)
from .trace import derived, solve

AFTER_STOP = "$P_2$, the normal impulse after the slip has stopped"


@derived
def sticking_force() -> sp.Expr:
    """F_x that keeps the contact point at rest, Eq. (17)."""
    (force,) = solve(contact_change(F_x, F_z)[0], F_x)
    return force


@derived
def stick_margin() -> sp.Expr:
    """mu - F_x/F_z while sticking, for XZ > 0: friction holds where this is positive, (16)."""
    return sp.together(STICK({q: sticking_force() / F_z}))


@derived
def sticking_velocity(p_z: sp.Expr) -> sp.Expr:
    """Change of the normal contact velocity under the impulse p_z while sticking."""
    return contact_change(sticking_force().subs(F_z, p_z), p_z)[1]


@derived
def impulse() -> tuple[sp.Expr, sp.Expr]:
    """Total impulse (P_x, P_z) under kinematic restitution, Eqs. (B5), (B4)."""
    p_x, p_z, v = stop()
    extra = sp.Symbol("P_2")
    (extra_z,) = solve(v + sticking_velocity(extra) - RESTITUTION({}), extra, AFTER_STOP)
    return p_x + sticking_force().subs(F_z, extra_z), p_z + extra_z


_stop = mu * (k**2 + Z**2) + X * Z
_all = k**2 + X**2 + Z**2
_bracket = v_0 * (1 + epsilon) + (k**2 + X**2 + mu * X * Z) / _stop * u_0
_u, _v = c_x - omega * Z, c_z - V_z + omega * X
_slip = _all / (k**2 + Z**2)
_printed_b3 = v_0 + (k**2 + X**2 + mu * X * Z) / _stop * u_0 + _slip / m * (P_z - P_1)

EQUATIONS = (
    Equation.read(
        "16", printed=sp.Gt(mu * (k**2 + Z**2), X * Z), derive=lambda: sp.Gt(stick_margin(), 0)
    ),
    Equation.read("17", printed=X * Z / (k**2 + Z**2) * F_z, derive=sticking_force),
    Equation.read("B1", printed=u_0 * m * k**2 / _stop, derive=lambda: stop()[1]),
    Equation.read("B2", printed=-u_0 * m * mu * k**2 / _stop, derive=lambda: stop()[0]),
    Equation.read(
        "B3",
        printed=v_1 + _slip * (P_z - P_1),
        derive=lambda: v_1 + sticking_velocity(P_z - P_1),
        at={m: sp.Integer(2), v_1: sp.Integer(0), P_1: sp.Integer(0), P_z: sp.Integer(1)},
        repair=(Repair("a factor $1/m$", P_z - P_1, (P_z - P_1) / m),),
        contradiction=lambda: v_1 + _printed_b3 - _printed_b3.subs(P_z, P_1),
    ),
    Equation.read(
        "B3: second line",
        printed=_printed_b3,
        derive=lambda: stop()[2] + sticking_velocity(P_z - P_1),
    ),
    Equation.read(
        "B4",
        printed=u_0 * m * k**2 / _stop - _bracket * m * (k**2 + Z**2) / _all,
        derive=lambda: impulse()[1],
    ),
    Equation.read(
        "B5",
        printed=-u_0 * m * mu * k**2 / _stop - _bracket * m * X * Z / _all,
        derive=lambda: impulse()[0],
    ),
    Equation.read(
        "18",
        printed=(_u * Z**2 - _v * (1 + epsilon) * X * Z) / _all + omega * Z,
        derive=lambda: cm_velocity(*impulse())[0],
    ),
    Equation.read(
        "19",
        printed=(_v * (X**2 - (k**2 + Z**2) * epsilon) - _u * X * Z) / _all + V_z - omega * X,
        derive=lambda: cm_velocity(*impulse())[1],
    ),
    Equation.read(
        "IV: stick without mu",
        printed=(0, 0),
        derive=lambda: tuple(sp.cancel(c).diff(mu) for c in cm_velocity(*impulse())),
    ),
)
