"""Routines: algorithms as ordered lists of assignments, proved.

The text of a routine, in kernel.toml, keeps to the part of Python that every language has: names,
numbers, + - * /, comparisons, `&`, groups, and calls of primitives (`arithmetic`), of generated
functions and of other routines. A name is assigned once. It may have a meaning: the value it has
where nothing is rounded, derived elsewhere; that of a low part is zero. So may `returned`, the
group of what is returned.

A proof runs the text twice in each situation. Once nothing is rounded: every name has the value
that it means. Then every rounding is followed to first order, and what is claimed to be accurate
must have no more of them left than it says. Neither is a bound for all numbers: a mistake is not
seen if it shows in no situation, in terms of second order alone, in a clamp that acts on rounding
errors, or beyond the range of floating-point numbers. The order of arguments and of results is
proved by the routines that call, so a kernel is proved by all its routines together.
"""

import ast
import textwrap
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cache, cached_property
from importlib import resources
from types import CodeType
from typing import Any

import mpmath
import sympy as sp

from . import codegen
from .arithmetic import ARITHMETICS, Rounded
from .proof import DIGITS, Proof, Verdict
from .sentences import to_text

# An expression or condition, in letters and in the names before it, or a group of them.
Meaning = Any
Situation = Mapping[str, Any]  # a value of every letter

low = sp.Function("low")  # what the rounded value of an argument lacks
ANY = sp.Symbol("any")  # a value that no branch takes
# Friction beyond 2^500 gives the same impact, and squares of lengths may stand beside it.
CONSTANTS = {"SPLIT": "2.0**27 + 1", "HUGE_FRICTION": "2.0**500"}

_ALLOWED = (
    *(ast.Module, ast.Assign, ast.Tuple, ast.Name, ast.Constant, ast.Call, ast.BinOp, ast.UnaryOp),
    *(ast.Compare, ast.Add, ast.Sub, ast.Mult, ast.Div, ast.BitAnd, ast.USub, ast.Load, ast.Store),
    *(ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq),
)
_TEXTS = tomllib.loads(resources.files(__package__).joinpath("kernel.toml").read_text("utf-8"))
_SWAPS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
_TURNED = {ast.Lt: ast.Gt, ast.LtE: ast.GtE, ast.Gt: ast.Lt, ast.GtE: ast.LtE}
_known: dict[str, "Routine"] = {}  # by name, for the routines that call them


