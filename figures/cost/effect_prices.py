"""What each effect of a scene costs in a step of a rod, and what leaving it out does to the drift.

All scenes go on from the same places of one settled run, a short way from each, at one step, so
that who touches whom is nearly the same. Where the plate is at rest the places are taken in its
frame; without a plate the rods fall freely. Alone: an effect on top of the barest scene in which it
makes sense. Within: the full scene less the full scene without the effect and what needs it. Below
them one thing in the place of another, then effects of the size zero against a scene that does not
name them: the same compiled kernel, so that these bars show the error of all.

Drift: that of the changed scene less that of the full one, over seeds. Without gravity, plate, box
or contacts of rods no row is left to drift; what only measures does not change the rods by a bit.
"""

from collections.abc import Callable
from copy import deepcopy
from math import ceil
from time import perf_counter

import matplotlib.pyplot as plt
import numba
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from md.host import Engine
from md.kernels import C_Z, Z
from md.kernels.march import Series
from md.scene import put
from md.sweep import Sweep

from ..lib.runs import SIMPLE_ROW, gathered, over_seeds, planned, starts
from ..lib.style import BLUE, ORANGE, Data, note, style
from ..lib.timing import (
    Sampler,
    estimate,
    in_turn,
    machine_line,
    measured_here,
    onward,
    steady,
    waited,
)
from .scene_variants import BARE, FULL, GROUPS, STEP_SIZE, Effect, Variant, variants

Place = tuple[dict[str, np.ndarray], int]  # all that changes in a run, and the number of its step
PLACES = 8  # evenly over the plate's cycle, more than a period apart
PART = 16  # of a period: how far each variant goes from each place
WARM_STEPS = 32  # steps before, that bring all into the cache
ROUNDS = {True: 150, False: 800}  # quick or not
PRICE_SETTLE = {True: 10, False: 50}  # periods
DRIFT_SEEDS, DRIFT_PERIODS = {True: 8, False: 16}, {True: 100, False: 300}  # of the drift


def rows() -> dict[str, Effect]:
    """Effects by name, each a row of the figure."""
    return {name: effect for group in GROUPS.values() for name, effect in group.items()}


def _ready(variant: Variant) -> tuple[Engine, Series | None]:
    """Engine of a variant, and arrays for the means that a run samples, if it has the series."""
    engine, sampled = variant.engine(), "series" in variant.diagnostics
    return engine, engine.series(PRICE_SETTLE[False] + 2 * PLACES) if sampled else None


