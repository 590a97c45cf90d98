"""Accuracy: intervals, choice of the step, runs that end when they are accurate enough."""

import json
import time
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import t as student

import md
from md import accuracy, bias, plans
from md.__main__ import main
from md.result_text import result_text
from md.scene import _parsed, put, read_tables
from md.store import Store, table
from md.sweep import execute, expand

from .rows import ROW, row

NONE = accuracy.Correction(0.0, 0.0)
RATIOS = [f"contacts.{part}.tangential_ratio=3" for part in ("plate", "rods")]
INSIDE = md.load("quasi2d", RATIOS)  # of the calibration


def calibrated(monkeypatch, value=0.0, error=0.0):
    """Take every scene for a calibrated one, with this bias at all steps."""

    def same(_, n, known):
        return np.full(n.shape, value), np.full(n.shape, error)

    monkeypatch.setattr(bias, "unknown", lambda *_: ())
    monkeypatch.setattr(bias, "bias_at", same)


# Choice of the step


@pytest.mark.parametrize("tolerance", [0.5, 0.05, 0.01, 0.001])
def test_the_step_is_the_cheapest(tolerance, monkeypatch):
    """Of those no longer than the longest measured: n over what the bias leaves for statistics."""
    monkeypatch.setattr(bias, "unknown", lambda *_: ())
    scene = md.load("quasi2d", ["contacts.plate.tangential_ratio=29"])
    chosen = bias.choose(scene, tolerance, 0.95)
    known = bias.calibrated()
    n = np.geomspace(known["fewest"], 1600, 20001)
    grown = np.exp((np.degrees(scene.tilt) - 30) / known["growth_deg"])
    stiff = np.sqrt(29 / known["ratio"])
    length = 10 * stiff / n
    value = known["step"] * grown * length ** known["order"]
    scatter = known["step_error"] * grown * length ** known["scatter_order"]
    error = np.hypot(scatter, value * np.log(length) * known["order_error"])
    room = tolerance**2 - (student.ppf(0.975, 5) * error) ** 2
    price = np.where(room > 0, n / np.abs(room), np.inf)
    assert chosen.per_contact == pytest.approx(n[np.argmin(price)], rel=0.025)
    steps = bias.steps_per_contact(scene, chosen.scene.step.size)
    assert steps == pytest.approx(chosen.per_contact)
    assert chosen.bias.value == pytest.approx(np.interp(steps, n, value), rel=1e-5)
    assert chosen.bias.error == pytest.approx(np.interp(steps, n, error), rel=1e-5)


@pytest.mark.parametrize("change", ["start.drop=20", "start.speed=50"])
def test_a_fall_at_the_start_takes_no_step_that_is_not_stable(change, monkeypatch):
    """Of the stable ones, which are shorter than the cheapest without it, the longest."""
    monkeypatch.setattr(bias, "unknown", lambda *_: ())
    chosen = bias.choose(md.load("quasi2d", [change]), 0.3, 0.95)
    assert chosen.per_contact > bias.choose(md.load("quasi2d"), 0.3, 0.95).per_contact
    assert md.host.step_of(chosen.scene)[0] <= chosen.scene.step.size
    longer = replace(chosen.scene.step, size=1.05 * chosen.scene.step.size)
    with pytest.raises(md.InputError, match="to be stable"):
        md.host.step_of(replace(chosen.scene, step=longer))


def outside(scene):
    """By the shipped calibration."""
    return bias.outside(scene, bias.calibrated(scene))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("plate.acceleration=9", "plate.acceleration 9 is outside of"),
        ("rods.length=30", "rods.length 30 is outside of"),
        ("contacts.plate.friction=3", "friction of plate 3 is outside of"),
        ("contacts.rods.restitution=0.99", "restitution of rods 0.99 is outside of"),
        ("contacts.rods.stiffness=6e6", "contacts of plate and rods differ in stiffness"),
        ("box.length=200", "tilt_deg 78.46 is outside of"),
        ("rods.count=10", "rods.count 10 is below 20"),
        ("box=none start.tilt_deg=30", "there is no box: the row is open"),
        ("contacts.rods=none", "laws constant_restitution/none were not calibrated"),
        ("gravity.x=0.1", "gravity is not 1, downwards"),
    ],
)
def test_what_lies_outside_of_the_calibration_is_said(change, words):
    scene = md.load("quasi2d", change.split())
    assert any(words in one for one in outside(scene))
    chosen = bias.choose(scene, 0.01, 0.95)
    assert chosen.bias is None
    assert chosen.scene.step == md.Step()


