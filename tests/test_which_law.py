"""The search over contact laws: its laws are scenes that run, its score counts what is fitted."""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest

from figures.checks import which_law
from figures.checks.contact_laws import COLUMNS
from md.host import step_of


@pytest.fixture(scope="module")
def made():
    """Made-up numbers of a few laws: the first holds all, the last nothing."""
    given = replace(which_law.search(), points=32)
    laws, tilts, random = 32, 7, np.random.default_rng(3)
    grades = random.integers(0, 3, (laws, len(COLUMNS))).astype(float)
    grades[0], grades[-1] = 2, 0
    return {
        "parts": given.draw(),
        "value": random.random((laws, len(COLUMNS))),
        "grade": grades,
        "nominal": np.linspace(9, 60, tilts),
        "theory": np.linspace(12, 3, tilts),
        "c_x": random.random((laws, tilts)),
        "c_x_error": np.full((laws, tilts), 0.1),
    }


def test_every_law_is_a_scene_that_runs_with_a_resolved_spring():
    given = replace(which_law.search(), points=16, seeds=(1,), places=({"box.length": 43.0},))
    parts = given.draw()
    for row, point in zip(parts, given.sweep(parts).points, strict=True):
        values, plate = given.values(row), point.scene.contacts.plate
        assert step_of(point.scene)[0] > 0  # refused, if the step does not resolve the contact
        assert not point.scene.step.coarse
        if values["form"] == which_law.CONSTANT:
            assert plate.law.restitution == values["restitution, plate"]
        else:
            assert plate.law.name == "appendix_a"
            damped = plate.law.normal.constant if values["overlap factor"] == "without" else None
            assert (damped is not None) == (values["overlap factor"] == "without")


def test_the_score_counts_the_fitted_claims_alone(made):
    fitted = [name for name in COLUMNS if name.partition(".")[0] not in which_law.HELD_OUT]
    assert len(fitted) < len(COLUMNS)
    score = which_law.scores(made)
    assert score[0] == len(fitted)
    assert score[-1] == 0
    held_out = np.array([name not in fitted for name in COLUMNS])
    changed = {**made, "grade": np.where(held_out, 0, made["grade"])}
    assert np.array_equal(which_law.scores(changed), score)
    failed = {**made, "grade": np.full_like(made["grade"], np.nan)}
    assert (which_law.scores(failed) == 0).all()


def test_the_picture_and_the_words_show_the_best_law_first(made):
    figure = which_law.draw(made)
    labels = [text.get_text() for ax in figure.axes for text in ax.get_yticklabels()]
    best = np.argsort(-which_law.scores(made), kind="stable")[: which_law.BEST]
    assert best[0] == 0
    assert sum("/" in label for label in labels) == which_law.BEST
    assert len(figure.axes) == 12
    plt.close(figure)
    first = which_law.summary(made).splitlines()
    assert "32 laws" in first[0]
