"""The numbers of the claims under every contact law that was searched.

A strip is a number with limits, a dot a law of the search (figure `which_law`): blue where the tilt
of the row stays within two degrees of acos(dN/L), grey elsewhere. The diamond is the law that was
singled out, in the search as all dots; the open one is the same law as it was confirmed, at more
tilts. In the dark band the claim holds, in the light one in part. An asterisk: the number had a
part in the choice of that law; all others the law predicts. Dots beyond the ends of a strip stand
there.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from ..claims.over_laws import FITTED, HEADED, JUDGED, KEPT_DEG, data, singled_out, sweeps
from ..lib.style import BLUE, ORANGE, Data, style

__all__ = ["data", "draw", "sweeps"]
HOLDS, PARTLY, OTHER = "#9CD3A0", "#E4F3DF", "0.72"


def _ends(values: np.ndarray, limits: dict) -> tuple[float, float]:
    """What a row shows: nineteen of twenty laws, and all limits."""
    laws = np.percentile(values[np.isfinite(values)], [2.5, 97.5])
    shown = np.array([*laws, *limits["holds"], *limits["partly"]])
    low, high = shown[np.isfinite(shown)].min(), shown[np.isfinite(shown)].max()
    room = 0.04 * (high - low or 1.0)
    return low - room, high + room


def _strip(ax: Axes, d: Data, j: int) -> None:
    name, limits = list(JUDGED.items())[j]
    even = d["round"] == 0
    values, kept = d["value"][even, j], d["tilt_off"][even] <= KEPT_DEG
    low, high = _ends(values, limits)
    for key, colour in (("partly", PARTLY), ("holds", HOLDS)):
        ends = np.clip(limits[key], low, high)
        if ends[0] == ends[1]:
            ends = ends + 0.004 * np.array([-1, 1]) * (high - low)
        ax.axvspan(*ends, color=colour, linewidth=0)
    height = np.random.default_rng(j).uniform(-0.7, 0.7, len(values))
    for which, colour in ((~kept, OTHER), (kept, BLUE)):
        x = np.clip(np.nan_to_num(values[which], posinf=high, neginf=low), low, high)
        ax.plot(x, height[which], ".", color=colour, markersize=2)
    chosen = singled_out(d)
    of_search = d["best"][chosen : chosen + 1]  # none, if it is a law known without it
    confirmed, searched = d["best_value"][chosen, j], d["value"][of_search, j]
    for value, face in ((confirmed, "white"), (searched, ORANGE)):
        place = np.clip(value, low, high)
        ax.plot(place, 0, "D", color=face, markeredgecolor="black", markersize=4)
    ax.set(xlim=(low, high), ylim=(-1, 1), yticks=[])
    ax.tick_params(labelsize=5.5, pad=1, length=2, top=False)
    ax.spines[["left", "right", "top"]].set_visible(False)
    words = limits.get("head", limits["name"]).replace("\n", " ")
    label = f"{name.partition('.')[0]}{'*' if FITTED[j] else ''} {words}"
    ax.set_ylabel(label, rotation=0, ha="right", va="center", fontsize=5.5)


@style
def draw(d: Data) -> plt.Figure:
    shown = np.flatnonzero(HEADED)
    rows = -(-len(shown) // 2)
    figure, axes = plt.subplots(rows, 2, figsize=(7.4, 0.42 * rows))
    for ax in axes.T.flat[len(shown) :]:
        figure.delaxes(ax)
    for ax, j in zip(axes.T.flat, shown, strict=False):
        _strip(ax, d, j)
    return figure
