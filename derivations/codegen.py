"""Code generation: rewritten expressions become the text of functions.

The bodies use + - * / only, so the same text runs on floats, arrays, mpmath numbers and under
Numba.
"""

import textwrap

import sympy as sp

from .lecture import to_text
from .rewrites import Function


def text_of(expr: sp.Expr) -> str:
    """Python source of an expression: positive terms first, sums last, one division."""
    if expr.is_Symbol or expr.is_Integer:
        return str(expr)
    if expr.is_Rational:  # exact in binary as a float, else as a quotient
        return repr(float(expr)) if expr.q & (expr.q - 1) == 0 else f"{expr.p} / {expr.q}"
    if expr.is_Add:
        terms = sorted(expr.args, key=lambda term: term.could_extract_minus_sign())
        text = text_of(terms[0])
        for term in terms[1:]:
            minus = term.could_extract_minus_sign()
            text += f" - {_factor(-term)}" if minus else f" + {text_of(term)}"
        return text
    if expr.is_Pow and expr.exp.is_Integer and expr.exp > 0 and expr.base.is_Symbol:
        return " * ".join([str(expr.base)] * expr.exp)  # a product rounds alike everywhere
    if expr.is_Mul or (expr.is_Pow and expr.exp.is_Integer and expr.exp < 0):
        if expr.could_extract_minus_sign():
            return f"-{_factor(-expr)}"
        above, below = sp.fraction(expr)
        if below.is_Integer and below & (below - 1) == 0:  # a dyadic factor, or none
            return " * ".join(_factors(expr))
        quotient = " * ".join(_factors(above))
        product = below.is_Pow or below.is_Mul  # a power is printed as a product
        divisor = " * ".join(_factors(below))
        return f"{quotient} / " + (f"({divisor})" if product else divisor)
    raise ValueError(f"not plain arithmetic: {expr}")


def _factor(expr: sp.Expr) -> str:
    """`expr` inside a product or power."""
    text = text_of(expr)
    closed = not expr.is_Add and "/" not in text
    return text if closed else f"({text})"


def _factors(expr: sp.Expr) -> list[str]:
    """Factors of a product, numbers first and sums last."""
    ordered = sorted(sp.Mul.make_args(expr), key=lambda f: (not f.is_number, f.is_Add))
    return [_factor(factor) for factor in ordered]


def text(function: Function) -> str:
    """Text of a generated function."""
    body, steps = function.body
    words = {key: to_text(said) for key, said in function.words.items()}
    history = ", ".join(f"{step.rule} {step.operations}" for step in steps)
    doc = textwrap.wrap(to_text(f"{words['detail']} Operations: {history}."), 92)
    outputs = " ".join(str(name) for name in body if name in function.outputs)
    returned = words.get("returned", outputs).split()
    lines = [
        f"def {function.name}({', '.join(map(str, function.arguments))}):",
        f'    """{words["summary"]}',
        "",
        *(f"    {line}" for line in doc),
        '    """',
    ]
    for symbol, expr in body.items():
        if str(symbol) in words.get("unused", "").split():
            continue
        keyword = "return" if [str(symbol)] == returned else f"{symbol} ="
        lines.append(f"    {keyword} {text_of(expr)}")
    if len(returned) > 1:
        lines.append(f"    return {', '.join(returned)}")
    return "\n".join(lines)