def test_a_law_of_ones_own_is_outside_whatever_its_name():
    contact = INSIDE.contacts.rods
    own = replace(contact.law, normal=md.Normal(contact.law.normal.stiffness, constant=1.0))
    contacts = replace(INSIDE.contacts, rods=replace(contact, law=own))
    assert outside(INSIDE) == ()
    assert "is not that of the calibration" in outside(replace(INSIDE, contacts=contacts))[0]


def test_other_sources_are_outside(monkeypatch):
    known = bias.calibrated()
    monkeypatch.setattr(bias, "digest", lambda annulus: known["code"])
    assert bias.unknown(INSIDE, known) == ()
    monkeypatch.setattr(bias, "digest", lambda annulus: "an edit")
    assert "calibrated for other sources" in bias.unknown(INSIDE, known)[0]


# Runs


def test_a_run_that_was_ended_early_is_not_judged():
    """By Ctrl-C before the first look; nothing is said of its error."""
    goal = accuracy._Goal(0.5, 0.95, 0.05, 600.0, lambda _: NONE)
    goal.ask(0, np.zeros(0))
    goal.series = [np.ones(46)]
    goal.found = accuracy.interval(goal.series)
    assert (goal.found.half, goal.reached) == (np.inf, False)
    result = md.run(row("plate.acceleration=5"), periods=46)
    found = accuracy._accuracy(goal, bias.choose(row("plate.acceleration=5"), 0.5, 0.95), result)
    assert found.state == "not settled"
    words = plans.in_words(replace(result, accuracy=found))
    assert words == ["accuracy     NOT SETTLED: ended too early to tell the error"]


def test_several_starts_answer_soon():
    """So that Ctrl-C, or one that fails, need not wait for the first look of the others."""
    goals = [accuracy._Goal(0.5, 0.95, 0.05, 600.0, lambda _: NONE, starts) for starts in (1, 2)]
    asked = [goal.ask(0, np.zeros(0)) for goal in goals]
    assert asked == [accuracy.FIRST_LOOK, accuracy.FEW]


def test_the_pace_is_not_known_at_once_after_a_resume():
    """A run that is accurate enough ends there; another one makes a few periods more."""
    drift = 1 + 0.1 * np.random.default_rng(3).normal(size=400)
    ends = []
    for tolerance in (0.5, 1e-4):
        goal = accuracy._Goal(tolerance, 0.95, 0.05, 600.0, lambda _: NONE)
        ends.append((goal.ask(0, drift), goal.over, np.isnan(goal.needed)))
    assert ends == [(400, True, True), (400 + accuracy.FEW, False, True)]


def test_a_run_ends_as_soon_as_it_is_accurate(monkeypatch):
    """And is the run of that step and that many periods, less its bias."""
    calibrated(monkeypatch, -0.1, 0.02)
    scene = row("plate.acceleration=5")
    reached = md.run(scene, tolerance=0.2, floor=0.05)
    a = reached.accuracy
    assert (a.state, a.starts, a.made) == ("reached", 1, reached.periods)
    assert reached.scene == bias.choose(scene, 0.2, 0.95).scene
    plain = md.run(reached.scene, periods=reached.periods)
    np.testing.assert_array_equal(plain.c_x_series, reached.c_x_series)
    found = accuracy.interval([reached.c_x_series])
    assert a.statistical == found.half
    assert reached.c_x == pytest.approx(found.mean / 0.9)
    assert a.bias == pytest.approx(-0.1 * reached.c_x)
    assert a.bias_error == pytest.approx(student.ppf(0.975, 5) * 0.02 * abs(reached.c_x))
    assert a.error == pytest.approx(np.hypot(a.statistical, a.bias_error))
    assert a.error <= 0.2 * max(abs(reached.c_x), 0.05) * (1 + 1e-12)
    assert a.next_digit_seconds > 50 * (a.error / (0.2 * abs(reached.c_x))) ** 2 * a.seconds
    assert "is taken off (calibrated)" in " ".join(plans.in_words(reached))


