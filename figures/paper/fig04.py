"""Fig. 4: drift of rods in the annulus over tilt, acceleration, friction of walls and of the plate.

Means over independent starts; errors are the larger of those between and within the runs. (a): the
number of rods sets the tilt; without (full) and with (open) rotation about the rods' own axes;
squares: plane rows of the same rods without walls, reduced 2.5-fold, which is the paper's ratio;
dotted: the paper's maxima. (b): dotted: where the paper's rods begin to move. (c, d): drift, and
tilt (green), of 44 rods; the row of (d) is logarithmic but for its first point, no friction.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from md.sweep import Sweep

from ..claims.uncertainty import off_line
from ..lib import annulus_runs as ring
from ..lib.style import BLACK, BLUE, GREEN, ORANGE, RED, name_panel, style, tilt_axis

MAXIMA_DEG, ONSET, RATIO = (18, 35), 1.5, 2.5  # the paper's
PLANE_DEG = (5, 10, 15, 20, 25, 30, 35, 40, 45, 50)
FEW = (50, 44, 36)  # numbers of rods of (b)
WALL, PLATE = "contacts.wall.friction", "contacts.plate.friction"
FULL = {
    "count": [23, 26, 29, 32, *range(34, 57, 2)],
    "gamma": [1.2, 1.4, 1.6, 2.0, 3.0, 4.0],
    "wall": [0, 0.03, 0.1, 0.3, 0.5, 1.0],
    "plate": [0, 0.01, 0.03, 0.1, 0.3, 1.0],
    "plane": [*PLANE_DEG],
    "seeds": [1, 2, 3],
    "few_seeds": [1, 2],
    "periods": 400,  # a region of larger tilt (Fig. 5) takes hundreds to grow
}
QUICK = {
    "count": [23, 30, 36, 40, 44, 50, 54, 56],
    "gamma": [1.3, 1.6, 2.2, 3.3],
    "wall": [0, 0.1, 0.3, 1.0],
    "plate": [0, 0.03, 0.3, 1.0],
    "plane": [10, 20, 30, 40],
    "seeds": [1, 2],
    "few_seeds": [1, 2],
    "periods": 40,
}


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Over the number of rods, Gamma and the frictions; plane rows over tilt."""
    size = QUICK if quick else FULL
    seeds, periods = {"start.seed": size["seeds"]}, size["periods"]
    few = {"start.seed": size["few_seeds"]}
    over = {"rods.count": size["count"]}
    many = {"rods.count": ring.COUNT}
    accelerations = {"plate.acceleration": size["gamma"]}
    return {
        "still": ring.planned([over, seeds], periods),
        "rolling": ring.planned([over, seeds], periods, {"rods.rolling": True}),
        "gamma": ring.planned([accelerations, {"rods.count": [*FEW]}, few], periods),
        "wall": ring.planned([{WALL: size["wall"]}, few], periods, many),
        "plate": ring.planned([{PLATE: size["plate"]}, few], periods, many),
        "plane": ring.plane(size["plane"], periods, seeds),
    }


def data(quick: bool = False) -> dict[str, np.ndarray]:
    """Drifts in cm/s and tilts in degrees with their errors."""
    runs = sweeps(quick)
    axes = {"gamma": "plate.acceleration", "wall": WALL, "plate": PLATE}
    return {
        "count": runs["still"].values("rods.count"),
        "few": runs["gamma"].values("rods.count"),
        **{name: runs[name].values(key) for name, key in axes.items()},
        **{key: x for name, sweep in runs.items() for key, x in ring.measured(sweep, name).items()},
    }


BARS = {"ms": 3, "elinewidth": 0.7, "lw": 0.7}


def _over_tilt(ax: Axes, d: dict[str, np.ndarray]) -> None:
    looks = {
        "still": {"fmt": "o-", "color": BLACK, "label": "rods do not roll"},
        "rolling": {"fmt": "o-", "color": RED, "mfc": "white", "label": "rods roll"},
        "plane": {"fmt": "s--", "color": BLUE, "label": f"plane row / {RATIO}"},
    }
    for name, look in looks.items():
        unit = RATIO if name == "plane" else 1
        bars = {"xerr": d[f"{name}_tilt_error"], "yerr": d[f"{name}_c_x_error"] / unit}
        ax.errorbar(d[f"{name}_tilt"], d[f"{name}_c_x"] / unit, **bars, **BARS, **look)
    for tilt in MAXIMA_DEG:
        ax.axvline(tilt, color="0.5", lw=0.8, ls=":")
    tilt_axis(ax, 0, 60)
    ax.legend(fontsize=6.5)


def _over_gamma(ax: Axes, d: dict[str, np.ndarray]) -> None:
    at = int(np.abs(d["gamma"] - ring.GAMMA).argmin())
    for i, colour in enumerate((BLUE, BLACK, ORANGE)):
        label = rf"$N={d['few'][i]}$, {d['gamma_tilt'][at, i]:.0f}° at {d['gamma'][at]:g}"
        shown = d["gamma"], d["gamma_c_x"][:, i], d["gamma_c_x_error"][:, i]
        ax.errorbar(*shown, fmt="o-", color=colour, label=label, **BARS)
    ax.axvline(ONSET, color="0.5", lw=0.8, ls=":")
    ax.set(xlabel=r"acceleration $\Gamma$", xlim=(1, None))
    ax.legend(fontsize=6.5, loc="upper left")


