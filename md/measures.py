"""Sums over the touches and samples of a run, period by period, and means with standard errors.

A rod that leaves the plate slower than the plate rises is hit again at once, so there are two kinds
of mean: over every touch of the plate, and over touches merged into one landing where less than
`HOP` lies between them; of flights most are shorter than half of it, or longer than twice. In
an annulus wedged rods are counted as well. Means of correlated series leave out the
transient, are tested for a trend, and have standard errors.
"""

from collections.abc import Iterable
from math import inf, log, nan, pi, sqrt
from typing import Any

import numpy as np
from scipy.linalg import solve_toeplitz

from . import kernels
from .host import Engine
from .kernels import SLIDING, SLIP_REVERSAL, SLIP_STICK
from .kernels import touches as columns
from .scene import Scene

_PARTS = 64  # of a period, in which touches are counted
HOP = 0.2  # periods; a shorter flight does not separate two landings
_MERGED = columns.WIDTH  # column behind those of a touch: how many touches a landing has


def phase_at(time: Any) -> Any:
    """Phase of the plate, rad, 0 to 2 pi, `time` periods after a start at its lowest point."""
    return 2 * pi * ((time - 0.25) % 1)


def wedged_periods(scene: Scene) -> float:
    """Periods without a new touch after which a rod counts as wedged: 20 flights from V_0.

    No rod wedges where the plate has less acceleration than gravity, or gravity does not point to
    it. In annuli of 23 to 56 rods, rods that do not wedge touch again within 6 such flights; of 54
    rods that wedged, 46 never did.
    """
    gamma = scene.plate.acceleration if scene.plate else 0.0
    pull = -scene.gravity.z if scene.gravity else 0.0
    return 20 * max(gamma / (pi * pull), 1.0) if gamma > pull > 0 else inf


