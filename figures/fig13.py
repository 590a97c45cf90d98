"""Fig. 13: drift of the row over tilt, over the plate's acceleration and over the rods' length.

Symbols: simulated rows, mean and standard error over independent starts. Lines: the theory's drift
(24)-(29) for the thin rod and for the spherocylinder, with the assumed V_z = V_0/2 and with the V_z
that the same runs have at their landings.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from impact import drift, spherocylinder, thin_rod

from .rows import (
    COUNT,
    FRICTION,
    GAMMA,
    LAW_NAME,
    LENGTH,
    RESTITUTION,
    boxes,
    over_seeds,
    plate_speed_cm_s,
    store,
    swept,
)
from .shared import BLACK, BLUE, GREEN, ORANGE, RED, name_panel, style, tilt_axis

BOX, BOX_OF_LENGTHS, GAMMA_OF_LENGTHS = 43.0, 41.4, 2.5  # panels (b) and (c)


def _measured(sweep, prefix: str) -> dict[str, np.ndarray]:
    """Drift [cm/s], tilt [deg] and V_z/V_0 with their errors."""
    names = ("c_x_cm_s", "tilt_deg", "landings.plate_velocity_by_speed.mean")
    found = {}
    for name, values in zip(("c_x", "tilt", "V_z"), sweep.gather(store(), *names), strict=True):
        found[f"{prefix}_{name}"], found[f"{prefix}_{name}_error"] = over_seeds(values)
    return found


def data(quick: bool = False) -> dict[str, np.ndarray]:
    """Measured rows and the theory beside them; velocities in cm/s."""
    tilt_deg = np.linspace(6, 75, 8) if quick else np.linspace(3, 78, 26)
    gamma = np.array([1.2, 1.6, 2, 3, 4, 5]) if quick else np.append(1.05, np.arange(1.2, 5.1, 0.2))
    length = np.array([1, 1.5, 2, 3, 5, 9.5]) if quick else np.array(
        [1, 1.1, 1.25, 1.5, 1.75, 2, 2.5, 3, 4, 5, 6.5, 8, 9.5, 12]
    )  # fmt: skip
    seeds = {"start.seed": [1, 2] if quick else [1, 2, 3, 4]}
    periods = 80 if quick else 600
    over_tilt = swept([{"box.length": boxes(tilt_deg)}, seeds], periods)
    over_gamma = swept([{"plate.acceleration": gamma.tolist()}, seeds], periods)
    over_length = swept(
        [{"rods.length": length.tolist()}, seeds],
        *(periods, {"box.length": BOX_OF_LENGTHS, "plate.acceleration": GAMMA_OF_LENGTHS}),
    )
    fine, fine_length = np.radians(np.linspace(0.5, 89.5, 357)), np.linspace(1, length[-1], 200)
    setting = {"friction": FRICTION, "restitution": RESTITUTION}
    fixed_tilt = np.arccos(COUNT / BOX_OF_LENGTHS)
    return {
        "tilt_deg": tilt_deg,
        "gamma": gamma,
        "length": length,
        "speed": plate_speed_cm_s(),
        "speed_b": plate_speed_cm_s(gamma),
        "speed_c": plate_speed_cm_s(GAMMA_OF_LENGTHS),
        **_measured(over_tilt, "a"),
        **_measured(over_gamma, "b"),
        **_measured(over_length, "c"),
        "fine": fine,
        "thin": drift(thin_rod(fine), **setting).c_x,  # over V_z
        "thick": drift(spherocylinder(fine, LENGTH), **setting).c_x,
        "thick_at_tilts": drift(spherocylinder(np.radians(tilt_deg), LENGTH), **setting).c_x,
        "thick_at_box": drift(spherocylinder(np.arccos(COUNT / BOX), LENGTH), **setting).c_x,
        "thin_at_box": drift(thin_rod(np.arccos(COUNT / BOX)), **setting).c_x,
        "fine_length": fine_length,
        "thick_of_length": drift(spherocylinder(fixed_tilt, fine_length), **setting).c_x,
        "thick_at_lengths": drift(spherocylinder(fixed_tilt, length), **setting).c_x,
    }


def _bars(ax: Axes, x: np.ndarray, d: dict, name: str, **look) -> None:
    ax.errorbar(x, d[name], d[f"{name}_error"], fmt="o", ms=3, elinewidth=0.7, **look)


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, (a, b, c) = plt.subplots(1, 3, figsize=(7.0, 2.9))
    half = d["speed"] / 2
    _bars(a, d["a_tilt"], d, "a_c_x", color=BLACK, label="simulated")
    a.plot(np.degrees(d["fine"]), half * d["thin"], color=RED, label=r"thin, $V_z=V_0/2$")
    a.plot(np.degrees(d["fine"]), half * d["thick"], "--", color=ORANGE, label=r"$l=9.5d$, $V_0/2$")
    measured = d["thick_at_tilts"] * d["a_V_z"] * d["speed"]
    a.plot(
        d["tilt_deg"], measured, "s-", color=BLUE, ms=2.5, lw=0.8, label=r"$l=9.5d$, measured $V_z$"
    )
    a.axhline(0, color="0.7", lw=0.6)
    tilt_axis(a, 0, 90, 30)
    a.set_ylabel(r"drift $c_x$ (cm/s)")
    a.legend(fontsize=5.5, loc="upper right")
    name_panel(a, "a", rf"$\Gamma={GAMMA}$")
    _bars(b, d["gamma"], d, "b_c_x", color=BLACK)
    b.plot(d["gamma"], d["thin_at_box"] * d["speed_b"] / 2, color=RED)
    b.plot(d["gamma"], d["thick_at_box"] * d["speed_b"] / 2, "--", color=ORANGE)
    b.plot(
        d["gamma"], d["thick_at_box"] * d["b_V_z"] * d["speed_b"], "s-", color=BLUE, ms=2.5, lw=0.8
    )
    b.axhline(0, color="0.7", lw=0.6)
    b.set(xlabel=r"acceleration $\Gamma$", xlim=(1, None))
    inset = b.inset_axes([0.2, 0.68, 0.36, 0.28])
    _bars(inset, d["gamma"], d, "b_tilt", color=GREEN)
    inset.axhline(np.degrees(np.arccos(COUNT / BOX)), color="0.5", lw=0.6)
    inset.set_ylabel(r"$\phi$ (deg)", fontsize=6)
    inset.tick_params(labelsize=5.5)
    name_panel(b, "b", rf"$L={BOX:g}\,d$")
    _bars(c, d["length"], d, "c_c_x", color=BLACK)
    c.plot(d["fine_length"], d["thick_of_length"] * d["speed_c"] / 2, "--", color=ORANGE)
    measured = d["thick_at_lengths"] * d["c_V_z"] * d["speed_c"]
    c.plot(d["length"], measured, "s-", color=BLUE, ms=2.5, lw=0.8)
    c.axhline(0, color="0.7", lw=0.6)
    c.set(xlabel=r"length $l/d$")
    name_panel(c, "c", rf"$L={BOX_OF_LENGTHS}\,d$, $\Gamma={GAMMA_OF_LENGTHS}$")
    figure.supxlabel(rf"$N={COUNT}$, $d=0.6$ cm, 60 Hz, $\mu={FRICTION}$; {LAW_NAME}", fontsize=7)
    return figure
