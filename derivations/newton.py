"""The contact point of a rod that is struck there: from the axioms to Eqs. (1)-(6).

The contact point is the origin, the centre of mass stands at (X, 0, Z), and a positive omega
turns +z towards +x. Every later equation is computed from the functions below.
"""

from collections.abc import Mapping

import sympy as sp

from .axioms import EULER, IMPULSIVE, NEWTON, RIGID, P, lever_x, lever_z, tau, turn, xi, zeta
from .equality import equal
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
from .trace import derived, say, solve
from .typeset import latex

Lever = tuple[sp.Expr, sp.Expr]  # (x, z) from the centre of mass to the contact point

TO_CONTACT: Lever = (-X, -Z)
TO_TIP: Lever = (-length / 2 * sp.sin(phi), -length / 2 * sp.cos(phi))
g = sp.Symbol("g", positive=True)  # gravity
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
    """The impulse at the contact point changes the spin."""
    return spin_change(p_x, p_z, TO_CONTACT, m * k**2)


def _turned(lever: Lever, order: int) -> sp.Matrix:
    """Derivative of a body point's place with respect to the turn of the body."""
    place = RIGID({xi: lever[0], zeta: lever[1]})
    rate = place.diff(turn, order).subs(turn, 0)
    power = "" if order == 1 else f"^{order}"
    lefts = (rf"d{power}{x}/d\vartheta{power}" for x in "xz")
    say(r"Its derivative by the turn, at $\vartheta = 0$", *lefts, tuple(rate))
    return rate


@derived("u", "v")
def contact_velocity(lever: Lever) -> sp.Matrix:
    r"""The centre's velocity, plus $\omega$ times that, less the plate's $(0, V_z)$."""
    return sp.Matrix([c_x, c_z - V_z]) + omega * _turned(lever, 1)


@derived(r"\dot v_x", r"\dot v_z")
def contact_acceleration(f_x: sp.Expr, f_z: sp.Expr, lever: Lever, inertia: sp.Expr) -> sp.Matrix:
    r"""Acceleration of the contact point: centre, plus $\dot\omega$ and $\omega^2$ times these."""
    along, up = velocity_change(f_x, r"\dot c_x"), velocity_change(f_z, r"\dot c_z + g")
    centre = sp.Matrix([along, up - g - plate_rate])
    say(
        "The centre accelerates against the plate",
        r"\dot c_x",
        r"\dot c_z - \dot V_z",
        tuple(centre),
    )
    spin_rate = spin_change(f_x, f_z, lever, inertia, r"\dot\omega")
    return centre + spin_rate * _turned(lever, 1) + omega**2 * _turned(lever, 2)


def _say_change(lever: Lever, inertia: sp.Expr, change: sp.Matrix) -> None:
    """The same change, part by part, as it is told; ValueError if it is another one."""
    x, z = lever
    along, up, turned = sp.symbols(r"dc_x dc_z d\omega")
    values = {
        along: velocity_change(P_x, "dc_x"),
        up: velocity_change(P_z, "dc_z"),
        turned: spin_change(P_x, P_z, lever, inertia),
    }
    share = along + z * turned, up - x * turned
    parts = tuple(form.subs(values) for form in share)
    if not equal(sp.Matrix(parts), change):
        raise ValueError("the parts are not the whole")
    say(
        f"The impulse moves the centre and turns the body, and the point at $({latex(x)}, "
        f"{latex(z)})$ from the centre changes its velocity by both",
        *map(latex, share),
        parts,
    )


@derived("du", "dv")
def impulsive_change(p_x: sp.Expr, p_z: sp.Expr, lever: Lever, inertia: sp.Expr) -> sp.Matrix:
    r"""That acceleration times $\tau$, for a force $P/\tau$ and $\tau \to 0$."""
    force = IMPULSIVE({P: P_x}, "F_x"), IMPULSIVE({P: P_z}, "F_z")
    change = tau * contact_acceleration(*force, lever, inertia)
    change = change.expand().subs(tau, 0)
    _say_change(lever, inertia, change)
    return change.xreplace({P_x: p_x, P_z: p_z})


