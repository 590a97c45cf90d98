"""Data of figures, kept: what NAME.npz in a folder holds is read if it is of the present sources.

Sources are the syntax trees (`md.cache.code_of`) of `md`, of `impact` and of what the figure's
module imports from here, of `derivations` where one of these imports it, and the tables (TOML,
JSON) of these packages and beside these modules: an edit of words keeps the data but for
words in a table, an edit of a number or a formula does not.
"""

import ast
import hashlib
import json
import platform
from collections.abc import Callable, Mapping
from functools import cache
from inspect import getfile
from pathlib import Path
from types import MappingProxyType
from typing import Any
from zipfile import BadZipFile

import numpy as np

from impact import InputError
from md.cache import code_of

from .. import FIGURES, load

BROKEN = (OSError, EOFError, SyntaxError, ValueError, LookupError, BadZipFile)  # of NumPy, Pillow
Own = Mapping[str, Any]  # values of one's own, in place of the paper's
NOTHING: Own = MappingProxyType({})
_HOUSE = Path(__file__).parents[2]


def _imports(path: Path, found: set[Path]) -> set[Path]:
    """Add a file of `figures`, the tables that it names, and all that it imports from there."""
    source = path.read_text(encoding="utf-8")
    found |= {path, *(table for table in path.parent.glob("*.toml") if table.name in source)}
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = path.parents[node.level - 1] / (node.module or "").replace(".", "/")
            for name in (base.with_suffix(".py"), *(base / f"{a.name}.py" for a in node.names)):
                if name.is_file() and name not in found:
                    _imports(name, found)
        elif isinstance(node, ast.ImportFrom) and str(node.module).startswith("derivations"):
            found.update(_files("derivations"))
    return found


@cache
def _digest(*paths: Path) -> str:
    """Digest of what of these files decides numbers."""
    content = hashlib.sha256()
    for path in paths:
        source = path.read_bytes()
        code = code_of(source).encode() if path.suffix == ".py" else source
        content.update(path.name.encode() + b"\0" + code)
    return content.hexdigest()[:12]


def _files(*packages: str) -> list[Path]:
    """Sources and tables of packages."""
    return sorted(
        path
        for package in packages
        for path in (_HOUSE / package).rglob("*")
        if path.suffix in (".py", ".toml", ".json")
    )


def sources_of(function: Callable) -> str:
    """Digest of the sources of a function of `figures`, those of `md` left out.

    Parameters
    ----------
    function : at the top of its module
    """
    return _digest(*_files("impact"), *sorted(_imports(Path(getfile(function)), set())))


def sources(name: str) -> str:
    """Digest of the sources of a figure's data.

    Parameters
    ----------
    name : one of `FIGURES`
    """
    module = _HOUSE / "figures" / FIGURES[name].room / f"{name}.py"
    return _digest(*_files("md", "impact"), *sorted(_imports(module, set())))


def keep(path: Path, name: str, quick: bool, data: Mapping[str, Any], own: Own = NOTHING) -> None:
    """Write the data of a figure for `stored_data`, and what made them: sources, versions, size.

    Parameters
    ----------
    path : of the file, NAME.npz
    name, quick : figure and size
    data : arrays by name, as the figure's `data` returns them
    own : values of one's own in place of the paper's
    """
    import matplotlib as mpl

    from impact._generated import DIGEST

    by = {
        "impact": DIGEST,  # of the generated closed forms
        "sources": sources(name),
        "numpy": np.__version__,
        "matplotlib": mpl.__version__,
        "python": platform.python_version(),
        "quick": quick,
        "own": dict(own),
    }
    np.savez_compressed(path, **data, provenance=json.dumps(by))


def made(npz: Path) -> dict[str, Any]:
    """What made a figure's numbers: `quick`, values of one's `own`; empty if it cannot be read."""
    try:
        with npz.open("rb") as file:  # np.load(npz) leaves one open that is no archive
            return dict(json.loads(str(np.load(file)["provenance"])))
    except BROKEN:
        return {}


def stored_data(name: str, quick: bool, out: Path) -> dict[str, np.ndarray] | None:
    """Read the data of a figure that `draw` left in a folder.

    Parameters
    ----------
    name : one of `FIGURES`
    quick : the size that the data must have
    out : folder of NAME.npz

    Returns
    -------
    Arrays by name; None if no such file can be read, or it is of another size, of other sources or
    of values that are not the paper's.
    """
    by = made(out / f"{name}.npz")
    if by.get("own") or (by.get("sources"), by.get("quick")) != (sources(name), quick):
        return None
    return kept_data(name, out)


def kept_data(name: str, folder: Path) -> dict[str, np.ndarray]:
    """Data of a figure that lie in a folder as NAME.npz, of whatever sources and size."""
    path = folder / f"{name}.npz"
    try:
        with path.open("rb") as file, np.load(file) as stored:
            return {key: stored[key] for key in stored if key != "provenance"}
    except (*BROKEN, TypeError) as error:  # TypeError: a single array
        raise InputError(f"{path} holds no data of {name}: {error}") from None


def figure_data(name: str, quick: bool = False, out: Path | None = None) -> dict[str, np.ndarray]:
    """Data of a figure: read from a folder if they are there and current, else computed.

    Parameters
    ----------
    name : one of `FIGURES`
    quick : the small size
    out : folder of NAME.npz; None: compute
    """
    stored = stored_data(name, quick, out) if out is not None else None
    return load(name).data(quick=quick) if stored is None else stored
