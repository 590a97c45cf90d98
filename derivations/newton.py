"""The contact point of a rod that is struck there: from the axioms to Eqs. (1)-(6).

The contact point is the origin, the centre of mass stands at (X, 0, Z), and a positive omega
turns +z towards +x. Every later equation is computed from the functions below.
"""

from collections.abc import Mapping

import sympy as sp

from .axioms import EULER, IMPULSIVE, NEWTON, RIGID, P, lever_x, lever_z, tau, turn, xi, zeta
from .proof import Equation
from .symbols import (
    F_x,
    F_z,
    P_x,
    P_z,
    V_z,
    X,
    Z,
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
from .trace import derived, solve

Lever = tuple[sp.Expr, sp.Expr]  # (x, z) from the centre of mass to the contact point

TO_CONTACT: Lever = (-X, -Z)
TO_TIP: Lever = (-length / 2 * sp.sin(phi), -length / 2 * sp.cos(phi))
g = sp.Symbol("g", positive=True)  # gravity
plate_rate = sp.Symbol("Vdot_z", real=True)  # acceleration of the plate


def velocity_change(p: sp.Expr) -> sp.Expr:
    """Change of a component of the centre's velocity under that component of the impulse."""
    return NEWTON({P: p})


def spin_change(p_x: sp.Expr, p_z: sp.Expr, lever: Lever, inertia: sp.Expr) -> sp.Expr:
    """Change of omega under an impulse at the end of a lever."""
    x, z = lever
    return EULER({P_x: p_x, P_z: p_z, lever_x: x, lever_z: z, moment: inertia})


@derived
def spin_jump(p_x: sp.Expr, p_z: sp.Expr) -> sp.Expr:
    """Change of omega under the impulse (p_x, p_z) at the contact point."""
    return spin_change(p_x, p_z, TO_CONTACT, m * k**2)


def _turned(lever: Lever, order: int) -> sp.Matrix:
    """Derivative of a body point's place with respect to the turn of the body."""
    place = RIGID({xi: lever[0], zeta: lever[1]})
    return place.diff(turn, order).subs(turn, 0)


@derived
def contact_velocity(lever: Lever) -> sp.Matrix:
    """Velocity of the contact point relative to the plate, (u, v)."""
    return sp.Matrix([c_x, c_z - V_z]) + omega * _turned(lever, 1)


@derived
def contact_acceleration(f_x: sp.Expr, f_z: sp.Expr, lever: Lever, inertia: sp.Expr) -> sp.Matrix:
    """Acceleration of the contact point relative to the plate under the force (f_x, f_z) there."""
    centre = sp.Matrix([velocity_change(f_x), velocity_change(f_z) - g - plate_rate])
    spin_rate = spin_change(f_x, f_z, lever, inertia)
    return centre + spin_rate * _turned(lever, 1) + omega**2 * _turned(lever, 2)


@derived
def impulsive_change(p_x: sp.Expr, p_z: sp.Expr, lever: Lever, inertia: sp.Expr) -> sp.Matrix:
    """Change of the contact point's velocity in the limit of a short and violent impact."""
    force = [IMPULSIVE({P: p}) for p in (P_x, P_z)]
    change = tau * contact_acceleration(*force, lever, inertia)
    return change.expand().subs(tau, 0).xreplace({P_x: p_x, P_z: p_z})


@derived
def contact_change(p_x: sp.Expr, p_z: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Change (du, dv) of the contact point's velocity under the impulse (p_x, p_z)."""
    du, dv = impulsive_change(p_x, p_z, TO_CONTACT, m * k**2)
    return sp.expand(du), sp.expand(dv)


@derived
def approach() -> Mapping[sp.Symbol, sp.Expr]:
    """u_0 and v_0, the contact point's velocity before the impact, by Eq. (3)."""
    u, v = contact_velocity(TO_CONTACT)
    return {u_0: u, v_0: v}


alpha = sp.Symbol("alpha", positive=True)  # of Eq. (4)
_u = sp.Matrix([sp.sin(phi), 0, sp.cos(phi)])  # from the contact point up the rod
_force = sp.Matrix([F_x, 0, F_z])
_impulse = sp.Matrix([P_x, 0, P_z])


def _in_plane(vector: sp.Matrix) -> sp.Matrix:
    """(x, z) of a vector of that plane."""
    return sp.Matrix([vector[0], vector[2]])


@derived
def tip_acceleration() -> sp.Matrix:
    """Mass times acceleration of the rod's tip under a force there, in the impulsive limit."""
    return (m * impulsive_change(F_x, F_z, TO_TIP, moment)).expand()


@derived
def alpha_of_4() -> sp.Expr:
    """alpha of Eq. (4), solved from its component along x."""
    printed = _force + alpha * (_force - _u * _force.dot(_u))
    (value,) = solve(printed[0] - tip_acceleration()[0], alpha)
    return sp.simplify(value)


@derived
def dropped_terms() -> sp.Matrix:
    """What the impulsive limit leaves out: terms that stay finite."""
    whole = m * contact_acceleration(F_x, F_z, TO_TIP, moment)
    return (whole - tip_acceleration()).expand()


def _alpha_by_energy(form: sp.Expr) -> list[sp.Expr]:
    """Kinetic energy of a unit impulse across the rod at its tip, by its two velocities."""
    speed, spin = 1 / m, length / 2 / moment
    energy = (m * speed**2 + moment * spin**2) / 2
    return [energy - (1 + form) / (2 * m), form.subs(moment, m * length**2 / 12) - 3]


def _dropped_by_vectors(form: sp.Matrix) -> list[sp.Expr]:
    """omega x (omega x r), gravity and the plate, by vector products."""
    spin, tip = sp.Matrix([0, omega, 0]), -length / 2 * _u
    centripetal = _in_plane(spin.cross(spin.cross(tip)))
    return list(form - m * (centripetal - sp.Matrix([0, g + plate_rate])))


EQUATIONS = (
    Equation.read(
        "2",
        printed=(-length / 2 * _u.cross(_impulse))[1],
        derive=lambda: moment * spin_change(P_x, P_z, TO_TIP, moment),
    ),
    Equation.read(
        "3",
        printed=_in_plane(
            sp.Matrix([c_x, 0, c_z])
            - length / 2 * sp.Matrix([0, omega, 0]).cross(_u)
            - sp.Matrix([0, 0, V_z])
        ),
        derive=lambda: contact_velocity(TO_TIP),
    ),
    Equation.read(
        "4",
        printed=_in_plane(_force + alpha * (_force - _u * _force.dot(_u))),
        derive=lambda: tip_acceleration().subs(moment, m * length**2 / (4 * alpha)),
    ),
    Equation.read(
        "IV: dropped in (4)",
        derive=dropped_terms,
        shown=(
            m * omega**2 * length / 2 * sp.sin(phi),
            m * omega**2 * length / 2 * sp.cos(phi) - m * (g + plate_rate),
        ),
        check=_dropped_by_vectors,
    ),
    Equation.read("IV: alpha", derive=alpha_of_4, check=_alpha_by_energy),
    Equation.read(
        "IV: spin",
        derive=lambda: spin_jump(P_x, P_z),
        # the impulse passes through the contact point and keeps the spin about it
        check=lambda form: (k**2 * form + Z * velocity_change(P_x) - X * velocity_change(P_z),),
    ),
    Equation.read(
        "5",
        printed=-X * Z / k**2 * F_z + (k**2 + Z**2) / k**2 * F_x,
        derive=lambda: m * contact_change(F_x, F_z)[0],
    ),
    Equation.read(
        "6",
        printed=(k**2 + X**2) / k**2 * F_z - X * Z / k**2 * F_x,
        derive=lambda: m * contact_change(F_x, F_z)[1],
    ),
)
