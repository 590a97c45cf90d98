"""What commands and calls refuse, in one line and before any work: no file is changed."""

# ruff: noqa: F401 (calls of the table have these names)

import json
import os
import socket
import sqlite3
import sys
from contextlib import chdir, closing
from functools import partial
from math import inf, nan
from pathlib import Path

import numpy as np
import pytest

import derivations
import impact
import md
from derivations import languages
from impact import bouncing, compiled
from md.kernels.contact import Normal, Spring
from md.placement import largest_tilt, placed
from md.search import search
from md.store import Store, table, write_csv
from md.sweep import execute, expand

from .command_line import ROOT, called, enter, python, read_toml, refused
from .test_help import ALL
from .test_store import filled

TABLES = read_toml("tests/refusals.toml")
LINES = TABLES.pop("lines of a file that has none of its own")
ASKED = [(command, *row) for command in LINES for row in TABLES.pop(command).items()]
CALLS = TABLES.pop("in Python")
FILES = TABLES.pop("files")
REFUSALS = {
    f"{begin} {rest}".strip(): words
    for begin, rows in TABLES.items()
    for rest, words in rows.items()
}

ROD = impact.thin_rod(0.3)
bounce = partial(bouncing.bounce, friction=0.3, restitution=0.65, landings=5)


def database(path, statement):
    """A database that somebody else made or changed."""
    with closing(sqlite3.connect(path)) as other, other:
        other.execute(statement)


@pytest.fixture(scope="module", autouse=True)
def folder(tmp_path_factory):
    """A working directory with a store of a run, and files of other kinds."""
    folder = tmp_path_factory.mktemp("folder")
    with chdir(folder):
        filled("a.db")
        database("other.db", "CREATE TABLE mine (x)")
        for version in (1, 99):
            filled(f"v{version}.db")
            database(f"v{version}.db", f"PRAGMA user_version={version}")
        filled("edited.db")
        database("edited.db", "UPDATE runs SET result = 'oops'")
        Path("theirs").mkdir()
        for name, text in FILES.items():
            Path(name).write_text(text)
        write_csv("more.csv", *table("a.db"))  # and a column of one's own
        Path("more.csv").write_text(Path("more.csv").read_text().replace("\n", ",mine\n"))
        np.save("array.npy", np.zeros(3))
        np.savez("arrays.npz", about="{}")
        np.savez("old.npz", about=json.dumps({"code": "other", "scene": "other"}))
        Path("drift_long.csv").write_text("9" * 200_000)
        Path("deep.toml").write_text("rods = " + 3000 * "[")
        Path("link").symlink_to("a.db")
        Path("hard").hardlink_to("a.db")
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind("socket")
        Path("odd").mkdir()
        for pipe in ("pipe", "odd/report.html", "odd/fig10.pdf"):
            os.mkfifo(pipe)
        _, device = os.openpty()  # as /dev/null, without the harm
        for name in ("tty", "tty.html"):
            Path(name).symlink_to(os.ttyname(device))
        yield folder


def contents(folder):
    """Contents of all files but those that SQLite reads with."""
    mine = (path for path in folder.rglob("*") if "db-" not in path.name)
    return {path: path.read_bytes() if path.is_file() else None for path in mine}


@pytest.mark.parametrize(("command", "words"), REFUSALS.items(), ids=REFUSALS)
def test_nonsense_is_refused_in_one_line(folder, command, words):
    """The line names command, option or key, value, domain; exit code 2; no file is changed."""
    package, *inner = command.split()[:2]
    name = " ".join([package, *inner])
    before = contents(folder)
    err = refused(words, command)
    assert err.startswith(f"python -m {name if name in ALL else package}: ")
    assert contents(folder) == before


@pytest.mark.parametrize(("command", "text", "words"), ASKED)
def test_a_file_that_asks_for_nonsense_is_refused_in_one_line(command, text, words):
    lines = (line for key, line in LINES[command].items() if not text.startswith(key))
    Path("bad.toml").write_text("\n".join([*lines, text]))
    refused(words, command)
    assert not Path("b.db").exists()


@pytest.mark.parametrize(("call", "words"), CALLS.items(), ids=CALLS)
def test_nonsense_is_refused_in_python(folder, call, words):
    """Calls refuse as commands do, and no file is changed either."""
    before = contents(folder)
    with pytest.raises((AttributeError, TypeError, ValueError)) as caught:
        eval(call)
    assert words in f"{caught.typename}: {caught.value}\n"
    assert contents(folder) == before


def test_what_a_command_wrote_it_may_replace(folder):
    """It may replace a table, of no runs as well, and the file behind a link."""
    Store("none.db").database.close()
    Path("to").symlink_to("b.csv")
    for _ in range(2):
        enter("md results none.db --csv b.csv")
        enter("md results a.db --csv to")
    assert Path("to").is_symlink()
    assert len(Path("b.csv").read_text().splitlines()) == 2
    assert not list(folder.glob("*.part*"))


def test_errors_keep_off_standard_output_where_standard_error_is_closed():
    said = called("sh", "-c", f"{sys.executable} -m md run nowhere 2>&-", cwd=ROOT)
    assert (said.returncode, said.stdout) == (2, "")


def test_what_a_terminal_has_no_letter_for_is_spelled():
    said = python("-m figures list", PYTHONIOENCODING="ascii")
    assert said.returncode == 0
    assert r"Painlev\xe9" in said.stdout
