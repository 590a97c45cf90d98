"""What the drift's accuracy costs: parts of long runs, prices, the ladder; tiny sizes."""

import numpy as np
import pytest

import md
from figures.cost import accuracy_cost_drift as drift_figure
from figures.cost import accuracy_cost_ladder as ladder
from figures.lib.timing import seconds_per_period
from md.accuracy import steps_per_contact

from .quick_figures import SIZES, data, tiny


def test_errors_of_parts():
    """Of independent values: sigma/sqrt(n) and the distance of the truth, squares added."""
    series = 2 + np.random.default_rng(1).normal(size=200_000)
    n = np.array([1, 10, 100, 10**5])
    parts = drift_figure.parts(series, n)
    found = drift_figure.rms_of_parts(parts, 2.0)
    np.testing.assert_allclose(found[:3], n[:3] ** -0.5, rtol=4 / np.sqrt(2 * 2000))
    assert np.isnan(found[3])  # fewer than eight parts
    shifted = drift_figure.rms_of_parts(parts, 2.5)[:3]
    np.testing.assert_allclose(shifted, np.hypot(n[:3] ** -0.5, 0.5), rtol=0.03)
    means = series.reshape(-1, 10).mean(axis=1)
    assert found[1] == pytest.approx(np.sqrt(np.mean((means - 2) ** 2)))


def test_time_to_reach_an_error():
    """Bias and noise add; a bias that is lost in its error counts as none."""
    d = {
        "bias": np.array([0.02, 0.006, 0.006]),
        "bias_error": np.array([0.001, 0.001, 0.004]),
        "noise": np.array([0.2, 0.2, 0.2]),
        "seconds": np.array([1e-3, 2e-3, 4e-3]),
    }
    found = drift_figure.to_reach(d, 0.01)
    assert found[0] == np.inf
    assert found[1] == pytest.approx(0.04 / (1e-4 - 3.6e-5) * 2e-3)
    assert found[2] == pytest.approx(0.04 / 1e-4 * 4e-3)


def test_accuracy_against_time(monkeypatch):
    d = data("accuracy_cost_drift")
    assert (np.diff(d["per_contact"]) > 0).all()
    assert d["dt"] * d["per_contact"] == pytest.approx(d["dt"][0] * d["per_contact"][0])
    assert d["made"].tolist() == [300] * 5 + [100]
    run = md.run(drift_figure._scene(d["dt"][-1]), periods=120).c_x_series[20:]
    assert (1 + d["bias"][-1]) * d["truth"] == pytest.approx(run.mean())
    assert 0.2 < d["truth"] < 0.4
    assert np.nanmin(d["rms"]) > 0
    assert (d["run_per_contact"] > 10).all()
    assert [run["tolerance"] for run in drift_figure.runs(d)] == 4 * [0.4]
    monkeypatch.setattr(md, "run", None)  # all is in the store
    with tiny():
        np.testing.assert_array_equal(drift_figure.data(quick=True)["rms"], d["rms"])


def test_prices_of_a_period():
    """Positive, and one per step; how they compare is the machine's business."""
    scenes = [ladder.scene(n, {}) for n in (13, 18)]
    found = seconds_per_period(scenes, rounds=1, periods=1, settle=1)
    assert found.shape == (2,)
    assert (found > 0).all()


def test_the_ladder():
    d = data("accuracy_cost_ladder")
    groups = ["theory", "theory", "one rigid rod", "length", "length", "step", "rods"]
    assert list(d["group"]) == groups
    assert d["answer"][0] == d["answer"][1]
    off, *_ = ladder.deviations(d)
    np.testing.assert_allclose((off + 1) * d["trusted"][0], d["answer"])
    few = SIZES[ladder]["ROWS"]["rods"]["N=5"]
    scenes = (ladder.scene(13, few, seed) for seed in range(1, 9))
    starts = [md.run(scene, periods=4).c_x for scene in scenes]
    assert d["answer"][-1] == pytest.approx(np.mean(starts))  # bars: scatter of independent starts
    assert d["scatter"][-1] == pytest.approx(np.std(starts, ddof=1))
    assert d["error"][-1] == pytest.approx(np.std(starts, ddof=1) / np.sqrt(8))


@pytest.mark.parametrize("changes", [{}, ladder.PRINTED, ladder.CONSTRAINT])
def test_steps_of_the_ladder_are_parts_of_a_contact(changes):
    scene = ladder.scene(20, changes)
    assert steps_per_contact(scene, scene.step.size) == pytest.approx(20)
