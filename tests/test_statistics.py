"""Standard errors of correlated series against exact ones; the end of a transient."""

import numpy as np
import pytest
from scipy.signal import lfilter

from md.statistics import ratio, standard_error, transient


def autoregressive(random, n, memory):
    """x' = memory x + noise of variance 1, from its stationary distribution."""
    noise = random.normal(size=n)
    noise[0] /= np.sqrt(1 - memory**2)
    return lfilter([1.0], [1.0, -memory], noise)


def exact_error(n, memory):
    """Standard error of the mean of n values, from the covariances memory^k/(1 - memory^2)."""
    k = np.arange(1, n)
    total = n + 2 * np.sum((n - k) * memory**k)
    return np.sqrt(total / (1 - memory**2)) / n


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9, -0.5])
@pytest.mark.parametrize("n", [256, 3000, 16384])
def test_standard_error_of_autoregressive_series(memory, n):
    """The mean of 100 estimates, each from a series of its own, against the exact value.

    Blocking stops where the correlation r of neighbouring blocks can no longer be seen, and errs by
    r. Blocks of b values have r = tau/b, tau the sum of memory^k, and n/b of them show r down to
    sqrt(q b/n): r = (q tau/n)^(1/3), with q of a few. q = 3 holds it, the scatter of a mean of 100
    estimates included, and it is a bias to the low side where memory > 0, to the high side where
    memory < 0, at most 25 % for memory = -0.5.
    """
    random = np.random.default_rng(n)
    found = [standard_error(autoregressive(random, n, memory)) for _ in range(100)]
    bias = np.mean(found) / exact_error(n, memory) - 1
    tau = memory / (1 - memory)
    if tau >= 0:
        assert -((3 * tau / n) ** (1 / 3)) - 0.01 < bias < 0.01
    else:
        assert -0.01 < bias < 0.25


def test_white_noise_needs_no_blocks():
    """The usual estimator; it scatters by 1/sqrt(2 n), four times which is the bound."""
    x = np.random.default_rng(0).normal(size=4096)
    usual = x.std() / np.sqrt(4095)
    assert standard_error(x) == pytest.approx(usual, rel=1e-12)
    assert usual == pytest.approx(1 / 64, rel=4 / np.sqrt(2 * 4096))


def test_standard_error_does_not_depend_on_units():
    """Shifted by a thousand, scaled by a power of two: to rounding."""
    x = autoregressive(np.random.default_rng(1), 1000, 0.8)
    assert standard_error(1024 * x) == 1024 * standard_error(x)
    assert standard_error(x + 1000) == pytest.approx(standard_error(x), rel=1e-9)


@pytest.mark.parametrize("n", [4, 5, 7, 100])
@pytest.mark.parametrize("value", [0.0, 0.1, -3e8])
def test_a_constant_has_no_error(n, value):
    """Up to the rounding of its mean."""
    assert standard_error(np.full(n, value)) <= 4e-16 * abs(value)


@pytest.mark.parametrize(
    "series", [[], [1.0], [1.0, 2.0, 4.0], [1.0, np.nan, 2.0, 3.0, 4.0], [np.inf] * 8]
)
def test_no_error_without_enough_finite_values(series):
    """nan, and no warning."""
    assert np.isnan(standard_error(np.array(series)))


@pytest.mark.parametrize("offset", [0.0, 1.0, 1e6])
@pytest.mark.parametrize("ramp", [40, 100])
def test_a_ramp_is_cut_off(ramp, offset):
    """A line down to a noisy plateau: cut within two batches and what the noise hides.

    The ramp ends below the noise within its last tenth; where the plateau stands does not matter.
    """
    random = np.random.default_rng(ramp)
    series = offset + 0.05 * random.normal(size=400)
    series[:ramp] += np.linspace(1, 0, ramp)
    cut = transient(series)
    assert cut % 5 == 0
    assert 0.85 * ramp - 10 <= cut <= ramp + 15


def test_a_series_without_a_transient_is_kept_and_half_is_the_most_that_goes():
    """Noise loses little; a ramp without an end loses half."""
    random = np.random.default_rng(0)
    assert np.mean([transient(random.normal(size=400)) for _ in range(50)]) < 100
    assert transient(np.arange(400.0)) == 200
    assert transient(np.ones(100)) == 0
    for n in range(20):
        assert transient(np.arange(float(n))) == 0
    assert transient(np.full(100, np.nan)) <= 50


def test_ratio_of_sums():
    """A quantity summed over a varying number of events: the delta method, 1/sqrt(n) for noise."""
    random = np.random.default_rng(0)
    counts = random.poisson(20, 1024).astype(float)
    sums = np.array([random.normal(3, 2, int(n)).sum() for n in counts])
    mean, error = ratio(sums, counts)
    assert mean == sums.sum() / counts.sum()
    assert abs(mean - 3) < 4 * error
    assert error == pytest.approx(2 / np.sqrt(counts.sum()), rel=4 / np.sqrt(2 * 1024))
    empty = ratio(np.zeros(8), np.zeros(8))
    assert np.isnan(empty).all()
