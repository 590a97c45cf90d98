"""What the tests of several command lines share."""

import os
import signal
import subprocess
import sys
import time
import tomllib
from collections import namedtuple
from contextlib import redirect_stderr, redirect_stdout
from importlib import import_module
from io import StringIO
from pathlib import Path

import psutil
import pytest

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "figures/pages/docs"
PACKAGES = "derivations", "figures", "impact", "md"
COMMANDS = "derivations", "figures", "md"  # packages that have some
each_signal = pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])


def read_toml(path):
    """Tables of a TOML file of the checkout."""
    return tomllib.loads((ROOT / path).read_text("utf-8"))


def called(*words, **options):
    """Run a command; return its exit code and output, as text."""
    return subprocess.run(words, capture_output=True, text=True, **options)


def python(line, *more, cwd=ROOT, **environment):
    """Run Python with a line such as "-m md results", and what else it ends with; see `called`."""
    env = os.environ | {"PYTHONPATH": str(ROOT)} | environment
    return called(sys.executable, *line.split(), *more, cwd=cwd, env=env)


Printed = namedtuple("Printed", "out err")


def enter(line, *more, code=0):
    """Run a line such as "md results", and what else it ends with; its output, if `code` is so."""
    package, *words = line.split()
    with redirect_stdout(StringIO()) as out, redirect_stderr(StringIO()) as err:
        found = import_module(f"{package}.__main__").main([*words, *map(str, more)])
    printed = Printed(out.getvalue(), err.getvalue())
    assert found == code, printed
    return printed


def left(folder):
    """Processes that still work in a folder, after a while."""
    mine = [p for p in psutil.process_iter(["cwd"]) if p.info["cwd"] == str(folder)]
    return psutil.wait_procs(mine, timeout=10)[1]


def names_in(folder):
    """Names of what a folder holds."""
    return {path.name for path in folder.iterdir()}


def refused(word, line, *more):
    """Check one line on stderr, with the word in it, nothing on stdout, exit code 2; the line."""
    out, err = enter(line, *more, code=2)
    assert (out, err.count("\n")) == ("", 1)
    assert word in err
    return err


def ended(number, folder, line, *more, begun=None, seconds=0.0, **environment):
    """Exit code and output of a command in a process of its own, which gets a signal; see `enter`.

    So many seconds after the file `begun` is there and not empty; SIGKILL ends its children too.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", *line.split(), *more],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        start_new_session=True,
        env=os.environ | {"PYTHONPATH": str(ROOT)} | environment,
    )
    while begun and process.poll() is None and not (begun.exists() and begun.stat().st_size):
        time.sleep(0.05)
    time.sleep(seconds)
    os.killpg(process.pid, number) if number == signal.SIGKILL else process.send_signal(number)
    out, error = process.communicate(timeout=120)
    return process.returncode, out, error
