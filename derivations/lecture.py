"""Words of the report, read from lecture.toml or computed, as HTML and as plain text.

In `the slip $u_0 > 0$ of (14)` the formula is LaTeX, and the number of an equation may become a
link. Text between backquotes is code. A letter of the table has one meaning. Dimensions are
monomials in mass, length and time; a plain number has the dimension 1.
"""

import html
import re
import tomllib
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import sympy as sp

from . import paper
from .equality import components, equal
from .symbols import V_z, X, Z, epsilon, k, mu, phi
from .typeset import latex, mathml, words

PRINTED = {"Vdot_z": r"\dot V_z", "cprime_x": "c_x'", "cprime_z": "c_z'"}


class Part(NamedTuple):
    """Introduction of a section, before its entries: paragraphs, then drawings by their names."""

    text: list[str]  # with %(names)s of computed words
    drawings: list[str]


class Letter(NamedTuple):
    """One line of the table of letters."""

    name: str  # of the symbol
    meaning: str
    dimension: str  # LaTeX

    @property
    def tex(self) -> str:
        """LaTeX of the letter."""
        return PRINTED.get(self.name, latex(sp.Symbol(self.name)))


_CITED = re.compile(r"\((B?\d{1,2})(?::\s([^)]*))?\)")
_SOURCE = paper.text_of("lecture.toml")
TEXTS = tomllib.loads(_CITED.sub(r"(\1)", _SOURCE))
CITED = [(number, " ".join(name.split())) for number, name in _CITED.findall(_SOURCE)]
PARTS = {
    title: Part(
        [" ".join(paragraph.split()) for paragraph in part["text"].split("\n\n")],
        part.get("drawings", []),
    )
    for title, part in TEXTS["parts"].items()
}
REFERENCES = TEXTS["references"]
LETTERS = sorted(
    (Letter(*line.split(" | ")) for line in TEXTS["letters"].splitlines()),
    key=lambda letter: (re.sub(r"\\dot |[\\{}]", "", letter.tex).lower(), letter.tex),
)
_MEANINGS = {letter.name: letter.meaning for letter in LETTERS}
_MATH = "<math>(?:(?!</math>).)*</math>"
_WHOLE = re.compile(rf"\({_MATH}[,.;:)]*|{_MATH}[,.;:)]+")  # a line must not break in it
_PLAIN = ((r"\ge", ">="), (r"\le", "<="), (r"\to", "->"), (r"\cdot", "."), (r"\,", " "))


def to_html(text: str, link: Callable[[str], str] = "".format) -> str:
    """HTML of a sentence; `link` gives the address of an equation's tag, or nothing."""

    def linked(match: re.Match) -> str:
        address = link(match[1])
        return f'<a href="{address}">{match[0]}</a>' if address else match[0]

    def plain(part: str) -> str:
        part = html.escape(part, quote=False).replace("'", "’")
        return re.sub(r"\((B?\d+)\)", linked, re.sub("`([^`]+)`", r"<code>\1</code>", part))

    parts = re.sub('"([^"]*)"', r"“\1”", text).split("$")
    parts[::2] = map(plain, parts[::2])
    parts[1::2] = [mathml(words(part)) for part in parts[1::2]]
    return _WHOLE.sub(r'<span class="whole">\g<0></span>', "".join(parts))


def to_text(text: str) -> str:
    """Plain text of a sentence, for a terminal: c_x', mu, k^2."""
    for sign, plain in _PLAIN:
        text = text.replace(sign, plain)
    text = re.sub(r"\^\{(\w+/\w+)\}", r"^(\1)", text)
    text = re.sub(r"\\sqrt\{(.*?)\}", r"sqrt(\1)", text)
    return re.sub(r"\\mathrm|[\\${}]", "", text)


# ---- words of the notes that are computed --------------------------------------------------------

PAPER = paper.setting("Fig. 11")
EXERCISES = {  # by the entry whose note answers it
    tag: text % {str(x): str(float(y)) for x, y in PAPER.items()}
    for tag, text in TEXTS["exercises"].items()
}


def meaning(letter: sp.Symbol, *others: sp.Symbol) -> sp.Expr:
    """Expression that a letter stands for, read from its meaning; `others` may stand in it, too."""
    known = paper.LETTERS | {latex(x): x for x in others}
    return paper.read(_MEANINGS[letter.name].split("$")[1], known)


def number(value: sp.Expr, digits: int = 2) -> str:
    """Text of a value with so many significant digits, such as 0.76."""
    return f"{float(f'{float(value):.{digits}g}'):.12g}"


def degrees(angle: sp.Expr, digits: int = 1) -> str:
    """Text of an angle, given in rad, in degrees with so many decimals."""
    return f"{float(sp.deg(angle)):.{digits}f}".removesuffix(".0") + " degrees"


def formula(form: sp.Expr) -> str:
    """LaTeX of a form between dollar signs."""
    return f"${latex(form)}$"


def identity(equation: str) -> str:
    """An equation in the paper's letters between dollar signs; ValueError if it does not hold."""
    if not equal(*(paper.read(side, paper.LETTERS) for side in equation.split(" = "))):
        raise ValueError(f"it is not so: {equation}")
    return f"${equation}$"


def falls(form: sp.Expr, letter: sp.Symbol, zero: sp.Expr) -> bool:
    """Whether a form of a letter is positive below its zero and negative above it."""
    below, above = (form.subs(letter, zero * x) for x in (0.9, 1.1))
    return below > 0 > above


def largest(form: sp.Expr, letter: sp.Symbol, there: sp.Expr, at: Mapping = {}) -> bool:
    """Whether a form of a letter is larger at the value `there` than 10 % below and above it."""
    here, *beside = (form.subs(letter, there * x).subs(at).evalf() for x in (1, 0.9, 1.1))
    return here > max(beside)


def negative(form: sp.Expr | sp.MatrixBase, put: Mapping = {}) -> bool:
    """Whether a form is negative for any positive lengths, speeds and friction, 0 < epsilon < 1.

    `put` has what letters stand for, and is put in first.
    """
    inelastic = sp.Symbol("loss", positive=True)  # (1 - epsilon)/epsilon
    sizes = X, Z, k, mu, V_z, sp.sin(phi), sp.cos(phi)
    letters = {x: sp.Symbol(str(x), positive=True) for x in sizes} | {epsilon: 1 / (1 + inelastic)}
    return all(sp.factor(x.subs(put).subs(letters)).is_negative for x in components(form))


SENSES: Mapping[str, Callable[..., bool]] = {  # tests of what a word claims; the first that fits
    "never positive": lambda terms: all(term.is_nonpositive for term in terms),
    "negative": negative,
    "positive": lambda form, *put: negative(-form, *put),
    "largest": largest,
    "least": lambda form, *there: largest(-form, *there),
    "above": lambda form, *zero: falls(-form, *zero),
    "below": falls,
}


def so(words: str, *claimed: Any) -> str:
    """Return words if what one of `SENSES` in them claims is true; else raise ValueError.

    "Above" and "below" say on which side of its zero a form of a letter is positive.
    """
    test = next(test for word, test in SENSES.items() if word in words)
    if not test(*claimed):
        raise ValueError(f"it is not so: {words}")
    return words
