"""What the paper fits, computed: mean plate velocity at landing, alpha = V_z/V_0, and the drift.

One spherocylinder l = 9.5 d at fixed tilt, epsilon = 0.65, mu = 0.3, exact flights and impacts,
omega = 0 before each impact; a hop below 0.01 periods is no landing. Bars: one standard error over
independent rods; where it is large, rods have settled on different orbits. (a)-(c) over tilt at
Gamma = 3.3, (b) with the density of flights in grey; (d)-(f) over Gamma.

Look at (b): flights change from longer and shorter ones to exactly one period at 34 to 35 degrees,
some degrees above the tilt X^2 = epsilon k^2 from which a stationary rod is hit again at once.
And at (d), (e): up to a gamma of about 1.6 alpha is negative and the drift at 20 and 40 degrees all
but gone, yet forward: a negative alpha alone does not make a rod go backwards. (At 9 degrees some
of the rods, thrown at the start, find orbits that never rest.) Dotted in (d): the perfectly
inelastic rod. Dotted in (e): where the paper's rods begin to drift forward.
"""

import matplotlib.pyplot as plt
import numpy as np

from impact import drift, spherocylinder

from ..lib.style import BLACK, BLUE, GREEN, RED, name_panel, style, tilt_axis

SETTING = {"friction": 0.3, "restitution": 0.65, "shortest_flight": 0.01}
GAMMA = 3.3
LENGTH = 9.5  # over the diameter
TILTS_DEG = (9, 20, 40)
EXPERIMENT = 1.6  # Gamma above which the paper's rods drift forward, Fig. 2(c, d)
FIELDS = ("alpha", "alpha_impulse", "drift", "flight", "rest", "again")


def _sweep(prefix: str, runs: list) -> dict[str, np.ndarray]:
    """Means and errors of several runs, one array a field."""
    arrays = {}
    for field in FIELDS:
        values = [getattr(run, field) for run in runs]
        arrays[f"{prefix}_{field}"] = np.array([value.mean for value in values])
        arrays[f"{prefix}_{field}_error"] = np.array([value.error for value in values])
    return arrays


def data(quick: bool = False) -> dict[str, np.ndarray]:
    """Sweeps over tilt [rad] and gamma; velocities in V_0, flights in periods."""
    from impact.bouncing import bounce  # compiles

    counts = {"rods": 30 if quick else 200, "landings": 200 if quick else 1000}

    def run(tilt, gamma):
        rod = spherocylinder(tilt, LENGTH)
        return bounce(rod, gamma=gamma, **SETTING, **counts, transient=200)

    tilts = np.radians(np.arange(0, 76, 5 if quick else 1))
    onset = np.geomspace(1e-3, 0.1, 4 if quick else 8)
    gammas = np.concatenate([1 + onset, np.arange(1.2, 5.01, 0.4 if quick else 0.1)])
    over_tilt = [run(tilt, GAMMA) for tilt in tilts]
    over_gamma = [[run(np.radians(deg), gamma) for gamma in gammas] for deg in TILTS_DEG]
    fine = np.concatenate([1 + np.geomspace(1e-4, 0.1, 30), np.linspace(1.11, np.hypot(1, np.pi))])
    upright = {"friction": 0.3, "restitution": 0.0, "landings": 1}
    inelastic = [bounce(spherocylinder(0.0, LENGTH), gamma=g, **upright).alpha.mean for g in fine]
    steady = drift(
        spherocylinder(tilts, LENGTH),
        friction=SETTING["friction"],
        restitution=SETTING["restitution"],
    )
    again = np.arcsin(
        np.sqrt(SETTING["restitution"])
        * spherocylinder(0.0, LENGTH).k
        / spherocylinder(np.pi / 2, LENGTH).X
    )
    by_tilt = [_sweep("gamma", runs) for runs in over_gamma]
    return {
        **{name: np.float64(value) for name, value in SETTING.items()},
        "length": np.float64(LENGTH),
        "gamma": np.float64(GAMMA),
        "tilt": tilts,
        **_sweep("tilt", over_tilt),
        "tilt_flights": np.array([each.flights.mean for each in over_tilt]),
        "steady_c_x": steady.c_x,
        "again_tilt": again,
        "gammas": gammas,
        "gamma_tilt": np.radians(TILTS_DEG),
        **{name: np.array([each[name] for each in by_tilt]) for name in by_tilt[0]},
        "inelastic_gamma": fine,
        "inelastic_alpha": np.array(inelastic),
    }


