"""The steps on the way to an entry, as sentences and formulas for a reader.

A step is an axiom put to use, a value derived (a link, where it is an entry of its own), or an
equation solved. Values are brought into the shortest of a few equal forms.
"""

import inspect
import re
from dataclasses import dataclass
from functools import cache
from typing import Any

import sympy as sp
from sympy.core.random import seed

from . import trace
from .proof import Equation, components
from .registry import ENTRIES
from .symbols import epsilon, mu
from .trace import Step
from .typeset import latex, moving, pieces

LONGEST = 230  # characters of LaTeX; a longer value is told in words alone
MOST = 120  # operations; a form with more is not tidied, which would take long
_NAMES = "alpha|epsilon|eta|kappa|mu|omega|phi|theta|Gamma|cos|sin|tan"
_ATOM = (
    rf"(?:(?:cos|sin|tan|H)\([^)]*\)|(?:d?[a-zA-Z]|{_NAMES})_(?:[a-z]|\d|\*)'?"
    rf"|{_NAMES}|XZ|d[uv]|[a-zA-Z]|\d+)(?:\^\d)?"
)
_FORMULA = re.compile(
    rf"A, B, C|X, Z, k|(?<![\w'])-?{_ATOM}(?:(?: ?(?:->|[<>]=|[-=<>/+]) ?-?| ){_ATOM})*(?![\w'])"
)
_CITED = re.compile(r"[,;] (?:Eqs?\. )?\(B?\d+\)(?:, \(B?\d+\))*$")
_WORDS = {"stick": "slip-stick", "back": "slip reversal", "slip": "slide"} | {
    law: law.title() for law in ("newton", "poisson", "stronge")
}
_GAIN = sp.Symbol("gain", positive=True)  # 1 + epsilon
_EQUATIONS = {entry.tag: entry for entry in ENTRIES if isinstance(entry, Equation)}


@dataclass(frozen=True, slots=True)
class Line:
    """One step as it is shown."""

    text: str  # sentence with formulas between dollar signs
    formulas: tuple[tuple[str, ...], ...] = ()  # LaTeX, each in pieces that a line may break after
    tags: tuple[str, ...] = ()  # entries that hold the value


def with_formulas(text: str) -> str:
    """Plain text such as c_x' = -c_z with its formulas as LaTeX between dollar signs."""

    def formula(found: re.Match) -> str:
        if re.fullmatch(r"[aA]|[\d ]+", found[0]):
            return found[0]
        tex = re.sub(rf"(?<![A-Za-z])({_NAMES})(?![a-z])", r"\\\1", found[0])
        return "$" + tex.replace(">=", r"\ge").replace("->", r"\to") + "$"

    return _FORMULA.sub(formula, text)


def _size(form: sp.Expr) -> int:
    """Length of a form as text, about as long as it is to read; signs count more."""
    text = sp.sstr(form, order="none")
    return len(text) + 3 * text.count("-")


def _collected(form: sp.Expr, letter: sp.Symbol) -> sp.Expr:
    return form.replace(lambda x: x.is_Add, lambda x: x.collect(letter))


@cache
def tidy(expr: sp.Expr) -> sp.Expr:
    """Return the shortest of a few equal forms: as it is, factored, sorted by its speeds."""
    if not expr.is_rational_function():
        return expr  # to factor roots and sines can take minutes
    seed(0)  # as for a derivation
    speeds = [x for x in sorted(expr.free_symbols, key=str) if moving(x)]
    forms = [expr, sp.factor(expr)]
    if not set(speeds) <= set(forms[1].args) and expr.is_polynomial(*speeds):
        forms.append(sp.collect(sp.expand(expr), speeds, sp.factor))
    for letter in (mu, epsilon):
        forms += [_collected(form, letter) for form in forms]
    if expr.has(epsilon) and expr.is_polynomial():
        turned = sp.expand(expr.subs(epsilon, _GAIN - 1))
        forms.append(sp.collect(turned, _GAIN, sp.factor).subs(_GAIN, 1 + epsilon))
    return min(forms, key=_size)


