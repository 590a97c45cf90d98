"""Two programs, one row: this one, and a plain program in C that shares nothing with it.

Both integrate the paper's row of forty rods by leapfrog, with steps of 2e-5, a contact of constant
restitution and stiff tangential springs with hardly a dashpot. Each has its own spring, which goes
with the root of the overlap here and with the overlap there; two rods touch at two places here, at
their closest points there; neighbours, starts and order of sums are each program's own. A dashpot
would part them: while the contact slips, spring and dashpot relax behind a slider here, there the
spring is set so that both together carry the limit.

Means and standard errors over four starts of 600 periods, over the nominal tilt, from 18 degrees
on: more upright rows have several states, and which one a start finds differs from start to start
in either program. (a) Drift. (b) Velocity of the plate as a rod touches it, over its peak. (c)
Share of the touches during which another rod pushes the one that touches. (d) Touches of a rod in a
period. What the other program found stands in two_codes.toml, with its flags and the date.
"""

import tomllib
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from md.scene import put, read_tables

from ..lib.runs import SEEDS, Sweeps, both, boxes, means, planned, seed_means
from ..lib.style import ORANGE, Data, curve, legend_above, painted, style

MEASURED = {  # in the columns of the table, with the names that a run has for them
    "c_x": "c_x_cm_s",
    "V_z": "touches.plate_velocity.mean",
    "pushed": "touches.pushed_by_others.mean",
    "touches": "touches.per_rod_and_period.mean",
}
TITLES = {
    "c_x": "drift",
    "V_z": "plate at touches",
    "pushed": "pushed by others",
    "touches": "touches",
}
LABELS = {
    "c_x": r"$c_x$ (cm/s)",
    "V_z": r"$V_z/V_0$",
    "pushed": "share of the touches",
    "touches": "per rod and period",
}


def other() -> tuple[np.ndarray, np.ndarray]:
    """Nominal tilts [deg], and what the other program measured: (measured, tilts, starts)."""
    text = Path(__file__).with_name("two_codes.toml").read_text(encoding="utf-8")
    rows = np.loadtxt(tomllib.loads(text)["runs"].splitlines())
    tilts = np.unique(rows[:, 0])
    return tilts, rows[:, 2:].T.reshape(len(MEASURED), len(tilts), -1)


def sweeps(quick: bool = False) -> Sweeps:
    """Sweep of this program's row over the other program's tilts and over starts."""
    changes = {"rods.diameter_cm": 0.635, "start.speed": 0.3, **both(tangential_damping=0.04)}
    base = put(read_tables("quasi2d"), changes)
    axes = [{"box.length": boxes(other()[0])}, SEEDS]
    return {"row": planned(axes, 20 if quick else 600, base=base)}


def data(quick: bool = False) -> Data:
    """What both programs found, over the nominal tilt, with standard errors over starts."""
    tilts, found = other()
    others = {f"other_{name}": values for name, values in zip(MEASURED, found, strict=True)}
    return {"nominal_deg": tilts, **means(sweeps(quick)["row"], MEASURED), **seed_means(others)}


def _beside(ax, d, name: str):
    there = f"other_{name}"
    curve(ax, d, "nominal_deg", there, ORANGE, "program in C", form="s", ms=6, hollow=True)
    curve(ax, d, "nominal_deg", name, label="this program")
    ax.set(ylabel=LABELS[name], xlabel="nominal tilt (deg)", ylim=(0, 1.15 * np.max(d[there])))


@style
def draw(d: Data) -> Figure:
    panels = {title: partial(_beside, name=name) for name, title in TITLES.items()}
    figure = painted(d, panels, 3.8, 4.2, rows=2)
    for ax in figure.axes[:2]:
        ax.set(xlabel="")
    legend_above(figure, figure.axes[0], ncols=2)
    return figure
