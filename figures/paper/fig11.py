"""Fig. 11: stationary drift of thin rods over tilt, epsilon = 0.65, mu = 0.3.

Solid: what happens, Eq. (26) below the lower and above the upper critical tilt, Eq. (29) between
them. Dashed: the unphysical continuations of (26) and (29), as in the paper. Look at the inset:
the true curve comes back to (26) at the upper critical tilt, 84.04 degrees, and ends at zero, where
the one root that is printed as Eq. (23) would leave it on (29).
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

from derivations.bodies import THIN
from derivations.drift import stationary
from derivations.symbols import V_z, epsilon, length, mu, phi
from impact import critical_tilts, drift, thin_rod

from ..lib.style import ARROW, BLACK, BLUE, GREEN, RED, Data, style, tilt_axis


def data(quick: bool = False, friction: float = 0.3, restitution: float = 0.65) -> Data:
    """True drift and both branches over the whole range of tilt [rad], in units of V_z."""
    critical = np.array(critical_tilts(friction))
    grid = np.linspace(0, np.pi / 2, 91 if quick else 1801)
    tilt = np.sort(np.concatenate([grid, critical]))
    rod = thin_rod(tilt)
    moves = drift(rod, friction=friction, restitution=restitution)
    sticking = drift(rod, friction=np.inf, restitution=restitution)
    # `drift` never leaves the branch that holds; this one is followed beyond its range.
    form = (stationary("back")[0] / V_z).subs(THIN).subs(length, 1)  # any length: it cancels
    back = sp.lambdify((phi, mu, epsilon), form)
    return {
        "friction": np.float64(friction),
        "restitution": np.float64(restitution),
        "tilt": tilt,
        "c_x": moves.c_x,
        "c_z": moves.c_z,
        "regime": moves.regime,
        "stick_c_x": sticking.c_x,
        "reversal_c_x": back(tilt, friction, restitution),
        "critical_tilt": critical,
    }


def _curves(ax: plt.Axes, d: Data) -> None:
    tilt_deg = np.degrees(d["tilt"])
    ax.plot(tilt_deg, d["c_z"], "-.", color=GREEN, label=r"$c_z'/V_z$")
    for name, equation, colour in (("stick", 26, RED), ("reversal", 29, BLUE)):
        label = f"({equation}) where it does not hold"
        ax.plot(tilt_deg, d[f"{name}_c_x"], "--", color=colour, lw=1, label=label)
    ax.plot(tilt_deg, d["c_x"], color=BLACK, label=r"$c_x'/V_z$")
    for edge in np.degrees(d["critical_tilt"]):
        ax.axvline(edge, color="0.5", lw=0.6, ls=":")


@style
def draw(d: Data) -> plt.Figure:
    figure, ax = plt.subplots(figsize=(3.4, 3.0))
    _curves(ax, d)
    tilt_axis(ax)
    ax.set(ylabel=r"velocity / $V_z$", ylim=(0, 6.6))
    lower, upper = np.degrees(d["critical_tilt"])
    ax.text(lower + 1, 6.5, rf"$\phi_c$: {lower:.2f}°", va="top")
    ax.text(upper - 1, 6.5, f"second root: {upper:.2f}°", va="top", ha="right")
    setting = rf"$\epsilon={d['restitution']:g}$, $\mu={d['friction']:g}$"
    legend = {"loc": "upper right", "bbox_to_anchor": (0.93, 0.95), "title": setting}
    ax.legend(*(items[-1:] + items[:-1] for items in ax.get_legend_handles_labels()), **legend)

    inset = ax.inset_axes((0.52, 0.34, 0.4, 0.26))
    _curves(inset, d)
    inset.set(xlim=(78, 90), ylim=(0, 0.4), xticks=(80, 85, 90), yticks=(0, 0.2, 0.4))
    inset.tick_params(labelsize=6)
    place = 86.5, np.interp(86.5, np.degrees(d["tilt"]), d["c_x"])
    look = {"ha": "center", "va": "center", "arrowprops": ARROW, "fontsize": 6}
    inset.annotate("sticks\nagain", place, (82, 0.07), **look)
    ax.indicate_inset_zoom(inset, edgecolor="0.5", lw=0.6)
    return figure
