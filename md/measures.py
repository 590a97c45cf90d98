"""What a run adds up over its landings and samples, a row a period, and means of it.

A rod that leaves the plate slower than the plate rises is hit again at once. Flight lengths fall
into two groups, below 0.1 and above 0.4 periods, so there are two kinds of mean: over every touch
of the plate, and over touches merged into one landing where less than `HOP` lies between them.
"""

from typing import Any

import numpy as np

from .host import SAMPLES, Engine
from .kernels import plane as row
from .kernels import touches as landings
from .statistics import ratio, standard_error

_PHASES = 64  # parts of a period
HOP = 0.2  # periods; a shorter flight does not part two landings
_OF_PERIOD = "series", "sums", "phases"  # arrays with a row a period
_TOUCHES = landings.WIDTH  # column behind those of a landing: touches merged into it

# What is summed over the landings of each period.
SUMS = (
    *("landings", "plate", "c_x_before", "c_x_after", "c_z_before", "c_z_after", "omega_before"),
    *("approach", "leaving", "flight", "flights", "duration", "slide", "stick", "reversal"),
    *("shared", "pushing", "omega_after", "flight_squared", "falling", "touches"),
)
MEANS = {  # what follows from them; plate_velocity over the plate's peak velocity, V_z/V_0
    "plate_velocity": ("plate", "landings"),
    "plate_velocity_by_speed": ("pushing", "approach"),  # each landing counts as its v_0
    "c_x_before": ("c_x_before", "landings"),
    "c_x_after": ("c_x_after", "landings"),
    "c_z_before": ("c_z_before", "landings"),
    "c_z_after": ("c_z_after", "landings"),
    "omega_before": ("omega_before", "landings"),
    "omega_after": ("omega_after", "landings"),
    "restitution": ("leaving", "approach"),  # of all landings together
    "flight_periods": ("flight", "flights"),
    "flight_seen_periods": ("flight_squared", "flight"),  # mean of the flights met at a random time
    "contact_periods": ("duration", "landings"),
    "slide": ("slide", "landings"),
    "slip_stick": ("stick", "landings"),
    "slip_reversal": ("reversal", "landings"),
    "pushed_by_others": ("shared", "landings"),
    "falling": ("falling", "landings"),  # while the plate falls
}
OF_LANDINGS = {
    **{name: of for name, of in MEANS.items() if name.startswith(("c_", "omega", "flight"))},
    **{name: MEANS[name] for name in ("plate_velocity", "falling")},
    "touches": ("touches", "landings"),
}


def merged(rows: np.ndarray, shortest: float) -> tuple[np.ndarray, np.ndarray]:
    """Landings from touches: those that are over, in the order in which that was seen, and others.

    Their rows are those of the first touch, with the velocities after the last one.

    Parameters
    ----------
    rows : (n, WIDTH + 1) as they came; of each rod in the order of time
    shortest : steps; what follows so soon belongs to the landing before
    """
    if not len(rows):
        return rows, rows
    order = np.lexsort((rows[:, landings.STEP], rows[:, landings.ROD]))
    rows = rows[order]
    of_rod = np.diff(rows[:, landings.ROD], prepend=-1) != 0
    first = np.flatnonzero(of_rod | ~(rows[:, landings.FLIGHT] <= shortest))
    last = np.append(first[1:], len(rows)) - 1
    found = rows[first]
    found[:, landings.AFTER : landings.AFTER + 3] = rows[last, landings.AFTER : landings.AFTER + 3]
    found[:, _TOUCHES] = np.add.reduceat(rows[:, _TOUCHES], first)
    over = np.append(~of_rod[first[1:]], False)  # the same rod has begun another one
    seen = np.argsort(order[first[1:]][over[:-1]])
    return found[over][seen], found[~over]


