"""Rods of one's own in the paper's figures and claims."""

import inspect
import json
import re
from unittest.mock import Mock

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import figures
import impact
from figures.claims import over_tilt, own_rods
from figures.lib import runs
from figures.lib.data import kept_data, stored_data
from figures.paper import fig04, fig05, fig08, fig11, fig13
from impact import bouncing, drift
from md.scene import SCENES

from .command_line import ROOT, enter, python

SCENE = """
rods = { count = 5, length = 5, inertia = "solid" }
plate = { acceleration = 3, frequency_hz = 60 }
box = { length = 6 }
gravity = {}
contacts.plate = { restitution = 0.5, friction = 0.2, stiffness = 1e5, tangential_ratio = 3 }
contacts.rods = { restitution = 0.8, friction = 0.2, stiffness = 1e5, tangential_ratio = 3 }
step = { coarse = true }
"""


def test_each_figure_takes_what_the_list_says():
    for name, entry in figures.FIGURES.items():
        takes = inspect.signature(figures.load(name).data).parameters
        assert {*takes} - {"assumed"} == {"quick", *entry.own}


def test_a_figure_is_drawn_from_values_of_ones_own(tmp_path, monkeypatch):
    """The README's command, in small: each figure takes what it knows, and is not the paper's.

    In processes that need no window, whatever the environment says.
    """
    monkeypatch.setenv("MPLBACKEND", "module://nowhere")
    command = "-m figures draw fig10 fig11 --friction 0.2 --restitution 0.5"
    assert f"python {command}  " in (ROOT / "README.md").read_text("utf-8")
    assert python(f"{command} --quick --jobs 2 --out", tmp_path).returncode == 0
    ten, eleven = (kept_data(name, tmp_path) for name in ("fig10", "fig11"))
    assert (ten["restitution"], ten["marked"]) == (0.5, 0.2)
    assert (eleven["restitution"], eleven["friction"]) == (0.5, 0.2)
    expected = fig11.data(quick=True, friction=0.2, restitution=0.5)
    assert_array_equal(eleven["c_x"], expected["c_x"])
    assert stored_data("fig11", True, tmp_path) is None


