"""Words of notes follow their numbers; routes that prove by numbers tell a wrong form."""

import shutil
from dataclasses import replace
from functools import partial
from inspect import signature
from pathlib import Path

import pytest
import sympy as sp

import md
from derivations import landing_phases, lecture, paper, texts
from derivations.symbols import X, Z, epsilon, mu
from figures.paper import fig11

from .test_derivations import BY_TAG, EDITS

x = sp.Symbol("x")


def test_numbers_are_told_as_long_as_they_are_asked_for():
    assert lecture.number(sp.Rational(2, 3), 4) == "0.6667"
    assert lecture.degrees(sp.pi / 7, 2) == "25.71 degrees"


@pytest.mark.parametrize(
    ("words", "other", "claimed"),
    [
        ("largest", "least", (-((x - 1) ** 2), x, sp.S.One)),
        ("below", "above", (1 - x, x, sp.S.One)),
        ("negative", "positive", (-X,)),
        ("never positive", "positive", ([-mu, sp.S.Zero],)),
    ],
)
def test_words_are_those_of_the_numbers(words, other, claimed):
    assert lecture.so(words, *claimed) == words
    with pytest.raises((ValueError, TypeError)):
        lecture.so(other, *claimed)


def test_what_is_asked_of_forms():
    assert not lecture.largest(x, x, sp.S.One)
    assert not any(map(lecture.negative, (X * Z + mu, X - Z)))


def test_numbers_of_the_paper_are_those_of_the_simulations():
    """Numbers of the paper, past the seal, are those that are typed in the simulations."""
    law, drawn = (signature(function).parameters for function in (md.appendix_a, fig11.data))
    for tag, name in (
        ("A: unit of k_n", "stiffness"),
        ("A: k_t = 95 k_n", "tangential_ratio"),
        ("A: unit of gamma", "damping"),
    ):
        assert float(paper.printed(tag).as_coeff_Mul()[0]) == law[name].default
    for letter, name in ((epsilon, "restitution"), (mu, "friction")):
        assert float(lecture.PAPER[letter]) == drawn[name].default


def test_rods_counted_one_by_one_tell_a_wrong_mean():
    form = landing_phases.mean_speed(True)
    assert landing_phases._rods_counted(form) == [0]
    assert landing_phases._rods_counted(form * (1 + sp.Float("1e-8", 30))) != [0]


@pytest.mark.parametrize(("name", "old", "new"), EDITS["sealed"])
def test_whatever_is_typed_is_sealed(name, old, new, tmp_path, monkeypatch):
    copy = tmp_path / "copy"
    shutil.copytree(Path(texts.__file__).parent, copy)
    monkeypatch.setattr(texts, "KERNEL", Path(shutil.copy(texts.KERNEL, tmp_path)))
    monkeypatch.setattr(texts, "__file__", str(copy / "texts.py"))
    assert texts.digest() == texts.READ
    (file,) = tmp_path.rglob(name)
    file.write_text(file.read_text("utf-8").replace(old, new), "utf-8")
    assert texts.digest() != texts.READ


def test_words_that_are_not_so_are_no_proof():
    """Words that are not so prove nothing, and do not stop the other proofs."""
    note = partial(lecture.so, "never positive", [sp.S.One])
    proof = replace(BY_TAG["23"], note=note).prove()
    assert not proof.ok
    assert not proof.computed
