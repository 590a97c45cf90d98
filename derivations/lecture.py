"""The report's words, from lecture.toml, and sentences as HTML, as LaTeX and as plain text.

In `the slip $u_0 > 0$ of (14)` the formula is LaTeX, and the number of an equation may become a
link. Between backquotes stands code. A letter of the table has one meaning; dimensions are
monomials in mass, length and time, 1 is a number.
"""

import html
import re
import tomllib
from collections.abc import Callable, Iterator
from importlib import resources
from typing import NamedTuple

import sympy as sp

from .typeset import latex, mathml, words


class Part(NamedTuple):
    """What stands before the entries of a section: paragraphs, then drawings by their names."""

    text: tuple[str, ...]
    drawings: tuple[str, ...] = ()


class Letter(NamedTuple):
    """One line of the table."""

    name: str  # of the symbol
    meaning: str
    dimension: str  # LaTeX

    @property
    def tex(self) -> str:
        """LaTeX of the letter."""
        return {"Vdot_z": r"\dot V_z", "cprime_x": "c_x'", "cprime_z": "c_z'"}.get(
            self.name, latex(sp.Symbol(self.name))
        )


TEXTS = tomllib.loads(resources.files(__package__).joinpath("lecture.toml").read_text("utf-8"))


def _paragraphs(text: str) -> tuple[str, ...]:
    return tuple(" ".join(part.split()) for part in text.split("\n\n"))


PARTS = {
    title: Part(_paragraphs(part["text"]), tuple(part.get("drawings", ())))
    for title, part in TEXTS["parts"].items()
}
REFERENCES = tuple(TEXTS["references"])
LETTERS = tuple(
    sorted(
        (Letter(*line.split(" | ")) for line in TEXTS["letters"].splitlines()),
        key=lambda letter: (re.sub(r"\\dot |[\\{}]", "", letter.tex).lower(), letter.tex),
    )
)
_QUOTED = re.compile(r'"([^"]*)"')
_MATH = "<math>(?:(?!</math>).)*</math>"
_WHOLE = re.compile(rf"\({_MATH}[,.;:)]*|{_MATH}[,.;:)]+")  # a line must not break in it
_CODE = re.compile(r"`([^`]+)`")
_ESCAPES = {sign: f"\\{sign}" for sign in "&%#_{}"}
_ESCAPES |= {"<": "$<$", ">": "$>$", "^": r"\^{}", "é": r"\'e"}
_PLAIN = ((r"\ge", ">="), (r"\le", "<="), (r"\to", "->"), (r"\cdot", "."), (r"\,", " "))


def _parts(text: str) -> Iterator[tuple[bool, str]]:
    """Split a sentence at its dollar signs: (whether it is a formula, text)."""
    return ((i % 2 == 1, part) for i, part in enumerate(text.split("$")))


def to_html(text: str, link: Callable[[str], str] = "".format) -> str:
    """HTML of a sentence; `link` gives the address of an equation's tag, or nothing."""

    def linked(match: re.Match) -> str:
        address = link(match[1])
        return f'<a href="{address}">{match[0]}</a>' if address else match[0]

    def plain(part: str) -> str:
        part = html.escape(part, quote=False).replace("'", "’")
        return re.sub(r"\((B?\d+)\)", linked, _CODE.sub(r"<code>\1</code>", part))

    text = _QUOTED.sub("“\\1”", text)
    text = "".join(mathml(words(part)) if math else plain(part) for math, part in _parts(text))
    return _WHOLE.sub(r'<span class="whole">\g<0></span>', text)


def to_latex(text: str) -> str:
    """LaTeX of a sentence."""

    def plain(part: str) -> str:
        part = "".join(_ESCAPES.get(letter, letter) for letter in part)
        return _CODE.sub(r"\\texttt{\1}", part)

    parts = _parts(_QUOTED.sub("“\\1”", text))
    text = "".join(f"${words(part)}$" if math else plain(part) for math, part in parts)
    return text.replace("“", "``").replace("”", "''")


def to_text(text: str) -> str:
    """A sentence for a terminal: c_x', mu, k^2."""
    for sign, plain in _PLAIN:
        text = text.replace(sign, plain)
    text = re.sub(r"\^\{(\w+/\w+)\}", r"^(\1)", text)
    text = re.sub(r"\\sqrt\{(.*?)\}", r"sqrt(\1)", text)
    return re.sub(r"\\mathrm|[\\${}]", "", text)
