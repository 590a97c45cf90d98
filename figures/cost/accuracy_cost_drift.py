"""What the accuracy of the drift costs in time, step by step for the row, and by tolerance.

The paper's row, N = 40, L = 43 d, Gamma = 3.3, tangential springs 30 times as stiff as the contact.
(a) Error of a run's drift against its time, a curve per step: root mean square over disjoint parts
of one long run, against the mean of the fine steps. The curves fall as time^(-1/2) (guide), until
they come to the bias of their step (short lines at the right; dotted where it is less than three
times its own error, which is then what the line shows). Diamond: the paper's own step at the
length that gives 1 %. (b) Runs to a tolerance: the one asked for, 95 % confidence, against the time
it took, scene by scene. Crosses: the error that the runs of the row then had. The broken lines are
the prices of fixed steps; times are of this machine, without compiling.
"""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import md
from md.accuracy import steps_per_contact
from md.measures import standard_error
from md.scene import from_tables
from md.sweep import Point, Sweep

from ..lib.runs import ROW, Sweeps, computed, gathered, measured_by, nearest
from ..lib.soft_impacts import PAPER_STEP
from ..lib.style import BLACK, BLUE, GREEN, RED, Data, Look, log_log, note, painted, shades, style
from ..lib.timing import measured_here, seconds_per_period

PER_CONTACT = (16, 20, 26, 40, 80)  # and the paper's
FINE = 30  # steps a contact from which on runs are taken as the truth
CUT = 100  # periods at the start
LONG_PERIODS = {True: 2500, False: 20000}  # quick or not; a third of it at the paper's step
CLEAR_BIAS = 3  # its own errors: a smaller bias is taken for none
DRIFT_TOLERANCES = (0.05, 0.03, 0.01)
ASKED_SEED = 5
BELOW = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.18), "ncols": 2}  # of a legend
AXES: Look = {"xlabel": "time of the run (s)", "ylabel": r"error of $c_x$, relative"}
FORMS = (BLACK, "s-"), (BLUE, "^-"), (GREEN, "D-"), (RED, "v-")  # of runs to a tolerance
PART_LENGTHS = np.unique(np.geomspace(4, 2500, 14).astype(int))  # of the parts, periods


def _scene(dt: float, seed: int = 1) -> md.Scene:
    how = [f"step.size={dt}", "step.coarse=true", "start.speed=0.3", f"start.seed={seed}"]
    return md.load("quasi2d", how)


