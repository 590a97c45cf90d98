"""The derivation as one page to read (HTML with MathML, no script, no network) and as LaTeX.

`html` and `latex` follow the registry: each equation as printed in our copy and as derived, the
verdict with its evidence, then the generated functions with the rules that made them.
"""

import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from html import escape
from pathlib import Path

import sympy as sp

from . import codegen
from .presentation import presented
from .proof import Equation, Form
from .prose import left_hand_side, tex_escape, to_html, to_latex
from .references import Citation
from .registry import ENTRIES, SECTIONS, Row
from .rewrites import Body, Function, Step
from .typeset import is_wide, latex_lines, mathml, mathml_terms
from .typeset import latex as tex

Progress = Callable[[Iterable], Iterable]

TITLE = "Rods on a vibrated plate: the theory, derived again"
ABOUT = (
    "Every equation of Sections IV and V and of Appendix B of D. Volfson, A. Kudrolli and "
    "L. S. Tsimring, “Anisotropy driven dynamics in vibrated granular rods”, is derived here from "
    "Newton’s and Euler’s laws by computation, and so is what the text says there in numbers; "
    "of Appendix A the dimensions are checked. "
    "Each stands as printed in our copy and as derived, with a verdict that a proof has tested; "
    "our copy is a transcription, so a mistake in it need not be in the paper. "
    "Terms and factors are put in one order, and derived forms are rearranged to read like the "
    "printed ones; every rearrangement is checked to change no value."
)
VERDICTS = {  # sign, and what the word means
    "agrees": ("✓", "the difference of both forms simplifies to zero"),
    "rewritten": ("≈", "both forms are equal to 40 digits at random points"),
    "erratum": ("✗", "a mistake as printed in our copy: a point where both forms differ"),
    "assumed": ("◇", "an axiom or a closure: nothing to derive it from"),
    "new": ("★", "not in the paper; proved by a second route"),
}
NUMBERED = re.compile(r"(B?\d+)(?:: (.*))?")
_BY_TAG = {entry.tag: entry for entry in ENTRIES}
_FUNCTIONS = {function.name: function for function in codegen.FUNCTIONS}


@cache
def forms(tag: str) -> tuple[Form | None, Form]:
    """Printed and derived form of an equation, the latter rearranged."""
    entry = _BY_TAG[tag]
    assert isinstance(entry, Equation)
    return entry.printed, presented(entry.derive(), entry.printed)


@cache
def _body(name: str) -> tuple[Body, tuple[Step, ...]]:
    return _FUNCTIONS[name].body()


def anchor(tag: str) -> str:
    """The id of an entry in the page."""
    return "eq-" + re.sub(r"[^A-Za-z0-9]+", "-", tag).strip("-").lower()


def _name(tag: str, text: Callable[[str], str]) -> str:
    """(12) for 12, (B3), second line for B3: second line; other tags as they are."""
    found = NUMBERED.fullmatch(tag)
    if not found:
        return text(tag)
    return f"({found[1]})" + (f", {text(found[2])}" if found[2] else "")


def _split(symbol: str) -> tuple[str, bool]:
    """The left-hand side, and whether it is printed as positive (u_* > 0)."""
    return symbol.removesuffix(" > 0"), symbol.endswith(" > 0")


# ---- HTML -------------------------------------------------------------------------------------


def _link(tag: str) -> str:
    return f"#{anchor(tag)}" if tag in _BY_TAG else ""


def _text(sentence: str) -> str:
    return to_html(sentence, _link)


def _math(inner: str) -> str:
    return f'<math displaystyle="true">{inner}</math>'


def _equation(symbol: str | sp.Symbol, form: Form) -> str:
    """A form with its left-hand side, in a box that scrolls; long sums break between terms."""
    first, *more = mathml_terms(form)
    name, positive = _split(str(symbol))
    if not isinstance(form, sp.core.relational.Relational):
        left = left_hand_side(name) if isinstance(symbol, str) else mathml(symbol)
        first = f"{left}<mo>=</mo>{first}"
        if positive:
            more = [*more, '<mo form="infix" lspace="0.28em" rspace="0.28em">&gt;</mo><mn>0</mn>']
    return f'<div class="eq">{"<wbr>".join(_math(piece) for piece in (first, *more))}</div>'


def _badge(verdict: str, proved: bool = True) -> str:
    return (
        f'<span class="badge {verdict}"><span aria-hidden="true">{VERDICTS[verdict][0]}</span> '
        f"{verdict}</span>{'' if proved else ' <strong>not proved</strong>'}"
    )


