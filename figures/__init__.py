"""Pictures of theory and simulation: one module a figure, `data()` computes and `draw()` draws.

>>> import figures
>>> fig11 = figures.load("fig11")
>>> picture = fig11.draw(fig11.data(quick=True, friction=0.2))  # as the paper's without friction

`FIGURES` holds an `Entry` for each name, from figures.toml. From a shell: `python -m figures list`,
`python -m figures draw fig11 --out DIR`.

Files, as one reads them
------------------------
paper, theory, checks, cost         rooms: one module for each of `FIGURES`, and what they share
lib                                 style, runs, bounces, soft and exact impacts, printing, files
claims                              the paper's claims, the numbers behind them, the verdicts
pages                               one page of everything, README, animation, page of sliders
__main__                            the commands, by `derivations.command_line`

A module of a figure has `data(quick)`, which computes arrays by name, and `draw(data)`; perhaps
`sweeps(quick)`, the runs it needs. It writes no files: `lib.drawing` keeps what `data` returns as
.npz, what `draw` returns as .png and .pdf. Runs are kept in the store of `lib.runs`; of a command
that is `--store`, or rows.db in `--out`.

To add a figure: write its module in a room, and its line in figures.toml.
"""

from derivations import command_line  # noqa: F401  (before slow imports)

# isort: split
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from types import ModuleType

from impact import InputError

__all__ = ["FIGURES", "Entry", "check", "load"]


@dataclass(frozen=True, slots=True)
class Entry:
    """What is known of a figure before its module is imported.

    room : folder of its module
    title : what it shows, with the paper's number
    quick : part of the set that is drawn, on coarse grids, when no name is given
    alone : takes all cores or measures times: nothing is drawn beside it
    panel : what its main panel is called on the page of prices, if it is there
    seconds : of the processor, in full, but for runs that the store holds
    own : what of one's own its `data` takes
    """

    room: str
    title: str
    quick: bool = True
    alone: bool = False
    panel: str = ""
    seconds: int = 5
    own: Sequence[str] = ()


_ROOMS = tomllib.loads(Path(__file__).with_name("figures.toml").read_text(encoding="utf-8"))
FIGURES = {
    name: Entry(room, **known) for room, names in _ROOMS.items() for name, known in names.items()
}


def check(names: Iterable[str]) -> None:
    """Raise an error if one of the names is not in `FIGURES`.

    Parameters
    ----------
    names : of figures

    Raises
    ------
    ValueError
        With the names that are like it.
    """
    for name in names:
        if name not in [*FIGURES]:
            near = ", ".join(get_close_matches(str(name), FIGURES, cutoff=0.4))
            raise InputError(
                f"there is no figure {name!r}{near and f'; near it: {near}'}; "
                "`python -m figures list` lists all"
            )


def load(name: str) -> ModuleType:
    """Module of a figure, with its `data(quick)` and `draw(data)`.

    Parameters
    ----------
    name : one of `FIGURES`

    Raises
    ------
    ValueError
        If there is no figure of that name.
    """
    check([name])
    return import_module(f".{FIGURES[name].room}.{name}", __name__)


def __getattr__(name: str) -> str:
    """Version, found only when asked for; a checkout that is not installed has none."""
    if name == "__version__":
        from importlib.metadata import version

        return version("rod-impact")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
