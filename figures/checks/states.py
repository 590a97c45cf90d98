"""States of a row over tilt and acceleration: how often, how long, and whether they hang on.

In a block all rods go up and down together; in a zig-zag neighbours depart from the row's mean by
turns to either side, in height or in tilt; else the rods move by themselves, or in groups. A row
has fallen where rods lie or lean against the others. The rule for each part of a run: fallen, then
zig-zag if neighbours' departures are opposite and large enough to be seen, then block if nearly all
of the vertical motion is common to all rods, else single rods. A run's state is the one of most
parts of its second half. The share in common is a number between 0 and 1 and changes smoothly
beyond 20 degrees, where the rule cuts it; at small tilts it jumps.

(a) States over tilt and acceleration, a symbol a start; open: the state changed in the second half.
(b) Drift over tilt at the figures' acceleration, by state. (c) Starts that are still in the state
in which they began, over time, by tilt. (d) Drift over tilt while the box takes the row slowly up
and down, with standard errors over starts; where the two differ, the row remembers.
"""

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import mode

from md.sweep import Sweep

from ..lib.runs import (
    COUNT,
    GAMMA,
    LAW_NAME,
    LENGTH,
    Sweeps,
    boxes,
    gathered,
    nearest,
    planned,
    seed_means,
    starts,
)
from ..lib.style import (
    BLACK,
    BLUE,
    GREEN,
    RED,
    Data,
    note,
    painted,
    points,
    shades,
    style,
    zero_line,
)
from . import row_motion
from .row_motion import SEEN, driven, followed

STATES = "block", "zig-zag", "single rods", "fallen"
BLOCK, ZIGZAG, SINGLE, FALLEN = range(4)
MISSING = -1  # state of a run that was lost
BLOCK_COMMON = 0.9  # share of the vertical motion from which on a row is a block
ZIGZAG_ORDER = -0.5  # correlation of neighbours up to which they stand by turns
ZIGZAG_SPREAD = 0.01  # departures [d] from which on they are seen
FALLEN_SHARE = 0.02  # share of rods from which on a row has fallen
LOOKS = ((BLUE, "s"), (GREEN, "^"), (RED, "o"), (BLACK, "x"))  # of the states
STARTS = {  # largest component of a velocity, height over the plate
    "start.seed": [1, 2, 3, 4],
    "start.speed": [1e-3, 0.3, 0.3, 0.3],
    "start.drop": [0.0, 0.0, 1.0, 3.0],
}
MAP = {  # tilts [deg], accelerations, periods
    True: ((9, 45), (GAMMA,), 40),
    False: (
        (3, 5, 7, 9, 11, 13, 16, 20, 28, 36, 45, 54, 62, 70, 78),
        (1.3, 1.8, 2.4, GAMMA, 4.2, 5.0, 6.0),
        400,
    ),
}
LIVES = {  # tilts [deg], starts, periods
    True: ((9,), 2, 40),
    False: ((7, 9, 11, 13), 20, 2000),
}
DRIVEN = {True: (2, 400), False: (4, 3000)}  # starts, periods; faster, rods are thrown over
PARTS = 24  # of the time from one end to the other, over which (d) takes the mean
BESIDE = 0.15  # by which symbols of one Gamma stand apart
WAYS = (RED, "o-", "up"), (BLUE, "s-", "down")  # of the tilt


def sweeps(quick: bool = False) -> Sweeps:
    """Sweeps of rows over tilt, acceleration and start; long runs; tilts driven up and down."""
    tilts, gammas, periods = MAP[quick]
    some, lives, long = LIVES[quick]
    ways, slow = DRIVEN[quick]
    return {
        "map": planned(
            [{"box.length": boxes(tilts)}, {"plate.acceleration": [*gammas]}, STARTS],
            periods,
            measure=followed,
        ),
        "lives": planned([{"box.length": boxes(some)}, starts(lives)], long, measure=followed),
        "driven": planned(
            [{"box.length": boxes(row_motion.ENDS_DEG)}, starts(ways)], slow, measure=driven
        ),
    }


def states(d: Data) -> np.ndarray:
    """Index into `STATES` of each part of a run by the rule; `MISSING` where it was lost.

    Parameters
    ----------
    d : arrays of one shape by the names of `row_motion.SEEN`
    """
    by_turns = [
        (d[f"{name}_order"] <= ZIGZAG_ORDER) & (d[f"{name}_spread"] >= ZIGZAG_SPREAD)
        for name in ("height", "tilt")
    ]
    rules = [d["fallen"] >= FALLEN_SHARE, *by_turns, d["common"] >= BLOCK_COMMON]
    found = np.select(rules, [FALLEN, ZIGZAG, ZIGZAG, BLOCK], SINGLE)
    return np.where(np.isfinite(d["common"]), found, MISSING)