def _over_friction(ax: Axes, d: dict[str, np.ndarray], name: str) -> None:
    ax.errorbar(d[name], d[f"{name}_c_x"], d[f"{name}_c_x_error"], fmt="o-", color=BLACK, **BARS)
    beside = ax.twinx()
    look = {"fmt": "^--", "color": GREEN, "mfc": "white", **BARS}
    beside.errorbar(d[name], d[f"{name}_tilt"], d[f"{name}_tilt_error"], **look)
    beside.set_ylabel(r"tilt $\phi$ (deg)", color=GREEN)
    beside.set_ylim(0, 1.5 * np.nanmax(d[f"{name}_tilt"]))
    beside.tick_params(colors=GREEN)


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, axes = plt.subplots(2, 2, figsize=(7.0, 4.9))
    (a, b), (c, e) = axes
    _over_tilt(a, d)
    _over_gamma(b, d)
    _over_friction(c, d, "wall")
    _over_friction(e, d, "plate")
    c.set(xlabel=r"friction of the walls $\mu_{rw}$", ylim=(0, None))
    smallest = d["plate"][d["plate"] > 0].min()
    e.set_xscale("symlog", linthresh=smallest, linscale=0.4)
    e.set(xlabel=r"friction of the plate $\mu_{rb}$ (0 at the left end)")
    e.set_xlim(-smallest / 4, 1.2 * d["plate"].max())
    many = rf"$N={ring.COUNT}$, $\Gamma={ring.GAMMA}$"
    titles = (rf"$\Gamma={ring.GAMMA}$", "", many, many)
    for ax, letter, title in zip(axes.flat, "abcd", titles, strict=True):
        ax.axhline(0, color="0.7", lw=0.6)
        ax.set_ylabel(r"drift $c_x$ (cm/s)")
        name_panel(ax, letter, title)
    figure.supxlabel(ring.SAID, fontsize=6.5)
    return figure


def shape(tilt: np.ndarray, c_x: np.ndarray) -> dict[str, float]:
    """What Fig. 4(a) is said to show, as numbers.

    early, late : tilts of the largest drift below and beyond the middle of the paper's two maxima
    dip : by which part the lowest drift between them is less than the smaller of the two; 0 if
        there is no slowdown
    bend, slope : rms distance from a straight line up to the paper's first maximum, over the mean
        there; slope of that line, in cm/s a degree
    end : drift at the largest tilt over the largest drift
    """
    order = np.argsort(tilt)
    tilt, c_x = tilt[order], c_x[order]
    late = tilt > np.mean(MAXIMA_DEG)
    i, j = (int(np.argmax(np.where(side, c_x, -np.inf))) for side in (~late, late))
    lowest, smaller = c_x[i : j + 1].min(), min(c_x[i], c_x[j])
    small = tilt <= MAXIMA_DEG[0]
    bend, slope = np.nan, np.nan
    if small.sum() > 2:
        slope = np.polyfit(tilt[small], c_x[small], 1)[0]
        bend = off_line(tilt[small], c_x[small]) / c_x[small].mean()
    return {
        "early": float(tilt[i]),
        "late": float(tilt[j]),
        "dip": float(1 - lowest / smaller),
        "bend": float(bend),
        "slope": float(slope),
        "end": float(c_x[-1] / c_x.max()),
    }


def summary(d: dict[str, np.ndarray]) -> str:
    """The shape of (a), and the curves."""
    lines = ["Fig. 4. drift in cm/s, tilt in deg, +- one s.e."]
    for name in ("still", "rolling"):
        found = shape(d[f"{name}_tilt"], d[f"{name}_c_x"])
        lines.append(f"{name}: " + ", ".join(f"{key} {value:.3f}" for key, value in found.items()))

    def cell(name: str, *at) -> str:
        return f"{d[name][at]:7.3f} +- {d[f'{name}_error'][at]:.3f}"

    lines.append("rods: tilt, drift without and with rolling")
    for i, n in enumerate(d["count"]):
        cells = (
            cell(name, i) for name in ("still_tilt", "still_c_x", "rolling_tilt", "rolling_c_x")
        )
        lines.append(f"  {n:4d} " + " ".join(cells))
    lines.append(f"Gamma: drift of {', '.join(map(str, d['few']))} rods")
    for i, gamma in enumerate(d["gamma"]):
        lines.append(f"  {gamma:4g} " + " ".join(cell("gamma_c_x", i, j) for j in range(3)))
    for name in ("wall", "plate"):
        lines.append(f"friction of the {name}: tilt, drift")
        for i, mu in enumerate(d[name]):
            lines.append(f"  {mu:4g} {cell(f'{name}_tilt', i)} {cell(f'{name}_c_x', i)}")
    lines.append("plane row: tilt, drift")
    lines += [
        f"  {cell('plane_tilt', i)} {cell('plane_c_x', i)}" for i in range(len(d["plane_c_x"]))
    ]
    return "\n".join(lines)
