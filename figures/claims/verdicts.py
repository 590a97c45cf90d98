"""The paper's claims, judged: `claims.toml` holds them and their limits, `measured` the numbers.

>>> from figures.claims import verdicts as claims
>>> len(claims.read())
29
>>> claims.verdict([2, 1, 2])  # of a claim, from the grades of its numbers
'holds in part'

`judge()` runs what it needs, for minutes; `page` and `brief` show what it found. A claim holds if
all its judged numbers lie within `holds`, does not hold if none lies even within `partly`, else it
holds in part. A number that cannot be had leaves its claim, and no other, open.
"""

import math
import platform
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

from impact._generated import DIGEST
from md.simulation import finite
from md.sources import digest

from .number import Number

GRADES = ("does not hold", "holds in part", "holds")
MISSING, UNBUILT = "not measured", "scene not built yet"
MARKS = {None: "", 0: "-", 1: "~", 2: "+"}


def read() -> list[dict[str, Any]]:
    """The claims, in the order of their numbers; those without a scene have no numbers."""
    text = Path(__file__).with_name("claims.toml").read_text(encoding="utf-8")
    empty = {"figure": "", "scene": "", "why": "", "remark": "", "numbers": []}
    return [{**empty, **claim} for claim in tomllib.loads(text)["claims"]]


def grade(value: float, limits: dict[str, Any]) -> int | None:
    """2 within `holds`, 1 within `partly`, else 0; None for what is not judged or not known."""
    if "holds" not in limits or math.isnan(value):
        return None
    return 2 if _within(value, limits["holds"]) else int(_within(value, limits["partly"]))


def _within(value: float, limits: list[float]) -> bool:
    return limits[0] <= value <= limits[1]


def close(number: Number, limits: dict[str, Any]) -> bool:
    """Whether a border is as near as two standard errors, or one error of another notion."""
    reach = (2 if number.notion == "standard error" else 1) * number.error
    borders = (*limits.get("holds", ()), *limits.get("partly", ()))
    return any(abs(number.value - border) <= reach for border in borders if math.isfinite(border))


def verdict(grades: list[int | None]) -> str:
    """Of a claim, from the grades of its judged numbers."""
    known = [grade for grade in grades if grade is not None]
    if not grades or len(known) < len(grades):
        return MISSING
    return GRADES[2 if min(known) == 2 else 0 if max(known) == 0 else 1]


def _judged(claim: dict[str, Any], quick: bool) -> dict[str, Any]:
    """The claim with its numbers, their grades and the verdict."""
    from .row_numbers import MEASURES

    found = {**claim, "verdict": UNBUILT, "trouble": ""}
    if not claim["numbers"]:
        return found
    keys, measure = MEASURES[claim["id"]]
    try:
        measured = dict(zip(keys, measure(quick), strict=True))
    except Exception as failure:
        reason = " ".join(str(failure).split())
        return {**found, "verdict": MISSING, "trouble": f"{type(failure).__name__}: {reason}"}
    rows = []
    for limits in claim["numbers"]:
        number = Number(*measured[limits["key"]])
        value, error = float(number.value), float(number.error)
        row = {**limits, "value": value, "error": error, "notion": number.notion}
        rows.append({**row, "grade": grade(value, limits), "close": close(number, limits)})
    of = verdict([row["grade"] for row in rows if "holds" in row])
    trouble = "runs are missing or have failed" if of == MISSING else ""
    return {**found, "numbers": rows, "verdict": of, "trouble": trouble}


def judge(quick: bool = False, progress: bool = False) -> dict[str, Any]:
    """All claims with what was measured, and where that comes from.

    Parameters
    ----------
    quick : the figures' quick data, shorter and coarser
    progress : a bar with the time left, on a terminal
    """
    from tqdm import tqdm

    from impact.__main__ import _machine as machine

    look = {"desc": "judging", "unit": "claim", "leave": False}
    bar = tqdm(read(), disable=None if progress else True, **look)
    judged = []
    for claim in bar:
        bar.set_postfix_str(claim["id"])
        judged.append(_judged(claim, quick))
    made = {name: value for name, value in machine().items() if name != "threads"}
    made |= {
        "system": platform.system(),
        "md": digest(annulus=True, tolerance=True),
        "impact": DIGEST,
        "quick": quick,
    }
    return {"provenance": made, "claims": judged}


def plain(report: dict[str, Any]) -> dict[str, Any]:
    """For JSON, which has neither nan nor inf."""

    def cleaned(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: cleaned(inner) for key, inner in value.items()}
        return [cleaned(inner) for inner in value] if isinstance(value, list) else finite(value)

    return cleaned(report)


