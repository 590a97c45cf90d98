"""Fig. 4: drift of rods in the annulus over tilt, acceleration, friction of walls and of the plate.

Means over independent starts; errors are the larger of those between and within the runs. (a): the
number of rods sets the tilt; without (full) and with (open) rotation about the rods' own axes;
squares: plane rows of the same rods without walls, reduced 2.5-fold, which is the paper's ratio;
triangles: a narrower gap in which a rod leans by the paper's 53 degrees at most: there rods wedge
between the walls and stand still; dotted: the paper's maxima. (b): dotted: where the paper's rods
begin to move; open: 44 rods between walls at rest, while else walls and plate shake as one piece.
(c, d): drift, and tilt (green), of 44 rods; the row of (d) is logarithmic but for
its first point, no friction.
"""

from collections.abc import Sequence

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from md.scene import put
from md.sweep import Sweep

from ..claims.uncertainty import bend
from ..lib.arrangement import followed
from ..lib.runs import (
    ANNULUS,
    ANNULUS_COUNT,
    GAMMA,
    ROW,
    SIMPLE_ANNULUS,
    SIMPLE_ROW,
    Changes,
    Sweeps,
    Tables,
    annulus_of,
    boxes,
    drift_and_tilt,
    nearest,
    planned,
    starts,
)
from ..lib.style import (
    ANOTHER,
    BLACK,
    FAINT,
    ORANGE,
    PURPLE,
    SKY,
    Data,
    curve,
    name_panels,
    note,
    shades,
    style,
    tilt_axis,
    zero_line,
)

MAXIMA_DEG, ONSET_FIG4, REDUCTION = (18, 35), 1.5, 2.5  # the paper's
GAMMA_COUNTS = (50, 44, 36)  # numbers of rods of (b)
WALL_KEY, PLATE_KEY = "contacts.wall.friction", "contacts.plate.friction"
AT_REST = {"annulus.shaken": False}
USUAL = {"rods.rolling": False, "annulus.shaken": True}  # where neither is varied
NARROW = {"annulus.outer": 7.3304}  # largest tilt 53 degrees, as the paper says of its annulus
FEW = 2  # starts of all but the row without rolling
SIZES = {  # in full, quick
    "count": ([23, 26, 29, 32, *range(34, 57, 2)], [26, 36, 44, 50, 56]),
    # denser ones jam between walls at rest
    "rolling": ([23, 29, *range(34, 53, 2)], [26, 36, 44, 50]),
    "rest": ([23, 29, *range(34, 57, 2)], [26, 36, 44]),
    "narrow": ([22, 23, 24, 26, 29, 32, 36, 40, 44], [23, 26, 36]),
    "gamma": ([1.05, 1.4, 1.6, 1.8, 2.0, 3.0, 4.0], [1.3, 1.8, 3.3]),
    "wall": ([0, 0.03, 0.1, 0.3, 0.5, 1.0], [0.03, 0.3, 1.0]),  # none at all: another kernel
    "plate": ([0, 0.01, 0.03, 0.1, 0.3, 1.0, 2.0], [0.01, 0.1, 0.3]),
    "plane": ([*range(5, 51, 5)], [10, 20, 30, 40]),
    "starts": (5, 2),
    "periods": (400, 20),  # a region of larger tilt (Fig. 5) takes hundreds to grow
    "gamma_periods": (200, 20),
}


def over_count(
    counts: Sequence[int],
    seeds: int,
    periods: int,
    base: Tables,
    changes: Changes | None = None,
) -> Sweep:
    """Sweep of annuli over the number of rods, which sets the tilt, and starts."""
    axes = [{"rods.count": [*counts]}, starts(seeds)]
    return planned(axes, periods, changes, base, measure=followed)


def sweeps(quick: bool = False, assumed: bool = False, scene: str | None = None) -> Sweeps:
    """Sweeps of annuli over the number of rods, Gamma and the frictions; of rows over tilt.

    Parameters
    ----------
    quick : the small size
    assumed : under the simple law, with few starts, and without what no claim needs
    scene : an annulus of one's own; then without rows and without the narrower gap
    """
    size = {name: both[quick] for name, both in SIZES.items()}
    of = annulus_of(scene)
    base, row = put(of.tables, USUAL), ROW
    if assumed:
        base, row = SIMPLE_ANNULUS, SIMPLE_ROW
    few, periods = starts(FEW), size["periods"]
    seeds = FEW if assumed else size["starts"]
    gamma, gamma_periods = {"plate.acceleration": size["gamma"]}, size["gamma_periods"]
    many = {"rods.count": of.counts([ANNULUS_COUNT])[0]}

    def around(*axes: dict[str, list], periods: int = periods, **changes: object) -> Sweep:
        return planned([*axes, few], periods, changes, base)

    of_rods = {
        f"rods.{name}": ANNULUS["rods"][name] for name in ("length", "inertia", "diameter_cm")
    }
    found = {
        "still": over_count(of.counts(size["count"]), seeds, periods, base),
        "rolling": around({"rods.count": of.counts(size["rolling"])}, **{"rods.rolling": True}),
        "gamma": around(gamma, {"rods.count": of.counts(GAMMA_COUNTS)}, periods=gamma_periods),
        "wall": around({WALL_KEY: size["wall"]}, **many),
        "plane": planned([{"box.length": boxes(size["plane"])}, few], periods, of_rods, row),
    }
    if assumed:
        return found
    found |= {
        "rest": over_count(of.counts(size["rest"]), FEW, periods, base, AT_REST),
        "rest_gamma": around(gamma, periods=gamma_periods, **many, **AT_REST),
        "plate": around({PLATE_KEY: size["plate"]}, **many),
    }
    if scene is None:
        found["narrow"] = over_count(size["narrow"], FEW, periods, base, NARROW)
    else:
        del found["plane"]
    return found


