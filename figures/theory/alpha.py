"""What the paper fits, computed: mean plate velocity at landing, alpha = V_z/V_0, and the drift.

One spherocylinder l = 9.5 d at fixed tilt, epsilon = 0.65, mu = 0.3, exact flights and impacts,
omega = 0 before each impact; a hop below 0.01 periods is no landing. Bars: one standard error over
independent rods; where it is large, rods have settled on different orbits. (a)-(c) over tilt at
Gamma = 3.3, (b) with the density of flights in grey; (d)-(f) over Gamma.

Dotted in (a)-(c): the tilt X^2 = epsilon k^2, from which on a stationary rod is hit again at once.
Dotted in (d): the perfectly inelastic rod. Dotted in (e): where the paper's rods begin to drift
forward. (At 9 degrees some of the rods, thrown at the start, find orbits that never rest.)
"""

from functools import partial

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from impact import drift, spherocylinder

from ..lib.bounces import bounced, estimates
from ..lib.runs import FRICTION, GAMMA, LENGTH, RESTITUTION, with_error
from ..lib.style import (
    BLACK,
    DOTTED,
    RIGID,
    SKY,
    THEORY,
    Data,
    curve,
    name_panels,
    note,
    shades,
    style,
    tilt_axis,
    zero_line,
)
from ..paper.fig02 import ONSET

SHORTEST_FLIGHT = 0.01  # periods
ALPHA_TILTS_DEG = (9, 20, 40)
small = partial(curve, ms=2)  # symbols of places close together
MEASURED_FIELDS = ("alpha", "alpha_impulse", "drift", "flight", "rest")


def _measured(prefix: str, runs: np.ndarray) -> Data:
    """Means and errors of runs, arrays of their shape, one a field."""
    found = {}
    for field in MEASURED_FIELDS:
        found |= with_error(f"{prefix}_{field}", *estimates(runs, field))
    return found


def data(
    quick: bool = False,
    friction: float = FRICTION,
    restitution: float = RESTITUTION,
    length: float = LENGTH,
) -> Data:
    """Sweeps over tilt [rad] and gamma; velocities in V_0, flights in periods."""
    setting = {"friction": friction, "restitution": restitution}
    rods, landings = (30, 200) if quick else (200, 1000)
    run = partial(
        bounced,
        length=length,
        landings=landings,
        rods=rods,
        transient=200,
        shortest_flight=SHORTEST_FLIGHT,
        **setting,
    )
    tilts = np.radians(np.arange(0, 76, 5 if quick else 1))
    gammas = np.append(
        1 + np.geomspace(1e-3, 0.1, 4 if quick else 8), np.arange(1.2, 5.01, 0.4 if quick else 0.1)
    )
    few, over_tilt = np.radians(ALPHA_TILTS_DEG), run(tilts, GAMMA)
    fine = np.append(1 + np.geomspace(1e-4, 0.1, 30), np.linspace(1.11, np.hypot(1, np.pi)))
    inelastic = bounced(0.0, fine, length, friction=friction, restitution=0.0, landings=1)
    flat = spherocylinder(np.pi / 2, length)
    with np.errstate(all="ignore"):
        again = np.arcsin(np.sqrt(restitution) * flat.k / flat.X)
    return {
        "tilt": tilts,
        **_measured("tilt", over_tilt),
        "tilt_flights": np.array([each.flights.mean for each in over_tilt]),
        "steady_c_x": drift(spherocylinder(tilts, length), **setting).c_x,
        "again_tilt": again,
        **setting,
        "length": length,
        "gammas": gammas,
        "gamma_tilt": few,
        **_measured("gamma", run(few[:, None], gammas)),
        "inelastic_gamma": fine,
        "inelastic_alpha": estimates(inelastic, "alpha")[0],
    }


def _over_tilt(axes, d):
    deg = np.degrees(d["tilt"])
    d = {**d, "deg": deg}
    again, (a, b, c) = np.degrees(d["again_tilt"]), axes
    small(a, d, "deg", "tilt_alpha", SKY, "every landing alike")
    small(a, d, "deg", "tilt_alpha_impulse", RIGID, "weighted by impulse")
    a.axhline(0.5, color=THEORY, ls="--", label="Eq. (31): 1/2")
    a.set_ylabel(r"$\alpha=\langle V_z\rangle/V_0$")
    zero_line(a)

    share = d["tilt_flights"].T / 16
    b.pcolormesh(
        deg,
        np.arange(len(share)) / 16,
        np.sqrt(share),
        cmap="Greys",
        vmin=0,
        vmax=1,
        rasterized=True,
    )
    small(b, d, "deg", "tilt_flight", RIGID, "mean")
    b.set(ylabel="flight (periods)", ylim=(0, 3.2))
    if again >= 0:
        b.plot([], [], ":", color=BLACK, label=rf"$X^2=\epsilon k^2$, {again:.1f}°")

    small(c, d, "deg", "tilt_drift", RIGID, "computed")
    steady, label = d["steady_c_x"], r"(24), (27), computed $\alpha$"
    c.plot(deg, steady * d["tilt_alpha_impulse"], color=THEORY, lw=0.8, label=label)
    c.plot(deg, steady / 2, "--", color=THEORY, label=r"(24), (27), $\alpha=1/2$")
    c.set(ylabel=r"drift / $V_0$", ylim=(0, 1.45 * d["tilt_drift"].max() or 1))
    for ax in axes:
        tilt_axis(ax, 0, 75)
        ax.axvline(again, **DOTTED)
        ax.legend()
    c.legend(loc="upper right")


def _over_gamma(axes, d):
    a, b, c = axes
    for i, colour in enumerate(shades(len(d["gamma_tilt"]))):
        label = rf"$\phi={np.degrees(d['gamma_tilt'][i]):.0f}$°"
        for ax, name in zip(axes, ("alpha_impulse", "drift", "rest"), strict=True):
            small(ax, d, "gammas", f"gamma_{name}", colour, label, at=i)
    a.plot(d["inelastic_gamma"], d["inelastic_alpha"], ":", color=BLACK, label=r"$\epsilon=0$")
    a.set(ylabel=r"$\alpha$, weighted by impulse", ylim=(-1.1, 1.1))
    zero_line(a)
    b.set_ylabel(r"drift / $V_0$")
    zero_line(b)
    b.axvline(ONSET, **DOTTED, label="experiment")
    c.set(ylabel="part of the time at rest", ylim=(-0.02, 1))
    for ax in axes:
        ax.set(xlabel=r"acceleration $\Gamma$", xlim=(0.9, 5.1), xticks=range(1, 6))
    a.legend(handles=a.lines[-2:-1])
    b.legend(handles=b.lines[-1:])
    c.legend(title="tilt")


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 5.0))
    _over_tilt(axes[0], d)
    _over_gamma(axes[1], d)
    name_panels(axes.flat, [rf"$\Gamma={GAMMA:g}$"] * 3 + [""] * 3)
    note(
        figure, rf"$\epsilon={d['restitution']:g}$, $\mu={d['friction']:g}$, $l={d['length']:g}\,d$"
    )
    return figure
