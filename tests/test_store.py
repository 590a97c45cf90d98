"""The store: what was written stays, what is not a store is left alone."""

import contextlib
import os
import shutil
import sqlite3
import tempfile
from pathlib import Path

import pytest

from md.store import Store, StoreError, table, write_csv

from .command_line import enter, names_in, refused

ABOUT = {"scene": {"rods": {"count": 2}}, "periods": 3, "seed": 1, "code": "abc", "seconds": 0.1}


def filled(path):
    """Make a store of one run."""
    with Store(path) as store:
        store.put("k", ABOUT, {"c_x": 0.5}, None)


def test_a_result_is_written_once_and_a_failure_gives_way(path):
    with Store(path) as store:
        store.put("k", ABOUT, None, "it broke")
        assert store.has("k")
        assert not store.has("k", failed=False)
        store.put("k", ABOUT, {"c_x": 0.1 + 2**-54}, None)
        store.put("k", ABOUT, {"c_x": 0.2}, None)
        store.put("k", ABOUT, None, "it broke again")
        assert store.result("k") == {"c_x": 0.1 + 2**-54}  # to the bit
        (row,) = store.rows()
        assert row["error"] is None


def test_two_writers_share_a_store(path):
    with Store(path) as one, Store(path) as other:
        for i in range(10):
            (one if i % 2 else other).put(f"k{i}", ABOUT, {"i": i}, None)
            (other if i % 2 else one).put(f"k{i}", ABOUT, {"i": -1}, None)
        assert [row["result"]["i"] for row in one.rows()] == list(range(10))


def test_a_store_opens_while_another_process_writes(path, monkeypatch):
    """Only what writes waits for it."""
    filled(path)
    monkeypatch.setattr("md.store._WAIT", 0.0)
    with contextlib.closing(sqlite3.connect(path)) as other:
        other.execute("BEGIN IMMEDIATE")
        with Store(path) as store:
            assert store.has("k")
            with pytest.raises(StoreError, match="cannot be written: database is locked"):
                store.put("l", ABOUT, {"c_x": 0.5}, None)


@contextlib.contextmanager
def read_only():
    """A folder with a store that nobody may write, not even who runs the tests."""
    user, folder = os.geteuid(), Path(tempfile.mkdtemp())
    try:
        filled(folder / "a.db")
        (folder / "a.db").chmod(0o444)
        folder.chmod(0o555)
        if user == 0:  # whom no permissions hold back
            os.seteuid(65534)
        yield folder
    finally:
        os.seteuid(user)
        folder.chmod(0o755)
        shutil.rmtree(folder)


def test_a_store_in_a_read_only_folder_is_read():
    """It is read and not written, which is said in one line."""
    with read_only() as folder:
        with pytest.raises(PermissionError):
            (folder / "new").touch()
        with Store(folder / "a.db", write=False) as store:
            assert store.result("k") == {"c_x": 0.5}
        assert "0.5" in enter("md results", folder / "a.db").out
        refused("a.db' cannot be used: [Errno 13] Perm", "md sweep drift --store", folder / "a.db")
        assert names_in(folder) == {"a.db"}


def test_a_full_disk_loses_nothing_that_was_written(path):
    """SQLite's own limit of pages stands in for the disk's end."""
    with Store(path) as store:
        store.put("first", ABOUT, {"c_x": 1.0}, None)
        (pages,) = store.database.execute("PRAGMA page_count").fetchone()
        store.database.execute(f"PRAGMA max_page_count={pages}")
        with pytest.raises(StoreError, match="full"):
            store.put("long", ABOUT, {"text": "x" * 500_000}, None)
        assert store.result("first") == {"c_x": 1.0}
    with Store(path) as store:  # there is room again
        store.put("last", ABOUT, {"c_x": 2.0}, None)
        assert [row["result"]["c_x"] for row in store.rows()] == [1.0, 2.0]
        assert store.database.execute("PRAGMA integrity_check").fetchone() == ("ok",)


def test_a_table_has_all_columns(tmp_path, path):
    with Store(path) as store:
        store.put("k", ABOUT, None, "it broke, badly")
        store.put("l", ABOUT, {"c_x": 0.5, "touches": {"slide": {"mean": 0.1}}}, None)
    write_csv(tmp_path / "a.csv", *table(path))
    lines = (tmp_path / "a.csv").read_text().splitlines()
    assert lines[0].split(",")[:3] == ["rods.count", "c_x", "touches.slide.mean"]
    assert '"it broke, badly"' in lines[1]
    assert lines[2].startswith("2,0.5,0.1,")


def test_a_store_without_runs_says_so(tmp_path):
    """It is there, in a folder that was made with it."""
    path = tmp_path / "new" / "a.db"
    Store(path).database.close()
    assert enter("md results", path).out == "no runs yet\n"
