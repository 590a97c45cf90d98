"""Fig. 13: drift of the row over tilt, over the plate's acceleration and over the rods' length.

Symbols: simulated rows, mean and standard error over independent starts; as in the paper, rods have
the inertia of a thin rod in (a) and (b), of the uniform body in (c). Lines: the theory's drift
(24)-(29) for the rod without thickness and for the simulated one, with the assumed V_z = V_0/2 and
with the V_z that the same runs have at their landings, where it is positive (else the closure has
no impact). Triangles in (a): the same rows under another contact law. Inset of (b): tilt.
Open in (c): started side by side almost at rest, rods of 2 to 5 d bounce as one block, which
hardly drifts; those thrown at the start do not.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from impact import drift, spherocylinder, thin_rod
from md.sweep import Sweep

from ..lib.runs import (
    BOX,
    COUNT,
    FRICTION,
    GAMMA,
    LAW_NAME,
    LENGTH,
    RESOLVED,
    SECOND,
    SEEDS,
    SETTING,
    means,
    paper_rod,
    periods_of,
    planned,
    plate_speed_cm_s,
    tilt_plan,
    tilts,
)
from ..lib.style import (
    BLUE,
    GREEN,
    ORANGE,
    RED,
    Data,
    curve,
    legend_above,
    name_panels,
    style,
    tilt_axis,
)
from .fig02 import AT_TOUCH

BOX_OF_LENGTHS, GAMMA_OF_LENGTHS = 41.4, 2.5  # panel (c)
GAMMAS = (1.02, 1.05, 1.1, 1.15, 1.2, 1.3, 1.4, 1.6, 1.8, 2, 2.5, 3, 3.3, 4, 5)
ROD_LENGTHS = (1, 1.1, 1.25, 1.5, 1.75, 2, 2.5, 3, 4, 5, 6.5, 8, 9.5, 12)


def _measured(sweep: Sweep, prefix: str) -> Data:
    """Drift [cm/s], tilt [deg] and V_z/V_0 with their errors."""
    alike = "touches.plate_velocity.mean"
    names = {"c_x": "c_x_cm_s", "tilt": "tilt_deg", "V_z": AT_TOUCH, "V_z_alike": alike}
    return means(sweep, {f"{prefix}_{name}": result for name, result in names.items()})


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Over tilt, over Gamma, over length, over length from rest, over tilt by a second law."""
    gamma = [1.05, 1.2, 1.4, 1.6, 2, 3, 4] if quick else [*GAMMAS]
    length = [1.25, 1.5, 2, 3, 9.5] if quick else [*ROD_LENGTHS]
    jammed = [2.5, 3] if quick else [2, 2.5, 3, 4, 5, 6.5]
    periods, two = periods_of(quick), {"start.seed": [1, 2]}
    seeds = two if quick else SEEDS
    row = {"box.length": BOX_OF_LENGTHS, "plate.acceleration": GAMMA_OF_LENGTHS}
    row |= {"rods.inertia": "solid"}
    return {
        "tilt": tilt_plan(quick),
        "gamma": planned([{"plate.acceleration": gamma}, seeds], periods),
        "length": planned([{"rods.length": length}, seeds], periods, row),
        "jammed": planned([{"rods.length": jammed}, two], periods, row | {"start.speed": 1e-3}),
        "second": tilt_plan(quick, SECOND | RESOLVED),
    }


def data(quick: bool = False) -> Data:
    """Measured rows and the theory beside them; velocities in cm/s."""
    runs = sweeps(quick)
    tilt_deg, gamma = tilts(quick), runs["gamma"].values("plate.acceleration")
    length, jammed = (runs[name].values("rods.length") for name in ("length", "jammed"))
    fine, fine_length = np.radians(np.linspace(0.5, 89.5, 357)), np.linspace(1, length[-1], 200)
    fixed_tilt = np.arccos(COUNT / BOX_OF_LENGTHS)
    return {
        "tilt_deg": tilt_deg,
        "gamma": gamma,
        "length": length,
        "speed": plate_speed_cm_s(),
        "speed_b": plate_speed_cm_s(gamma),
        "speed_c": plate_speed_cm_s(GAMMA_OF_LENGTHS),
        **_measured(runs["tilt"], "a"),
        **_measured(runs["gamma"], "b"),
        **_measured(runs["length"], "c"),
        "jammed_length": jammed,
        **_measured(runs["jammed"], "jammed"),
        **_measured(runs["second"], "second"),
        "fine": fine,
        "thin": drift(thin_rod(fine), **SETTING).c_x,  # over V_z
        "thick": drift(paper_rod(fine), **SETTING).c_x,
        "thick_at_tilts": drift(paper_rod(np.radians(tilt_deg)), **SETTING).c_x,
        "thick_at_box": drift(paper_rod(np.arccos(COUNT / BOX)), **SETTING).c_x,
        "thin_at_box": drift(thin_rod(np.arccos(COUNT / BOX)), **SETTING).c_x,
        "fine_length": fine_length,
        "thick_of_length": drift(spherocylinder(fixed_tilt, fine_length), **SETTING).c_x,
        "thick_at_lengths": drift(spherocylinder(fixed_tilt, length), **SETTING).c_x,
    }


POINTS, THIN = {"form": "o"}, {"marker": "s", "ms": 2.5, "lw": 0.8}


