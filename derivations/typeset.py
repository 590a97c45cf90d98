"""How one form looks: terms in the paper's order, as MathML and as LaTeX.

These are SymPy's printers with terms and factors in the paper's order, signs and whole numbers
taken out of brackets, sin^2 phi for sin(phi)^2 and columns in round brackets.
"""

import html
import re
from functools import cache

import sympy as sp
from sympy.printing.latex import LatexPrinter
from sympy.printing.mathml import MathMLPresentationPrinter
from sympy.printing.pretty.pretty_symbology import greek_unicode

from .proof import Form
from .symbols import Gamma

# Letters in the order in which they stand in a product; what is not named comes last.
_LETTERS = (
    "pi epsilon m M mu I l d gain bounce k omega theta eta A B C a a_1 a_2 q X Z x z h h_0 r j "
    "c_x c_z u_0 u_f v_0 v_1 v_f V_z V_0 P_x P_z P_1 F_x F_z"
)
_RANK = {name: rank for rank, name in enumerate(_LETTERS.split())}

Factors = tuple[sp.Expr, ...]


# ---- order and signs --------------------------------------------------------------------------


def _ranks(expr: sp.Expr) -> list[tuple[int, str]]:
    return sorted((_RANK.get(x.name, len(_RANK)), x.name) for x in expr.free_symbols)


def _factor_key(factor: sp.Expr) -> tuple:
    """Numbers, letters, roots and functions, sums."""
    base = factor.as_base_exp()[0]
    kind = 0 if base.is_Number else 1 if base.is_Symbol else 3 if base.is_Add else 2
    return kind, len(base.free_symbols), -isinstance(base, sp.sin), _ranks(base), str(factor)


@cache
def _term_key(term: sp.Expr) -> tuple:
    """Numbers first, then what has few letters, low powers first."""
    powers = sp.total_degree(term, *term.free_symbols) if term.is_polynomial() else 99
    return len(term.free_symbols), _ranks(term), powers, str(term)


def _scaled(total: sp.Expr, by: sp.Expr) -> sp.Expr:
    return sp.Add(*(by * term for term in total.args))


@cache
def _signs(total: sp.Expr) -> tuple[bool, ...]:
    return tuple(_parts(term)[0] for term in sorted(total.args, key=_term_key))


@cache
def _parts(expr: sp.Expr) -> tuple[bool, Factors, Factors]:
    """Whether a product is negative, and its factors above and below the fraction bar."""
    number, turned = sp.S.One, set()
    above: list[sp.Expr] = []
    below: list[sp.Expr] = []
    for factor in sp.Mul.make_args(expr):
        base, exponent = factor.as_base_exp()
        if factor.is_Rational:
            number *= factor
            continue
        if base.is_Add and exponent.is_Integer:  # a sum starts with plus, and without a number
            signs, content = _signs(base), base.primitive()[0]
            if len({abs(term.as_coeff_Mul()[0]) for term in base.args}) > 1:
                content = content if content.is_Integer else sp.S.One
            first = signs[0] and base.free_symbols != {Gamma}  # Gamma - 1, but 1 - epsilon
            if 2 * sum(signs) > len(signs) or (2 * sum(signs) == len(signs) and first):
                content = -content
            base, number = _scaled(base, 1 / content), number * content**exponent
            if content.is_negative and not all(signs):
                turned.add(base)
        down = exponent.is_number and exponent.is_negative
        (below if down else above).append(base ** (-exponent if down else exponent))
    for root in [f for f in above if f.is_Pow and f.exp == sp.S.Half and f.base.is_Integer]:
        if number.is_Rational and number.q % root.base == 0:  # 1/(2 sqrt(3)), not sqrt(3)/6
            above.remove(root)
            below.append(root)
            number *= root.base
    for part in (above, below):
        for i, total in enumerate(part):  # -(a - b) is b - a, but 1 - epsilon stays
            even = 2 * sum(_signs(total)) == len(total.args)
            mixed = total.is_Add and not any(x.is_number for x in total.args)
            if number.is_negative and mixed and (even if part is below else total in turned):
                part[i], number = _scaled(total, sp.S.NegativeOne), -number
        part.sort(key=_factor_key)
    if number.is_Rational:
        above = [sp.Integer(abs(number.p))] * (abs(number.p) != 1) + above
        below = [sp.Integer(number.q)] * (number.q != 1) + below
    return bool(number.is_negative), tuple(above) or (sp.S.One,), tuple(below)


def signed_terms(expr: sp.Expr) -> list[tuple[bool, sp.Expr]]:
    """(negative, size) of the terms of a sum, a positive one first where there is one."""
    terms = [
        (minus, -term if minus else term)
        for term in sorted(sp.Add.make_args(expr), key=_term_key)
        for minus in [_parts(term)[0]]
    ]
    first = next((i for i, (minus, _) in enumerate(terms) if not minus), 0)
    return [terms[first], *terms[:first], *terms[first + 1 :]]


