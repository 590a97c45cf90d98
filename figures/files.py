"""Files of the commands: what could not be written in the end is refused before the work."""

import tempfile
from pathlib import Path

from impact._command import CommandError

MARKS = {  # what a file of each kind has near its beginning
    ".npz": b"PK",
    ".png": b"\x89PNG",
    ".pdf": b"%PDF",
    ".gif": b"GIF8",
    ".mp4": b"ftyp",
    ".json": b"{",
    ".md": b"# The paper's claims",
    ".html": b"<title>Rods on a vibrated plate",
}
NEAR = 300  # bytes


def ready(out: Path, *names: str, store: Path | None = None) -> list[Path]:
    """Paths of the files `names` in the folder `out`, which is made.

    Parameters
    ----------
    out : folder
    names : of the files that a command is about to write there
    store : that the command uses; it must be none of them

    Raises
    ------
    CommandError
        If the folder takes no file, or something of another kind stands where a file would go.
    """
    from md.files import distinct, writable  # late: the list of figures needs no Numba

    paths = [out / name for name in names]
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
        for path in paths:
            distinct(out=path, store=store)
            if path.exists():
                writable("out", path, _replaceable, f"a {path.suffix} file made here")
    except OSError as error:
        raise CommandError(f"out must be a folder that takes files: {error}") from None
    except ValueError as error:
        raise CommandError(error) from None
    return paths


def _replaceable(path: Path) -> bool:
    """Whether what is there is of the kind that its name says."""
    with path.open("rb") as file:
        return MARKS.get(path.suffix, b"") in file.read(NEAR)
