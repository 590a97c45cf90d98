"""Bias of the drift by the step: measured, and kept in `calibration.json`, or for one scene.

Rows are drawn evenly from ranges (`PARAMETERS`) and run at several steps; annuli
(`OF_ANNULUS`) tell the size of the bias alone, whose order is that of rows. The calibration's
`code` says for which sources it was measured. After an edit that keeps the bits of all runs, set
both by hand to what `md.sources.digest(annulus=...)` gives; after any other edit, measure again
(`python -m md calibrate`).

A scene of your own, for `md.run(scene, tolerance=..., calibration=...)`:

>>> import md
>>> scene = md.load("my_rods", ["rods.count=10", "box.length_cm=7.5"])
>>> found = md.calibration.of_scene(scene, "mine.db", periods=400)
>>> md.calibration.write("mine.json", found)
"""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.stats import qmc

from . import simulation
from .accuracy import FIRST_LOOK, interval, slower
from .bias import (
    CONTACT_TIME,
    FREEDOM,
    laws,
    lengths_of,
    own_tables,
    properties,
    steps_per_contact,
)
from .domains import whole
from .errors import RunError
from .files import replacing
from .scene import Scene, Step, both, from_tables, put, read_tables
from .search import Parameter
from .sources import digest
from .statistics import transient
from .sweep import Measure, Point, Sweep, execute

STEPS = 16, 24, 64  # a contact
PERIODS = 2000  # from each start
SEEDS = 1, 2
SCENES = 64  # a power of two
ANNULI = 8  # a power of two, besides the one that ships
ANNULUS_PERIODS = 1500
OWN_PERIODS = 6000  # from each start, of a scene of the user
OWN_ORDER = 2.0, 0.7  # of the bias of such a scene, and its error: from that of scatter to rows'
CLEAR = 10  # standard errors from which on a drift tells a bias
SAME = 0.75  # part of the usual drift below which it is that of another state
FLAT = 1e9  # of a ratio or an angle: the bias does not depend on it
PARTS = "plate", "rods"
_COULOMB = {"contacts.plate.law": "coulomb"}
_COULOMB |= dict.fromkeys(
    (f"contacts.plate.tangential_{name}" for name in ("ratio", "damping")), "none"
)


def _of_each(name: str, low: float, high: float, log: bool = False) -> list[Parameter]:
    """An option of the contacts of plate and rods, each by itself."""
    keys = {part: f"contacts.{part}.{name.replace(' ', '_')}" for part in PARTS}
    return [Parameter(f"{name} of {p}", (key,), low, high, log) for p, key in keys.items()]


PARAMETERS = (
    Parameter("law", ("law",), 0, 1),  # the last quarter: friction of the plate as a constraint
    Parameter("tilt_deg", ("tilt_deg",), 15, 50),
    Parameter("plate.acceleration", ("plate.acceleration",), 1.8, 5),
    Parameter("rods.length", ("rods.length",), 5, 10),
    Parameter("stiffness", tuple(both(stiffness=0)), 1e6, 2e7, True),
    *_of_each("friction", 0.1, 0.6),
    *_of_each("restitution", 0.5, 0.95),
    *_of_each("tangential ratio", 0.5, 30, True),
    *_of_each("tangential damping", 0, 1),
)


OF_ANNULUS = (
    Parameter("rods.count", ("rods.count",), 32, 56, integer=True),
    Parameter("plate.acceleration", ("plate.acceleration",), 2, 5),
    *(
        Parameter(f"{name} of {p}", keys, low, high, log)
        for p, parts in (("plate", ("plate", "wall")), ("rods", ("rods",)))
        for name, low, high, log in (
            ("friction", 0.1, 0.6, False),
            ("restitution", 0.65, 0.9, False),
            ("tangential ratio", 0.5, 10, True),
            ("tangential damping", 0, 0.5, False),
        )
        if (keys := tuple(f"contacts.{part}.{name.replace(' ', '_')}" for part in parts))
    ),
)


def annulus_of(parts: np.ndarray) -> dict:
    """Tables of an annulus at these parts of the ranges; walls are like the plate."""
    changes = {k: p.value(x) for p, x in zip(OF_ANNULUS, parts, strict=True) for k in p.keys}
    return put(read_tables("annulus"), {"step": "none", **changes})


def tables_of(parts: np.ndarray) -> dict:
    """Tables of the scene at these parts of the ranges, with its own stiffness and no step."""
    changes: dict[str, Any] = {
        key: p.value(x) for p, x in zip(PARAMETERS, parts, strict=True) for key in p.keys
    }
    base = put(read_tables("quasi2d"), {"step": "none", "start.speed": 0.3})
    tilt = np.radians(changes.pop("tilt_deg"))
    changes["box.length"] = base["rods"]["count"] / np.cos(tilt)
    return put(base, changes | (_COULOMB if changes.pop("law") > 0.75 else {}))


