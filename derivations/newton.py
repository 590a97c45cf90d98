"""The contact point of a rod that is struck there: from the axioms to Eqs. (1)-(6).

The contact point is the origin, the centre of mass stands at (X, 0, Z), and a positive omega
turns +z towards +x. Every later equation is computed from the functions below.
"""

import sympy as sp

from .axioms import EULER, IMPULSIVE, NEWTON, RIGID, P, lever_x, lever_z, tau, turn, xi, zeta
from .equality import Forms, Pair
from .lecture import meaning, so
from .proof import Equation
from .symbols import (
    F_x,
    F_z,
    P_x,
    P_z,
    V_z,
    X,
    Z,
    alpha,
    c_x,
    c_z,
    k,
    length,
    m,
    moment,
    omega,
    phi,
    u_0,
    v_0,
)
from .trace import derived, say
from .typeset import latex

Lever = Pair  # (x, z) from the centre of mass to the contact point

TO_CONTACT: Lever = (-X, -Z)
TO_TIP: Lever = (-length / 2 * sp.sin(phi), -length / 2 * sp.cos(phi))
g = sp.Symbol("g", positive=True)  # gravity
_FORCES = {P_x: F_x, P_z: F_z}
plate_rate = sp.Symbol("Vdot_z", real=True)  # acceleration of the plate


def velocity_change(p: sp.Expr, left: str = "dc") -> sp.Expr:
    """Change of a component of the centre's velocity under that component of the impulse."""
    return NEWTON({P: p}, left)


def spin_change(
    p_x: sp.Expr, p_z: sp.Expr, lever: Lever, inertia: sp.Expr, left: str = r"d\omega"
) -> sp.Expr:
    """Change of omega under an impulse at the end of a lever."""
    x, z = lever
    return EULER({P_x: p_x, P_z: p_z, lever_x: x, lever_z: z, moment: inertia}, left)


@derived(r"\omega' - \omega")
def spin_jump(p_x: sp.Expr, p_z: sp.Expr) -> sp.Expr:
    """The impulse at the contact point changes the spin; lever $(-X, -Z)$ and $I = m k^2$."""
    return spin_change(p_x, p_z, TO_CONTACT, m * k**2)


def _turned(lever: Lever, order: int) -> sp.Matrix:
    """Derivative, of a given order, of a body point's place by the body's turn, at zero turn."""
    place = RIGID({xi: lever[0], zeta: lever[1]})
    rate = place.diff(turn, order).subs(turn, 0)
    power = "" if order == 1 else f"^{order}"
    lefts = (rf"d{power}{x}/d\vartheta{power}" for x in "xz")
    say(r"Derivative of this place by the turn, at $\vartheta = 0$", *lefts, tuple(rate))
    return rate


@derived("u", "v")
def contact_velocity(lever: Lever) -> sp.Matrix:
    r"""The centre's velocity, plus $\omega$ times that, less the plate's."""
    return sp.Matrix([c_x, c_z - V_z]) + omega * _turned(lever, 1)


@derived(r"\dot v_x", r"\dot v_z")
def contact_acceleration(f_x: sp.Expr, f_z: sp.Expr, lever: Lever, inertia: sp.Expr) -> sp.Matrix:
    r"""Acceleration there: that of the centre plus $\dot\omega$, $\omega^2$ times these."""
    along, up = velocity_change(f_x, r"\dot c_x"), velocity_change(f_z - m * g, r"\dot c_z")
    say("Against the plate", r"\dot c_z - \dot V_z", up - plate_rate)
    spin_rate = spin_change(f_x, f_z, lever, inertia, r"\dot\omega")
    return (
        sp.Matrix([along, up - plate_rate])
        + spin_rate * _turned(lever, 1)
        + omega**2 * _turned(lever, 2)
    )


