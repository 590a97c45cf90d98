"""The derivation as one page to read (HTML with MathML, no script, no network) and as LaTeX.

`html` is for a lecture: the registry's sections with their text and drawings (`lecture`), each
equation with its steps, in print only where that differs, and its verdict in the margin; letters,
exercises, references. `latex` holds the entries alone.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from importlib import resources
from pathlib import Path
from typing import Any

import sympy as sp
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from . import closed_forms, codegen, lecture, paper, typeset
from .drawings import DRAWINGS
from .equality import Form
from .exercises import EXERCISES
from .files import write as write_file
from .lecture import LETTERS, to_html, to_latex
from .proof import Equation
from .registry import SECTIONS, Code, Entry, Row
from .steps import Reader

Progress = Callable[[Iterable], Iterable]

TITLE, ABOUT = lecture.TEXTS["title"], lecture.TEXTS["about"]
VERDICTS = {  # sign, and what the word means
    "agrees": ("✓", "the difference of both forms simplifies to zero"),
    "rewritten": ("≈", "both forms are equal to 40 digits at random points"),
    "erratum": ("✗", "a mistake as printed in our copy: a point where both forms differ"),
    "assumed": ("◇", "an axiom or a closure: nothing to derive it from"),
    "new": ("★", "not in the paper; proved by a second route"),
    "noted": ("✎", "words or a citation of the paper, quoted; nothing is proved of it"),
}
PRINTED = "As printed in our copy"
_NUMBERED = re.compile(r"(B?\d+)(?:: (.*))?")
_TAGS = {entry.tag for _, entries in SECTIONS for entry in entries}


def anchor(tag: str) -> str:
    """Id of an entry in the page."""
    return "eq-" + re.sub(r"[^A-Za-z0-9]+", "-", tag).strip("-").lower()


def _named(tag: str) -> str:
    """(12) for 12, (B3), second line for B3: second line; others with their letters as formulas."""
    found = _NUMBERED.fullmatch(tag)
    if found:
        return f"({found[1]})" + (f", {found[2]}" if found[2] else "")
    return tag


def forms(entry: Entry) -> list[tuple[str, Form]]:
    """Labelled forms of an entry, the printed one first."""
    if not isinstance(entry, Equation):
        return []
    found = [] if entry.printed is None else [(PRINTED, entry.printed)]
    if entry.printed is None or entry.verdict == "erratum":
        how = "Assumed" if entry.verdict == "assumed" else "As derived"
        found.append((how, entry.readable()))
    return found


def _lines_of(entry: Equation, label: str, form: Form, align: str = "") -> list[list[str]]:
    """LaTeX of a form of an entry: the paper's own where it is printed, with the repairs made."""
    own = entry.formulas and entry.said is None and entry.tag not in paper.SENTENCES
    if own and (label == PRINTED or entry.repair):
        texts = [paper.EQUATIONS[tag].tex for tag in dict.fromkeys(entry.formulas)]
        if label != PRINTED:
            for repair in entry.repair:
                texts = [repair.of(tex) for tex in texts]
        return [[paper.aligned(tex, align)] for tex in texts]
    return equations(entry.left, form, align)


def _program(entry: Entry) -> str:
    """Text of the code that an entry proves; of other entries nothing."""
    return entry.text if isinstance(entry, Code) else ""


def equations(left: str | sp.Symbol, form: Form, align: str = "") -> list[list[str]]:
    """LaTeX of a form with its left-hand side; a column of values as one equation each."""
    if not isinstance(form, sp.MatrixBase):
        return [equation(left, form, align)]
    parts = paper.parts(str(left))
    if len(parts) == len(form):
        return [equation(part, x, align) for part, x in zip(parts, form, strict=True)]
    return [equation(left, form[0] if len(set(form)) == 1 else form, align)]


def equation(left: str | sp.Symbol, form: Form, align: str = "") -> list[str]:
    """LaTeX of a form with its left-hand side, in pieces between which a line may break."""
    first, *more = typeset.pieces(form)
    if isinstance(form, sp.core.relational.Relational):
        return [align + first, *more]
    shown = typeset.words(left) if isinstance(left, str) else typeset.latex(left)
    return [f"{shown} {align}= {first}", *more]


def _remarks(row: Row) -> list[tuple[str, str]]:
    """Labelled sentences below an entry."""
    found = {
        "Repair": row.repair,
        "Mistake": row.mistake,
        "Contradicted by": ", ".join(map(_named, row.contradicted_by)),
        "Note": row.note,
    }
    return [(label, text) for label, text in found.items() if text]


def _proof(row: Row) -> list[tuple[str, str]]:
    """Labelled sentences beside an entry."""
    found = {
        "Counter-example" if row.verdict == "erratum" else "Proof": row.evidence,
        "Rests on": ", ".join(map(_named, row.rests_on)),
    }
    return [(label, text) for label, text in found.items() if text]


