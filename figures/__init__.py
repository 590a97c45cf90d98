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
    quick: bool = True  # part of the set that is drawn when no name is given


FIGURES = {
    "fig02": Entry(
        "paper", "Fig. 2: forward and reverse drift over acceleration and tilt", quick=False
    ),
    "fig04": Entry(
        "paper", "Fig. 4: drift in the annulus over tilt, acceleration and friction", quick=False
    ),
    "fig05": Entry("paper", "Fig. 5: rods in the annulus from above; the zig-zag", quick=False),
    "fig06": Entry(
        "paper",
        "Fig. 6: velocities of a simulated row before and after a landing, over tilt",
        quick=False,
    ),
    "fig07": Entry(
        "paper", "Fig. 7: tips of rods over the plate; lengths of flights over tilt", quick=False
    ),
    "fig08": Entry("paper", "Fig. 8: landing phases of a simulated row", quick=False),
    "fig13": Entry(
        "paper", "Fig. 13: drift of a simulated row over tilt, acceleration and length", quick=False
    ),
    "fig10": Entry("paper", "Fig. 10: regimes of an impact over tilt and friction"),
    "fig11": Entry("paper", "Fig. 11: stationary drift over tilt, with its unphysical branches"),
    "fig12": Entry(
        "paper", "Fig. 12: one soft impact over tilt against the closed forms; its restitution"
    ),
    "alpha": Entry(
        "theory", "Mean plate velocity at landing, flights and drift, computed rod by rod"
    ),
    "fig08_theory": Entry("theory", "Fig. 8: landing phases of bouncing rods, computed"),
    "free_rod": Entry(
        "theory", "A rod that is let go: how soon it falls, and its drift until then"
    ),
    "restitution_laws": Entry(
        "theory", "Where Newton's law creates energy; how far three laws differ"
    ),
    "tip_shape": Entry("theory", "Drift of round and flat-ended rods over tilt and over length"),
    "phase_friction": Entry(
        "checks", "Drift of a simulated row over friction and restitution", quick=False
    ),
    "contact_laws": Entry(
        "checks", "Which contact law obeys which of the paper's claims", quick=False
    ),
    "landing_census": Entry(
        "checks", "Landings in the row against the impact map, one by one", quick=False
    ),
    "appendix_a": Entry("checks", "Readings of Appendix A against what the paper says of them"),
    "rigid_limit": Entry("checks", "How the soft impact comes to the rigid one, law by law"),
    "accuracy_map": Entry(
        "cost", "Error of an impact in ulp: ours, and the paper's formulas literally"
    ),
    "accuracy_cost_theory": Entry(
        "cost", "Error of an impact against the time it takes, for nine ways"
    ),
    "accuracy_cost_impact": Entry(
        "cost", "Error of a soft impact against its price: integration, model"
    ),
    "accuracy_cost_drift": Entry(
        "cost", "Error of the row's drift against time; runs to a tolerance", quick=False
    ),
    "accuracy_cost_ladder": Entry(
        "cost", "One question, every way to answer it: deviation against time", quick=False
    ),
    "effect_prices": Entry(
        "cost", "Price of each effect of a scene, alone and in the full scene", quick=False
    ),
    "scaling": Entry(
        "cost", "Time over the number of rods, work over the number of cores", quick=False
    ),
}


def load(name: str) -> ModuleType:
    """Module of a figure, with its `data(quick)` and `draw(data)`.

    Parameters
    ----------
    name : one of `FIGURES`
    """
    return import_module(f".{FIGURES[name].room}.{name}", __name__)
