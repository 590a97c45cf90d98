"""Exercises of the report: questions from lecture.toml, answers computed from the equations.

The answer is the note of an entry, or an impact worked out below.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import sympy as sp

from .bodies import THIN
from .laws import a_1, a_2
from .lecture import PAPER, TEXTS, number
from .lookup import entry_of, equation
from .newton import approach
from .proof import told
from .symbols import P_1, V_z, c_x, c_z, diameter, epsilon, length, m, mu, omega, phi, u_0, v_0


class Exercise(NamedTuple):
    """A question, and its answer; sentences with formulas between dollar signs."""

    question: str
    answer: Callable[[], str]


def _thin(tag: str, tilt: int) -> sp.Expr:
    """An equation of a thin rod of length and mass one, tilt in degrees, before numbers go in."""
    return equation(tag).subs(THIN).subs({phi: sp.rad(tilt), length: 1, m: 1})


def _contact() -> str:
    at = {length: 8, diameter: 1, phi: sp.rad(20)}
    x, z = (part.subs(at) for part in equation("bodies: contact")[:2])
    square = equation("bodies: gyration radius")[0].subs(at)
    return (
        f"$X = {number(x, 3)} d$, $Z = {number(z, 3)} d$, $k^2 = {number(square, 3)} d^2$: it "
        rf"slips back below $\mu = {number(x * z / (square + z**2), 3)}$."
    )


def _one_impact() -> str:
    at = {c_x: 1, c_z: -2, omega: 0, V_z: 0, **PAPER}
    left = _thin("14", 20).subs(approach()).subs(at)
    after = [number(_thin(tag, 20).subs(at), 3) for tag in ("18", "19")]
    regime = "holds: slip-stick" if _thin("16", 20).subs(at) else "fails: slip reversal"
    return (
        f"$u_* = {number(left, 3)}$, so the slip stops, and (16) {regime}. "
        f"$c_x' = {after[0]}$, $c_z' = {after[1]}$."
    )


def _laws() -> str:
    at = {u_0: sp.Rational(11, 10), v_0: -1, mu: PAPER[mu], epsilon: sp.Rational(1, 2)}
    slopes = [part.subs(at) for part in _thin("laws: slopes", 12)]
    stop = {P_1: _thin("B1", 12).subs(at), a_1: slopes[0], a_2: slopes[1]}
    late = bool(_thin("15", 12).subs(at) > 0)
    forms = [equation(f"laws: {law}")[late] for law in ("Poisson", "Stronge")]
    ends = [form.subs(stop).subs(at) for form in (equation("IV: restitution"), *forms)]
    newton, poisson, stronge = (number(end, 3) for end in ends)
    return (
        f"The slip stops {('before', 'after')[late]} the deepest point. $v_f$ is {newton} by "
        f"Newton, {poisson} by Poisson and {stronge} by Stronge."
    )


def _by_note(tag: str) -> str:
    note = told(entry_of(tag))
    return f"{note[:1].upper()}{note[1:]}."


_WORKED = {"contact": _contact, "one_impact": _one_impact, "laws": _laws}
EXERCISES = tuple(
    Exercise(question, _WORKED.get(answer, partial(_by_note, answer)))
    for answer, question in TEXTS["exercises"].items()
)
