"""Where Newton's kinematic restitution creates energy, and how far three laws differ.

Not in the paper; the debate of its reference [8], for a thin rod. (a) The restitution above which
some impact ends with more energy than it began with, in closed form: never below 4/5, which is
reached on the thick line only. (b), (c) What the choice of law moves: the velocities after one
impact, and the largest distance between the outcomes of two laws. Slides are the same under all
three.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from impact import collide, critical_friction, energy_restitution, slide_friction, thin_rod

from ..lib.style import (
    BLACK,
    LAW_COLOURS,
    RESTITUTION_LAWS,
    WARM,
    Data,
    legend_above,
    note,
    painted,
    reversal_boundary,
    style,
    tilt_axis,
    where_it_stops,
)

GOURAUD = {"shading": "gouraud", "rasterized": True}
LEVELS = (0.85, 0.9, 0.95, 0.99)  # of the restitution in (a)


def _after(tilt, friction, restitution, approach_ratio) -> np.ndarray:
    """(c_x', c_z') after an impact with c_z = -1 under each law: shape (2, 3, ...)."""
    how = {"geometry": thin_rod(tilt), "friction": friction, "restitution": restitution}
    hits = [collide(1 / approach_ratio, -1.0, **how, law=law) for law in RESTITUTION_LAWS]
    return np.array([[hit.c_x for hit in hits], [hit.c_z for hit in hits]])


def data(quick: bool = False, friction: float = 0.5, restitution: float = 0.8) -> Data:
    """Thresholds of energy creation; outcomes of three laws in units of |c_z|."""
    n = 46 if quick else 361
    tilt, over = np.linspace(0, np.pi / 2, n), np.linspace(0, 1, n)
    floor = thin_rod(np.pi / 4)
    setting = {"approach_ratio": 1.0, "restitution": restitution}
    reversal = reversal_boundary(4 * n)
    c_x, c_z = _after(tilt, friction, **setting)
    everywhere = _after(tilt, over[:, None], **setting)
    apart = np.hypot(*(everywhere[:, :, None] - everywhere[:, None]))  # each law from each
    return {
        "tilt": tilt,
        "friction": over,
        "threshold": energy_restitution(thin_rod(tilt), over[:, None]),
        "floor": np.array([np.pi / 4, critical_friction(floor)]),  # 4/5 at and above this friction
        "floor_threshold": energy_restitution(floor, 1.0),
        "c_x": c_x,
        "c_z": c_z,
        "line_friction": np.float64(friction),
        "line_restitution": np.float64(setting["restitution"]),
        "approach_ratio": np.float64(setting["approach_ratio"]),
        "difference": apart.max(axis=(0, 1)),
        "slide_friction": slide_friction(thin_rod(tilt), **setting),
        **reversal,
        "stopping_tilt": where_it_stops(reversal, **setting),
    }


def _draw_creation(ax: Axes, d: Data) -> None:
    look = {"cmap": WARM.reversed(), "vmin": d["floor_threshold"], "vmax": 1, **GOURAUD}
    fill = ax.pcolormesh(np.degrees(d["tilt"]), d["friction"], d["threshold"], **look)
    axes = np.degrees(d["tilt"]), d["friction"]
    lines = ax.contour(*axes, d["threshold"], levels=LEVELS, linewidths=1, colors="k")
    tilt, friction = d["floor"]
    ax.plot(2 * [np.degrees(tilt)], [friction, 1], color=BLACK, lw=2.5, solid_capstyle="butt")
    ax.set(ylabel=r"friction $\mu$", ylim=(0, 1))
    tilt_axis(ax)
    ax.clabel(lines, fmt="%.2f", manual=[(28, 0.7), (20, 0.6), (13, 0.5), (6, 0.4)])
    ax.plot(np.degrees(d["critical_tilt"]), d["critical_friction"], "k--")
    ax.figure.colorbar(fill, ax=ax, label=r"$\epsilon_c$")


def _draw_outcomes(ax: Axes, d: Data) -> None:
    tilt_deg = np.degrees(d["tilt"])
    for i, (law, colour) in enumerate(LAW_COLOURS.items()):
        ax.plot(tilt_deg, d["c_x"][i], color=colour, label=law.title())
        ax.plot(tilt_deg, d["c_z"][i], "--", color=colour)
    for part in "xz":
        ax.text(88, d[f"c_{part}"][0, -1] + 0.06, rf"$c_{part}'$", ha="right", va="bottom")
    ax.set_ylabel(r"velocity / $|c_z|$")
    ax.margins(y=0.12)  # for the letters
    ax.legend()
    tilt_axis(ax)


def _draw_difference(ax: Axes, d: Data) -> None:
    tilt_deg = np.degrees(d["tilt"])
    look = {"cmap": WARM, "vmin": 0, **GOURAUD}
    fill = ax.pcolormesh(tilt_deg, d["friction"], d["difference"], **look)
    ax.plot(tilt_deg, d["slide_friction"], "k-", label=r"$u_*=0$, Eq. (14)")
    held = np.degrees(d["stopping_tilt"]), d["critical_friction"]
    ax.plot(*held, "k--", label="(a, c): both roots of Eq. (23)")
    free = 0.1 if abs(d["line_friction"] - 0.2) < 0.06 else 0.2  # of the dotted line
    for word, x, y in (("slide", 76, 0.75), ("stick", 13, 0.75), ("reversal", 36, free)):
        ax.text(x, y, word, ha="center", va="center")
    ax.axhline(d["line_friction"], color="0.4", ls=":", label="friction of (b)")
    ax.set(ylabel=r"friction $\mu$", ylim=(0, 1))
    tilt_axis(ax)
    ax.figure.colorbar(fill, ax=ax, label=r"largest $|\Delta\mathbf{c}'|/|c_z|$")


@style
def draw(d: Data) -> plt.Figure:
    setting = rf"$\epsilon={d['line_restitution']:g}$, $-c_z/c_x={d['approach_ratio']:g}$"
    panels = {
        r"$\epsilon$ that creates energy": _draw_creation,
        rf"one impact, $\mu={d['line_friction']:g}$": _draw_outcomes,
        "how far laws differ": _draw_difference,
    }
    figure = painted(d, panels, figsize=(7.0, 3.1))
    legend_above(figure, figure.axes[2], ncols=3)
    note(figure, f"thin rod; (a) 0.80 on the thick line; (b, c) {setting}")
    return figure