@pytest.mark.parametrize("friction", [0, 1e-300, np.inf])
def test_friction_at_its_ends_is_drawn(tmp_path, friction):
    """At 1e-300 the upper critical tilt is 90 degrees to rounding."""
    enter(f"figures draw fig11 --quick --restitution 1 --friction {friction} --out", tmp_path)


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A small scene, and a grid of few tilts."""
    monkeypatch.setattr(runs, "tilts", lambda quick: np.array([9.0, 18.0, 27.0, 34.0, 45.0]))
    monkeypatch.setattr(own_rods, "tilts", runs.tilts)
    (tmp_path / "mine.toml").write_text(SCENE)
    return tmp_path / "mine.toml"


def test_the_papers_statements_are_judged_for_ones_own_rods(mine, tmp_path):
    """Numbers are of their row; the theory has the friction and restitution of their plate."""
    out = tmp_path / "out"
    printed = enter("figures claims --quick --out", out, "--scene", mine).out
    begin, left, rods, says, line, *_ = printed.splitlines()
    assert (begin, left[:21]) == ("20 runs, none of them stored", "those left take about")
    assert "mine: 5 rods, l=5 d" in rods
    assert says.startswith("S2  In the plane row the tilt follows from the length of the box")
    assert re.match(r"    [+~-] [a-z ]+: tilt less acos.+, rms: .+ deg, asked ≤ 1\.5", line)
    report = json.loads((out / "claims-mine.json").read_text())
    rows = report["statements"]
    assert ("warning: the tilt" in printed) == (report["tilt_off_deg"] > 2)
    for off, warned in ((2.0, False), (2.1, True), (np.nan, True)):
        assert (
            "warning: the tilt" in own_rods.brief(report | {"statements": [], "tilt_off_deg": off})
        ) == warned
    values = {f"{row['id']}.{row['key']}": row["value"] for row in rows}
    assert {"S2.rms", "S3.forward", "S16.distance", "S22.pushed"} <= values.keys()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runs, "STORE", out / "rows.db")
        assert [*own_rods.estimate(str(mine), True)] == ["20 runs, all of them stored"]
        sweep = runs.tilt_plan(True, scene=str(mine))
        table = over_tilt.table(sweep, runs.tilts(True), own=True)
    for name, value in values.items():
        assert value == pytest.approx(over_tilt.NUMBERS[name](table), nan_ok=True)
    assert runs.row_of(str(mine)).setting == {"friction": 0.2, "restitution": 0.5}
    assert {point.scene.rods.length for point in sweep.points} == {5.0}


def test_a_row_that_has_turned_over_counts_as_its_mirror_image(monkeypatch):
    starts = {
        "tilt_deg": (20.0, -20.0),
        "c_x_cm_s": (3.0, -3.0),
        "c_x_stderr_cm_s": (0.1, 0.1),
        "landings.omega_after.mean": (-1.0, 1.0),
        "touches.c_z_before.mean": (-2.0, -2.0),
    }
    monkeypatch.setattr(runs, "gathered", lambda _, *names: [np.array(starts[x]) for x in names])
    gravity = Mock(x=0.0)
    sweep = Mock(points=[Mock(scene=Mock(gravity=gravity))])
    found = runs.means(sweep, {name: name for name in starts}, runs.along_lean)
    assert {name: found[name] for name in starts} == {name: x for name, (x, _) in starts.items()}
    assert not any(found[f"{name}_error"] for name in starts)
    gravity.x = 0.1  # the mirror image is another row
    assert runs.along_lean(sweep, "c_x_cm_s")[0].tolist() == [3.0, -3.0]


def test_a_figure_of_the_row_shows_ones_own_rods(mine):
    d = fig08.data(quick=True, scene=str(mine))
    assert "mine: 5 rods" in str(d["words"])
    assert "plate/rods" not in str(d["words"])  # the law of the figures


def test_the_rigid_rod_of_ones_own_falls_under_its_own_gravity(mine, monkeypatch):
    """Its flights, in periods, go as the plate's acceleration over gravity's."""
    bounce = Mock(wraps=bouncing.bounce)
    monkeypatch.setattr(bouncing, "bounce", bounce)
    mine.write_text(SCENE.replace("gravity = {}", "gravity = { z = -0.25 }"))
    runs.lone("flight", True, str(mine))
    assert {call.kwargs["gamma"] for call in bounce.call_args_list} == {3 / 0.25}
    mine.write_text(SCENE.replace("gravity = {}", "gravity = { x = 0.1 }"))
    with pytest.raises(impact.InputError, match="gravity across the plate alone"):
        runs.lone("flight", True, str(mine))


def annulus(path, changes):
    """Write the example of an annulus, some of its text changed; return its name."""
    text = (SCENES / "annulus.toml").read_text()
    for usual, other in changes.items():
        text = text.replace(usual, other)
    path.write_text(text)
    return str(path)


def test_what_a_figure_of_annuli_varies_is_its_own(tmp_path, monkeypatch):
    """Rods that roll and walls at rest are beside rods that do not, between walls that shake."""
    changes = {"shaken = true": "shaken = false", "rolling = false": "rolling = true"}
    own = fig04.sweeps(True, scene=annulus(tmp_path / "rolling.toml", changes))
    for name, rolls in (("still", False), ("rolling", True)):
        assert {point.scene.rods.rolling for point in own[name].points} == {rolls}
    for name, shakes in (("gamma", True), ("rest", False)):
        assert {point.scene.annulus.shaken for point in own[name].points} == {shakes}
    seen = []

    def gathered(sweep, *names):
        seen.extend(point.scene for point in sweep.points)
        return (np.ones((*sweep.shape, 4, 5)),)

    monkeypatch.setattr(fig05, "gathered", gathered)
    fig05.data(True, scene=str(tmp_path / "rolling.toml"))
    assert {(one.rods.rolling, one.annulus.shaken) for one in seen} == {(False, True)}


def test_annuli_of_ones_own_hold_as_many_more_rods_as_they_are_wider(tmp_path):
    """What is the paper's alone is left out."""
    radii = {"5.73228": "12.31866", "7.44094": "14.02778"}  # twice the middle, as wide a gap
    wide = annulus(tmp_path / "wide.toml", radii)
    usual, own = (fig04.sweeps(True, scene=scene) for scene in (None, wide))
    assert {*usual} - {*own} == {"plane", "narrow"}
    for name in ("still", "rest", "rolling"):
        counts = usual[name].values("rods.count")
        assert_array_equal(own[name].values("rods.count"), 2 * counts)
    assert own["wall"].points[0].scene.rods.count == 88
    assert own["still"].points[0].scene.annulus.inner == 12.31866
    assert "wide: 44 rods" in runs.annulus_of(wide).words


def test_rows_of_the_paper_stand_beside_the_papers_theory_alone(monkeypatch):
    monkeypatch.setattr(runs, "execute", None)  # nothing runs
    d = fig13.data(quick=True, friction=0.1, length=5.0)
    assert not any(name.endswith("c_x") for name in d)
    assert r"\mu=0.1" in str(d["words"])
    assert "plate/rods" not in str(d["words"])
    rod = runs.paper_rod(d["fine"], 5.0)
    assert_array_equal(d["thick"], drift(rod, friction=0.1, restitution=0.65).c_x)
    assert len(fig13.draw(d).axes) == 3


def test_the_plate_of_ones_own_may_be_plastic(mine):
    mine.write_text(SCENE.replace("restitution = 0.5", "restitution = 0"))
    assert runs.row_of(str(mine)).setting["restitution"] == 0.0
