"""How one form looks: terms in the paper's order, as MathML and as LaTeX, and formulas in prose.

`presented` looks for the form of a derived expression that reads best (or most like the printed
one) and proves that it still has the same value. Order and signs of terms are the printers' work.
"""

import html
import re
from collections.abc import Iterator
from difflib import SequenceMatcher

import sympy as sp
from sympy.printing.latex import LatexPrinter
from sympy.printing.mathml import MathMLPresentationPrinter
from sympy.printing.precedence import PRECEDENCE

from . import symbols as s
from .proof import Form, components, equal_at_random_points

# Letters in the order in which they stand in a product; what is not named comes last.
_LETTERS = (
    "pi epsilon m M mu I l d gain bounce k omega theta eta A B C a a_1 a_2 q X Z x z h h_0 r j "
    "c_x c_z u_0 u_f v_0 v_1 v_f V_z V_0 P_x P_z P_1 F_x F_z"
).split()
_RANK = {name: rank for rank, name in enumerate(_LETTERS)}


class PresentationError(ArithmeticError):
    """A form chosen for its looks has another value than the derived one."""


# ---- order and signs --------------------------------------------------------------------------


def _ranks(expr: sp.Expr) -> list[tuple[int, str]]:
    return sorted((_RANK.get(x.name, len(_RANK)), x.name) for x in expr.free_symbols)


def _factor_key(factor: sp.Expr) -> tuple:
    """Numbers, letters, roots and functions, sums."""
    base = factor.as_base_exp()[0]
    kind = 0 if base.is_Number else 1 if base.is_Symbol else 3 if base.is_Add else 2
    return kind, len(base.free_symbols), -isinstance(base, sp.sin), _ranks(base), str(factor)


def _term_key(term: sp.Expr) -> tuple:
    """Numbers first, then what has few letters, low powers first."""
    powers = sp.total_degree(term, *term.free_symbols) if term.is_polynomial() else 99
    return len(term.free_symbols), _ranks(term), powers, str(term)


def _parts(expr: sp.Expr) -> tuple[bool, list[sp.Expr], list[sp.Expr]]:
    """Whether a product is negative, and its factors above and below the fraction bar."""
    number, above, below = sp.S.One, [], []
    for factor in sp.Mul.make_args(expr):
        base, exponent = factor.as_base_exp()
        if factor.is_Rational:
            number *= factor
            continue
        if base.is_Add and exponent.is_Integer:
            content = base.primitive()[0]
            content = content if content.is_Integer else sp.S.One
            minus = sum(_parts(term)[0] for term in base.args)
            content *= -1 if 2 * minus > len(base.args) else 1
            base, number = sp.expand(base / content, deep=False), number * content**exponent
        down = exponent.is_number and exponent.is_negative
        (below if down else above).append(base ** (-exponent if down else exponent))
    for root in [f for f in above if f.is_Pow and f.exp == sp.S.Half and f.base.is_Integer]:
        if number.is_Rational and number.q % root.base == 0:  # 1/(2 sqrt(3)), not sqrt(3)/6
            above.remove(root)
            below.append(root)
            number *= root.base
    above, below = sorted(above, key=_factor_key), sorted(below, key=_factor_key)
    if number.is_Rational:
        above = [sp.Integer(abs(number.p))] * (abs(number.p) != 1) + above
        below = [sp.Integer(number.q)] * (number.q != 1) + below
    return bool(number.is_negative), above or [sp.S.One], below


def signed_terms(expr: sp.Expr) -> list[tuple[bool, sp.Expr]]:
    """(negative, size) of the terms of a sum, a positive one first where there is one."""
    terms = [
        (minus, -term if minus else term)
        for term in sorted(sp.Add.make_args(expr), key=_term_key)
        for minus in [_parts(term)[0]]
    ]
    first = next((i for i, (minus, _) in enumerate(terms) if not minus), 0)
    return [terms[first], *terms[:first], *terms[first + 1 :]]


def _shared(expr: sp.Expr) -> bool:
    """Whether a sum has a whole number to put in front of a bracket."""
    return expr.is_Add and expr.primitive()[0].is_Integer and expr.primitive()[0] != 1


