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

from . import trace
from .proof import Equation, components
from .registry import ENTRIES
from .symbols import epsilon, mu
from .trace import Step
from .typeset import latex, moving, pieces

LONGEST = 230  # characters of LaTeX; a longer value is told in words alone
MOST = 120  # operations; a form with more is not tidied, which would take long
_GREEK = "alpha|epsilon|eta|kappa|mu|omega|phi|Gamma"
_LETTER = re.compile(
    rf"\b((?:{_GREEK}|[a-zA-Z])_(?:[a-z]\b|\d|\*)'?|(?:{_GREEK}|XZ|[dI]?[uv]|[klI]\^2|T)\b)"
)
_CITED = re.compile(r"[,;] (?:Eqs?\. )?\(B?\d+\)(?:, \(B?\d+\))*$")
_WORDS = {"stick": "slip-stick", "back": "slip reversal", "slip": "slide"} | {
    law: law.title() for law in ("newton", "poisson", "stronge")
}
_EQUATIONS = {entry.tag: entry for entry in ENTRIES if isinstance(entry, Equation)}


@dataclass(frozen=True, slots=True)
class Line:
    """One step as it is shown."""

    text: str  # sentence with formulas between dollar signs
    formulas: tuple[tuple[str, ...], ...] = ()  # LaTeX, each in pieces that a line may break after
    tags: tuple[str, ...] = ()  # entries that hold the value


def _letters(text: str) -> str:
    """A docstring's line with its letters between dollar signs, without the equations it cites."""
    greek = re.compile(rf"^(?={_GREEK})")
    return _LETTER.sub(lambda found: f"${greek.sub(chr(92) * 2, found[1])}$", _CITED.sub("", text))


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
        return expr  # to factor roots and sines can take for ever
    speeds = [x for x in sorted(expr.free_symbols, key=str) if moving(x)]
    forms = [expr, sp.factor(expr)]
    if speeds and expr.is_polynomial(*speeds):
        forms.append(sp.collect(sp.expand(expr), speeds, sp.factor))
    for letter in (mu, epsilon):
        forms += [_collected(form, letter) for form in forms]
    return min(forms, key=_size)


def _tidied(value: Any, end: str = "") -> tuple[tuple[str, ...], ...]:
    """LaTeX of each component of a value; nothing if it is too long to be read."""
    parts = value.values() if isinstance(value, dict) else value
    listed = parts if isinstance(value, (tuple, dict)) else components(value)
    forms = [sp.sympify(part) for part in listed]
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
        steps = entry.steps
        if len(steps) == 1 and steps[0].kind == "derived" and _is(steps[0], entry):
            key = steps[0].name, steps[0].given
            found[key] = (*found.get(key, ()), tag)
    return found


def _with(step: Step) -> str:
    """What was put in: the step's arguments by their names."""
    names = inspect.signature(trace.STEPS[step.name]).parameters
    told = []
    for name, value in zip(names, step.given, strict=False):
        if isinstance(value, str):
            told.append(_WORDS.get(value, value))
        elif isinstance(value, sp.Expr) and value.count_ops() < MOST // 8:
            text = latex(tidy(value))
            told += [f"${name} = {text}$"] if name.startswith("p_") else []
    return f" ({', '.join(told)})" if told else ""


def _left_side(form: sp.Expr, unknowns: tuple[sp.Symbol, ...]) -> sp.Expr:
    """Numerator of an equation's left side, without the factors that no unknown stands in."""
    if form.count_ops() > 3 * MOST or not form.is_rational_function():
        return form
    # not by factoring, which now and then takes minutes for so many letters
    left = sp.Poly(sp.numer(sp.cancel(form)), *unknowns)
    return left.primitive()[1].as_expr()


def _line(step: Step) -> Line:
    if step.kind == "axiom":
        entry = _EQUATIONS[step.name]
        found = _tidied(step.value) if step.value != entry.derive() else ()
        return Line("By", found, (step.name,))
    if step.kind == "solved":
        letters = ", ".join(f"${latex(x)}$" for x in step.given)
        forms = [x for part in step.value for x in _tidied(_left_side(part, step.given), " = 0")]
        return Line(f"Solved for {letters}", tuple(forms))
    tags = _entries().get((step.name, step.given), ())
    return Line(_letters(step.what) + _with(step), () if tags else _tidied(step.value), tags)


def lines(entry: Equation) -> list[Line]:
    """The steps of an entry's derivation, in their order; none of an assumption."""
    if entry.verdict == "assumed":
        return []
    steps = entry.steps
    if len(steps) == 1 and steps[0].kind == "derived" and _is(steps[0], entry):
        steps = steps[0].inner
    return [_line(step) for step in steps]
