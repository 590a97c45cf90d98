"""Where the theory of the drift fails: its assumptions replaced one by one by what was measured.

The theory: all landings are one impact of a rod without thickness, without spin, with the plate at
V_0/2, that keeps c_x and turns c_z round. Black: drift of the simulated row over tilt. Each line
replaces one assumption more, in the order of the bars, by its mean over touches, each alike, and
says at which c_x the impact map keeps its balance; c_x is the mean of before and after. (a) As
printed; the rod as simulated; V_z; the ratio -c_z/c_z', from which c_z follows. (b) The change of
c_x in a touch, which the row undoes between touches; the spin before a touch; the restitution, mean
of v_f over that of -v_0 where no other rod pushes, or of all touches where hardly any is unpushed.
(c) What is assumed (broken lines) and what is measured. (d) What is left of the misfit: rms
distance from the row over tilt over the row's rms, with standard errors; open: with this assumption
alone replaced, the rod as simulated; triangles: means over landings (`md.measures`) in place of
those over touches, the restitution as assumed. Where a step adds to the misfit, two errors of the
theory cancelled.
"""

from functools import partial

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

import md
from impact import ContactGeometry, collide, thin_rod
from md.kernels import touches
from md.measures import HOP, VELOCITIES, merged
from md.scene import from_tables

from ..claims.over_tilt import SMALL_DEG
from ..lib.runs import (
    DRIFT_AND_TILT,
    FRICTION,
    LENGTH,
    RESTITUTION,
    ROW,
    TILT_SCAN_WORDS,
    Sweeps,
    boxes,
    drift_and_tilt,
    gathered,
    paper_rod,
    periods_of,
    planned,
    seed_means,
    starts,
)
from ..lib.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    RED,
    Data,
    Look,
    curve,
    note,
    painted,
    points,
    shades,
    style,
    tilt_axis,
)
from .census import observed

ENOUGH = 30  # touches in which nobody pushes, for the mean restitution over them
CLOSURE_TILTS_DEG = {
    True: (9, 15, 21, 30, 45, 60),
    False: (9, 12, 15, 18, 21, 24, 27, 30, 34, 40, 45, 50, 60),
}
ASSUMED = {"V_z": 0.5, "turned": 1.0, "gain": 0.0, "spin": 0.0, "restitution": RESTITUTION}
FIRST = 2  # of `STEPS` that replaces one of `ASSUMED`
STEPS = {  # in order, as they are drawn; each keeps what the ones before replaced
    "printed": "as printed",
    "thick": "+ thick rod",
    "V_z": "+ $V_z$",
    "turned": "+ $-c_z/c_z'$",
    "gain": "+ $c_x'-c_x$",
    "spin": r"+ $\omega$",
    "restitution": r"+ $\epsilon$",
}
NAMES = (*VELOCITIES, "V_z")  # means over touches, and over landings
LANDED = "landing_"  # before these names
MEANS = ("restitution", *NAMES, *(f"{LANDED}{name}" for name in NAMES))


def mean_drift(
    rod: ContactGeometry,
    friction: float,
    *,
    restitution: float,
    V_z: float,
    turned: float = 1.0,
    gain: float = 0.0,
    spin: float = 0.0,
) -> float:
    """Drift of the theory, of all landings alike, under any closure.

    In a row that neither speeds up nor turns over, the mean change of a velocity in a touch is
    undone between touches; the map says at which c_x it makes the change of c_x that is asked for.

    Parameters
    ----------
    rod : contact geometry
    friction, restitution : of the plate
    V_z : velocity of the plate at the landing
    turned : -c_z/c_z', before over after
    gain : change of c_x in a landing, which is undone between landings
    spin : omega before the landing

    Returns
    -------
    Mean of c_x before and after; nan where there is no such landing.
    """
    x, z = rod.X / rod.k, rod.Z / rod.k
    # v_f = -restitution v_0 with both impulses known: P_x = gain, P_z = (1 + turned) c_z'
    driven = (1 + restitution) * (V_z - spin * rod.X) + x * z * gain
    rise = driven / (1 - restitution * turned + (1 + turned) * x**2)

    def excess(c_x: float) -> float:
        hit = collide(
            c_x,
            -turned * rise,
            spin,
            geometry=rod,
            friction=friction,
            restitution=restitution,
            plate_velocity=V_z,
        )
        return hit.c_x - c_x - gain

    far = 1e3 * (abs(rise) + abs(V_z) + abs(spin) * rod.k)
    if not (excess(-far) > 0 > excess(far)):
        return np.nan
    return brentq(excess, -far, far, xtol=1e-13) + gain / 2