def _settled(settle: int) -> tuple[list[Place], list[Place]]:
    """Places of the full scene after `settle` periods, and the same in the frame of the plate."""
    engine, moving, still = FULL.engine(), [], []
    onward(engine, settle * engine.per)
    for _ in range(PLACES):
        onward(engine, engine.per + engine.per // PLACES)
        arrays = deepcopy(engine.arrays())
        motion, now = engine.plate, engine.step % engine.per
        moving.append((arrays, engine.step))
        seen = deepcopy(arrays)
        for name in ("rods", "listed.built"):
            seen[name][:, Z] -= motion.height[now]
        seen["rods"][:, C_Z] -= motion.velocity[now]
        still.append((seen, engine.step))
    return moving, still


def _call(engine: Engine, series: Series | None, places: list[Place]) -> Sampler:
    """Time of a step of a rod, mean over the places; the call and the restart do not count."""
    steps = engine.per // PART

    def sample() -> float:
        seconds = 0.0
        for place in places:
            engine.restore(*place)
            engine.go(WARM_STEPS, series)
            begin = perf_counter()
            engine.go(0, series)
            between = perf_counter()
            engine.go(steps, series)
            seconds += perf_counter() - between - (between - begin)
        return seconds / (steps * len(engine.rods) * len(places))

    sample()  # compiles
    return sample


def _kernel(engine: Engine, series: Series | None) -> tuple:
    """What decides which kernel runs: the types of all that it takes."""
    watchers = engine.watchers._replace(series=series)
    return tuple(map(numba.typeof, (engine.effects, engine.state, watchers)))


def sweeps(quick: bool = False) -> dict[int, Sweep]:
    """Sweeps over seeds: of the full scene, 0, and by its row of each whose drift is asked for."""
    wanted = {0: FULL}
    wanted |= {i: effect.changed for i, effect in enumerate(rows().values(), 1) if effect.drifts}
    how = [starts(DRIFT_SEEDS[quick])], DRIFT_PERIODS[quick], {"step.size": STEP_SIZE}
    return {i: planned(*how, put(SIMPLE_ROW, one.changes)) for i, one in wanted.items()}


def _drifts(quick: bool) -> np.ndarray:
    """Drift and its standard error in cm/s: of the full scene, then of each changed one."""
    found = np.full((2, 1 + len(rows())), np.nan)
    for i, sweep in waited(sweeps(quick).items(), "drift", "scene"):
        mean_and_error = over_seeds(gathered(sweep, "c_x")[0])
        found[:, i] = np.multiply(mean_and_error, sweep.points[0].scene.cm_per_s)
    return found


def data(quick: bool = False) -> Data:
    """Prices in ns per step of a rod, (value, error, interquartile range) of each row."""
    here, effects = measured_here(), rows().values()
    every = variants(effects)
    moving, still = _settled(PRICE_SETTLE[quick])
    couples = [*map(_ready, every)]
    calls = [
        _call(engine, series, moving if engine.scene.vibrates else still)
        for engine, series in waited(couples, "compiling")
    ]
    times = 1e9 * steady(in_turn(calls, ROUNDS[quick]))

    def price(*pair: Variant) -> tuple[float, ...]:
        """Price of the first variant less the second, in ns, with its error and spread."""
        dear, cheap = (times[..., every.index(one)] for one in pair)
        return estimate(dear - cheap)

    def alike(effect: Effect, what: Callable) -> bool:
        """Whether `what` gives the same for both variants within the full scene."""
        first, second = (couples[every.index(one)] for one in effect.within)
        return what(*first) == what(*second)

    def after(engine: Engine, series: Series | None) -> bytes:
        """Bytes of the rods some way on from the first place."""
        engine.restore(*moving[0])
        engine.go(engine.per // PART, series)
        return engine.rods.tobytes()

    return {
        "alone": np.array([price(*effect.alone) for effect in effects]),
        "within": np.array([price(*effect.within) for effect in effects]),
        "full": np.array(estimate(times[..., every.index(FULL)])),
        "bare": np.array(estimate(times[..., every.index(BARE)])),
        "drift": _drifts(quick),
        "same_rods": np.array([alike(effect, after) for effect in effects], float),
        "same_kernel": np.array([alike(effect, _kernel) for effect in effects], float),
        **here,
    }


def plus_minus(value: float, error: float) -> str:
    """A value and its error as text, both in hundredths, the error rounded up."""
    return f"{round(value, 2) + 0.0:.2f} ± {ceil(100 * error) / 100:.2f}"


def changes(d: Data) -> list[str]:
    """What happens to the drift, row by row, in words or in cm/s."""
    (full, *changed), (error, *errors) = d["drift"]
    words = []
    for i, name in enumerate(rows()):
        if np.isfinite(changed[i]):
            words.append(f"{changed[i] - full:+.2f} ± {np.hypot(error, errors[i]):.2f}")
        elif name in GROUPS["off"]:
            words.append("same kernel" if d["same_kernel"][i] else "another kernel")
        else:
            words.append("0, same bits" if d["same_rods"][i] else "-")
    return words


_LOOKS = (
    (-0.2, "alone", ORANGE, "alone, on the barest scene"),
    (0.2, "within", BLUE, "in the full scene"),
)


def panel(ax: Axes, d: Data) -> None:
    """Bars of both prices with their errors, and what becomes of the drift at the right."""
    sizes = [len(group) for group in GROUPS.values()]
    y = np.arange(sum(sizes)) + 0.6 * np.repeat(range(len(sizes)), sizes)  # groups apart
    price, error, _ = np.concatenate([d["alone"], d["within"]]).T
    longest = max((price + error).max(), 0.1)
    lowest = min((price - error).min(), -0.05 * longest)
    for side, key, colour, label in _LOOKS:
        value, error, _ = d[key].T
        look = {"color": colour, "label": label, "error_kw": {"elinewidth": 0.7}}
        ax.barh(y + side, value, 0.38, xerr=error, **look)
        for at, one, off in zip(y + side, value, error, strict=True):
            start = max(one, 0) + off + 0.01 * longest
            words = plus_minus(one, off).replace("-", "−")
            ax.text(start, at, words, va="center", color="0.25")
    beside = {"va": "center", "transform": ax.get_yaxis_transform()}
    for at, words in zip(y, changes(d), strict=True):
        ax.text(1.02, at, words.replace("-", "−"), **beside)
    words = f"change of $c_x$ from\n{d['drift'][0, 0]:.2f} ± {d['drift'][1, 0]:.2f} cm/s"
    ax.text(1.02, y[0] - 1.3, words, **beside)
    ax.axvline(0, color="black", lw=0.6)
    ax.set(
        xlabel="price (ns per step of a rod)",
        xlim=(1.1 * lowest, 1.45 * longest),
        ylim=(y[-1] + 0.7, -0.7),
    )
    names = [f"{name}{' instead' if name in GROUPS['instead'] else ''}" for name in rows()]
    ax.set_yticks(y, names)
    ax.tick_params(axis="y", length=0)
    ax.tick_params(axis="x", top=False)
    full = d["full"][0]
    scales = (lambda x: 100 * x / full), (lambda x: x * full / 100)
    share = ax.secondary_xaxis("top", functions=scales)
    share.set_xlabel(f"share (%) of the full scene, {full:.1f} ns per step of a rod")
    ax.legend(loc="lower right")


@style
def draw(d: Data) -> Figure:
    figure, ax = plt.subplots(figsize=(7.0, 7.0))
    panel(ax, d)
    words = "errors of the median; drift −: no row is left without it"
    note(figure, f"{words}; {machine_line(d)}")
    return figure
