"""Store of results of runs in one SQLite file: one row per run, by its key (`md.cache.key`).

Every row is a transaction of its own: rows that were written stay when the process is killed, and
two sweeps may write to one file.

The columns of a result are those of `result.Result`: "c_x" is its `c_x`, the mean over the
periods behind the transient of `measures.Tables.by_period`.
"""

import contextlib
import csv
import json
import sqlite3
import time
from collections.abc import Iterator
from operator import methodcaller
from pathlib import Path
from typing import Any

from .domains import InputError, flat, held
from .files import empty, plain, replacing, tried, writable
from .units import in_cm

_VERSION = 2  # 1: other names of keys and columns
_APPLICATION = 0x726F6473  # "rods"
_WAIT = 60.0  # seconds for another writer
_LAST = "code", "error", "seconds", "written"  # columns at the end of all tables
_OF_RUN = "periods", "seed", *_LAST

_BEGIN = f"""
BEGIN IMMEDIATE;
PRAGMA application_id={_APPLICATION};
PRAGMA user_version={_VERSION};
CREATE TABLE IF NOT EXISTS runs (
    key TEXT PRIMARY KEY,    -- as md.cache.key
    scene TEXT NOT NULL,     -- JSON
    periods INTEGER NOT NULL,
    seed INTEGER NOT NULL,
    code TEXT NOT NULL,      -- digest of the sources
    result TEXT,             -- JSON; NULL: the run failed
    error TEXT,              -- why it failed
    seconds REAL NOT NULL,   -- of the run
    written TEXT NOT NULL    -- UTC
);
COMMIT;
"""


class StoreError(InputError):
    """Error for a file that cannot be used as a store; the file is left as it is."""


