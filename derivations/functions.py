"""What is generated: each function's derived outputs and the rules that make them compute well."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy as sp

from . import bodies, drift, laws, slip_reversal, slip_stick, thin_rod
from .newton import approach, spin_jump
from .rewrites import (
    CONTACT,
    GENERAL,
    RESPONSES,
    Body,
    N,
    N_back,
    Rule,
    Step,
    T,
    T_back,
    name_responses,
    nested,
    r,
    recast,
    rewrite,
    single_fraction,
    w,
)
from .slide import impulse as slide_impulse
from .slide import slide_excess, stop
from .symbols import (
    P_1,
    P_x,
    P_z,
    V_z,
    X,
    Z,
    c_x,
    c_z,
    diameter,
    epsilon,
    k,
    length,
    m,
    mu,
    omega,
    phi,
    u_0,
    v_0,
    v_1,
    v_f,
)

_one = {m: sp.Integer(1)}  # impulses per unit mass
_x, _z, _s, _g = sp.symbols("x z s g", positive=True)  # |X|/k, |Z|/k, d/l, (1 + epsilon) r
_grip, _sin, _cos, _root = sp.symbols("grip sin cos root", positive=True)
_root_a, _root_b, _root_ac, _root_d = sp.symbols("root_a root_b root_ac root_d", positive=True)
_u_f, _spin = sp.symbols("u_f spin", real=True)


def _name(name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """One generated function."""

    name: str
    summary: str  # what and which equation
    detail: str  # units, domain
    arguments: tuple[sp.Symbol, ...]
    outputs: Body
    rules: tuple[Rule, ...]
    meaning: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)
    returned: tuple[str, ...] = ()  # if not the outputs
    unused: tuple[str, ...] = ()  # assignments that only the proof needs

    def body(self) -> tuple[Body, tuple[Step, ...]]:
        """Rewritten assignments and the history of operation counts."""
        return rewrite(self.outputs, self.rules, self.meaning)


def _impulse_outputs(impulse: tuple[sp.Expr, sp.Expr]) -> Body:
    """P_x, P_z per unit mass and the spin that they give."""
    p_x, p_z = (part.subs(_one) for part in impulse)
    return {P_x: p_x, P_z: p_z, _spin: spin_jump(p_x, p_z).subs(_one)}


def _until(v_final: sp.Symbol, impulse: tuple[sp.Expr, sp.Expr]) -> tuple[sp.Expr, sp.Expr]:
    """An impulse under kinematic restitution, for any final normal velocity instead."""
    return tuple(part.subs(epsilon, -v_final / v_0) for part in impulse)


def _thin(expr: sp.Expr) -> sp.Expr:
    """Per length k, for positive X and Z."""
    return sp.simplify(expr.subs({X: _x * k, Z: _z * k}))


def _stronge_stick() -> sp.Expr:
    """v_f^2 of an early stop with the slopes of slipping and sticking put in."""
    slope = laws.slopes()
    known = {P_1: stop()[1].subs(_one), laws.a_1: slope["slip"], laws.a_2: slope["stick"]}
    return (laws.final_velocity("stronge", "early") ** 2).subs(known)


def _of_tilt(expr: sp.Expr) -> sp.Expr:
    return expr.subs({sp.sin(phi): _sin, sp.cos(phi): _cos})


def _grip_of(case: str) -> sp.Expr:
    """c_x/(x c_z') - z."""
    along, up = drift.stationary(case)
    return sp.simplify(_thin(along / up) / _x - _z)


_gain, _all = sp.symbols("gain inertia", real=True)
_j, _j_1, _j_2 = sp.symbols("j j_1 j_2", real=True)
_h = _name("h")

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
                v_0=_name("fall") + omega * X,
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
        summary="Impulse, spin and slip velocity after a slide, Eqs. (7)-(9), (14).",
        detail="Per unit mass. Needs N > 0 and u_0 N + (1 + epsilon) v_0 T >= 0.",
        arguments=(X, Z, k, mu, epsilon, u_0, v_0, N, T),
        outputs={
            **_impulse_outputs(slide_impulse()),
            _u_f: slide_excess().subs(_one),
        },
        rules=(
            name_responses(),
            recast(
                "one quotient",
                "impulse over k^2 is shared; no k^2 in a denominator",
                bounce=1 + epsilon,
                j=-_name("bounce") * v_0 / N,
                P_z=k**2 * _j,
                P_x=-mu * P_z,
                spin=(X + mu * Z) * _j,
                u_f=u_0 - T * _j,
            ),
        ),
        returned=("P_x", "P_z", "spin", "u_f"),
        meaning=CONTACT,
    ),
    Function(
        name="stop_velocity",
        summary="v_1, normal contact velocity when the slip stops, Eq. (15).",
        detail="Needs T > 0.",
        arguments=(u_0, v_0, N, T),
        outputs={v_1: stop()[2]},
        rules=(recast("sum", "v_0 is not multiplied and divided by T", v_1=v_0 + N * u_0 / T),),
        meaning=RESPONSES,
    ),
    Function(
        name="stick",
        summary="Impulse and spin after slip-stick that ends at v_f, Eqs. (B4), (B5).",
        detail="Per unit mass; v_f = -epsilon v_0 for Newton's law. Independent of friction.",
        arguments=(X, Z, k, u_0, v_0, v_f),
        outputs=_impulse_outputs(_until(v_f, slip_stick.impulse())),
        rules=(
            single_fraction(),
            recast(
                "gain of normal velocity",
                "v_f - v_0 is a sum of positive terms; P_z and P_x share one denominator",
                gain=v_f - v_0,
                inertia=k**2 + X**2 + Z**2,
                P_x=(X * Z * _gain - (k**2 + X**2) * u_0) / _all,
                P_z=((k**2 + Z**2) * _gain - X * Z * u_0) / _all,
                spin=(Z * u_0 + X * _gain) / _all,
            ),
        ),
    ),
    Function(
        name="reverse",
        summary="Impulse, spin and slip velocity after slip reversal to v_f, Eqs. (B8)-(B10).",
        detail="Per unit mass. Needs T > 0, T_back > 0, and so N_back > 0.",
        arguments=(X, Z, k, mu, u_0, v_1, v_f, T, N_back, T_back),
        outputs={
            **_impulse_outputs(_until(v_f, slip_reversal.impulse())),
            _u_f: _until(v_f, (slip_reversal.final_slip(),))[0].subs(_one),
        },
        rules=(
            recast(
                "two phases",
                "forward and backward impulse over k^2, both positive, added last",
                j_1=u_0 / T,
                j_2=(v_f - v_1) / N_back,
                P_x=mu * k**2 * (_j_2 - _j_1),
                P_z=k**2 * (_j_1 + _j_2),
                spin=(X + mu * Z) * _j_1 + (X - mu * Z) * _j_2,
                u_f=-T_back * _j_2,
            ),
        ),
        meaning=CONTACT,
    ),
    Function(
        name="stick_slopes",
        summary="w = a_2 P_1 and r = a_2/a_1 when the contact sticks after slipping.",
        detail="w in m/s. Needs T > 0; r only where N > 0.",
        arguments=(X, Z, k, u_0, N, T),
        outputs={
            w: laws.slopes()["stick"] * stop()[1].subs(_one),
            r: laws.slopes()["stick"] / laws.slopes()["slip"],
        },
        rules=(
            recast(
                "shared slope",
                "sums of squares",
                q=k**2 * ((k**2 + X**2 + Z**2) / (k**2 + Z**2)),
                w=_name("q") * u_0 / T,
                r=_name("q") / N,
            ),
        ),
        meaning=RESPONSES,
    ),
    Function(
        name="reverse_slopes",
        summary="w = a_2 P_1 and r = a_2/a_1 when the contact slips back.",
        detail="w in m/s. Needs T > 0 and N > 0.",
        arguments=(u_0, N, T, N_back),
        outputs={
            w: laws.slopes()["back"] * stop()[1].subs(_one),
            r: laws.slopes()["back"] / laws.slopes()["slip"],
        },
        rules=(recast("name responses", "computed once", w=N_back * u_0 / T, r=N_back / N),),
        meaning=RESPONSES,
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
        detail="v_0 < 0, v_1 <= 0, w >= 0. Two equal forms: for XZ u_0 >= 0 and for XZ u_0 < 0.",
        arguments=(X, Z, k, epsilon, u_0, v_0, v_1, w),
        outputs=dict.fromkeys((_name("square"), _name("adverse")), _stronge_stick()),
        rules=(
            recast(
                "sums of positive terms",
                "each form is one where its sign of XZ u_0 holds; the second does not feel T -> 0",
                square=epsilon**2 * (v_1**2 - w * (v_0 + v_1)),
                adverse=epsilon**2 * (v_0**2 + X * Z * u_0 / (k**2 + Z**2) * (v_0 + v_1)),
            ),
        ),
        meaning={**CONTACT, w: laws.slopes()["stick"] * stop()[1].subs(_one)},
    ),
    Function(
        name="stronge_late",
        summary="v_f^2 under Stronge's restitution; the slip stopped after compression ended.",
        detail="0 <= v_1 <= -epsilon v_0, r > 0.",
        arguments=(epsilon, v_0, v_1, r),
        outputs={_name("square"): laws.final_velocity("stronge", "late") ** 2},
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
        outputs={_name("energy"): P_x * (u_0 + _u_f) / 2 + P_z * (v_0 + v_f) / 2},
        rules=(
            recast(
                "half last",
                "one product less",
                twice=P_x * (u_0 + _u_f) + P_z * (v_0 + v_f),
                energy=_name("twice") / 2,
            ),
        ),
    ),
    Function(
        name="critical_friction",
        summary="Friction below which a stopped contact slips back, Eqs. (16), (20).",
        detail="For XZ >= 0; the sign of XZ is the side to which it slips.",
        arguments=(X, Z, k),
        outputs={mu: thin_rod.critical_friction()},
        rules=(recast("positive denominator", "no sign to lose", mu=X * Z / (k**2 + Z**2)),),
    ),
    Function(
        name="critical_tangents",
        summary="Critical tilts of a thin rod: tan(lower) = a/b and tan(upper) = b/c; Eq. (23).",
        detail="root = sqrt((3 - 4 mu)(3 + 4 mu)), mu <= 3/4.",
        arguments=(mu, _root),
        outputs={
            _name("lower"): thin_rod.critical_tangents()[0].subs(sp.sqrt(9 - 16 * mu**2), _root),
            _name("upper"): thin_rod.critical_tangents()[1].subs(sp.sqrt(9 - 16 * mu**2), _root),
        },
        rules=(
            recast(
                "conjugate root",
                "3 - root cancels for small mu; the product of both roots is 4",
                a=8 * mu,
                b=3 + _root,
                c=2 * mu,
                lower=_name("a") / _name("b"),
                upper=_name("b") / _name("c"),
            ),
        ),
        returned=("a", "b", "c"),
        unused=("lower", "upper"),
        meaning={mu: sp.sqrt(9 - _root**2) / 4},
    ),
    Function(
        name="slide_friction",
        summary="Numerator and denominator of the friction at which u_* = 0, Eq. (14).",
        detail="g = (1 + epsilon)(-c_z/c_x), omega = 0, c_x > 0.",
        arguments=(X, Z, k, _g),
        outputs={
            _name("quotient"): thin_rod.slide_friction().subs(thin_rod.ratio, _g / (1 + epsilon))
        },
        rules=(
            single_fraction(),
            recast(
                "two signs",
                "numerator and denominator decide between 0, a number and infinity",
                above=k**2 + X**2 - _g * X * Z,
                below=_g * (k**2 + Z**2) - X * Z,
                quotient=_name("above") / _name("below"),
            ),
        ),
        returned=("above", "below"),
        unused=("quotient",),
    ),
    Function(
        name="drift_grips",
        summary="What friction adds to z in the drift: while sticking, and in slip reversal.",
        detail="Lengths in units of k: x = |X|/k, z = |Z|/k. The smaller one is the right one.",
        arguments=(_x, _z, mu),
        outputs={
            _name("stick"): _grip_of("stick"),
            _name("back"): _grip_of("back"),
        },
        rules=(recast("positive", "no difference", stick=_z, back=mu * (1 + _z**2) / _x),),
    ),
    Function(
        name="drift",
        summary="Stationary (c_x, c_z')/V_z, Eqs. (24)-(30), with the grip of `drift_grips`.",
        detail="Lengths in units of k; signs of XZ and V_z are put on afterwards.",
        arguments=(_x, _z, epsilon, _grip),
        outputs={
            _name("along"): _thin(drift.stationary("back")[0] / V_z).subs(
                mu, _grip * _x / (1 + _z**2)
            ),
            _name("up"): _thin(drift.stationary("back")[1] / V_z),
        },
        rules=(
            recast(
                "divide by x",
                "x^2 cannot underflow; tilt 0 and full restitution give a signed infinity",
                lost=1 - epsilon,
                along=(1 + epsilon) * (_z + _grip) / (_name("lost") / _x + 2 * _x),
                up=(1 + epsilon) / (_name("lost") + 2 * _x**2),
            ),
        ),
    ),
    Function(
        name="energy_threshold_stick",
        summary="(1-epsilon)/(1+epsilon) below which Newton's law can create energy, slip-stick.",
        detail="Mobilities A, B, C; root_ac = sqrt(A C), root_d = sqrt(A C - B^2).",
        arguments=(laws.B, _root_ac, _root_d),
        outputs={_name("kappa"): laws.energy_threshold("stick")},
        rules=(
            recast(
                "difference of roots",
                "(a - b)^2 = B^4/(a + b)^2",
                kappa=laws.B**2 / (_root_ac + _root_d) ** 2,
            ),
        ),
        meaning={
            laws.A: _root_ac**2 / laws.C,
            laws.B: sp.sqrt(_root_ac**2 - _root_d**2),
        },
    ),
    Function(
        name="energy_threshold_back",
        summary="(1-epsilon)/(1+epsilon) below which Newton's law can create energy, reversal.",
        detail="Mobilities A, B, C; root_a = sqrt(A), root_b = sqrt(A - mu^2 C).",
        arguments=(laws.B, laws.C, mu, _root_a, _root_b),
        outputs={_name("kappa"): laws.energy_threshold("back")},
        rules=(
            recast(
                "difference of roots",
                "(a - b)^2 = mu^4 C^2/(a + b)^2",
                kappa=mu**3 * laws.C**2 / (laws.B * (_root_a + _root_b) ** 2),
            ),
        ),
        meaning={laws.A: _root_a**2, laws.C: (_root_a**2 - _root_b**2) / mu**2},
    ),
    Function(
        name="round_rod",
        summary="(X, Z) and k^2/l^2 of a solid spherocylinder.",
        detail="l overall length, d diameter, s = d/l <= 1, of a tilt given by sin and cos.",
        arguments=(length, diameter, _s, _sin, _cos),
        outputs={
            X: _of_tilt(bodies.round_contact()[0]),
            Z: _of_tilt(bodies.round_contact()[1]),
            _name("gyration"): sp.factor(
                bodies.spherocylinder_gyration().subs(diameter, _s * length) / length**2
            ),
        },
        rules=(
            recast(
                "sums of positive terms",
                "h = (l - d)/l instead of powers of d with both signs",
                axis=length - diameter,
                X=_name("axis") / 2 * _sin,
                Z=_name("axis") / 2 * _cos + diameter / 2,
                h=1 - _s,
                gyration=(_s**3 / 10 + _h * (sp.Rational(9, 32) * _s**2 + _h * (_s / 4 + _h / 8)))
                / (_s + 3 * _h / 2),
            ),
        ),
    ),
    Function(
        name="flat_rod",
        summary="(X, Z) and k^2/l^2 of a solid flat-ended cylinder on its lower edge.",
        detail="l length, d diameter, s = d/l, of a tilt >= 0 given by sin and cos.",
        arguments=(length, diameter, _s, _sin, _cos),
        outputs={
            X: _of_tilt(bodies.flat_contact()[0]),
            Z: _of_tilt(bodies.flat_contact()[1]),
            _name("gyration"): sp.expand(
                bodies.cylinder_gyration().subs(diameter, _s * length) / length**2
            ),
        },
        rules=(
            recast(
                "half last",
                "halving is exact",
                X=(length * _sin - diameter * _cos) / 2,
                Z=(length * _cos + diameter * _sin) / 2,
                weight=4 + 3 * _s**2,
                gyration=_name("weight") / 48,
            ),
        ),
    ),
)
