"""What the accuracy of the row's drift costs in time, step by step, and by tolerance.

The paper's row, N = 40, L = 43 d, Gamma = 3.3, tangential springs 30 times as stiff as the contact.
(a) Error of a run's drift against its time, a curve per step: root mean square over disjoint parts
of one long run, against the mean of the fine steps. The curves fall as time^(-1/2) (guide), until
they come to the bias of their step (short lines at the right; dotted where it is less than three
times its own error, which is then what the line shows). Diamond: the paper's own step at the
length that gives 1 %. (b) Bias over the steps a contact lasts, against the shortest step there, all
scenes of the calibration, in grey, with the bound that `--tolerance` takes from them; coloured, the
row of (a). The line that stays high is a rough plate (friction 0.6), where rows have two states,
and one start at the finest step found the other. (c) Runs to a tolerance: the one asked for, 95 %
confidence, against the time it took; dots: the error that the run then had. The broken lines are
the prices of fixed steps; times are of this machine, without compiling.
"""

import os
from statistics import median
from time import perf_counter

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

import md
from md.accuracy import calibrated, steps_per_contact
from md.host import Engine, prepare
from md.statistics import standard_error

from ..lib.style import BLACK, BLUE, GREEN, ORANGE, RED, name_panel, style
from ..lib.timing import machine_line

PAPER_STEP = 2e-5  # sqrt(d/g)
PER_CONTACT = (16, 20, 26, 40, 80)  # and the paper's
FINE = 30  # steps a contact from which on runs are taken as the truth
CUT = 100  # periods at the start
PERIODS = {True: 2500, False: 20000}  # quick or not; a third of it at the paper's step
CLEAR = 3  # its own errors: a smaller bias is taken for none
TOLERANCES = (0.2, 0.1, 0.05, 0.02, 0.01)


def _scene(dt: float, seed: int = 1) -> md.Scene:
    how = [f"step.size={dt}", "step.coarse=true", "start.speed=0.3", f"start.seed={seed}"]
    return md.load("quasi2d", how)


def rms_of_parts(series: np.ndarray, lengths: np.ndarray, truth: float) -> np.ndarray:
    """Root mean square distance from the truth of the means of disjoint parts."""
    found = []
    for n in lengths:
        means = series[len(series) % n :].reshape(-1, n).mean(axis=1)
        found.append(np.sqrt(np.mean((means - truth) ** 2)))
    return np.array(found)


def seconds_per_period(steps: list[float], rounds: int = 7, periods: int = 6) -> np.ndarray:
    """Medians over rounds in which each step has its turn, from a settled row."""
    engines = []
    for dt in steps:
        engine = prepare(_scene(dt), ledger=False)
        engine.go(20 * engine.per)
        engines.append(engine)
    samples = [[_timed(engine, periods) for engine in engines] for _ in range(rounds)]
    return np.array([median(of_one) for of_one in zip(*samples, strict=True)])


def _timed(engine: Engine, periods: int) -> float:
    begin = perf_counter()
    for _ in range(periods):
        engine.go(engine.per)
        engine.record.count[0] = 0
    return (perf_counter() - begin) / periods


