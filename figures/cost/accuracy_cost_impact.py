"""What the accuracy of one soft impact costs: error of the integration, and error of the model.

The scene of Fig. 12. Errors are lengths of the difference of (c_x', c_z')/|c_z|; times are those of
the compiled impact (of the Python call for DOP853). (a), (b) Integration: the law `coulomb` at
k_n = 5e6 against itself with every switch located, at a tolerance of 1e-14; the broken line is how
far that at 1e-13 is from it. Filled symbols: largest over six tilts, two in each regime, and over
24 places of the touch within a step; open: median. The dashpot begins as delta^(1/4): as long as
the touch is not located, order 5/4 is the most there is. (c) Model: RMS over 17 tilts against the
rigid map at the restitution of each run, with Verlet at the longest step at which this error has
come within a tenth of its limit. A stiffer plate costs nothing here, but in a long run its step
shrinks as k_n^(-2/5). The two errors add. The table: what each method takes for a largest error, by
time and setting (step as a part of the contact time t_c, or tolerance), the cheapest in bold.
"""

import os

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

import md
from md.laws import contact_time

from ..claims.uncertainty import rms
from ..lib.impact_times import impact_call, price, rigid_seconds
from ..lib.soft_impacts import TABLE_TILTS
from ..lib.style import BLACK, BLUE, GREEN, ORANGE, RED, Data, name_panels, style
from .impact_errors import (
    LADDERS,
    METHODS,
    OFFSETS,
    TILTS_OF_REGIMES,
    adaptive,
    fixed_steps,
    models,
    one_impact,
    order,
    reached,
    velocities,
)

LAW = md.coulomb()
OTHERS = {"constant_restitution": md.constant_restitution(), "appendix_a": md.appendix_a()}
PAPER_STEP = 2e-5  # sqrt(d/g)
TARGETS = (1e-2, 1e-3, 1e-6, 1e-10)


def _other_laws(parts: np.ndarray) -> Data:
    """Largest errors of the other laws, against Verlet at a sixteenth of the finest step."""
    error = []
    for law in OTHERS.values():
        fine = contact_time(law, 1.0) / (16 * parts[-1])
        error.append(fixed_steps(law, parts, velocities(law, integrator="verlet", dt=fine)[0])[0])
    orders = [[order(parts, row) for row in rows] for rows in error]
    return {"other_parts": parts, "other_error": np.array(error), "other_order": np.array(orders)}


def gear_from_leapfrog() -> np.ndarray:
    """Difference at the paper's step: root mean square and largest over 17 tilts.

    Under `constant_restitution` that step is too long for Gear's method.
    """

    def after(law, method):
        hits = [one_impact(tilt, law, integrator=method, dt=PAPER_STEP) for tilt in TABLE_TILTS]
        return np.array([(hit.c_x, hit.c_z) for hit in hits])

    laws = LAW, OTHERS["appendix_a"]
    off = [np.hypot(*(after(law, "gear") - after(law, "leapfrog")).T) for law in laws]
    return np.array([(rms(one), one.max()) for one in off])


def _step_seconds(runs: int) -> np.ndarray:
    """Of one compiled step under each law (rows) by each method."""
    calls = [
        impact_call(0.7, law, method, contact_time(law, 1.0) / 1e4)
        for law in (LAW, *OTHERS.values())
        for method in METHODS
    ]
    seconds, steps = price(calls, runs)
    return (seconds / steps).reshape(-1, len(METHODS))


def data(quick: bool = False) -> Data:
    """Errors and prices; a step is 1/`parts` of a head-on contact time."""
    runs = 3 if quick else 9
    parts = 10.0 * (4 ** np.arange(6) if quick else 2 ** np.arange(14))
    tolerances = 10.0 ** -np.arange(3, 14, 2 if quick else 1)
    load = os.getloadavg()[0]
    true, near = (velocities(LAW, integrator="dop853", tolerance=t)[0] for t in (1e-14, 1e-13))
    fixed = fixed_steps(LAW, parts, true)
    whole = contact_time(LAW, 1.0)
    calls = [
        impact_call(float(tilt), LAW, method, whole / part)
        for method in METHODS
        for part in parts
        for tilt in TILTS_OF_REGIMES
    ]
    seconds, steps = (a.reshape(*fixed[0].shape, -1).mean(-1) for a in price(calls, runs))
    return {
        "parts": parts,
        "fixed_error": fixed,
        "fixed_seconds": seconds,
        "fixed_steps": steps,
        "order": np.array([order(parts, row) for row in fixed[0]]),
        "floor": np.hypot(*(near - true).T).max(),
        "tolerance": tolerances,
        **adaptive(LAW, tolerances, true, runs),
        **_other_laws(parts[parts < 3e3]),
        "step_seconds": _step_seconds(runs),
        "gear_from_leapfrog": gear_from_leapfrog(),
        **models(3 if quick else 1, runs),
        "rigid_seconds": np.float64(rigid_seconds(runs)),
        "offsets": OFFSETS,
        "runs": np.int64(runs),
        "load": np.float64(load),
    }


