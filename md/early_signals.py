"""Ctrl-C and SIGTERM while a command is being imported: one line.

The first import of each package. The same file stands in `derivations`, `impact` and `md`, of which
none imports another.
"""

import os
import signal
import sys
from collections.abc import Callable


def handle(handler: Callable[..., object] | signal.Handlers) -> None:
    """Handle both signals, unless they are ignored from the start, as under nohup."""
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, handler)


def _end(*_: object) -> None:
    """Say which command ends, and end at once: nothing was begun."""
    command = sys.orig_argv[-len(sys.argv)].removeprefix("-m")
    os.write(2, f"python -m {command}: interrupted: nothing was begun\n".encode())
    os._exit(130)


if sys.argv[:1] == ["-m"]:  # Python imports the package of a command; `Commands` takes over
    handle(_end)
