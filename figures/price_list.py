"""All prices on one page: what accuracy costs, what each effect costs, what more rods cost."""

from collections.abc import Mapping

import matplotlib.pyplot as plt
import numpy as np

from . import FIGURES, load
from .shared import name_panel, style
from .timing import machine_line

PRICES = {  # and what the panel of the page is called
    "accuracy_cost_drift": "error of the drift against time",
    "accuracy_cost_ladder": "one question, every way to answer it",
    "effect_prices": "price of each effect",
    "scaling": "time of a period",
}
WIDE = {"accuracy_cost_ladder", "effect_prices"}  # across the page; the others two abreast


def known() -> list[str]:
    """Those that there are."""
    return [name for name in PRICES if name in FIGURES]


@style
def draw(found: Mapping[str, Mapping[str, np.ndarray]]) -> plt.Figure:
    """Main panels of the figures whose data are given, by name."""
    narrow = [name for name in found if name not in WIDE]
    layout = [[name, name] for name in found if name in WIDE]
    layout += [[narrow[i], narrow[min(i + 1, len(narrow) - 1)]] for i in range(0, len(narrow), 2)]
    heights = [4.9 if row[0] in WIDE else 2.9 for row in layout]
    size = 7.0, sum(heights)
    figure, axes = plt.subplot_mosaic(layout, figsize=size, height_ratios=heights)
    for letter, (name, ax) in zip("abcd", axes.items(), strict=False):
        load(name).panel(ax, found[name])
        name_panel(ax, letter, PRICES[name])
    load_then = next((float(d["load"]) for d in found.values() if "load" in d), np.nan)
    figure.supxlabel(machine_line(load_then), fontsize=6)
    return figure


def summary(found: Mapping[str, Mapping[str, np.ndarray]]) -> str:
    """What the figures say in words and tables, one after the other."""
    return "\n\n".join(
        f"{FIGURES[name].title}\n{load(name).summary(d)}" for name, d in found.items()
    )
