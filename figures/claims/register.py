"""The register of what measures the claims, and what those functions share."""

from collections.abc import Callable, Iterator
from functools import cache

import numpy as np

from md.sweep import Sweep

from .. import load
from ..lib import runs as rows
from .number import Number

CLEAR = 3.0  # standard errors

MEASURES: dict[str, tuple[tuple[str, ...], Callable[[bool], Iterator[Number]]]] = {}


def measures(claim: str, *keys: str):
    """Register a function that yields the numbers of a claim in the order of its keys."""

    def register(function):
        MEASURES[claim] = keys, function
        return function

    return register


@cache
def table(figure: str, quick: bool) -> dict[str, np.ndarray]:
    """Data of a figure."""
    return load(figure).data(quick=quick)


def over(sweep: Sweep, **names: str) -> dict[str, np.ndarray]:
    """Means over the seeds of the results of that name."""
    return rows.means(rows.computed(sweep), names)
