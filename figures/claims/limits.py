"""The claims and their statements, claims.toml; verdicts on statements by their limits.

A claim of the paper is split into statements. Each is one number, and limits within which it is
what the paper says.

>>> from figures.claims import limits
>>> len(limits.read())
29
>>> limits.holds(0.7, {"holds": [0.4, 0.6]})
False
>>> limits.deviation(0.7, {"holds": [0.4, 0.6]})  # in allowances: of 0.1, around 0.5
2.0
"""

import math
import tomllib
from pathlib import Path
from typing import Any

Record = dict[str, Any]  # as JSON has it: a claim, one of its numbers, a report on all claims

HOLDS, FAILS = "holds", "does not hold"
CLOSE, MISSING = "too close to call", "not measured"
VERDICTS = HOLDS, FAILS, CLOSE, MISSING
ONE_STATE_DEG = 12  # from this tilt on a row has one state (figure `states`)


def read() -> list[Record]:
    """The claims, in the order of their numbers."""
    text = Path(__file__).with_name("claims.toml").read_text("utf-8")
    claims = tomllib.loads(text)["claims"]
    return [{"figure": "", "remark": "", "own_law": False, **claim} for claim in claims]


def holds(value: float, limits: Record) -> bool | None:
    """Whether a number is within its limits; None for what is not judged or not known."""
    if "holds" not in limits or math.isnan(value):
        return None
    low, high = limits["holds"]
    return bool(low <= value <= high)


def deviation(value: float, limits: Record) -> float:
    """(measured - claimed)/allowance; beyond 1 in size the statement does not hold.

    The claimed value is the middle of two limits, and zero where a number is to be small; nan where
    it is only to be large, as there the paper claims no value.
    """
    low, high = limits["holds"]
    if math.isinf(low):
        return value / high if high > 0 else math.nan
    if math.isinf(high) or low == high:
        return math.nan
    return (value - (low + high) / 2) / ((high - low) / 2)
