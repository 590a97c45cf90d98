"""What the command lines of `impact` and `figures` share: help, one-line errors, clean exits."""

import argparse
import os
import signal
import sys
from collections.abc import Callable
from typing import Any, NoReturn


class Parser(argparse.ArgumentParser):
    """Help as it is written, never in colours; bad arguments cost one line and exit code 2."""

    def __init__(self, **options: Any):
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, **options)
        self.color = False  # Python 3.14 would colour a pipe where FORCE_COLOR is set

    def error(self, message: str) -> NoReturn:
        """Print one line and leave."""
        self.exit(2, f"{self.prog}: {message}\n")


def told(text: str) -> dict[str, Any]:
    """What a command says of itself: one line in the list of commands, all of it in its help."""
    line = text.partition("\n")[0].rstrip(".")
    return {"help": line[0].lower() + line[1:], "description": text}


class CommandError(Exception):
    """Why a command does not go on, in one line; with its exit code."""

    def __init__(self, why: object, code: int = 2):
        super().__init__(why)
        self.code = code


def guarded(program: str, command: Callable[[], int]) -> int:
    """Exit code of `command`; what ends it before its time costs one line, a closed pipe none."""
    try:
        return command()
    except CommandError as error:
        said, code = str(error), error.code
    except KeyboardInterrupt:
        said, code = "interrupted; what was finished is kept", 130
    except BrokenPipeError:  # the reader has seen enough
        return 0
    except MemoryError as error:
        said, code = f"not enough memory: {error}", 1
    except ModuleNotFoundError as missing:
        said, code = f"it needs {missing.name}, which is not here", 2
    except ImportError as error:
        said, code = str(error), 2
    except OSError as error:
        said, code = f"cannot write: {error}", 2
    print(f"{program}: {said}", file=sys.stderr)
    return code


def _stop(*_: object) -> NoReturn:
    """Handle SIGINT and SIGTERM as Python handles SIGINT.

    But `md.run` takes over Python's own handler, and would return to a figure what it has.
    """
    raise KeyboardInterrupt


def leave(program: str, main: Callable[[], int]) -> NoReturn:
    """End the process; output that nobody takes any more is dropped without a traceback."""
    if sys.stdout is None:
        print(f"{program}: cannot write: standard output is closed", file=sys.stderr)
        sys.exit(2)
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _stop)
    try:
        code = main()
    except SystemExit as end:  # after help, or bad arguments
        code = int(end.code or 0)
    try:
        sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            print(f"{program}: cannot write: {error}", file=sys.stderr)
            code = code or 2
    sys.exit(code)
