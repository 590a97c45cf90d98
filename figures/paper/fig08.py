"""Fig. 8: phases of the plate at which rods of the row land, at five tilts.

The phase theta is that of the plate's velocity V_0 cos(theta). Steps: every touch, mean and
standard error over independent starts. H: the paper's (1 + cos(theta))/2 pi. Shaded: the plate
falls. (f): part of the landings there; in "landings" touches less than 0.2 periods apart are taken
as one, at the first of them; one rigid rod: at fixed tilt, exact flights and impacts.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from impact import landing_density

from ..lib.runs import (
    SHOWN_DEG,
    along_lean,
    gathered,
    lone,
    means,
    over_seeds,
    row_of,
    tilt_plan,
    tilt_sweeps,
    tilts,
    with_error,
)
from ..lib.style import BLACK, RIGID, THEORY, Data, curve, name_panels, note, style, tilt_axis

BINS_DRAWN = 32  # drawn; the store has 64
FALLING_MEANS = {"tilt_deg": "tilt_deg", "landing_falling": "landings.falling.mean"}
EXPECTED = 0.5 - 1 / np.pi  # part of H = (1 + cos(theta))/2 pi while the plate falls


def densities(counts: np.ndarray) -> np.ndarray:
    """Landings over the cycle, (..., 64), as densities per rad, (..., `BINS_DRAWN`)."""
    counts = counts.reshape(*counts.shape[:-1], BINS_DRAWN, -1).sum(axis=-1)
    return counts / counts.sum(axis=-1, keepdims=True) * BINS_DRAWN / (2 * np.pi)


def falling(counts: np.ndarray) -> np.ndarray:
    """Part of landings over the cycle, (..., bins), at pi/2 < theta < 3 pi/2: the plate falls."""
    quarter = counts.shape[-1] // 4
    return counts[..., quarter : 3 * quarter].sum(axis=-1) / counts.sum(axis=-1)


sweeps = tilt_sweeps


def data(quick: bool = False, scene: str | None = None) -> Data:
    """Densities [per rad] and the part on the way down."""
    sweep = tilt_plan(quick, scene=scene)
    (counts,) = gathered(sweep, "phases")  # (tilts, seeds, 64)
    shown = np.searchsorted(tilts(quick), SHOWN_DEG)
    lone_deg, lone_falling = lone("falling", quick, scene)
    return {
        "words": row_of(scene).words,
        "shown_deg": np.array(SHOWN_DEG),
        "phase": 2 * np.pi * (np.arange(BINS_DRAWN) + 0.5) / BINS_DRAWN,
        **with_error("density", *over_seeds(np.moveaxis(densities(counts[shown]), 1, -1))),
        **with_error("falling", *over_seeds(falling(counts))),
        **means(sweep, FALLING_MEANS, along_lean),
        "lone_deg": lone_deg,
        "lone_falling": lone_falling,
    }


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 4.8))
    fine, top = np.linspace(0, 360, 361), 1.12 * np.nanmax(d["density"] + d["density_error"])
    *panels, last = axes.flat
    for ax, density, error in zip(panels, d["density"], d["density_error"], strict=True):
        ax.axvspan(90, 270, color="0.93", lw=0)
        ax.stairs(density, np.linspace(0, 360, BINS_DRAWN + 1), color=BLACK, lw=0.9)
        ax.errorbar(
            np.degrees(d["phase"]), density, error, fmt="none", ecolor=BLACK, elinewidth=0.6
        )
        ax.plot(fine, landing_density(np.radians(fine)), color=THEORY, label=r"$H(\theta)$")
        ax.set(
            xlabel=r"phase $\theta$ (deg)",
            xlim=(0, 360),
            xticks=range(0, 361, 90),
            ylim=(0, top),
        )
    for ax in axes[:, 0]:
        ax.set_ylabel("density of landings (1/rad)")
    panels[0].text(180, 0.95 * top, "plate falls", ha="center", va="top", color="0.3")
    panels[0].legend(loc="upper center", bbox_to_anchor=(0.5, 0.9))
    last.axhline(EXPECTED, color=THEORY, label=r"$H(\theta)$")
    curve(last, d, "tilt_deg", "falling", BLACK, "touches")
    curve(last, d, "tilt_deg", "landing_falling", BLACK, "landings", form="s-", hollow=True)
    last.plot(d["lone_deg"], d["lone_falling"], color=RIGID, lw=0.8, label="one rigid rod")
    high = 1.8 * max(d["lone_falling"].max(), np.nanmax(d["landing_falling"]))
    tilt_axis(last, 0, 80, 20, ylabel="share of the landings", ylim=(-0.02, high))
    last.legend(loc="upper right", ncols=2)
    titles = [rf"$\phi={tilt:.0f}$°" for tilt in d["shown_deg"]]
    name_panels(axes.flat, [*titles, "share on the way down"])
    note(figure, rf"$\theta=0$: the plate rises fastest; {d['words']}")
    return figure
