"""Steps of an entry's derivation, as sentences and equations for a reader.

A step is an axiom put to use, a derived value (a link, if it is an entry of its own), a solved
equation, or a line that a derivation says. Each has a sentence, and an equation with a left side
if that is short enough to be read. A step that one entry has shown is cited by the next ones.
"""

from itertools import chain
from typing import Any, NamedTuple, TypeAlias

import sympy as sp

from . import axioms
from .equality import components
from .proof import Equation
from .trace import Step
from .typeset import equation, latex, pieces, tidy

LONGEST = 1600  # characters of LaTeX; longer formulas are left out, and words alone are shown
MOST = 220  # operations; a form with more is left out, as it would take long to tidy
_CASES = {
    "stick": "slip-stick",
    "back": "slip reversal",
    "newton": "Newton",
    "poisson": "Poisson",
    "stronge": "Stronge",
}


# LaTeX, each in pieces that a line may break after.
Formulas: TypeAlias = tuple[tuple[str, ...], ...]


class Line(NamedTuple):
    """One step as it is shown: a sentence, formulas, and tags of entries to link to."""

    text: str  # sentence with formulas between dollar signs
    formulas: Formulas = ()
    tags: tuple[str, ...] = ()  # entries that hold the value


def _short(expr: Any) -> bool:
    return isinstance(expr, sp.Expr) and expr.count_ops() <= MOST


def _equations(values: list[tuple[str, Any]]) -> Formulas:
    """LaTeX of each value with its left side; empty if they are too long to be read."""
    if not all(_short(value) for _, value in values):
        return ()
    return _readable([equation(left, tidy(value)) for left, value in values])


def _readable(formulas: list[tuple[str, ...]]) -> Formulas:
    """Formulas in pieces, as given; empty if they are longer than `LONGEST` together."""
    return tuple(formulas) if sum(map(len, chain(*formulas))) <= LONGEST else ()


def _solved(step: Step) -> Line:
    """Line of a solved equation: both sides; of a form that must vanish, its numerator."""
    sentence = step.what or "Solved for " + ", ".join(f"${latex(x)}$" for x in step.given)
    formulas = []
    for left, right in step.value:
        if right == 0 and left.is_rational_function() and left.count_ops() <= 3 * MOST:
            left = _numerator(left, step.given)
        if not _short(left):
            return Line(sentence)
        (*above, last), (first, *below) = (pieces(tidy(side)) for side in (left, right))
        formulas.append((*above, f"{last} = {first}", *below))
    return Line(sentence, _readable(formulas))


def _numerator(form: sp.Expr, unknowns: tuple[sp.Symbol, ...]) -> sp.Expr:
    """Numerator of a form that vanishes, without factors that are free of the unknowns."""
    # factoring is avoided: it sometimes takes minutes for so many letters
    left = sp.Poly(sp.numer(sp.cancel(form)), *unknowns).primitive()[1]
    terms = [(tidy(c) if c.count_ops() < MOST // 4 else c, powers) for powers, c in left.terms()]
    return sp.Add(
        *(c * sp.prod(x**n for x, n in zip(unknowns, powers, strict=True)) for c, powers in terms)
    )


def _put_in(step: Step) -> str:
    """Words for the arguments of a step: its cases, and what is put in for impulses such as P_x."""
    _, *cases = step.case
    words = ", ".join(_CASES.get(case, case) for case in cases)
    put_in = " and ".join(
        f"${latex(tidy(value))}$ for ${name[0].upper()}{name[1:]}$"
        for name, value in step.arguments.items()
        if name.startswith("p_") and str(value).lower() != name and value.count_ops() < MOST // 16
    )
    return (f" ({words})" if words else "") + (f", with {put_in}" if put_in else "")


class Reader:
    """Lines of entries, in reading order; a step that one entry has shown is cited by the next."""

    def __init__(self, entries: list[Equation]):
        self.shown: dict[tuple, tuple] = {}  # name and cases of a step: first entry, arguments
        self.own: dict[tuple, list[str]] = {}  # name, arguments of a step: entries of its values
        for entry in entries:
            form = set(components(entry.derive()))
            for step in entry.steps:
                values = {value for _, value in step.values} if step.kind == "derived" else set()
                if any(x.free_symbols for x in form) and form <= values:
                    self.own.setdefault((step.name, step.given), []).append(entry.tag)

    def lines(self, entry: Equation) -> list[Line]:
        """Lines of the steps of an entry's derivation, in their order; an assumption has none."""
        if entry.verdict == "assumed":
            return []
        found = [line for step in entry.steps for line in self._lines(step, entry)]
        return list(dict.fromkeys(found))

    def _lines(self, step: Step, entry: Equation) -> list[Line]:
        """Lines of one step, after those of its inner steps that no entry has shown yet."""
        if step.kind == "part":
            return []
        if step.kind == "axiom":
            used = step.value != axioms.BY_TAG[step.name].form
            return [Line("By", _equations(step.values) if used else (), (step.name,))]
        if step.kind == "solved":
            return [_solved(step)]
        if step.kind == "said":
            return [Line(step.what, _equations(step.values))]
        own = self.own.get((step.name, step.given), [])
        sentence = step.what + _put_in(step)
        if own and entry.tag != own[0]:
            return [Line(sentence, (), tuple(own[:1] if entry.tag in own else own))]
        cited, given = self.shown.setdefault(step.case, (entry.tag, step.given))
        fresh = cited == entry.tag
        if not fresh and given == step.given:
            return [Line(sentence, (), (cited,))]
        inner = step.inner if fresh else [x for x in step.inner if x.kind in ("said", "solved")]
        before = [line for x in inner for line in self._lines(x, entry)]
        if entry.tag in own and len(step.values) == 1:  # the entry shows it as its result
            return [*before, Line(sentence)]
        return [*before, Line(sentence, _equations(step.values), () if fresh else (cited,))]
