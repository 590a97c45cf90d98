"""Landings beside the impact map, and the animation of a scene."""

from itertools import product
from math import radians

import matplotlib.pyplot as plt
import numpy as np
import pytest
from PIL import Image

import md
from figures.__main__ import main
from figures.checks import landing_census
from figures.checks.census import Census, census, compared, measures
from figures.pages import movie
from impact import ContactGeometry, Regime, classify, collide
from md.host import prepare
from md.kernels import touches
from md.rod import Rod

from .quick_figures import MOST_PERIODS, data

SETTINGS = ["contacts.plate.law=coulomb", "contacts.rods.tangential_ratio=5"]


def lone(stiffness):
    """Rods thrown on the plate one by one, all their touches; each is a block."""
    settings = ["rods.count=150", "start.speed=0.5", "start.drop=0.1"]
    scene = md.load("single_rod", [*settings, f"contacts.plate.stiffness={stiffness}"])
    kept = []
    run = md.run(scene, periods=5, observe=kept.append, ledger=False)
    rows = np.concatenate(kept)
    found = compared(rows, scene, run.dt, run.steps_per_period)
    return Census(np.arange(len(rows)), len(rows), **found)


@pytest.fixture(scope="module")
def row():
    """A row of twenty rods at 33 degrees, friction of the plate as a constraint."""
    settings = ["rods.count=20", "box.length=24", "step.size=none"]
    return census(md.load("quasi2d", settings + SETTINGS), 125)[0]


def written(scene, tilt, cap, before, restitution, kick=0.0, duration=0.0):
    """A row of the record whose outcome is the map's, and a kick about the contact point."""
    k = np.sqrt(Rod(scene.rods.length, scene.rods.inertia).gyration_squared)
    half, plate = (scene.rods.length - 1) / 2, scene.plate_speed * np.sin(np.pi / 5)
    a_x, a_z = cap * half * np.sin(tilt), cap * half * np.cos(tilt) - 0.5
    how = {"friction": scene.contacts.plate.friction, "restitution": restitution}
    rod = ContactGeometry(-a_x, -a_z, k)
    hit = collide(*before, geometry=rod, plate_velocity=plate, **how)
    row = np.zeros(touches.WIDTH)
    row[touches.STEP] = 100 - duration  # of 1000: a tenth of the period as it ends
    row[[touches.A_X, touches.A_Z, touches.PLATE]] = a_x, a_z, plate
    row[touches.BEFORE : touches.BEFORE + 3] = before
    # The direction that no force at the contact point can move: normal to (A_z, -A_x)/k and that.
    turn = np.array([-a_z, a_x, k]) / np.sqrt(a_x**2 + a_z**2 + k**2) * kick
    after = np.array([hit.c_x, hit.c_z, hit.omega]) + turn / [1, 1, k]
    row[touches.AFTER : touches.AFTER + 3] = after
    row[touches.APPROACH] = before[1] - before[2] * a_x - plate
    row[touches.LEAVING] = after[1] - after[2] * a_x - plate
    row[touches.REGIME] = hit.regime
    row[touches.DURATION] = duration
    return row


CASES = [
    (radians(20), -1, (0.5, -1.0, 0.0), 0.65),
    (radians(40), -1, (0.1, -0.9, 0.0), 0.3),
    (radians(-35), -1, (0.9, -0.2, -0.05), 0.9),
    (radians(130), 1, (0.4, -1.0, 0.02), 0.0),
]


@pytest.mark.parametrize(("kick", "duration"), [(0, 0), (0.01, 0), (0, 50)])
def test_what_the_map_makes_is_found_without_error(kick, duration):
    """Arms, signs, plate velocity and restitution, for both ends of the rod.

    A turn about the contact point, which the plate cannot give, is found as it was given, and the
    map misses by no less; gravity during the contact is no such kick.
    """
    scene = md.load("single_rod", [] if duration else ["gravity=none"])
    rows = np.array([written(scene, *case, kick=kick, duration=duration) for case in CASES])
    rows[:, touches.AFTER + 1] -= duration * 1e-4
    found = compared(rows, scene, 1e-4, 1000)
    np.testing.assert_allclose(found["kick"], kick, rtol=1e-12, atol=1e-14)
    assert np.all(found["residual"] >= kick * (1 - 1e-12))
    if not (kick or duration):
        np.testing.assert_allclose(found["residual"], 0, atol=1e-14)
        np.testing.assert_allclose(found["allowed"], 0, atol=1e-14)
        np.testing.assert_allclose(found["restitution"], [case[3] for case in CASES], atol=1e-14)
        np.testing.assert_array_equal(found["mapped"], found["seen"])
        assert set(found["seen"]) == {1, 2, 3}


