"""Fig. 2, simulated: forward, no and reverse drift over acceleration and tilt, row and annulus.

(a): the row; the drift counts as forward or reverse beyond 3 standard errors and 0.003 cm/s.
Shades: drift of one rigid rod at fixed tilt, exact flights and impacts, with the theory's closure
omega = 0; on the dashed line its mean plate velocity at a touch, V_z weighted by impulse, is zero,
and negative to the left. (b): the drift over Gamma at three tilts; dashed: the theory at V_z =
V_0/2. (c): near Gamma = 1; linear within the grey band, logarithmic beyond. (d, e, f): the same in
the experiment's annulus, where the number of rods sets the tilt; arrows in (d): V_z at a touch,
weighted by the speed of approach, up where positive. The row has no walls and no curvature.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from impact import drift, spherocylinder
from md.sweep import Sweep

from ..claims.over_tilt import CLEAR
from ..lib.bounces import bounced, estimates
from ..lib.runs import (
    ANNULUS,
    FRICTION,
    LAW_NAME,
    LENGTH,
    SETTING,
    Sweeps,
    boxes,
    computed,
    drift_and_tilt,
    means,
    planned,
    plate_speed_cm_s,
    starts,
)
from ..lib.style import (
    BLACK,
    DOTTED,
    DRIFTS,
    FORWARD,
    REVERSE,
    Data,
    curve,
    legend_above,
    name_panels,
    note,
    shades,
    style,
    zero_line,
)

FLOOR_CM_S = 0.003  # half a hundredth of a diameter a second
ONSET = 1.6  # Gamma above which the paper's rods drift forward, Fig. 2(b)
MAP_GAMMAS = {
    True: (1.2, 1.5, 1.8, 3.3),
    False: (1.05, 1.1, 1.2, 1.3, 1.4, 1.6, 1.8, 2.2, 2.8, 3.5),
}
NOMINAL_DEG = {True: (9, 20, 45), False: (5, 12, 20, 30, 45, 60)}
CHOSEN = {True: (0, 1, 2), False: (1, 2, 4)}  # tilts of (b)
MAP_COUNTS = {True: (44, 36), False: (50, 44, 36)}
MAP_PERIODS = {True: (30, 12), False: (150, 300)}  # of rows, of annuli
ARROW_DEG = 8.0  # an arrow of V_0
AT_TOUCH = "touches.plate_velocity_by_speed.mean"


def classify(mean: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Direction of drifts [cm/s] with standard errors: 1 forward, -1 reverse, 0 none."""
    clear = np.abs(mean) > np.maximum(CLEAR * error, FLOOR_CM_S)
    return np.where(clear, np.sign(mean), 0).astype(int)


def sweeps(quick: bool = False) -> Sweeps:
    """Sweeps of rows over Gamma and tilt, of annuli over Gamma and the number of rods."""
    gamma, (of_rows, of_annuli) = {"plate.acceleration": [*MAP_GAMMAS[quick]]}, MAP_PERIODS[quick]
    rows = [gamma, {"box.length": boxes(NOMINAL_DEG[quick])}, starts(3)]
    annuli = [gamma, {"rods.count": [*MAP_COUNTS[quick]]}, starts(2)]
    return {
        "grid": planned(rows, of_rows, {"rods.inertia": "solid"}),
        "annulus": planned(annuli, of_annuli, base=ANNULUS),
    }


def data(quick: bool = False) -> Data:
    """Drifts [cm/s] on the grid (Gamma, tilt), those of one rigid rod, and the closure's lines.

    Names that begin with `ring_`: in the annulus (Gamma, number of rods).
    """
    fine_gamma = np.linspace(1.02, 4, 12 if quick else 40)
    fine_deg = np.linspace(2, 65, 10 if quick else 22)
    plan, nominal = sweeps(quick), np.array(NOMINAL_DEG[quick])
    chosen = np.array(CHOSEN[quick])
    # a row and an annulus first: their kernels are compiled side by side
    computed(Sweep((), (plan["annulus"].points[0], *plan["grid"].points)))
    found = {}
    for name, prefix in (("grid", ""), ("annulus", "ring_")):
        found |= drift_and_tilt(plan[name], prefix) | means(plan[name], {f"{prefix}V_z": AT_TOUCH})
        found[f"{prefix}kind"] = classify(found[f"{prefix}c_x"], found[f"{prefix}c_x_error"])
    rods, landings, transient = (20, 60, 100) if quick else (60, 300, 150)
    lone = bounced(
        np.radians(fine_deg),
        fine_gamma[:, None],
        LENGTH,
        landings=landings,
        rods=rods,
        transient=transient,
        shortest_flight=0.01,
        **SETTING,
    )
    speed = plate_speed_cm_s(fine_gamma)
    tilted = spherocylinder(np.radians(nominal[chosen]), LENGTH)
    return {
        "gamma": np.array(MAP_GAMMAS[quick]),
        "nominal_deg": nominal,
        **found,
        "ring_count": np.array(MAP_COUNTS[quick]),
        "chosen": chosen,
        "fine_gamma": fine_gamma,
        "fine_deg": fine_deg,
        "lone_c_x": speed[:, None] * estimates(lone, "drift")[0],
        "lone_alpha": estimates(lone, "alpha_impulse")[0],
        "closure": drift(tilted, **SETTING).c_x[:, None] * speed / 2,
    }


