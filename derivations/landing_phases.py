"""Beyond the paper: landing phases weighted by the flux of impacts, and V_z with them.

Rods that fall with the velocity q V_0, one after the other at equal distances, fill a strip of
height 2 pi q (in V_0 over the angular frequency) each period. The plate, at sin(theta), sweeps it
at the velocity of approach, q + cos(theta), wherever no rod has been met before: a rod lands at its
first contact. For q >= 1 rods land at every phase; q = 1 gives the paper's H. For q < 1 the plate
runs away from the rods beyond theta_0 = arccos(-q). It then is in the shadow of theta_0, where it
meets no rod, until it is back among rods that it has not met, at 2 pi + theta_s.
"""

import mpmath
import sympy as sp
from sympy.simplify.fu import TR7

from . import paper
from .axioms import after_z
from .drift import thin_stationary
from .equality import DIGITS, Pair, Residuals
from .lecture import PAPER, degrees, meaning, number
from .proof import Equation
from .symbols import V_z, epsilon, phi, theta
from .trace import derived, only_root

q = sp.Symbol("q", positive=True)  # |c_z|/V_0
theta_0, theta_s = sp.symbols("theta_0 theta_s", real=True)  # end and start of the landing phases
bounce = sp.Symbol("b", positive=True)  # c_z'/V_z by the closure


def swept(start: sp.Expr, end: sp.Expr, power: int = 0) -> sp.Expr:
    """Height of the strip that is swept between two phases, weighted with cos(theta)^power."""
    strip = sp.expand((q + sp.cos(theta)) * sp.cos(theta) ** power)
    return sp.integrate(TR7(strip), (theta, start, end))  # TR7 leaves no square of a cosine


@derived(r"h(\theta_s)")
def shadow() -> sp.Expr:
    r"""Zero at the end of the shadow: the strip swept from $\theta_s$ to $\theta_0$ is whole."""
    return swept(theta_s, theta_0) - 2 * sp.pi * q


@derived("V_z/V_0")
def mean_speed(slow: bool) -> sp.Expr:
    r"""Mean of $\cos\theta$ over the rods of a period.

    `slow` where q < 1.
    """
    start, end = (theta_s, theta_0) if slow else (-sp.pi, sp.pi)
    return sp.factor(swept(start, end, 1) / (2 * sp.pi * q))


@derived(r"H(\theta)")
def density() -> sp.Expr:
    r"""$H(\theta)$ at the phases that are met: one landing a rod."""
    return (q + sp.cos(theta)) / (2 * sp.pi * q)


@derived("V_z/V_0", "b_{min}")
def consistent_alpha() -> Pair:
    """The fall that the closure asks for, and the $b$ with which it is as fast as the plate."""
    fitting = sp.Symbol("{V_z/V_0}", positive=True)
    alpha = only_root(mean_speed(False).subs(q, bounce * fitting) - fitting, fitting)
    return alpha, only_root(bounce * alpha - 1, bounce)


@derived(r"\sin^2\phi")
def tilt_of_one_half() -> sp.Expr:
    """Of the tilt at which a thin rod lands with $V_z = V_0/2$ by the closure."""
    square = sp.Symbol(r"{\sin^2\phi}", positive=True)
    up = (thin_stationary("stick")[1] / V_z).subs(sp.sin(phi) ** 2, square)
    return only_root(up - consistent_alpha()[1], square)


def _first_contact(fall: mpmath.mpf, line: mpmath.mpf, before: mpmath.mpf) -> mpmath.mpf:
    """Phase after `before` at which a rod at line - fall theta first meets the plate, sin(theta).

    Between neighbouring turning points the gap has one sign or one root.
    """

    def gap(phase: mpmath.mpf) -> mpmath.mpf:
        return line - fall * phase - mpmath.sin(phase)

    turn = mpmath.acos(-fall)
    period = int(mpmath.floor(before / (2 * mpmath.pi))) - 1
    turns = [2 * mpmath.pi * n + x for n in range(period, period + 200) for x in (turn, -turn)]
    for after in sorted(x for x in turns if x > before):
        if gap(after) < 0:
            return mpmath.findroot(
                gap, (before, after), solver="bisect", maxsteps=300, verify=False
            )
        before = after
    raise ValueError("this rod meets no plate")


def _touched(fall: mpmath.mpf) -> tuple[mpmath.mpf, dict[sp.Symbol, mpmath.mpf]]:
    """Line of the rod that the plate just touches as it turns away, with theta_0, theta_s and q.

    The rod's height is its line less fall times theta.
    """
    end = mpmath.acos(-fall)
    line = fall * end + mpmath.sin(end)
    start = _first_contact(fall, line, end) - 2 * mpmath.pi
    return line, {theta_0: end, theta_s: start, q: fall}


def _shadow_of_a_rod(form: sp.Expr) -> Residuals:
    """Residuals of the shadow, by a rod that the plate just touches at theta_0 as it turns away.

    The plate meets this rod again at theta_s, a period later. The second residual is that of the
    formula for theta_0.
    """
    with mpmath.workdps(DIGITS + 30):
        _, phases = _touched(mpmath.mpf(3) / 5)
        return [form.subs(phases), meaning(theta_0, q).subs(phases) - phases[theta_0]]


