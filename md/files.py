"""Files that a run or a command writes: refused before the work begins, replaced as a whole."""

import itertools
import os
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

from .errors import InputError

__all__ = ["NotWritten", "distinct", "empty", "replacing", "same", "warn", "writable"]


class NotWritten(RuntimeWarning):
    """A file that was asked for is not whole; what was computed stands."""


def warn(message: str) -> None:
    """Warn on one line of standard error, without a place in the sources."""
    warnings.warn_explicit(message, RuntimeWarning, "md", 0)


def same(one: str | Path, other: str | Path) -> bool:
    """Whether two paths lead to one file, through links as well."""
    one, other = (Path(os.path.realpath(path)) for path in (one, other))
    return one == other or (one.exists() and other.exists() and one.samefile(other))


def distinct(**paths: str | Path | None) -> None:
    """Refuse two names of one file.

    Parameters
    ----------
    paths : by the names of their arguments; None: not given

    Raises
    ------
    ValueError
        If two of the files are one.
    """
    given = ((name, path) for name, path in paths.items() if path is not None)
    for (first, one), (second, other) in itertools.combinations(given, 2):
        if same(one, other):
            raise InputError(f"{second} must be another file than {first}, got {str(other)!r}")


def empty(path: str | Path) -> bool:
    """Whether there is no such file yet, or nothing in it."""
    return not Path(path).exists() or Path(path).stat().st_size == 0


def writable(
    name: str, path: str | Path, kind: Callable[[Path], bool] | None = None, what: str = ""
) -> None:
    """Refuse a file that could not be written in the end, or holds something else.

    Parameters
    ----------
    name : of the argument
    path : of the file, which is not changed
    kind : says whether a file that is there may be replaced; None: any may
    what : in words, what it must be for that

    Raises
    ------
    ValueError
        If the path is none of a file, or the file is of another kind or cannot be written.
    """
    path = Path(path)
    try:
        if path.is_dir():
            raise InputError(f"{name} must be a file, got the folder {str(path)!r}")
        if path.exists() and not path.is_file():
            raise InputError(f"{name} must be a plain file, got {str(path)!r}")
        folder = Path(os.path.realpath(path)).parent
        if not folder.is_dir():
            raise InputError(f"{name} must be in a folder that exists, got {str(path)!r}")
        with tempfile.TemporaryFile(dir=folder), path.open("a") if path.exists() else nullcontext():
            pass
        fits = kind is None or empty(path) or kind(path)
    except OSError as error:
        raise InputError(
            f"{name} must be a file that can be written, got {str(path)!r}: {error.strerror}"
        ) from None
    if not fits:
        raise InputError(f"{name} must be a new file or {what}, got {str(path)!r}")


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A file to write beside `path`, which takes its place once it is whole; links are followed.

    Its name is always the same: what a killed process leaves, the next one replaces.

    Parameters
    ----------
    path : of the file in the end; its ending is that of the one beside it
    """
    whole = Path(os.path.realpath(path))
    part = whole.with_name(f".{whole.stem}.part{whole.suffix}")
    try:
        yield part
        part.replace(whole)
    finally:
        part.unlink(missing_ok=True)
