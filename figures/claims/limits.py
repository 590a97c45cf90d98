"""The claims and their limits, claims.toml, and the grade of a number by them.

>>> from figures.claims import limits
>>> len(limits.read())
29
"""

import math
import tomllib
from pathlib import Path
from typing import Any


def read() -> list[dict[str, Any]]:
    """The claims, in the order of their numbers."""
    text = Path(__file__).with_name("claims.toml").read_text(encoding="utf-8")
    empty = {"figure": "", "remark": "", "fitted": False}
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
