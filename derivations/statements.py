"""Sentences of the text that state a number, a sign or an order, and are wrong.

What a sentence says and what is true are computed as two values of one quantity where there is
something to compute (`EQUATIONS`). Where two places of the text differ, it is a `Reading`.
"""

from collections.abc import Callable
from dataclasses import dataclass

import mpmath
import sympy as sp

from . import second_routes, slide
from .axioms import CLOSURE, after_z
from .bodies import THIN
from .drift import landing_velocity, relaxation, stationary
from .proof import DIGITS, Equation, Proof, Repair, Verdict
from .slip_reversal import EQUATIONS as REVERSAL
from .slip_reversal import impulse as reversal_impulse
from .symbols import V_z, X, Z, c_x, c_z, epsilon, k, m, mu, omega, phi, u_0, v_0
from .trace import derived, solve

stiffness, damping, speed, mass = sp.symbols("k_n gamma_n v m_r", positive=True)

_30_degrees = {phi: sp.pi / 6}
_FIG_12 = {mu: sp.Rational(2, 5), epsilon: sp.Rational(13, 20), phi: 17 * sp.pi / 36}
_FIG_12_APPROACH = {u_0: 1, v_0: -2}
_PRINTED = {e.tag: sp.sympify(e.printed) for e in (*slide.EQUATIONS, *REVERSAL)}


def _sign(value: sp.Expr) -> sp.Expr:
    return sp.sign(sp.nsimplify(sp.N(value, DIGITS)))


def stationary_ratio() -> sp.Expr:
    """-c_z/c_x before the stationary landing of a thin rod in slip-stick."""
    along, up = stationary("stick")
    return sp.simplify((up / along).subs(THIN))


@derived
def landings_to_relax() -> sp.Expr:
    """mu times the number of landings that leave 1/e of a deviation, as mu goes to 0."""
    rate = -sp.log(relaxation("back")).diff(mu).subs(mu, 0)
    return sp.factor(1 / rate)


@derived
def restitution_lost() -> sp.Expr:
    """1 - e of Appendix A's normal force at small damping, with the reduced mass as M_e.

    The damping force's work along the undamped path, over twice the energy.
    """
    power = sp.Symbol("y", positive=True)  # overlap to the power 5/2
    energy = sp.Rational(2, 5) * stiffness * power
    (deepest,) = (
        y ** sp.Rational(2, 5)
        for y in solve(energy - mass * speed**2 / 2, power, r"$y = \delta^{5/2}$")
    )
    # x sqrt(1 - x^(5/2)) from 0 to 1, x the overlap over the deepest, is a beta function
    shape = sp.Rational(2, 5) * sp.beta(sp.Rational(4, 5), sp.Rational(3, 2))
    work = 2 * damping * mass * speed * deepest**2 * shape
    return sp.powsimp(sp.simplify(work / (mass * speed**2)))


def _relaxed(form: sp.Expr) -> list[sp.Expr]:
    """Two landings whose c_x differ by one: how fast friction brings them together."""
    after = second_routes.impact("back")[0].subs(omega, 0)
    left = sp.cancel(after.subs(c_x, 1) - after.subs(c_x, 0))
    return [form * left.diff(mu).subs(mu, 0) + 1]


def _lost_by_quadrature(form: sp.Expr) -> list[sp.Expr]:
    """The work integral by numbers where the deepest overlap is 1, and its powers by dimensions."""
    with mpmath.workdps(DIGITS + 30):
        integral = mpmath.quad(lambda x: x * mpmath.sqrt(1 - x ** mpmath.mpf("2.5")), [0, 1])
        number = sp.Float(str(2 * integral), DIGITS + 25)
    unit = {stiffness: sp.Rational(5, 4), mass: 1, speed: 1, damping: 1}
    powers = [sp.simplify(letter * form.diff(letter) / form) for letter in unit]
    wanted = [-sp.Rational(4, 5), sp.Rational(4, 5), sp.Rational(3, 5), sp.S.One]
    return [form.subs(unit) - number, *(a - b for a, b in zip(powers, wanted, strict=True))]


def appendix_a_loss() -> sp.Expr:
    """1 - e for Appendix A's constants, two rods that meet head on at (d g)^(1/2)."""
    constants = {stiffness: 5 * 10**6, damping: 400, mass: sp.Rational(1, 2), speed: 1}
    return restitution_lost().subs(constants)


_end_of_stop = (u_0 * m * k**2) / (mu * (k**2 + Z**2) + X * Z)

