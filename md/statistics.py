"""Means of correlated series: where the transient ends, and the standard error of what follows."""

import numpy as np
from scipy.stats import chi2


def transient(series: np.ndarray, batch: int = 5) -> int:
    """Number of leading values to discard: MSER-5 (White, Cobb and Spratt, 2000).

    The cut that makes the marginal standard error of the rest, from means of `batch` values, the
    smallest; at most half of the series.
    """
    means = series[: len(series) // batch * batch].reshape(-1, batch).mean(axis=1)
    if len(means) < 4:
        return 0
    means -= means.mean()  # or the squares cancel where the mean is large
    left = np.arange(len(means), 0, -1)
    sums, squares = np.cumsum(means[::-1])[::-1], np.cumsum(means[::-1] ** 2)[::-1]
    marginal = (squares - sums**2 / left) / left**2
    return int(np.argmin(marginal[: len(means) // 2 + 1])) * batch


def standard_error(series: np.ndarray) -> float:
    """Standard error of the mean of a correlated, stationary series, by automated blocking.

    Values are averaged in pairs again and again (Flyvbjerg and Petersen, 1989). The plateau is
    found by Jonsson's test (Phys. Rev. E 98, 043304, 2018): from there on, the covariances of
    neighbours, squared and summed over the levels left, are no larger than those of independent
    values, at 99 % of chi^2. An odd value out is the first one. nan below 4 values.
    """
    series = np.asarray(series, float)
    if not len(series) >= 4 or not np.isfinite(series).all():
        return float("nan")
    x, variances, terms, sizes = series, [], [], []
    while len(x) > 1:
        n, off = len(x), x - x.mean()
        variance, covariance = np.mean(off**2), np.sum(off[1:] * off[:-1]) / n
        lag = (n - 1) * variance / n**2 + covariance if variance > 0 else 0.0
        terms.append(n * (lag / variance) ** 2 if variance > 0 else 0.0)
        variances.append(variance)
        sizes.append(n)
        x = x[n % 2 :]
        x = (x[0::2] + x[1::2]) / 2
    left = np.cumsum(terms[::-1])[::-1]
    quantiles = chi2.ppf(0.99, np.arange(len(sizes), 0, -1))
    plateau = int(np.argmax(left < quantiles)) if (left < quantiles).any() else -1
    return float(np.sqrt(variances[plateau] / (sizes[plateau] - 1)))


def ratio(sums: np.ndarray, counts: np.ndarray) -> tuple[float, float]:
    """Mean of a quantity from its sums and counts in a row of blocks, and its standard error."""
    if not counts.sum() > 0:
        return float("nan"), float("nan")
    mean = sums.sum() / counts.sum()
    return float(mean), standard_error((sums - mean * counts) / counts.mean())
