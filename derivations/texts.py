"""Checks that texts say of equations, letters and functions what was computed.

A number in the sentence of a step, an entry or a function must be that of an equation whose value
is taken there; several numbers come in the order in which the values are taken. In prose each
number stands with what its equation is about. A letter has one dimension: every value is
homogeneous and has the dimension of its left side, and a formula in the letter's meaning fits.

All text that is typed, not computed, was read beside its forms and is sealed by a digest, `READ`:
whoever changes a word, a label or a formula in a sentence reads it again there, on the page.
"""

import ast
import hashlib
import re
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import sympy as sp

from . import lecture, paper, trace
from .closed_forms import FUNCTIONS
from .equality import equal
from .kernel import KERNEL
from .proof import Equation, told
from .trace import Step

READ = "cd9f8b750a88141e"  # digest of all words, when they were last read
_REMARK = re.compile(r'"""(?s:.*?)"""|#.*')
_NUMBER = re.compile(r"\((B?\d+)\)")
_NUMBERED = re.compile(r"(B?\d+)(: (?!text).*)?")
_UNITS = {unit: sp.Symbol(unit, positive=True) for unit in "MLT"}
_DIMENSIONS = {x.name: paper.read(x.dimension, _UNITS) for x in lecture.LETTERS}
_LETTERS = {
    re.sub(r"\\mathit|[{}']", "", x.tex): sp.Symbol(x.name) for x in reversed(lecture.LETTERS)
}
_PLAIN = (  # replacements that keep the dimension of a left side
    (r"\\(Delta|delta|partial|max_\\phi) ?|\(t_[1f]\)|\((\d+|\\theta(_s)?)\)|[]['|]", ""),
    (r"_\{(?:([\w*]), )?[a-z, ]{3,}\}", r"_\1"),
    (r"_\{([\w*]+)\}|\{(\\\w+)\}", r"_\1\2"),
    (r"(?<![\\\w])d(\^2)?(?=[cuvxzP]|\\omega|\\vartheta)", ""),
    (r"\\dot ?(\\?[A-Za-z]+(_\w)?)", r"\1/t"),
    ("_(?!\\w|[*])", ""),
    (" - ", " + "),
)
_UNIT = re.compile(r"((?:\$[^$]+\$(?:, | and )?)+) in (m/s|1/s|m|\$[^$]+\$)(?![\w/])")


# ---- numbers of equations ------------------------------------------------------------------------


class _Held(NamedTuple):
    """Number of an equation, and the value that a derivation takes last: that of the equation."""

    number: str
    step: Step
    place: Any  # of the value among those of the step; None: the whole


def _takes(steps: Sequence[Step]) -> Iterator[tuple[Step, Any]]:
    """Axioms and derived steps, each with the place of a value that is taken; None: the whole."""
    for step in steps:
        if step.kind in ("axiom", "derived"):
            part = "part", step.name, step.given
            places = [x.given[-1] for x in steps if (x.kind, x.name, x.given[:-1]) == part]
            yield from ((step, place) for place in places or [None])


def _holders(entries: Sequence[Equation]) -> Iterator[_Held]:
    """Numbered equations, each with its value."""
    for entry in entries:
        number, takes = _NUMBERED.fullmatch(entry.tag), list(_takes(entry.steps))
        if number and takes:
            yield _Held(number[1], *takes[-1])


def _numbers(steps: Sequence[Step], held: Sequence[_Held], own: bool = False) -> list[str]:
    """Numbers of the equations whose values steps take, in their order.

    `own` asks for equations that hold a value of the same step, but for other arguments.
    """
    found = []
    for step, place in _takes(steps):
        same = [x for x in held if x.step.case == step.case]
        exact = [x for x in same if x.step.given == step.given]
        first = [*{x.place: x for x in reversed(same)}.values()][::-1]
        other = [x for x in first if x.step.given != step.given]
        cited = other if own else exact or first
        found += [x.number for x in cited if None in (place, x.place) or x.place == place]
        if not same:
            found += _numbers(step.inner, held)
    return found


def _misnumbered(sentence: str, taken: Sequence[str]) -> Iterator[str]:
    rest = iter(taken)
    cited = _NUMBER.findall(re.sub('"[^"]*"', "", sentence))
    if not all(number in rest for number in cited):
        yield f"{sentence}: {', '.join(cited)}, where {', '.join(taken) or 'none'} is taken"


def _steps(steps: Sequence[Step], known: set) -> Iterator[tuple[Step, Sequence[Step]]]:
    """Each step of a derivation once, with the steps that its sentence may cite."""
    for step in steps:
        yield step, step.inner if step.kind == "derived" else steps
        if step.kind == "derived" and (step.name, step.given) not in known:
            known.add((step.name, step.given))
            for inner, around in _steps(step.inner, known):
                yield inner, (*around, step) if around is step.inner else around


