"""Accuracy: intervals, choice of the step, runs that end when they are accurate enough."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom
from scipy.stats import t as student

import md
from md import accuracy, calibration
from md.__main__ import main
from md.scene import _parsed, from_tables, put, read_tables
from md.store import Store, table
from md.sweep import execute, expand

from .rows import ROW, row
from .test_statistics import autoregressive


def inside(monkeypatch):
    """Take every scene, and these sources, for calibrated ones."""
    monkeypatch.setattr(accuracy, "outside", lambda scene: ())
    monkeypatch.setattr(accuracy, "digest", lambda: accuracy.calibrated()["code"])


# Interval


def test_the_interval_of_constant_parts_is_students():
    """Parts of 8 that differ, and of 16 and 32 that do not more: the widest is that of 8."""
    values = np.random.default_rng(1).normal(size=8)
    mean, half, cut = accuracy.interval(
        np.concatenate([np.full(64, 9.0), np.repeat(values, 32)]), 0.9
    )
    assert cut == 64
    assert half == pytest.approx(student.ppf(0.95, 7) * values.std(ddof=1) / np.sqrt(8), rel=1e-12)
    assert mean == pytest.approx(values.mean())


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.8])
def test_intervals_hold_the_mean_as_often_as_they_say(memory):
    """Of 400 series of 800 values; no fewer than chance allows in one test of 1000."""
    random, hits = np.random.default_rng(5), 0
    for _ in range(400):
        mean, half, _ = accuracy.interval(autoregressive(random, 800, memory), 0.95)
        hits += abs(mean) <= half
    assert hits >= binom.ppf(1e-3, 400, 0.95)
    assert hits < 400


@pytest.mark.parametrize("n", [0, 1, 7, 31])
def test_few_values_have_no_interval(n):
    assert accuracy.interval(np.ones(n))[1] == np.inf


# Choice of the step


@pytest.mark.parametrize("tolerance", [0.5, 0.05, 0.01, 0.001])
def test_the_step_is_the_cheapest(tolerance):
    """Of those no longer than the longest measured: n/(tolerance - bias(n))^2 is least there."""
    scene = md.load("quasi2d")
    tuned, bias = accuracy.chosen_step(scene, tolerance)
    known = accuracy.calibrated()
    n = np.geomspace(known["fewest"], 1e4, 20001)
    bound = known["scale"] * (10 / n) ** known["order"]
    price = np.where(bound < tolerance, n / (tolerance - bound) ** 2, np.inf)
    chosen = accuracy.steps_per_contact(scene, tuned.step.size)
    assert chosen == pytest.approx(n[np.argmin(price)], rel=2e-3)
    assert bias == pytest.approx(known["scale"] * (10 / chosen) ** known["order"])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("plate.acceleration=9", "plate.acceleration 9 is outside of"),
        ("rods.length=30", "rods.length 30 is outside of"),
        ("contacts.plate.friction=3", "friction 3 is outside of"),
        ("contacts.rods.restitution=0.99", "restitution 0.99 is outside of"),
        ("box.length=200", "tilt_deg 78.46 is outside of"),
        ("contacts.rods=none", "laws constant_restitution/none were not calibrated"),
        ("gravity.x=0.1", "gravity is not 1, downwards"),
    ],
)
def test_what_lies_outside_of_the_calibration_is_said(change, words):
    scene = md.load("quasi2d", [change])
    assert any(words in one for one in accuracy.outside(scene))
    tuned, bias = accuracy.chosen_step(scene, 0.01)
    assert np.isnan(bias)
    assert tuned.step == md.Step()


def test_a_run_that_was_ended_early_is_not_judged():
    """By Ctrl-C before the first look; nothing is said of its error."""
    goal = accuracy._Goal(0.5, 0.95, 0.05, 0.0, 600.0)
    goal(np.zeros(0))
    goal(np.ones(46))
    assert (goal.half, goal.reached) == (np.inf, False)
    result = md.run(row("plate.acceleration=5"), periods=46)
    found = accuracy._accuracy(goal, row("plate.acceleration=5"), result, np.nan)
    assert found.state == "not reached"
    words = accuracy.in_words(replace(result, accuracy=found))
    assert words == ["accuracy     NOT REACHED: ended before 128 periods, error unknown"]


# Runs


def test_a_run_ends_as_soon_as_it_is_accurate():
    """And is the run of that step and that many periods."""
    reached = md.run(row("plate.acceleration=5"), tolerance=0.2, floor=0.05)
    a = reached.accuracy
    assert a.state == "bias unknown"  # five rods of this length were not calibrated
    assert np.isnan(a.error)
    assert reached.finished
    assert a.statistical <= 0.2 * max(abs(reached.c_x), 0.05) * (1 + 1e-12)
    mean, half, cut = accuracy.interval(reached.c_x_series)
    assert (a.statistical, cut) == (half, reached.discarded)
    plain = md.run(reached.scene, periods=reached.periods)
    np.testing.assert_array_equal(plain.c_x_series, reached.c_x_series)
    before = reached.c_x_series[: int(reached.periods / 1.1) - 2]
    if reached.periods > 128:
        mean, half, _ = accuracy.interval(before)
        assert half > 0.15 * max(abs(mean), 0.05)


@pytest.mark.parametrize("own", [True, False])
def test_error_and_price_add_up_under_a_calibration_for_these_sources(own, monkeypatch):
    """The next digit costs a hundredfold, and the shorter steps.

    A calibration for other sources leaves the bias unknown; the step stays the one it chooses, so
    that no number depends on the stamp.
    """
    inside(monkeypatch)
    if not own:
        monkeypatch.setattr(accuracy, "digest", lambda: "an edit")
    scene = row("plate.acceleration=5")
    result = md.run(scene, tolerance=0.3, floor=0.05)
    a, size, words = result.accuracy, max(abs(result.c_x), 0.05), accuracy.in_words(result)
    tuned, bias = accuracy.chosen_step(scene, 0.3)
    assert result.scene == tuned
    assert a.state == ("reached" if own else "bias unknown")
    assert ("calibrated for other sources" in " ".join(words)) != own
    if not own:
        assert np.isnan([a.bias, a.error]).all()
        return
    assert a.bias == pytest.approx(bias * size)
    assert a.error == pytest.approx(a.bias + a.statistical)
    assert a.next_digit_seconds > 50 * (a.statistical / (0.3 * size)) ** 2 * a.seconds
    assert "by calibration" in " ".join(words)


def test_slow_drifts_are_judged_by_the_floor():
    """No friction, no drift: its error is one of the floor."""
    result = md.run(row("contacts.plate.friction=0"), tolerance=0.5, floor=0.2)
    assert result.accuracy.state == "bias unknown"
    assert abs(result.c_x) < 0.2
    assert result.accuracy.statistical <= 0.5 * 0.2
    assert "of the floor 0.2" in accuracy.in_words(result)[0]


SMALL = [part for change in (*ROW, "plate.acceleration=5") for part in ("--set", change)]


def test_the_command_has_three_ends(capsys, monkeypatch):
    """Reached: 0; as far as statistics go: 3; not at all: 4. An unknown bias is no number."""
    how = ["--tolerance", "0.3", "--floor", "0.05"]
    assert main(["run", "quasi2d", *SMALL, *how, "--json"]) == 3
    found = json.loads(capsys.readouterr().out)["accuracy"]
    assert found["state"] == "bias unknown"
    assert found["bias"] is found["error"] is None
    assert main(["run", "quasi2d", *SMALL, *how]) == 3
    assert "accuracy     statistically reached, bias unknown" in capsys.readouterr().out
    still = ["--set", "plate.acceleration=0.5"]  # nothing moves
    assert main(["run", "quasi2d", *SMALL, *still, *how, "--json"]) == 3
    assert json.loads(capsys.readouterr().out)["accuracy"]["state"] == "bias unknown"
    hard = ["--tolerance", "1e-4", "--max-seconds", "0.05"]  # known after the second look
    assert main(["run", "quasi2d", *SMALL, *hard]) == 4
    out = capsys.readouterr().out
    assert "NOT REACHED" in out
    assert "this would take about" in out
    assert main(["run", "quasi2d", *SMALL, *hard, "--json"]) == 4
    found = json.loads(capsys.readouterr().out)
    assert (found["finished"], found["accuracy"]["state"]) == (True, "not reached")
    assert found["periods"] < 5000
    assert found["accuracy"]["needed_seconds"] > 0.05
    inside(monkeypatch)
    assert main(["run", "quasi2d", *SMALL, *how, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["accuracy"]["state"] == "reached"


def test_a_sweep_takes_a_tolerance(tmp_path):
    """Each point has a length of its own; what was not reached is a failure that says so."""
    store = tmp_path / "a.db"
    base = put(read_tables("quasi2d"), dict(map(_parsed, ROW)))
    axes = [{"plate.acceleration": [4, 5]}]
    tables = {"tolerance": 0.4, "max_seconds": 30, "axes": axes}
    tally = execute(expand(tables, base), store, workers=1)
    assert (tally.computed, tally.failed) == (2, 0)
    assert execute(expand(tables, base), store, workers=1).there == 2
    (periods,) = expand(tables, base).gather(store, "periods")
    assert (periods >= 128).all()
    _, rows = table(store)
    assert {row["accuracy.state"] for row in rows} == {"bias unknown"}
    hard = {**tables, "tolerance": 1e-4, "max_seconds": 0.05}
    assert execute(expand(hard, base), store, workers=1).failed == 2
    with Store(store, write=False) as database:
        assert "NOT REACHED" in [run["error"] for run in database.rows()][-1]


# Calibration


def test_the_fit_finds_what_was_put_in():
    n, order = np.array(calibration.STEPS, float), 2.6
    fine, scale = np.array([0.3, 0.1, 0.5]), np.array([-0.1, 0.05, -0.02])
    drift = fine[:, None] * (1 + scale[:, None] * (10 / n) ** order)
    error = np.full_like(drift, 1e-4)
    found = calibration.fitted(drift, error)
    assert found["order"] == pytest.approx(order, rel=1e-5)
    np.testing.assert_allclose(found["scales"], scale, rtol=1e-5)
    assert found["chi_squared"] == pytest.approx(0, abs=1e-9)
    assert found["scale"] == pytest.approx(0.1 + 2 * found["scale_errors"][0], rel=1e-4)
    noisy = drift + error * np.random.default_rng(0).normal(size=drift.shape)
    again = calibration.fitted(noisy, error)
    assert abs(again["order"] - order) < 4 * again["order_error"]
    assert 0.2 < again["chi_squared"] < 3


def test_what_is_stored_follows_from_its_drifts():
    known = accuracy.calibrated()
    found = calibration.fitted(np.array(known["drift"]), np.array(known["drift_error"]))
    for name in ("order", "scale", "chi_squared"):
        assert found[name] == pytest.approx(known[name], rel=1e-6)
    assert known["scenes"] == list(calibration.SCENES)
    assert known["steps"] == list(calibration.STEPS)
    for changes in calibration.SCENES.values():
        base = put(read_tables("quasi2d"), {"step": "none", **changes})
        assert accuracy.outside(from_tables(base)) == ()


def test_the_calibration_is_a_command(tmp_path, monkeypatch, capsys):
    """Two tiny scenes; the file is what `--tolerance` reads."""
    few = {name: calibration.SCENES[name] for name in list(calibration.SCENES)[:2]}
    small = {"rods.count": 3, "box.length": 3.225}
    monkeypatch.setattr(calibration, "SCENES", {name: few[name] | small for name in few})
    monkeypatch.setattr(calibration, "STEPS", (16, 20, 26, 40))
    monkeypatch.setitem(calibration.calibrate.__kwdefaults__, "periods", 124)
    out = tmp_path / "calibration.json"
    how = ["calibrate", "--store", str(tmp_path / "a.db"), "--out", str(out)]
    assert main(how) == 0
    assert "order" in capsys.readouterr().out
    found = json.loads(out.read_text())
    assert found["scenes"] == list(few)
    assert np.shape(found["drift"]) == (2, 4)


# Long


@pytest.mark.slow
def test_the_calibration_holds():
    """Steps chosen for 4 % against steps a third as long: no more apart than bound and errors."""
    for changes in ([], ["box.length=60"], ["contacts.plate.friction=0.6"]):
        scene = md.load("quasi2d", [*changes, "start.speed=0.3"])
        tuned, bias = accuracy.chosen_step(scene, 0.04)
        fine = md.Step(tuned.step.size / 3, coarse=True)
        coarse = md.run(tuned, periods=6000, ledger=False)
        finer = md.run(replace(tuned, step=fine), periods=4000, ledger=False)
        error = np.hypot(coarse.c_x_stderr, finer.c_x_stderr)
        assert abs(coarse.c_x - finer.c_x) < bias * abs(finer.c_x) + 3 * error


@pytest.mark.slow
def test_the_error_is_as_large_as_it_says(monkeypatch):
    """Of 120 starts, the long-run drift at the same step lies within the interval as often.

    The number of hits is no smaller than chance allows in one test of 1000; the long run's own
    error, a tenth of the interval, is added.
    """
    inside(monkeypatch)
    scene = md.load("quasi2d", ["start.speed=0.3"])
    tuned, _ = accuracy.chosen_step(scene, 0.05)
    long = md.run(tuned, periods=25000, ledger=False)
    hits = 0
    for seed in range(100, 220):
        start = replace(scene.start, seed=seed)
        found = md.run(replace(scene, start=start), tolerance=0.05, ledger=False)
        assert found.accuracy.state == "reached"
        hits += abs(found.c_x - long.c_x) <= found.accuracy.statistical + long.c_x_stderr
    assert hits >= binom.ppf(1e-3, 120, 0.95)
