"""Sums and products of floating-point numbers that carry along what their rounding took away.

That of Knuth (`two_sum`), of Dekker and Veltkamp (`two_product`, `split`) are exact. It is shown by
trying them on all pairs of numbers of a few binary digits.
"""

import numpy as np
import sympy as sp

from .arithmetic import Short
from .contacts import any_numbers
from .routines import Routine, low, read


def _short_pairs() -> tuple[Short, Short]:
    """All pairs of a short number of one size and one of any size that overlaps it, both signs."""
    whole = np.arange(2 ** (Short.digits - 1), 2**Short.digits, dtype=float)
    sizes = np.ldexp(whole[:, None], np.arange(-Short.digits - 2, 1)).ravel()
    a, b = np.meshgrid(whole, np.concatenate([sizes, -sizes]))
    return Short(a), Short(b)


def _exact(whole: str, parts: str, true: np.ndarray, found: dict[str, Short]) -> bool:
    """Whether a rounded value and its error add up to the true one."""
    return bool((found[whole].value + found[parts].value == true).all())


def _halves_are_exact(routine: Routine) -> bool:
    """Whether all numbers of seven binary digits are the sum of such parts, of few digits each."""
    a, _ = _short_pairs()
    found = routine.run("short", {"a": a})
    parts = (np.frexp(found[part].value)[0] for part in ("high", "rest"))
    few = [(np.ldexp(part, Short.digits // 2) % 1 == 0).all() for part in parts]
    return all(few) and _exact("high", "rest", a.value, found)


def _sum_is_exact(routine: Routine) -> bool:
    """Whether this holds for all pairs of numbers of seven binary digits, in either order."""
    a, b = _short_pairs()
    both = (routine.run("short", {"a": x, "b": y}) for x, y in ((a, b), (b, a)))
    return all(_exact("s", "error", a.value + b.value, found) for found in both)


def _product_is_exact(routine: Routine) -> bool:
    """Whether this holds for all pairs of numbers of seven binary digits."""
    a, b = _short_pairs()
    split = (_SPLIT.run("short", {"a": x}) for x in (a, b))
    first, second = ((part["a"], part["high"], part["rest"]) for part in split)
    found = routine.run("short", {"first": first, "second": second})
    return _exact("p", "error", a.value * b.value, found)


def _first_order() -> sp.Expr:
    """Derivative of a/b as both change by their low parts, at a = q b."""
    t, q, a_low, b_low = sp.symbols("t q a_low b_low")
    return ((q * _b + t * a_low) / (_b + t * b_low)).diff(t).subs(t, 0)


_a, _b, _rest = sp.symbols("a b rest")
_PAIR = {"a": _a, "b": _b}
_TWOFOLD = _PAIR | {"a_low": low(_a), "b_low": low(_b)}
_HALVES = {"first": (_a, _a - _rest, _rest), "second": (_b, _b / 2, _b / 2)}

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
    read("twofold_sum", lambda law: _TWOFOLD | {"high": _a + _b}, lambda: any_numbers("a b")),
    read("twofold_product", lambda law: _TWOFOLD | {"high": _a * _b}, lambda: any_numbers("a b")),
    read("twofold_quotient", lambda law: _PAIR | {"high": _a / _b}, lambda: any_numbers("a b")),
    read(
        "lacking",
        lambda law: {
            **{x: sp.Symbol(x) for x in ("q", "a_low", "b", "b_low")},
            "missing": _first_order(),
        },
        lambda: any_numbers("q a_low b b_low"),
    ),
)
