"""The registry: every verdict is proved, and a wrong one is caught."""

import json
import random
import re
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
import sympy as sp
from mpmath import mpf, workdps

from derivations import __main__ as cli
from derivations import (
    closed_forms,
    codegen,
    equations_page,
    files,
    laws,
    newton,
    proof,
    registry,
    rewrites,
    slide,
    slip_reversal,
    slip_stick,
)
from derivations import symbols as s
from derivations.proof import Equation

from .reference import SLIDE, SLIP_REVERSAL, SLIP_STICK, reference_collide

BY_TAG = {entry.tag: entry for entry in registry.ENTRIES}
NUMBERED = [str(n) for n in range(1, 32)] + [f"B{n}" for n in range(1, 13)]
ERRATA = {entry.tag for entry in registry.mistakes() if isinstance(entry, Equation)}


@pytest.mark.parametrize("entry", registry.ENTRIES, ids=lambda entry: entry.tag)
def test_every_verdict_is_proved(entry):
    proof_found = entry.prove()
    assert proof_found.ok, proof_found.evidence


def test_every_numbered_equation_is_there_once():
    assert len(BY_TAG) == len(registry.ENTRIES)
    assert set(NUMBERED) <= set(BY_TAG)
    assert all(BY_TAG[tag].printed is not None for tag in NUMBERED)


def test_no_words_are_left_over():
    equations = {entry.tag for entry in registry.ENTRIES if isinstance(entry, Equation)}
    assert equations == set(proof.WORDS)
    assert {function.name for function in closed_forms.FUNCTIONS} == set(rewrites.WORDS)


def test_mistakes_are_reported_with_what_contradicts_them():
    assert all(entry.note and entry.contradicted_by for entry in registry.mistakes())


@pytest.mark.parametrize("tag", [tag for tag in NUMBERED if BY_TAG[tag].verdict == "agrees"])
def test_agreeing_equation_cannot_pass_as_erratum(tag):
    assert not replace(BY_TAG[tag], verdict="erratum").prove().ok


@pytest.mark.parametrize("tag", sorted(ERRATA))
def test_erratum_cannot_pass_as_agreeing(tag):
    assert not replace(BY_TAG[tag], verdict="agrees").prove().ok
    assert not replace(BY_TAG[tag], verdict="rewritten", at=None).prove().ok or tag.startswith("V")


def test_contradiction_that_does_not_give_the_derived_form_is_caught():
    wrong = replace(BY_TAG["12"], contradiction=lambda: BY_TAG["12"].printed)
    assert not wrong.prove().ok


def test_new_result_without_second_route_is_refused():
    without = replace(BY_TAG["laws: energy"], check=None).prove()
    assert not without.ok
    assert "second route" in without.evidence
    for check in (lambda form: (s.mu,), lambda form: ()):
        assert not replace(BY_TAG["laws: energy"], check=check).prove().ok


ERRATA_OF_FORMS = [tag for tag in sorted(ERRATA) if BY_TAG[tag].repair]


@pytest.mark.parametrize("tag", ERRATA_OF_FORMS)
def test_a_repair_makes_the_printed_form_right(tag):
    entry = BY_TAG[tag]
    assert not replace(entry, repair=()).prove().ok
    other = replace(entry.repair[0], new=entry.repair[0].new + 1)
    assert not replace(entry, repair=(other, *entry.repair[1:])).prove().ok
    if entry.printed.free_symbols:
        whole = proof.Repair("all of it", entry.printed, entry.readable())
        assert not replace(entry, repair=(whole,)).prove().ok  # no repair, but another form


@pytest.mark.parametrize("tag", sorted(ERRATA - set(ERRATA_OF_FORMS)))
def test_a_mistake_in_words_is_computed_as_what_is_true_is(tag):
    entry = BY_TAG[tag]
    assert not replace(entry, mistaken=None).prove().ok
    assert not replace(entry, mistake="").prove().ok
    assert not replace(entry, contradiction=None).prove().ok
    assert not replace(entry, mistaken=entry.derive).prove().ok


class Vector(sp.ImmutableDenseMatrix):
    """Three components, with the products as they are printed."""

    def __xor__(self, other):
        return self.cross(other)

    def __and__(self, other):
        return self.dot(other)


