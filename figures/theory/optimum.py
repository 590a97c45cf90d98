"""The best tilt of a thin rod, its drift, and the best length of a short one; a prediction.

(a), (b) The tilt of the largest stationary drift and that drift over friction, in closed form, for
three restitutions. The optimum is that of slip reversal (blue), the critical tilt itself (orange, a
corner of the drift), or that of slip-stick (black), from where on friction matters no more. Look at
the orange pieces: on them the best tilt grows with friction. (c) The drift of a spherocylinder over
its length at the friction of (c)'s title: a sphere does not drift, a short rod drifts faster than a
long one. Dots: lengths of the largest drift in slip-stick, roots of a polynomial that is derived.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from derivations import function
from impact import Regime, critical_tilts, drift, optimal_tilt, spherocylinder

from ..lib.runs import SETTING
from ..lib.style import BLACK, BLUE, GREEN, ORANGE, RED, Data, painted, style

RESTITUTIONS = (0.5, 0.65, 0.8)
TILTS_DEG = (10.0, 20.0, 30.0, 45.0)
_PIECES = {BLUE: "of slip reversal", ORANGE: r"the critical tilt $\phi_c$", BLACK: "of slip-stick"}


def _best_length(tilt: float, restitution: float) -> float:
    """Length over diameter of the largest drift of a spherocylinder in slip-stick."""
    nodes = np.linspace(0, 1, 5)
    values = function("V: best length")(epsilon=restitution, phi=tilt, h_0=nodes)
    roots = np.polynomial.Polynomial.fit(nodes, values, 4).roots()
    return 1 + float(min(x.real for x in roots if abs(x.imag) < 1e-9 and x.real > 0))


def data(quick: bool = False) -> Data:
    """Optimum over friction, shape (restitutions, n), tilt in rad; drift over length at tilts."""
    n = 121 if quick else 601
    mu = np.linspace(0.4, 0, n, endpoint=False)[::-1]
    best = optimal_tilt(friction=mu, restitution=np.array(RESTITUTIONS)[:, None])
    corner = np.isclose(best.tilt, critical_tilts(mu)[0], rtol=1e-12)
    tilts, lengths = np.radians(TILTS_DEG), np.geomspace(1, 20, n)
    best_length = np.array([_best_length(tilt, SETTING["restitution"]) for tilt in tilts])
    return {
        "friction": mu,
        "restitution": np.array(RESTITUTIONS),
        "tilt": best.tilt,
        "c_x": best.c_x,
        "kind": np.where(best.regime == Regime.SLIP_REVERSAL, 0, np.where(corner, 1, 2)),
        "length_friction": np.float64(SETTING["friction"]),
        "length_restitution": np.float64(SETTING["restitution"]),
        "tilts": tilts,
        "lengths": lengths,
        "c_x_by_length": drift(spherocylinder(tilts[:, None], lengths), **SETTING).c_x,
        "best_length": best_length,
        "best_c_x": drift(spherocylinder(tilts, best_length), **SETTING).c_x,
    }


def _over_friction(ax: Axes, d: Data, y: np.ndarray) -> None:
    for row, values in enumerate(y):
        for kind, (colour, label) in enumerate(_PIECES.items()):
            here = np.where(d["kind"][row] == kind, values, np.nan)
            ax.plot(d["friction"], here, color=colour, label=None if row else label)
        place = d["friction"][-1], values[-1]
        word = rf"$\epsilon={d['restitution'][row]:g}$"
        ax.annotate(word, place, (-2, 2), textcoords="offset points", ha="right")
    ax.set(xlabel=r"friction $\mu$", xlim=(0, 0.4))


def _tilts(ax: Axes, d: Data) -> None:
    _over_friction(ax, d, np.degrees(d["tilt"]))
    ax.set(ylabel=r"best tilt (deg)", ylim=(0, 18))


def _drifts(ax: Axes, d: Data) -> None:
    _over_friction(ax, d, d["c_x"])
    ax.set(ylabel=r"largest drift $c_x/V_z$", ylim=(0, 5.5))


def _lengths(ax: Axes, d: Data) -> None:
    for i, colour in enumerate((BLACK, BLUE, GREEN, RED)):
        label = f"{np.degrees(d['tilts'][i]):g}°"
        ax.plot(d["lengths"], d["c_x_by_length"][i], color=colour, label=label)
        ax.plot(d["best_length"][i], d["best_c_x"][i], "o", color=colour, ms=4)
    ax.set(xscale="log", xlabel="length $l/d$", ylabel=r"drift $c_x/V_z$", xlim=(1, 20))
    ax.set(xticks=[1, 2, 5, 10, 20], xticklabels=["1", "2", "5", "10", "20"], ylim=(0, 5.6))
    ax.minorticks_off()
    ax.legend(title="tilt", ncols=2, loc="upper right")


@style
def draw(d: Data) -> plt.Figure:
    setting = rf"$\mu={d['length_friction']:g}$, $\epsilon={d['length_restitution']:g}$"
    panels = {"best tilt": _tilts, "its drift": _drifts, f"round tips, {setting}": _lengths}
    figure = painted(d, panels, figsize=(7.0, 2.9))
    handles = figure.axes[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=3, title="the optimum is")
    return figure