def wrong_numbers(entries: Sequence[Equation]) -> Iterator[str]:
    """Messages on equation numbers that are cited where their values are not taken."""
    abouts = {x.tag: x.what for x in entries}
    for number, name in lecture.CITED:
        if abouts.get(number) != name:
            yield f"({number}) is not {name or 'said'}"
    held = list(_holders(entries))
    known: set[Any] = set()
    for entry in entries:
        yield from _misnumbered(entry.what + told(entry), _numbers(entry.steps, held))
        for step, around in _steps(entry.steps, known):
            if _NUMBER.search(step.what):
                own = [step] if step.kind == "derived" else around[-1:]
                taken = _numbers(around, held) + _numbers(own, held, own=True)
                yield from _misnumbered(step.what, taken)
    for function in FUNCTIONS:
        words = function.words["summary"] + function.words["detail"]
        if _NUMBER.search(words):
            with trace.noted() as steps:
                function.derived()
            yield from _misnumbered(words, _numbers(steps, held))


# ---- letters -------------------------------------------------------------------------------------


@cache
def dimension(form: sp.Expr) -> sp.Expr:
    """Dimension of a form; ValueError if it is not homogeneous."""
    if form.is_number:
        return sp.S.One
    if form.is_Symbol:
        known = _DIMENSIONS.get(form.name)
        return dimension(left_side(form.name)) if known is None else known
    if form.has(sp.Integral):
        return dimension(form.doit())
    parts = [dimension(x) for x in form.args]
    if form.is_Mul:
        return sp.Mul(*parts)
    if form.is_Pow and form.exp.is_number:
        return parts[0] ** form.exp
    if len(set(parts)) > 1 or not (form.is_Add or parts[0] == 1):
        raise ValueError(f"{form} is not homogeneous")
    return parts[0]


@cache
def left_side(left: str) -> sp.Expr:
    """Expression with the dimension of a left side, read in letters of the table."""
    for old, new in _PLAIN:
        left = re.sub(old, new, left)
    left = re.sub(r"(\\?[A-Za-z]+)_[\w*]", lambda x: x[x[0] not in _LETTERS], left)
    return paper.read(left, _LETTERS)


def wrong_letters(entries: Sequence[Equation]) -> Iterator[str]:
    """Messages on meanings of letters, values and left sides whose dimensions do not fit."""
    known: set[Any] = set()
    for letter in lecture.LETTERS:
        for formula in letter.meaning.split("$")[1::2]:
            sides = [dimension(left_side(x)) for x in formula.split("=")]
            if sides[0] != (_DIMENSIONS[letter.name] if len(sides) == 1 else sides[1]):
                yield f"{letter.name} has not the dimension of {formula}"
    for entry in entries:
        if entry.tag.startswith("A: ") and entry.verdict != "new":
            continue  # its values are dimensions themselves
        for step, _ in _steps(entry.steps, known):
            for left, value in step.values:
                if left != "0" and dimension(left_side(left)) != dimension(value):
                    yield f"{left} has not the dimension of {value}"


# ---- generated functions -------------------------------------------------------------------------


def _plain(tex: str) -> str:
    return re.sub(r"[${}]|\\mathrm", "", tex).strip()


def wrong_functions() -> Iterator[str]:
    """Messages on units and formulas in generated functions' words that contradict their forms."""
    for function in FUNCTIONS:
        words = function.words["summary"] + function.words["detail"]
        for names, unit in _UNIT.findall(words):
            meant = paper.read(_plain(unit), {"m": _UNITS["L"], "s": _UNITS["T"]})
            for name in map(_plain, names.split("$")[1::2]):
                form = function.outputs.get(function.letters[name])
                found = dimension(left_side(name) if form is None else form)
                if found.subs(_UNITS["M"], 1) != meant:  # impulses are per unit mass
                    yield f"{function.name}: {name} is not in {unit}"
        letters = sp.Tuple(*function.arguments, *function.meaning.items()).free_symbols
        known = {str(x): x for x in letters}
        for formula in words.split("$")[1::2]:
            left, _, right = formula.partition(" = ")
            if right and function.meaning and _plain(left) in known:
                sides = (paper.read(x, paper.LETTERS | known) for x in (_plain(left), right))
                if not equal(*(x.subs(function.meaning) for x in sides)):
                    yield f"{function.name}: not so, {formula}"


# ---- the seal ------------------------------------------------------------------------------------


@cache
def _strings(source: bytes) -> list[str]:
    values = (getattr(node, "value", "") for node in ast.walk(ast.parse(source)))
    return [x for x in values if isinstance(x, str)]


def digest() -> str:
    """Digest, 16 hex digits, of all words and LaTeX typed here and in the kernel's remarks.

    White space does not count, nor do `READ` and comments of this package's Python files.
    """
    typed = _REMARK.findall(KERNEL.read_text("utf-8"))
    for path in sorted(Path(__file__).parent.rglob("*")):
        if path.suffix in (".toml", ".html", ".css", ".jinja"):
            typed.append(path.read_text("utf-8"))
        elif path.suffix == ".py":
            typed += (x for x in _strings(path.read_bytes()) if x != READ)
    words = "".join(typed).split()  # margins of docstrings differ
    return hashlib.sha256("".join(words).encode()).hexdigest()[:16]


def wrong(entries: Sequence[Equation]) -> Iterator[str]:
    """Messages on all that is wrong in texts: numbers, letters, functions, words not read again."""
    yield from wrong_numbers(entries)
    yield from wrong_letters(entries)
    yield from wrong_functions()
    if (found := digest()) != READ:
        yield f"The words are not those that were read beside their forms, but {found}"
