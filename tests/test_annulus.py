"""Scenes in an annulus: what they may hold, runs, resume, trajectories."""

import json

import numpy as np
import pytest

import md
from md.__main__ import main
from md.host import prepare
from md.kernels.codes import DIRECTOR, PLACE, TURN, VELOCITY
from md.kernels.touches import A_X, BEFORE, FLIGHT
from md.placement import largest_tilt, overlap, placed
from md.result_text import result_text
from md.scene import GAP
from md.sources import imported

from .test_row_resume import bits

SMALL = (
    *("rods.count=6", "rods.length=4", "annulus.inner=1", "annulus.outer=2.8", "step.size=none"),
    *(f"contacts.{part}.stiffness=1e5" for part in ("plate", "rods", "wall")),
)

ROLLING = (  # between walls at rest, on a plate without a spring
    *("rods.rolling=true", "annulus.shaken=false"),
    *("contacts.plate.law=coulomb", "contacts.plate.tangential_ratio=none"),
)


def ring(*assignments):
    """A few short soft rods in a narrow gap."""
    return md.load("annulus", [*SMALL, *assignments])


@pytest.fixture(scope="module")
def whole():
    return md.run(ring("plate.acceleration=5"), periods=6)


def test_rods_bounce_and_keep_to_the_gap(whole):
    rods, scene = whole.rods, whole.scene
    assert whole.touches["per_rod_and_period"]["mean"] > 0.1
    ends = [rods[:, :2] + s * rods[:, 3:5] * (scene.rods.length - 1) / 2 for s in (-1, 0, 1)]
    rho = np.hypot(*np.concatenate(ends).T)
    assert rho.min() > scene.annulus.inner + 0.5 - 0.05
    assert rho.max() < scene.annulus.outer - 0.5 + 0.05
    np.testing.assert_allclose(np.linalg.norm(rods[:, DIRECTOR:VELOCITY], axis=1), 1, atol=1e-12)


@pytest.mark.parametrize("seconds", [1e-4, 10.0])
def test_how_a_run_is_cut_into_calls_does_not_matter(whole, monkeypatch, seconds):
    monkeypatch.setattr(md.host, "CALL_SECONDS", seconds)
    assert bits(md.run(whole.scene, periods=6)) == bits(whole)


def test_a_run_goes_on_from_its_checkpoint(whole, tmp_path):
    path = tmp_path / "ring.npz"
    md.run(whole.scene, periods=2, checkpoint=path)
    assert bits(md.run(whole.scene, periods=6, checkpoint=path)) == bits(whole)


def test_rods_that_lean_the_other_way_drift_the_other_way():
    """The drift follows the sign of the lean; errors are small against it."""
    found = []
    for tilt in (35, -35):
        result = md.run(ring("plate.acceleration=5", f"start.tilt_deg={tilt}"), periods=40)
        lean = result.annulus["lean_deg"]["mean"]
        assert np.sign(lean) == np.sign(tilt)
        found.append(result.c_x)
    assert found[0] > 0 > found[1]


@pytest.mark.parametrize("tilt", [30, -30])
def test_rods_that_lean_either_way_start_clear_of_each_other(tilt):
    scene = md.load("annulus", [f"start.tilt_deg={tilt}"])
    rods = prepare(scene).rods
    assert overlap(scene.annulus, rods, 3.5) <= -GAP
    assert (np.sign(rods[:, 0] * rods[:, 4] - rods[:, 1] * rods[:, 3]) == np.sign(tilt)).all()


def test_rods_are_placed_without_a_kernel():
    """So that what compiles is the march of the run, whose time is told apart."""
    assert {name for name in imported("placement") if "kernels" in name} == {"kernels.codes"}


@pytest.mark.parametrize("count", [23, 40, 56])
def test_rods_start_apart_from_each_other_and_the_walls(count):
    """By `GAP` at least, the lower caps on one plane; none leans more than a rod can."""
    gap, length = md.load("annulus").annulus, 8.0
    rods = placed(gap, count, length)
    half = (length - 1) / 2
    assert overlap(gap, rods, half) <= -GAP
    np.testing.assert_allclose(rods[:, 2] - half * rods[:, 5], 0.5, atol=1e-12)
    assert np.arccos(rods[:, 5]).max() < largest_tilt(gap, length)