@derived("du", "dv")
def contact_change(p_x: sp.Expr, p_z: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Change of the contact velocity under an impulse, for a lever $(-X, -Z)$ and $I = m k^2$."""
    du, dv = impulsive_change(p_x, p_z, TO_CONTACT, m * k**2)
    return sp.expand(du), sp.expand(dv)


def _of_forces(change: sp.Matrix) -> sp.Matrix:
    """The change per time and times the mass: forces in the place of impulses."""
    return (m * change).xreplace({P_x: F_x, P_z: F_z})


@derived(r"m \dot v_x", r"m \dot v_z")
def contact_force() -> sp.Matrix:
    """Change of the contact velocity per time, times the mass: forces in the place of impulses."""
    return _of_forces(sp.Matrix(contact_change(P_x, P_z)))


@derived()
def approach() -> Mapping[sp.Symbol, sp.Expr]:
    """The contact velocity before the impact, (3) with the lever $(-X, -Z)$."""
    u, v = contact_velocity(TO_CONTACT)
    return {u_0: u, v_0: v}


_u = sp.Matrix([sp.sin(phi), 0, sp.cos(phi)])  # from the contact point up the rod
_force = sp.Matrix([F_x, 0, F_z])


@derived(r"m \dot v_x", r"m \dot v_z")
def tip_acceleration() -> sp.Matrix:
    """Change of the contact velocity per time, times the mass: forces in the place of impulses."""
    return _of_forces(impulsive_change(P_x, P_z, TO_TIP, moment)).expand()


@derived(r"\alpha")
def alpha_of_4() -> sp.Expr:
    r"""The $\alpha$ of (4), from its component along $x$."""
    printed = _force + alpha * (_force - _u * _force.dot(_u))
    (value,) = solve((printed[0], tip_acceleration()[0]), alpha)
    return sp.simplify(value)


@derived(r"\delta(m \dot v_x)", r"\delta(m \dot v_z)")
def dropped_terms() -> sp.Matrix:
    """What the limit leaves out: terms that stay finite."""
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
    centripetal = spin.cross(spin.cross(tip))[::2]
    return list(form - m * (sp.Matrix(centripetal) - sp.Matrix([0, g + plate_rate])))


EQUATIONS = (
    Equation(
        "2",
        "Euler's law about the centre of mass",
        r"I d\boldsymbol{\omega}",
        derive=lambda: moment * spin_change(P_x, P_z, TO_TIP, moment),
    ),
    Equation(
        "3",
        "velocity of the contact point",
        r"\mathbf{v}",
        derive=lambda: contact_velocity(TO_TIP),
    ),
    Equation(
        "4",
        "acceleration of the contact point, vector form",
        r"m \frac{d\mathbf{v}}{dt}",
        derive=lambda: tip_acceleration().subs(moment, m * length**2 / (4 * alpha)),
        note=lambda: rf"with $\alpha = {latex(alpha_of_4())}$",
    ),
    Equation(
        "IV: dropped in (4)",
        "what (4) leaves out: the rod's rotation, gravity and the acceleration of the plate",
        r"(\delta(m \dot v_x), \delta(m \dot v_z))",
        derive=dropped_terms,
        check=_dropped_by_vectors,
    ),
    Equation(
        "IV: alpha",
        r"the constant $\alpha$ of (4)",
        r"\alpha",
        derive=alpha_of_4,
        check=_alpha_by_energy,
        note=lambda: f"{latex(alpha_of_4().subs(moment, m * length**2 / 12))} for a thin rod",
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
        r"m \dot{v}_x",
        derive=lambda: contact_force()[0],
    ),
    Equation(
        "6",
        "acceleration of the contact point across the plate",
        r"m \dot{v}_z",
        derive=lambda: contact_force()[1],
    ),
)
