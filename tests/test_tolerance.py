"""Accuracy: intervals, choice of the step, runs that end when they are accurate enough."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_array_equal

import md
from md import accuracy
from md.accuracy import ALLOWANCE, STEPS_PER_CONTACT, stepped, steps_per_contact
from md.host import stable_step
from md.result import accuracy_lines, result_text
from md.scene import _parsed, put, read_tables
from md.store import table
from md.sweep import execute, expand

from .command_line import enter
from .rows import DRIVEN, ROW, row, seeded, sets

SCENE = row(DRIVEN)


# Choice of the step


@pytest.mark.parametrize("scene", ["quasi2d", "my_rods", "annulus"])
@pytest.mark.parametrize("tolerance", [0.5, 0.03, 0.001])
def test_the_step_is_a_part_of_a_contact(scene, tolerance):
    """A contact has as many in any scene, and more below the allowance, where bias is measured."""
    chosen, doubled = stepped(md.load(scene), tolerance)
    n = STEPS_PER_CONTACT * max(1, ALLOWANCE / tolerance)
    assert steps_per_contact(chosen, chosen.step.size) == pytest.approx(n)
    assert doubled == (tolerance < 2 * ALLOWANCE)


@pytest.mark.parametrize("change", ["start.drop=20", "start.speed=50"])
@pytest.mark.parametrize("measure_bias", [False, True])
def test_a_fall_at_the_start_takes_no_step_that_is_not_stable(change, measure_bias, monkeypatch):
    """The longest stable step is taken, shorter than the rule's; if doubled, twice it is stable."""
    monkeypatch.setattr(accuracy, "STEPS_PER_CONTACT", 4)
    chosen, _ = stepped(md.load("quasi2d", [change]), 0.3, measure_bias=measure_bias)
    assert steps_per_contact(chosen, chosen.step.size) > 4
    size = chosen.step.size * (1 + measure_bias)
    assert md.host.step_of(replace(chosen, step=md.Step(0.99 * size, coarse=True)))[0] <= size
    with pytest.raises(md.InputError, match="to be stable"):
        md.host.step_of(replace(chosen, step=md.Step(1.05 * size, coarse=True)))


def test_the_bias_of_rows_that_hardly_lean_is_measured_by_steps_stable_for_their_friction():
    """The allowance is for rows that lean 18 degrees or more; one that just does takes it."""
    length = md.load("quasi2d").rods.count / np.cos(np.radians([17.9, 18.3]))
    upright, leaning = (["step.size=none", f"box.length={x}"] for x in length)
    chosen, measured = stepped(row := md.load("quasi2d", upright), 0.3)
    assert measured
    assert 2 * chosen.step.size == pytest.approx(stable_step(row)[0])
    for others in (leaning, [*upright, "contacts.rods.friction=0"], ["start.tilt_deg=-21.5"]):
        assert not stepped(md.load("quasi2d", others), 0.3)[1]


def test_the_drift_of_a_row_that_hardly_leans_is_that_of_fine_steps():
    """At 24 steps a contact it would be nine times as fast, as its rods would stick too seldom."""
    jammed = ["rods.count=20", "box.length=20.5", "plate.acceleration=2"]
    found = md.run(md.load("quasi2d", jammed), tolerance=0.5)
    finer = md.run(md.load("quasi2d", [*jammed, "step.size=4e-5"]), periods=320)
    assert abs(found.c_x - finer.c_x) < found.accuracy.error + 3 * finer.c_x_stderr
    coarse = md.load("quasi2d", [*jammed, "step.size=3.3e-4", "step.coarse=true"])
    assert md.run(coarse, periods=320).c_x > 5 * finer.c_x
    shaken = [*jammed, "step.size=5e-4", "step.coarse=true", "contacts.rods.tangential_damping=0.3"]
    assert "energy does not balance" in str(md.run(md.load("quasi2d", shaken), periods=100))
    assert "balance" not in f"{finer}{found}"


def test_the_bias_of_a_law_of_ones_own_is_measured():
    scene = md.load("quasi2d")
    contact = scene.contacts.rods
    own = replace(contact.law, name="own", normal=md.Normal(5e6, constant=1.0))
    contacts = replace(scene.contacts, rods=replace(contact, law=own))
    assert stepped(replace(scene, contacts=contacts), 0.1)[1]


# Runs


