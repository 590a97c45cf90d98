"""Figures of the row of rods: tiny sweeps, and made-up numbers."""

import numpy as np
import pytest

from figures.lib import runs
from figures.paper import fig02, fig07, fig08, fig13
from impact import ContactGeometry, drift, landing_density, spherocylinder, thin_rod

from .quick_figures import data, tiny


@pytest.fixture(scope="module")
def over_tilt():
    """The row along the tilts, run once."""
    with tiny():
        yield runs.computed(runs.tilt_plan(True))


def test_what_the_store_holds_is_not_computed_again():
    """By the same figure, and by another with the same scan over tilt."""
    first = data("fig13")
    with tiny() as patch:
        tallies, execute = [], runs.execute
        patch.setattr(runs, "execute", lambda *a, **how: tallies.append(execute(*a, **how)))
        again = fig13.data(quick=True)
        runs.computed(runs.tilt_plan(True))
    assert len(tallies) > 3
    assert sum(tally.computed for tally in tallies) == 0
    for name, values in first.items():
        np.testing.assert_array_equal(again[name], values)


def thick(tilt):
    """Round tip, inertia l^2/12."""
    return ContactGeometry(4.25 * np.sin(tilt), 4.25 * np.cos(tilt) + 0.5, 9.5 / 12**0.5)


def test_theory_lines_are_those_of_the_closed_forms():
    """At the paper's friction and restitution, for each line's rod."""
    d, setting = data("fig13"), {"friction": 0.3, "restitution": 0.65}
    np.testing.assert_array_equal(d["thin"], drift(thin_rod(d["fine"]), **setting).c_x)
    rod = thick(np.radians(d["tilt_deg"]))
    np.testing.assert_array_equal(d["thick_at_tilts"], drift(rod, **setting).c_x)
    rod = spherocylinder(np.arccos(40 / 41.4), d["fine_length"])
    np.testing.assert_array_equal(d["thick_of_length"], drift(rod, **setting).c_x)
    np.testing.assert_allclose(d["speed"], 3.3 * 981 / (2 * np.pi * 60))
    np.testing.assert_allclose(d["speed_b"], d["gamma"] * 981 / (2 * np.pi * 60))
    six = data("fig06")
    rod = thick(np.radians(six["fine_deg"]))
    line = drift(rod, **setting, plate_velocity=six["speed"] / 2)
    np.testing.assert_allclose(six["line_c_x"], line.c_x, rtol=1e-12)
    np.testing.assert_allclose(six["line_c_z"], line.c_z, rtol=1e-12)


def test_units_are_those_of_the_axes(over_tilt):
    """cm/s and rad/s: the store's means times sqrt(g d) and over sqrt(d/g)."""
    names = ("touches.c_x_after.mean", "touches.omega_before.mean")
    c_x, omega = (runs.over_seeds(v)[0] for v in runs.gathered(over_tilt, *names))
    np.testing.assert_allclose(data("fig06")["c_x_after"], c_x * np.sqrt(981 * 0.6))
    np.testing.assert_allclose(data("fig06")["omega_before"], omega * np.sqrt(981 / 0.6))


def test_phase_densities_integrate_to_one(over_tilt):
    (counts,) = runs.gathered(over_tilt, "phases")
    sums = data("fig08")["density"].sum(axis=1)
    np.testing.assert_allclose(sums * 2 * np.pi / fig08.BINS_DRAWN, 1)
    rising = np.concatenate([counts[..., :16], counts[..., 48:]], axis=-1).sum(axis=-1)
    np.testing.assert_allclose(fig08.falling(counts) + rising / counts.sum(axis=-1), 1)


def test_the_papers_density_is_found_again():
    edges = np.linspace(0, 2 * np.pi, 65)
    counts = 1e6 * np.diff(edges + np.sin(edges)) / (2 * np.pi)
    middle = 2 * np.pi * (np.arange(fig08.BINS_DRAWN) + 0.5) / fig08.BINS_DRAWN
    np.testing.assert_allclose(fig08.densities(counts), landing_density(middle), atol=1e-3)
    assert fig08.falling(counts) == pytest.approx(fig08.EXPECTED, rel=1e-12)


def test_tips_stay_above_the_plate_and_meet_it():
    d = data("fig07")
    gap = d["tips"] - d["plate"][:, None]
    assert -0.01 < gap.min() < 0.001  # cm
    assert gap.max() > 0.02
    assert d["plate"].max() == pytest.approx(3.3 * 981 / (2 * np.pi * 60) ** 2, rel=1e-3)
    assert d["time"][0] == 0
    assert d["time"][-1] == pytest.approx(fig07.SHOWN_PERIODS, abs=0.05)


def test_drift_is_told_from_none():
    mean = np.array([1.0, 1.0, -1.0, -1.0, 0.001, -0.001, 0.0, 0.03, np.nan])
    error = np.array([0.1, 0.4, 0.1, 0.4, 1e-5, 1e-5, 0.0, 0.009, 0.1])
    np.testing.assert_array_equal(fig02.classify(mean, error), [1, 0, -1, 0, 0, 0, 0, 1, 0])


def test_the_larger_error_counts():
    """Between the runs where they differ, within them where they agree by chance."""
    _, error = runs.larger_error(np.array([[1.0, 3.0], [2.0, 2.0]]), np.full((2, 2), 0.5))
    np.testing.assert_allclose(error, [1.0, 0.5 / np.sqrt(2)])


def test_fits_find_what_was_put_in():
    gamma = np.array([1.05, 1.1, 1.2, 1.4, 2, 3, 4, 5.0])
    c_x = np.where(gamma < 1.5, 3 * (gamma - 1) ** 1.5, 2.5 * (gamma - 1.3))
    f = fig13.fits({"gamma": gamma, "b_c_x": c_x, "b_c_x_error": np.full(8, 1e-3)})
    assert f["power"] == pytest.approx(1.5, abs=1e-6)
    assert (f["line_slope"], f["line_from"]) == pytest.approx((2.5, 1.3))
