"""Fig. 11: stationary drift of thin rods over tilt, epsilon = 0.65, mu = 0.3.

Solid: what happens, Eq. (26) below the lower and above the upper critical tilt, Eq. (29) between
them. Dashed: the unphysical continuations of (26) and (29), as in the paper. Look at the inset:
the true curve comes back to (26) at the upper critical tilt, 84.04 degrees, and ends at zero, where
the one root that is printed as Eq. (23) would leave it on (29). Where friction holds at every tilt,
from mu = 3/4 on, there is no inset.
"""

import matplotlib.pyplot as plt
import numpy as np
import sympy as sp

from derivations.bodies import THIN
from derivations.drift import stationary
from derivations.symbols import V_z, epsilon, length, mu, phi
from impact import Regime, critical_tilts, drift, thin_rod

from ..lib.style import ASIDE, BLACK, BLUE, GREEN, LEGEND_BOX, RED, Data, style, tilt_axis

HIGHEST = 20.0  # V_z; without losses the drift has no bound


def data(quick: bool = False, friction: float = 0.3, restitution: float = 0.65) -> Data:
    """True drift and both branches over the whole range of tilt [rad], in units of V_z."""
    critical = np.array(critical_tilts(friction))
    grid = np.linspace(0, np.pi / 2, 91 if quick else 1801)
    tilt = np.sort(np.concatenate([grid, critical[np.isfinite(critical)]]))
    rod = thin_rod(tilt)
    moves = drift(rod, friction=friction, restitution=restitution)
    sticking = drift(rod, friction=np.inf, restitution=restitution)
    # `drift` never leaves the branch that holds; this one is followed beyond its range.
    form = (stationary("back")[0] / V_z).subs(THIN).subs(length, 1)  # any length: it cancels
    back = sp.lambdify((phi, mu, epsilon), form)
    with np.errstate(divide="ignore"):  # without losses, upright
        reversing = back(tilt, friction, restitution)
    return {
        "friction": np.float64(friction),
        "restitution": np.float64(restitution),
        "tilt": tilt,
        "c_x": moves.c_x,
        "c_z": moves.c_z,
        "regime": moves.regime,
        "stick_c_x": sticking.c_x,
        "reversal_c_x": reversing,
        "critical_tilt": critical,
    }


def _curves(ax: plt.Axes, d: Data) -> None:
    tilt_deg, reverses = np.degrees(d["tilt"]), d["regime"] == Regime.SLIP_REVERSAL
    ax.plot(tilt_deg, d["c_z"], "-.", color=GREEN, label=r"$c_z'/V_z$")
    branches = ("stick", 26, RED, reverses), ("reversal", 29, BLUE, ~reverses)
    for name, equation, colour, unphysical in branches:
        label = f"({equation}) where it does not hold" if unphysical.any() else None
        ax.plot(tilt_deg, d[f"{name}_c_x"], "--", color=colour, lw=1, label=label)
    ax.plot(tilt_deg, d["c_x"], color=BLACK, label=r"$c_x'/V_z$")
    for edge in critical_deg(d):
        ax.axvline(edge, color="0.5", lw=0.6, ls=":")


def critical_deg(d: Data) -> np.ndarray:
    """Critical tilts in degrees; none where friction holds at every tilt."""
    return np.degrees(d["critical_tilt"][np.isfinite(d["critical_tilt"])])


def _end(ax: plt.Axes, d: Data, upper: float) -> None:
    """Inset: the contact sticks again beyond the upper critical tilt, half way to the end."""
    tilt_deg = np.degrees(d["tilt"])
    inset = ax.inset_axes((0.52, 0.32, 0.4, 0.24))
    _curves(inset, d)
    left, middle = 2 * upper - 90, (upper + 90) / 2
    near = tilt_deg >= left
    top = 1.25 * max(d["stick_c_x"][near].max(), d["reversal_c_x"][near].max())
    inset.set(xlim=(left, 90), ylim=(0, top))
    inset.locator_params(nbins=3)
    inset.tick_params(labelsize=6)
    place = middle, np.interp(middle, tilt_deg, d["c_x"])
    aside = left + (90 - left) / 3, 0.18 * top
    inset.annotate("sticks\nagain", place, aside, fontsize=6, **ASIDE)
    ax.indicate_inset_zoom(inset, edgecolor="0.5", lw=0.6)


@style
def draw(d: Data) -> plt.Figure:
    figure, ax = plt.subplots(figsize=(3.4, 3.0))
    _curves(ax, d)
    tilt_axis(ax)
    highest = min(max(d["c_x"].max(), d["c_z"].max()), HIGHEST)
    ax.set(ylabel=r"velocity / $V_z$", ylim=(0, 1.4 * highest))
    critical = critical_deg(d)
    if critical.size:
        ends = ", ".join(f"{edge:.2f}°" for edge in critical)
        ax.plot([], [], ":", color="0.5", lw=0.6, label=rf"$\phi_c$: {ends}")
    setting = rf"$\epsilon={d['restitution']:g}$, $\mu={d['friction']:g}$"
    handles, labels = ax.get_legend_handles_labels()
    order = sorted(range(len(labels)), key=lambda i: "c_x" not in labels[i])
    ax.legend(
        [handles[i] for i in order],
        [labels[i] for i in order],
        **{"loc": "upper right", "bbox_to_anchor": (0.96, 0.99), "title": setting, **LEGEND_BOX},
    )
    if critical.size:
        _end(ax, d, critical[-1])
    return figure
