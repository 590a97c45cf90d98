"""Work that `figures paper` has left to do; about how long it takes on the machine of prices."""

from pathlib import Path

from joblib import cpu_count

from md.host import step_of
from md.sweep import Point

from .. import FIGURES, load
from ..claims import measure_annulus, measure_rows
from ..lib.data import stored_data
from ..lib.drawing import files_of
from ..lib.runs import lacking

OF_CLAIMS = (measure_rows, measure_annulus)  # runs that no figure shows
CLAIMS_SECONDS = 30  # processor seconds of movie and claims, runs of the store apart
STEP_SECONDS = {True: 50e-9, False: 330e-9}  # a step of a rod in full runs: row, annulus


def left(out: Path) -> list[str]:
    """Figures whose files in `out` are not there, not in full, or of other sources."""
    return [
        name
        for name in FIGURES
        if not all((out / file).is_file() for file in files_of(name))
        or stored_data(name, False, out) is None
    ]


def missing() -> list[Point]:
    """Points of figures and claims whose runs the store does not hold, each once."""
    modules = [*map(load, FIGURES), *OF_CLAIMS]
    sweeps = [sweep for m in modules if hasattr(m, "sweeps") for sweep in m.sweeps().values()]
    return lacking(point for sweep in sweeps for point in sweep.points)


def run_seconds(points: list[Point]) -> float:
    """Processor seconds of runs, by their rods and steps; a run to a tolerance counts as none."""
    return sum(
        STEP_SECONDS[point.scene.annulus is None]
        * point.periods
        * step_of(point.scene)[1]
        * point.scene.rods.count
        for point in points
    )


def in_words(seconds: float) -> str:
    """Seconds, or whole minutes from 90 seconds on."""
    return f"{seconds / 60:.0f} min" if seconds > 90 else f"{seconds:.0f} s"


def estimate(out: Path) -> str:
    """Sentence on what is left and how long it takes, at most."""
    points, names, cores = missing(), left(out), cpu_count()
    runs = run_seconds(points) / cores
    others = sum(FIGURES[name].seconds for name in names) + CLAIMS_SECONDS
    return (
        f"{len(points)} runs that the store lacks: {in_words(runs)} on {cores} cores; "
        f"{len(names)} figures of {len(FIGURES)}, movie and claims: {in_words(others)}; "
        f"in all about {in_words(runs + others)} and the time to compile, if nothing else runs"
    )
