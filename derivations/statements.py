"""Sentences of the text that state a number, a sign or an order, and are wrong.

What a sentence says and what is true are computed as two values of one quantity where there is
something to compute (`EQUATIONS`). Where two places of the text differ, it is a `Reading`.
"""

import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from importlib import resources
from typing import Any

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
    Equation.read(
        "I: vertical velocity",
        printed=sp.S.One,
        derive=lambda: solve(CLOSURE({})[2], c_z)[0] / after_z,
        at={},
        contradiction=lambda: sp.S.NegativeOne,
        mistaken=lambda: sp.Abs(sp.solve(CLOSURE({})[2], c_z)[0] / after_z),
    ),
    Equation.read(
        "IV: large ratio",
        printed=sp.S.One,
        derive=lambda: _sign(stationary_ratio().subs(_30_degrees) - 1),
        contradiction=lambda: _sign((k**2 / (2 * X * Z)).subs(THIN).subs(_30_degrees) - 1),
        mistaken=lambda: _sign(sp.Integer(10) - 1),
    ),
    Equation.read(
        "IV: slide above mu_c",
        printed=sp.S.NegativeOne,
        derive=lambda: _sign(slide.slide_excess().subs(THIN).subs(_FIG_12).subs(_FIG_12_APPROACH)),
        contradiction=lambda: _sign(_PRINTED["14"].subs(THIN).subs(_FIG_12).subs(_FIG_12_APPROACH)),
        mistaken=lambda: _sign(1 / (8 * (1 + _FIG_12[epsilon])) - _FIG_12[mu]),
    ),
    Equation.read(
        "V: landings to relax", derive=landings_to_relax, shown=X * Z / (2 * k**2), check=_relaxed
    ),
    Equation.read(
        "VI: reverse drift",
        printed=sp.S.NegativeOne,
        derive=lambda: _sign(
            landing_velocity("stick").subs(THIN).subs({**_30_degrees, V_z: -1, epsilon: 0})
        ),
        contradiction=lambda: _sign(
            (-(k**2) * V_z / (k**2 + 2 * X**2) - V_z).subs(THIN).subs({**_30_degrees, V_z: -1})
        ),
        mistaken=lambda: _sign(
            landing_velocity("stick").subs(THIN).subs({**_30_degrees, V_z: 1, epsilon: 0})
        ),
    ),
    Equation.read(
        "A: restitution",
        derive=restitution_lost,
        shown=sp.Mul(
            damping,
            sp.beta(sp.Rational(4, 5), sp.Rational(3, 2)),
            sp.Pow(4 * mass**4 * speed**3 / (5 * stiffness**4), sp.Rational(1, 5), evaluate=False),
            evaluate=False,
        ),
        check=_lost_by_quadrature,
    ),
    Equation.read(
        "B8: text",
        printed=_PRINTED["B8"],
        derive=lambda: reversal_impulse()[1] - slide.stop()[1],
        contradiction=lambda: (
            (-epsilon * v_0 - _PRINTED["15"]) * (m * k**2) / (k**2 + X**2 - mu * X * Z)
        ),
        repair=(Repair("without the impulse until the slip stops", _end_of_stop, sp.S.Zero),),
    ),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """A sentence that another place of the text, or a computed number, contradicts."""

    tag: str  # section and key word
    what: str  # is said
    said: str  # the value of the quantity by that sentence
    true: str | Callable[[], str]  # by the other place
    contradicted_by: str  # the other place
    note: str  # what is right
    verdict: Verdict = "erratum"  # of all
    printed: None = None  # no equation

    def prove(self) -> Proof:
        """Show both values."""
        true = self.true() if callable(self.true) else self.true
        return Proof(ok=self.said != true, evidence=f"by reading: said {self.said}, there {true}")


def _lost() -> str:
    return f"{float(appendix_a_loss()):.2g}"


_TEXTS = tomllib.loads(resources.files(__package__).joinpath("statements.toml").read_text("utf-8"))
_COMPUTED: dict[str, Any] = {"III: restitution": {"true": _lost}}
READINGS = tuple(
    Reading(tag=tag, **words, **_COMPUTED.get(tag, {})) for tag, words in _TEXTS["readings"].items()
)
