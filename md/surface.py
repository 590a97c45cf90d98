"""A result as a function of parameters, from its values at some points."""

from collections.abc import Callable
from itertools import combinations_with_replacement

import numpy as np

_DEGREES = 3, 2, 1  # of the polynomials that are tried
ENOUGH = 1.5  # points a coefficient that a polynomial needs
_STEPS = 300  # of draws, of which the first half is forgotten


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
        variance = self.scatter**2 * np.sum(terms @ self.spread * terms, axis=1)
        return terms @ self.weights, variance


def _terms(places: np.ndarray, degree: int) -> np.ndarray:
    """Products of up to `degree` coordinates, a column each."""
    n, k = places.shape
    powers = [c for d in range(1, degree + 1) for c in combinations_with_replacement(range(k), d)]
    return np.column_stack([np.ones(n), *(places[:, list(c)].prod(axis=1) for c in powers)])


def draws(
    misfit: Callable[[np.ndarray], np.ndarray], walkers: np.ndarray, random: np.random.Generator
) -> np.ndarray:
    """Places within -1 and 1 drawn with weights exp(-misfit/2), (n, coordinates).

    Each walker moves along the line to another one, so that a ridge needs no smaller moves
    (Goodman and Weare, Commun. Appl. Math. Comput. Sci. 5, 65, 2010).

    Parameters
    ----------
    misfit : of places, (n, coordinates) to (n,)
    walkers : (an even number, coordinates), where they begin
    random : source of random numbers
    """
    places, now, found = walkers.copy(), misfit(walkers), []
    half, dimensions = len(walkers) // 2, walkers.shape[1]
    first, second = slice(None, half), slice(half, None)
    for step in range(_STEPS):
        for moving, others in ((first, second), (second, first)):
            stretch = (1 + random.random(half)) ** 2 / 2
            ends = random.permutation(places[others])
            moved = ends + stretch[:, None] * (places[moving] - ends)
            then = np.where((np.abs(moved) <= 1).all(axis=1), misfit(moved), np.inf)
            odds = (dimensions - 1) * np.log(stretch) + (now[moving] - then) / 2
            taken = np.log(random.random(half)) < odds
            places[moving][taken], now[moving][taken] = moved[taken], then[taken]
        if step < _STEPS // 2 and step % 25 == 0:  # out of lesser minima
            lost = now > max(np.median(now), now.min() + 25)
            other = random.choice(np.flatnonzero(~lost), lost.sum())
            places[lost], now[lost] = places[other], now[other]
        if step >= _STEPS // 2 and step % 10 == 0:
            found.append(places.copy())
    return np.concatenate(found)
