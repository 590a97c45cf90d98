"""Scenes: examples load, and what is no scene is refused with its key, value and domain."""

import json
import re
from dataclasses import replace
from math import cos, pi

import pytest

import md
from md.host import step_of
from md.scene import GAP, SCENES, as_dict, load

EXAMPLES = sorted(path.stem for path in SCENES.glob("*.toml"))

DOMAINS = {  # what a message says is allowed, and the nearest values that are not
    "rods.count": ("between 1 and 1000000", 0, 1000001),
    "rods.length": ("between 1 and 1000", 0.999, 1000.1),
    "plate.frequency_hz": ("between 0.001 and 1e6", 9e-4, 1.1e6),
    "gravity.z": ("between -1000 and 1000", -1000.1, 1000.1),
    "contacts.plate.friction": (">= 0", -0.1, -1e-300),
    "start.tilt_deg": ("between -90 and 90", -90.1, 90.1),
    "start.seed": ("between 0 and 9223372036854775807", -1, 2**63),
    "step.size": ("between 1e-12 and 1000", 0, 1000.1),
}


@pytest.mark.parametrize("key", DOMAINS)
def test_a_number_is_held_to_its_domain(key):
    """Also nan, and what is not a number."""
    domain, *beyond = DOMAINS[key]
    integer = key in ("rods.count", "start.seed")
    for value in beyond if integer else (*beyond, float("nan")):
        with pytest.raises(ValueError, match=re.escape(f"{key} must be {domain}, got {value}")):
            load("quasi2d", [f"{key}={value}"])
    for value in (True, "1", "many"):
        wanted = "whole number" if integer else "number"
        with pytest.raises(TypeError, match=f"{key} must be a {wanted}, got {value!r}"):
            load("quasi2d", [f"{key}={json.dumps(value)}"])


def test_a_scene_may_begin_with_a_byte_order_mark(tmp_path):
    """As editors on Windows write it."""
    path = tmp_path / "mine.toml"
    path.write_text((SCENES / "my_rods.toml").read_text(), encoding="utf-8-sig")
    assert load(path) == load("my_rods")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: md.Contacts(rods=1.0), "rods must be"),
        (lambda: md.Scene(rods=5, start=md.Start(tilt_deg=0.0)), "rods must be"),
        (lambda: md.Contact("coulomb", 0.3), "law must be"),
        (lambda: md.run("quasi2d"), "scene must be a"),
        (lambda: md.run("quasi2d", tolerance=0.1), r"scene must be a md\.Scene"),
        (lambda: md.run(load("single_rod"), periods=2.7), "periods must be a whole number"),
        (lambda: load("quasi2d", [None]), "assignments must be texts KEY=VALUE, got None"),
    ],
)
def test_wrong_types_in_python(make, message):
    with pytest.raises(TypeError, match=message):
        make()


def test_an_assignment_may_stand_alone():
    assert load("quasi2d", "rods.count=10").rods.count == 10


# What is a scene


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_load(name):
    """And have a step."""
    scene = load(name)
    assert step_of(scene)[0] > 0
    assert load(SCENES / f"{name}.toml") == scene
    assert load(name, ["start.seed=7"]) == replace(scene, start=replace(scene.start, seed=7))


def test_the_paper_s_row():
    """Fig. 3(b): 40 rods in 43, acos(40/43); Gamma 3.3 at 60 Hz; units of cm and s."""
    scene = load("quasi2d")
    assert cos(scene.tilt) == pytest.approx(40 / 43, rel=1.1 * GAP)
    assert scene.frequency == pytest.approx(60 * (0.6 / 981) ** 0.5)
    assert scene.cm_per_s == pytest.approx((981 * 0.6) ** 0.5)
    assert scene.plate_speed * scene.cm_per_s == pytest.approx(3.3 * 981 / (120 * pi))


def test_a_scene_is_what_its_parts_say():
    """The table of a scene builds the scene again; laws by their constants."""
    scene = load("quasi2d")
    table = as_dict(scene)
    assert table["rods"] == vars(scene.rods)
    assert table["contacts"]["plate"]["law"]["name"] == "constant_restitution"
    assert "plate" not in as_dict(load("quasi2d", ["plate=none", "contacts.plate=none"]))
    json.dumps(table)
    assert scene.digest() == load("quasi2d").digest()
    assert scene.digest() != load("quasi2d", ["start.seed=2"]).digest()
