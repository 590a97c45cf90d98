"""The paper's formulas and sentences (paper.toml), and LaTeX read as SymPy expressions.

SymPy's parser reads each piece of a formula, in its lark grammar: the inside of a bracket, of a
fraction, the whole. The grammar needs every product and every argument of a function marked, takes
some letters for constants and knows no vectors; so letters and pieces that were read are numbered,
products get their dot, and the products of a vector formula, (1) to (4), are worked out before.
A slash divides by the number behind it, or 2 pi, or 2 sqrt(3): 3/2 h_0 is three halves of h_0.
"""

import hashlib
import re
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

import sympy as sp
from sympy.parsing.latex.lark import LarkLaTeXParser

from . import symbols as s

SOURCE = resources.files(__package__).joinpath("paper.toml").read_bytes()
DIGEST = "0de1b372748cb071"  # of paper.toml, when it was compared with our copy of the paper
_GREEK = ("alpha", "epsilon", "mu", "omega", "phi", "theta")
_WORD = r"\\(?:frac|sqrt|sin|cos|tan|arccos|arctan|int|times|cdot)(?![A-Za-z])"
_LETTER = "[\ue000-\uf8ff]"
_APPLIED = re.compile(
    rf"\\(?:sin|cos|tan|arccos|arctan)(?:\^\d|\^\{{.\}})?(?:{_LETTER}|\{{{_LETTER}\}})"
)
_PIECE = r"(?:[^(){}]|\{.\})"
_INNER = re.compile(rf"\\frac\{{.\}}\{{.\}}|\(({_PIECE}+)\)|\{{({_PIECE}{{2,}})\}}")
_PRODUCT = re.compile(rf"(?:(?<={_LETTER}|\}})|(?<=\^\d))(?={_LETTER}|\\)")
_VECTOR = r"d?\\(?:mathbf|boldsymbol)\{\\?\w+\}"


class Formula(NamedTuple):
    """A formula or a sentence of the paper."""

    tex: str

    @property
    def left(self) -> str:
        """Left side of an equation; nothing of a bare formula or a condition."""
        left, sign, _ = self.tex.replace(r"\equiv", "=").partition("=")
        return left.strip() if sign else ""

    @property
    def right(self) -> str:
        """The rest of it, without the sign of a condition such as (7)."""
        right = self.tex.replace(r"\equiv", "=").rpartition("=")[2]
        return right.removesuffix(self.condition).strip()

    @property
    def condition(self) -> str:
        """What an equation that is a condition, too, ends with."""
        return "> 0" if self.left and self.tex.endswith("> 0") else ""


_TEXTS = tomllib.loads(SOURCE.decode("utf-8"))
EQUATIONS = {tag: Formula(tex) for tag, tex in _TEXTS["equations"].items()}
SENTENCES: dict[str, str] = _TEXTS["sentences"]
NOTED: list[dict[str, str]] = _TEXTS["noted"]


def sealed() -> bool:
    """Whether paper.toml is what was compared with our copy."""
    return hashlib.sha256(SOURCE).hexdigest()[:16] == DIGEST


def bare(left: str) -> str:
    """A left side without what does not change its meaning."""
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


@cache
def _parser() -> LarkLaTeXParser:
    return LarkLaTeXParser()


@cache
def _shape(tex: str) -> sp.Expr:
    """What the grammar makes of a piece, which must have one meaning."""
    found = _parser().doparse(tex)
    if not isinstance(found, sp.Basic):
        raise ValueError(f"{tex} has no meaning, or several")
    return found


def _term(tex: str) -> sp.Expr:
    """A product whose letters are single characters, in symbols of these names."""
    letters = list(dict.fromkeys(re.findall(_LETTER, tex)))
    if not _APPLIED.fullmatch(tex):
        tex = _PRODUCT.sub(r" \\cdot ", tex)
    tex = re.sub(r"(\\int_(?:\w|\{.\})\^(?:\w|\{.\})) \\cdot", r"\1", tex)
    for number, letter in enumerate(letters):
        tex = tex.replace(letter, f"a_{{{number}}}")
    names = {sp.Symbol(f"a_{{{n}}}"): sp.Symbol(letter) for n, letter in enumerate(letters)}
    return _shape(tex).xreplace(names)


def _sum(tex: str) -> sp.Expr:
    """A piece without brackets, term by term; a condition as a whole."""
    if "<" in tex or ">" in tex:
        return _term(tex)
    terms = [
        _term(term) * (-1) ** sign.count("-") for sign, term in re.findall("([+-]?)([^+-]+)", tex)
    ]
    return sp.Add(*terms)