def _place(figure: str, panel: str) -> str:
    if not figure:
        return "no figure or equation of the paper"
    name = f"({figure.removeprefix('eq. ')})" if figure.startswith("eq") else f"Fig. {figure}"
    return name + (f"({panel})" if panel else "")


def _remarks(row: Row) -> list[tuple[str, str]]:
    """What is said below an entry: (label, sentence)."""
    entry = _BY_TAG[row.tag]
    if isinstance(entry, Citation):
        found = [("There", row.evidence), ("Meant", _place(*entry.meant))]
    elif row.verdict == "erratum":
        counter, _, gives = row.evidence.partition("; the printed ")
        against = row.contradicted_by.rstrip(",")
        if gives:
            against += ": as printed, that gives the derived form"
        found = [("Counter-example", counter), ("Contradicted by", against)]
    else:
        found = [("Proof", row.evidence)]
    return [(label, text) for label, text in (*found, ("Note", row.note)) if text]


def _entry(row: Row) -> str:
    """One entry of the page."""
    badge = _badge(row.verdict, row.proved)
    parts = [f"<h3>{_name(row.tag, _text)} <span>{_text(row.what)}</span> {badge}</h3>"]
    if not isinstance(_BY_TAG[row.tag], Citation):
        printed, derived = forms(row.tag)
        symbol = _BY_TAG[row.tag].symbol
        how = "Assumed" if row.verdict == "assumed" else "As derived"
        two = {"As printed in our copy": printed, how: derived}
        if row.verdict == "assumed" and printed is not None:
            del two[how]
        wide = any(is_wide(form) for form in (printed, derived) if form is not None)
        shown = "".join(
            f'<div><p class="how">{label}</p>{_equation(symbol, form)}</div>'
            for label, form in two.items()
            if form is not None
        )
        parts.append(f'<div class="forms{" wide" * wide}">{shown}</div>')
    parts += [f"<p><b>{label}:</b> {_text(text)}</p>" for label, text in _remarks(row)]
    return f'<article id="{anchor(row.tag)}" class="{row.verdict}">{"".join(parts)}</article>'


def _function(function: Function) -> str:
    """A generated function: its assignments, and the rules with the operations they left."""
    body, steps = _body(function.name)
    why = ["", *(_text(rule.why) for rule in function.rules)]
    lines = "".join(_equation(symbol, expr) for symbol, expr in body.items())
    rules = "".join(
        f"<tr><td>{_text(step.rule)}</td><td>{reason}</td><td>{step.operations}</td></tr>"
        for step, reason in zip(steps, why, strict=True)
    )
    return (
        f'<article id="function-{function.name.replace("_", "-")}">'
        f"<h3><code>{function.name}</code></h3><p>{_text(function.summary)} "
        f"{_text(function.detail)}</p>{lines}<table><thead><tr><th>Rule</th><th>Why</th>"
        f"<th>Operations</th></tr></thead><tbody>{rules}</tbody></table></article>"
    )


def counted(verdicts: Iterable[str]) -> str:
    """How often each verdict is given, and what it means, as a table."""
    counts = Counter[str](verdicts)
    lines = "".join(
        f"<tr><td>{_badge(verdict)}</td><td>{meaning}</td><td>{counts[verdict]}</td></tr>"
        for verdict, (_, meaning) in VERDICTS.items()
        if counts[verdict]
    )
    return (
        "<table><thead><tr><th>Verdict</th><th>Meaning</th><th>Entries</th></tr></thead>"
        f"<tbody>{lines}</tbody></table>"
    )


def _summary(rows: Sequence[Row]) -> str:
    failed = sum(not row.proved for row in rows)
    outcome = f"{failed} of them not proved." if failed else "All of them are proved."
    mistakes = "".join(
        f'<li><a href="#{anchor(row.tag)}">{_name(row.tag, to_html)}</a> {_text(row.what)}'
        f" <small>{_text(row.note)}</small></li>"
        for row in rows
        if row.verdict == "erratum"
    )
    return (
        f'<section id="verdicts"><h2>Verdicts</h2><p>{len(rows)} entries. {outcome}</p>'
        f"{counted(row.verdict for row in rows)}"
        f'<h3 id="mistakes">Mistakes as printed in our copy</h3><ol>{mistakes}</ol></section>'
    )


def _contents(rows: Mapping[str, Row]) -> str:
    groups = "".join(
        f'<li><a href="#section-{n}">{_text(title)}</a><ul>'
        + "".join(
            f'<li><a href="#{anchor(e.tag)}">{_name(e.tag, to_html)}</a> {to_html(e.what)} '
            f"{_badge(e.verdict, rows[e.tag].proved)}</li>"
            for e in entries
        )
        + "</ul></li>"
        for n, (title, entries) in enumerate(SECTIONS, 1)
    )
    return (
        f'<nav aria-labelledby="contents"><h2 id="contents">Contents</h2><ol>{groups}'
        '<li><a href="#functions">Generated functions</a></li></ol></nav>'
    )


