"""Equations by their tags, as expressions and as functions."""

import inspect

import numpy as np
import pandas as pd
import pytest
from sympy.core.relational import Relational

import derivations
from derivations import symbols
from derivations.equality import components, random_point

from .test_derivations import each_equation


@each_equation
def test_a_function_has_the_values_of_what_was_derived(entry):
    """It has, at a random point, by position and by name; letters of one form alone cancel."""
    derived = entry.derive()
    point = random_point(derived.free_symbols | entry.readable().free_symbols, seed=1)
    function = derivations.function(entry.tag)
    values = {str(letter): float(value) for letter, value in point.items()}
    named = {name: values[name] for name in inspect.signature(function).parameters}
    with np.errstate(invalid="ignore"):
        value = function(**named)
        assert str(function(*named.values())) == str(value)
    if isinstance(derived, Relational):
        assert bool(value) == bool(derived.subs(point))
        return
    found = value if isinstance(value, tuple) else (value,)
    for part, form in zip(found, components(derived), strict=True):
        wanted = complex(form.subs(point).evalf(25))
        assert part == pytest.approx(np.nan if wanted.imag else wanted.real, 1e-10, nan_ok=True)


@each_equation
def test_letters_are_those_of_symbols_and_can_be_put_in(entry):
    forms = [derivations.equation(entry.tag)]
    if entry.printed is None:
        with pytest.raises(ValueError, match="does not print it"):
            derivations.equation(entry.tag, printed=True)
    else:
        forms.append(derivations.equation(entry.tag, printed=True))
        assert components(forms[1]) == components(entry.printed)
    for form in forms:
        hash(form)  # nobody can change what the registry holds
        for letter in form.free_symbols:
            assert letter not in form.subs(symbols.NAMED.get(letter.name, letter), 0.3).free_symbols


def test_letters_are_under_the_names_that_are_printed():
    assert symbols.I is symbols.NAMED["I"] is symbols.moment


def test_whole_numbers_and_single_precision():
    """Arguments broadcast, lists of integers count as real numbers; float32 stays."""
    drift = derivations.function("24")
    assert drift([[1], [2]], 0, 1, 1, [2, 3, 4]).shape == (2, 3)
    assert drift([1, 2], 0, 1, 1, 2).tolist() == drift([1.0, 2.0], 0.0, 1.0, 1.0, 2.0).tolist()
    assert drift(*np.ones((5, 3), np.float32)).dtype == np.float32


@pytest.mark.parametrize(
    ("tag", "given"),
    [("21", "(21)"), ("21", 21), ("21", np.int64(21)), ("B4", "b4"), ("B4", "(B4)")],
)
def test_a_tag_is_taken_as_it_is_written(tag, given):
    """A tag is found in parentheses, as a number, in either case."""
    assert derivations.equation(given) == derivations.equation(tag)
    assert derivations.function(given).__name__ == f"equation_{tag}"


def test_labels_stay():
    one, other = pd.Series([0.3, 0.4], list("ab")), pd.Series([1.0, 2.0], list("bc"))
    drift = derivations.function("26")(0.65, one, other)
    assert drift.index.tolist() == ["a", "b", "c"]
    assert drift["b"] == derivations.function("26")(0.65, 0.4, 1.0)


def test_constants_have_the_shape_of_the_arguments():
    """Components of a vector, of which some are zero, and forms without letters."""
    stuck = derivations.function("IV: stick without mu")()
    assert stuck == (0.0, 0.0)
    assert all(isinstance(part, float) for part in stuck)
    fitting, least = derivations.function("V: alpha and closure")([2.0, 3.0])
    assert fitting.shape == least.shape == (2,)