def _values(value: Any) -> list[sp.Expr]:
    """The expressions that a step gave."""
    parts = value.values() if isinstance(value, dict) else value
    listed = parts if isinstance(value, (tuple, dict)) else components(value)
    return [sp.sympify(part) for part in listed]


def _tidied(value: Any, end: str = "") -> tuple[tuple[str, ...], ...]:
    """LaTeX of each component of a value; nothing if it is too long to be read."""
    forms = _values(value)
    if sum(form.count_ops() for form in forms) > MOST:
        return ()
    found = [pieces(tidy(form)) for form in forms]
    length = sum(len(piece) for form in found for piece in form)
    return () if length > LONGEST else tuple((*form[:-1], form[-1] + end) for form in found)


def _is(step: Step, entry: Equation) -> bool:
    """Whether what the entry derives is the step's value or a part of it."""
    value = step.value
    parts = value if isinstance(value, tuple) else (value,)
    if any(isinstance(part, (dict, str)) for part in parts):
        return False
    whole = {x for part in parts for x in components(part)}
    return set(components(entry.derive())) <= whole


@cache
def _entries() -> dict[tuple, tuple[str, ...]]:
    """Tags of the entries that hold a step's value, by the step's name and arguments."""
    found: dict[tuple, tuple[str, ...]] = {}
    for tag, entry in _EQUATIONS.items():
        steps = [step for step in entry.steps if step.kind == "derived"]
        for step in steps:
            values = set(_values(step.value))
            part = any(x.free_symbols for x in values) and values <= set(components(entry.derive()))
            if part or (len(entry.steps) == 1 and _is(step, entry)):
                key = step.name, step.given
                found[key] = (*found.get(key, ()), tag)
    return found


def _with(step: Step) -> str:
    """What was put in: the step's arguments by their names."""
    names = inspect.signature(trace.STEPS[step.name]).parameters
    told, put_in = [], []
    for name, value in zip(names, step.given, strict=False):
        if isinstance(value, str):
            told.append(_WORDS.get(value, value))
        elif name.startswith("p_") and str(value).lower() != name and value.count_ops() < MOST // 8:
            put_in.append(f"${name} = {latex(tidy(value))}$")
    words = f" ({', '.join(told)})" if told else ""
    return words + (f", with {' and '.join(put_in)}" if put_in else "")


def _left_side(form: sp.Expr, unknowns: tuple[sp.Symbol, ...]) -> sp.Expr:
    """Numerator of an equation's left side, without the factors that no unknown stands in."""
    if form.count_ops() > 3 * MOST or not form.is_rational_function():
        return form
    # not by factoring, which now and then takes minutes for so many letters
    left = sp.Poly(sp.numer(sp.cancel(form)), *unknowns).primitive()[1]
    terms = [(tidy(c) if c.count_ops() < MOST // 4 else c, powers) for powers, c in left.terms()]
    return sp.Add(
        *(c * sp.prod(x**n for x, n in zip(unknowns, powers, strict=True)) for c, powers in terms)
    )


def _line(step: Step, shown_in: str) -> Line:
    """One step of the entry of a tag."""
    if step.kind == "axiom":
        entry = _EQUATIONS[step.name]
        found = _tidied(step.value) if step.value != entry.derive() else ()
        return Line("By", found, (step.name,))
    if step.kind == "solved":
        letters = step.name or ", ".join(f"${latex(x)}$" for x in step.given)
        forms = [x for part in step.value for x in _tidied(_left_side(part, step.given), " = 0")]
        return Line(f"Solved for {letters}", tuple(forms))
    tags = _entries().get((step.name, step.given), ())
    found = () if tags else _tidied(step.value)
    text = with_formulas(_CITED.sub("", step.what)) + _with(step)
    return Line(text, found, tuple(tag for tag in tags if tag != shown_in))


def lines(entry: Equation) -> list[Line]:
    """The steps of an entry's derivation, in their order; none of an assumption."""
    if entry.verdict == "assumed":
        return []
    steps = entry.steps
    if len(steps) == 1 and steps[0].kind == "derived" and _is(steps[0], entry):
        steps = steps[0].inner
    return [_line(step, entry.tag) for step in steps]
