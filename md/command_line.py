"""A group of commands that end with an exit code and, where they fail, one line of standard error.

The first import of each package with commands: Ctrl-C while the others go on ends a command at
once, as nothing was begun; SIGTERM does so by itself. What it defines stands in
`derivations` as well: neither package imports the other.
"""

import io
import os
import signal
import sys
from collections.abc import Callable, Sequence
from types import FrameType
from typing import Any, NoReturn

# ["-m"]: Python imports the package of a command, this one or another that imports this one.
if (
    sys.argv[:1] == ["-m"]
    and f" -m {__package__} " in " ".join([*sys.orig_argv, ""])
    and signal.getsignal(signal.SIGINT) is signal.default_int_handler
):
    signal.signal(signal.SIGINT, signal.SIG_DFL)

import click


def handle(handler: Callable[..., Any] | signal.Handlers) -> None:
    """Handle Ctrl-C and SIGTERM, unless they are ignored from the start, as under nohup."""
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, handler)


def stop(number: int, frame: FrameType | None) -> NoReturn:
    """Handle a signal by KeyboardInterrupt; `md.run` does not take this handler over.

    While a module is being imported the signal ends the process at once: modules of others lose an
    exception then, or abort.
    """
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            signal.signal(number, signal.SIG_DFL)
            signal.raise_signal(number)
        frame = frame.f_back
    raise KeyboardInterrupt


class Commands(click.Group):
    """Commands of a package; as a function it takes arguments and returns the exit code.

    An error with an `exit_code` is foreseen and costs one line, as click's own errors do. Any other
    one is a mistake of ours: its traceback is shown.
    """

    def main(self, args: Sequence[str] | None = None, **_: Any) -> int:  # type: ignore[override]
        """Run one command; returns the exit code."""
        context = None
        try:
            if sys.stdout is None:
                raise OSError("standard output is closed")
            words = sys.argv[1:] if args is None else args
            with self.make_context(  # settings that its commands inherit
                self.name, list(words), max_content_width=100, show_default=True
            ) as context:
                context.call_on_close(sys.stdout.flush)
                return self.invoke(context) or 0
        except click.exceptions.Exit as end:  # help was asked for
            return end.exit_code
        except BrokenPipeError:  # the reader has seen enough
            return 0
        except KeyboardInterrupt as error:
            said, code = f"interrupted: {str(error) or 'what was finished is kept'}", 130
        except MemoryError as error:
            said, code = f"not enough memory: {error}", 1
        except OSError as error:
            said, code = f"cannot write: {error}", 2
        except Exception as error:
            if not hasattr(error, "exit_code"):
                raise
            said, code = getattr(error, "format_message", error.__str__)(), error.exit_code
        command = context and context.invoked_subcommand
        print(f"{self.name}{f' {command}' if command else ''}: {said}", file=sys.stderr)
        return code

    def program(self, interrupt: Callable[..., Any] = stop) -> NoReturn:
        """Run the command of this process and end with its exit code; SIGTERM is Ctrl-C."""
        os.environ["MPLBACKEND"] = "agg"  # pictures go to files, whatever a notebook has set
        try:
            handle(interrupt)
            sys.stderr = sys.stderr or io.StringIO()  # closed: not to standard output
            if isinstance(sys.stdout, io.TextIOWrapper):
                sys.stdout.reconfigure(errors="backslashreplace")
            code = self.main()
            handle(signal.SIG_IGN)  # what is left takes a moment
        except KeyboardInterrupt:  # at the first or the last moment
            code = 130
            print(f"{self.name}: interrupted", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # unread output is dropped without a traceback
        # Python that was stopped in code of a string, as of a dataclass, ends by the signal itself
        # unless other such code has run since.
        exec("")
        sys.exit(code)
