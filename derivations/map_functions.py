"""Generated functions of the impact map: derived outputs and rewriting rules."""

import sympy as sp

from . import laws, slip_reversal
from .newton import approach, spin_jump
from .rewrites import (
    COLLECT_FRICTION,
    CONTACT,
    GENERAL,
    NAME_RESPONSES,
    RESPONSES,
    SQUARES,
    Function,
    K_z,
    N,
    T,
)
from .slide import impulse as slide_impulse
from .slide import slide_excess, stop
from .slip_stick import sticking_force
from .symbols import F_z, P_x, P_z, epsilon, k, m, mu, u_0, u_f, v_0, v_f

_one = {m: sp.Integer(1)}  # impulses per unit mass
_gain, _rest, _j_1, _N_after = sp.symbols("gain rest j_1 N_after", real=True)


def _until_v_f(part: sp.Expr) -> sp.Expr:
    """A form under kinematic restitution, for any final normal velocity instead."""
    return part.subs(epsilon, -v_f / v_0)


def _sticking() -> dict[str, sp.Expr]:
    """Impulse and spin of j = 1."""
    lift = SQUARES[K_z]
    push = sticking_force().subs(F_z, lift)
    return {"push": push, "lift": lift, "turn": spin_jump(push, lift).subs(_one)}


FUNCTIONS: tuple[Function, ...] = (
    Function.read("approach", approach),
    Function.read(
        "slip_response", lambda: {"N": RESPONSES[N], "T": RESPONSES[T]}, COLLECT_FRICTION
    ),
    Function.read(
        "slide",
        lambda: {"j_1": slide_impulse()[1].subs(_one) / k**2, "u_f": slide_excess().subs(_one)},
        NAME_RESPONSES,
        meaning={**CONTACT, _gain: -(1 + epsilon) * v_0},
    ),
    Function.read(
        "stop",
        lambda: {"j_1": stop()[1].subs(_one) / k**2, "rise": stop()[2] - v_0},
        meaning=RESPONSES,
    ),
    Function.read(
        "reverse",
        lambda: {
            "j_2": (_until_v_f(slip_reversal.impulse()[1]) - stop()[1]).subs(_one) / k**2,
            "u_f": _until_v_f(slip_reversal.final_slip()).subs(_one),
        },
        meaning={**CONTACT, _rest: v_f - stop()[2]},
    ),
    Function.read(
        "slip",
        lambda: {
            "push": mu * k**2,
            "lift": k**2,
            "turn": spin_jump(-mu * k**2, k**2).subs(_one),
            "back": spin_jump(mu * k**2, k**2).subs(_one),
        },
    ),
    Function.read("stick", _sticking, meaning=SQUARES),
    Function.read(
        "stick_response", lambda: {"N_stick": k**2 * laws.slopes()["stick"]}, meaning=SQUARES
    ),
    Function.read(
        "slopes",
        lambda: {"w": laws.a_2 * stop()[1].subs(_one), "r": laws.a_2 / laws.slopes()["slip"]},
        meaning={**RESPONSES, _N_after: k**2 * laws.a_2, _j_1: stop()[1].subs(_one) / k**2},
    ),
    Function.read(
        "poisson_early", lambda: {"v_f": laws.final_velocity("poisson", "early")}, meaning=GENERAL
    ),
    Function.read(
        "poisson_late", lambda: {"v_f": laws.final_velocity("poisson", "late")}, meaning=GENERAL
    ),
    Function.read(
        "stronge_early",
        lambda: {"square": laws.final_velocity("stronge", "early") ** 2},
        meaning=GENERAL,
    ),
    Function.read(
        "stronge_late",
        lambda: {"square": laws.final_velocity("stronge", "late") ** 2},
        meaning=GENERAL,
    ),
    Function.read(
        "energy_change", lambda: {"energy": P_x * (u_0 + u_f) / 2 + P_z * (v_0 + v_f) / 2}
    ),
)
