"""Verdicts on the paper's claims: grades of measured numbers by the limits of claims.toml.

A claim holds if all its judged numbers lie within `holds`, does not hold if none lies even within
`partly`, else it holds in part. A number that cannot be had leaves its claim, and no other, open.
"""

import json
import math
import platform
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

import md
from impact._generated import DIGEST
from md.sources import digest

from .limits import GRADES, MISSING, grade, read, verdict
from .uncertainty import MEASURES, Number, resampled

MARKS = {None: "", 0: "-", 1: "~", 2: "+"}
NEARLY = 0.95  # part of the laws that is nearly all
CHOOSES = "S2"  # the claim by which laws that keep the tilt are chosen
NO_DATA = (md.RunError, np.linalg.LinAlgError)  # a run has failed; a fit through missing points


def measure(claim: str, evidence: Any) -> dict[str, Number]:
    """Numbers of a claim by key: those of the row over tilt, and those of its `MEASURES`.

    Parameters
    ----------
    claim : as "S13"
    evidence : the data, `evidence.Evidence`
    """
    # Late: pages need no compiled code; the modules fill `MEASURES`.
    from . import measure_annulus, measure_rows, over_tilt  # noqa: F401

    found = {}
    for name, number in over_tilt.NUMBERS.items():
        if name.startswith(f"{claim}."):
            found[name.partition(".")[2]] = resampled(evidence.over_tilt, number)
    for function in MEASURES.get(claim, ()):
        found |= function(evidence)
    return found


def close(number: Number, limits: dict[str, Any]) -> bool:
    """Whether a limit is as near as two standard errors, or one error of another notion."""
    random = number.notion == "standard error"
    borders = (*limits.get("holds", ()), *limits.get("partly", ()))
    if random and borders and math.isfinite(number.value) and math.isnan(number.error):
        return True  # in some draws the value is not there
    reach = (2 if random else 1) * number.error
    return any(abs(number.value - border) <= reach for border in borders if math.isfinite(border))


def _judged(claim: dict[str, Any], evidence: Any) -> dict[str, Any]:
    """The claim with its numbers, their grades and the verdict."""
    try:
        measured = measure(claim["id"], evidence)
    except NO_DATA as failure:
        trouble = f"{type(failure).__name__}: {' '.join(str(failure).split())}"
        return {**claim, "verdict": MISSING, "trouble": trouble}
    rows = []
    for limits in claim["numbers"]:
        number = Number(*measured[limits["key"]])
        value, error = float(number.value), float(number.error)
        row = {**limits, "value": value, "error": error, "notion": number.notion}
        rows.append({**row, "grade": grade(value, limits), "close": close(number, limits)})
    of = verdict([row["grade"] for row in rows if "holds" in row])
    trouble = "runs are missing or have failed" if of == MISSING else ""
    return {**claim, "numbers": rows, "verdict": of, "trouble": trouble}


def _told(claim: dict[str, Any]) -> dict[str, str]:
    """Verdict and judged numbers in words."""
    numbers = (
        f"{row['name']}: {shown(row)} ({MISSING if row['grade'] is None else GRADES[row['grade']]})"
        for row in judged_rows(claim)
    )
    return {"verdict": claim["verdict"], "numbers": "; ".join(numbers)}


def judge(quick: bool = False, progress: bool = False, out: Path | None = None) -> dict[str, Any]:
    """Judge all claims: what was measured, the verdicts, and where they come from.

    Runs what it needs, for minutes, as far as the store and the figures in `out` do not hold it.

    Parameters
    ----------
    quick : the figures' quick data, shorter and coarser
    progress : a bar with the time left, on a terminal
    out : folder of figures that were drawn; current data there are read, not computed
    """
    from tqdm import tqdm

    from impact.benchmark import machine

    from . import across_laws  # late, as in `measure`
    from .evidence import ASSUMED, Assumed, Evidence
    from .over_laws import outcome

    evidence, simple, judged = Evidence(quick, out), Assumed(quick), []
    searched = evidence.figure("which_law")
    look = {"desc": "judging", "unit": "claim", "leave": False}
    bar = tqdm(read(), disable=None if progress else True, **look)
    for claim in bar:
        bar.set_postfix_str(claim["id"])
        found = _judged(claim, evidence)
        if claim["figure"] in ASSUMED:
            found["assumed"] = _told(_judged(claim, simple))
        judged.append(found)
    made = machine() | {"system": platform.system(), "md": digest(annulus=True, tolerance=True)}
    made |= {"impact": DIGEST, "quick": quick}
    search = {**outcome(searched), **across_laws.told(searched)}
    return {"provenance": made, "search": search, "claims": judged}


TEXTS = ("id", "verdict", "says", "figure", "trouble")
OF_A_NUMBER = {"name", "value", "error", "grade", "close"}


