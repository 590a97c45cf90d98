"""Every command: its help, with examples that hold; what it says and how it exits."""

import importlib
import inspect
import os
import shlex
import subprocess
import sys
from functools import partial
from pathlib import Path
from unittest.mock import Mock

import pytest

import figures
import md

from .command_line import COMMANDS, enter, python

GROUPS = {name: importlib.import_module(f"{name}.__main__").main for name in COMMANDS}
# Each command by its words, as "md run", with its group as "md".
ALL = GROUPS | {
    f"{name} {inner}": c for name, g in GROUPS.items() for inner, c in g.commands.items()
}


def said(command):
    """Text of a command in its help, with the lines of its source."""
    return f"{inspect.cleandoc(command.help)}\n{command.epilog or ''}"


def examples(command):
    """Lines of a help that begin with a command, as the shell would split them."""
    lines = (line for line in said(command).splitlines() if line.startswith("python -m "))
    return [shlex.split(line, comments=True)[2:] for line in lines]


EXAMPLES = [words for command in ALL.values() for words in examples(command)]


@pytest.mark.parametrize("name", ALL)
def test_help_is_complete(name, monkeypatch):
    """Options, arguments and commands have words, lines fit, one example is of that command."""
    monkeypatch.setenv("COLUMNS", "80")  # however wide the terminal
    printed, err = enter(name, "--help")
    assert err == ""
    assert max(map(len, printed.splitlines())) <= 100
    for parameter in ALL[name].params:
        shown = (parameter.metavar or parameter.name).strip("[].").upper()
        assert getattr(parameter, "help", None) or shown in said(ALL[name])
    for inner in getattr(ALL[name], "commands", {}).values():
        short = inner.get_short_help_str(100)
        assert short.endswith((".", ")"))
        assert f" {short}\n" in printed
    assert any(f"{' '.join(words)} ".startswith(f"{name} ") for words in examples(ALL[name]))


@pytest.mark.parametrize("words", EXAMPLES, ids=" ".join)
def test_examples_are_commands(words):
    """Each example parses, and names scenes and figures that are there."""
    package, name, *arguments = words
    given = ALL[f"{package} {name}"].make_context(name, arguments).params
    if given.get("scene") not in (None, "mine.toml"):
        assert md.load(given["scene"], given.get("changes", ()))
    assert set(given.get("names", ())) <= set(figures.FIGURES)


# Those that take a second at most; the others are read, not run.
@pytest.mark.parametrize("beginning", ["md impact", "figures list", "md run my_rods --periods"])
def test_cheap_examples_run(beginning, here):
    cheap = [words for words in EXAMPLES if " ".join(words).startswith(beginning)]
    assert cheap
    for words in cheap:
        assert enter(*words).err == ""


DONE = {  # a command, and the function that does its work
    "derivations check": "derivations.__main__._bar",
    "figures index": "figures.pages.index.files",
    "md run single_rod": "md.accuracy.run",
}


@pytest.fixture(params=DONE)
def failing(request, here, monkeypatch):
    """A command, how it is called, and what fails in the midst of its work, as a mock."""
    monkeypatch.setattr(DONE[request.param], work := Mock())
    return " ".join(request.param.split()[:2]), partial(enter, request.param), work


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (KeyboardInterrupt, 130, "interrupted"),
        (MemoryError, 1, "not enough memory"),
        (md.RunError("the contact has not ended", ()), 1, "the contact has not ended"),
    ],
)
def test_ends_before_the_time(failing, error, code, said):
    """Ctrl-C is 130, what fails is 1; one line, that begins with the command."""
    command, call, work = failing
    work.side_effect = error
    out, err = call(code=code)
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith(f"python -m {command}: {said}")


@pytest.mark.parametrize("error", [TypeError, ValueError, RuntimeError])
def test_a_mistake_of_ours_keeps_its_traceback(failing, error):
    """No command takes it for something that the user gave."""
    _, call, work = failing
    work.side_effect = error("a mistake")
    with pytest.raises(error, match="a mistake"):
        call()


def test_help_is_cheap():
    """No command of these packages needs Numba, SciPy or Matplotlib to explain itself."""
    done = python("-c", "import sys, figures.__main__; print(*sys.modules)")
    assert done.returncode == 0
    assert not {"matplotlib", "md", "numba", "scipy", "sympy"} & {*done.stdout.split()}


def test_modules_that_need_numba_are_attributes_of_impact():
    done = python("-c", "import impact; print(impact.bouncing.Bouncing, impact.compiled.__name__)")
    assert done.stdout.split()[-1] == "impact.compiled"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a disk that is always full")
@pytest.mark.parametrize(
    ("words", "unbuffered"),
    [("figures --help", ""), ("figures list", "1")],
)
def test_output_in_a_pipe_is_plain(words, unbuffered):
    """No colours come, even if asked for; a reader that has left is no error, a full disk a line.

    Whether the pipe breaks as a line is printed or, buffered, as the program ends.
    """
    command = [sys.executable, "-m", *words.split()]
    environment = {**os.environ, "FORCE_COLOR": "1", "PYTHONUNBUFFERED": unbuffered}
    reader, writer = os.pipe()
    os.close(reader)
    with Path("/dev/full").open("w") as full:
        done, gone, no_room = (
            subprocess.run(command, stdout=out, stderr=subprocess.PIPE, text=True, env=environment)
            for out in (subprocess.PIPE, writer, full)
        )
    os.close(writer)
    assert done.stdout
    assert "\x1b" not in done.stdout
    assert (done.returncode, done.stderr) == (gone.returncode, gone.stderr) == (0, "")
    assert (no_room.returncode, no_room.stderr.count("\n")) == (2, 1)
