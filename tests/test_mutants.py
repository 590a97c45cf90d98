"""The proofs can fail: deliberate mistakes in forms, axioms and derivation steps are caught."""

import random
from itertools import chain
from pathlib import Path

import pytest
import sympy as sp

from derivations import axioms, registry, symbols, trace
from derivations.lookup import entry_of

from . import mutants
from .command_line import enter
from .test_derivations import EQUATIONS

SOURCES = sorted(Path(registry.__file__).parent.glob("*.py"))
SAMPLE = random.Random(b"".join(path.read_bytes() for path in SOURCES))  # another with every edit
FEW_STEPS = SAMPLE.sample(sorted(trace.STEPS), 4)


def outcomes(trials):
    """What became of each mutant; none survives."""
    found = list(chain.from_iterable(trial() for trial in trials))
    assert not [mutant for mutant in found if mutant.outcome == "survived"]
    return [mutant.outcome for mutant in found]


def test_no_deliberate_mistake_keeps_its_verdict(monkeypatch):
    """One change of each side of some entries and axioms."""
    changes = mutants.changes
    monkeypatch.setattr(mutants, "changes", lambda form: SAMPLE.sample(list(changes(form)), 1))
    assert outcomes(SAMPLE.sample(mutants.trials(), 20)).count("caught") > 20


def test_no_deliberate_mistake_at_all_keeps_its_verdict():
    assert len(outcomes(mutants.trials())) > 2000


def negated(value):
    """The sign of what a step gives turned; of several, that of the last."""
    if isinstance(value, dict):
        *_, last = value
        return value | {last: -value[last]}
    return (*value[:-1], -value[-1]) if isinstance(value, tuple) else -value


@pytest.mark.parametrize(
    "step",
    [
        step if step in FEW_STEPS else pytest.param(step, marks=pytest.mark.slow)
        for step in sorted(trace.STEPS)
    ],
)
def test_a_sign_turned_in_a_step_ends_as_a_row(step):
    first = sorted(EQUATIONS, key=lambda entry: step not in trace.names(entry.steps, "derived"))
    with mutants.bent(step, negated):
        assert not all(entry.prove().ok for entry in first)
    assert trace.STEPS[step].__doc__


@pytest.mark.parametrize("command", ["derivations check", "derivations report"])
def test_a_derivation_that_cannot_be_computed_is_a_row_and_exit_code_one(
    monkeypatch, here, command
):
    monkeypatch.setattr(registry, "ENTRIES", (entry_of("24"),))
    with mutants.bent("drift.stationary", lambda value: 1 / 0):
        printed = enter(command, code=1).out
    assert "NOT PROVED" in printed
    assert "this failed: ZeroDivisionError" in printed
    assert "1 entries: 1 agrees; 1 not proved" in printed
    assert not list(here.rglob("*.html"))


def test_what_an_equation_rests_on_is_computed():
    rests = {entry.tag: set(entry.rests_on) for entry in EQUATIONS}
    impact = {"1", "IV: Euler", "IV: rigid body", "IV: impulsive limit"}
    assert rests["5"] == rests["6"] == impact
    assert rests["8"] == impact | {"IV: Coulomb, slip", "IV: restitution"}
    assert rests["24"] == rests["8"] | {"V: closure"}
    assert rests["16"] == impact | {"IV: Coulomb, stick"}
    assert rests["31"] == {"V: H(theta)"}
    assert rests["[12]: mass"] == set()
    assert set().union(*rests.values()) == axioms.BY_TAG.keys()
    with mutants.derived_again("axiom", "1"):
        assert set(entry_of("8").rests_on) == rests["8"]


def test_what_says_the_same_is_told_apart():
    x = symbols.X
    assert mutants.says_the_same(sp.Gt(2 * x, 2), sp.Gt(x, 1))
    assert not mutants.says_the_same(sp.Lt(x, 1), sp.Gt(x, 1))
    assert mutants.says_the_same(-2 * x, x, "zero")
    assert not mutants.says_the_same(-2 * x, x, "sign")
    assert not mutants.says_the_same(x + 1, x, "zero")