@dataclass(frozen=True, kw_only=True)
class Routine:
    """One routine: an entry of the registry, and a function of the generated kernel."""

    name: str  # of the function
    what: str  # it computes
    note: str = ""  # domain, units
    arguments: str  # names; `law` is the routine of a law of restitution
    text: str  # assignments
    returned: str  # names
    means: Callable[[str], Mapping[str, Meaning]]  # of a law: the value of each name
    situations: Callable[[], Iterable[Situation]]  # in which it is tried
    accurate: tuple[str, ...] = ()  # "sum of names: roundings left, of its size [of another sum]"
    laws: tuple[str, ...] = ("",)  # under which it is proved
    check: Callable[["Routine"], bool] | None = None  # another part of the proof
    verdict: Verdict = "new"  # of all
    printed: None = None  # no equation of the paper
    contradicted_by: str = ""  # nothing

    def __post_init__(self) -> None:
        _known.setdefault(self.name, self)

    @property
    def tag(self) -> str:
        """Name among the registry's entries."""
        return f"kernel: {self.name}"

    @cached_property
    def tree(self) -> ast.Module:
        """The text, parsed; ValueError if it is not in the language."""
        tree = ast.parse(textwrap.dedent(self.text))
        for node in ast.walk(tree):
            if not isinstance(node, _ALLOWED):
                raise ValueError(f"{self.tag}: {ast.unparse(node)!r} is not in the language")
        names = [*self.arguments.split(), *_assigned(tree)]
        if len({*names}) < len(names):
            raise ValueError(f"{self.tag}: a name is assigned twice")
        return tree

    @property
    def given(self) -> list[str]:
        """Arguments that are numbers."""
        return [name for name in self.arguments.split() if name != "law"]

    @cached_property
    def _code(self) -> CodeType:
        return compile(f"{ast.unparse(self.tree)}\nreturned = {self.returned}", self.tag, "exec")

    def source(self) -> str:
        """Text of the function."""
        what, note = f"{to_text(self.what)}.", textwrap.fill(f"{to_text(self.note)}.", 92)
        doc = f"{what}\n\n{note}\n" if self.note else what
        text = textwrap.dedent(self.text).strip()
        body = f'"""{doc}"""\n{text}\nreturn {self.returned}'
        head = f"def {self.name}({', '.join(self.arguments.split())}):\n"
        return head + textwrap.indent(body, "    ")

    def prove(self) -> Proof:
        """Test every assignment, and how many roundings are left of what is accurate."""
        try:
            names = [*_assigned(self.tree), "returned"]
            with mpmath.workdps(DIGITS + 20):
                wrong = [text for law in self.laws if (text := self._wrong(names, law))]
            if self.check is not None and not self.check(self):
                wrong.append(f"it is not true {self._checked}")
        except Exception as error:  # whatever stops a computation, there is no proof
            return Proof(ok=False, evidence=f"{type(error).__name__}: {error}", computed=False)
        points = sum(len(values(self, law)) for law in self.laws)
        known = [name for name in names if name in _meant(self.means, self.laws[0])]
        evidence = f"right to {DIGITS} digits at {points} points: {', '.join(known)}"
        if self.accurate:
            evidence += f"; roundings left: {', '.join(self.accurate)}"
        if self.check is not None:
            evidence += f"; tested {self._checked}"
        return Proof(ok=not wrong, evidence=wrong[0] if wrong else evidence)

    @property
    def _checked(self) -> str:
        """What `check` tests, in words."""
        doc = (self.check.__doc__ or "") if self.check else ""
        return "that " + doc.partition("\n")[0].removeprefix("Whether ").rstrip(".")

    def _wrong(self, names: list[str], law: str) -> str:
        """What is wrong under one law, in words."""
        for at in values(self, law):
            exact = self.run("exact", {name: at[name] for name in self.given}, law)
            for name in names:
                if name in at and not _same(exact[name], at[name]):
                    return f"{name} is not what it stands for"
            left = self._run_rounded(at, law)
            for claim in self.accurate:
                whole, _, left_of_it = claim.partition(": ")
                most, _, unit = left_of_it.partition(" of ")
                errors = _total(_parts(left, whole)).errors.values()
                size = sum(map(abs, _parts(exact, unit or whole)))
                if sum(map(abs, errors)) > (int(most) + mpmath.mpf("1e-6")) * size:
                    return f"{whole} has more than {most} roundings left"
        return ""

    def _run_rounded(self, at: Mapping[str, Any], law: str) -> dict[str, Any]:
        meant = [_meant(self.means, law)[name] for name in self.given]
        flat = [part for each in meant for part in (each if isinstance(each, tuple) else [each])]
        parted = {part.args[0]: None for part in flat if isinstance(part, low)}
        rounded = {n: _rounded(x, at[n], parted) for n, x in zip(self.given, meant, strict=True)}
        return self.run("rounded", rounded, law)

    def run(self, arithmetic: str, given: Mapping[str, Any], law: str = "") -> dict[str, Any]:
        """All values, assigned in order.

        Parameters
        ----------
        arithmetic : name of one of `ARITHMETICS`
        given : value of each argument
        law : name of the routine that is the argument `law`
        """
        space = {**_functions(arithmetic), **given}
        if law:
            space["law"] = space[law]
        with mpmath.workdps(DIGITS + 20):
            exec(self._code, space)
        return space

    def says_the_same(self, other: "Routine") -> bool:
        """Whether two routines have the same values, with roundings of the same size.

        This is tested in the situations of the proof, so a change that shows in none is the same.

        Parameters
        ----------
        other : with the same meanings
        """
        return all(
            _sizes(self._run_rounded(at, law)) == _sizes(other._run_rounded(at, law))
            for law in self.laws
            for at in values(self, law)
        )

    def mistakes(self) -> Iterator[tuple[str, "Routine"]]:
        """Changed routines, each with the change in words: an operation, a comparison, a name."""
        tree = self.tree
        old = ast.unparse(tree).splitlines()
        for node in ast.walk(tree):
            for changed in _changed(node):
                new = ast.unparse(deepcopy(tree, {id(node): changed})).splitlines()
                for before, after in zip(old, new, strict=True):
                    if before != after:
                        yield f"{before} to {after}", replace(self, text="\n".join(new))


def read(
    name: str,
    means: Callable[[str], Mapping[str, Meaning]],
    situations: Callable[[], Iterable[Situation]],
    **more: Any,
) -> Routine:
    """A routine of kernel.toml, with the meaning of its names and where it is tried."""
    texts = dict(_TEXTS[name])
    claims = tuple(texts.pop("accurate", ()))
    return Routine(name=name, means=means, situations=situations, accurate=claims, **texts, **more)


