"""Output files: checked before the work begins, and replaced only when the new one is whole."""

import os
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

from .domains import InputError


def warn(message: str) -> None:
    """Warn in one line, without a place in the source code."""
    warnings.warn_explicit(message, RuntimeWarning, "md", 0)


def distinct(**paths: str | Path | None) -> None:
    """Refuse two options that name one file.

    Parameters
    ----------
    paths : two, by the names of their arguments; None: not given

    Raises
    ------
    ValueError
        If they name one file.
    """
    given = [os.path.realpath(str(path)) for path in paths.values() if path is not None]
    if len(given) > len({*given}):
        first, second = paths
        raise InputError(f"{second} must be another file than {first}, got {str(paths[second])!r}")


def empty(path: Path) -> bool:
    """Whether a file is missing or empty."""
    return not path.exists() or path.stat().st_size == 0


def plain(path: str | Path) -> Path:
    """The file that a path leads to, through links: a plain file, or none yet.

    The same stands in `derivations.files` and in `md.files`: neither package imports the other.

    Raises
    ------
    OSError
        If it is a folder, a device, a FIFO or a socket: none may be replaced, and reading may hang.
    """
    whole = Path(os.path.realpath(path))
    if whole.exists() and not whole.is_file():
        raise OSError(f"{path} is not a plain file")
    return whole


def text_of(path: str | Path) -> str:
    """Text of a plain UTF-8 file, with or without a byte order mark.

    Raises
    ------
    ValueError
        If it cannot be read.
    """
    try:
        return plain(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(f"{path}: cannot be read ({why})") from None


def tried(whole: Path) -> None:
    """Try whether a file, and its folder, can be written; neither is changed.

    Raises
    ------
    OSError
        If one cannot.
    """
    there = next(folder for folder in whole.parents if folder.exists())
    with tempfile.TemporaryFile(dir=there), whole.open("a") if whole.exists() else nullcontext():
        pass


def writable(
    name: str, path: str | Path, kind: Callable[[Path], bool] | None = None, what: str = ""
) -> Path:
    """The plain file that an output path leads to, which can be written.

    It is refused where it holds data of another kind. Missing folders are no reason to refuse it:
    they are made with the file.

    Parameters
    ----------
    name : of the argument
    path : of the file, which is not changed
    kind : says whether an existing file may be replaced; None: any file may
    what : kind of file that may be replaced, in words

    Raises
    ------
    ValueError
        If the path does not lead to a plain file, or the file is of another kind or cannot be
        written.
    """
    try:
        path, whole = Path(path), plain(path)
        tried(whole)
        fits = kind is None or empty(path) or kind(path)
    except (OSError, TypeError) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(
            f"{name} must be a file that can be written, got {str(path)!r}: {why}"
        ) from None
    if not fits:
        raise InputError(f"{name} must be a new file or {what}, got {str(path)!r}")
    return whole


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Name the file in an error that does not: a disk that is full tells no name."""
    try:
        yield
    except OSError as error:
        raise OSError(f"{path}: {error.strerror or error}") from None


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Temporary file beside `path`, which takes its place when it is whole; links are followed.

    Its name is always the same, so that the file of a killed process is replaced by the next one.
    Missing folders are made. The same stands in `derivations.files` and in `md.files`.

    Parameters
    ----------
    path : of the file to replace, a plain one; the temporary one has the same ending
    """
    whole = plain(path)
    part = whole.with_name(f".{whole.stem}.part{whole.suffix}")
    whole.parent.mkdir(parents=True, exist_ok=True)
    try:
        yield part
        part.replace(whole)
    finally:
        part.unlink(missing_ok=True)