class _MathML(MathMLPresentationPrinter):
    """SymPy's printer with the order above, sin^2 phi, bracketed columns, and no raw entities."""

    def _element(self, tag: str, *children, **attributes):
        element = self.dom.createElement(tag)
        for child in children:
            element.appendChild(self.dom.createTextNode(child) if isinstance(child, str) else child)
        for name, value in attributes.items():
            element.setAttribute(name, value)
        return element

    def _bracketed(self, inner):
        return self._element("mrow", self._l_paren(), inner, self._r_paren())

    def _product(self, factors: list[sp.Expr], alone: bool):
        row = self._element("mrow")
        for i, factor in enumerate(factors):
            base = factor.as_base_exp()[0]
            if i:  # U+2062 is the invisible times
                wide = isinstance(base, sp.Function) or isinstance(
                    factors[i - 1].as_base_exp()[0], sp.Function
                )
                row.appendChild(
                    self._element("mspace", width="0.17em") if wide else self._element("mo", "⁢")
                )
            printed = self._print(factor)
            bare = not factor.is_Add or (alone and len(factors) == 1)
            row.appendChild(printed if bare else self._bracketed(printed))
        return row

    def _print_Mul(self, expr):
        minus, above, below = _parts(expr)
        body = self._product(above, alone=bool(below) or not minus)
        if below:
            body = self._element("mfrac", body, self._product(below, alone=True))
        return self._element("mrow", self._element("mo", "−"), body) if minus else body

    def _print_Add(self, expr, order=None):
        if _shared(expr):
            return self._print_Mul(expr)
        row = self._element("mrow")
        for i, (minus, term) in enumerate(signed_terms(expr)):
            if i or minus:
                row.appendChild(self._element("mo", "−" if minus else "+"))
            row.appendChild(self._print(term))
        return row

    def _print_Pow(self, expr):
        if expr.exp.is_number and expr.exp.is_negative:
            return self._print_Mul(expr)
        if isinstance(expr.base, sp.Function) and expr.exp.is_Integer:
            return self._applied(expr.base, self._print(expr.exp))
        return super()._print_Pow(expr)

    def _applied(self, expr, power=None):
        name = self._element("mi", self.mathml_tag(expr))
        name = self._element("msup", name, power) if power else name
        (argument,) = expr.args
        inner = self._print(argument)
        if argument.is_Symbol:
            return self._element("mrow", name, self._element("mspace", width="0.17em"), inner)
        return self._element("mrow", name, self._element("mo", "\u2061"), self._bracketed(inner))

    def _print_Function(self, expr):
        return self._applied(expr)

    def _print_MatrixBase(self, matrix):
        rows = (
            self._element("mtr", *(self._element("mtd", self._print(x)) for x in matrix.row(i)))
            for i in range(matrix.rows)
        )
        return self._bracketed(self._element("mtable", *rows, displaystyle="true"))

    def doprint(self, expr):
        """The inner MathML of an expression, well-formed and without named entities."""
        root = self._print(expr)
        waiting = [root]
        while waiting:
            node = waiting.pop()
            waiting.extend(node.childNodes)
            if node.nodeType == node.TEXT_NODE:
                node.data = html.escape(html.unescape(node.data).replace("-", "−"), quote=False)
        return root.toxml()


class _LaTeX(LatexPrinter):
    """SymPy's printer with the same order."""

    def _bracketed(self, text: str) -> str:
        return rf"\left({text}\right)"

    def _product(self, factors: list[sp.Expr], alone: bool) -> str:
        bare = alone and len(factors) == 1
        texts = (
            self._bracketed(self._print(f)) if f.is_Add and not bare else self._print(f)
            for f in factors
        )
        return " ".join(texts)

    def _print_Mul(self, expr):
        minus, above, below = _parts(expr)
        body = self._product(above, alone=bool(below) or not minus)
        if below:
            body = rf"\frac{{{body}}}{{{self._product(below, alone=True)}}}"
        return f"-{body}" if minus else body

    def _print_Add(self, expr, order=None):
        if _shared(expr):
            return self._print_Mul(expr)
        text = ""
        for minus, term in signed_terms(expr):
            text += (" - " if minus else " + " if text else "") + self._print(term)
        return text


