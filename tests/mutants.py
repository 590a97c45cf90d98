"""Deliberate mistakes, to see that the proofs can fail.

Every entry's printed and derived form, and every axiom, is changed in small ways: a factor 8/7, a
term's sign turned, a symbol replaced by another of the same form, a denominator scaled, one side
of an inequality scaled. An entry with a changed form must lose its verdict, and a changed axiom
must cost some entry that rests on it its proof. Changes that say the same are counted apart.
"""

from collections import namedtuple
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial, wraps
from itertools import pairwise
from unittest.mock import patch

import sympy as sp
from sympy.core.relational import Relational

from derivations import axioms, trace
from derivations.equality import components, equal_at_random_points
from derivations.proof import Equation
from derivations.registry import ENTRIES

EQUATIONS = [entry for entry in ENTRIES if isinstance(entry, Equation)]
FACTOR = sp.Rational(8, 7)
COMPARED = {"IV: Coulomb, stick": "sign", "V: closure": "zero"}  # with zero: sign alone, or none


@contextmanager
def derived_again(kind, name):
    """Derive again, inside, what takes the step of a name; afterwards all is as before."""
    with ExitStack() as stack:
        for results in trace.CACHES:
            stack.enter_context(patch.dict(results))
            for given, (_, steps) in list(results.items()):
                if name in trace.names(steps, kind):
                    del results[given]
        yield


@contextmanager
def bent(name, change):
    """Change what one step of `STEPS` gives; what takes it is derived again."""
    usual = trace.STEPS[name]
    changed = wraps(usual)(lambda *given: change(usual(*given)))
    with derived_again("derived", name), patch.dict(trace.STEPS, {name: changed}):
        yield


# A changed form: tag of the entry or axiom; its side (printed, derived or axiom); the change in
# words; and what became of the proofs (caught, equivalent or survived).
Mutant = namedtuple("Mutant", "tag side change outcome")


def _changes_of(form):
    """Changed expressions, each with the change in words."""
    yield "times 8/7", form * FACTOR
    yield "times -1", -form
    if form.is_number:
        yield "plus 1", form + 1
    letters = sorted(form.free_symbols, key=str)
    for one, other in pairwise(letters + letters[:1]):
        if one != other:
            yield f"{one} to {other}", form.xreplace({one: other})
    for node in sp.preorder_traversal(form):
        if node.is_Add:
            for term in node.args:
                yield f"sign of {term}", form.xreplace({node: node - 2 * term})
        elif node.is_Pow and node.exp.could_extract_minus_sign():
            scaled = node * sp.Rational(9, 8)
            yield f"denominator {node.base} times 9/8", form.xreplace({node: scaled})


def changes(form):
    """Changed forms, each with the change in words; those that did not change are left out."""
    if isinstance(form, Relational):
        yield "right side times 8/7", form.func(form.lhs, form.rhs * FACTOR)
        yield "turned", form.reversed.func(form.lhs, form.rhs)
        for what, side in _changes_of(form.lhs):
            yield f"left: {what}", form.func(side, form.rhs)
    elif isinstance(form, sp.MatrixBase):
        for i, part in enumerate(form):
            for what, new in _changes_of(part):
                other = form.as_mutable()
                other[i] = new
                yield f"component {i}: {what}", other
    else:
        yield from _changes_of(form)


def says_the_same(a, b, up_to=""):
    """Whether two forms are equal, or differ by a factor that does not matter.

    `up_to` is "sign" for a form that is compared with zero, "zero" for one that is set to zero.
    """
    if not isinstance(a, type(b)) and isinstance(b, Relational):
        return False
    up_to = up_to or ("sign" if isinstance(b, Relational) else "")
    pairs = list(zip(components(a), components(b), strict=True))
    if up_to:
        ratios = [sp.cancel(x / y) if y != 0 else sp.nan for x, y in pairs]
        return all(r.is_positive or (up_to == "zero" and r.is_nonzero) for r in ratios)
    return all(equal_at_random_points(x.doit(), y.doit()) for x, y in pairs)


def _tried(tag, side, form, proved, up_to=""):
    """Every change of a form; `proved` says whether all that rests on a form is proved with it."""
    for what, new in changes(form):
        outcome = "caught"
        if proved(new):
            outcome = "equivalent" if says_the_same(new, form, up_to) else "survived"
        yield Mutant(tag, side, what, outcome)


def of_entry(entry):
    """Try every change of both sides of one entry."""
    lefts = entry.lefts
    left = entry.left or (lefts[0] if len(lefts) == 1 else f"({', '.join(lefts)})")

    def proved(side, new):
        given = {"said": new} if side == "printed" else {"derive": lambda: new, "left": left}
        return replace(entry, **given).prove().ok

    sides = {"derived": entry.derive()}
    if entry.printed is not None and not entry.repair:  # which is a change of the LaTeX itself
        sides["printed"] = entry.printed
    for side, form in sides.items():
        assert proved(side, form)  # so that the change alone is judged
        yield from _tried(entry.tag, side, form, partial(proved, side))


def of_axiom(axiom):
    """Try every change of an axiom against the entries that rest on it."""
    resting = [entry for entry in EQUATIONS if axiom.tag in entry.rests_on]

    def proved(new):
        with derived_again("axiom", axiom.tag), patch.object(axiom, "form", new):
            return all(entry.prove().ok for entry in resting)

    yield from _tried(axiom.tag, "axiom", axiom.form, proved, COMPARED.get(axiom.tag, ""))


def trials():
    """One for each entry that is an equation, and each axiom."""
    return [
        *(partial(of_entry, entry) for entry in EQUATIONS),
        *(partial(of_axiom, axiom) for axiom in axioms.AXIOMS),
    ]
