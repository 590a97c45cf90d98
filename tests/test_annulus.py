"""Scenes in an annulus: how rods are placed, and what runs tell."""

from itertools import combinations

import numpy as np
import pytest
from numpy.testing import assert_allclose

import md
from figures.claims.measure_annulus import largest_tilt_of_flat
from md.host import prepare
from md.kernels import DIRECTOR, PLACE, TURN, VELOCITY
from md.placement import largest_tilt, placed
from md.result import result_text
from md.scene import GAP

from .rows import EXPERIMENT, ROLLING, around, distance, go, radii, resting_overlap, ring

# Placement


def test_the_largest_tilt_of_one_rod():
    """Round ends: sin = sqrt((R_o - 1/2)^2 - (R_i + 1/2)^2)/(l/2 - 1/2); a flat end leaves less."""
    reach = np.sqrt((EXPERIMENT.outer - 0.5) ** 2 - (EXPERIMENT.inner + 0.5) ** 2)
    round_ends, flat = largest_tilt(EXPERIMENT, 8.0), largest_tilt_of_flat(EXPERIMENT, 8.0)
    assert np.sin(round_ends) == pytest.approx(reach / 3.5)
    assert np.radians(53) < flat < round_ends
    assert largest_tilt(EXPERIMENT, 3.0) == largest_tilt_of_flat(EXPERIMENT, 3.0) == np.pi / 2


@pytest.mark.parametrize("count", [1, 2, 23, 40, 44, 58])
def test_placed_rods_touch_neither_each_other_nor_a_wall(count):
    """They are `GAP` apart at least, stand on the plate and lean one way, by what a rod can."""
    rods, half = placed(EXPERIMENT, count, 8.0), 3.5
    x, a = rods[:, PLACE:DIRECTOR], rods[:, DIRECTOR:]
    gap, rho = 0.999 * GAP, radii(rods, half)  # less what distances round by
    pairs = combinations(range(count), 2)
    assert min((distance(rods, *pair, half) for pair in pairs), default=2) > 1 + gap
    assert rho.min() > EXPERIMENT.inner + 0.5 + gap
    assert rho.max() < EXPERIMENT.outer - 0.5 - gap
    assert_allclose(x[:, 2] - half * a[:, 2], 0.5, atol=1e-12)
    assert np.arccos(a[:, 2]).max() < largest_tilt(EXPERIMENT, 8.0)
    assert abs(np.sign(around(x, a)).sum()) == count


def test_an_odd_ring_starts_tilted_as_an_even_one():
    """An odd ring is no zig-zag all around: one rod stands between the walls, with more room."""
    tilts = [np.arccos(placed(EXPERIMENT, count, 8.0)[:, 5]).mean() for count in (51, 52)]
    assert tilts[0] > tilts[1] > 0.2


# Runs


def test_m10_rods_bounce_and_keep_to_a_gap_barely_wider_than_they_are():
    """Rods stay upright, and none turns about its axis."""
    narrow = "annulus.outer=2.9901", "annulus.inner=1.99", "rods.count=4", "plate.acceleration=4"
    result = md.run(ring(*narrow), periods=5)
    rods, directors = result.rods, result.rods[:, DIRECTOR:VELOCITY]
    assert result.touches["per_rod_and_period"]["mean"] > 0.1
    assert np.abs(radii(rods, 1.5) - 2.49).max() < 0.02
    assert result.tilt_deg < 10
    assert_allclose(np.linalg.norm(directors, axis=1), 1, atol=1e-12)
    assert np.abs((directors * rods[:, TURN:]).sum(axis=1)).max() < 1e-12


def test_a_cap_that_friction_holds_does_not_slip_as_its_rod_rolls():
    """A cap stays on a plate at rest as its rod turns about the vertical and rolls: order two."""
    still = "start.speed=0", "step.size=2e-4", "contacts.plate.friction=50"
    engine = prepare(ring(*ROLLING, *still))
    for motion in engine.plate:
        motion[:] = 0
    half, rolling, rod = engine.effects.half_length, engine.effects.inertia.rolling, engine.rods[0]
    up, a = np.array([0, 0, 1]), np.array([0, 0.3, 1]) / np.hypot(0.3, 1)
    w = up - a * (up @ a) + a * 3 / (1 + rolling)
    engine.rods[:, 2] += 20  # all but one are out of the way
    rod[:] = 1.9, 0, 0.5 - resting_overlap(1) + half * a[2], *a, *np.cross(up, half * a), *w
    go(engine, 300)
    a, w = rod[DIRECTOR:VELOCITY], rod[TURN:]
    arm = -half * a + (0, 0, half * a[2] - rod[PLACE + 2])
    slip = rod[VELOCITY:TURN] + np.cross(w + rolling * (w @ a) * a, arm)
    assert np.abs(slip[:2]).max() < 1e-7


def test_axial_inertia():
    """A sphere has 1/10, a cylinder 1/8, which is three quarters of the mass at length 3."""
    assert md.Rod(1.0).axial_gyration_squared == pytest.approx(0.1)
    assert md.Rod(3.0).axial_gyration_squared == pytest.approx(0.75 / 8 + 0.25 / 10)


@pytest.mark.parametrize(
    ("gravity", "gamma", "drop", "share"),
    [(-1, 3.3, 0, 0), (-1, 1e-6, 0, 0), (-1, 3.3, 500, 1), (-0.02, 3.3, 500, 0), (0, 3.3, 1, 0)],
)
def test_a_wedged_ring_is_reported(gravity, gamma, drop, share):
    """Rods that keep off the plate for 20 flights from V_0, here as they fall for longer.

    Flights last longer under less gravity, and do not end without.
    """
    changes = f"gravity.z={gravity}", f"start.drop={drop}", "start.speed=0"
    result = md.run(ring(*changes, f"plate.acceleration={gamma}"), periods=24)
    assert result.as_dict()["wedged"] == share
    said = "wedged: 100% of the rods have kept off or on the plate for 21 periods"
    assert (said in result_text(result)) == (share == 1)
    assert "an annulus needs 400 periods or more to settle" in result_text(result)


def test_the_tilt_is_that_of_the_rods():
    """Rods that nothing moves; the tilt is from the vertical."""
    still = ring("gravity.z=0", "start.drop=9", "start.speed=0", "start.tilt_deg=10")
    result = md.run(still, periods=2)
    upwards = np.abs(result.rods[:, VELOCITY - 1])
    assert result.tilt_deg == pytest.approx(np.degrees(np.arccos(upwards)).mean(), rel=1e-6)
    assert result.tilt_deg > 5


def test_rods_that_lean_the_other_way_drift_the_other_way():
    """The drift follows the sign of the tilt along the annulus; errors are small against it."""
    found = {}
    for tilt in (35, -35):
        result = md.run(ring("plate.acceleration=5", f"start.tilt_deg={tilt}"), periods=40)
        director = result.rods[:, DIRECTOR:VELOCITY]
        along = around(result.rods, director) * np.sign(director[:, 2])
        assert np.sign(along.mean()) == np.sign(tilt)
        found[tilt] = result.c_x
    assert found[35] > 0 > found[-35]