@derived()
def impulsive_change(lever: Lever, inertia: sp.Expr) -> dict[sp.Expr, sp.Expr]:
    r"""That acceleration times $\tau$, for $P/\tau$, $\tau \to 0$; on the left centre and turn."""
    force = IMPULSIVE({P: P_x}, "F_x"), IMPULSIVE({P: P_z}, "F_z")
    change = tau * contact_acceleration(*force, lever, inertia)
    change_x, change_z = change.expand().subs(tau, 0)
    velocity_change(P_x, "dc_x")
    velocity_change(P_z, "dc_z")
    spin_change(P_x, P_z, lever, inertia)
    along, up, turned = sp.symbols(r"dc_x dc_z d\omega")
    x, z = lever
    return {along + z * turned: change_x, up - x * turned: change_z}


@derived("du", "dv")
def contact_change(p_x: sp.Expr, p_z: sp.Expr) -> Pair:
    """Change of the contact velocity under an impulse, for a lever $(-X, -Z)$ and $I = m k^2$."""
    parts = impulsive_change(TO_CONTACT, m * k**2).values()
    return tuple(part.xreplace({P_x: p_x, P_z: p_z}).expand() for part in parts)


def contact_force(place: int) -> sp.Expr:
    """Mass times the acceleration of the contact point, along or across the plate."""
    force = (m * contact_change(P_x, P_z)[place]).xreplace(_FORCES)
    left = rf"m \dot v_{'xz'[place]}"
    say("Per time and times the mass, forces in the place of impulses", left, force)
    return force


@derived()
def approach() -> Forms:
    """The contact velocity before the impact, (3) with the lever $(-X, -Z)$."""
    u, v = contact_velocity(TO_CONTACT)
    return {u_0: u, v_0: v}


@derived(r"m \dot v_x", r"m \dot v_z")
def tip_acceleration() -> sp.Matrix:
    r"""Per time and times the mass, forces in the place of impulses, $I$ by $\alpha$."""
    change = m * sp.Matrix(list(impulsive_change(TO_TIP, moment).values()))
    return change.xreplace(_FORCES).subs(moment, moment * _ALPHA / alpha).expand()


@derived(r"\delta(m \dot v_x)", r"\delta(m \dot v_z)")
def dropped_terms() -> sp.Matrix:
    """What the limit leaves out: terms that stay finite."""
    kept = tip_acceleration().subs(alpha, _ALPHA)
    return (m * contact_acceleration(F_x, F_z, TO_TIP, moment) - kept).expand()


_ALPHA = meaning(alpha)

EQUATIONS = (
    Equation(
        "2",
        "Euler's law about the centre of mass",
        r"I d\boldsymbol{\omega}",
        derive=lambda: moment * spin_change(P_x, P_z, TO_TIP, moment),
    ),
    Equation("3", "velocity of the contact point", derive=lambda: contact_velocity(TO_TIP)),
    Equation(
        "4",
        "acceleration of the contact point, vector form",
        derive=tip_acceleration,
        note=rf"with $\alpha = {latex(_ALPHA)}$",
    ),
    Equation(
        "IV: dropped in (4)",
        "what (4) leaves out: centripetal acceleration, gravity and the acceleration of the plate",
        r"(\delta(m \dot v_x), \delta(m \dot v_z))",
        derive=dropped_terms,
        note=lambda: so(
            "with the plate at rest and no spin, the part across the plate is negative",
            dropped_terms()[1].subs({omega: 0, plate_rate: 0}),
        ),
        # towards the centre, half a length away, and down
        check=lambda form: (
            form
            - m * omega**2 * length / 2 * sp.Matrix([sp.sin(phi), sp.cos(phi)])
            + m * sp.Matrix([0, g + plate_rate])
        ),
    ),
    Equation(
        "IV: spin",
        "change of spin under an impulse at the contact point",
        r"\omega' - \omega",
        derive=lambda: spin_jump(P_x, P_z),
        # the impulse passes through the contact point and keeps the spin about it
        check=lambda form: (k**2 * form + Z * velocity_change(P_x) - X * velocity_change(P_z),),
    ),
    Equation(
        "5",
        "acceleration of the contact point along the plate",
        derive=lambda: contact_force(0),
    ),
    Equation(
        "6",
        "acceleration of the contact point across the plate",
        derive=lambda: contact_force(1),
    ),
)