def data(quick: bool = False) -> dict[str, np.ndarray]:
    """Long runs at several steps, prices of a period, runs to a tolerance."""
    load = os.getloadavg()[0]
    contact = steps_per_contact(md.load("quasi2d"), 1.0)
    steps = [*(contact / n for n in PER_CONTACT), PAPER_STEP]
    periods = PERIODS[quick]
    seconds = seconds_per_period(steps)
    series = []
    for dt in steps:
        made = periods if dt > PAPER_STEP else periods // 3
        series.append(md.run(_scene(dt), periods=CUT + made, ledger=False).c_x_series[CUT:])
    mean = np.array([one.mean() for one in series])
    error = np.array([standard_error(one) for one in series])
    n = np.array([contact / dt for dt in steps])
    weight = (n >= FINE) / error**2
    truth = float((weight * mean).sum() / weight.sum())
    lengths = np.unique(np.geomspace(4, periods / 8, 14).astype(int))
    rms = [rms_of_parts(one, lengths[lengths <= len(one) / 8], truth) for one in series]
    tolerances = TOLERANCES[: 3 if quick else None]
    runs = [md.run(_scene(PAPER_STEP, 5), tolerance=r, ledger=False) for r in tolerances]
    # Errors of a mean of n periods as sigma sqrt(g/n): from the standard error of the long run.
    noise = error * np.sqrt([len(one) for one in series]) / truth
    known = calibrated()
    return {
        "load": np.float64(load),
        "per_contact": n,
        "dt": np.array(steps),
        "seconds": seconds,
        "made": np.array([len(one) for one in series]),
        "truth": np.float64(truth),
        "truth_error": np.float64(weight.sum() ** -0.5),
        "bias": mean / truth - 1,
        "bias_error": np.hypot(error, weight.sum() ** -0.5) / truth,
        "noise": noise,
        "lengths": lengths,
        "rms": np.array([np.append(r, np.full(len(lengths) - len(r), np.nan)) for r in rms])
        / truth,
        "tolerance": np.array(tolerances),
        "run_seconds": np.array([run.run_seconds for run in runs]),
        "run_per_contact": np.array([run.accuracy.per_contact for run in runs]),
        "run_error": np.abs([run.c_x / truth - 1 for run in runs]),
        "run_periods": np.array([run.periods for run in runs]),
        "known_steps": np.array(known["steps"], float),
        "known_drift": np.array(known["drift"]),
        "known_error": np.array(known["drift_error"]),
        "scale": np.float64(known["scale"]),
        "order": np.float64(known["order"]),
    }


def to_reach(d: dict[str, np.ndarray], error: float) -> np.ndarray:
    """Seconds at each step until the root mean square error is this small; inf where it never is.

    Squares of bias and noise add; a bias that cannot be told from zero counts as none.
    """
    clear = np.abs(d["bias"]) > CLEAR * d["bias_error"]
    room = error**2 - np.where(clear, d["bias"], 0.0) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        periods = d["noise"] ** 2 / room
    return np.where(room > 0, periods * d["seconds"], np.inf)


_COLOURS = (RED, ORANGE, GREEN, BLUE, "#56B4E9", BLACK)


def _labels(d: dict[str, np.ndarray]) -> list[str]:
    names = [rf"$t_c/{n:.0f}$" for n in d["per_contact"]]
    return [*names[:-1], names[-1] + ", the paper's"]


def panel(ax: Axes, d: dict[str, np.ndarray]) -> None:
    """Error against time, step by step."""
    for i, (colour, label) in enumerate(zip(_COLOURS, _labels(d), strict=True)):
        time = d["lengths"] * d["seconds"][i]
        ax.plot(time, d["rms"][i], "o-", color=colour, ms=2.2, lw=0.8, label=label)
    right = 2 * (d["lengths"][-1] * d["seconds"][:-1]).max()
    for i, colour in enumerate(_COLOURS):
        size, error = abs(d["bias"][i]), d["bias_error"][i]
        clear = size > CLEAR * error
        ax.plot(
            [right, 3 * right],
            [size] * 2 if clear else [CLEAR * error] * 2,
            color=colour,
            lw=1.4 if clear else 0.8,
            ls="-" if clear else ":",
        )
    time = np.array([d["lengths"][0] * d["seconds"][:-1].min(), right])
    middle = int(np.abs(d["per_contact"] - 25).argmin())
    guide = 0.5 * d["noise"][middle] * np.sqrt(d["seconds"][middle] / time)
    ax.plot(time, guide, color="0.5", lw=0.8, ls="--", label="time$^{-1/2}$")
    ax.plot(to_reach(d, 0.01)[-1], 0.01, "D", color=BLACK, ms=5, mfc="white", mew=1.2)
    ax.axhline(0.01, color="0.75", lw=0.6)
    ax.set(xscale="log", yscale="log", xlabel="time of the run (s)")
    ax.set(ylabel=r"error of $c_x$, relative", ylim=(4e-4, 0.5))
    ax.legend(fontsize=5.5, loc="lower left", title="step", title_fontsize=6)