def interval(*runs, **how):
    """Interval of the drift that runs have measured, as a run to a tolerance finds it."""
    return accuracy.interval([np.array([r.c_x_series, r.fell_series]) for r in runs], **how)


def pooled(scene, periods):
    """Interval of the two starts of a run to a tolerance."""
    seeds = 1, accuracy.SEED_GAP + 1
    return interval(*(md.run(seeded(scene, seed), periods=periods) for seed in seeds))


def test_a_run_ends_as_soon_as_it_is_accurate():
    """Its first start is the plain run of that step and that many periods."""
    result = md.run(SCENE, tolerance=0.3, floor=0.05)
    a = result.accuracy
    assert (a.state, a.starts, a.bias, a.bias_measured) == ("reached", 2, 0.0, False)
    assert result.scene == stepped(SCENE, 0.3)[0]
    plain = md.run(result.scene, periods=result.periods)
    assert_array_equal(plain.c_x_series, result.c_x_series)
    assert a.made == 2 * result.periods
    found = pooled(result.scene, result.periods)
    assert (result.c_x, a.statistical, a.chance) == (found.mean, found.half, found.chance)
    assert a.bias_error == ALLOWANCE * abs(result.c_x)
    assert a.error == pytest.approx(np.hypot(a.statistical, a.bias_error))
    assert a.error <= 0.3 * max(abs(result.c_x), 0.05)
    assert a.next_digit_seconds > 50 * (a.error / (0.3 * abs(result.c_x))) ** 2 * a.seconds


