"""Quick data of figures, computed once for all tests of a process."""

from functools import cache

import numpy as np

import figures


@cache
def data(name: str) -> dict[str, np.ndarray]:
    """Data of a figure in the small size; tests must not change them."""
    return figures.load(name).data(quick=True)