def test_outside_of_the_calibration_the_bias_is_measured():
    """From a run with steps twice as long, whose error and the bias itself are charged."""
    scene = row("plate.acceleration=5")
    result = md.run(scene, tolerance=0.3, floor=0.05)
    a = result.accuracy
    assert a.outside
    dt, _ = md.host.step_of(replace(scene, step=md.Step()))
    longer = replace(scene, step=md.Step(2 * dt, coarse=True))
    rough = accuracy._Goal(0.5, 0.95, 0.05, 300.0, lambda _: NONE)
    accuracy._started(longer, rough, {})
    mean = result.c_x + a.bias
    assert a.bias == pytest.approx((rough.found.mean - mean) / 3)
    assert a.bias_error == pytest.approx(np.hypot(rough.found.half / 3, a.bias))
    assert "measured in place: contact time" in " ".join(plans.in_words(result))


def test_starts_at_once_are_pooled(monkeypatch):
    """Each from a seed of its own; the result but for the drift is that of the first."""
    calibrated(monkeypatch)
    scene = row("plate.acceleration=5")
    result = md.run(scene, tolerance=0.2, floor=0.05, workers=2)
    a = result.accuracy
    assert (a.starts, a.state) == (2, "reached")
    assert a.made >= 2 * accuracy.FIRST_LOOK
    assert 0 <= a.chance <= 1
    one = md.run(result.scene, periods=accuracy.FIRST_LOOK)
    np.testing.assert_array_equal(one.c_x_series, result.c_x_series[: accuracy.FIRST_LOOK])
    assert "starts       2" in " ".join(plans.in_words(result))


@pytest.mark.parametrize("asked", [[], [np.zeros(0), np.zeros(20)]], ids=["at once", "later"])
def test_one_start_that_fails_ends_all(monkeypatch, asked):
    """Before the first look as well, which would have to wait for it."""
    calibrated(monkeypatch)
    usual = accuracy.simulation.run

    def failing(scene, **how):
        if scene.start.seed > accuracy.SEED_GAP:
            for series in asked:
                how["goal"](series)
            raise md.RunError("no longer finite")
        return usual(scene, **how)

    monkeypatch.setattr(accuracy.simulation, "run", failing)
    with pytest.raises(md.RunError, match="no longer finite"):
        md.run(row("plate.acceleration=5"), tolerance=1e-4, workers=2)


def test_slow_drifts_are_judged_by_the_floor():
    """No friction, no drift: its error is one of the floor."""
    result = md.run(row("contacts.plate.friction=0"), tolerance=0.5, floor=0.2)
    assert result.accuracy.state == "reached"
    assert abs(result.c_x) < 0.2
    assert result.accuracy.error <= 0.5 * 0.2
    assert "of the floor 0.2" in plans.in_words(result)[0]


SMALL = [part for change in (*ROW, "plate.acceleration=5") for part in ("--set", change)]


