"""Regime boundaries over tilt and friction; the thin rod of Section IV and Eq. (23)."""

import sympy as sp

from . import second_routes
from .bodies import TANGENT, THIN, T, over_tangent
from .newton import approach
from .proof import Equation, Repair
from .slide import slide_excess
from .slip_stick import stick_margin
from .symbols import V_z, X, Z, c_x, c_z, epsilon, k, mu, omega, phi, u_0, v_0
from .trace import derived, solve

gain = sp.Symbol("g", positive=True)  # (1 + epsilon) ratio
ratio = sp.Symbol("r", positive=True)  # approach ratio -c_z/c_x, for omega = 0 and V_z = 0


@derived
def critical_friction() -> sp.Expr:
    """Friction at which stick turns into reversal, any geometry, XZ > 0."""
    (value,) = solve(stick_margin(), mu)
    return value


@derived
def slide_friction() -> sp.Expr:
    """Friction at which u_* = 0, any geometry; the approach ratio is r = -v_0/u_0."""
    numerator = sp.numer(sp.together(slide_excess().subs({u_0: 1, v_0: -ratio})))
    (value,) = solve(numerator, mu)
    return sp.factor(value)


@derived
def thin_slide_friction() -> sp.Expr:
    """u_* = 0 solved for mu: a thin rod without spin on a plate at rest."""
    rate = {ratio: (-v_0 / u_0).subs(approach()).subs({omega: 0, V_z: 0})}
    return slide_friction().subs(rate).subs(THIN)


@derived
def critical_cosines() -> tuple[sp.Expr, sp.Expr]:
    """cos(2 phi) at the two critical tilts (lower, upper), from the squared condition."""
    double = sp.Symbol(r"{\cos 2\phi}")
    sine_squared, cosine_squared = (1 - double) / 2, (1 + double) / 2
    condition = sp.numer(sp.together(stick_margin().subs(THIN)))  # a mu + b sin cos, a by cos^2
    parts = sp.collect(sp.expand(condition), mu, evaluate=False)
    slope = parts[mu].subs(sp.cos(phi) ** 2, cosine_squared)
    product = parts[sp.S.One]
    factor = product / (sp.sin(phi) * sp.cos(phi))
    squared = mu**2 * slope**2 - factor**2 * sine_squared * cosine_squared
    roots = solve(squared, double)
    return tuple(sorted(roots, key=lambda r: -r.subs(mu, sp.Rational(1, 2))))


@derived
def critical_tangents() -> tuple[sp.Expr, sp.Expr]:
    """tan(phi) at the two critical tilts: roots of a quadratic, no squaring needed."""
    roots = solve(sp.numer(sp.together(over_tangent(stick_margin()))), T, TANGENT)
    return tuple(sorted(roots, key=lambda r: r.subs(mu, sp.Rational(1, 2))))


@derived
def critical_tilt() -> sp.Expr:
    """phi_c, the lower critical tilt, (23)."""
    return sp.acos(critical_cosines()[0]) / 2


@derived
def largest_reversal_friction() -> tuple[sp.Expr, sp.Expr]:
    """Largest friction at which a thin rod reverses, and the tangent of its tilt."""
    mu_of = over_tangent(critical_friction())
    (best,) = solve(mu_of.diff(T), T, TANGENT)
    return mu_of.subs(T, best), best


def _rationalised(expr: sp.Expr) -> sp.Expr:
    """Replace sqrt(9 - 16 mu^2) by a fraction in w, with mu = 3 w/(2 (1 + w^2))."""
    w = sp.Symbol("w", positive=True)
    root = sp.sqrt(9 - 16 * mu**2)
    return expr.subs(root, 3 * (1 - w**2) / (1 + w**2)).subs(mu, 3 * w / (2 * (1 + w**2)))


@derived
def largest_reversal_tilt() -> sp.Expr:
    """Largest tilt at which a thin rod reverses."""
    return _end_of_reversal(critical_tangents())


