"""A rod that is let go: how soon it falls, and its drift until then, beside the closure's.

The spherocylinder of the paper's Figs. 6-8 (l = 9.5 d, d = 0.6 cm, 60 Hz), epsilon = 0.65, mu =
0.3, bounces at held tilt and is then released; it keeps its spin from impact to impact. A colour
is a Gamma. (a) Tilt of single rods over time, where the tip lands and where the other end does,
which ends the fall: beyond 90 degrees if it comes down while the tip is in the air. The thin lines
only join the points of a rod. Dashed: let go at rest on a plate at rest. (b) Time of the fall,
median and 5th to 95th percentile (bands); dashed as in (a). (c) Drift until then against the
closure, which holds the tilt and with whose velocity the fall begins; the drift is that of the tip,
since the centre of a falling rod moves ahead of it without any drift.
"""

import matplotlib.pyplot as plt
import numpy as np

from impact import spherocylinder

from ..lib.runs import GAMMA, SETTING
from ..lib.style import BLACK, BLUE, GREEN, ORANGE, RED, Data, name_panels, points, style, tilt_axis
from ..lib.tables import columned

UNIT = 981 / (2 * np.pi * 60) ** 2  # g/Omega^2, cm
FALLING_ROD = {"length": 5.7 / UNIT, "diameter": 0.6 / UNIT}
FALL_GAMMAS = (1.5, GAMMA, 5.0)
COLOURS = (GREEN, BLUE, RED)  # of `FALL_GAMMAS` in all panels
STILL = 1e-6  # gamma of a plate all but at rest
SINGLE_DEG = (5, 20, 40)
SINGLES = 5  # rods drawn of each


def _tip_drift(tilt: float, run) -> tuple[float, float]:
    """Drift of the tip until the fall, mean over rods and standard error, in V_0."""
    reach = (FALLING_ROD["length"] - FALLING_ROD["diameter"]) / 2
    ahead = reach * (np.sin(run.tilt_end) - np.sin(tilt))
    drift = (run.travel - ahead / (2 * np.pi * GAMMA)) / run.time
    return drift.mean(), drift.std(ddof=1) / np.sqrt(drift.size)


def _second_landing(run) -> np.ndarray:
    """Medians of the tilt, rad, and of omega X over the speed at which the centre meets the plate.

    The first landing finds omega = 0, as every one does under the closure.
    """
    tilt, omega, c_z, phase = (column[:, 1] for column in (run.tilt, run.omega, run.c_z, run.phase))
    X = spherocylinder(np.nan_to_num(tilt), **FALLING_ROD).X
    share = omega * X / (GAMMA * (np.cos(phase) - c_z))
    return np.array([np.nanmedian(tilt), np.nanmedian(share)])


def data(quick: bool = False) -> Data:
    """Tilts [rad] and periods of single rods; percentiles of the time; drifts in V_0."""
    from impact.bouncing import bounce  # compiles
    from impact.falling import fall

    def release(tilt, gamma, rods, **limit):
        return fall(tilt, **FALLING_ROD, gamma=gamma, **SETTING, rods=rods, **limit)

    tilts, rods = np.radians(np.arange(5, 81, 15 if quick else 2.5)), 50 if quick else 200
    runs = [[release(tilt, gamma, rods) for tilt in tilts] for gamma in FALL_GAMMAS]
    how = {"gamma": GAMMA, **SETTING, "landings": 300, "rods": rods, "shortest_flight": 1e-3}
    held = [bounce(spherocylinder(tilt, **FALLING_ROD), **how).drift for tilt in tilts]
    single = {}
    for deg in SINGLE_DEG:
        tilt = np.radians(deg)
        run = release(tilt, GAMMA, rods)
        start, drawn = np.zeros((SINGLES, 1)), np.s_[:SINGLES, : run.landings[:SINGLES].max()]
        clock, end = np.cumsum(run.flight + run.rest, axis=1)[drawn], np.s_[:SINGLES, None]
        single[f"time_{deg}"] = np.hstack([start, clock, run.time[end]])
        single[f"tilt_{deg}"] = np.hstack([start + tilt, run.tilt[drawn], run.tilt_end[end]])
        single[f"second_{deg}"] = _second_landing(run)
        still = [release(tilt, STILL, 1, periods=upto) for upto in range(1, 20)]
        single[f"still_time_{deg}"] = np.array([0, *(run.time[0] for run in still)])
        single[f"still_tilt_{deg}"] = np.array([tilt, *(run.tilt_end[0] for run in still)])
    return {
        "tilt": tilts,
        "gamma": np.array(FALL_GAMMAS),
        "time": np.array([[np.percentile(run.time, (5, 50, 95)) for run in row] for row in runs]),
        "landings": np.array([[np.median(run.landings) for run in row] for row in runs]),
        "fallen": np.array([[run.fallen.mean() for run in row] for row in runs]),
        "still_time": np.array([release(tilt, STILL, 1).time[0] for tilt in tilts]),
        "drift": np.array(list(map(_tip_drift, tilts, runs[FALL_GAMMAS.index(GAMMA)]))),
        "held_drift": np.array(held),
        **single,
    }


