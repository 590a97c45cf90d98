"""Scenes in cm, cm/s and Hz: the same as in their own units, or refused in words."""

import json
import tomllib
from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from numpy.testing import assert_allclose

import md
from md.domains import as_dict, flat
from md.scene import from_tables, keys, put
from md.store import table
from md.sweep import execute, expand
from md.units import TWINS, error_of, in_cm, labelled

from .command_line import enter

SCENE = """
rods = { count = 3, length = 8.0, diameter_cm = 0.5 }
plate = { acceleration = 3.0, frequency_hz = 50 }
box = { length = 4.0 }
gravity = {}
contacts.plate = { stiffness = 1e4, tangential_ratio = 3, friction = 0.3 }
contacts.rods = { stiffness = 1e4, tangential_ratio = 3, friction = 0.3 }
"""
TABLES = tomllib.loads(SCENE)
RING = {"box": "none", "annulus.inner": 4.0, "annulus.outer": 6.0, "contacts.wall.friction": 0.3}
# Key: value in it, key that it stands for, value of that; with d = 1/2 cm lengths lose no bit.
SAME = {
    "rods.length_cm": (5.08, "rods.length", 10.16),
    "plate.amplitude_cm": (0.025, "plate.acceleration", 0.025 * (100 * pi) ** 2 / 981),
    "plate.velocity_cm_s": (9.5, "plate.acceleration", 9.5 * 100 * pi / 981),
    "box.length_cm": (2.25, "box.length", 4.5),
    "annulus.inner_cm": (1.75, "annulus.inner", 3.5),
    "annulus.outer_cm": (3.5, "annulus.outer", 7.0),
    "start.speed_cm_s": (4.0, "start.speed", 4 / sqrt(981 * 0.5)),
    "start.drop_cm": (0.3, "start.drop", 0.6),
}


@pytest.mark.parametrize("key", SAME)
def test_a_scene_in_cm_is_the_scene(key):
    """It is, and back; bit for bit where only the diameter counts, a power of two."""
    assert set(SAME) == set(TWINS)
    given, own, value = SAME[key]
    base = put(TABLES, RING if key.startswith("annulus") else {})
    found, same = from_tables(put(base, {key: given})), from_tables(put(base, {own: value}))
    if key.endswith("cm") and not key.startswith("plate"):
        assert found == same
    part, name = own.split(".")
    of_part = getattr(found, part)
    assert getattr(of_part, name) == pytest.approx(value, rel=1e-15, abs=0)
    assert replace(found, **{part: replace(of_part, **{name: value})}) == same
    assert in_cm(as_dict(found))[key] == pytest.approx(given, rel=1e-15, abs=0)


def test_what_comes_later_takes_the_place():
    """It does so of what said the same in the file, either way round; tables stay as they were."""
    cm = {"rods.diameter_cm": 0.635, "rods.length_cm": 5.08, "box.length_cm": 2.54}
    found = from_tables(put(TABLES, cm))
    assert found == from_tables(put(TABLES, {"rods.diameter_cm": 0.635}))  # 5.08/0.635 is 8
    assert md.load("my_rods", ["plate.acceleration=2"]).plate == md.Plate(2.0, 60.0)
    found = md.load("my_rods", ["plate.velocity_cm_s=8", "rods.diameter_cm=0.5"])
    assert found.plate.acceleration == pytest.approx(8 * 120 * pi / 981)
    assert found.rods.length == 5.08 / 0.5
    found = md.load("my_rods", ["plate.acceleration=none", "gravity=none", "gravity.x=none"])
    assert (found.plate, found.gravity) == (md.Plate(), None)


# Runs


