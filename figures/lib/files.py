"""Files of the commands: what could not be written in the end is refused before the work."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from impact import InputError

SIGNATURES = {  # what a file of each kind has near its beginning
    ".npz": [b"PK"],
    ".png": [b"\x89PNG"],
    ".pdf": [b"%PDF"],
    ".gif": [b"GIF8"],
    ".json": [b'"provenance"', b'"machine"'],
    ".md": [b"# The paper's claims"],
    ".html": [b"<title>Rods on a vibrated plate"],
}
HEAD_BYTES = 300  # bytes


def ready(out: Path, *names: str, store: Path | None = None, option: str = "out") -> list[Path]:
    """Paths of the files `names` in the folder `out`, which need not be there yet.

    Parameters
    ----------
    out : folder
    names : of the files that a command is about to write there
    store : that the command uses; it must be none of them
    option : that names the folder or the file

    Raises
    ------
    InputError
        If the folder takes no file, or something of another kind stands where a file would go.
    """
    from md.files import distinct, writable  # late: the list of figures needs no Numba

    paths = [out / name for name in names]
    try:
        there = next(folder for folder in (out, *out.absolute().parents) if folder.exists())
        with tempfile.TemporaryFile(dir=there):
            pass
        for path in (out, *paths):
            distinct(out=path, store=store)
        for path in paths:
            if path.exists():
                writable(option, path, _replaceable, f"a {path.suffix} file made here")
    except OSError as error:
        raise InputError(f"{option} must lead to a folder that takes files: {error}") from None
    return paths


def _replaceable(path: Path) -> bool:
    """Whether what is there is of the kind that its name says."""
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    return any(mark in head for mark in SIGNATURES.get(path.suffix, [b""]))


@contextmanager
def storing(out: Path, store: Path | None, *names: str) -> Iterator[Path]:
    """The folder `out`, ready for the files `names`; runs go to `store`, by default rows.db there.

    Raises
    ------
    InputError
        As `ready`, and if the store cannot be used.
    """
    from md.store import Store

    from . import runs

    usual, runs.STORE = runs.STORE, store or out / "rows.db"
    try:
        ready(out, *names, store=runs.STORE)
        if runs.STORE.exists() or runs.STORE.parent != out:
            Store(runs.STORE).database.close()
        yield out
    finally:
        runs.STORE = usual
