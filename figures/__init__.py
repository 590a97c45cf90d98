'''Pictures of theory and simulation: one module a figure, `data()` computes and `draw()` draws.

>>> import figures
>>> fig11 = figures.load("fig11")
>>> picture = fig11.draw(fig11.data(quick=True))

`FIGURES` holds an `Entry` for each name. From a shell: `python -m figures list`,
`python -m figures draw fig11 --out DIR`.

Files, as one reads them
------------------------
shared, style.mplstyle              colours, axes and style of all figures
one for each of `FIGURES`           `data`, `draw`; perhaps `summary` in words, `sweeps` of runs
rows, ring                          runs of rows and of the annulus, from one store
soft, landings, effects, in_space   soft impacts, landings, effects, motion in space: to compare
impact_errors, precise              what is off, and many digits to say by how much
price, timing, price_list           what it costs, on a machine that is not quiet
claims, claims.toml, law_claims     the paper's claims and their limits, judged
measured, measured_ring, measuring, number    the numbers behind them, with errors
movie, explore, setting             animation; one window of sliders
paper, index, readme                everything, and how long it takes; one page of it; the README
files, __main__                     what may be written where; the commands

Only `__main__` writes files: what `data` returns as .npz, what `draw` returns as .png and .pdf.
Runs are kept in the file `rows.STORE`; of a command that is `--store`, or rows.db in `--out`.

To add a figure: the critical tilts
-----------------------------------
1. figures/critical.py, a new file: its docstring goes with the picture on the page of `index`
    """Critical tilts of a thin rod over friction, both roots of Eq. (23).

    Between the lines a stopped contact slips back. Look whether they meet at 3/4 and arctan 2.
    """

    import matplotlib.pyplot as plt
    import numpy as np

    from impact import critical_tilts

    from .shared import style


    def data(quick: bool = False) -> dict[str, np.ndarray]:
        """Both tilts [rad] over friction."""
        friction = np.linspace(0, 0.75, 31 if quick else 301)
        lower, upper = critical_tilts(friction)
        return {"friction": friction, "lower": lower, "upper": upper}


    @style
    def draw(d: dict[str, np.ndarray]) -> plt.Figure:
        figure, ax = plt.subplots(figsize=(3.4, 2.6))
        for name, line in (("lower", "k-"), ("upper", "k--")):
            ax.plot(d["friction"], np.degrees(d[name]), line, label=name)
        ax.set(xlabel="friction", ylabel="critical tilt [deg]")
        ax.legend()
        return figure

2. figures/__init__.py, last in `FIGURES`
    "critical": Entry("Critical tilts of a thin rod over friction"),

Try it:

    python -m figures draw critical --quick

The suite draws all of the quick set; a figure with `quick=False` needs a test of its own. One that
takes more than 5 s in full says so in `paper.SECONDS`.
'''

from dataclasses import dataclass
from importlib import import_module
from types import ModuleType

__all__ = ["FIGURES", "Entry", "load"]


@dataclass(frozen=True, slots=True)
class Entry:
    """What is known of a figure before its module is imported."""

    title: str  # what it shows, with the paper's number
    quick: bool = True  # part of the set that is drawn when no name is given


FIGURES = {
    "fig02": Entry("Fig. 2: forward and reverse drift over acceleration and tilt", quick=False),
    "fig04": Entry(
        "Fig. 4: drift in the annulus over tilt, acceleration and friction", quick=False
    ),
    "fig05": Entry("Fig. 5: rods in the annulus from above; the zig-zag", quick=False),
    "fig06": Entry(
        "Fig. 6: velocities of a simulated row before and after a landing, over tilt", quick=False
    ),
    "fig07": Entry(
        "Fig. 7: tips of rods over the plate; lengths of flights over tilt", quick=False
    ),
    "fig08": Entry("Fig. 8: landing phases of a simulated row", quick=False),
    "phase_friction": Entry("Drift of a simulated row over friction and restitution", quick=False),
    "contact_laws": Entry("Which contact law obeys which of the paper's claims", quick=False),
    "fig13": Entry(
        "Fig. 13: drift of a simulated row over tilt, acceleration and length", quick=False
    ),
    "alpha": Entry("Mean plate velocity at landing, flights and drift, computed rod by rod"),
    "fig08_theory": Entry("Fig. 8: landing phases of bouncing rods, computed"),
    "fig10": Entry("Fig. 10: regimes of an impact over tilt and friction"),
    "fig11": Entry("Fig. 11: stationary drift over tilt, with its unphysical branches"),
    "free_rod": Entry("A rod that is let go: how soon it falls, and its drift until then"),
    "restitution_laws": Entry("Where Newton's law creates energy; how far three laws differ"),
    "landing_census": Entry("Landings in the row against the impact map, one by one", quick=False),
    "tip_shape": Entry("Drift of round and flat-ended rods over tilt and over length"),
    "accuracy_map": Entry("Error of an impact in ulp: ours, and the paper's formulas literally"),
    "accuracy_cost_theory": Entry("Error of an impact against the time it takes, for nine ways"),
    "fig12": Entry("Fig. 12: one soft impact over tilt against the closed forms; its restitution"),
    "appendix_a": Entry("Readings of Appendix A against what the paper says of them"),
    "rigid_limit": Entry("How the soft impact comes to the rigid one, law by law"),
    "accuracy_cost_impact": Entry("Error of a soft impact against its price: integration, model"),
    "accuracy_cost_drift": Entry("Error of the row's drift against time; the dial", quick=False),
    "accuracy_cost_ladder": Entry(
        "One question, every way to answer it: deviation against time", quick=False
    ),
    "effect_prices": Entry(
        "Price of each effect of a scene, alone and in the full scene", quick=False
    ),
    "scaling": Entry("Time over the number of rods, work over the number of cores", quick=False),
}


def load(name: str) -> ModuleType:
    """Module of a figure, with its `data(quick)` and `draw(data)`.

    Parameters
    ----------
    name : one of `FIGURES`
    """
    return import_module(f".{name}", __name__)
