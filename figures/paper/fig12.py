"""Fig. 12: one soft impact over tilt against the closed forms, and what restitution it shows.

mu = 0.4, -c_z/c_x = 2, |c_z| = 1 sqrt(g d), l = 9.5 d, thin inertia, k_n = 5e6 m g/d^(3/2). (a)
friction as a constraint, the law under which the paper's figure comes out: symbols on the lines,
and on the theory at the restitution measured at each tilt they cannot be told apart. (b)
Appendix A as printed: neither. (c) the restitution of a soft contact is not constant, although its
dashpot gives 0.65 head on at every speed: friction adds to or takes from the work of compression.
(d) one constant in Stronge's (energetic) law explains that best.
"""

from functools import partial

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

import md
from impact import Collision

from ..lib.soft_impacts import SCENE_WORDS, TABLE_TILTS, Soft, compared, distance, rigid, simulate
from ..lib.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    RED,
    RESTITUTION_LAWS,
    Data,
    legend_above,
    painted,
    shade,
    style,
    tilt_axis,
)

EPSILON = 0.65
SOFT = {  # all with k_n = 5e6
    "coulomb": md.coulomb(EPSILON),
    "constant_restitution": md.constant_restitution(EPSILON),
    "appendix_a": md.appendix_a(),
}
_DASHES = {1: "--", 2: "-", 3: "-."}  # the paper's: slide, slip-stick, slip reversal
_COLOURS = {"coulomb": BLACK, "constant_restitution": BLUE, "appendix_a": RED}
_LAWS = ("Newton", ORANGE, "-."), ("Poisson", GREEN, "-."), ("Stronge", GREEN, ":")


def data(quick: bool = False) -> Data:
    """Velocities over |c_z| and restitution; MD arrays are of shape (3 laws, tilts)."""
    tilt = np.radians(np.linspace(0, 89, 90) if not quick else np.arange(0, 90, 5))
    edges = np.radians(np.linspace(0, 90, 181 if quick else 1801))
    line = (edges[1:] + edges[:-1]) / 2
    soft = [simulate(tilt, law) for law in SOFT.values()]
    fine = [simulate(tilt, law, refine=64) for law in SOFT.values()]
    coarse = [simulate(TABLE_TILTS, law) for law in SOFT.values()]
    measured = np.array([compared(s, rigid(TABLE_TILTS, s.restitution)) for s in coarse])
    theory = {law: rigid(line, EPSILON, law=law) for law in RESTITUTION_LAWS}
    at_measured = [rigid(tilt, s.restitution) for s in soft]

    def off(theory: Collision) -> np.ndarray:
        return np.hypot(soft[0].c_x - theory.c_x, soft[0].c_z - theory.c_z)

    return {
        **{"tilt": tilt, "line_tilt": line, "line_edges": edges, "epsilon": np.float64(EPSILON)},
        **{field: np.array([getattr(s, field) for s in soft]) for field in Soft._fields},
        "measured_c_x": np.array([r.c_x for r in at_measured]),
        "measured_c_z": np.array([r.c_z for r in at_measured]),
        "line_c_x": theory["newton"].c_x,
        "line_c_z": theory["newton"].c_z,
        "line_regime": theory["newton"].regime,
        "line_restitution": np.array([theory[law].normal_velocity for law in RESTITUTION_LAWS]),
        # distance of the first law's symbols from each theory at the constant, and at the measured
        "off": np.array([off(rigid(tilt, EPSILON, law=law)) for law in RESTITUTION_LAWS]),
        "off_measured": off(at_measured[0]),
        "step_error": np.array([distance(a, b) for a, b in zip(soft, fine, strict=True)]),
        "rms_constant": np.array([distance(s, rigid(TABLE_TILTS, EPSILON)) for s in coarse]),
        "rms_measured": measured[:, 0],
        "regimes_right": measured[:, 1].astype(int),
    }