def choices(d: Data, target: float) -> dict[str, tuple[float, str]]:
    """Seconds and setting of the cheapest run of each method whose largest error is that small.

    A method that fails has infinite seconds, and says how far it came.
    """
    found = {}
    for i, method in enumerate(METHODS):
        parts, error, seconds = d["parts"], d["fixed_error"][0, i], d["fixed_seconds"][i]
        enough = reached(parts, error, target)
        if np.isnan(enough):
            j = np.nanargmin(error)
            found[method] = np.inf, f"{error[j]:.0e} at t_c/{parts[j]:.0f}"
        else:
            cost = np.exp(np.interp(np.log(enough), np.log(parts), np.log(seconds)))
            found[method] = float(cost), f"t_c/{enough:.0f}"
    # Not for a tolerance that only happens to do: all smaller ones have to as well.
    enough = np.logical_and.accumulate((d["adaptive_error"][0] <= target)[::-1])[::-1]
    found["dop853"] = np.inf, "at every tolerance"
    if enough.any():
        j = enough.argmax()
        text = f"tolerance {d['tolerance'][j]:.0e}, {d['evaluations'][j]} evaluations"
        found["dop853"] = float(d["adaptive_seconds"][j]), text
    return found


def _time(seconds: float) -> str:
    if seconds < 9.95e-6:
        return f"{seconds * 1e6:.1f} µs"
    return f"{seconds * 1e6:.0f} µs" if seconds < 1e-3 else f"{seconds * 1e3:.1f} ms"


def _advice(d: Data) -> list[list[str]]:
    """Error wanted, and what each method takes for it: time and setting, or how far it comes."""

    def told(cost: float, how: str) -> str:
        return f"{_time(cost)}, {how.partition(',')[0]}" if cost < np.inf else f"no, {how}"

    return [[f"{t:.0e}", *(told(*how) for how in choices(d, t).values())] for t in TARGETS]


BESIDE = {"textcoords": "offset points", "va": "center", "fontsize": 6.5}
_LOOKS = {"leapfrog": (BLUE, "s"), "verlet": (BLACK, "o"), "gear": (ORANGE, "^")}


def _draw_integration(ax: Axes, d: Data, x: np.ndarray) -> None:
    """Largest (filled) and median errors over `x`, one row a method."""
    for i, (method, (colour, marker)) in enumerate(_LOOKS.items()):
        worst, middle = d["fixed_error"][:, i]
        look = {"color": colour, "lw": 0.8, "ms": 3}
        ax.plot(x[i], worst, marker + "-", label=method, **look)
        ax.plot(x[i], middle, marker + ":", mfc="white", mew=0.7, **look)
    ax.axhline(d["floor"], color="0.55", lw=0.8, ls="--")
    ax.axhline(np.finfo(float).eps / 2, color="0.55", lw=0.8, ls=":")
    ax.set(xscale="log", yscale="log", ylim=(3e-17, 1))


def _draw_steps(ax: Axes, d: Data) -> None:
    _draw_integration(ax, d, np.broadcast_to(1 / d["parts"], d["fixed_steps"].shape))
    lift = {"leapfrog": 1.0, "verlet": 0.35, "gear": 3.0}
    small = {"fontsize": 6.5}
    for i, (method, (colour, _)) in enumerate(_LOOKS.items()):
        at = 0.8 / d["parts"][-1], lift[method] * d["fixed_error"][0, i, -1]
        words = f"order {d['order'][i]:.2f}"
        ax.text(*at, words, color=colour, ha="right", va="center", **small)
    ax.axvline(1 / 50, color="0.55", lw=0.8, ls="-.")
    ax.text(1 / 60, 1e-8, r"$t_c/50$", ha="right", **small)
    ax.text(4e-6, 2 * d["floor"], "the reference's own error", **small)
    ax.text(4e-6, 2e-16, "half an ulp", **small)
    ax.set(xlabel=r"step $\Delta t/t_c$", xlim=(1.5e-6, 0.3))
    ax.set_ylabel(r"$|\Delta\mathbf{c}'|/|c_z|$, integration")
    words = "filled: largest\nopen: median"
    ax.text(0.03, 0.97, words, transform=ax.transAxes, va="top", **small)


