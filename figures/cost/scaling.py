"""Time of a period over the number of rods, and work done at once over the number of cores.

(a) The row of the other figures with all that a run measures, settled, at the same tilt and
density: the length of the box grows with the number of rods. (b) Independent runs of a sweep, four
for each core, from the call to the last result in the store, processes already there; the broken
line is the first point times the number of cores. Medians of samples taken in turn. (a) is the
time of the processor; (b) is by the clock: a machine that does other work meanwhile has less to
give.
"""

import os
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, perf_counter, sleep

import numpy as np
from joblib import Parallel, cpu_count, delayed, parallel_config
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import md
from md.host import prepare
from md.scene import from_tables, put
from md.sweep import execute

from ..lib.runs import SIMPLE_ROW, planned, starts
from ..lib.style import BLACK, BLUE, GUIDE, Data, log_log, note, painted, style
from ..lib.timing import (
    Sampler,
    estimate,
    in_turn,
    machine_line,
    measured_here,
    onward,
    steady,
    waited,
)

ROW_SIZES = (10, 20, 40, 80, 160, 320, 640, 1250, 2500, 5000)  # a third of them if quick
LEAST = 320  # rods a sample is about, with one period each
SPACING = SIMPLE_ROW["box"]["length"] / SIMPLE_ROW["rods"]["count"]
RUNS_PER_CORE, SWEEP_PERIODS = 4, 40  # of each core, and of each run
CORE_LEVELS = 5  # numbers of cores, at most
SCALING_ROUNDS, SCALING_SETTLE = {True: 9, False: 31}, {True: 10, False: 40}
REPEATS = {True: 5, False: 15}  # of a sweep


def _row(count: int) -> md.Scene:
    """Row of `count` rods at the tilt and density of the other figures."""
    return from_tables(put(SIMPLE_ROW, {"rods.count": count, "box.length": count * SPACING}))


def _periods(count: int, settle: int) -> Sampler:
    """Processor time of a step of a rod in a settled row, over whole periods."""
    engine = prepare(_row(count))

    def sample(periods: int = max(1, LEAST // count)) -> float:
        engine.step %= engine.per
        steps = periods * engine.per
        return onward(engine, steps, engine.series(periods)) / steps / count

    sample(settle)
    return sample


def _meet(folder: str, workers: int) -> None:
    """Load the code of a run in this process, and wait until all others have."""
    md.run(_row(40), periods=1)
    (Path(folder) / f"{os.getpid()}").touch()
    give_up = monotonic() + 60
    while len(list(Path(folder).iterdir())) < workers and monotonic() < give_up:
        sleep(0.01)


def _sweeping(workers: int) -> Sampler:
    """Time of a step of a rod in as many runs at once as there are workers."""
    sweep = planned([starts(RUNS_PER_CORE * workers)], SWEEP_PERIODS, base=SIMPLE_ROW)
    engine = prepare(sweep.points[0].scene)
    work = len(sweep.points) * SWEEP_PERIODS * engine.per * len(engine.rods)

    def sample() -> float:
        with TemporaryDirectory() as folder:
            ready = [delayed(_meet)(folder, workers)] * workers
            with parallel_config("loky"):
                Parallel(n_jobs=workers, batch_size=1)(ready)
            begin = perf_counter()
            execute(sweep, Path(folder) / "runs.db", workers=workers)
            return (perf_counter() - begin) / work

    return sample


def _estimates(samples: np.ndarray) -> np.ndarray:
    """Value, error and interquartile range of each call, (calls, 3), in ns."""
    return np.array([estimate(1e9 * times) for times in steady(samples).T])


def data(quick: bool = False) -> Data:
    """Times in ns per step of a rod, (value, error, interquartile range)."""
    here = measured_here()
    counts = ROW_SIZES[:: 3 if quick else 1]
    rows = [_periods(count, SCALING_SETTLE[quick]) for count in waited(counts, "settling", "row")]
    by_count = in_turn(rows, SCALING_ROUNDS[quick])
    cores = cpu_count()
    workers = np.unique(np.geomspace(1, cores, min(cores, CORE_LEVELS)).round().astype(int))
    sweeps = [_sweeping(int(count)) for count in workers]
    return {
        "counts": np.array(counts),
        "row": _estimates(by_count),
        "steps_per_period": np.int64(prepare(_row(40)).per),
        "workers": workers,
        "sweep": _estimates(in_turn(sweeps, REPEATS[quick])),
        **here,
    }


def _throughput(d: Data) -> tuple[np.ndarray, np.ndarray]:
    """Million steps of a rod in a second, and the error."""
    value, error, _ = d["sweep"].T
    return 1e3 / value, 1e3 / value**2 * error


def panel(ax: Axes, d: Data) -> None:
    """Time of a period over the number of rods, beside a line of the slope 1.

    Bars are half of the interquartile range to either side.
    """
    counts = d["counts"]
    ms, _, spread = d["row"].T * counts * d["steps_per_period"] * 1e-6
    guide = np.median(ms / counts) * counts
    ax.plot(counts, guide, "--", **GUIDE, label="proportional to $N$")
    ax.errorbar(counts, ms, spread / 2, fmt="o", color=BLUE, ms=3, lw=0.8, label="measured")
    log_log(ax, xlabel="number of rods $N$", ylabel="time of a period (ms)")
    rate = _throughput(d)[0]
    gains = [*zip(d["workers"], rate / rate[0], strict=True)][1:]
    words = [f"{np.median(d['row'][:, 0]):.1f} ns per\nstep of a rod"]
    words += [f"{n} cores:\n{gain:.2f} times one" for n, gain in gains]
    ax.text(0.97, 0.04, "\n".join(words), ha="right", transform=ax.transAxes)
    ax.legend(loc="upper left")


def _draw_cores(ax, d):
    (rate, error), workers = _throughput(d), d["workers"]
    ends = np.array([0, workers[-1]])
    ax.plot(ends, rate[0] * ends, "--", **GUIDE, label="proportional to cores")
    ax.errorbar(workers, rate, error, fmt="s", color=BLACK, ms=3, lw=0.8, label="measured")
    ax.set(
        xlabel="cores",
        xlim=(0, 1.1 * workers[-1]),
        ylabel="million steps of a rod per second",
        ylim=(0, 1.1 * rate[0] * workers[-1]),
    )
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.legend(loc="upper left")


@style
def draw(d: Data) -> Figure:
    panels = {"a period": panel, "many runs": _draw_cores}
    figure = painted(d, panels, 2.7)
    note(figure, machine_line(d))
    return figure
