"""What a derivation rests on, noted while it is computed.

An axiom notes its use (`note`), `solve` an equation that was solved. `derived` caches a derivation
together with its steps, so that a cached result hands the note on.
"""

import inspect
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from typing import Any

import sympy as sp
from sympy.core.random import seed

from . import paper
from .equality import equal
from .typeset import latex

_SEVERAL = re.compile(r"[-+/]")  # in a left side of several letters
_UNREAD = re.compile(r"[A-Za-z\\'|]")


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a derivation: an axiom put to use, a value derived, an equation solved."""

    kind: str  # "axiom", "derived", "part" (of a derived one), "solved" or "said"
    name: str  # tag of the axiom, name of the step; of the others its sentence
    given: tuple[Any, ...] = ()  # arguments and place; of "solved" the unknowns; else left sides
    value: Any = None  # what it gave; of "solved" both sides
    inner: tuple["Step", ...] = ()  # the steps on the way to it

    @property
    def what(self) -> str:
        """Its sentence: of a derived value the first line of the docstring."""
        if self.kind != "derived":
            return self.name
        return (STEPS[self.name].__doc__ or "").partition("\n")[0].rstrip(".")

    @property
    def values(self) -> list[tuple[str, sp.Expr]]:
        """What a derived value consists of, each with its left side."""
        if self.kind in ("solved", "part"):
            return []
        if isinstance(self.value, dict):
            return [
                (latex(x) if isinstance(x, sp.Basic) else LEFTS[self.name][0] % x, value)
                for x, value in self.value.items()
            ]
        listed = self.value if isinstance(self.value, tuple | sp.MatrixBase) else (self.value,)
        names = inspect.signature(STEPS[self.name]).parameters if self.kind == "derived" else ()
        put = dict(zip(names, self.given, strict=False))
        lefts = LEFTS[self.name] if self.kind == "derived" else self.given
        return [(left % put, value) for left, value in zip(lefts, listed, strict=True)]


_open: list[list[Step]] = []  # steps of the derivations now being computed, the inner one last

STEPS: dict[str, Callable[..., Any]] = {}  # every derivation step, by module and name
LEFTS: dict[str, tuple[str, ...]] = {}  # left sides of what each gives, LaTeX with %(argument)s
CACHES: list[dict] = []  # of all derivations: arguments, and the result with its steps


def note(*steps: Step) -> None:
    """Count steps among those of the derivation now being computed, each once."""
    if _open:
        _open[-1] += [step for step in steps if step not in _open[-1]]


@contextmanager
def noted() -> Iterator[list[Step]]:
    """Collect the steps that are taken inside."""
    taken: list[Step] = []
    _open.append(taken)
    try:
        yield taken
    finally:
        _open.pop()


def misread(steps: Iterable[Step], named: Iterable[tuple[str, Any]] = ()) -> str:
    """What is wrong with a left side such as v_f - v_1; nothing if all is well.

    It is read with the letters that are named before it and those of the values; where one of
    its letters is not among them, it is not read.
    """
    known: dict[str, Any] = {}
    free: set[sp.Basic] = set()
    sides = [*named, *(pair for step in steps for pair in step.values)]
    for left, value in sides:
        side = paper.bare(left)
        free |= getattr(value, "free_symbols", set())
        if not _SEVERAL.search(side[1:]):
            known[side] = value
            continue
        letters = {paper.bare(latex(x)): x for x in free} | known
        found = "|".join(map(re.escape, sorted(letters, key=len, reverse=True)))
        if not _UNREAD.search(re.sub(found, "", side)):
            meant = paper.read(side, letters)
            if not equal(meant, value):
                return f"{left} is {meant}, not {value}"
    return ""


def names(steps: Iterable[Step], kind: str) -> set[str]:
    """Names of the steps of a kind, those on the way to a step included."""
    inner = [names(step.inner, kind) for step in steps]
    return {step.name for step in steps if step.kind == kind}.union(*inner)


class Parts(tuple):
    """The values of a step, which notes those that are taken one by one."""

    step: Step

    def __getitem__(self, place: Any) -> Any:
        """Return the value at a place."""
        note(Step("part", self.step.name, (*self.step.given, place)))
        return super().__getitem__(place)


def remembered(function: Callable[..., Any], name: str = "") -> Callable[..., Any]:
    """Cache results by positional arguments, each with its steps; a `name` makes it a step."""
    results: dict[tuple, tuple[Any, list[Step]]] = {}

    @wraps(function)
    def cached(*given: Any) -> Any:
        if given not in results:
            seed(0)  # factoring draws random numbers, of which a few take it minutes
            with noted() as taken:
                value = function(*given)
            whole = Step("derived", name, given, value, tuple(taken))
            if name and isinstance(value, tuple):
                value = Parts(value)
                value.step = whole
            if wrong := misread([*taken, *([whole] if name else [])]):
                raise ValueError(wrong)
            results[given] = value, [whole] if name else taken
        value, steps = results[given]
        note(*steps)
        return value

    CACHES.append(results)
    return cached


def derived(*lefts: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Register a derivation step with the left sides of its values, and cache it.

    The first line of its docstring is the sentence that a reader finds before them.
    """

    def registered(function: Callable[..., Any]) -> Callable[..., Any]:
        name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"

        @wraps(function)
        def step(*given: Any) -> Any:
            return STEPS[name](*given)

        STEPS[name], LEFTS[name] = function, lefts
        return remembered(step, name)

    return registered


def say(sentence: str, *lefts_and_value: Any) -> None:
    """Note a line of the derivation: a sentence, and an equation of what was computed.

    The left sides, LaTeX, and the value come last; several values are a tuple.
    """
    *lefts, value = lefts_and_value
    note(Step("said", sentence, tuple(lefts), value))


def solve(forms: Any, unknowns: Any, meant: str = "") -> Any:
    """Solve one equation for a letter, or several linear ones; it is noted as a step.

    An equation is an expression that vanishes, or a pair of sides. `meant` is the sentence that
    says what it is; without one it says what it was solved for.
    """
    several = isinstance(unknowns, list)
    letters = tuple(unknowns) if several else (unknowns,)
    equations = forms if several else [forms]
    pairs = [form if isinstance(form, tuple) else (form, sp.S.Zero) for form in equations]
    note(Step("solved", meant, letters, tuple(pairs)))
    differences = [left - right for left, right in pairs]
    if several:
        (found,) = sp.linsolve(differences, *letters)
        return found
    # SymPy's own simplification of a root takes longer than the root
    roots = sp.solve(differences[0], unknowns, simplify=False)
    return [sp.factor(x) if x.is_rational_function() else sp.simplify(x) for x in roots]
