"""Steps on which a derivation rests, noted while it is computed.

An axiom notes its use by `note`; `solve` notes the equation that it solves. `derived` caches a
derivation together with its steps, so that a cached result notes them wherever it is used.
"""

import inspect
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any, NamedTuple, TypeAlias

import sympy as sp
from sympy.core.random import seed

from . import paper
from .equality import equal
from .typeset import latex

Derivation: TypeAlias = Callable[..., Any]

_SEVERAL = re.compile(r"[-+/]")  # in a left side of several letters
_UNREAD = re.compile(r"[A-Za-z\\'|]")


class Step(NamedTuple):
    """One step of a derivation: an axiom put to use, a value derived, an equation solved."""

    kind: str  # "axiom", "derived", "part" (of a derived one), "solved" or "said"
    name: str  # tag of an axiom, name of a derived step or of a part's; else the sentence
    given: tuple[Any, ...] = ()  # arguments, then a part's place; unknowns; or left sides
    value: Any = None  # the result; if "solved", both sides of each equation
    inner: tuple["Step", ...] = ()  # steps that were taken while it was computed

    @property
    def what(self) -> str:
        """Sentence of the step: for a derived one the first line of its function's docstring."""
        if self.kind != "derived":
            return self.name
        return (STEPS[self.name].__doc__ or "").partition("\n")[0].rstrip(".")

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of a derived step by their names, without those that were left out."""
        return dict(zip(inspect.signature(STEPS[self.name]).parameters, self.given, strict=False))

    @property
    def case(self) -> tuple[str, ...]:
        """Name of the step, and the cases among its arguments, such as "stick"."""
        return self.name, *(x for x in self.given if isinstance(x, str))

    @property
    def values(self) -> list[tuple[str, sp.Expr]]:
        """Values of the step, each with its left side; a solved equation or a part has none."""
        if self.kind in ("solved", "part"):
            return []
        if isinstance(self.value, dict):
            return [
                (latex(x) if isinstance(x, sp.Basic) else LEFTS[self.name][0] % x, value)
                for x, value in self.value.items()
            ]
        listed = self.value if isinstance(self.value, tuple | sp.MatrixBase) else (self.value,)
        lefts: Iterable[str] = self.given
        if self.kind == "derived":
            put = self.arguments
            lefts = (left % put for left in LEFTS[self.name])
        return list(zip(lefts, listed, strict=True))


_open: list[list[Step]] = []  # steps of the derivations now being computed, innermost last

STEPS: dict[str, Derivation] = {}  # every derivation step, by module and name
LEFTS: dict[str, tuple[str, ...]] = {}  # left sides of each one's values, LaTeX with %(argument)s
CACHES: list[dict] = []  # one per cached function: arguments to the result with its steps


def note(*steps: Step) -> None:
    """Add steps to those of the derivation now being computed, each once."""
    if _open:
        _open[-1] += [step for step in steps if step not in _open[-1]]


@contextmanager
def noted() -> Iterator[list[Step]]:
    """Collect the steps that are taken inside a `with` block, in a list."""
    taken: list[Step] = []
    _open.append(taken)
    try:
        yield taken
    finally:
        _open.pop()


def misread(steps: Iterable[Step], named: Iterable[tuple[str, Any]] = ()) -> str:
    """What is wrong with the left sides of steps, such as v_f - v_1; empty if all is well.

    A left side of several letters is read with the letters that are named before it and those of
    the values so far, and must equal its value. One with any other letter is not read.
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
    """Names of all steps of a kind, including the steps inside other steps."""
    inner = [names(step.inner, kind) for step in steps]
    return {step.name for step in steps if step.kind == kind}.union(*inner)


class Parts(tuple):
    """Values of a step, as a tuple that notes each one that is taken by its place."""

    step: Step

    def __getitem__(self, place: Any) -> Any:
        """Return the value at a place, and note that it was taken."""
        note(Step("part", self.step.name, (*self.step.given, place)))
        return super().__getitem__(place)


def remembered(function: Derivation, name: str = "") -> Derivation:
    """Cache results and their steps by positional arguments; a `name` makes each call a step."""
    results: dict[tuple, tuple[Any, list[Step]]] = {}

    @wraps(function)
    def cached(*given: Any) -> Any:
        if given not in results:
            seed(0)  # factoring draws random numbers; unlucky ones make it take minutes
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


def derived(*lefts: str) -> Callable[[Derivation], Derivation]:
    """Decorator that registers a derivation step with the left sides of its values, and caches it.

    The first line of the step's docstring is the sentence that a reader finds before its values.
    """

    def registered(function: Derivation) -> Derivation:
        name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}"

        @wraps(function)
        def step(*given: Any) -> Any:
            return STEPS[name](*given)

        STEPS[name], LEFTS[name] = function, lefts
        return remembered(step, name)

    return registered


def say(sentence: str, *lefts_and_value: Any) -> None:
    """Note a line of a derivation: a sentence, and an equation of what was computed.

    After the sentence come the left sides, in LaTeX, and last the value; several values are a
    tuple.
    """
    *lefts, value = lefts_and_value
    note(Step("said", sentence, tuple(lefts), value))


def solve(forms: Any, unknowns: Any, meant: str = "") -> Any:
    """Solve an equation for a letter, or linear ones for a list of letters; note it as a step.

    An equation is an expression that vanishes, or a pair of sides. `meant` is the sentence of the
    step; without one it says which letters were solved for. One equation gives a list of its
    roots, several give one value for each letter.
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
    # SymPy takes longer to simplify a root than to find it
    roots = sp.solve(differences[0], unknowns, simplify=False)
    return [sp.factor(x) if x.is_rational_function() else sp.simplify(x) for x in roots]


def only_root(form: Any, unknown: sp.Symbol, meant: str = "") -> sp.Expr:
    """Solve an equation that has one root, as `solve` does; ValueError if it has more or none."""
    (found,) = solve(form, unknown, meant)
    return found
