"""The impact map as text in C99 and in JavaScript, translated from the generated Python.

`impact/_generated.py` and `impact/_kernel.py` are written in a small language: assignments, calls,
tuples, a choice of two numbers. So are the functions of `languages.toml`, which engines and pages
call. Here their syntax trees become functions of another language, line by line; no formula is
written a second time, and the order of operations, on which the last digit rests, stays.

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
    path(law, given)                                            -> impulse_path
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

All fields and arguments must be given. A law is "newton", "poisson" or "stronge" in JavaScript,
ROD_IMPACT_NEWTON and so on in C. A regime is one of INVALID = -1, NO_IMPACT = 0, SLIDE = 1,
SLIP_STICK = 2, SLIP_REVERSAL = 3: `rodImpact.Regime.SLIDE`, ROD_IMPACT_SLIDE.

`path`: in the plane of the impulse (P_x, P_z) over the mass the state goes from 0 in a straight
line, with P_x = -+friction P_z, to the point that `path` returns, and from there straight to
(P_x, P_z) of `collide`. With `mobilities` the contact velocity is slip + C P_x - B P_z and
normal + A P_z - B P_x all the way: zero slip and the end of compression are straight lines.
"""

import ast
import textwrap
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from importlib import resources
from typing import Any, ClassVar

from jinja2 import Environment, PackageLoader, StrictUndefined

from . import files
from .routines import CONSTANTS

_TEXTS = tomllib.loads(resources.files(__package__).joinpath("languages.toml").read_text("utf-8"))
RECORDS: Mapping[str, Mapping[str, str]] = _TEXTS["records"]
LAWS = "newton", "poisson", "stronge"
_CONSTANTS = {**CONSTANTS, "MOST_FRICTION": "2.0**500"}  # of bodies; beyond it nothing changes
_WIDTH = 100


@dataclass(frozen=True)
class Group:
    """Several values of one name; a record has a name of its own, and names for its values."""

    parts: tuple["Kind", ...]
    name: str = ""
    fields: tuple[str, ...] = ()


Kind = str | Group  # or "number", "flag", "law", "regime"
_PAIR = Group(("number", "number"))


def _record(name: str) -> Group:
    """A record as a group; a field named as a body is one."""
    special: dict[str, Kind] = {"regime": "regime"}
    if name == "pair_collision":
        special |= dict.fromkeys(("first", "second"), _record("body"))
    fields = tuple(RECORDS[name])
    return Group(tuple(special.get(field, "number") for field in fields), name, fields)


@dataclass(frozen=True)
class Function:
    """A function of the small language."""

    tree: ast.FunctionDef
    record: str = ""  # that it returns
    shown: bool = False  # to callers
    twofold: bool = False  # all its numbers are in twice the digits

    @property
    def name(self) -> str:
        """Name in Python."""
        return self.tree.name

    @property
    def arguments(self) -> list[str]:
        """Names of the arguments."""
        return [argument.arg for argument in self.tree.args.args]

    @property
    def lines(self) -> list[ast.Assign | ast.AnnAssign]:
        """Assignments."""
        return [line for line in self.tree.body if isinstance(line, ast.Assign | ast.AnnAssign)]

    @property
    def returned(self) -> ast.expr:
        """What it returns."""
        last = self.tree.body[-1]
        assert isinstance(last, ast.Return)
        assert last.value is not None
        return last.value

    @property
    def used(self) -> set[str]:
        """Names that are read."""
        names = (node for node in ast.walk(self.tree) if isinstance(node, ast.Name))
        return {node.id for node in names if isinstance(node.ctx, ast.Load)}

    @property
    def doc(self) -> str:
        """First sentence on what it does."""
        return (ast.get_docstring(self.tree) or "").partition("\n\n")[0].replace("\n", " ")