def quantities(rows: np.ndarray, per: int, speed: float) -> dict[str, Any]:
    """Quantities that are summed over the touches or landings of a period, by name.

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
        **dict(zip(VELOCITIES, rows[:, columns.BEFORE : columns.PLATE].T, strict=True)),
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


VELOCITIES = (
    "c_x_before",
    "c_z_before",
    "omega_before",
    "c_x_after",
    "c_z_after",
    "omega_after",
)
SUMS = tuple(quantities(np.zeros((0, _MERGED + 1)), 1, 1.0))
_BOTH = "plate_velocity", *VELOCITIES, "flight_periods", "falling"
# Means over touches, and over landings.
MEANS = (
    *_BOTH,
    "contact_periods",
    "slide",
    "slip_stick",
    "slip_reversal",
    "pushed_by_others",
    "plate_velocity_by_speed",
    "restitution",
)
OF_LANDINGS = (*_BOTH, "touches")
# Sums whose quotient a mean is, where that is not its own sum over the number of touches.
_QUOTIENTS = {
    "plate_velocity_by_speed": ("pushing", "approach"),  # each touch is weighted by its v_0
    "restitution": ("leaving", "approach"),  # of all touches together
    "per_rod_and_period": ("begun", "rods"),
}


def merged(rows: np.ndarray, shortest: float) -> tuple[np.ndarray, np.ndarray]:
    """Merge touches into landings: finished ones in the order of their end, and unfinished ones.

    A landing has the row of its first touch, with the velocities after the last one.

    Parameters
    ----------
    rows : (n, WIDTH + 1), touches as they came; those of one rod in the order of time
    shortest : steps; a touch that follows sooner belongs to the landing before
    """
    if not len(rows):
        return rows, rows
    order = np.argsort(rows[:, columns.ROD], kind="stable")
    rows = rows[order]
    of_rod = np.diff(rows[:, columns.ROD], prepend=-1) != 0
    first = np.flatnonzero(of_rod | ~(rows[:, columns.FLIGHT] <= shortest))
    following = np.append(first[1:], 0)  # first touch of the next landing; behind the last one 0
    found, after = rows[first], slice(columns.AFTER, columns.PLATE)
    found[:, after] = rows[following - 1, after]
    found[:, _MERGED] = np.add.reduceat(rows[:, _MERGED], first)
    over = ~of_rod[following]  # the same rod has begun another one
    seen = np.argsort(order[following[over]])
    return found[over][seen], found[~over]


class Tables:
    """Tables of a run: samples of each period, and sums over its touches and landings.

    In an annulus all errors are unknown: rods keep their arrangement, another one at each start.

    Parameters
    ----------
    engine : of the run
    periods : to be made
    """

    def __init__(self, engine: Engine, periods: int):
        self.engine, self.per = engine, engine.per
        self.annulus = engine.scene.annulus
        self.series = engine.series(periods)
        self.sums = np.zeros((periods + 1, 2, len(SUMS)))  # over touches, over landings
        self.phases = np.zeros((periods + 1, _PARTS), np.uint32)
        self.under_way = np.zeros((0, _MERGED + 1))  # landings that may not be over

    def arrays(self, periods: int) -> dict[str, np.ndarray]:
        """Arrays that a checkpoint after so many periods needs, by name."""
        kept = slice(periods + 1)
        return {
            "series": self.series.rows[kept],
            "sums": self.sums[kept],
            "phases": self.phases[kept],
            "last": self.series.last,
            "under_way": self.under_way,
        }

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Restore the tables from the arrays of a checkpoint."""
        self.under_way = arrays["under_way"]
        for name, table in self.arrays(len(arrays["sums"]) - 1).items():
            table[:] = arrays[name]

    def by_period(self, periods: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Mean drift, mean tilt and number of rods that fell over, in each period.

        Drift in sqrt(g d), in an annulus around it, at its middle radius; tilt in degrees; falls
        are zeros in an annulus, where they are not counted.
        """
        engine, rows, length = self.engine, self.series.rows[:periods], self.engine.dt * self.per
        if self.annulus is not None:
            drift = rows[:, kernels.ADVANCE] * self.annulus.middle / length
            tilt = rows[:, kernels.TILT_SUM] / rows[:, kernels.SAMPLED]
            return drift, np.degrees(tilt), np.zeros(periods)
        twice = rows[:, kernels.TILT_COSINE] + 1j * rows[:, kernels.TILT_SINE]
        mean = np.angle(twice.sum())  # rods have no head: tilts are within 90 degrees of their mean
        tilt = (mean + np.angle(twice * np.exp(-1j * mean))) / 2
        places = self.series.rows[: periods + 1, kernels.MEAN_X].copy()
        if engine.step == periods * self.per:  # the next period's first sample is not yet made
            places[-1] = engine.rods[:, kernels.X].mean()
        return np.diff(places) / length, np.degrees(tilt), rows[:, kernels.FELL].copy()

    def mean(self, series: np.ndarray) -> tuple[float, float]:
        """Mean of a series with one value a period, and its standard error; nan in an annulus."""
        if not len(series):
            return nan, nan
        return float(series.mean()), nan if self.annulus else standard_error(series)

    def results(self, first: int, periods: int) -> dict[str, Any]:
        """Fields of a `Result` that touches give, from periods `first` to `periods`.

        These are the periods behind the transient.
        """
        found: dict[str, Any] = {"touches": None, "landings": None, "wedged": None, "phases": []}
        if (record := self.engine.record) is not None:
            found["phases"] = self.phases[first:periods].sum(axis=0, dtype=np.int64).tolist()
            if periods > 0:
                found["touches"] = self._means(0, MEANS, first, periods)
                found["landings"] = self._means(1, OF_LANDINGS, first, periods)
            if self.annulus is not None:
                since = columns.since_touch(record, self.engine.step)
                long = wedged_periods(self.engine.scene) * self.per
                found["wedged"] = float((since > long).mean())
        return found

    def add(self, rows: np.ndarray) -> None:
        """Add finished touches to the sums, and the landings that they finish."""
        rows = np.column_stack([rows, np.ones(len(rows))])
        over, self.under_way = merged(np.concatenate([self.under_way, rows]), HOP * self.per)
        self._sum(1, over)
        period, step = np.divmod(self._sum(0, rows), self.per)
        # Parts begin where the plate rises fastest, a quarter of a cycle behind the start; a
        # negative one counts from the end, as indices do.
        part = step * _PARTS // self.per - _PARTS // 4
        np.add.at(self.phases, (period, part), 1)

    def _sum(self, kind: int, rows: np.ndarray) -> np.ndarray:
        """Add touches or landings to the sums, but the first of each rod; return their steps.

        A rod may have begun with its first one: there is no flight before it.
        """
        rows = rows[np.isfinite(rows[:, columns.FLIGHT])]
        step = rows[:, columns.STEP].astype(int)
        found = quantities(rows, self.per, self.engine.scene.plate_speed or 1.0)
        table = np.array([*found.values()], float).T
        np.add.at(self.sums[:, kind], step // self.per, table)
        return step

    def _means(self, kind: int, names: Iterable[str], first: int, last: int) -> dict[str, Any]:
        """Quotients of two sums over all periods, and standard errors; these nan in an annulus."""
        part = dict(zip(SUMS, self.sums[first:last, kind].T, strict=True))
        part["rods"] = np.full(last - first, self.engine.scene.rods.count)
        going = self.under_way[np.isfinite(self.under_way[:, columns.FLIGHT]), columns.STEP]
        begun = np.bincount(going.astype(int) // self.per, minlength=last)[first:last]
        part["begun"] = part["count"] + kind * begun  # landings under way count too
        found = {}
        for name in (*names, "per_rod_and_period"):
            top, base = _QUOTIENTS.get(name, (name, "count"))
            mean, stderr = ratio(part[top], part[base])
            found[name] = {"mean": mean, "stderr": nan if self.annulus else stderr}
        return found


FEWEST = 100  # values for a standard error
TREND = 0.743  # value of `trend` that one in a hundred long stationary series exceeds
# Starts whose differences have a chance below this count as being in different states: of rows, and
# of annuli, where each start has an arrangement of its own.
UNLIKELY = 1e-3, 5e-2
_BLOCKS = 8  # of counts, whose order tells a trend
_ORDERED = 19  # of 28 pairs of blocks, rising less falling ones; one in 70 steady counts exceeds it
_ROUNDING = 1e-10  # smaller errors of a sum are rounding


def transient(periods: int) -> int:
    """Periods left out at the start of a run: a fifth."""
    return periods // 5


def standard_error(series: np.ndarray) -> float:
    """Standard error of the mean of a correlated, stationary series; nan below `FEWEST` values.

    Its square is the spectral density at frequency zero of an autoregressive model over the number
    of values (Heidelberger and Welch, 1981). The model is fitted by Yule and Walker's equations up
    to the order 10 log10(n), and the order with the smallest Akaike criterion is taken. A change of
    state that is rarer than once in the series goes unseen: only independent starts show it. A
    deviation that later values make up for, in small parts over many of them, counts as scatter.
    """
    series = np.asarray(series, float)
    n = len(series)
    if n < FEWEST or not np.isfinite(series).all():
        return nan
    off = series - series.mean()
    most = int(10 * np.log10(n))
    covariance = np.array([off[: n - lag] @ off[lag:] for lag in range(most + 1)]) / n
    error, least = 0.0, inf
    for order in range(most + 1):
        lagged = covariance[1 : order + 1]
        weights = solve_toeplitz(covariance[:order], lagged) if order else lagged
        noise = covariance[0] - weights @ lagged
        if not noise > 1e-15 * covariance[0]:  # nothing is left to explain
            break
        criterion = n * log(noise) + 2 * order
        if criterion < least:
            density = noise * n / (n - order - 1) / (1 - weights.sum()) ** 2
            error, least = sqrt(density / n), criterion
    return error


def trend(series: np.ndarray, least: float = _ROUNDING) -> float:
    """How far a series is from a stationary one; nan below `FEWEST` values.

    Cramer and von Mises' statistic of its partial sums, which are a Brownian bridge if it is
    stationary, with the standard error from its second half (Heidelberger and Welch, 1983), below
    200 values from what a straight line leaves of it. Above `TREND` are 1 to 2 % of stationary
    series; of series with a memory of ten values 6 % at 320 values and up to 25 % below 200.

    Parameters
    ----------
    series : a value a period
    least : the standard error of its sum is at least this
    """
    n = len(series)
    if n < FEWEST:
        return nan
    late = series[-max(n // 2, FEWEST) :]
    if n < 2 * FEWEST:  # nearly all of it: a trend would pass for scatter
        time = np.arange(len(late))
        late = late - np.polyval(np.polyfit(time, late, 1), time)
    error = standard_error(late) * sqrt(len(late) / n)
    bridge = np.cumsum(series - np.mean(series)) / max(n * error, least)
    return float(np.mean(bridge**2))


def steady(counts: np.ndarray) -> bool:
    """Whether events come at a steady rate.

    They do not if their counts trend, nor if these rise or fall from block to block (Mann, 1945): a
    rate that grows from nothing has an error as large as itself, so that `trend` misses it. The
    number of events is at least as uncertain as its square root.

    Parameters
    ----------
    counts : of events, a value a period
    """
    blocks = counts[len(counts) % _BLOCKS :].reshape(_BLOCKS, -1).sum(axis=1)  # as long as another
    order = np.triu(np.sign(blocks - blocks[:, None]), 1).sum()
    return not (abs(order) > _ORDERED or trend(counts, sqrt(max(counts.sum(), 1))) > TREND)


def settled(first: int, series: np.ndarray, events: np.ndarray) -> int | None:
    """Values to leave out so that the rest shows no trend; None if half of them is not enough.

    Parameters
    ----------
    first : least number of values to leave out; tenths of the series are added to it
    series : with its transient
    events : counts in the same periods, whose rate is to be steady as well

    A freely chosen cut, as that of MSER-5, keeps the part that looks constant, and standard errors
    come out too small; this one is the first of at most six.
    """
    n = len(series)
    for cut in range(first, max(n // 2, first) + 1, max(n // 10, 1)):
        if not trend(series[cut:]) > TREND and steady(events[cut:]):
            return cut
    return None


def ratio(sums: np.ndarray, counts: np.ndarray) -> tuple[float, float]:
    """Mean of a quantity from its sums and counts in blocks, and its standard error.

    Parameters
    ----------
    sums, counts : of each block, in the order of time
    """
    if not counts.sum() > 0:
        return nan, nan
    mean = sums.sum() / counts.sum()
    off = (sums - mean * counts) / counts.mean()
    return float(mean), standard_error(off)
