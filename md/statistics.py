"""Means of correlated series: the transient left out, and the standard error of the rest."""

from math import inf, log, nan, sqrt

import numpy as np

FEWEST = 100  # values for a standard error


def transient(periods: int) -> int:
    """Periods left out at the start of a run: a fifth.

    A cut chosen from the series itself (MSER-5, for one) keeps the part that looks constant, and
    its standard errors come out too small.
    """
    return periods // 5


def standard_error(series: np.ndarray) -> float:
    """Standard error of the mean of a correlated, stationary series; nan below `FEWEST` values.

    The spectral density at frequency zero of an autoregressive model over the number of values
    (Heidelberger and Welch, 1981). The model is fitted by Yule and Walker's equations up to the
    order 10 log10(n), and the order with the smallest Akaike criterion is taken. A change of state
    that is rarer than once in the series goes unseen: only independent starts show it.
    """
    series = np.asarray(series, float)
    n = len(series)
    if n < FEWEST or not np.isfinite(series).all():
        return nan
    off = series - series.mean()
    most = int(10 * np.log10(n))
    covariance = np.array([off[: n - lag] @ off[lag:] for lag in range(most + 1)]) / n
    noise, weights, found, least = covariance[0], np.zeros(0), 0.0, inf
    for order in range(most + 1):  # Levinson and Durbin's recursion
        if order:
            lagged = covariance[order - 1 : 0 : -1]
            reflected = (covariance[order] - weights @ lagged) / noise
            weights = np.append(weights - reflected * weights[::-1], reflected)
            noise *= 1 - reflected**2
        if not noise > 1e-15 * covariance[0]:  # nothing is left to explain
            break
        criterion = n * log(noise) + 2 * order
        if criterion < least:
            density = noise * n / (n - order - 1) / (1 - weights.sum()) ** 2
            found, least = sqrt(density / n), criterion
    return found


def ratio(
    sums: np.ndarray, counts: np.ndarray, *, independent: bool = False
) -> tuple[float, float]:
    """Mean of a quantity from its sums and counts in blocks, and its standard error.

    Parameters
    ----------
    sums, counts : of each block, in the order of time
    independent : whether the blocks are, else they are a correlated series
    """
    if not counts.sum() > 0:
        return nan, nan
    mean = sums.sum() / counts.sum()
    off = (sums - mean * counts) / counts.mean()
    if independent:
        return float(mean), float(off.std(ddof=1) / sqrt(len(off)))
    return float(mean), standard_error(off)
