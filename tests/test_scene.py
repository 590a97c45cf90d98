"""Scenes: examples load, and what is no scene is refused with its key, value and domain."""

import json
import re
from dataclasses import replace
from math import acos, degrees, pi

import pytest

import md
from md.__main__ import main
from md.host import prepare
from md.scene import SCENES, as_dict, load

from . import command_line

EXAMPLES = sorted(path.stem for path in SCENES.glob("*.toml"))

BAD = {  # KEY=VALUE for the row: what the error says
    "rodz.count=3": "rodz is not a key of a scene; known there: rods, plate",
    "rods.number=3": "rods.number is not a key of a scene; known there: count, length",
    "rods.spin=true": "rods.spin is of an earlier version: write rods.rolling in its place",
    "box.width=3": "box.width is not a key",
    "contacts.walls.friction=1": "contacts.walls is not a key",
    "contacts.plate.mu=1": "contacts.plate.mu is not a key",
    "contacts.plate.stiffness.x=1": "contacts.plate.stiffness must be a number, got {'x': 1}",
    "rods=3": "rods must be a table, got 3",
    "box=[1]": "box must be a table, got [1]",
    "contacts.rods=1": "contacts.rods must be a table, got 1",
    "rods.count=2.5": "rods.count must be a whole number, got 2.5",
    "rods.length=[1]": "rods.length must be a number, got [1]",
    "rods.inertia=heavy": "rods.inertia must be solid or thin, got 'heavy'",
    "rods.inertia=[1]": "rods.inertia must be solid or thin, got [1]",
    "step.coarse=1": "step.coarse must be true or false, got 1",
    "box.length=39.9": "box.length must be at least 40 for 40 rods, got 39.9",
    "start.tilt_deg=80": "start.tilt_deg must be at most 21.5",
    "step.size=0.1": "step.size must be at most",
    "contacts.plate.law=hertz": "contacts.plate.law must be one of appendix_a, constant_rest",
    "contacts.plate.law=[1]": "contacts.plate.law must be one of appendix_a, constant_rest",
    "contacts.rods.restitution=1.5": "contacts.rods.restitution must be between 0 and 1, got 1.5",
    "contacts.rods.restitution=true": "contacts.rods.restitution must be a number, got True",
    "contacts.rods.stiffness=0": "contacts.rods.stiffness must be > 0 and finite, got 0",
    "contacts.rods.stiffness=1": "contacts.rods.stiffness 1 is too soft",
    "contacts.rods.damping=1": "contacts.rods.damping is not for the law constant_restitution",
    "contacts.rods.law=coulomb": "contacts.rods.law must have a tangential spring",
    "contacts.plate.law=appendix_a": "--set contacts.plate.restitution=none",
    "plate=none": "plate is missing: the scene names contacts.plate, and needs both",
    "contacts.plate=none": "contacts.plate is missing: the scene names plate, and needs both",
    "box=none": "start.tilt_deg is missing: without a box it has no default",
    "box.length=none": "box.length is missing",
    "rods.count": "--set needs KEY=VALUE, got 'rods.count'",
    "rods.count.x=1": "--set rods.count.x: count is a value, not a table",
}
DOMAINS = {  # what a message says is allowed, and the nearest values that are not
    "rods.count": ("between 1 and 1000000", 0, 1000001),
    "rods.length": ("between 1 and 1000", 0.999, 1000.1),
    "rods.diameter_cm": ("between 1e-6 and 1e6", 9e-7, 1.1e6),
    "plate.acceleration": ("between 0 and 1000", -0.1, 1000.1),
    "plate.frequency_hz": ("between 0.001 and 1e6", 9e-4, 1.1e6),
    "box.length": ("between 1 and 1e7", 0.999, 1.1e7),
    "gravity.x": ("between -1000 and 1000", -1000.1, 1000.1),
    "gravity.z": ("between -1000 and 1000", -1000.1, 1000.1),
    "contacts.plate.friction": (">= 0", -0.1, -1e-300),
    "contacts.rods.friction": (">= 0", -0.1, -1e-300),
    "start.tilt_deg": ("between -90 and 90", -90.1, 90.1),
    "start.seed": ("between 0 and 9223372036854775807", -1, 2**63),
    "start.speed": ("between 0 and 1000", -0.1, 1000.1),
    "start.drop": ("between 0 and 1000", -0.1, 1000.1),
    "step.size": ("between 1e-12 and 1000", 0, 1000.1),
}


def refused(capsys, message, *arguments):
    """The command refuses in one line."""
    command_line.refused(lambda: main(["run", *arguments]), message, capsys)


@pytest.mark.parametrize(("assignment", "message"), BAD.items(), ids=BAD)
def test_what_is_no_scene_is_refused(assignment, message, capsys):
    """Key, value and domain, before anything runs: in Python an error, at the prompt a line."""
    with pytest.raises((ValueError, TypeError)) as caught:
        prepare(load("quasi2d", [assignment]))
    assert message in str(caught.value)
    refused(capsys, message, "quasi2d", "--set", assignment)


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