def _map(ax, d, tilt: str, kind: str):
    """Draw symbols where there is drift forward, none, or reverse."""
    gamma, tilt_deg = np.broadcast_arrays(d["gamma"][:, None], d[tilt])
    looks = ("forward", 1, FORWARD, "o"), ("none", 0, "white", "o"), ("reverse", -1, REVERSE, "v")
    for label, which, face, marker in looks:
        here = d[kind] == which
        ax.plot(
            gamma[here], tilt_deg[here], marker, mfc=face, mec=BLACK, mew=0.6, ms=4.5, label=label
        )
    ax.set(ylabel=r"tilt $\phi$ (deg)", ylim=(0, 66), xlim=(0.95, 4.1))


def _near_onset(ax, d, prefix: str, looks: dict):
    """Draw drifts below the onset, linear and logarithmic; `looks`: colour and name by column."""
    early = d["gamma"] <= ONSET
    d = {**d, "gamma": d["gamma"][early]}
    for i, look in looks.items():
        curve(ax, d, "gamma", f"{prefix}c_x", *look, at=(early, i))
    ax.set_yscale("symlog", linthresh=FLOOR_CM_S)
    ax.axhspan(-FLOOR_CM_S, FLOOR_CM_S, color="0.88", lw=0)
    ax.text(1.63, FLOOR_CM_S / 2, "counts as none", va="center", ha="right")
    ax.set(xlim=(1, ONSET + 0.05), ylim=(-0.1, 60), yticks=(-0.1, -0.01, 0, 0.01, 0.1, 1, 10))
    ax.legend(loc="upper left", ncols=2, handlelength=1.2)


def _rows(axes, d):
    a, b, c = axes
    gamma, top = d["fine_gamma"], np.nanmax(np.abs(d["lone_c_x"]))
    mesh = a.pcolormesh(
        gamma,
        d["fine_deg"],
        d["lone_c_x"].T,
        cmap=DRIFTS,
        norm=TwoSlopeNorm(0, -top / 4, top),
        alpha=0.55,
        rasterized=True,
    )
    bar = a.figure.colorbar(mesh, ax=a, label="one rigid rod (cm/s)", pad=0.02)
    ends = MaxNLocator(2).tick_values(-top / 4, 0), MaxNLocator(4).tick_values(0, top)
    bar.set_ticks([tick for tick in np.unique(np.concatenate(ends)) if -top / 4 <= tick <= top])
    a.contour(gamma, d["fine_deg"], d["lone_alpha"].T, [0.0], colors=BLACK, linestyles="--")
    a.plot([], [], "--", color=BLACK, label="$V_z=0$, one rigid rod")
    _map(a, d, "nominal_deg", "kind")
    tilts = [rf"$\phi={tilt:.0f}$°" for tilt in d["nominal_deg"]]
    looks = [*zip(shades(len(tilts)), tilts, strict=True)]
    for i, line in zip(d["chosen"], d["closure"], strict=True):
        curve(b, d, "gamma", "c_x", *looks[i], at=(..., i))
        b.plot(gamma, line, color=looks[i][0], lw=0.8, ls="--")
    b.plot([], [], "--", color="0.4", lw=0.8, label="theory")
    top = max(np.nanmax(d["c_x"]), 1)
    b.set(xlim=(1, None), ylim=(-0.45 * top, 1.15 * top))
    b.legend(loc="lower right", ncols=2, handlelength=1.2, columnspacing=1)
    _near_onset(c, d, "", {i: looks[i] for i in np.flatnonzero(d["nominal_deg"] >= 20)})


def _annuli(axes, d):
    a, b, c = axes
    size = ARROW_DEG * np.clip(d["ring_V_z"], -1, 1)
    arrows = a.quiver(
        d["gamma"][:, None] + 0 * size,
        d["ring_tilt"],
        0 * size,
        size,
        angles="xy",
        scale_units="xy",
        scale=1,
        color="0.3",
        width=0.012,
    )
    a.quiverkey(arrows, 0.6, 1.09, ARROW_DEG / 2, "$V_z=V_0/2$", angle=90, labelpos="E")
    _map(a, d, "ring_tilt", "ring_kind")
    names = [rf"$N={n}$" for n in d["ring_count"]]
    looks = dict(enumerate(zip(shades(len(names))[::-1], names, strict=True)))
    for i, look in looks.items():
        curve(b, d, "gamma", "ring_c_x", *look, at=(..., i))
    b.set_xlim(1, None)
    b.legend(loc="upper left")
    _near_onset(c, d, "ring_", looks)


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 5.8), width_ratios=(1.35, 1, 1))
    _rows(axes[0], d)
    _annuli(axes[1], d)
    clear = {axes[0, 1]: (0.25, 1), axes[1, 1]: (0, 0.74)}  # of the legends
    for ax in axes.flat:
        ax.axvline(ONSET, *clear.get(ax, (0, 1)), **DOTTED, label="the paper's rods begin to move")
        ax.set_xlabel(r"acceleration $\Gamma$")
    legend_above(figure, axes[0, 0], ncols=3)
    for ax in axes[:, 1:].flat:
        ax.set_ylabel(r"drift $c_x$ (cm/s)")
        zero_line(ax)
    name_panels(axes.flat, ("row", "", "near onset", "annulus", "", "near onset"))
    rods = rf"row: $l={LENGTH}\,d$, $d=0.6$ cm; annulus: the experiment's, $l=8\,d$, $d=0.635$ cm"
    note(figure, rf"{rods}; 60 Hz, $\mu={FRICTION}$, solid inertia; {LAW_NAME}")
    return figure
