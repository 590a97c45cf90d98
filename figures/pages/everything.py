"""Work that `figures paper` has left to do, and about how long it takes."""

from pathlib import Path
from time import thread_time

import numpy as np
from joblib import Parallel, cpu_count, delayed

import md
from md.host import step_of
from md.scene import Scene
from md.store import Store
from md.sweep import Point

from .. import FIGURES, load
from ..claims import measure_annulus, measure_rows
from ..lib.data import stored_data
from ..lib.runs import store

OF_CLAIMS = (measure_rows, measure_annulus)  # runs that no figure shows
CLAIMS_SECONDS = 30  # processor seconds of movie and claims, runs of the store apart
SAMPLES, SETTLE, TIMED = 12, 3, 12  # runs that are timed of each kind; periods of each


def left(out: Path) -> list[str]:
    """Figures whose files in `out` are not there, not in full, or of other sources."""
    return [
        name
        for name in FIGURES
        if not all((out / f"{name}.{kind}").is_file() for kind in ("png", "pdf"))
        or stored_data(name, False, out) is None
    ]


def missing() -> list[Point]:
    """Runs of the figures and claims that the store does not hold, none twice."""
    modules = [*map(load, FIGURES), *OF_CLAIMS]
    sweeps = [sweep for m in modules if hasattr(m, "sweeps") for sweep in m.sweeps().values()]
    with Store(store()) as database:
        points = {point.key: point for sweep in sweeps for point in sweep.points}
        return [point for key, point in points.items() if not database.has(key)]


def rod_steps(point: Point) -> int:
    """Steps times rods of a run; 0 where a tolerance says how long it is."""
    return point.periods * step_of(point.scene)[1] * point.scene.rods.count


def timed(scene: Scene) -> float:
    """Processor seconds of a step of a rod in a run under way; 0 for a run that fails."""
    seconds = []
    try:
        md.run(scene, periods=1)  # compiles
        for periods in (SETTLE, SETTLE + TIMED):
            begin = thread_time()
            md.run(scene, periods=periods)
            seconds.append(thread_time() - begin)
    except md.RunError:
        return 0.0
    return max(seconds[1] - seconds[0], 0.0) / (TIMED * step_of(scene)[1] * scene.rods.count)


def run_seconds(points: list[Point]) -> float:
    """Processor seconds of runs, but for compiling: rows and annuli, each kind by a sample.

    A run is drawn as often as its part of the work, so that the mean over the sample is the mean
    over all steps. All cores time at once, as they will run.
    """
    random, total = np.random.default_rng(1), 0.0
    for plane in (True, False):
        alike = [point for point in points if (point.scene.annulus is None) is plane]
        work = np.array([rod_steps(point) for point in alike])
        if work.sum():
            drawn = random.choice(len(alike), SAMPLES, p=work / work.sum())
            step = Parallel(n_jobs=-1)(delayed(timed)(alike[i].scene) for i in drawn)
            total += work.sum() * float(np.mean(step))
    return total


def in_words(seconds: float) -> str:
    """Seconds, or whole minutes from 90 seconds on."""
    return f"{seconds / 60:.0f} min" if seconds > 90 else f"{seconds:.0f} s"


def estimate(out: Path) -> str:
    """Sentence on what is left and how long it takes, at most."""
    points, names, cores = missing(), left(out), cpu_count()
    for module in map(load, names):
        points += module.later() if hasattr(module, "later") else []
    runs = run_seconds(points) / cores
    others = sum(FIGURES[name].seconds for name in names) + CLAIMS_SECONDS
    return (
        f"{len(points)} runs that the store lacks: {in_words(runs)} on {cores} cores; "
        f"{len(names)} figures of {len(FIGURES)}, movie and claims: {in_words(others)}; "
        f"in all about {in_words(runs + others)} and the time to compile, if nothing else runs"
    )
