"""A derived form that reads well: equal ones are tried, and the best is proved to be equal.

SymPy returns derived expressions expanded, or factored over everything. In print a velocity has
one factored coefficient, c_z - V_z + omega X stands together, and so does 1 + epsilon. Where a
printed form is known, the candidate most like it is taken; what is shown is never the printed form
itself, but the derived one, rearranged.
"""

import re
from collections.abc import Iterator
from difflib import SequenceMatcher
from functools import cache

import sympy as sp

from . import symbols as s
from .proof import Form, components, equal_at_random_points
from .typeset import latex

# What stands together: (letter that hides it, the letter it replaces, what that is, as shown)
_u, _v, _p = sp.symbols("u v p", real=True)
_PAIRS = (
    (_u, s.c_x, _u + s.omega * s.Z, s.c_x - s.omega * s.Z),
    (_v, s.c_z, _v + s.V_z - s.omega * s.X, s.c_z - s.V_z + s.omega * s.X),
    (_p, s.P_z, _p + s.P_1, s.P_z - s.P_1),
)
_LINEAR = (_u, _v, _p, s.u_0, s.v_0, s.F_x, s.F_z)
_LENGTHS = {s.k, s.length, s.diameter, s.phi}
_bounce = sp.Symbol("bounce", positive=True)  # 1 + epsilon
_POINTS = 2


class PresentationError(ArithmeticError):
    """A form chosen for its looks has another value than the derived one."""


@cache
def _tokens(expr: sp.Expr) -> tuple[str, ...]:
    """What a reader sees, letter by letter and sign by sign."""
    return tuple(re.findall(r"\\(?!left|right)[a-z]+|(?<!\\)\b\w|[-+^()]", latex(expr)))


@cache
def _size(expr: sp.Expr) -> int:
    return sum(token not in "()" for token in _tokens(expr))


@cache
def _tidy(expr: sp.Expr) -> sp.Expr:
    """One fraction of factors, each of them collected."""
    expr = expr.replace(
        lambda e: e.is_Pow and not e.exp.is_Integer and e.base.is_Add,
        lambda e: _tidy(e.base) ** e.exp,
    )
    above, below = sp.fraction(sp.factor(expr))
    powers = [f.as_base_exp() for f in sp.Mul.make_args(above)]
    powers += [(base, -e) for base, e in (f.as_base_exp() for f in sp.Mul.make_args(below))]
    return sp.Mul(*(_collected(base) ** exponent for base, exponent in powers))


@cache
def _collected(total: sp.Expr) -> sp.Expr:
    """A sum, collected in the letters that make it shortest; X and Z stay where they are."""
    if not total.is_Add:
        return total
    free = total.free_symbols
    groups = [{s.mu}, {s.epsilon}, free & set(_LINEAR), {s.k} if len(total.args) <= 3 else set()]
    if not free & {s.X, s.Z}:
        groups += [{letter} for letter in sorted(free - _LENGTHS, key=str)]
    forms = [_grouped(total, group) for group in groups]
    if s.epsilon in free:
        shifted = sp.expand(total.subs(s.epsilon, _bounce - 1))
        forms.append(_grouped(shifted, {_bounce}).subs(_bounce, 1 + s.epsilon))
    return min((*forms, total), key=_size)


def _grouped(total: sp.Expr, letters: set[sp.Symbol]) -> sp.Expr:
    """One letter: its terms as one product; several: one product for each."""
    rest = sp.Add(*(term for term in total.args if not term.free_symbols & letters))
    parts = [
        sp.Add(*(term for term in total.args if letter in term.free_symbols)) for letter in letters
    ]
    if total in parts or rest == total or sp.expand(sp.Add(rest, *parts) - total) != 0:
        return total
    return sp.Add(_collected(rest), *map(_tidy, parts))


def _by_letter(above: sp.Expr, below: sp.Expr, base: sp.Expr) -> sp.Expr | None:
    """`base` plus a sum of velocities or forces, with one factored coefficient each."""
    above = sp.expand(above - base * below)
    letters = [x for x in _LINEAR if x in above.free_symbols]
    parts = sp.collect(above, letters, evaluate=False)
    rest = _tidy(parts.pop(sp.S.One, sp.S.Zero) / below)
    linear = set(parts) <= set(letters) and not rest.has(*letters) and not below.has(*letters)
    if not linear or (base == 1 and rest.is_Add):
        return None
    return base + sp.Add(rest, *(_tidy(part / below) * x for x, part in parts.items()))


@cache
def _short(expr: sp.Expr) -> sp.Expr:
    return sp.cancel(sp.together(expr))


def _forms(expr: sp.Expr) -> Iterator[sp.Expr]:
    """Equal forms of an expression."""
    free = expr.free_symbols
    pairs = [pair for pair in _PAIRS if {pair[1]} | pair[3].free_symbols <= free]
    if not pairs:
        yield expr
        if len(free) <= 1 and expr.is_polynomial(*free):
            return
        if free == {s.phi}:
            yield sp.simplify(expr)
    meanings = {letter: meaning for _, letter, meaning, _ in pairs}
    back = {hidden: shown for hidden, _, _, shown in pairs}
    short = _short(expr.xreplace(meanings))
    if not {_u, _v} & set(back):
        yield _tidy(short).xreplace(back)
    yield from (base + _tidy(short - base) for base in (s.F_x, s.F_z) if base in free)
    plain = [] if free & set(_LINEAR) or pairs else [sp.S.One]
    for base in (sp.S.Zero, *plain, s.c_x, s.c_z):
        if base.is_number or base in free:
            above, below = sp.fraction(short)
            form = _by_letter(above, below, base.xreplace(meanings))
            if form is not None:
                yield form.xreplace(back)


@cache
def _best(expr: sp.Expr, like: sp.Expr | None) -> sp.Expr:
    """The candidate that is most like `like`, and short."""
    forms = []
    for form in _forms(expr):
        if like is not None and _tokens(form) == _tokens(like):
            forms = [form]
            break
        forms.append(form)
    shortest = min(map(_size, forms))

    def strangeness(form: sp.Expr) -> float:
        unlike = 0.0
        if like is not None:
            unlike = 1 - SequenceMatcher(None, _tokens(like), _tokens(form), False).ratio()
        return unlike + _size(form) / shortest / 4

    best = min(forms, key=strangeness)
    if not equal_at_random_points(best, expr, _POINTS):
        raise PresentationError(f"{expr} became {best}")
    return best


def _inequality(relation: sp.core.relational.Relational) -> sp.core.relational.Relational:
    """Without positive factors, and with the negative terms brought to the other side."""
    difference = relation.lhs - relation.rhs
    above = sp.expand(sp.numer(sp.cancel(sp.together(difference))))
    if not sp.cancel(difference / above).is_positive:
        return relation
    right = sp.Add(*(-x for x in above.args if x.could_extract_minus_sign()))
    return relation.func(_tidy(above + right), _tidy(right))


def presented(derived: Form, printed: Form | None) -> Form:
    """A derived form, rearranged; components of columns one by one."""
    if isinstance(derived, sp.core.relational.Relational):
        return _inequality(derived)
    likes = components(printed) if printed is not None else [None] * len(components(derived))
    forms = [_best(x, like) for x, like in zip(components(derived), likes, strict=True)]
    return sp.Matrix(forms) if isinstance(derived, sp.MatrixBase) else forms[0]