def test_nothing_approaches():
    """A rod that is pressed on without approach: the map leaves it as it is."""
    scene = md.load("single_rod")
    row = written(scene, radians(20), -1, (0.1, 0.5, 0.0), 0.5)
    found = compared(row[None], scene, 1e-4, 1000)
    assert found["restitution"] == -np.inf
    assert found["mapped"] == Regime.NO_IMPACT
    assert found["jump"] == found["residual"] == 0


def test_lone_rods_follow_the_map():
    """Errors fall with the contact's duration, k_n^(-2/5), and are gravity's and the plate's."""
    errors = []
    for rods in (lone(5e5), lone(5e7)):
        found = measures(rods)
        assert rods.isolated.all()
        assert len(rods.jump) > 200
        kinds = (found[name][0] for name in ("residual", "allowed", "kick"))
        errors.append([*kinds, np.average(rods.duration, weights=rods.jump)])
        assert found["agree_number"][0] > 0.97
        assert found["agree_allowed_number"][0] > 0.99
    for before, after in zip(*errors, strict=True):
        assert 2.5 < before / after < 12  # 100^(2/5) = 6.3
    residual, allowed, kick, duration = errors[1]
    assert max(50 * allowed, 20 * kick) < residual < 0.012
    assert duration < 0.006


def test_isolated_landings_of_a_row_follow_the_map(row):
    found = measures(row)
    assert row.isolated.sum() > 100
    assert found["isolated_residual"][0] < 0.06
    assert found["isolated_allowed"][0] < 3e-4
    assert found["isolated_kick"][0] < 1e-3
    assert found["isolated_agree_number"][0] > 0.96
    assert found["isolated_agree_allowed_number"][0] > 0.995


def test_pushed_landings_do_not(row):
    """And of 500 landings at most one has an error below half of what other rods gave."""
    found = measures(row)
    assert 0.6 < found["shared"][0] < 0.95
    assert found["pushed_residual"][0] > 5 * found["isolated_residual"][0]
    assert found["pushed_allowed"][0] > 0.2
    assert found["pushed_kick"][0] > 100 * found["isolated_kick"][0]
    some = row.duration < 0.1  # longer, and gravity weighs more than the impact
    assert np.mean(row.residual[some] > 0.5 * row.kick[some]) > 0.998


def test_means_are_those_of_the_landings(row):
    """Weighted and not, and shares sum to one; a block is a period."""
    found = measures(row)
    for part, how in product(("", "isolated_", "pushed_"), ("", "_number")):
        shares = [found[f"{part}{name}{how}"] for name in ("slide", "stick", "reversal")]
        assert sum(mean for mean, _ in shares) == pytest.approx(1, abs=1e-12)
        assert all(0 <= mean <= 1 and error >= 0 for mean, error in shares)
    alone = row.isolated
    assert found["isolated_slide_number"][0] == pytest.approx((row.seen[alone] == 1).mean())
    expected = row.residual[~alone].sum() / row.jump[~alone].sum()
    assert found["pushed_residual"][0] == pytest.approx(expected)
    assert found["shared"][0] == pytest.approx(row.jump[~alone].sum() / row.jump.sum())
    assert 0 <= row.block.min() <= row.block.max() < row.blocks <= 100


def test_reversal_begins_at_the_line_drawn():
    half, k = 4.25, 9.5 / 12**0.5
    for offset, regime in ((-0.1, Regime.SLIP_STICK), (0.1, Regime.SLIP_REVERSAL)):
        tilt = radians(landing_census.reversal_tilt() + offset)
        rod = ContactGeometry(half * np.sin(tilt), half * np.cos(tilt) + 0.5, k)
        assert classify(0.1, -1.0, geometry=rod, friction=0.3, restitution=0.65) == regime


def test_the_data_are_those_of_the_census():
    """Shares of the landings; where nothing was isolated, nan."""
    d = data("landing_census")
    scene = md.load("quasi2d", ["step.size=none", *SETTINGS, "plate.acceleration=2"])
    assert d["gamma_slide"][0, 0] == measures(census(scene, MOST_PERIODS)[0])["slide"][0]
    assert d["constraint_shared"][0, 0] == 1
    assert np.isnan(d["constraint_isolated_residual"][0, 0])