def _draw_time(ax: Axes, d: Data) -> None:
    _draw_integration(ax, d, 1e6 * d["fixed_seconds"])
    worst, middle = d["adaptive_error"]
    time = 1e6 * d["adaptive_seconds"]
    ax.plot(time, worst, "D-", color=GREEN, lw=0.8, ms=3, label="dop853, events")
    ax.plot(time, middle, "D:", color=GREEN, mfc="white", mew=0.7, lw=0.8, ms=3)
    ax.legend(loc="lower left", fontsize=6.5, bbox_to_anchor=(0, 0.3))
    ax.set(xlabel="time per impact (µs)", xlim=(0.1, 1e5))


def _draw_models(ax: Axes, d: Data) -> None:
    sides = {"coulomb": (-1, -1), "constant_restitution": (-1, -1), "appendix_a": (1, -1)}
    looks = ((BLACK, "o"), (BLUE, "s"), (RED, "D"))
    for (name, (_, _, word)), (colour, marker) in zip(LADDERS.items(), looks, strict=True):
        value, error = d[f"{name}_value"], d[f"{name}_error"]
        time = 1e6 * d[f"{name}_seconds"]
        symbol = "$k_n$" if word == "k_n" else "ratio"
        ax.plot(time, error, marker + "-", color=colour, lw=0.8, ms=3, label=f"{name}, {symbol}")
        for j, side in zip((0, -1), sides[name], strict=True):
            digits = rf"$10^{{{np.log10(value[j]):.0f}}}$" if word == "k_n" else f"{value[j]:g}"
            look = {"ha": "left" if side > 0 else "right", "color": colour, **BESIDE}
            ax.annotate(digits, (time[j], error[j]), (4 * side, 0), **look)
    ax.axvline(1e6 * d["rigid_seconds"], 0, 0.82, color="0.55", lw=0.8, ls="--")
    upright = {"fontsize": 6.5, "rotation": 90, "ha": "right"}
    ax.text(0.93e6 * d["rigid_seconds"], 2e-5, "rigid map, compiled", **upright)
    ax.set(xscale="log", yscale="log", xlabel="time per impact (µs)", ylim=(1e-7, 100))
    ax.set(xlim=(0.007, 300), ylabel=r"RMS $|\Delta\mathbf{c}'|/|c_z|$, model")
    ax.legend(loc="upper center", fontsize=6, labelspacing=0.3)


def _draw_advice(ax: Axes, d: Data) -> None:
    """Table of what each method takes for an error, the cheapest in bold."""
    heads, look = ("largest error", *METHODS, "dop853, events"), {"cellLoc": "center"}
    rows = [[cell.replace("t_c", "$t_c$") for cell in row] for row in _advice(d)]
    told = ax.table(rows, colLabels=heads, edges="horizontal", bbox=(0, 0, 1, 1), **look)
    told.auto_set_font_size(False)
    told.set_fontsize(6.5)
    for (i, j), cell in told.get_celld().items():
        cell.set_linewidth(0.4)
        times = [seconds for seconds, _ in choices(d, TARGETS[i - 1]).values()] if i else []
        if i and j == 1 + int(np.argmin(times)):
            cell.get_text().set_weight("bold")
    ax.set(xticks=[], yticks=[])
    ax.spines[:].set_visible(False)
    ax.set_xlabel("what each method takes for a largest error in (a, b); the cheapest in bold")


@style
def draw(d: Data) -> plt.Figure:
    figure, axes = plt.subplot_mosaic("abc;ddd", figsize=(7.0, 4.2), height_ratios=(3.2, 1))
    *panels, below = axes.values()
    for ax, panel in zip(panels, (_draw_steps, _draw_time, _draw_models), strict=True):
        panel(ax, d)
    name_panels(panels, ("integration, steps", "integration, time", "model, time"))
    _draw_advice(below, d)
    return figure