def data(quick: bool = False, assumed: bool = False, scene: str | None = None) -> Data:
    """Drifts in cm/s and tilts in degrees with their errors."""
    runs, of = sweeps(quick, assumed, scene), annulus_of(scene)
    axes = {"gamma": "plate.acceleration", "wall": WALL_KEY, "plate": PLATE_KEY}
    found = {
        "count": runs["still"].values("rods.count"),
        "rolling": runs["rolling"].values("rods.count"),
        "few": np.array(of.counts(GAMMA_COUNTS)),
        "many": of.counts([ANNULUS_COUNT])[0],
        "words": of.words,
        "driving": of.gamma,
        **{name: runs[name].values(key) for name, key in axes.items() if name in runs},
    }
    for name, sweep in runs.items():
        found |= drift_and_tilt(sweep, f"{name}_")
    return found


def _over_tilt(ax, d):
    curve(ax, d, "still_tilt", "still_c_x", BLACK, "rods do not roll", both=True)
    curve(ax, d, "rolling_tilt", "rolling_c_x", ORANGE, "rods roll", both=True, hollow=True)
    if "plane_c_x" in d:
        plane = "plane_tilt", "plane_c_x", SKY, f"row / {REDUCTION}"
        curve(ax, d, *plane, form="s--", scale=1 / REDUCTION, both=True)
        words = "gap for 53° at most"
        curve(ax, d, "narrow_tilt", "narrow_c_x", PURPLE, words, form="^:", both=True)
        for tilt in MAXIMA_DEG:
            ax.axvline(tilt, 0, 0.6, **FAINT)  # up to the legend
    tilt_axis(ax, 0, 60, ylim=(None, 1.4 * np.nanmax(d["rolling_c_x"])))
    ax.legend()


def _over_gamma(ax, d):
    at = nearest(d["gamma"], GAMMA)
    for i, colour in enumerate(shades(len(d["few"]))[::-1]):
        label = rf"$N={d['few'][i]}$, {d['gamma_tilt'][at, i]:.0f}° at {d['gamma'][at]:g}"
        curve(ax, d, "gamma", "gamma_c_x", colour, label, at=(..., i))
    resting = f"$N={d['many']}$, walls at rest"
    curve(ax, d, "gamma", "rest_gamma_c_x", BLACK, resting, form="o--", hollow=True)
    ax.axvline(ONSET_FIG4, 0, 0.55, **FAINT)  # up to the legend
    ax.set(xlabel=r"acceleration $\Gamma$", xlim=(1, None))
    ax.legend(loc="upper left")


def _over_friction(ax, d, name: str):
    curve(ax, d, name, f"{name}_c_x")
    beside = ax.twinx()
    curve(beside, d, name, f"{name}_tilt", ANOTHER, form="^--", hollow=True)
    beside.set_ylabel(r"tilt $\phi$ (deg)", color=ANOTHER)
    beside.set_ylim(0, 1.5 * np.nanmax(d[f"{name}_tilt"]))
    beside.tick_params(colors=ANOTHER)


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplots(2, 2, figsize=(7.0, 4.9))
    (a, b), (c, e) = axes
    _over_tilt(a, d)
    _over_gamma(b, d)
    _over_friction(c, d, "wall")
    _over_friction(e, d, "plate")
    c.set(xlabel=r"friction of the walls $\mu_{rw}$", ylim=(0, None))
    plate = d["plate"]
    smallest = plate[plate > 0].min()
    e.set_xscale("symlog", linthresh=smallest, linscale=0.4)
    words = r"friction of the plate $\mu_{rb}$ (0 at the left end)"
    e.set(xlabel=words, xlim=(-smallest / 4, 1.2 * plate.max()))
    for ax in axes.flat:
        zero_line(ax)
        ax.set_ylabel(r"drift $c_x$ (cm/s)")
    driving = rf"$\Gamma={d['driving']:.3g}$"
    many = rf"$N={d['many']}$, {driving}"
    name_panels(axes.flat, (driving, "", many, many))
    note(figure, d["words"])
    return figure


def shape(tilt: np.ndarray, c_x: np.ndarray) -> Data:
    """What Fig. 4(a) is said to show, as numbers.

    early, late : tilts of the largest drift below and beyond the middle of the paper's two maxima
    dip : by which part the lowest drift between them is less than the smaller of the two; 0 if
        there is no slowdown
    bend, slope : rms distance from a straight line up to the paper's first maximum, over the mean
        there; slope of that line, in cm/s a degree
    end : drift at the largest tilt over the largest drift
    """
    order = np.argsort(tilt)
    tilt, c_x = tilt[order], c_x[order]
    late = tilt > np.mean(MAXIMA_DEG)
    i, j = (np.argmax(np.where(side, c_x, -np.inf)) for side in (~late, late))
    small = tilt <= MAXIMA_DEG[0]
    line = tilt[small], c_x[small]
    bent, slope = (bend(*line), np.polyfit(*line, 1)[0]) if small.sum() > 2 else (np.nan, np.nan)
    return {
        "early": tilt[i],
        "late": tilt[j],
        "dip": 1 - c_x[i : j + 1].min() / min(c_x[i], c_x[j]),
        "bend": bent,
        "slope": slope,
        "end": c_x[-1] / c_x.max(),
    }
