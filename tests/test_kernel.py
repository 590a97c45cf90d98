"""The routines of one impact: their language, their proofs, and what the proofs would miss."""

import ast
from dataclasses import replace
from functools import cache

import mpmath
import pytest

from derivations import files, routines
from derivations.kernel import ROUTINES

BY_NAME = {routine.name: routine for routine in ROUTINES}


@pytest.mark.parametrize("routine", ROUTINES, ids=BY_NAME)
def test_a_change_of_1e_12_in_any_value_is_seen(monkeypatch, routine):
    law = routine.laws[0]
    right = routines.values(routine, law)
    assigned = {node.id for node in ast.walk(routine.tree) if isinstance(node, ast.Name)}
    for name in assigned & set(routine.means(law)) - set(routine.arguments.split()):
        if any(isinstance(at[name], mpmath.mpf) and abs(at[name]) > 0 for at in right):
            wrong = [{**at, name: at[name] * (1 + mpmath.mpf("1e-12"))} for at in right]
            monkeypatch.setattr(routines, "values", lambda routine, law, wrong=wrong: wrong)
            assert routine.prove().evidence == f"{name} is not what it stands for"


def test_the_situations_go_every_way():
    """All regimes, early and late stops, both sides of each edge, the Painleve region."""
    seen, lifted = set(), set()
    for at in routines.values(BY_NAME["phases"], "poisson"):
        regime = "slides" if at["slides"] else "sticks" if at["sticks"] else "slips back"
        way = (regime, "soon" if at["soon"] else "late") if at["hits"] else "parts"
        (lifted if at["contact"][0] < 0 else seen).add(way)
    stops = {(regime, time) for regime in ("sticks", "slips back") for time in ("soon", "late")}
    assert seen >= stops | {"parts", ("slides", "late")}
    assert ("sticks", "soon") in lifted


@pytest.mark.parametrize(
    "text", ["a = b ** 2", "a = b if b else 1", "a = [b]", "a += b", "a = b and b", "import os"]
)
def test_what_another_language_may_not_have_is_refused(text):
    proof = replace(BY_NAME["lacking"], text=text).prove()
    assert not proof.ok
    assert "not in the language" in proof.evidence


def test_a_name_is_assigned_once():
    text = "missing = q + b\nmissing = q"
    assert "assigned twice" in replace(BY_NAME["lacking"], text=text).prove().evidence


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("two_sum", "(a - (s - part)) + (b - part)", "b - part"),  # right for |a| >= |b| alone
        ("responses", "across_error + press_error", "across_error"),
        ("branches", "(u_low - T_low * j_rounded)", "u_low"),
        ("phases", "N_low * j_rounded + N * j_low", "N * j_low"),
    ],
)
def test_sums_that_lose_digits_are_seen(name, old, new):
    """Without rounding all of them are right."""
    routine = BY_NAME[name]
    assert old in routine.text
    changed = replace(routine, text=routine.text.replace(old, new))
    proof = changed.prove()
    assert not proof.ok
    assert "roundings left" in proof.evidence or "binary digits" in proof.evidence


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("impact", "P_x, P_z", "P_z, P_x"),
        ("responses", "K_z, N_low, T_low", "K_z, T_low, N_low"),
        ("branches", "v_0 < 0", "v_0 <= 0"),
        ("mirrored", "smaller(friction, HUGE_FRICTION)", "friction"),
        ("mirrored", "side * u_low", "u_low"),
        ("phases", "select(slips, T, 1.0)", "T"),
    ],
)
def test_a_mistake_is_seen_in_its_routine_or_in_an_impact(monkeypatch, name, old, new):
    right = BY_NAME[name]
    assert old in right.text + right.returned
    text, returned = (part.replace(old, new) for part in (right.text, right.returned))
    monkeypatch.setitem(routines._known, name, replace(right, text=text, returned=returned))
    monkeypatch.setattr(routines, "_functions", cache(routines._functions.__wrapped__))
    assert not all(routines._known[changed].prove().ok for changed in (name, "impact"))


def test_a_wrong_branch_rule_names_a_history_that_breaks_a_law():
    """A contact that always sticks: its meaning changed, too, so that only the laws tell."""
    rule = BY_NAME["branches"]
    text = rule.text.replace("sticks = T_back <= 0", "sticks = T_back <= T")
    _, T, _, T_back, *_ = rule.means("")["contact"]
    meant = {**rule.means(""), "sticks": T_back <= T}
    with mpmath.workdps(60):
        assert not replace(rule, text=text, means=lambda law: meant).prove().ok


def test_a_call_of_anything_unknown_is_no_proof():
    proof = replace(BY_NAME["lacking"], text="missing = unknown(q)").prove()
    assert not proof.ok
    assert "NameError" in proof.evidence


def test_a_changed_constant_changes_the_digest(monkeypatch):
    """Which says whether figures are of the present theory."""
    before = files.sources()[files.CLOSED_FORMS]
    monkeypatch.setitem(files.CONSTANTS, "SPLIT", "2.0**26 + 1")
    after = files.sources()[files.CLOSED_FORMS]
    assert [a != b for a, b in zip(before.splitlines(), after.splitlines(), strict=True)].count(
        True
    ) == 1