_mathml = _MathML()
_latex = _LaTeX({"fold_func_brackets": True, "inv_trig_style": "full", "mat_delim": "("})


def mathml(form: Form) -> str:
    """Presentation MathML, without the outer math element."""
    return _mathml.doprint(form)


def latex(form: Form) -> str:
    """LaTeX of the same."""
    return _latex.doprint(form)


# ---- a derived form that reads well -----------------------------------------------------------

# What stands together in print: (letter that hides it, the letter it replaces, what that is)
_u, _v, _p = sp.symbols("u v p", real=True)
_PAIRS = (
    (_u, s.c_x, _u + s.omega * s.Z, s.c_x - s.omega * s.Z),
    (_v, s.c_z, _v + s.V_z - s.omega * s.X, s.c_z - s.V_z + s.omega * s.X),
    (_p, s.P_z, _p + s.P_1, s.P_z - s.P_1),
)
_LINEAR = (_u, _v, _p, s.u_0, s.v_0, s.F_x, s.F_z)
_BASES = (sp.S.Zero, sp.S.One, s.c_x, s.c_z)


def _tidy(expr: sp.Expr) -> sp.Expr:
    """One fraction of factors, each collected in the letter that makes it shortest."""
    expr = expr.replace(
        lambda e: e.is_Pow and not e.exp.is_Integer and e.base.is_Add,
        lambda e: _tidy(e.base) ** e.exp,
    )
    above, below = sp.fraction(sp.factor(expr))
    factors = [
        _collected(f.as_base_exp()[0]) ** (sign * f.as_base_exp()[1])
        for part, sign in ((above, 1), (below, -1))
        for f in sp.Mul.make_args(part)
    ]
    return sp.Mul(*factors)


def _collected(total: sp.Expr) -> sp.Expr:
    if not total.is_Add:
        return total
    letters = sorted(total.free_symbols, key=str)
    groups = [*letters, [x for x in _LINEAR if x in letters]]
    return min((total, *(sp.collect(total, g, _tidy) for g in groups if g)), key=sp.count_ops)


def _by_letter(expr: sp.Expr, base: sp.Expr) -> sp.Expr | None:
    """`base` plus a sum of velocities or forces with one factored coefficient each."""
    back = {}
    for hidden, letter, meaning, shown in _PAIRS:
        if letter in expr.free_symbols and shown.free_symbols <= expr.free_symbols:
            expr, base = expr.subs(letter, meaning), base.subs(letter, meaning)
            back[hidden] = shown
    above, below = sp.fraction(sp.cancel(sp.together(expr - base)))
    letters = [x for x in _LINEAR if x in above.free_symbols]
    parts = sp.collect(sp.expand(above), letters, evaluate=False)
    rest = parts.pop(sp.S.One, sp.S.Zero)
    if not set(parts) <= set(letters) or rest.has(*letters) or below.has(*letters):
        return None
    terms = [_tidy(factor / below) * back.get(x, x) for x, factor in parts.items()]
    return base.subs(back) + sp.Add(*terms) + _tidy(rest / below)


def _candidates(expr: sp.Expr) -> Iterator[sp.Expr]:
    yield expr
    yield _tidy(expr)
    if expr.free_symbols == {s.phi}:
        yield sp.simplify(expr)
    for base in _BASES:
        form = _by_letter(expr, base)
        if form is not None:
            yield form


def _tokens(expr: sp.Expr) -> list[str]:
    return re.findall(r"\\[a-z]+|\w|\S", latex(expr))


def _best(expr: sp.Expr, like: sp.Expr | None) -> sp.Expr:
    """The candidate that is most like `like` and short."""
    forms = {form: _tokens(form) for form in _candidates(expr)}
    target = _tokens(like) if like is not None else None
    shortest = min(map(len, forms.values()))

    def strangeness(form: sp.Expr) -> float:
        text = forms[form]
        unlike = 1 - SequenceMatcher(None, target, text, False).ratio() if target else 0
        return unlike + len(text) / shortest / 4

    best = min(forms, key=strangeness)
    if not equal_at_random_points(best, expr):
        raise PresentationError(f"{expr} became {best}")
    return best
