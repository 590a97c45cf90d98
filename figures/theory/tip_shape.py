"""Drift of thin, round-tipped and flat-ended rods by the theory and by repeated impacts.

The paper's closed forms hold for any contact geometry, its curves are those of a thin rod. (a) A
flat-ended rod stands on the lower edge of its end: below arctan(d/l), 7.125 degrees for the
experiment's l = 8 d, its centre of mass is on the other side of that edge and it drifts against
its tilt; at tilt 0 the contact jumps from edge to edge and the drift from one sign to the other.
Look at 8 degrees, where flat-ended rods began to move in the experiment; at the kinks slip-stick
turns into slip reversal. (b) Over rod length at 15 degrees, the tilt arccos(N d/L) of the paper's
Fig. 13(c): a sphere does not drift; look whether the drift saturates near l = 3 d, as it did there.
(c) The exact map, landing by landing at held tilt, mean over Gamma from 2 to 4, with its standard
error: the same threshold, reverse drift below it, flat ends slower just beyond it.
(d) One impact, straight down: the soft impact of `md` has the map's sign at each tilt; upright both
corners touch and push each other's way, so that a rod that stands on its end does not drift.
"""

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import sem

import md
from impact import collide, drift, flat_ended_rod, spherocylinder, thin_rod

from ..lib.bounces import bounced, estimates
from ..lib.runs import with_error
from ..lib.style import (
    ARROW,
    BLACK,
    GREEN,
    SHAPE_COLOURS,
    SHAPES,
    Data,
    curve,
    painted,
    style,
    tilt_axis,
    zero_line,
)
from ..paper.fig11 import HIGHEST

OBSERVED_DEG = 8.0  # experiment: flat-ended rods drift only above this tilt
FLAT = SHAPE_COLOURS["flat"]
TOLD = {"va": "center", "color": FLAT, "arrowprops": {**ARROW, "color": FLAT}}
LINES = {"thin": "-.", "round": "-", "flat": "-"}


def _bounced(quick: bool, length: float, setting: Data) -> Data:
    """Drift of repeated impacts at held tilt, in V_0; mean over Gamma and standard error."""
    gammas = np.linspace(2, 4, 5 if quick else 21)
    tilts = np.radians([1, 5, 8, 15, 28, 60] if quick else [*range(1, 12), *range(12, 61, 2)])
    found = {"bounced_tilt": tilts}
    for name, shape in (("round", spherocylinder), ("flat", flat_ended_rod)):
        runs = bounced(
            tilts[:, None],
            gammas,
            length,
            shape,
            landings=100 if quick else 500,
            rods=4,
            **setting,
        )
        drifts, _ = estimates(runs, "drift")
        found |= with_error(f"{name}_bounced", drifts.mean(axis=1), sem(drifts, axis=1))
    return found


def _one_impact(quick: bool, length: float, friction: float, restitution: float) -> Data:
    """c_x after one impact straight down on a flat end, in |c_z|: soft, and by the map."""
    degrees = [0, 0.02, 0.05, 0.1, 0.2, *([5, 10] if quick else range(1, 16))]
    half = np.radians(degrees)
    soft_tilt = np.append(-half[:0:-1], half)
    rod, law = md.Rod(length, ends="flat"), md.coulomb(restitution)
    soft = [
        md.impact(tilt, 0.0, -1.0, friction=friction, rod=rod, law=law).c_x for tilt in soft_tilt
    ]
    tilt = np.radians(np.append(-np.linspace(15, 0, 151), np.linspace(0, 15, 151)))
    rod = flat_ended_rod(tilt, length)
    return {
        "soft_tilt": soft_tilt,
        "soft": np.array(soft),
        "rigid_tilt": tilt,
        "rigid": collide(0.0, -1.0, geometry=rod, friction=friction, restitution=restitution).c_x,
    }


