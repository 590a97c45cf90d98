"""Runs to a tolerance: step and length follow from the error that the drift may have.

The error has two parts, which add in squares. The statistical one is estimated as the run goes on,
which ends as soon as both are small enough. The bias of a long step is known from a calibration
(`bias.py`) and is taken off; its error is the other part. Where the calibration does not hold, the
bias is measured: a second run with steps twice as long tells it.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import partial
from math import hypot, inf, isfinite, nan
from pathlib import Path
from threading import Lock
from time import perf_counter, sleep
from typing import Any, NamedTuple

import numpy as np
from scipy.special import chdtrc, ndtri, stdtrit

from . import simulation
from .bias import Bias, Choice, choose, steps_per_contact, student
from .domains import number, whole
from .errors import InputError
from .host import step_of
from .scene import Scene, Step
from .simulation import Accuracy, Result
from .statistics import FEWEST, settled, standard_error, transient

DOMAINS = {
    "tolerance": (1e-5, 0.5),
    "confidence": (0.5, 0.999),
    "floor": (1e-12, 1e12),
    "max_seconds": (1e-3, 1e9),
}
CONFIDENCE = 0.95
FLOOR = 0.05  # of the plate's peak velocity: slower drifts are judged as if they were this fast
MAX_SECONDS = 600.0
MOST_WORKERS = 64
LONGEST = 10**6  # periods of a run
FIRST_LOOK = 320  # periods
GROWTH = 1.1, 2.0  # least and largest, of the run from one look to the next
CUT = 150, 400  # least and most periods that are left out at the start, of a fifth, if settled
SLOWER = 2  # an annulus settles so many times slower than a row
PER_FREEDOM = 30  # periods that tell as much of a standard error as one independent number
# Chance below which starts that differ are in different states, of rows and of annuli, where each
# start has an arrangement of its own.
UNLIKELY = 1e-3, 5e-2
UNSETTLED = 1.5  # growth of a run that has not settled
FEW = 5  # periods to the first answer, where nothing is known of a start's pace
PATIENCE = 0.3  # seconds after which one of several starts asks again
SEED_GAP = 10**6  # between the seeds of starts
IN_PLACE = 3.0  # tolerances that a bias is measured to
ORDER = 2.0  # of the bias, where it is measured: at twice the step it is 2^ORDER times as large


class Interval(NamedTuple):
    """Mean of one or several series behind their transients, and how sure it is."""

    mean: float
    half: float  # of the interval
    error: float  # standard error
    chance: float  # that starts differ as they do, if they are in one state; nan: of one start
    settled: bool  # whether no series has a trend left


NONE = Interval(nan, inf, inf, nan, False)


def slower(annulus: bool) -> int:
    """How many times slower than a row the rods settle."""
    return SLOWER if annulus else 1


def interval(
    series: list[np.ndarray], confidence: float = CONFIDENCE, *, annulus: bool = False
) -> Interval:
    """Pool the drifts of independent starts behind their transients.

    The standard error is that of `statistics.standard_error`, of an autoregressive model, whose
    variance is as uncertain as that of n/(2 order) independent numbers. A series with a trend
    (`statistics.settled`) counts from its middle, and the difference of what is left is its error.
    Where starts differ by more than the errors explain, the scatter between them is the error.

    Parameters
    ----------
    series : drift of each start, period by period
    confidence : of the interval
    annulus : whether the rods are in one: it settles later, and starts differ sooner
    """
    least, most = (slower(annulus) * cut for cut in CUT)
    firsts = [min(int(np.clip(transient(len(x)), least, most)), len(x) // 2) for x in series]
    cuts = [settled(one, first) for one, first in zip(series, firsts, strict=True)]
    calm = None not in cuts
    rest = [x[len(x) // 2 if cut is None else cut :] for x, cut in zip(series, cuts, strict=True)]
    sizes = np.array([len(one) for one in rest])
    if sizes.min() < FEWEST:
        mean = float(np.concatenate(rest).mean()) if sizes.sum() else nan
        return NONE._replace(mean=mean)
    means = np.array([one.mean() for one in rest])
    errors = np.array([standard_error(one) for one in rest])
    if not calm:
        halves = (np.array_split(one, 2) for one in rest)
        off = [abs(one.mean() - two.mean()) / 2 for one, two in halves]
        errors = np.maximum(errors, off)
    part = sizes / sizes.sum()
    mean, error = float(part @ means), float(np.sqrt(np.sum((part * errors) ** 2)))
    freedom, chance, others = int(sizes.sum()) // PER_FREEDOM, nan, len(series) - 1
    if others:
        off = (means - mean) / np.maximum(errors, 1e-300)
        chance = float(chdtrc(others, np.sum(off**2)))
        if chance < UNLIKELY[annulus]:
            error, freedom = float(means.std(ddof=1) / np.sqrt(others + 1)), others
    half = float(stdtrit(freedom, (1 + confidence) / 2) * error)
    return Interval(mean, half, error, chance, calm)


class Correction(NamedTuple):
    """What the step does to the drift; velocities."""

    bias: float  # to be taken off
    error: float  # half of its interval
    gain: float = 1.0  # of the statistical error, where the bias follows from the mean itself


@dataclass
class _Goal:
    """Goal of one or several starts: looks at their drifts until these are accurate enough."""

    tolerance: float
    confidence: float
    floor: float
    max_seconds: float
    correct: Callable[[float], Correction]  # of a mean
    starts: int = 1
    annulus: bool = False
    series: list[np.ndarray] = field(default_factory=list)  # drift of each start so far
    began: float = nan  # by the clock
    before: int = 0  # periods that the first start had then, from a checkpoint
    due: int = 0  # periods of each start at the next look
    found: Interval = NONE
    over: bool = False
    needed: float = nan  # seconds in all
    lock: Any = field(default_factory=Lock)

    def __post_init__(self) -> None:
        self.series = [np.zeros(0)] * self.starts
        self.due = self.first = FIRST_LOOK * slower(self.annulus)

    @property
    def correction(self) -> Correction:
        """Of the mean found."""
        return self.correct(self.found.mean)

    @property
    def mean(self) -> float:
        """Without the bias."""
        return self.found.mean - self.correction.bias

    @property
    def size(self) -> float:
        """Velocity that errors are relative to."""
        return max(abs(self.mean), self.floor)

    @property
    def statistical(self) -> float:
        """Half of the interval, of statistics alone."""
        return self.correction.gain * self.found.half

    @property
    def error(self) -> float:
        """Half of the interval, of bias and statistics together."""
        return hypot(self.statistical, self.correction.error)

    @property
    def reached(self) -> bool:
        """Whether the tolerance is kept, by series that have settled."""
        return self.found.settled and self.error <= self.tolerance * self.size

    def ask(self, start: int, drift: np.ndarray) -> int:
        """Periods that a start is to make in all, given the drift of each one made so far."""
        with self.lock:
            made = len(drift)
            if self.over:
                return made
            self.series[start] = drift
            if not isfinite(self.began):
                self.began, self.before = perf_counter(), made
            if min(map(len, self.series)) >= self.due:
                self.judge()
            if self.over:
                return made
            if self.starts == 1:
                return self.due
            if not made:
                return FEW
            if made < 2 * self.due:
                pace = made / max(perf_counter() - self.began, 1e-3)  # periods a second
                slowly = made + max(int(pace * PATIENCE), 1)
                return min(slowly, self.due if made < self.due else 2 * self.due)
        sleep(PATIENCE)  # another start is late, and may share the core with this one
        return made + 1

    def judge(self) -> None:
        """Whether it is over, and if not, when to look again.

        Starts are judged by as many periods each, whichever thread was faster.
        """
        made, seconds = self.due, perf_counter() - self.began
        if self.starts == 1:
            made = len(self.series[0])
        self.series = [one[:made] for one in self.series]
        self.found = interval(self.series, self.confidence, annulus=self.annulus)
        if made == self.before:  # at once after a resume: the pace is not known
            self.over, self.due = self.reached, made + FEW
            return
        room = (self.tolerance * self.size) ** 2 - self.correction.error**2
        wanted = inf if room <= 0 else made * self.statistical**2 / room
        pace = (made - self.before) / max(seconds, 1e-6)
        self.needed = wanted / pace
        affordable = self.before + pace * self.max_seconds
        hopeless = self.needed > 2 * self.max_seconds and made >= 2 * self.first
        hopeless = hopeless and (self.found.settled or room <= 0)
        if self.reached or hopeless or affordable < GROWTH[0] * made or made >= LONGEST:
            self.over = True
            return
        if not self.found.settled:
            wanted = UNSETTLED * made
        grown = np.clip(wanted, GROWTH[0] * made, GROWTH[1] * made) + 1
        self.due = int(min(grown, affordable, LONGEST))

    def interrupt(self, drift: np.ndarray) -> None:
        """End early, by Ctrl-C, with what the first start has."""
        with self.lock:
            if not self.over:
                self.over, self.series = True, [drift, *self.series[1:]]
                self.found = interval(self.series, self.confidence, annulus=self.annulus)


def run(
    scene: Scene,
    *,
    tolerance: float | None = None,
    confidence: float = CONFIDENCE,
    floor: float | None = None,
    max_seconds: float = MAX_SECONDS,
    workers: int = 1,
    calibration: str | Path | None = None,
    **options: Any,
) -> Result:
    """Run a scene and measure it: for a number of periods, or until its drift is accurate.

    Parameters
    ----------
    scene : Scene
    tolerance : total error of the drift over its size, 1e-5 to 0.5; the step and the length of the
        run follow (320 periods at least, of which the first 150 to 400, or more where the drift
        still trends then, are left out of the drift; in an annulus twice as many), the scene's own
        step is not used. None: `periods` are made, at the scene's step
    confidence : with which the interval holds the long-run drift, 0.5 to 0.999
    floor : drifts below it, in sqrt(g d), are judged as if they were this fast (default: a
        twentieth of the plate's peak velocity)
    max_seconds : of the run, without compiling, but for the first 320 periods, in an annulus 640,
        which are made in any case; where it will take more than twice as long, it ends early, with
        `accuracy.state` "not reached", or "not settled" if the drift still trends or rods fall over
    workers : independent starts, 1 to 64, which run at once, one a thread; their drifts are pooled,
        all else that is measured is of the first start. In an annulus, where rods keep their
        arrangement, the error of one start is about its arrangement. With a tolerance alone
    calibration : file of the bias of the step for this scene, by `md.calibration.of_scene`; None:
        the shipped one, and where it does not hold, the bias is measured by a second run
    options : as of `simulation.run`: `periods` (200; without tolerance alone), `ledger`, `observe`,
        `trajectory`, `frames`, `checkpoint`, `progress`

    Returns
    -------
    Result; its `accuracy` is None without a tolerance. With one, `c_x` is the mean over all starts,
    less the bias of the step; other means keep theirs

    Raises
    ------
    ValueError
        As `simulation.run`, if no plate vibrates, or an argument is out of its domain.
    RunError
        As `simulation.run`.
    KeyboardInterrupt
        On Ctrl-C while the bias is measured, of which nothing is kept.
    """
    own = {"confidence": confidence, "floor": floor, "max_seconds": max_seconds}
    if tolerance is None:
        usual = {"confidence": CONFIDENCE, "max_seconds": MAX_SECONDS, "workers": 1}
        for name, value in (own | {"workers": workers, "calibration": calibration}).items():
            if value != usual.get(name):
                raise InputError(f"{name} has no meaning without tolerance")
        return simulation.run(scene, **options)
    checked(tolerance=tolerance, periods=options.get("periods"), **own)
    workers = whole("workers", workers, 1, MOST_WORKERS)
    if workers > 1 and options.get("checkpoint") is not None:
        raise InputError("checkpoint must be None with several workers: it holds one start alone")
    chosen = choose(scene, tolerance, confidence, calibration)
    floor = FLOOR * scene.plate_speed if floor is None else floor
    how: dict[str, Any] = {"confidence": confidence, "floor": floor, "starts": workers}
    how["annulus"] = scene.annulus is not None
    spent = 0.0
    if chosen.bias is None:
        rough = _Goal(
            min(IN_PLACE * tolerance, DOMAINS["tolerance"][1]),
            max_seconds=max_seconds / 2,
            correct=lambda _: Correction(0.0, 0.0),
            **how,
        )
        dt, _ = step_of(chosen.scene)
        longer = replace(chosen.scene, step=Step(2 * dt, coarse=True))
        first = _started(longer, rough, {"ledger": False})
        if not first.finished:
            raise KeyboardInterrupt("the bias of the step was being measured, nothing is kept")
        spent, correct = first.run_seconds, partial(_measured, rough.found)
    else:
        correct = partial(_known, chosen.bias, confidence)
    goal = _Goal(tolerance, max_seconds=max(max_seconds - spent, 1e-3), correct=correct, **how)
    result = _started(chosen.scene, goal, options)
    finer = choose(scene, tolerance / 10, confidence, calibration)
    stderr = goal.statistical / float(ndtri((1 + confidence) / 2))
    stderr = stderr if isfinite(stderr) else nan
    found = _accuracy(goal, finer, result, spent)
    return replace(result, c_x=goal.mean, c_x_stderr=stderr, accuracy=found)


def _known(bias: Bias, confidence: float, mean: float) -> Correction:
    """By the calibration."""
    true = mean / (1 + bias.value)
    return Correction(mean - true, student(confidence) * bias.error * abs(true))


def _measured(rough: Interval, mean: float) -> Correction:
    """By a run with steps twice as long; as the order is not known here, its size is its error."""
    share = 1 / (2**ORDER - 1)
    bias = share * (rough.mean - mean)
    return Correction(bias, hypot(share * rough.half, bias), 1 + share)


def _started(scene: Scene, goal: _Goal, options: dict[str, Any]) -> Result:
    """Run all starts until the goal is over; the result of the first one."""
    seeds = (scene.start.seed + SEED_GAP * start for start in range(goal.starts))
    scenes = [replace(scene, start=replace(scene.start, seed=seed)) for seed in seeds]

    def other(start: int) -> None:
        mine = partial(goal.ask, start)
        try:
            simulation.run(scenes[start], periods=LONGEST, ledger=False, goal=mine)
        except BaseException:
            goal.over = True  # nobody waits for this one
            raise

    with ThreadPoolExecutor(max(goal.starts - 1, 1)) as pool:
        others = [pool.submit(other, start) for start in range(1, goal.starts)]
        try:
            how = {**options, "periods": LONGEST, "goal": partial(goal.ask, 0)}
            result = simulation.run(scene, **how)
            if not result.finished:
                goal.interrupt(result.c_x_series)
        finally:
            goal.over = True
        for one in others:
            one.result()
    return result


def checked(*, periods: int | None = None, **options: float | None) -> None:
    """Hold the options of a tolerance to their domains."""
    if periods is not None:
        raise InputError("periods has no meaning with tolerance, which chooses the length")
    if "tolerance" not in options:
        raise InputError(f"{next(iter(options))} has no meaning without tolerance")
    for name, value in options.items():
        if value is not None:
            number(name, value, *DOMAINS[name])


def _accuracy(goal: _Goal, finer: Choice, result: Result, spent: float = 0.0) -> Accuracy:
    """What a goal has found; `finer`: step for a tenth of its tolerance."""
    correction, per_contact = goal.correction, steps_per_contact(result.scene, result.dt)
    # Rods that fall lean the other way, and the drift dies away too slowly for one start to show.
    calm = goal.found.settled and (goal.starts > 1 or not result.turned.get("fell"))
    state = ("reached" if goal.reached else "not reached") if calm else "not settled"
    dearer, room, seconds = inf, 0.0, spent + result.run_seconds
    if finer.bias is not None:
        dearer = finer.per_contact / per_contact
        room = (goal.tolerance / 10) ** 2 - (student(goal.confidence) * finer.bias.error) ** 2
    longer = (goal.found.half / goal.size) ** 2 / room if room > 0 else inf
    return Accuracy(
        tolerance=goal.tolerance,
        confidence=goal.confidence,
        floor=goal.floor,
        error=goal.error,
        statistical=goal.statistical,
        bias=correction.bias,
        bias_error=correction.error,
        per_contact=per_contact,
        starts=goal.starts,
        made=sum(map(len, goal.series)),
        chance=goal.found.chance,
        outside=finer.outside,
        state=state,
        seconds=seconds,
        needed_seconds=spent + goal.needed,
        next_digit_seconds=seconds * dearer * longer,
    )
