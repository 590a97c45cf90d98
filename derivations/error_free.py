"""Sums and products of floating-point numbers that carry along what their rounding took away.

The sum of Knuth (`two_sum`), the product of Dekker and Veltkamp (`two_product`, `split`) are exact
for numbers of any number of digits: that is their theorem. The proof here is of the text, not of
the theorem: it tries all pairs of numbers of seven binary digits.

shown      exactness for seven digits, rounded to nearest even, ties and both signs among them.
           Numbers whose sizes differ by more than those tried are returned as they are; a power
           of two as a common factor, or both signs turned, change no digit
not shown  the step from 7 digits to 53 (each is odd; halves of 3 and 3 digits stand for 26 and 26),
           and what leaves the range: a part of a product that is subnormal, `SPLIT` times a number
           beyond 2^996, infinity, nan
"""

from collections.abc import Mapping

import numpy as np
import sympy as sp

from .arithmetic import Short
from .contacts import any_numbers
from .routines import Meaning, Routine, low, read


def _short_pairs() -> tuple[Short, Short]:
    """All pairs of a short number of one size and one of any size that overlaps it, both signs."""
    whole = np.arange(2 ** (Short.digits - 1), 2**Short.digits, dtype=float)
    sizes = np.ldexp(whole[:, None], np.arange(-Short.digits - 2, 1)).ravel()
    a, b = np.meshgrid(whole, np.concatenate([sizes, -sizes]))
    return Short(a), Short(b)


def _exact(true: np.ndarray, pair: tuple[Short, Short]) -> bool:
    """Whether a pair is the true value, rounded, and what that took away."""
    rounded, error = (part.value for part in pair)
    return bool(((rounded == Short(true).value) & (rounded + error == true)).all())


def _halves_are_exact(routine: Routine) -> bool:
    """Whether all numbers of seven binary digits are the sum of halves of three digits each."""
    a, _ = _short_pairs()
    whole, *halves = (part.value for part in routine.run("short", {"a": a})["returned"])
    short = [np.ldexp(np.frexp(half)[0], Short.digits // 2) % 1 == 0 for half in halves]
    first = abs(halves[0]) > abs(halves[1])
    return bool((first & short[0] & short[1] & (sum(halves) == a.value) & (whole == a.value)).all())


def _sum_is_exact(routine: Routine) -> bool:
    """Whether sum and error are exact for all pairs of seven binary digits, in either order."""
    a, b = _short_pairs()
    both = (routine.run("short", {"a": x, "b": y}) for x, y in ((a, b), (b, a)))
    return all(_exact(a.value + b.value, found["returned"]) for found in both)


def _product_is_exact(routine: Routine) -> bool:
    """Whether product and error are exact for all pairs of numbers of seven binary digits."""
    a, b = _short_pairs()
    first, second = (_SPLIT.run("short", {"a": x})["returned"] for x in (a, b))
    found = routine.run("short", {"first": first, "second": second})
    return _exact(a.value * b.value, found["returned"])


def _first_order() -> sp.Expr:
    """Derivative of a/b as both change by their low parts, at a = q b."""
    t, q, a_low, b_low = sp.symbols("t q a_low b_low")
    return ((q * _b + t * a_low) / (_b + t * b_low)).diff(t).subs(t, 0)


_a, _b, _rest = sp.symbols("a b rest")
_PAIR = {"a": _a, "b": _b}
_TWOFOLD = _PAIR | {"a_low": low(_a), "b_low": low(_b)}
_HALVES = {"first": (_a, _a - _rest, _rest), "second": (_b, _b / 2, _b / 2)}


def _twofold(name: str, means: Mapping[str, Meaning]) -> Routine:
    return read(name, lambda law: means, lambda: any_numbers("a b"))


_SPLIT = read(
    "split",
    lambda law: {"a": _a, "t": (2**27 + 1) * _a, "high": _a, "rest": 0},
    lambda: any_numbers("a"),
    check=_halves_are_exact,
)
ROUTINES = (
    _SPLIT,
    read(
        "two_product",
        lambda law: _HALVES | {"p": _a * _b, "error": 0},
        lambda: any_numbers("a b rest"),
        check=_product_is_exact,
    ),
    read(
        "two_sum",
        lambda law: _PAIR | {"s": _a + _b, "part": _b, "error": 0},
        lambda: any_numbers("a b"),
        check=_sum_is_exact,
    ),
    read(
        "total",
        lambda law: _PAIR | {"rest": _rest, "small": _rest, "whole": _a + _b + _rest, "lack": 0},
        lambda: any_numbers("a b rest"),
    ),
    _twofold("twofold_sum", _TWOFOLD | {"returned": (_a + _b, 0)}),
    _twofold("twofold_product", _TWOFOLD | {"returned": (_a * _b, 0)}),
    _twofold("twofold_quotient", _PAIR | {"returned": (_a / _b, 0)}),
    read(
        "lacking",
        lambda law: {
            **{x: sp.Symbol(x) for x in ("q", "a_low", "b", "b_low")},
            "missing": _first_order(),
        },
        lambda: any_numbers("q a_low b b_low"),
    ),
)
