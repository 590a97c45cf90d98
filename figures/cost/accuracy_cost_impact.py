"""What the accuracy of one soft impact costs: error of its integration over step and time.

The scene of Fig. 12 under the law `coulomb` at k_n = 5e6, against itself with every switch located
at a tolerance of 1e-14; the broken line is how far that at 1e-13 is from it. Errors are lengths of
the difference of (c_x', c_z')/|c_z|; times are those of the compiled impact (of the Python call for
DOP853). Filled symbols: largest over six tilts, two in each regime, and over 24 places of the touch
within a step; open: median. The dashpot begins as delta^(1/4): as long as the touch is not located,
order 5/4 is the most there is. The error of the model, a finite stiffness, adds to this one: figure
`rigid_limit`.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from math import cos

import matplotlib.pyplot as plt
import numpy as np

import md
from md.cache import kernel
from md.kernels.codes import WATCHED
from md.kernels.single import METHODS, run, started
from md.laws import contact_time, effects_of

from ..lib.soft_impacts import APPROACH_RATIO, IMPACT_FRICTION, ROD, TABLE_TILTS, one_impact
from ..lib.style import BLACK, BLUE, GREEN, GUIDE, ORANGE, Data, log_log, name_panels, note, style
from ..lib.timing import machine_line, measured_here, medians

LAW = md.coulomb()
TILTS_OF_REGIMES = np.radians([10, 25, 40, 65, 83, 87])  # two tilts in each regime
OFFSETS = (np.arange(24) + 0.5) / 24  # of the touch within a step
PAPER_STEP = 2e-5  # sqrt(d/g)
MOST_STEPS = 10**9  # the contact ends long before
LOOKS = {"leapfrog": (BLUE, "s"), "verlet": (BLACK, "o"), "gear": (ORANGE, "^")}


@kernel(entry=True)
def repeated_impact(effects, state, dt, times, watch):
    """Velocity after an impact that is integrated `times` times over, and the steps of one."""
    velocity, steps = state.velocity, 0
    for _ in range(times):
        for i in range(WATCHED):
            watch[i] = 0.0
        after, steps, _ = run(effects, state, 0, MOST_STEPS, dt, watch)
        velocity = after[2]
    return velocity, steps


def impact_call(tilt: float, integrator: str, dt: float) -> Callable:
    """Call that integrates an impact as often as asked, compiled; touch in the middle of a step."""
    effects = effects_of(ROD, LAW, IMPACT_FRICTION, None, None)
    position = np.array([0.0, ROD.half_length * cos(tilt) + 0.5, tilt])
    velocity = np.array([1 / APPROACH_RATIO, -1.0, 0.0])
    start = position - dt / 2 * velocity
    state, watch = started(integrator, start, velocity, dt), np.zeros(WATCHED)
    return lambda times=1: repeated_impact(effects, state, dt, times, watch)


def velocities(**how) -> tuple[np.ndarray, list[md.Impact]]:
    """(c_x', c_z') at `TILTS_OF_REGIMES`; nan where the step is refused or the run fails."""
    hits, found = [], np.full((TILTS_OF_REGIMES.size, 2), np.nan)
    for row, tilt in zip(found, TILTS_OF_REGIMES, strict=True):
        with suppress(ValueError, RuntimeError):
            hits.append(one_impact(tilt, LAW, **how))
            row[:] = hits[-1].c_x, hits[-1].c_z
    return found, hits


def fixed_steps(parts: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Largest and median error, shape (2, methods, parts); nan if any impact fails."""
    whole, found = contact_time(LAW, 1.0), np.empty((2, len(METHODS), parts.size))
    for i, j in np.ndindex(found.shape[1:]):
        dt = whole / parts[j]
        hits = [velocities(integrator=METHODS[i], dt=dt, offset=part)[0] for part in OFFSETS]
        length = np.hypot(*np.moveaxis(hits - true, -1, 0))
        found[:, i, j] = length.max(), np.median(length)
    return found


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


def gear_from_leapfrog() -> list[float]:
    """Gear's method less leapfrog at the paper's step: the largest difference over 17 tilts.

    Of the laws `coulomb` and `appendix_a`; under `constant_restitution` that step is too long for
    Gear's method.
    """

    def after(law, method):
        hits = [one_impact(tilt, law, integrator=method, dt=PAPER_STEP) for tilt in TABLE_TILTS]
        return np.array([(hit.c_x, hit.c_z) for hit in hits])

    laws = LAW, md.appendix_a()
    return [np.hypot(*(after(law, "gear") - after(law, "leapfrog")).T).max() for law in laws]


def data(quick: bool = False) -> Data:
    """Errors and prices; a step is 1/`parts` of a head-on contact time."""
    runs, here = 3 if quick else 9, measured_here()
    parts = 10.0 * (4 ** np.arange(6) if quick else 2 ** np.arange(14))
    tolerances = 10.0 ** -np.arange(3, 14, 2 if quick else 1)
    true, near = (velocities(integrator="dop853", tolerance=t)[0] for t in (1e-14, 1e-13))
    fixed, whole = fixed_steps(parts, true), contact_time(LAW, 1.0)
    calls = [
        impact_call(tilt, method, whole / part)
        for method in METHODS
        for part in parts
        for tilt in TILTS_OF_REGIMES
    ]
    shape = len(METHODS), parts.size, TILTS_OF_REGIMES.size
    return {
        "parts": parts,
        "fixed_error": fixed,
        "fixed_seconds": medians(calls, runs).reshape(shape).mean(-1),
        "order": np.array([order(parts, row) for row in fixed[0]]),
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


def _fixed_steps(ax, d, x: Sequence[np.ndarray]):
    """Draw errors of the methods over `x`, one row a method."""
    for i, (method, look) in enumerate(LOOKS.items()):
        label = f"{method.title()}, order {d['order'][i]:.2f}"
        _errors(ax, x[i], d["fixed_error"][:, i], *look, label)
    ax.axhline(d["floor"], **GUIDE, ls="--")
    ax.axhline(np.finfo(float).eps / 2, **GUIDE, ls=":")
    log_log(ax, ylim=(3e-17, 1))


@style
def draw(d: Data) -> plt.Figure:
    figure, (steps, time) = plt.subplots(1, 2, figsize=(7.0, 3.2), sharey=True)
    _fixed_steps(steps, d, [1 / d["parts"]] * len(LOOKS))
    steps.text(4e-6, 2 * d["floor"], "the reference's own error")
    steps.text(4e-6, 2e-16, "half an ulp")
    steps.set(xlabel=r"step $\Delta t/t_c$", xlim=(1.5e-6, 0.3))
    steps.set_ylabel(r"$|\Delta\mathbf{c}'|/|c_z|$, integration")
    _fixed_steps(time, d, 1e6 * d["fixed_seconds"])
    label, microseconds = "DOP853, switches located", 1e6 * d["adaptive_seconds"]
    _errors(time, microseconds, d["adaptive_error"], GREEN, "D", label)
    time.legend(loc="lower left", bbox_to_anchor=(0, 0.28))
    time.set(xlabel="time per impact (µs)", xlim=(0.1, 1e5))
    name_panels((steps, time), ("over the step", "over the time"))
    note(figure, machine_line(d))
    return figure
