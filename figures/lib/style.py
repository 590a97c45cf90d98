"""Look of the figures: style, colours, panels, curves with errors."""

from collections.abc import Callable, Iterable, Mapping
from functools import wraps
from pathlib import Path
from string import ascii_lowercase
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure

from impact import Regime

Data = dict[str, Any]  # of a figure: arrays, numbers, words by name
Look = dict[str, Any]  # options of Matplotlib

_LOOK = plt.style.context(Path(__file__).parents[1] / "style.mplstyle")


def style(draw: Callable[..., Figure]) -> Callable[..., Figure]:
    """Decorate a `draw`: it has our look, and a notebook shows what it returns, once."""
    drawn = _LOOK(draw)

    @wraps(draw)
    def styled(*given: Any, **named: Any) -> Figure:
        figure = drawn(*given, **named)
        if "inline" in plt.get_backend():
            plt.close(figure)
        return figure

    return styled


BLACK, ORANGE, GREEN, BLUE = "#000000", "#E69F00", "#009E73", "#0072B2"
RED, SKY, PURPLE = "#D55E00", "#56B4E9", "#AA4A84"

# What a colour means, in every figure; `shades` are values of a parameter.
SIMULATED = BLACK  # rows, annuli, soft impacts; also what happens, where others show what would
THEORY = RED  # the paper's closed forms, as they stand
RIGID = BLUE  # exact flights and impacts; the theory, told what was measured
ANOTHER = GREEN  # a second quantity, with its own axis; a second law of contact
PRINTED_LAW = PURPLE  # Appendix A
DRIFTS = "RdBu_r"  # forward is red, reverse blue
FORWARD, REVERSE = "#B2182B", "#2166AC"

# Slide, slip-stick, slip reversal: maps pale, so that boundary lines and words stand out.
REGIME_MAP = ListedColormap(["#A9D8F5", "#FBF5BE", "#EDA677"])
REGIME_COLOURS = SKY, "#A08A00", "#B4481E"  # of curves
REGIME_NORM = BoundaryNorm([0.5, 1.5, 2.5, 3.5], 3)
REGIME_LOOK: Look = {"cmap": REGIME_MAP, "norm": REGIME_NORM, "rasterized": True, "zorder": 0}

REGIME_WORDS = {
    Regime.SLIDE: "slide",
    Regime.SLIP_STICK: "slip-stick",
    Regime.SLIP_REVERSAL: "slip reversal",
}
LAW_COLOURS = {"newton": THEORY, "poisson": ORANGE, "stronge": SKY}  # of restitution
RESTITUTION_LAWS = tuple(LAW_COLOURS)
ARROW: Look = {"arrowstyle": "->", "lw": 0.6}
DOTTED: Look = {"color": BLACK, "lw": 0.8, "ls": ":"}  # a place on an axis that the caption names
FAINT: Look = {"color": "0.5", "lw": 0.8, "ls": ":"}
GUIDE: Look = {"color": "0.55", "lw": 0.8}  # a line beside what is measured
CENTRED: Look = {"ha": "center", "va": "center"}
SHAPES = {"thin": "thin rod", "round": "round tips", "flat": "flat ends"}
SHAPE_COLOURS = {"thin": THEORY, "round": RIGID, "flat": PURPLE}

# White to vermilion: light enough for black lines everywhere.
WARM = LinearSegmentedColormap.from_list("warm", ["#FFFFFF", ORANGE, RED])


def tilt_axis(ax: Axes, low: float = 0, high: float = 90, step: float = 15, **look: Any) -> None:
    """Let a panel be over tilts in degrees; `look`: what else is set, as the name of its height."""
    ticks = np.arange(low, high + 1, step)
    ax.set(xlabel=r"tilt $\phi$ (deg)", xlim=(low, high), xticks=ticks, **look)


def name_panels(axes: Iterable[Axes], titles: Iterable[str]) -> None:
    """Give panels their letters, from (a) on, and their titles."""
    for ax, letter, title in zip(axes, ascii_lowercase, titles, strict=False):
        ax.set_title(rf"$\bf{{({letter})}}$ {title}", loc="left")


def painted(
    d: Data,
    panels: Mapping[str, Callable[[Axes, Data], None]],
    height: float,
    width: float = 7.0,
    rows: int = 1,
    **look: Any,
) -> Figure:
    """Figure of panels, each drawn by its function, under its title.

    Parameters
    ----------
    d : data
    panels : functions by title, row by row
    height, width : of the figure, in inches
    rows : of panels
    look : of the figure, as `plt.subplots` takes it
    """
    figure, axes = plt.subplots(rows, len(panels) // rows, figsize=(width, height), **look)
    for ax, panel in zip(axes.flat, panels.values(), strict=True):
        panel(ax, d)
    name_panels(axes.flat, panels)
    return figure


def log_log(ax: Axes, **look: Any) -> None:
    """Give a panel two logarithmic axes; `look`: their limits and names."""
    ax.set(xscale="log", yscale="log", **look)


def zero_line(ax: Axes) -> None:
    """Draw a thin line where what is shown is zero."""
    ax.axhline(0, color="0.6", lw=0.6, zorder=1)


def shades(count: int) -> np.ndarray:
    """Colours (count, 4) of values of a parameter, from dark to light as they grow."""
    return plt.get_cmap("viridis")(np.linspace(0, 0.8, count))


def points(
    ax: Axes,
    x: Any,
    y: Any,
    error: Any,
    colour: str = BLACK,
    *,
    form: str = "o-",
    hollow: bool = False,
    **look: Any,
) -> None:
    """Draw points with their errors, joined.

    Parameters
    ----------
    x, y, error : arrays
    form : marker and line, as `plt.plot` takes them
    hollow : open symbols
    look : of the points
    """
    face = "white" if hollow else colour
    look = {"ms": 3, "lw": 0.7, "elinewidth": 0.7, "mew": 0.7, "mfc": face, **look}
    ax.errorbar(x, y, error, fmt=form, color=colour, **look)


def curve(
    ax: Axes,
    d: Data,
    x: str,
    y: str,
    colour: str = BLACK,
    label: str | None = None,
    *,
    at: Any = ...,
    scale: float = 1.0,
    both: bool = False,
    **look: Any,
) -> None:
    """Draw one array of a figure over another as `points`, with its errors.

    Parameters
    ----------
    d : data; holds `x`, `y`, `y_error`, and `x_error` if that is to be shown too
    x, y : names of arrays
    at : index into `y`
    scale : factor of `y`
    both : errors of `x` as well
    look : of `points`
    """
    if both:
        look["xerr"] = d[f"{x}_error"]
    error = np.abs(scale) * d[f"{y}_error"][at]
    points(ax, d[x], scale * d[y][at], error, colour, label=label, **look)


def note(figure: Figure, words: Any) -> None:
    """Write what holds for all panels below them, in as many lines as it takes."""
    figure.supxlabel(str(words), wrap=True)


def legend_above(figure: Figure, ax: Axes, **look: Any) -> None:
    """Put the legend of one panel above all panels."""
    figure.legend(*ax.get_legend_handles_labels(), loc="outside upper center", **look)
