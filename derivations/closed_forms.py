"""Outputs of the generated functions, as derived; functions.toml has their words and text."""

from collections.abc import Callable
from functools import partial

import sympy as sp

from . import bodies, drift, laws, optimum, pairs, slide, slip_reversal, thin_rod
from .equality import NamedForms, Pair
from .newton import approach, spin_jump, velocity_change
from .pairs import FIRST, SECOND
from .rewrites import (
    CONTACT,
    GENERAL,
    LETTERS,
    RESPONSES,
    SINGLE_FRACTION,
    SQUARES,
    Function,
    K_z,
    Letters,
    N,
    T,
    responses,
)
from .slide import stop
from .slip_stick import sticking_force
from .symbols import (
    F_z,
    P_x,
    P_z,
    V_z,
    X,
    Z,
    diameter,
    epsilon,
    k,
    length,
    m,
    mu,
    phi,
    v_0,
    v_f,
)

_gain, _rest, _j_1, _N_after, _cross = sp.symbols("gain rest j_1 N_after cross", real=True)
_slide, _left = sp.symbols("slide left", real=True)  # v_f of a slide, and what it has over v_1


def _until_v_f(part: sp.Expr) -> sp.Expr:
    """A form under kinematic restitution, rewritten for any final normal velocity v_f."""
    return part.subs(epsilon, -v_f / v_0)


def _sticking() -> NamedForms:
    """Impulse (push, lift) and spin (turn) of j = 1 while the contact sticks, per unit mass."""
    lift = SQUARES[K_z]
    push = sticking_force().subs(F_z, lift)
    return {"push": push, "lift": lift, "turn": spin_jump(push, lift)}


_POSITIVE = sp.symbols(
    "x z s g grip sin cos root tangent held root_a root_b root_c root_d", positive=True
)
_x, _z, _s, _g, _grip, _sin, _cos, _root, _tangent, _held, _root_a, _root_b, _root_c, _root_d = (
    _POSITIVE
)
_of_rods = partial(Function, letters=Letters(LETTERS | {x.name: x for x in _POSITIVE}))


def _thin(expr: sp.Expr) -> sp.Expr:
    """A form with X = x k and Z = z k put in, for positive x and z, simplified."""
    return sp.simplify(expr.subs({X: _x * k, Z: _z * k}))


def _rod(contact: Pair, simpler: Callable[[sp.Expr], sp.Expr], square: sp.Expr) -> NamedForms:
    """Outputs of a rod: X and Z by sine and cosine of the tilt, and `gyration`, k^2 over l^2."""
    X, Z = (form.subs({sp.sin(phi): _sin, sp.cos(phi): _cos}) for form in contact)
    return {"X": X, "Z": Z, "gyration": simpler(square.subs(diameter, _s * length) / length**2)}


def _of_law(law: str, order: str, outputs: str, power: int) -> Function:
    """Generated function of v_f to a power, if the slip stops, and of how much more it is than v_1.

    Where it stops early, v_f - v_1 is a sum of positive terms as it stands: v_f alone is generated.
    """

    def forms() -> NamedForms:
        v_f = laws.final_velocity(law, order) ** power
        return dict(zip(outputs.split(), (v_f, v_f - laws.V_1**power), strict=False))

    slide = -epsilon * v_0
    meaning = {**GENERAL, _slide: slide, _left: slide - laws.V_1}
    return Function(f"{law}_{order}", forms, meaning=meaning)


def _grip_of(case: str) -> sp.Expr:
    """Grip of a stationary landing: c_x/(x c_z') - z, with x = X/k and z = Z/k."""
    along, up = drift.stationary(case)
    return sp.simplify(_thin(along / up) / _x - _z)


def _response() -> NamedForms:
    """Forms that give the eigenvalues of a stationary landing's response, in slip reversal.

    `held` is the friction over the critical one; at 1 the forms are those of slip-stick.
    """
    a, b, c, d = optimum.jacobian("back")
    forms = *optimum.stability_margins("back"), a - d, -4 * b * c
    names = "steady", "alternating", "shrinking", "apart", "coupling"
    friction = _held * thin_rod.critical_friction()
    return {name: form.subs(mu, friction) for name, form in zip(names, forms, strict=True)}


def _critical_tangents() -> NamedForms:
    root = sp.sqrt(9 - 16 * mu**2)
    lower, upper = (tangent.subs(root, _root) for tangent in thin_rod.critical_tangents())
    return {"lower": lower, "upper": upper}


def _of_levers(form: sp.Expr) -> sp.Expr:
    """A form of a rod or of two bodies, rewritten in inverse masses and in levers over k."""
    for letters, names in (
        ({x: x for x in (m, k, X, Z)}, "s x z"),
        (FIRST, "s_1 x_1 z_1"),
        (SECOND, "s_2 x_2 z_2"),
    ):
        K, (s, x, z) = letters[k], sp.symbols(names, real=True)
        form = form.subs({letters[m]: 1 / s, letters[X]: x * K, letters[Z]: z * K})
    return sp.expand(form)


