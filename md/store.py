"""Results of runs in one SQLite file: a row a run, found again by its scene and the sources.

The file is in WAL mode and every row is a transaction of its own: whatever kills the process, rows
that were written stay, and two sweeps may write to one file.
"""

import contextlib
import csv
import json
import sqlite3
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .units import cm_per_s, in_cm
from .writing import replacing

__all__ = ["Store", "StoreError", "table", "write_csv"]

_VERSION = 1
_APPLICATION = 0x726F6473  # "rods"
_WAIT = 60.0  # seconds for another writer

_TABLE = """
CREATE TABLE IF NOT EXISTS runs (
    key TEXT PRIMARY KEY,    -- digest of scene, periods and sources
    scene TEXT NOT NULL,     -- JSON
    periods INTEGER NOT NULL,
    seed INTEGER NOT NULL,
    code TEXT NOT NULL,      -- digest of the sources
    result TEXT,             -- JSON; NULL: the run failed
    error TEXT,              -- why it failed
    seconds REAL NOT NULL,   -- of the run
    written TEXT NOT NULL    -- UTC
)
"""


class StoreError(ValueError):
    """A file that cannot be used as a store; it is left as it is."""


class Store:
    """Open a store, made anew if there is no such file.

    Parameters
    ----------
    path : of the file
    write : False for reading alone; the file must exist

    Raises
    ------
    StoreError
        If the file is not a store, is one of another version, or cannot be written.
    """

    def __init__(self, path: str | Path, write: bool = True):
        self.path = Path(path)
        fresh = not self.path.exists() or self.path.stat().st_size == 0
        if fresh and not write:
            raise StoreError(f"store {path}: no such file")
        if fresh and not self.path.parent.is_dir():
            raise StoreError(f"store {path}: no such folder")
        if not fresh:
            self._check()
        with self._named("cannot be opened"):
            mode = "rwc" if write else "ro"
            self.database = sqlite3.connect(
                f"{self.path.absolute().as_uri()}?mode={mode}", uri=True, timeout=_WAIT
            )
        if write:
            with self._named("cannot be written"):
                self._begin()

    def _check(self) -> None:
        """Refuse what is not a store of this version, without a change to it."""
        with self._named("is not a store"):
            look = sqlite3.connect(f"{self.path.absolute().as_uri()}?mode=ro", uri=True)
            with contextlib.closing(look):
                (mark,) = look.execute("PRAGMA application_id").fetchone()
                (version,) = look.execute("PRAGMA user_version").fetchone()
        if mark != _APPLICATION:
            raise StoreError(f"store {self.path} is a database, but not one of runs")
        if version != _VERSION:
            raise StoreError(f"store {self.path} is of version {version}, this is {_VERSION}")

    def _begin(self) -> None:
        self.database.execute("PRAGMA journal_mode=WAL")
        self.database.execute("PRAGMA synchronous=FULL")
        with self.database:
            self.database.execute("BEGIN IMMEDIATE")
            self.database.execute(f"PRAGMA application_id={_APPLICATION}")
            self.database.execute(f"PRAGMA user_version={_VERSION}")
            self.database.execute(_TABLE)

    @contextlib.contextmanager
    def _named(self, what: str) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise StoreError(f"store {self.path} {what}: {error}") from None

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        self.database.close()

    def has(self, key: str, failed: bool = True) -> bool:
        """Whether the run is there.

        Parameters
        ----------
        key : of the run, as `md.sweep.Point.key`
        failed : whether a run that failed counts as well
        """
        query = "SELECT result IS NOT NULL FROM runs WHERE key = ?"
        with self._named("cannot be read"):
            found = self.database.execute(query, (key,)).fetchone()
        return found is not None and (failed or bool(found[0]))

    def put(self, key: str, about: dict[str, Any], result: dict | None, error: str | None) -> None:
        """Write a run, for good when this returns; a result is never replaced.

        Parameters
        ----------
        key : of the run
        about : scene (as dictionaries), periods, seed, code, seconds
        result : what was measured, or None
        error : why there is no result, or None
        """
        row = (
            *(key, json.dumps(about["scene"]), about["periods"], about["seed"], about["code"]),
            *(json.dumps(result) if result is not None else None, error, about["seconds"]),
            time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
        )
        with self._named("cannot be written"), self.database:
            self.database.execute("DELETE FROM runs WHERE key = ? AND result IS NULL", (key,))
            marks = ", ".join("?" * len(row))
            self.database.execute(f"INSERT OR IGNORE INTO runs VALUES ({marks})", row)

    def result(self, key: str) -> dict | None:
        """What a run measured; None if it is not there or failed.

        Parameters
        ----------
        key : of the run, as `md.sweep.Point.key`
        """
        with self._named("cannot be read"):
            found = self.database.execute(
                "SELECT result FROM runs WHERE key = ?", (key,)
            ).fetchone()
        return json.loads(found[0]) if found and found[0] else None

    def rows(self) -> Iterator[dict[str, Any]]:
        """All runs, in the order of their writing."""
        names = "scene", "periods", "seed", "code", "result", "error", "seconds", "written"
        with self._named("cannot be read"):
            for row in self.database.execute(f"SELECT {', '.join(names)} FROM runs ORDER BY rowid"):
                found = dict(zip(names, row, strict=True))
                found["scene"] = json.loads(found["scene"])
                found["result"] = json.loads(found["result"]) if found["result"] else None
                yield found


def _flat(tables: dict, prefix: str = "") -> dict[str, Any]:
    """Nested tables with dotted names."""
    found: dict[str, Any] = {}
    for key, value in tables.items():
        if isinstance(value, dict):
            found |= _flat(value, f"{prefix}{key}.")
        elif not isinstance(value, list):
            found[f"{prefix}{key}"] = value
    return found


def table(path: str | Path) -> tuple[list[str], list[dict[str, Any]]]:
    """All runs of a store, flat: names of columns, and a dictionary a run.

    Columns with a dot are keys of the scene, in its own units and in cm and cm/s, or parts of the
    results, such as `landings.`.

    Parameters
    ----------
    path : of the store

    Raises
    ------
    StoreError
        If the file is not a store.
    """
    with Store(path, write=False) as database:
        runs = list(database.rows())
    rows = []
    for found in runs:
        scene, result = found.pop("scene"), found.pop("result") or {}
        if result.get("c_x_stderr") is not None:
            unit = cm_per_s(scene["rods"]["diameter_cm"])
            result["c_x_stderr_cm_s"] = result["c_x_stderr"] * unit
        rows.append(_flat(scene) | in_cm(scene) | _flat(result) | found)
    return list(dict.fromkeys(name for row in rows for name in row)), rows


def write_csv(path: str | Path, columns: list[str], rows: list[dict[str, Any]]) -> None:
    """Write rows to a file, whole or not at all.

    Parameters
    ----------
    path : of the file; what is there is replaced
    columns, rows : as `table` gives them
    """
    with replacing(Path(path)) as part, part.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