def test_printed_vector_equations_mean_their_components():
    """LaTeX as it is shown, read as Python: a cross product is ^, a dot product &."""
    letters = {
        "u": Vector([sp.sin(s.phi), 0, sp.cos(s.phi)]),
        "c": Vector([s.c_x, 0, s.c_z]),
        "V": Vector([0, 0, s.V_z]),
        "omega": Vector([0, s.omega, 0]),
        "F": Vector([s.F_x, 0, s.F_z]),
        "dP": Vector([s.P_x, 0, s.P_z]),
        "l": s.length,
        "alpha": newton.alpha,
    }
    for tag in ("2", "3", "4"):
        text = BY_TAG[tag].as_printed
        text = re.sub(r"d\\mathbf\{P\}", "dP", text)
        text = re.sub(r"\\(?:mathbf|boldsymbol)\{\\?(\w+)\}", r"\1", text)
        text = re.sub(r"\\frac\{(\w+)\}\{(\w+)\}", r"\1/\2 *", text)
        text = re.sub(r"(\w+) \\times (\w+)", r"(\1 ^ \2)", text)
        text = re.sub(r"(\w+) \\cdot (\w+)", r"\1 & \2", text)
        text = text.replace(r"\alpha [", "alpha * (").replace("]", ")").replace("u (", "u * (")
        value = list(eval(text, letters))
        printed = list(sp.Matrix([BY_TAG[tag].printed]))
        want = [0, *printed, 0] if len(printed) == 1 else [printed[0], 0, printed[1]]
        assert all(proof.vanishes(a - b) for a, b in zip(value, want, strict=True)), tag


def test_random_points_tell_equal_from_unequal():
    root = sp.sqrt(s.mu**2 + 2 * s.mu + 1)
    assert proof.equal_at_random_points(root, s.mu + 1)
    assert not proof.equal_at_random_points(root, s.mu + 1 + sp.Rational(1, 10**39))


def test_inequality_must_keep_its_sense():
    entry = BY_TAG["16"]
    turned = replace(entry, printed=sp.Lt(entry.printed.gts, entry.printed.lts))
    assert not turned.prove().ok


def test_missing_panel_and_wrong_subject_are_needed_for_a_citation_to_fail():
    entry = BY_TAG["III: Fig. 6(a)"]
    assert not replace(entry, cited=("6", "c")).prove().ok


@cache
def _random_impacts():
    """150 rational impacts with u_0 > 0, v_0 < 0, as the paper has them."""
    draw, found = random.Random(7), []
    while len(found) < 150:
        point = {
            symbol: sp.Rational(draw.randrange(-300, 300), 100)
            for symbol in (s.X, s.Z, s.c_x, s.c_z, s.omega, s.V_z)
        }
        point |= {
            s.k: sp.Rational(draw.randrange(20, 200), 100),
            s.mu: sp.Rational(draw.randrange(1, 200), 100),
            s.epsilon: sp.Rational(draw.randrange(0, 101), 100),
            s.m: sp.Integer(1),
        }
        start = {symbol: value.subs(point) for symbol, value in newton.approach().items()}
        if start[s.u_0] > 0 > start[s.v_0]:
            found.append({**point, **start})
    return found


def _number(value):
    """A rational at the working precision."""
    return mpf(value.p) / value.q


def _integrated(point, law="newton"):
    """The independent integration of one rational impact, at the working precision."""
    names = {"friction": s.mu, "restitution": s.epsilon, "plate_velocity": s.V_z}
    names |= {str(letter): letter for letter in (s.c_x, s.c_z, s.omega, s.X, s.Z, s.k)}
    given = {name: _number(point[letter]) for name, letter in names.items()}
    return reference_collide(**given, law=law)


def test_derived_impulses_agree_with_an_independent_integration():
    """The symbolic results against phase-by-phase integration at 50 digits, regime by regime."""
    derived = {SLIDE: slide, SLIP_STICK: slip_stick, SLIP_REVERSAL: slip_reversal}
    letters = list(_random_impacts()[0])
    impulses = {code: sp.lambdify(letters, of.impulse(), "mpmath") for code, of in derived.items()}
    seen = dict.fromkeys(derived, 0)
    for point in _random_impacts():
        with workdps(60):
            reference = _integrated(point)
            P_x, P_z = impulses[reference.regime](*map(_number, point.values()))
            assert abs(P_x - reference.P_x) < mpf(10) ** -45
            assert abs(P_z - reference.P_z) < mpf(10) ** -45
        seen[reference.regime] += 1
    assert min(seen.values()) >= 5, seen


