"""Stationary translation of bouncing rods, Section V, Eqs. (24)-(31)."""

import sympy as sp

from . import paper, second_routes, slide, slip_reversal, slip_stick
from .axioms import CLOSURE, LANDING_PHASES, after_x, after_z
from .bodies import THIN, T, over_tangent
from .equality import NamedForms, Pair, Residuals
from .lecture import PAPER, degrees, number, so
from .newton import g, velocity_change
from .proof import Equation
from .symbols import (
    V_0,
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
    theta,
)
from .trace import derived, only_root, say, solve
from .typeset import latex

CASES = "stick", "back"
_IMPULSES = {"slide": slide.impulse, "stick": slip_stick.impulse, "back": slip_reversal.impulse}


@derived("c'_x", "c'_z")
def landing(case: str) -> Pair:
    r"""The velocity after a landing without spin: $\omega = 0$ put in."""
    after = slide.cm_velocity(*_IMPULSES[case]())
    spin = only_root(CLOSURE({})[0], omega, "The closure has no spin")
    return tuple(c.subs(omega, spin) for c in after)


@derived("c'_x", "c'_z")
def stationary(case: str) -> Pair:
    """The landing that repeats itself."""
    after = dict(zip((after_x, after_z), landing(case), strict=True))
    closure = CLOSURE({})
    _, along, across = closure.subs(after)
    before_x, before_z = solve(
        [along, across],
        [c_x, c_z],
        f"The closure, ${' = '.join(map(latex, closure[1:]))} = 0$, with this velocity, "
        "cleared of denominators; two linear equations, solved for $c_x$ and $c_z$",
    )
    return sp.factor(before_x), sp.factor(-before_z)


@derived("c'_x", "c'_z")
def thin_stationary(case: str) -> Pair:
    """The stationary landing of a thin rod: its lengths put in."""
    return tuple(sp.factor(part.subs(THIN)) for part in stationary(case))


@derived("v_0")
def landing_velocity(case: str) -> sp.Expr:
    """The contact velocity before the stationary landing, $c_z - V_z$ without spin."""
    return sp.factor(-stationary(case)[1] - V_z)


@derived("c'_z - V_z")
def centre_excess() -> sp.Expr:
    """By what the centre leaves faster than the plate."""
    return sp.factor(stationary("stick")[1] - V_z)


def _drifts() -> NamedForms:
    """Drifts of both regimes, by left sides with the numbers of their equations, (24) and (27)."""
    return {"c'_x(24)": stationary("stick")[0], "c'_x(27)": stationary("back")[0]}


@derived("W/(m g s)")
def cost_of_transport() -> sp.Expr:
    """Work of the plate, $P_z V_z$, per weight and distance of the flight that follows."""
    p_z = sp.Symbol("p_z")
    up = only_root(CLOSURE({})[2], after_z)
    impulse = only_root(c_z + velocity_change(p_z, "dc_z") - up, p_z)
    flight = 2 * up / g
    say("The flight lasts", "t", flight)
    return impulse * V_z / (m * g * c_x * flight)


@derived("c'_x - c_x")
def slide_loss() -> sp.Expr:
    """Change of $c_x$ in a slide without spin."""
    return sp.factor(landing("slide")[0] - c_x)


@derived("V_z")
def plate_velocity() -> sp.Expr:
    """The mean of the plate's velocity over the density of landing phases."""
    mean = sp.Integral(V_0 * sp.cos(theta) * LANDING_PHASES({}), (theta, 0, 2 * sp.pi))
    say("The integral", "V_z", mean)
    return mean.doit()


# ---- second routes ----------------------------------------------------------------------------


def _balance_of_impulses(form: sp.Expr) -> Residuals:
    """Residual of (27) over (24) at mu -> 0, from a balance of tangential impulses.

    In the stationary landing friction forward and backward cancel, under a total normal impulse p
    that is equal in both regimes. In slip reversal without much friction the slip then stops at
    p/2. Sticking takes the whole tangential impulse back, so that the slip stops at p s/(mu + s),
    where s = XZ/(k^2 + Z^2). Per unit of normal impulse up to the stop, the slip loses
    (XZ + mu (k^2 + Z^2))/(m k^2).
    """
    s = X * Z / (k**2 + Z**2)
    lost = X * Z + mu * (k**2 + Z**2)
    back, stick = sp.S.Half * lost.subs(mu, 0), s / (mu + s) * lost
    return [form - back / stick]


