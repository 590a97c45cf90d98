"""What a run adds up over its touches and samples, a row a period, and means of it.

A rod that leaves the plate slower than the plate rises is hit again at once. Flight lengths fall
into two groups, below 0.1 and above 0.4 periods, so there are two kinds of mean: over every touch
of the plate, and over touches merged into one landing where less than `HOP` lies between them. An
annulus has the lean along it besides.
"""

from math import inf, nan, pi
from typing import Any

import numpy as np

from .host import Engine
from .kernels import codes
from .kernels import touches as columns
from .kernels.codes import SLIDING, SLIP_REVERSAL, SLIP_STICK
from .scene import Scene
from .statistics import ratio, standard_error

_PARTS = 64  # of a period
HOP = 0.2  # periods; a shorter flight does not part two landings
_MERGED = columns.WIDTH  # column behind those of a touch: how many touches a landing has


def phase_at(time: Any) -> Any:
    """Phase of the plate, rad, 0 to 2 pi, so many periods after the start, at its lowest point."""
    return 2 * pi * ((time - 0.25) % 1)


def wedged_periods(scene: Scene) -> float:
    """Periods without a touch after which a rod counts as wedged: 20 flights that begin at V_0.

    Rods of rings that do not wedge, 23 to 56 rods, touch again within 6 such flights; of 54 rods
    that wedged, 46 never did.
    """
    return 20 * max(scene.plate.acceleration / pi, 1.0) if scene.plate else inf


def quantities(rows: np.ndarray, per: int, speed: float) -> dict[str, Any]:
    """What is summed over the touches or landings of a period, by name.

    Parameters
    ----------
    rows : (n, WIDTH + 1)
    per : steps of a period
    speed : peak velocity of the plate
    """
    plate = rows[:, columns.PLATE] / speed
    approach, regime = -rows[:, columns.APPROACH], rows[:, columns.REGIME]
    return {
        "count": np.ones(len(rows)),
        "plate_velocity": plate,  # V_z/V_0
        **dict(zip(_BEFORE, rows[:, columns.BEFORE : columns.AFTER].T, strict=True)),
        **dict(zip(_AFTER, rows[:, columns.AFTER : columns.PLATE].T, strict=True)),
        "flight_periods": rows[:, columns.FLIGHT] / per,
        "falling": plate < 0,  # while the plate falls
        "touches": rows[:, _MERGED],
        "contact_periods": rows[:, columns.DURATION] / per,
        "slide": regime == SLIDING,
        "slip_stick": regime == SLIP_STICK,
        "slip_reversal": regime == SLIP_REVERSAL,
        "pushed_by_others": rows[:, columns.PUSHED] > 0,
        "approach": approach,
        "leaving": rows[:, columns.LEAVING],
        "pushing": approach * plate,
    }


_BEFORE = [f"{name}_before" for name in ("c_x", "c_z", "omega")]
_AFTER = [f"{name}_after" for name in ("c_x", "c_z", "omega")]
SUMS = tuple(quantities(np.zeros((0, _MERGED + 1)), 1, 1.0))
_BOTH = "plate_velocity", *_BEFORE, *_AFTER, "flight_periods", "falling"
_OF_TOUCHES = "contact_periods", "slide", "slip_stick", "slip_reversal", "pushed_by_others"
# Quotients of sums: over the touches, or the landings, unless it says otherwise.
MEANS = {name: (name, "count") for name in (*_BOTH, *_OF_TOUCHES)} | {
    "plate_velocity_by_speed": ("pushing", "approach"),  # each touch counts as its v_0
    "restitution": ("leaving", "approach"),  # of all touches together
}
OF_LANDINGS = {name: (name, "count") for name in (*_BOTH, "touches")}


def merged(rows: np.ndarray, shortest: float) -> tuple[np.ndarray, np.ndarray]:
    """Landings from touches: finished ones in the order of their end, and landings still under way.

    A landing has the row of its first touch, with the velocities after the last one.

    Parameters
    ----------
    rows : (n, WIDTH + 1) as they came; of each rod in the order of time
    shortest : steps; a touch that follows sooner belongs to the landing before
    """
    if not len(rows):
        return rows, rows
    order = np.lexsort((rows[:, columns.STEP], rows[:, columns.ROD]))
    rows = rows[order]
    of_rod = np.diff(rows[:, columns.ROD], prepend=-1) != 0
    first = np.flatnonzero(of_rod | ~(rows[:, columns.FLIGHT] <= shortest))
    last = np.append(first[1:], len(rows)) - 1
    found = rows[first]
    found[:, columns.AFTER : columns.AFTER + 3] = rows[last, columns.AFTER : columns.AFTER + 3]
    found[:, _MERGED] = np.add.reduceat(rows[:, _MERGED], first)
    over = np.append(~of_rod[first[1:]], False)  # the same rod has begun another one
    seen = np.argsort(order[first[1:]][over[:-1]])
    return found[over][seen], found[~over]


