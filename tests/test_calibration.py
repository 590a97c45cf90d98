"""Calibration of the bias of a step, and long tests of the accuracy that follows from it."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import md
from md import accuracy, bias, calibration, plans
from md.__main__ import main
from md.scene import _parsed, from_tables, put

from .rows import ROW, row
from .test_tolerance import NONE, RATIOS, calibrated


def made_drifts(scatter, noise, scenes=64, orders=(2.6, 1.5)):
    """Drifts of scenes with biases that scatter around a mean: arguments of `fitted`."""
    random, n = np.random.default_rng(0), np.array(calibration.STEPS, float)
    tilt, ratio = random.uniform(15, 50, scenes), np.exp(random.uniform(-1, 3.4, scenes))
    length = 10 * np.sqrt(np.maximum(ratio / 5, 1))[:, None] / n
    mean, other = (length**order * np.exp((tilt[:, None] - 30) / 25) for order in orders)
    own = scatter * random.standard_t(bias.FREEDOM, (scenes, 1))
    drift = random.uniform(0.1, 0.5, (scenes, 1)) * np.exp(-0.08 * mean + own * other)
    error = noise * drift
    return drift + error * random.normal(size=drift.shape), error, tilt, ratio


@pytest.mark.parametrize("scatter", [0.01, 0.05])
def test_the_fit_finds_what_was_put_in(scatter):
    """What the errors of the drifts explain is no scatter of the scenes."""
    found = calibration.fitted(*made_drifts(scatter, 0.002))
    assert abs(found["order"] - 2.6) < 4 * found["order_error"]
    assert found["order_error"] < 0.3
    assert found["scatter_order"] == pytest.approx(1.5, abs=0.4)
    assert abs(found["step"] + 0.08) < 4 * np.hypot(0.01, scatter / 8)
    assert found["step_scatter"] == pytest.approx(scatter, rel=0.35)
    assert found["step_error"] > found["step_scatter"]
    assert found["ratio"] == pytest.approx(5, rel=0.25)
    assert found["growth_deg"] == pytest.approx(25, rel=0.25)


def test_what_is_stored_follows_from_its_drifts():
    known = bias.calibrated()
    scenes = [from_tables(tables) for tables in calibration.drawn()]
    drift, error = np.array(known["drift"]), np.array(known["drift_error"])
    found = calibration.fitted(drift, error, *calibration.described(scenes))
    for name in found:
        assert found[name] == pytest.approx(known[name], rel=1e-4)
    assert known["steps"] == list(calibration.STEPS)
    assert all(bias.outside(scene, known) == () for scene in scenes)


@pytest.mark.parametrize("scenes", [1, 64])
def test_the_size_alone_is_found(scenes):
    """For the shapes that `made_drifts` puts in: of many scenes with their scatter, of one."""
    scatter = 0.03 if scenes > 1 else 0.0
    drift, error, tilt, ratio = made_drifts(scatter, 0.002, scenes, orders=(2.6, 2.6))
    stiff = np.sqrt(np.maximum(ratio / 5, 1))[:, None] * 10 / np.array(calibration.STEPS)
    shape = stiff**2.6 * np.exp((tilt[:, None] - 30) / 25)
    step, found, of_one = calibration.size_alone(drift, error, shape)
    assert abs(step + 0.08) < 4 * of_one * scenes**-0.5
    assert of_one < 0.06
    deviation = scatter * (bias.FREEDOM / (bias.FREEDOM - 2)) ** 0.5
    assert found == pytest.approx(deviation, rel=0.35)


TINY = ["rods.count=10", "rods.length=4", "annulus.inner=2", "annulus.outer=3.7"]
SOFT = [f"contacts.{part}.stiffness=1e5" for part in ("plate", "rods", "wall")]


def test_the_calibration_is_a_command(tmp_path, monkeypatch, capsys):
    """Two tiny rows and an annulus; the file is what `--tolerance` reads."""
    usual, annuli = calibration.drawn, calibration.annuli
    small = {"rods.count": 3, "box.length": 3.225}
    tiny = dict(map(_parsed, [*TINY, *SOFT]))
    monkeypatch.setattr(calibration, "drawn", lambda count: [put(t, small) for t in usual(count)])
    monkeypatch.setattr(calibration, "annuli", lambda count: [put(t, tiny) for t in annuli(1)[:1]])
    monkeypatch.setattr(calibration, "execute", partial(calibration.execute, workers=1))
    how = {"count": 2, "periods": 320}
    monkeypatch.setattr(calibration, "calibrate", partial(calibration.calibrate, **how))
    monkeypatch.setattr(calibration, "of_annuli", partial(calibration.of_annuli, periods=640))
    out = tmp_path / "calibration.json"
    asked = ["calibrate", "--store", str(tmp_path / "a.db"), "--out", str(out)]
    assert main(asked) == 0
    assert "order" in capsys.readouterr().out
    found = json.loads(out.read_text())
    assert np.shape(found["drift"]) == (2, 3)
    assert np.shape(found["annulus"]["drift"]) == (1, 3)
    assert bias.is_calibration(out)
    assert found["fewest"] == calibration.STEPS[0]


def test_a_scene_has_a_calibration_of_its_own(tmp_path, monkeypatch, capsys):
    """Measured, used, and refused to a scene of other physics and under other sources."""
    monkeypatch.chdir(tmp_path)
    asked = ["quasi2d", *(part for one in ROW for part in ("--set", one))]
    assert main(["calibrate", *asked, "--out", "own.json", "--periods", "1000"]) == 0
    told = capsys.readouterr().out
    assert told.startswith("price")
    assert "bias      at ten steps a contact" in told
    here = json.loads(Path("own.json").read_text())
    how = {"tolerance": 0.3, "calibration": "own.json"}
    result = md.run(row("start.seed=5"), **how)
    value, error = bias.bias_at(row(), np.array([result.accuracy.per_contact]), here)
    assert result.accuracy.outside == ()
    assert result.accuracy.bias == pytest.approx(value[0] * result.c_x, rel=1e-2)
    assert result.accuracy.bias_error == pytest.approx(
        bias.student(0.95) * error[0] * abs(result.c_x), rel=1e-2
    )
    with pytest.raises(md.InputError, match=r"plate\.acceleration was 3\.3, it is 4"):
        md.run(row("plate.acceleration=4"), **how)
    monkeypatch.setattr(bias, "digest", lambda annulus: "an edit")
    with pytest.raises(md.InputError, match="does not hold for the scene: calibrated for"):
        md.run(row(), **how)


def test_annuli_have_a_part_of_their_own():
    """As far as the bias does not depend on tilt; outside are other walls and other radii."""
    scene, row_of = md.load("annulus"), bias.calibrated()
    known = bias.calibrated(scene)
    assert known["code"] == row_of["annulus"]["code"]
    assert known["order"] == row_of["order"]
    assert bias.outside(scene, known) == ()
    n = np.array([16.0])
    assert bias.bias_at(scene, n, known)[0] == pytest.approx(
        known["step"] * (10 / 16) ** known["order"]
    )
    for change, words in {
        "annulus.outer=7.5": "annulus.outer 7.5 is outside of",
        "contacts.wall.friction=0.2": "contacts of wall and plate differ",
        "rods.rolling=true": "rods roll about their axes",
        "rods.count=20": "rods.count 20 is outside of 32 to 56",
    }.items():
        found = bias.outside(md.load("annulus", [change]), known)
        assert any(words in one for one in found)


def test_the_error_in_annuli_is_that_measured_at_the_longest_step():
    """And falls as that of rows as steps get shorter."""
    known, scene = bias.calibrated(md.load("annulus")) | {"order_error": 0.0}, md.load("annulus")
    drift, error = np.array(known["drift"]), np.array(known["drift_error"])
    n, scenes = np.array(calibration.STEPS, float), [*map(from_tables, calibration.annuli())]
    again = calibration._size(drift, error, scenes, known)
    assert (again["step"], again["step_error"]) == pytest.approx(
        (known["step"], known["step_error"])
    )
    length = np.array([bias.lengths_of(one, n, known)[0] for one in scenes])
    _, _, of_one = calibration.size_alone(drift, error, length ** known["order"])
    _, found = bias.bias_at(scene, n, known)
    assert found[0] == pytest.approx(of_one * (10 / n[0]) ** known["order"])
    assert found[1] / found[0] == pytest.approx((n[0] / n[1]) ** known["scatter_order"])


def test_runs_of_another_state_tell_no_bias():
    drift = np.array([[0.1, 0.11, 0.12], [0.1, 0.11, 0.06], [0.1, 0.11, 0.005]])
    one = calibration.in_one_state(drift, np.full((3, 3), 0.001))
    np.testing.assert_array_equal(one, [[True] * 3, [True, True, False], [True, True, False]])


def test_an_annulus_runs_to_a_tolerance(monkeypatch):
    """A tiny one, taken for calibrated: 640 periods at least, and about its own arrangement."""
    calibrated(monkeypatch)
    scene = md.load("annulus", [*TINY, *SOFT])
    result = md.run(scene, tolerance=0.5)
    assert result.periods >= 2 * accuracy.FIRST_LOOK
    found = accuracy.interval([result.c_x_series], annulus=True)
    assert result.accuracy.statistical == found.half
    words = " ".join(plans.in_words(result))
    assert "about its arrangement of rods" in words


def others():
    """Scenes drawn from the ranges of the calibration, which has others."""
    drawn = calibration.qmc.Sobol(len(calibration.PARAMETERS), seed=11).random(32)
    return [from_tables(calibration.tables_of(parts)) for parts in drawn]


def test_rods_that_fall_over_are_not_settled():
    """Lively ones, whose drift falls to a third and less within 1000 periods."""
    lively = others()[19]
    result = md.run(lively, tolerance=0.1)
    assert result.turned["fell"] > 0
    assert result.accuracy.error <= 0.1 * result.c_x
    assert (result.settled, result.accuracy.state) == (False, "not settled")
    assert f"fell over {result.turned['fell']} times" in "\n".join(plans.in_words(result))
    calm = md.run(others()[0], tolerance=0.1)
    assert calm.turned["fell"] == 0
    assert calm.accuracy.state == "reached"


# Long


@pytest.mark.slow
def test_runs_are_off_by_as_much_as_they_say(capsys):
    """Twenty scenes to 3 %, three starts of each, against finer and four times more accurate runs.

    The true error is within the stated one, as far as the reference tells, in 17 of 20 or more.
    Where the reference is known to 1 %, which it is not where a scene has several states, stated
    errors are neither padded nor boastful: the root mean square of true over stated ones, which
    95 % make 0.51, is 0.3 to 0.7. Scenes that do not settle, which have no such drift, are told and
    are few.
    """
    within, off, told = [], [], 0
    drawn = iter(others())
    while told < 20:
        scene = next(drawn)
        starts = [replace(scene, start=replace(scene.start, seed=seed)) for seed in (1, 2, 3)]
        found = [md.run(s, tolerance=0.03, max_seconds=60, ledger=False) for s in starts]
        if "not settled" in {one.accuracy.state for one in found}:
            continue
        told += 1
        finer = max(48, 2 * found[0].accuracy.per_contact)
        fine = replace(scene, step=md.Step(bias.steps_per_contact(scene, 1.0) / finer, coarse=True))
        truth = accuracy._Goal(0.0075, 0.95, 0.0, 150.0, lambda _: NONE, 2)
        accuracy._started(fine, truth, {"ledger": False})
        for one in found:
            error = one.c_x - truth.mean
            within += [abs(error) <= np.hypot(one.accuracy.error, truth.error)]
            off += [error / one.accuracy.error] if truth.error < 0.01 * truth.size else []
        with capsys.disabled():
            print(np.round(off[-3:], 2), within[-3:], f"{truth.error / truth.size:.4f}", flush=True)
    assert len([*drawn]) >= 32 - 20 - 2
    assert np.mean(within) >= 17 / 20
    assert 0.3 <= np.sqrt(np.mean(np.square(off))) <= 0.7


@pytest.fixture(scope="module")
def long_run():
    """The drift of the intervals' scene ten times as accurately as they know it."""
    scene = bias.choose(md.load("quasi2d", [*RATIOS, "start.speed=0.3"]), 0.05, 0.95).scene
    long = md.run(scene, periods=30000, ledger=False)
    assert long.c_x_stderr < 0.0025 * long.c_x
    return long


@pytest.mark.slow
@pytest.mark.parametrize("workers", [1, 2])
def test_the_interval_is_as_wide_as_it_says(workers, long_run):
    """Of 400 starts, 92 to 98 in a hundred hold the long-run drift at the same step.

    Two standard deviations of so many hits are added.
    """
    scene, hits = long_run.scene, 0
    for seed in range(100, 500):
        start = replace(scene.start, seed=seed)
        goal = accuracy._Goal(0.05, 0.95, 0.0, 60.0, lambda _: NONE, workers)
        accuracy._started(replace(scene, start=start), goal, {"ledger": False})
        assert goal.reached
        hits += abs(goal.mean - long_run.c_x) <= goal.found.half
    spread = 2 * np.sqrt(0.05 * 0.95 / 400)
    assert 0.92 - spread <= hits / 400 <= 0.98 + spread
