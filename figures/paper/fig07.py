"""Fig. 7: tips of rods over the plate at two tilts, and how long flights last.

(a), (b): lowest points of three rods of the row, and the plate (grey); the scales differ.
(c): flights over tilt, over independent starts. Dots: from touch to touch; squares: touches less
than 0.2 periods apart taken as one landing; line: one rigid rod at fixed tilt, exact flights and
impacts. Dotted: where the paper sees flights change from several periods to one.

Look at (a): all rods do the same, the row bounces as one block. And at (b): a rod is hit again and
again while the plate rises, which halves the mean from touch to touch.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from md.scene import from_tables, put

from ..lib.runs import along_lean, boxes, lone, means, row_of, tilt_plan, tilt_sweeps
from ..lib.style import (
    BLACK,
    DOTTED,
    RIGID,
    Data,
    curve,
    name_panels,
    note,
    shades,
    style,
    tilt_axis,
)
from ..pages import movie

TIP_TILTS_DEG, SHOWN_PERIODS, TRANSIENT, FRAMES = (9, 34), 6, 40, 64  # periods, pictures a period
RODS_DRAWN = 5 / 40, 18 / 40, 31 / 40  # parts of their number
CHANGE_DEG = 30.0  # the paper's
FLIGHT_MEANS = {
    "tilt_deg": "tilt_deg",
    "flight": "touches.flight_periods.mean",
    "landing_flight": "landings.flight_periods.mean",
}

sweeps = tilt_sweeps


def data(quick: bool = False, scene: str | None = None) -> Data:
    """Heights [cm] over time [periods]; flights [periods] over tilt."""
    row, heights = row_of(scene), []
    rods = row.scene.rods
    drawn = [int(part * rods.count) for part in RODS_DRAWN]
    for length in boxes(TIP_TILTS_DEG, rods.count):
        tilted = from_tables(put(row.tables, {"box.length": length, "start.seed": 1}))
        film = movie.record(tilted, TRANSIENT + SHOWN_PERIODS, FRAMES)
        late = film.time >= TRANSIENT
        heights.append(rods.diameter_cm * film.tips[late][:, drawn])
        time, plate = film.time[late] - TRANSIENT, rods.diameter_cm * film.plate[late]
    lone_deg, lone_flight = lone("flight", quick, scene)
    return {
        "time": time,
        "plate": plate,
        "tips": np.array(heights),  # (tilts, times, rods)
        **means(tilt_plan(quick, scene=scene), FLIGHT_MEANS, along_lean),
        "words": row.words,
        "lone_deg": lone_deg,
        "lone_flight": lone_flight,
    }


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplot_mosaic("ac;bc", figsize=(7.0, 4.6), width_ratios=(1.5, 1))
    a, b, c = (axes[letter] for letter in "abc")
    time, plate = d["time"], d["plate"]
    low, dashes = plate.min(), ("-", (0, (6, 6)), (0, (2, 4)))  # rods on one line: all show
    titles = []
    for ax, tips, tilt in zip((a, b), d["tips"], TIP_TILTS_DEG, strict=True):
        ax.fill_between(time, low - 0.05, plate, color="0.8", lw=0)
        ax.plot(time, plate, color="0.45", lw=0.8)
        ax.set_prop_cycle(color=shades(3), ls=dashes)
        ax.plot(time, tips)
        ax.set(
            xlabel="time (periods of the plate)",
            xlim=(0, SHOWN_PERIODS),
            ylabel="height (cm)",
            ylim=(low - 0.03, 1.1 * tips.max()),
        )
        apart = np.ptp(tips, axis=1).max() > 0.1 * np.ptp(tips)
        words = "" if apart else ", one on another"
        titles.append(rf"$\phi={tilt}$°, three rods{words}")
    c.plot(d["lone_deg"], d["lone_flight"], color=RIGID, lw=0.8, label="one rigid rod")
    curve(c, d, "tilt_deg", "flight", BLACK, "touch to touch")
    left_out = "hops < 0.2 periods left out"
    curve(c, d, "tilt_deg", "landing_flight", BLACK, left_out, form="s-", hollow=True)
    c.axhline(1, color="0.5", lw=0.6)
    c.axvline(CHANGE_DEG, **DOTTED, label="the paper: one period from here")
    top = 1.5 * max(d["lone_flight"].max(), np.nanmax(d["landing_flight"]))
    tilt_axis(c, 0, 80, 20, ylabel="mean flight (periods)", ylim=(0, top))
    c.legend(loc="upper right")
    name_panels((a, b, c), (*titles, "length of flights"))
    note(figure, d["words"])
    return figure