class Tables:
    """Samples of each period, and what is added up over its touches.

    In an annulus all errors are unknown: rods keep their arrangement, another one at each start.

    Parameters
    ----------
    engine : of the run
    periods : to be made
    """

    def __init__(self, engine: Engine, periods: int):
        self.engine, self.per, self.speed = engine, engine.per, engine.scene.plate_speed or 1.0
        self.annulus = engine.scene.annulus
        self.series = engine.series(periods)
        self.sums = np.zeros((periods + 1, 2, len(SUMS)))  # over touches, over landings
        self.phases = np.zeros((periods + 1, _PARTS), np.uint32)
        self.of_period = {"series": self.series.rows, "sums": self.sums, "phases": self.phases}
        self.under_way = np.zeros((0, _MERGED + 1))  # landings that may not be over

    def arrays(self, periods: int) -> dict[str, np.ndarray]:
        """All that a checkpoint needs, by name."""
        of_period = {name: rows[: periods + 1] for name, rows in self.of_period.items()}
        return of_period | {"last": self.series.last, "under_way": self.under_way}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Restore from the arrays of a checkpoint, which are taken out."""
        self.under_way = arrays.pop("under_way")
        for name, array in (self.of_period | {"last": self.series.last}).items():
            part = arrays.pop(name)
            array[: len(part)] = part

    def drift(self, periods: int) -> np.ndarray:
        """Mean drift of each period made; in an annulus around it, at its middle radius."""
        engine, length = self.engine, self.engine.dt * self.per
        if self.annulus is not None:
            return self.series.rows[:periods, codes.ADVANCE] * self.annulus.middle / length
        places = self.series.rows[: periods + 1, codes.MEAN_X].copy()
        if engine.step == periods * self.per:  # the next period's first sample is not yet made
            places[-1] = engine.rods[:, codes.X].mean()
        return np.diff(places) / length

    def fell(self, periods: int) -> np.ndarray:
        """Rods that fell over in each period made; it is not counted in an annulus."""
        if self.annulus is not None:
            return np.zeros(periods)
        return self.series.rows[:periods, codes.FELL].copy()

    def error(self, series: np.ndarray) -> float:
        """Standard error of the mean of one value a period."""
        return nan if self.annulus else standard_error(series)

    def tilt_deg(self, periods: int) -> np.ndarray:
        """Mean tilt of each period made."""
        part = self.series.rows[:periods]
        return np.degrees(part[:, codes.TILT_SUM] / part[:, codes.SAMPLED])

    def quotient(self, over: np.ndarray, under: np.ndarray) -> dict[str, float]:
        """Quotient of two sums, given period by period, and its standard error."""
        mean, stderr = ratio(over, under)
        return {"mean": mean, "stderr": nan if self.annulus else stderr}

    def results(self, first: int, periods: int) -> dict[str, Any]:
        """What a `Result` tells of the periods behind the transient but for drift and tilt."""
        found: dict[str, Any] = dict.fromkeys(("touches", "landings", "annulus"))
        found |= {"turned": {}, "phases": []}
        if self.engine.record is not None:
            found["phases"] = self.cycle(first, periods)
            if periods > 0:
                found["touches"] = self._means(0, MEANS, first, periods)
                found["landings"] = self._means(1, OF_LANDINGS, first, periods)
        if self.annulus is None:
            fell, upright = self.series.rows[:, [codes.FELL, codes.UPRIGHT]].sum(axis=0)
            found["turned"] = {"fell": int(fell), "passed_upright": int(upright)}
        elif periods > 0:
            part = self.series.rows[first:periods]
            lean = self.quotient(np.degrees(part[:, codes.LEAN_SUM]), part[:, codes.SAMPLED])
            found["annulus"] = {"lean_deg": lean, "wedged": {"mean": self._wedged(), "stderr": nan}}
        return found

    def add(self, rows: np.ndarray) -> None:
        """Add touches as they end."""
        rows = np.column_stack([rows, np.ones(len(rows))])
        over, self.under_way = merged(np.concatenate([self.under_way, rows]), HOP * self.per)
        self._sum(1, over)
        period, part = np.divmod(self._sum(0, rows), self.per)
        np.add.at(self.phases, (period, part * _PARTS // self.per), 1)

    def _sum(self, kind: int, rows: np.ndarray) -> np.ndarray:
        """Add touches or landings, but those with which a rod may have begun; their steps."""
        rows = rows[np.isfinite(rows[:, columns.FLIGHT])]
        step = rows[:, columns.STEP].astype(int)
        table = np.array([*quantities(rows, self.per, self.speed).values()], float).T
        np.add.at(self.sums[:, kind], step // self.per, table)
        return step

    def _means(self, kind: int, names: dict, first: int, last: int) -> dict[str, Any]:
        part = dict(zip(SUMS, self.sums[first:last, kind].T, strict=True))
        part["rods"] = np.full(last - first, self.engine.scene.rods.count)
        pairs = names | {"per_rod_and_period": ("count", "rods")}
        return {name: self.quotient(part[top], part[base]) for name, (top, base) in pairs.items()}

    def cycle(self, first: int, last: int) -> list[int]:
        """Touches over the plate's cycle; a run begins at its lowest place, a quarter before."""
        counts = self.phases[first:last].sum(axis=0, dtype=np.int64)
        return np.roll(counts, -(_PARTS // 4)).tolist()

    def _wedged(self) -> float:
        """Share of rods that have long not touched the plate at the end; nan without a record."""
        engine = self.engine
        if engine.record is None:
            return nan
        since = columns.since_touch(engine.record, engine.step)
        return float((since > wedged_periods(engine.scene) * self.per).mean())
