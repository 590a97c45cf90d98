"""Times of several calls on a machine that is not quiet: taken in turn, compared round by round.

In a round every call is timed once at each place, in a new random order, so that no call always
follows the same one. Differences are those of one round and place: what slows the machine down for
longer than a round falls on both. What is left of it, a speed that changes from round to round, is
divided out: the speed of a round is the median over all calls of their time over its own lower
quartile, so that times are those of the quieter rounds. Rounds come in blocks, and the calls may be
made again for each: where code and arrays lie in memory moves times by up to three per cent, and is
thus part of the error, which is that of resampled blocks.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from time import perf_counter, thread_time
from typing import Any, NamedTuple

import numpy as np
from tqdm import tqdm

from impact.benchmark import machine
from md.cache import kernel
from md.host import Engine, prepare
from md.kernels import plane
from md.scene import Scene

RESAMPLED = 400  # of the bootstrap
LONG_ENOUGH = 1e-3  # seconds of one sample


class Estimate(NamedTuple):
    """Median, its standard error and the interquartile range; means over places."""

    value: float
    error: float
    spread: float


def waited(items: Iterable, desc: str, unit: str = "it") -> tqdm:
    """The items, with a progress bar on a terminal once they have taken two seconds."""
    return tqdm(items, desc=desc, unit=unit, disable=None, leave=False, delay=2)


def interleaved(
    prepare: Callable[[np.random.Generator], Sequence[Callable[[int], float]]],
    blocks: int,
    rounds: int = 1,
    places: int = 1,
    seed: int = 0,
) -> np.ndarray:
    """Samples of all calls, (blocks, rounds, places, calls).

    Parameters
    ----------
    prepare : gives the calls of a block; each makes one sample at a place and returns its time
    blocks, rounds, places : how many, rounds of a block
    seed : of the orders
    """
    random, samples = np.random.default_rng(seed), []
    for _ in waited(range(blocks), "timing", "block"):
        calls = prepare(random)
        samples.append(np.empty((rounds, places, len(calls))))
        for turn, place in np.ndindex(rounds, places):
            for number in random.permutation(len(calls)):
                samples[-1][turn, place, number] = calls[number](place)
    return np.array(samples)


def _sampler(call: Callable[[int], Any]) -> Callable[[int], float]:
    """Seconds of one of so many repetitions that a sample is long enough."""

    def sample(times: int) -> float:
        begin = perf_counter()
        call(times)
        return (perf_counter() - begin) / times

    call(1)  # compiles
    often = max(1, round(LONG_ENOUGH / sample(1)))
    return lambda _: sample(often)


def medians(calls: Sequence[Callable[[int], Any]], runs: int = 7) -> np.ndarray:
    """Median seconds of each of several calls, taken in turn, after two that do not count.

    Parameters
    ----------
    calls : each does its work as many times as its argument says
    runs : samples of each
    """
    samplers = [_sampler(call) for call in calls]
    return np.median(interleaved(lambda _: samplers, runs), axis=(0, 1, 2))


def repeated(call: Callable[[], Any]) -> Callable[[int], Any]:
    """A call for `medians`: the result of the last of so many repetitions."""

    def repeat(times: int) -> Any:
        for _ in range(times):
            result = call()
        return result

    return repeat


def steady(samples: np.ndarray) -> np.ndarray:
    """Samples at one speed of the machine, that of the quieter rounds."""
    quiet = np.quantile(samples, 0.25, axis=(0, 1))
    return samples / np.median(samples / quiet, axis=-1, keepdims=True)


def estimate(values: np.ndarray, seed: int = 0) -> Estimate:
    """Of values (blocks, rounds, places): median over a block, then over blocks."""
    of_blocks = np.median(values, axis=1)
    drawn = np.random.default_rng(seed).integers(0, len(values), (RESAMPLED, len(values)))
    resampled = np.median(of_blocks[drawn], axis=1).mean(axis=1)
    low, high = np.quantile(values, (0.25, 0.75), axis=(0, 1)).mean(axis=1)
    middle = np.median(of_blocks, axis=0).mean()
    return Estimate(float(middle), float(resampled.std()), float(high - low))


@contextmanager
def reloading() -> Iterator[Callable[[], None]]:
    """A function that loads the code of a step once more, to another place in memory."""
    usual = plane.march

    def again() -> None:
        plane.march = kernel(inline=False)(usual.py_func)

    try:
        yield again
    finally:
        plane.march = usual


def onward(engine: Engine, steps: int, series: plane.Series | None = None) -> float:
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


def seconds_per_period(
    scenes: Sequence[Scene], rounds: int = 7, periods: int = 6, settle: int = 20
) -> np.ndarray:
    """Median processor seconds of a period of each scene under way, without an energy ledger.

    Parameters
    ----------
    scenes : timed in turn
    rounds, periods : samples of each, and their length
    settle : periods before
    """

    def sampler(scene: Scene) -> Callable[[int], float]:
        engine = prepare(scene, ledger=False)
        onward(engine, settle * engine.per)
        return lambda _: onward(engine, periods * engine.per) / periods

    samplers = [*map(sampler, scenes)]
    return np.median(interleaved(lambda _: samplers, rounds), axis=(0, 1, 2))


def machine_line(load: float) -> str:
    """Processor, versions and load."""
    this = machine()
    return (
        f"{this['processor']}, {this['cores']} cores, load {load:.1f} at the start; python"
        f" {this['python']}, numpy {this['numpy']}, numba {this['numba']}"
    )