def _rods_counted(form: sp.Expr) -> Residuals:
    """Residual, to ten digits, of the mean speed: mean of the plate's velocity at rods one by one.

    The rods are those between two that are just touched. The first contact of each is searched for
    from a height that the plate does not reach.
    """
    with mpmath.workdps(20):
        fall = mpmath.mpf(1) / 5
        line, phases = _touched(fall)

        def met(height: mpmath.mpf) -> mpmath.mpf:
            return mpmath.cos(_first_contact(fall, height, (height - 1) / fall - mpmath.pi))

        strip = 2 * mpmath.pi * fall
        counted = mpmath.quad(met, [line, line + strip]) / strip
        residual = form.subs(phases) - counted
    return [0 if abs(residual) < 1e-10 else residual]


def _fast_quadrature(form: sp.Expr) -> Residuals:
    """Residual of the mean speed for rods that fall faster than the plate, by quadrature."""
    with mpmath.workdps(DIGITS + 30):
        speed = mpmath.mpf("1.7")

        def moment(n: int) -> mpmath.mpf:
            return mpmath.quad(
                lambda x: (speed + mpmath.cos(x)) * mpmath.cos(x) ** n, [0, mpmath.pi]
            )

        return [form.subs(q, sp.Rational(17, 10)) - moment(1) / moment(0)]


def _consistent_checks(form: sp.Matrix) -> Residuals:
    """Residuals: a fall of b alpha V_0 gives the mean alpha; at the least b that fall is V_0."""
    alpha, least = form
    fall = bounce * alpha
    mean = sp.integrate(density().subs(q, fall) * sp.cos(theta), (theta, 0, 2 * sp.pi))
    return [mean - alpha, fall.subs(bounce, least) - 1]


def _fall_of_the_paper() -> sp.Expr:
    difference = density() - paper.printed("V: H(theta)")
    (fall,) = sp.solve(difference.subs(theta, 0), q)
    if sp.simplify(difference.subs(q, fall)) != 0:
        raise ValueError("it is of no fall speed")
    return fall


def _closure_told() -> str:
    upright = meaning(bounce).subs(after_z, thin_stationary("stick")[1]).subs(phi, 0).subs(PAPER)
    alpha = consistent_alpha()[0]
    half = sp.S.Half
    return (
        f"{half} where $b = {only_root(alpha - half, bounce)}$; "
        f"{number(alpha.subs(bounce, upright))} for upright rods and the paper's restitution, "
        f"{number(PAPER[epsilon])}"
    )


EQUATIONS = (
    Equation(
        "V: flux of impacts",
        "density of landing phases in proportion to the velocity of approach, "
        "$q = |c_z|/V_0$, at the phases that are met",
        r"H(\theta)",
        derive=density,
        # normalised and even, with a first harmonic alone; the values at 0 and pi are in proportion
        # to the velocities of approach there
        check=lambda form: [
            sp.integrate(form, (theta, 0, 2 * sp.pi)) - 1,
            form.diff(theta, 3) + form.diff(theta),
            form.diff(theta).subs(theta, 0),
            form.subs(theta, sp.pi) * (q + 1) - form.subs(theta, 0) * (q - 1),
        ],
        note=lambda: f"the paper's $H$ is the one of $q = {_fall_of_the_paper()}$",
    ),
    Equation(
        "V: alpha by flux",
        r"$V_z/V_0$ with that density, $q \ge 1$",
        "V_z/V_0",
        derive=lambda: mean_speed(False),
        check=_fast_quadrature,
    ),
    Equation(
        "V: shadow",
        "height of the strip swept, less that of a period's rods: zero at the shadow's end, "
        "$q < 1$",
        r"h(\theta_s)",
        derive=shadow,
        shown=sp.sin(theta_0) - sp.sin(theta_s) - q * (2 * sp.pi + theta_s - theta_0),
        check=_shadow_of_a_rod,
    ),
    Equation(
        "V: alpha by flux, slow",
        "$V_z/V_0$ of first contacts, $q < 1$",
        "V_z/V_0",
        derive=lambda: mean_speed(True),
        check=_rods_counted,
    ),
    Equation(
        "V: alpha and closure",
        "$V_z/V_0$ if the rod falls as fast as the closure has it rise, $q = b V_z/V_0$ "
        "with $b = c'_z/V_z$; and the smallest $b$ for which it holds, with $q \\ge 1$",
        "(V_z/V_0, b_{min})",
        derive=consistent_alpha,
        check=_consistent_checks,
        note=_closure_told,
    ),
    Equation(
        "V: tilt of one half",
        rf"$\sin^2\phi$ of a thin rod at which ${paper.EQUATIONS['31: value'].tex}$ is consistent "
        "with the closure",
        r"\sin^2\phi",
        derive=tilt_of_one_half,
        # the rod leaves and lands as fast as the plate moves: there c_z' = V_0 = 2 V_z by (30)
        check=lambda form: [(1 + epsilon) / (1 - epsilon + 6 * form) - 2],
        note=lambda: (
            f"{degrees(sp.asin(sp.sqrt(tilt_of_one_half().subs(PAPER))))} for the paper's "
            f"restitution, {number(PAPER[epsilon])}"
        ),
    ),
)
