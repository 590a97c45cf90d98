"""The row at small tilts, where it has several states: one block, a zig-zag, single rods.

In a block all rods go up and down together; in a zig-zag neighbours depart from the row's mean by
turns to either side, in height or in tilt; else the rods move by themselves, or in groups. The rule
for each part of a run: a zig-zag if neighbours' departures are opposite and large enough to be
seen, else a block if nearly all of the vertical motion is common to all rods, else single rods. A
run's state is the one of most parts of its second half. Runs begin with rods side by side, with
small or with large random velocities, on the plate or dropped on it.

(a) Drift over tilt, both as measured in the second half, a symbol a run, with standard errors;
open: the state changed in that half. (b) Share of the vertical motion that is common to all rods
over time, a line a run, coloured by state, at the tilt where the runs differ most in state; dotted:
limit of the rule.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from md.sweep import Sweep

from ..lib.runs import (
    COUNT,
    GAMMA,
    LAW_LINES,
    LENGTH,
    boxes,
    gathered,
    planned,
)
from ..lib.style import BLUE, GREEN, RED, Data, legend_above, painted, points, style
from .row_motion import followed

STATES = "block", "zig-zag", "single rods"
BLOCK, ZIGZAG, SINGLE = range(3)
STATE_RULES = {
    "common": 0.9,  # share of the vertical motion from which on a row is a block
    "order": -0.5,  # correlation of neighbours up to which they stand by turns
    "spread": 0.01,  # departures [d] from which on they are seen
}
LOOKS = ((BLUE, "s"), (GREEN, "^"), (RED, "o"))  # of the states
SMALL_TILTS_DEG = {True: (5, 9), False: (3, 5, 7, 9, 11, 14)}
STARTS = {  # largest component of a velocity, height over the plate
    "still": (1e-3, 0.0),
    "fast": (0.3, 0.0),
    "dropped": (0.3, 1.0),
    "dropped from high": (0.3, 3.0),
}
SEEDS_AND_PERIODS = {True: ((1,), 40), False: ((1, 2), 1000)}
FOLLOWED = "common", "height_spread", "height_order", "tilt_spread", "tilt_order"


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Rows over tilt, start and seed."""
    seeds, periods = SEEDS_AND_PERIODS[quick]
    speed, drop = map(list, zip(*STARTS.values(), strict=True))
    axes = [
        {"box.length": boxes(SMALL_TILTS_DEG[quick])},
        {"start.speed": speed, "start.drop": drop},
        {"start.seed": [*seeds]},
    ]
    return {"starts": planned(axes, periods, measure=followed)}


def states(d: Data) -> np.ndarray:
    """Index into `STATES` of each part of a run by `STATE_RULES`; -1 where a run is missing.

    Parameters
    ----------
    d : arrays of one shape by the names of `FOLLOWED`
    """
    zigzag = np.zeros(np.shape(d["common"]), bool)
    for name in ("height", "tilt"):
        by_turns = d[f"{name}_order"] <= STATE_RULES["order"]
        zigzag |= by_turns & (d[f"{name}_spread"] >= STATE_RULES["spread"])
    block = d["common"] >= STATE_RULES["common"]
    found = np.select([zigzag, block], [ZIGZAG, BLOCK], SINGLE)
    return np.where(np.isfinite(d["common"]), found, -1)


def settled(state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """State of most parts of the second half of each run, and whether it changed in that half.

    Parameters
    ----------
    state : (..., parts), from `states`
    """
    late = state[..., state.shape[-1] // 2 :]
    most = np.stack([(late == each).sum(axis=-1) for each in range(len(STATES))]).argmax(axis=0)
    return np.where(late[..., 0] < 0, -1, most), (late != late[..., :1]).any(axis=-1)


def data(quick: bool = False) -> Data:
    """Runs along tilt, start, seed: how rods move and the states over time; drift of the end."""
    sweep = sweeps(quick)["starts"]
    names = (*FOLLOWED, "c_x", "tilt_deg", "middle", "late_c_x_stderr")
    found = dict(zip(names, gathered(sweep, *names), strict=True))
    state = states(found)
    of_run, changed = settled(state)
    half = state.shape[-1] // 2
    return {
        "nominal_deg": np.array(SMALL_TILTS_DEG[quick], float),
        "start": np.array([*STARTS]),
        **{name: found[name] for name in FOLLOWED},
        "middle": np.nanmax(found["middle"].reshape(-1, state.shape[-1]), axis=0),
        "state_over_time": state,
        "state": of_run,
        "changed": changed.astype(int),
        **{name: found[name][..., half:].mean(axis=-1) for name in ("c_x", "tilt_deg")},
        "c_x_error": found["late_c_x_stderr"],
    }


def most_mixed(state: np.ndarray) -> int:
    """Index of the tilt at which most runs are not in the commonest state; the first of equals.

    Parameters
    ----------
    state : (tilts, ...), of each run
    """
    runs = state.reshape(len(state), -1)
    of_each = [[(row == each).sum() for each in range(len(STATES))] for row in runs]
    return int(np.argmax([sum(counts) - max(counts) for counts in of_each]))


def _draw_drift(ax: Axes, d: Data) -> None:
    for each, (colour, form) in enumerate(LOOKS):
        for changed in (0, 1):
            some = (d["state"] == each) & (d["changed"] == changed)
            label = None if changed else STATES[each]
            what = (d[name][some] for name in ("tilt_deg", "c_x", "c_x_error"))
            points(ax, *what, colour, form=form, label=label, hollow=bool(changed))
    ax.axhline(0, color="0.6", lw=0.6)
    ax.set(xlabel=r"tilt $\phi$ (deg)", ylabel=r"drift $c_x$ (cm/s)")


def _draw_time(ax: Axes, d: Data) -> None:
    shown = most_mixed(d["state"])
    runs, every = d["common"][shown].reshape(-1, len(d["middle"])), max(len(d["middle"]) // 10, 1)
    for common, each in zip(runs, d["state"][shown].ravel(), strict=True):
        colour, form = LOOKS[each]
        ax.plot(d["middle"], common, f"{form}-", color=colour, ms=2.5, lw=0.7, markevery=every)
    ax.axhline(STATE_RULES["common"], color="0.5", lw=0.8, ls=":")
    ax.set(xlabel="time (periods of the plate)", ylabel="share in common", ylim=(0, 1.05))


@style
def draw(d: Data) -> plt.Figure:
    tilt = d["nominal_deg"][most_mixed(d["state"])]
    panels = {
        "drift in the second half": _draw_drift,
        f"motion in common at {tilt:g}°": _draw_time,
    }
    figure = painted(d, panels, rows=2, figsize=(3.4, 4.2))
    legend_above(figure, figure.axes[0], ncols=3)
    figure.supxlabel(rf"$N={COUNT}$, $l={LENGTH}\,d$, $\Gamma={GAMMA}$, 60 Hz;" f"\n{LAW_LINES}")
    return figure
