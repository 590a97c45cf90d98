"""What several figures share: style, colours of regimes, names, the stick/reversal boundary."""

from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap, ListedColormap

from impact import Regime, critical_tilts, slide_friction, thin_rod

style = plt.style.context(Path(__file__).parents[1] / "style.mplstyle")  # decorates each `draw`

BLACK, ORANGE, GREEN, BLUE, RED = "#000000", "#E69F00", "#009E73", "#0072B2", "#D55E00"

# Pale, so that boundary lines and words stand out.
_REGIME_COLOURS = {
    Regime.SLIDE: "#A9D8F5",
    Regime.SLIP_STICK: "#FBF5BE",
    Regime.SLIP_REVERSAL: "#EDA677",
}
REGIME_MAP = ListedColormap(list(_REGIME_COLOURS.values()))
REGIME_NORM = BoundaryNorm([0.5, 1.5, 2.5, 3.5], 3)
_REGIMES: dict[str, Any] = {
    "cmap": REGIME_MAP,
    "norm": REGIME_NORM,
    "rasterized": True,
    "zorder": 0,
}

LAWS = ("newton", "poisson", "stronge")
SHAPES = {"thin": "thin rod", "round": "round tips", "flat": "flat ends"}

# White to vermilion: light enough for black lines everywhere.
WARM = LinearSegmentedColormap.from_list("warm", ["#FFFFFF", ORANGE, RED])


def reversal_boundary(points: int) -> dict[str, np.ndarray]:
    """Critical tilts of a thin rod, both roots as one line from (0, 0) over the end to (90, 0)."""
    lower, upper = critical_tilts(friction := 0.75 * np.sin(np.linspace(0, np.pi / 2, points)))
    return {
        "critical_tilt": np.concatenate([lower, upper[::-1]]),
        "critical_friction": np.concatenate([friction, friction[::-1]]),
    }


def where_it_stops(boundary: dict[str, np.ndarray], **setting: float) -> np.ndarray:
    """The boundary's tilts, nan where the contact slides through and can neither stick nor turn."""
    slide = slide_friction(thin_rod(boundary["critical_tilt"]), **setting)
    return np.where(boundary["critical_friction"] >= slide, boundary["critical_tilt"], np.nan)


def map_regimes(
    ax: Axes, tilt_deg: np.ndarray, friction: np.ndarray, regime: np.ndarray
) -> QuadMesh:
    """Colour the panel by regime over tilt and friction."""
    return ax.pcolormesh(tilt_deg, friction, regime, shading="nearest", **_REGIMES)


def shade(ax: Axes, edges_deg: np.ndarray, regime: np.ndarray) -> QuadMesh:
    """Colour the panel by regime over tilt; `regime` holds between the edges."""
    upright = ax.get_xaxis_transform()
    return ax.pcolormesh(edges_deg, [0, 1], regime[None], transform=upright, **_REGIMES)


def tilt_axis(ax: Axes, low: float = 0, high: float = 90, step: float = 15) -> None:
    ax.set(xlabel=r"tilt $\phi$ (deg)", xlim=(low, high), xticks=np.arange(low, high + 1, step))


def name_panel(ax: Axes, letter: str, title: str = "") -> None:
    ax.set_title(rf"$\bf{{({letter})}}$ {title}", loc="left")