def test_a_sweep_along_an_amplitude(path):
    """The axis is in cm, its points are those of the accelerations; results have either unit."""
    sweep = expand({"periods": 124, "axes": [{"plate.amplitude_cm": [0.02, 0.03]}]}, TABLES)
    execute(sweep, path, workers=1)
    gamma = [point.scene.plate.acceleration for point in sweep.points]
    assert_allclose(gamma, sweep.values("plate.amplitude_cm") * (100 * pi) ** 2 / 981)
    same = expand({"periods": 124, "axes": [{"plate.acceleration": gamma}]}, TABLES)
    assert np.isfinite(same.gather(path, "c_x")[0]).all()
    head, *lines = map(str.split, enter("md results", path).out.splitlines())
    assert head[:4] == ["plate.acceleration", "c_x", "c_x_stderr", "c_x_cm_s"]
    assert len(lines) == 2
    for row in table(path)[1]:
        assert (row["rods.length"], row["rods.length_cm"]) == (8.0, 4.0)
        for name in ("c_x", "c_x_stderr"):
            assert row[f"{name}_cm_s"] == pytest.approx(row[name] * sqrt(981 * 0.5))


def test_what_a_run_prints_in_cm(tmp_path):
    """It prints rods, plate, drift and time; JSON says what one unit is, and what was run."""
    command = (
        "md run my_rods --periods 124 --set rods.count=3 --set box.length_cm=2"
        " --set contacts.plate.stiffness=1e4 --set contacts.rods.stiffness=1e4"
    )
    printed = enter(command, "--trajectory", tmp_path / "a.xyz").out.splitlines()
    assert printed[0] == "rods         3 of 5.08 by 0.635 cm, in a box of 2 cm that repeats"
    assert "periods      124 = 2.067 s; the first 24 are left out of the means" in printed
    found = json.loads(enter(command, "--json").out, parse_constant=pytest.fail)
    units, cm = found["units"], found["scene_in_cm"]
    assert f"= {found['c_x_cm_s']:.4g} +- {found['c_x_stderr_cm_s']:.2g} cm/s" in printed[2]
    assert found["c_x_cm_s"] == pytest.approx(found["c_x"] * units["velocity_cm_s"])
    assert found["rod_steps"] == 3 * 124 * found["steps_per_period"]
    assert units["time_s"] == pytest.approx(sqrt(0.635 / 981))
    assert (cm["plate.amplitude_cm"], units["length_cm"]) == pytest.approx((0.025, 0.635))
    assert f" cm_per_s={units['velocity_cm_s']!r} " in (tmp_path / "a.xyz").read_text()


# Units of what comes out


@pytest.mark.parametrize(
    ("scene", "change"), [("annulus", "rods.count=9"), ("my_rods", "plate.acceleration=3")]
)
def test_what_is_measured_and_chosen_has_a_unit_and_a_name(scene, change):
    """Results, their errors, columns of records, keys that an axis may have.

    As arrays with labels, touches and landings lie along axes of their own; what is counted has no
    unit, so that a plot has no empty brackets.
    """
    rows = []
    result = md.run(md.load(scene, change), periods=3, observe=rows.append)
    apart = {"scene", "versions", "scene_digest", "finished", "settled"}
    results = {key for key in flat(result.as_dict()) if key.partition(".")[0] not in apart}
    touches, landings = md.records.touches(rows, result), md.records.landings(rows, result)
    assert (*touches.dims, *landings.dims) == ("touch", "landing")
    assert "units" not in landings.touches.attrs
    assert touches.c_x_before.attrs["units"] == "sqrt(g d)"
    names = results.union({"phases"}, touches, landings)
    names |= {key.rpartition(": ")[2].partition(" (")[0] for key, _ in keys()}
    found = labelled(dict.fromkeys(names, ((), 0.0)))
    assert len(found) == len(names) > 80
    said = {array.attrs["long_name"] for array in found.values()}
    assert not said & names - {"touches", "regime", "phase"}
    for error in (name for name in results if "stderr" in name):
        (value,) = (name for name in results - {error} if error_of(name) == error)
        one, other = (found[name.replace(".", "_")].attrs for name in (value, error))
        assert other == {**one, "long_name": f"standard error: {one['long_name']}"}