class _InTwiceTheDigits(ast.NodeTransformer):
    """Operations on numbers in twice the digits."""

    def visit_BinOp(self, node: ast.BinOp) -> ast.Call:
        left, right = self.visit(node.left), self.visit(node.right)
        match node.op:
            case ast.Mult():
                return _call("product_of", left, right)
            case ast.Sub():
                return _call("sum_of", left, _call("negative", right))
            case ast.Add():
                return _call("sum_of", left, right)
        raise ValueError(f"not in twice the digits: {ast.unparse(node)}")


def _call(name: str, *arguments: ast.expr) -> ast.Call:
    return ast.Call(ast.Name(name, ast.Load()), list(arguments), [])


def _parsed(text: str) -> Iterator[ast.FunctionDef]:
    yield from (node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef))


def _own(name: str, about: Mapping[str, Any]) -> ast.FunctionDef:
    """A function of languages.toml."""
    doc = f"{about['what']} {about.get('note', '')}".strip()
    body = f"'''{doc}'''\n{about['text'].strip()}\nreturn {about['returned']}"
    (tree,) = _parsed(f"def {name}({about['arguments']}):\n{textwrap.indent(body, '    ')}")
    return tree


def functions() -> list[Function]:
    """All functions, each after those that it calls."""
    texts = (path.read_text(encoding="utf-8") for path in (files.CLOSED_FORMS, files.KERNEL))
    found = [Function(tree) for text in texts for tree in _parsed(text)]
    known = {function.name: function.tree for function in found}
    for name, about in _TEXTS["functions"].items():
        tree = deepcopy(known[about["of"]]) if "of" in about else _own(name, about)
        tree.name = name
        if twofold := "twofold" in about:
            tree = _InTwiceTheDigits().visit(tree)
        record = about.get("record", "")
        found.append(Function(tree, record, bool(record) or "number" in about, twofold))
    return found


class _Kinds:
    """What kind of value each name and each expression is; one word means one thing."""

    def __init__(self, functions: Sequence[Function]):
        self.returned: dict[str, Kind] = {}
        self.functions = functions
        lines = [line for function in functions for line in function.lines]
        flags = (line for line in lines if _is_flag(line.value))
        self.flags = {
            ast.unparse(line.targets[0]) for line in flags if isinstance(line, ast.Assign)
        }
        self.groups = {
            name: group
            for function in functions
            for name, group in self._unpacked(function).items()
            if name in function.arguments
        }

    def _unpacked(self, function: Function) -> dict[str, Kind]:
        """Names that a function takes apart."""
        found: dict[str, Kind] = {}
        for line in function.lines:
            match line:
                case ast.Assign([ast.Tuple(parts)], ast.Name(name)):
                    found[name] = Group(tuple(self._plain(ast.unparse(part)) for part in parts))
        return found

    def _plain(self, name: str) -> Kind:
        return "flag" if name in self.flags else "number"

    def arguments(self, function: Function) -> dict[str, Kind]:
        """Kinds of a function's arguments."""
        unpacked = self._unpacked(function)
        found: dict[str, Kind] = {}
        for argument in function.tree.args.args:
            name = argument.arg
            said = ast.unparse(argument.annotation) if argument.annotation else name
            if said in RECORDS:
                found[name] = _record(said)
            elif name == "law":
                found[name] = "law"
            elif function.twofold:
                found[name] = _PAIR
            else:
                found[name] = unpacked.get(name) or self.groups.get(name) or self._plain(name)
        return found

    def of(self, node: ast.expr, known: Mapping[str, Kind]) -> Kind:
        """Kind of an expression, of names whose kinds are known."""
        match node:
            case ast.Name(name):
                return known.get(name, "number")
            case ast.Tuple(parts):
                return Group(tuple(self.of(part, known) for part in parts))
            case ast.Call(ast.Name("law")):
                return self.returned[LAWS[0]]
            case ast.Call(ast.Name(name)):
                return self.returned.get(name, "number")
        return "flag" if _is_flag(node) else "number"


