"""All prices on one page: what accuracy costs, what each effect costs, what more rods cost."""

from collections.abc import Iterable, Mapping
from functools import partial
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from impact import collide, compiled

from .. import FIGURES, load
from ..lib import exact_impacts
from ..lib.style import RESTITUTION_LAWS, name_panels, note, style
from ..lib.timing import machine_line, medians
from . import accuracy_cost_drift, accuracy_cost_ladder, effect_prices

PRICE_PANELS = {name: entry.panel for name, entry in FIGURES.items() if entry.panel}
IMPACTS, CHECKED = 200_000, 20_000  # timed; compared with many digits
RUNS = 9  # of each way to time an impact
LAYOUT = [
    ["accuracy_cost_ladder", "accuracy_cost_ladder"],
    ["effect_prices", "effect_prices"],
    ["accuracy_cost_drift", "scaling"],
]
HEIGHTS = 6.2, 6.2, 2.9  # inches
Found = Mapping[str, Mapping[str, np.ndarray]]  # data of the figures in `PRICE_PANELS`, by name


@style
def draw(found: Found) -> Figure:
    """Main panels of the figures of prices, from their data."""
    figure, axes = plt.subplot_mosaic(LAYOUT, figsize=(7.0, sum(HEIGHTS)), height_ratios=HEIGHTS)
    for name, ax in axes.items():
        load(name).panel(ax, found[name])
    name_panels(axes.values(), map(PRICE_PANELS.get, axes))
    note(figure, machine_line(*found.values()))
    return figure


def impact_times(n: int) -> dict[str, float]:
    """Median ns of an impact under each law, by NumPy and compiled, over n random impacts."""
    impacts = exact_impacts.random_impacts(n)
    calls = {
        f"{way} {law}": partial(impacts.collide, function, law)
        for way, function in {"numpy": collide, "compiled": compiled.collide}.items()
        for law in RESTITUTION_LAWS
    }
    return dict(zip(calls, (1e9 / n * medians([*calls.values()], RUNS)).tolist(), strict=True))


def numbers(found: Found) -> dict[str, Any]:
    """What the figures measured, for other programs, and what one impact costs.

    Pairs are a value and its standard error; times of steps are in ns per step of a rod; nan: not
    known.
    """
    ladder, effects, rods = (found[n] for n in ("accuracy_cost_ladder", "effect_prices", "scaling"))
    ways = "group", "label", "seconds", "periods"
    answers = [*(ladder[name] for name in ways), *accuracy_cost_ladder.deviations(ladder)]
    prices = effects["alone"][:, :2], effects["within"][:, :2], effect_prices.changes(effects)
    gain = rods["sweep"][0, 0] / rods["sweep"][:, 0]
    largest = exact_impacts.largest_errors(CHECKED)
    return {
        "machine": machine_line(*found.values()),
        "ladder": _rows((*ways, "deviation", "error", "scatter"), *answers),
        "tolerance": accuracy_cost_drift.runs(found["accuracy_cost_drift"]),
        "effects": _rows(("name", "alone", "within", "drift"), effect_prices.rows(), *prices),
        "full": effects["full"][:2],
        "bare": effects["bare"][:2],
        "drift_cm_s": effects["drift"][:, 0],
        "rods": _rows(("count", "ns"), rods["counts"], rods["row"][:, :2]),
        "cores": _rows(("count", "gain"), rods["workers"], gain),
        "impact_ns": impact_times(IMPACTS),
        "impact_ulp": _rows(("law", "largest"), RESTITUTION_LAWS, largest),
    }


def _rows(keys: tuple[str, ...], *columns: Iterable) -> list[dict[str, Any]]:
    """Rows of a table as dictionaries, from its columns."""
    return [dict(zip(keys, row, strict=True)) for row in zip(*columns, strict=True)]
