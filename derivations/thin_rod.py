"""Regime boundaries over tilt and friction; the thin rod of Section IV and Eq. (23)."""

from functools import cache

import sympy as sp

from .bodies import THIN
from .newton import approach
from .proof import Equation
from .slide import slide_excess
from .slip_stick import stick_margin
from .symbols import V_z, X, Z, c_x, c_z, epsilon, k, mu, omega, phi, u_0, v_0

ratio = sp.Symbol("r", positive=True)  # approach ratio -c_z/c_x, for omega = 0 and V_z = 0


@cache
def critical_friction() -> sp.Expr:
    """Friction at which stick turns into reversal, any geometry, XZ > 0."""
    (value,) = sp.solve(stick_margin(), mu)
    return value


@cache
def slide_friction() -> sp.Expr:
    """Friction at which u_* = 0, any geometry; the approach ratio is r = -v_0/u_0."""
    numerator = sp.numer(sp.together(slide_excess().subs({u_0: 1, v_0: -ratio})))
    (value,) = sp.solve(numerator, mu)
    return sp.factor(value)


@cache
def thin_slide_friction() -> sp.Expr:
    """u_* = 0 solved for mu: a thin rod without spin on a plate at rest."""
    rate = {ratio: (-v_0 / u_0).subs(approach()).subs({omega: 0, V_z: 0})}
    return slide_friction().subs(rate).subs(THIN)


@cache
def critical_cosines() -> tuple[sp.Expr, sp.Expr]:
    """cos(2 phi) at the two critical tilts (lower, upper), from the squared condition."""
    double = sp.Symbol("C")
    sine_squared, cosine_squared = (1 - double) / 2, (1 + double) / 2
    condition = sp.numer(sp.together(stick_margin().subs(THIN)))  # a mu + b sin cos, a by cos^2
    parts = sp.collect(sp.expand(condition), mu, evaluate=False)
    slope = parts[mu].subs(sp.cos(phi) ** 2, cosine_squared)
    product = parts[sp.S.One]
    factor = product / (sp.sin(phi) * sp.cos(phi))
    squared = mu**2 * slope**2 - factor**2 * sine_squared * cosine_squared
    roots = sp.solve(squared, double)
    return tuple(sorted(roots, key=lambda r: -r.subs(mu, sp.Rational(1, 2))))


@cache
def critical_tangents() -> tuple[sp.Expr, sp.Expr]:
    """tan(phi) at the two critical tilts: roots of a quadratic, no squaring needed."""
    tangent = sp.Symbol("T", positive=True)
    condition = stick_margin().subs(THIN).subs(sp.sin(phi), tangent * sp.cos(phi))
    condition = condition.subs(sp.cos(phi), 1 / sp.sqrt(1 + tangent**2))
    roots = sp.solve(sp.numer(sp.together(sp.simplify(condition))), tangent)
    return tuple(sorted(roots, key=lambda r: r.subs(mu, sp.Rational(1, 2))))


def critical_tilt() -> sp.Expr:
    """phi_c of Eq. (23): the smaller of the two."""
    return sp.acos(critical_cosines()[0]) / 2


@cache
def largest_reversal_friction() -> tuple[sp.Expr, sp.Expr]:
    """Largest friction at which a thin rod reverses, and the tangent of its tilt."""
    tangent = sp.Symbol("T", positive=True)
    mu_of = critical_friction().subs(THIN).subs(sp.sin(phi), tangent * sp.cos(phi))
    mu_of = sp.simplify(mu_of.subs(sp.cos(phi), 1 / sp.sqrt(1 + tangent**2)))
    (best,) = sp.solve(mu_of.diff(tangent), tangent)
    return mu_of.subs(tangent, best), best


def _rationalised(expr: sp.Expr) -> sp.Expr:
    """Replace sqrt(9 - 16 mu^2) by a fraction in w, with mu = 3 w/(2 (1 + w^2))."""
    w = sp.Symbol("w", positive=True)
    root = sp.sqrt(9 - 16 * mu**2)
    return expr.subs(root, 3 * (1 - w**2) / (1 + w**2)).subs(mu, 3 * w / (2 * (1 + w**2)))


def _root_checks() -> list[sp.Expr]:
    """Tangents solve the condition; they give the cosines; their product is 4."""
    lower, upper = critical_tangents()
    checks = [_rationalised(lower * upper) - 4]
    for tangent, cosine in zip(critical_tangents(), critical_cosines(), strict=True):
        checks.append(_rationalised(mu * (1 + tangent**2) + 3 * mu - 3 * tangent))
        checks.append(_rationalised(sp.expand(cosine) * (1 + tangent**2) - (1 - tangent**2)))
    return checks


_printed_23 = sp.acos((sp.sqrt(9 - 16 * mu**2) - 5 * mu**2) / (3 * (1 + mu**2))) / 2
_mu_c = -c_x / (4 * c_z * (1 + epsilon))
_reversal = sp.Lt(mu * (1 + 3 * sp.cos(phi) ** 2), 3 * sp.sin(phi) * sp.cos(phi))

