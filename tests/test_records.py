"""Touches and landings one by one: their columns are what the means of a run are of."""

import numpy as np
import pytest

import md

from .rows import row
from .test_annulus import ring


@pytest.fixture(scope="module", params=[row, ring])
def made(request):
    rows = []
    result = md.run(request.param("plate.acceleration=5"), periods=30, observe=rows.append)
    return rows, result


@pytest.mark.parametrize("kind", ["touches", "landings"])
def test_columns_have_the_means_of_the_run(made, kind):
    rows, result = made
    found = getattr(md.records, kind)(rows, result)
    assert np.isnan(found["flight"]).any()
    part = found[(found["time"] >= result.discarded) & np.isfinite(found["flight"])]
    assert len(part) > 40
    wanted = {name: value["mean"] for name, value in getattr(result, kind).items()}
    means = {name: part[name].mean() for name in part.dtype.names if name in wanted}
    means["flight_periods"] = part["flight"].mean()
    means["plate_velocity"] = part["plate_velocity"].mean() / result.scene.plate_speed
    if kind == "touches":
        means["restitution"] = -part["v_after"].sum() / part["v_before"].sum()
        means["contact_periods"] = part["duration"].mean()
        means["slip_stick"] = (part["regime"] == "slip-stick").mean()
        means["pushed_by_others"] = (part["pushed_by_others"] > 0).mean()
    assert len(means) > 8
    assert means == pytest.approx({name: wanted[name] for name in means}, rel=1e-10)


def test_a_touch_is_an_impact_at_its_contact_point(made):
    """v = c_z - omega a_x - V_z, with the arm to the end of a rod of this tilt."""
    touches = md.records.touches(*made)
    v = touches["c_z_before"] - touches["omega_before"] * touches["a_x"] - touches["plate_velocity"]
    np.testing.assert_allclose(v, touches["v_before"], atol=1e-12)
    half = made[1].scene.rods.length / 2 - 0.5
    assert (np.hypot(touches["a_x"], touches["a_z"] + 0.5) <= half * 1.01).all()
    assert set(touches["cap"]) <= {-1, 1}
    assert touches["max_overlap"].max() < 0.5


def test_a_run_without_touches_has_empty_arrays(made):
    for kind in (md.records.touches, md.records.landings):
        assert kind([], made[1]).shape == (0,)


@pytest.mark.parametrize("kind", ["touches", "landings"])
def test_phases_are_those_of_the_plate_s_velocity(made, kind):
    """V_0 cos(phase); counts over the cycle are those of the run."""
    rows, result = made
    found = getattr(md.records, kind)(rows, result)
    speed = result.scene.plate_speed
    step = 2 * np.pi / result.steps_per_period  # in which the plate's velocity is taken once
    np.testing.assert_allclose(
        found["plate_velocity"], speed * np.cos(found["phase"]), atol=1.01 * step * speed
    )
    if kind == "touches":
        part = found[(found["time"] >= result.discarded) & np.isfinite(found["flight"])]
        counts, _ = np.histogram(part["phase"], len(result.phases), (0, 2 * np.pi))
        np.testing.assert_array_equal(counts, result.phases)