def _assigned(tree: ast.AST) -> list[str]:
    """Names that are assigned, in order; `_` is none."""
    lines = ast.iter_child_nodes(tree)
    names = [node for line in lines for node in ast.walk(line) if isinstance(node, ast.Name)]
    return [node.id for node in names if isinstance(node.ctx, ast.Store) and node.id != "_"]


def _changed(node: ast.AST) -> Iterator[ast.AST]:
    """What may stand in a text by mistake in place of a node."""
    match node:
        case ast.BinOp(left, ast.BitAnd(), right):
            yield from (left, right)
        case ast.BinOp(left, operation, right):
            yield ast.BinOp(left, _SWAPS[type(operation)](), right)
        case ast.Compare(left, [comparison], right) if type(comparison) in _TURNED:
            yield ast.Compare(left, [_TURNED[type(comparison)]()], right)
        case ast.UnaryOp(ast.USub(), operand):
            yield operand
        case ast.Constant(int() | float() as value):
            yield ast.Constant(value + 1)
        case ast.Call(function, arguments) if len(arguments) > 1:
            for i in range(len(arguments) - 1):
                swapped = arguments.copy()
                swapped[i : i + 2] = reversed(swapped[i : i + 2])
                yield ast.Call(function, swapped, [])


@cache
def _functions(arithmetic: str) -> dict[str, Any]:
    """Everything that a text may call, and the constants."""
    space: dict[str, Any] = {name: eval(text) for name, text in CONSTANTS.items()}
    for text in (*map(codegen.text, codegen.FUNCTIONS), *(r.source() for r in _known.values())):
        exec(text, space)
    space.update(ARITHMETICS[arithmetic])  # in place: what was executed looks names up there
    return space


@cache
def _meant(means: Callable[[str], Mapping[str, Meaning]], law: str) -> Mapping[str, Meaning]:
    return means(law)


@cache
def _values(
    means: Callable[[str], Mapping[str, Meaning]],
    situations: Callable[[], Iterable[Situation]],
    law: str,
) -> list[dict[str, Any]]:
    with mpmath.workdps(DIGITS + 20):
        found = [{"any": mpmath.nan, **situation} for situation in situations()]
        for name, meant in _meant(means, law).items():
            form = sp.sympify(meant).replace(low, lambda _: sp.S.Zero)
            letters = sorted(map(str, form.free_symbols))
            evaluate = sp.lambdify(letters, form, "mpmath", cse=True)
            for values in found:
                try:
                    values[name] = evaluate(*(values[letter] for letter in letters))
                except ZeroDivisionError:  # 0/0 without slip and friction: any value
                    values[name] = mpmath.nan
    return found


def values(routine: Routine, law: str = "") -> list[dict[str, Any]]:
    """What each name of a routine stands for, as numbers, in each situation."""
    return _values(routine.means, routine.situations, law)


def _sizes(found: Mapping[str, Any]) -> dict[str, Any]:
    """Values and roundings that are left, as text of 30 digits."""
    numbers = {name: x for name, x in found.items() if isinstance(x, Rounded)}
    return {
        name: [mpmath.nstr(part, 30) for part in (x.value, sum(map(abs, x.errors.values())))]
        for name, x in numbers.items()
    }


def _same(a: Any, b: Any) -> bool:
    """Whether a number, a condition or a group of them is what it stands for."""
    if isinstance(b, tuple):
        return len(a) == len(b) and all(map(_same, a, b))
    if mpmath.isnan(b):
        return True
    return bool(abs(a - b) <= mpmath.mpf(10) ** -DIGITS * (1 + abs(b)))


def _rounded(meant: Meaning, value: Any, parted: dict[sp.Expr, Any]) -> Any:
    """An argument as it comes: exact, or rounded if its low part comes with it."""
    if isinstance(meant, tuple):
        return tuple(_rounded(part, x, parted) for part, x in zip(meant, value, strict=True))
    if isinstance(meant, low):
        return parted[meant.args[0]][1]
    if isinstance(value, bool):
        return value
    if meant in parted:
        parted[meant] = Rounded(value).parted()
        return parted[meant][0]
    return Rounded.of(value)


def _parts(found: Mapping[str, Any], whole: str) -> list[Any]:
    """Values in a sum of names; a group counts as the sum of its parts."""
    values = [found[name] for name in whole.split(" + ")]
    return [part for x in values for part in (x if isinstance(x, tuple) else [x])]


def _total(parts: list[Any]) -> Rounded:
    """Exact sum of rounded numbers."""
    whole = Rounded.of(parts[0])
    for part in parts[1:]:
        whole = whole.plus(part)
    return whole
