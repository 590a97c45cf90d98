"""Runs as they are seen from outside: several starts at once, a limit of time, progress."""

import signal
import sys
from unittest.mock import Mock

import numpy as np
import pytest

import md
from md import accuracy
from md.result import accuracy_lines
from md.simulation import Run

from .rows import DRIVEN, row

SCENE = row(DRIVEN)


def test_one_start_that_fails_ends_all(monkeypatch):
    """The others end at once: they do not go on to the first look."""
    usual, made = Run.march, []

    def failing(running, _, stop):
        if running.engine.scene.start.seed > accuracy.SEED_GAP:
            raise md.RunError("no longer finite")
        usual(running, 50_000, stop)
        made.append(running.made)

    monkeypatch.setattr(Run, "march", failing)
    with pytest.raises(md.RunError, match="no longer finite"):
        md.run(SCENE, tolerance=0.01)
    assert made[0] < 50_000


def test_what_a_handler_raises_ends_all_starts(monkeypatch):
    usual, made = Run.march, []
    monkeypatch.setattr(accuracy, "FIRST_LOOK", 50_000)
    monkeypatch.setattr(accuracy, "as_completed", Mock(side_effect=KeyboardInterrupt))
    monkeypatch.setattr(Run, "march", lambda *a: (usual(*a), made.append(a[0].made)))
    with pytest.raises(KeyboardInterrupt):
        md.run(SCENE, tolerance=0.01)
    assert max(made) < 50_000


@pytest.mark.parametrize("periods", [0, 5])
def test_what_an_interrupted_run_does_not_know_is_not_told(monkeypatch, periods):
    """After few periods, or none, neither the error is told nor how long it would have taken."""
    usual = accuracy._together

    def few(runs, _, stop):
        usual(runs, periods, stop)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(accuracy, "_together", few)
    result = md.run(SCENE, tolerance=0.05)
    assert (result.finished, result.accuracy.state) == (False, "not settled")
    assert accuracy_lines(result) == ["accuracy     INTERRUPTED: ended too early to tell the error"]
    assert np.isfinite(result.c_x) == (periods > 0)
    assert np.isnan(result.c_x_stderr)
    assert "inf" not in str(result)


def test_a_limit_of_time_holds(monkeypatch):
    """It holds however far the second look is; the first one is made in any case."""
    monkeypatch.setattr(accuracy, "GROWTH", (300, 300))
    result = md.run(SCENE, tolerance=0.02, max_seconds=1)
    first = 2 * accuracy.FIRST_LOOK
    assert first <= result.accuracy.made < 300 * first


@pytest.mark.parametrize("terminal", [True, False])
def test_progress_is_shown_on_a_terminal_alone(terminal, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal)
    with Run(SCENE, 1, progress=True) as running:
        assert running.bar.disable != terminal