@pytest.mark.parametrize("differs", [(), ROLLING], ids=["shaken walls", "rolling"])
def test_the_ledger_closes_as_the_step_shrinks(differs):
    """Residual over turnover: second order to a quarter, as in a row (`test_row_run`)."""
    found, lost = [], {}
    for size in (4e-4, 1e-4):
        thrown = ("plate.acceleration=5", "start.speed=0.5", "step.coarse=true", *differs)
        lost = md.run(ring(*thrown, f"step.size={size}"), periods=3).energy
        found.append(abs(lost["residual"]) / sum(map(abs, lost.values())))
    assert all(value > 1e-3 for name, value in lost.items() if name not in ("change", "residual"))
    assert np.log2(found[0] / found[1]) / 2 > 1.75, found
    assert found[0] < 2e-3, found


@pytest.mark.parametrize("lean", [0, 1e-9, -1e-9, 0.1, -0.1])
def test_a_touch_is_seen_in_the_plane_of_the_rod(lean):
    """x leads around the annulus, for an upright rod as for one that leans either way."""
    engine = prepare(ring("plate.acceleration=5", "rods.count=1", "start.speed=0"))
    up = np.cos(lean)
    engine.rods[0] = 1.9, 0, engine.plate_height + 2.1, 0, np.sin(lean), up, 0.1, 0.3, -1, 0, 0, 0
    while not engine.record.count[0]:
        engine.go(100)
    touch = engine.record.rows[0]
    assert touch[BEFORE] == pytest.approx(0.3, abs=5e-3)  # an upright rod's plane turns as it flies
    assert touch[A_X] == pytest.approx(-1.5 * np.sin(lean), abs=1e-12)
    assert np.isfinite(touch[:FLIGHT]).all()
    assert np.abs(touch[BEFORE:]).max() < 20


def axial(rods):
    """Largest part of the spin vectors along the rods."""
    return np.abs((rods[:, DIRECTOR:VELOCITY] * rods[:, TURN:]).sum(axis=1)).max()


def test_rolling_is_an_effect(whole):
    """Absent, it is `None`; present, rods that rub on walls begin to roll."""
    assert prepare(whole.scene).effects.rolling is None
    assert axial(whole.rods) < 1e-12
    assert prepare(ring(*ROLLING)).effects.rolling > 0
    assert axial(md.run(ring(*ROLLING, "plate.acceleration=5"), periods=6).rods) > 1e-6


def test_a_cap_that_friction_holds_does_not_slip_as_its_rod_rolls():
    """On a plate at rest, while the rod turns about the vertical and rolls: second order."""
    still = "rods.count=1", "start.speed=0", "step.size=2e-4", "contacts.plate.friction=50"
    engine = prepare(ring(*ROLLING, *still, "plate.acceleration=5"))
    for motion in engine.plate:
        motion[:] = 0
    half, rolling, rod = engine.effects.half_length, engine.effects.rolling, engine.rods[0]
    up, a = np.array([0, 0, 1]), np.array([0, 0.3, 1]) / np.hypot(0.3, 1)
    w = up - a * (up @ a) + a * 3 / (1 + rolling)
    height = 0.5 - 1e5 ** (-2 / 3) + half * a[2]
    rod[:] = 1.9, 0, height, *a, *np.cross(up, half * a), *w
    engine.go(300, engine.series(1))
    a, w = rod[DIRECTOR:VELOCITY], rod[TURN:]
    arm = -half * a + (0, 0, half * a[2] - rod[PLACE + 2])
    slip = rod[VELOCITY:TURN] + np.cross(w + rolling * (w @ a) * a, arm)
    assert np.abs(slip[:2]).max() < 1e-7


def test_axial_inertia():
    """A sphere has 1/10, a long cylinder 1/8."""
    assert md.Rod(1.0).axial_gyration_squared == pytest.approx(0.1)
    assert md.Rod(1e6).axial_gyration_squared == pytest.approx(0.125, rel=1e-5)