def measures(rows: np.ndarray) -> Data:
    """Means over touches, each alike.

    Parameters
    ----------
    rows : touches behind the transient, as `md.run` hands them to `observe`

    Returns
    -------
    Velocities before and after, V_z of the plate, the restitution of touches in which nobody pushes
    (of all, if there are fewer than `ENOUGH`).
    """
    rows = rows[np.isfinite(rows[:, touches.FLIGHT])]
    alone = rows[rows[:, touches.PUSHED] == 0]
    mean, among = rows.mean(axis=0), alone if len(alone) >= ENOUGH else rows
    return {
        **dict(zip(NAMES, mean[touches.BEFORE : touches.PLATE + 1].tolist(), strict=True)),
        "restitution": -among[:, touches.LEAVING].sum() / among[:, touches.APPROACH].sum(),
    }


def balanced(scene: md.Scene, periods: int) -> Data:
    """`measures` of a run, its drift and its tilt, for `runs.planned`."""
    rows, result = observed(scene, periods)
    ones = np.ones(len(rows))
    landings, _ = merged(np.column_stack([rows, ones]), HOP * result.steps_per_period)
    landed = measures(landings)
    return {
        **measures(rows),
        **{f"{LANDED}{name}": landed[name] for name in NAMES},
        **{name: getattr(result, name) for name in DRIFT_AND_TILT},
    }


def sweeps(quick: bool = False) -> Sweeps:
    """Sweep of the row over tilt that measures touch by touch."""
    axes = [{"box.length": boxes(CLOSURE_TILTS_DEG[quick])}, starts(2 if quick else 4)]
    return {"tilt": planned(axes, periods_of(quick), measure=balanced)}


def replaced(tilt_deg: float, known: Data) -> list[float]:
    """Drifts of a mean landing, in the units of what is known.

    After each of `STEPS`; then with each of `ASSUMED` alone replaced, the rod as simulated.

    Parameters
    ----------
    tilt_deg : of the rod
    known : measured values of `ASSUMED`, and `speed`, the plate's peak velocity
    """
    if not np.isfinite([tilt_deg, *known.values()]).all():  # of a run that failed
        return [np.nan] * (len(STEPS) + len(ASSUMED))
    tilt = np.radians(tilt_deg)
    rod, given = paper_rod(tilt), {**ASSUMED, "V_z": known["speed"] / 2}
    closures = [given]
    for name in ASSUMED:
        closures.append(closures[-1] | {name: known[name]})
    closures += [given | {name: known[name]} for name in ASSUMED]
    thin = mean_drift(thin_rod(tilt, LENGTH), FRICTION, **given)
    return [thin, *(mean_drift(rod, FRICTION, **closure) for closure in closures)]


def left(row: np.ndarray, drift: np.ndarray) -> np.ndarray:
    """Rms distance of drifts from the row over their second last axis, over the row's rms."""
    return np.sqrt(np.mean((drift - row) ** 2, axis=-2) / np.mean(row**2, axis=-2))


def closures_of(of: Data, kind: str = "") -> Data:
    """Measured values of `ASSUMED`, from means.

    Parameters
    ----------
    of : the means by name
    kind : `LANDED`: over landings, whose restitution is the one that is assumed; else over touches
    """
    mean = {name: of[f"{kind}{name}"] for name in NAMES}
    assumed = np.full_like(mean["V_z"], RESTITUTION)
    return {
        "V_z": mean["V_z"],
        "turned": -mean["c_z_before"] / mean["c_z_after"],
        "gain": mean["c_x_after"] - mean["c_x_before"],
        "spin": mean["omega_before"],
        "restitution": assumed if kind else np.clip(of["restitution"], 0, 1),
    }


def drifts(tilt: np.ndarray, speed: float, measured: Data) -> np.ndarray:
    """`replaced` of every run, along a first axis."""
    found = np.empty((len(STEPS) + len(ASSUMED), *tilt.shape))
    for at in np.ndindex(tilt.shape):
        known = {name: array[at] for name, array in measured.items()}
        found[(..., *at)] = replaced(tilt[at], {**known, "speed": speed})
    return found


