"""Fig. 13: drift of the row over tilt, over the plate's acceleration and over the rods' length.

Symbols: simulated rows, mean and standard error over independent starts; as in the paper, rods have
the inertia of a thin rod in (a) and (b), of the uniform body in (c). Lines: the theory's drift
(24)-(29) for the rod without thickness and for the simulated one, with the assumed V_z = V_0/2 and
with the V_z that the same runs have at touches, weighted by the speed of approach, where it is
positive (else the closure has no impact). Triangles in (a): the same rows under another contact
law. Inset of (b): tilt.
Open in (c): started side by side almost at rest, rods of 2 to 5 d bounce as one block, which
hardly drifts; those thrown at the start do not.
"""

import numpy as np
from matplotlib.figure import Figure

from impact import InputError, drift, spherocylinder, thin_rod

from ..lib.runs import (
    BOX,
    BOX_TILT,
    COUNT,
    FRICTION,
    GAMMA,
    LAW_NAME,
    LENGTH,
    RESOLVED,
    RESTITUTION,
    SECOND,
    SETTING,
    Sweeps,
    means,
    paper_rod,
    periods_of,
    planned,
    plate_speed_cm_s,
    starts,
    tilt_plan,
    tilts,
)
from ..lib.style import (
    ANOTHER,
    ORANGE,
    RIGID,
    THEORY,
    Data,
    Look,
    curve,
    legend_above,
    note,
    painted,
    style,
    tilt_axis,
    zero_line,
)
from .fig02 import AT_TOUCH

BOX_OF_LENGTHS, GAMMA_OF_LENGTHS = 41.4, 2.5  # panel (c)
GAMMAS = [1.02, 1.05, 1.1, 1.15, 1.2, 1.3, 1.4, 1.6, 1.8, 2, 2.5, 3, 3.3, 4, 5]
ROD_LENGTHS = [1, 1.1, 1.25, 1.5, 1.75, 2, 2.5, 3, 4, 5, 6.5, 8, 9.5, 12]


def sweeps(quick: bool = False) -> Sweeps:
    """Sweeps over tilt, Gamma, length; over length from rest; over tilt by a second law."""
    gamma = [1.05, 1.2, 1.4, 1.6, 2, 3, 4] if quick else GAMMAS
    length = [1.25, 1.5, 2, 3, 9.5] if quick else ROD_LENGTHS
    jammed = [2.5, 3] if quick else [2, 2.5, 3, 4, 5, 6.5]
    periods, seeds = periods_of(quick), starts(2 if quick else 4)
    row = {
        "box.length": BOX_OF_LENGTHS,
        "plate.acceleration": GAMMA_OF_LENGTHS,
        "rods.inertia": "solid",
    }
    return {
        "tilt": tilt_plan(quick),
        "gamma": planned([{"plate.acceleration": gamma}, seeds], periods),
        "length": planned([{"rods.length": length}, seeds], periods, row),
        "jammed": planned(
            [{"rods.length": jammed}, starts(2)], periods, row | {"start.speed": 1e-3}
        ),
        "second": tilt_plan(quick, SECOND | RESOLVED, seeds=seeds),
    }


def data(
    quick: bool = False,
    friction: float = FRICTION,
    restitution: float = RESTITUTION,
    length: float = LENGTH,
) -> Data:
    """Measured rows and the theory beside them; of one's own values the theory alone. cm/s."""
    if friction == 0:
        raise InputError("friction must be > 0, else no drift is determined; got 0")
    setting = {"friction": friction, "restitution": restitution}
    words = rf"theory: $\epsilon={restitution:g}$, $\mu={friction:g}$, (a, b) $l={length:g}\,d$"
    runs = sweeps(quick)
    of_rods = {}  # drift [cm/s], tilt [deg] and V_z/V_0 of the rows, by sweep
    if (setting, length) == (SETTING, LENGTH):
        words = f"row: {LAW_NAME}; {words}"
        of_rods["jammed_length"] = runs["jammed"].values("rods.length")
        for name, sweep in runs.items():
            names = {f"{name}_c_x": "c_x_cm_s", f"{name}_tilt": "tilt_deg", f"{name}_V_z": AT_TOUCH}
            of_rods |= means(sweep, names)
    tilt_deg, gamma = tilts(quick), runs["gamma"].values("plate.acceleration")
    lengths = runs["length"].values("rods.length")
    fine, fine_length = np.radians(np.linspace(0.5, 89.5, 357)), np.linspace(1, lengths[-1], 200)
    fixed_tilt = np.arccos(COUNT / BOX_OF_LENGTHS)

    def c_x(rod):
        return drift(rod, **setting).c_x  # over V_z

    return {
        "tilt_deg": tilt_deg,
        "gamma": gamma,
        "length": lengths,
        "words": words,
        **of_rods,
        "speed": plate_speed_cm_s(),
        "speed_b": plate_speed_cm_s(gamma),
        "speed_c": plate_speed_cm_s(GAMMA_OF_LENGTHS),
        "fine": fine,
        "thin": c_x(thin_rod(fine)),
        "thick": c_x(paper_rod(fine, length)),
        "thick_at_tilts": c_x(paper_rod(np.radians(tilt_deg), length)),
        "thick_at_box": c_x(paper_rod(BOX_TILT, length)),
        "thin_at_box": c_x(thin_rod(BOX_TILT)),
        "fine_length": fine_length,
        "thick_of_length": c_x(spherocylinder(fixed_tilt, fine_length)),
        "thick_at_lengths": c_x(spherocylinder(fixed_tilt, lengths)),
    }


