"""How large a row must be: made-up numbers, and rows that are followed."""

import numpy as np
import pytest

import md
from figures.checks import row_motion, row_size
from md.kernels.codes import Z

from .quick_figures import data

HALF = 4.25


def test_drifts_are_over_that_of_the_largest_row():
    c_x = np.array([[14.0, 9.0], [10.4, 12.0], [10.2, 9.0], [10.0, 10.0]])
    error = np.array([[0.1, 0.9], [0.1, 0.1], [0.1, 0.9], [0.1, 0.1]])
    part, off = row_size.over_largest({"c_x": c_x, "c_x_error": error})
    assert part[0] == pytest.approx([1.4, 0.9])
    assert off[0, 0] == pytest.approx(np.hypot(0.1, 1.4 * 0.1) / 10)
    assert np.isnan(off[-1]).all()


def test_rows_of_all_sizes_are_equally_dense():
    for count, sweep in row_size.sweeps().items():
        scenes = [point.scene for point in sweep.points]
        assert {scene.rods.count for scene in scenes} == {int(count)}
        tilts = sorted({round(float(np.degrees(scene.tilt)), 2) for scene in scenes})
        assert tilts == [*row_size.SIZE_TILTS_DEG[False]]
    work = {
        p.periods * int(n) * s.shape[-1] for n, s in row_size.sweeps().items() for p in s.points
    }
    assert len(work) == 1  # rods x starts x periods


def test_a_followed_row_drifts_as_a_run_does():
    """The tiny runs of the figures, beside `md.run`."""
    d = data("row_size")
    points = row_size.sweeps(True)["5"].points
    scene = points[0].scene
    result = md.run(scene, periods=8, ledger=False)
    found, rods = row_motion.watched(scene, 8)
    np.testing.assert_allclose(found["c_x"], result.c_x_series * scene.cm_per_s, rtol=1e-9)
    np.testing.assert_array_equal(rods[:, Z], result.rods[:, Z])
    assert found["tilt_deg"] == pytest.approx(result.tilt_series, abs=0.5)
    assert d["c_x"].shape == (3, 1)
    spread = np.mean([row_motion.averaged(point.scene, 8)["tilt_spread"] for point in points])
    assert d["spread_deg"][0, 0] == pytest.approx(np.degrees(spread / HALF))
