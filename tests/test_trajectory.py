"""Trajectories as other programs read them: columns by their names, rods as spherocylinders."""

import re
import shlex
import shutil
from functools import partial

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

import md
from md import records, simulation
from md.host import prepare

from .rows import ROLLING, in_space, ring, row, vectors


def parsed(path):
    """Frames of an extended XYZ file: values of the head by key, columns by name."""
    lines, frames = path.read_text().splitlines(), []
    while lines:
        count, head, *rest = lines
        about = dict(pair.split("=") for pair in shlex.split(head))
        fields = re.findall(r"(\w+):([SRI]):(\d+)", about["Properties"])
        words = np.array([line.split() for line in rest[: int(count)]])
        assert words.shape == (int(count), sum(int(width) for *_, width in fields))
        for name, kind, width in fields:
            part, words = words[:, : int(width)], words[:, int(width) :]
            about[name] = part.astype({"S": str, "R": float, "I": int}[kind])
        frames.append(about)
        lines = rest[int(count) :]
    return frames


@pytest.fixture(params=[row, ring, partial(ring, *ROLLING)])
def written(request, tmp_path):
    """A scene, the state of its rods after a period, and the file of its run."""
    scene, path = request.param(), tmp_path / "a.xyz"
    md.run(scene, periods=2, trajectory=path)
    engine = prepare(scene)
    place, director, velocity, omega = vectors(engine, md.run(scene, periods=1).rods)
    omega += (engine.effects.inertia.rolling or 0) * np.vecdot(omega, director)[:, None] * director
    return scene, (place, director, velocity, omega), path


def test_columns_say_where_each_rod_is_and_what_it_looks_like(written):
    """The quaternion turns the z axis into the rod's; shape: radius twice, length between caps."""
    scene, (place, director, velocity, omega), path = written
    _, frame = parsed(path)
    assert (frame["species"] == "rod").all()
    assert (frame["Z"] == 0).all()
    assert frame["id"][:, 0].tolist() == list(range(len(place)))
    assert_allclose(frame["pos"], place, atol=1e-8)
    turned = Rotation.from_quat(frame["orientation"]).apply([0, 0, 1])
    assert_allclose(turned, director, atol=1e-6)
    assert (frame["aspherical_shape"] == [0.5, 0.5, scene.rods.length - 1]).all()
    assert_allclose(frame["velo"], velocity, atol=1e-8)
    assert_allclose(frame["omega"], omega, atol=1e-8)
    assert_allclose(frame["tilt"][:, 0], np.degrees(np.arccos(turned[:, 2])), atol=1e-5)
    low = np.array(frame["Origin"].split(), float)
    high = low + np.array(frame["Lattice"].split(), float)[::4]
    assert (low <= place).all()
    assert (place <= high).all()
    assert frame["pbc"] == ("F F F" if scene.annulus else "T F F")


@pytest.mark.parametrize("up", [-1.0, 1.0])
def test_a_rod_straight_up_or_down_has_an_orientation(up):
    for rods in (np.array([[2, 0, 0, up, 0, 0, 0]]), in_space(((2, 0, 1), (0, 0, up)))):
        [(_, quaternion, *_)] = records._in_space(rods)
        turned = Rotation.from_quat(quaternion).apply([0, 0, 1])
        assert_allclose(turned, [0, 0, up], atol=1e-15)


def test_small_tilts_in_space_keep_their_digits():
    [(*_, tilt)] = records._in_space(in_space(((2, 0, 1), (1e-9, 0, 1))))
    assert tilt == pytest.approx(np.degrees(1e-9), rel=1e-15)


def test_frames_stand_at_the_same_phases_of_all_periods(tmp_path):
    """Where a period is no whole number of gaps: at the first step behind each part of it."""
    per, path, kept = prepare(row()).per, tmp_path / "a.xyz", tmp_path / "a.npz"
    frames = next(n for n in range(24, per) if per % n)
    for periods in (1, 3):
        md.run(row(), periods=periods, trajectory=path, frames=frames, checkpoint=kept)
    steps = [round(float(frame["Time"]) * per) for frame in parsed(path)]
    assert steps == [k * per - (-i * per // frames) for k in range(3) for i in range(frames)]


def test_frames_go_on_or_the_run_does_not(tmp_path, monkeypatch):
    """After a hole, or those of another run, or fewer than the checkpoint has seen, or none.

    It is refused before anything is compiled.
    """
    path, kept, new = tmp_path / "a.xyz", tmp_path / "a.npz", tmp_path / "b.xyz"
    md.run(row(), periods=2, trajectory=path, checkpoint=kept)
    whole = path.read_text()
    md.run(row("rods.count=3"), periods=3, trajectory=new)
    later = shutil.copy(kept, tmp_path / "later.npz")
    md.run(row(), periods=3, checkpoint=later)
    monkeypatch.setattr(simulation, "prepare", pytest.fail)
    others = (path, whole[:-1], kept), (path, whole[:-2] + "5\n", kept), (path, whole, later)
    for file, text, checkpoint in ((new, new.read_text(), kept), *others):
        file.write_text(text)
        with pytest.raises(md.InputError, match="frames before the checkpoint: name a new file"):
            md.run(row(), periods=4, trajectory=file, checkpoint=checkpoint)
        assert file.read_text() == text
