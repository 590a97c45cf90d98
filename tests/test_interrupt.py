"""Signals: none comes in the midst of compiled code, a compilation or a file that is written."""

import inspect
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial

import pytest
from numba.extending import overload
from numpy.random import default_rng

import impact
import md
from derivations import command_line as theirs
from derivations import files
from impact import _interrupt, _jit, bouncing
from md import cache, command_line
from md.files import replacing
from md.host import prepare
from md.kernels.march import march
from md.kernels.state import Clock

from .command_line import ROOT, each_signal, ended, left, python
from .rows import LIVELY, go, row
from .track import CONTACT

COMMAND_LINE = "handle", "stop", "Commands"


class RungError(Exception):
    """What the handler raises."""


@pytest.fixture(autouse=True)
def alarm():
    """Handlers that do not end the tests, one that raises; a function to let it run in a while."""

    def ring(*_):
        raise RungError

    usual = {number: signal.getsignal(number) for number in cache.SIGNALS}
    signal.signal(signal.SIGALRM, ring)
    signal.signal(signal.SIGTERM, lambda *_: pytest.fail("SIGTERM"))
    yield partial(signal.setitimer, signal.ITIMER_REAL)
    signal.setitimer(signal.ITIMER_REAL, 0)
    for number, handler in usual.items():
        signal.signal(number, handler)


# Signals that wait


def test_all_packages_do_the_same():
    """Sources that stand in several packages are the same: none imports another."""
    for one, other in (
        (_interrupt.deferred, cache.deferred),
        (files.plain, md.files.plain),
        (files.replacing, replacing),
        *((getattr(theirs, name), getattr(command_line, name)) for name in COMMAND_LINE),
    ):
        assert inspect.getsource(one) == inspect.getsource(other)


def test_handlers_run_at_the_end_of_the_outermost():
    """All handlers run, though each raises; then they are in their places again."""
    done = []

    def handle(number, _):
        done.append(number)
        raise RungError

    @cache.deferred()
    def inner():
        for number in cache.SIGNALS:
            signal.raise_signal(number)
        done.append("inner")

    @cache.deferred()
    def outer():
        inner()
        done.append("outer")

    for number in cache.SIGNALS:
        signal.signal(number, handle)
    with pytest.raises(RungError):
        outer()
    assert done[:2] == ["inner", "outer"]
    assert sorted(done[2:]) == sorted(cache.SIGNALS)
    with pytest.raises(RungError):
        signal.raise_signal(signal.SIGALRM)


def test_other_threads_have_no_signals():
    """Work in another thread, where Python would refuse a handler, is done without."""
    with ThreadPoolExecutor() as pool:
        assert pool.submit(cache.deferred()(lambda: True)).result()


@pytest.mark.parametrize(
    ("kernel", "called"),
    [(cache.kernel, partial(cache.kernel, entry=True)), (_jit.kernel, _jit.kernel)],
    ids=["md", "impact"],
)
def test_a_compilation_ends_before_a_handler_runs(kernel, called, monkeypatch, tmp_path):
    """A signal in the innermost of two kernels leaves both compiled."""
    monkeypatch.setattr(cache, "directory", lambda: tmp_path)

    def one():
        return 1.0

    @overload(one)
    def _typed():
        signal.raise_signal(signal.SIGALRM)
        return lambda: 1.0

    @kernel
    def inner(x):
        return x + one()

    @called
    def outer(x):
        return 2 * inner(x)

    with pytest.raises(RungError):
        outer(1.0)
    assert outer.signatures
    assert inner.signatures
    assert outer(1.0) == 4.0


# Calls that return to Python


def test_no_kernel_builds_its_result_by_calling_python():
    """No part is a named tuple, which Numba builds in Python and dies if a handler raises there."""
    engine = prepare(row(*ALOFT))
    clock = Clock(0, engine.dt)
    parts = [march(engine.effects, engine.state, engine.watchers, clock, 1)]
    while parts:
        part = parts.pop()
        assert not hasattr(part, "_fields")
        parts += part if isinstance(part, tuple) else ()


ALOFT = "gravity.z=0", "start.drop=9", "start.speed=0"  # no touch of which a record is full
HELD = {"gamma": 3.3, "friction": 0.3, "restitution": 0.65}


@pytest.mark.parametrize(
    "last",
    [
        lambda n: md.impact(0.0, 0.0, -1.0, friction=0.3, dt=CONTACT / min(100 * n, 1e8)),
        lambda n: bouncing.bounce(impact.thin_rod(0.3), **HELD, landings=1, transient=n),
        lambda n: go(prepare(row(*ALOFT)), n),
    ],
    ids=["touching", "bouncing", "marching"],
)
def test_what_lasts_for_hours_can_be_stopped(last, alarm):
    last(1)  # compiles
    alarm(0.1)
    with pytest.raises(RungError):
        last(10**12)


def test_parts_give_the_bits_of_the_whole(monkeypatch):
    """Landings, transient or not, and a soft contact do."""

    def results():
        held = bouncing.record(impact.thin_rod(0.3), **HELD, landings=60, transient=25)
        soft = md.impact(0.3, 0.5, -1.0, friction=0.4, dt=1e-5)[:-1]
        return [array.tobytes() for array in held], soft

    whole = results()
    monkeypatch.setattr(bouncing, "_LANDINGS_A_CALL", 10)
    monkeypatch.setattr(md.soft_impact, "_STEPS_A_CALL", 100)
    assert results() == whole


# SIGTERM is Ctrl-C


def exit_code(monkeypatch, work):
    """Exit code of a program whose one command is `work`."""
    group = command_line.Commands("it")
    group.command("work")(work)
    monkeypatch.setattr(sys, "argv", ["it", "work"])
    monkeypatch.setattr(os, "dup2", lambda *_: None)  # the output of the tests stays
    with pytest.raises(SystemExit) as end:
        group.program()
    return end.value.code


