"""Which contact law obeys which of the paper's claims about the row.

A row is a law, a column a number of a claim; the colour compares the measured number with the paper
by the limits of that claim (claims/claims.toml); those of S1, of single impacts, serve for touches.
Thin rods as in the paper, l = 9.5 d, Gamma = 3.3, mu = 0.3; tilts from 9 to 60 degrees. Flights,
shares of landings and c_z/c_z' are of landings, touches less than 0.2 periods apart taken as one;
all other means are over every touch.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap

from md.scene import both
from md.sweep import Sweep

from ..claims import over_tilt
from ..claims.limits import grade
from ..claims.over_laws import JUDGED, LAW_TILTS_DEG, NUMBERS, QUICK_DEG
from ..lib.runs import FRICTION, GAMMA, LAW, PRINTED, SIMPLE, SIMPLE_ROW, boxes, planned
from ..lib.style import Data, style
from ..lib.tables import columned, pairs, table, text_of

CONTACT_LAWS = {  # what a law changes in `rows.SIMPLE_ROW`
    "law of the figures": LAW,
    "App. A as printed": PRINTED,
    "A, no overlap factor": PRINTED | both(overlap_factor=False),
    "A, damping 1.9e5": PRINTED | both(damping=1.9e5),
    "0.65, ratio 3": SIMPLE,
    "0.65, ratio 3, undamped": both(tangential_damping=0),
    "0.65, ratio 30": both(tangential_ratio=30),
    "0.65, ratio 30, undamped": both(tangential_ratio=30, tangential_damping=0),
    "0.8, ratio 3": both(restitution=0.8),
    "0.9, ratio 3": both(restitution=0.9),
    "0.9, ratio 3, undamped": both(restitution=0.9, tangential_damping=0),
    "0.65, Coulomb on plate": {
        "contacts.plate.law": "coulomb",
        "contacts.plate.tangential_ratio": "none",
    },
}
QUICK_LAWS = ("App. A as printed", "0.65, ratio 3", "0.9, ratio 3")
COLUMNS = {name: row for name, row in JUDGED.items() if "head" in row}


def _shown(value: float) -> str:
    return "never" if np.isinf(value) else text_of(value, ".2g")


def _names(d: Data) -> list[str]:
    return [list(CONTACT_LAWS)[i] for i in d["law"]]


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Of each law: over tilt."""
    names, periods = QUICK_LAWS if quick else tuple(CONTACT_LAWS), 40 if quick else 150
    axes = [{"box.length": boxes(QUICK_DEG if quick else LAW_TILTS_DEG)}]
    axes.append({"start.seed": [1, 2]})
    return {name: planned(axes, periods, CONTACT_LAWS[name], SIMPLE_ROW) for name in names}


def data(quick: bool = False) -> Data:
    """Of each law: the tables over tilt, and a number for each claim."""
    nominal, runs = np.array(QUICK_DEG if quick else LAW_TILTS_DEG), sweeps(quick)
    tables = [over_tilt.table(sweep, nominal) for sweep in runs.values()]
    value = np.array([[NUMBERS[name](d) for name in COLUMNS] for d in tables])
    limits = COLUMNS.values()
    grades = [[grade(v, c) or 0 for v, c in zip(row, limits, strict=True)] for row in value]
    return {
        "law": np.array([list(CONTACT_LAWS).index(name) for name in runs]),
        "value": value,
        "verdict": np.array(grades),
        "theory": over_tilt.theory(nominal),
        **{key: np.array([found[key] for found in tables]) for key in tables[0]},
    }


@style
def draw(d: Data) -> plt.Figure:
    n, m = d["value"].shape
    figure, ax = plt.subplots(figsize=(7.4, 1.8 + 0.24 * n))
    colours = ListedColormap(["#EDA677", "#FBF5BE", "#A6DBA0"])
    look = {"cmap": colours, "vmin": -0.5, "vmax": 2.5, "edgecolors": "white", "linewidth": 1}
    ax.pcolormesh(np.arange(m), np.arange(n), d["verdict"], **look)
    for (i, j), value in np.ndenumerate(d["value"]):
        ax.text(j, i, _shown(value), ha="center", va="center", fontsize=5.5)
    ax.set_yticks(range(n), _names(d), fontsize=6.5)
    heads = [f"{n.partition('.')[0]} {c['head']} [{c['paper']}]" for n, c in COLUMNS.items()]
    ax.set_xticks(range(m), heads, fontsize=6, rotation=90, linespacing=1)
    ax.tick_params(length=0, labelbottom=False, labeltop=True)
    ax.invert_yaxis()
    ax.spines[:].set_visible(False)
    tilt = d["nominal"][0]
    words = "green: holds, yellow: in part, red: does not; in brackets the paper's statement."
    row = rf"Thin rods, $\Gamma={GAMMA}$, $\mu={FRICTION}$, tilts {tilt.min()}-{tilt.max()}°"
    ax.set_xlabel(f"{words} {row}", fontsize=6.5)
    return figure


def summary(d: Data) -> str:
    """Matrix, then what it is made of, law by law."""
    names = _names(d)
    rows = []
    for (key, column), *cells in zip(COLUMNS.items(), d["value"].T, d["verdict"].T, strict=True):
        head = f"{key.partition('.')[0]} {column['head']}".replace("\n", " ")
        shown = (f"{_shown(v)} {'-~+'[k]}" for v, k in zip(*cells, strict=True))
        rows.append([head, column["paper"], *shown])
    lines = ["Claims: + holds, ~ in part, - does not", table(("number", "paper", *names), rows)]
    ratio = -d["landing_c_z_before"] / d["landing_c_z_after"]
    for i, name in enumerate(names):
        good, fair, bad = ((d["verdict"][i] == k).sum() for k in (2, 1, 0))
        lines.append(f"{name}: holds {good}, in part {fair}, not {bad}")
        columns = {key: d[key][i] for key in ("nominal", "tilt", "restitution")}
        columns |= {"theory": d["theory"], "-c_z/c_z'": ratio[i]}
        columns |= {key: pairs(d, key, i) for key in ("c_x", "V_z", "flight", "falling")}
        lines.append(columned(columns))
    return "\n".join(lines)
