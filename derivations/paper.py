"""The paper's formulas and sentences (paper.toml), and LaTeX read as SymPy expressions.

A slash divides by the number or letter behind it, or by 2 pi, or 2 sqrt(3): 3/2 h_0 is three halves
of h_0. In a vector formula, (1) to (4), products are those of columns of components.
"""

import hashlib
import re
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

import sympy as sp
from sympy.core.parameters import distribute

from . import symbols as s


def text_of(name: str) -> str:
    """Text of a file of this package."""
    return resources.files(__package__).joinpath(name).read_text("utf-8")


SOURCE = resources.files(__package__).joinpath("paper.toml").read_bytes()
DIGEST = "bd41e61dc1ff73e4"  # of paper.toml, when it was compared with our copy of the paper
_GREEK = ("alpha", "epsilon", "mu", "omega", "phi", "theta")


class Formula(NamedTuple):
    """A formula or a sentence of the paper."""

    tex: str

    @property
    def sides(self) -> list[str]:
        """Sides between equals signs, without the condition > 0 at the end of (7) and (14)."""
        return re.split(r" (?:=|\\equiv) ", self.tex.removesuffix(" > 0"))

    @property
    def left(self) -> str:
        """Left side of an equation; empty for a bare formula or a condition."""
        return self.sides[0] if len(self.sides) > 1 else ""

    @property
    def right(self) -> str:
        """Right side of an equation, or the whole formula."""
        return self.sides[-1]


_TEXTS = tomllib.loads(SOURCE.decode("utf-8"))
EQUATIONS = {tag: Formula(tex) for tag, tex in _TEXTS["equations"].items()}
SENTENCES: dict[str, str] = _TEXTS["sentences"]
NOTED = _TEXTS["noted"]


def sealed() -> bool:
    """Whether paper.toml is unchanged since it was compared with our copy of the paper."""
    return hashlib.sha256(SOURCE).hexdigest()[:16] == DIGEST


def bare(left: str) -> str:
    """A left side for comparison: without spaces and braces, primes behind subscripts."""
    return re.sub(r"'(_\w)", r"\1'", re.sub(r"[\s{}]|\\,", "", left))


def parts(left: str) -> list[str]:
    """Letters of a left side such as (X, k_{a, b}), split at the commas outside of braces."""
    inside = re.fullmatch(r"\((.*)\)", left)
    return re.split(r",\s*(?![^{(]*[})])", inside[1]) if inside else []


_AT = re.compile(r"\[(.*)\]_\{(.*) = (.*)\}")
_SLOPE = re.compile(r"\\partial_(\\?\w+) (.*)")


def value_of(left: str, letters: Mapping[str, Any]) -> sp.Expr:
    r"""Value of a left side by those of its letters, which are added to the paper's.

    Beside what `read` knows: [\phi_c]_{\mu = 3/5}, \mathrm{sgn}(x), \partial_\mu c'_x, and [k_n]
    for the dimension of k_n.
    """
    known = LETTERS | dict(letters)
    if found := _AT.fullmatch(left):
        inner, letter, there = found.groups()
        return value_of(inner, letters).subs(read(letter, known), read(there, known))
    if found := _SLOPE.fullmatch(left):
        return value_of(found[2], letters).diff(read(found[1], known))
    if left.startswith(r"\mathrm{sgn}"):
        return sp.sign(read(left.removeprefix(r"\mathrm{sgn}"), known))
    return read(left[1:-1] if left.startswith("[") else left, known)


class _Reader:
    """Reader of a LaTeX formula, which takes its parts one after the other."""

    def __init__(self, tex: str, letters: Mapping[str, Any]):
        names = map(re.escape, sorted(letters, key=len, reverse=True))
        tex = re.sub(r"\\left|\\right|\\limits|\\,", "", tex)
        tex = re.sub(r"/(\d+(?:\\sqrt\{\d+\}|\\pi))", r"/(\1)", tex)
        parts = "|".join([r"d\\theta", *names, r"\\[a-z]+", r"[\d.]+", r"\S"])
        self.rest = ["", *reversed(re.findall(parts, tex))]  # the next one last
        self.letters = letters

    def comes(self, part: str) -> bool:
        """Take a part if it comes next."""
        found = self.rest[-1] == part
        if found:
            self.rest.pop()
        return found

    def sum(self) -> Any:
        """Read a sum; it is a column if its terms are columns."""
        terms: list[Any] = []
        while not terms or self.comes("+") or self.rest[-1] == "-":
            sign = -1 if self.comes("-") else 1
            terms.append(sign * self.product())
        return sum(terms[1:], terms[0])

    def product(self) -> Any:
        """Read a product, one of columns if its factors are columns."""
        value = self.power()
        while self.rest[-1] not in ("", "d\\theta", *"+-)]}<>"):
            if self.comes("/"):
                value /= self.power()
            elif self.comes(r"\times"):
                value = value.cross(self.power())
            elif self.comes(r"\cdot") and isinstance(value, sp.MatrixBase):
                value = value.dot(self.power())
            else:
                value *= self.power()
        return value

    def power(self) -> Any:
        """Read a factor with its exponent."""
        base = self.factor()
        return base ** self.factor() if self.comes("^") else base

    def factor(self) -> Any:
        """Read a letter, number, bracket, fraction, root, function or integral."""
        part = self.rest.pop()
        if part in self.letters:
            return self.letters[part]
        if part in ("(", "[", "{"):
            value = self.sum()
            self.rest.pop()
            return value
        if part == r"\frac":
            return self.factor() / self.factor()
        if part == r"\int":
            ends = [self.factor() for sign in "_^" if self.comes(sign)]
            value = self.sum()
            self.rest.pop()
            return sp.Integral(value, (s.theta, *ends))
        if part.startswith("\\"):
            function = getattr(sp, part[1:].replace("arc", "a"))
            exponent = self.factor() if self.comes("^") else 1
            return function(self.factor()) ** exponent
        return sp.Rational(part)