def document(title: str, about: str, main: str, style: str = "") -> str:
    """A whole page in the style of this one, with more `style` if given."""
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{STYLE}{style}</style></head><body>"
        f"<header><h1>{escape(title)}</h1><p>{escape(about)}</p></header>"
        f"<main>{main}</main></body></html>\n"
    )


def html(rows: Sequence[Row], progress: Progress = iter) -> str:
    """The page; `progress` may wrap the iteration over entries and functions."""
    by_tag = {row.tag: row for row in rows}
    made = {
        key: _entry(by_tag[key]) if key in by_tag else _function(_FUNCTIONS[key])
        for key in progress([*_BY_TAG, *_FUNCTIONS])
    }
    sections = "".join(
        f'<section id="section-{n}"><h2>{_text(title)}</h2>'
        f"{''.join(made[entry.tag] for entry in entries)}</section>"
        for n, (title, entries) in enumerate(SECTIONS, 1)
    )
    main = (
        f"{_summary(rows)}{_contents(by_tag)}{sections}"
        '<section id="functions"><h2>Generated functions</h2><p>What is computed comes from the '
        "derived forms by named rules; each rule is proved to change no value.</p>"
        f"{''.join(made[name] for name in _FUNCTIONS)}</section>"
    )
    return document(TITLE, ABOUT, main)


STYLE = """
:root { color-scheme: light; --rule: #d5d9de; --quiet: #4c5661; --link: #0b4f8a; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 62rem; padding: 1rem; color: #16191d; background: #fff;
  font: 1rem/1.5 system-ui, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif;
  overflow-wrap: break-word; }
h1 { font-size: 1.7rem; line-height: 1.2; }
h2 { margin: 2.5rem 0 .5rem; border-bottom: 2px solid var(--rule); }
h3 { margin: 0 0 .4rem; font-size: 1.05rem; line-height: 1.4; }
h3 > span:not(.badge) { font-weight: normal; }
a { color: var(--link); }
a:focus-visible { outline: 2px solid var(--link); outline-offset: 2px; }
p { margin: .3rem 0; }
small { color: var(--quiet); font-size: .9em; }
article { padding: .9rem 0; border-bottom: 1px solid var(--rule); scroll-margin-top: .5rem; }
article.erratum { border-left: 4px solid #d55e00; padding-left: .8rem; }
article:target { background: #fffbe6; }
.forms { display: grid; gap: 0 1.5rem;
  grid-template-columns: repeat(auto-fit, minmax(min(100%, 21rem), 1fr)); }
.forms > div { min-width: 0; }
.forms.wide { display: block; }
.how { margin-top: .5rem; color: var(--quiet); font-size: .88rem; }
.eq { padding: .35rem 0 .5rem; overflow-x: auto; overflow-y: hidden; }
.eq math { margin-block: .3rem; }
math { font-family: "Latin Modern Math", "STIX Two Math", "Cambria Math", "Noto Sans Math", math;
  font-size: 1.08rem; line-height: normal; }
mtd { padding: .25em .4em; }
var { font-family: "STIX Two Text", Cambria, "Times New Roman", serif; font-size: 1.05em; }
sub, sup { font-size: .72em; line-height: 0; }
.badge { display: inline-block; padding: 0 .45em; border: 1px solid; border-radius: .7em;
  font-size: .8rem; font-weight: 600; line-height: 1.5; white-space: nowrap; }
.agrees { --ink: #00543d; --paper: #e3f4ee; }
.rewritten { --ink: #0b4f8a; --paper: #e5f0fa; }
.erratum { --ink: #8c3800; --paper: #fdeadb; }
.assumed { --ink: #444b53; --paper: #eef0f2; }
.new { --ink: #6d2a58; --paper: #f8e9f3; }
.badge { color: var(--ink); background: var(--paper); border-color: currentcolor; }
table { width: 100%; margin: .5rem 0; border-collapse: collapse; font-size: .93rem; }
th, td { padding: .25rem .6rem .25rem 0; text-align: left; vertical-align: top;
  border-bottom: 1px solid var(--rule); }
th:last-child, td:last-child { padding-right: 0; text-align: right; }
#verdicts ol { padding-left: 1.8rem; }
nav > ol { padding-left: 1.4rem; }
nav ul { columns: 20rem 2; padding-left: .2rem; list-style: none; font-size: .93rem; }
nav ul > li { break-inside: avoid; }
li { margin: .2rem 0; }
code { font-size: .95em; }
@media print {
  @page { margin: 16mm 15mm; }
  html { font-size: 9.5pt; }
  body { max-width: none; padding: 0; }
  a { color: inherit; text-decoration: none; }
  .eq { overflow: visible; }
  h2, h3, .how { break-after: avoid; }
  article, tr { break-inside: avoid; }
  article { padding: .5rem 0; }
  article:target { background: none; }
}
"""


