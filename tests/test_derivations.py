"""The registry: every verdict is proved, and a wrong one is caught."""

import json
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from functools import cache

import pytest
import sympy as sp

from derivations import (
    closed_forms,
    codegen,
    drift,
    equality,
    files,
    kernel,
    laws,
    lecture,
    pairs,
    paper,
    proof,
    registry,
    rewrites,
    slide,
    texts,
    trace,
)
from derivations import symbols as s

from .command_line import enter, read_toml
from .mutants import EQUATIONS, derived_again

EDITS = read_toml("tests/edits.toml")["derivations"]
BY_TAG = {entry.tag: entry for entry in registry.ENTRIES}
NUMBERED = [str(n) for n in range(1, 32)] + [f"B{n}" for n in range(1, 13)]
each_entry = pytest.mark.parametrize("entry", registry.ENTRIES)
each_equation = pytest.mark.parametrize("entry", EQUATIONS)
ERRATA = {entry.tag for entry in registry.mistakes()}
proved = cache(registry.proved)  # each proof is made once, for the report's tests as well


def holds(tag, **changes):
    """Whether the equation of a tag is proved, with some of its fields changed."""
    return replace(BY_TAG[tag], **changes).prove().ok


@each_entry
def test_every_verdict_is_proved(entry):
    """What is noted is that of the paper, and never counted as proved."""
    row = proved(registry.ENTRIES.index(entry))
    assert row.proved == (entry.verdict != "noted")
    assert row.proved or entry.prove().ok


def test_everything_of_the_paper_is_judged_once():
    """Every numbered equation; every formula and sentence typed, or it judges another one."""
    used = {tag for entry in EQUATIONS for tag in (*entry.formulas, *entry.contradicted_by)}
    assert len(BY_TAG) == len(registry.ENTRIES)
    assert all(BY_TAG[tag].printed is not None for tag in NUMBERED)
    assert set(paper.EQUATIONS) <= used | set(BY_TAG)
    assert set(paper.SENTENCES) <= set(BY_TAG)
    typed = {entry.tag for entry in EQUATIONS if entry.said is not None and entry.where is None}
    assert not typed & set(paper.EQUATIONS)  # what is printed is read, not typed again
    assert {function.name for function in closed_forms.FUNCTIONS} == set(rewrites.WORDS)


@pytest.mark.parametrize(
    ("tag", "verdict"),
    [
        *((tag, "erratum") for tag in NUMBERED if BY_TAG[tag].verdict == "agrees"),
        *((tag, "agrees") for tag in sorted(ERRATA)),
        ("A: time step", "assumed"),  # which is derived
    ],
)
def test_no_entry_passes_with_another_verdict(tag, verdict):
    assert not holds(tag, verdict=verdict)


@pytest.mark.parametrize("tag", sorted(ERRATA))
def test_what_contradicts_a_mistake_is_named(tag):
    """With another formula of the paper in the place of any of them no contradiction is left."""
    named = BY_TAG[tag].contradicted_by
    assert named
    for place, one in enumerate(named):
        other = next(x for x in ("7", "17", "25") if x != one)
        changed = (*named[:place], other, *named[place + 1 :])
        assert not holds(tag, contradicted_by=changed)


def test_a_counter_example_has_the_printed_value_first():
    entry = BY_TAG["12"]
    forms = (form.subs(proof.EXAMPLE) for form in (entry.printed, entry.derive()))
    printed, derived = map(proof._number, forms)
    assert entry.prove().evidence.startswith(f"printed ${printed}$, derived ${derived}$ at")


def test_new_result_without_second_route_is_refused():
    for check in (None, lambda form: (s.mu,), lambda form: ()):
        refused = replace(BY_TAG["pairs: energy"], check=check).prove()
        assert not refused.ok
        assert "second route" in refused.evidence


ERRATA_OF_FORMS = [tag for tag in sorted(ERRATA) if BY_TAG[tag].repair]


@pytest.mark.parametrize("tag", ERRATA_OF_FORMS)
def test_a_repair_makes_the_printed_form_right(tag):
    entry = BY_TAG[tag]
    first, *rest = entry.repair
    other = replace(first, new=first.new + " + 1")
    printed = paper.EQUATIONS[entry.formulas[0]].right
    # no repair, but another form
    far = proof.Repair(printed, sp.latex(entry.derive().doit()).replace("{", "{ "))
    for repair in ((), (other, *rest), (far,)):
        assert not holds(tag, repair=repair)


@pytest.mark.parametrize("tag", sorted(ERRATA - set(ERRATA_OF_FORMS)))
def test_a_mistake_in_words_is_computed_as_what_is_true_is(tag):
    derive = BY_TAG[tag].derive
    assert not holds(tag, mistaken=None)
    assert not holds(tag, mistake="")
    assert not holds(tag, contradiction=None)
    assert not holds(tag, mistaken=derive)
    assert not holds(tag, said=derive())