_turned = pairs.CROSS / (FIRST[k] * SECOND[k])
_PAIR = {x: _of_levers(form) for x, form in (pairs.mobility() | {_cross: _turned}).items()}

FUNCTIONS = (
    # ---- the impact map ----
    Function("approach", approach),
    Function("slip_response", lambda: {x: responses()[x] for x in (N, T)}),
    Function(
        "slide",
        lambda: {
            "j_1": slide.impulse()[1] / k**2,
            "u_f": slide.slide_excess(),
        },
        meaning={**CONTACT, _gain: -(1 + epsilon) * v_0},
    ),
    Function(
        "stop",
        lambda: {"j_1": stop()[1] / k**2, "rise": stop()[2] - v_0},
        meaning=RESPONSES,
    ),
    Function(
        "reverse",
        lambda: {
            "j_2": (_until_v_f(slip_reversal.impulse()[1]) - stop()[1]) / k**2,
            "u_f": _until_v_f(slip_reversal.final_slip()),
        },
        meaning={**CONTACT, _rest: v_f - stop()[2]},
    ),
    Function(
        "slip",
        lambda: {
            "push": mu * k**2,
            "lift": k**2,
            "turn": spin_jump(-mu * k**2, k**2),
            "back": spin_jump(mu * k**2, k**2),
        },
    ),
    Function("stick", _sticking, meaning=SQUARES),
    Function(
        "stick_response",
        lambda: {"N_stick": k**2 * laws.slopes()["stick"]},
        meaning=SQUARES,
    ),
    Function(
        "slopes",
        lambda: {
            "w": laws.a_2 * stop()[1],
            "r": laws.a_2 / laws.slopes()["slip"],
        },
        meaning={**RESPONSES, _N_after: k**2 * laws.a_2, _j_1: stop()[1].subs(m, 1) / k**2},
    ),
    _of_law("poisson", "early", "v_f", 1),
    _of_law("poisson", "late", "v_f rest", 1),
    _of_law("stronge", "early", "square", 2),
    _of_law("stronge", "late", "square more", 2),
    Function("energy_change", lambda: {"energy": laws.energy_of_impulse()}),
    # ---- rods, regime boundaries, drift ----
    _of_rods("critical_friction", lambda: {"mu": thin_rod.critical_friction()}),
    _of_rods("painleve_friction", lambda: {"mu": optimum.painleve_friction()}),
    _of_rods("critical_tangents", _critical_tangents, meaning={mu: sp.sqrt(9 - _root**2) / 4}),
    _of_rods(
        "slide_friction",
        lambda: {"quotient": thin_rod.slide_friction().subs(thin_rod.ratio, _g / (1 + epsilon))},
        (SINGLE_FRACTION,),
    ),
    _of_rods("drift_grips", lambda: {"stick": _grip_of("stick"), "back": _grip_of("back")}),
    _of_rods(
        "drift",
        lambda: {
            "along": _thin(drift.stationary("back")[0] / V_z).subs(mu, _grip * _x / (1 + _z**2)),
            "up": _thin(drift.stationary("back")[1] / V_z),
        },
    ),
    _of_rods(
        "optimum_stick",
        lambda: {"along": optimum.optimum("stick")[1]},
        meaning={_root_a: sp.sqrt(1 - epsilon), _root_b: sp.sqrt(7 - epsilon)},
    ),
    _of_rods(
        "optimum_back",
        lambda: {"tangent": optimum.optimum("back")[0], "along": optimum.optimum("back")[1]},
        meaning={_root: optimum.ROOT},
    ),
    _of_rods(
        "thin_drift_stick",
        lambda: {"along": optimum.drift_over_tangent("stick").subs(bodies.T, _tangent)},
    ),
    _of_rods("landing_response", _response),
    _of_rods(
        "energy_restitution_stick",
        lambda: {"restitution": laws.sticking_threshold()},
        meaning={
            laws.A: _root_a**2,
            laws.C: _root_c**2,
            laws.B: sp.sqrt(_root_a**2 * _root_c**2 - _root_d**2),
        },
    ),
    _of_rods(
        "energy_threshold_back",
        lambda: {"kappa": laws.energy_threshold("back")},
        meaning={laws.A: _root_a**2, laws.C: (_root_a**2 - _root_b**2) / mu**2},
    ),
    _of_rods(
        "round_rod",
        lambda: _rod(bodies.round_contact(), sp.factor, bodies.spherocylinder_gyration()),
    ),
    _of_rods(
        "flat_rod", lambda: _rod(bodies.flat_contact(), sp.expand, bodies.cylinder_gyration())
    ),
    # ---- two bodies that meet ----
    Function("pair_mobility", lambda: _PAIR),
    Function(
        "pair_determinant",
        lambda: {"D": _of_levers(pairs.determinant())},
        meaning=_PAIR,
    ),
    Function(
        "pair_change",
        lambda: {
            "dc_x": _of_levers(velocity_change(P_x)),
            "dc_z": _of_levers(velocity_change(P_z)),
            "turn": _of_levers(k * spin_jump(P_x, P_z)),
        },
    ),
)
