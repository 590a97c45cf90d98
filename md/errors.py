"""The two errors that a command foresees; any other is a mistake of this package."""

from typing import Any


class InputError(ValueError, TypeError):
    """An argument, a key or a file that is refused; the message names it, its value and its domain.

    Both a `ValueError` and a `TypeError`, so that either catches it.
    """

    exit_code = 2  # of the command that it ends


class RunError(RuntimeError):
    """A run that cannot go on; `state` is the last good one.

    Of one impact it is (x, z, tilt, c_x, c_z, omega), of many rods the array of `Result.rods`.
    """

    exit_code = 1  # of the command that it ends

    def __init__(self, message: str, state: Any = ()):
        super().__init__(message)
        self.state = state
