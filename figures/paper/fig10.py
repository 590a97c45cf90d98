"""Fig. 10: regimes of an impact of a thin rod over tilt and friction, epsilon = 0.8, omega = 0.

Colours are what `impact.classify` answers point by point; lines are the closed forms u_* = 0 of
Eq. (14) and both roots of Eq. (23). Look whether lines and colours meet: a mistake in either would
part them. Slip reversal ends at mu = 3/4 and arctan 2, under the dot (the paper: 3/5 at 90
degrees, the cross), and at large tilt the contact sticks again.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from impact import classify, critical_tilts, slide_friction, thin_rod

from ..lib.style import (
    REGIME_LOOK,
    REGIME_WORDS,
    RIGID,
    Data,
    legend_above,
    name_panels,
    note,
    style,
    tilt_axis,
)

APPROACH_RATIOS = (1.0, 2.0, 10.0)  # -c_z/c_x of panels (a), (b), (c)


def data(quick: bool = False, friction: float | None = None, restitution: float = 0.8) -> Data:
    """Regimes, shape (3, n, n) over friction and tilt [rad], and the boundary lines.

    `friction`: one to mark.
    """
    n, points = (46, 200) if quick else (361, 1000)
    ratio = np.array(APPROACH_RATIOS)[:, None]
    tilt, over = np.linspace(0, np.pi / 2, n), np.linspace(0, 1, n)
    setting = {"approach_ratio": ratio, "restitution": restitution}
    line = np.linspace(0, np.pi / 2, points)
    # both roots as one line, from (0, 0) over the end of slip reversal to (90 degrees, 0)
    rising = 0.75 * np.sin(line)
    lower, upper = critical_tilts(rising)
    critical_tilt = np.append(lower, upper[::-1])
    critical_friction = np.append(rising, rising[::-1])
    stops = critical_friction >= slide_friction(thin_rod(critical_tilt), **setting)
    return {
        "approach_ratio": ratio.ravel(),
        "restitution": restitution,
        "tilt": tilt,
        "friction": over,
        **({} if friction is None else {"marked": friction}),
        "regime": classify(
            1.0,
            -ratio[:, None],
            geometry=thin_rod(tilt),
            friction=over[:, None],
            restitution=restitution,
        ),
        "slide_tilt": line,
        "slide_friction": slide_friction(thin_rod(line), **setting),
        "critical_tilt": np.where(stops, critical_tilt, np.nan),
        "critical_friction": critical_friction,
        "reversal_end": np.array([critical_tilts(0.75)[0], 0.75]),
    }


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplots(1, 3, figsize=(7.0, 3.2), sharey=True)
    end, end_friction = d["reversal_end"]
    end_deg = np.degrees(end)
    for i, ax in enumerate(axes):
        mesh = ax.pcolormesh(np.degrees(d["tilt"]), d["friction"], d["regime"][i], **REGIME_LOOK)
        slide_deg, slide = np.degrees(d["slide_tilt"]), d["slide_friction"][i]
        ax.plot(slide_deg, slide, "k-", label=r"$u_*=0$, Eq. (14)")
        critical_deg = np.degrees(d["critical_tilt"][i])
        ax.plot(critical_deg, d["critical_friction"], "k--", label="both roots of Eq. (23)")
        if np.interp(end_deg, slide_deg, slide) <= end_friction:
            ax.plot(end_deg, end_friction, "ko", label=r"$\mu=3/4$, $\phi=\arctan 2$")
        ax.plot(90, 0.6, "kx", ms=6, clip_on=False, label=r"as printed: 3/5 at 90°")
        if "marked" in d:
            ax.axhline(d["marked"], color=RIGID, ls=":", label=rf"$\mu={d['marked']:g}$")
        tilt_axis(ax, ylim=(0, 1))
    name_panels(axes, [rf"$-c_z/c_x={ratio:g}$" for ratio in d["approach_ratio"]])
    axes[0].set_ylabel(r"friction $\mu$")
    legend_above(figure, axes[2], ncols=5)
    restitution = rf"restitution $\epsilon={d['restitution']:g}$"
    note(figure, rf"thin rod, {restitution}, no spin before the impact ($\omega=0$)")
    bar = figure.colorbar(mesh, ax=axes, pad=0.02, aspect=12, label="regime")
    words = [word.replace(" ", "\n") for word in REGIME_WORDS.values()]
    bar.set_ticks([*REGIME_WORDS], labels=words)
    bar.ax.tick_params(which="both", length=0)
    return figure