@pytest.mark.parametrize("law", ["newton", "poisson", "stronge"])
def test_derived_laws_agree_with_an_independent_integration(law):
    """v_f of all laws and orders, from the slopes, against the integration."""
    letters, slopes, (_, p_1, v_1) = list(_random_impacts()[0]), laws.slopes(), slide.stop()
    ways = {}
    for regime, after in ((SLIP_STICK, "stick"), (SLIP_REVERSAL, "back")):
        known = {laws.a_1: slopes["slip"], laws.a_2: slopes[after], s.P_1: p_1}
        for order in ("early", "late"):
            form = laws.final_velocity(law, order).subs(known)
            ways[regime, order] = sp.lambdify(letters, form, "mpmath")
    seen = set()
    for point in _random_impacts():
        with workdps(60):
            reference = _integrated(point, law)
            if reference.regime == SLIDE:
                continue
            way = reference.regime, "early" if v_1.subs(point) < 0 else "late"
            seen.add(way)
            value = ways[way](*map(_number, point.values()))
            assert abs(value - reference.normal_velocity) < mpf(10) ** -40
    assert seen == set(ways)


def test_rewriting_that_changes_a_value_is_refused():
    wrong = rewrites.Rule("wrong", "", lambda _: {s.v_1: s.v_0 - rewrites.N * s.u_0})
    with pytest.raises(rewrites.RewriteError, match="wrong"):
        rewrites.rewrite({s.v_1: slide.stop()[2]}, (wrong,), rewrites.RESPONSES)


def test_the_generated_file_is_what_the_derivations_give():
    assert files.CLOSED_FORMS.read_text(encoding="utf-8") == files.source()


def test_the_page_of_equations_is_that_of_the_registry():
    text = equations_page.source()
    assert equations_page.TARGET.read_text(encoding="utf-8") == text
    assert all(line.endswith("|") for line in text.splitlines() if line.startswith("|"))
    assert all(f"| ({tag}) |" in text for tag in NUMBERED)
    assert all(f"| {entry.tag} |" in text for entry in registry.mistakes())


def test_generating_again_leaves_the_file_alone(tmp_path):
    target = tmp_path / "generated.py"
    assert files.write("a = 1\n", target)
    before = target.stat().st_mtime_ns
    assert not files.write("a = 1\n", target)
    assert target.stat().st_mtime_ns == before
    assert list(tmp_path.iterdir()) == [target]


def test_unplain_arithmetic_is_not_generated():
    with pytest.raises(ValueError, match="plain"):
        codegen.text_of(sp.sqrt(s.X))


@pytest.fixture
def few_entries(monkeypatch):
    entries = (BY_TAG["8"], BY_TAG["12"])
    monkeypatch.setattr(registry, "ENTRIES", entries)
    return entries


def test_check_prints_a_table(few_entries, capsys):
    assert cli.main(["check"]) == 0
    text = capsys.readouterr().out
    assert "erratum" in text
    assert "2 entries: 1 agrees, 1 erratum; 0 not proved" in text


def test_check_prints_json_for_machines(few_entries, capsys):
    assert cli.main(["check", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [(row["tag"], row["verdict"]) for row in rows] == [("8", "agrees"), ("12", "erratum")]
    assert all(row["proved"] and "note" in row for row in rows)


def test_a_false_verdict_gives_exit_code_one(monkeypatch, capsys):
    false = replace(BY_TAG["12"], verdict="agrees")
    monkeypatch.setattr(registry, "ENTRIES", (false,))
    assert cli.main(["check"]) == 1
    printed = capsys.readouterr().out
    assert "NOT PROVED" in printed
    assert "this failed: difference" in printed


FULL = Path("/dev/full")
FEW = """
from derivations import __main__, registry
registry.ENTRIES = registry.ENTRIES[:2]
__main__.main.program()
"""


@pytest.mark.skipif(not FULL.exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("arguments", [["-c", FEW, "check"], ["-m", "figures", "list"]])
def test_output_that_nobody_takes_ends_without_a_traceback(arguments):
    """A pipe closed early is no error; a full disk is one line and exit code 2."""
    command = [sys.executable, *arguments]
    with FULL.open("w") as full:
        for code, target in ((0, subprocess.PIPE), (2, full)):
            process = subprocess.Popen(command, stdout=target, stderr=subprocess.PIPE, text=True)
            if process.stdout:
                process.stdout.close()
            errors = process.stderr.read()
            process.stderr.close()
            assert process.wait() == code, errors
            assert "Traceback" not in errors
            assert "Exception ignored" not in errors
