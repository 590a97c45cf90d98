"""Beyond the paper: the best tilt of a thin rod, stability of its landing, and Painleve's paradox.

With T = tan(phi) both drifts are quotients of two quadratics in T. Below the lower critical tilt
slip-stick holds, above it slip reversal with less drift, so that the best tilt is the one of
slip-stick, the one of slip reversal, or the critical tilt between them (the corner).
"""

from collections.abc import Callable

import sympy as sp

from . import second_routes
from .bodies import T, over_tangent
from .drift import CASES, landing, landing_velocity, stationary, thin_stationary
from .equality import Pair, Residuals, Triple
from .laws import slopes
from .lecture import PAPER, degrees, formula, number, so
from .proof import Equation
from .slide import slide_excess
from .symbols import V_z, X, Z, c_x, c_z, epsilon, k, mu, u_0, v_0
from .trace import derived, only_root, solve
from .typeset import latex


@derived("c_x/V_z")
def drift_over_tangent(case: str) -> sp.Expr:
    r"""Drift of a thin rod as a function of $\tan\phi$."""
    return over_tangent(thin_stationary(case)[0] / V_z)


@derived(r"\tan\phi", "c_x/V_z")
def optimum(case: str) -> Pair:
    """Tangent of the tilt of the largest drift in one regime, and that drift over $V_z$."""
    drift = drift_over_tangent(case)
    roots = solve(sp.numer(sp.together(drift.diff(T))), T)
    at = {mu: sp.Rational(3, 10), epsilon: sp.S.Half}
    (best,) = (root for root in roots if root.subs(at).evalf() > 0)
    return best, drift.subs(T, best)


@derived(
    r"\partial c'_x/\partial c_x",
    r"\partial c'_x/\partial c_z",
    r"-\partial c'_z/\partial c_x",
    r"-\partial c'_z/\partial c_z",
)
def jacobian(case: str) -> sp.Matrix:
    """Derivatives of $(c_x', -c_z')$ by $(c_x, c_z)$: one landing of the closure's map."""
    after_x, after_z = landing(case)
    return sp.Matrix([after_x, -after_z]).jacobian([c_x, c_z]).applyfunc(sp.factor)


@derived("[1 - tr + det]_{%(case)s}", "[1 + tr + det]_{%(case)s}", "[1 - det]_{%(case)s}")
def stability_margins(case: str) -> Triple:
    """By trace and determinant of these: the landing is stable where all are positive."""
    a, b, c, d = jacobian(case)
    trace, determinant = a + d, a * d - b * c
    margins = 1 - trace + determinant, 1 + trace + determinant, 1 - determinant
    return tuple(map(sp.factor, margins))


@derived("u_{*, %(case)s}")
def slip_left(case: str) -> sp.Expr:
    """Of the stationary landing: the slip that a slide would leave, if its slip never stopped."""
    at = {u_0: stationary(case)[0], v_0: landing_velocity(case)}
    return sp.factor(slide_excess().subs(at))


@derived(r"\mu_P")
def painleve_friction() -> sp.Expr:
    """Friction at which slip towards $-x$ presses the contact into the plate, $XZ > 0$."""
    return only_root(slopes()["back"], mu)


@derived(r"\tan\phi", r"\mu_P")
def least_painleve_friction() -> Pair:
    """Tangent of the tilt at which that friction is least for a thin rod, and that friction."""
    friction = over_tangent(painleve_friction())
    best = only_root(friction.diff(T), T)
    return best, friction.subs(T, best)


def _is_largest(case: str, form: sp.Matrix) -> Residuals:
    """Residuals of a largest drift: whole impacts give it at its T, and there their slope is zero.

    No tilt gives more. Plate velocity and Z are one.
    """
    level, lengths = sp.Symbol("c"), {X: T, Z: 1, k: sp.sqrt((1 + T**2) / 3), V_z: 1}
    curve = second_routes.landing(case)[0].subs(lengths) - level
    return [part.subs({T: form[0], level: form[1]}) for part in (curve, curve.diff(T))]


def _response(case: str) -> sp.Matrix:
    """Matrix of the landing map, from whole impacts of landings a unit apart in c_x and in c_z."""
    v_x, v_z, _ = second_routes.landed(case)
    after = sp.Matrix([v_x, -v_z])
    at = {c_x: 0, c_z: 0}
    return sp.Matrix.hstack(*(after.subs({**at, x: 1}) - after.subs(at) for x in (c_x, c_z)))


def _margins(form: sp.Matrix) -> Residuals:
    """Residuals of the margins: characteristic polynomial at 1 and -1, one minus its value at 0."""
    wanted: list[sp.Expr] = []
    for case in CASES:
        polynomial = _response(case).charpoly()
        wanted += polynomial(1), polynomial(-1), 1 - polynomial(0)
    return sp.Matrix(wanted) - form