def _is_flag(node: ast.expr | None) -> bool:
    match node:
        case ast.Compare() | ast.BinOp(op=ast.BitAnd()):
            return True
    return False


class _Words(ast.NodeTransformer):
    """Expressions with the names, numbers and choices of another language.

    What is no longer Python stands in them as a name, so that Python's own parentheses, which keep
    the order of operations, are printed around it.
    """

    def __init__(self, language: "Language"):
        self.language = language

    def visit_Name(self, node: ast.Name) -> ast.Name:
        return ast.Name(self.language.constants.get(node.id, node.id))

    def visit_Constant(self, node: ast.Constant) -> ast.Name:
        return ast.Name(repr(float(ast.unparse(node))))

    def visit_Call(self, node: ast.Call) -> ast.AST:
        assert isinstance(node.func, ast.Name)
        parts = [self.visit(argument) for argument in node.args]
        if node.func.id == "select":
            condition, first, second = map(ast.unparse, parts)
            return ast.Name(f"({condition} ? {first} : {second})")
        return ast.Call(ast.Name(self.language.called(node.func.id)), parts, [])


class Language:
    """How assignments, groups and functions are written."""

    own_constants: ClassVar[Mapping[str, str]]
    names: ClassVar[Mapping[str, str]]  # of functions that the language has

    def __init__(self) -> None:
        self.functions = functions()
        self.kinds = _Kinds(self.functions)
        values = {name: repr(float(eval(text))) for name, text in _CONSTANTS.items()}
        self.constants = values | dict(self.own_constants)

    def called(self, name: str) -> str:
        """Name of a function that others call."""
        return self.names.get(name, name)

    def text(self, node: ast.expr) -> str:
        """An expression."""
        return ast.unparse(_Words(self).visit(deepcopy(node)))

    def texts(self) -> tuple[list[str], list[str]]:
        """Functions that others call, and those that callers see."""
        inner: list[str] = []
        shown: list[str] = []
        for function in self.functions:
            (shown if function.shown else inner).append(self.function(function))
        return inner, shown

    def function(self, function: Function) -> str:
        """Text of a function."""
        known = self.kinds.arguments(function)
        head, lines = dict(known), []
        for line in function.lines:
            lines += self.assigned(line, known, function.used)
        kind = self.kinds.of(function.returned, known)
        if function.record:
            kind = _record(function.record)
        if not function.shown:
            self.kinds.returned[function.name] = kind
        lines += self._given_back(function.returned, kind)
        return self._whole(function, head, kind, lines)

    def assigned(self, line: ast.stmt, known: dict[str, Kind], used: set[str]) -> list[str]:
        """Lines of an assignment, whose names become known; what nothing reads is left out."""
        match line:
            case ast.AnnAssign(ast.Name(name), ast.Name(record), value=ast.Tuple() as value):
                known[name] = _record(record)
                return [self._declared(name, known[name], self._made(value, known[name]))]
            case ast.Assign([ast.Tuple(targets)], value):
                group = self.kinds.of(value, known)
                names = [target.id for target in targets if isinstance(target, ast.Name)]
                assert isinstance(group, Group)
                known |= zip(names, group.parts, strict=True)
                kept = [name if name in used else "" for name in names]
                return self._unpacked(kept, group, self.text(value)) if any(kept) else []
            case ast.Assign([ast.Name(name)], value):
                kind = known[name] = self.kinds.of(value, known)
                made = isinstance(value, ast.Tuple)
                text = self._made(value, kind) if made else self.text(value)
                return [self._declared(name, kind, text)] if name in used else []
        raise ValueError(f"not in the language: {ast.unparse(line)}")

    def _declared(self, name: str, kind: Kind, text: str) -> str:
        """A value with a name."""
        raise NotImplementedError

    def _made(self, node: ast.expr, kind: Kind) -> str:
        """A group, made of values."""
        raise NotImplementedError

    def _unpacked(self, names: Sequence[str], group: Group, text: str) -> list[str]:
        """A group, taken apart into those values that have a name."""
        raise NotImplementedError

    def _given_back(self, node: ast.expr, kind: Kind) -> list[str]:
        """Last lines of a function."""
        raise NotImplementedError

    def _whole(
        self, function: Function, head: Mapping[str, Kind], kind: Kind, lines: list[str]
    ) -> str:
        """A function, of its arguments, what it returns and its lines."""
        raise NotImplementedError