def drawn(count: int = SCENES) -> list[dict]:
    """Tables of the rows, drawn evenly from the ranges."""
    return [tables_of(parts) for parts in qmc.Sobol(len(PARAMETERS), seed=1).random(count)]


def annuli(count: int = ANNULI) -> list[dict]:
    """Tables of annuli: the one that ships, and others drawn evenly from the ranges."""
    drawn_parts = qmc.Sobol(len(OF_ANNULUS), seed=1).random(count)
    return [put(read_tables("annulus"), {"step": "none"}), *map(annulus_of, drawn_parts)]


def settled_drift(scene: Scene, periods: int) -> dict[str, Any]:
    """Drift behind its transient, its standard error, and whether it has settled."""
    run = simulation.run(scene, periods=periods, ledger=False)
    if not run.finished:
        raise KeyboardInterrupt
    found = interval([run.c_x_series], annulus=scene.annulus is not None)
    return {"mean": found.mean, "error": found.error, "settled": found.settled}


def sweep(scenes: Sequence[Scene], periods: int, seeds: Sequence[int] = SEEDS) -> Sweep:
    """Scenes, steps, starts."""
    how = Measure(settled_drift, digest(annulus=True, tolerance=True))
    points = [
        Point(
            replace(scene, step=step, start=replace(scene.start, seed=seed)), periods, measure=how
        )
        for scene in scenes
        for step in (Step(steps_per_contact(scene, 1.0) / n, coarse=True) for n in STEPS)
        for seed in seeds
    ]
    axes = {"scene": [*range(len(scenes))]}, {"per_contact": [*STEPS]}, {"seed": [*seeds]}
    return Sweep(axes, tuple(points))


