"""The report: complete, well-formed, self-contained, and of the same value as what was derived."""

import os
import re
from dataclasses import replace
from multiprocessing import Pool
from xml.etree import ElementTree

import numpy as np
import pytest
import sympy as sp
from matplotlib.colors import to_hex, to_rgb
from matplotlib.text import Annotation

from derivations import (
    __main__,
    closed_forms,
    drawings,
    lecture,
    paper,
    registry,
    report,
    slide,
    steps,
    texts,
    typeset,
)
from derivations.equality import components, equal, equal_at_random_points
from derivations.lookup import entry_of
from derivations.proof import told
from impact import classify, collide, thin_rod

from .page import Page, plain, stands_alone
from .test_derivations import EQUATIONS, each_entry, each_equation, proved

CHILDREN = {"mfrac": 2, "msub": 2, "msup": 2, "mroot": 2, "msubsup": 3, "mover": 2, "munderover": 3}
KNOWN = {"math", "mrow", "mi", "mn", "mo", "mspace", "msqrt", "mtable", "mtr", "mtd", *CHILDREN}
each_function = pytest.mark.parametrize("function", closed_forms.FUNCTIONS)


@pytest.fixture(scope="module")
def rows():
    return registry.check(over=lambda _, numbers: map(proved, numbers))


@pytest.fixture(scope="module")
def prepared():
    return report.prepared()


@pytest.fixture(scope="module")
def lines(prepared):
    return prepared["steps"]


@pytest.fixture(scope="module")
def source(rows, prepared):
    return report.html(rows, prepared)


@pytest.fixture(scope="module")
def page(source):
    return Page(source)


def test_needs_nothing_from_outside(source, page):
    """Every link leads to a place of the page."""
    stands_alone(source, page)
    assert not page.images
    assert set(page.links) <= {f"#{name}" for name in page.ids}
    assert len(page.links) > 2 * len(registry.ENTRIES)


@each_entry
def test_every_entry_is_there_with_its_verdict_and_evidence(page, entry):
    text = page.text[report.anchor(entry.tag)]
    row = proved(registry.ENTRIES.index(entry))
    sign, _ = report.VERDICTS[entry.verdict]
    assert f"{sign} {entry.verdict}" in text
    assert all(plain(said) in text for said in (entry.what, told(entry), row.evidence))
    printed = report.PRINTED if getattr(entry, "own", ()) else report.TOLD
    for label in (printed, "As derived"):  # both, or one form alone
        assert (label in text) == (entry.verdict == "erratum")
    shown = {
        "Repair": [row.repair],
        "Mistake": [row.mistake],
        "Rests on": getattr(entry, "rests_on", ()),
        "Contradicted by": getattr(entry, "contradicted_by", ()),
    }
    for label, said in shown.items():
        words = ", ".join(map(report._named, said))
        assert not words or f"{label}: {plain(words)}" in text


@each_equation
def test_what_is_shown_as_printed_is_the_printed_form(entry):
    names = report.PRINTED, report.TOLD
    printed = [form for label, form in report.forms(entry) if label in names]
    assert printed == [entry.printed] * (entry.printed is not None)


def test_a_failed_proof_is_not_hidden(rows, prepared):
    source = report.html([replace(rows[0], proved=False), *rows[1:]], prepared)
    assert "1 of them not proved." in source
    assert "<strong>not proved</strong>" in source
    assert "No verdict failed" not in source


def test_mathml_is_what_browsers_know(source):
    found = re.findall(r"<math\b.*?</math>", source, re.DOTALL)
    assert len(found) > 2 * len(EQUATIONS)
    for math in found:
        for element in ElementTree.fromstring(math).iter():
            assert element.tag in KNOWN
            assert len(element) == CHILDREN.get(element.tag, len(element))
            text = element.text or ""
            assert not set(text) & set("\\_^&{}'")
            assert text or len(element) or element.tag in {"mspace", "mrow"}


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("Newton's slip", "Newton’s slip"),
        ('"a" < 1 & (12)', '“a” &lt; 1 &amp; <a href="#12">(12)</a>'),
        ("Fig. 6(b), c_x and `drift`", "Fig. 6(b), c_x and <code>drift</code>"),
        ("$-u$ of", "<math><mrow><mo>&#x02212;</mo><mi>u</mi></mrow></math> of"),
        (r"$\mu_x'$", "<math><mrow><msubsup><mi>&#x003BC;</mi><mi>x</mi><mi>&#x02032;</mi>"),
    ],
)
def test_sentences_in_html(given, expected):
    assert lecture.to_html(given, "#{}".format).startswith(expected)