EQUATIONS = (
    Equation(
        tag="I: vertical velocity",
        what='"the vertical velocity just before the collision is equal to the CM velocity in the '
        'beginning of the flight": their ratio',
        symbol="c_z/c_z'",
        printed=sp.S.One,
        derive=lambda: solve(CLOSURE({})[2], c_z)[0] / after_z,
        at={},
        verdict="erratum",
        contradicted_by="V: closure",
        contradiction=lambda: sp.S.NegativeOne,
        mistaken=lambda: sp.Abs(sp.solve(CLOSURE({})[2], c_z)[0] / after_z),
        mistake="equal in size, which is meant",
        note="equal and opposite",
    ),
    Equation(
        tag="IV: large ratio",
        what='"typically this ratio [$-c_z/c_x$] is large": sign of $-c_z/c_x - 1$ at 30 degrees',
        symbol="sgn(-c_z/c_x - 1)",
        printed=sp.S.One,
        derive=lambda: _sign(stationary_ratio().subs(_30_degrees) - 1),
        verdict="erratum",
        contradicted_by="(24) with (25)",
        contradiction=lambda: _sign((k**2 / (2 * X * Z)).subs(THIN).subs(_30_degrees) - 1),
        mistaken=lambda: _sign(sp.Integer(10) - 1),
        mistake="the 10 of Fig. 10(c) is taken for typical",
        note=r"in stationary translation it is $k^2/(2 X Z)$, for a thin rod $1/(3 \sin 2\phi)$: "
        "0.38 at 30 degrees, above 1 only below 9.7 and above 80.3 degrees",
    ),
    Equation(
        tag="IV: slide above mu_c",
        what=r'"sliding can only be observed for small $\mu < \mu_c$": sign of $u_*$ in Fig. 12 '
        r"($\mu = 0.4$, $-c_z/c_x = 2$, $\epsilon = 0.65$) at 85 degrees",
        symbol="sgn(u_*)",
        printed=sp.S.NegativeOne,
        derive=lambda: _sign(slide.slide_excess().subs(THIN).subs(_FIG_12).subs(_FIG_12_APPROACH)),
        verdict="erratum",
        contradicted_by="(14), and Fig. 12, whose text sees all three regimes",
        contradiction=lambda: _sign(_PRINTED["14"].subs(THIN).subs(_FIG_12).subs(_FIG_12_APPROACH)),
        mistaken=lambda: _sign(1 / (8 * (1 + _FIG_12[epsilon])) - _FIG_12[mu]),
        mistake=r"whether $\mu < \mu_c$ is taken for whether it slides",
        note=r"$\mu_c$ is 0.076 there, and the rod slides above 75 degrees",
    ),
    Equation(
        tag="V: landings to relax",
        what=r"$\mu$ times the number of landings after which 1/e of a deviation is left, as "
        r"$\mu \to 0$",
        symbol="\\mu n",
        derive=landings_to_relax,
        shown=X * Z / (2 * k**2),
        check=_relaxed,
        verdict="new",
        note="the abstract calls friction crucial: with less of it the drift does not go to zero "
        "(it tends to half of (24)), but takes ever longer to come; without any, $c_x$ stays what "
        "it was",
    ),
    Equation(
        tag="VI: reverse drift",
        what='"reverse drift [...] presumably due to the small negative value of average $V_z$": '
        "sign of $v_0$ of such a landing (an impact needs $-1$)",
        symbol="sgn(v_0)",
        printed=sp.S.NegativeOne,
        derive=lambda: _sign(
            landing_velocity("stick").subs(THIN).subs({**_30_degrees, V_z: -1, epsilon: 0})
        ),
        verdict="erratum",
        contradicted_by="(25) with $v_0 = -c_z' - V_z$",
        contradiction=lambda: _sign(
            (-(k**2) * V_z / (k**2 + 2 * X**2) - V_z).subs(THIN).subs({**_30_degrees, V_z: -1})
        ),
        mistaken=lambda: _sign(
            landing_velocity("stick").subs(THIN).subs({**_30_degrees, V_z: 1, epsilon: 0})
        ),
        mistake="that the closure lands at all is taken over from positive $V_z$",
        note="with $V_z < 0$ the closure has no impact; a reverse drift needs another cause",
    ),
    Equation(
        tag="A: restitution",
        what="$1 - e$ of Appendix A's normal force at small damping, $M_e$ the reduced mass $m_r$",
        symbol="1 - e",
        derive=restitution_lost,
        shown=sp.Mul(
            damping,
            sp.beta(sp.Rational(4, 5), sp.Rational(3, 2)),
            sp.Pow(4 * mass**4 * speed**3 / (5 * stiffness**4), sp.Rational(1, 5), evaluate=False),
            evaluate=False,
        ),
        check=_lost_by_quadrature,
        verdict="new",
        note=r"it grows as $v^{3/5}$ and in proportion to $\gamma_n$; Appendix A's constants give "
        r"0.00085 at $(d g)^{1/2}$, and 0.35 would need hundreds of times their $\gamma_n$",
    ),
    Equation(
        tag="B8: text",
        what='"the impulse during the reversal phase"',
        symbol="P_z(t_f) - P_z(t_1)",
        printed=_PRINTED["B8"],
        derive=lambda: reversal_impulse()[1] - slide.stop()[1],
        verdict="erratum",
        contradicted_by="(B1) with (B7)",
        contradiction=lambda: (
            (-epsilon * v_0 - _PRINTED["15"]) * (m * k**2) / (k**2 + X**2 - mu * X * Z)
        ),
        repair=(Repair("without the impulse until the slip stops", _end_of_stop, sp.S.Zero),),
        note="(B8) is the impulse of the whole contact, and right as such",
    ),
)


