"""Results as functions of parameters, from their values at some points, and draws from a misfit."""

from collections.abc import Callable
from itertools import combinations_with_replacement

import numpy as np
from emcee import EnsembleSampler, State
from scipy.stats import qmc

_DEGREES = 3, 2, 1  # of the polynomials that are tried
ENOUGH = 1.5  # points a coefficient that a polynomial needs
_SAMPLES, _WALKERS = 2**12, 2**8  # places, and how many of the best are where walkers begin
_WARM_UPS, _WARM_UP, _STEPS = 6, 25, 150  # steps before draws, and of draws
_THIN = 10  # steps from draw to draw
_AS_GOOD = 10.0  # more misfit than the best point has: it may be chance


class Surface:
    """A polynomial of coordinates within -1 and 1, fitted to a result.

    Its degree is the one with which each point is best told from the others. It may be off at any
    place by as much as it misses these points then: how far a result is from a polynomial does not
    average out, and what else scatters them is not told from that.

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
        variance = self.scatter**2 * (1 + np.sum(terms @ self.spread * terms, axis=1))
        return terms @ self.weights, variance


def _terms(places: np.ndarray, degree: int) -> np.ndarray:
    """Products of up to `degree` coordinates, a column each."""
    n, k = places.shape
    powers = [c for d in range(1, degree + 1) for c in combinations_with_replacement(range(k), d)]
    return np.column_stack([np.ones(n), *(places[:, list(c)].prod(axis=1) for c in powers)])


def misfit_of(limits: np.ndarray, results: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Sum over the targets of the squared distances from their limits, in errors.

    Parameters
    ----------
    limits : (targets, 3): lower limit, upper limit, error; an error of nan: it does not count
    results : (..., targets)
    variance : of the results, as far as it is not in the error of the limits
    """
    low, high, error = limits.T
    off = np.maximum(np.maximum(low - results, results - high), 0)
    return np.sum(np.where(np.isnan(error), 0, off**2 / (error**2 + variance)), axis=-1)


class Fit:
    """Surfaces of all targets, and the misfit that follows from them.

    Parameters
    ----------
    places : (n, coordinates), within -1 and 1
    results : (n, targets)
    limits : (targets, 3): lower limit, upper limit, error
    """

    def __init__(self, places: np.ndarray, results: np.ndarray, limits: np.ndarray) -> None:
        self.surfaces, self.limits = [Surface(places, column) for column in results.T], limits
        self.errors = np.where(limits[:, 0] == limits[:, 1], limits[:, 2], np.inf)
        self.coordinates = places.shape[1]

    def __call__(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Results and their variances, (n, targets) each, and the misfits, (n,).

        Parameters
        ----------
        places : (n, coordinates)
        """
        results, variances = np.array([s(places) for s in self.surfaces]).transpose(1, 2, 0)
        return results, variances, misfit_of(self.limits, results, variances)

    def unlikely(self, places: np.ndarray) -> np.ndarray:
        """The misfit, and more where little is known, which would fit anything, (n,).

        Parameters
        ----------
        places : (n, coordinates)
        """
        _, variances, misfits = self(places)
        return misfits + np.log1p(variances / self.errors**2).sum(axis=1)

    def draw(self, seed: int) -> np.ndarray:
        """Places as likely as the data leave them, (n, coordinates).

        Parameters
        ----------
        seed : of the random numbers
        """
        return draws(self.unlikely, self.coordinates, seed)


def box_around(parts: np.ndarray, misfits: np.ndarray) -> np.ndarray:
    """Lowest and highest parts of the best quarter of the points, and the gaps around them.

    Points that are as good as the best one belong to it, however many they are.
    """
    few = max(len(parts) // 4, 2 * (parts.shape[1] + 1), np.sum(misfits < misfits.min() + _AS_GOOD))
    near = parts[np.argsort(misfits)[:few]]
    low, high = near.min(axis=0), near.max(axis=0)
    gap = max(0.1, 2 / len(near)) * (high - low)
    ends = [
        np.where(parts < low, parts, 0).max(axis=0),
        np.where(parts > high, parts, 1).min(axis=0),
    ]
    return np.clip([np.minimum(low - gap, ends[0]), np.maximum(high + gap, ends[1])], 0, 1 - 1e-12)


def draws(misfit: Callable[[np.ndarray], np.ndarray], coordinates: int, seed: int) -> np.ndarray:
    """Places within -1 and 1 drawn with weights exp(-misfit/2), (n, coordinates).

    By emcee's stretch move, which needs no smaller moves along a ridge (Goodman and Weare, Commun.
    Appl. Math. Comput. Sci. 5, 65, 2010). Walkers begin at the best of evenly spread places; before
    draws begin, those that are held in lesser minima go to where others are.

    Parameters
    ----------
    misfit : of places, (n, coordinates) to (n,)
    coordinates : their number
    seed : of the random numbers
    """

    def log_weight(places: np.ndarray) -> np.ndarray:
        return np.where((np.abs(places) <= 1).all(axis=1), -misfit(places) / 2, -np.inf)

    samples = 2 * qmc.Sobol(coordinates, seed=seed).random(_SAMPLES) - 1
    best = samples[np.argsort(misfit(samples))[:_WALKERS]]
    random, begin = np.random.default_rng(seed), np.random.RandomState(seed).get_state()
    walkers = State(best, random_state=begin)
    sampler = EnsembleSampler(_WALKERS, coordinates, log_weight, vectorize=True)
    for _ in range(_WARM_UPS):
        walkers = sampler.run_mcmc(walkers, _WARM_UP, store=False, skip_initial_state_check=True)
        weights = walkers.log_prob
        lost = weights < min(np.median(weights), weights.max() - 12.5)
        others = random.choice(np.flatnonzero(~lost), lost.sum())
        walkers.coords[lost], walkers.log_prob[lost] = walkers.coords[others], weights[others]
    sampler.run_mcmc(walkers, _STEPS, skip_initial_state_check=True)
    return sampler.get_chain(thin=_THIN, flat=True)
