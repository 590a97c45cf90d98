"""Equations by their tags: as SymPy expressions, and as NumPy functions."""

from collections.abc import Callable
from difflib import get_close_matches
from inspect import Parameter, Signature
from typing import Any

import numpy as np
import sympy as sp

from .equality import Form
from .proof import Equation
from .registry import ENTRIES
from .symbols import NAMED

_BY_LETTERS = {entry.tag.lower(): entry for entry in ENTRIES}


def entry_of(tag: str | int) -> Equation:
    """Find the equation of a tag, however it is written; raise `ValueError` if there is none."""
    written = str(tag).strip().lower()
    entry = _BY_LETTERS.get(written) or _BY_LETTERS.get(written.removeprefix("(").removesuffix(")"))
    if entry is None:
        tags = [entry.tag for entry in ENTRIES]
        near = ", ".join(map(repr, get_close_matches(str(tag), tags, cutoff=0.4)))
        raise ValueError(
            f"tag must be one of the registry's, got {tag!r}{near and f'; near it: {near}'}; "
            "`python -m derivations check` lists all"
        )
    if not isinstance(entry, Equation):
        raise ValueError(f"tag must be that of an equation; {tag!r} is a statement in words")
    return entry


def equation(tag: str | int, *, printed: bool = False) -> Form:
    """Right-hand side of one equation, as derived from Newton's laws or as the paper prints it.

    Parameters
    ----------
    tag : the paper's number ("21", "(21)", 21, "B4", "b4"), or another tag of
        `derivations.registry.ENTRIES`
    printed : the form in our copy of the paper, mistakes included, instead of the derived one

    Returns
    -------
    SymPy expression; a column of them for a vector; an inequality for a condition. The derived
    form is written to be read, as in the report: where derived and printed form agree, which is
    proved, it is the printed one. Lengths may be in any unit, velocities in that unit per time,
    impulses in that times mass.

    Raises
    ------
    ValueError
        If there is no such tag, it has no expression, or the paper does not print it.

    Notes
    -----
    The letters know their signs, so that `sympy.Symbol("mu")` is another mu: substitute for
    those of `derivations.symbols`, or of the expression's `free_symbols`.

    Examples
    --------
    >>> import derivations
    >>> from derivations.symbols import epsilon, mu, phi
    >>> drift = derivations.equation("29")
    >>> drift.subs({epsilon: 0.5, mu: 0.25, phi: 0})
    3.0*V_z
    >>> derivations.equation("16")
    mu*(Z**2 + k**2) > X*Z
    """
    entry = entry_of(tag)
    if printed and entry.printed is None:
        raise ValueError(f"printed must be False for {tag!r}: the paper does not print it")
    form = entry.printed if printed else entry.readable()
    return sp.ImmutableMatrix(form) if isinstance(form, sp.MatrixBase) else form


def _real(name: str, value: Any) -> Any:
    """Convert a real argument to floating point; labels of pandas and xarray stay."""
    if np.asarray(value).dtype.kind not in "biuf":
        raise TypeError(f"{name} must be a real number or an array of them, got {value!r}")
    return np.multiply(1.0, value)


def _spread(value: Any, shape: tuple[int, ...]) -> Any:
    """Broadcast a constant result to the shape of the arguments; an array stays as it is."""
    return np.full(shape, float(value))[()] if isinstance(value, int | float) else value


def function(tag: str | int) -> Callable[..., Any]:
    """Make a NumPy function of one derived equation.

    (26), (29) and (30) are for a thin rod; (24), (25), (27) and (28) for any X, Z and k.

    Parameters
    ----------
    tag : as in `equation`

    Returns
    -------
    Function of the letters of `equation(tag)`, by position or name, which broadcasts. Their order,
    shown by its signature, is that of `derivations.symbols.NAMED`; letters that only this equation
    has come last, by name. A vector gives a tuple of its components, a condition says where it
    holds. Outside of its domain a form is nan or infinite, with NumPy's warning.

    Raises
    ------
    ValueError
        If there is no such tag, or it has no expression.

    Notes
    -----
    The form is evaluated as it is written, and where it cancels, digits are lost. The functions of
    `impact` keep them.

    Examples
    --------
    The drift of rods of one's own, over the plate's velocity at landing:

    >>> import derivations, numpy as np
    >>> drift = derivations.function("27")
    >>> drift.__name__, *drift.__signature__.parameters
    ('equation_27', 'k', 'mu', 'epsilon', 'X', 'Z', 'V_z')
    >>> phi = np.radians([30, 40])
    >>> X, Z = 0.5 * np.sin(phi), 0.5 * np.cos(phi) + 0.1  # on a tip of its own
    >>> drift(X=X, Z=Z, k=0.3, mu=0.3, epsilon=0.65, V_z=1.0).round(3)
    array([2.588, 1.748])
    """
    form, tag = equation(tag).doit(), entry_of(tag).tag
    order = [*NAMED.values(), *sorted(form.free_symbols, key=str)]
    letters = sorted(form.free_symbols, key=order.index)
    vector = isinstance(form, sp.MatrixBase)
    evaluate = sp.lambdify(letters, tuple(form) if vector else form, "numpy")
    signature = Signature(
        [Parameter(letter.name, Parameter.POSITIONAL_OR_KEYWORD) for letter in letters]
    )

    def evaluated(*values: Any, **named: Any) -> Any:
        try:
            given = signature.bind(*values, **named).arguments
        except TypeError as error:
            raise TypeError(f"equation {tag} takes {signature}: {error}") from None
        numbers = [_real(name, value) for name, value in given.items()]
        found, shape = evaluate(*numbers), np.broadcast_shapes(*map(np.shape, numbers))
        return tuple(_spread(one, shape) for one in found) if vector else _spread(found, shape)

    evaluated.__name__ = evaluated.__qualname__ = f"equation_{tag}"
    evaluated.__doc__ = f"{tag}, {entry_of(tag).what}: {form}."
    evaluated.__signature__ = signature  # type: ignore[attr-defined]
    return evaluated
