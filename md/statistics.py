"""Means of correlated series: the transient left out, whether it is over, standard errors."""

from math import inf, log, nan, sqrt

import numpy as np

FEWEST = 100  # values for a standard error
TREND = 0.743  # of `trend`; of long stationary series, one in a hundred is above
# Chance below which starts that differ are in different states, of rows and of annuli, where each
# start has an arrangement of its own.
UNLIKELY = 1e-3, 5e-2
_BLOCKS = 8  # of counts whose order tells a trend
_ORDERED = 19  # of 28 pairs, ordered less reversed ones; of steady counts, one in 70 is above
_ROUNDING = 1e-12  # smaller standard errors are rounding


def transient(periods: int) -> int:
    """Periods left out at the start of a run: a fifth."""
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


def trend(series: np.ndarray) -> float:
    """How far a series is from a stationary one; nan below `FEWEST` values.

    Cramer and von Mises' statistic of its partial sums, which are a Brownian bridge if it is
    stationary, with the standard error from its second half (Heidelberger and Welch, 1983). Above
    `TREND` are 1 to 2 % of stationary series, up to 6 % of short ones with a memory of ten values.
    """
    n, late = len(series), series[-max(len(series) // 2, FEWEST) :]
    error = standard_error(late) * sqrt(len(late) / max(n, 1))
    bridge = np.cumsum(series - np.mean(series)) / (n * max(error, _ROUNDING)) if n else series
    return float(np.mean(bridge**2)) if n >= FEWEST else nan


def steady(counts: np.ndarray) -> bool:
    """Whether events come at a steady rate.

    Not if their counts trend, nor if they rise or fall from block to block (Mann, 1945): a rate
    that grows from nothing has an error as large as itself, by which `trend` excuses it.

    Parameters
    ----------
    counts : of events, a value a period
    """
    blocks = np.array([part.sum() for part in np.array_split(counts, _BLOCKS)])
    order = np.triu(np.sign(blocks - blocks[:, None]), 1).sum()
    return not (abs(order) > _ORDERED or trend(counts) > TREND)


def settled(first: int, series: np.ndarray, events: np.ndarray | None = None) -> int | None:
    """Values to leave out so that the rest shows no trend; None if half of them is not enough.

    Parameters
    ----------
    first : the fewest to leave out; more by tenths of the series
    series : with its transient
    events : counts beside it, whose rate is to be steady as well

    A cut that is free, as that of MSER-5, keeps the part that looks constant, and standard errors
    come out too small; this one is the first of at most six.
    """
    n = len(series)
    cuts = range(first, max(n // 2, first) + 1, max(n // 10, 1))
    calm = (cut for cut in cuts if not trend(series[cut:]) > TREND)
    return next((cut for cut in calm if events is None or steady(events[cut:])), None)


def ratio(sums: np.ndarray, counts: np.ndarray) -> tuple[float, float]:
    """Mean of a quantity from its sums and counts in blocks, and its standard error.

    Parameters
    ----------
    sums, counts : of each block, in the order of time
    """
    if not counts.sum() > 0:
        return nan, nan
    mean = sums.sum() / counts.sum()
    off = (sums - mean * counts) / counts.mean()
    return float(mean), standard_error(off)
