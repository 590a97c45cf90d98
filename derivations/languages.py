"""The impact map as text in C99 and in JavaScript, translated from Python.

`impact/_generated.py` and `impact/_kernel.py` are written in a small language: assignments, calls,
tuples, a choice of two numbers. So are the functions of `languages.toml`, which engines and pages
call. Here each function of `languages.toml` becomes one function of another language. The functions
that it calls are put in the place of their calls, so that only numbers are left; lines that nothing
reads are dropped. No formula is written a second time. The order of operations, on which the last
digit depends, is kept.

The interface has the names of Python in both languages; C puts `rod_impact_` before each one, in
JavaScript they are members of one object, `rodImpact`. Angles are in rad; lengths in one unit,
velocities in that unit per time. Records are structs in C and plain objects in JavaScript:

    geometry            X Z k
    given               c_x c_z omega plate_velocity geometry friction restitution
    collision           c_x c_z omega regime P_x P_z slip_velocity normal_velocity energy_change
    impulse_path        slip_velocity normal_velocity P_x P_z
    body                mass k X Z c_x c_z omega
    pair_collision      first second (bodies) regime P_x P_z energy_change
    mobility            A B C
    critical            lower upper
    stationary          c_x c_z regime
    optimum             tilt c_x regime

    collide(law, given)                                         -> collision
    path(given)                                                 -> impulse_path
    collide_pair(law, first, second, friction, restitution)     -> pair_collision
    thin_rod(tilt, length)                                      -> geometry
    spherocylinder(tilt, length, diameter)                      -> geometry
    flat_ended_rod(tilt, length, diameter)                      -> geometry
    mobilities(geometry)                                        -> mobility
    critical_tilts(friction)                                    -> critical
    critical_friction(geometry)                                 -> number
    painleve_friction(geometry)                                 -> number
    slide_friction(geometry, approach_ratio, restitution)       -> number
    drift(geometry, friction, restitution, plate_velocity)      -> stationary
    optimal_tilt(friction, restitution)                         -> optimum

All fields and arguments must be given. An impact with a value that is out of its domain, or not a
number, is INVALID and its numbers are nan, as in Python; other functions check nothing. A law is
"newton", "poisson" or "stronge" in JavaScript, ROD_IMPACT_NEWTON and so on in C. A regime is one of
INVALID = -1, NO_IMPACT = 0, SLIDE = 1, SLIP_STICK = 2, SLIP_REVERSAL = 3: `rodImpact.Regime.SLIDE`,
ROD_IMPACT_SLIDE.

`path`: in the plane of the impulse (P_x, P_z) over the mass the state goes from 0 in a straight
line, with P_x = -+friction P_z, to the point that `path` returns, and from there straight to
(P_x, P_z) of `collide`. With `mobilities` the contact velocity is slip + C P_x - B P_z and
normal + A P_z - B P_x all the way: zero slip and the end of compression are straight lines.
"""

import ast
import textwrap
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from copy import deepcopy
from typing import Any, NamedTuple, TypeAlias

from . import files
from .kernel import CODE, KERNEL, functions, loaded
from .laws import LAWS
from .paper import text_of

_TEXTS = tomllib.loads(text_of("languages.toml"))
Tables: TypeAlias = Mapping[str, Mapping[str, str]]
RECORDS: Tables = _TEXTS["records"]
FUNCTIONS: Tables = _TEXTS["functions"]
REGIMES = {"INVALID": -1, "NO_IMPACT": 0, "SLIDE": 1, "SLIP_STICK": 2, "SLIP_REVERSAL": 3}
LANGUAGES = {
    "c": "rod_impact.h.jinja",
    "javascript": "rod_impact.js.jinja",
    "module": "rod_impact.js.jinja",
    "typescript": "rod_impact.d.ts.jinja",
}
_RECORD_OF = {name: name for name in RECORDS} | {"first": "body", "second": "body"}  # of a field
# Functions that are steps of one sum or product: no comment names them, and the names of their
# values give way to those of their callers.
_STEPS = {
    *(name for code in CODE[:2] for name in code.shown),
    "lacking",
    *(name for name, about in _TEXTS["called"].items() if "twofold" not in about),
}
# Operations and nodes of expressions, beside names, tuples and calls.
_NODES = (
    ast.Add,
    ast.Sub,
    ast.Mult,
    ast.Div,
    ast.BitAnd,
    ast.USub,
    ast.Constant,
    ast.Compare,
    ast.cmpop,
)

Value = Any  # expression of a number or a flag, or a list of them


class Line(NamedTuple):
    """One line of a translated function: a value with a name."""

    routine: str  # function from which the line comes
    name: str
    flag: bool  # whether the value is a flag, not a number
    text: str


class Function(NamedTuple):
    """A translated function, as the template of its language takes it."""

    name: str
    about: Mapping[str, str]  # its entry in languages.toml
    arguments: Mapping[str, str]  # the record that each one is; "law", or "" for a number
    lines: list[Line]
    returned: Any  # text of a number, or a list for a record