def test_what_no_effect_needs_is_not_there():
    smooth = [f"contacts.{part}.friction=0" for part in ("plate", "rods", "wall")]
    engine = prepare(ring(*smooth))
    assert engine.state.springs is None
    assert engine.state.listed.springs is None
    bare = prepare(ring(), ledger=False, touches=False)
    assert [*bare.watchers] == [None] * 3
    alone = prepare(ring("contacts.rods=none", "rods.count=1", "start.tilt_deg=10"))
    assert alone.state.listed is None
    assert alone.effects.between is None
    assert prepare(ring("annulus.shaken=false")).effects.shaken is None


def test_the_command(capsys):
    sets = [part for change in SMALL for part in ("--set", change)]
    assert main(["run", "annulus", *sets, "--periods", "8"]) == 0
    out = capsys.readouterr().out
    assert "V_z/V_0" in out
    assert "slip-stick" in out
    assert "an annulus needs 400 periods or more to settle" in out
    assert main(["run", "annulus", *sets, "--periods", "3", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["annulus"]["lean_deg"]["mean"] is not None
    assert main(["run", "annulus", "--set", "contacts.wall=none"]) == 2


@pytest.mark.parametrize(
    ("gravity", "gamma", "share"), [(-1, 3.3, 0.0), (-1, 1e-6, 0.0), (0, 3.3, 1.0)]
)
def test_a_wedged_ring_is_reported(gravity, gamma, share):
    """Rods that hang over the plate for good, as between walls that hold them."""
    changes = f"gravity.z={gravity}", f"start.drop={gravity + 1}", "start.speed=0"
    result = md.run(ring(*changes, f"plate.acceleration={gamma}"), periods=24)
    assert result.as_dict()["annulus"]["wedged"]["mean"] == share
    said = "wedged: 100% of the rods have not touched the plate for 21 periods"
    assert (said in result_text(result)) == (share == 1)


def test_an_odd_ring_starts_tilted_as_an_even_one():
    """It is no zig-zag all around: one rod stands between the walls, with more room beside it."""
    gap = md.load("annulus").annulus
    tilts = [np.arccos(placed(gap, count, 8.0)[:, 5]).mean() for count in (51, 52)]
    assert tilts[0] > tilts[1] > 0.2


def test_too_deep_in_a_wall_is_an_error():
    engine = prepare(ring())
    engine.rods[0, :2] *= 0.05
    with pytest.raises(md.RunError, match=r"deep in a wall|with each other"):
        engine.go(10)


def test_a_film_rolls_it_out():
    """Places along the middle circle, without jumps, and the lean along it."""
    from figures.pages import movie

    scene = ring("plate.acceleration=5", "start.tilt_deg=30")
    film = movie.record(scene, 3, 4)
    assert film.length == pytest.approx(2 * np.pi * scene.annulus.middle)
    assert np.abs(np.diff(film.x, axis=0)).max() < 0.5
    assert np.degrees(film.tilt[0]).mean() == pytest.approx(30, abs=2)
    assert movie.segments(film, 0)[0].shape[1:] == (2, 2)


def test_tilt_and_lean_are_those_of_the_rods():
    """Rods that nothing moves; the tilt is from the vertical, the lean along the annulus."""
    still = ring("gravity.z=0", "start.drop=9", "start.speed=0", "start.tilt_deg=10")
    result = md.run(still, periods=2)
    x, y, _ = result.rods[:, PLACE:DIRECTOR].T
    a = result.rods[:, DIRECTOR:VELOCITY]
    up = np.abs(a[:, 2])
    along = np.sign(a[:, 2]) * (x * a[:, 1] - y * a[:, 0]) / np.hypot(x, y)
    assert result.tilt_deg == pytest.approx(np.degrees(np.arccos(up)).mean(), rel=1e-6)
    assert result.tilt_deg > 5
    lean = result.annulus["lean_deg"]["mean"]
    assert lean == pytest.approx(np.degrees(np.arctan2(along, up)).mean(), rel=1e-6)
    assert abs(lean) > 1
