"""One question, the drift of the row, and every way to answer it: deviation and time.

N = 40 thin rods of 9.5 d at 21.5 degrees, Gamma = 3.3, mu = 0.3, restitution 0.65 head on.
Another model: the closed form (24) with the assumed V_z = V_0/2, in an array and by itself; one
rigid rod that bounces at fixed tilt, 30 to 100,000 landings; other stiffnesses and contact laws.
The same model: rows of rods over several lengths of time (in periods), steps (in parts of a
contact) and numbers of rods. Symbols: deviation of the mean over independent starts from the
trusted answer, long runs of many starts of the same law with a fine step, linear between -1 and 1
%. Bars: one standard error, of both, from the scatter between starts; where it exceeds the
deviation the symbol is open. The time at the right is that of one start.
"""

from functools import partial

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter

import md
from impact import drift
from md.accuracy import STEPS_PER_CONTACT, steps_per_contact
from md.scene import Scene, from_tables, put, read_tables
from md.sweep import Point, Sweep

from ..lib.runs import (
    BOX,
    BOX_TILT,
    COUNT,
    FRICTION,
    GAMMA,
    RESTITUTION,
    SETTING,
    Sweeps,
    both,
    gathered,
    over_seeds,
    paper_rod,
    starts,
)
from ..lib.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, RIGID, THEORY, Data, note, style
from ..lib.timing import measured_here, medians, seconds_per_period

PRINTED = both(law="appendix_a", restitution="none")
CONSTRAINT = {"contacts.plate.law": "coulomb"}
STEPS = (12, 16, STEPS_PER_CONTACT, 48, 96)  # a contact
ROWS = {  # group: label: what the scene changes, at the usual step
    "stiffness": {rf"$k_n=5\cdot10^{n}$": both(stiffness=5.0 * 10**n) for n in (3, 4, 5, 7)},
    "contact law": {
        "App. A": PRINTED,
        "springs 3": both(tangential_ratio=3),
        "Coulomb": CONSTRAINT,
        r"$\epsilon=0.8$": both(restitution=0.8),
    },
    "rods": {rf"$N={n}$": {"rods.count": n, "box.length": n * BOX / COUNT} for n in (5, 10, 160)},
}
RUN_LENGTHS = (3, 30)  # periods, at the usual step
STARTS = 8  # of each row: its error is known to a quarter
LADDER_PERIODS = {True: 400, False: 1000}  # quick or not
TRUSTED_STEPS, TRUSTED_STARTS = 72, 12  # the drift of their means is known to 0.2 %
TRUSTED_PERIODS = {True: 400, False: 4000}
LANDINGS = (30, 300, 3000, 100_000)  # of one rigid rod


def scene(per_contact: float, changes: dict, seed: int = 1) -> Scene:
    """The row at a step that is a part of its contact time."""
    how = {**changes, "step": "none", "start.speed": 0.3, "start.seed": seed}
    row = put(read_tables("quasi2d"), how)
    dt = steps_per_contact(from_tables(row), 1.0) / per_contact
    return from_tables(put(row, {"step.size": dt, "step.coarse": True}))


def rungs(quick: bool) -> dict[tuple[str, str], tuple[float, dict, int]]:
    """Rows by group and label: steps a contact, changes of the scene, periods."""
    periods = LADDER_PERIODS[quick]
    found = {("length", f"{n} periods"): (STEPS_PER_CONTACT, {}, n) for n in RUN_LENGTHS}
    found |= {("step", rf"$t_c/{n}$"): (n, {}, periods) for n in STEPS}
    for group, rows in ROWS.items():
        found |= {(group, label): (STEPS_PER_CONTACT, to, periods) for label, to in rows.items()}
    return found


def sweeps(quick: bool = False) -> Sweeps:
    """Sweeps over starts: of every row, and of the row of the trusted answer."""

    def started(rows: list[tuple[float, dict, int]], count: int) -> Sweep:
        axis = starts(count)
        points = [
            Point(scene(n, to, seed), periods)
            for n, to, periods in rows
            for seed in axis["start.seed"]
        ]
        return Sweep(({"row": rows}, axis), tuple(points))

    trusted = [(TRUSTED_STEPS, {}, TRUSTED_PERIODS[quick])]
    every = list(rungs(quick).values())
    return {"rows": started(every, STARTS), "trusted": started(trusted, TRUSTED_STARTS)}


def _closed(speed: float, calls: int) -> tuple[float, ...]:
    """Closed form with the assumed V_z, and the seconds of each of `calls` in one array."""
    rod = paper_rod(np.full(calls, BOX_TILT) if calls > 1 else BOX_TILT)
    call = partial(drift, rod, **SETTING, plate_velocity=speed / 2)
    return np.ravel(call().c_x)[0], 0.0, 0.0, medians([call], 21)[0] / calls