def load(path: Path) -> dict[str, Any]:
    """Report from a JSON file; null as the value of a judged number was inf, else nan.

    Raises
    ------
    ValueError
        If the file is no JSON, or not of the claims.
    """
    report = json.loads(path.read_text(encoding="utf-8"))
    try:
        claims = [
            {**c, "numbers": [_restored(row) for row in c["numbers"]]} for c in report["claims"]
        ]
        texts = [claim[key] for claim in claims for key in TEXTS]
        whole = all(row.keys() >= OF_A_NUMBER for claim in claims for row in judged_rows(claim))
        if not (texts and whole and all(isinstance(text, str) for text in texts)):
            raise TypeError("something is missing")
        return {**report, "claims": claims, "quick": report["provenance"]["quick"]}
    except (AttributeError, LookupError, TypeError) as error:
        raise ValueError(f"no report of the claims: {error}") from None


def _restored(row: dict[str, Any]) -> dict[str, Any]:
    """A number with the nan and inf that JSON lacks."""
    known = {"value": math.nan if row.get("grade") is None else math.inf, "error": math.nan}
    known |= {key: row[key] for key in known if row.get(key) is not None}
    ends = (-math.inf, math.inf)
    limits: dict[str, Any] = {
        key: [end if x is None else x for x, end in zip(row[key], ends, strict=True)]
        for key in ("holds", "partly")
        if key in row
    }
    return {**row, **limits, **(known if "value" in row else {})}


def shown(row: dict[str, Any]) -> str:
    """A number with its error and unit, to two digits of the error."""
    value, error, unit = row["value"], row["error"], f" {row['unit']}" if "unit" in row else ""
    if not math.isfinite(value):
        return "no data" if math.isnan(value) else "never"
    if not error > 0:
        return f"{value:.4g}{unit}"
    digits = max(1 - math.floor(math.log10(error)), 0)
    if digits > 6:
        return f"{value:.4g} ± {error:.0e}{unit}"
    return f"{value:.{digits}f} ± {error:.{digits}f}{unit}"


def limits_shown(limits: list[float] | None) -> str:
    """An interval in words."""
    if limits is None:
        return ""
    low, high = limits
    if math.isinf(low) or math.isinf(high):
        return f"≤ {high:g}" if math.isinf(low) else f"≥ {low:g}"
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def counts(report: dict[str, Any]) -> str:
    """Number of claims with each verdict."""
    found = Counter(claim["verdict"] for claim in report["claims"])
    kinds = (*reversed(GRADES), MISSING)
    return ", ".join(f"{kind}: {found[kind]}" for kind in kinds if found[kind])


def score(report: dict[str, Any]) -> tuple[float, int]:
    """Numbers of the search's score that the report's law obeys, those in part half; how many."""
    fitted = (c for c in report["claims"] if c["fitted"] and not c["own_law"])
    grades = [row["grade"] or 0 for c in fitted for row in judged_rows(c) if "head" in row]
    return sum(grades) / 2, len(grades)


def trust(report: dict[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Numbers that hold under nearly all contact laws, under some, under hardly any.

    Each with its claim's `id` and what the search says of it. Without those of the claim by which
    the laws were chosen.
    """
    found: dict[str, list[dict[str, Any]]] = {"all": [], "some": [], "none": []}
    for name, (claim, row) in numbers(report).items():
        of = report["search"]["numbers"].get(name)
        if of is None or claim["id"] == CHOOSES:
            continue
        part = of["counts"][0] / sum(of["counts"])
        group = "all" if part >= NEARLY else "none" if part <= 1 - NEARLY else "some"
        found[group].append({"id": claim["id"], **row, **of})
    return found


def numbers(report: dict[str, Any]) -> dict[str, tuple[dict[str, Any], dict[str, Any]]]:
    """All numbers of a report, by claim and key ("S16.peak"): the claim, the number."""
    return {f"{c['id']}.{row['key']}": (c, row) for c in report["claims"] for row in c["numbers"]}


def ids(claim: dict[str, Any]) -> list[str]:
    """Names of the numbers of a claim, as "S16.peak"."""
    return [f"{claim['id']}.{row['key']}" for row in claim["numbers"]]


def slashed(counts: list[int]) -> str:
    """Counts of laws under which a number holds, holds in part, does not."""
    return "/".join(map(str, counts))


def share(claim: dict[str, Any]) -> str:
    """How many of the judged numbers hold, of a claim that holds in part."""
    grades = [row["grade"] for row in judged_rows(claim)]
    return f" ({grades.count(2)} of {len(grades)})" if claim["verdict"] == GRADES[1] else ""


def judged_rows(claim: dict[str, Any]) -> list[dict[str, Any]]:
    """The judged numbers of a claim, if they are there."""
    return [row for row in claim["numbers"] if "holds" in row and "value" in row]


def brief(report: dict[str, Any]) -> str:
    """A line a claim: verdict, and each judged number with + holds, ~ in part, - does not."""
    lines = []
    for claim in report["claims"]:
        cells = (f"{row['key']} {shown(row)} {MARKS[row['grade']]}" for row in judged_rows(claim))
        lines.append(f"{claim['id']:4}{claim['verdict']:20}{', '.join(cells)}{claim['trouble']}")
    return "\n".join([*(line.rstrip() for line in lines), counts(report)])