def test_sentences_for_a_terminal():
    text = r"$\mu \ge 0$, $gain = \sqrt{k_a^{3/2}}$, 5 & 6"
    assert lecture.to_text(text) == "mu >= 0, gain = sqrt(k_a^(3/2)), 5 & 6"


@each_entry
def test_formulas_in_sentences_are_marked(entry, lines):
    """Formulas stand between dollar signs; outside there is neither an index nor LaTeX."""
    for text in (entry.what, told(entry), *(line.text for line in lines.get(entry.tag, ()))):
        words = "".join(text.split("$")[::2])
        assert not re.search(r"\w_\w|\^|\\|\b(mu|phi|epsilon|omega)\b", words)


def test_a_form_that_has_not_the_derived_value_is_refused():
    entry = entry_of("21")
    assert not replace(entry, shown=entry.printed).prove().ok


def read_back(form):
    """Components of a form, as a reader of their LaTeX has them."""
    tex = ["".join(typeset.pieces(part)) for part in components(form)]
    letters = {typeset.latex(letter): letter for letter in form.atoms(sp.Symbol)}
    return [paper.read(one, letters | {r"\pi": sp.pi}) for one in tex]


@each_equation
def test_what_can_be_read_is_what_is_meant(entry):
    if entry.derive().has(sp.beta):
        pytest.skip("the grammar of SymPy's parser has no beta function")
    for _, form in report.forms(entry):
        for read, part in zip(read_back(form), components(form), strict=True):
            assert equal_at_random_points(read.doit(), part.doit())


def read_line(tex, letters):
    """Both sides of an equation of the page."""
    return [paper.read(side, letters) for side in "".join(tex).split(" = ")]


def test_a_solved_equation_is_shown_as_it_is():
    """It or its numerator is shown, up to a factor: the same at any two values of the unknown."""
    taken = texts._steps([step for entry in EQUATIONS for step in entry.steps], set())
    shown = 0
    for step in dict.fromkeys(step for step, _ in taken if step.kind == "solved"):
        (unknown, *_), value = step.given, sp.Rational(7, 3)
        for tex, (left, right) in zip(steps._solved(step).formulas, step.value, strict=False):
            true = left - right
            letters = {typeset.latex(x): x for x in true.free_symbols}
            if any("phi}" in name for name in letters):  # tan(phi) as an unknown
                continue
            one, other = read_line(tex, letters)
            found, shown = one - other, shown + 1
            assert found.has(unknown)
            there = found.subs(unknown, value)
            assert any(
                equal_at_random_points(found * form.subs(unknown, value), there * form)
                for form in (true, sp.numer(sp.together(true)))
            )
    assert shown > 20


@pytest.mark.parametrize("entry", [x for x in EQUATIONS if x.repair and x.own])
def test_what_is_shown_as_derived_has_all_repairs(entry):
    lines = report._lines_of(entry, "As derived", entry.readable())
    forms = [
        read_line(tex, paper.LETTERS)[-1].subs(entry.put(), simultaneous=True) for tex in lines
    ]
    assert all(map(equal, forms, components(entry.derive())))
    assert report.equation("u", entry.readable())[0].startswith("u = ")


@each_function
def test_what_can_be_read_of_a_function_is_what_is_generated(function):
    body, _ = function.body
    for expr in body.values():
        (read,) = read_back(sp.sympify(expr))
        assert equal_at_random_points(read, expr)


