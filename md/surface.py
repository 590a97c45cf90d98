"""A result as a function of parameters, from its values at some points."""

from itertools import combinations_with_replacement

import numpy as np

_DEGREES = 3, 2, 1  # of the polynomials that are tried
ENOUGH = 1.5  # points a coefficient that a polynomial needs


class Surface:
    """A polynomial of coordinates within -1 and 1, fitted to a result.

    Its degree is the one with which each point is best told from the others.

    Parameters
    ----------
    places : (n, coordinates)
    results : (n,)
    """

    def __init__(self, places: np.ndarray, results: np.ndarray) -> None:
        found = []
        for degree in _DEGREES:
            terms = _terms(places, degree)
            if degree == 1 or len(results) >= ENOUGH * terms.shape[1]:
                inverse = np.linalg.pinv(terms)
                left = 1 - np.einsum("ij,ji->i", terms, inverse)
                off = (results - terms @ (inverse @ results)) / np.maximum(left, 1e-9)
                found.append((float(np.sqrt(np.mean(off**2))), degree, inverse))
        self.scatter, self.degree, inverse = min(found, key=lambda one: one[0])
        self.weights, self.spread = inverse @ results, inverse @ inverse.T

    def __call__(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values and their variances, (n,) each.

        Parameters
        ----------
        places : (n, coordinates)
        """
        terms = _terms(places, self.degree)
        variance = self.scatter**2 * np.einsum("ij,jk,ik->i", terms, self.spread, terms)
        return terms @ self.weights, variance


def _terms(places: np.ndarray, degree: int) -> np.ndarray:
    """Products of up to `degree` coordinates, a column each."""
    n, k = places.shape
    powers = [c for d in range(1, degree + 1) for c in combinations_with_replacement(range(k), d)]
    return np.column_stack([np.ones(n), *(places[:, list(c)].prod(axis=1) for c in powers)])
