"""What the command lines of `impact` and `figures` share: one-line errors and clean exits."""

import argparse
import os
import sys
from collections.abc import Callable
from typing import NoReturn


class Parser(argparse.ArgumentParser):
    """Bad arguments cost one line on stderr and exit code 2."""

    def error(self, message: str) -> NoReturn:
        """Print one line and leave."""
        self.exit(2, f"{self.prog}: {message}\n")


def guarded(program: str, command: Callable[[], int]) -> int:
    """Exit code of `command`; an interrupt or a full disk costs one line, a closed pipe none."""
    try:
        return command()
    except KeyboardInterrupt:
        print("interrupted; what was finished is kept", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader has seen enough
        return 0
    except MemoryError as error:
        print(f"{program}: not enough memory: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"{program}: cannot write: {error}", file=sys.stderr)
        return 2


def leave(code: int) -> None:
    """End the process; output that nobody takes any more is dropped without a traceback."""
    try:
        sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            print(f"cannot write: {error}", file=sys.stderr)
            code = code or 2
    sys.exit(code)
