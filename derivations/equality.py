"""Tests whether forms are equal: identically where they are rational, else at random points."""

import random
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from math import prod
from typing import Any, TypeAlias

import mpmath
import sympy as sp
from sympy.polys.rings import PolyRing

from . import symbols as s

Form: TypeAlias = sp.Expr | sp.MatrixBase | sp.Rel
Pair: TypeAlias = tuple[sp.Expr, sp.Expr]
Triple: TypeAlias = tuple[sp.Expr, sp.Expr, sp.Expr]
Forms: TypeAlias = dict[sp.Symbol, sp.Expr]  # by what they are the values of
NamedForms: TypeAlias = dict[str, sp.Expr]
Residuals: TypeAlias = Iterable[sp.Expr]  # what vanishes where a form is right

DIGITS = 40
POINTS = 5

# Where random points are drawn; other letters lie in (-2, 2), or in (1/2, 2) if positive.
DOMAIN = {
    s.mu: ("1/20", "7/10"),
    s.epsilon: ("1/10", "9/10"),
    s.phi: ("1/10", "7/5"),
    s.h_0: ("1/10", "9"),
    s.theta: ("0", "6"),
}


def components(form: Form) -> tuple[sp.Expr, ...]:
    """The scalar expressions of a form; an inequality a > b counts as a - b."""
    if isinstance(form, sp.MatrixBase):
        return tuple(form)
    if isinstance(form, sp.Rel):
        return (form.gts - form.lts,)
    return (sp.sympify(form),)


@cache
def vanishes(expr: sp.Expr) -> bool:
    """Whether an expression, rational in its letters and in tan(phi/2), is identically zero."""
    expr = expr.doit()
    if not equal_at_random_points(expr, sp.S.Zero, points=1):
        return False  # the quick way out
    if expr.has(s.phi):
        half = sp.Symbol("tau", positive=True)
        sine, cosine = 2 * half / (1 + half**2), (1 - half**2) / (1 + half**2)
        expr = sp.expand_trig(expr).subs({sp.sin(s.phi): sine, sp.cos(s.phi): cosine})
    top = sp.numer(sp.together(expr))
    try:
        return not PolyRing(sorted(top.free_symbols, key=str), sp.QQ).from_expr(top)
    except ValueError:  # it has roots, or pi
        return sp.expand(top) == 0


def is_zero(expr: sp.Expr) -> bool:
    """Whether `expr` vanishes at random points, and identically where it is rational."""
    trigonometric = {sp.sin(s.phi), sp.cos(s.phi)}
    rational = (
        not expr.has(sp.Float)
        and expr.atoms(sp.Function) <= trigonometric
        and all(power.exp.is_Integer for power in expr.atoms(sp.Pow))
    )
    return vanishes(expr) if rational else equal_at_random_points(expr, sp.S.Zero)


def random_point(free: Iterable[sp.Symbol], seed: int) -> dict[sp.Symbol, sp.Rational]:
    """Random rational values of letters in `DOMAIN`, reproducible by their seed."""
    draw = random.Random(seed)
    point = {}
    for symbol in sorted(free, key=str):
        default = ("1/2", "2") if symbol.is_positive else ("-2", "2")
        low, high = map(sp.Rational, DOMAIN.get(symbol, default))
        point[symbol] = low + (high - low) * sp.Rational(draw.randrange(1, 10**6), 10**6)
    return point


@cache
def _compiled(expr: sp.Expr) -> tuple[list[sp.Symbol], Callable[..., mpmath.mpf]]:
    """Letters of an expression, and the expression as an mpmath function of them."""
    letters = sorted(expr.free_symbols, key=str)
    return letters, sp.lambdify(letters, expr, "mpmath")


def value(form: sp.Expr, at: Mapping[sp.Symbol, Any]) -> Any:
    """Value of a form where its letters have values, by mpmath."""
    letters, function = _compiled(form)
    return function(*(at[letter] for letter in letters))


def _value(expr: sp.Expr, known: dict[sp.Expr, mpmath.mpf]) -> mpmath.mpf:
    """Value of an expression; `known` has its letters' values, and gains those of its parts."""
    if expr not in known:
        if expr.is_Add or expr.is_Mul or expr.is_Pow:
            parts = [_value(part, known) for part in expr.args]
            combine = sum if expr.is_Add else prod
            known[expr] = mpmath.power(*parts) if expr.is_Pow else combine(parts)
        else:
            known[expr] = value(expr, known)
    return known[expr]


@cache
def equal_at_random_points(a: sp.Expr, b: sp.Expr, points: int = POINTS) -> bool:
    """Whether two expressions agree to 40 digits at random rational points."""
    letters = a.free_symbols | b.free_symbols
    with mpmath.workdps(DIGITS + 20):
        for seed in range(points):
            point = random_point(letters, seed)
            known = {letter: mpmath.mpf(x.p) / x.q for letter, x in point.items()}
            x, y = _value(a, known), _value(b, known)
            if not abs(x - y) <= mpmath.mpf(10) ** -DIGITS * (1 + abs(y)):  # nan, too
                return False
    return True


def same(a: Form, b: Form) -> bool:
    """Whether two forms are identically equal; inequalities may differ by a positive factor."""
    pairs = zip(components(a), components(b), strict=True)
    if isinstance(a, sp.Rel):
        as_strict = ("=" in a.rel_op) == ("=" in b.rel_op)
        return as_strict and all(sp.cancel(x / y).is_positive for x, y in pairs)
    return all(vanishes(x - y) for x, y in pairs)


def equal(a: Form, b: Form) -> bool:
    """Whether two forms agree at random points."""
    pairs = zip(components(a), components(b), strict=True)
    return all(equal_at_random_points(x.doit(), y.doit()) for x, y in pairs)
