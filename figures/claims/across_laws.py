"""What the search over contact laws says of each claim: where it holds, and what decides.

All of it is of the search's first round, whose laws are drawn evenly from their ranges.
"""

from itertools import combinations
from typing import Any

import numpy as np
from scipy.stats import spearmanr

from ..lib.style import Data
from .over_laws import CONSTANT, JUDGED, KEPT_DEG, PARAMETERS, laws_of, singled_out

FOLLOWS = 0.5  # rank correlation from which on a number is said to follow a parameter
FEW = 20  # laws from which on a correlation is told
BY_CHANCE = 8  # laws under which two numbers hold together if they have nothing to do with another


def _counts(of: np.ndarray) -> list[int]:
    """Of grades: how many hold, hold in part, do not."""
    return [int((of == grade).sum()) for grade in (2, 1, 0)]


def _even(d: Data) -> tuple[np.ndarray, np.ndarray]:
    """Places of the laws that are drawn evenly; which of them keep the tilt of the row."""
    even = np.flatnonzero(d["round"] == 0)
    return even, d["tilt_off"][even] <= KEPT_DEG


def numbers(d: Data) -> dict[str, dict[str, Any]]:
    """Of each number: under how many laws that keep the tilt it holds, and what it follows.

    `counts`: laws under which it holds, holds in part, does not. `follows`, among laws of constant
    restitution: the parameter with the largest rank correlation, that correlation, and between
    which values of the parameter the middle half of the laws lies under which the number holds;
    none if no law obeys the number. None if the correlation is weak or the laws are few.
    """
    even, kept = _even(d)
    laws = laws_of(d["parts"][even[kept]])
    constant = [i for i, law in enumerate(laws) if law["form"] == CONSTANT]
    names = [p.name for p in PARAMETERS if (p.when or {}).get("form") == CONSTANT]
    parameters = {name: np.array([float(laws[i][name]) for i in constant]) for name in names}
    value, grade = d["value"][even[kept]], d["grade"][even[kept]]
    return {
        name: {
            "counts": _counts(grade[:, j]),
            "follows": _follows(parameters, value[constant, j], grade[constant, j] == 2),
        }
        for j, name in enumerate(JUDGED)
    }


def _follows(
    parameters: dict[str, np.ndarray], value: np.ndarray, holds: np.ndarray
) -> dict[str, Any] | None:
    """`follows` of `numbers`, from parameters and values of the laws, and where it holds."""
    known = np.isfinite(value)
    if known.sum() < FEW:
        return None
    rank = {name: spearmanr(x[known], value[known]).statistic for name, x in parameters.items()}
    most = max(rank, key=lambda name: abs(rank[name]))
    if abs(rank[most]) < FOLLOWS:
        return None
    where = parameters[most][holds]
    middle = np.percentile(where, [25, 75]).tolist() if where.size else []
    return {"parameter": most, "rank": float(rank[most]), "middle": middle}


def excluded(d: Data) -> list[tuple[str, str, float]]:
    """Pairs of numbers that never hold together, and under how many laws they would by chance."""
    holds, names = d["grade"][_even(d)[0]] == 2, list(JUDGED)
    share = holds.mean(axis=0)
    return [
        (names[i], names[j], float(expected))
        for i, j in combinations(range(len(names)), 2)
        if (expected := len(holds) * share[i] * share[j]) >= BY_CHANCE
        and not (holds[:, i] & holds[:, j]).any()
    ]


def told(d: Data) -> dict[str, Any]:
    """What the page of the claims says of this."""
    found = {"numbers": numbers(d), "excluded": excluded(d), "forms": forms(d)}
    return {**found, "over_theory": over_theory(d)}


def over_theory(d: Data) -> dict[str, list[float]]:
    """Drift over that of the theory, up to 30 degrees and beyond.

    `law`: lowest and highest of the law singled out, up to 30 degrees, then beyond; `laws`: medians
    over tilt and the laws that keep the tilt.
    """
    even, kept = _even(d)
    best = d["best_c_x"][singled_out(d)] / d["best_theory"]
    every = d["c_x"][even[kept]] / d["theory"]
    lean, upright = (d[f"{which}nominal"] > 30 for which in ("best_", ""))
    law = [float(f(best[part])) for part in (~lean, lean) for f in (np.min, np.max)]
    return {"law": law, "laws": [float(np.median(every[:, part])) for part in (~upright, upright)]}


def forms(d: Data) -> dict[str, list[int]]:
    """Of each form of the law: how many laws keep the tilt of the row, and how many there are."""
    even, kept = _even(d)
    form = np.array([law["form"] for law in laws_of(d["parts"][even])])
    return {
        str(of): [int(kept[form == of].sum()), int((form == of).sum())] for of in np.unique(form)
    }