def data(
    quick: bool = False, friction: float = 0.3, restitution: float = 0.65, length: float = 8.0
) -> Data:
    """Drift in units of V_z, over tilt [rad] and over length; lengths in diameters."""
    n = 61 if quick else 601
    # The sign of a zero tilt says which edge of a flat end touches: both are there, in a row.
    tilt = np.radians(np.append(-np.linspace(20, 0, n // 3), np.linspace(0, 60, n)))
    fixed, lengths = np.radians(15), np.geomspace(1, 20, n)

    setting = {"friction": friction, "restitution": restitution}

    def c_x(rod):
        return drift(rod, **setting).c_x

    return {
        **setting,
        "length": length,
        "tilt": tilt,
        "thin": c_x(thin_rod(tilt)),
        "round": c_x(spherocylinder(tilt, length)),
        "flat": c_x(flat_ended_rod(tilt, length)),
        "flat_threshold": np.arctan(1 / length),
        "fixed_tilt": fixed,
        "lengths": lengths,
        "thin_by_length": np.full(n, c_x(thin_rod(fixed))),
        "round_by_length": c_x(spherocylinder(fixed, lengths)),
        "flat_by_length": c_x(flat_ended_rod(fixed, lengths)),
        "flat_length": 1 / np.tan(fixed),  # at this length 15 degrees is the threshold
        **_bounced(quick, length, setting),
        **_one_impact(quick, length, **setting),
    }


def _limit(d: Data) -> float:
    """Largest drift shown in (a) and (b), with room for words."""
    drifts = np.abs(
        np.concatenate([d[name] for kind in SHAPES for name in (kind, f"{kind}_by_length")])
    )
    return 1.45 * min(drifts[np.isfinite(drifts)].max(initial=0.1), HIGHEST)


def _cut(ax, tilt: np.ndarray, y: np.ndarray, form: str, colour: str):
    """Draw a curve over tilt that is cut at 0, where a flat end's contact jumps."""
    negative = np.signbit(tilt)
    for side in (negative, ~negative):
        ax.plot(np.degrees(tilt[side]), y[side], form, color=colour)


def _marks(ax, d):
    """Mark where a flat end turns by the closed form, and where it moved in the experiment."""
    ax.plot(np.degrees(d["flat_threshold"]), 0, "o", color=FLAT)
    ax.axvline(OBSERVED_DEG, color=GREEN, lw=0.8)


def _over_tilt(ax, d):
    limit, threshold_deg = _limit(d), np.degrees(d["flat_threshold"])
    for kind, line in LINES.items():
        _cut(ax, d["tilt"], d[kind], line, SHAPE_COLOURS[kind])
    edges = d["flat"][d["tilt"] == 0]
    ax.plot([0, 0], edges, "o:", color=FLAT, lw=1, ms=3, mfc="w")
    words = "contact jumps\nfrom edge to edge"
    ax.annotate(words, (0, edges.max()), (-19, 0.8 * limit), va="center", arrowprops=ARROW)
    ax.axvspan(-threshold_deg, threshold_deg, color=FLAT, alpha=0.1, lw=0)
    aside = min(threshold_deg, OBSERVED_DEG) - 0.5
    ax.text(aside, -0.94 * limit, "flat ends\nbackwards", color=FLAT, ha="right")
    _marks(ax, d)
    words = rf"$\arctan(d/l)$ = {threshold_deg:.3f}°"
    ax.annotate(words, (threshold_deg, 0), (16, -0.33 * limit), **TOLD)
    ax.text(OBSERVED_DEG + 1, -0.94 * limit, "experiment: flat\nends drift above 8°", color=GREEN)
    tilt_axis(ax, -20, 60, 10, ylabel=r"drift $c_x/V_z$", ylim=(-limit, limit))


def _over_length(ax, d):
    limit = _limit(d)
    for kind, line in LINES.items():
        y = d[f"{kind}_by_length"]
        ax.plot(d["lengths"], y, line, color=SHAPE_COLOURS[kind], label=SHAPES[kind])
    ax.plot(d["flat_length"], 0, "o", color=FLAT)
    words = rf"$l=d/\tan\phi={d['flat_length']:.2f}\,d$"
    ax.annotate(words, (d["flat_length"], 0), (6.2, -0.16 * limit), **TOLD)
    ax.axvline(3, color="0.5", lw=0.6, ls=":")
    words = rf"$\epsilon={d['restitution']:g}$, $\mu={d['friction']:g}$"
    ax.text(0.98, 0.97, words, transform=ax.transAxes, ha="right", va="top")
    ax.text(3.2, 0.86 * limit, "Fig. 13(c):\nsaturates", color="0.3", va="center")
    ax.set(xlabel="length $l/d$", xlim=(0, 20), xticks=(1, 3, 5, 10, 15, 20), ylim=(-limit, limit))
    ax.legend(loc="lower right")


def _over_bounces(ax, d):
    d = {**d, "deg": np.degrees(d["bounced_tilt"])}
    for kind in ("round", "flat"):
        curve(ax, d, "deg", f"{kind}_bounced", SHAPE_COLOURS[kind])
    _marks(ax, d)
    ax.text(0.97, 0.95, r"mean over $\Gamma$", transform=ax.transAxes, ha="right", va="top")
    tilt_axis(ax, 0, 60, 10, ylabel=r"drift $c_x/V_0$")


def _one(ax, d):
    _cut(ax, d["rigid_tilt"], d["rigid"], "-", FLAT)
    ax.plot([], [], color=FLAT, label="the map")
    ax.plot(np.degrees(d["soft_tilt"]), d["soft"], "o", color=BLACK, ms=2.5, label="soft impact")
    tilt_axis(ax, -15, 15, 5, ylabel=r"$c_x'/|c_z|$, from $c_x=0$")
    ax.legend(loc="lower right")


@style
def draw(d: Data) -> Figure:
    length = rf"$l={d['length']:g}\,d$"
    panels = {
        f"closure, {length}": _over_tilt,
        rf"closure, $\phi$ = {np.degrees(d['fixed_tilt']):g}°": _over_length,
        f"repeated impacts, {length}": _over_bounces,
        f"one impact, {length}": _one,
    }
    figure = painted(d, panels, 5.6, rows=2)
    for ax in figure.axes:
        zero_line(ax)
    return figure