class Tables:
    """Samples of each period and sums over its landings."""

    def __init__(self, engine: Engine, periods: int):
        self.periods, self.per, self.speed = periods, engine.per, engine.scene.plate_speed or 1.0
        self.series = np.zeros((periods + 1, 5))
        self.sides = engine.rods[:, 2:4].copy()
        self.sums = np.zeros((periods + 1, 2, len(SUMS)))  # over touches, over merged landings
        self.phases = np.zeros((periods + 1, _PHASES), np.uint16)
        self.under_way = np.zeros((0, _TOUCHES + 1))  # merged landings that may not be over

    def sampled(self, engine: Engine) -> row.Series:
        """What the kernel adds to."""
        return row.Series(self.series, self.sides, self.per, max(self.per // SAMPLES, 1))

    def arrays(self, periods: int) -> dict[str, np.ndarray]:
        """All that a checkpoint needs, by name."""
        of_period = {name: getattr(self, name)[: periods + 1] for name in _OF_PERIOD}
        return {**of_period, "sides": self.sides, "under_way": self.under_way}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Take them out again."""
        self.under_way = arrays.pop("under_way")
        for name in (*_OF_PERIOD, "sides"):
            part = arrays.pop(name)
            getattr(self, name)[: len(part)] = part

    def drift(self, engine: Engine, periods: int) -> np.ndarray:
        """Mean drift of each period made."""
        places = self.series[: periods + 1, row.MEAN_X].copy()
        if engine.step == periods * engine.per:  # the next period's first sample is not yet made
            places[-1] = engine.rods[:, 0].mean()
        return np.diff(places) / (engine.dt * engine.per)

    def tilt_deg(self, periods: int) -> np.ndarray:
        """Mean tilt of each period made."""
        return np.degrees(self.series[:periods, row.TILTS] / self.series[:periods, row.SAMPLES])

    @staticmethod
    def error(series: np.ndarray) -> float:
        """Standard error of the mean of one value a period."""
        return standard_error(series)

    def results(self, engine: Engine, first: int, periods: int) -> dict[str, Any]:
        """What a `Result` tells of the periods behind the transient but for drift and tilt."""
        seen, n = engine.record is not None and periods > 0, engine.scene.rods.count
        return {
            "touches": self._means(0, MEANS, first, periods, n) if seen else None,
            "landings": self._means(1, OF_LANDINGS, first, periods, n) if seen else None,
            "annulus": None,
            "turned": {
                "fell": int(self.series[:, row.FELL].sum()),
                "passed_upright": int(self.series[:, row.UPRIGHT].sum()),
            },
            "phases": self.cycle(first, periods) if engine.record is not None else [],
        }

    def add(self, rows: np.ndarray) -> None:
        """Touches as they end."""
        rows = np.column_stack([rows, np.ones(len(rows))])
        over, self.under_way = merged(np.concatenate([self.under_way, rows]), HOP * self.per)
        self._sum(1, over)
        period, part = np.divmod(self._sum(0, rows), self.per)
        np.add.at(self.phases, (period, part * _PHASES // self.per), 1)

    def _sum(self, kind: int, rows: np.ndarray) -> np.ndarray:
        """Add landings, but those with which a rod may have begun on the plate; their steps."""
        rows = rows[np.isfinite(rows[:, landings.FLIGHT])]
        step = rows[:, landings.STEP].astype(int)
        flight, plate = rows[:, landings.FLIGHT] / self.per, rows[:, landings.PLATE] / self.speed
        regime = rows[:, landings.REGIME]
        before, after = landings.BEFORE, landings.AFTER
        columns = (
            *(np.ones(len(rows)), plate),
            *(rows[:, before], rows[:, after], rows[:, before + 1], rows[:, after + 1]),
            rows[:, before + 2],
            *(-rows[:, landings.APPROACH], rows[:, landings.LEAVING]),
            *(flight, np.ones(len(rows))),
            rows[:, landings.DURATION] / self.per,
            *(regime == 1, regime == 2, regime == 3, rows[:, landings.SHARED] > 0),
            -rows[:, landings.APPROACH] * plate,
            *(rows[:, after + 2], flight**2, plate < 0, rows[:, _TOUCHES]),
        )
        np.add.at(self.sums[:, kind], step // self.per, np.array(columns, float).T)
        return step

    def _means(self, kind: int, names: dict, first: int, last: int, rods: int) -> dict[str, Any]:
        part = dict(zip(SUMS, self.sums[first:last, kind].T, strict=True))
        found = {name: ratio(part[top], part[base]) for name, (top, base) in names.items()}
        found["per_rod_and_period"] = ratio(part["landings"], np.full(last - first, rods))
        return {name: {"mean": m, "stderr": e} for name, (m, e) in found.items()}

    def cycle(self, first: int, last: int) -> list[int]:
        """Landings over the plate's cycle; a run begins at its lowest place, a quarter before."""
        counts = self.phases[first:last].sum(axis=0, dtype=np.int64)
        return np.roll(counts, -(_PHASES // 4)).tolist()