class _InTwiceTheDigits(ast.NodeTransformer):
    """Transformer of + - * into calls that work on numbers in twice the digits."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.Call:
        names = {ast.Mult: "product_of", ast.Add: "sum_of", ast.Sub: "difference_of"}
        return _call(names[type(node.op)], self.visit(node.left), self.visit(node.right))


def _call(name: str, *arguments: ast.expr) -> ast.Call:
    return ast.Call(ast.Name(name), list(arguments), [])


def _written(name: str, about: Mapping[str, str]) -> ast.FunctionDef:
    """Syntax tree of a function of languages.toml."""
    lines = f"{about.get('text', '').strip()}\nreturn {about['returned']}".strip()
    (tree,) = ast.parse(f"def {name}({about['arguments']}):\n{textwrap.indent(lines, '    ')}").body
    assert isinstance(tree, ast.FunctionDef)
    return tree


def _called(own: Tables) -> dict[str, ast.FunctionDef]:
    """Syntax trees of all functions that may be called; `own` are those of a language."""
    found = {tree.name: tree for tree in functions(KERNEL.read_text("utf-8"))}
    for name, about in (*_TEXTS["called"].items(), *own.items()):
        tree = deepcopy(found[about["of"]]) if "of" in about else _written(name, about)
        found[name] = _InTwiceTheDigits().visit(tree) if "twofold" in about else tree
    return found


class _Assigned(NamedTuple):
    """An assignment, with the routine that it comes from."""

    routine: str
    name: ast.Name
    value: ast.expr


class _Inlined(ast.NodeTransformer):
    """Lines of a function in which every call is replaced by the lines of the called function.

    As a transformer it puts an expression into the new names, with its calls replaced.
    """

    def __init__(self, called: Mapping[str, ast.FunctionDef], taken: Iterable[str]):
        self.called = called
        self.taken = set(taken)  # names in use
        self.lines: list[_Assigned] = []
        self.routine = ""
        self.names: dict[str, Value] = {}  # new names, or lists of them, in the routine
        self.known: dict[str, Value] = {}  # results by call
        self.steps: set[ast.Name] = set()  # names given in steps

    def visit_Name(self, node: ast.Name) -> Value:
        return self.names.get(node.id, node)

    def visit_Tuple(self, node: ast.Tuple) -> Value:
        return list(map(self.visit, node.elts))

    def visit_Call(self, node: ast.Call) -> Value:
        name, given = ast.unparse(node.func), list(map(self.visit, node.args))
        if name == "law":
            return _selected(*(self.call(law, given) for law in LAWS))
        return self.call(name, given) if name in self.called else _call(name, *given)

    def generic_visit(self, node: ast.AST) -> ast.AST:
        if not isinstance(getattr(node, "op", node), _NODES):
            raise ValueError(f"{ast.unparse(node)!r} is not in the language")
        return super().generic_visit(node)

    def call(self, name: str, given: Sequence[Value]) -> Value:
        """Result of a call; its lines are taken over unless an equal call has been."""
        key = f"{name} {_nested(ast.unparse, list(given))}"
        if key not in self.known:
            before = self.routine, self.names
            self.routine = self.routine if name in _STEPS else name
            self.known[key] = self.run(self.called[name], given)
            self.routine, self.names = before
        return self.known[key]

    def run(self, tree: ast.FunctionDef, given: Sequence[Value]) -> Value:
        """Take over the lines of a function and return its result, in the new names."""
        self.names = {}
        for argument, value in zip(tree.args.args, given, strict=True):
            self.bind(ast.Name(argument.arg), value, step=True)
        for line in deepcopy(tree.body):
            match line:
                case ast.Assign([target], value):
                    self.bind(target, self.visit(value), step=tree.name in _STEPS)
                case ast.Return(ast.expr() as value):
                    return self.visit(value)
                case ast.Expr(ast.Constant()):  # its docstring
                    continue
                case _:
                    raise ValueError(f"{ast.unparse(line)!r} is not in the language")
        raise ValueError(f"{tree.name} returns nothing")

    def bind(self, target: ast.expr, value: Value, *, step: bool) -> None:
        """Give a value its names; an expression becomes a line of its own."""
        match target, value:
            case ast.Tuple(parts), _:
                for part, one in zip(parts, value, strict=True):
                    self.bind(part, one, step=step)
            case ast.Name(name), list() | ast.Name() | ast.Constant():
                if not step and isinstance(value, ast.Name) and value in self.steps:
                    value.id = self.fresh(name)
                    self.steps.remove(value)
                self.names[name] = value
            case ast.Name(name), _:
                self.names[name] = ast.Name(self.fresh(name))
                self.lines.append(_Assigned(self.routine, self.names[name], value))
                if step:
                    self.steps.add(self.names[name])

    def fresh(self, name: str) -> str:
        """Return a name that nothing has so far, and take it."""
        found, number = name, 1
        while found in self.taken:
            number += 1
            found = f"{name}_{number}"
        self.taken.add(found)
        return found

    def needed(self, returned: Value) -> Iterator[_Assigned]:
        """Lines on which the returned value depends, the last first."""
        read: set[str] = set()

        def reads(value: ast.expr) -> None:
            read.update(node.id for node in ast.walk(value) if isinstance(node, ast.Name))

        _nested(reads, returned)
        for line in reversed(self.lines):
            if line.name.id in read:
                reads(line.value)
                yield line


def _nested(function: Any, value: Value) -> Any:
    """What a function gives for an expression, or for each one in a nested list."""
    if isinstance(value, list):
        return [_nested(function, part) for part in value]
    return function(value)


def _selected(newton: Value, poisson: Value, stronge: Value) -> Value:
    """Value that is chosen among those of the three laws, by the law that is asked for."""
    if isinstance(newton, list):
        return list(map(_selected, newton, poisson, stronge))
    others = _call("select", ast.Name("by_poisson"), poisson, stronge)
    return _call("select", ast.Name("by_newton"), newton, others)


class _Words(ast.NodeTransformer):
    """Transformer of expressions into the names, numbers and choices of another language.

    Text that is no longer Python stands in an expression as a name. Python then prints its own
    parentheses around it, which keep the order of operations.
    """

    def __init__(self, language: str):
        known = loaded(KERNEL.read_text("utf-8"), {})
        constants = {name: repr(x) for name, x in known.items() if isinstance(x, float)}
        self.names = constants | _TEXTS["names"][language]

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(self.names.get(node.id, node.id))

    def visit_Constant(self, node: ast.Constant) -> ast.Name:
        return ast.Name(repr(float(ast.unparse(node))))

    def visit_Call(self, node: ast.Call) -> ast.AST:
        parts = [self.visit(argument) for argument in node.args]
        if ast.unparse(node.func) != "select":
            return ast.Call(self.visit(node.func), parts, [])
        condition, first, second = map(ast.unparse, parts)
        return ast.Name(f"({condition} ? {first} : {second})")

    def text(self, value: ast.expr) -> str:
        """Text of an expression in the other language."""
        return ast.unparse(self.visit(deepcopy(value)))


def function(language: str, name: str, about: Mapping[str, str], own: Tables) -> Function:
    """Translate a function of languages.toml.

    Parameters
    ----------
    language : "c" or "javascript"
    name, about : name of the function, and its entry in languages.toml
    own : functions that the language has in its own way, by name, like those of languages.toml
    """
    tree, words = _written(name, about), _Words(language)
    arguments = {}
    for argument in tree.args.args:
        record = ast.unparse(argument.annotation) if argument.annotation else argument.arg
        arguments[argument.arg] = record if record in (*RECORDS, "law") else ""
    inlined = _Inlined(_called(own), [*arguments, *words.names])
    given: list[Value] = [
        [ast.Name(x) for x in numbers_of(part, kind)] if kind in RECORDS else ast.Name(part)
        for part, kind in arguments.items()
    ]
    returned = inlined.run(tree, given)
    lines = [
        Line(
            of,
            variable.id,
            isinstance(getattr(value, "op", value), ast.Compare | ast.BitAnd),
            words.text(value),
        )
        for of, variable, value in inlined.needed(returned)
    ]
    return Function(name, about, arguments, lines[::-1], _nested(words.text, returned))


def numbers_of(name: str, record: str) -> Iterator[str]:
    """Names of all numbers in a record, such as given.geometry.X; a number has its own name."""
    if record not in RECORDS:
        yield name
    for field in RECORDS.get(record, ()):
        yield from numbers_of(f"{name}.{field}", _RECORD_OF.get(field, ""))


def _folded(text: str) -> str:
    """Line of a function's body, wrapped if it is long."""
    wrapper = textwrap.TextWrapper(100, "    ", " " * 8)
    wrapper.break_long_words = wrapper.break_on_hyphens = False
    return wrapper.fill(text)


def source(language: str) -> str:
    """Text of the impact map in another language.

    Parameters
    ----------
    language : "c" (a C99 header), "javascript" (a script), "module" (the same as an ES module) or
        "typescript" (declarations of either)

    Raises
    ------
    ValueError
        If there is no such language.
    """
    if language not in LANGUAGES:
        raise ValueError(f"language must be one of {', '.join(LANGUAGES)}, got {language!r}")
    files.TEMPLATES.filters["folded"] = _folded
    words = "c" if language == "c" else "javascript"
    return files.TEMPLATES.get_template(LANGUAGES[language]).render(
        functions=[
            function(words, name, about, _TEXTS["own"][words]) for name, about in FUNCTIONS.items()
        ],
        product_error=function(words, "product_error", _TEXTS["product_error"], {}),
        module=language == "module",
        record_of=_RECORD_OF,
        records=RECORDS,
        regimes=REGIMES,
        laws=LAWS,
        digest=files.digest(),
    )
