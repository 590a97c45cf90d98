"""Where Newton's kinematic restitution creates energy, and how far three laws differ.

Not in the paper; the debate of its reference [8], for a thin rod. (a) The restitution above which
some impact ends with more energy than it began with, in closed form: never below 4/5, which is
reached on the thick line only. (b) The same by search: each dot has the colour of the smallest of
the restitutions with which an impact was found that gains energy. Look whether the dots fill the
closed form's lines. (c), (d) What the choice of law moves: the velocities after one impact, and the
largest distance between the outcomes of two laws. Slides are the same under all three.
"""

from itertools import combinations
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from impact import collide, critical_friction, energy_restitution, slide_friction, thin_rod

from .shared import BLACK, BLUE, RED, name_panel, reversal_boundary, style, tilt_axis

LAWS = ("newton", "poisson", "stronge")
RESTITUTIONS = (0.8, 0.85, 0.9, 0.95, 0.99)


def largest_gain(tilt: Any, friction: Any, restitution: Any) -> np.ndarray:
    """Largest energy change under Newton's law over all u_0, in units of v_0^2, by search."""
    tilt, friction, restitution = np.broadcast_arrays(tilt, friction, restitution)
    centre, half = np.zeros((*tilt.shape, 1)), np.radians(80)  # of arctan(u_0/|v_0|)
    for points in (161, 41, 41):
        angle = centre + half * np.linspace(-1, 1, points)
        gain = collide(
            np.tan(angle),
            -1.0,
            geometry=thin_rod(tilt[..., None]),
            friction=friction[..., None],
            restitution=restitution[..., None],
        ).energy_change
        centre = np.take_along_axis(angle, gain.argmax(-1)[..., None], -1)
        half *= 2 / (points - 1)
    return gain.max(-1)


def _creation(n: int, dots: tuple[int, int]) -> dict[str, np.ndarray]:
    """Threshold of energy creation on a map, and the smallest restitution found to create it."""
    tilt, friction = np.linspace(0, np.pi / 2, n), np.linspace(0, 1, n)
    dot_tilt, dot_friction = ((np.arange(m) + 0.5) / m for m in dots)
    dot_tilt *= np.pi / 2
    levels = np.array(RESTITUTIONS)
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


def _after(tilt, friction, restitution, ratio) -> np.ndarray:
    """(c_x', c_z') after an impact with c_z = -1 under each law: shape (2, 3, ...)."""
    hits = [
        collide(
            1 / ratio,
            -1.0,
            geometry=thin_rod(tilt),
            friction=friction,
            restitution=restitution,
            law=law,
        )
        for law in LAWS
    ]
    return np.array([[hit.c_x for hit in hits], [hit.c_z for hit in hits]])


def data(
    quick: bool = False,
    friction: float = 0.5,
    restitution: float = 0.8,
    approach_ratio: float = 1.0,
) -> dict[str, np.ndarray]:
    """Thresholds and what the search found; outcomes of three laws in units of |c_z|."""
    n, dots = (46, (15, 10)) if quick else (361, (45, 30))
    d = _creation(n, dots)
    setting = (restitution, approach_ratio)
    d["c_x"], d["c_z"] = _after(d["tilt"], friction, *setting)
    everywhere = _after(d["tilt"], d["friction"][:, None], *setting)
    pairs = [everywhere[:, i] - everywhere[:, j] for i, j in combinations(range(len(LAWS)), 2)]
    return {
        **d,
        "line_friction": np.float64(friction),
        "line_restitution": np.float64(restitution),
        "approach_ratio": np.float64(approach_ratio),
        "difference": np.max([np.hypot(*pair) for pair in pairs], axis=0),
        "slide_friction": slide_friction(
            thin_rod(d["tilt"]), approach_ratio=approach_ratio, restitution=restitution
        ),
        **reversal_boundary(4 * n),
    }


def _threshold(ax: Axes, d: dict[str, np.ndarray], **kwargs: Any):
    """Closed-form lines of equal threshold, and the line on which it is least."""
    axes = np.degrees(d["tilt"]), d["friction"]
    lines = ax.contour(*axes, d["threshold"], levels=d["restitutions"][1:], linewidths=1, **kwargs)
    tilt, friction = d["floor"]
    ax.plot(2 * [np.degrees(tilt)], [friction, 1], color=BLACK, lw=2.5, solid_capstyle="butt")
    ax.set(ylabel=r"friction $\mu$", ylim=(0, 1))
    tilt_axis(ax)
    return lines


