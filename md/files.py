"""Output files: checked before the work begins, and replaced only when the new one is whole."""

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
    """Warning that an output file is not whole; the result is."""


def warn(message: str) -> None:
    """Warn in one line, without a place in the sources."""
    warnings.warn_explicit(message, RuntimeWarning, "md", 0)


def same(one: str | Path, other: str | Path) -> bool:
    """Whether two paths lead to one file, through links as well."""
    one, other = (Path(os.path.realpath(path)) for path in (one, other))
    return one == other or (one.exists() and other.exists() and one.samefile(other))


def distinct(**paths: str | Path | None) -> None:
    """Refuse two options that name one file.

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
    """Whether a file is missing or empty."""
    return not Path(path).exists() or Path(path).stat().st_size == 0


def writable(
    name: str, path: str | Path, kind: Callable[[Path], bool] | None = None, what: str = ""
) -> None:
    """Refuse an output file that cannot be written, or that holds data of another kind.

    Parameters
    ----------
    name : of the argument
    path : of the file, which is not changed
    kind : says whether an existing file may be replaced; None: any file may
    what : kind of file that may be replaced, in words

    Raises
    ------
    ValueError
        If the path does not name a file, or the file is of another kind or cannot be written.
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
    """Temporary file beside `path`, which takes its place when it is whole; links are followed.

    Its name is always the same, so that the file of a killed process is replaced by the next one.

    Parameters
    ----------
    path : of the file to replace; the temporary one has the same ending
    """
    whole = Path(os.path.realpath(path))
    part = whole.with_name(f".{whole.stem}.part{whole.suffix}")
    try:
        yield part
        part.replace(whole)
    finally:
        part.unlink(missing_ok=True)
