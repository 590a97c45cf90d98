"""The impact map as it is generated: derived outputs, and the rules that make them compute well."""

import sympy as sp

from . import laws, slip_reversal, slip_stick
from .newton import approach, spin_jump
from .rewrites import (
    CONTACT,
    GENERAL,
    RESPONSES,
    SQUARES,
    Body,
    Function,
    K_x,
    K_z,
    N,
    N_back,
    T,
    T_back,
    name_responses,
    nested,
    r,
    recast,
    single_fraction,
    w,
)
from .slide import impulse as slide_impulse
from .slide import slide_excess, stop
from .symbols import (
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
_u_f, _spin, _gain, _all = sp.symbols("u_f spin gain inertia", real=True)
_j_1, _j_2, _q, _kk, _fall, _bounce = sp.symbols("j_1 j_2 q kk fall bounce", real=True)
_N_stick, _N_after = sp.symbols("N_stick N_after", real=True)
_square, _energy, _twice = sp.symbols("square energy twice", real=True)


def _impulse_outputs(impulse: tuple[sp.Expr, sp.Expr]) -> Body:
    """P_x, P_z per unit mass and the spin that they give."""
    p_x, p_z = (part.subs(_one) for part in impulse)
    return {P_x: p_x, P_z: p_z, _spin: spin_jump(p_x, p_z).subs(_one)}


def _until(v_final: sp.Symbol, impulse: tuple[sp.Expr, sp.Expr]) -> tuple[sp.Expr, sp.Expr]:
    """An impulse under kinematic restitution, for any final normal velocity instead."""
    return tuple(part.subs(epsilon, -v_final / v_0) for part in impulse)


FUNCTIONS: tuple[Function, ...] = (
    Function(
        name="approach",
        summary="Contact-point velocity (u_0, v_0) before the impact, Eq. (3).",
        detail="c, V_z in m/s, omega in 1/s, X, Z in m.",
        arguments=(c_x, c_z, omega, V_z, X, Z),
        outputs=dict(approach()),
        rules=(
            recast(
                "plate first",
                "c_z - V_z is exact where both are close",
                u_0=c_x - omega * Z,
                fall=c_z - V_z,
                v_0=_fall + omega * X,
            ),
        ),
    ),
    Function(
        name="slip_response",
        summary="(N, T): k^2 times dv/dP_z and -du/dP_z in forward slip, Eqs. (5), (6).",
        detail="Lengths in m; N, T in m^2. Backward slip: the same with -mu.",
        arguments=(X, Z, k, mu),
        outputs={N: RESPONSES[N], T: RESPONSES[T]},
        rules=(nested(),),
    ),
    Function(
        name="slide",
        summary="Impulse over k^2 and slip velocity left after a slide, Eqs. (8), (14).",
        detail="Per unit mass. Needs N > 0 and u_0 N + (1 + epsilon) v_0 T >= 0.",
        arguments=(epsilon, u_0, v_0, N, T),
        outputs={
            _j_1: slide_impulse()[1].subs(_one) / k**2,
            _u_f: slide_excess().subs(_one),
        },
        rules=(
            name_responses(),
            recast(
                "one quotient",
                "both outputs share it; no k^2 in a denominator",
                bounce=1 + epsilon,
                j_1=-_bounce * v_0 / N,
                u_f=u_0 - T * _j_1,
            ),
        ),
        meaning=CONTACT,
    ),
    Function(
        name="stop",
        summary="Impulse over k^2 and normal velocity v_1 when the slip stops, Eqs. (B1), (15).",
        detail="Per unit mass. Needs T > 0.",
        arguments=(u_0, v_0, N, T),
        outputs={_j_1: stop()[1].subs(_one) / k**2, v_1: stop()[2]},
        rules=(
            recast(
                "sum", "v_0 is not multiplied and divided by T", j_1=u_0 / T, v_1=v_0 + N * _j_1
            ),
        ),
        meaning=RESPONSES,
    ),
    Function(
        name="reverse",
        summary="Impulse over k^2 and slip velocity of the way back, Eqs. (B8), (B10).",
        detail="Per unit mass, without what `stop` gave. Needs T_back > 0, and so N_back > 0.",
        arguments=(v_1, v_f, N_back, T_back),
        outputs={
            _j_2: (_until(v_f, slip_reversal.impulse())[1] - stop()[1]).subs(_one) / k**2,
            _u_f: _until(v_f, (slip_reversal.final_slip(),))[0].subs(_one),
        },
        rules=(
            recast(
                "name v_1",
                "a difference of velocities instead of three fractions",
                j_2=(v_f - v_1) / N_back,
                u_f=-T_back * _j_2,
            ),
        ),
        meaning=CONTACT,
    ),
    Function(
        name="slip",
        summary="Impulse and spin of slipping forward (j_1) and back (j_2), Eqs. (1), (2).",
        detail="Per unit mass; j_1, j_2 >= 0 are normal impulses over k^2.",
        arguments=(X, Z, k, mu, _j_1, _j_2),
        outputs=_impulse_outputs((mu * k**2 * (_j_2 - _j_1), k**2 * (_j_1 + _j_2))),
        rules=(
            recast(
                "two phases",
                "no k^2 in a denominator",
                kk=k**2,
                P_x=mu * (_kk * (_j_2 - _j_1)),
                P_z=_kk * (_j_1 + _j_2),
                spin=(X + mu * Z) * _j_1 + (X - mu * Z) * _j_2,
            ),
        ),
    ),
    Function(
        name="stick",
        summary="Impulse and spin after slip-stick that ends at v_f, Eqs. (B4), (B5).",
        detail="Per unit mass; v_f = -epsilon v_0 for Newton's law. Independent of friction. "
        "K_x = k^2 + X^2, K_z = k^2 + Z^2.",
        arguments=(X, Z, K_x, K_z, u_0, v_0, v_f),
        outputs=_impulse_outputs(_until(v_f, slip_stick.impulse())),
        rules=(
            single_fraction(),
            recast(
                "gain of normal velocity",
                "v_f - v_0 is a sum of positive terms; the outputs share one denominator",
                gain=v_f - v_0,
                inertia=K_x + Z**2,
                P_x=(X * Z * _gain - K_x * u_0) / _all,
                P_z=(K_z * _gain - X * Z * u_0) / _all,
                spin=(Z * u_0 + X * _gain) / _all,
            ),
        ),
        meaning=SQUARES,
    ),
    Function(
        name="stick_response",
        summary="N_stick: k^2 times dv/dP_z while sticking; what N is while slipping forward.",
        detail="Lengths in m, N_stick in m^2. K_x = k^2 + X^2, K_z = k^2 + Z^2.",
        arguments=(Z, k, K_x, K_z),
        outputs={_N_stick: k**2 * laws.slopes()["stick"]},
        rules=(
            recast(
                "divide first",
                "a quotient of sums of squares, of order one",
                q=(K_x + Z**2) / K_z,
                N_stick=k**2 * _q,
            ),
        ),
        meaning=SQUARES,
    ),
    Function(
        name="slopes",
        summary="w = a_2 P_1 and r = a_2/a_1, with N_after = k^2 a_2 of the phase after the stop.",
        detail="w in m/s. Needs T > 0; r only where N > 0.",
        arguments=(u_0, N, T, _N_after),
        outputs={
            w: laws.a_2 * stop()[1].subs(_one),
            r: laws.a_2 / laws.slopes()["slip"],
        },
        rules=(
            recast(
                "name responses",
                "shares the quotient with stop",
                j_1=u_0 / T,
                w=_N_after * _j_1,
                r=_N_after / N,
            ),
        ),
        meaning={**RESPONSES, _N_after: k**2 * laws.a_2},
    ),
    Function(
        name="poisson_early",
        summary="v_f under Poisson's restitution; the slip stopped before compression ended.",
        detail="v_1 <= 0, w >= 0.",
        arguments=(epsilon, v_1, w),
        outputs={v_f: laws.final_velocity("poisson", "early")},
        rules=(recast("name v_1", "a sum of positive terms", v_f=epsilon * (w - v_1)),),
        meaning=GENERAL,
    ),
    Function(
        name="poisson_late",
        summary="v_f under Poisson's restitution; the slip stopped after compression ended.",
        detail="0 <= v_1 <= -epsilon v_0, r > 0.",
        arguments=(epsilon, v_0, v_1, r),
        outputs={v_f: laws.final_velocity("poisson", "late")},
        rules=(
            recast(
                "name v_1", "what is left to gain, stretched", v_f=v_1 - r * (v_1 + epsilon * v_0)
            ),
        ),
        meaning=GENERAL,
    ),
    Function(
        name="stronge_early",
        summary="v_f^2 under Stronge's restitution; the slip stopped before compression ended.",
        detail="v_0 < 0, v_1 <= 0, w >= 0.",
        arguments=(epsilon, v_0, v_1, w),
        outputs={_square: laws.final_velocity("stronge", "early") ** 2},
        rules=(
            recast(
                "sum of positive terms",
                "v_1 and w share the quotient u_0/T, so that T -> 0 hurts neither",
                square=epsilon**2 * (v_1**2 - w * (v_0 + v_1)),
            ),
        ),
        meaning=GENERAL,
    ),
    Function(
        name="stronge_late",
        summary="v_f^2 under Stronge's restitution; the slip stopped after compression ended.",
        detail="0 <= v_1 <= -epsilon v_0, r > 0.",
        arguments=(epsilon, v_0, v_1, r),
        outputs={_square: laws.final_velocity("stronge", "late") ** 2},
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
        outputs={_energy: P_x * (u_0 + _u_f) / 2 + P_z * (v_0 + v_f) / 2},
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