@pytest.fixture(scope="module")
def film():
    """Fast rods in a short box: each of them passes its end."""
    settings = ["rods.count=5", "box.length=7", "step.size=none", "plate.acceleration=6"]
    laws = ["contacts.plate.tangential_ratio=5", "contacts.rods.tangential_ratio=5"]
    return movie.record(md.load("quasi2d", settings + laws), periods=45, frames=2)


def test_film_is_the_run(film):
    """The same rods as a run without a film leaves, and none below the plate."""
    engine = prepare(film.scene)
    engine.go(29 * engine.per)
    at = np.flatnonzero(film.time == 29)[0]
    np.testing.assert_array_equal(film.x[at], engine.rods[:, 0])
    np.testing.assert_array_equal(film.z[at], engine.rods[:, 1])
    np.testing.assert_allclose(np.tan(film.tilt[at]), engine.rods[:, 2] / engine.rods[:, 3])
    assert film.time[0] == 0
    assert np.all(film.x[0] == (np.arange(5) + 0.5) * 1.4)
    assert film.pictures == 90
    assert np.all(film.tips.min(axis=1) > film.plate - 0.02)
    assert np.ptp(film.plate) == pytest.approx(
        2 * film.scene.plate_speed / (2 * np.pi * film.scene.frequency), rel=0.02
    )


def test_picture_shows_each_rod_where_it_is(film):
    """Images fill the box; lengths and widths are true; the trail does not cross the picture."""
    picture = movie.Picture(film)
    try:
        picture.show(80)
        axes, number = movie.segments(film, 80 * film.every)
        picture.figure.canvas.draw()
        drawn = np.array(picture.rods.get_segments())
        trail = picture.trail.get_segments()
        (width,) = picture.outline.get_linewidths()
        (left, _), (right, _) = picture.row.transData.transform([(0, 0), (1, 0)])
        words = picture.words.get_text()
    finally:
        plt.close(picture.figure)
    assert width == pytest.approx((right - left) * 72 / movie.DPI, rel=0.01)
    np.testing.assert_allclose(drawn, axes)
    assert set(number) == set(range(5))
    np.testing.assert_allclose(np.linalg.norm(axes[:, 1] - axes[:, 0], axis=1), 8.5)
    centres = axes.mean(axis=1)[:, 0]
    off = (centres - film.x[80 * film.every][number]) / 7
    np.testing.assert_allclose(off, np.round(off), atol=1e-9)
    inside = (centres >= 0) & (centres < 7)
    assert sorted(number[inside]) == [0, 1, 2, 3, 4]
    assert len(trail) > 1
    assert all(np.all(np.abs(np.diff(part[:, 0])) < 1) for part in trail)
    assert "t =  40.0" in words
    assert f"tilt {np.degrees(film.tilt[80 * film.every].mean()):.1f}°" in words


def test_command_writes_a_gif_that_loops(tmp_path, capsys):
    out = tmp_path / "row.gif"
    settings = ["--set", "rods.count=4", "--set", "box.length=5", "--set", "step.size=4e-5"]
    command = ["movie", "quasi2d", *settings, "--periods", "3", "--frames", "4"]
    assert main([*command, "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert printed.out == f"{out}  12 frames\n"
    assert printed.err == ""
    with Image.open(out) as gif:
        assert gif.n_frames == 12
        assert gif.info["loop"] == 0
        assert gif.size[0] == 600
        colours = {colour for _, colour in gif.convert("RGB").getcolors()}
    assert {(255, 255, 255), (191, 215, 234), (213, 94, 0)} <= colours
    assert list(tmp_path.iterdir()) == [out]
    assert main([*command, "--out", str(tmp_path / "folder")]) == 0
    assert (tmp_path / "folder" / "quasi2d.gif").exists()


def test_movie_of_what_has_no_plate():
    settings = ["plate=none", "contacts.plate=none", "contacts.rods=none", "rods.count=3"]
    scene = md.load("quasi2d", settings)
    picture = movie.Picture(movie.record(scene, periods=1, frames=1))
    picture.show(0)
    plt.close(picture.figure)
    assert picture.plate is picture.trace is None
