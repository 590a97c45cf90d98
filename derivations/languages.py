"""The impact map as text in C99 and in JavaScript, translated from the generated Python.

`impact/_generated.py` and `impact/_kernel.py` are written in a small language: assignments, calls,
tuples, a choice of two numbers. So are the functions of `languages.toml`, which engines and pages
call. Here each of the latter becomes one function of another language: what it calls is put in its
place, so that only numbers are left, and no line that nothing reads. No formula is written a second
time, and the order of operations, on which the last digit rests, stays.

The interface has the names of Python in both languages; C puts `rod_impact_` before each one, in
JavaScript they are members of one object, `rodImpact`. Angles are in rad; lengths in one unit,
velocities in that unit per time. Records are structs in C and plain objects in JavaScript:

    given               c_x c_z omega plate_velocity X Z k friction restitution
    collision           c_x c_z omega regime P_x P_z slip_velocity normal_velocity energy_change
    impulse_path        slip_velocity normal_velocity P_x P_z
    body                mass k X Z c_x c_z omega
    pair_collision      first second (bodies) regime P_x P_z energy_change
    geometry            X Z k
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

All fields and arguments must be given; nothing but the law's name is checked. A law is "newton",
"poisson" or "stronge" in JavaScript, ROD_IMPACT_NEWTON and so on in C. A regime is one of
INVALID = -1, NO_IMPACT = 0, SLIDE = 1, SLIP_STICK = 2, SLIP_REVERSAL = 3:
`rodImpact.Regime.SLIDE`, ROD_IMPACT_SLIDE.

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
from importlib import resources
from itertools import chain, count
from typing import Any, ClassVar

from jinja2 import Environment, PackageLoader, StrictUndefined

from . import error_free, files
from .routines import CONSTANTS

_TEXTS = tomllib.loads(resources.files(__package__).joinpath("languages.toml").read_text("utf-8"))
RECORDS: Mapping[str, Mapping[str, str]] = _TEXTS["records"]
FUNCTIONS: Mapping[str, Mapping[str, str]] = _TEXTS["functions"]
LAWS = "newton", "poisson", "stronge"
REGIMES = {"INVALID": -1, "NO_IMPACT": 0, "SLIDE": 1, "SLIP_STICK": 2, "SLIP_REVERSAL": 3}
_PREFIX = "rod_impact_"  # of all names in C
_CONSTANTS = {**CONSTANTS, "MOST_FRICTION": "2.0**500"}  # of bodies; beyond it nothing changes
# Steps of one sum or product: not worth a comment, and their names give way to those of callers.
_SMALL = {
    *(routine.name for routine in error_free.ROUTINES),
    *(name for name, about in _TEXTS["called"].items() if "twofold" not in about),
}

Value = ast.expr | list["Value"]  # a number, a flag, or a group of them


class _InTwiceTheDigits(ast.NodeTransformer):
    """Operations on numbers in twice the digits."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.Call:
        left, right = self.visit(node.left), self.visit(node.right)
        if isinstance(node.op, ast.Mult):
            return _call("product_of", left, right)
        return _call("sum_of" if isinstance(node.op, ast.Add) else "difference_of", left, right)


def _call(name: str, *arguments: ast.expr) -> ast.Call:
    return ast.Call(ast.Name(name), list(arguments), [])


def _parsed(text: str) -> Iterator[ast.FunctionDef]:
    yield from (node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef))


def _written(name: str, about: Mapping[str, str]) -> ast.FunctionDef:
    """A function of languages.toml."""
    lines = f"{about.get('text', '').strip()}\nreturn {about['returned']}".strip()
    (tree,) = _parsed(f"def {name}({about['arguments']}):\n{textwrap.indent(lines, '    ')}")
    return tree


def _called(own: Mapping[str, Mapping[str, str]]) -> dict[str, ast.FunctionDef]:
    """All functions that others call, some as a language has them."""
    texts = (path.read_text(encoding="utf-8") for path in (files.CLOSED_FORMS, files.KERNEL))
    found = {tree.name: tree for text in texts for tree in _parsed(text)}
    for name, about in (*_TEXTS["called"].items(), *own.items()):
        tree = deepcopy(found[about["of"]]) if "of" in about else _written(name, about)
        found[name] = _InTwiceTheDigits().visit(tree) if "twofold" in about else tree
    return found


