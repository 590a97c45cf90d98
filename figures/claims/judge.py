"""Verdicts on the paper's claims, statement by statement: measured numbers and their limits.

A statement holds if its number lies within the limits of claims.toml, does not hold if it lies
outside, and is too close to call if a limit is as near as two standard errors. One that cannot be
measured leaves the others as they are.
"""

import json
import math
import platform
from pathlib import Path
from typing import Any

import numpy as np

import md
from impact._generated import DIGEST
from md.cache import digest

from .limits import CLOSE, FAILS, HOLDS, MISSING, VERDICTS, Record, deviation, holds, read
from .uncertainty import MEASURES, Number, resampled

MARKS = {HOLDS: "+", FAILS: "-", CLOSE: "~", MISSING: "?"}
APART = "under laws of their own, or none"  # statements that the law of the figures has no part in
NEARLY = 0.95  # share of the kinds of rods that is nearly all
CHOOSES = "S2"  # the claim by which rows that keep their tilt are chosen
DIGITS = 3  # of a number, at most
NO_DATA = (md.RunError, np.linalg.LinAlgError)  # a run has failed; a fit through missing points


def measure(claim: str, evidence: Any) -> dict[str, Number]:
    """Numbers of a claim by key: of the row over tilt, and of its function in `MEASURES`.

    Parameters
    ----------
    claim : as "S13"
    evidence : the data, `evidence.Evidence`
    """
    # Late: pages need no compiled code; the modules fill `MEASURES`.
    from . import measure_annulus, measure_rows, over_tilt  # noqa: F401

    found = {}
    for name, number in over_tilt.NUMBERS.items():
        of, key = name.split(".")
        if of == claim:
            found[key] = resampled(evidence.over_tilt, number)
    if claim in MEASURES:
        function, figure = MEASURES[claim]
        d = evidence.figure(figure) if figure else evidence
        for key, number in function(d).items():
            found[key] = resampled(d, number) if callable(number) else number
    return found


def close(number: Number, limits: Record) -> bool:
    """Whether a limit is as near as two standard errors, or nearer than an error of another notion.

    An interval of a grid that ends at a limit lies on one side of it, however it is rounded.
    """
    random = number.notion == "standard error"
    if random and math.isfinite(number.value) and math.isnan(number.error):
        return True  # in some draws the value is not there
    reach = (2 if random else 1 - 1e-9) * number.error
    return reach > 0 and any(abs(number.value - limit) <= reach for limit in limits["holds"])


def verdict(number: Number, limits: Record) -> str:
    """Verdict on a statement."""
    true = holds(number.value, limits)
    if true is None:
        return MISSING
    return CLOSE if close(number, limits) else HOLDS if true else FAILS


def judged_number(number: Number, limits: Record) -> Record:
    """A number with its limits and, if it has any, the verdict."""
    value = float(number.value)
    row = {**limits, "value": value, "error": float(number.error), "notion": number.notion}
    if "holds" in limits:
        row["verdict"] = verdict(number, limits)
        row["deviation"] = deviation(value, limits)
    return row


def _judged(claim: Record, evidence: Any) -> Record:
    """The claim with its numbers and the verdicts on its statements."""
    trouble, measured = "", {}
    try:
        measured = measure(claim["id"], evidence)
    except NO_DATA as failure:
        trouble = f"{type(failure).__name__}: {' '.join(str(failure).split())}"
    rows = [
        judged_number(measured.get(row["key"], Number(math.nan)), row) for row in claim["numbers"]
    ]
    return {**claim, "numbers": rows, "trouble": trouble}


def judge(quick: bool, out: Path | None = None) -> Record:
    """Judge all claims: what was measured, the verdicts, and where they come from.

    Runs what it needs, for minutes, as far as the store and the figures in `out` do not hold it.

    Parameters
    ----------
    quick : the figures' quick data, shorter and coarser
    out : folder of figures that were drawn; current data there are read, not computed
    """
    from ..lib.timing import machine, waited  # late, as in `measure`
    from . import any_rods
    from .evidence import ASSUMED, Evidence

    evidence, simple, judged = Evidence(quick, out), Evidence(quick, assumed=True), []
    surveyed = evidence.figure("any_rods")
    bar = waited(read(), "judging", "claim")
    for claim in bar:
        bar.set_postfix_str(claim["id"])
        found = _judged(claim, evidence)
        if claim["figure"] in ASSUMED:
            found["assumed"] = "; ".join(
                f"{row['name']}: {shown(row)} ({row['verdict']})"
                for row in statements(_judged(claim, simple))
            )
        judged.append(found)
    return {
        "provenance": {
            **machine(),
            "system": platform.system(),
            "md": digest(),
            "impact": DIGEST,
            "quick": quick,
        },
        "any_rods": any_rods.told(surveyed),
        "claims": judged,
    }


TEXTS = ("id", "says", "figure", "trouble")
OF_A_STATEMENT = {"name", "value", "error", "verdict"}


