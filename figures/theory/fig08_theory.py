"""Fig. 8 computed: phases of the plate at landing, one rod with exact flights and impacts.

Spherocylinder l = 9.5 d, Gamma = 3.3, epsilon = 0.65, mu = 0.3, fixed tilt, omega = 0 before each
impact. Bars: one standard error over independent rods. Line: the paper's H = (1 + cos(theta))/2 pi.
Shaded: the plate falls. (f): share of landings there; dashed: the tilt X^2 = epsilon k^2, from
which on a stationary rod is hit again at once. Hops below 0.01 periods (about the duration of a
soft contact in the paper's simulations) count as part of the landing before them.
"""

import matplotlib.pyplot as plt
import numpy as np

from impact import spherocylinder

from ..lib.phases import estimates, middles, phase_panels, share_panel
from ..lib.runs import GAMMA, LENGTH, RESTITUTION, SETTING, SHOWN_DEG
from ..lib.style import ARROW, BLACK, BLUE, Data, curve, hit_again_tilt, style

PHASE_BINS = 36
SPREAD_DEG = 3.0
PHASE_SETTING = {**SETTING, "gamma": GAMMA, "shortest_flight": 0.01, "transient": 200}


def data(quick: bool = False) -> Data:
    """Densities of landing phases [per rad], shape (tilts, bins), and the part on the way down."""
    from impact.bouncing import bounce  # compiles

    def run(tilt, rods, landings):
        how = {**PHASE_SETTING, "rods": rods, "landings": landings, "bins": PHASE_BINS}
        return bounce(spherocylinder(tilt, LENGTH), **how)

    sweep = np.radians(np.arange(0, 61, 5 if quick else 1))
    tilt, spread = np.radians(SHOWN_DEG), np.radians(np.linspace(-SPREAD_DEG, SPREAD_DEG, 13))
    shown = [run(one, *((60, 400) if quick else (1000, 2000))).phases for one in tilt]
    few = (15, 200) if quick else (100, 1000)
    around = [run(one + step, *few).phases for one in tilt for step in spread]
    near = estimates("near", around)
    density, error = (near[name].reshape(tilt.size, spread.size, -1) for name in near)
    falling = [run(one, *((60, 200) if quick else (200, 1000))).falling for one in sweep]
    return {
        "tilt": tilt,
        "phase": middles(PHASE_BINS),
        **estimates("density", shown),
        "spread_density": density.mean(axis=1),
        "spread_error": np.sqrt((error**2).mean(axis=1) / spread.size),
        "sweep_tilt": sweep,
        **estimates("falling", falling),
        "again_tilt": hit_again_tilt(LENGTH, RESTITUTION),
    }


@style
def draw(d: Data) -> plt.Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 4.2))
    phase_deg, width = np.degrees(d["phase"]), 360 / d["phase"].size
    top = 0.8
    for i, ax in enumerate(phase_panels(axes, top)):
        density, error = d["density"][i], d["density_error"][i]
        ax.bar(phase_deg, density, width, color=BLUE, alpha=0.55, lw=0, label="this tilt")
        ax.errorbar(phase_deg, density, error, fmt="none", ecolor=BLUE, elinewidth=0.8)
        look = {"fmt": "k.-", "ms": 2, "lw": 0.6, "elinewidth": 0.6}
        look["label"] = rf"mean over $\phi\pm{SPREAD_DEG:.0f}$°"
        ax.errorbar(phase_deg, d["spread_density"][i], d["spread_error"][i], **look)
        peak = np.argmax(density)
        if density[peak] > top:
            at, beside = (phase_deg[peak], 0.99 * top), (phase_deg[peak] + 25, 0.9 * top)
            ax.annotate(f"up to {density[peak]:.1f}", at, beside, arrowprops=ARROW)
    last = share_panel(figure, np.degrees(d["tilt"]), 60, 15)
    curve(last, {**d, "deg": np.degrees(d["sweep_tilt"])}, "deg", "falling", BLUE)
    again = np.degrees(d["again_tilt"])
    name = rf"$X^2=\epsilon k^2$: {again:.1f}°"
    last.axvline(again, 0, 0.73, color=BLACK, lw=0.8, ls="--", label=name)  # up to the legend
    last.set(ylim=(-0.02, 1))
    last.legend(loc="upper right")
    return figure
