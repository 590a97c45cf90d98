"""Fig. 2, simulated: forward, no and reverse drift over acceleration and tilt, plane and annulus.

(a): the plane row; forward (full red), reverse (full blue) where the drift is beyond 3 standard
errors and beyond 0.003 cm/s, else none (open). Colours: drift of one rigid rod at fixed tilt, exact
flights and impacts, with the theory's closure omega = 0; dashed: there the mean plate velocity at
landing, V_z weighted by impulse, is zero, and negative to the left. (b): the drift over Gamma at
three tilts; lines: the theory at V_z = V_0/2. (c): near Gamma = 1, linear within the floor (grey),
logarithmic beyond. (d, e, f): the same in the experiment's annulus, where the number of rods sets
the tilt; arrows in (d): V_z at landing, weighted by the speed of approach, up where positive.
Dotted: where the paper's rods begin to move. The plane row has no walls and no curvature.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import TwoSlopeNorm

from impact import drift, spherocylinder
from md.sweep import Sweep

from ..lib import annulus_runs as ring
from ..lib.row_runs import (
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
from ..lib.style import BLACK, BLUE, GREEN, ORANGE, RED, name_panel, style

FLOOR_CM_S = 0.003  # half a hundredth of a diameter a second
SIGNIFICANT = 3.0  # standard errors
ONSET = 1.6  # Gamma, Fig. 2(b, c)


def classify(mean: np.ndarray, error: np.ndarray) -> np.ndarray:
    """1 forward, -1 reverse, 0 none: drifts [cm/s] with their standard errors."""
    clear = (np.abs(mean) > SIGNIFICANT * error) & (np.abs(mean) > FLOOR_CM_S)
    return np.where(clear, np.sign(mean), 0).astype(int)


QUICK = (1.2, 1.8, 3.3), (9, 20, 45), (0, 1, 2)
ANNULUS = {True: ((44, 36), [1, 2], 40), False: ((50, 44, 36), [1, 2], 300)}
FULL = (1.05, 1.1, 1.2, 1.3, 1.4, 1.6, 1.8, 2.2, 2.8, 3.5), (5, 12, 20, 30, 45, 60), (1, 2, 4)


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Over Gamma and tilt; over Gamma and the number of rods."""
    gamma, nominal, _ = QUICK if quick else FULL
    counts, seeds, periods = ANNULUS[quick]
    axes = [{"plate.acceleration": [*gamma]}, {"box.length": boxes(np.array(nominal))}]
    axes.append({"start.seed": [1, 2, 3]})
    around = [axes[0], {"rods.count": [*counts]}, {"start.seed": seeds}]
    return {
        "grid": planned(axes, 50 if quick else 150, {"rods.inertia": "solid"}),
        "annulus": ring.planned(around, periods),
    }


def data(quick: bool = False) -> dict[str, np.ndarray]:
    """Drifts [cm/s] on the grid (Gamma, tilt), those of one rigid rod, and the closure's lines.

    Names that begin with `ring_`: in the annulus (Gamma, number of rods).
    """
    from impact.bouncing import bounce  # compiles

    fine_gamma = np.linspace(1.02, 4, 12 if quick else 40)
    fine_deg = np.linspace(2, 65, 10 if quick else 22)
    gamma, nominal, chosen = QUICK if quick else FULL
    plan = sweeps(quick)
    sweep = computed(plan["grid"])
    names = ("c_x_cm_s", "c_x_stderr", "tilt_deg", "touches.plate_velocity_by_speed.mean")
    drifts, stderr, tilt, plate = sweep.gather(store(), *names)
    mean, error = measured_error(drifts, stderr * sweep.points[0].scene.cm_per_s)
    around = ring.measured(plan["annulus"], "ring")
    [landing] = plan["annulus"].gather(store(), names[-1])
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
        **around,
        "ring_count": plan["annulus"].values("rods.count"),
        "ring_kind": classify(around["ring_c_x"], around["ring_c_x_error"]),
        "ring_V_z": over_seeds(landing)[0],
        "chosen": np.array(chosen),
        "fine_gamma": fine_gamma,
        "fine_deg": fine_deg,
        "lone_c_x": speed[:, None] * np.array([[run.drift.mean for run in row] for row in lone]),
        "lone_alpha": np.array([[run.alpha_impulse.mean for run in row] for row in lone]),
        "closure": lines[:, None] * speed / 2,
    }


def _map(ax: plt.Axes, gamma: np.ndarray, tilt: np.ndarray, kind: np.ndarray) -> None:
    """Symbols where there is drift forward, none, or reverse."""
    for which, face, marker, label in (
        (1, RED, "o", "forward"),
        (0, "white", "o", "none"),
        (-1, BLUE, "v", "reverse"),
    ):
        here = kind == which
        ax.plot(gamma[here], tilt[here], marker, mfc=face, mec=BLACK, mew=0.6, ms=4.5, label=label)
    ax.axvline(ONSET, color=BLACK, lw=0.8, ls=":")
    ax.set(
        xlabel=r"acceleration $\Gamma$", ylabel=r"tilt $\phi$ (deg)", ylim=(0, 66), xlim=(0.95, 4.1)
    )


BARS = {"fmt": "o-", "ms": 2.6, "lw": 0.6, "elinewidth": 0.7}