def restored(report: dict[str, Any]) -> dict[str, Any]:
    """What `plain` was given, but for limits: of a judged number that has no value, nan or inf."""

    def number(row: dict[str, Any]) -> dict[str, Any]:
        nothing = math.nan if row.get("grade") is None else math.inf
        value, error = (row.get(key) for key in ("value", "error"))
        value, error = nothing if value is None else value, math.nan if error is None else error
        return {**row, "value": value, "error": error} if "value" in row else row

    judged = [{**c, "numbers": [number(row) for row in c["numbers"]]} for c in report["claims"]]
    return {**report, "claims": judged}


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


def _limits(limits: list[float] | None) -> str:
    if limits is None:
        return ""
    low, high = limits
    if math.isinf(low) or math.isinf(high):
        return f"≤ {high:g}" if math.isinf(low) else f"≥ {low:g}"
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def counts(report: dict[str, Any]) -> str:
    """How many claims hold, and how many do not."""
    found = Counter(claim["verdict"] for claim in report["claims"])
    kinds = (*reversed(GRADES), MISSING, UNBUILT)
    return ", ".join(f"{kind}: {found[kind]}" for kind in kinds if found[kind])


def judged_rows(claim: dict[str, Any]) -> list[dict[str, Any]]:
    """Its judged numbers, if they are there."""
    return [row for row in claim["numbers"] if "holds" in row and "value" in row]


def brief(report: dict[str, Any]) -> str:
    """A line a claim: verdict, and each judged number with + holds, ~ in part, - does not."""
    lines = []
    for claim in report["claims"]:
        cells = (f"{row['key']} {shown(row)} {MARKS[row['grade']]}" for row in judged_rows(claim))
        lines.append(f"{claim['id']:4}{claim['verdict']:20}{', '.join(cells)}{claim['trouble']}")
    return "\n".join([*(line.rstrip() for line in lines), counts(report)])


def _section(claim: dict[str, Any]) -> list[str]:
    """What is said of one claim."""
    lines = [f"### {claim['id']}: {claim['verdict']}", ""]
    lines += [f"The paper, {claim['section']}: {claim['says']}", ""]
    lines += [f"Measured: {claim['scene']}.", ""]
    if claim["trouble"]:
        lines += [f"No verdict: {claim['trouble']}.", ""]
    if any("value" in row for row in claim["numbers"]):
        lines += ["| | measured | error | holds | in part | |", "|---|---|---|---|---|---|"]
        for row in claim["numbers"]:
            cells = [row["name"], shown(row), row["notion"] if row["error"] > 0 else ""]
            cells += [_limits(row.get("holds")), _limits(row.get("partly"))]
            cells.append("" if row["grade"] is None else GRADES[row["grade"]])
            cells[-1] += ", close call" if row["close"] else ""
            lines.append(f"| {' | '.join(cells)} |")
        lines.append("")
    lines += [f"Limits: {claim['why']}", ""]
    lines += [f"What we make of it: {claim['remark']}", ""] if claim["remark"] else []
    picture = f"`python -m figures draw {claim['figure']}`" if claim["figure"] else "none"
    return [*lines, f"Picture: {picture}.", ""]


def page(report: dict[str, Any]) -> str:
    """The report to be read: a table, then a section for each claim that has a scene."""
    from ..lib.runs import LAW_NAME

    made, claims = report["provenance"], report["claims"]
    of = "short and coarse runs (`--quick`)" if made["quick"] else "full runs"
    lines = [
        *("# The paper's claims, judged", "", f"**{counts(report)}**", ""),
        f"Made by `python -m figures claims` from {of}; limits and words are in",
        "`figures/claims.toml`. A claim holds if every number with limits lies within them, does",
        "not hold if none lies even within the wider ones, else it holds in part. A close call has",
        "a border within two standard errors, or within the error if that is the change when the",
        "step is halved or half an interval of the grid. Rows, unless said: contact law",
        f"{LAW_NAME}, friction 0.3, 60 Hz, rods of",
        "9.5 d with the inertia of a thin rod; errors are standard errors over independent starts.",
        "",
        f"{made['processor']}, {made['cores']} cores; Python {made['python']}, NumPy "
        f"{made['numpy']}, Numba {made['numba']}; sources md {made['md']}, impact "
        f"{made['impact']}.",
        *("", "| | the paper says | measured | verdict |", "|---|---|---|---|"),
    ]
    for claim in claims:
        found = "<br>".join(
            f"{row['name']}: {shown(row)}{' (close call)' if row['close'] else ''}"
            for row in judged_rows(claim)
        )
        name = f"[{claim['id']}](#{_anchor(claim)})" if claim["numbers"] else claim["id"]
        lines.append(f"| {name} | {claim['says']} | {found} | {claim['verdict']} |")
    lines += ["", "## One by one", ""]
    for claim in claims:
        lines += _section(claim) if claim["numbers"] else []
    return "\n".join(lines).rstrip() + "\n"


def _anchor(claim: dict[str, Any]) -> str:
    """As pages of Markdown name a heading."""
    return f"{claim['id']}: {claim['verdict']}".lower().replace(":", "").replace(" ", "-")
