"""Words of the notes that are computed: numbers, angles, signs and comparisons."""

from collections.abc import Mapping

import sympy as sp

from .proof import components
from .symbols import V_z, X, Z, epsilon, k, mu, phi
from .typeset import latex

PAPER = {epsilon: sp.Rational(13, 20), mu: sp.Rational(3, 10)}  # of Figs. 11 and 13
THE_PAPERS = "the paper's restitution, {}".format  # of the value


def number(value: sp.Expr, digits: int = 2) -> str:
    """A value with so many digits that count, such as 0.76."""
    return f"{float(f'{float(value):.{digits}g}'):.12g}"


def degrees(angle: sp.Expr, digits: int = 1) -> str:
    """An angle in rad, said in degrees."""
    return f"{float(sp.deg(angle)):.{digits}f}".removesuffix(".0") + " degrees"


def percent(part: sp.Expr) -> str:
    """A ratio, said in percent."""
    return f"{number(100 * part)} %"


def formula(form: sp.Expr) -> str:
    """A form between dollar signs."""
    return f"${latex(form)}$"


def compared(one: sp.Expr, other: sp.Expr, words: tuple[str, str] = ("above", "below")) -> str:
    """The first word where one value is larger than the other, the second where it is smaller."""
    difference = sp.N(one - other, 30)
    if not difference.is_comparable or difference == 0:
        raise ValueError(f"{one} and {other} cannot be told apart")
    return words[0] if difference > 0 else words[1]


def extreme(form: sp.Expr, letter: sp.Symbol, there: sp.Expr, at: Mapping) -> str:
    """`largest` or `least`: what a form of a letter is there, beside both its neighbours."""
    value = form.subs(letter, there).subs(at)
    beside = [form.subs(letter, there * x).subs(at) - value for x in (0.9, 1.1)]
    (word,) = {compared(x, sp.S.Zero, ("least", "largest")) for x in beside}
    return word


def sign(form: sp.Expr | sp.MatrixBase, put: Mapping = {}) -> str:
    """`negative` or `positive`: what a form is for any positive lengths, speeds, friction.

    0 < epsilon < 1; `put` says what letters stand for first. ValueError where it has no one sign.
    """
    inelastic = sp.Symbol("loss", positive=True)  # (1 - epsilon)/epsilon
    letters = {x: sp.Symbol(str(x), positive=True) for x in (X, Z, k, mu, V_z)}
    letters |= {sp.sin(phi): sp.Symbol("sin", positive=True), epsilon: 1 / (1 + inelastic)}
    letters[sp.cos(phi)] = sp.Symbol("cos", positive=True)
    signs = set()
    for part in components(form):
        whole = sp.factor(sp.cancel(sp.together(part.subs(put).subs(letters))))
        if whole == 0:
            raise ValueError(f"{part} is zero")
        terms = [
            term
            for side in sp.fraction(whole)
            for factor in sp.Mul.make_args(side)
            for term in [sp.expand(factor)]
        ]
        value = 1
        for term in terms:
            each = {bool(x.is_negative) for x in sp.Add.make_args(term)}
            if len(each) != 1:
                raise ValueError(f"{part} has no one sign")
            value *= -1 if each == {True} else 1
        signs.add(value)
    if len(signs) != 1:
        raise ValueError(f"the parts of {form} differ in sign")
    return "negative" if signs == {-1} else "positive"