def drifts(
    planned: Sweep, store: str | Path, progress: bool, *, strict: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """Means over starts, (scenes, steps), and standard errors: from runs or from their scatter.

    Raises
    ------
    RunError
        If a run failed, or, where this is `strict`, did not settle.
    """
    execute(planned, store, progress=progress)
    means, errors, calm = planned.gather(store, "mean", "error", "settled")
    if not np.isfinite(errors).all():
        raise RunError(f"a run failed: `python -m md results {store}` tells why")
    if strict and not calm.all():
        few = planned.points[0].periods
        raise RunError(f"{(calm == 0).sum()} runs of {few} periods did not settle: ask for more")
    starts = means.shape[-1]
    between = means.var(axis=2, ddof=1) if starts > 1 else 0.0
    return means.mean(axis=2), np.sqrt(np.maximum((errors**2).mean(axis=2), between) / starts)


def fitted(
    drift: np.ndarray, error: np.ndarray, tilt_deg: np.ndarray, ratio: np.ndarray
) -> dict[str, float]:
    """Bias of the step, by maximum likelihood.

    Of each scene ln c = ln c_0 + [step l^order + scatter l^scatter_order] exp((tilt - 30)/growth),
    where l = 10 f/n, f^2 is the tangential ratio of the plate over `ratio`, or one, and `scatter`
    is a number of the scene, which follows Student's t, around zero, with the scale `step_scatter`.

    Parameters
    ----------
    drift, error : with standard errors, (scenes, steps)
    tilt_deg, ratio : of the scenes, (scenes,); no tangential spring of the plate: 0
    """
    value, noise, n = np.log(np.abs(drift)), error / np.abs(drift), np.array(STEPS, float)
    off = value - value.mean(axis=1, keepdims=True)
    free = np.ones((len(n), len(n)))  # variance of ln c_0: it may be anything

    def unlikely(parameters: np.ndarray) -> float:
        order, scatter_order, step, scatter, ratio_0, growth = parameters
        stiff = np.sqrt(np.maximum(ratio / np.exp(ratio_0), 1))
        length = 10 * stiff[:, None] / n
        grown = np.exp(growth * (tilt_deg[:, None] - 30))
        spread = np.exp(scatter) * length**scatter_order * grown
        cover = spread[:, :, None] * spread[:, None] + free
        cover[:, range(len(n)), range(len(n))] += noise**2
        rest = off - step * length**order * grown
        far = np.einsum("ij,ij->i", rest, np.linalg.solve(cover, rest[:, :, None])[..., 0])
        tails = (FREEDOM + len(n) - 1) * np.log1p(far / FREEDOM)
        return float((tails + np.linalg.slogdet(cover)[1]).sum())

    starts = (np.array([order, 1.5, -0.04, -3.5, 2.0, 0.04]) for order in (2.0, 3.0, 4.0))
    how = {"maxfev": 8000, "xatol": 1e-6, "fatol": 1e-6}
    bounds = (1, 6), (0.3, 6), (-2, 2), (-9, 1), (-1, 5), (1e-3, 0.3)
    fits = (minimize(unlikely, x, method="Nelder-Mead", bounds=bounds, options=how) for x in starts)
    found = min(fits, key=lambda one: one.fun)
    h = np.diag([0.1, 0.1, 3e-3, 0.1, 0.1, 3e-3])
    bend = [[unlikely(found.x + a + b) - unlikely(found.x + a - b) for b in h] for a in h]
    back = [[unlikely(found.x - a + b) - unlikely(found.x - a - b) for b in h] for a in h]
    variance = 8 * h[0, 0] ** 2 * np.linalg.pinv(np.subtract(bend, back))[0, 0]
    order, scatter_order, step, scatter, ratio_0, growth = map(float, found.x)
    return {
        "order": order,
        "order_error": float(np.sqrt(variance)) if variance > 0 else 1.0,
        "scatter_order": scatter_order,
        "step": step,
        "step_scatter": float(np.exp(scatter)),
        "step_error": float(np.exp(scatter) * np.sqrt(1 + 1 / len(drift))),
        "ratio": float(np.exp(ratio_0)),
        "growth_deg": 1 / growth,
    }


def described(scenes: list[Scene]) -> tuple[np.ndarray, np.ndarray]:
    """Tilts [deg] of scenes, and the tangential ratios of their plates; without a spring: 0."""
    numbers = [properties(scene) for scene in scenes]
    ratio = [one.get("tangential ratio of plate", 0.0) for one in numbers]
    return np.array([one["tilt_deg"] for one in numbers]), np.array(ratio)


def in_one_state(drift: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Drifts that can be told from none and are not those of another state, (scenes, steps).

    Rods of an annulus may lean either way and hardly drift, or come to do so in one run of three.
    """
    usual = np.median(np.abs(drift), axis=1, keepdims=True)
    return np.abs(drift) > np.maximum(CLEAR * error, SAME * usual)


def size_alone(
    drift: np.ndarray, error: np.ndarray, shape: np.ndarray
) -> tuple[float, float, float]:
    """Mean of `step`, its scatter from scene to scene and the error for one more, for known shapes.

    Of each scene ln c = ln c_0 + step shape, by weighted least squares; scenes scatter as in
    DerSimonian and Laird (1986).

    Parameters
    ----------
    drift, error, shape : (scenes, steps)
    """
    weight = np.where(in_one_state(drift, error), (drift / error) ** 2, 0.0)
    told = (weight > 0).sum(axis=1) > 1
    weight, shape, drift = weight[told], shape[told], drift[told]
    off = shape - (weight * shape).sum(axis=1, keepdims=True) / weight.sum(axis=1, keepdims=True)
    weight = weight * off
    variance = 1 / (weight * off).sum(axis=1)
    step = (weight * np.log(np.abs(drift))).sum(axis=1) * variance
    part = 1 / variance
    excess = (part * (step - (part @ step) / part.sum()) ** 2).sum() - len(step) + 1
    scatter = max(excess, 0.0) / max(part.sum() - (part @ part) / part.sum(), 1e-300)
    part = 1 / (variance + scatter)
    return float(part @ step / part.sum()), scatter**0.5, float((scatter + 1 / part.sum()) ** 0.5)


def _size(drift: np.ndarray, error: np.ndarray, scenes: list[Scene], known: dict) -> dict[str, Any]:
    """What the calibration of annuli or of one scene has in place of that of rows."""
    lengths = (lengths_of(scene, np.array(STEPS, float), known) for scene in scenes)
    shape = np.array([grown * length ** known["order"] for length, grown in lengths])
    step, scatter, of_one = size_alone(drift, error, shape)
    same = (10 / STEPS[0]) ** (known["order"] - known["scatter_order"])  # at the longest step
    found = {"step": step, "step_scatter": same * scatter, "step_error": same * of_one}
    return found | {"growth_deg": FLAT, "drift": drift.tolist(), "drift_error": error.tolist()}


def _noise(drift: np.ndarray, error: np.ndarray, kept: int) -> float:
    """Standard error of a drift over it, times the root of the periods, typically."""
    some = in_one_state(drift, error)
    return float(np.exp(np.median(np.log((error / np.abs(drift))[some] * np.sqrt(kept)))))


def of_annuli(
    store: str | Path,
    rows: dict[str, Any],
    *,
    count: int = ANNULI,
    periods: int = ANNULUS_PERIODS,
    progress: bool = False,
) -> dict[str, Any]:
    """Measure the size of the bias in annuli, of one start each; its orders are those of rows."""
    scenes = [from_tables(tables) for tables in annuli(count)]
    drift, error = drifts(sweep(scenes, periods, SEEDS[:1]), store, progress)
    found = [properties(scene) for scene in scenes]
    ends = {name: [f(one[name] for one in found) for f in (min, max)] for name in found[0]}
    ends |= {
        p.name: [min(ends[p.name][0], p.low), max(ends[p.name][1], p.high)] for p in OF_ANNULUS
    }
    del ends["tilt_deg"]  # at the start alone
    return _size(drift, error, scenes, rows | {"growth_deg": FLAT}) | {
        "noise": _noise(drift, error, periods - transient(periods)),
        "ranges": ends,
        "laws": sorted({laws(scene) for scene in scenes}),
        "code": digest(annulus=True),
    }


def _own_sweep(scene: Scene, periods: int) -> Sweep:
    """Steps and starts of one scene."""
    fewest = FIRST_LOOK * slower(scene.annulus is not None)
    return sweep([scene], whole("periods", periods, fewest, simulation.MOST_PERIODS))


def of_scene(
    scene: Scene, store: str | Path, *, periods: int = OWN_PERIODS, progress: bool = False
) -> dict[str, Any]:
    """Measure the bias of the drift of one scene; runs that the store holds are not repeated.

    Parameters
    ----------
    scene : Scene; its step and seed do not matter
    store : path of the store
    periods : of each run, of two starts at three steps
    progress : whether to show a progress bar

    Returns
    -------
    What `write` makes the file of that `md.run` takes as `calibration`.

    Raises
    ------
    RunError
        If a run fails or does not settle, or the drift cannot be told from none.
    """
    order, order_error = OWN_ORDER
    known = {"order": order, "order_error": order_error, "scatter_order": order}
    known |= {"ratio": FLAT, "growth_deg": FLAT}
    drift, error = drifts(_own_sweep(scene, periods), store, progress, strict=True)
    if not in_one_state(drift, error).all():
        raise RunError(
            f"the drift is too small to calibrate: {drift[0, -1]:.2g} +- {error[0, -1]:.1g}"
        )
    return {
        **known,
        **_size(drift, error, [scene], known),
        "noise": _noise(drift, error, (periods - transient(periods)) * len(SEEDS)),
        "fewest": STEPS[0],
        "ranges": {},
        "laws": [laws(scene)],
        "steps": [*STEPS],
        "scene": own_tables(scene),
        "code": digest(annulus=scene.annulus is not None),
    }


def seconds_of(scene: Scene, periods: int = OWN_PERIODS) -> float:
    """Processor seconds that `of_scene` takes; a short run is timed."""
    first, *_ = _own_sweep(scene, periods).points
    simulation.run(first.scene, periods=1, ledger=False)  # compiles
    timed = simulation.run(first.scene, periods=20, ledger=False)
    return timed.run_seconds / 20 * periods * len(SEEDS) * sum(STEPS) / STEPS[0]


def write(path: str | Path, found: dict[str, Any]) -> None:
    """Write what was measured to a file for `--calibration`."""
    with replacing(Path(path)) as part:
        part.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def calibrate(
    store: str | Path, *, count: int = SCENES, periods: int = PERIODS, progress: bool = False
) -> dict:
    """Measure the bias of the drift; runs that the store holds are not repeated.

    Parameters
    ----------
    store : path of the store
    count : scenes, a power of two
    periods : of each run
    progress : whether to show a progress bar

    Returns
    -------
    Content of `calibration.json`: the bias, the drifts behind it, the ranges of the scenes;
    `noise`: standard error of a drift over it, times the root of the periods, typically.
    """
    made = [from_tables(tables) for tables in drawn(count)]
    drift, error = drifts(sweep(made, periods), store, progress)
    ends = {p.name: [p.low, p.high] for p in PARAMETERS if p.name not in ("law", "stiffness")}
    times = [properties(scene)[CONTACT_TIME] for scene in made]
    found = fitted(drift, error, *described(made))
    return {
        **found,
        "noise": _noise(drift, error, (periods - transient(periods)) * len(SEEDS)),
        "fewest": STEPS[0],
        "ranges": {**ends, CONTACT_TIME: [min(times), max(times)]},
        "laws": sorted({laws(scene) for scene in made}),
        "steps": [*STEPS],
        "drift": drift.tolist(),
        "drift_error": error.tolist(),
        "code": digest(),
        "annulus": of_annuli(store, found, progress=progress),
    }