def parts(series: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Mean and variance of the means of disjoint parts, (2, lengths); nan for fewer than eight."""
    found = np.full((2, len(lengths)), np.nan)
    for i, n in enumerate(lengths[lengths <= len(series) / 8]):
        means = series[len(series) % n :].reshape(-1, n).mean(axis=1)
        found[:, i] = means.mean(), means.var()
    return found


def long_run(scene: md.Scene, periods: int) -> Data:
    """Drift of a run behind `CUT` and of its parts, for `runs.planned`."""
    run = md.run(scene, periods=periods, ledger=False)
    if not run.finished:
        raise KeyboardInterrupt
    series = run.c_x_series[CUT:]
    return {
        "mean": series.mean(),
        "error": standard_error(series),
        "made": len(series),
        "parts": parts(series, PART_LENGTHS).tolist(),
    }


def steps() -> list[float]:
    """Sizes of the steps, the paper's last."""
    contact = steps_per_contact(md.load("quasi2d"), 1.0)
    return [*(contact / n for n in PER_CONTACT), PAPER_STEP]


def asked() -> dict[str, md.Scene]:
    """Scenes that run to a tolerance; the truth is known of the first."""
    return {
        "row of the paper": _scene(PAPER_STEP, ASKED_SEED),
        "row, law of the search": from_tables(ROW),
        "my_rods": md.load("my_rods"),
        "annulus": md.load("annulus"),
    }


def sweeps(quick: bool = False) -> Sweeps:
    """Sweeps: long runs over the step; runs to a tolerance, scene by scene."""
    sizes, most, scenes = steps(), LONG_PERIODS[quick], asked()
    long = [Point(_scene(dt), CUT + (most if dt > PAPER_STEP else most // 3)) for dt in sizes]
    chosen = [{"tolerance": tolerance} for tolerance in DRIFT_TOLERANCES]
    points = [Point(one, 0, how) for one in scenes.values() for how in chosen]
    axes = {"scene": [*scenes]}, {"tolerance": [*DRIFT_TOLERANCES]}
    return {
        "long": measured_by(Sweep(({"step.size": sizes},), tuple(long)), long_run),
        "asked": Sweep(axes, tuple(points)),
    }


def data(quick: bool = False) -> Data:
    """Long runs at several steps, prices of a period, runs to a tolerance."""
    here, planned, dt = measured_here(), sweeps(quick), np.array(steps())
    seconds = seconds_per_period([_scene(size) for size in dt])
    mean, error, made, of_parts = gathered(planned["long"], "mean", "error", "made", "parts")
    n = steps_per_contact(md.load("quasi2d"), 1.0) / dt
    weight = (n >= FINE) / error**2
    truth, truth_error = (weight * mean).sum() / weight.sum(), weight.sum() ** -0.5
    names = "run_seconds", "accuracy.per_contact", "c_x", "periods"
    spent, per_contact, c_x, periods = gathered(computed(planned["asked"], workers=1), *names)
    return {
        **here,
        "per_contact": n,
        "dt": dt,
        "seconds": seconds,
        "truth": truth,
        "truth_error": truth_error,
        "bias": mean / truth - 1,
        "bias_error": np.hypot(error, truth_error) / truth,
        # Errors of a mean of n periods as sigma sqrt(g/n): from the standard error of the long run.
        "noise": error * np.sqrt(made) / truth,
        "lengths": PART_LENGTHS,
        "rms": rms_of_parts(of_parts, truth) / truth,
        "scene": planned["asked"].values("scene"),
        "tolerance": planned["asked"].values("tolerance"),
        "run_seconds": spent,
        "run_per_contact": per_contact,
        "run_error": np.abs(c_x[0] / truth - 1),
        "run_periods": periods,
    }


def runs(d: Data) -> list[dict[str, Any]]:
    """Runs to a tolerance; the error is None where the true drift is not known."""
    return [
        {
            "scene": d["scene"][i],
            "tolerance": d["tolerance"][j],
            **{name: d[f"run_{name}"][i, j] for name in ("per_contact", "periods", "seconds")},
            "error": d["run_error"][j] if i == 0 else None,
        }
        for i, j in np.ndindex(d["run_seconds"].shape)
    ]


def rms_of_parts(of_parts: np.ndarray, truth: float) -> np.ndarray:
    """Root mean square distance from the truth of the means that `parts` sums up."""
    mean, variance = np.moveaxis(of_parts, -2, 0)
    return np.sqrt(variance + (mean - truth) ** 2)


def to_reach(d: Data, error: float) -> np.ndarray:
    """Seconds at each step until the root mean square error is this small; inf where it never is.

    Squares of bias and noise add; a bias that cannot be told from zero counts as none.
    """
    clear = np.abs(d["bias"]) > CLEAR_BIAS * d["bias_error"]
    room = error**2 - np.where(clear, d["bias"], 0.0) ** 2
    with np.errstate(all="ignore"):
        periods = d["noise"] ** 2 / room
    return np.where(room > 0, periods * d["seconds"], np.inf)


def _looks(d: Data) -> list[tuple[Any, str]]:
    """Colour and name of each step."""
    *names, papers = (rf"$t_c/{n:.0f}$" for n in d["per_contact"])
    return [*zip(shades(len(names)), names, strict=True), (BLACK, f"{papers}, the paper's")]


def panel(ax: Axes, d: Data) -> None:
    """Error against time, step by step."""
    longest = d["lengths"][np.isfinite(d["rms"][0])][-1]
    right = 2 * (longest * d["seconds"][:-1]).max()
    for i, (colour, label) in enumerate(_looks(d)):
        time = d["lengths"] * d["seconds"][i]
        ax.plot(time, d["rms"][i], "o-", color=colour, ms=2.2, lw=0.8, label=label)
        size, least = abs(d["bias"][i]), CLEAR_BIAS * d["bias_error"][i]
        look = {"lw": 1.4, "ls": "-"} if size > least else {"lw": 0.8, "ls": ":"}
        ax.plot([right, 3 * right], [max(size, least)] * 2, color=colour, **look)
    time = np.array([d["lengths"][0] * d["seconds"][:-1].min(), right])
    middle = nearest(d["per_contact"], 25)
    guide = 0.5 * d["noise"][middle] * np.sqrt(d["seconds"][middle] / time)
    ax.plot(time, guide, color="0.5", lw=0.8, ls="--", label="time$^{-1/2}$")
    ax.plot(to_reach(d, 0.01)[-1], 0.01, "D", color=BLACK, ms=5, mfc="white", mew=1.2)
    ax.axhline(0.01, color="0.75", lw=0.6)
    log_log(ax, **AXES, ylim=(4e-4, 0.5))
    ax.legend(**BELOW, title="step")


def _draw_runs(ax, d):
    wanted = np.geomspace(0.003, 0.3, 60)
    for i in (1, 3, 5):
        time, (colour, label) = [to_reach(d, r / 1.96)[i] for r in wanted], _looks(d)[i]
        ax.plot(time, wanted, "--", color=colour, lw=0.7, label=label)
    for name, time, (colour, form) in zip(d["scene"], d["run_seconds"], FORMS, strict=True):
        label = name.replace("_", " ")
        ax.plot(time, d["tolerance"], form, color=colour, ms=3, lw=0.9, label=label)
    had = np.fmax(d["run_error"], 1e-4)
    ax.plot(d["run_seconds"][0], had, "x", color=BLACK, ms=4, label="error the row had")
    log_log(ax, **AXES, ylim=(1e-4, 0.12))
    ax.legend(**BELOW)


@style
def draw(d: Data) -> Figure:
    panels = {"drift of the row": panel, "by tolerance, 95 %": _draw_runs}
    figure = painted(d, panels, 3.8)
    times = zip(to_reach(d, 0.01), _looks(d), strict=True)
    one = [f"{time:.2g} s at {name}" for time, (_, name) in times]
    words = f"an error of 1 % (one standard error): {', '.join(one)}".replace("inf s", "never")
    note(figure, words)
    return figure
