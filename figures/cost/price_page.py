"""All prices on one page: what accuracy costs, what each effect costs, what more rods cost."""

from collections.abc import Iterable, Mapping
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from impact.benchmark import benchmark

from .. import FIGURES, load
from ..lib.style import RESTITUTION_LAWS, name_panels, note, style
from ..lib.timing import machine_line
from . import accuracy_cost_drift, accuracy_cost_ladder, effect_prices, exact_impacts

PRICE_PANELS = {name: entry.panel for name, entry in FIGURES.items() if entry.panel}
IMPACTS, CHECKED = 200_000, 20_000  # timed; compared with many digits
WIDE = {"accuracy_cost_ladder", "effect_prices"}  # across the page; the others two abreast


@style
def draw(found: Mapping[str, Mapping[str, np.ndarray]]) -> plt.Figure:
    """Main panels of the figures whose data are given, by name."""
    narrow = [name for name in found if name not in WIDE]
    layout = [[name, name] for name in found if name in WIDE]
    layout += [[narrow[i], narrow[min(i + 1, len(narrow) - 1)]] for i in range(0, len(narrow), 2)]
    heights = [6.2 if row[0] in WIDE else 2.9 for row in layout]
    size = 7.0, sum(heights)
    figure, axes = plt.subplot_mosaic(layout, figsize=size, height_ratios=heights)
    for name, ax in axes.items():
        load(name).panel(ax, found[name])
    name_panels(axes.values(), map(PRICE_PANELS.get, axes))
    load_then = next((float(d["load"]) for d in found.values() if "load" in d), np.nan)
    note(figure, machine_line(load_then))
    return figure


def numbers(found: Mapping[str, Mapping[str, np.ndarray]]) -> dict[str, Any]:
    """What the figures measured, for other programs, and what one impact costs.

    Pairs are a value and its standard error; times of steps are in ns per step of a rod; nan: not
    known.
    """
    made: dict[str, Any] = {"machine": machine_line(max(float(d["load"]) for d in found.values()))}
    if d := found.get("accuracy_cost_ladder"):
        keys = "group", "label", "seconds", "periods", "deviation", "error", "scatter"
        off = accuracy_cost_ladder.deviations(d)
        told = [d[name] for name in keys[:4]]
        made["ladder"] = _rows(keys, *told, *off)
    if d := found.get("accuracy_cost_drift"):
        made["tolerance"] = accuracy_cost_drift.runs(d)
    if d := found.get("effect_prices"):
        prices, changes = (d["alone"][:, :2], d["within"][:, :2]), effect_prices._changes(d)
        keys = "name", "alone", "within", "drift"
        made["effects"] = _rows(keys, effect_prices.rows(), *prices, changes)
        made |= {"full": d["full"][:2], "bare": d["bare"][:2], "drift_cm_s": d["drift"][:, 0]}
    if d := found.get("scaling"):
        made["rods"] = _rows(("count", "ns"), d["counts"], d["row"][:, :2])
        gain = d["sweep"][0, 0] / d["sweep"][:, 0]
        made["cores"] = _rows(("count", "gain"), d["workers"], gain)
    made["impact_ns"] = benchmark(IMPACTS)["ns_per_impact"]
    largest = exact_impacts.largest_errors(CHECKED)
    made["impact_ulp"] = _rows(("law", "largest"), RESTITUTION_LAWS, largest)
    return made


def _rows(keys: tuple[str, ...], *columns: Iterable) -> list[dict[str, Any]]:
    """A dictionary a row."""
    return [dict(zip(keys, row, strict=True)) for row in zip(*columns, strict=True)]
