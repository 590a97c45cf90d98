"""Formulas as LaTeX with terms and factors in the paper's order, and LaTeX as MathML."""

import re

import sympy as sp
from latex2mathml.converter import convert
from sympy.printing.latex import LatexPrinter

from .proof import Form

# Letters in the order in which they stand in a product; others come last.
_LETTERS = (
    "pi epsilon m M mu I l d gain bounce k omega theta eta A B C a a_1 a_2 q X Z x z h h_0 r j "
    "c_x c_z u_0 u_f v_0 v_1 v_f V_z V_0 P_x P_z P_1 F_x F_z"
)
_RANK = {name: rank for rank, name in enumerate(_LETTERS.split())}
_LONG = 80  # characters of LaTeX; a longer sum may break between its terms


def _ranks(expr: sp.Expr) -> list[tuple[int, str]]:
    return sorted((_RANK.get(x.name, len(_RANK)), x.name) for x in expr.free_symbols)


def _factor_key(factor: sp.Expr) -> tuple:
    """Sort key in a product: numbers, letters, roots and functions, sums."""
    base = factor.as_base_exp()[0]
    kind = 0 if base.is_Number else 1 if base.is_Symbol else 3 if base.is_Add else 2
    return kind, len(base.free_symbols), -isinstance(base, sp.sin), _ranks(base), str(factor)


def _term_key(term: sp.Expr) -> tuple:
    """Sort key in a sum: numbers first, then few letters, then low powers."""
    powers = sp.total_degree(term, *term.free_symbols) if term.is_polynomial() else 99
    return len(term.free_symbols), _ranks(term), powers, str(term)


def split(term: sp.Expr) -> tuple[bool, list[sp.Expr], list[sp.Expr]]:
    """Whether a product is negative, and its factors above and below the fraction bar."""
    number, rest = term.as_coeff_Mul()
    above: list[sp.Expr] = []
    below: list[sp.Expr] = []
    for factor in sp.Mul.make_args(rest):
        base, exponent = factor.as_base_exp()
        if base.is_Add and exponent.is_Integer:  # whole numbers come out of brackets
            content, base = base.primitive()
            if all(x.as_coeff_Mul()[0].is_negative for x in base.args):
                content, base = -content, -base
            number *= content**exponent
        down = exponent.is_number and exponent.is_negative
        (below if down else above).append(base ** (-exponent if down else exponent))
    size = abs(number)
    above = [size.p if size.is_Rational else size, *sorted(above, key=_factor_key)]
    below = [size.q if size.is_Rational else 1, *sorted(below, key=_factor_key)]
    return (
        bool(number.is_negative),
        [sp.sympify(x) for x in above if x != 1],
        [sp.sympify(x) for x in below if x != 1],
    )


class _Printer(LatexPrinter):
    """SymPy's printer with terms and factors in the paper's order."""

    def terms(self, total: sp.Expr) -> list[tuple[bool, str]]:
        """(negative, size) of each term of a sum, a positive one first where there is one."""
        whole = total.is_Add and total.primitive()[0] not in (1, -1) and total.primitive()[0].q == 1
        args = [total] if whole else sorted(sp.Add.make_args(total), key=_term_key)
        found = [self._term(arg) for arg in args]
        first = next((i for i, (minus, _) in enumerate(found) if not minus), 0)
        return [found[first], *found[:first], *found[first + 1 :]]

    def _term(self, term: sp.Expr) -> tuple[bool, str]:
        minus, above, below = split(term)
        text = self._product(above, alone=bool(below) or not minus)
        return minus, rf"\frac{{{text}}}{{{self._product(below, alone=True)}}}" if below else text

    def _product(self, factors: list[sp.Expr], alone: bool) -> str:
        bare = alone and len(factors) == 1
        texts = [
            rf"\left({self._print(f)}\right)" if f.is_Add and not bare else self._print(f)
            for f in factors
        ]
        return " ".join(texts) or "1"

    def _print_Add(self, expr: sp.Expr, order: str | None = None) -> str:
        return "".join(pieces_of(self.terms(expr)))

    def _print_Mul(self, expr: sp.Expr) -> str:
        return "".join(pieces_of([self._term(expr)]))

    def _print_Symbol(self, expr: sp.Symbol, style: str = "plain") -> str:
        return words(super()._print_Symbol(expr, style))


def pieces_of(terms: list[tuple[bool, str]]) -> list[str]:
    """Terms with their signs in front."""
    (minus, first), *more = terms
    return ["-" * minus + first, *((" - " if minus else " + ") + text for minus, text in more)]


def words(tex: str) -> str:
    """Set names of three or more small letters as words, not as products of letters."""
    return re.sub(r"(\\[A-Za-z]+)|([a-z]{3,})", lambda m: m[1] or rf"\mathit{{{m[2]}}}", tex)


_printer = _Printer({"fold_func_brackets": True, "inv_trig_style": "full", "mat_delim": "("})


def latex(form: Form) -> str:
    """LaTeX of a form."""
    return _printer.doprint(form)


def pieces(form: Form) -> list[str]:
    """LaTeX of a form, a long sum term by term, so that a line can break between them."""
    whole = latex(form)
    return (
        pieces_of(_printer.terms(form))
        if isinstance(form, sp.Add) and len(whole) > _LONG
        else [whole]
    )


def mathml(tex: str, display: bool = False) -> str:
    """MathML of LaTeX, in the size of a displayed formula or of a sentence."""
    found = convert(re.sub(r"^ ([+-])", r"{}\1", tex))
    style = ' displaystyle="true"' if display else ""
    found = re.sub(r' xmlns="[^"]*" display="inline"', style, found)
    found = found.replace('mathvariant="bold"', 'mathvariant="normal" style="font-weight:bold"')
    # an operator, unlike an identifier, is set apart from its argument
    operator = r'<mo lspace=".17em" rspace=".17em">\1</mo>'
    return re.sub(r"<mi>((?:arc)?(?:sin|cos|tan))</mi>", operator, found)
