"""How large a row is large enough: its drift over the number of rods, at equal density.

Box and rods grow together, so that the rods can lean alike. Starts times periods fall as the rods
grow in number: all sizes take about as long, and their errors are alike. (a) Drift over that of the
largest row, with standard errors of the quotient; grey: a part of it that counts as alike. (b)
Standard deviation of the tilts of a row's rods among each other, mean over time; dotted: beyond it
the row has separated into two tilts, most rods and a stretch of some thirty that lean much more;
its mean tilt falls, its drift does not change.
"""

import numpy as np
from matplotlib.figure import Figure

from ..lib.runs import (
    GAMMA,
    LAW_NAME,
    LENGTH,
    Sweeps,
    boxes,
    gathered,
    larger_error,
    over_seeds,
    planned,
    starts,
    with_error,
)
from ..lib.style import FAINT, Data, legend_above, note, painted, points, shades, style
from .row_motion import averaged

NEAR = 0.05  # part of the largest row's drift
SEPARATED_DEG = 3.0  # spread of tilts of a row that has separated
SIZE_TILTS_DEG = {True: (28,), False: (15, 28, 45)}
PLANS = {  # rods: starts, periods
    True: {5: (2, 120), 10: (2, 60), 20: (2, 30)},
    False: {10: (4, 4800), 20: (4, 2400), 40: (4, 1200), 80: (2, 1200), 160: (2, 600)},
}
FORMS = "o-", "s-", "^-"  # of the tilts


def sweeps(quick: bool = False) -> Sweeps:
    """Sweeps of rows over tilt, one for each number of rods."""
    return {
        str(count): planned(
            [{"box.length": boxes(SIZE_TILTS_DEG[quick], count)}, starts(seeds)],
            periods,
            {"rods.count": count},
            measure=averaged,
        )
        for count, (seeds, periods) in PLANS[quick].items()
    }


def data(quick: bool = False) -> Data:
    """Drift [cm/s] and spread of tilts [deg], (sizes, tilts) each, with standard errors."""
    rows = sweeps(quick).values()
    half = (LENGTH - 1) / 2  # the spread of tilts is stored as a length
    drifts = [larger_error(*gathered(row, "c_x", "c_x_stderr")) for row in rows]
    spreads = [over_seeds(np.degrees(gathered(row, "tilt_spread")[0] / half)) for row in rows]
    return {
        "count": np.array([*PLANS[quick]]),
        "nominal_deg": np.array(SIZE_TILTS_DEG[quick], float),
        **with_error("c_x", *np.stack(drifts, axis=1)),
        **with_error("spread_deg", *np.stack(spreads, axis=1)),
    }


def over_largest(d: Data) -> tuple[np.ndarray, np.ndarray]:
    """Drift over that of the largest row, with the standard error of the quotient."""
    last, last_error = d["c_x"][-1], d["c_x_error"][-1]
    part = d["c_x"] / last
    error = np.hypot(d["c_x_error"], part * last_error) / np.abs(last)
    error[-1] = np.nan  # of 1, which is exact
    return part, error


def _over_count(ax, d, y: np.ndarray, error: np.ndarray):
    """Draw an array (sizes, tilts) over the number of rods, a line for each tilt."""
    tilts = d["nominal_deg"]
    looks = zip(tilts, y.T, error.T, shades(len(tilts)), FORMS, strict=False)
    for tilt, values, errors, colour, form in looks:
        points(ax, d["count"], values, errors, colour, form=form, label=f"{tilt:g}°")
    ax.set(xscale="log", xlabel="number of rods")
    ax.set_xticks(d["count"], d["count"], minor=False)
    ax.set_xticks([], minor=True)


def _draw_drift(ax, d):
    ax.axhspan(1 - NEAR, 1 + NEAR, color="0.9", lw=0)
    _over_count(ax, d, *over_largest(d))
    ax.set(ylabel=r"$c_x$ / largest row's")


def _draw_spread(ax, d):
    _over_count(ax, d, d["spread_deg"], d["spread_deg_error"])
    ax.axhline(SEPARATED_DEG, **FAINT)
    ax.set(ylabel="spread of tilts (deg)", yscale="log")


@style
def draw(d: Data) -> Figure:
    panels = {
        "drift over the largest row's": _draw_drift,
        "rods that lean unlike": _draw_spread,
    }
    figure = painted(d, panels, 4.4, 3.4, rows=2, sharex=True)
    top, _ = figure.axes
    top.set_xlabel("")
    legend_above(figure, top, ncols=3)
    note(figure, rf"$l={LENGTH}\,d$, $\Gamma={GAMMA}$, 60 Hz; {LAW_NAME}")
    return figure
