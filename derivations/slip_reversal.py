"""Slip reversal: the slip stops and starts again backwards, Eqs. (20)-(22), (B6)-(B12)."""

import sympy as sp

from .axioms import RESTITUTION
from .newton import approach, contact_change
from .proof import Equation, Repair
from .slide import cm_velocity, friction, stop
from .slip_stick import AFTER_STOP, stick_margin
from .symbols import P_1, P_z, V_z, X, Z, c_x, c_z, epsilon, k, m, mu, omega, u_0, v_0, v_1
from .trace import derived, solve


@derived
def reversed_change(p_z: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Change (du, dv) of the contact velocity under p_z in backward slip."""
    return contact_change(friction(p_z, -1), p_z)


@derived
def impulse() -> tuple[sp.Expr, sp.Expr]:
    """Total impulse (P_x, P_z) under kinematic restitution, Eqs. (B9), (B8)."""
    p_x, p_z, v = stop()
    extra = sp.Symbol("P_2")
    (extra_z,) = solve(v + reversed_change(extra)[1] - RESTITUTION({}), extra, AFTER_STOP)
    return p_x + friction(extra_z, -1), p_z + extra_z


@derived
def final_slip() -> sp.Expr:
    """u_f, the backward slip velocity at separation, Eq. (B10)."""
    return sp.factor(reversed_change(impulse()[1] - stop()[1])[0])


_stop = mu * (k**2 + Z**2) + X * Z
_back = k**2 + X**2 - mu * X * Z
_bracket = (1 + epsilon) * v_0 + (k**2 + X**2 + mu * X * Z) / _stop * u_0
_u, _v = c_x - omega * Z, c_z - V_z + omega * X
_printed_b11 = u_0 * (1 - mu * k**2 / _stop) + omega * Z - mu * k**2 / _back * _bracket
_slip_21 = _u * 2 * mu * k**2 * (k**2 + X**2) / (_stop * _back)
_bounce_21 = _v * mu * k**2 * (1 + epsilon) / _back
_printed_b12 = v_0 + u_0 * k**2 / _stop - k**2 / _back * _bracket + V_z - omega * X

EQUATIONS = (
    Equation.read(
        "20", printed=sp.Lt(mu * (k**2 + Z**2), X * Z), derive=lambda: sp.Lt(stick_margin(), 0)
    ),
    Equation.read(
        "B6",
        printed=(mu * (k**2 + Z**2) - X * Z) / (m * k**2) * (P_z - P_1),
        derive=lambda: reversed_change(P_z - P_1)[0],
    ),
    Equation.read(
        "B7",
        printed=v_1 + _back / (m * k**2) * (P_z - P_1),
        derive=lambda: v_1 + reversed_change(P_z - P_1)[1],
    ),
    Equation.read(
        "B8",
        printed=u_0 * m * k**2 / _stop - m * k**2 / _back * _bracket,
        derive=lambda: impulse()[1],
    ),
    Equation.read(
        "B9",
        printed=-u_0 * mu * m * k**2 / _stop - mu * m * k**2 / _back * _bracket,
        derive=lambda: impulse()[0],
    ),
    Equation.read(
        "B10", printed=-(mu * (k**2 + Z**2) - X * Z) / _back * _bracket, derive=final_slip
    ),
    Equation.read(
        "B11", printed=_printed_b11.subs(approach()), derive=lambda: cm_velocity(*impulse())[0]
    ),
    Equation.read(
        "B12", printed=_printed_b12.subs(approach()), derive=lambda: cm_velocity(*impulse())[1]
    ),
    Equation.read(
        "21",
        printed=c_x + _slip_21 - _bounce_21,
        shown=c_x - _slip_21 - _bounce_21,
        derive=lambda: cm_velocity(*impulse())[0],
        contradiction=lambda: _printed_b11.subs(approach()),
        repair=(Repair("the sign of the second term", _slip_21, -_slip_21),),
    ),
    Equation.read(
        "22",
        printed=c_z
        - _u * 2 * mu * k**2 * X * Z / (_stop * _back)
        - _v * k**2 * (1 + epsilon) / _back,
        derive=lambda: cm_velocity(*impulse())[1],
    ),
)