def test_the_paper_is_sealed(monkeypatch):
    """A letter of paper.toml more, and no printed form is proved."""
    monkeypatch.setattr(paper, "SOURCE", paper.SOURCE.replace(b"c_z", b"c_x", 1))
    assert not holds("7")


@pytest.mark.parametrize("tex", EDITS["unreadable"])
def test_what_cannot_be_read_is_refused(tex):
    with pytest.raises((ValueError, IndexError, TypeError, AttributeError)):
        paper.read(tex, paper.LETTERS)


@each_equation
def test_every_part_of_a_left_side_is_held(entry):
    """A left side is the paper's, its step's, or is read itself; a condition has none."""
    given = paper.parts(entry.left) or entry.lefts[:1]
    for place in range(len(given) if given[0] else 0):
        changed = [*given[:place], "Q_{17}", *given[place + 1 :]]
        left = f"({', '.join(changed)})" if len(given) > 1 else changed[0]
        assert not holds(entry.tag, left=left)


@pytest.mark.parametrize(("tag", "old", "new"), EDITS["left_sides"])
def test_a_left_side_that_is_read_has_the_derived_value(tag, old, new):
    assert not holds(tag, left=BY_TAG[tag].left.replace(old, new, 1))


@pytest.mark.parametrize(("step", "tag"), EDITS["left_sides_of_several_letters"])
def test_a_left_side_of_several_letters_has_the_value_of_its_step(step, tag, monkeypatch):
    lefts = tuple(left.replace(" - ", " + ") for left in trace.LEFTS[step])
    monkeypatch.setitem(trace.LEFTS, step, lefts)
    with derived_again("derived", step):
        assert not BY_TAG[tag].prove().ok


@pytest.fixture
def unsealed(monkeypatch):
    """Open the seal of the words: what is computed must tell a wrong one itself."""
    monkeypatch.setattr(texts, "digest", lambda: texts.READ)


@pytest.mark.parametrize(("step", "old", "new"), EDITS["citations"])
def test_a_step_cites_what_it_takes(step, old, new, unsealed, monkeypatch):
    function = trace.STEPS[step]
    monkeypatch.setattr(function, "__doc__", function.__doc__.replace(old, new))
    assert not BY_TAG["texts"].prove().ok


@pytest.mark.parametrize(("name", "old", "new"), EDITS["dimensions"])
def test_a_letter_keeps_its_dimension(name, old, new, unsealed, monkeypatch):
    lines = [
        lecture.Letter(*(text.replace(old, new) for text in line)) if line.name == name else line
        for line in lecture.LETTERS
    ]
    dimensions = {x.name: paper.read(x.dimension, texts._UNITS) for x in lines}
    monkeypatch.setattr(lecture, "LETTERS", lines)
    monkeypatch.setattr(texts, "_DIMENSIONS", dimensions)
    texts.dimension.cache_clear()
    proved = BY_TAG["texts"].prove().ok
    texts.dimension.cache_clear()
    assert not proved


@pytest.mark.parametrize(("name", "old", "new"), EDITS["words_of_functions"])
def test_words_of_a_function_are_those_of_its_forms(name, old, new, unsealed, monkeypatch):
    changed = {key: text.replace(old, new) for key, text in rewrites.WORDS[name].items()}
    monkeypatch.setitem(rewrites.WORDS, name, changed)
    assert not BY_TAG["texts"].prove().ok


def test_prose_has_a_number_with_its_name(unsealed, monkeypatch):
    for other in (("6", BY_TAG["5"].what), ("5", "")):
        monkeypatch.setattr(lecture, "CITED", [other])
        assert not BY_TAG["texts"].prove().ok


@pytest.mark.parametrize(("tag", "step", "old", "new"), EDITS["renamed_in_step_and_entry"])
def test_a_left_side_cannot_be_renamed_in_step_and_entry_alike(tag, step, old, new, monkeypatch):
    lefts = tuple(left.replace(old, new) for left in trace.LEFTS[step])
    monkeypatch.setitem(trace.LEFTS, step, lefts)
    entry = replace(BY_TAG[tag], left=BY_TAG[tag].left.replace(old, new))
    entries = (entry if x.tag == tag else x for x in registry.ENTRIES)
    monkeypatch.setattr(registry, "ENTRIES", tuple(entries))
    with derived_again("derived", step):
        assert entry.prove().ok
        assert not BY_TAG["texts"].prove().ok


@pytest.mark.parametrize(
    ("tag", "check"),
    [
        ("V: no slide", lambda form: (drift.landing("slide")[0] - s.c_x - form,)),
        ("laws: Poisson", lambda form: [laws.compression("early") * x for x in (0, 0)]),
        ("pairs: determinant", lambda form: (pairs.determinant() - form,)),
    ],
)
def test_a_second_route_shares_no_step_with_the_first(tag, check):
    assert "both routes take" in replace(BY_TAG[tag], check=check).prove().evidence


