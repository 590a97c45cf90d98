"""Generated functions of the impact map: derived outputs and rewriting rules."""

import sympy as sp

from . import laws, slip_reversal
from .newton import approach, spin_jump
from .rewrites import (
    CONTACT,
    GENERAL,
    RESPONSES,
    SQUARES,
    Function,
    K,
    K_z,
    N,
    N_back,
    T,
    T_back,
    collect_friction,
    name_responses,
    r,
    recast,
    w,
)
from .slide import impulse as slide_impulse
from .slide import slide_excess, stop
from .slip_stick import sticking_force
from .symbols import (
    F_z,
    P_x,
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
    v_f,
)

_one = {m: sp.Integer(1)}  # impulses per unit mass
_u_f, _gain, _rise, _rest = sp.symbols("u_f gain rise rest", real=True)
_j_1, _j_2, _q, _fall = sp.symbols("j_1 j_2 q fall", real=True)
_push, _lift, _turn, _back = sp.symbols("push lift turn back", real=True)
_N_stick, _N_after = sp.symbols("N_stick N_after", real=True)
_square, _energy, _twice = sp.symbols("square energy twice", real=True)


def _until(v_final: sp.Symbol, impulse: tuple[sp.Expr, ...]) -> tuple[sp.Expr, ...]:
    """An impulse under kinematic restitution, for any final normal velocity instead."""
    return tuple(part.subs(epsilon, -v_final / v_0) for part in impulse)