def _folded(lines: Sequence[str]) -> str:
    """Lines of a body, none too long."""
    wrapper = textwrap.TextWrapper(_WIDTH, "    ", " " * 8)
    wrapper.break_long_words = wrapper.break_on_hyphens = False
    return "\n".join(map(wrapper.fill, lines))


class JavaScript(Language):
    """Functions of arrays and objects."""

    own_constants: ClassVar = {"inf": "Infinity", "nan": "NaN"}
    names: ClassVar = {
        **{name: f"Math.{name}" for name in ("abs", "sqrt", "sin", "cos", "hypot")},
        **{"arctan": "Math.atan", "arctan2": "Math.atan2", "law": "restitutionOf(law)"},
    }

    def _declared(self, name: str, kind: Kind, text: str) -> str:
        return f"const {name} = {text};"

    def _made(self, node: ast.expr, kind: Kind) -> str:
        assert isinstance(node, ast.Tuple)
        assert isinstance(kind, Group)
        parts = list(map(self.text, node.elts))
        if not kind.fields:
            return f"[{', '.join(parts)}]"
        pairs = zip(kind.fields, parts, strict=True)
        return f"{{ {', '.join(a if a == b else f'{a}: {b}' for a, b in pairs)} }}"

    def _unpacked(self, names: Sequence[str], group: Group, text: str) -> list[str]:
        if not group.fields:
            return [f"const [{', '.join(names).rstrip(', ')}] = {text};"]
        pairs = zip(group.fields, names, strict=True)
        kept = [a if a == b else f"{a}: {b}" for a, b in pairs if b]
        return [f"const {{ {', '.join(kept)} }} = {text};"]

    def _given_back(self, node: ast.expr, kind: Kind) -> list[str]:
        text = self._made(node, kind) if isinstance(node, ast.Tuple) else self.text(node)
        return [f"return {text};"]

    def _whole(
        self, function: Function, head: Mapping[str, Kind], kind: Kind, lines: list[str]
    ) -> str:
        keyword = "" if function.shown else "function "
        text = f"{keyword}{function.name}({', '.join(head)}) {{\n{_folded(lines)}\n}}"
        return f"/** {function.doc} */\n{text}" + ("," if function.shown else "")


LANGUAGES: Mapping[str, tuple[type[Language], str]] = {
    "javascript": (JavaScript, "rod_impact.js"),
}


def source(language: str) -> str:
    """Text of the impact map in another language.

    Parameters
    ----------
    language : "c" (a C99 header) or "javascript" (a script; a module as well)
    """
    made, template = LANGUAGES[language]
    translated = made()
    inner, shown = translated.texts()
    environment = Environment(
        loader=PackageLoader(__package__), undefined=StrictUndefined, keep_trailing_newline=True
    )
    (digest,) = (
        line.split('"')[1]
        for line in files.CLOSED_FORMS.read_text(encoding="utf-8").splitlines()
        if line.startswith("DIGEST")
    )
    return environment.get_template(f"{template}.jinja").render(
        inner="\n\n".join(inner),
        shown="\n\n".join(shown),
        digest=digest,
        records=RECORDS,
        laws=LAWS,
        regimes={"INVALID": -1, "NO_IMPACT": 0, "SLIDE": 1, "SLIP_STICK": 2, "SLIP_REVERSAL": 3},
    )
