"""The derivation as one page to read: HTML with MathML, no script, no network.

The page is for a lecture. It has the registry's sections with their text and drawings (module
`lecture`), and letters, exercises and references. Each equation has its steps, and its verdict in
the margin; both its printed and its derived form are shown only where they differ.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import sympy as sp
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from . import closed_forms, lecture, paper, typeset
from .drawings import DRAWINGS, WORDS
from .equality import Form, components
from .lecture import to_html
from .proof import Equation
from .registry import ENTRIES, SECTIONS, Entry, Progress, Row
from .steps import Reader
from .typeset import equation

TITLE, ABOUT = lecture.TEXTS["title"], lecture.TEXTS["about"]
VERDICTS = lecture.TEXTS["verdicts"]  # sign, and what the word means
PRINTED, TOLD = "As printed in our copy", "As our copy says"
_TAGS = {entry.tag for entry in ENTRIES}


def anchor(tag: str) -> str:
    """Id of an entry in the page."""
    return "eq-" + re.sub(r"[^A-Za-z0-9]+", "-", tag).strip("-").lower()


def _named(tag: str) -> str:
    """Name of a tag: (12) for 12, (B3), second line for B3: second line; others as they are."""
    return re.sub(r"^(B?\d+)(?=:|$)", r"(\1)", tag).replace("): ", "), ")


def forms(entry: Entry) -> Iterator[tuple[str, Form]]:
    """Labelled forms of an entry, the printed one first."""
    if not isinstance(entry, Equation):
        return
    if entry.printed is not None:
        yield PRINTED if entry.own else TOLD, entry.printed
    if entry.printed is None or entry.verdict == "erratum":
        yield "Assumed" if entry.verdict == "assumed" else "As derived", entry.readable()


def _lines_of(entry: Equation, label: str, form: Form) -> list[tuple[str, ...]]:
    """LaTeX of a form of an entry: the paper's own if it prints one, repaired where derived."""
    if not entry.own or (label != PRINTED and not entry.repair):
        values = components(form) if isinstance(form, sp.MatrixBase) else [form]
        pairs = dict.fromkeys(zip(map(typeset.words, entry.lefts), values, strict=True))
        return [equation(*pair) for pair in pairs]
    texts = [paper.EQUATIONS[tag].tex for tag in dict.fromkeys(entry.own)]
    for repair in entry.repair if label != PRINTED else ():
        texts = [repair.of(tex) for tex in texts]
    return [(tex,) for tex in texts]


# ---- HTML -------------------------------------------------------------------------------------


def _sentence(text: str, links: bool = True) -> Markup:
    return Markup(to_html(text, lambda tag: f"#{anchor(tag)}" if links and tag in _TAGS else ""))


_html = Environment(loader=PackageLoader(__package__), undefined=StrictUndefined, autoescape=True)
_html.filters |= {
    "anchor": anchor,
    "tex": typeset.latex,
    "inline": lambda tex: Markup(typeset.mathml(tex)),
    "math": lambda tex: Markup(typeset.mathml(tex, display=True)),
    "named": _named,
    "sentence": _sentence,
}
_html.globals |= {
    "verdicts": VERDICTS,
    "forms": forms,
    "lines_of": _lines_of,
    "equation": equation,
}
STYLE = paper.text_of("templates/page.css")


def _page(template: str, title: str, about: str, style: str = "", **values: Any) -> str:
    return _html.get_template(template).render(
        title=title, about=_sentence(about), style=Markup(STYLE + style), **values
    )


def document(title: str, about: str, main: str, style: str = "") -> str:
    """HTML of a whole page in the style of the report, with more CSS in `style` if given."""
    return _page("page.html", title, about, style, main=Markup(main)) + "\n"


def counted(verdicts: Iterable[str]) -> str:
    """Table in HTML of how often each verdict is given and what it means."""
    return _html.get_template("verdicts.html").render(counts=Counter(verdicts)).strip()


def prepared() -> dict[str, Any]:
    """Parts of the page that need no proof: steps by equations' tags, SVG drawings by names."""
    equations = [x for x in ENTRIES if isinstance(x, Equation)]
    reader = Reader(equations)
    return {
        "steps": {x.tag: reader.lines(x) for x in equations},
        "svg": {name: drawing.svg() for name, drawing in DRAWINGS.items()},
    }


def html(rows: Sequence[Row], prepared: Mapping[str, Any], progress: Progress = iter) -> str:
    """HTML of the report, made of the rows of all proofs and what `prepared` returns.

    `progress` may wrap the iteration over entries and functions.
    """
    failed = sum(row.failed for row in rows)
    return _page(
        "report.html",
        TITLE,
        ABOUT,
        rows={row.tag: row for row in rows},
        outcome=f"{failed} of them not proved." if failed else "No verdict failed.",
        counts=Counter(row.verdict for row in rows),
        sections=SECTIONS,
        functions=closed_forms.FUNCTIONS,
        lecture=lecture,
        words=WORDS,
        drawings=DRAWINGS,
        progress=progress,
        **prepared,
    )