FUNCTIONS: tuple[Function, ...] = (
    Function(
        name="approach",
        summary="Contact-point velocity $(u_0, v_0)$ before the impact, Eq. (3).",
        detail=r"$c$, $V_z$ in m/s, $\omega$ in 1/s, $X$, $Z$ in m.",
        arguments=(c_x, c_z, omega, V_z, X, Z),
        derived=lambda: dict(approach()),
        rules=(
            recast(
                "plate first",
                "$c_z - V_z$ is exact where both are close",
                u_0=c_x - omega * Z,
                fall=c_z - V_z,
                v_0=_fall + omega * X,
            ),
        ),
    ),
    Function(
        name="slip_response",
        summary="$(N, T)$: $k^2$ times $dv/dP_z$ and $-du/dP_z$ in forward slip, Eqs. (5), (6).",
        detail=r"Lengths in m; $N$, $T$ in $\mathrm{m}^2$. Backward slip: the same with $-\mu$.",
        arguments=(X, Z, k, mu),
        derived=lambda: {N: RESPONSES[N], T: RESPONSES[T]},
        rules=(collect_friction(),),
    ),
    Function(
        name="slide",
        summary="Impulse over $k^2$ and slip velocity left after a slide, Eqs. (8), (14).",
        detail=r"Per unit mass; $gain = -(1 + \epsilon) v_0$. Needs $N > 0$ and $u_f \ge 0$.",
        arguments=(_gain, u_0, N, T),
        derived=lambda: {
            _j_1: slide_impulse()[1].subs(_one) / k**2,
            _u_f: slide_excess().subs(_one),
        },
        rules=(
            name_responses(),
            recast(
                "one quotient",
                "both outputs share it; no $k^2$ in a denominator",
                j_1=_gain / N,
                u_f=u_0 - T * _j_1,
            ),
        ),
        meaning={**CONTACT, _gain: -(1 + epsilon) * v_0},
    ),
    Function(
        name="stop",
        summary="Impulse over $k^2$ when the slip stops, and $v_1 - v_0$ there, Eqs. (B1), (15).",
        detail="Per unit mass. Needs $T > 0$.",
        arguments=(u_0, N, T),
        derived=lambda: {_j_1: stop()[1].subs(_one) / k**2, _rise: stop()[2] - v_0},
        rules=(recast("shared quotient", "no $k^2$ in a denominator", j_1=u_0 / T, rise=N * _j_1),),
        meaning=RESPONSES,
    ),
    Function(
        name="reverse",
        summary="Impulse over $k^2$ and slip velocity of the way back, Eqs. (B8), (B10).",
        detail="Per unit mass, after the stop; $rest = v_f - v_1$. Needs $T_{back} > 0$, and so "
        "$N_{back} > 0$.",
        arguments=(_rest, N_back, T_back),
        derived=lambda: {
            _j_2: (_until(v_f, slip_reversal.impulse())[1] - stop()[1]).subs(_one) / k**2,
            _u_f: _until(v_f, (slip_reversal.final_slip(),))[0].subs(_one),
        },
        rules=(
            recast(
                "name the rest",
                "a difference of velocities instead of three fractions",
                j_2=_rest / N_back,
                u_f=-T_back * _j_2,
            ),
        ),
        meaning={**CONTACT, _rest: v_f - stop()[2]},
    ),
    Function(
        name="slip",
        summary="Impulse and spin of $j = 1$ while slipping, Eqs. (1), (2).",
        detail="$(-push, lift, turn)$ forward, $(push, lift, back)$ backward, per unit mass; $j$ "
        "is the normal impulse over $k^2$.",
        arguments=(X, Z, k, mu),
        derived=lambda: {
            _push: mu * k**2,
            _lift: k**2,
            _turn: spin_jump(-mu * k**2, k**2).subs(_one),
            _back: spin_jump(mu * k**2, k**2).subs(_one),
        },
        rules=(
            recast(
                "no quotient",
                "$k^2$ cancels in the spin",
                lift=k**2,
                push=_lift * mu,
                turn=X + mu * Z,
                back=X - mu * Z,
            ),
        ),
        returned=("push", "lift", "turn", "back"),
    ),
    Function(
        name="stick",
        summary="Impulse and spin of $j = 1$ while sticking, Eqs. (17), (B3).",
        detail="$(push, lift, turn)$ per unit mass; $j = (v_f - v_1)/(k^2 + X^2 + Z^2)$. "
        "$K_z = k^2 + Z^2$.",
        arguments=(X, Z, K_z),
        derived=lambda: {
            _push: sticking_force().subs(F_z, SQUARES[K_z]),
            _lift: SQUARES[K_z],
            _turn: spin_jump(sticking_force().subs(F_z, SQUARES[K_z]), SQUARES[K_z]).subs(_one),
        },
        rules=(recast("no quotient", "the denominator is in $j$", push=X * Z, lift=K_z, turn=X),),
        meaning=SQUARES,
        returned=("push", "K_z", "X"),
        unused=("lift", "turn"),
    ),
    Function(
        name="stick_response",
        summary="$N_{stick}$: $k^2$ times $dv/dP_z$ while sticking; what $N$ is while slipping "
        "forward.",
        detail=r"Lengths in m, $N_{stick}$ in $\mathrm{m}^2$. $K = k^2 + X^2 + Z^2$, "
        "$K_z = k^2 + Z^2$.",
        arguments=(k, K, K_z),
        derived=lambda: {_N_stick: k**2 * laws.slopes()["stick"]},
        rules=(
            recast(
                "divide first",
                "a quotient of sums of squares, of order one",
                q=K / K_z,
                N_stick=k**2 * _q,
            ),
        ),
        meaning=SQUARES,
    ),
    Function(
        name="slopes",
        summary="$w = a_2 P_1$ and $r = a_2/a_1$, with $N_{after} = k^2 a_2$ of the phase after "
        "the stop.",
        detail="$w$ in m/s; $j_1 = P_1/k^2$. $r$ only where $N > 0$.",
        arguments=(_j_1, N, _N_after),
        derived=lambda: {
            w: laws.a_2 * stop()[1].subs(_one),
            r: laws.a_2 / laws.slopes()["slip"],
        },
        rules=(
            recast(
                "name responses",
                "shares the quotient with stop",
                w=_N_after * _j_1,
                r=_N_after / N,
            ),
        ),
        meaning={**RESPONSES, _N_after: k**2 * laws.a_2, _j_1: stop()[1].subs(_one) / k**2},
    ),
    Function(
        name="poisson_early",
        summary="$v_f$ under Poisson's restitution; the slip stopped before compression ended.",
        detail=r"$v_1 \le 0$, $w \ge 0$.",
        arguments=(epsilon, v_1, w),
        derived=lambda: {v_f: laws.final_velocity("poisson", "early")},
        rules=(recast("name $v_1$", "a sum of positive terms", v_f=epsilon * (w - v_1)),),
        meaning=GENERAL,
    ),
    Function(
        name="poisson_late",
        summary="$v_f$ under Poisson's restitution; the slip stopped after compression ended.",
        detail=r"$0 \le v_1 \le -\epsilon v_0$, $r > 0$.",
        arguments=(epsilon, v_0, v_1, r),
        derived=lambda: {v_f: laws.final_velocity("poisson", "late")},
        rules=(
            recast(
                "name $v_1$", "what is left to gain, stretched", v_f=v_1 - r * (v_1 + epsilon * v_0)
            ),
        ),
        meaning=GENERAL,
    ),
    Function(
        name="stronge_early",
        summary="$v_f^2$ under Stronge's restitution; the slip stopped before compression ended.",
        detail=r"$v_0 < 0$, $v_1 \le 0$, $w \ge 0$.",
        arguments=(epsilon, v_0, v_1, w),
        derived=lambda: {_square: laws.final_velocity("stronge", "early") ** 2},
        rules=(
            recast(
                "sum of positive terms",
                r"$v_1$ and $w$ share the quotient $u_0/T$, so that $T \to 0$ hurts neither",
                square=epsilon**2 * (v_1**2 - w * (v_0 + v_1)),
            ),
        ),
        meaning=GENERAL,
    ),
    Function(
        name="stronge_late",
        summary="$v_f^2$ under Stronge's restitution; the slip stopped after compression ended.",
        detail=r"$0 \le v_1 \le -\epsilon v_0$, $r > 0$.",
        arguments=(epsilon, v_0, v_1, r),
        derived=lambda: {_square: laws.final_velocity("stronge", "late") ** 2},
        rules=(
            recast(
                "sum of positive terms",
                "a difference of squares is a product",
                square=v_1**2 - r * (v_1 - epsilon * v_0) * (v_1 + epsilon * v_0),
            ),
        ),
        meaning=GENERAL,
    ),
    Function(
        name="energy_change",
        summary="Kinetic energy after minus before, in the frame of the plate.",
        detail="Per unit mass: impulse times mean contact velocity.",
        arguments=(P_x, P_z, u_0, v_0, _u_f, v_f),
        derived=lambda: {_energy: P_x * (u_0 + _u_f) / 2 + P_z * (v_0 + v_f) / 2},
        rules=(
            recast(
                "half last",
                "one product less",
                twice=P_x * (u_0 + _u_f) + P_z * (v_0 + v_f),
                energy=_twice / 2,
            ),
        ),
    ),
)