def test_files_that_are_none(tmp_path, capsys):
    """Missing, a directory, not text, not TOML."""
    refused(capsys, "no such scene", str(tmp_path / "missing.toml"))
    refused(capsys, "quasi2d", "quasi3d")
    refused(capsys, str(tmp_path), str(tmp_path))
    broken = tmp_path / "broken.toml"
    for content in (b"[rods\ncount = 3\n", b"\xff\xfe\x00", b"[rods]\ncount = 3\ncount = 4\n"):
        broken.write_bytes(content)
        refused(capsys, "broken.toml", str(broken))


@pytest.mark.parametrize(
    "arguments",
    [
        *("--periods 0", "--periods -3", "--periods 2.5", "--frames 0", "--no-such-option"),
        *("--checkpoint no/such/folder/a.npz", "--trajectory no/such/folder/a.xyz"),
    ],
)
def test_bad_options_are_refused_before_anything_runs(arguments, capsys):
    """One line and exit code 2, whether the parser finds out or the run."""
    refused(capsys, "", "single_rod", *arguments.split())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ("--checkpoint /proc/a.npz", "checkpoint must be a file that can be written"),
        ("--trajectory /proc/a.xyz", "trajectory must be a file that can be written"),
        ("--frames 2", "frames has no meaning without trajectory"),
        ("--set step.size=1e-12", "step.size must be at least"),
        ("--periods 1000000000", "periods must be between 1 and"),
    ],
)
def test_what_cannot_be_done_is_refused_before_the_run(options, message, capsys):
    refused(capsys, message, "single_rod", *options.split())


def test_a_scene_may_begin_with_a_byte_order_mark(tmp_path):
    """As editors on Windows write it."""
    path = tmp_path / "mine.toml"
    path.write_text((SCENES / "my_rods.toml").read_text(), encoding="utf-8-sig")
    assert load(path) == load("my_rods")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: md.Rods(count="3"), "count must be a whole number"),
        (lambda: md.Rods(length="long"), "length must be a number"),
        (lambda: md.Contacts(rods=1.0), "rods must be"),
        (lambda: md.Scene(rods=5, start=md.Start(tilt_deg=0.0)), "rods must be"),
        (lambda: md.Scene(plate=3.3, start=md.Start(tilt_deg=0.0)), "plate must be"),
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
    """And make an engine."""
    scene = load(name)
    assert prepare(scene).dt > 0
    assert load(SCENES / f"{name}.toml") == scene
    assert load(name, ["start.seed=7"]) == replace(scene, start=replace(scene.start, seed=7))


def test_the_paper_s_row():
    """Fig. 3(b): 40 rods in 43, acos(40/43); Gamma 3.3 at 60 Hz; units of cm and s."""
    scene = load("quasi2d")
    assert degrees(scene.tilt) == pytest.approx(degrees(acos(40 / 43)))
    assert scene.frequency == pytest.approx(60 * (0.6 / 981) ** 0.5)
    assert scene.cm_per_s == pytest.approx((981 * 0.6) ** 0.5)
    assert scene.plate_speed * scene.cm_per_s == pytest.approx(3.3 * 981 / (120 * pi))


def test_a_scene_is_what_its_parts_say():
    """The table of a scene builds the scene again; laws by their constants."""
    scene = load("quasi2d")
    table = as_dict(scene)
    assert table["rods"] == vars(scene.rods)
    assert table["contacts"]["plate"]["law"]["name"] == "constant_restitution"
    assert "plate" in table
    assert "plate" not in as_dict(load("quasi2d", ["plate=none", "contacts.plate=none"]))
    json.dumps(table)
    assert scene.digest() == load("quasi2d").digest()
    assert scene.digest() != load("quasi2d", ["start.seed=2"]).digest()


def test_what_a_run_prints(capsys):
    """The keys of --json, numbers that hang together, and nothing that is not JSON."""
    soft = ["--set", "contacts.plate.stiffness=1e5", "--set", "start.seed=3"]
    assert main(["run", "single_rod", *soft, "--periods", "3", "--json"]) == 0
    found = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)
    for key in (
        *("c_x", "c_x_stderr", "c_x_cm_s", "tilt_deg", "tilt_stderr_deg", "periods"),
        *("steps_per_period", "rod_steps", "run_seconds", "compile_seconds", "energy", "scene"),
        *("law", "seed", "versions"),
    ):
        assert key in found
    assert found["rod_steps"] == found["periods"] * found["steps_per_period"]
    assert found["c_x_cm_s"] == pytest.approx(found["c_x"] * (981 * 0.6) ** 0.5)
    assert (found["seed"], found["law"]) == (3, "coulomb")
    assert set(found["versions"]) >= {"md", "numpy", "numba"}
    assert set(found["energy"]) >= {"plate_work", "plate_friction", "change", "residual"}
    assert main(["run", "single_rod", *soft, "--periods", "3"]) == 0
    assert "drift" in capsys.readouterr().out
