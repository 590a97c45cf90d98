"""Regime boundaries over tilt and friction; the thin rod of Section IV and Eq. (23)."""

import sympy as sp

from . import second_routes
from .bodies import THIN, T, over_tangent
from .equality import Pair, Residuals
from .lecture import PAPER, degrees, formula, meaning, number, so
from .newton import approach
from .proof import Equation
from .slide import slide_excess
from .slip_stick import stick_margin
from .symbols import V_z, X, Z, c_x, c_z, epsilon, k, length, mu, omega, phi, u_0, v_0
from .trace import derived, only_root, say, solve

ratio = sp.Symbol("r", positive=True)  # approach ratio -c_z/c_x, for omega = 0 and V_z = 0


@derived(r"\mu")
def critical_friction() -> sp.Expr:
    """The friction at which sticking just holds, any geometry, $XZ > 0$."""
    return only_root(stick_margin(), mu, r"The edge of (16), solved for $\mu$")


@derived(r"\mu_{slide}")
def slide_friction() -> sp.Expr:
    """The friction at which the slip just reaches the end, any geometry, with $r = -v_0/u_0$."""
    excess = slide_excess().subs(v_0, -ratio * u_0)
    say("(14) with this ratio", "u_*", excess)
    return only_root(excess, mu, r"Its numerator, solved for $\mu$")


@derived(r"\mu_{slide}")
def thin_slide_friction() -> sp.Expr:
    """That of a thin rod without spin on a plate at rest, $r = -c_z/c_x$."""
    rate = {ratio: meaning(ratio).subs(approach()).subs({omega: 0, V_z: 0})}
    return sp.factor(slide_friction().subs(rate).subs(THIN))


def _upright_friction() -> sp.Expr:
    """Friction at the edge of slide of a thin rod at tilt 0, mu_c."""
    value = sp.factor(thin_slide_friction().subs(phi, 0))
    say(r"At $\phi = 0$", r"\mu_c", value)
    return value


def _reversal() -> sp.Expr:
    """XZ - mu (k^2 + Z^2) of a thin rod, from (16), times 12/l^2."""
    first, second = k**2 + Z**2, 12 / length**2
    margin = sp.cancel(-stick_margin() * first)
    sentence = (
        f"The edge of (16), times {formula(first)}; with the lengths of a thin rod, times "
        f"{formula(second)}"
    )
    say(sentence, "0", margin)
    return sp.expand(second * margin.subs(THIN))


def _at_one_half(root: sp.Expr) -> sp.Expr:
    """Sort key of roots: their value at mu = 1/2, where both are real."""
    return root.subs(mu, sp.S.Half)


@derived(r"\tan\phi_{lower}", r"\tan\phi_{upper}")
def critical_tangents() -> Pair:
    """The edge of (16) is a quadratic in the tangent: its two roots, no squaring needed."""
    roots = solve(over_tangent(stick_margin()), T, r"Solved for $\tan\phi$")
    return tuple(sorted(roots, key=_at_one_half))


@derived(r"\phi_c")
def critical_tilt() -> sp.Expr:
    """Half of the angle of this cosine, which follows from the tangent at the lower root."""
    lower, _ = critical_tangents()
    cosine = sp.factor_terms(sp.radsimp(sp.cancel((1 - lower**2) / (1 + lower**2))))
    say("The cosine of twice the tilt, freed of the root below the line", r"\cos 2\phi", cosine)
    return sp.acos(cosine) / 2


@derived(r"\phi_c")
def small_friction(order: int) -> sp.Expr:
    """The tilt of this tangent, expanded in the friction."""
    tangent = sp.series(critical_tangents()[0], mu, 0, order).removeO()
    return sp.series(sp.atan(tangent), mu, 0, order).removeO()


@derived(r"\max_\phi \mu", r"\tan\phi")
def largest_reversal_friction() -> Pair:
    """The largest friction at which a thin rod slips back, and the tangent of its tilt."""
    mu_of = over_tangent(critical_friction())
    say("The edge of (16) as a function of the tangent", r"\mu", mu_of)
    best = only_root(mu_of.diff(T), T, "Its derivative vanishes where it is largest")
    return mu_of.subs(T, best), best


@derived(r"\phi_{max}")
def largest_reversal_tilt() -> sp.Expr:
    """The larger root is the largest tilt at which a thin rod slips back."""
    return _end_of_reversal(critical_tangents())


def _end_of_reversal(tangents: tuple[sp.Expr, ...]) -> sp.Expr:
    """Tilt at which slip reversal ends: the second critical one, or 90 degrees if there is none."""
    return sp.atan(tangents[1]) if len(tangents) > 1 else sp.pi / 2


def _last_reversal_checks(form: sp.Expr) -> Residuals:
    """Residual of the largest reversal friction: there mu (4 + T^2) = 3 T has a double root."""
    tangent = 3 / (2 * form)  # half the sum of the roots
    return [form * (4 + tangent**2) - 3 * tangent]


def _slide_boundary_checks(form: sp.Expr) -> Residuals:
    """Residual of the slide boundary: at that friction a slide leaves nothing of the slip."""
    rest = {omega: 0, V_z: 0, c_x: 1, c_z: -ratio, mu: form}
    v_x, _, spin = (part.subs(rest) for part in second_routes.impact("slide"))
    return [v_x - spin * Z]


_MU_C = -c_x / (4 * c_z * (1 + epsilon))
_FLAT = sp.pi / 2
_UPRIGHT, _OVERLOOKING = 0, sp.pi / 4  # tilts by which two mistakes come out
_ORDER = 3
_TWICE = 2  # factor by which a third one does
_THERE = {mu: sp.Rational(3, 5)}  # where (23) is said to end


