"""Arguments of every public function: domains, labels, dtypes, evaluation in blocks.

A scalar outside its domain raises; inside an array such an element becomes nan. A nan, or an
infinity where none is allowed, gives nan everywhere and never raises. Arrays are paired by
position: labels (pandas, xarray) that say otherwise raise, equal ones are dropped.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import IntEnum
from functools import cache, reduce
from html import escape
from itertools import combinations
from operator import index
from typing import Any, NamedTuple, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

LARGE = 2**22 - 2**10  # numbers, just below 32 MiB: the largest block from which glibc learns
T = TypeVar("T")
Number = TypeVar("Number", covariant=True)  # of a field: float or `Numbers`
Code = TypeVar("Code", covariant=True)  # `Regime` or `Codes`
Numbers: TypeAlias = NDArray[np.float64]
Codes: TypeAlias = NDArray[np.int8]
BLOCK = 8192  # elements in flight; a block's temporaries stay in the second-level cache


class InputError(ValueError, TypeError):
    """Error for an argument that is refused; the message names it, its value and its domain.

    Both a `ValueError` and a `TypeError`, so that either catches it.
    """

    exit_code = 2  # of a command that it ends


def _texts(result: Any) -> list[tuple[str, str]]:
    """Fields of a named tuple as text: numbers with six digits, of long arrays the ends."""
    with np.printoptions(threshold=6, edgeitems=2, precision=6):
        return [
            (name, f"{value:.6g}" if isinstance(value, float | np.floating) else f"{value!r}")
            for name, value in result._asdict().items()
        ]


def _brief(result: Any) -> str:
    fields = ", ".join(f"{name}={text}" for name, text in _texts(result))
    return f"{type(result).__name__}({fields})"


def _table(result: Any) -> str:
    rows = (f"<tr><td>{name}</td><td>{escape(text)}</td></tr>" for name, text in _texts(result))
    return f"<table>{''.join(rows)}</table>"


def shown(kind: type[T]) -> type[T]:
    """Decorate a named tuple: it is shown in one line as text, and as a table in a notebook."""
    kind.__repr__ = _brief  # type: ignore[method-assign]
    kind._repr_html_ = _table  # type: ignore[attr-defined]
    return kind


def typed_as(other: T) -> Callable[[Any], T]:
    """Decorate a function with the type of another one, of the same arguments and results."""
    return lambda function: function


class Domain(NamedTuple):
    """Smallest and largest permitted value, and text for messages."""

    low: float
    high: float
    text: str

    def holds(self, value: np.ndarray) -> np.ndarray:
        """Whether each value lies in the domain; a nan does not."""
        return (value >= self.low) & (value <= self.high)


LARGEST = np.finfo(np.float64).max  # the largest number that is not infinite
SMALLEST = np.nextafter(0.0, 1.0)  # the smallest number > 0
RIGHT = float(np.float32(np.pi / 2))  # right angle in single precision, larger than in double
ANY = Domain(-LARGEST, LARGEST, "any finite number")
POSITIVE = Domain(SMALLEST, LARGEST, "> 0")
DOMAINS = {  # by the name of an argument or of a field; all others have `ANY`
    "friction": Domain(0.0, np.inf, ">= 0"),
    "restitution": Domain(0.0, 1.0, "between 0 and 1"),
    "tilt": Domain(-RIGHT, RIGHT, "between -pi/2 and pi/2"),
    "mass": Domain(SMALLEST, np.inf, "> 0 (inf: keeps its velocity and spin)"),
    "gamma": Domain(np.nextafter(1.0, 2.0), 1e6, "> 1, which throws a rod up, and at most 1e6"),
    "shortest_flight": Domain(1e-12, 0.1, "between 1e-12 and 0.1 (periods)"),
    **dict.fromkeys(("k", "length", "diameter", "approach_ratio", "fall_speed"), POSITIVE),
}

Labels: TypeAlias = Sequence[tuple[Any, Any]]  # dimension and index of each axis, or None
_PLAIN = {float, int, np.float64, np.ndarray}


class Labelled(np.ndarray):
    """Array that remembers the labels of the arguments it was computed from."""

    labels: Labels = ()


def labels_of(value: Any) -> Labels:
    """Labels of a pandas or xarray object, recognised without importing either; else empty."""
    if isinstance(value, Labelled):
        return value.labels
    if getattr(value, "dims", None) is not None:
        indexes = getattr(value, "indexes", {})
        return [(dimension, indexes.get(dimension)) for dimension in value.dims]
    return [(None, index) for index in getattr(value, "axes", None) or ()]


def _refuse_unlike(values: Mapping[str, Any]) -> None:
    """Raise `InputError` if two labelled arguments would be paired against their labels.

    Axes are paired as NumPy pairs them, from the last.
    """
    labelled = [(name, labels_of(value)[::-1]) for name, value in values.items()]
    for (one, axes), (other, axes_) in combinations(labelled, 2):
        for (name, labels), (name_, labels_) in zip(axes, axes_, strict=False):
            if None not in (name, name_) and name != name_:
                unlike = name, name_
            elif labels is not None and labels_ is not None and not labels.equals(labels_):
                unlike = list(labels), list(labels_)
            else:
                continue
            raise InputError(
                f"{one} and {other} must have equal labels, got {unlike[0]!r:.60} where the other "
                f"has {unlike[1]!r:.60}; align them, or pass plain arrays"
            )


def fields_of(name: str, value: Any, kind: Any) -> dict[str, Any]:
    """Fields of a named tuple by names as `geometry.k`; raises `InputError` for anything else."""
    fields = kind._fields
    if not isinstance(value, tuple | list | np.ndarray) or len(value) != len(fields):
        raise InputError(f"{name} must be ({', '.join(fields)}), got {value!r}")
    return {f"{name}.{field}": part for field, part in zip(fields, value, strict=True)}


def domain_of(name: str) -> Domain:
    """Domain of an argument, or of a field as `geometry.k`, by its name."""
    return DOMAINS.get(name.rpartition(".")[2], ANY)


def real_array(name: str, value: Any, domain: Domain = ANY) -> np.ndarray:
    """A value as a real array; a scalar outside the domain raises `InputError`.

    Masked elements count as nan. Anything but a real number raises.
    """
    if isinstance(value, np.ma.MaskedArray):
        value = np.ma.filled(value.astype(np.result_type(value.dtype, np.float32)), np.nan)
    try:
        array = np.asarray(float(value) if type(value) is int else value)
    except (ValueError, OverflowError):  # ragged, or an integer beyond all floats
        array = None
    if array is None or array.dtype.kind not in "biuf":
        raise InputError(f"{name} must be a real number or an array of them, got {value!r}")
    if array.ndim == 0 and np.isfinite(array) and not domain.holds(array):
        raise InputError(f"{name} must be {domain.text}, got {value!r}")
    return array


def real_arrays(
    arguments: Mapping[str, Any], domains: Iterable[Domain]
) -> tuple[list[np.ndarray], np.dtype]:
    """Arguments of a call as real arrays, and the dtype of the results.

    It is float32 if the arguments are, where Python's numbers and float64 scalars do not count;
    else float64. Arguments that do not broadcast, and labelled ones whose labels differ, raise
    `InputError`.
    """
    values = list(arguments.values())
    if not _PLAIN.issuperset(map(type, values)):
        _refuse_unlike(arguments)
    arrays = [real_array(*given) for given in zip(arguments, values, domains, strict=True)]
    try:
        np.broadcast(*arrays)
    except ValueError:
        shapes = (f"{name} {x.shape}" for name, x in zip(arguments, arrays, strict=True) if x.ndim)
        raise InputError(f"arguments must broadcast, got {', '.join(shapes)}") from None
    kinds = {np.asarray(value).dtype for value in values if not isinstance(value, int | float)}
    single = kinds and np.result_type(*kinds) == np.float32
    return arrays, np.dtype(np.float32 if single else np.float64)


def number(name: str, value: Any) -> float:
    """`value` as one number in the domain of its name; a nan is refused."""
    domain = domain_of(name)
    array = real_array(name, value, domain)
    if array.ndim or not domain.holds(array):
        raise InputError(f"{name} must be one number, {domain.text}, got {value!r}")
    return float(array)


def count(name: str, value: Any, least: int) -> int:
    """`value` as one whole number, at least `least`."""
    try:
        whole = index(value)
    except TypeError:
        raise InputError(f"{name} must be a whole number, got {value!r}") from None
    if whole < least:
        raise InputError(f"{name} must be at least {least}, got {value!r}")
    return whole


def evaluated(
    function: Callable[..., tuple[Any, ...]],
    arguments: Mapping[str, Any],
    kinds: Sequence[type[IntEnum] | None] = (None,),
    **special: Domain,
) -> tuple[Any, ...]:
    """Results of a function of broadcast arguments; nan, or -1, where one is out of its domain.

    Parameters
    ----------
    function : of blocks of float64, in the order of `arguments`; returns one array for each kind
    arguments : by name
    kinds : of the results: an enumeration for codes, as int8, or as its member for a single one;
        None for numbers, as float64, or as float32 if the arguments are
    special : domains of some arguments, instead of those of their names
    """
    domains = [special.get(name, domain_of(name)) for name in arguments]
    arrays, dtype = real_arrays(arguments, domains)

    def block(*values: Any) -> tuple[Any, ...]:
        parts = function(*values)
        held = (domain.holds(value) for domain, value in zip(domains, values, strict=True))
        valid = reduce(np.logical_and, held)
        if np.all(valid):
            return parts
        invalid = [-1 if kind else np.nan for kind in kinds]
        return tuple(np.where(valid, *pair) for pair in zip(parts, invalid, strict=True))

    results = _in_blocks(block, arrays, [np.dtype(np.int8) if kind else dtype for kind in kinds])
    return tuple(
        kind(int(result)) if kind and np.ndim(result) == 0 else result
        for kind, result in zip(kinds, results, strict=True)
    )


@cache
def _keep_memory() -> None:
    """Make and drop a large array, so that glibc keeps the memory of a block for the next one.

    By itself glibc gives the memory back to the system and takes it again page by page, which is
    half of a call's time.
    """
    np.empty(LARGE)


def _in_blocks(
    function: Callable[..., tuple[np.ndarray, ...]],
    inputs: Sequence[np.ndarray],
    dtypes: Sequence[np.dtype],
) -> tuple[Any, ...]:
    """Broadcast `inputs` and apply `function` block by block, in float64, without warnings.

    `dtypes` belong to the results; beside them a few blocks are in memory. Scalars stay scalars, so
    that a term common to all elements is computed once a block; scalars alone give scalars.
    """
    _keep_memory()
    arrays = [value for value in inputs if value.ndim > 0]
    read_only: list[Any] = [["readonly"]] * len(arrays)
    made: list[Any] = [["writeonly", "allocate"]] * len(dtypes)
    with np.errstate(all="ignore"):
        numbers = [value.astype(np.float64)[()] if value.ndim == 0 else None for value in inputs]
        if not arrays:
            results = zip(function(*numbers), dtypes, strict=True)
            return tuple(np.asarray(value).astype(dtype)[()] for value, dtype in results)
        blocks = np.nditer(
            [*arrays, *[None] * len(dtypes)],
            flags=["external_loop", "buffered", "zerosize_ok"],
            op_flags=read_only + made,
            op_dtypes=[np.dtype(np.float64)] * len(arrays) + list(dtypes),
            casting="unsafe",
            buffersize=BLOCK,
        )
        with blocks:
            for chunk in blocks:
                read = iter(chunk[: len(arrays)])
                block = [next(read) if number is None else number for number in numbers]
                for target, values in zip(chunk[len(arrays) :], function(*block), strict=True):
                    target[...] = values
            return tuple(blocks.operands[len(arrays) :])
