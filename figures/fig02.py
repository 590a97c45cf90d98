"""Fig. 2, simulated: forward, no and reverse drift of the plane row, over acceleration and tilt.

(a): forward (full red), reverse (full blue) where the drift is beyond 3 standard errors and beyond
0.003 cm/s, else none (open). Colours: drift of one rigid rod at fixed tilt, exact flights and
impacts, with the theory's closure omega = 0; dashed: there the mean plate velocity at landing, V_z
weighted by impulse, is zero, and negative to the left. (b): the drift over Gamma at three tilts;
lines: the theory at V_z = V_0/2. (c): near Gamma = 1, linear within the floor (grey), logarithmic
beyond. Dotted: where the paper's annulus begins to move. No walls, no curvature: the experiment's
threshold need not be here.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import TwoSlopeNorm

from impact import drift, spherocylinder
from md.sweep import Sweep

from .rows import (
    FRICTION,
    LAW_NAME,
    LENGTH,
    RESTITUTION,
    boxes,
    computed,
    measured_error,
    over_seeds,
    planned,
    plate_speed_cm_s,
    store,
)
from .shared import BLACK, BLUE, GREEN, ORANGE, RED, name_panel, style

FLOOR_CM_S = 0.003  # half a hundredth of a diameter a second
SIGNIFICANT = 3.0  # standard errors
ONSET = 1.6  # Gamma, Fig. 2(b, c)


def classify(mean: np.ndarray, error: np.ndarray) -> np.ndarray:
    """1 forward, -1 reverse, 0 none: drifts [cm/s] with their standard errors."""
    clear = (np.abs(mean) > SIGNIFICANT * error) & (np.abs(mean) > FLOOR_CM_S)
    return np.where(clear, np.sign(mean), 0).astype(int)


QUICK = (1.2, 1.8, 3.3), (9, 20, 45), (0, 1, 2)
FULL = (1.05, 1.1, 1.2, 1.3, 1.4, 1.6, 1.8, 2.2, 2.8, 3.5), (5, 12, 20, 30, 45, 60), (1, 2, 4)


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Over Gamma and tilt."""
    gamma, nominal, _ = QUICK if quick else FULL
    axes = [{"plate.acceleration": [*gamma]}, {"box.length": boxes(np.array(nominal))}]
    axes.append({"start.seed": [1, 2, 3]})
    return {"grid": planned(axes, 50 if quick else 150, {"rods.inertia": "solid"})}


