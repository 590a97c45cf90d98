"""Fig. 8 computed: phases of the plate at landing, one rod with exact flights and impacts.

Spherocylinder l = 9.5 d, Gamma = 3.3, epsilon = 0.65, mu = 0.3, fixed tilt, omega = 0 before each
impact. Bars: one standard error over independent rods. Line: the paper's H = (1 + cos(theta))/2 pi.
Shaded: the plate falls. (f): share of landings there; dashed: the tilt X^2 = epsilon k^2, from
which on a stationary rod is hit again at once. Hops below 0.01 periods (about the duration of a
soft contact in the paper's simulations) count as part of the landing before them.
"""

import matplotlib.pyplot as plt
import numpy as np

from impact import landing_density, spherocylinder

from ..lib.style import (
    BLACK,
    BLUE,
    LEGEND_BOX,
    RED,
    Data,
    curve,
    hit_again_tilt,
    name_panels,
    style,
    tilt_axis,
)

PHASE_TILTS_DEG = (9, 18, 27, 34, 45)
PHASE_BINS = 36
SPREAD_DEG = 3.0
PHASE_SETTING = {"gamma": 3.3, "friction": 0.3, "restitution": 0.65, "shortest_flight": 0.01}
LENGTH = 9.5  # over the diameter


def data(quick: bool = False) -> Data:
    """Densities of landing phases [per rad], shape (tilts, bins), and the part on the way down."""
    from impact.bouncing import bounce  # compiles

    def run(tilt, rods, landings):
        rod = spherocylinder(tilt, LENGTH)
        return bounce(
            rod, **PHASE_SETTING, rods=rods, landings=landings, transient=200, bins=PHASE_BINS
        )

    sweep = np.radians(np.arange(0, 61, 5 if quick else 1))
    tilt, spread = np.radians(PHASE_TILTS_DEG), np.radians(np.linspace(-SPREAD_DEG, SPREAD_DEG, 13))
    shown = [run(one, *((60, 400) if quick else (1000, 2000))).phases for one in tilt]
    around = [
        [run(one + step, *((15, 200) if quick else (100, 1000))).phases for step in spread]
        for one in tilt
    ]
    falling = [run(one, *((60, 200) if quick else (200, 1000))).falling for one in sweep]
    return {
        **{name: np.float64(value) for name, value in PHASE_SETTING.items()},
        "length": np.float64(LENGTH),
        "tilt": tilt,
        "phase": 2 * np.pi * (np.arange(PHASE_BINS) + 0.5) / PHASE_BINS,
        "density": np.array([each.mean for each in shown]),
        "density_error": np.array([each.error for each in shown]),
        "spread": np.radians(SPREAD_DEG),
        "spread_density": np.mean([[each.mean for each in near] for near in around], axis=1),
        "spread_error": np.sqrt(
            np.mean([[each.error**2 for each in near] for near in around], axis=1) / spread.size
        ),
        "sweep_tilt": sweep,
        "falling": np.array([each.mean for each in falling]),
        "falling_error": np.array([each.error for each in falling]),
        "again_tilt": hit_again_tilt(LENGTH, PHASE_SETTING["restitution"]),
    }


@style
def draw(d: Data) -> plt.Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 4.2))
    phase_deg, width = np.degrees(d["phase"]), 360 / d["phase"].size
    fine = np.linspace(0, 360, 361)
    top = 0.8
    for i, ax in enumerate(axes.flat[:-1]):
        density, error = d["density"][i], d["density_error"][i]
        ax.axvspan(90, 270, color="0.93", lw=0)
        ax.bar(phase_deg, density, width, color=BLUE, alpha=0.55, lw=0, label="this tilt")
        ax.errorbar(phase_deg, density, error, fmt="none", ecolor=BLUE, elinewidth=0.8)
        label = rf"mean over $\phi\pm{np.degrees(d['spread']):.0f}$°"
        near, error = d["spread_density"][i], d["spread_error"][i]
        ax.errorbar(phase_deg, near, error, fmt="k.-", ms=2, lw=0.6, elinewidth=0.6, label=label)
        ax.plot(fine, landing_density(np.radians(fine)), color=RED, label=r"$H(\theta)$")
        peak = np.argmax(density)
        if density[peak] > top:
            ax.annotate(
                f"up to {density[peak]:.1f}",
                (phase_deg[peak], 0.99 * top),
                (phase_deg[peak] + 25, 0.9 * top),
                arrowprops={"arrowstyle": "->", "lw": 0.6},
            )
        ax.set(xlim=(0, 360), ylim=(0, top), xticks=range(0, 361, 90))
        ax.set(xlabel=r"phase $\theta$ of the plate (deg)")
    for ax in axes[:, 0]:
        ax.set_ylabel("density of landings (1/rad)")
    axes[0, 0].text(180, 0.95 * top, "plate falls", ha="center", va="top", color="0.3")
    axes[0, 0].legend(loc="upper center", bbox_to_anchor=(0.5, 0.9))
    last = axes[1, 2]
    curve(last, {**d, "deg": np.degrees(d["sweep_tilt"])}, "deg", "falling", BLUE)
    expected = 0.5 - 1 / np.pi  # integral of H over the shaded half
    last.axhline(expected, color=RED, label=r"$H(\theta)$")
    again = np.degrees(d["again_tilt"])
    last.axvline(again, color=BLACK, lw=0.8, ls="--", label=rf"$X^2=\epsilon k^2$: {again:.1f}°")
    tilt_axis(last, 0, 60)
    last.set(ylabel="landings while the plate falls", ylim=(-0.02, 1))
    last.legend(loc="upper right", **LEGEND_BOX)
    titles = [rf"$\phi={tilt:.0f}$°" for tilt in np.degrees(d["tilt"])]
    name_panels(axes.flat, [*titles, "share on the way down"])
    return figure
