"""Pictures of theory and simulation: one module a figure, `data()` computes and `draw()` draws.

>>> import figures
>>> fig11 = figures.load("fig11")
>>> picture = fig11.draw(fig11.data(quick=True))

`FIGURES` holds an `Entry` for each name. From a shell: `python -m figures list`,
`python -m figures draw fig11 --out DIR`.

Files, as one reads them
------------------------
paper, theory, checks, cost         rooms: one module for each of `FIGURES`, and what they share
lib                                 style, runs of rows and annuli, soft impacts, timing, files
claims                              the paper's claims, the numbers behind them, the verdicts
pages                               one page of everything, README, animation, window of sliders
__main__                            the commands

A module of a figure has `data(quick)`, which computes arrays by name, and `draw(data)`; perhaps
`summary(data)` in words, and `sweeps(quick)`, the runs it needs. Only `__main__` writes files: what
`data` returns as .npz, what `draw` returns as .png and .pdf. Runs are kept in the store of
`lib.runs`; of a command that is `--store`, or rows.db in `--out`.

To add a figure: write its module in a room, and its line in `FIGURES`.
"""

from dataclasses import dataclass
from importlib import import_module
from types import ModuleType

__all__ = ["FIGURES", "Entry", "load"]


@dataclass(frozen=True, slots=True)
class Entry:
    """What is known of a figure before its module is imported."""

    room: str  # folder of its module
    title: str  # what it shows, with the paper's number
    quick: bool  # part of the set that is drawn, on coarse grids, when no name is given
    alone: bool  # takes all cores or measures times: nothing is drawn beside it


# Titles with the paper's numbers, by room and name.
_TITLES = {
    "paper": {
        "fig02": "Fig. 2: forward and reverse drift over acceleration and tilt",
        "fig04": "Fig. 4: drift in the annulus over tilt, acceleration and friction",
        "fig05": "Fig. 5: rods in the annulus from above; the zig-zag",
        "fig06": "Fig. 6: velocities of a simulated row before and after a landing, over tilt",
        "fig07": "Fig. 7: tips of rods over the plate; lengths of flights over tilt",
        "fig08": "Fig. 8: landing phases of a simulated row",
        "fig13": "Fig. 13: drift of a simulated row over tilt, acceleration and length",
        "fig10": "Fig. 10: regimes of an impact over tilt and friction",
        "fig11": "Fig. 11: stationary drift over tilt, with its unphysical branches",
        "fig12": "Fig. 12: one soft impact over tilt against the closed forms; its restitution",
    },
    "theory": {
        "alpha": "Mean plate velocity at landing, flights and drift, computed rod by rod",
        "fig08_theory": "Fig. 8: landing phases of bouncing rods, computed",
        "free_rod": "A rod that is let go: how soon it falls, and its drift until then",
        "pairs": "Two bodies that meet: rods of a row after a landing, a ball on a bat",
        "restitution_laws": "Where Newton's law creates energy; how far three laws differ",
        "tip_shape": "Drift of round and flat-ended rods over tilt and over length",
    },
    "checks": {
        "phase_friction": "Drift of a simulated row over friction and restitution",
        "contact_laws": "Which contact law obeys which of the paper's claims",
        "landing_census": "Landings in the row against the impact map, one by one",
        "appendix_a": "Readings of Appendix A against what the paper says of them",
        "rigid_limit": "How the soft impact comes to the rigid one, law by law",
    },
    "cost": {
        "accuracy_map": "Error of an impact in ulp: ours, and the paper's formulas literally",
        "accuracy_cost_theory": "Error of an impact against the time it takes, for nine ways",
        "accuracy_cost_impact": "Error of a soft impact against its price: integration, model",
        "accuracy_cost_drift": "Error of the row's drift against time; runs to a tolerance",
        "accuracy_cost_ladder": "One question, every way to answer it: deviation against time",
        "effect_prices": "Price of each effect of a scene, alone and in the full scene",
        "scaling": "Time over the number of rods, work over the number of cores",
    },
}
_RODS = {"fig02", "fig05", "fig06", "fig07", "fig08", "fig13"}  # many rods
_LONG = {"fig04", "phase_friction", "contact_laws", "landing_census"}  # many rods, for longer
_LONG |= {"accuracy_cost_drift", "accuracy_cost_ladder", "effect_prices", "scaling"}
_TIMED = {"accuracy_cost_theory", "accuracy_cost_impact"}
FIGURES = {
    name: Entry(room, title, name not in _LONG, name in _RODS | _LONG | _TIMED)
    for room, titles in _TITLES.items()
    for name, title in titles.items()
}


def load(name: str) -> ModuleType:
    """Module of a figure, with its `data(quick)` and `draw(data)`.

    Parameters
    ----------
    name : one of `FIGURES`
    """
    return import_module(f".{FIGURES[name].room}.{name}", __name__)
