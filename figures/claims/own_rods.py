"""The paper's statements on a row over its tilt, judged for rods of one's own.

The rods stand in boxes that give the nominal tilts, from four starts each; the theory has the
friction and restitution of their plate. Statements on annuli, single impacts, other accelerations
or frictions have no part here.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from joblib import cpu_count

from md.cache import digest
from md.store import Store
from md.sweep import Point, Sweep, execute

from ..lib.runs import lacking, row_of, tilt_plan, tilts
from ..pages.everything import in_words
from . import over_tilt
from .judge import MARKS, judged_number, limits_shown, shown
from .limits import VERDICTS
from .uncertainty import resampled

EACH, TRIED_PERIODS = 8, 20  # of the runs, one in `EACH` is tried


def estimate(scene: str, quick: bool = False) -> Iterator[str]:
    """Sentences on what the store holds and, if it lacks something, on how long the rest takes.

    Some of the runs are timed, much shortened: upright rows take five times as long as flat ones.

    Parameters
    ----------
    scene : file, or name of an example of `md`
    quick : fewer tilts, shorter runs
    """
    points = tilt_plan(quick, scene=scene).points
    left = lacking(points)
    there = len(points) - len(left) or "none"
    yield f"{len(points)} runs, {there if left else 'all'} of them stored"
    if left:
        seconds = _seconds(left) / cpu_count()
        yield f"those left take about {in_words(seconds)}, by short ones"


def _seconds(points: list[Point]) -> float:
    """Processor seconds of runs by those of short ones, in as many processes; compiles."""
    tried = tuple(replace(point, periods=TRIED_PERIODS) for point in points[::EACH])
    with TemporaryDirectory() as folder:
        store = Path(folder, "tried.db")
        execute(Sweep((), tried), store, progress=True)
        with Store(store) as database:
            found = [database.result(point.key) or {} for point in tried]
    spent = sum(result.get("run_seconds", 0.0) for result in found)
    return spent / len(tried) * sum(point.periods for point in points) / TRIED_PERIODS


def judged(scene: str, quick: bool = False) -> dict[str, Any]:
    """Statements with their numbers and verdicts for a scene; runs what the store does not hold.

    Parameters
    ----------
    scene, quick : as of `estimate`
    """
    row, nominal = row_of(scene), tilts(quick)
    table = over_tilt.table(tilt_plan(quick, scene=scene), nominal, own=True)
    rows = [
        judged_number(resampled(table, over_tilt.NUMBERS[name]), limits)
        for name, limits in over_tilt.JUDGED.items()
    ]
    made = {"scene": scene, "quick": quick, "md": digest()}
    return {"provenance": made, "rods": row.words, "statements": rows}


def brief(report: dict[str, Any]) -> str:
    """What the paper says, below it a line a statement; how many have each verdict."""
    rods = report["rods"].replace("$", "").replace("\\,", " ").replace("\\", "")
    said, lines = "", [f"{rods}. The paper says:"]
    for row in report["statements"]:
        if row["says"] != said:
            said = row["says"]
            lines.append(f"{row['id']:4}{said}")
        asked = f"{row['name']}: {shown(row)}, asked {limits_shown(row['holds'])}"
        lines.append(f"    {MARKS[row['verdict']]} {row['verdict']}: {asked}")
    verdicts = Counter(row["verdict"] for row in report["statements"])
    counted = (f"{MARKS[name]} {name}: {verdicts[name]}" for name in VERDICTS if verdicts[name])
    return "\n".join([*lines, ", ".join(counted)])
