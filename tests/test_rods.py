"""One name for all commands."""

import os
import sys
from unittest.mock import Mock

import pytest

from figures.rods import COMMANDS, main

from .command_line import python

SCRIPT = "from figures.rods import main; main()"


def test_each_command_has_the_same_name_under_rods(monkeypatch):
    """Each command takes the place of the process; one of them is seen doing so."""
    run = Mock(side_effect=SystemExit)
    monkeypatch.setattr(os, "execv", run)
    for name in COMMANDS:
        monkeypatch.setattr(sys, "argv", ["rods", name, "--version"])
        with pytest.raises(SystemExit):
            main()
        run.assert_called_with(sys.executable, [sys.executable, "-m", name, "--version"])
    told, wanted = (python(*words, name, "--version").stdout for words in (("-c", SCRIPT), ("-m",)))
    assert told == wanted != ""
    unknown = python("-c", SCRIPT, "rod")
    assert (unknown.returncode, unknown.stderr) == (1, "rods: no command 'rod'\n")
    assert all(name in unknown.stdout for name in COMMANDS)
