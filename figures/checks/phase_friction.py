"""Drift of the row over friction of the plate and restitution, at fixed tilt and Gamma = 3.3.

(a): simulated, (b): the theory for the spherocylinder at V_z = V_0/2, same colours. Line: friction
below which a stopped contact slips back, |XZ|/(k^2 + Z^2). (c): cut at the restitution of the
figures' law, with errors over independent starts; the theory with V_0/2 and with V_z as measured at
touches, each weighted by its speed of approach. Look at small friction: the theory's drift
stays finite as the friction goes to zero, that of the row goes to zero. And at large friction: the
theory's no longer changes. Restitution and friction are varied at the plate alone; rods rub on
each other with 0.3 throughout.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from impact import critical_friction, drift, spherocylinder

from ..lib.runs import (
    BOX,
    BOX_TILT,
    GAMMA,
    LAW_NAME,
    LENGTH,
    ROW,
    Sweeps,
    means,
    nearest,
    planned,
    plate_speed_cm_s,
    starts,
)
from ..lib.style import (
    BLACK,
    CENTRED,
    ORANGE,
    RIGID,
    WARM,
    Data,
    curve,
    name_panels,
    note,
    points,
    style,
    zero_line,
)
from ..paper.fig02 import AT_TOUCH

OF_LAW = ROW["contacts"]["plate"]["restitution"]
HALO = withStroke(linewidth=2, foreground="w")
FRICTION_MEANS = {"c_x": "c_x_cm_s", "V_z": AT_TOUCH}


def sweeps(quick: bool = False) -> Sweeps:
    """Sweep of the row over friction and restitution of the plate."""
    friction, restitution = [0.01, 0.1, 0.3, 1.0], {0.4, OF_LAW, 0.9}
    if not quick:
        friction = [0.001, 0.004, 0.02, 0.06, 0.12, 0.2, 0.3, 0.6, 2.0]
        restitution = {0.3, 0.5, OF_LAW, 0.95}
    axes = [{"contacts.plate.friction": friction}]
    axes += [{"contacts.plate.restitution": sorted(restitution)}, starts(2)]
    changes = {"box.length": BOX, "rods.inertia": "solid"}
    return {"grid": planned(axes, 30 if quick else 150, changes)}


def data(quick: bool = False) -> Data:
    """Drift [cm/s] on the grid (friction, restitution), measured and by the theory."""
    sweep = sweeps(quick)["grid"]
    friction = sweep.values("contacts.plate.friction")
    epsilon = sweep.values("contacts.plate.restitution")
    rod, speed = spherocylinder(BOX_TILT, LENGTH), plate_speed_cm_s()
    fine = np.geomspace(friction[0], friction[-1], 200)
    half = {"plate_velocity": speed / 2}
    return {
        "friction": friction,
        "restitution": epsilon,
        **means(sweep, FRICTION_MEANS),
        "theory": drift(rod, friction=friction[:, None], restitution=epsilon, **half).c_x,
        "fine_friction": fine,
        "fine_theory": drift(rod, friction=fine, restitution=OF_LAW, **half).c_x,
        "critical": critical_friction(rod),
        "nominal_deg": np.degrees(BOX_TILT),
    }


@style
def draw(d: Data) -> Figure:
    figure, (a, b, c) = plt.subplots(1, 3, figsize=(7.0, 3.1), width_ratios=(1, 1, 1.15))
    friction, restitution = d["friction"], d["restitution"]
    top = max(d["theory"].max(), np.nanmax(d["c_x"]))
    name_panels((a, b, c), ("simulated", "theory", rf"$\epsilon={OF_LAW:g}$"))
    rows, columns = np.arange(len(restitution)), np.arange(len(friction))
    critical = np.interp(np.log(d["critical"]), np.log(friction), columns)
    for ax, name in ((a, "c_x"), (b, "theory")):
        mesh = ax.pcolormesh(columns, rows, d[name].T, cmap=WARM, vmin=0, vmax=top)
        for (i, j), value in np.ndenumerate(d[name]):
            ax.text(i, j, f"{value:.1f}", **CENTRED, rotation=90, path_effects=[HALO])
        ax.set_xticks(columns, [f"{mu:g}" for mu in friction], rotation=60)
        ax.set_yticks(rows, [f"{e:g}" for e in restitution])
        ax.axvline(critical, color=BLACK, lw=0.8)
        ax.set_xlabel(r"friction $\mu$ of the plate")
        ax.tick_params(top=False, right=False)
    a.set_ylabel(r"restitution $\epsilon$")
    figure.colorbar(mesh, ax=[a, b], label=r"$c_x$ (cm/s)", pad=0.02)
    cut = nearest(restitution, OF_LAW)
    curve(c, d, "friction", "c_x", label="simulated", at=(..., cut), form="o")
    c.plot(d["fine_friction"], d["fine_theory"], color=ORANGE, label=r"theory, $V_0/2$")
    scaled = d["theory"][:, cut] * 2 * d["V_z"][:, cut]
    points(c, friction, scaled, None, RIGID, form="s-", ms=2.5, label=r"theory, measured $V_z$")
    c.axvline(d["critical"], 0, 0.67, color=BLACK, lw=0.8)
    zero_line(c)
    c.set(
        xscale="log",
        xlabel=r"friction $\mu$ of the plate",
        ylabel=r"$c_x$ (cm/s)",
        ylim=(min(0, 1.1 * np.nanmin(d["c_x"][:, cut])), 1.35 * max(np.nanmax(scaled), top)),
    )
    c.legend(loc="upper left")
    row = rf"$L={BOX:g}\,d$ ($\phi={d['nominal_deg']:.1f}$°), $\Gamma={GAMMA}$, $l={LENGTH}\,d$"
    note(figure, f"{row}, 60 Hz; {LAW_NAME}")
    return figure