def load(path: Path) -> Record:
    """Report from a JSON file; null as the value of a judged number was inf, else nan.

    Raises
    ------
    ValueError
        If the file is no JSON, or not of the claims.
    """
    report = json.loads(path.read_text("utf-8"))
    try:
        claims = [
            {**c, "numbers": [_restored(row) for row in c["numbers"]]} for c in report["claims"]
        ]
        there = [isinstance(claim[key], str) for claim in claims for key in TEXTS]
        there += [row.keys() >= OF_A_STATEMENT for c in claims for row in statements(c)]
        if not (there and all(there)):
            raise TypeError("something is missing")
        return {**report, "claims": claims, "quick": report["provenance"]["quick"]}
    except (AttributeError, LookupError, TypeError) as error:
        raise ValueError(f"no report of the claims: {error}") from None


def _restored(row: Record) -> Record:
    """A number with the nan and inf that JSON lacks."""
    value = math.nan if row.get("verdict", MISSING) == MISSING else math.inf
    known = {"value": value, "error": math.nan, "deviation": math.nan}
    restored = row | {key: lacking for key, lacking in known.items() if row.get(key) is None}
    if "holds" in row:
        low, high = row["holds"]
        restored["holds"] = [-math.inf if low is None else low, math.inf if high is None else high]
    return restored


def shown(row: Record) -> str:
    """A number with its error and unit: to two digits of the error, three of the number at most.

    An error that these digits do not show is left out.
    """
    value, error, unit = row["value"], row["error"], f" {row['unit']}" if "unit" in row else ""
    if not math.isfinite(value):
        return "no data" if math.isnan(value) else "never"
    if not error > 0:
        return f"{value:.{DIGITS}g}{unit}"
    largest = max(abs(value), error)
    digits = max(
        0, min(1 - math.floor(math.log10(error)), DIGITS - 1 - math.floor(math.log10(largest)))
    )
    off = f" ± {error:.{digits}f}" if error >= 0.5 * 10**-digits else ""
    return f"{value:.{digits}f}{off}{unit}"


def limits_shown(limits: list[float] | None) -> str:
    """Limits of a statement in words; nothing if it has none."""
    if limits is None:
        return ""
    low, high = limits
    if math.isinf(low):
        return f"≤ {high:g}"
    if math.isinf(high):
        return f"≥ {low:g}"
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def statements(claim: Record) -> list[Record]:
    """The judged numbers of a claim."""
    return [row for row in claim["numbers"] if "holds" in row]


def counted(report: Record) -> dict[str, dict[str, int]]:
    """Statements with each verdict, by kind.

    Those that had a part in the choice of the figures' contact law are fitted, those of laws of
    their own or of none are apart, all others are predicted by that law.
    """
    found = {kind: dict.fromkeys(VERDICTS, 0) for kind in ("predicted", "fitted", APART)}
    for claim in report["claims"]:
        for row in statements(claim):
            apart = claim.get("own_law") or row.get("own_law")
            kind = APART if apart else "fitted" if row.get("fitted") else "predicted"
            found[kind][row["verdict"]] += 1
    return found


def counts(report: Record) -> str:
    """Number of statements with each verdict, kind by kind."""
    return "; ".join(
        f"of {sum(of.values())} statements {kind} "
        + ", ".join(f"{verdict}: {number}" for verdict, number in of.items() if number)
        for kind, of in counted(report).items()
    )


def summary(claim: Record) -> str:
    """How many statements of a claim hold: "2 of 4 hold"."""
    rows = statements(claim)
    return f"{sum(row['verdict'] == HOLDS for row in rows)} of {len(rows)} hold"


def regions(report: Record) -> dict[str, list[Record]]:
    """Statements that hold for nearly all rods, for some, for hardly any.

    Each with its claim's `id` and what `any_rods` says of it. Without those of the claim by which
    rows were chosen.
    """
    found: dict[str, list[Record]] = {"none": [], "some": [], "all": []}
    for claim in report["claims"]:
        for row in statements(claim):
            of = report["any_rods"]["numbers"].get(f"{claim['id']}.{row['key']}", {})
            share = of.get("share")
            if share is None or claim["id"] == CHOOSES:
                continue
            group = "all" if share >= NEARLY else "none" if share <= 1 - NEARLY else "some"
            found[group].append({"id": claim["id"], **row, **of})
    return found


def numbers(report: Record) -> dict[str, Record]:
    """All numbers of a report, by claim and key ("S16.peak")."""
    return {f"{c['id']}.{row['key']}": row for c in report["claims"] for row in c["numbers"]}


def brief(report: Record) -> str:
    """A line a claim: its statements with + holds, - does not, ~ too close, ? not measured."""
    lines = []
    for claim in report["claims"]:
        cells = (f"{r['key']} {shown(r)} {MARKS[r['verdict']]}" for r in statements(claim))
        line = f"{claim['id']:4}{summary(claim):14}{', '.join(cells)} {claim['trouble']}"
        lines.append(line.rstrip())
    return "\n".join([*lines, *counts(report).split("; ")])
