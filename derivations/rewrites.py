"""Named rules that turn derived expressions into ones that compute well.

A rule maps the body of a function (ordered assignments) to an equal one. The last rule gives the
assignments of functions.toml, which are generated. After every rule `rewrite` proves the equality,
with all abbreviations written out, and counts the operations. A rule that changed a value raises
`RewriteError`.
"""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import sympy as sp

from . import slide
from .equality import Forms, is_zero
from .laws import V_1, A, B, C, a_1, a_2
from .newton import contact_change
from .paper import text_of
from .symbols import NAMED, P_1, P_z, X, Z, k, m, v_1
from .trace import remembered

WORDS = tomllib.loads(text_of("functions.toml"))

# Abbreviations of the generated code. N and T are k^2 times what a unit of normal impulse adds to
# v and takes from u in forward slip, N_back and T_back those in backward slip.
N, T, N_back, T_back = sp.symbols("N T N_back T_back", real=True)
K, K_z = sp.symbols("K K_z", positive=True)  # k^2 + X^2 + Z^2 and k^2 + Z^2
w, r = sp.symbols("w r", real=True)  # a_2 P_1 and a_2/a_1


class Letters(dict[str, sp.Symbol]):
    """Letters by their names; an unknown name stands for any real number."""

    def __missing__(self, name: str) -> sp.Symbol:
        return sp.Symbol(name, real=True)


LETTERS = Letters(NAMED | {letter.name: letter for letter in (K, K_z, A, B, C)})


@remembered
def responses() -> Forms:
    """N, T, N_back, T_back in X, Z, k, mu, read off the change of the contact velocity."""
    found: Forms = {}
    for along, up, direction in ((T, N, 1), (T_back, N_back, -1)):
        u, v = contact_change(slide.friction(P_z, direction), P_z)
        found |= {up: sp.expand(m * k**2 * v / P_z), along: sp.expand(-m * k**2 * u / P_z)}
    return found


RESPONSES = responses()
SQUARES = {K: k**2 + X**2 + Z**2, K_z: k**2 + Z**2}
# v_1 where slopes are general, and where they are those of the contact
GENERAL = {w: a_2 * P_1, r: a_2 / a_1, v_1: V_1}
CONTACT = {**RESPONSES, v_1: slide.stop()[2]}


class Rule(NamedTuple):
    """A named rewriting step and the reason for it."""

    name: str
    why: str
    apply: Callable[[Forms], Forms]


class RewriteError(ArithmeticError):
    """A rewriting rule changed the value of an expression."""


def written_out(body: Forms, meaning: Forms) -> Forms:
    """Assignments of a body with earlier ones and all abbreviations substituted."""
    known: Forms = {}
    for symbol, expr in body.items():
        known[symbol] = expr.subs(known).subs(meaning)
    return known


def operations(body: Forms) -> int:
    """Number of arithmetic operations in a body."""
    return sp.count_ops([*body.values()])


def rewrite(
    derived: Forms, rules: tuple[Rule, ...], meaning: Forms
) -> tuple[Forms, dict[str, int]]:
    """Apply rules in order and prove after each that every output equals its derived form.

    Returns the body, and how many operations each rule left.
    """
    body = dict(derived)
    counts = {"as derived": operations(body)}
    for rule in rules:
        body = rule.apply(body)
        values = written_out(body, meaning)
        for symbol, expr in derived.items():
            if not is_zero(values[symbol] - expr.subs(meaning)):
                raise RewriteError(f"rule {rule.name!r} changed {symbol}: {expr} to {body[symbol]}")
        counts[rule.name] = operations(body)
    return body, counts


SINGLE_FRACTION = Rule(
    "single fraction",
    "one division; quantities that do not matter drop out",  # as mu in sticking
    lambda body: {symbol: sp.cancel(expr) for symbol, expr in body.items()},
)


@dataclass(frozen=True)
class Function:
    """One generated function, in the words of functions.toml.

    name : name of the function
    derived : gives the outputs by their names
    first : rules that come before the one of functions.toml
    meaning : what abbreviations among its letters stand for
    letters : letters of the assignments, by their names
    """

    name: str
    derived: Callable[[], Mapping[Any, sp.Expr]]
    first: tuple[Rule, ...] = ()
    meaning: Forms = field(default_factory=dict)
    letters: Letters = field(default_factory=lambda: LETTERS)

    @property
    def words(self) -> Mapping[str, str]:
        """Sentences, arguments and assignments of the function in functions.toml."""
        return WORDS[self.name]

    @property
    def arguments(self) -> list[sp.Symbol]:
        """Letters of the function's arguments."""
        return [self.letters[name] for name in self.words["arguments"].split()]

    @cached_property
    def outputs(self) -> Forms:
        """Outputs of the function, as derived, by their letters; impulses per unit mass."""
        return {self.letters[str(x)]: form.subs(m, 1) for x, form in self.derived().items()}

    @property
    def lines(self) -> dict[str, str]:
        """Assignments as they are generated: text of plain arithmetic, by the name of its value."""
        return dict(line.split(" = ") for line in self.words["text"].strip().splitlines())

    @property
    def rules(self) -> tuple[Rule, ...]:
        """All rules of the function; the last gives the assignments of functions.toml."""
        body = {}
        for name, form in self.lines.items():
            if "**" in form:
                raise ValueError(f"not plain arithmetic: {form}")
            value = eval(form, {}, self.letters)
            exact = sp.nsimplify(value, rational=True, rational_conversion="exact")
            body[self.letters[name]] = exact  # 0.5 is one half, but 0.1 no tenth
        return *self.first, Rule(self.words["rule"], self.words["why"], lambda _: body)

    @cached_property
    def body(self) -> tuple[Forms, dict[str, int]]:
        """Rewritten assignments and the history of operation counts."""
        return rewrite(self.outputs, self.rules, self.meaning)