def test_the_command_has_two_ends(capsys, monkeypatch):
    """Reached: 0; not reached: 4."""
    how = ["--tolerance", "0.3", "--floor", "0.05"]
    assert main(["run", "quasi2d", *SMALL, *how, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["accuracy"]
    assert (found["state"], found["starts"]) == ("reached", 1)
    assert main(["run", "quasi2d", *SMALL, *how, "--workers", "2"]) == 0
    assert "accuracy     reached" in capsys.readouterr().out
    still = ["--set", "plate.acceleration=0.5"]  # nothing moves
    assert main(["run", "quasi2d", *SMALL, *still, *how]) == 0
    assert "accuracy     reached: nothing drifts" in capsys.readouterr().out
    hard = ["--tolerance", "1e-4", "--max-seconds", "0.05"]  # known after the second look
    assert main(["run", "quasi2d", *SMALL, *hard]) == 4
    assert "the bias alone is known no better" in capsys.readouterr().out
    calibrated(monkeypatch)
    assert main(["run", "quasi2d", *SMALL, *hard]) == 4
    out = capsys.readouterr().out
    assert "NOT REACHED" in out
    assert "this would take about" in out
    assert main(["run", "quasi2d", *SMALL, *hard, "--json"]) == 4
    found = json.loads(capsys.readouterr().out)
    assert (found["finished"], found["accuracy"]["state"]) == (True, "not reached")
    assert found["periods"] < 5000
    assert found["accuracy"]["needed_seconds"] > 0.05


def test_a_run_that_does_not_settle_ends_as_one_that_is_not_reached(capsys, monkeypatch):
    calibrated(monkeypatch)
    monkeypatch.setattr(accuracy, "settled", lambda series, first: None)
    asked = ["run", "quasi2d", *SMALL, "--tolerance", "0.5", "--max-seconds", "1"]
    assert main(asked) == 4
    out = capsys.readouterr().out
    assert "accuracy     NOT SETTLED" in out
    assert "the drift still trends" in out
    assert main([*asked, "--json"]) == 4
    found = json.loads(capsys.readouterr().out)
    assert (found["settled"], found["accuracy"]["state"]) == (False, "not settled")


@pytest.mark.parametrize(("slope", "periods"), [(0, 124), (0, 123), (1, 200)])
def test_a_run_says_whether_its_drift_trends(slope, periods):
    """Without a tolerance: behind a fifth, if there are 100 periods; in JSON and in a line."""
    noise = 0.01 * np.random.default_rng(9).normal(size=periods)
    result = md.run(row(), periods=2)
    series = noise + slope * np.linspace(0, 1, periods)
    result = replace(result, c_x_series=series, periods=periods, discarded=periods // 5)
    expected = None if periods == 123 else slope == 0
    assert result.as_dict()["settled"] is expected
    assert ("not settled: the drift still trends" in result_text(result)) == (expected is False)


@pytest.mark.slow
def test_an_annulus_is_seen_to_settle():
    """The one that ships: 600 periods trend behind a fifth, and not behind what is left out.

    Two starts agree within their intervals.
    """
    scene = md.load("annulus")
    step = md.Step(bias.steps_per_contact(scene, 1.0) / 16, coarse=True)
    starts = (replace(scene, step=step, start=replace(scene.start, seed=i)) for i in (3, 4))
    results = [md.run(start, periods=1500) for start in starts]
    short = replace(results[0], c_x_series=results[0].c_x_series[:600], discarded=120)
    assert short.settled is False
    one, other = (accuracy.interval([result.c_x_series], annulus=True) for result in results)
    assert one.settled
    assert other.settled
    assert abs(one.mean - other.mean) < np.hypot(one.half, other.half)


def test_the_plan_is_told_and_not_run(capsys, monkeypatch):
    how = ["run", "quasi2d", "--tolerance", "0.05", "--plan"]
    monkeypatch.setattr(bias, "digest", lambda annulus: bias.calibrated()["code"])
    assert main([*how, *(part for one in RATIOS for part in ("--set", one))]) == 0
    step, taken, price = capsys.readouterr().out.splitlines()
    chosen = bias.choose(INSIDE, 0.05, 0.95)
    assert f"{chosen.per_contact:.3g} steps a contact" in step
    assert f"{chosen.bias.value:+.2g}" in taken
    assert price.startswith("price        0.05 of c_x takes about")
    assert main([*how, "--set", "rods.length=30"]) == 0
    assert "measured in place: rods.length 30" in capsys.readouterr().out


def test_a_sweep_takes_a_tolerance(tmp_path):
    """Each point has a length of its own; what was not reached is a failure that says so."""
    store = tmp_path / "a.db"
    base = put(read_tables("quasi2d"), dict(map(_parsed, ROW)))
    tables = {"tolerance": 0.4, "max_seconds": 30, "axes": [{"plate.acceleration": [4, 5]}]}
    tally = execute(expand(tables, base), store, workers=1)
    assert (tally.computed, tally.failed) == (2, 0)
    assert execute(expand(tables, base), store, workers=1).there == 2
    (periods,) = expand(tables, base).gather(store, "periods")
    assert (periods >= accuracy.FIRST_LOOK).all()
    _, rows = table(store)
    assert {row["accuracy.state"] for row in rows} == {"reached"}
    hard = {**tables, "tolerance": 1e-4, "max_seconds": 0.05}
    assert execute(expand(hard, base), store, workers=1).failed == 2
    with Store(store, write=False) as database:
        assert "NOT REACHED" in [run["error"] for run in database.rows()][-1]


def test_a_run_to_a_tolerance_goes_on_from_its_checkpoint(tmp_path, monkeypatch):
    """And says at once what it has; several starts have no checkpoint."""
    calibrated(monkeypatch)
    scene, file = row("plate.acceleration=5"), tmp_path / "a.npz"
    how = {"tolerance": 0.2, "floor": 0.05, "checkpoint": file}
    first, again = md.run(scene, **how), md.run(scene, **how)
    assert again.periods == first.periods
    assert again.c_x == first.c_x
    with pytest.raises(md.InputError, match="checkpoint must be None with several workers"):
        md.run(scene, **how, workers=2)


def test_starts_wait_for_one_that_is_late(monkeypatch):
    """Far behind, as where it compiles or shares its core, it changes no number."""
    calibrated(monkeypatch)
    usual, scene = accuracy.simulation.run, row("plate.acceleration=5")
    how = {"tolerance": 0.05, "floor": 0.05, "workers": 2}
    expected = md.run(scene, **how)

    def late(scene, **options):
        if scene.start.seed > accuracy.SEED_GAP:
            time.sleep(1)
        return usual(scene, **options)

    monkeypatch.setattr(accuracy.simulation, "run", late)
    found = md.run(scene, **how)
    assert (found.c_x, found.accuracy.made) == (expected.c_x, expected.accuracy.made)
    assert found.accuracy.made > 2 * accuracy.FIRST_LOOK


def pressed(monkeypatch, periods):
    """Ctrl-C after so many periods of the first run."""
    usual = accuracy.simulation.run

    def stopped(scene, **_):
        return replace(usual(scene, periods=periods), finished=False)

    monkeypatch.setattr(accuracy.simulation, "run", stopped)


def test_what_is_pressed_while_the_bias_is_measured_ends_the_command(monkeypatch, capsys):
    """Of the run with the longer step nothing is told or kept."""
    pressed(monkeypatch, 5)
    assert main(["run", "quasi2d", *SMALL, "--tolerance", "0.3"]) == 130
    told = "interrupted: the bias of the step was being measured, nothing is kept\n"
    assert capsys.readouterr() == ("", f"python -m md run: {told}")


@pytest.mark.parametrize("periods", [5, 300])
def test_what_an_interrupted_run_does_not_know_is_not_told(monkeypatch, periods):
    """The error of a few periods; how long it would have taken, before the first look."""
    calibrated(monkeypatch)
    pressed(monkeypatch, periods)
    result = md.run(row("plate.acceleration=5"), tolerance=1e-4)
    assert not result.finished
    assert np.isnan(result.c_x_stderr) == (periods == 5)
    assert "inf" not in result_text(result)
    assert "known no better" not in result_text(result)


def test_a_seed_that_leaves_none_for_the_other_starts_is_refused():
    with pytest.raises(md.InputError, match=r"start\.seed must be between"):
        md.run(row(f"start.seed={2**63 - 1}"), tolerance=0.05, workers=2)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"workers": 2}, "workers has no meaning without tolerance"),
        ({"confidence": 0.9}, "confidence has no meaning without tolerance"),
        ({"tolerance": 0.1, "workers": 0}, "workers must be"),
        ({"tolerance": 0.1, "workers": 65}, "workers must be"),
    ],
)
def test_options_of_a_tolerance_are_refused(options, words):
    with pytest.raises(md.InputError, match=words):
        md.run(INSIDE, **options)
    if "tolerance" in options:
        with pytest.raises(md.InputError, match=words):
            plans.plan(INSIDE, **options)