def _slide_from_the_landing(form: sp.Matrix) -> Residuals:
    """Residuals of the slip that a slide leaves, from a whole impact that starts at the landing."""
    v_x, _, spin = second_routes.landed("slide")
    left = v_x - spin * Z
    for case, value in zip(CASES, form, strict=True):
        start = dict(zip((c_x, c_z), second_routes.landing(case), strict=True))
        yield left.subs(start, simultaneous=True) - value


def _least_pressed_in(form: sp.Matrix) -> Residuals:
    """Residuals of a thin rod's least Painleve friction: a quadratic in T has a double root."""
    friction = sp.Symbol("nu")
    curve = (1 + T**2) / 3 + T * (T - friction)
    return [part.subs({T: form[0], friction: form[1]}) for part in (curve, curve.diff(T))]


_a, _b = 1 - epsilon, 7 - epsilon
ROOT = sp.sqrt(mu**2 * (9 - epsilon) ** 2 + _a * _b)


def _best_told(case: str) -> str:
    tangent, along = (part.subs(PAPER) for part in optimum(case))
    place = ", ".join(rf"${latex(x)} = {number(value)}$" for x, value in PAPER.items())
    return f"{degrees(sp.atan(tangent))} and {number(along, 3)} for the paper's {place}"


def _best(regime: str, case: str, equation: str, shown: Pair) -> Equation:
    """Entry of the best tilt in a regime, whose drift is that of a numbered equation."""
    words = rf"$\tan\phi$ of the largest drift ({equation}) of a thin rod, and it over $V_z$"
    return Equation(
        f"V: optimum, {regime}",
        lambda: so(words, drift_over_tangent(case), T, optimum(case)[0], PAPER),
        r"(\tan\phi, c_x/V_z)",
        derive=lambda: optimum(case),
        shown=shown,
        check=lambda form: _is_largest(case, form),
        note=lambda: _best_told(case),
    )


def _where_it_holds(words: str, forms: Callable[[str], sp.Matrix]) -> str:
    """Return words on the sign of forms if true in both regimes; else raise ValueError.

    A slip reverses for XZ > mu (k^2 + Z^2).
    """
    reversing = {X: mu * (k**2 + Z**2) / Z + sp.Symbol("room", positive=True)}
    so(words, forms("stick"))
    return so(f"{words} wherever the regime holds", forms("back"), reversing)


def _least_told() -> str:
    tangent, friction = least_painleve_friction()
    over = formula(over_tangent(painleve_friction()))
    return rf"${friction}$ at {degrees(sp.atan(tangent))}; at a tilt it is {over}"


EQUATIONS = (
    _best("slip-stick", "stick", "26", (sp.sqrt(_a / _b), 3 * (1 + epsilon) / sp.sqrt(_a * _b))),
    _best(
        "slip reversal",
        "back",
        "29",
        (
            _a / (mu * (9 - epsilon) + ROOT),
            (1 + epsilon) * (mu * (29 - 5 * epsilon) + 3 * ROOT) / (2 * _a * _b),
        ),
    ),
    Equation(
        "V: stability",
        (
            "stability of the stationary landing, by Jury's criterion: $1 - tr + det$, "
            r"$1 + tr + det$, $1 - det$ of the landing map $(c_x, c_z) \to (c_x', -c_z')$ in "
            "slip-stick, then in slip reversal"
        ),
        (
            "([1 - tr + det]_{stick}, [1 + tr + det]_{stick}, [1 - det]_{stick}, [1 - tr + "
            "det]_{back}, [1 + tr + det]_{back}, [1 - det]_{back})"
        ),
        derive=lambda: tuple(part for case in CASES for part in stability_margins(case)),
        check=_margins,
        note=lambda: _where_it_holds(
            "all positive", lambda case: sp.Matrix(stability_margins(case))
        ),
    ),
    Equation(
        "V: slip stops",
        "$u_*$ of the stationary landing: slip-stick, slip reversal",
        "(u_{*, stick}, u_{*, back})",
        derive=lambda: tuple(slip_left(case) for case in CASES),
        check=_slide_from_the_landing,
        note=lambda: _where_it_holds("negative", slip_left),
    ),
    Equation(
        "Painleve: friction",
        "friction from which a contact that slips towards $-x$ is pressed into the plate, $XZ > 0$",
        r"\mu_P",
        derive=painleve_friction,
        # from rest, an impulse (mu, 1) gives no normal velocity: the centre's, and X times the spin
        check=lambda form: [1 + X * (X - Z * form) / k**2],
        note=lambda: so(
            "$dv/dP_z$ is negative above it",
            slopes()["back"],
            {mu: painleve_friction() + sp.Symbol("more", positive=True)},
        ),
    ),
    Equation(
        "Painleve: thin rod",
        lambda: so(
            r"$\tan\phi$ at which that friction is least for a thin rod, and that friction",
            over_tangent(painleve_friction()),
            T,
            least_painleve_friction()[0],
        ),
        r"(\tan\phi, \mu_P)",
        derive=least_painleve_friction,
        check=_least_pressed_in,
        note=_least_told,
    ),
)