class Store:
    """Open store of runs; without such a file a new one, in folders that are made with it.

    Parameters
    ----------
    path : of the file
    write : False to read only; the file must exist

    Raises
    ------
    StoreError
        If the file is not a store, is one of another version, or cannot be written.
    """

    def __init__(self, path: str | Path, write: bool = True):
        try:
            self.path, whole = Path(path), plain(path)
            fresh = empty(whole)
            if write:
                tried(whole)  # now, not when the first run is lost
                whole.parent.mkdir(parents=True, exist_ok=True)
        except (OSError, TypeError) as error:
            raise StoreError(f"store {str(path)!r} cannot be used: {error}") from None
        if fresh and not write:
            raise StoreError(f"store {path}: no such file, or an empty one")
        uri = f"{self.path.absolute().as_uri()}?mode={'rwc' if write else 'ro'}"
        with self._failing("cannot be opened"):
            self.database = sqlite3.connect(uri, uri=True, timeout=_WAIT)
        try:
            if fresh:
                with self._failing("cannot be written"):
                    self.database.executescript(_BEGIN)
            self._recognise()
            self.database.execute("PRAGMA synchronous=FULL")
        except StoreError:
            self.database.close()
            raise

    def _recognise(self) -> None:
        """Refuse a file that is not a store of this version."""
        with self._failing("is not a store"):
            query = "SELECT * FROM pragma_application_id, pragma_user_version"
            mark, version = self.database.execute(query).fetchone()
        if mark != _APPLICATION:
            raise StoreError(f"store {self.path} is a database, but not one of runs")
        if version != _VERSION:
            raise StoreError(
                f"store {self.path} is of another version of md ({version}, not {_VERSION}), which "
                "named keys and columns differently: name a new file"
            )

    @contextlib.contextmanager
    def _failing(self, what: str) -> Iterator[None]:
        """Turn errors of SQLite and JSON into a `StoreError` that says what could not be done."""
        try:
            yield
        except (sqlite3.Error, json.JSONDecodeError, AttributeError, TypeError) as error:
            raise StoreError(f"store {self.path} {what}: {error}") from None

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        self.database.close()

    def has(self, key: str, failed: bool = True) -> bool:
        """Whether the store holds a run.

        Parameters
        ----------
        key : of the run, as `md.sweep.Point.key`
        failed : whether a run that failed counts as well
        """
        query = "SELECT 1 FROM runs WHERE key = ? AND (? OR result IS NOT NULL)"
        with self._failing("cannot be read"):
            return self.database.execute(query, (key, failed)).fetchone() is not None

    def put(self, key: str, about: dict[str, Any], result: dict | None, error: str | None) -> None:
        """Write a run; it is on the disk when this returns, and no result is replaced.

        A row of a run that failed gives way.

        Parameters
        ----------
        key : of the run
        about : scene (as dictionaries), periods, seed, code, seconds
        result : of the run; None if it failed
        error : why it failed; None if it did not
        """
        with self._failing("cannot be written"), self.database:
            tolist = methodcaller("tolist")  # of numbers and arrays of NumPy
            row = about | {
                "key": key,
                "scene": json.dumps(about["scene"]),
                "result": None if result is None else json.dumps(result, default=tolist),
                "error": error,
                "written": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
            }
            names, places = ", ".join(row), ", :".join(row)
            self.database.execute(
                f"INSERT OR REPLACE INTO runs ({names}) SELECT :{places} WHERE NOT EXISTS "
                "(SELECT 1 FROM runs WHERE key = :key AND result IS NOT NULL)",
                row,
            )

    def result(self, key: str) -> dict | None:
        """Result of a run; None if the store does not hold it, or it failed.

        Parameters
        ----------
        key : of the run, as `md.sweep.Point.key`
        """
        with self._failing("cannot be read"):
            query = "SELECT result FROM runs WHERE key = ? AND result IS NOT NULL"
            row = self.database.execute(query, (key,)).fetchone()
            return json.loads(row[0]) if row else None

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield all runs, in the order in which they were written."""
        with self._failing("cannot be read"):
            query = f"SELECT scene, result, {', '.join(_OF_RUN)} FROM runs ORDER BY rowid"
            for scene, result, *about in self.database.execute(query):
                tables = {"scene": json.loads(scene), "result": json.loads(result or "null")}
                yield tables | dict(zip(_OF_RUN, about, strict=True))


def named(result: dict | None, name: str) -> Any:
    """Value of a result by its dotted name; None if the run failed or measured none.

    Parameters
    ----------
    result : results of a run, or None
    name : such as "landings.plate_velocity.mean"

    Raises
    ------
    ValueError
        If the results have no such name; the message names what there is.
    """
    held("names", name, str)
    values = flat(result or {})
    absent = (f"{key}." for key, value in values.items() if value is None)
    if result is None or name.startswith(tuple(absent)):
        return None
    if name not in values:
        raise InputError(f"{name} is not in the results: {', '.join(values)}")
    return values[name]


def table(path: str | Path) -> tuple[list[str], list[dict[str, Any]]]:
    """All runs of a store as a flat table: names of columns, and a dictionary for each run.

    Columns with a dot are keys of the scene, in its own units and in cm and cm/s, or parts of the
    results, such as `touches.`.

    Parameters
    ----------
    path : of the store

    Raises
    ------
    StoreError
        If the file is not a store.
    """
    rows = []
    with Store(path, write=False) as database:
        for found in database.rows():
            scene, result = found.pop("scene"), found.pop("result") or {}
            row = flat(scene) | in_cm(scene) | flat(result) | found
            rows.append({name: x for name, x in row.items() if not isinstance(x, list)})
    names = dict.fromkeys(name for row in rows for name in row if name not in _OF_RUN)
    return [*names, *_OF_RUN], rows


def write_csv(path: str | Path, columns: list[str], rows: list[dict[str, Any]]) -> None:
    """Write rows to a CSV file, whole or not at all.

    Parameters
    ----------
    path : of a new file, or of a table of runs to replace
    columns, rows : as `table` gives them

    Raises
    ------
    ValueError
        If the file holds something else, or cannot be written.
    """

    def is_table(there: Path) -> bool:
        with there.open(encoding="utf-8", errors="replace", newline="") as file:
            return file.readline(2**20).rstrip().endswith(",".join(_LAST))

    writable("csv", path, is_table, "one of runs")
    with replacing(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)
