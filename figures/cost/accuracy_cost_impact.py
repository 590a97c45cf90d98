"""What the accuracy of one soft impact costs: error of its integration over step and time.

The scene of Fig. 12 under the law `coulomb` at k_n = 5e6, against itself with every switch located
at a tolerance of 1e-14; the broken line is how far that at 1e-13 is from it. Errors are lengths of
the difference of (c_x', c_z')/|c_z|; times are those of the compiled loop, some 10 microseconds of
calling it included, and of the Python call for DOP853. Filled symbols: largest over six tilts, two
in each regime, and over 24 places of the touch within a step; open: median. The dashpot begins as
delta^(1/4): as long as the touch is not located, order 5/4 is the most there is. The error of the
model, a finite stiffness, adds to this one: figure `rigid_limit`.
"""

from contextlib import suppress

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import md
from md.laws import contact_time

from ..lib.soft_impacts import one_impact
from ..lib.style import BLACK, GREEN, GUIDE, Data, log_log, name_panels, note, style
from ..lib.timing import machine_line, measured_here

LAW = md.coulomb()
TILTS_OF_REGIMES = np.radians([10, 25, 40, 65, 83, 87])  # two tilts in each regime
OFFSETS = (np.arange(24) + 0.5) / 24  # of the touch within a step


def velocities(**how) -> tuple[np.ndarray, list[md.Impact]]:
    """(c_x', c_z') at `TILTS_OF_REGIMES`, and the impacts; nan where one is refused or fails."""
    hits, found = [], np.full((TILTS_OF_REGIMES.size, 2), np.nan)
    for row, tilt in zip(found, TILTS_OF_REGIMES, strict=True):
        with suppress(ValueError, RuntimeError):
            hits.append(one_impact(tilt, LAW, **how))
            row[:] = hits[-1].c_x, hits[-1].c_z
    return found, hits


def fixed_steps(parts: np.ndarray, true: np.ndarray) -> Data:
    """Verlet's method: largest and median error, (2, parts), and seconds."""
    rows = []
    for part in parts:
        dt = contact_time(LAW, 1.0) / part
        samples = [velocities(dt=dt, offset=offset) for offset in OFFSETS]
        length = np.hypot(*np.moveaxis([found - true for found, _ in samples], -1, 0))
        times = [hit.seconds for _, hits in samples for hit in hits]
        rows.append((length.max(), np.median(length), np.median(times)))
    *error, seconds = np.array(rows).T
    return {"fixed_error": np.array(error), "fixed_seconds": seconds}


def order(parts: np.ndarray, error: np.ndarray) -> float:
    """Order of an error: slope in log-log where it is small; nan from fewer than three points."""
    some = error < 1e-2
    if np.sum(some) < 3:
        return np.nan
    return -np.polyfit(np.log(parts[some]), np.log(error[some]), 1)[0]


def adaptive(tolerances: np.ndarray, true: np.ndarray, runs: int) -> Data:
    """DOP853: largest and median error, shape (2, tolerances), evaluations and seconds."""
    rows = []
    for tolerance in tolerances:
        samples = [velocities(integrator="dop853", tolerance=tolerance) for _ in range(runs)]
        found, hits = samples[0]
        length = np.hypot(*(found - true).T)
        times = [np.mean([hit.seconds for hit in hits]) for _, hits in samples]
        evaluations = max(hit.steps for hit in hits)
        rows.append((length.max(), np.median(length), evaluations, np.median(times)))
    *error, evaluations, seconds = np.array(rows).T
    return {
        "adaptive_error": np.array(error),
        "evaluations": evaluations,
        "adaptive_seconds": seconds,
    }


def data(quick: bool = False) -> Data:
    """Errors and prices; a step is 1/`parts` of a head-on contact time."""
    runs, here = 3 if quick else 9, measured_here()
    parts = 10.0 * (4 ** np.arange(6) if quick else 2 ** np.arange(14))
    tolerances = 10.0 ** -np.arange(3, 14, 2 if quick else 1)
    true, near = (velocities(integrator="dop853", tolerance=t)[0] for t in (1e-14, 1e-13))
    fixed = fixed_steps(parts, true)
    return {
        "parts": parts,
        **fixed,
        "order": order(parts, fixed["fixed_error"][0]),
        "floor": np.hypot(*(near - true).T).max(),
        "tolerance": tolerances,
        **adaptive(tolerances, true, runs),
        "offsets": OFFSETS,
        **here,
    }


def _errors(ax, x: np.ndarray, error: np.ndarray, colour: str, marker: str, label: str):
    """Draw largest (filled) and median errors over `x`."""
    worst, middle = error
    look = {"color": colour, "lw": 0.8, "ms": 3}
    ax.plot(x, worst, f"{marker}-", label=label, **look)
    ax.plot(x, middle, f"{marker}:", mfc="white", mew=0.7, **look)


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplots(1, 2, figsize=(7.0, 3.2), sharey=True)
    steps, time = axes
    label = f"Verlet, order {d['order']:.2f}"
    for ax, x in (steps, 1 / d["parts"]), (time, 1e6 * d["fixed_seconds"]):
        _errors(ax, x, d["fixed_error"], BLACK, "o", label)
        ax.axhline(d["floor"], **GUIDE, ls="--")
        ax.axhline(np.finfo(float).eps / 2, **GUIDE, ls=":")
        log_log(ax, ylim=(3e-17, 1))
    steps.text(4e-6, 2 * d["floor"], "the reference's own error")
    steps.text(4e-6, 2e-16, "half an ulp")
    words = r"$|\Delta\mathbf{c}'|/|c_z|$, integration"
    steps.set(xlabel=r"step $\Delta t/t_c$", xlim=(1.5e-6, 0.3), ylabel=words)
    label, microseconds = "DOP853, switches located", 1e6 * d["adaptive_seconds"]
    _errors(time, microseconds, d["adaptive_error"], GREEN, "D", label)
    time.legend(loc="lower left", bbox_to_anchor=(0, 0.28))
    time.set(xlabel="time per impact (µs)", xlim=(3, 1e5))
    name_panels(axes, ("over the step", "over the time"))
    note(figure, machine_line(d))
    return figure