def _in_front(above: Factors, below: Factors) -> tuple[sp.Rational, Factors, Factors]:
    """A fraction to print before a function of something tall: 1/2 arccos(...)."""
    tall = any(f.is_Function and not f.args[0].is_Symbol and not f.args[0].is_number for f in above)
    if not (tall and len(below) == 1 and below[0].is_Integer):
        return sp.S.One, above, below
    whole = above[0] if above[0].is_Integer else sp.S.One
    return whole / below[0], above[1:] if above[0].is_Integer else above, ()


def _shared(expr: sp.Expr) -> bool:
    """Whether a sum has a whole number to put in front of a bracket."""
    return expr.is_Add and expr.primitive()[0].is_Integer and expr.primitive()[0] != 1


def _is_word(factor: sp.Expr) -> bool:
    """Whether a factor needs a little space: sin phi, or a name of several letters."""
    base = factor.as_base_exp()[0]
    word = base.name.split("_")[0] if base.is_Symbol else ""
    return base.is_Function or (len(word) > 1 and word not in greek_unicode)


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
        tall = any(inner.getElementsByTagName(tag) for tag in ("mfrac", "msqrt", "mtr"))
        signs = [self._element("mo", c, **({} if tall else {"stretchy": "false"})) for c in "()"]
        return self._element("mrow", signs[0], inner, signs[1])

    def _space(self):
        return self._element("mspace", width="0.17em")

    def _product(self, factors: Factors, alone: bool):
        row = self._element("mrow")
        for i, factor in enumerate(factors):
            if i:
                wide = any(map(_is_word, factors[i - 1 : i + 1]))
                row.appendChild(self._space() if wide else self._element("mo", "\u2062"))  # times
            printed = self._print(factor)
            bare = not factor.is_Add or (alone and len(factors) == 1)
            row.appendChild(printed if bare else self._bracketed(printed))
        return row

    def _print_Mul(self, expr):
        minus, above, below = _parts(expr)
        number, above, below = _in_front(above, below)
        body = self._product(above, alone=bool(below) or not minus)
        if number != 1:
            body = self._element("mrow", self._print(number), self._space(), body)
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
        base = self._print(expr.base)
        if base.tagName == "msub" and expr.exp.is_Integer:
            return self._element("msubsup", *list(base.childNodes), self._print(expr.exp))
        return super()._print_Pow(expr)

    def _applied(self, expr, power=None):
        name = self._element("mi", self.mathml_tag(expr))
        name = self._element("msup", name, power) if power else name
        (argument,) = expr.args
        inner = self._print(argument)
        if argument.is_Symbol:
            return self._element("mrow", name, self._space(), inner)
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

    def _product(self, factors: Factors, alone: bool) -> str:
        bare = alone and len(factors) == 1
        texts = (
            self._bracketed(self._print(f)) if f.is_Add and not bare else self._print(f)
            for f in factors
        )
        return (r" \, " if any(map(_is_word, factors)) else " ").join(texts)

    def _print_Symbol(self, expr):
        text = re.sub(r"_\{([a-z]{2,})\}", r"_{\\mathrm{\1}}", super()._print_Symbol(expr))
        return re.sub(r"^([a-z]{2,})", r"\\mathit{\1}", text)

    def _print_Mul(self, expr):
        minus, above, below = _parts(expr)
        number, above, below = _in_front(above, below)
        body = self._product(above, alone=bool(below) or not minus)
        if number != 1:
            body = f"{self._print(number)} {body}"
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


def _width(text: str) -> int:
    return len(re.sub(r"\\[a-z]+|[{}_^ ]", "", text))


def _terms(form: Form) -> list[tuple[bool, Form]]:
    whole = not getattr(form, "is_Add", False) or _shared(form)
    return [(False, form)] if whole else signed_terms(form)


_INFIX = '<mo form="infix" lspace="0.22em" rspace="0.22em">{}</mo>'


def mathml_terms(form: Form) -> list[str]:
    """A long sum term by term, so that a line can break between them; else the whole form."""
    if len(latex(form)) < 80:
        return [mathml(form)]
    return [
        (_INFIX.format("−" if minus else "+") if i else "<mo>−</mo>" * minus) + mathml(term)
        for i, (minus, term) in enumerate(_terms(form))
    ]


def is_wide(form: Form) -> bool:
    """Whether a term of the form needs more than half a page."""
    return any(_width(latex(term)) > 60 for _, term in _terms(form))


def latex_lines(form: Form, width: int = 70) -> list[str]:
    """A long sum in lines of about `width` visible characters."""
    lines, used = [""], 0
    for i, (minus, term) in enumerate(_terms(form)):
        text = latex(term)
        if used and used + _width(text) > width:
            lines.append("")
            used = 0
        lines[-1] += (" - " if minus else " + " if i else "") + text
        used += _width(text)
    return lines