@pytest.mark.parametrize("tag", sorted(paper.EQUATIONS))
def test_a_changed_letter_or_sign_of_the_paper_is_caught(tag, monkeypatch):
    """The proofs themselves, past the seal, see a changed formula, left side or number."""
    formula = paper.EQUATIONS[tag]
    monkeypatch.setattr(paper, "sealed", lambda: True)
    judged = [x for x in EQUATIONS if tag in (x.tag, *x.formulas, *x.contradicted_by)]
    assert judged
    for changed in changed_texts(formula.tex, numbers=not tag.startswith("A: ")):
        monkeypatch.setitem(paper.EQUATIONS, tag, formula._replace(tex=changed))
        with read_again(tag):
            assert not all(entry.prove().ok for entry in judged)


@contextmanager
def read_again(tag):
    """Read the paper again, inside, and derive again what a printed condition is put into."""
    put_in = derived_again("derived", "drift.stationary")
    paper.printed.cache_clear()
    try:
        with put_in if tag == "V: continuity" else nullcontext():
            yield
    finally:
        paper.printed.cache_clear()


def changed_texts(tex, numbers):
    """A sign turned, a digit raised, a letter exchanged, on each side; each once, and the last.

    Of Appendix A's constants the dimensions are judged; for the numbers see test_words.py.
    """
    found = []
    for old, new in EDITS["of_the_paper"]:
        if old in tex and (numbers or not old.isdigit()):
            head, _, tail = tex.rpartition(old)
            found += [tex.replace(old, new, 1), head + new + tail]
    return dict.fromkeys(found)


def test_random_points_tell_equal_from_unequal():
    root = sp.sqrt(s.mu**2 + 2 * s.mu + 1)
    assert equality.equal_at_random_points(root, s.mu + 1)
    assert not equality.equal_at_random_points(root, s.mu + 1 + sp.Rational(1, 10**39))


@pytest.mark.parametrize(
    ("function", "forms"),
    [
        (laws._restitution.__wrapped__, []),
        (BY_TAG["V: continuity"].derive.__wrapped__, []),
        (BY_TAG["V: alpha and closure"].note, []),
        (BY_TAG["B8: text"].contradiction, [s.P_z, s.v_0, s.v_f]),
        (BY_TAG["IV: no reversal above 3/5"].contradiction, [s.mu]),
        (BY_TAG["IV: slide only below mu_c"].contradiction, [s.mu]),
    ],
)
def test_a_second_root_is_not_dropped(function, forms, monkeypatch):
    function(*forms)  # the steps that it takes are cached now
    monkeypatch.setattr(sp, "solve", lambda *_, **__: [s.mu, -s.mu])
    with pytest.raises(ValueError, match="too many values to unpack"):
        function(*forms)


def test_what_is_noted_is_quoted():
    noted = [entry.what for entry in registry.ENTRIES if entry.verdict == "noted"]
    assert noted == [f'"{line["quote"]}"' for line in paper.NOTED]


def test_rewriting_that_changes_a_value_is_refused():
    wrong = rewrites.Rule("wrong", "", lambda _: {s.v_1: s.v_0 - rewrites.N * s.u_0})
    with pytest.raises(rewrites.RewriteError, match="wrong"):
        rewrites.rewrite({s.v_1: slide.stop()[2]}, (wrong,), rewrites.RESPONSES)


def test_the_generated_file_is_what_the_derivations_give():
    assert files.CLOSED_FORMS.read_text("utf-8") == files.source()


def test_the_page_of_equations_is_that_of_the_registry():
    text = files.page()
    assert files.PAGE.read_text("utf-8") == text
    assert all(f"| {entry.tag} |" in text for entry in registry.mistakes())


def test_generating_again_leaves_the_file_alone(tmp_path):
    target = tmp_path / "generated.py"
    assert files.write("a = 1\n", target)
    before = target.stat().st_mtime_ns
    assert not files.write("a = 1\n", target)
    assert target.stat().st_mtime_ns == before
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("square", ["X**2", "sqrt(X * X * X * X)"])
def test_unplain_arithmetic_is_not_generated(square, monkeypatch):
    (function,) = (x for x in closed_forms.FUNCTIONS if x.name == "painleve_friction")
    changed = function.words["text"].replace("X * X", square)
    monkeypatch.setitem(function.words, "text", changed)
    with pytest.raises((ValueError, TypeError), match=r"not plain|not callable"):
        codegen.text(replace(function))


def test_check_prints_a_table_and_json_for_machines(monkeypatch):
    monkeypatch.setattr(registry, "ENTRIES", (BY_TAG["8"], kernel.CODE[1], BY_TAG["12"]))
    table, _, counts = enter("derivations check").out.rpartition("3 entries: ")
    assert counts == "1 agrees, 1 new, 1 erratum; 0 not proved\n"
    assert "erratum" in table
    rows = json.loads(enter("derivations check --json").out)
    assert [row["verdict"] for row in rows if row["proved"]] == ["agrees", "new", "erratum"]
