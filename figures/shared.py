"""What several figures share: style, colours, the tilt axis, the stick/reversal boundary."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap

from impact import Regime, critical_tilts

style = plt.style.context(Path(__file__).with_name("style.mplstyle"))  # decorates each `draw`

BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, RED, PINK = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"

# Pale, so that boundary lines and words stand out; in this order also grey by grey.
_REGIME_COLOURS = {
    Regime.SLIDE: "#A9D8F5",
    Regime.SLIP_STICK: "#FBF5BE",
    Regime.SLIP_REVERSAL: "#EDA677",
}
REGIME_MAP = ListedColormap(list(_REGIME_COLOURS.values()))
REGIME_NORM = BoundaryNorm([0.5, 1.5, 2.5, 3.5], 3)


def reversal_boundary(points: int) -> dict[str, np.ndarray]:
    """Critical tilts of a thin rod, both roots as one line from (0, 0) over the end to (90, 0)."""
    lower, upper = critical_tilts(friction := 0.75 * np.sin(np.linspace(0, np.pi / 2, points)))
    return {
        "critical_tilt": np.concatenate([lower, upper[::-1]]),
        "critical_friction": np.concatenate([friction, friction[::-1]]),
    }


def tilt_axis(ax: Axes, low: float = 0, high: float = 90, step: float = 15) -> None:
    ax.set(xlabel=r"tilt $\phi$ (deg)", xlim=(low, high), xticks=np.arange(low, high + 1, step))


def name_panel(ax: Axes, letter: str, title: str = "") -> None:
    ax.set_title(rf"$\bf{{({letter})}}$ {title}", loc="left")