MEASURED: Look = {"color": RIGID, "marker": "s", "ms": 2.5, "lw": 0.8}  # theory, V_z as measured


def _over_tilt(ax, d):
    fine_deg, half = np.degrees(d["fine"]), d["speed"] / 2
    ax.plot(fine_deg, half * d["thin"], color=THEORY, label=r"theory, thin, $V_0/2$")
    ax.plot(fine_deg, half * d["thick"], "--", color=ORANGE, label=r"theory, $l$, $V_0/2$")
    tilt_axis(ax, step=30, ylabel=r"drift $c_x$ (cm/s)")
    if "tilt_c_x" not in d:
        return
    curve(ax, d, "tilt_tilt", "tilt_c_x", label="simulated", form="o")
    words = "simulated, another contact law"
    curve(ax, d, "second_tilt", "second_c_x", ANOTHER, words, hollow=True, form="^")
    measured = d["thick_at_tilts"] * d["tilt_V_z"] * d["speed"]
    ax.plot(d["tilt_deg"], measured, label=r"theory, $l$, measured $V_z$", **MEASURED)
    ax.set_ylim(-0.5, 1.1 * max(np.nanmax(measured), 15))


def _over_gamma(ax, d):
    gamma, speed = d["gamma"], d["speed_b"]
    ax.plot(gamma, d["thin_at_box"] * speed / 2, color=THEORY)
    ax.plot(gamma, d["thick_at_box"] * speed / 2, "--", color=ORANGE)
    ax.set(xlabel=r"acceleration $\Gamma$", xlim=(1, None))
    if "gamma_c_x" not in d:
        return
    curve(ax, d, "gamma", "gamma_c_x", form="o")
    rising = np.where(d["gamma_V_z"] > 0, d["gamma_V_z"], np.nan)  # else the closure has no impact
    ax.plot(gamma, d["thick_at_box"] * rising * speed, **MEASURED)
    fit = fits(d)
    x = np.array([fit["line_start"], gamma[-1]])
    ax.plot(x, fit["line_slope"] * (x - fit["line_from"]), color="0.5", label="fit from 2 on")
    ax.legend(loc="upper right")
    ax.set_ylim(-0.5, 2.2 * np.nanmax(d["gamma_c_x"]))
    inset = ax.inset_axes([0.2, 0.62, 0.25, 0.22])
    curve(inset, d, "gamma", "gamma_tilt", ms=2, form="o")
    nominal = np.degrees(BOX_TILT)
    inset.axhline(nominal, color="0.5", lw=0.6)
    inset.set(ylim=(nominal - 3, nominal + 3), xlim=(1, None))
    inset.set_title("tilt (deg)", pad=2)


def _over_length(ax, d):
    ax.plot(d["fine_length"], d["thick_of_length"] * d["speed_c"] / 2, "--", color=ORANGE)
    ax.set(xlabel=r"length $l/d$", xlim=(0.5, None))
    if "length_c_x" not in d:
        return
    curve(ax, d, "length", "length_c_x", form="o")
    curve(ax, d, "jammed_length", "jammed_c_x", label="from rest", hollow=True, form="o")
    measured = d["thick_at_lengths"] * d["length_V_z"] * d["speed_c"]
    ax.plot(d["length"], measured, **MEASURED)
    ax.set_ylim(-0.4, 1.4 * np.nanmax(measured))
    ax.legend(loc="upper right")


@style
def draw(d: Data) -> Figure:
    panels = {
        rf"$\Gamma={GAMMA}$": _over_tilt,
        rf"$L={BOX:g}\,d$": _over_gamma,
        rf"$L={BOX_OF_LENGTHS}\,d$, $\Gamma={GAMMA_OF_LENGTHS}$": _over_length,
    }
    figure = painted(d, panels, 3.4)
    for ax in figure.axes:
        zero_line(ax)
    legend_above(figure, figure.axes[0], ncols=3)
    note(figure, rf"$N={COUNT}$, $d=0.6$ cm, 60 Hz; {d['words']}")
    return figure


def _slope(x: np.ndarray, y: np.ndarray, error: np.ndarray) -> tuple[float, float, float]:
    """Slope of a line fitted by the errors, its standard error, and where it meets zero."""
    (slope, at), cover = np.polyfit(x, y, 1, w=1 / error, cov="unscaled")
    residual = ((slope * x + at - y) / error) ** 2
    scale = max(residual.sum() / (len(x) - 2), 1.0)  # where the line does not fit
    return slope, np.sqrt(cover[0, 0] * scale), -at / slope


def fits(d: Data) -> Data:
    """What the paper says of the drift over Gamma, as numbers.

    power : exponent of c_x over Gamma - 1 below 1.5; line_ : c_x(Gamma) from 2 on
    """
    gamma, c_x = d["gamma"], d["gamma_c_x"]
    error = d["gamma_c_x_error"]
    near = (gamma < 1.5) & (c_x > 3 * error)
    far = (gamma >= 2) & np.isfinite(c_x)
    power, power_error = np.nan, np.nan
    if near.sum() >= 3:
        relative = np.fmax(error / np.abs(c_x), 0.02)[near]
        power, power_error, _ = _slope(np.log(gamma[near] - 1), np.log(c_x[near]), relative)
    certain = np.fmax(error[far], 0.01 * np.abs(c_x[far]).max())
    slope, slope_error, start = _slope(gamma[far], c_x[far], certain)
    return {
        "power": power,
        "power_error": power_error,
        "line_start": gamma[far][0],
        "line_slope": slope,
        "line_slope_error": slope_error,
        "line_from": start,
    }
