"""Where the theory of the drift fails: its assumptions replaced one by one by what was measured.

The theory: all landings are one impact of a rod without thickness, without spin, with the plate at
V_0/2, that keeps c_x and turns c_z round. Black: drift of the simulated row over tilt. Each line
replaces one assumption more, in the order of the bars, and says at which c_x the impact map keeps
its balance; c_x is the mean of before and after. (a) As printed; the rod as simulated; V_z; the
ratio -c_z/c_z', from which c_z follows. (b) The change of c_x in a touch, which the row undoes
between touches; the spin before a touch; the restitution, mean of v_f over that of -v_0 where no
other rod pushes. These means are over touches, each alike: where the contact sticks, the map is
linear, and the map of the means is the mean of the maps. (c) Every touch by itself, with its own
velocities, arms and plate; then what the map misses where no other rod pushes, in parts of the
change of c_z (a soft contact takes time, and its friction yields); then what it misses where they
do, so that c_x is that of the touches; then every flight and touch weighted by the time that it
takes. Where hardly any touch is unpushed, the restitution is that of all touches and a soft contact
changes nothing. (d) What is assumed (broken lines) and what is measured. (e) Pushed touches left
out: c_x of unpushed touches, and that of the map for them alone, each by itself, with one
restitution. (f) What is left of the misfit: rms distance from the row over tilt over the row's rms,
with standard errors; open: with this assumption alone replaced, the rod as simulated. Where a step
adds to the misfit, two errors of the theory cancelled.
"""

from collections.abc import Callable
from functools import partial

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from impact import thin_rod
from md.scene import from_tables
from md.sweep import Sweep

from ..claims.over_tilt import SMALL_DEG
from ..lib.runs import (
    FRICTION,
    LENGTH,
    RESTITUTION,
    ROW,
    SEEDS,
    TILT_SCAN_WORDS,
    boxes,
    gathered,
    larger_error,
    over_seeds,
    paper_rod,
    periods_of,
    planned,
)
from ..lib.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    RED,
    Data,
    curve,
    painted,
    points,
    style,
    tilt_axis,
)
from ..lib.tables import columned, pairs
from .balance import balanced, mean_drift

CLOSURE_TILTS_DEG = (9, 12, 15, 18, 21, 24, 27, 30, 34, 40, 45, 50, 60)
QUICK_TILTS_DEG = (9, 15, 21, 30, 45, 60)
ASSUMED = {"V_z": 0.5, "turned": 1.0, "gain": 0.0, "spin": 0.0, "restitution": RESTITUTION}
FIRST = 2  # of `STEPS` that replaces one of `ASSUMED`
DISTRIBUTED = ("each", "soft", "pushed", "in_time")
STEPS = {  # in order; each keeps what the ones before replaced
    "printed": "as printed",
    "thick": "thick rod",
    "V_z": "$V_z$",
    "turned": "$-c_z/c_z'$",
    "gain": "$c_x'-c_x$",
    "spin": r"$\omega$",
    "restitution": r"$\epsilon$",
    "each": "each touch",
    "soft": "soft contact",
    "pushed": "pushes",
    "in_time": "over time",
}
MEANS = (
    *("drift", "tilt", "V_z", "restitution", "alone"),
    *(f"{name}_{side}" for name in ("c_x", "c_z", "omega") for side in ("before", "after")),
)
ALONE = ("isolated", "isolated_pushed")


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """The row over tilt, touch by touch."""
    tilts = QUICK_TILTS_DEG if quick else CLOSURE_TILTS_DEG
    seeds: dict[str, list] = {"start.seed": [1, 2]} if quick else SEEDS
    axes: list[dict[str, list]] = [{"box.length": boxes(tilts)}, seeds]
    return {"tilt": planned(axes, periods_of(quick), measure=balanced)}


def replaced(tilt_deg: float, known: dict[str, float]) -> list[float]:
    """Drifts of a mean landing, in the units of what is known.

    After each of the first steps; then with each of `ASSUMED` alone replaced, the rod as simulated.

    Parameters
    ----------
    tilt_deg : of the rod
    known : measured values of `ASSUMED`, and `speed`, the plate's peak velocity
    """
    if not np.isfinite([tilt_deg, *known.values()]).all():  # of a run that failed
        return [np.nan] * (FIRST + 2 * len(ASSUMED))
    tilt = np.radians(tilt_deg)
    rod, given = paper_rod(tilt), {**ASSUMED, "V_z": known["speed"] / 2}
    closures = [given]
    for name in ASSUMED:
        closures.append(closures[-1] | {name: known[name]})
    closures += [given | {name: known[name]} for name in ASSUMED]
    return [
        mean_drift(rod if i else thin_rod(tilt, LENGTH), FRICTION, **closure)
        for i, closure in enumerate([given, *closures])
    ]


