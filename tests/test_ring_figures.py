"""Figures of the annulus: tiny runs in a store of their own, and made-up arrangements."""

from types import SimpleNamespace

import numpy as np
import pytest

import md
from figures.claims import measure_annulus
from figures.lib import arrangement as order
from figures.lib import runs
from figures.paper import fig04
from md.host import prepare
from md.placement import largest_tilt
from md.scene import from_tables, put

from .quick_figures import MOST_PERIODS, data, tiny


def arrangement(radii, tilts=None):
    """Rods in any order around a ring, leaning along it."""
    azimuth = 2 * np.pi * np.arange(len(radii)) / len(radii)
    lean = np.radians(np.full(len(radii), 20.0) if tilts is None else tilts)
    found = np.zeros((len(radii), 6))
    found[:, 0], found[:, 1] = radii * np.cos(azimuth), radii * np.sin(azimuth)
    found[:, 3], found[:, 4] = -np.sin(lean) * np.sin(azimuth), np.sin(lean) * np.cos(azimuth)
    found[:, 5] = np.cos(lean)
    return np.random.default_rng(1).permutation(found)


# Order


def test_rods_at_random_have_no_order():
    random = np.random.default_rng(3)
    orders = [order.zigzag(arrangement(random.uniform(6.2, 6.9, 40))) for _ in range(200)]
    assert np.mean(orders) == pytest.approx(1 / 40, abs=0.03)  # offsets of 40 sum to zero
    assert np.std(orders) == pytest.approx(1 / np.sqrt(40), rel=0.2)


def test_one_defect_lowers_the_order_little():
    """Of a zig-zag that is perfect without it."""
    radii = np.tile([6.2, 6.9], 20)
    assert order.zigzag(arrangement(radii)) == pytest.approx(1)
    radii[20:] = radii[20:][::-1]
    assert 0.85 < order.zigzag(arrangement(radii)) < 0.95


def test_a_region_of_larger_tilt_is_told_from_scattered_tilts():
    tilts = np.repeat([15.0, 35.0], 20)
    mean, spread, _, contrast, share = order.arrangement(arrangement(np.full(40, 6.5), tilts))
    assert (mean, spread, contrast, share) == pytest.approx((25, 10, 20, 0.5))
    by_turns = order.arrangement(arrangement(np.full(40, 6.5), np.tile([15.0, 35.0], 20)))
    assert by_turns[3] == pytest.approx(0, abs=1e-9)
    even = order.arrangement(arrangement(np.full(40, 6.5)))
    assert (even[1], even[4]) == pytest.approx((0, 0), abs=1e-6)


# Shape of the drift over tilt


def test_two_maxima_and_a_slowdown_are_found():
    tilt = np.array([50, 3, 6, 9, 12, 15, 18, 22, 26, 30, 35, 40, 45.0])
    c_x = np.array([0.2, 1, 2, 3, 4, 5, 6, 5, 3, 4, 5, 3, 1])
    found = fig04.shape(tilt, c_x)
    assert (found["early"], found["late"]) == (18, 35)
    assert found["dip"] == pytest.approx(0.4)
    assert found["bend"] == pytest.approx(0, abs=1e-12)
    assert found["slope"] == pytest.approx(1 / 3)
    assert found["end"] == pytest.approx(0.2 / 6)


def test_one_maximum_has_no_slowdown():
    tilt = np.linspace(3, 50, 20)
    found = fig04.shape(tilt, 30 - np.abs(tilt - 25))
    assert found["dip"] == pytest.approx(0, abs=1e-12)
    assert found["bend"] < 1e-12 < found["slope"]


# Runs


def test_drift_and_tilt_are_those_of_a_run():
    d, scene = data("fig04"), from_tables(put(runs.ANNULUS, {"rods.count": 32}))
    result = md.run(scene, periods=MOST_PERIODS)
    found = order.followed(scene, MOST_PERIODS)
    assert found["c_x_cm_s"] == pytest.approx(result.c_x * np.sqrt(981 * 0.635))
    assert found["tilt_deg"] == result.tilt_deg
    assert (d["still_c_x_error"] > 0).all()
    assert (np.diff(d["still_tilt"]) < 0).all()  # more rods lean less


def test_a_rod_in_the_narrow_gap_leans_by_53_degrees():
    gap = from_tables(put(runs.ANNULUS, fig04.NARROW)).annulus
    assert np.degrees(largest_tilt(gap, 8.0)) == pytest.approx(53, abs=0.01)


@pytest.mark.parametrize("assumed", [False, True])
def test_the_assumed_law_differs_in_the_contacts_alone(assumed):
    """Restitution 0.65 of plate, rods and walls, those of the plane row as well."""
    with tiny():
        plans = fig04.sweeps(True, assumed)
    simple = from_tables(runs.SIMPLE_ANNULUS).contacts.plate.law
    assert simple.restitution == 0.65
    for name, sweep in plans.items():
        contacts = sweep.points[0].scene.contacts
        parts = (contacts.plate, contacts.rods, *([] if name == "plane" else [contacts.wall]))
        assert ({part.law for part in parts} == {simple}) == assumed