BOX = {"frameon": True, "edgecolor": "none", "framealpha": 0.9, "borderpad": 0.2}
_BARS = {"fmt": "o-", "ms": 2, "lw": 0.8, "elinewidth": 0.6}


def _over_tilt(axes, d: dict[str, np.ndarray]) -> None:
    tilt_deg, again = np.degrees(d["tilt"]), np.degrees(d["again_tilt"])
    ax = axes[0]
    for name, colour, label in (
        ("alpha", BLUE, "every landing alike"),
        ("alpha_impulse", RED, "weighted by impulse"),
    ):
        mean, error = d[f"tilt_{name}"], d[f"tilt_{name}_error"]
        ax.errorbar(tilt_deg, mean, error, color=colour, label=label, **_BARS)
    ax.axhline(0.5, color=BLACK, lw=0.8, ls=":", label="Eq. (31): 1/2")
    ax.set(ylabel=r"$\alpha=\langle V_z\rangle/V_0$", ylim=(-1, 1.9), yticks=(-1, -0.5, 0, 0.5, 1))
    ax.axhline(0, color="0.5", lw=0.6)
    ax.legend(loc="upper right", **BOX)

    ax = axes[1]
    share = d["tilt_flights"].T / 16
    length = np.arange(len(share)) / 16
    shading = {"cmap": "Greys", "vmin": 0, "vmax": 1, "shading": "nearest", "rasterized": True}
    ax.pcolormesh(tilt_deg, length, np.sqrt(share), **shading)
    ax.errorbar(
        tilt_deg, d["tilt_flight"], d["tilt_flight_error"], color=BLUE, label="mean", **_BARS
    )
    ax.set(ylabel="flight (periods)", ylim=(0, 3.2))
    ax.text(again + 1.5, 2.6, rf"$X^2=\epsilon k^2$:" f"\n{again:.1f}°", va="center")
    ax.legend(loc="upper right", **BOX)

    ax = axes[2]
    ax.errorbar(
        tilt_deg, d["tilt_drift"], d["tilt_drift_error"], color=BLUE, label="computed", **_BARS
    )
    steady = d["steady_c_x"]
    label = r"(24), (27), computed $\alpha$"
    ax.plot(tilt_deg, steady * d["tilt_alpha_impulse"], "-", color=RED, label=label)
    ax.plot(tilt_deg, steady / 2, ":", color=BLACK, label=r"(24), (27), $\alpha=1/2$")
    ax.set(ylabel=r"drift / $V_0$", ylim=(0, 4.6))
    ax.legend(loc="upper right", **BOX)
    for ax in axes:
        tilt_axis(ax, 0, 75)
        ax.axvline(again, color=BLACK, lw=0.8, ls="--")


def _over_gamma(axes, d: dict[str, np.ndarray]) -> None:
    for i, colour in enumerate((GREEN, BLUE, RED)):
        label = rf"$\phi={np.degrees(d['gamma_tilt'][i]):.0f}$°"
        for ax, name in zip(axes, ("alpha_impulse", "drift", "rest"), strict=True):
            mean, error = d[f"gamma_{name}"][i], d[f"gamma_{name}_error"][i]
            ax.errorbar(d["gammas"], mean, error, color=colour, label=label, **_BARS)
    axes[0].plot(
        d["inelastic_gamma"], d["inelastic_alpha"], ":", color=BLACK, label=r"$\epsilon=0$"
    )
    axes[0].set(ylabel=r"$\alpha$, weighted by impulse", ylim=(-1.1, 1.1))
    axes[0].axhline(0, color="0.5", lw=0.6)
    axes[0].legend(loc="lower center", bbox_to_anchor=(0.48, 0))
    axes[1].set(ylabel=r"drift / $V_0$")
    axes[1].axhline(0, color="0.5", lw=0.6)
    axes[1].axvline(EXPERIMENT, color=BLACK, lw=0.8, ls=":")
    axes[1].text(EXPERIMENT - 0.08, 2.35, "exp.", ha="right", va="top", rotation=90)
    axes[2].set(ylabel="part of the time at rest", ylim=(-0.02, 1))
    for ax in axes:
        ax.set(xlabel=r"$\Gamma$", xlim=(0.9, 5.1), xticks=range(1, 6))


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 4.4))
    _over_tilt(axes[0], d)
    _over_gamma(axes[1], d)
    for letter, ax in zip("abcdef", axes.flat, strict=True):
        title = rf"$\Gamma={d['gamma']:g}$" if letter in "abc" else ""
        name_panel(ax, letter, title)
    return figure
