"""Times of several calls on a machine that is not quiet: taken in turn, compared round by round.

In a round every call is timed once, in a new random order, so that no call always follows the same
one. Differences are those of one round: what slows the machine down for longer than a round falls
on both. What is left of it, a speed that changes from round to round, is divided out: the speed of
a round is the median over all calls of their time over its own lower quartile, so that times are
those of the quieter rounds. Where code and arrays lie in memory moves times by up to three per
cent; this is no part of the errors.
"""

import os
import platform
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from time import thread_time
from timeit import timeit
from typing import Any, NamedTuple

import numba
import numpy as np
from tqdm import tqdm

from md.host import Engine, prepare
from md.kernels.march import Series
from md.scene import Scene

SAMPLES = 7  # whose median is the time of a call
SAMPLE_PERIODS, SETTLE_PERIODS = 6, 20  # of a scene: of a sample, before the first
LONG_ENOUGH = 1e-3  # seconds of one sample
MEDIAN_ERROR = 1.2533 / 1.349  # of the median of n normal values: this times their iqr / sqrt(n)


Sampler = Callable[[], float]  # makes one sample and returns its time


class Estimate(NamedTuple):
    """Median over rounds, its standard error and the interquartile range."""

    value: float
    error: float
    spread: float


def waited(items: Iterable, desc: str, unit: str = "it") -> tqdm:
    """Items with a progress bar, which shows on a terminal once they have taken two seconds."""
    return tqdm(items, desc=desc, unit=unit, disable=None, leave=False, delay=2)


def in_turn(calls: Sequence[Sampler], rounds: int, seed: int = 0) -> np.ndarray:
    """Times of calls taken in turn, in a random order each round, shape (rounds, calls).

    Parameters
    ----------
    calls : each makes one sample
    rounds : how many of each
    seed : of the orders
    """
    random, samples = np.random.default_rng(seed), np.empty((rounds, len(calls)))
    for turn in waited(range(rounds), "timing", "round"):
        for number in random.permutation(len(calls)):
            samples[turn, number] = calls[number]()
    return samples


def medians(calls: Sequence[Callable[[], Any]], runs: int) -> np.ndarray:
    """Median seconds of each of several calls, taken in turn, after two that do not count.

    Parameters
    ----------
    calls : each is repeated in a sample, so often that this takes long enough
    runs : samples of each
    """

    def sampler(call: Callable[[], Any]) -> Sampler:
        call()  # compiles
        often = max(1, round(LONG_ENOUGH / timeit(call, number=1)))
        return lambda: timeit(call, number=often) / often

    return np.median(in_turn([*map(sampler, calls)], runs), axis=0)


def steady(samples: np.ndarray) -> np.ndarray:
    """Samples (rounds, calls) at one speed of the machine, that of the quieter rounds."""
    quiet = np.quantile(samples, 0.25, axis=0)
    return samples / np.median(samples / quiet, axis=-1, keepdims=True)


def estimate(values: np.ndarray) -> Estimate:
    """Median over rounds of an array with one value a round, with its error and spread."""
    low, middle, high = np.quantile(values, (0.25, 0.5, 0.75))
    error = MEDIAN_ERROR * (high - low) / np.sqrt(len(values))
    return Estimate(middle, error, high - low)


def onward(engine: Engine, steps: int, series: Series | None = None) -> float:
    """Processor time of `steps` steps, in s: what other programs do meanwhile does not count.

    The record of touches is emptied when it is full.
    """
    seconds = 0.0
    while steps > 0:
        begin = thread_time()
        steps -= engine.go(steps, series)
        seconds += thread_time() - begin
        if engine.record is not None:
            engine.record.count[0] = 0
    return seconds


def seconds_per_period(scenes: Sequence[Scene]) -> np.ndarray:
    """Median processor seconds of a period of each scene under way, without an energy ledger."""

    def sampler(scene: Scene) -> Sampler:
        engine = prepare(scene, ledger=False)
        onward(engine, SETTLE_PERIODS * engine.per)
        return lambda: onward(engine, SAMPLE_PERIODS * engine.per) / SAMPLE_PERIODS

    return np.median(in_turn([*map(sampler, scenes)], SAMPLES), axis=0)


def machine() -> dict[str, Any]:
    """Processor, cores and versions of this machine."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text(encoding="utf-8").splitlines() if cpuinfo.is_file() else []
    named = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return {
        "processor": named[0] if named else platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def measured_here() -> dict[str, Any]:
    """Words for this machine, and its load: they stand among the data that are measured on it."""
    this = machine()
    words = f"{this['processor']}, {this['cores']} cores; python {this['python']}"
    words += f", numpy {this['numpy']}, numba {this['numba']}"
    return {"machine": words, "load": os.getloadavg()[0]}


def machine_line(*data: Mapping[str, Any]) -> str:
    """Words for the machines on which data were measured, and for the largest load at a start."""
    machines = sorted({str(d["machine"]) for d in data})
    return f"{'; '.join(machines)}; load {max(d['load'] for d in data):.1f} at the start"
