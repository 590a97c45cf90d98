"""Scenes: examples load, the paper's row has its numbers, a table says all of a scene."""

from math import cos, pi

import pytest

from md.domains import as_dict
from md.host import step_of
from md.scene import GAP, SCENES, load

from .rows import seeded


def test_a_scene_may_begin_with_a_byte_order_mark(tmp_path):
    """The mark, which editors on Windows write, is left out."""
    path = tmp_path / "mine.toml"
    path.write_text((SCENES / "my_rods.toml").read_text(), encoding="utf-8-sig")
    assert load(path) == load("my_rods")


def test_an_assignment_takes_what_python_writes():
    scene = load("annulus", ["plate.acceleration=.5", "rods.rolling=True", "gravity=None"])
    assert (scene.plate.acceleration, scene.rods.rolling, scene.gravity) == (0.5, True, None)


# What is a scene


@pytest.mark.parametrize("file", sorted(SCENES.glob("*.toml")))
def test_examples_load(file):
    """Examples have a step, and load as files; one assignment may stand without a list."""
    scene = load(file.stem)
    assert step_of(scene)[0] > 0
    assert load(file) == scene
    assert load(file, "start.seed=7") == seeded(scene, 7)


def test_the_paper_s_row():
    """Fig. 3(b): 40 rods in 43, acos(40/43); Gamma 3.3 at 60 Hz; units of cm and s."""
    scene = load("quasi2d")
    assert cos(scene.tilt) == pytest.approx(40 / 43, rel=1.1 * GAP)
    assert scene.frequency == pytest.approx(60 * (0.6 / 981) ** 0.5)
    assert scene.plate_speed * scene.cm_per_s == pytest.approx(3.3 * 981 / (120 * pi))


def test_a_scene_is_what_its_parts_say():
    """A table of a scene holds its parts, laws by their constants, and nothing that is absent."""
    scene = load("quasi2d")
    table = as_dict(scene)
    assert table["rods"] == vars(scene.rods)
    assert table["contacts"]["plate"]["law"]["name"] == "constant_restitution"
    assert "plate" not in as_dict(load("quasi2d", ["plate=none", "contacts.plate=none"]))