def _draw_velocities(ax: Axes, d: Data, i: int) -> None:
    deg, line_deg = np.degrees(d["tilt"]), np.degrees(d["line_tilt"])
    shade(ax, np.degrees(d["line_edges"]), d["line_regime"])
    some = slice(None, None, 1 if deg.size < 50 else 3)
    for part, colour, marker in (("c_x", BLACK, "o"), ("c_z", BLUE, "s")):
        for regime, dashes in _DASHES.items():
            here = np.where(d["line_regime"] == regime, d[f"line_{part}"], np.nan)
            ax.plot(line_deg, here, dashes, color=colour, lw=1)
        ax.plot(deg, d[f"measured_{part}"][i], "-", color=GREEN, lw=2.6, alpha=0.6, zorder=1.9)
        ax.plot(deg[some], d[part][i, some], marker, color=colour, mfc="none", ms=3, mew=0.7)
    ax.set(ylabel=r"velocity / $|c_z|$", ylim=(-1.05, 1.3))
    tilt_axis(ax)


def _legend(ax: Axes) -> None:
    for marker, colour, part in (("o", BLACK, "x"), ("s", BLUE, "z")):
        ax.plot([], [], marker, color=colour, mfc="none", ms=3, label=rf"$c_{part}'$, MD")
    for regime, name in ((2, "slip-stick"), (1, "slide"), (3, "slip reversal")):
        ax.plot([], [], _DASHES[regime], color="0.3", lw=1, label=rf"{name}, $\epsilon=0.65$")
    ax.plot([], [], "-", color=GREEN, lw=2.6, alpha=0.6, label=r"theory, measured $\epsilon$")


def _draw_restitution(ax: Axes, d: Data) -> None:
    line_deg = np.degrees(d["line_tilt"])
    for (name, colour), e in zip(_COLOURS.items(), d["restitution"], strict=True):
        dashes = "-" if name != "constant_restitution" else (0, (4, 1.5))
        ax.plot(np.degrees(d["tilt"]), e, ls=dashes, color=colour, label=f"MD, {name}")
    for (label, colour, dashes), e in zip(_LAWS, d["line_restitution"], strict=True):
        ax.plot(line_deg, e, dashes, color=colour, lw=1, label=f"{label}, {EPSILON}")
    ax.set(ylabel=r"restitution $-v_f/v_0$", ylim=(0.45, 1.25))
    ax.legend(ncols=2, loc="upper center", fontsize=6, handlelength=1.8, columnspacing=1)
    tilt_axis(ax)


def _draw_off(ax: Axes, d: Data) -> None:
    deg = np.degrees(d["tilt"])
    for (label, colour, dashes), off in zip(_LAWS, d["off"], strict=True):
        ax.plot(deg, off, dashes, color=colour, label=f"{label}, {EPSILON}")
    ax.plot(deg, d["off_measured"], "-", color=BLACK, label="Newton, measured")
    ax.set(yscale="log", ylim=(3e-5, 1), ylabel=r"$|\Delta\mathbf{c}'|/|c_z|$")
    ax.legend(ncols=2, loc="upper center", fontsize=6)
    tilt_axis(ax)


@style
def draw(d: Data) -> plt.Figure:
    panels = {
        "MD: coulomb": partial(_draw_velocities, i=0),
        "MD: appendix_a as printed": partial(_draw_velocities, i=2),
        "measured restitution": _draw_restitution,
        "MD (coulomb) from theory": _draw_off,
    }
    figure = painted(d, panels, rows=2, figsize=(7.0, 5.6))
    first, *_ = figure.axes
    for x, y, word in ((11, -0.93, "slip-stick"), (50, -0.93, "slip reversal"), (85, 1.1, "slide")):
        first.text(x, y, word, ha="center", fontsize=7)
    _legend(first)
    legend_above(figure, first, ncols=6, fontsize=6.5, handlelength=1.8, columnspacing=1.2)
    figure.supxlabel(
        rf"{SCENE_WORDS}, $k_n=5\times10^6\,mg/d^{{3/2}}$"
        "\nhead on 0.65; constant_restitution: tangential ratio 30, damping 1;"
        r" appendix_a: $k_t=95\,k_n$, $\gamma=400$, $M_e=1/2$"
    )
    return figure
