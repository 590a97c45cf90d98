"""What holds for any rods: drift and verdicts over what rods and plate are made of.

A symbol is a kind of rods on a kind of plate, a row at seven tilts; all properties vary at once,
those of plate and rods apart. Only kinds whose row keeps its tilt are shown. (a) Drift over that of
the theory of the same friction, restitution and plate's speed, mean over tilts. (b) How many of the
statements of (c) hold. (c) Share of the kinds for which a statement of the paper holds; beside it
the property that the number follows most, with its rank correlation, left out below a half.
"""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PathCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from ..claims.any_rods import JUDGED, data, judged, kept, sweeps, told
from ..lib.style import DRIFTS, SKY, Data, name_panels, style

__all__ = ["data", "draw", "sweeps"]
RATIO_TICKS = 0.25, 0.5, 1, 2, 4  # of drift over the theory's, in colour


def _over_restitution(ax, d, colour: np.ndarray, **look: Any) -> PathCollection:
    """Kinds of rods that keep their tilt, coloured, over restitution of plate and of rods."""
    some = kept(d)
    x, y = d["restitution, plate"][some], d["restitution, rods"][some]
    ax.set(xlabel="restitution of the plate", ylabel="restitution of the rods")
    return ax.scatter(x, y, 9, colour, linewidths=0.2, edgecolors="black", **look)


@style
def draw(d: Data) -> Figure:
    figure = plt.figure(figsize=(7.0, 7.6))
    top, bottom = figure.subfigures(2, 1, height_ratios=(1, 2))
    left, right = top.subplots(1, 2)
    ratio = (d["c_x"] / d["theory"])[kept(d)].mean(axis=1)
    low, *_, high = RATIO_TICKS
    shown = _over_restitution(
        left, d, np.clip(ratio, low, high), norm=LogNorm(low, high), cmap=DRIFTS
    )
    bar = top.colorbar(shown, ax=left, label="drift over the theory's")
    bar.set_ticks(RATIO_TICKS, labels=[f"{tick:g}" for tick in RATIO_TICKS])
    bar.minorticks_off()
    true = judged(d)
    hold = np.nansum([*true.values()], axis=0)
    shown = _over_restitution(right, d, hold, cmap="viridis")
    top.colorbar(shown, ax=right, label=f"statements that hold, of {len(true)}")
    ax = bottom.subplots()
    found = {n: of for n, of in told(d)["numbers"].items() if of["share"] is not None}
    names = sorted(found, key=lambda name: found[name]["share"])
    for i, name in enumerate(names):
        ax.barh(i, found[name]["share"], color=SKY, alpha=0.5)
        ax.text(0.005, i, f"{name.partition('.')[0]} {JUDGED[name]['name']}", va="center")
        if of := found[name]["follows"]:
            words = f"{of['property']} ({of['rank']:+.2f})".replace("-", "−")
            ax.text(1.34, i, words, va="center", ha="right")
    ax.set(
        xlabel="share of the kinds of rods for which it holds",
        xlim=(0, 1.35),
        xticks=np.linspace(0, 1, 6),
        ylim=(-0.8, len(names) - 0.2),
        yticks=[],
    )
    name_panels((left, right, ax), ("drift", "verdicts", "statements"))
    return figure
