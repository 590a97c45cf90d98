"""Numbers with errors, made of arrays with errors."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .law_numbers import rms


class Number(NamedTuple):
    """A measured value: nan if there is no data, inf where what was looked for never happens.

    Notions of the error: standard error; the change if the step is halved; half the interval of the
    grid in which the value lies. A count and an exact value have none.
    """

    value: float
    error: float = np.nan
    notion: str = "exact"


def count(value: float) -> Number:
    return Number(value, notion="count")


def standard(value: float, error: float) -> Number:
    return Number(value, error, "standard error")


def resampled(d: dict, function: Callable[[dict], float], *names: str) -> Number:
    """What a function makes of `d`; its spread as `names` vary within their standard errors."""
    random = np.random.default_rng(1)

    def varied() -> dict:
        return {n: random.normal(d[n], np.nan_to_num(d[f"{n}_error"])) for n in names}

    found = [function({**d, **varied()}) for _ in range(200)]
    return standard(function(d), float(np.std(found)) if np.isfinite(found).all() else np.nan)


def onset(x: np.ndarray, begun: np.ndarray) -> Number:
    """Where on a grid of Gamma it begins for good; below 1 nothing moves."""
    if not begun[-1]:
        return Number(np.inf, notion="half interval")
    j, x = np.max(np.flatnonzero(~begun), initial=-1) + 1, np.append(1.0, x)
    return Number((x[j] + x[j + 1]) / 2, (x[j + 1] - x[j]) / 2, "half interval")


def off_line(x: np.ndarray, y: np.ndarray) -> float:
    """Root-mean-square distance from the straight line."""
    return rms(np.polyval(np.polyfit(x, y, 1), x) - y)