def left(row: np.ndarray, drift: np.ndarray) -> np.ndarray:
    """Rms distance of drifts from the row over their second last axis, over the row's rms."""
    return np.sqrt(np.mean((drift - row) ** 2, axis=-2) / np.mean(row**2, axis=-2))


def _closures(of: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Measured values of `ASSUMED`."""
    mean = {name: of[name][..., 0] for name in MEANS}
    return {
        "V_z": mean["V_z"],
        "turned": -mean["c_z_before"] / mean["c_z_after"],
        "gain": mean["c_x_after"] - mean["c_x_before"],
        "spin": mean["omega_before"],
        "restitution": np.clip(mean["restitution"], 0, 1),
    }


def data(quick: bool = False) -> Data:
    """Drifts over tilt after each step [cm/s], what was measured, and what is left of the misfit.

    Velocities of `ASSUMED` are in units of the plate's peak velocity, the spin times half a rod.
    """
    sweep, scene = sweeps(quick)["tilt"], from_tables(ROW)
    names = (*MEANS, *DISTRIBUTED, *ALONE)
    of = dict(zip(names, gathered(sweep, *names), strict=True))
    for name in ("drift", *DISTRIBUTED, *ALONE):
        of[name] = of[name] * scene.cm_per_s
    row, tilt = of["drift"][..., 0], of["tilt"][..., 0]
    measured, speed = _closures(of), scene.plate_speed
    first = np.empty((FIRST + 2 * len(ASSUMED), *tilt.shape))
    for at in np.ndindex(tilt.shape):
        known = {name: float(array[at]) for name, array in measured.items()}
        first[(..., *at)] = replaced(float(tilt[at]), {**known, "speed": speed})
    together, single = np.split(scene.cm_per_s * first, [FIRST + len(ASSUMED)])
    steps = np.stack([*together, *(of[name] for name in DISTRIBUTED)])

    nominal = np.degrees(np.arccos(scene.rods.count / sweep.values("box.length")))
    found: Data = {"nominal_deg": nominal}
    for name in ("drift", "tilt", "alone"):
        found[name], found[f"{name}_error"] = larger_error(*np.moveaxis(of[name], -1, 0))
    units = {"V_z": speed, "gain": speed, "spin": 2 * speed / LENGTH}
    larger = nominal > SMALL_DEG
    for name, values in {
        **{name: array / units.get(name, 1.0) for name, array in measured.items()},
        **{name: of[name] for name in ALONE},
        "step": steps,
        "left": left(row, steps),
        "left_single": left(row, single),
        "left_larger": left(row[larger], steps[:, larger]),
    }.items():
        found[name], found[f"{name}_error"] = over_seeds(values)
    return found


LEGEND = {"loc": "upper center", "ncols": 2, "fontsize": 6, "columnspacing": 0.8}
LEGEND |= {"handlelength": 1.6, "handletextpad": 0.5, "borderaxespad": 0.2}
LOOKS = ((RED, "s-"), (ORANGE, "^-"), (BLUE, "v-"), (GREEN, "D-"))


def _row(ax: Axes, d: Data, roof: float) -> None:
    """The row's drift, and room for the legend."""
    curve(ax, d, "tilt", "drift", label="row", ms=3.5, lw=1.2)
    tilt_axis(ax, 0, 65)
    ax.set(ylabel=r"drift $c_x$ (cm/s)", ylim=(min(0, 1.1 * d["drift"].min()), 1.55 * roof))
    ax.legend(**LEGEND)


def _draw_steps(ax: Axes, d: Data, names: tuple[str, ...]) -> None:
    at = [[*STEPS].index(name) for name in names]
    for i, name, (colour, form) in zip(at, names, LOOKS, strict=False):
        label = STEPS[name] if name == "printed" else f"+ {STEPS[name]}"
        curve(ax, d, "tilt", "step", colour, label, at=i, form=form, ms=2.5)
    _row(ax, d, max(np.nanmax(d["step"][at]), d["drift"].max()))


def _draw_assumed(ax: Axes, d: Data) -> None:
    labels = ("$V_z/V_0$", "$-c_z/c_z'$", "$(c_x'-c_x)/V_0$", r"$\omega\,l/2V_0$", r"$\epsilon$")
    looks = ((BLUE, "v-"), (GREEN, "D-"), (RED, "s-"), (BLACK, "o-"), (ORANGE, "^-"))
    for (name, value), label, (colour, form) in zip(ASSUMED.items(), labels, looks, strict=True):
        ax.axhline(value, color=colour, ls="--", lw=0.7)
        curve(ax, d, "tilt", name, colour, label, form=form, ms=2.5)
    tilt_axis(ax, 0, 65)
    low = min(-0.2, *(1.1 * np.nanmin(d[name]) for name in ASSUMED))
    ax.set(ylabel="assumed, measured", ylim=(low, 1.75), yticks=np.arange(-0.25, 1.1, 0.25))
    ax.legend(**LEGEND)


def _draw_alone(ax: Axes, d: Data) -> None:
    look = {"form": "s-", "hollow": True, "ms": 2.5}
    curve(ax, d, "tilt", "isolated_pushed", BLUE, "unpushed", form="v-", ms=2.5)
    curve(ax, d, "tilt", "isolated", RED, "map, for them alone", **look)
    _row(ax, d, np.nanmax([np.nanmax(d["isolated"]), d["drift"].max()]))


def _draw_left(ax: Axes, d: Data) -> None:
    y, names = np.arange(len(STEPS)), list(STEPS.values())
    sets = ((-0.2, "left", BLACK, "all tilts"), (0.2, "left_larger", BLUE, f"> {SMALL_DEG}°"))
    error_kw = {"elinewidth": 0.7, "ecolor": "0.6"}
    for off, name, colour, label in sets:
        bars = {"xerr": d[f"{name}_error"], "color": colour, "label": label, "error_kw": error_kw}
        ax.barh(y + off, d[name], 0.4, **bars)
    look = {"form": "D", "hollow": True, "label": "it alone", "xerr": d["left_single_error"]}
    points(ax, d["left_single"], FIRST + np.arange(len(ASSUMED)), None, RED, **look)
    ax.set_yticks(y, [names[0], *(f"+ {name}" for name in names[1:])], fontsize=6)
    ax.set(xlabel="misfit / row", xlim=(0, None))
    ax.invert_yaxis()
    ax.tick_params(axis="y", left=False, right=False)
    ax.legend(loc="lower right", fontsize=6)


@style
def draw(d: Data) -> plt.Figure:
    names = tuple(STEPS)
    panels: dict[str, Callable[[Axes, Data], None]] = {
        "theory, plate, bounce": partial(_draw_steps, names=names[:4]),
        "mean touch": partial(_draw_steps, names=names[4:7]),
        "each touch": partial(_draw_steps, names=names[7:]),
        "assumptions": _draw_assumed,
        "unpushed touches": _draw_alone,
        "what is left": _draw_left,
    }
    figure = painted(d, panels, rows=2, figsize=(7.0, 5.0))
    figure.supxlabel(TILT_SCAN_WORDS)
    return figure


def summary(d: Data) -> str:
    """Drifts step by step, what was measured, and what is left of the misfit."""
    plain = {name: label.replace("$", "").replace("\\", "") for name, label in STEPS.items()}
    heads = {"tilt": pairs(d, "tilt"), "row": pairs(d, "drift")}
    drifts = {name: pairs(d, "step", i) for i, name in enumerate(plain.values())}
    measured = {name: pairs(d, name) for name in (*ASSUMED, "alone", *ALONE)}
    lines = ["drift (cm/s) after each step, ± standard error", columned({**heads, **drifts})]
    lines += ["measured (gain: c_x'-c_x over V_0; spin: omega l/2V_0; alone: share of touches;"]
    lines += ["isolated: c_x of the map for these alone, isolated_pushed: theirs, cm/s)"]
    lines += [columned({"tilt": heads["tilt"], **measured}, 3)]
    single = pairs(d, "left_single")
    columns = {
        "step": plain.values(),
        "all tilts": pairs(d, "left"),
        f"beyond {SMALL_DEG} deg": pairs(d, "left_larger"),
        "all tilts, it alone": [np.nan] * FIRST + single + [np.nan] * len(DISTRIBUTED),
    }
    lines += ["rms misfit over the row's rms, left after each step", columned(columns, 3)]
    return "\n".join(lines)