# ---- LaTeX ------------------------------------------------------------------------------------


def _tex_equation(symbol: str, form: Form, tag: str) -> str:
    """A displayed equation with its tag."""
    name, positive = _split(re.sub(r"_\{([a-z]{2,})\}", r"_{\\mathrm{\1}}", symbol))
    lines = latex_lines(form)
    if not isinstance(form, sp.core.relational.Relational):
        lines[0] = f"{name} &= {lines[0]}"
        lines[-1] += " > 0" * positive
    body = " \\\\\n  &\\quad ".join(lines)
    body = f"\\begin{{split}}\n  {body}\n\\end{{split}}"
    return f"\\begin{{equation}}\n{body}\n{tag}\n\\end{{equation}}\n"


def _tex_entry(tag: str, row: Row | None) -> str:
    entry = _BY_TAG[tag]
    name = _name(tag, to_latex)
    text = f"\\paragraph{{{name}}} {to_latex(entry.what)}: \\emph{{{entry.verdict}}}.\n"
    if not isinstance(entry, Citation):
        printed, derived = forms(tag)
        found = NUMBERED.fullmatch(tag)
        label = f"\\tag{{{tag}}}" if found and not found[2] else f"\\tag*{{{name}}}"
        if printed is not None:
            text += "As printed in our copy\n" + _tex_equation(entry.symbol, printed, label)
            label = "\\tag*{derived}"
        if printed is None or entry.verdict != "assumed":
            text += "As derived\n" * (printed is not None)
            text += _tex_equation(entry.symbol, derived, label)
    remarks = _remarks(row) if row else [("Note", entry.note)] if entry.note else []
    return text + "".join(f"{label}: {to_latex(said)}.\n\n" for label, said in remarks)


def _tex_function(function: Function) -> str:
    body, steps = _body(function.name)
    history = ", ".join(f"{to_latex(step.rule)} {step.operations}" for step in steps)
    lines = " \\\\\n".join(
        " \\\\\n&\\quad ".join((f"{tex(symbol)} &= {first}", *more))
        for symbol, (first, *more) in ((x, latex_lines(expr)) for x, expr in body.items())
    )
    return (
        f"\\paragraph{{{to_latex(f'`{function.name}`')}}} "
        f"{to_latex(function.summary)} {to_latex(function.detail)} Operations: {history}.\n"
        f"\\begin{{align*}}\n{lines}\n\\end{{align*}}\n"
    )


def latex(rows: Iterable[Row] = ()) -> dict[str, str]:
    """File name to text: one fragment a section, and all.tex, which compiles with them."""
    by_tag = {row.tag: row for row in rows}
    files = {}
    for n, (title, entries) in enumerate(SECTIONS, 1):
        slug = re.sub(r"[^a-z]+", "-", title.lower()).strip("-")
        blocks = "\n".join(_tex_entry(entry.tag, by_tag.get(entry.tag)) for entry in entries)
        files[f"{n:02d}-{slug}.tex"] = f"\\section{{{to_latex(title)}}}\n\n{blocks}"
    blocks = "\n".join(_tex_function(function) for function in _FUNCTIONS.values())
    files[f"{len(files) + 1:02d}-functions.tex"] = f"\\section{{Generated functions}}\n\n{blocks}"
    inputs = "\n".join(f"\\input{{{name}}}" for name in files)
    files["all.tex"] = (
        "\\documentclass[a4paper]{article}\n\\usepackage{amsmath}\n"
        "\\usepackage[margin=20mm]{geometry}\n\\setlength{\\parindent}{0pt}\n"
        f"\\allowdisplaybreaks\n\\title{{{tex_escape(TITLE)}}}\n\\author{{}}\n\\date{{}}\n"
        f"\\begin{{document}}\n\\maketitle\n{tex_escape(ABOUT)}\n\n{inputs}\n"
        "\\end{document}\n"
    )
    return files


def write(out: Path, rows: Sequence[Row], progress: Progress = iter) -> list[Path]:
    """Write report.html and latex/*.tex into `out`, each beside and renamed."""
    texts = {out / "report.html": html(rows, progress)}
    texts |= {out / "latex" / name: text for name, text in latex(rows).items()}
    for path, text in texts.items():
        codegen.write(text, path)
    return list(texts)