def test_the_bias_is_measured_by_steps_twice_as_long():
    """Two thirds of what a step twice as long changes are taken off, and a third is an error.

    Bias of first order is all of the change, of second order a third: the two ends.
    """
    result = md.run(SCENE, tolerance=0.3, floor=0.05, measure_bias=True)
    a = result.accuracy
    assert (a.starts, a.bias_measured) == (4, True)
    longer = replace(result.scene, step=md.Step(2 * result.scene.step.size, coarse=True))
    fine, coarse = (pooled(scene, a.made // 4) for scene in (result.scene, longer))
    change = coarse.mean - fine.mean
    assert a.bias == pytest.approx(2 / 3 * change)
    assert a.bias_error == pytest.approx(abs(change) / 3)
    assert result.c_x == pytest.approx(fine.mean - a.bias)
    assert a.statistical == pytest.approx(np.hypot(5 / 3 * fine.half, 2 / 3 * coarse.half))


def test_slow_drifts_are_judged_by_the_floor():
    """With hardly any friction there is hardly any drift, and its error is one of the floor."""
    result = md.run(row("contacts.plate.friction=0.001"), tolerance=0.5, floor=0.2)
    assert result.accuracy.state == "reached"
    assert abs(result.c_x) < 0.2
    assert result.accuracy.error <= 0.5 * 0.2
    assert "of the floor 0.2" in accuracy_lines(result)[0]


SMALL = sets(*ROW, DRIVEN)


def test_the_command_has_two_ends(monkeypatch):
    """The exit code is 0 if the tolerance is reached, 4 if not, or if nothing settled."""
    printed = enter("md run quasi2d --tolerance 0.3 --floor 0.05 --json", *SMALL)
    found = json.loads(printed.out)["accuracy"]
    assert (found["state"], found["starts"]) == ("reached", 2)
    hard = "md run quasi2d --tolerance 0.05 --max-seconds 0.05 --json"
    monkeypatch.setattr(accuracy, "settled", lambda first, *series: first)
    found = json.loads(enter(hard, *SMALL, code=4).out)  # known after the second look
    assert (found["finished"], found["accuracy"]["state"]) == (True, "not reached")
    assert found["periods"] < 5000
    assert found["accuracy"]["needed_seconds"] > 0.05
    monkeypatch.setattr(accuracy, "settled", lambda first, *series: None)
    printed = enter("md run quasi2d --tolerance 0.5 --max-seconds 1", *SMALL, code=4)
    assert "accuracy     NOT SETTLED" in printed.out


# Rods fall over ever more often for 300 periods; both starts agree meanwhile
LIVELY = """
    rods.count=38 rods.length=6.2 box.length=52 plate.acceleration=2.6
    start.speed=0.3 start.seed=3
    contacts.plate.restitution=0.7 contacts.plate.friction=0.54
    contacts.rods.restitution=0.85 contacts.rods.friction=0.33
    contacts.rods.tangential_ratio=4.2 contacts.rods.tangential_damping=0.35
"""


def test_rods_that_fall_over_ever_more_often_have_not_settled():
    """Two starts that agree have not either; at a steady rate a warning says what is unseen."""
    scene = md.load("quasi2d", LIVELY.split())
    early = md.run(scene, tolerance=0.5, max_seconds=1e-3)
    assert early.accuracy.fell > 100
    assert early.accuracy.chance > 0.01
    assert (early.settled, early.accuracy.state) == (False, "not settled")
    drift = default_rng(1).normal(size=400)
    plain = replace(early, accuracy=None, discarded=0, c_x_series=drift)
    assert replace(plain, fell_series=np.arange(400.0)).settled is False
    assert replace(plain, fell_series=np.ones(400)).settled is True
    assert f"rods fell over {early.accuracy.fell} times: a decay" in str(early)


@pytest.mark.parametrize(("slope", "periods"), [(0, 124), (0, 123), (1, 124), (1, 200)])
def test_a_run_says_whether_its_drift_trends(slope, periods):
    """Without a tolerance it does, behind a fifth, if there are 100 periods; in JSON and a line.

    The seed is of a noise without alarm, as two in a hundred have one.
    """
    result = replace(
        md.run(row(), periods=2),
        c_x_series=0.01 * default_rng(8).normal(size=periods) + slope * np.linspace(0, 1, periods),
        fell_series=np.zeros(periods),
        periods=periods,
        discarded=periods // 5,
    )
    expected = None if periods == 123 else slope == 0
    assert result.as_dict()["settled"] is expected
    assert ("not settled: drift or falls trend" in result_text(result)) == (expected is False)


def test_a_run_says_what_became_of_its_rods():
    """They lean to the other side, or have not touched the plate; results are told apart."""
    result, said = md.run(row(), periods=2), ("turned over", "none has begun")
    assert not any(word in str(result) for word in said)
    none = result.touches | {"per_rod_and_period": {"mean": 0.0, "stderr": 0.0}}
    other = replace(result, tilt_deg=-result.tilt_deg, touches=none)
    assert all(word in str(other) for word in said)
    for tilt in (-0.9, -85.1):  # upright, or lying: +90 degrees are -90 degrees
        assert said[0] not in str(replace(result, tilt_deg=tilt))
    assert result not in (other, replace(result))


def test_an_annulus_is_seen_to_settle():
    """Of the one that ships 600 periods trend behind a fifth, and not behind what is left out.

    Two starts agree within their intervals; of eight, six have settled after 1,500 periods.
    """
    scene = md.load("annulus")
    step = md.Step(steps_per_contact(scene, 1.0) / 16, coarse=True)
    scene = replace(scene, step=step)
    results = [md.run(seeded(scene, seed), periods=1500) for seed in (1, 2)]
    short = replace(results[0], c_x_series=results[0].c_x_series[:600], discarded=120)
    assert short.settled is False
    one, other = (interval(result, annulus=True) for result in results)
    assert one.settled
    assert other.settled
    assert abs(one.mean - other.mean) < np.hypot(one.half, other.half)


def test_a_sweep_takes_a_tolerance(path, monkeypatch):
    """Each point has a length of its own; one that is not reached is a failure that says so."""
    base = put(read_tables("quasi2d"), dict(map(_parsed, ROW)))
    tables = {"tolerance": 0.4, "max_seconds": 30, "axes": [{"plate.acceleration": [4, 5]}]}
    tally = execute(expand(tables, base), path, workers=1)
    assert (tally.computed, tally.failed) == (2, 0)
    again = tables | {"max_seconds": 30.0}
    assert execute(expand(again, base), path, workers=1).there == 2
    (periods,) = expand(tables, base).gather(path, "periods")
    assert (periods >= accuracy.FIRST_LOOK).all()
    assert {row["accuracy.state"] for row in table(path)[1]} == {"reached"}
    hard = {**tables, "tolerance": 0.02, "max_seconds": 0.05}
    monkeypatch.setattr(accuracy, "settled", lambda first, *series: first)
    assert execute(expand(hard, base), path, workers=1).failed == 2
    assert "NOT REACHED" in table(path)[1][-1]["error"]