def _draw_bias(ax: Axes, d: dict[str, np.ndarray]) -> None:
    fine = d["known_drift"][:, -1:]
    bias = np.abs(d["known_drift"] / fine - 1)[:, :-1]
    error = np.hypot(d["known_error"] / d["known_drift"], d["known_error"][:, -1:] / fine)[:, :-1]
    for one, spread in zip(bias, error, strict=True):
        ax.errorbar(
            d["known_steps"][:-1], np.fmax(one, 1e-4), spread, color="0.7", lw=0.6, elinewidth=0.4
        )
    n = np.geomspace(10, 110, 50)
    ax.plot(n, d["scale"] * (10 / n) ** d["order"], color=BLACK, lw=1, label="bound taken")
    for i, colour in enumerate(_COLOURS[:-1]):
        size, spread = abs(d["bias"][i]), d["bias_error"][i]
        ax.errorbar(
            d["per_contact"][i], max(size, 1e-4), spread, fmt="o", color=colour, ms=3.5, zorder=3
        )
    ax.set(xscale="log", yscale="log", xlabel="steps a contact", ylim=(3e-4, 0.3), xlim=(11, 110))
    ax.set_xticks([13, 18, 25, 36, 50, 100], ["13", "18", "25", "36", "50", "100"])
    ax.minorticks_off()
    ax.set_ylabel(r"|bias| of $c_x$, relative")
    ax.legend(fontsize=6, loc="lower left")


def _draw_runs(ax: Axes, d: dict[str, np.ndarray]) -> None:
    wanted = np.geomspace(0.003, 0.3, 60)
    for i in (1, 3, 5):
        time = np.array([to_reach(d, r / 1.96)[i] for r in wanted])
        ax.plot(time, wanted, "--", color=_COLOURS[i], lw=0.7, label=_labels(d)[i])
    ax.plot(d["run_seconds"], d["tolerance"], "s-", color=BLACK, ms=3, lw=0.9, label="asked for")
    ax.plot(d["run_seconds"], np.fmax(d["run_error"], 1e-4), "o", color=RED, ms=3, label="had")
    ax.set(xscale="log", yscale="log", xlabel="time of the run (s)", ylim=(2e-4, 0.5))
    ax.set_ylabel(r"error of $c_x$, relative")
    ax.legend(fontsize=5.5, loc="lower left")


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, axes = plt.subplots(1, 3, figsize=(7.0, 3.0), width_ratios=(1.25, 1, 1))
    for ax, paint in zip(axes, (panel, _draw_bias, _draw_runs), strict=True):
        paint(ax, d)
    for ax, letter, title in zip(
        axes, "abc", ("drift of the row", "bias of the step", "by tolerance, 95 %"), strict=True
    ):
        name_panel(ax, letter, title)
    one = [f"{t:.2g} s at {name}" for t, name in zip(to_reach(d, 0.01), _labels(d), strict=True)]
    figure.supxlabel(
        "an error of 1 % (one standard error): " + ", ".join(one).replace("inf s", "never"),
        fontsize=5.5,
    )
    return figure


def summary(d: dict[str, np.ndarray]) -> str:
    """Prices, biases, what 1 % and 0.3 % take, what runs to a tolerance took."""
    lines = [
        f"{machine_line(float(d['load']))}; 1 core used",
        f"c_x = {d['truth']:.5f} +- {d['truth_error']:.5f} sqrt(g d)",
        " step       a contact  ms/period  noise of a period  bias              1 % takes  0.3 %",
    ]
    one, third = to_reach(d, 0.01), to_reach(d, 0.003)
    for i, dt in enumerate(d["dt"]):
        lines.append(
            f" {dt:.2e} {d['per_contact'][i]:9.1f} {1e3 * d['seconds'][i]:10.2f} "
            f"{d['noise'][i]:15.1%}    {d['bias'][i]:+8.2%} +- {d['bias_error'][i]:.2%}"
            f" {one[i]:9.2f} s {third[i]:7.1f} s"
        )
    lines.append("tolerance, 95 %: asked for, steps a contact, periods, seconds, error it had")
    for i, r in enumerate(d["tolerance"]):
        lines.append(
            f" {r:6.1%} {d['run_per_contact'][i]:8.1f} {d['run_periods'][i]:8d} "
            f"{d['run_seconds'][i]:8.2f} s  {d['run_error'][i]:.2%}"
        )
    return "\n".join(lines)