def data(quick: bool = False) -> dict[str, np.ndarray]:
    """Drifts [cm/s] on the grid (Gamma, tilt), those of one rigid rod, and the closure's lines."""
    from impact.bouncing import bounce  # compiles

    fine_gamma = np.linspace(1.02, 4, 12 if quick else 40)
    fine_deg = np.linspace(2, 65, 10 if quick else 22)
    gamma, nominal, chosen = QUICK if quick else FULL
    sweep = computed(sweeps(quick)["grid"])
    names = ("c_x_cm_s", "c_x_stderr", "tilt_deg", "landings.plate_velocity_by_speed.mean")
    drifts, stderr, tilt, plate = sweep.gather(store(), *names)
    mean, error = measured_error(drifts, stderr * sweep.points[0].scene.cm_per_s)
    count = {"rods": 20, "landings": 60, "transient": 100} if quick else {
        **{"rods": 60, "landings": 300, "transient": 150}
    }  # fmt: skip
    setting = {"friction": FRICTION, "restitution": RESTITUTION}
    lone = [
        [
            bounce(
                *(spherocylinder(np.radians(deg), LENGTH),),
                **{"gamma": one, "shortest_flight": 0.01, **setting, **count},
            )
            for deg in fine_deg
        ]
        for one in fine_gamma
    ]
    speed = plate_speed_cm_s(fine_gamma)
    lines = drift(spherocylinder(np.radians(np.array(nominal)[[*chosen]]), LENGTH), **setting).c_x
    return {
        "gamma": np.array(gamma),
        "nominal_deg": np.array(nominal),
        "tilt_deg": over_seeds(tilt)[0],
        "c_x": mean,
        "c_x_error": error,
        "kind": classify(mean, error),
        "V_z": over_seeds(plate)[0],
        "chosen": np.array(chosen),
        "fine_gamma": fine_gamma,
        "fine_deg": fine_deg,
        "lone_c_x": speed[:, None] * np.array([[run.drift.mean for run in row] for row in lone]),
        "lone_alpha": np.array([[run.alpha_impulse.mean for run in row] for row in lone]),
        "closure": lines[:, None] * speed / 2,
    }


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, (a, b, c) = plt.subplots(1, 3, figsize=(7.0, 3.0), width_ratios=(1.35, 1, 1))
    top = np.nanmax(np.abs(d["lone_c_x"]))
    norm = TwoSlopeNorm(0, -top / 4, top)
    shading = {"cmap": "RdBu_r", "norm": norm, "shading": "nearest", "alpha": 0.55}
    mesh = a.pcolormesh(d["fine_gamma"], d["fine_deg"], d["lone_c_x"].T, rasterized=True, **shading)
    figure.colorbar(mesh, ax=a, label="drift of one rigid rod (cm/s)", pad=0.02)
    alpha = np.nan_to_num(d["lone_alpha"].T, nan=-1.0)
    a.contour(d["fine_gamma"], d["fine_deg"], alpha, [0.0], colors=BLACK, linestyles="--")
    gamma = np.broadcast_to(d["gamma"][:, None], d["kind"].shape)
    tilt = np.broadcast_to(d["nominal_deg"], d["kind"].shape)
    for kind, face, marker, label in (
        (1, RED, "o", "forward"),
        (0, "white", "o", "none"),
        (-1, BLUE, "v", "reverse"),
    ):
        here = d["kind"] == kind
        a.plot(gamma[here], tilt[here], marker, mfc=face, mec=BLACK, mew=0.6, ms=4.5, label=label)
    a.axvline(ONSET, color=BLACK, lw=0.8, ls=":")
    a.set(
        xlabel=r"acceleration $\Gamma$", ylabel=r"tilt $\phi$ (deg)", ylim=(0, 66), xlim=(0.95, 4.1)
    )
    figure.legend(*a.get_legend_handles_labels(), loc="outside upper left", ncols=3)
    name_panel(a, "a")
    bars = {"fmt": "o-", "ms": 2.6, "lw": 0.6, "elinewidth": 0.7}
    for i, colour, line in zip(d["chosen"], (GREEN, BLUE, RED), d["closure"], strict=True):
        name = rf"$\phi={d['nominal_deg'][i]:.0f}$°"
        shown = d["gamma"], d["c_x"][:, i], d["c_x_error"][:, i]
        b.errorbar(*shown, **bars, color=colour, label=name)
        b.plot(d["fine_gamma"], line, color=colour, lw=0.8, ls="--")
    early = d["gamma"] <= ONSET
    steep = np.flatnonzero(d["nominal_deg"] >= 20)
    for i, colour in zip(steep, (BLUE, BLACK, RED, ORANGE), strict=False):
        shown = d["gamma"][early], d["c_x"][early, i], d["c_x_error"][early, i]
        c.errorbar(*shown, **bars, color=colour, label=rf"$\phi={d['nominal_deg'][i]:.0f}$°")
    c.set_yscale("symlog", linthresh=FLOOR_CM_S)
    c.axhspan(-FLOOR_CM_S, FLOOR_CM_S, color="0.88", lw=0)
    c.set(xlabel=r"acceleration $\Gamma$", xlim=(1, ONSET + 0.05))
    c.set_ylim(-0.03, 60)
    c.legend(loc="upper left", fontsize=6, ncols=2, columnspacing=1, handlelength=1.2)
    name_panel(c, "c", "near onset")
    for ax in (b, c):
        ax.axhline(0, color="0.6", lw=0.6)
        ax.axvline(ONSET, color=BLACK, lw=0.8, ls=":")
    b.set(xlabel=r"acceleration $\Gamma$", ylabel=r"drift $c_x$ (cm/s)", xlim=(1, None))
    b.set_ylim(None, 1.15 * max(np.nanmax(d["c_x"]), 1))
    b.legend(loc="lower right", fontsize=6)
    name_panel(b, "b")
    figure.supxlabel(
        rf"$l={LENGTH}\,d$, $d=0.6$ cm, 60 Hz, $\mu={FRICTION}$; {LAW_NAME}", fontsize=7
    )
    return figure


def summary(d: dict[str, np.ndarray]) -> str:
    """The map, a row a Gamma: f forward, - none, r reverse; drifts with errors."""
    lines = ["Fig. 2. f forward, - none, r reverse; drift in cm/s +- one s.e. (one rigid rod)"]
    lines.append("Gamma  " + "  ".join(f"{tilt:>15} deg" for tilt in d["nominal_deg"]))
    place = np.abs(d["fine_deg"][:, None] - d["nominal_deg"]).argmin(axis=0)
    for i, gamma in enumerate(d["gamma"]):
        near = np.abs(d["fine_gamma"] - gamma).argmin()
        lines.append(
            f"{gamma:5.2f}  "
            + "  ".join(
                f"{'r-f'[d['kind'][i, j] + 1]} {d['c_x'][i, j]:6.3f}+-{d['c_x_error'][i, j]:.3f}"
                f" ({d['lone_c_x'][near, place[j]]:.1f})"
                for j in range(len(d["nominal_deg"]))
            )
        )
    return "\n".join(lines)
