"""Fig. 11: stationary drift of thin rods over tilt, epsilon = 0.65, mu = 0.3.

Solid: what happens, Eq. (26) below the lower and above the upper critical tilt, Eq. (29) between
them. Dashed: the unphysical continuations of (26) and (29), as in the paper. Look at the inset:
the true curve comes back to (26) at the upper critical tilt, 84.04 degrees, and ends at zero, where
the one root that is printed as Eq. (23) would leave it on (29). Where friction holds at every tilt,
from mu = 3/4 on, there is no inset.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from derivations import function
from impact import Regime, critical_tilts, drift, thin_rod

from ..lib.style import (
    ANOTHER,
    ARROW,
    CENTRED,
    REGIME_COLOURS,
    SIMULATED,
    Data,
    legend_above,
    note,
    style,
    tilt_axis,
)

HIGHEST = 20.0  # V_z; without losses the drift has no bound


def data(quick: bool = False, friction: float = 0.3, restitution: float = 0.65) -> Data:
    """True drift and both branches over the whole range of tilt [rad], in units of V_z."""
    critical = np.array(critical_tilts(friction))
    grid = np.linspace(0, np.pi / 2, 91 if quick else 1801)
    tilt = np.sort(np.append(grid, critical[np.isfinite(critical)]))
    rod = thin_rod(tilt)
    moves = drift(rod, friction=friction, restitution=restitution)
    # `drift` never leaves the branch that holds; this one is followed beyond its range.
    with np.errstate(all="ignore"):  # without losses, upright; beyond all friction
        reversing = function("29")(phi=tilt, mu=friction, epsilon=restitution, V_z=1.0)
    return {
        "friction": friction,
        "restitution": restitution,
        "tilt": tilt,
        "c_x": moves.c_x,
        "c_z": moves.c_z,
        "regime": moves.regime,
        "stick_c_x": drift(rod, friction=np.inf, restitution=restitution).c_x,
        "reversal_c_x": reversing,
        "critical_tilt": critical,
    }


def _curves(ax, d):
    tilt_deg = np.degrees(d["tilt"])
    drifts = np.isfinite(d["c_x"]).any()  # without friction nothing says how fast
    ax.plot(tilt_deg, d["c_x"], color=SIMULATED, label=r"drift $c_x'$" if drifts else None)
    ax.plot(tilt_deg, d["c_z"], "-.", color=ANOTHER, label=r"rise $c_z'$")
    branches = (
        ("stick", Regime.SLIP_STICK, "slip-stick (26)"),
        ("reversal", Regime.SLIP_REVERSAL, "slip reversal (29)"),
    )
    for name, regime, words in branches:
        c_x = d[f"{name}_c_x"]
        unphysical = np.isfinite(c_x) & (d["regime"] != regime)
        label = f"{words} where it does not hold" if unphysical.any() else None
        ax.plot(tilt_deg, c_x, "--", color=REGIME_COLOURS[regime - 1], zorder=1.9, label=label)
    edges = critical_deg(d)
    label = f"roots of (23): {', '.join(f'{edge:.2f}°' for edge in edges)}"
    for edge in edges:
        ax.axvline(edge, color="0.5", lw=0.6, ls=":", label=label if edge == edges[0] else None)


def critical_deg(d: Data) -> np.ndarray:
    """Critical tilts in degrees; none where friction holds at every tilt."""
    return np.degrees(d["critical_tilt"][np.isfinite(d["critical_tilt"])])


def _end(ax, d):
    """Inset: the contact sticks again beyond the upper critical tilt, half way to the end."""
    tilt_deg, upper = np.degrees(d["tilt"]), critical_deg(d)[-1]
    inset = ax.inset_axes((0.42, 0.42, 0.45, 0.5))
    _curves(inset, d)
    left, middle = 2 * upper - 90, (upper + 90) / 2
    near = tilt_deg >= left
    top = 1.25 * max(d[name][near].max() for name in ("stick_c_x", "reversal_c_x", "c_z"))
    inset.set(xlim=(left, 90), ylim=(0, top))
    inset.locator_params(nbins=3)
    place = middle, np.interp(middle, tilt_deg, d["c_x"])
    aside = left + (90 - left) / 3, 0.18 * top
    inset.annotate("sticks\nagain", place, aside, **CENTRED, arrowprops=ARROW)
    ax.indicate_inset_zoom(inset, edgecolor="0.5", lw=0.6)


@style
def draw(d: Data) -> Figure:
    figure, ax = plt.subplots(figsize=(5.0, 3.6))
    _curves(ax, d)
    highest = min(np.nanmax([d["c_x"], d["c_z"]]), HIGHEST)
    tilt_axis(ax, ylabel=r"velocity / $V_z$", ylim=(0, 1.35 * highest))
    edges = critical_deg(d)
    if edges.size and edges[-1] < 89.9:  # else too narrow to see
        _end(ax, d)
    legend_above(figure, ax, ncols=2)
    setting = rf"$\epsilon={d['restitution']:g}$, friction $\mu={d['friction']:g}$"
    if d["friction"] == 0:
        setting += "; without friction no drift is determined"
    note(figure, f"thin rod, restitution {setting}")
    return figure
