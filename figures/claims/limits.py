"""The claims and their limits, claims.toml; grades of numbers by them, verdicts by the grades.

>>> from figures.claims import limits
>>> len(limits.read())
29
>>> limits.verdict([2, 1, 2])  # of a claim, from the grades of its numbers
'holds in part'
"""

import math
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

GRADES = ("does not hold", "holds in part", "holds")
MISSING = "not measured"


def read() -> list[dict[str, Any]]:
    """The claims, in the order of their numbers."""
    text = Path(__file__).with_name("claims.toml").read_text(encoding="utf-8")
    empty = {"figure": "", "remark": "", "fitted": False, "own_law": False}
    return [{**empty, **claim} for claim in tomllib.loads(text)["claims"]]


def claim_of(number: str) -> dict[str, Any]:
    """The claim of a number, as "S13.small"."""
    return next(claim for claim in read() if claim["id"] == number.partition(".")[0])


def grade(value: float, limits: dict[str, Any]) -> int | None:
    """2 within `holds`, 1 within `partly`, else 0; None for what is not judged or not known."""
    if "holds" not in limits or math.isnan(value):
        return None
    return 2 if _within(value, limits["holds"]) else int(_within(value, limits["partly"]))


def _within(value: float, limits: list[float]) -> bool:
    return limits[0] <= value <= limits[1]


def verdict(grades: Sequence[float | None]) -> str:
    """Verdict on a claim, from the grades of its judged numbers."""
    known = [grade for grade in grades if grade is not None]
    if not grades or len(known) < len(grades):
        return MISSING
    return GRADES[2 if min(known) == 2 else 0 if max(known) == 0 else 1]
