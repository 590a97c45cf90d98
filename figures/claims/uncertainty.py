"""A measured number with its error; how errors of arrays carry over to what is made of them."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

MEASURES: dict[str, tuple[Callable, str]] = {}  # of a claim: a function, the figure that it takes


class Number(NamedTuple):
    """A measured value: nan if there is no data, inf where what was looked for never happens.

    Notions of the error: standard error; the change if the step is halved; half the interval of the
    grid in which the value lies. A count and an exact value have none.
    """

    value: float
    error: float = np.nan
    notion: str = "exact"


Numbers = dict[str, Number | Callable]  # of a claim, by their keys


def measures(claim: str, figure: str = "") -> Callable[[Callable], Callable]:
    """Register a function that returns `Numbers` of a claim by their keys.

    Parameters
    ----------
    claim : as "S13"
    figure : whose data the function takes; it may return functions of them, which are `resampled`;
        without one it takes `evidence.Evidence`
    """

    def register(function: Callable) -> Callable:
        assert claim not in MEASURES
        MEASURES[claim] = function, figure
        return function

    return register


def count(value: float) -> Number:
    """A number of things, or a share of them: without error."""
    return Number(value, notion="count")


def standard(value: float, error: float) -> Number:
    """A value with its standard error."""
    return Number(value, error, "standard error")


def entry(d: Mapping, name: str, at: Any) -> Number:
    """An entry of an array with its standard error; `at`: its index."""
    return standard(d[name][at], d[f"{name}_error"][at])


class _Watched(dict):
    """The entries of another dictionary that have been read."""

    def __init__(self, given: Mapping):
        self.given = given

    def __missing__(self, name: str) -> np.ndarray:
        return self.setdefault(name, self.given[name])


def resampled(d: Mapping, function: Callable[[Mapping], float]) -> Number:
    """Value of `function(d)`; its spread as the arrays that it reads vary within their errors.

    The error is nan where an error is not known, or a value is not there in each of the draws.

    Parameters
    ----------
    d : arrays; the standard errors of `name`, if it has any, are `name_error`
    function : of such a dictionary
    """
    random, watched, found = np.random.default_rng(1), _Watched(d), []
    value = function(watched)
    names = [name for name in watched if f"{name}_error" in d]
    for _ in range(200):
        moved = {name: random.normal(d[name], d[f"{name}_error"]) for name in names}
        found.append(function({**d, **moved}))
    return standard(value, float(np.std(found)) if np.isfinite(found).all() else np.nan)


def onset(x: np.ndarray, begun: np.ndarray) -> Number:
    """Place on a grid of Gamma from which on `begun` is true; below Gamma = 1 nothing moves."""
    if not begun[-1]:
        return Number(np.inf, notion="half interval")
    j = np.max(np.flatnonzero(~begun), initial=-1) + 1
    low, high = np.append(1.0, x)[j : j + 2]
    return Number((low + high) / 2, (high - low) / 2, "half interval")


def crossing(x: np.ndarray, y: np.ndarray, level: float) -> float:
    """Place between two points at which `y` first falls below a level; inf if it never does."""
    below = np.flatnonzero(y < level)
    if not below.size:
        return np.inf
    ends = [below[0], max(below[0] - 1, 0)]
    return np.interp(level, y[ends], x[ends])


def among(number: Number, places: np.ndarray) -> Number:
    """Number that is one of some places: half the way to the next ones is a part of its error."""
    apart = np.sort(np.abs(places - number.value))[1:3].mean() / 2
    return number._replace(error=np.hypot(number.error, apart))


def peak(d: Mapping, x: str, y: str) -> Number:
    """Place `d[x]` of the largest value of `d[y]`, with its error."""
    return among(resampled(d, lambda d: d[x][d[y].argmax()]), d[x])


def exponents(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """d ln y/d ln x between neighbouring points; nan where y is not positive."""
    with np.errstate(all="ignore"):
        found = np.diff(np.log(y)) / np.diff(np.log(x))
    return np.where(np.isfinite(found), found, np.nan)


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return np.sqrt(np.mean(values**2))


def off_line(x: np.ndarray, y: np.ndarray) -> float:
    """Root-mean-square distance of the points from the best straight line."""
    return rms(np.polyval(np.polyfit(x, y, 1), x) - y)


def bend(x: np.ndarray, y: np.ndarray) -> float:
    """Root-mean-square distance from the best straight line, over the mean of the points."""
    return off_line(x, y) / y.mean()
