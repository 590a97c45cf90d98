"""Rods of any kind: the numbers of the claims over what the rods, the plate and the shaking are.

Sets of properties fill their ranges evenly (`PROPERTIES`, a Sobol sequence): those of the plate and
of the rods apart, and length, number, friction and acceleration as well. Each set is a row at seven
tilts. Its numbers are judged by the limits of claims.toml, those of the theory (S16) against the
theory of the same friction, restitution and speed of the plate. No set is chosen: counted is under
which of them a statement holds.
"""

import numpy as np
from scipy.stats import qmc, spearmanr

from md.scene import put
from md.search import Parameter
from md.sweep import Sweep, point_at

from ..lib.runs import PARTS, RESOLVED, SIMPLE_ROW, Sweeps, boxes, computed, starts
from ..lib.style import Data
from . import over_tilt
from .limits import Record, holds

TILTS_DEG = {False: (9, 15, 22, 28, 34, 45, 60), True: (9, 28, 45)}
SETS, PERIODS = {False: 256, True: 4}, {False: 150, True: 40}
KEPT_DEG = 2.0  # a row that keeps its tilt is as near to acos(dN/L), at every tilt
FOLLOWS = 0.5  # rank correlation from which on a number is said to follow a property
FEW = 20  # sets from which on a correlation is told


_OF_CONTACTS = (  # option of plate and rods, ends of its range, whether evenly in log
    ("restitution", 0.3, 0.97, False),
    ("friction", 0.05, 1.0, True),
    ("tangential_ratio", 0.3, 30.0, True),
    ("tangential_damping", 0.0, 1.0, False),
)
_RANGES = (
    *(
        Parameter(f"{option.replace('_', ' ')}, {part}", (f"contacts.{part}.{option}",), *ends)
        for option, *ends in _OF_CONTACTS
        for part in PARTS
    ),
    Parameter("length", ("rods.length",), 3.0, 30.0, log=True),
    Parameter("acceleration", ("plate.acceleration",), 2.0, 6.0),
    Parameter("number of rods", ("rods.count",), 20, 60),
)
PROPERTIES = {one.name: one for one in _RANGES}
JUDGED = {  # statements that every set of properties has
    name: row for name, row in over_tilt.JUDGED.items() if name not in over_tilt.OF_MANY_TILTS
}


def drawn(quick: bool = False) -> Data:
    """Properties of all sets: arrays by name, a value a set."""
    parts = qmc.Sobol(len(PROPERTIES), seed=1).random(SETS[quick])
    found = {p.name: p.value(x) for p, x in zip(PROPERTIES.values(), parts.T, strict=True)}
    return found | {"number of rods": np.rint(found["number of rods"])}


def sweeps(quick: bool = False) -> Sweeps:
    """Sweep of rows: every set at every tilt."""
    sets, tilts, points = drawn(quick), TILTS_DEG[quick], []
    base = put(SIMPLE_ROW, RESOLVED)
    for i in range(SETS[quick]):
        changes = {k: sets[name][i].item() for name, p in PROPERTIES.items() for k in p.keys}
        changes["rods.count"] = count = int(changes["rods.count"])
        for box in boxes(tilts, count):
            points.append(point_at(base, changes | {"box.length": box}, {"set": i}, PERIODS[quick]))
    axes = {"set": [*range(SETS[quick])]}, {"tilt": [*tilts]}, starts(1)
    return {"sets": Sweep(axes, tuple(points))}


def data(quick: bool = False) -> Data:
    """Properties of all sets, numbers of the claims, drifts [cm/s] over tilt and the theory's."""
    nominal, whole = np.array(TILTS_DEG[quick]), computed(sweeps(quick)["sets"])
    firsts = range(0, len(whole.points), nominal.size)
    sets = [Sweep(whole.axes[1:], whole.points[i : i + nominal.size]) for i in firsts]
    tables = [over_tilt.table(sweep, nominal, own=True) for sweep in sets]
    values = [[over_tilt.NUMBERS[name](table) for name in JUDGED] for table in tables]
    return {
        **drawn(quick),
        "number": np.array([*JUDGED]),
        "value": np.array(values, float),
        "nominal": nominal,
        "c_x": np.array([table["c_x"] for table in tables]),
        "theory": np.array([over_tilt.theory(table, nominal) for table in tables]),
        "tilt_off": np.array([over_tilt.NUMBERS["S2.largest"](table) for table in tables]),
    }


def kept(d: Data) -> np.ndarray:
    """Sets under which the row keeps its tilt; the others are no rows any more."""
    return d["tilt_off"] <= KEPT_DEG


def _numbers(d: Data) -> Data:
    """Number of each statement under each set that keeps the tilt."""
    return dict(zip(d["number"].tolist(), d["value"][kept(d)].T, strict=True))


def judged(d: Data) -> Data:
    """Whether each statement holds, 1 or 0, under each set that keeps the tilt; nan: not known."""
    values = _numbers(d)
    return {
        name: np.array([holds(value, row) for value in values[name]], float)
        for name, row in JUDGED.items()
        if name in values
    }


def told(d: Data) -> Record:
    """What the page of the claims says: sets, and where each statement holds.

    `ranges` of the properties. `share`: of the sets that keep the tilt, those under which it holds;
    `quartiles` of the number over these sets. `follows`: the property with the largest rank
    correlation with the number, that correlation, and between which values of the property lies the
    middle half of the sets under which the statement holds; none if the correlation is weak, or
    sets are few. Of sets and tilts up to 30 degrees, and of those beyond: `over_theory`, quartiles
    of the drift over the theory's, and `within_two`, the share within a factor of two.
    """
    some = kept(d)
    ratio, lean = d["c_x"][some] / d["theory"][some], d["nominal"] > 30
    sides = [ratio[:, of] for of in (~lean, lean)]
    numbers = _numbers(d)
    return {
        "sets": len(some),
        "kept": int(some.sum()),
        "ranges": {name: [p.low, p.high] for name, p in PROPERTIES.items()},
        "numbers": {
            name: {
                "share": np.nanmean(true) if np.isfinite(true).any() else None,
                "quartiles": _quartiles(numbers[name]),
                "follows": _follows(d, numbers[name], true == 1),
            }
            for name, true in judged(d).items()
        },
        "over_theory": [_quartiles(side) for side in sides],
        "within_two": [np.mean((side >= 0.5) & (side <= 2)) for side in sides],
    }


def _quartiles(values: np.ndarray) -> list[float]:
    """Quartiles of the finite values; an empty list where there are none."""
    known = values[np.isfinite(values)]
    return np.percentile(known, [25, 50, 75]).tolist() if known.size else []


def _follows(d: Data, value: np.ndarray, true: np.ndarray) -> Record | None:
    """`follows` of `told`, from the numbers of the sets that keep the tilt, and where it holds."""
    known, some = np.isfinite(value), kept(d)
    if known.sum() < FEW or np.ptp(value[known]) == 0:
        return None
    rank = {n: spearmanr(d[n][some][known], value[known]).statistic for n in PROPERTIES}
    most = max(rank, key=lambda name: abs(rank[name]))
    if abs(rank[most]) < FOLLOWS:
        return None
    return {"property": most, "rank": rank[most], "middle": _quartiles(d[most][some][true])[::2]}