def summary(d: Data) -> str:
    """Medians at GAMMA, and the second landings."""
    i = FALL_GAMMAS.index(GAMMA)
    columns = {"tilt (deg)": np.degrees(d["tilt"]), "landings": d["landings"][i]}
    columns |= {"periods to fall": d["time"][i, :, 1], "plate at rest": d["still_time"]}
    columns |= {"drift of the tip (V_0)": d["drift"][:, 0], "closure": d["held_drift"][:, 0]}
    lines = [f"{GAMMA = :g}", columned(columns)]
    for deg in SINGLE_DEG:
        tilt, share = d[f"second_{deg}"]
        landing = f"released at {deg} deg: second landing at {np.degrees(tilt):.0f} deg"
        lines.append(f"{landing}, omega X takes {100 * share:.0f} % off the approach")
    return "\n".join(lines)


@style
def draw(d: Data) -> plt.Figure:
    figure, axes = plt.subplots(1, 3, figsize=(7.0, 2.8))
    still = {"ls": "--", "color": BLACK, "lw": 1, "label": "at rest"}
    free = COLOURS[FALL_GAMMAS.index(GAMMA)]
    ax, mark = axes[0], {"color": free, "ms": 3, "mew": 0.7}
    for deg in SINGLE_DEG:
        for time, tilt in zip(d[f"time_{deg}"], np.degrees(d[f"tilt_{deg}"]), strict=True):
            *landed, fallen = zip(time[there := ~np.isnan(time)], tilt[there], strict=True)
            ax.plot(time[there], tilt[there], color=free, lw=0.5, alpha=0.4)
            ax.plot(*zip(*landed[1:], strict=True), "o", label="lands", **mark)
            ax.plot(*fallen, "o", mfc="white", label="has fallen", **mark)
        ax.plot(d[f"still_time_{deg}"], np.degrees(d[f"still_tilt_{deg}"]), **still)
    ax.set(xlabel="time (periods)", ylabel=r"tilt $\phi$ (deg)", xlim=(0, 15), ylim=(0, 105))
    ax.set_yticks(range(0, 91, 15))
    handles, labels = ax.get_legend_handles_labels()
    unlike = dict(zip(labels, handles, strict=True))
    ax.legend(unlike.values(), unlike.keys(), loc="lower right", handlelength=1.2, fontsize=6)

    ax, tilt_deg = axes[1], np.degrees(d["tilt"])
    for gamma, time, colour in zip(d["gamma"], d["time"], COLOURS, strict=True):
        ax.fill_between(tilt_deg, time[:, 0], time[:, 2], color=colour, alpha=0.15, lw=0)
        ax.plot(tilt_deg, time[:, 1], color=colour, label=rf"$\Gamma={gamma:g}$")
    ax.plot(tilt_deg, d["still_time"], **still)
    ax.set(ylabel="time to fall (periods)", ylim=(0, 16))
    ax.legend()

    ax = axes[2]
    looks = {"held_drift": (ORANGE, "closure: held"), "drift": (free, "free, its tip")}
    for name, (colour, label) in looks.items():
        points(ax, tilt_deg, *d[name].T, colour, label=label, ms=2)
    ax.axhline(0, color="0.5", lw=0.6)
    ax.set(ylabel=r"drift / $V_0$", ylim=(None, 1.4 * d["held_drift"].max()))
    ax.legend(loc="upper right")
    name_panels(axes, (rf"$\Gamma={GAMMA:g}$", "", rf"$\Gamma={GAMMA:g}$"))
    for ax in axes[1:]:
        tilt_axis(ax, 0, 80, 20)
    return figure