def _near_onset(ax: plt.Axes) -> None:
    ax.set_yscale("symlog", linthresh=FLOOR_CM_S)
    ax.axhspan(-FLOOR_CM_S, FLOOR_CM_S, color="0.88", lw=0)
    ax.set(xlabel=r"acceleration $\Gamma$", xlim=(1, ONSET + 0.05), ylim=(-0.1, 60))
    ax.legend(loc="upper left", fontsize=6, ncols=2, columnspacing=1, handlelength=1.2)


def _plane(axes: np.ndarray, d: dict[str, np.ndarray]) -> None:
    a, b, c = axes
    top = np.nanmax(np.abs(d["lone_c_x"]))
    norm = TwoSlopeNorm(0, -top / 4, top)
    shading = {"cmap": "RdBu_r", "norm": norm, "shading": "nearest", "alpha": 0.55}
    mesh = a.pcolormesh(d["fine_gamma"], d["fine_deg"], d["lone_c_x"].T, rasterized=True, **shading)
    a.figure.colorbar(mesh, ax=a, label="one rigid rod (cm/s)", pad=0.02)
    alpha = np.nan_to_num(d["lone_alpha"].T, nan=-1.0)
    a.contour(d["fine_gamma"], d["fine_deg"], alpha, [0.0], colors=BLACK, linestyles="--")
    gamma = np.broadcast_to(d["gamma"][:, None], d["kind"].shape)
    _map(a, gamma, np.broadcast_to(d["nominal_deg"], d["kind"].shape), d["kind"])
    for i, colour, line in zip(d["chosen"], (GREEN, BLUE, RED), d["closure"], strict=True):
        name = rf"$\phi={d['nominal_deg'][i]:.0f}$°"
        shown = d["gamma"], d["c_x"][:, i], d["c_x_error"][:, i]
        b.errorbar(*shown, **BARS, color=colour, label=name)
        b.plot(d["fine_gamma"], line, color=colour, lw=0.8, ls="--")
    early = d["gamma"] <= ONSET
    steep = np.flatnonzero(d["nominal_deg"] >= 20)
    for i, colour in zip(steep, (BLUE, BLACK, RED, ORANGE), strict=False):
        shown = d["gamma"][early], d["c_x"][early, i], d["c_x_error"][early, i]
        c.errorbar(*shown, **BARS, color=colour, label=rf"$\phi={d['nominal_deg'][i]:.0f}$°")
    b.set_ylim(None, 1.15 * max(np.nanmax(d["c_x"]), 1))


def _annulus(axes: np.ndarray, d: dict[str, np.ndarray]) -> None:
    a, b, c = axes
    gamma = np.broadcast_to(d["gamma"][:, None], d["ring_kind"].shape)
    size = 6 * np.clip(d["ring_V_z"], -1, 1)
    a.quiver(
        *(gamma, d["ring_tilt"], 0 * size, size),
        **{"angles": "xy", "scale_units": "xy", "scale": 1, "color": "0.45", "width": 0.006},
    )
    _map(a, gamma, d["ring_tilt"], d["ring_kind"])
    early = d["gamma"] <= ONSET
    for i, colour in zip(range(len(d["ring_count"])), (GREEN, BLUE, BLACK, RED), strict=False):
        shown = d["gamma"], d["ring_c_x"][:, i], d["ring_c_x_error"][:, i]
        name = rf"$N={d['ring_count'][i]}$"
        b.errorbar(*shown, **BARS, color=colour, label=name)
        c.errorbar(*(part[early] for part in shown), **BARS, color=colour, label=name)


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 5.4), width_ratios=(1.35, 1, 1))
    _plane(axes[0], d)
    _annulus(axes[1], d)
    handles = axes[0, 0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside upper left", ncols=3)
    for (a, b, c), letters, where in zip(axes, ("abc", "def"), ("plane", "annulus"), strict=True):
        _near_onset(c)
        for ax in (b, c):
            ax.axhline(0, color="0.6", lw=0.6)
            ax.axvline(ONSET, color=BLACK, lw=0.8, ls=":")
        b.set(xlabel=r"acceleration $\Gamma$", ylabel=r"drift $c_x$ (cm/s)", xlim=(1, None))
        b.legend(loc="lower right" if where == "plane" else "upper left", fontsize=6)
        for ax, letter, title in zip((a, b, c), letters, (where, "", "near onset"), strict=True):
            name_panel(ax, letter, title)
    figure.supxlabel(
        rf"plane: $l={LENGTH}\,d$, $d=0.6$ cm; annulus: the experiment's, $l=8\,d$, $d=0.635$ cm; "
        rf"60 Hz, $\mu={FRICTION}$, solid inertia;"
        f"\n{LAW_NAME}",
        fontsize=6.5,
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
    lines.append(
        "annulus: tilt; drift; V_z/V_0 of " + ", ".join(f"{n} rods" for n in d["ring_count"])
    )
    for i, gamma in enumerate(d["gamma"]):
        cells = (
            f"{'r-f'[d['ring_kind'][i, j] + 1]} {d['ring_tilt'][i, j]:4.1f};"
            f" {d['ring_c_x'][i, j]:7.4f}+-{d['ring_c_x_error'][i, j]:.4f};"
            f" {d['ring_V_z'][i, j]:5.2f}"
            for j in range(len(d["ring_count"]))
        )
        lines.append(f"{gamma:5.2f}  " + "  ".join(cells))
    return "\n".join(lines)