EQUATIONS = (
    Equation(
        "IV: condition for phi_c",
        "edge of slip reversal for a thin rod",
        "0",
        derive=_reversal,
    ),
    Equation(
        "23: both roots",
        r"$\tan\phi$ at the lower and the upper critical tilt",
        r"(\tan\phi_{lower}, \tan\phi_{upper})",
        derive=critical_tangents,
        # sum and product of the roots of mu (4 + T^2) = 3 T
        check=lambda form: (form[0] * form[1] - 4, mu * (form[0] + form[1]) - 3),
        note=lambda: (
            f"the product of the two tangents is {sp.simplify(sp.prod(critical_tangents()))}, "
            "whatever the friction"
        ),
    ),
    Equation(
        "23",
        "critical tilt between slip-stick and slip reversal",
        derive=critical_tilt,
        note=lambda: rf"{degrees(critical_tilt().subs(PAPER), 2)} at $\mu = {number(PAPER[mu])}$",
    ),
    Equation(
        "23: small friction",
        rf"$\phi_c$ up to terms of $O(\mu^{_ORDER})$",
        derive=lambda: small_friction(_ORDER),
    ),
    Equation(
        "IV: slide boundary",
        "edge of slide, $u_* = 0$, solved for the friction, any geometry, $r = -v_0/u_0$",
        r"\mu_{slide}",
        derive=slide_friction,
        shown=(k**2 + X**2 - (1 + epsilon) * ratio * X * Z)
        / ((1 + epsilon) * ratio * (k**2 + Z**2) - X * Z),
        check=_slide_boundary_checks,
    ),
    Equation(
        "IV: mu_c",
        "largest friction of continuous slide at tilt zero",
        derive=_upright_friction,
    ),
    Equation(
        "IV: slide only below mu_c",
        f"friction up to which a thin rod slides at {degrees(_FLAT)}",
        r"[\mu_{slide}]_{\phi = \pi/2}",
        where=lambda: {r"\mu_{slide}": thin_slide_friction()},
        said=_MU_C,
        derive=lambda: sp.factor(thin_slide_friction().subs(phi, _FLAT)),
        contradicted_by=("14",),
        contradiction=lambda slip: only_root(
            slip.subs(THIN).subs({phi: _FLAT, u_0: c_x, v_0: c_z}), mu
        ),
        mistaken=lambda: thin_slide_friction().subs(phi, _UPRIGHT),
        mistake=f"the value at {degrees(_UPRIGHT)} is taken for the largest",
        note=lambda: rf"${sp.cancel(thin_slide_friction().subs(phi, _FLAT) / _MU_C)} \mu_c$",
    ),
    Equation(
        "IV: phi_c at mu = 3/5",
        "what (23) gives there",
        r"[\phi_c]_{\mu = 3/5}",
        where=lambda: {r"\phi_c": critical_tilt()},
        said=sp.pi / 2,
        derive=lambda: critical_tilt().subs(_THERE),
        contradicted_by=("23",),
        contradiction=lambda tilt: tilt.subs(_THERE),
        mistaken=lambda: _TWICE * critical_tilt().subs(_THERE),
        mistake=rf"${_TWICE} \phi_c$ is taken for $\phi_c$",
        note=lambda: rf"$\phi_c$ is {degrees(critical_tilt().subs(_THERE))} there",
    ),
    Equation(
        "IV: no reversal above 3/5",
        lambda: so(
            "largest friction of a reversal",
            over_tangent(critical_friction()),
            T,
            largest_reversal_friction()[1],
        ),
        r"\max_\phi \mu",
        said=sp.Rational(3, 5),
        derive=lambda: largest_reversal_friction()[0],
        check=_last_reversal_checks,
        contradicted_by=("IV: condition for phi_c",),
        # where the tangent is 2
        contradiction=lambda condition: only_root(over_tangent(condition).subs(T, 2), mu),
        mistaken=lambda: critical_friction().subs(THIN).subs(phi, _OVERLOOKING),
        mistake=rf"the friction whose $\phi_c$ is {degrees(_OVERLOOKING)} is taken for the largest "
        "over all tilts",
        note=lambda: (
            rf"$\mu = {largest_reversal_friction()[0]}$, at "
            rf"{degrees(sp.atan(largest_reversal_friction()[1]))}"
        ),
    ),
    Equation(
        "VI: slip-stick at any tilt",
        "the largest friction at which a thin rod slips back at some tilt, over a large friction",
        r"[\mu_{max}/\mu]_{\mu = \infty}",
        where=lambda: {r"\mu_{max}": largest_reversal_friction()[0], r"\infty": sp.oo},
        said=sp.S.Zero,
        derive=lambda: sp.limit(largest_reversal_friction()[0] / mu, mu, sp.oo),
    ),
    Equation(
        "IV: reversal at larger angles",
        "largest tilt of a reversal",
        r"\phi_{max}",
        said=sp.pi / 2,
        derive=largest_reversal_tilt,
        at={mu: PAPER[mu]},
        contradicted_by=("IV: condition for phi_c",),
        # a quadratic in the tangent
        contradiction=lambda condition: sp.atan(
            max(sp.solve(over_tangent(condition), T), key=_at_one_half)
        ),
        mistaken=lambda: _end_of_reversal(critical_tangents()[:1]),
        mistake="the second root of the condition is overlooked",
        note=lambda: (
            rf"{degrees(largest_reversal_tilt().subs(PAPER), 2)} at $\mu = {number(PAPER[mu])}$"
        ),
    ),
)
