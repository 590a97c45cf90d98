"""Every touch in the row beside the impact map: Sections IV and V, tested.

The map is fed what was measured at each touch (velocities, arms, plate velocity) and the measured
restitution -v_f/v_0, cut to [0, 1]. 40 rods, l = 9.5 d, epsilon = 0.65 head on, mu = 0.3; friction
of the plate as a constraint, unless the law is named. Each touch weighs what it changes of (c_x,
c_z, k omega). "Pushed": another rod pushes at some time during the touch; isolated: none does.
"Kicked": other rods gave more than a tenth of the change as a turn about the contact point, which
the plate cannot give.

(a) Regimes over tilt; (b) touches that are pushed, kicked; (c) error of the map, in isolated
touches also with gravity and the plate's acceleration during the contact allowed for; (d) over
Gamma; (e) over what rods lose when they meet. Dotted in (a) to (c): the tilt beyond which friction
cannot hold a tip.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

from impact import critical_friction
from md.scene import put, read_tables
from md.sweep import Sweep

from ..lib.runs import FRICTION, GAMMA, Sweeps, both, gathered, paper_rod, planned, with_error
from ..lib.style import (
    ANOTHER,
    BLACK,
    PRINTED_LAW,
    REGIME_COLOURS,
    REGIME_WORDS,
    SIMULATED,
    SKY,
    Data,
    curve,
    name_panels,
    style,
    tilt_axis,
)
from .census import DISTURBED, counted

CONTACTS = {  # a softer tangential spring between rods allows a larger step
    "constraint": {"contacts.plate.law": "coulomb", "contacts.rods.tangential_ratio": 5},
    "appendix_a": both(law="appendix_a", restitution="none"),
}
BOXES = (40.15, 40.6, 41.4, 43, 45.5, 48, 52, 57, 63, 70, 80)
VARIED = {  # key, its values, those of --quick; the law is the first one where none is named
    "constraint": ("box.length", BOXES, (40.6, 43, 48, 57, 80)),
    "appendix_a": ("box.length", BOXES, (43, 57)),
    "gamma": ("plate.acceleration", (1.2, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5), (1.5, 3.3, 5)),
    "lossy": ("contacts.rods.restitution", (0.3, 0.5, 0.65, 0.8, 0.9, 0.97), (0.3, 0.65, 0.9)),
}
CENSUS_PERIODS = {True: 20, False: 400}
FEWEST_ISOLATED = 30  # isolated touches, below which their mean is not drawn
CENSUS_ROW = put(read_tables("quasi2d"), {"step.size": "none"})
LAWS = {"constraint": ("constraint", SIMULATED), "appendix_a": ("Appendix A", PRINTED_LAW)}
KINDS = {  # of errors: their names and forms
    "pushed_residual": ("pushed", "s:"),
    "isolated_residual": ("isolated", "o-"),
    "isolated_allowed": ("allowed for", "^--"),
}
ISOLATED = "isolated_residual", "isolated_allowed"
STORED = "tilt", "slide", "stick", "reversal", "shared", "disturbed", "pushed_residual", *ISOLATED


def one_row(quick: bool) -> Sweep:
    """Sweep of one run: the row at its usual tilt, friction of the plate as a constraint."""
    return planned([], CENSUS_PERIODS[quick], CONTACTS["constraint"], CENSUS_ROW, counted)


def sweeps(quick: bool = False) -> Sweeps:
    """Sweeps of rows over tilt, law by law, over Gamma and over the restitution between rods."""
    return {
        name: planned(
            [{key: [*(few if quick else full)]}],
            CENSUS_PERIODS[quick],
            CONTACTS.get(name, CONTACTS["constraint"]),
            CENSUS_ROW,
            counted,
        )
        for name, (key, full, few) in VARIED.items()
    }


def reversal_tilt() -> float:
    """Tilt [deg] beyond which friction cannot hold the tip of the row's rods."""
    return np.degrees(brentq(lambda tilt: critical_friction(paper_rod(tilt)) - FRICTION, 0, 0.8))


def data(quick: bool = False) -> Data:
    """Measures over what each sweep varies, with their errors."""
    found = {"reversal_tilt_deg": reversal_tilt()}
    for name, sweep in sweeps(quick).items():
        found[name] = sweep.values(VARIED[name][0])
        *measured, isolated = gathered(sweep, *STORED, "isolated_count")
        for measure, values in zip(STORED, measured, strict=True):
            some = measure not in ISOLATED or isolated >= FEWEST_ISOLATED
            mean, error = np.where(some, values.T, np.nan)
            found |= with_error(f"{name}_{measure}", mean, error)
    return found


def _draw_regimes(ax, d):
    looks = zip(STORED[1:4], REGIME_COLOURS, REGIME_WORDS.values(), strict=True)
    for measure, colour, name in looks:
        curve(ax, d, "constraint_tilt", f"constraint_{measure}", colour, name)


def _draw_company(ax, d):
    """Draw the shares of touches with other rods in play, over tilt."""
    curve(ax, d, "constraint_tilt", "constraint_shared", ANOTHER, "pushed")
    curve(ax, d, "constraint_tilt", "constraint_disturbed", SKY, f"kicked > {DISTURBED:.0%}")
    curve(ax, d, "appendix_a_tilt", "appendix_a_shared", PRINTED_LAW, "pushed, Appendix A")


def _draw_residual(ax, d):
    for law, (name, colour) in LAWS.items():
        for kind, (_, form) in KINDS.items():
            curve(ax, d, f"{law}_tilt", f"{law}_{kind}", colour, form=form)
        ax.plot([], [], color=colour, label=name)
    for name, form in KINDS.values():
        ax.plot([], [], form, color="0.4", ms=3, lw=0.7, label=name)
    ax.set(ylabel="error / change", yscale="log", ylim=(1e-6, 1e7))


def _draw_shares(ax, d, sweep: str):
    """Draw shares of landings and errors of the map over what a sweep changes."""
    curve(ax, d, sweep, f"{sweep}_shared", ANOTHER, "pushed")
    curve(ax, d, sweep, f"{sweep}_slide", REGIME_COLOURS[0], "slide")
    for kind in ("pushed_residual", "isolated_residual"):
        name, form = KINDS[kind]
        curve(ax, d, sweep, f"{sweep}_{kind}", BLACK, f"error, {name}", form=form)
    ax.set(ylabel="share; error / change", ylim=(0, 1.03))
    ax.legend()


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplot_mosaic("aabbcc;dddeee", figsize=(7.0, 5.2))
    *over_tilt, gamma, lossy = axes.values()
    panels = {_draw_regimes: 0.64, _draw_company: 0.64, _draw_residual: 0.5}
    for ax, (panel, top) in zip(over_tilt, panels.items(), strict=True):
        tilt_axis(ax, 0, 65, ylabel="share of touches", ylim=(0, 1.6))
        panel(ax, d)
        ax.legend(loc="upper right")
        ax.axvline(d["reversal_tilt_deg"], 0, top, color="0.4", lw=0.8, ls=":")  # up to the legend
    _draw_shares(gamma, d, "gamma")
    gamma.set(xlabel=r"$\Gamma$", xlim=(1, 5.2), xticks=range(1, 6))
    _draw_shares(lossy, d, "lossy")
    lossy.set(xlabel="restitution between rods", xlim=(0.2, 1.05))
    titles = rf"regimes, $\Gamma={GAMMA:g}$", "not alone", "error of the map"
    name_panels(axes.values(), (*titles, "driving", "losses between rods"))
    return figure