class _Inlined:
    """A function in which every call of another one is replaced by what that does."""

    def __init__(self, called: Mapping[str, ast.FunctionDef], taken: Iterable[str]):
        self.called = called
        self.taken = set(taken)  # names
        self.lines: list[tuple[str, ast.Name, ast.expr]] = []  # routine, name, value
        self.routine = ""
        self.known: dict[str, Value] = {}  # what calls returned
        self.steps: set[ast.Name] = set()  # names given in small functions

    def value(self, node: ast.expr, names: Mapping[str, Value]) -> Value:
        """What an expression is, in the new names."""
        match node:
            case ast.Name(name):
                return names.get(name, node)
            case ast.Tuple(parts):
                return [self.value(part, names) for part in parts]
            case ast.Call(ast.Name("law"), parts):
                given = [self.value(part, names) for part in parts]
                return _selected(*(self.call(law, given) for law in LAWS))
            case ast.Call(ast.Name(name), parts):
                given = [self.value(part, names) for part in parts]
                if name in self.called:
                    return self.call(name, given)
                return _call(name, *map(_number, given))
        made = deepcopy(node)
        for field, old in ast.iter_fields(node):
            match old:
                case ast.expr():
                    setattr(made, field, self.value(old, names))
                case [ast.expr() as one]:
                    setattr(made, field, [self.value(one, names)])
        return made

    def call(self, name: str, given: Sequence[Value]) -> Value:
        """What a function returns."""
        key = f"{name} {[_dumped(value) for value in given]}"
        if key not in self.known:
            before = self.routine
            self.routine = before if name in _SMALL else name
            self.known[key] = self.run(self.called[name], given)
            self.routine = before
        return self.known[key]

    def run(self, tree: ast.FunctionDef, given: Sequence[Value]) -> Value:
        """Take over the lines of a function; returns what it returns."""
        names: dict[str, Value] = {}
        for argument, value in zip(tree.args.args, given, strict=True):
            self.bind(ast.Name(argument.arg), value, names)
        for line in tree.body:
            match line:
                case ast.Assign([target], value):
                    self.bind(target, self.value(value, names), names, tree.name in _SMALL)
                case ast.Return(ast.expr() as value):
                    return self.value(value, names)
        raise ValueError(f"{tree.name} returns nothing")

    def bind(
        self, target: ast.expr, value: Value, names: dict[str, Value], small: bool = True
    ) -> None:
        """Give a value its names; `small`: if it is a step of a sum or product."""
        if isinstance(target, ast.Tuple):
            assert isinstance(value, list)
            for one, part in zip(target.elts, value, strict=True):
                self.bind(one, part, names, small)
            return
        assert isinstance(target, ast.Name)
        if not isinstance(value, list | ast.Name | ast.Constant):
            self.lines.append((self.routine, name := ast.Name(self.fresh(target.id)), value))
            self.steps |= {name} if small else set()
            value = name
        elif isinstance(value, ast.Name) and value in self.steps and not small:
            value.id = self.fresh(target.id)
            self.steps.remove(value)
        names[target.id] = value

    def fresh(self, name: str) -> str:
        """A name that nothing has so far."""
        found = next(
            x for x in chain([name], (f"{name}_{i}" for i in count(2))) if x not in self.taken
        )
        self.taken.add(found)
        return found

    def needed(self, returned: Value) -> list[tuple[str, str, ast.expr]]:
        """Lines on which what is returned depends."""
        read, kept = _read(returned), []
        for routine, name, value in reversed(self.lines):
            if name.id in read:
                read |= _read(value)
                kept.append((routine, name.id, value))
        return kept[::-1]


def _number(value: Value) -> ast.expr:
    assert isinstance(value, ast.expr)
    return value


def _dumped(value: Value) -> str:
    return str(list(map(_dumped, value))) if isinstance(value, list) else ast.dump(value)