def _draw_creation(ax: Axes, d: dict[str, np.ndarray]) -> None:
    name_panel(ax, "a", r"least $\epsilon$ that creates energy")
    fill = ax.pcolormesh(
        np.degrees(d["tilt"]),
        d["friction"],
        d["threshold"],
        cmap="cividis_r",
        vmin=d["floor_threshold"],
        vmax=1,
        shading="gouraud",
        rasterized=True,
    )
    lines = _threshold(ax, d, colors="w")
    ax.clabel(lines, fontsize=6, fmt="%.2f")
    ax.plot(np.degrees(d["critical_tilt"]), d["critical_friction"], "k--")
    ax.text(47, 0.97, f"{d['floor_threshold']:.2f}", va="top", fontsize=6)
    ax.figure.colorbar(fill, ax=ax, label=r"$\epsilon_c$")


def _draw_search(ax: Axes, d: dict[str, np.ndarray]) -> None:
    name_panel(ax, "b", "found by search (dots)")
    colours = plt.get_cmap("viridis")(np.linspace(0.95, 0.1, len(d["restitutions"]) - 1))
    _threshold(ax, d, colors=colours)
    tilt_deg, friction = np.meshgrid(np.degrees(d["dot_tilt"]), d["dot_friction"])
    for level, colour in zip(d["restitutions"], [RED, *colours], strict=True):
        here = d["dot_created"] == level
        ax.plot(
            tilt_deg[here],
            friction[here],
            "o",
            color=colour,
            ms=2,
            mew=0,
            label=rf"$\epsilon={level:.2f}$" + ("" if here.any() else ": none"),
        )
    none = np.isnan(d["dot_created"])
    ax.plot(tilt_deg[none], friction[none], "o", color="0.8", ms=1, mew=0, label="no gain")
    ax.legend(loc="upper left", bbox_to_anchor=(1, 1), handletextpad=0, markerscale=2)


def _draw_outcomes(ax: Axes, d: dict[str, np.ndarray]) -> None:
    name_panel(ax, "c", rf"after one impact, $\mu={d['line_friction']:g}$")
    tilt_deg = np.degrees(d["tilt"])
    for i, (law, colour) in enumerate(zip(LAWS, (BLACK, RED, BLUE), strict=True)):
        ax.plot(tilt_deg, d["c_x"][i], color=colour, label=law.title())
        ax.plot(tilt_deg, d["c_z"][i], "--", color=colour)
    ax.plot([], [], "-", color="0.5", label=r"$c_x'$")
    ax.plot([], [], "--", color="0.5", label=r"$c_z'$")
    ax.set_ylabel(r"velocity / $|c_z|$")
    ax.legend()
    tilt_axis(ax)


def _draw_difference(ax: Axes, d: dict[str, np.ndarray]) -> None:
    name_panel(
        ax, "d", rf"$\epsilon={d['line_restitution']:g}$, $-c_z/c_x={d['approach_ratio']:g}$"
    )
    tilt_deg = np.degrees(d["tilt"])
    fill = ax.pcolormesh(
        tilt_deg,
        d["friction"],
        d["difference"],
        cmap="cividis_r",
        vmin=0,
        shading="gouraud",
        rasterized=True,
    )
    ax.plot(tilt_deg, d["slide_friction"], "k-")
    ax.plot(np.degrees(d["critical_tilt"]), d["critical_friction"], "k--")
    ax.axhline(d["line_friction"], color="0.4", lw=0.8, ls=":")
    ax.set(ylabel=r"friction $\mu$", ylim=(0, 1))
    tilt_axis(ax)
    ax.figure.colorbar(fill, ax=ax, label=r"largest $|\Delta\mathbf{c}'|/|c_z|$")


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, axes = plt.subplots(2, 2, figsize=(7.0, 5.2))
    panels = (_draw_creation, _draw_search, _draw_outcomes, _draw_difference)
    for ax, panel in zip(axes.flat, panels, strict=True):
        panel(ax, d)
    return figure
