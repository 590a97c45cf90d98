"""Two programs of one row: the table of the other one, and this one's runs at its points."""

import numpy as np
import pytest

import md
from figures.checks import two_codes
from figures.lib import runs
from figures.lib.runs import SEEDS

from .quick_figures import MOST_PERIODS, data


def test_the_table_is_of_whole_sets_of_starts():
    tilts, found = two_codes.other()
    assert found.shape == (len(two_codes.MEASURED), len(tilts), len(SEEDS["start.seed"]))
    assert found[:, 0, 1].tolist() == [7.07588, 0.53119, 0.91108, 1.26100]  # 18 degrees, seed 2
    assert np.isfinite(found).all()
    d = data("two_codes")
    spread = found.std(axis=-1, ddof=1) / np.sqrt(found.shape[-1])
    for name, mean, error in zip(two_codes.MEASURED, found.mean(axis=-1), spread, strict=True):
        np.testing.assert_allclose(d[f"other_{name}"], mean)
        np.testing.assert_allclose(d[f"other_{name}_error"], error)


def test_this_program_runs_the_same_rows():
    """At the tilts of the table, with the constants of its flags."""
    d, points = data("two_codes"), two_codes.sweeps(True)["row"].points
    for point in points:
        scene = point.scene
        assert (scene.rods.count, scene.rods.length, scene.rods.inertia) == (40, 9.5, "thin")
        assert (scene.plate.acceleration, scene.plate.frequency_hz) == (3.3, 60.0)
        assert {part.friction for part in (scene.contacts.plate, scene.contacts.rods)} == {0.3}
        assert scene.step.size == 2e-5
    tilts = [float(np.degrees(point.scene.tilt)) for point in points[:: len(SEEDS["start.seed"])]]
    np.testing.assert_allclose(d["nominal_deg"], tilts, atol=1e-3)  # rods start a hair apart
    starts = [md.run(point.scene, periods=MOST_PERIODS).touches for point in points[:4]]
    pushed = np.mean([touches["pushed_by_others"]["mean"] for touches in starts])
    assert d["pushed"][0] == pytest.approx(pushed)


@pytest.mark.slow
def test_two_programs_give_one_answer(tmp_path, monkeypatch):
    """Within four errors; touches within 6 %, as each program ends a touch by a rule of its own."""
    monkeypatch.setattr(runs, "STORE", tmp_path / "rows.db")
    d = two_codes.data()
    for name in two_codes.MEASURED:
        apart = np.abs(d[name] - d[f"other_{name}"])
        error = np.hypot(d[f"{name}_error"], d[f"other_{name}_error"])
        alike = 0.06 * d[name] if name == "touches" else 0.0
        assert np.all(apart < alike + 4 * error), name
