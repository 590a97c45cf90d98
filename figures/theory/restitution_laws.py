"""Where Newton's kinematic restitution creates energy, and how far three laws differ.

Not in the paper; the debate of its reference [8], for a thin rod. (a) The restitution above which
some impact ends with more energy than it began with, in closed form: never below 4/5, which is
reached on the thick line only. (b) The same by search: each dot has the colour of the smallest of
the restitutions with which an impact was found that gains energy. Look whether the dots fill the
closed form's lines. (c), (d) What the choice of law moves: the velocities after one impact, and the
largest distance between the outcomes of two laws. Slides are the same under all three.
"""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap

from impact import collide, critical_friction, energy_restitution, slide_friction, thin_rod

from ..lib.style import (
    BLACK,
    BLUE,
    RED,
    RESTITUTION_LAWS,
    WARM,
    Data,
    painted,
    reversal_boundary,
    style,
    tilt_axis,
    where_it_stops,
)

GOURAUD = {"shading": "gouraud", "rasterized": True}
LINE_FRICTION = 0.5  # of panel (c)
RESTITUTIONS = (0.8, 0.85, 0.9, 0.95, 0.99)


def largest_gain(tilt: Any, friction: Any, restitution: Any) -> np.ndarray:
    """Largest energy change under Newton's law over all u_0, in units of v_0^2, by search."""
    given = np.broadcast_arrays(tilt, friction, restitution)
    tilt, friction, restitution = np.stack(given)[..., None]
    centre, half = np.zeros(tilt.shape), np.radians(80)  # of arctan(u_0/|v_0|)
    how = {"geometry": thin_rod(tilt), "friction": friction, "restitution": restitution}
    for points in (161, 41, 41):
        angle = centre + half * np.linspace(-1, 1, points)
        gain = collide(np.tan(angle), -1.0, **how).energy_change
        centre = np.take_along_axis(angle, gain.argmax(-1)[..., None], -1)
        half *= 2 / (points - 1)
    return gain.max(-1)


def _creation(n: int, dots: tuple[int, int]) -> Data:
    """Threshold of energy creation on a map, and the smallest restitution found to create it."""
    tilt, friction = np.linspace(0, np.pi / 2, n), np.linspace(0, 1, n)
    dot_tilt, dot_friction = ((np.arange(m) + 0.5) / m for m in dots)
    dot_tilt *= np.pi / 2
    levels = np.array(RESTITUTIONS)
    # Beyond what rounding can feign, in units of v_0^2.
    creates = largest_gain(dot_tilt, dot_friction[:, None], levels[:, None, None]) > 1e-12
    floor = thin_rod(np.pi / 4)
    return {
        "tilt": tilt,
        "friction": friction,
        "threshold": energy_restitution(thin_rod(tilt), friction[:, None]),
        "floor": np.array([np.pi / 4, critical_friction(floor)]),  # 4/5 at and above this friction
        "floor_threshold": energy_restitution(floor, 1.0),
        "restitutions": levels,
        "dot_tilt": dot_tilt,
        "dot_friction": dot_friction,
        "dot_created": np.where(creates.any(0), levels[creates.argmax(0)], np.nan),
    }


def _after(tilt, friction, restitution, approach_ratio) -> np.ndarray:
    """(c_x', c_z') after an impact with c_z = -1 under each law: shape (2, 3, ...)."""
    how = {"geometry": thin_rod(tilt), "friction": friction, "restitution": restitution}
    hits = [collide(1 / approach_ratio, -1.0, **how, law=law) for law in RESTITUTION_LAWS]
    return np.array([[hit.c_x for hit in hits], [hit.c_z for hit in hits]])


def data(quick: bool = False) -> Data:
    """Thresholds and what the search found; outcomes of three laws in units of |c_z|."""
    n, dots = (46, (15, 10)) if quick else (361, (45, 30))
    d = _creation(n, dots)
    setting = {"approach_ratio": 1.0, "restitution": 0.8}
    reversal = reversal_boundary(4 * n)
    d["c_x"], d["c_z"] = _after(d["tilt"], LINE_FRICTION, **setting)
    everywhere = _after(d["tilt"], d["friction"][:, None], **setting)
    apart = np.hypot(*(everywhere[:, :, None] - everywhere[:, None]))  # each law from each
    return {
        **d,
        "line_friction": np.float64(LINE_FRICTION),
        "line_restitution": np.float64(setting["restitution"]),
        "approach_ratio": np.float64(setting["approach_ratio"]),
        "difference": apart.max(axis=(0, 1)),
        "slide_friction": slide_friction(thin_rod(d["tilt"]), **setting),
        **reversal,
        "stopping_tilt": where_it_stops(reversal, **setting),
    }


