"""The paper's statements on a row over its tilt, judged for rods of one's own.

The rods stand in boxes that give the nominal tilts, from four starts each; the theory has the
friction and restitution of their plate. Statements on annuli, single impacts, other accelerations
or frictions have no part here.
"""

from collections import Counter
from typing import Any

from joblib import cpu_count

from md.cache import digest

from ..lib.runs import row_of, tilt_plan, tilts
from ..pages.everything import in_words, run_seconds
from . import over_tilt
from .judge import MARKS, limits_shown, shown, verdict
from .limits import VERDICTS, deviation, read
from .uncertainty import resampled


def estimate(scene: str, quick: bool = False) -> str:
    """Sentence on what is to be run, and about how long it takes.

    Parameters
    ----------
    scene : file, or name of an example of `md`
    quick : fewer tilts, shorter runs
    """
    points, cores = tilt_plan(quick, scene=scene).points, cpu_count()
    seconds = run_seconds([*points]) / cores
    time = f"about {in_words(seconds)}, compiling apart"
    return f"{len(points)} runs, of which the store may hold some: {time}"


def judged(scene: str, quick: bool = False) -> dict[str, Any]:
    """Statements with their numbers and verdicts for a scene; runs what the store does not hold.

    Parameters
    ----------
    scene, quick : as of `estimate`
    """
    row, nominal = row_of(scene), tilts(quick)
    table = over_tilt.table(tilt_plan(quick, scene=scene), nominal, own=True)
    rows = []
    for claim in read():
        for limits in claim["numbers"]:
            name = f"{claim['id']}.{limits['key']}"
            if "holds" not in limits or name not in over_tilt.NUMBERS:
                continue
            number = resampled(table, over_tilt.NUMBERS[name])
            found = {"value": float(number.value), "error": float(number.error)}
            found["deviation"] = deviation(number.value, limits)
            rows.append({"id": claim["id"], **limits, **found, "verdict": verdict(number, limits)})
    made = {"scene": scene, "quick": quick, "md": digest()}
    return {"provenance": made, "rods": row.words, "statements": rows}


def brief(report: dict[str, Any]) -> str:
    """A line a statement, and how many have each verdict."""
    lines = [report["rods"].replace("$", "").replace("\\,", " ").replace("\\", "")]
    for row in report["statements"]:
        asked = f"asked {limits_shown(row['holds'])}"
        lines.append(f"{MARKS[row['verdict']]} {row['id']:4}{row['name']}: {shown(row)}, {asked}")
    verdicts = Counter(row["verdict"] for row in report["statements"])
    counted = (f"{MARKS[name]} {name}: {verdicts[name]}" for name in VERDICTS if verdicts[name])
    return "\n".join([*lines, ", ".join(counted)])