EQUATIONS = (
    Equation(
        tag="IV: mu_c",
        what="largest friction of continuous slide at small tilt",
        symbol="\\mu_c",
        printed=_mu_c,
        derive=lambda: sp.factor(thin_slide_friction().subs(phi, 0)),
        note="the limit of tilt 0",
    ),
    Equation(
        tag="IV: slide only below mu_c",
        what=r'"sliding can only be observed for small $\mu < \mu_c$": largest friction over all '
        "tilts",
        symbol="\\max_\\phi \\mu_{slide}",
        printed=_mu_c,
        derive=lambda: sp.factor(thin_slide_friction().subs(phi, sp.pi / 2)),
        verdict="erratum",
        contradicted_by="(14) for a thin rod at 90 degrees",
        contradiction=lambda: sp.solve(
            (u_0 + mu * k**2 / (k**2 + X**2) * v_0 * (1 + epsilon))
            .subs(THIN)
            .subs({phi: sp.pi / 2, u_0: c_x, v_0: c_z}),
            mu,
        )[0],
        note=r"near 90 degrees the rod slides up to $16 \mu_c$",
    ),
    Equation(
        tag="IV: condition for phi_c",
        what="condition of slip reversal for a thin rod",
        symbol="3\\sin\\phi\\cos\\phi - \\mu(1+3\\cos^2\\phi)",
        printed=_reversal,
        derive=lambda: sp.Lt(stick_margin().subs(THIN), 0),
    ),
    Equation(
        tag="23",
        what="critical tilt between slip-stick and slip reversal",
        symbol="\\phi_c",
        printed=_printed_23,
        derive=critical_tilt,
        note="one of two roots: beyond the larger one the contact sticks again",
    ),
    Equation(
        tag="23: both roots",
        what=r"$\tan(\phi)$ at the lower and the upper critical tilt",
        symbol="\\tan\\phi_c",
        derive=lambda: sp.Matrix(critical_tangents()),
        check=_root_checks,
        verdict="new",
        note="the product of the two tangents is 4, whatever the friction",
    ),
    Equation(
        tag="23: small friction",
        what=r"$\phi_c$ to $O(\mu^3)$",
        symbol="\\phi_c",
        printed=sp.Rational(4, 3) * mu,
        derive=lambda: sp.series(sp.atan(critical_tangents()[0]), mu, 0, 3).removeO(),
    ),
    Equation(
        tag="23: next order",
        what=r"$\phi_c$ to $O(\mu^5)$",
        symbol="\\phi_c",
        derive=lambda: sp.series(sp.atan(critical_tangents()[0]), mu, 0, 5).removeO(),
        check=lambda: (
            sp.series(
                3 * sp.tan(_series := sp.Rational(4, 3) * mu - _cubic() * mu**3)
                - mu * (4 + sp.tan(_series) ** 2),
                mu,
                0,
                5,
            ).removeO(),
        ),
        verdict="new",
    ),
    Equation(
        tag="IV: phi_c at mu = 3/5",
        what=r'"becomes $\pi/2$ at $\mu = 3/5$"',
        symbol="\\phi_c(3/5)",
        printed=sp.pi / 2,
        derive=lambda: critical_tilt().subs(mu, sp.Rational(3, 5)),
        verdict="erratum",
        contradicted_by="(23)",
        contradiction=lambda: _printed_23.subs(mu, sp.Rational(3, 5)),
        note=r"it is $2 \phi_c$ that becomes $\pi/2$ there; $\phi_c$ is 45 degrees",
    ),
    Equation(
        tag="IV: no reversal above 3/5",
        what=r'"at larger $\mu$, the slip-reversal scenario does not occur at any tilt angle"',
        symbol="\\max_\\phi \\mu_{reversal}",
        printed=sp.Rational(3, 5),
        derive=lambda: largest_reversal_friction()[0],
        verdict="erratum",
        contradicted_by=r"condition for $\phi_c$ at $\tan(\phi) = 2$",
        contradiction=lambda: sp.solve(
            (_reversal.gts - _reversal.lts)
            .subs({sp.sin(phi): 2 * sp.cos(phi)})
            .subs(sp.cos(phi), 1 / sp.sqrt(5)),
            mu,
        )[0],
        note=r"reversal ends at $\mu = 3/4$, where both critical tilts meet at $\arctan 2$ = 63.4 "
        "degrees",
    ),
    Equation(
        tag="IV: reversal at larger angles",
        what='"at larger angles there is the slip reversal regime": largest tilt of reversal',
        symbol="\\phi_{max}",
        printed=sp.pi / 2,
        derive=lambda: sp.atan(critical_tangents()[1]),
        at={mu: sp.Rational(3, 10)},
        verdict="erratum",
        contradicted_by=r"condition for $\phi_c$ at 90 degrees, where it fails for every $\mu > 0$",
        note="beyond the second root of the same condition the contact sticks again (84.04 degrees "
        r"at $\mu = 0.3$, the friction of Fig. 11); Section V repeats it as $\phi > \phi_c$",
    ),
    Equation(
        tag="IV: slide boundary",
        what="$u_* = 0$ solved for the friction, any geometry, $r = -v_0/u_0$",
        symbol="\\mu_{slide}",
        derive=slide_friction,
        shown=(k**2 + X**2 - (1 + epsilon) * ratio * X * Z)
        / ((1 + epsilon) * ratio * (k**2 + Z**2) - X * Z),
        check=lambda: (slide_excess().subs(mu, slide_friction()).subs({u_0: 1, v_0: -ratio}),),
        verdict="new",
    ),
)


def _cubic() -> sp.Expr:
    """Coefficient of -mu^3 in phi_c."""
    series = sp.series(sp.atan(critical_tangents()[0]), mu, 0, 4).removeO()
    return -series.coeff(mu, 3)