def _end_of_reversal(tangents: tuple[sp.Expr, ...]) -> sp.Expr:
    """Where reversal, begun at the first critical tilt, ends: at the next, or at 90 degrees."""
    return sp.atan(tangents[1]) if len(tangents) > 1 else sp.pi / 2


def overlooking_the_second_root() -> sp.Expr:
    """Largest tilt of reversal, computed with the first critical tilt alone."""
    return _end_of_reversal(critical_tangents()[:1])


@derived
def largest_slide_friction() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Tangent of the inner tilt of largest slide friction, the friction there, and at 90 degrees.

    g = (1 + epsilon)(-c_z/c_x); in T = tan(phi) the friction is a quotient of two quadratics.
    """
    mu_of = over_tangent(thin_slide_friction().subs(c_x, -(1 + epsilon) * c_z / gain))
    mu_of = sp.factor(mu_of)
    extrema = solve(sp.numer(sp.together(mu_of.diff(T))), T, TANGENT)
    (inner,) = (x for x in extrema if mu_of.diff(T, 2).subs(T, x).subs(gain, 1) < 0)
    return inner, sp.factor(mu_of.subs(T, inner)), sp.limit(mu_of, T, sp.oo)


def _slide_friction_checks(form: sp.Matrix) -> list[sp.Expr]:
    """u_* = 0 as a quadratic in T: one double root at the largest friction, none beyond it."""
    friction = sp.Symbol("nu", positive=True)
    lengths = {X: T, Z: 1, k: sp.sqrt((1 + T**2) / 3), omega: 0, V_z: 0, epsilon: 0}
    speed = {c_x: 1, c_z: -gain, mu: friction}
    v_x, _, spin = (part.subs(lengths).subs(speed) for part in second_routes.impact("slide"))
    curve = sp.Poly(sp.numer(sp.cancel(v_x - spin)), T)
    at_most = curve.as_expr().subs(friction, form[1])
    return [
        sp.discriminant(curve.as_expr(), T).subs(friction, form[1]),
        at_most.subs(T, form[0]),
        at_most.diff(T).subs(T, form[0]),
        curve.LC().subs(friction, form[2]),
    ]


def _root_checks(form: sp.Matrix) -> list[sp.Expr]:
    """Sum and product of the roots of the condition; each gives the cosine of its tilt."""
    lower, upper = form
    checks = [_rationalised(lower * upper) - 4, _rationalised(mu * (lower + upper)) - 3]
    for tangent, cosine in zip(form, critical_cosines(), strict=True):
        checks.append(_rationalised(sp.expand(cosine) * (1 + tangent**2) - (1 - tangent**2)))
    return checks


def _last_reversal_checks(form: sp.Expr) -> list[sp.Expr]:
    """There both critical tilts are one: a double root of mu (4 + T^2) = 3 T."""
    tangent = largest_reversal_friction()[1]
    return [form * (4 + tangent**2) - 3 * tangent, 2 * form * tangent - 3]


def _slide_boundary_checks(form: sp.Expr) -> list[sp.Expr]:
    """At that friction nothing is left of the slip."""
    rest = {omega: 0, V_z: 0, c_x: 1, c_z: -ratio, mu: form}
    v_x, _, spin = (part.subs(rest) for part in second_routes.impact("slide"))
    return [v_x - spin * Z]


def printed_upper_tilt() -> sp.Expr:
    """Largest tilt of the printed condition, which is a quadratic in the tangent."""
    quadratic = 3 * T - mu * (1 + T**2 + 3)  # over cos^2
    return sp.atan(max(sp.solve(quadratic, T), key=lambda r: r.subs(mu, sp.Rational(1, 2))))


_printed_23 = sp.acos((sp.sqrt(9 - 16 * mu**2) - 5 * mu**2) / (3 * (1 + mu**2))) / 2
_mu_c = -c_x / (4 * c_z * (1 + epsilon))
_reversal = sp.Lt(mu * (1 + 3 * sp.cos(phi) ** 2), 3 * sp.sin(phi) * sp.cos(phi))

EQUATIONS = (
    Equation.read(
        "IV: mu_c", printed=_mu_c, derive=lambda: sp.factor(thin_slide_friction().subs(phi, 0))
    ),
    Equation.read(
        "IV: slide only below mu_c",
        printed=_mu_c,
        derive=lambda: sp.factor(thin_slide_friction().subs(phi, sp.pi / 2)),
        contradiction=lambda: sp.solve(
            (u_0 + mu * k**2 / (k**2 + X**2) * v_0 * (1 + epsilon))
            .subs(THIN)
            .subs({phi: sp.pi / 2, u_0: c_x, v_0: c_z}),
            mu,
        )[0],
        mistaken=lambda: thin_slide_friction().subs(phi, 0),
    ),
    Equation.read(
        "IV: largest slide friction",
        derive=largest_slide_friction,
        shown=((1 + 2 * gain) / (2 - gain), (4 + 3 * gain) / (4 * gain - 3), 4 / gain),
        check=_slide_friction_checks,
    ),
    Equation.read(
        "IV: condition for phi_c",
        printed=_reversal,
        derive=lambda: sp.Lt(stick_margin().subs(THIN), 0),
    ),
    Equation.read("23", printed=_printed_23, derive=critical_tilt),
    Equation.read("23: both roots", derive=critical_tangents, check=_root_checks),
    Equation.read(
        "23: small friction",
        printed=sp.Rational(4, 3) * mu,
        derive=lambda: sp.series(sp.atan(critical_tangents()[0]), mu, 0, 3).removeO(),
    ),
    Equation.read(
        "23: next order",
        derive=lambda: sp.series(sp.atan(critical_tangents()[0]), mu, 0, 5).removeO(),
        check=lambda form: (
            sp.series(3 * sp.tan(form) - mu * (4 + sp.tan(form) ** 2), mu, 0, 5).removeO(),
        ),
    ),
    Equation.read(
        "IV: phi_c at mu = 3/5",
        printed=sp.pi / 2,
        derive=lambda: critical_tilt().subs(mu, sp.Rational(3, 5)),
        contradiction=lambda: _printed_23.subs(mu, sp.Rational(3, 5)),
        repair=(Repair(r"$2 \phi_c$ is meant: a factor 1/2", sp.pi / 2, sp.pi / 4),),
    ),
    Equation.read(
        "IV: no reversal above 3/5",
        printed=sp.Rational(3, 5),
        derive=lambda: largest_reversal_friction()[0],
        check=_last_reversal_checks,
        contradiction=lambda: sp.solve(
            (_reversal.gts - _reversal.lts)
            .subs({sp.sin(phi): 2 * sp.cos(phi)})
            .subs(sp.cos(phi), 1 / sp.sqrt(5)),
            mu,
        )[0],
        mistaken=lambda: critical_friction().subs(THIN).subs(phi, sp.pi / 4),
    ),
    Equation.read(
        "VI: slip-stick at any tilt",
        printed=sp.S.One,
        derive=lambda: sp.sign(sp.limit(mu - largest_reversal_friction()[0], mu, sp.oo)),
    ),
    Equation.read(
        "IV: reversal at larger angles",
        printed=sp.pi / 2,
        derive=largest_reversal_tilt,
        at={mu: sp.Rational(3, 10)},
        contradiction=printed_upper_tilt,
        mistaken=overlooking_the_second_root,
    ),
    Equation.read(
        "IV: slide boundary",
        derive=slide_friction,
        shown=(k**2 + X**2 - (1 + epsilon) * ratio * X * Z)
        / ((1 + epsilon) * ratio * (k**2 + Z**2) - X * Z),
        check=_slide_boundary_checks,
    ),
)
