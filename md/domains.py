"""Values checked against their types and domains, parts as tables, and the errors of this package.

A message names key, value and what is allowed. A command foresees the two errors; any other is a
mistake of this package.
"""

import html
import re
from collections.abc import Mapping
from dataclasses import is_dataclass
from functools import cache, partial
from math import inf
from operator import index
from types import NoneType
from typing import Any, Literal, get_args, get_origin, get_type_hints

import numpy as np


class InputError(ValueError, TypeError):
    """Error for a refused argument, key or file; the message names it, its value and its domain.

    Both a `ValueError` and a `TypeError`, so that either catches it.
    """

    exit_code = 2  # of the command that it ends


class RunError(RuntimeError):
    """Error for a run that cannot go on; `state` is the last good one.

    For one impact it is the rod's row of the array that it is for many rods, `Result.rods`.
    """

    exit_code = 1  # of the command that it ends

    def __init__(self, message: str, state: Any = ()):
        super().__init__(message)
        self.state = state


def number(name: str, value: Any, low: float, high: float, domain: str = "") -> float:
    """`value` as a float in [low, high]; `domain` says in words what is allowed."""
    try:
        if isinstance(value, bool | np.bool_ | str | bytes):
            raise TypeError
        found = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{name} must be a number, got {value!r}") from None
    if not low <= found <= high:
        raise InputError(f"{name} must be {domain or _between(low, high)}, got {value!r}")
    return found


# Functions of name and value.
positive = partial(number, low=5e-324, high=1.7e308, domain="> 0 and finite")
not_negative = partial(number, low=0.0, high=1.7e308, domain=">= 0 and finite")
finite = partial(number, low=-1.7e308, high=1.7e308, domain="finite")


def whole(name: str, value: object, low: int, high: int) -> int:
    """`value` as an int in [low, high]."""
    try:
        if isinstance(value, bool):
            raise TypeError
        found = index(value)  # type: ignore[arg-type]
    except TypeError:
        raise InputError(f"{name} must be a whole number, got {value!r}") from None
    if not low <= found <= high:
        raise InputError(f"{name} must be {_between(low, high)}, got {value!r}")
    return found


def listed(value: Any) -> list | None:
    """Values of a list, tuple, range or array as Python's own numbers; None for anything else."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if not isinstance(value, list | tuple | range):
        return None
    return [x.item() if isinstance(x, np.generic) else x for x in value]


def tabled(name: str, value: Any, needed: tuple[str, ...], also: tuple[str, ...] = ()) -> Mapping:
    """`value` as a table that has all keys of `needed`, and else at most keys of `also`."""
    if not isinstance(value, Mapping):
        raise InputError(f"{name} must be a table, got {value!r}")
    for key in value:
        if key not in needed + also:
            raise InputError(f"{key} is not a key of {name}; known: {', '.join(needed + also)}")
    if not {*needed} <= set(value):
        raise InputError(f"{name} must have {', '.join(needed)}, got {value!r}")
    return value


def span(name: str, table: Mapping) -> tuple[float, float, bool]:
    """Ends of a range of numbers, and whether its numbers are evenly spaced in log.

    Parameters
    ----------
    name : of the table, for messages
    table : with from, to, and log if it is not false
    """
    log = held(f"{name}.log", table.get("log", False), bool)
    limited = positive if log else finite
    return limited(f"{name}.from", table["from"]), limited(f"{name}.to", table["to"]), log


def held(name: str, value: Any, hint: Any) -> Any:
    """`value` checked against a hint: class, `Literal`, `Annotated[float, low, high]` or None."""
    kind, *allowed = get_args(hint) or (hint,)
    if NoneType in allowed:
        return None if value is None else held(name, value, kind)
    if get_origin(hint) is Literal:
        if not isinstance(value, str) or value not in get_args(hint):
            raise InputError(f"{name} must be {' or '.join(get_args(hint))}, got {value!r}")
        return str(value)
    if kind in (int, float):
        return (whole if kind is int else number)(name, value, *allowed)
    if kind is bool and isinstance(value, np.bool_):
        return bool(value)
    if not isinstance(value, kind):
        wanted = "true or false" if kind is bool else f"of the type {kind.__name__}"
        raise InputError(f"{name} must be {wanted}, got {value!r}")
    return value


# Type hints of a class, by the names of its fields.
hints = cache(partial(get_type_hints, include_extras=True))


def in_notebook(thing: object) -> str:
    """HTML of a thing for a notebook: its text; a class takes it as `_repr_html_`."""
    return f"<pre>{html.escape(str(thing))}</pre>"


class Part:
    """Base of the parts of a scene: checks all fields against their types and domains."""

    def __post_init__(self) -> None:
        kind: Any = type(self)
        key = getattr(kind, "KEY", f"{kind.__name__.lower()}.")
        for name, hint in hints(kind).items():
            object.__setattr__(self, name, held(f"{key}{name}", getattr(self, name), hint))


def as_dict(part: Any) -> Any:
    """A scene, or a part, as plain dictionaries; absent parts are left out."""
    if is_dataclass(part):
        values = vars(part)
    elif hasattr(part, "_asdict"):
        values = part._asdict()
    else:
        return part
    return {name: as_dict(value) for name, value in values.items() if value is not None}


def flat(tables: Mapping, prefix: str = "") -> dict[str, Any]:
    """Nested tables as one table with dotted names."""
    found: dict[str, Any] = {}
    for key, value in tables.items():
        if isinstance(value, dict):
            found |= flat(value, f"{prefix}{key}.")
        else:
            found[f"{prefix}{key}"] = value
    return found


def _between(low: float, high: float) -> str:
    ends = [
        f"{x}" if isinstance(x, int) else re.sub(r"e\+?(-?)0?", r"e\1", f"{x:g}")
        for x in (low, high)
    ]
    return f">= {ends[0]}" if high == inf else f"between {ends[0]} and {ends[1]}"
