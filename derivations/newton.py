"""Newton's and Euler's laws for a rod that is struck at its contact point, Eqs. (1)-(6).

The contact point is the origin, the centre of mass stands at (X, 0, Z), and a positive omega
turns +z towards +x. Every later equation is computed from the functions below.
"""

from functools import cache

import sympy as sp

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
    t,
    u_0,
    v_0,
)

AXIS = sp.Matrix([sp.sin(phi), 0, sp.cos(phi)])  # u: from the contact point up the rod
TO_CONTACT = sp.Matrix([-X, 0, -Z])  # from the centre of mass to the contact point


def velocity_change(impulse: sp.Matrix) -> sp.Matrix:
    """Newton: the impulse changes the velocity of the centre of mass by P/m, Eq. (1)."""
    return impulse / m


def spin_change(impulse: sp.Matrix, lever: sp.Matrix, inertia: sp.Expr) -> sp.Matrix:
    """Euler: the impulse's moment about the centre of mass changes omega, Eq. (2)."""
    return lever.cross(impulse) / inertia


def contact_velocity(
    c: sp.Matrix, spin: sp.Matrix, lever: sp.Matrix, plate: sp.Matrix
) -> sp.Matrix:
    """Velocity of the body's contact point relative to the plate, Eq. (3)."""
    return c + spin.cross(lever) - plate


@cache
def contact_change(p_x: sp.Expr, p_z: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """Change (du, dv) of the contact point's velocity under the impulse (p_x, p_z); I = m k^2."""
    impulse = sp.Matrix([p_x, 0, p_z])
    spin = spin_change(impulse, TO_CONTACT, m * k**2)
    change = contact_velocity(velocity_change(impulse), spin, TO_CONTACT, sp.zeros(3, 1))
    return sp.expand(change[0]), sp.expand(change[2])


@cache
def spin_jump(p_x: sp.Expr, p_z: sp.Expr) -> sp.Expr:
    """Change of omega under the impulse (p_x, p_z)."""
    return spin_change(sp.Matrix([p_x, 0, p_z]), TO_CONTACT, m * k**2)[1]


@cache
def approach() -> dict[sp.Symbol, sp.Expr]:
    """u_0 and v_0, the contact point's velocity before the impact, by Eq. (3)."""
    v = contact_velocity(
        sp.Matrix([c_x, 0, c_z]), sp.Matrix([0, omega, 0]), TO_CONTACT, sp.Matrix([0, 0, V_z])
    )
    return {u_0: v[0], v_0: v[2]}


@cache
def tip_velocity() -> sp.Matrix:
    """Velocity of the rod's lower tip relative to the plate, by differentiating its position."""
    x, z, tilt, height = (sp.Function(name)(t) for name in ("x", "z", "phi", "h"))
    tip = sp.Matrix([x, 0, z]) - length / 2 * AXIS.subs(phi, tilt) - sp.Matrix([0, 0, height])
    rates = {x.diff(t): c_x, z.diff(t): c_z, tilt.diff(t): omega, height.diff(t): V_z}
    return tip.diff(t).subs(rates).subs(tilt, phi)


@cache
def tip_acceleration() -> sp.Matrix:
    """m dv/dt of the tip under the force F at that tip, the plate's velocity constant."""
    force, lever = sp.Matrix([F_x, 0, F_z]), -length / 2 * AXIS
    spin = spin_change(force, lever, moment)
    return m * contact_velocity(velocity_change(force), spin, lever, sp.zeros(3, 1))


def _alpha() -> sp.Expr:
    """alpha of Eq. (4), solved from the component of (4) along x."""
    alpha = sp.Symbol("alpha")
    force = sp.Matrix([F_x, 0, F_z])
    printed = force + alpha * (force - AXIS * force.dot(AXIS))
    (value,) = sp.solve(printed[0] - tip_acceleration()[0], alpha)
    return sp.simplify(value)


def _printed_4() -> sp.Matrix:
    force = sp.Matrix([F_x, 0, F_z])
    return force + m * length**2 / (4 * moment) * (force - AXIS * force.dot(AXIS))


_dP = sp.Matrix([P_x, 0, P_z])
_c = sp.Matrix([c_x, 0, c_z])
_spin = sp.Matrix([0, omega, 0])

EQUATIONS = (
    Equation(
        tag="1",
        what="Newton's law for the centre of mass",
        symbol="dc",
        printed=_dP / m,
        derive=lambda: velocity_change(_dP),
        verdict="assumed",
        note="an axiom of the derivation",
    ),
    Equation(
        tag="2",
        what="Euler's law about the centre of mass",
        symbol="I d\\omega",
        printed=-length / 2 * AXIS.cross(_dP),
        derive=lambda: moment * spin_change(_dP, -length / 2 * AXIS, moment),
        note="the moment of $dP$ at the lower tip; only for a contact on the rod's axis (thin rod)",
    ),
    Equation(
        tag="3",
        what="velocity of the contact point",
        symbol="\\mathbf v",
        printed=_c - length / 2 * _spin.cross(AXIS) - sp.Matrix([0, 0, V_z]),
        derive=tip_velocity,
        note="derived by differentiating the tip's position",
    ),
    Equation(
        tag="4",
        what="acceleration of the contact point, vector form",
        symbol="m\\,d\\mathbf v/dt",
        printed=_printed_4(),
        derive=tip_acceleration,
        note=r"with $\alpha = m l^2/(4 I)$, which the text does not define (3 for a thin rod); "
        r"another $\alpha$ follows (30)",
    ),
    Equation(
        tag="IV: alpha",
        what=r"the constant $\alpha$ of (4)",
        symbol="\\alpha",
        derive=_alpha,
        check=lambda: (
            _alpha().subs(moment, m * length**2 / 12) - 3,
            _alpha() - m * length**2 / (4 * moment),
        ),
        verdict="new",
        note="$m l^2/(4 I)$; the paper leaves it undefined",
    ),
    Equation(
        tag="5",
        what="acceleration of the contact point along the plate",
        symbol="m\\dot v_x",
        printed=-X * Z / k**2 * F_z + (k**2 + Z**2) / k**2 * F_x,
        derive=lambda: m * contact_change(F_x, F_z)[0],
    ),
    Equation(
        tag="6",
        what="acceleration of the contact point across the plate",
        symbol="m\\dot v_z",
        printed=(k**2 + X**2) / k**2 * F_z - X * Z / k**2 * F_x,
        derive=lambda: m * contact_change(F_x, F_z)[1],
    ),
)
