"""Generated functions of rods, regime boundaries and drift: outputs and rewriting rules."""

from functools import partial

import sympy as sp

from . import bodies, drift, laws, optimum, thin_rod
from .rewrites import SINGLE_FRACTION, Function
from .symbols import V_z, X, Z, diameter, epsilon, k, length, mu, phi

_POSITIVE = sp.symbols(
    "x z s g grip sin cos root tangent held root_a root_b root_c root_d", positive=True
)
_x, _z, _s, _g, _grip, _sin, _cos, _root, _tangent, _held, _root_a, _root_b, _root_c, _root_d = (
    _POSITIVE
)
_read = partial(Function.read, letters=_POSITIVE)


def _thin(expr: sp.Expr) -> sp.Expr:
    """Per length k, for positive X and Z."""
    return sp.simplify(expr.subs({X: _x * k, Z: _z * k}))


def _of_tilt(expr: sp.Expr) -> sp.Expr:
    return expr.subs({sp.sin(phi): _sin, sp.cos(phi): _cos})


def _grip_of(case: str) -> sp.Expr:
    """c_x/(x c_z') - z."""
    along, up = drift.stationary(case)
    return sp.simplify(_thin(along / up) / _x - _z)


def _response() -> dict[str, sp.Expr]:
    """What a response's eigenvalues are made of; at the critical friction that of slip-stick."""
    a, b, c, d = optimum.jacobian("back")
    forms = (*optimum.stability_margins("back"), a - d, -4 * b * c)
    names = ("steady", "alternating", "shrinking", "apart", "coupling")
    friction = _held * thin_rod.critical_friction()
    return {name: form.subs(mu, friction) for name, form in zip(names, forms, strict=True)}


def _critical_tangents() -> dict[str, sp.Expr]:
    root = sp.sqrt(9 - 16 * mu**2)
    lower, upper = (tangent.subs(root, _root) for tangent in thin_rod.critical_tangents())
    return {"lower": lower, "upper": upper}


FUNCTIONS: tuple[Function, ...] = (
    _read("critical_friction", lambda: {"mu": thin_rod.critical_friction()}),
    _read("painleve_friction", lambda: {"mu": optimum.painleve_friction()}),
    _read("critical_tangents", _critical_tangents, meaning={mu: sp.sqrt(9 - _root**2) / 4}),
    _read(
        "slide_friction",
        lambda: {"quotient": thin_rod.slide_friction().subs(thin_rod.ratio, _g / (1 + epsilon))},
        SINGLE_FRACTION,
    ),
    _read("drift_grips", lambda: {"stick": _grip_of("stick"), "back": _grip_of("back")}),
    _read(
        "drift",
        lambda: {
            "along": _thin(drift.stationary("back")[0] / V_z).subs(mu, _grip * _x / (1 + _z**2)),
            "up": _thin(drift.stationary("back")[1] / V_z),
        },
    ),
    _read(
        "optimum_stick",
        lambda: {"along": optimum.optimum("stick")[1]},
        meaning={_root_a: sp.sqrt(1 - epsilon), _root_b: sp.sqrt(7 - epsilon)},
    ),
    _read(
        "optimum_back",
        lambda: {"tangent": optimum.optimum("back")[0], "along": optimum.optimum("back")[1]},
        meaning={_root: sp.sqrt(mu**2 * (9 - epsilon) ** 2 + (1 - epsilon) * (7 - epsilon))},
    ),
    _read(
        "thin_drift_stick",
        lambda: {"along": optimum.drift_over_tangent("stick").subs(bodies.T, _tangent)},
    ),
    _read("landing_response", _response),
    _read(
        "energy_restitution_stick",
        lambda: {"restitution": laws.sticking_threshold()},
        meaning={
            laws.A: _root_a**2,
            laws.C: _root_c**2,
            laws.B: sp.sqrt(_root_a**2 * _root_c**2 - _root_d**2),
        },
    ),
    _read(
        "energy_threshold_back",
        lambda: {"kappa": laws.energy_threshold("back")},
        meaning={laws.A: _root_a**2, laws.C: (_root_a**2 - _root_b**2) / mu**2},
    ),
    _read(
        "round_rod",
        lambda: {
            "X": _of_tilt(bodies.round_contact()[0]),
            "Z": _of_tilt(bodies.round_contact()[1]),
            "gyration": sp.factor(
                bodies.spherocylinder_gyration().subs(diameter, _s * length) / length**2
            ),
        },
    ),
    _read(
        "flat_rod",
        lambda: {
            "X": _of_tilt(bodies.flat_contact()[0]),
            "Z": _of_tilt(bodies.flat_contact()[1]),
            "gyration": sp.expand(
                bodies.cylinder_gyration().subs(diameter, _s * length) / length**2
            ),
        },
    ),
)
