"""The report: complete, well-formed, self-contained, and of the same value as what was derived."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import pytest
import sympy as sp

from derivations import codegen, presentation, prose, registry, report, typeset
from derivations.proof import components, equal_at_random_points, same
from derivations.references import Citation
from derivations.symbols import X, Z, c_x, mu, omega, v_0

from .page import Page, plain

CHILDREN = {"mfrac": 2, "msub": 2, "msup": 2, "msubsup": 3, "mover": 2}
KNOWN = {"math", "mrow", "mi", "mn", "mo", "mspace", "msqrt", "mtable", "mtr", "mtd", *CHILDREN}
EQUATIONS = [e for e in registry.ENTRIES if not isinstance(e, Citation)]
ERRATA = registry.mistakes()


@pytest.fixture(scope="module")
def rows():
    return registry.check()


@pytest.fixture(scope="module")
def source(rows):
    return report.html(rows)


@pytest.fixture(scope="module")
def page(source):
    return Page(source)


@pytest.fixture(scope="module")
def maths(source):
    found = re.findall(r"<math .*?</math>", source, re.DOTALL)
    assert len(found) > 2 * len(EQUATIONS)
    return [ElementTree.fromstring(math) for math in found]


@pytest.fixture(scope="module")
def fragments(rows):
    return report.latex(rows)


def test_says_first_what_it_is(source, fragments):
    assert f"<h1>{report.TITLE}</h1><p>{report.ABOUT}</p>" in source
    assert f"\n{prose.tex_escape(report.ABOUT)}\n" in fragments["all.tex"]


def test_needs_nothing_from_outside(source, page):
    assert source.startswith('<!DOCTYPE html>\n<html lang="en">')
    assert '<meta name="viewport"' in source
    assert "http:" not in source
    assert "https:" not in source
    assert not re.search(r"<(script|link|img|iframe|object)\b|url\(|@import|\son\w+=", source)
    assert all(link.startswith("#") for link in page.links)


def test_every_link_has_its_place(page):
    assert len(page.ids) == len(set(page.ids))
    assert {link[1:] for link in page.links} <= set(page.ids)
    assert len(page.links) > 2 * len(registry.ENTRIES) - len(ERRATA)


def test_headings_leave_out_no_level(page):
    assert page.headings[0] == 1
    assert page.headings.count(1) == 1
    pairs = zip(page.headings, page.headings[1:], strict=False)
    assert all(after <= before + 1 for before, after in pairs)


@pytest.mark.parametrize("entry", registry.ENTRIES, ids=lambda entry: entry.tag)
def test_every_entry_is_there_with_its_verdict(page, entry):
    text = page.text[report.anchor(entry.tag)]
    sign, _ = report.VERDICTS[entry.verdict]
    assert f"{sign} {entry.verdict}" in text
    assert plain(entry.what) in text
    assert plain(entry.note) in text
    assert ("As printed in our copy" in text) == (entry.printed is not None)
    derived = "As derived" in text or "Assumed" in text or entry.tag == "1"
    assert derived or isinstance(entry, Citation)


def test_entries_come_in_the_order_of_the_paper(page):
    anchors = [report.anchor(entry.tag) for entry in registry.ENTRIES]
    assert [name for name in page.text if name in set(anchors)] == anchors


def test_verdicts_are_counted(source):
    for verdict in {entry.verdict for entry in registry.ENTRIES}:
        count = sum(entry.verdict == verdict for entry in registry.ENTRIES)
        assert re.search(rf"{verdict}</span></td><td>[^<]+</td><td>{count}</td>", source)
    assert "All of them are proved." in source


def test_a_failed_proof_is_not_hidden(rows):
    source = report.html([replace(rows[0], proved=False), *rows[1:]])
    assert "1 of them not proved." in source
    assert "<strong>not proved</strong>" in source
    assert "All of them" not in source


@pytest.mark.parametrize("entry", ERRATA, ids=lambda entry: entry.tag)
def test_every_erratum_shows_its_evidence(page, rows, entry):
    (row,) = (row for row in rows if row.tag == entry.tag)
    text = page.text[report.anchor(entry.tag)]
    assert plain(row.evidence.split("; the printed ")[0]) in text
    if isinstance(entry, Citation):
        assert f"Meant: {report._place(*entry.meant)}" in text
    else:
        assert re.search(r"printed \S+, derived \S+", text)
        assert plain(entry.contradicted_by.rstrip(",")) in text
        assert ("gives the derived form" in text) == (entry.contradiction is not None)


def test_mathml_is_what_browsers_know(maths):
    for math in maths:
        for element in math.iter():
            assert element.tag in KNOWN, element.tag
            assert len(element) == CHILDREN.get(element.tag, len(element))
            text = element.text or ""
            assert not set(text) & set("\\_^&{}'"), text
            assert text not in prose._GREEK, text
            assert text or len(element) or element.tag in {"mspace", "mrow"}


def test_letters_come_with_their_indices():
    assert typeset.mathml(c_x) == "<msub><mi>c</mi><mi>x</mi></msub>"
    assert typeset.mathml(mu) == "<mi>μ</mi>"
    assert typeset.mathml(sp.Symbol("N_back")) == "<msub><mi>N</mi><mi>back</mi></msub>"
    assert typeset.mathml(v_0**2) == "<msubsup><mi>v</mi><mi>0</mi><mn>2</mn></msubsup>"
    assert prose.left_hand_side("c_x'") == (
        "<mrow><msubsup><mi>c</mi><mi>x</mi><mo>′</mo></msubsup></mrow>"
    )
    assert "&lt;" in typeset.mathml(X < Z)


@pytest.mark.parametrize("symbol", sorted({e.symbol for e in EQUATIONS}))
def test_left_hand_sides_leave_no_latex(symbol):
    inner = prose.left_hand_side(symbol)
    ElementTree.fromstring(inner)
    assert not re.search(r"[\\{}_^']", inner)


def test_unknown_latex_is_not_let_through():
    with pytest.raises(KeyError):
        prose.left_hand_side("\\nonsense_x")


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("-u_0 - k^2", "−<var>u</var><sub>0</sub> − <var>k</var><sup>2</sup>"),
        ("c_x' of a rod", "<var>c</var><sub><var>x</var></sub>′ of a rod"),
        ("Newton's mu_rw", "Newton’s <var>μ</var><sub>rw</sub>"),
        ('"a" < 1 & (12)', '“a” &lt; 1 &amp; <a href="#12">(12)</a>'),
        ("Fig. 6(b), slip-stick", "Fig. 6(b), slip-stick"),
        ("(a, b), (f): 3 cm/s, Sections IV and V", "(a, b), (f): 3 cm/s, Sections IV and V"),
        ("w in m/s, N in m^2.", "<var>w</var> in m/s, <var>N</var> in m<sup>2</sup>."),
    ],
)
def test_prose(given, expected):
    assert prose.to_html(given, "#{}".format) == expected


@pytest.mark.parametrize("entry", EQUATIONS, ids=lambda entry: entry.tag)
def test_what_is_shown_has_the_derived_value(entry):
    derived, (printed, shown) = entry.derive(), report.forms(entry.tag)
    assert printed is entry.printed
    if isinstance(derived, sp.core.relational.Relational):
        assert same(shown, derived)
    else:
        pairs = zip(components(shown), components(derived), strict=True)
        assert all(equal_at_random_points(*pair) for pair in pairs)


def test_printers_regroup_without_changing_a_value():
    forms = [form for entry in EQUATIONS for form in report.forms(entry.tag) if form is not None]
    parts = {x for form in forms for part in components(form) for x in sp.preorder_traversal(part)}
    assert len(parts) > 300
    for part in parts:
        minus, above, below = typeset._parts(part)
        number, above, below = typeset._in_front(above, below)
        product = number * (-1 if minus else 1) * sp.Mul(*above) / sp.Mul(*below)
        terms = [-x if negative else x for negative, x in typeset.signed_terms(part)]
        assert equal_at_random_points(product, part)
        assert sp.Add(*terms) == part


def test_a_changed_value_is_refused(monkeypatch):
    monkeypatch.setattr(presentation, "_forms", lambda expr: iter([expr + sp.Rational(1, 10**9)]))
    with pytest.raises(presentation.PresentationError):
        presentation.presented(sp.sqrt(X**2 + 7) + omega, None)


@pytest.mark.parametrize("tag", ["7", "8", "14", "15", "B6", "16", "22", "24", "26", "29", "23"])
def test_forms_that_agree_look_alike(tag):
    printed, shown = report.forms(tag)
    assert typeset.mathml(shown) == typeset.mathml(printed)


def test_the_printed_form_is_not_what_is_shown_as_derived():
    printed, shown = report.forms("12")
    assert typeset.latex(shown) == typeset.latex(printed).replace(
        r"X Z + \mu \left(k^{2} + Z^{2}\right)", r"k^{2} + X^{2} + \mu X Z"
    )


@pytest.mark.parametrize("function", codegen.FUNCTIONS, ids=lambda function: function.name)
def test_functions_show_rules_reasons_and_operations(page, function):
    _, steps = function.body()
    text = page.text[f"function-{function.name.replace('_', '-')}"]
    assert text.startswith(function.name)
    assert plain(function.summary) in text
    for step in steps:
        assert plain(step.rule) in text
        assert str(step.operations) in text
    for rule in function.rules:
        assert plain(rule.why) in text


def test_latex_is_balanced(fragments):
    for name, text in fragments.items():
        bare = re.sub(r"\\[{}\\]", "", text)
        depth = 0
        for brace in re.findall(r"[{}]", bare):
            depth += 1 if brace == "{" else -1
            assert depth >= 0, name
        assert depth == 0, name
        opened = []
        for kind, what in re.findall(r"\\(begin|end)\{([^}]+)\}", text):
            if kind == "begin":
                opened.append(what)
            else:
                assert opened.pop() == what, name
        assert not opened, name
        assert len(re.findall(r"(?<!\\)\$", text)) % 2 == 0, name
        assert text.isascii(), name


def test_latex_has_every_tag(fragments):
    text = "\n".join(fragments.values())
    for entry in registry.ENTRIES:
        assert rf"\paragraph{{{report._name(entry.tag, prose.to_latex)}}}" in text
        if re.fullmatch(r"B?\d+", entry.tag):
            assert rf"\tag{{{entry.tag}}}" in text
    inputs = re.findall(r"\\input\{([^}]+)\}", fragments["all.tex"])
    assert [*inputs, "all.tex"] == list(fragments)


def test_writes_everything_and_leaves_no_temporary_file(tmp_path, rows, source, fragments):
    seen = []
    paths = report.write(tmp_path / "new", rows, lambda items: (seen.append(i) or i for i in items))
    assert len(seen) == len(registry.ENTRIES) + len(codegen.FUNCTIONS)
    assert (tmp_path / "new" / "report.html").read_text(encoding="utf-8") == source
    assert {path.name for path in paths[1:]} == set(fragments)
    assert sorted(p for p in (tmp_path / "new").rglob("*") if p.is_file()) == sorted(paths)
