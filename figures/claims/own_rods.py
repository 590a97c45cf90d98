"""The paper's statements on a row over its tilt, judged for rods of one's own.

The rods stand in boxes that give the nominal tilts, from four starts each; of a row that turns over
the mirror image counts. The theory has the friction and restitution of their plate. Statements on
annuli, single impacts, other accelerations or frictions have no part here.
"""

from collections import Counter
from collections.abc import Iterator

from joblib import cpu_count

from md.cache import digest

from ..lib.runs import along_lean, lacking, row_of, tilt_plan, tilts
from ..pages.everything import in_words, run_seconds
from . import over_tilt
from .any_rods import KEPT_DEG
from .judge import MARKS, judged_number, limits_shown, shown
from .limits import VERDICTS, Record
from .uncertainty import resampled


def estimate(scene: str, quick: bool = False) -> Iterator[str]:
    """Sentences on what the store holds and, if it lacks something, on how long the rest takes.

    On the machine of prices, by rods and steps; upright rows take longer than flat ones.

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
        seconds = run_seconds(left) / cpu_count()
        yield f"those left take about {in_words(seconds)} and the time to compile"


def judged(scene: str, quick: bool = False) -> Record:
    """Statements with their numbers and verdicts for a scene; runs what the store does not hold.

    Parameters
    ----------
    scene, quick : as of `estimate`
    """
    row = row_of(scene)
    plan = tilt_plan(quick, scene=scene)
    table = over_tilt.table(plan, tilts(quick), own=True, read=along_lean)
    rows = [
        judged_number(resampled(table, over_tilt.NUMBERS[name]), limits)
        for name, limits in over_tilt.JUDGED.items()
    ]
    return {
        "provenance": {"scene": scene, "quick": quick, "md": digest()},
        "rods": row.words,
        "tilt_off_deg": float(over_tilt.NUMBERS["S2.largest"](table)),
        "statements": rows,
    }


def brief(report: Record) -> str:
    """What the paper says, below it a line a statement; how many have each verdict."""
    rods = report["rods"].replace("$", "").replace("\\,", " ").replace("\\", "")
    said, lines = "", [f"{rods}. The paper says:"]
    if not (off := report["tilt_off_deg"]) <= KEPT_DEG:
        lines.append(
            f"warning: the tilt is up to {off:.1f} degrees off acos(d N/L): these are no rows as "
            "the paper has them, and what is judged means little"
        )
    for row in report["statements"]:
        if row["says"] != said:
            said = row["says"]
            lines.append(f"{row['id']:4}{said}")
        asked = f"{row['name']}: {shown(row)}, asked {limits_shown(row['holds'])}"
        lines.append(f"    {MARKS[row['verdict']]} {row['verdict']}: {asked}")
    verdicts = Counter(row["verdict"] for row in report["statements"])
    counted = (f"{MARKS[name]} {name}: {verdicts[name]}" for name in VERDICTS if verdicts[name])
    return "\n".join([*lines, ", ".join(counted)])
