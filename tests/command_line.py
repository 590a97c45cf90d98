"""What the tests of several command lines share."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]


def refused(call, word, capsys):
    """Check one line on stderr, with the word in it, nothing on stdout, exit code 2; the line."""
    assert call() == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert word in printed.err
    return printed.err


def ended(
    arguments,
    number,
    folder,
    *,
    begun=None,
    seconds=0.0,
    **environment,
):
    """Exit code and output of `python -m ...`, which gets a signal.

    So many seconds after the file `begun` is there and not empty; SIGKILL ends its children too.
    """
    process = subprocess.Popen(
        [sys.executable, "-m", *arguments],
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