@each_function
def test_functions_show_rules_reasons_and_operations(page, function):
    _, counts = function.body
    text = page.text[f"function-{function.name.replace('_', '-')}"]
    assert text.startswith(function.name)
    assert plain(function.words["summary"]) in text
    for rule, operations in counts.items():
        assert plain(rule) in text
        assert str(operations) in text
    for rule in function.rules:
        assert plain(rule.why) in text


@pytest.mark.parametrize("drawing", drawings.DRAWINGS.values())
def test_drawings_are_in_the_page(source, page, prepared, drawing):
    svg = prepared["svg"][drawing.name]
    assert ElementTree.fromstring(svg).get("aria-label") == drawing.title
    assert svg in source
    assert plain(drawing.caption) in page.text[f"drawing-{drawing.name}"]


@pytest.mark.parametrize("regime", drawings.IMPACTS)
def test_a_path_ends_where_the_impact_does_under_each_law(regime):
    """It does as it is drawn, between edges with their labels, below the tilt that it has.

    The path turns where the slip stops; Newton's end is the highest, Poisson's the lowest.
    """
    tilt, slip = drawings.IMPACTS[regime]
    plane, *_ = drawings.impulses(regime).axes
    lines = {line.get_label(): line.get_xydata() for line in plane.lines}
    assert f"{tilt}°" in plane.get_title()
    assert [plane.get_xlabel()[:4], plane.get_ylabel()[:4]] == ["$P_x", "$P_z"]
    corner, ends = drawings.path(regime)
    assert lines["path"][1] == pytest.approx(corner)
    assert corner[0] == pytest.approx(-drawings.FRICTION * corner[1])
    if regime != "slide":
        left = slide.slip_velocity(sp.Float(corner[1]))
        assert drawings._number(left, drawings._at(regime)) == pytest.approx(0)
        assert corner[1] < ends["poisson"][1] < ends["stronge"][1] < ends["newton"][1]
    for law in drawings.MARKERS:
        hit = collide(
            slip,
            -1.0,
            geometry=thin_rod(np.radians(tilt)),
            friction=drawings.FRICTION,
            restitution=drawings.RESTITUTION,
            law=law,
        )
        (end,) = lines[f"end: {law.title()}"]
        assert tuple(end) == pytest.approx((hit.P_x, hit.P_z))
    for sign, slope in (("-", -1), ("", 1)):
        (edge,) = (xy for label, xy in lines.items() if label.startswith(f"$P_x = {sign}\\mu"))
        assert edge[1, 0] / edge[1, 1] == pytest.approx(slope * drawings.FRICTION)


def test_words_of_the_drawings_and_their_prose():
    assert (
        drawings.WORDS.items()
        >= {
            "slips": "between",
            "sticks": "outside of",
            "against": "against",
            "ahead": "+x",
            "edge": "left",
            "back": "right",
            "push": "forward",
            "approach": 2,
            "landing": 0.65,
        }.items()
    )
    for name, largest in (("blue", 2), ("orange", 0)):
        assert np.argmax(to_rgb(drawings.COLORS[name])) == largest


@pytest.mark.parametrize(("regime", "wrong"), [("slide", (30, 0.6)), ("slip reversal", (8, 0.8))])
def test_an_impact_of_another_regime_has_no_path(monkeypatch, regime, wrong):
    monkeypatch.setitem(drawings.IMPACTS, regime, wrong)
    with pytest.raises(ValueError, match=regime):
        drawings.path(regime)


def test_letters_stand_beside_what_they_mean():
    """Each letter stands once; an arrow of x or z lies along that axis."""
    axes, *_ = drawings.geometry().axes
    words = [text.get_text() for text in axes.texts if text.get_text().count("$") == 2]
    assert np.hypot(*axes.lines[0].get_xydata()[1]) == pytest.approx(2)  # the rod, l = 2
    arrows = [text for text in axes.texts if isinstance(text, Annotation)]
    letters = r"\phi l X Z F_{z} F_{x} z x V_{z} c_{x} c_{z} \omega"
    assert words == [f"${letter}$" for letter in letters.split()]
    for word, arrow in zip(words[4:-1], arrows[:-1], strict=True):
        along = np.subtract(arrow.xy, arrow.xyann)
        assert list(along != 0) == ["x" in word, "z" in word]
        assert (along.sum() < 0) == (word == "$F_{x}$")  # friction of forward slip
    assert arrows[-1].xy[0] > arrows[-1].xyann[0]  # the top turns towards +x
    assert (axes.patches[0].theta1, axes.patches[0].theta2) == pytest.approx((60, 90))


