"""Slide: the contact point slips forward until it separates, Eqs. (7)-(15)."""

import sympy as sp

from .axioms import RESTITUTION, SLIP, sigma
from .newton import approach, contact_change, velocity_change
from .proof import Equation, Repair
from .symbols import F_z, P_x, P_z, V_z, X, Z, c_x, c_z, epsilon, k, m, mu, omega, u_0, v_0
from .trace import derived, solve


def friction(p_z: sp.Expr, direction: int) -> sp.Expr:
    """Tangential impulse of friction under the normal impulse p_z, in a slip of one direction."""
    return SLIP({F_z: p_z, sigma: sp.Integer(direction)})


@derived
def slip_velocity(p_z: sp.Expr = P_z) -> sp.Expr:
    """Tangential contact velocity after the normal impulse p_z in forward slip, Eq. (7)."""
    return u_0 + contact_change(friction(p_z, 1), p_z)[0]


@derived
def normal_velocity(p_z: sp.Expr = P_z) -> sp.Expr:
    """Normal contact velocity after the normal impulse p_z in forward slip."""
    return v_0 + contact_change(friction(p_z, 1), p_z)[1]


@derived
def impulse() -> tuple[sp.Expr, sp.Expr]:
    """Total impulse (P_x, P_z) of a slide under kinematic restitution, Eqs. (9), (8)."""
    (p_z,) = solve(normal_velocity() - RESTITUTION({}), P_z)
    return friction(p_z, 1), p_z


@derived
def stop() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Impulse (P_x, P_z) at which the slip stops, and v_1 there; (B2), (B1), (15)."""
    (p_z,) = solve(slip_velocity(), P_z)
    return friction(p_z, 1), p_z, sp.factor(normal_velocity(p_z))


@derived
def cm_velocity(p_x: sp.Expr, p_z: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Velocity (c_x', c_z') of the centre of mass after the impulse, Eqs. (10), (11)."""
    dc_x, dc_z = velocity_change(p_x), velocity_change(p_z)
    after = c_x + dc_x, c_z + dc_z
    return tuple(c.subs(approach()) if c.has(u_0, v_0) else c for c in after)


@derived
def slide_excess() -> sp.Expr:
    """What is left of the slip velocity when the contact separates, u_*, (14)."""
    return sp.factor(slip_velocity(impulse()[1]))


_slope = k**2 + X**2 + mu * X * Z
_stop = mu * (k**2 + Z**2) + X * Z
_printed_8 = -v_0 * (1 + epsilon) * m * k**2 / _slope
_printed_9 = v_0 * (1 + epsilon) * m * mu * k**2 / _slope
# (13) prints omega_x where omega X is meant; a symbol of its own keeps the misprint visible
omega_x = sp.Symbol("omega_x", real=True)
_denominator = Repair("the denominator of (15) to that of (8)", _stop, _slope)

EQUATIONS = (
    Equation.read(
        "7", printed=u_0 - (X * Z + mu * (k**2 + Z**2)) / (m * k**2) * P_z, derive=slip_velocity
    ),
    Equation.read("8", printed=_printed_8, derive=lambda: impulse()[1]),
    Equation.read("9", printed=_printed_9, derive=lambda: impulse()[0]),
    Equation.read("10", printed=c_x + P_x / m, derive=lambda: cm_velocity(P_x, P_z)[0]),
    Equation.read("11", printed=c_z + P_z / m, derive=lambda: cm_velocity(P_x, P_z)[1]),
    Equation.read(
        "12",
        printed=c_x + mu * (1 + epsilon) * k**2 * (c_z - V_z + omega * X) / _stop,
        derive=lambda: cm_velocity(*impulse())[0],
        contradiction=lambda: (c_x + _printed_9 / m).subs(approach()),
        repair=(_denominator,),
    ),
    Equation.read(
        "13",
        printed=c_z - (c_z + omega_x - V_z) * (1 + epsilon) * k**2 / _stop,
        derive=lambda: cm_velocity(*impulse())[1],
        contradiction=lambda: (c_z + _printed_8 / m).subs(approach()),
        at={omega_x: sp.Rational(1, 10)},
        repair=(_denominator, Repair(r"$\omega_x$ to $\omega X$", omega_x, omega * X)),
    ),
    Equation.read(
        "14",
        printed=u_0 + (X * Z + mu * (k**2 + Z**2)) / _slope * v_0 * (1 + epsilon),
        derive=slide_excess,
    ),
    Equation.read("15", printed=v_0 + _slope / _stop * u_0, derive=lambda: stop()[2]),
)
