"""Whether runs to a tolerance are off by no more than they say, over drawn scenes.

A scene takes minutes of two cores, all of them hours: `python -m pytest -m hours`.
"""

from dataclasses import replace
from functools import cache
from typing import NamedTuple
from unittest.mock import patch

import numpy as np
import pytest
from scipy.stats import qmc

import md
from md import accuracy
from md.accuracy import ALLOWANCE, STEPS_PER_CONTACT, steps_per_contact
from md.scene import from_tables, put, read_tables

from .command_line import read_toml
from .rows import CONSTRAINT, seeded

FINER = 3  # times the steps of the rule
ACCURATE = 0.0075  # tolerance of the reference, and of the run at the rule's step
STARTS = accuracy.STARTS, 4  # of a row; of an annulus, where each start has its own arrangement
RANGES = read_toml("tests/allowance.toml")


def drawn(annulus):
    """Scenes drawn evenly from ranges in which rows keep their tilt, and annuli."""
    ranges = RANGES["annulus" if annulus else "row"]
    for parts in qmc.Sobol(len(ranges), seed=11).random(8 if annulus else 32):
        to = {"step": "none"}
        for (key, (low, high)), part in zip(ranges.items(), map(float, parts), strict=True):
            log = key.endswith("ratio")
            to[key] = low * (high / low) ** part if log else low + (high - low) * part
        yield (annulus_of if annulus else row_of)(to)


def annulus_of(to):
    """Walls are like the plate."""
    to |= {key.replace("plate", "wall"): to[key] for key in to if key.startswith("contacts.plate")}
    to["rods.count"] = round(to["rods.count"])
    return from_tables(put(read_tables("annulus"), to))


def row_of(to):
    base = read_tables("quasi2d")
    to["box.length"] = base["rods"]["count"] / np.cos(np.radians(to.pop("tilt_deg")))
    if to.pop("law") > 0.75:
        to |= dict(change.split("=") for change in CONSTRAINT)
        to["contacts.plate.tangential_damping"] = "none"
    return from_tables(put(base, to | {"start.speed": 0.3}))


class Judged(NamedTuple):
    """Drifts of a scene by the rule against finer ones."""

    bias: float  # relative; of the rule's step
    bias_error: float  # standard error
    off: np.ndarray  # errors of runs to 3 % over those that they state
    within: np.ndarray  # whether they are no larger, the reference's own error allowed for


def found(scene, per_contact):
    """Drift of several starts at a step, by statistics alone to `ACCURATE`."""
    step = md.Step(steps_per_contact(scene, 1.0) / per_contact, coarse=True)
    annulus = scene.annulus is not None
    starts = STARTS[annulus]
    runs = accuracy.starts_of(replace(scene, step=step), starts, False, {"ledger": False})
    with patch.object(accuracy, "ALLOWANCE", 0.0):
        goal = accuracy._Goal(ACCURATE, 0.95, 0.0, 150.0, starts, annulus)
        accuracy.pursued(goal, runs)
    return goal.found


def judged(scene):
    """A scene's errors; None where a run has not settled, or starts are in several states.

    Of annuli, whose starts differ more, only the bias is judged.
    """
    how = {"tolerance": 0.03, "max_seconds": 60, "ledger": False}
    seeds = (1, 2, 3) if scene.annulus is None else ()
    runs = [md.run(seeded(scene, seed), **how) for seed in seeds]
    if any(run.accuracy.state == "not settled" for run in runs):
        return None
    rule, truth = (found(scene, times * STEPS_PER_CONTACT) for times in (1, FINER))
    if not (rule.settled and truth.settled):
        return None
    if max(rule.statistical, truth.statistical) > 2 * ACCURATE * abs(truth.mean):
        return None
    pairs = [(run.c_x - truth.mean, run.accuracy.error) for run in runs]
    errors, stated = np.reshape(pairs, (-1, 2)).T
    return Judged(
        bias=rule.mean / truth.mean - 1,
        bias_error=np.hypot(rule.statistical, truth.statistical) / abs(truth.mean) / 1.96,
        off=errors / stated,
        within=np.abs(errors) <= np.hypot(stated, truth.statistical),
    )


@cache
def scenes(annulus):
    """Drawn scenes that settle in one state."""
    return [one for one in map(judged, drawn(annulus)) if one is not None]


@pytest.mark.hours
@pytest.mark.parametrize("annulus", [False, True], ids=["rows", "annuli"])
def test_the_bias_of_the_step_is_within_its_allowance(annulus):
    """Over scenes: what their errors leave of the mean square bias, to two standard errors.

    The allowance is half of an interval that holds 95 %, two standard deviations.
    """
    every = scenes(annulus)
    assert len(every) >= (5 if annulus else 20)
    square = np.array([one.bias**2 - one.bias_error**2 for one in every])
    mean, spread = square.mean(), square.std(ddof=1) / np.sqrt(len(square))
    assert mean - 2 * spread <= (ALLOWANCE / 2) ** 2
    assert abs(np.mean([one.bias for one in every])) <= ALLOWANCE


@pytest.mark.hours
def test_runs_are_off_by_as_much_as_they_say():
    """Three runs of each scene to 3 % are within the stated error in 17 of 20 or more.

    Stated errors are neither padded nor boastful: the root mean square of true over stated ones,
    which 95 % make 0.51, is 0.3 to 0.7.
    """
    every = scenes(False)
    within = np.concatenate([one.within for one in every])
    off = np.concatenate([one.off for one in every])
    rms = np.sqrt(np.mean(off**2))
    assert within.mean() >= 17 / 20
    assert 0.3 <= rms <= 0.7
