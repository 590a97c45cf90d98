"""Drift of thin, round-tipped and flat-ended rods under the closure of Section V; a prediction.

The paper's closed forms hold for any contact geometry, its curves are those of a thin rod. (a) A
flat-ended rod stands on the lower edge of its end: below arctan(d/l), 7.125 degrees for the
experiment's l = 8 d, its centre of mass is on the other side of that edge and it drifts against
its tilt; at tilt 0 the contact jumps from edge to edge and the drift from one sign to the other.
Look at 8 degrees, where flat-ended rods began to move in the experiment; at the kinks slip-stick
turns into slip reversal. (b) Over rod length at 15 degrees, the tilt arccos(N d/L) of the paper's
Fig. 13(c): a sphere does not drift; look whether the drift saturates near l = 3 d, as it did there.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from impact import drift, flat_ended_rod, spherocylinder, thin_rod

from ..lib.style import ARROW, BLACK, BLUE, GREEN, RED, SHAPES, Data, painted, style, tilt_axis

LENGTH, FRICTION, RESTITUTION = 8.0, 0.3, 0.65
OBSERVED_DEG = 8.0  # experiment: flat-ended rods drift only above this tilt
IN_RED = {"va": "center", "color": RED, "arrowprops": {**ARROW, "color": RED}}
_KINDS = (("thin", BLACK, "-."), ("round", BLUE, "-"), ("flat", RED, "-"))


def data(quick: bool = False) -> Data:
    """Drift in units of V_z, over tilt [rad] and over length; lengths in diameters."""
    n = 61 if quick else 601
    # The sign of a zero tilt says which edge of a flat end touches: both are there, in a row.
    tilt_deg = np.concatenate([-np.linspace(20, 0, n // 3), np.linspace(0, 60, n)])
    tilt, fixed, lengths = np.radians(tilt_deg), np.radians(15), np.geomspace(1, 20, n)

    def c_x(rod):
        return drift(rod, friction=FRICTION, restitution=RESTITUTION).c_x

    return {
        "friction": np.float64(FRICTION),
        "restitution": np.float64(RESTITUTION),
        "length": np.float64(LENGTH),
        "tilt": tilt,
        "thin": c_x(thin_rod(tilt)),
        "round": c_x(spherocylinder(tilt, LENGTH)),
        "flat": c_x(flat_ended_rod(tilt, LENGTH)),
        "flat_threshold": np.arctan(1 / LENGTH),
        "fixed_tilt": np.float64(fixed),
        "lengths": lengths,
        "thin_by_length": np.full(n, c_x(thin_rod(fixed))),
        "round_by_length": c_x(spherocylinder(fixed, lengths)),
        "flat_by_length": c_x(flat_ended_rod(fixed, lengths)),
        "flat_length": np.float64(1 / np.tan(fixed)),  # at this length 15 degrees is the threshold
    }


def _over_tilt(ax: Axes, d: Data) -> None:
    negative = np.signbit(d["tilt"])
    tilt_deg, threshold_deg = np.degrees(d["tilt"]), np.degrees(d["flat_threshold"])
    for kind, colour, line in _KINDS:
        for side in (negative, ~negative):
            ax.plot(tilt_deg[side], d[kind][side], line, color=colour)
    edges = d["flat"][tilt_deg == 0]
    ax.plot([0, 0], edges, ":", color=RED, lw=1)
    ax.plot([0, 0], edges, "o", color=RED, ms=3, mfc="w")
    words = "contact jumps\nfrom edge to edge"
    ax.annotate(words, (0, edges.max()), (-18.5, 3.9), va="center", arrowprops=ARROW)
    ax.axvspan(-threshold_deg, threshold_deg, color=RED, alpha=0.1, lw=0)
    ax.text(0, -4.6, "flat ends\nbackwards", color=RED, ha="center", fontsize=7)
    ax.plot(threshold_deg, 0, "o", color=RED, ms=4)
    words = rf"$\arctan(d/l)$ = {threshold_deg:.3f}°"
    ax.annotate(words, (threshold_deg, 0), (16, -1.6), **IN_RED)
    ax.axvline(OBSERVED_DEG, color=GREEN, lw=0.8)
    ax.text(OBSERVED_DEG + 1, -4.6, "experiment: flat\nends drift above 8°", color=GREEN)
    ax.set_ylabel(r"drift $c_x/V_z$")
    tilt_axis(ax, -20, 60, 10)


def _over_length(ax: Axes, d: Data) -> None:
    for kind, colour, line in _KINDS:
        ax.plot(d["lengths"], d[f"{kind}_by_length"], line, color=colour, label=SHAPES[kind])
    ax.plot(d["flat_length"], 0, "o", color=RED, ms=4)
    words = rf"$l=d/\tan\phi={d['flat_length']:.2f}\,d$"
    ax.annotate(words, (d["flat_length"], 0), (6.2, -0.8), **IN_RED)
    ax.axvline(3, color="0.5", lw=0.6, ls=":")
    ax.text(3.2, 4.2, "Fig. 13(c):\nsaturates", color="0.3", va="center")
    ax.set(xlabel="length $l/d$", xlim=(0, 20), xticks=(1, 3, 5, 10, 15, 20))
    ax.legend(loc="lower right")


@style
def draw(d: Data) -> plt.Figure:
    fixed = rf"$\phi$ = {np.degrees(d['fixed_tilt']):g}°"
    panels = {rf"$l={d['length']:g}\,d$": _over_tilt, fixed: _over_length}
    figure = painted(d, panels, figsize=(7.0, 2.9), sharey=True)
    left, right = figure.axes
    for ax in figure.axes:
        ax.axhline(0, color="0.5", lw=0.6, zorder=1)
    left.set_ylim(-4.9, 4.9)
    words = rf"$\epsilon={d['restitution']:g}$, $\mu={d['friction']:g}$"
    right.text(0.98, 0.97, words, transform=right.transAxes, ha="right", va="top")
    return figure
