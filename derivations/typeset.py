"""Tidy formulas, as LaTeX with terms and factors in the paper's order, and LaTeX as MathML."""

import re
from functools import cache

import sympy as sp
from latex2mathml.converter import convert
from sympy.core.random import seed
from sympy.printing.latex import LatexPrinter

from .equality import Form
from .symbols import epsilon, mu

# Letters in the order in which they stand in a product; others come last.
_SPEEDS = "c_x c_z u_0 u_f v_0 v_1 v_f V_z V_0 P_x P_z P_1 P_2 F_x F_z"
_STILL = "pi epsilon m M mu I l d gain bounce k omega theta eta A B C a a_1 a_2 q X Z x z h h_0 r j"
_RANK = {name: rank for rank, name in enumerate(f"{_STILL} {_SPEEDS}".split())}
_MOVING = set(_SPEEDS.split())  # they stand last in a product, and behind a fraction
_GAIN = sp.Symbol("gain", positive=True)  # 1 + epsilon
_LONG = 80  # characters of LaTeX; a longer sum may break between its terms


def _ranks(expr: sp.Expr) -> list[tuple[int, str]]:
    return sorted((_RANK.get(x.name, len(_RANK)), x.name) for x in expr.free_symbols)


def moving(expr: sp.Expr) -> bool:
    """Whether each term is in proportion to a velocity, an impulse or a force."""
    known = _MOVING | {"omega", "omega_x"} if expr.is_Add else _MOVING
    terms = sp.Add.make_args(expr)
    return expr.is_polynomial() and all(known & {x.name for x in t.free_symbols} for t in terms)


def _size(form: sp.Expr) -> int:
    """Length of a form as text, a measure of how long it is to read; minus signs count more."""
    text = sp.sstr(form, order="none")
    return len(text) + 3 * text.count("-")


_factor = cache(sp.factor)  # forms share their rates


@cache
def _collected(form: sp.Expr, letter: sp.Symbol) -> sp.Expr:
    return form.replace(lambda x: x.is_Add, lambda x: x.collect(letter))


@cache
def tidy(expr: sp.Expr) -> sp.Expr:
    """Return the shortest of a few equal forms: as it is, by its speeds, factored or collected."""
    if not expr.is_rational_function():
        return expr  # to factor roots and sines can take minutes
    seed(0)  # as for a derivation
    speeds = [x for x in sorted(expr.free_symbols, key=str) if moving(x)]
    rates = [expr.diff(x) for x in speeds]
    if any(rate.has(*speeds) for rate in rates):
        forms = [expr, _factor(expr)]
    else:
        alone = _factor(expr.subs(dict.fromkeys(speeds, 0)))
        terms = (_factor(rate) * x for rate, x in zip(rates, speeds, strict=True))
        forms = [expr, alone + sum(terms)]
    for letter in (mu, epsilon):
        forms += [_collected(form, letter) for form in forms if form.has(letter)]
    if expr.has(epsilon) and expr.is_polynomial():
        turned = sp.expand(expr.subs(epsilon, _GAIN - 1))
        forms.append(sp.collect(turned, _GAIN, sp.factor).subs(_GAIN, 1 + epsilon))
    return min(forms, key=_size)


def _factor_key(factor: sp.Expr) -> tuple:
    """Sort key of a factor: numbers, 1 + epsilon, letters, sums, roots and functions, speeds."""
    base = factor.as_base_exp()[0]
    loss = base.is_Add and base.free_symbols == {epsilon}
    kinds = (base.is_Number, loss, moving(base), base.is_Symbol, base.is_Add, True)
    kind = (0, 1, 5, 2, 3, 4)[kinds.index(True)]
    return kind, len(base.free_symbols), -isinstance(base, sp.sin), _ranks(base), str(factor)


@cache
def _term_key(term: sp.Expr) -> tuple:
    """Sort key of a term: numbers first, then few letters, then low powers."""
    powers = sp.total_degree(term, *term.free_symbols) if term.is_polynomial() else 99
    return len(term.free_symbols), _ranks(term), powers, str(term)


def _turned(total: sp.Expr, strictly: bool) -> bool:
    """Whether a sum in brackets reads better with all signs changed: P_z - P_1, not P_1 - P_z.

    `strictly` asks for no plus sign at all.
    """
    signs = [split(x)[0] for x in sorted(total.args, key=_term_key)]
    more = 2 * sum(signs) - len(signs)
    tied = more == 0 and moving(total) and bool(signs[0])
    return all(signs) if strictly else more > 0 or tied