def settled(state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """State of most parts of the second half of each run, and whether it changed in that half.

    Parameters
    ----------
    state : (..., parts), from `states`
    """
    late = state[..., state.shape[-1] // 2 :]
    return mode(late, axis=-1).mode, (late != late[..., :1]).any(axis=-1)


def still_there(state: np.ndarray) -> np.ndarray:
    """Share of the starts that have not yet left the state of their first part, over the parts.

    Parameters
    ----------
    state : (tilts, starts, parts), from `states`
    """
    return np.logical_and.accumulate(state == state[..., :1], axis=-1).mean(axis=1)


def _followed(sweep: Sweep) -> tuple[Data, np.ndarray]:
    """Series that were followed along a sweep, and the states over time, (..., parts)."""
    names = (*SEEN, "c_x", "middle", "late_c_x_stderr")
    found = dict(zip(names, gathered(sweep, *names), strict=True))
    return found, states(found)


def _in_parts(values: np.ndarray) -> np.ndarray:
    """Means of at most `PARTS` parts of the time; the last axis is split."""
    parts = np.array_split(values, min(PARTS, values.shape[-1]), axis=-1)
    return np.stack([part.mean(axis=-1) for part in parts], axis=-1)


def data(quick: bool = False) -> Data:
    """States, drift [cm/s] and tilt [deg] of each run of (a); numbers of (c) and (d)."""
    runs = sweeps(quick)
    tilts, gammas, _ = MAP[quick]
    found, state = _followed(runs["map"])
    of_run, changed = settled(state)
    half = state.shape[-1] // 2
    long, lived = _followed(runs["lives"])
    slow, _ = _followed(runs["driven"])
    slow_c_x = np.moveaxis(_in_parts(slow["c_x"]), 1, -1)
    return {
        "nominal_deg": np.array(tilts, float),
        "gamma": np.array(gammas),
        "state": of_run,
        "changed": changed.astype(int),
        "c_x": found["c_x"][..., half:].mean(axis=-1),
        "c_x_error": found["late_c_x_stderr"],
        "tilt_deg": found["tilt_deg"][..., half:].mean(axis=-1),
        "lives_deg": np.array(LIVES[quick][0], float),
        "middle": np.nanmax(long["middle"].reshape(-1, lived.shape[-1]), axis=0),
        "still_there": still_there(lived),
        "driven_deg": _in_parts(slow["tilt_deg"]).mean(axis=1),
        **seed_means({"driven_c_x": slow_c_x}),
    }


def _draw_map(ax, d):
    tilt = d["nominal_deg"][:, None, None]
    gamma = d["gamma"][:, None] + np.linspace(-BESIDE, BESIDE, d["state"].shape[-1])
    tilt, gamma = np.broadcast_arrays(tilt, gamma)
    for each, (colour, form) in enumerate(LOOKS):
        some = d["state"] == each
        if some.any():
            ax.plot([], [], form, color=colour, ms=3, label=STATES[each])
        for changed in (False, True):
            here = some & (d["changed"] == changed)
            places = tilt[here], gamma[here], None
            points(ax, *places, colour, form=form, hollow=changed, ms=2.2, mew=0.5)
    ax.set(xlabel=r"tilt $\phi$ (deg)", ylabel=r"acceleration $\Gamma$")
    ax.set_ylim(top=d["gamma"].max() + 1.6)
    ax.legend(loc="upper right")


def _draw_drift(ax, d):
    at = nearest(d["gamma"], GAMMA)
    for each, (colour, form) in enumerate(LOOKS):
        for changed in (False, True):
            some = (d["state"][:, at] == each) & (d["changed"][:, at] == changed)
            what = (d[name][:, at][some] for name in ("tilt_deg", "c_x", "c_x_error"))
            points(ax, *what, colour, form=form, hollow=changed)
    zero_line(ax)
    ax.set(xlabel=r"tilt $\phi$ (deg)", ylabel=r"drift $c_x$ (cm/s)")


def _draw_lives(ax, d):
    colours = shades(len(d["lives_deg"]))
    for i, tilt in enumerate(d["lives_deg"]):
        ax.step(
            d["middle"],
            d["still_there"][i],
            where="post",
            color=colours[i],
            ls="-" if i % 2 else (0, (5, 2)),
            label=f"{tilt:g}°",
            zorder=3 - i,
        )
    ax.set(
        xlabel="time (periods of the plate)",
        ylabel="share not yet changed",
        xscale="log",
        ylim=(0, 1.05),
    )
    ax.legend()


def _draw_driven(ax, d):
    for way, (colour, form, name) in enumerate(WAYS):
        what = (d[f"driven_{part}"][way] for part in ("deg", "c_x", "c_x_error"))
        points(ax, *what, colour, form=form, label=name)
    zero_line(ax)
    ax.set(xlabel=r"tilt $\phi$ (deg)", ylabel=r"drift $c_x$ (cm/s)")
    ax.legend()


@style
def draw(d: Data) -> Figure:
    panels = {
        "states": _draw_map,
        rf"drift by state, $\Gamma={GAMMA}$": _draw_drift,
        "how long the first state lasts": _draw_lives,
        "tilt changed slowly": _draw_driven,
    }
    figure = painted(d, panels, 5.0, rows=2)
    note(figure, rf"$N={COUNT}$, $l={LENGTH}\,d$, 60 Hz; (c), (d): $\Gamma={GAMMA}$; {LAW_NAME}")
    return figure