def _read(value: Value) -> set[str]:
    """Names in a value."""
    if isinstance(value, list):
        return set().union(*map(_read, value))
    return {node.id for node in ast.walk(value) if isinstance(node, ast.Name)}


def _selected(newton: Value, poisson: Value, stronge: Value) -> Value:
    """What holds under the law that is asked for."""
    if isinstance(newton, list):
        assert isinstance(poisson, list)
        assert isinstance(stronge, list)
        return list(map(_selected, newton, poisson, stronge))
    others = _call("select", ast.Name("by_poisson"), _number(poisson), _number(stronge))
    return _call("select", ast.Name("by_newton"), newton, others)


class _Words(ast.NodeTransformer):
    """Expressions with the names, numbers and choices of another language.

    What is no longer Python stands in them as a name, so that Python's own parentheses, which keep
    the order of operations, are printed around it.
    """

    def __init__(self, names: Mapping[str, str]):
        self.names = names

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


class Language:
    """How a function, its lines and its records are written."""

    names: ClassVar[Mapping[str, str]]  # of constants and functions that the language has
    own: ClassVar[Mapping[str, Mapping[str, str]]] = {}  # functions that it does in its own way

    def __init__(self) -> None:
        values = {name: repr(float(eval(text))) for name, text in _CONSTANTS.items()}
        self.words = _Words(values | dict(self.names))
        self.called = _called(self.own)

    def text(self, value: ast.expr) -> str:
        """An expression."""
        return ast.unparse(self.words.visit(deepcopy(value)))

    def functions(self) -> dict[str, str]:
        """Texts of all functions of languages.toml that callers see."""
        return {name: self.function(name, about) for name, about in FUNCTIONS.items()}

    def function(self, name: str, about: Mapping[str, str]) -> str:
        """Text of one of them."""
        tree = _written(name, about)
        given: dict[str, str] = {}  # record of each argument
        for argument in tree.args.args:
            said = ast.unparse(argument.annotation) if argument.annotation else argument.arg
            given[argument.arg] = said if said in RECORDS else ""
        inlined = _Inlined(self.called, [*given, *self.words.names])
        values: list[Value] = [
            [ast.Name(f"{argument}.{field}") for field in RECORDS[record]]
            if record
            else ast.Name(argument)
            for argument, record in given.items()
        ]
        returned = inlined.run(tree, values)
        lines, routine = self._begun(given), ""
        for of, variable, value in inlined.needed(returned):
            if of != routine:
                lines.append(self._comment(of))
            routine = of
            match value:
                case ast.Compare() | ast.BinOp(op=ast.BitAnd()):
                    lines.append(self._flag(variable, self.text(value)))
                case _:
                    lines.append(self._declared(variable, self.text(value)))
        record = about.get("record", "")
        lines += self._given_back(self._made(record, returned), record)
        wrapper = textwrap.TextWrapper(100, "    ", " " * 8)
        wrapper.break_long_words = wrapper.break_on_hyphens = False
        return self._whole(name, given, record, "\n".join(map(wrapper.fill, lines)))

    def _begun(self, given: Mapping[str, str]) -> list[str]:
        """First lines of a function."""
        raise NotImplementedError

    def _comment(self, text: str) -> str:
        return f"/* {text} */"

    def _flag(self, name: str, text: str) -> str:
        raise NotImplementedError

    def _declared(self, name: str, text: str) -> str:
        raise NotImplementedError

    def _made(self, record: str, value: Value) -> str:
        """What is returned: a number, or a record of its parts."""
        raise NotImplementedError

    def _given_back(self, text: str, record: str) -> list[str]:
        raise NotImplementedError

    def _whole(self, name: str, given: Mapping[str, str], record: str, body: str) -> str:
        """A function, of its arguments, what it returns and its lines."""
        raise NotImplementedError


