"""Standard errors of correlated series against exact ones."""

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.signal import lfilter

from md.measures import TREND, ratio, settled, standard_error, steady, trend


def autoregressive(random, shape, memory):
    """x' = memory x + noise of variance 1, stationary from the start, along the last axis."""
    noise = random.normal(size=shape)
    noise[..., 0] /= np.sqrt(1 - memory**2)
    return lfilter([1.0], [1.0, -memory], noise)


def exact_error(n, memory):
    """Standard error of the mean of n values, from the covariances memory^k/(1 - memory^2)."""
    k = np.arange(1, n)
    total = n + 2 * np.sum((n - k) * memory**k)
    return np.sqrt(total / (1 - memory**2)) / n


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9, -0.5])
@pytest.mark.parametrize("n", [100, 320, 3000])
def test_scatter_of_means_over_their_errors(memory, n):
    """Means of 400 autoregressive series scatter as their errors say, in the rms.

    The ratio is one to the scatter of both, 4/sqrt(2 400) each, and what a fitted memory lacks:
    a coefficient a is low by (1 + 3a)/n (Kendall), which takes (1 + 3a)/(1 - a)/n of 1/(1 - a).
    """
    series = autoregressive(default_rng(n), (400, n), memory)
    scatter = np.sqrt(np.mean(series.mean(axis=1) ** 2))
    error = np.sqrt(np.mean([standard_error(one) ** 2 for one in series]))
    lacking, of_each = max(1 + 3 * memory, 0) / (1 - memory) / n, 4 / np.sqrt(2 * 400)
    assert 1 - 2 * of_each < scatter / error < 1 + 2 * of_each + lacking
    assert error / exact_error(n, memory) == pytest.approx(1, abs=of_each + lacking)


def test_a_second_memory_is_seen():
    """A slow part below a fast one: x'' = 0.3 x' + 0.55 x + noise, spectrum 1/(1 - 0.85)^2 at 0."""
    noise = default_rng(2).normal(size=40_100)
    series = lfilter([1.0], [1.0, -0.3, -0.55], noise)[100:]
    assert standard_error(series) == pytest.approx(1 / 0.15 / 200, rel=0.1)


def test_standard_error_does_not_depend_on_units():
    """A shift by a thousand and a scale of a power of two leave it as it is, to rounding."""
    x = autoregressive(default_rng(1), 1000, 0.8)
    assert standard_error(1024 * x) == 1024 * standard_error(x)
    assert standard_error(x + 1000) == pytest.approx(standard_error(x), rel=1e-9)


@pytest.mark.parametrize("n", [100, 107])
@pytest.mark.parametrize("value", [0.0, 0.1, -3e8])
def test_a_constant_has_no_error(n, value):
    """Its error is zero up to the rounding of its mean."""
    assert standard_error(np.full(n, value)) <= 4e-16 * abs(value)


def test_what_repeats_has_next_to_none():
    """A sine, which its two last values predict, has next to no error."""
    assert standard_error(np.sin(np.arange(300))) < 0.1 * np.sqrt(0.5 / 300)


@pytest.mark.parametrize("series", [[], [1.0], np.arange(99.0), [np.nan] * 200, [np.inf] * 200])
def test_no_error_without_enough_finite_values(series):
    """The error is nan, without a warning."""
    assert np.isnan(standard_error(np.array(series)))


def test_ratio_of_sums():
    """A quantity summed over a varying number of events: the delta method, 1/sqrt(n) for noise."""
    random = default_rng(0)
    counts = random.poisson(20, 1024)
    sums = random.normal(3 * counts, 2 * np.sqrt(counts))
    mean, error = ratio(sums, counts)
    assert mean == sums.sum() / counts.sum()
    assert abs(mean - 3) < 4 * error
    assert error == pytest.approx(2 / np.sqrt(counts.sum()), rel=4 / np.sqrt(2 * 1024))
    assert np.isnan(ratio(sums[:9], counts[:9])[1])
    assert np.isnan(ratio(np.zeros(8), np.zeros(8))).all()


@pytest.mark.parametrize("n", [320, 2000])
@pytest.mark.parametrize(("memory", "alarms"), [(0.0, 0.02), (0.5, 0.02), (0.9, 0.06)])
def test_stationary_series_have_no_trend(memory, alarms, n):
    """Of 400 series as many alarm as `trend` says, to two standard deviations of so many."""
    series = autoregressive(default_rng(n), (400, n), memory)
    assert np.mean([trend(one) > TREND for one in series]) <= alarms + 2 * np.sqrt(alarms / 400)
    found = [settled(n // 5, one, np.zeros(n)) for one in series]
    assert np.mean([cut is None for cut in found]) <= 0.3 * alarms + 0.005


@pytest.mark.parametrize("n", [104, 130, 160, 199])
def test_a_trend_of_a_short_series_is_seen(n):
    """A straight line, alone or of ten standard deviations of what scatters about it."""
    random, line = default_rng(n), np.linspace(0, 10, n)
    assert trend(line) > TREND
    for memory, alarms in (0.0, 0.02), (0.5, 0.05), (0.9, 0.25):
        series = autoregressive(random, (200, n), memory)
        rising = series + line / np.sqrt(1 - memory**2)
        assert np.mean([trend(one) > TREND for one in rising]) > 0.95
        assert np.mean([trend(one) > TREND for one in series]) <= alarms + 2 * np.sqrt(alarms / 200)


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_a_slow_trend_never_settles(memory):
    """A straight line, over the series 60 times its standard error."""
    n = 2000
    line = 60 * exact_error(n, memory) * np.linspace(0, 1, n)
    series = autoregressive(default_rng(8), (100, n), memory) + line
    assert np.mean([settled(n // 5, one, np.zeros(n)) is None for one in series]) > 0.95


def test_too_few_values_have_no_trend():
    assert np.isnan(trend(np.zeros(99)))
    assert np.isnan(trend(np.zeros(0)))
    assert trend(1e-15 * np.arange(100)) < TREND  # rounding


@pytest.mark.parametrize(
    ("rates", "expected"),
    [
        ((0, 0, 0, 0, 30, 64, 106, 220), False),
        ((220, 106, 64, 30, 0, 0, 0, 0), False),
        ((60,) * 8, True),
        ((0,) * 8, True),
    ],
)
def test_a_rate_that_grows_or_dies_is_not_steady(rates, expected):
    """A rate may grow from nothing, with an error as large as itself, which `trend` misses."""
    counts = default_rng(1).poisson(np.repeat(rates, 40) / 40)
    assert steady(counts) == expected


@pytest.mark.parametrize(("rate", "n"), [(0.5, 320), (20, 107), (0.01, 400)])
def test_steady_events_are_hardly_ever_taken_for_others(rate, n):
    """Of 1000 series one in 70 is, by the order of blocks, and one in 100 by the trend.

    That holds for lengths that blocks do not divide, and for events too rare for each half.
    """
    counts = default_rng(2).poisson(rate, (1000, n))
    assert np.mean([steady(one) for one in counts]) > 0.95
