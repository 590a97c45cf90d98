"""Fig. 5: rods in the annulus seen from above: the zig-zag, and where it breaks.

(a, b): a line from the lower to the upper cap's centre, with a dot at the upper one; colour: tilt;
circles: the walls. The paper shows 55 and 44 rods; an odd number cannot be a perfect zig-zag, and
56 rods have the tilt of the paper's 55. All start as a zig-zag. (c): order of the zig-zag (1
perfect, 0 none) and share of rods that lean more than the mean by the angle of the legend; green:
how much more the place around the annulus that leans most does than the one that leans least, tilts
smoothed over three rods; each point a number of rods, means over the second half of a run. (d):
tilts around the annulus, over the rods in order of azimuth.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from md.scene import put

from ..lib.arrangement import EVERY, MEASURED, MORE_DEG, in_order, tilts_deg
from ..lib.runs import Sweeps, annulus_of, gathered, over_seeds, with_error
from ..lib.style import (
    ANOTHER,
    BLACK,
    ORANGE,
    Data,
    curve,
    name_panels,
    note,
    shades,
    style,
    zero_line,
)
from . import fig04

SHOWN_COUNTS = (56, 44)  # numbers of rods of (a) and (b)


def sweeps(quick: bool = False) -> Sweeps:
    """Arrangements over the number of rods: runs of Fig. 4(a)."""
    return {"annulus": fig04.sweeps(quick)["still"]}


def data(quick: bool = False, assumed: bool = False, scene: str | None = None) -> Data:
    """Final states of the numbers shown, and measures (number of rods, seed, time, measure).

    Under the assumed law no final states.
    """
    sweep, of = fig04.sweeps(quick, assumed, scene)["still"], annulus_of(scene)
    (series,), counts = gathered(sweep, "series"), sweep.values("rods.count")
    late = series[:, :, series.shape[2] // 2 :].mean(axis=2)  # over time
    gap, shown, base = of.scene.annulus, of.counts(SHOWN_COUNTS), put(of.tables, fig04.USUAL)
    found = {
        "count": counts,
        "time": EVERY * (1 + np.arange(series.shape[2])),
        "series": series,
        "words": of.words if scene else rf"$\Gamma={of.gamma:.3g}$; {of.words}",
        "radii": np.array([gap.inner, gap.outer]),
        "half": (of.scene.rods.length - 1) / 2,
        "shown": np.array(shown),
    }
    for n in () if assumed else shown:
        plan = fig04.over_count([n], 1, sweep.points[0].periods, base)
        found[f"rods_{n}"] = gathered(plan, "rods")[0][0, 0]
    for i, name in enumerate(MEASURED):
        found |= with_error(name, *over_seeds(late[..., i]))
    return found


def _from_above(ax, d, rods: np.ndarray, norm: plt.Normalize) -> LineCollection:
    for radius in d["radii"]:
        ax.add_patch(plt.Circle((0, 0), radius, fill=False, color="0.5", lw=0.7))
    up = np.sign(rods[:, 5:6]) * d["half"] * rods[:, 3:5]
    centre, tilt = rods[:, :2], tilts_deg(rods)
    ends = np.stack([centre - up, centre + up], axis=1)
    look = {"cmap": "viridis_r", "norm": norm}
    lines = ax.add_collection(LineCollection(ends, array=tilt, lw=1.6, **look))
    ax.scatter(*ends[:, 1].T, c=tilt, s=7, lw=0, **look)
    edge = 1.04 * d["radii"].max()
    ax.set(xlim=(-edge, edge), ylim=(-edge, edge), xlabel="$x/d$", ylabel="$y/d$", aspect="equal")
    ax.locator_params(steps=[1, 5, 10])
    return lines


@style
def draw(d: Data) -> Figure:
    figure, ((a, b), (c, e)) = plt.subplots(2, 2, figsize=(7.0, 5.6), height_ratios=(1.6, 1))
    figure.get_layout_engine().set(rect=(0, 0, 1, 0.97))  # titles over panels of fixed aspect
    counts = d["shown"]
    states = [d[f"rods_{n}"] for n in counts]
    tilts = [tilts_deg(in_order(rods)) for rods in states]
    largest = max(tilt.max() for tilt in tilts)
    norm = plt.Normalize(0, np.ceil(largest / 5) * 5)
    for ax, rods in zip((a, b), states, strict=True):
        lines = _from_above(ax, d, rods, norm)
    figure.colorbar(lines, ax=[a, b], label=r"tilt $\phi$ (deg)", pad=0.02, aspect=30)
    beside, share = c.twinx(), f"share {MORE_DEG:g}° beyond the mean"
    curve(c, d, "mean", "zigzag", BLACK, "order of the zig-zag", both=True)
    curve(c, d, "mean", "share", ORANGE, share, form="^:", both=True)
    curve(beside, d, "mean", "contrast", ANOTHER, "contrast of tilts", form="s--", both=True)
    zero_line(c)
    c.set(xlabel=r"mean tilt $\phi$ (deg)", ylabel="order, share", ylim=(-0.1, 1.7))
    beside.set_ylim(*np.multiply(c.get_ylim(), 1.2 * np.nanmax(d["contrast"])))
    beside.set_ylabel("contrast (deg)", color=ANOTHER)
    beside.tick_params(colors=ANOTHER)
    c.legend(handles=c.containers + beside.containers, loc="upper right")
    titles = []
    for n, tilt, colour in zip(counts, tilts, shades(2)[::-1], strict=True):
        titles.append(rf"$N={n}$, mean tilt {tilt.mean():.0f}°")
        e.plot(np.arange(n) / n, tilt, "o-", ms=2.5, lw=0.6, color=colour, label=rf"$N={n}$")
        e.axhline(tilt.mean(), color=colour, lw=0.6, ls=":")
    e.set(xlabel="place around the annulus", ylabel=r"tilt $\phi$ (deg)", xlim=(0, 1))
    e.set_ylim(0, 1.3 * largest)
    e.legend(loc="upper right", ncols=2)
    name_panels((a, b, c, e), (*titles, "", ""))
    note(figure, d["words"])
    return figure