# ---- HTML -------------------------------------------------------------------------------------


def _sentence(text: str, links: bool = True) -> Markup:
    known = _TAGS if links else set()
    return Markup(to_html(text, lambda tag: f"#{anchor(tag)}" if tag in known else ""))


def _environment(**options: Any) -> Environment:
    """Jinja environment over the templates of this package."""
    loader = PackageLoader(__package__)
    made = Environment(loader=loader, undefined=StrictUndefined, **options)
    made.globals |= {"forms": forms, "lines_of": _lines_of, "equations": equations}
    made.globals |= {"remarks": _remarks, "proof": _proof, "program": _program}
    return made


_html = _environment(autoescape=True)
_html.filters |= {
    "anchor": anchor,
    "inline": lambda tex: Markup(typeset.mathml(tex)),
    "math": lambda tex: Markup(typeset.mathml(tex, display=True)),
    "named": lambda tag: _sentence(_named(tag), links=False),
    "sentence": _sentence,
}
_html.globals["verdicts"] = VERDICTS
STYLE = resources.files(__package__).joinpath("templates/page.css").read_text(encoding="utf-8")


def _page(template: str, title: str, about: str, style: str = "", **values: Any) -> str:
    return _html.get_template(template).render(
        title=title, about=_sentence(about), style=Markup(STYLE + style), **values
    )


def document(title: str, about: str, main: str, style: str = "") -> str:
    """Return a whole page in the style of this one, with more `style` if given."""
    return _page("page.html", title, about, style, main=Markup(main)) + "\n"


def counted(verdicts: Iterable[str]) -> str:
    """How often each verdict is given, and what it means, as a table in HTML."""
    return _html.get_template("verdicts.html").render(counts=Counter(verdicts)).strip()


def html(rows: Sequence[Row], progress: Progress = iter) -> str:
    """Return the page; `progress` may wrap the iteration over entries and functions."""
    by_tag = {row.tag: row for row in rows}
    failed = sum(row.failed for row in rows)
    equations = [x for _, entries in SECTIONS for x in entries if isinstance(x, Equation)]
    reader = Reader(equations)
    return _page(
        "report.html",
        TITLE,
        ABOUT,
        rows=rows,
        outcome=f"{failed} of them not proved." if failed else "All verdicts are proved.",
        counts=Counter(row.verdict for row in rows),
        sections=[(title, [(e, by_tag[e.tag]) for e in entries]) for title, entries in SECTIONS],
        functions=[(f, *codegen.body(f.name)) for f in closed_forms.FUNCTIONS],
        steps={x.tag: reader.lines(x) for x in equations},
        parts=lecture.PARTS,
        drawings=DRAWINGS,
        letters=LETTERS,
        exercises=EXERCISES,
        references=lecture.REFERENCES,
        progress=progress,
    )


# ---- LaTeX ------------------------------------------------------------------------------------


def _label(tag: str, first: bool) -> str:
    """LaTeX tag of a form: the equation's number or name at the first form, else `derived`."""
    if not first:
        return r"\tag*{derived}"
    return (
        rf"\tag{{{tag}}}"
        if tag in _TAGS and tag.isalnum()
        else rf"\tag*{{{to_latex(_named(tag))}}}"
    )


_tex = _environment(
    block_start_string="<%",
    block_end_string="%>",
    variable_start_string="<<",
    variable_end_string=">>",
    comment_start_string="<#",
    comment_end_string="#>",
)
_tex.filters |= {"label": _label, "named": lambda tag: to_latex(_named(tag)), "sentence": to_latex}


def latex(rows: Sequence[Row]) -> dict[str, str]:
    """File name to text: one fragment a section, and all.tex, which compiles with them."""
    by_tag = {row.tag: row for row in rows}
    render = partial(_tex.get_template("section.tex.jinja").render, functions=(), entries=())
    files = {}
    for n, (title, entries) in enumerate(SECTIONS, 1):
        slug = re.sub(r"[^a-z]+", "-", title.lower()).strip("-")
        pairs = [(entry, by_tag[entry.tag]) for entry in entries]
        files[f"{n:02d}-{slug}.tex"] = render(title=title, entries=pairs)
    functions = [(f, *codegen.body(f.name)) for f in closed_forms.FUNCTIONS]
    name = f"{len(files) + 1:02d}-functions.tex"
    files[name] = render(title="Generated functions", functions=functions)
    whole = _tex.get_template("all.tex.jinja")
    return files | {"all.tex": whole.render(title=TITLE, about=ABOUT, inputs=files)}


def write(out: Path, rows: Sequence[Row], progress: Progress = iter) -> list[Path]:
    """Write report.html and latex/*.tex into `out`, each beside and renamed."""
    texts = {out / "report.html": html(rows, progress)}
    texts |= {out / "latex" / name: text for name, text in latex(rows).items()}
    for path, text in texts.items():
        write_file(text, path)
    return list(texts)