def _bouncing(landings: int, speed: float) -> tuple[float, ...]:
    """Drift of one rigid rod by exact flights and impacts, its error and scatter, the seconds."""
    from impact.bouncing import bounce  # compiles

    rods = 10 if landings < 1000 else 50

    def call():
        return bounce(
            paper_rod(BOX_TILT),
            gamma=GAMMA,
            **SETTING,
            landings=max(landings // rods, 3),
            rods=rods,
            transient=20,
            shortest_flight=0.1,
        )

    found = call().drift
    return speed * found.mean, *[speed * found.error] * 2, medians([call], 1)[0]


def data(quick: bool = False) -> Data:
    """Answers [sqrt(g d)] with errors and the scatter of one start, seconds, group and label."""
    here, speed = measured_here(), md.load("quasi2d").plate_speed
    entries = [
        ("theory", "(24), $V_0/2$", *_closed(speed, 1), 0),
        ("theory", "in an array", *_closed(speed, 100_000), 0),
        *(("one rigid rod", f"{n} landings", *_bouncing(n, speed), 0) for n in LANDINGS),
    ]
    plan, every = sweeps(quick), rungs(quick)
    means, errors = over_seeds(gathered(plan["rows"], "c_x")[0])
    periods = np.array([how[2] for how in every.values()])
    seconds = periods * seconds_per_period([scene(*how[:2]) for how in every.values()])
    for name, mean, error, *cost in zip(every, means, errors, seconds, periods, strict=True):
        entries.append((*name, mean, error, error * np.sqrt(STARTS), *cost))
    drifts, spent = gathered(plan["trusted"], "c_x", "run_seconds")
    (truth,), (spread,) = over_seeds(drifts)
    names = "group", "label", "answer", "error", "scatter", "seconds", "periods"
    columns = map(np.array, zip(*entries, strict=True))
    return {
        **here,
        **dict(zip(names, columns, strict=True)),
        "trusted": np.array([truth, spread, spent.sum()]),
    }


LOOKS = {
    "length": (PURPLE, "P"),
    "step": (BLUE, "o"),
    "rods": (GREEN, "v"),
    "theory": (THEORY, "*"),
    "one rigid rod": (RIGID, "D"),
    "stiffness": (ORANGE, "s"),
    "contact law": (BLACK, "^"),
}
COMPUTATION = ("length", "step", "rods")  # the other groups are of another model


def deviations(d: Data) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Relative deviation from the trusted answer, its standard error, scatter of one start."""
    truth, spread, _ = d["trusted"]
    return d["answer"] / truth - 1, np.hypot(d["error"], spread) / truth, d["scatter"] / truth


def panel(ax: Axes, d: Data) -> None:
    """A line for each way, sorted by time: deviation with its sign, and the time at the right."""
    off, error, _ = deviations(d)
    computed = np.isin(d["group"], COMPUTATION)
    order = np.lexsort((d["seconds"], computed))
    y = np.empty(len(order))
    y[order] = np.arange(len(order)) + 1.3 * computed[order]  # the two kinds apart
    for group, (colour, marker) in LOOKS.items():
        for unclear in (False, True):
            here = (d["group"] == group) & ((np.abs(off) <= error) == unclear)
            look = {"color": colour, "mfc": "white" if unclear else colour, "elinewidth": 0.8}
            ax.errorbar(off[here], y[here], xerr=error[here], fmt=marker, **look)
    seconds, beside = EngFormatter("s", places=1), ax.get_yaxis_transform()
    for at, time in zip(y, d["seconds"], strict=True):
        ax.text(1.15, at, seconds(time), transform=beside, va="center", ha="right")
    kinds = {"another model": -1.0, "the same model": y[computed].min() - 1}
    names = [f"{group}: {label}" for group, label in zip(d["group"], d["label"], strict=True)]
    bold = [rf"$\bf{{{kind}}}$".replace(" ", r"\ ") for kind in kinds]
    ax.set_yticks([*kinds.values(), *y], [*bold, *names])
    ax.tick_params(axis="y", length=0)
    ax.axvline(0, color="0.6", lw=0.6)
    ax.set_xscale("symlog", linthresh=0.01, linscale=0.5)
    ticks = (-1, -0.1, -0.01, 0, 0.01, 0.1, 1)
    ax.set_xticks(ticks, [f"{100 * tick:+g}".replace("-", "−") if tick else "0" for tick in ticks])
    ax.set(xlim=(-1, 3), ylim=(y.max() + 0.8, -1.8), xlabel="deviation of the drift (%)")


@style
def draw(d: Data) -> Figure:
    figure, ax = plt.subplots(figsize=(7.0, 5.4))
    panel(ax, d)
    truth, spread, seconds = d["trusted"]
    note(
        figure,
        rf"trusted: $c_x={truth:.4f}\pm{spread:.4f}\,\sqrt{{gd}}$, {seconds:.0f} s; "
        rf"$L={BOX:g}\,d$, $N={COUNT}$, $\Gamma={GAMMA}$, $\mu={FRICTION}$, "
        rf"$\epsilon={RESTITUTION}$",
    )
    return figure
