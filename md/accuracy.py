"""Runs to a tolerance: several starts side by side, until the error of their mean drift is small.

A contact lasts `STEPS_PER_CONTACT` steps, or as many as are stable. The error of the drift has two
parts, which add in squares. The statistical one is estimated as the starts go on. The bias of the
step is a flat `ALLOWANCE`, which `tests/test_allowance.py` measures over drawn scenes. Where the
tolerance is too small for that, the law is a user's own, rods stand upright, or it is asked for, as
many starts again take steps twice as long, and the bias follows from the difference.

Upright rods, which lean less than 18 degrees in their box, stick together or do not by what the
friction between them does within a step. Their steps are stable whatever the dashpots. The row of
`quasi2d` with 24 steps a contact in their place would drift 5.8(3) times as fast at 14 degrees; at
16 degrees it drifts as fast, to 1.4 %, at 18 degrees to 1.1 %.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from inspect import signature
from math import hypot, inf, isfinite, nan
from threading import Event
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from scipy.special import chdtrc, ndtri, stdtrit

from . import simulation
from .domains import InputError, held, number, whole
from .host import STEPS_PER_CONTACT, stable_step, step_of, upright
from .laws import LAWS, contact_time
from .measures import FEWEST, UNLIKELY, settled, standard_error, transient
from .result import Accuracy, Result
from .scene import Scene, Step
from .simulation import Run, interruptible

DOMAINS = {
    "tolerance": (1e-5, 0.5),
    "confidence": (0.5, 0.999),
    "floor": (1e-12, 1e12),
    "max_seconds": (1e-3, 1e9),
}
# Part of the drift allowed for the bias of the step. On 2026-11-28 the bias was 0.29(13) % on
# average over 27 drawn rows that lean 18 to 50 degrees, against steps a third as long; two standard
# deviations of it, statistical errors taken off, were 1.0 %, all of it from two rows; 91 % of 81
# runs to 3 % were off by no more than they said. Before contacts of rods were solved for four alike
# it was 0.2(3) % over annuli, five of eight drawn ones: in the others starts did not settle, or
# differ.
ALLOWANCE = 0.005
CONFIDENCE = 0.95
FLOOR = 0.05  # of the plate's peak velocity: slower drifts are judged as if they were this fast
MAX_SECONDS = 600.0
STARTS = 2  # at least: one start does not show that there are several states
MOST_STARTS = 64
MOST_PERIODS_OF_A_START = 10**6
FIRST_LOOK = 320  # periods
GROWTH = 1.1, 2.0  # least and largest, of the starts from one look to the next
UNSETTLED = 1.5  # growth of starts from one look to the next while they have not settled
CUT = 150, 400  # least and most periods that are left out at the start, of a fifth, if settled
SLOWER = 1, 2  # factor by which the transient is longer: in a row, in an annulus
PER_FREEDOM = 30  # periods that tell as much of a standard error as one independent number
SEED_GAP = 10**6  # between the seeds of starts
MEASURED_PRICE = 3.0  # of a bias that is measured: longer steps besides, and its statistical error


class Interval(NamedTuple):
    """Mean drift of one or more starts behind their transients, with its interval, in sqrt(g d)."""

    mean: float
    half: float  # of the interval
    error: float  # standard error
    chance: float  # that starts differ as they do, if they are in one state; nan: of one start
    settled: bool  # whether no start trends any longer, in its drift or in the rate of its falls
    fell: int  # rods that fell over behind the transients


def interval(
    starts: list[np.ndarray], confidence: float = CONFIDENCE, *, annulus: bool = False
) -> Interval:
    """Pool the drifts of independent starts behind their transients.

    The standard error is that of `measures.standard_error`, of an autoregressive model, whose
    variance is as uncertain as that of n/(2 order) independent numbers. A start whose drift or
    whose rate of falls trends (`measures.settled`) counts from its middle. For such starts, and
    wherever rods fall over, so that the drift may decay slowly, the change between the halves is an
    error as well. Where starts differ by more than the errors explain, the scatter between them is
    the error.

    Parameters
    ----------
    starts : at least one, each (2, periods): drift in sqrt(g d) and number of falls, as of
        `Run.history`
    confidence : of the interval
    annulus : whether the rods are in an annulus, which settles later, and where starts differ
        sooner
    """
    least, most = (SLOWER[annulus] * cut for cut in CUT)
    calm, drifts, fell = True, [], 0
    for drift, falls in starts:
        n = len(drift)
        cut = settled(min(max(transient(n), least), most, n // 2), drift, falls)
        if cut is None:
            calm, cut = False, n // 2
        drifts.append(drift[cut:])
        fell += int(falls[cut:].sum())
    sizes = np.array([*map(len, drifts)])
    total = int(sizes.sum())
    if sizes.min() < FEWEST:
        mean = float(np.concatenate(drifts).mean()) if total else nan
        return Interval(mean, inf, inf, nan, False, fell)
    means = np.array([drift.mean() for drift in drifts])
    errors = np.array([*map(standard_error, drifts)])
    if fell or not calm:
        halves = [np.array_split(drift, 2) for drift in drifts]
        change = [abs(early.mean() - late.mean()) / 2 for early, late in halves]
        errors = np.hypot(errors, change)
    part = sizes / total
    mean, error = float(part @ means), float(np.sqrt(np.sum((part * errors) ** 2)))
    freedom, chance, others = total // PER_FREEDOM, nan, len(starts) - 1
    if others:
        off = (means - mean) / np.maximum(errors, 1e-300)
        chance = float(chdtrc(others, np.sum(off**2)))
        if chance < UNLIKELY[annulus]:
            error, freedom = float(means.std(ddof=1) / np.sqrt(others + 1)), others
    half = float(stdtrit(freedom, (1 + confidence) / 2) * error)
    return Interval(mean, half, error, chance, calm, fell)


class Estimate(NamedTuple):
    """Estimated drift of a scene without the bias of the step, and its errors, in sqrt(g d)."""

    mean: float
    statistical: float  # half of the statistical interval
    bias: float  # taken off the drift
    bias_error: float  # half of the interval of the bias
    chance: float
    settled: bool
    fell: int

    @property
    def error(self) -> float:
        """Half of the interval, of bias and statistics together."""
        return hypot(self.statistical, self.bias_error)


def allowed(fine: Interval) -> Estimate:
    """`Estimate` with the flat allowance for the bias of the step."""
    error = ALLOWANCE * abs(fine.mean)
    return Estimate(fine.mean, fine.half, 0.0, error, fine.chance, fine.settled, fine.fell)


def measured(fine: Interval, coarse: Interval) -> Estimate:
    """`Estimate` with the bias measured by starts with steps twice as long.

    If these change the drift by c, the bias is c if it goes as the step, and c/3 if as its square:
    2c/3 +- c/3.
    """
    change = coarse.mean - fine.mean if isfinite(coarse.mean) else 0.0  # interrupted at the start
    bias = 2 / 3 * change
    return Estimate(
        mean=fine.mean - bias,
        statistical=hypot(5 / 3 * fine.half, 2 / 3 * coarse.half),
        bias=bias,
        bias_error=abs(change) / 3,
        chance=min(fine.chance, coarse.chance),
        settled=fine.settled and coarse.settled,
        fell=fine.fell + coarse.fell,
    )


@dataclass
class _Goal:
    """Goal of several starts: judges their drifts until the mean is accurate enough."""

    tolerance: float
    confidence: float
    floor: float
    max_seconds: float
    starts: int = STARTS  # with the fine step; if the bias is measured, as many have longer ones
    annulus: bool = False
    needed: float = nan  # seconds in all
    end: float = inf  # time of the clock at which to end; set by the first look

    @property
    def first(self) -> int:
        """Periods at the first look."""
        return FIRST_LOOK * SLOWER[self.annulus]

    def look(self, histories: list[np.ndarray]) -> None:
        """Estimate the drift from all starts."""
        self.made = sum(one.shape[1] for one in histories)
        find = partial(interval, confidence=self.confidence, annulus=self.annulus)
        fine, longer = find(histories[: self.starts]), histories[self.starts :]
        self.doubled = bool(longer)
        self.found = measured(fine, find(longer)) if longer else allowed(fine)

    @property
    def size(self) -> float:
        """Velocity to which errors are relative: |drift|, or the floor if that is larger."""
        return max(abs(self.found.mean), self.floor)

    @property
    def reached(self) -> bool:
        """Whether the tolerance is kept, by starts that have settled."""
        return self.found.settled and self.found.error <= self.tolerance * self.size

    def judge(self, histories: list[np.ndarray], seconds: float) -> int:
        """Periods of each start by the next look; 0 if the goal is over.

        Starts are judged by as many periods each.
        """
        made = min(one.shape[1] for one in histories)
        self.look([one[:, :made] for one in histories])
        found = self.found
        room = (self.tolerance * self.size) ** 2 - found.bias_error**2
        wanted = inf if room <= 0 else made * found.statistical**2 / room
        self.needed = wanted / made * seconds
        known = made >= 2 * self.first and (found.settled or room <= 0)
        hopeless = known and self.needed > 2 * self.max_seconds
        late = seconds > self.max_seconds or made >= MOST_PERIODS_OF_A_START
        if self.reached or hopeless or late:
            return 0
        if not found.settled:
            wanted = UNSETTLED * made
        grown = np.clip(wanted, GROWTH[0] * made, GROWTH[1] * made) + 1
        return int(min(grown, MOST_PERIODS_OF_A_START))


def _together(runs: list[Run], periods: int, stop: Callable[[], bool]) -> None:
    """March all runs until each has made `periods`, each in its thread; one that fails ends all."""
    ended = Event()
    with ThreadPoolExecutor(len(runs)) as pool:
        try:
            marches = [
                pool.submit(running.march, periods, lambda: ended.is_set() or stop())
                for running in runs
            ]
            for marching in as_completed(marches):
                marching.result()
        finally:  # also by an exception in this thread, which a handler of a signal has raised
            ended.set()


def pursued(goal: _Goal, runs: list[Run]) -> Result:
    """March the starts until the goal is over; return the result of the first one."""
    with ExitStack() as stack:
        for running in runs:
            stack.enter_context(running)
        pressed = stack.enter_context(interruptible())
        begin, periods = perf_counter(), goal.first
        while periods:
            _together(runs, periods, lambda: pressed() or perf_counter() > goal.end)
            histories = [running.history() for running in runs]
            if pressed():
                goal.look(histories)
                break
            goal.end = begin + goal.max_seconds
            periods = goal.judge(histories, perf_counter() - begin)
        return runs[0].result(not periods)


def steps_per_contact(scene: Scene, dt: float) -> float:
    """Steps in the shortest contact at twice the plate's peak velocity.

    Raises
    ------
    ValueError
        If nothing vibrates.
    """
    if not scene.vibrates:
        raise InputError("tolerance needs plate.acceleration > 0: nothing vibrates")
    found = filter(None, vars(scene.contacts).values())
    return min(contact_time(c.law, 2 * scene.plate_speed) for c in found) / dt


def stepped(scene: Scene, tolerance: float, measure_bias: bool = False) -> tuple[Scene, bool]:
    """Scene with the step for a tolerance, and whether the bias of the step is to be measured.

    A bias that is measured is known to about a third of itself: below the allowance the step
    shrinks with the tolerance.
    """
    own = {c.law.name for c in filter(None, vars(scene.contacts).values())} - LAWS.keys()
    doubled = bool(measure_bias or own or upright(scene) or tolerance < 2 * ALLOWANCE)
    n = STEPS_PER_CONTACT * max(1.0, ALLOWANCE / tolerance)
    longest = stable_step(replace(scene, step=Step(coarse=not upright(scene))))[0] / (1 + doubled)
    dt = min(steps_per_contact(scene, 1.0) / n, longest)
    return replace(scene, step=Step(dt, coarse=True)), doubled


def run(
    scene: Scene,
    *,
    tolerance: float | None = None,
    confidence: float = CONFIDENCE,
    floor: float | None = None,
    max_seconds: float = MAX_SECONDS,
    workers: int | None = None,
    measure_bias: bool = False,
    **options: Any,
) -> Result:
    """Run a scene and measure it: for a number of periods, or until its drift is accurate.

    Parameters
    ----------
    scene : Scene
    tolerance : total error of the drift over its size, 1e-5 to 0.5; the step and the length of the
        run follow (320 periods at least, of which the first 150 to 400, or more where the drift or
        the rate at which rods fall over still trends then, are left out of the drift; in an annulus
        twice as many), the scene's own step is not used. None: `periods` are made, at the scene's
        step
    confidence : with which the interval holds the long-run drift, 0.5 to 0.999
    floor : drifts below it, in sqrt(g d), are judged as if they were this fast (default: a
        twentieth of the plate's peak velocity)
    max_seconds : of the run, without compiling, but for the first 320 periods, in an annulus 640,
        which are made in any case; where it will take more than twice as long, it ends early, with
        `accuracy.state` "not reached", or "not settled" if a trend is left
    workers : independent starts, 2 (the default) to 64, which run at once, one a thread; their
        drifts are pooled, all else that is measured is of the first start. With a tolerance alone
    measure_bias : measure the bias of the step, by as many starts again with steps twice as long,
        also where the allowance of 0.5 % would do; it always is of rods in a box that rub and lean
        less than 18 degrees
    options : as of `simulation.run`: `periods` (200; without tolerance alone), `ledger`, `observe`,
        `trajectory`, `frames`, `checkpoint` (without tolerance alone), `progress`

    Returns
    -------
    Result; where Ctrl-C has ended the run, its `finished` is False, and a loop over runs has to end
    by itself. Its `accuracy` is None without a tolerance. With one, `c_x` is the mean over all
    starts, less the bias of the step where that was measured; other means keep theirs

    Raises
    ------
    ValueError
        As `simulation.run`, if no plate vibrates, or an argument is out of its domain.
    RunError
        As `simulation.run`.
    """
    if not isinstance(scene, Scene):
        raise InputError(f"scene must be a md.Scene, as md.load gives, got {scene!r}")
    own: dict[str, Any] = {"confidence": confidence, "floor": floor, "max_seconds": max_seconds}
    if tolerance is None:
        for name, value in (own | {"workers": workers, "measure_bias": measure_bias}).items():
            if value != signature(run).parameters[name].default:
                raise InputError(f"{name} has no meaning without tolerance")
        return simulation.run(scene, **options)
    checked(tolerance=tolerance, periods=options.get("periods"), **own)
    starts = STARTS if workers is None else whole("workers", workers, STARTS, MOST_STARTS)
    if options.get("checkpoint") is not None:
        raise InputError("checkpoint has no meaning with tolerance: it holds one start alone")
    asked = held("measure_bias", measure_bias, bool)
    fine, doubled = stepped(scene, tolerance, asked)
    floor = FLOOR * scene.plate_speed if floor is None else floor
    goal = _Goal(tolerance, confidence, floor, max_seconds, starts, scene.annulus is not None)
    result = pursued(goal, starts_of(fine, starts, doubled, options))
    stderr = goal.found.statistical / float(ndtri((1 + confidence) / 2))
    stderr = stderr if isfinite(stderr) else nan
    return replace(result, c_x=goal.found.mean, c_x_stderr=stderr, accuracy=_accuracy(goal, result))


def starts_of(scene: Scene, starts: int, doubled: bool, options: dict[str, Any]) -> list[Run]:
    """Runs of a scene from several seeds; if `doubled`, as many again with steps twice as long.

    The options, as those of `simulation.run`, are for the first one; `ledger` is for all.
    """
    scenes = [
        replace(scene, start=replace(scene.start, seed=scene.start.seed + SEED_GAP * i))
        for i in range(starts)
    ]
    if doubled:
        assert scene.step.size is not None
        longer = replace(scene.step, size=2 * scene.step.size)
        scenes += [replace(one, step=longer) for one in scenes]
    alike = {"ledger": options.get("ledger", True)}  # else another kernel would be compiled
    return [
        Run(one, MOST_PERIODS_OF_A_START, **(options if one is scenes[0] else alike))
        for one in scenes
    ]


def checked(*, periods: int | None = None, **options: float | None) -> dict[str, float]:
    """Options of a run with a tolerance that are given, checked against their domains."""
    if periods is not None:
        raise InputError("periods has no meaning with tolerance, which chooses the length")
    if "tolerance" not in options:
        raise InputError(f"{next(iter(options))} has no meaning without tolerance")
    return {
        name: number(name, value, *DOMAINS[name])
        for name, value in options.items()
        if value is not None or name != "floor"
    }


def _accuracy(goal: _Goal, result: Result) -> Accuracy:
    """`Accuracy` of a run, from the estimate that its goal has found."""
    found, tenth = goal.found, goal.tolerance / 10
    state = "reached" if goal.reached else "not reached" if found.settled else "not settled"
    longer = (found.statistical / goal.size / tenth) ** 2
    if not goal.doubled and tenth < 2 * ALLOWANCE:
        longer *= MEASURED_PRICE
    finer = result.dt / step_of(stepped(result.scene, tenth)[0])[0]
    return Accuracy(
        tolerance=goal.tolerance,
        confidence=goal.confidence,
        floor=goal.floor,
        error=found.error,
        statistical=found.statistical,
        bias=found.bias,
        bias_error=found.bias_error,
        bias_measured=goal.doubled,
        per_contact=steps_per_contact(result.scene, result.dt),
        starts=goal.starts * (1 + goal.doubled),
        made=goal.made,
        chance=found.chance,
        fell=found.fell,
        state=state,
        seconds=result.run_seconds,
        needed_seconds=goal.needed,
        next_digit_seconds=result.run_seconds * longer * finer,
    )