LOSING = """
import signal
try:
    signal.raise_signal({})
except BaseException:
    pass
"""
IMPORTING = """
from derivations.command_line import Commands
main = Commands("it")
main.command("work")(lambda: __import__("losing"))
main.program()
"""


@each_signal
def test_a_signal_that_an_import_would_lose_ends_the_command(number, tmp_path):
    (tmp_path / "losing.py").write_text(LOSING.format(int(number)))
    assert python("-c", IMPORTING, "work", cwd=tmp_path).returncode == -number


def test_a_signal_that_a_late_import_would_lose_ends_the_command(tmp_path):
    """In `md` it is held back until the import is over."""
    (tmp_path / "joblib.py").write_text(LOSING.format(int(signal.SIGTERM)))
    done = python("-m md sweep drift --store a.db", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (130, 1)


def test_standard_output_that_is_closed_costs_one_line(monkeypatch, capsys):
    """Nothing is begun that could not be told: Python has no standard output then."""
    monkeypatch.setattr(sys, "stdout", None)
    assert exit_code(monkeypatch, pytest.fail) == 2
    assert capsys.readouterr().err == "it: cannot write: standard output is closed\n"


def test_a_figure_is_not_made_of_half_a_run(monkeypatch):
    """A figure ends where `md.run` would return half a run, marked as not finished."""

    def figure():
        md.run(row(*LIVELY), periods=100_000, observe=lambda _: signal.raise_signal(signal.SIGINT))

    assert exit_code(monkeypatch, figure) == 130


def test_a_handler_of_ones_own_ends_a_run(tmp_path, alarm):
    """A run that a handler ends leaves no half-written file."""
    alarm(0.3)
    with pytest.raises(RungError):
        md.run(row(), periods=10**6, checkpoint=tmp_path / "row.npz")
    assert not list(tmp_path.iterdir())


# Files


def test_a_file_that_is_not_finished_is_not_there(tmp_path):
    """The old file stays, with nothing beside it; what a killed process left is replaced."""
    path = tmp_path / "picture.png"
    path.write_text("old")
    with suppress(KeyboardInterrupt), replacing(path) as part:
        part.write_text("half")
        raise KeyboardInterrupt
    assert [file.read_text() for file in tmp_path.iterdir()] == ["old"]
    part.write_text("left by a kill")
    with replacing(path) as part:
        part.write_text("whole")
    assert [file.read_text() for file in tmp_path.iterdir()] == ["whole"]


# Numba without its compiler


@pytest.mark.parametrize(
    ("command", "code"),
    [
        ("figures draw alpha", 2),
        ("md run my_rods --periods 1 --set rods.count=2 --set box.length=2.2", 0),
    ],
)
def test_without_the_compiler(command, code, tmp_path):
    """What Python can do it does, slowly; what it cannot is said without a traceback."""
    done = python(f"-m {command}", cwd=tmp_path, NUMBA_DISABLE_JIT="1")
    assert done.returncode == code
    assert bool(done.stdout) == (code == 0)
    assert ("NUMBA_DISABLE_JIT is set" in done.stderr) == (code > 0)
    assert "Traceback" not in done.stderr


# Any time


@pytest.mark.parametrize(
    ("line", "number"),
    [
        ("md sweep drift --store a.db", signal.SIGINT),
        ("figures draw --all", signal.SIGTERM),
        ("derivations check", signal.SIGINT),
    ],
)
def test_a_signal_during_the_imports_ends_the_command(line, number, tmp_path):
    """It does from the first module of the package on, whatever is being imported."""
    package, *words = line.split()
    command = [sys.executable, "-X", "importtime", "-m", package, *words]
    for seconds in (0.0, 0.2):
        with subprocess.Popen(
            command,
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            text=True,
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(ROOT)},
        ) as process:
            while "click" not in process.stderr.readline():
                assert process.poll() is None
            time.sleep(seconds)
            process.send_signal(number)
            said = [x for x in process.stderr if not x.startswith("import time:")]
        assert process.returncode in (-number, 130)
        assert len(said) == (process.returncode == 130)
        assert all(line.startswith(f"python -m {package}") for line in said)


def test_a_package_that_imports_this_one_keeps_ctrl_c(tmp_path):
    """Python imports it as it imports the package of a command, for `python -m`."""
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "__init__.py").write_text("import derivations, figures, md")
    told = "import signal; print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)"
    (mine / "__main__.py").write_text(told)
    assert python("-m mine", cwd=tmp_path).stdout == "True\n"


LONG = {
    "run": "md run quasi2d --periods 1000000 --checkpoint a.npz",
    "claims": "figures claims --quick",
    "draw": "figures draw alpha tip_shape --jobs 2",
}


@each_signal
@pytest.mark.parametrize("name", LONG)
def test_a_signal_at_any_time_ends_the_command(name, number, tmp_path):
    """A command ends as it compiles, half of the times, or runs, and leaves results alone."""
    random = default_rng(number)
    for cold in (True, False) * 5:
        folder = tmp_path / str(random.integers(10**9))
        folder.mkdir()
        home = {"XDG_CACHE_HOME": str(folder / "cache")} if cold else {}
        seconds = random.uniform(0.3, 15)
        code, _, error = ended(number, folder, LONG[name], seconds=seconds, **home)
        assert code in (130, -number)
        if code < 0:  # before anything was begun
            assert not error
        else:
            assert error.count("\n") in ((0, 1) if name == "run" else (1,))  # or a result
        assert not [*folder.glob("*.part*")]
        assert not left(folder)