def read(tex: str, letters: Mapping[str, Any]) -> Any:
    """Expression of a formula; a column of components where its letters stand for columns."""
    known: dict[str, Any] = {}

    def named(value: Any) -> str:
        character = chr(0xE000 + len(known))
        known[character] = value
        return character

    def product(found: re.Match) -> str:
        one, other = letters[found[1]], letters[found[3]]
        return named(one.cross(other) if found[2] == r"\times" else one.dot(other))

    def inner(found: re.Match) -> str:
        if not (found[1] or found[2]):
            return named(_term(found[0]))
        value = named(_sum(found[1] or found[2]))
        return value if found[1] else f"{{{value}}}"

    def resolved(expr: Any, component: int) -> Any:
        while private := [x for x in expr.atoms(sp.Symbol) if x.name in known]:
            values = {x: known[x.name] for x in private}
            expr = expr.xreplace(
                {x: v[component] if isinstance(v, sp.MatrixBase) else v for x, v in values.items()}
            )
        return expr

    tex = re.sub(r"\\left|\\right|\\limits|\\,", "", tex)
    tex = re.sub(r"/(\d+(?:\\sqrt\{\d+\}|\\pi))", r"/(\1)", tex)
    tex = re.sub(rf"({_VECTOR}) *(\\times|\\cdot) *({_VECTOR})", product, tex)
    names = "|".join(re.escape(name) for name in sorted(letters, key=len, reverse=True))
    tex = re.sub(
        rf"(d(?=\\theta))|({names})|({_WORD})",
        lambda x: named(letters[x[2]]) if x[2] else x[0],
        tex,
    )
    tex = re.sub(r"(?<![_^\d])(?<!sqrt\[)[\d.]+", lambda x: named(sp.Rational(x[0])), tex)
    tex = re.sub(r"(?<!\\sqrt)\[(.*?)\]", r"(\1)", re.sub(r"\\cdot| ", "", tex))
    while True:
        tex = _APPLIED.sub(lambda x: named(_term(x[0])), tex)
        tex = re.sub(rf"({_LETTER})/({_LETTER})", r"\\frac{\1}{\2}", tex)
        found = _INNER.search(tex)
        if not found:
            break
        tex = tex.replace(found[0], inner(found))
    whole = _sum(tex)
    if any(isinstance(value, sp.MatrixBase) for value in known.values()):
        return sp.Matrix([resolved(whole, component) for component in range(3)])
    return resolved(whole, 0)


# The letters as the paper writes them, and what (7) and (B3) write for an impulse.
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
    r"\mathbf{s}": sp.Symbol("s", positive=True),
    r"\delta": sp.Symbol("delta", positive=True),
    "c'_x": sp.Symbol("cprime_x", real=True),
    "c'_z": sp.Symbol("cprime_z", real=True),
    **{x: sp.Symbol(x, positive=True) for x in ("g", "D", "M_e", "v_n", "v_t", "k_n", "k_t")},
    **{rf"\gamma_{x}": sp.Symbol(f"gamma_{x}", positive=True) for x in "nt"},
}
COMPONENTS = {  # of vectors on left sides, by the steps that derive them
    r"\mathbf{v}": ("u", "v"),
    r"m \frac{d\mathbf{v}}{dt}": (r"m \dot v_x", r"m \dot v_z"),
}
_LETTERS_OF_VECTORS = {
    r"\mathbf{u}": sp.Matrix([sp.sin(s.phi), 0, sp.cos(s.phi)]),
    r"\mathbf{c}": sp.Matrix([s.c_x, 0, s.c_z]),
    r"\mathbf{V}": sp.Matrix([0, 0, s.V_z]),
    r"\mathbf{F}": sp.Matrix([s.F_x, 0, s.F_z]),
    r"\boldsymbol{\omega}": sp.Matrix([0, s.omega, 0]),
    r"d\mathbf{P}": sp.Matrix([s.P_x, 0, s.P_z]),
}


def setting(figure: str) -> dict[sp.Expr, sp.Rational]:
    """The numbers of a caption."""
    pairs = (text.split(" = ") for text in _TEXTS["settings"][figure])
    return {read(left, LETTERS): sp.Rational(value) for left, value in pairs}


TWO_SUMS = ("IV: condition for phi_c", *(tag for tag in EQUATIONS if tag.startswith("V: c")))


@cache
def printed(tag: str) -> Any:
    """Right side of a formula of the paper; the components of a vector in the plane.

    Of an equation between two sums, the left side less the right one.
    """
    formula, letters = EQUATIONS[tag], LETTERS | _LETTERS_OF_VECTORS
    found = read(formula.right, letters)
    if tag in TWO_SUMS:
        return read(formula.left, letters) - found
    if not isinstance(found, sp.MatrixBase):
        return sp.sympify(found)
    part = [x for x in found if x != 0]
    return part[0] if len(part) == 1 else sp.Matrix([found[0], found[2]])
