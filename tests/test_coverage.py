"""Quoted errors against the scatter between starts: twelve scenes, ten to fifty starts each."""

import numpy as np
import pytest
from joblib import Parallel, delayed

import md
from md.measures import standard_error, transient

from .command_line import read_toml
from .rows import ring

LENGTHS = 128, 400, 1000
SCENES = read_toml("tests/coverage.toml")


def _series(name, seed, periods):
    """Drift and tilt of each period."""
    one = SCENES[name]
    scene = md.load(one["source"], [*one["assignments"], f"start.seed={seed}"])
    result = md.run(scene, periods=periods, ledger=False)
    return result.c_x_series, result.tilt_series


def _starts(name, count, periods):
    """Drift and tilt, (count, periods) each."""
    jobs = (delayed(_series)(name, seed, periods) for seed in range(1, count + 1))
    return np.array(Parallel(n_jobs=-1)(jobs)).swapaxes(0, 1)


def _rms_error(drifts):
    return np.sqrt(np.mean([standard_error(one) ** 2 for one in drifts]))


def _parts(series, periods):
    """What `md.run` keeps of so many periods, and as many parts of that length as follow."""
    kept = series[:, transient(periods) :]
    length = periods - transient(periods)
    return kept[:, : kept.shape[1] // length * length].reshape(-1, length)


def _ratio(drifts):
    """Rms scatter of the mean drifts over the rms of their errors."""
    return drifts.mean(axis=1).std(ddof=1) / _rms_error(drifts)


@pytest.mark.parametrize("name", [name for name in SCENES if name not in ("annulus", "Gamma 2")])
def test_errors_are_as_large_as_the_scatter_between_starts(name):
    """Their ratio is 0.8 to 1.25 from 128 periods on, to one error of it, 1/sqrt(2 50).

    What follows of longer runs counts as further starts.
    """
    drifts, _ = _starts(name, 50, LENGTHS[-1])
    for periods in LENGTHS:
        assert 0.8 / 1.1 < _ratio(_parts(drifts, periods)) < 1.25 * 1.1


def test_a_drift_that_goes_with_the_change_of_tilt_has_a_rather_large_error():
    """At Gamma 2 rods drift faster while their tilt grows, which comes back within 20 periods.

    That part of the drift is in the error, but in no mean over many periods. Parts of long runs
    tell it, to two errors of the ratio: fifty starts do not.
    """
    runs = _starts("Gamma 2", 10, 5000)
    for periods in LENGTHS:
        drift, tilt = (_parts(series, periods) for series in runs)
        change = np.gradient(tilt, axis=1)
        slope = [np.polyfit(x, y, 1)[:1] for x, y in zip(change, drift, strict=True)]
        scatter, margin = drift.mean(axis=1).std(ddof=1), np.sqrt(2 / len(drift))
        error, rest = _rms_error(drift), _rms_error(drift - slope * change)
        assert error > 1.15 * rest
        for told in (error, rest):
            assert 0.8 * (1 - margin) < scatter / told < 1.25 * (1 + margin)


def test_an_annulus_does_not_forget_its_start():
    """Twelve runs, walls at rest, scatter by far more than each of them lets one think."""
    drifts, _ = _starts("annulus", 12, 2000)
    assert _ratio(_parts(drifts, 2000)) > 2


def test_one_run_in_an_annulus_quotes_no_error():
    result = md.run(ring("rods.count=2", "step.coarse=true"), periods=130)
    assert np.isfinite(result.c_x)
    assert np.isnan([result.c_x_stderr, result.tilt_stderr_deg]).all()
    assert all(np.isnan(value["stderr"]) for value in result.touches.values())


def test_a_row_quotes_an_error_from_124_periods_on():
    scene = md.load(**SCENES["10 rods"])  # a row of one has a kernel of its own
    short, long = (md.run(scene, periods=n) for n in (123, 124))
    assert np.isnan(short.c_x_stderr)
    assert long.c_x_stderr == standard_error(long.c_x_series[24:])
    assert long.c_x == long.c_x_series[24:].mean()