def _threshold(ax: Axes, d: Data, **kwargs: Any):
    """Closed-form lines of equal threshold, and the line on which it is least."""
    axes = np.degrees(d["tilt"]), d["friction"]
    lines = ax.contour(*axes, d["threshold"], levels=d["restitutions"][1:], linewidths=1, **kwargs)
    tilt, friction = d["floor"]
    ax.plot(2 * [np.degrees(tilt)], [friction, 1], color=BLACK, lw=2.5, solid_capstyle="butt")
    ax.set(ylabel=r"friction $\mu$", ylim=(0, 1))
    tilt_axis(ax)
    return lines


def _draw_creation(ax: Axes, d: Data) -> None:
    look = {"cmap": WARM.reversed(), "vmin": d["floor_threshold"], "vmax": 1, **GOURAUD}
    fill = ax.pcolormesh(np.degrees(d["tilt"]), d["friction"], d["threshold"], **look)
    lines = _threshold(ax, d, colors="k")
    ax.clabel(lines, fontsize=6, fmt="%.2f", manual=[(28, 0.7), (20, 0.6), (13, 0.5), (6, 0.4)])
    ax.plot(np.degrees(d["critical_tilt"]), d["critical_friction"], "k--")
    ax.text(47, 0.97, f"{d['floor_threshold']:.2f}", va="top", fontsize=6)
    ax.figure.colorbar(fill, ax=ax, label=r"$\epsilon_c$")


def _draw_search(ax: Axes, d: Data) -> None:
    levels = d["restitutions"][1:]
    colours = ListedColormap(plt.get_cmap("plasma")(np.linspace(0.75, 0, len(levels))))
    steps = BoundaryNorm(np.arange(len(levels) + 1), len(levels))
    _threshold(ax, d, colors=colours.colors)
    tilt_deg, friction = np.meshgrid(np.degrees(d["dot_tilt"]), d["dot_friction"])
    step = np.searchsorted(levels, d["dot_created"])
    some = np.isfinite(d["dot_created"])
    ax.scatter(tilt_deg[~some], friction[~some], s=1, color="0.8", linewidths=0)
    look = {"c": step[some], "cmap": colours, "norm": steps, "s": 5, "linewidths": 0}
    dots = ax.scatter(tilt_deg[some], friction[some], **look)
    bar = ax.figure.colorbar(dots, ax=ax, label=r"least $\epsilon$ found to create energy")
    bar.set_ticks(np.arange(len(levels)) + 0.5, labels=[f"{level:.2f}" for level in levels])


def _draw_outcomes(ax: Axes, d: Data) -> None:
    tilt_deg = np.degrees(d["tilt"])
    for i, (law, colour) in enumerate(zip(RESTITUTION_LAWS, (BLACK, RED, BLUE), strict=True)):
        ax.plot(tilt_deg, d["c_x"][i], color=colour, label=law.title())
        ax.plot(tilt_deg, d["c_z"][i], "--", color=colour)
    ax.plot([], [], "-", color="0.5", label=r"$c_x'$")
    ax.plot([], [], "--", color="0.5", label=r"$c_z'$")
    ax.set_ylabel(r"velocity / $|c_z|$")
    ax.legend()
    tilt_axis(ax)


def _draw_difference(ax: Axes, d: Data) -> None:
    tilt_deg = np.degrees(d["tilt"])
    look = {"cmap": WARM, "vmin": 0, **GOURAUD}
    fill = ax.pcolormesh(tilt_deg, d["friction"], d["difference"], **look)
    ax.plot(tilt_deg, d["slide_friction"], "k-")
    ax.plot(np.degrees(d["stopping_tilt"]), d["critical_friction"], "k--")
    for word, x, y in (("slide", 76, 0.75), ("stick", 8, 0.75), ("reversal", 36, 0.2)):
        ax.text(x, y, word, ha="center", va="center")
    ax.axhline(d["line_friction"], color="0.4", lw=0.8, ls=":")
    ax.set(ylabel=r"friction $\mu$", ylim=(0, 1))
    tilt_axis(ax)
    ax.figure.colorbar(fill, ax=ax, label=r"largest $|\Delta\mathbf{c}'|/|c_z|$")


@style
def draw(d: Data) -> plt.Figure:
    floor = d["restitutions"][0]
    found = np.count_nonzero(d["dot_created"] == floor)
    setting = rf"$\epsilon={d['line_restitution']:g}$, $-c_z/c_x={d['approach_ratio']:g}$"
    panels = {
        r"least $\epsilon$ that creates energy": _draw_creation,
        rf"found by search ({found or 'none'} at $\epsilon={floor:.2f}$)": _draw_search,
        rf"one impact, {setting}, $\mu={d['line_friction']:g}$": _draw_outcomes,
        setting: _draw_difference,
    }
    return painted(d, panels, rows=2, figsize=(7.0, 5.2))