def split(term: sp.Expr) -> tuple[bool, list[sp.Expr], list[sp.Expr]]:
    """Whether a product is negative, and its factors above and below the fraction bar."""
    number, rest = term.as_coeff_Mul()
    above: list[sp.Expr] = []
    below: list[sp.Expr] = []
    for factor in sp.Mul.make_args(rest):
        base, exponent = factor.as_base_exp()
        if base.is_Add and exponent.is_Integer:  # whole numbers come out of brackets
            content, base = base.primitive()
            if _turned(base, strictly=number.is_positive and exponent.is_positive):
                content, base = -content, -base
            number *= content**exponent
        if exponent.is_number and exponent.is_negative:
            below.append(base**-exponent)
        else:
            above.append(factor if base == factor.as_base_exp()[0] else base**exponent)
    top, bottom = sp.fraction(abs(number))
    above = [x for x in (top, *sorted(above, key=_factor_key)) if x != 1]
    below = [x for x in (bottom, *sorted(below, key=_factor_key)) if x != 1]
    return bool(number.is_negative), above, below


class _Printer(LatexPrinter):
    """SymPy's printer with terms and factors in the paper's order."""

    def terms(self, total: sp.Expr) -> list[tuple[bool, str]]:
        """(negative, size) of each term of a sum; a positive term first, if there is one."""
        content, _ = total.primitive()
        whole = total.is_Add and content.is_Integer and abs(content) != 1
        args = [total] if whole else sorted(sp.Add.make_args(total), key=_term_key)
        found = [self._term(arg) for arg in args]
        first = next((i for i, (minus, _) in enumerate(found) if not minus), 0)
        found.insert(0, found.pop(first))
        return found

    @cache  # noqa: B019, of the one printer
    def _term(self, term: sp.Expr) -> tuple[bool, str]:
        minus, above, below = split(term)
        if not below:
            return minus, self._product(above, alone=not minus)
        behind = self._behind(above)
        over = self._product([x for x in above if x not in behind], alone=True)
        text = rf"\frac{{{over}}}{{{self._product(below, alone=True)}}}"
        return minus, " ".join([text, self._product(behind, alone=False)] if behind else [text])

    def _behind(self, above: list[sp.Expr]) -> list[sp.Expr]:
        """Factors that stand behind a fraction: speeds, integrals, and what contains a fraction."""
        tall = [x for x in above if isinstance(x, sp.Integral) or r"\frac" in self._print(x)]
        behind = [*(x for x in above if moving(x) and x not in tall), *tall]
        return tall if all(x.is_number or x in behind for x in above) else behind

    def _product(self, factors: list[sp.Expr], alone: bool) -> str:
        bare = alone and len(factors) == 1
        texts = [
            rf"\left({self._print(f)}\right)" if f.is_Add and not bare else self._print(f)
            for f in factors
        ]
        return " ".join(texts) or "1"

    def _print_Add(self, expr: sp.Expr, order: str | None = None) -> str:
        return "".join(pieces_of(self.terms(expr)))

    _print_Mul = _print_Add  # a product is a sum of one term

    def _print_Symbol(self, expr: sp.Symbol, style: str = "plain") -> str:
        return words(super()._print_Symbol(expr, style))


def pieces_of(terms: list[tuple[bool, str]]) -> list[str]:
    """Texts of terms with their signs in front, as pieces of a sum."""
    (minus, first), *more = terms
    return ["-" * minus + first, *((" - " if minus else " + ") + text for minus, text in more)]


def words(tex: str) -> str:
    """Set names of three or more small letters as words, not as products of letters."""
    return re.sub(
        r"(\\mathit\{\w+\}|\\[A-Za-z]+)|([A-Z]?[a-z]{3,})",
        lambda m: m[1] or rf"\mathit{{{m[2]}}}",
        tex,
    )


_printer = _Printer(
    {
        "fold_func_brackets": True,
        "inv_trig_style": "full",
        "mat_delim": "(",
        "fold_frac_powers": True,
    }
)


def latex(form: Form) -> str:
    """LaTeX of a form."""
    return re.sub(r"\{\\tan\\phi\}(\^\{\d\})", r"\\tan\1\\phi", _printer.doprint(form))


def pieces(form: Form) -> list[str]:
    """LaTeX of a form, a long sum term by term, so that a line can break between them."""
    whole = latex(form)
    long = isinstance(form, sp.Add) and len(whole) > _LONG
    return pieces_of(_printer.terms(form)) if long else [whole]


def equation(left: str, form: Form) -> tuple[str, ...]:
    """LaTeX of a form with its left side, in pieces between which a line may break."""
    first, *more = pieces(form)
    return first if isinstance(form, sp.Rel) else f"{left} = {first}", *more


def mathml(tex: str, display: bool = False) -> str:
    """MathML of LaTeX, in the size of a displayed formula or of one in a sentence."""
    found = convert(re.sub(r"^ ([+-])", r"{}\1", tex))
    style = ' displaystyle="true"' if display else ""
    found = re.sub(r' xmlns="[^"]*" display="inline"', style, found)
    found = found.replace('mathvariant="bold"', 'mathvariant="normal" style="font-weight:bold"')
    # an operator, unlike an identifier, is set apart from its argument
    operator = r'<mo lspace=".17em" rspace=".17em">\1</mo>'
    return re.sub(r"<mi>((?:arc)?(?:sin|cos|tan))</mi>", operator, found)
