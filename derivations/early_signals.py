"""Ctrl-C, SIGTERM and what is not installed, while a command is being imported: one line each.

The first import of each package. The same file stands in `derivations`, `impact` and `md`, of which
none imports another.
"""

import os
import signal
import sys
from collections.abc import Callable
from typing import Any


def handle(handler: Callable[..., object] | signal.Handlers) -> None:
    """Handle both signals, unless they are ignored from the start, as under nohup."""
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, handler)


def _end(why: str, code: int) -> None:
    """Say why and end at once: nothing was begun."""
    os.write(2, f"python -m {_command()}: {why}\n".encode())
    os._exit(code)


def _command() -> str:
    """Package of the command."""
    return sys.orig_argv[-len(sys.argv)].removeprefix("-m")


def _failed(kind: type[BaseException], error: BaseException, trace: Any) -> None:
    """Say which extra of the package holds a module that is not installed."""
    if isinstance(error, ModuleNotFoundError):
        _end(f"{error.name} is missing: pip install 'rod-impact[{_command()}]'", 2)
    sys.__excepthook__(kind, error, trace)


if sys.argv[:1] == ["-m"]:  # Python imports the package of a command; `Commands` takes over
    handle(lambda *_: _end("interrupted: nothing was begun", 130))
    sys.excepthook = _failed