def read(tex: str, letters: Mapping[str, Any]) -> Any:
    """Expression of a LaTeX formula; a column of components if its letters stand for columns."""
    reader = _Reader(tex, letters)
    with distribute(False):
        value = reader.sum()
        for sign, relation in (("<", sp.Lt), (">", sp.Gt)):
            value = relation(value, reader.sum()) if reader.comes(sign) else value
    if not reader.comes(""):
        raise ValueError(f"{tex} has no meaning from {reader.rest[-1]!r} on")
    return value


# Letters by their LaTeX in the paper, and impulses as (7) and (B3) write them.
LETTERS: dict[str, Any] = {
    ("\\" if name.partition("_")[0] in _GREEK else "") + name: letter
    for name, letter in s.NAMED.items()
} | {
    r"\pi": sp.pi,
    "P_z(t_f)": s.P_z,
    "P_x(t_f)": s.P_x,
    "P_z(t_1)": s.P_1,
    r"\int_{t_1}^{t_f} F_z": s.P_z - s.P_1,
    r"\omega_x": sp.Symbol("omega_x", real=True),
    r"\phi_c": s.phi,
    r"\alpha": s.alpha,
    "c'_x": sp.Symbol("cprime_x", real=True),
    "c'_z": sp.Symbol("cprime_z", real=True),
    r"\mathbf{s}": sp.Symbol("s", positive=True),
    **{
        x: sp.Symbol(x.removeprefix("\\"), positive=True)
        for x in (r"\delta", r"\gamma_n", r"\gamma_t", "k_n", "k_t", "v_n", "v_t", "M_e", "D", "g")
    },
}
COMPONENTS = {  # of vectors on left sides, by the steps that derive them
    r"\mathbf{v}": ("u", "v"),
    r"m \frac{d\mathbf{v}}{dt}": (r"m \dot v_x", r"m \dot v_z"),
}
_VECTORS = {  # letters, with their components
    r"\mathbf{u}": (sp.sin(s.phi), 0, sp.cos(s.phi)),
    r"\mathbf{c}": (s.c_x, 0, s.c_z),
    r"\mathbf{V}": (0, 0, s.V_z),
    r"\mathbf{F}": (s.F_x, 0, s.F_z),
    r"\boldsymbol{\omega}": (0, s.omega, 0),
    r"d\mathbf{P}": (s.P_x, 0, s.P_z),
}


def setting(figure: str) -> dict[sp.Expr, sp.Rational]:
    """Values of letters that the caption of a figure gives."""
    pairs = (text.split(" = ") for text in _TEXTS["settings"][figure])
    return {read(left, LETTERS): sp.Rational(value) for left, value in pairs}


TWO_SUMS = ("IV: condition for phi_c", *(tag for tag in EQUATIONS if tag.startswith("V: c")))


def left_of(tag: str) -> str:
    """Left side that goes with `printed`; "0" for an equation between two sums."""
    return "0" if tag in TWO_SUMS else EQUATIONS[tag].left


@cache
def printed(tag: str) -> Any:
    """Right side of a formula of the paper; for a vector, its components in the plane.

    For an equation between two sums it is the left side less the right one.
    """
    formula, columns = EQUATIONS[tag], {tex: sp.Matrix(x) for tex, x in _VECTORS.items()}
    found = read(formula.right, LETTERS | columns)
    if tag in TWO_SUMS:
        return read(formula.left, LETTERS) - found
    if not isinstance(found, sp.MatrixBase):
        return sp.sympify(found)
    part = [x for x in found if x != 0]
    return part[0] if len(part) == 1 else sp.Matrix([found[0], found[2]])