def _again_told() -> str:
    """Note on the tilt above which the centre of a thin rod leaves more slowly than the plate."""
    excess = over_tangent(centre_excess() / V_z).subs(PAPER)
    (level,) = sp.solve(excess, T)
    return so(
        f"it leaves more slowly above {degrees(sp.atan(level))}, for a thin rod and the paper's "
        f"restitution, {number(PAPER[epsilon])}",
        -excess,
        T,
        level,
    )


EQUATIONS = (
    Equation(
        "V: no slide",
        "change of $c_x$ in a slide",
        "c'_x - c_x",
        derive=slide_loss,
        check=lambda form: (second_routes.landed("slide")[0] - c_x - form,),
        note=lambda: so(
            "negative for every friction above zero ($v_0 < 0$)",
            slide_loss().subs({c_z: V_z - 1, X: 0}),  # v_0 = -1
        ),
    ),
    Equation("24", "drift in slip-stick", derive=lambda: stationary("stick")[0]),
    Equation("25", "vertical velocity in slip-stick", derive=lambda: stationary("stick")[1]),
    Equation("26", "drift of a thin rod in slip-stick", derive=lambda: thin_stationary("stick")[0]),
    Equation("27", "drift in slip reversal", derive=lambda: stationary("back")[0]),
    Equation("28", "vertical velocity in slip reversal", derive=lambda: stationary("back")[1]),
    Equation(
        "V: continuity",
        r"(27) less (24) at the edge between them",
        r"[c'_x(27) - c'_x(24)]_{\mu = XZ/(k^2 + Z^2)}",
        where=_drifts,
        said=sp.S.Zero,
        derive=lambda: sp.cancel(
            (stationary("back")[0] - stationary("stick")[0]).subs(
                mu, only_root(paper.printed("V: continuity"), mu)
            )
        ),
    ),
    Equation(
        "29",
        "drift of a thin rod in slip reversal",
        derive=lambda: thin_stationary("back")[0],
    ),
    Equation(
        "30",
        "vertical velocity of a thin rod, slip-stick and slip reversal",
        formulas=("30", "30"),
        derive=lambda: tuple(thin_stationary(case)[1] for case in CASES),
    ),
    Equation(
        "V: H(theta), normalised",
        "the approximate density of landing phases is normalised",
        r"\int_0^{2\pi} H(\theta) d\theta",
        where=lambda: {r"H(\theta)": LANDING_PHASES({})},
        said=sp.S.One,
        derive=lambda: sp.integrate(LANDING_PHASES({}), (theta, 0, 2 * sp.pi)),
    ),
    Equation("31", "mean plate velocity at landing", derive=plate_velocity),
    Equation("31: value", "the same, integrated", derive=plate_velocity),
)

BEYOND = (
    Equation(
        "V: hit again at once",
        "by what the centre leaves faster than the plate in the stationary landing",
        "c'_z - V_z",
        derive=centre_excess,
        # from whole impacts, in both regimes; c_z before the landing is -c_z' after it
        check=lambda form: [second_routes.landing(case)[1] + form + V_z for case in CASES],
        note=_again_told,
    ),
    Equation(
        "V: friction to zero",
        r"(27) at $\mu \to 0$ over (24)",
        r"[c'_x(27)/c'_x(24)]_{\mu = 0}",
        where=_drifts,
        derive=lambda: stationary("back")[0].subs(mu, 0) / stationary("stick")[0],
        check=_balance_of_impulses,
    ),
    Equation(
        "V: cost of transport",
        "work of the plate per weight and distance travelled",
        "W/(m g s)",
        derive=cost_of_transport,
        # per time the plate carries the weight at its velocity, and the rod travels c_x
        check=lambda form: (form * c_x - V_z,),
    ),
)