def test_rolling_and_friction_are_varied_and_nothing_else():
    with tiny():
        plans = fig04.sweeps(True)
    still, rolling = (plans[name].points[0].scene for name in ("still", "rolling"))
    assert (still.rods.rolling, rolling.rods.rolling) == (False, True)
    assert still.contacts == rolling.contacts
    shaken = {n: {p.scene.annulus.shaken for p in plans[n].points} for n in plans if n != "plane"}
    assert {n for n in shaken if shaken[n] == {False}} == {"rest", "rest_gamma"}
    wall = [point.scene.contacts for point in plans["wall"].points]
    assert [c.wall.friction for c in wall] == [0.1, 0.1, 0.3, 0.3]
    assert {c.plate.friction for c in wall} == {c.rods.friction for c in wall} == {0.3}
    plane = plans["plane"].points[0].scene
    assert plane.rods.length == still.rods.length
    assert plane.rods.diameter_cm == still.rods.diameter_cm
    assert plane.rods.inertia == still.rods.inertia == "solid"


def test_the_arrangement_is_followed_in_time():
    d, scene = data("fig05"), from_tables(put(runs.ANNULUS, {"rods.count": 32}))
    engine = prepare(scene)
    engine.go(MOST_PERIODS * engine.per)
    np.testing.assert_array_equal(d["rods_32"], engine.rods[:, :6])
    assert d["time"].tolist() == [2, 4, 6, 8]
    assert d["series"].shape == (3, 2, len(d["time"]), len(order.MEASURED))
    np.testing.assert_allclose(d["mean"], d["series"][:, :, 2:, 0].mean(axis=(1, 2)))
    radius = np.hypot(*d["rods_32"][:, :2].T)
    gap = runs.ANNULUS_SCENE.annulus
    assert gap.inner + 0.45 < radius.min()
    assert radius.max() < gap.outer - 0.45


# Claims


def made_up(d):
    """Evidence of which every figure has these data."""
    return SimpleNamespace(figure=lambda name: d)


def test_the_geometry_is_that_of_the_gap():
    found = measure_annulus.geometry(made_up(data("fig04")))
    flat, round_ends = found["flat"], found["round"]
    gap, half = runs.ANNULUS_SCENE.annulus, (runs.ANNULUS_SCENE.rods.length - 1) / 2
    reach = np.sqrt((gap.outer - 0.5) ** 2 - (gap.inner + 0.5) ** 2)
    assert round_ends.value == pytest.approx(np.degrees(np.arcsin(reach / half)))
    assert 45 < flat.value < round_ends.value


def test_numbers_find_what_was_put_in():
    mu, gamma = np.array([0, 0.3, 1.0]), np.array([1.2, 1.6, 2.0, 3.0, 4.0])
    moving = 2 * np.clip(gamma - 1.5, 0, None)
    d = {"wall": mu, "wall_c_x": np.array([10, 4, 0.5]), "wall_c_x_error": np.full(3, 1e-3)}
    d |= {"gamma": gamma, "gamma_c_x": np.stack([moving] * 3, axis=1)}
    d["gamma_c_x_error"] = np.full((5, 3), 1e-3)
    d |= {"rest_gamma_c_x": np.clip(gamma - 1.7, 0, None), "rest_gamma_c_x_error": np.full(5, 1e-3)}
    walls = measure_annulus.walls(made_up(d))
    values = {key: number.value for key, number in walls.items()}
    assert values == pytest.approx({"rise": np.log(8) / np.log(0.3), "all": 0.05, "paper": 2.5})
    over = measure_annulus.drift_over_gamma(made_up(d))
    assert over["onset"].error == pytest.approx(0.2)
    values = {key: number.value for key, number in over.items()}
    expected = {
        **dict.fromkeys(("onset", "visible"), 1.4),
        "rest": 1.8,
        "bend": 0,
        "slope": 2,
        "zero": 1.5,
    }
    assert values == pytest.approx(expected, abs=1e-9)


def test_rolling_rods_are_compared_at_equal_numbers():
    still = np.array([9.0, 4, 3, 5, 5])
    d = {"count": np.array([56, 48, 44, 40, 36]), "still_tilt": np.array([9.0, 19, 23, 28, 34])}
    d |= {"rolling": np.array([48, 44, 40]), "rolling_tilt": np.array([20.0, 24, 29])}
    d |= {"still_c_x": still, "rolling_c_x": 2 * still[1:4]}
    d |= {f"{name}_error": np.full_like(d[name], 1e-6) for name in d if name != "count"}
    assert measure_annulus.rolling(made_up(d))["faster"].value == pytest.approx(2)


def test_a_region_is_said_to_appear_where_its_contrast_does():
    d = {"count": np.array([56, 50, 44]), "mean": np.array([10.0, 16, 24])}
    d |= {"zigzag": np.array([1, 0.8, 0.2]), "contrast": np.array([1.0, 3, 9])}
    d |= {"share": np.array([0, 0.1, 0.5]), "spread": np.array([1.0, 2, 6])}
    d |= {f"{name}_error": np.full(3, 1e-6) for name in order.MEASURED}
    numbers = measure_annulus.zigzag(made_up(d))
    found = {key: number.value for key, number in numbers.items()}
    assert (found["order"], found["tilt"], found["leaning"]) == (1, 10, 24)
    assert found["broken"] == pytest.approx(20)
    assert found["appears"] == pytest.approx(16 + 8 / 3)
    assert (found["share"], found["contrast"], found["spread"]) == (0.5, 9, 6)
