"""Sentences with formulas between dollar signs, set as HTML, as LaTeX and as plain text.

In `the slip $u_0 > 0$ of (14)` the formula is LaTeX, and the number of an equation may become a
link. Between backquotes stands code.
"""

import html
import re
from collections.abc import Callable, Iterator

from .typeset import mathml, words

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
