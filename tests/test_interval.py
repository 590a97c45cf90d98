"""Intervals of drifts: cuts, pooled starts, trends, and how often runs that end by them hold."""

import numpy as np
import pytest
from numpy.random import default_rng
from scipy.special import ndtri
from scipy.stats import t as student

from md import accuracy
from md.measures import standard_error

from .test_statistics import autoregressive


def interval(series, fell=0, **how):
    """Interval of starts with these drifts, whose rods fall over alike in each period."""
    starts = [np.array([one, np.broadcast_to(fell, len(one))]) for one in series]
    return accuracy.interval(starts, **how)


@pytest.mark.parametrize(("periods", "transient", "cut"), [(5000, 400, 400), (1000, 250, 300)])
def test_a_transient_is_left_out_and_hardly_more(periods, transient, cut):
    """A fifth is left out, 400 periods at most, and tenths more while the rest has a trend."""
    series = 1 + 0.1 * default_rng(6).normal(size=periods)
    series[:transient] += 2
    assert interval([series]).mean == series[cut:].mean()


@pytest.mark.parametrize(
    ("cuts", "confidence"), [({1000: 200}, 0.9), ({1000: 200, 500: 150}, 0.95)]
)
def test_starts_in_one_state_are_pooled(cuts, confidence):
    """Weights as their lengths; the error is Student's, of one series as long as all."""
    random = default_rng(2)
    series = [autoregressive(random, n, 0.3) for n in cuts]
    found = interval(series, confidence=confidence)
    rest = [one[cuts[len(one)] :] for one in series]
    n = np.array([*map(len, rest)])
    assert (found.mean, found.settled) == (pytest.approx(np.concatenate(rest).mean()), True)
    error = np.linalg.norm(n * [standard_error(one) for one in rest]) / n.sum()
    student_error = student.ppf((1 + confidence) / 2, n.sum() // 30) * error
    assert found.half == pytest.approx(student_error, rel=1e-12)
    assert np.isnan(found.chance) == (len(cuts) == 1)


@pytest.mark.parametrize(("annulus", "apart"), [(False, 1.0), (True, 0.019)])
def test_starts_in_several_states_are_told_and_their_scatter_counts(annulus, apart):
    """An annulus tells them sooner: by a chance of 1 %, which a row takes for one state."""
    random = default_rng(3)
    series = [apart * level + 0.1 * random.normal(size=900) for level in (0, 0, 1)]
    found = interval(series, annulus=annulus)
    means = [one[300 if annulus else 180 :].mean() for one in series]
    assert found.chance < accuracy.UNLIKELY[annulus]
    assert annulus == (interval(series).chance > accuracy.UNLIKELY[False])
    assert found.half == pytest.approx(student.ppf(0.975, 2) * np.std(means, ddof=1) / np.sqrt(3))


def test_a_run_that_has_not_settled_is_told():
    """Its goal is never reached; the change between halves of its second half is an error."""
    trending = np.linspace(1, 2, 800) + 0.1 * default_rng(4).normal(size=800)
    found, rest = interval([trending]), trending[400:]
    assert not found.settled
    change = (rest[200:].mean() - rest[:200].mean()) / 2
    assert found.error == pytest.approx(np.hypot(change, standard_error(rest)))
    goal = accuracy._Goal(0.5, 0.95, 0.0, 1e9)
    goal.found = accuracy.allowed(found)
    assert goal.found.error < 0.5 * goal.size
    assert not goal.reached


NOISE = 1 + 0.1 * default_rng(8).normal(size=(2, 1000))
SOMETIMES = default_rng(9).poisson(0.2, 1000)
EARLY = SOMETIMES * (np.arange(1000) < 150)
LATE = SOMETIMES * (np.arange(1000) > 700)


@pytest.mark.parametrize(
    ("fell", "settled"),
    [(0, True), (SOMETIMES, True), (EARLY, True), (LATE, False), (np.linspace(0, 3, 1000), False)],
    ids=["none", "steadily", "in the transient", "late", "ever more"],
)
def test_starts_that_agree_while_ever_more_rods_fall_have_not_settled(fell, settled):
    """Starts that decay together show nothing by their scatter; a steady rate is settled."""
    found = interval(NOISE, fell=fell)
    assert found.settled == settled
    assert found.chance > 0.01
    assert (found.error > interval(NOISE).error) == bool(found.fell)


def test_where_rods_fall_the_change_between_the_halves_is_an_error():
    """A decay so slow that the trend is lost in noise, by the same amount in each start."""
    slow = NOISE + np.linspace(0, 0.02, 1000)
    found = interval(slow, fell=SOMETIMES)
    assert found.settled
    change = (slow[:, 200:600] - slow[:, 600:]).mean(axis=1) / 2
    errors = np.hypot(change, [standard_error(one[200:]) for one in slow])
    assert found.error == pytest.approx(np.hypot(*errors) / 2)


def followed(starts, tolerance, confidence=0.95):
    """The goal of starts with these drifts, as it ends."""
    goal = accuracy._Goal(tolerance, confidence, 0.0, 1e9, len(starts))
    periods = goal.first
    while periods:
        histories = [np.array([drift[:periods], np.zeros(periods)]) for drift in starts]
        periods = goal.judge(histories, seconds=1.0)
    return goal


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.7])
@pytest.mark.parametrize("length", [300, 1500])
def test_runs_that_end_by_their_own_interval_hold_the_mean_as_often_as_they_say(memory, length):
    """Of 400 runs 92 to 98 in a hundred hold it, to two standard deviations of so many."""
    random, hits, unsettled = default_rng(5), 0, 0
    tolerance = ndtri(0.975) / (1 - memory) / np.sqrt(length)
    for _ in range(400):
        goal = followed(1 + autoregressive(random, (2, 10 * length), memory), tolerance)
        hits += abs(goal.found.mean - 1) <= goal.found.statistical
        unsettled += not goal.reached
    assert unsettled <= 4
    spread = 2 * np.sqrt(0.05 * 0.95 / 400)
    assert 0.92 - spread <= hits / 400 <= 0.98 + spread


def test_what_does_not_drift_is_known_at_once():
    goal = followed(np.zeros((2, 1000)), 0.1)
    assert (goal.reached, goal.found.error) == (True, 0)


@pytest.mark.parametrize("n", [0, 1, 7, 99])
def test_few_values_have_no_interval(n):
    assert interval([np.ones(n)]).half == np.inf