def _over_gamma(ax: Axes, d: Data) -> None:
    curve(ax, d, "gamma", "b_c_x", **POINTS)
    ax.plot(d["gamma"], d["thin_at_box"] * d["speed_b"] / 2, color=RED)
    ax.plot(d["gamma"], d["thick_at_box"] * d["speed_b"] / 2, "--", color=ORANGE)
    rising = np.where(d["b_V_z"] > 0, d["b_V_z"], np.nan)  # else the closure has no impact
    ax.plot(d["gamma"], d["thick_at_box"] * rising * d["speed_b"], color=BLUE, **THIN)
    fit = fits(d)
    x = np.array([fit["line_start"], d["gamma"][-1]])
    line = fit["line_slope"] * (x - fit["line_from"])
    ax.plot(x, line, color="0.5", label="fit from 2 on")
    ax.legend(loc="upper right", fontsize=6)
    ax.set(xlabel=r"acceleration $\Gamma$", xlim=(1, None))
    ax.set_ylim(-0.5, 2.2 * d["b_c_x"].max())
    inset = ax.inset_axes([0.14, 0.64, 0.25, 0.24])
    curve(inset, d, "gamma", "b_tilt", ms=2, **POINTS)
    nominal = np.degrees(np.arccos(COUNT / BOX))
    inset.axhline(nominal, color="0.5", lw=0.6)
    inset.set(ylim=(nominal - 3, nominal + 3), xlim=(1, None))
    inset.set_title(r"tilt (deg)", fontsize=6, pad=2)
    inset.tick_params(labelsize=5.5)


def _over_length(ax: Axes, d: Data) -> None:
    curve(ax, d, "length", "c_c_x", **POINTS)
    curve(ax, d, "jammed_length", "jammed_c_x", label="from rest", hollow=True, **POINTS)
    ax.plot(d["fine_length"], d["thick_of_length"] * d["speed_c"] / 2, "--", color=ORANGE)
    measured = d["thick_at_lengths"] * d["c_V_z"] * d["speed_c"]
    ax.plot(d["length"], measured, color=BLUE, **THIN)
    ax.set(xlabel=r"length $l/d$", ylim=(-0.4, 1.4 * measured.max()), xlim=(0.5, None))
    ax.legend(loc="upper right", fontsize=6)


@style
def draw(d: Data) -> plt.Figure:
    figure, (a, b, c) = plt.subplots(1, 3, figsize=(7.0, 3.0))
    fine_deg, half = np.degrees(d["fine"]), d["speed"] / 2
    curve(a, d, "a_tilt", "a_c_x", label="simulated", **POINTS)
    curve(a, d, "second_tilt", "second_c_x", GREEN, "the same, another law", hollow=True, form="^")
    a.plot(fine_deg, half * d["thin"], color=RED, label=r"theory, thin, $V_0/2$")
    a.plot(fine_deg, half * d["thick"], "--", color=ORANGE, label=r"theory, $l$, $V_0/2$")
    measured = d["thick_at_tilts"] * d["a_V_z"] * d["speed"]
    a.plot(d["tilt_deg"], measured, color=BLUE, label=r"theory, $l$, measured $V_z$", **THIN)
    tilt_axis(a, 0, 90, 30)
    a.set(ylabel=r"drift $c_x$ (cm/s)", ylim=(-0.5, 1.1 * max(measured.max(), 15)))
    _over_gamma(b, d)
    _over_length(c, d)
    third = rf"$L={BOX_OF_LENGTHS}\,d$, $\Gamma={GAMMA_OF_LENGTHS}$"
    name_panels((a, b, c), (rf"$\Gamma={GAMMA}$", rf"$L={BOX:g}\,d$", third))
    for ax in (a, b, c):
        ax.axhline(0, color="0.7", lw=0.6)
    legend_above(figure, a, ncols=3, fontsize=6.5)
    rods = rf"$N={COUNT}$, (a, b) $l={LENGTH}\,d$, $d=0.6$ cm"
    figure.supxlabel(rf"{rods}, 60 Hz, $\mu={FRICTION}$; {LAW_NAME}")
    return figure


def _slope(x: np.ndarray, y: np.ndarray, error: np.ndarray) -> tuple[float, float, float]:
    """Slope, its standard error, and where the line meets zero; weights of the errors."""
    weight = 1 / np.fmax(error, 0.01 * np.abs(y).max())
    (slope, at), cover = np.polyfit(x, y, 1, w=weight, cov="unscaled")
    residual = (weight * (slope * x + at - y)) ** 2
    scale = max(residual.sum() / max(len(x) - 2, 1), 1.0)  # where the line does not fit
    return float(slope), float(np.sqrt(cover[0, 0] * scale)), float(-at / slope)


def fits(d: Data) -> dict[str, float]:
    """What the paper says of the drift over Gamma, as numbers.

    power : exponent of c_x over Gamma - 1 below 1.5; line_ : c_x(Gamma) from 2 on
    """
    gamma, c_x = d["gamma"], d["b_c_x"]
    near = (gamma < 1.5) & (c_x > 3 * d["b_c_x_error"])
    far = gamma >= 2
    power, power_error = np.nan, np.nan
    if near.sum() >= 3:
        relative = np.fmax(d["b_c_x_error"] / np.abs(c_x), 0.02)[near]
        x, y = np.log(gamma[near] - 1), np.log(c_x[near])
        power, power_error, _ = _slope(x, y, relative)
    line = _slope(gamma[far], c_x[far], d["b_c_x_error"][far])
    found = {"power": power, "power_error": power_error, "line_start": float(gamma[far][0])}
    return found | dict(zip(("line_slope", "line_slope_error", "line_from"), line, strict=True))
