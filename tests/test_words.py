"""Words of notes follow their numbers; routes that prove by numbers tell a wrong form."""

import shutil
from dataclasses import replace
from inspect import signature
from pathlib import Path

import pytest
import sympy as sp

import md
from derivations import landing_phases, lecture, paper, texts, trace
from derivations.symbols import X, Z, epsilon, mu
from figures.paper import fig11

from .test_derivations import BY_TAG, EQUATIONS

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
    assert lecture.falls(2 - x, x, sp.Integer(2))
    assert not lecture.falls(x - 2, x, sp.Integer(2))
    assert lecture.largest(-((x - 1) ** 2), x, sp.S.One)
    assert not any(lecture.largest(form, x, sp.S.One) for form in ((x - 1) ** 2, x))
    assert lecture.negative(-X)
    assert not any(map(lecture.negative, (X * Z + mu, X - Z)))


def defaults(function):
    found = signature(function).parameters.items()
    return {name: parameter.default for name, parameter in found}


def test_numbers_of_the_paper_are_those_of_the_simulations():
    """Past the seal: the same numbers, typed there as well."""
    law, drawn = defaults(md.appendix_a), defaults(fig11.data)
    for tag, name in (
        ("A: unit of k_n", "stiffness"),
        ("A: k_t = 95 k_n", "tangential_ratio"),
        ("A: unit of gamma", "damping"),
    ):
        assert float(paper.printed(tag).as_coeff_Mul()[0]) == law[name]
    for letter, name in ((epsilon, "restitution"), (mu, "friction")):
        assert float(lecture.PAPER[letter]) == drawn[name]


def test_rods_counted_one_by_one_tell_a_wrong_mean():
    form = landing_phases.mean_speed(True)
    assert landing_phases._rods_counted(form) == [0]
    assert landing_phases._rods_counted(form * (1 + sp.Float("1e-8", 30))) != [0]


@pytest.mark.parametrize(
    ("tag", "field"),
    [("23", "about"), ("23", "note"), ("4", "note"), ("IV: large ratio", "mistake")],
)
def test_words_of_an_entry_are_sealed(tag, field):
    words = getattr(BY_TAG[tag], field)
    other = (lambda: words() + "!") if callable(words) else words + "!"
    changed = replace(BY_TAG[tag], **{field: other})
    entries = [changed if entry.tag == tag else entry for entry in EQUATIONS]
    assert texts.digest(EQUATIONS) == texts.READ != texts.digest(entries)


def test_words_of_steps_and_functions_are_sealed(monkeypatch):
    for changed in (
        (trace.STEPS["bodies.round_contact"], "__doc__", "Above the centre of its lower cap."),
        (texts, "FUNCTIONS", texts.FUNCTIONS[1:]),
    ):
        with monkeypatch.context() as patch:
            patch.setattr(*changed)
            assert texts.digest(EQUATIONS) != texts.READ
    monkeypatch.setitem(trace.LEFTS, "optimum.painleve_friction", (r"\epsilon_P",))
    assert texts.digest(EQUATIONS) != texts.READ


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("lecture.toml", "acts twice on its", "acts once on its"),
        ("languages.toml", "above which it sticks again", "below which it sticks again"),
        ("templates/report.html", "what\nholds after", "what\nholds before"),
    ],
)
def test_words_of_files_are_sealed(name, old, new, tmp_path, monkeypatch):
    copy = tmp_path / "copy"
    shutil.copytree(Path(texts.__file__).parent, copy)
    text = (copy / name).read_text()
    assert text.count(old) == 1
    (copy / name).write_text(text.replace(old, new))
    monkeypatch.setattr(texts.resources, "files", lambda _: copy)
    assert texts.digest(EQUATIONS) != texts.READ


def test_remarks_of_the_code_are_sealed(tmp_path, monkeypatch):
    text = texts.KERNEL.read_text()
    changed = text.replace("XZ >= 0", "XZ <= 0")
    assert changed != text
    (tmp_path / "code.py").write_text(changed)
    monkeypatch.setattr(texts, "KERNEL", tmp_path / "code.py")
    assert texts.digest(EQUATIONS) != texts.READ