class JavaScript(Language):
    """Members of an object."""

    names: ClassVar = {
        **{"inf": "Infinity", "nan": "NaN", "arctan": "Math.atan", "arctan2": "Math.atan2"},
        **{name: f"Math.{name}" for name in ("abs", "sqrt", "sin", "cos", "hypot")},
    }

    def _begun(self, given: Mapping[str, str]) -> list[str]:
        if "law" not in given:
            return []
        flags = [f'const by_{law} = law === "{law}";' for law in LAWS[:2]]
        return ["check(law);", *flags]

    def _flag(self, name: str, text: str) -> str:
        return self._declared(name, text)

    def _declared(self, name: str, text: str) -> str:
        return f"const {name} = {text};"

    def _made(self, record: str, value: Value) -> str:
        if not isinstance(value, list):
            return self.text(value)
        parts = (self._made("body", part) for part in value)
        pairs = zip(RECORDS[record], parts, strict=True)
        return f"{{ {', '.join(f'{field}: {part}' for field, part in pairs)} }}"

    def _given_back(self, text: str, record: str) -> list[str]:
        return [f"return {text};"]

    def _whole(self, name: str, given: Mapping[str, str], record: str, body: str) -> str:
        return f"{name}({', '.join(given)}) {{\n{body}\n}},"


class C(Language):
    """Functions and structs with a common prefix."""

    own: ClassVar = _TEXTS["c"]
    names: ClassVar = {
        **{
            "inf": "(double)INFINITY",
            "nan": "(double)NAN",
            "abs": "fabs",
            "arctan": "atan",
            "arctan2": "atan2",
        },
        **{name: f"{_PREFIX}{name}" for name in ("larger", "smaller", "product_error")},
        **{name: name for name in ("copysign", "sqrt", "sin", "cos", "hypot")},
    }

    def product_error(self) -> str:
        """Function that finds what a product lacks without a product and sum in one rounding."""
        plain = C()
        plain.called = _called({})
        return plain.function("product_error", _TEXTS["product_error"])

    def _begun(self, given: Mapping[str, str]) -> list[str]:
        laws = LAWS[:2] if "law" in given else ()
        return [f"const int by_{law} = law == {f'{_PREFIX}{law}'.upper()};" for law in laws]

    def _flag(self, name: str, text: str) -> str:
        return f"const int {name} = {text};"

    def _declared(self, name: str, text: str) -> str:
        return f"const double {name} = {text};"

    def _made(self, record: str, value: Value) -> str:
        if not isinstance(value, list):
            return self.text(value)
        parts = [self._made("body", part) for part in value]
        pairs = zip(RECORDS[record], parts, strict=True)
        regime = f"({_PREFIX}regime)"
        return f"{{{', '.join(regime * (field == 'regime') + part for field, part in pairs)}}}"

    def _given_back(self, text: str, record: str) -> list[str]:
        made = f"const {_PREFIX}{record} found = {text};"
        return [made, "return found;"] if record else [f"return {text};"]

    def _whole(self, name: str, given: Mapping[str, str], record: str, body: str) -> str:
        kinds = (f"{_PREFIX}{record}" if record else "double" for record in given.values())
        parts = ", ".join(f"{kind} {name}" for kind, name in zip(kinds, given, strict=True))
        parts = parts.replace("double law", f"{_PREFIX}law law")
        kind = f"{_PREFIX}{record}" if record else "double"
        return f"static inline {kind} {_PREFIX}{name}({parts}) {{\n{body}\n}}"


LANGUAGES: Mapping[str, tuple[type[Language], str]] = {
    "c": (C, "rod_impact.h.jinja"),
    "javascript": (JavaScript, "rod_impact.js.jinja"),
}


def source(language: str) -> str:
    """Text of the impact map in another language.

    Parameters
    ----------
    language : "c" (a C99 header) or "javascript" (a script)

    Raises
    ------
    ValueError
        If there is no such language.
    """
    if language not in LANGUAGES:
        raise ValueError(f"language must be one of {', '.join(LANGUAGES)}, got {language!r}")
    made, template = LANGUAGES[language]
    translated = made()
    environment = Environment(
        loader=PackageLoader(__package__), undefined=StrictUndefined, keep_trailing_newline=True
    )
    values: dict[str, Any] = {"records": RECORDS, "regimes": REGIMES, "laws": LAWS}
    return environment.get_template(template).render(
        language=translated, about=FUNCTIONS, **values, digest=files.digest()
    )