def test_colours_of_a_caption_are_those_of_the_lines():
    axes, *_ = drawings.regimes().axes
    drawn = [line for line in axes.collections if not line.get_fill()]
    assert axes.lines[0].get_xydata()[0] == pytest.approx((np.degrees(np.arctan(2)), 0.75))
    assert "degrees" in axes.get_xlabel()
    caption = drawings.DRAWINGS["regimes"].caption
    for line, tag in zip(drawn, ("14", "16"), strict=True):
        (color,) = (x for x, y in drawings.COLORS.items() if to_hex(line.get_edgecolor()[0]) == y)
        assert f"{color}: {entry_of(tag).what} ({tag})" in caption
    for text in axes.texts:
        tilt, friction = text.get_position()
        rod = thin_rod(np.radians(tilt))
        regime = classify(1.0, -2.0, geometry=rod, friction=friction, restitution=0.65)
        assert text.get_text().replace("-", " ").upper() == regime.name.replace("_", " ")


@each_equation
def test_no_fraction_stands_in_a_fraction(entry):
    """Forms have no fraction in a fraction, nor a power with a minus sign."""
    for _, form in report.forms(entry):
        for tex in map(typeset.latex, components(form)):
            assert not ElementTree.fromstring(typeset.mathml(tex)).findall(".//mfrac//mfrac")
            assert "^{-" not in tex


def test_steps_lead_to_the_entry(page, lines):
    """Steps show what was put in, what was solved, and link to the entries on the way."""
    parting = next(line for line in lines["8"] if "parts at" in line.text)
    assert parting.formulas[0][-1].endswith(r"= -\epsilon v_{0}")
    assert ("8", "9") in {line.tags for line in lines["12"]}
    assert "solved for" in page.text[report.anchor("8")]
    for tag, first in (("9", "8"), ("13", "12"), ("B1", "15"), ("B5", "B4"), ("19", "18")):
        assert lines[tag][-1].tags == (first,)  # what the other shows is cited
        assert not any(line.formulas for line in lines[tag])
    assert [line.tags for line in lines["24"]].count(("V: closure",)) == 1
    assert not lines["IV: restitution"]


@each_equation
def test_every_step_has_a_sentence_and_an_equation(entry, lines):
    """A step cites an entry, or shows an equation with a left side; the last may be the result."""
    steps = lines[entry.tag]
    assert steps or not entry.tag.isdigit() or entry.tag == "1"
    for line in steps:
        assert line.text
        assert line.tags or all("=" in "".join(tex) for tex in line.formulas)
        assert line.formulas or line.tags or line == steps[-1]


def test_every_section_with_equations_has_its_text(source):
    paragraphs = [text for part in lecture.PARTS.values() for text in part.text]
    for text in paragraphs:
        assert str(report._sentence(text % drawings.WORDS)) in source
    assert not re.search(r"\(B?\d+:", source)  # what an equation is about is left out
    drawn = [name for part in lecture.PARTS.values() for name in part.drawings]
    assert drawn == list(drawings.DRAWINGS)
    whole = " ".join(paragraphs)
    for reference in lecture.REFERENCES:
        name = re.match(r"(?:[A-Z]\. )+(\w+)", reference)[1]
        assert name in whole + report.ABOUT
    for name, year in re.findall(r"(\w+) \(?(\d{4})\)", whole):
        assert any(name in x and f"({year})" in x for x in lecture.REFERENCES)


def test_processes_that_prove_are_in_groups_of_their_own():
    """A signal to the group of the command, which ends it, would leave its pool without workers."""
    with Pool(1, __main__._leave_signals) as pool:
        assert pool.apply(os.getpgrp) != os.getpgrp()