def data(quick: bool = False) -> Data:
    """Drifts over tilt after each step [cm/s], what was measured, and what is left of the misfit.

    Velocities of `ASSUMED` are in units of the plate's peak velocity, the spin times half a rod.
    """
    sweep, scene = sweeps(quick)["tilt"], from_tables(ROW)
    row, tilt, *means = gathered(sweep, "c_x_cm_s", "tilt_deg", *MEANS)
    of, speed = dict(zip(MEANS, means, strict=True)), scene.plate_speed
    measured = closures_of(of)
    steps, single = np.split(scene.cm_per_s * drifts(tilt, speed, measured), [len(STEPS)])
    landed = scene.cm_per_s * drifts(tilt, speed, closures_of(of, LANDED))[: len(STEPS)]

    units = {"V_z": speed, "gain": speed, "spin": 2 * speed / LENGTH}
    larger = np.array(CLOSURE_TILTS_DEG[quick]) > SMALL_DEG
    results = {
        **{name: array / units.get(name, 1.0) for name, array in measured.items()},
        "step": steps,
        "left": left(row, steps),
        "left_single": left(row, single),
        "left_larger": left(row[larger], steps[:, larger]),
        "left_landing": left(row, landed),
    }
    return drift_and_tilt(sweep) | seed_means(results)


LEGEND: Look = {"loc": "upper center", "ncols": 2}
FORMS = "s-", "^-", "v-", "D-"


def _draw_steps(ax, d, at: range):
    names = [*STEPS.values()]
    for i, colour, form in zip(at, shades(len(at)), FORMS, strict=False):
        curve(ax, d, "tilt", "step", colour, names[i], at=i, form=form, ms=2.5)
    curve(ax, d, "tilt", "c_x", label="row", ms=3.5, lw=1.2)
    roof = max(np.nanmax(d["step"][at]), d["c_x"].max())
    limits = min(0, 1.1 * d["c_x"].min()), 1.55 * roof
    tilt_axis(ax, 0, 65, ylabel=r"drift $c_x$ (cm/s)", ylim=limits)
    ax.legend(**LEGEND)


def _draw_assumed(ax, d):
    looks = (
        (BLUE, "$V_z/V_0$", "v-"),
        (GREEN, "$-c_z/c_z'$", "D-"),
        (RED, "$(c_x'-c_x)/V_0$", "s-"),
        (BLACK, r"$\omega\,l/2V_0$", "o-"),
        (ORANGE, r"$\epsilon$", "^-"),
    )
    for (name, value), (colour, label, form) in zip(ASSUMED.items(), looks, strict=True):
        ax.axhline(value, color=colour, ls="--", lw=0.7)
        curve(ax, d, "tilt", name, colour, label, form=form, ms=2.5)
    low = min(-0.2, *(1.1 * np.nanmin(d[name]) for name in ASSUMED))
    ticks = np.arange(-0.25, 1.1, 0.25)
    tilt_axis(ax, 0, 65, ylabel="assumed, measured", ylim=(low, 1.75), yticks=ticks)
    ax.legend(**LEGEND)


def _draw_left(ax, d):
    y = np.arange(len(STEPS))
    sets = ((-0.2, "left", BLACK, "all tilts"), (0.2, "left_larger", BLUE, f"> {SMALL_DEG}°"))
    thin = {"elinewidth": 0.7, "ecolor": "0.6"}
    for off, name, colour, label in sets:
        error = d[f"{name}_error"]
        ax.barh(y + off, d[name], 0.4, xerr=error, color=colour, label=label, error_kw=thin)
    single, error = d["left_single"], d["left_single_error"]
    points(ax, single, y[FIRST:], None, RED, xerr=error, form="D", hollow=True, label="it alone")
    some = slice(FIRST, -1)
    landing, error = d["left_landing"][some], d["left_landing_error"][some]
    points(ax, landing, y[some], None, ORANGE, xerr=error, form="^", label="landings")
    ax.set_yticks(y, STEPS.values())
    ax.margins(x=0.5)  # for the legend
    ax.set(xlabel="misfit / row", xlim=(0, None))
    ax.invert_yaxis()
    ax.tick_params(axis="y", left=False, right=False)
    ax.legend(loc="lower right")


@style
def draw(d: Data) -> Figure:
    panels = {
        "replaced one after another: plate, bounce": partial(_draw_steps, at=range(4)),
        "and on top of these: the mean touch": partial(_draw_steps, at=range(4, len(STEPS))),
        "assumptions": _draw_assumed,
        "what is left, step on step": _draw_left,
    }
    figure = painted(d, panels, 5.0, rows=2)
    note(figure, f"+: kept in all later steps; {TILT_SCAN_WORDS}")
    return figure
