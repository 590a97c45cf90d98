"""Landings of a row one by one, with hops that are too short for a flight taken together.

A rod that leaves the plate slower than the plate rises is hit again at once. Flight lengths fall
into two groups, below 0.1 and above 0.4 periods: a hop below `HOP` belongs to the landing before.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

import md
from impact import spherocylinder
from md import landings as columns
from md.scene import from_tables, put
from md.statistics import ratio

from .rows import FRICTION, GAMMA, LENGTH, RESTITUTION, ROW, boxes

HOP = 0.2  # periods
NAMES = ("c_x", "c_z", "omega")
SKIPPED = 20  # periods at the start


class Landings(NamedTuple):
    """Of all rods, several touches in a row taken as one; velocities in sqrt(g d)."""

    period: np.ndarray  # of the first touch, counted from the first that is kept
    flight: np.ndarray  # before it, in periods
    before: np.ndarray  # (n, 3): c_x, c_z, omega at the first touch
    after: np.ndarray  # after the last one
    plate: np.ndarray  # velocity at the first touch over V_0
    impulse: np.ndarray  # change of c_z
    touches: np.ndarray


def grouped(rows: np.ndarray, per: int, speed: float, shortest: float = HOP) -> Landings:
    """Landings from the rows of `md.run`, with hops up to `shortest` inside of them."""
    rows = rows[np.lexsort((rows[:, columns.STEP], rows[:, columns.ROD]))]
    flight = rows[:, columns.FLIGHT] / per
    fresh = np.diff(rows[:, columns.ROD], prepend=-1) != 0
    first = np.flatnonzero(fresh | (flight > shortest))
    last = np.append(first[1:], len(rows)) - 1
    before = rows[first, columns.BEFORE : columns.BEFORE + 3]
    after = rows[last, columns.AFTER : columns.AFTER + 3]
    found = Landings(
        *(rows[first, columns.STEP] // per, flight[first], before, after),
        *(rows[first, columns.PLATE] / speed, after[:, 1] - before[:, 1], last - first + 1),
    )
    whole = ~fresh[first]  # what is kept may begin amid the first of a rod
    return Landings(*(values[whole] for values in found))


@cache
def _touches(tilt_deg: float, periods: int, changes: tuple) -> tuple[np.ndarray, int, float]:
    """Rows of one run, steps a period, V_0."""
    scene = from_tables(put(ROW, {"box.length": boxes(np.array(tilt_deg)), **dict(changes)}))
    kept: list[np.ndarray] = []
    done = md.run(scene, periods=periods + SKIPPED, ledger=False, observe=kept.append)
    rows, per = np.concatenate(kept), done.steps_per_period
    rows[:, columns.STEP] -= SKIPPED * per
    return rows[rows[:, columns.STEP] >= 0], per, scene.plate_speed


def landings(tilt_deg: float, periods: int, changes: tuple = (), shortest: float = HOP) -> Landings:
    """Landings of one run of the row at a nominal tilt, Gamma = 3.3 unless `changes` says more."""
    return grouped(*_touches(tilt_deg, periods, changes), shortest)


def mean_of(values: np.ndarray, period: np.ndarray, weight: np.ndarray | None = None):
    """Mean over landings and its standard error, from blocks of periods."""
    weight = np.ones(len(values)) if weight is None else weight
    count = int(period.max()) + 1 if len(period) else 1
    sums = np.bincount(period.astype(int), values * weight, count)
    return ratio(sums, np.bincount(period.astype(int), weight, count))


def periods_watched(quick: bool) -> int:
    """Length of the runs whose landings are looked at one by one."""
    return 60 if quick else 150


def averages(
    tilts_deg: np.ndarray, quick: bool, changes: tuple = (), shortest: float = HOP
) -> dict[str, np.ndarray]:
    """Means at several tilts, as (tilts,) arrays with errors beside them."""
    found: dict[str, list] = {}
    for tilt in tilts_deg.tolist():
        got = landings(tilt, periods_watched(quick), changes, shortest)
        quantities = {
            "flight": (got.flight,),
            "falling": (got.plate < 0,),
            "plate": (got.plate,),
            "plate_impulse": (got.plate, got.impulse),
            "touches": (got.touches,),
            **{f"{name}_before": (got.before[:, i],) for i, name in enumerate(NAMES)},
            **{f"{name}_after": (got.after[:, i],) for i, name in enumerate(NAMES)},
        }
        for name, (values, *weight) in quantities.items():
            found.setdefault(name, []).append(mean_of(values, got.period, *weight))
    return {
        name + end: np.array(values)[:, i]
        for name, values in found.items()
        for i, end in enumerate(("", "_error"))
    }


@cache
def lone(quick: bool):
    """Tilts [deg], and `bounce` there: one rigid rod at fixed tilt, the theory without closure."""
    from impact.bouncing import bounce  # compiles

    tilts = np.arange(0, 76, 5 if quick else 2.5)
    setting = {"friction": FRICTION, "restitution": RESTITUTION, "shortest_flight": 0.1}
    count = {"rods": 20 if quick else 100, "landings": 150 if quick else 600, "transient": 150}
    return tilts, [
        bounce(spherocylinder(np.radians(tilt), LENGTH), gamma=GAMMA, **setting, **count)
        for tilt in tilts
    ]