@dataclass(frozen=True, slots=True)
class Reading:
    """A sentence that another place of the text, or a computed number, contradicts."""

    tag: str  # section and key word
    what: str  # is said
    said: str | Callable[[], str]  # the value of the quantity by that sentence
    true: str | Callable[[], str]  # by the other place
    contradicted_by: str  # the other place
    note: str  # what is right
    verdict: Verdict = "erratum"  # of all
    printed: None = None  # no equation

    def prove(self) -> Proof:
        """Show both values."""
        said, true = (x() if callable(x) else x for x in (self.said, self.true))
        return Proof(ok=said != true, evidence=f"by reading: said {said}, there {true}")


def _lost() -> str:
    return f"{float(appendix_a_loss()):.2g}"


READINGS = (
    Reading(
        "abstract: parameters",
        '"using the dimensions and dissipation parameters from the experiments"',
        "friction 0.3, restitution 0.65 to 0.7 (III)",
        "friction 0.36 and 0.25, restitution 0.8 (0.1) (II)",
        "Section II",
        "the simulations have other parameters than the experiments",
    ),
    Reading(
        "III: restitution",
        '"they lead to the kinematic restitution coefficient of about 0.65-0.7": $1 - e$',
        "0.3 to 0.35",
        _lost,
        "A: restitution, with the constants of Appendix A",
        "Appendix A's damping is hundreds of times too small for it, head on",
    ),
    Reading(
        "III: quasi-2D",
        '"in the experiments in quasi-2D geometry there is no threshold"',
        "experiments",
        "simulations",
        "the same section: quasi-2D rods are simulated, Fig. 3(b)",
        "there are no quasi-2D experiments in the paper",
    ),
    Reading(
        "VI: threshold",
        '"robust drift of rods in the direction of their tilt, at [...] $\\Gamma > 1.5$" in '
        "experiments",
        "1.5",
        "1.6",
        "Section II, Fig. 2(b)",
        "1.5 is the slightly lower threshold of the simulations (III)",
    ),
    Reading(
        "VI: short flights",
        "\"the 'short' flights that last a fraction of the period of vibrations\"",
        "less than one period",
        "one period",
        'Section III: "short flights which last one period of vibration"',
        "the two sections differ",
    ),
    Reading(
        "V: small Gamma",
        '"$V_z \\propto \\Gamma - 1$ at small $\\Gamma$"',
        r"$\Gamma$ small",
        r"$\Gamma - 1$ small",
        'Section VI: "it grows as $\\Gamma - 1$ at small $\\Gamma - 1$"',
        r"below $\Gamma = 1$ no rod leaves the plate",
    ),
    Reading(
        "Fig. 6: diameter",
        '"experimental values of $d$ = 0.6 cm"',
        "0.6 cm",
        "0.635 cm",
        "Section II",
        "0.6 is rounded",
    ),
    Reading(
        "Fig. 6: length",
        '"$l = 9.5 d$", for comparison with experiments',
        "9.5",
        "8",
        "Section II: 5.08 cm over 0.635 cm",
        "the simulated rods are longer than the experimental ones",
    ),
    Reading(
        "A: m",
        '"$m$ is the mass of the rod"',
        "mass of the rod",
        "mass of a virtual sphere",
        'the same section: "mass of virtual sphere $m$" is the unit of mass',
        "one letter for two masses; by note [12] they differ by $1 + 3 h_0/2$",
    ),
)
