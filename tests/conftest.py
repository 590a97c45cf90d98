"""Files that share what they compute run in one process; rows of rods have a store of their own."""

import gc
import os
import re
import signal
import time
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest
from xdist.scheduler import LoadFileScheduling

from figures.lib import runs as rows
from impact._generated import DIGEST
from md.cache import digest

from .command_line import read_toml

TOGETHER = {  # files that one process works through, as they share what it has computed
    "derivations": "derivations generated kernel lookup mutants report wheel",  # long: not last
    "figures": "figures_checks figures_claims figures_paper figures_theory",
    "kernels": "annulus bouncing contacts documentation effects energy figures_cost figures_pages"
    " flight guards help md_command md_hard_cases md_impact md_reference neighbours own_rods resume"
    " runs tolerance touches trajectory",
}

LONGER = read_toml("tests/longer.toml")

gc.set_threshold(100_000, 20, 100)  # what is made here is large; Python's own costs 7 % of the time
os.environ.setdefault("SYMPY_CACHE_SIZE", "None")  # its own limit costs a fifth of SymPy's time
mpl.use("Agg")  # no windows

if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:  # in the background of a shell
    signal.signal(signal.SIGINT, signal.default_int_handler)  # for tests that press Ctrl-C


class Together(LoadFileScheduling):
    """A file to a process, and files that share something to the same one."""

    def _split_scope(self, nodeid):
        name = Path(super()._split_scope(nodeid)).stem.removeprefix("test_")
        return next((group for group, names in TOGETHER.items() if name in names.split()), name)


@pytest.hookimpl(optionalhook=True)  # pytest also runs without xdist
def pytest_xdist_make_scheduler(config, log):
    return Together(config, log)


@pytest.hookimpl(tryfirst=True)  # before pytest leaves out what is slow
def pytest_collection_modifyitems(items):
    for item in items:
        if any(re.match(name, item.name) for name in LONGER.get(item.path.stem, ())):
            item.add_marker(pytest.mark.slow)


def pytest_make_parametrize_id(val):
    """What has a tag or a name has it in the name of its test."""
    known = getattr(val, "tag", getattr(val, "name", None))
    return known if isinstance(known, str) else None


@pytest.fixture(scope="session", autouse=True)
def rows_store(tmp_path_factory):
    """Figures compute their rows themselves, and leave nothing behind."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rows, "STORE", tmp_path_factory.mktemp("rows") / "rows.db")
        yield


@pytest.fixture(autouse=True)
def no_figures():
    """A test leaves no figure of pyplot open."""
    yield
    plt.close("all")


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty folder, in which the test works."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def path(tmp_path):
    """File of a store that is not there yet."""
    return tmp_path / "a.db"


def pytest_addoption(parser):
    parser.addoption("--record", metavar="FILE", help="write date, sources, counts of a pass")


def pytest_terminal_summary(terminalreporter, exitstatus, config):
    """Record a run of which all tests have passed; one of several processes knows its own alone."""
    path = config.getoption("record")
    if path is None or exitstatus != 0 or hasattr(config, "workerinput"):
        return
    passed, skipped = (len(terminalreporter.stats.get(kind, ())) for kind in ("passed", "skipped"))
    Path(path).write_text(
        "# The longer studies\n\nWritten by `make slow` when all of them pass.\n\n"
        f"{time.strftime('%Y-%m-%d', time.gmtime())}: {passed} passed, {skipped} skipped;"
        f" sources md {digest()}, impact {DIGEST}.\n",
        "utf-8",
    )
