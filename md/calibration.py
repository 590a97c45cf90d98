"""Bias of the drift by the step: measured, and kept in `calibration.json`.

Scenes are drawn evenly from ranges (`PARAMETERS`) and run at several steps. The calibration's
`code` says for which sources it was measured. After an edit that keeps the bits of all runs, set it
by hand to what `md.sources.digest()` gives; after any other edit, measure again
(`python -m md calibrate`).
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.stats import qmc

from .bias import CONTACT_TIME, laws, properties, steps_per_contact
from .scene import Scene, Step, both, from_tables, put, read_tables
from .search import Parameter
from .sources import digest
from .statistics import transient
from .sweep import Point, Sweep, execute

STEPS = 16, 20, 32  # a contact
PERIODS = 2000  # from each start
SEEDS = 1, 2
SCENES = 64  # a power of two
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
    """Tables of the scenes, drawn evenly from the ranges."""
    return [tables_of(parts) for parts in qmc.Sobol(len(PARAMETERS), seed=1).random(count)]


def sweep(count: int = SCENES, periods: int = PERIODS) -> Sweep:
    """Scenes, steps, starts."""
    points = [
        Point(replace(scene, step=step, start=replace(scene.start, seed=seed)), periods)
        for scene in map(from_tables, drawn(count))
        for step in (Step(steps_per_contact(scene, 1.0) / n, coarse=True) for n in STEPS)
        for seed in SEEDS
    ]
    axes = {"scene": [*range(count)]}, {"per_contact": [*STEPS]}, {"seed": [*SEEDS]}
    return Sweep(axes, tuple(points))


def fitted(
    drift: np.ndarray, error: np.ndarray, tilt_deg: np.ndarray, ratio: np.ndarray
) -> dict[str, float]:
    """Bias of the step, by maximum likelihood.

    Of each scene ln c = ln c_0 + step (10 f/n)^order exp((tilt - 30)/growth_deg), with f^2 the
    tangential ratio of the plate over `ratio`, or one; `step` scatters from scene to scene around
    its mean.

    Parameters
    ----------
    drift, error : with standard errors, (scenes, steps)
    tilt_deg, ratio : of the scenes, (scenes,); no tangential spring of the plate: 0
    """
    value, noise, n = np.log(np.abs(drift)), error / np.abs(drift), np.array(STEPS, float)
    off = value - value.mean(axis=1, keepdims=True)
    free = np.ones((len(n), len(n)))  # variance of ln c_0: it may be anything

    def unlikely(parameters: np.ndarray) -> float:
        order, step, scatter, ratio_0, growth = parameters
        stiff = np.sqrt(np.maximum(ratio / np.exp(ratio_0), 1))
        shape = (10 * stiff[:, None] / n) ** order * np.exp(growth * (tilt_deg[:, None] - 30))
        spread = np.exp(scatter) * shape
        cover = spread[:, :, None] * spread[:, None] + free
        cover[:, range(len(n)), range(len(n))] += noise**2
        rest = off - step * shape
        far = np.einsum("ij,ij->", rest, np.linalg.solve(cover, rest[:, :, None])[..., 0])
        return float(far + np.linalg.slogdet(cover)[1].sum())

    starts = (np.array([order, -0.05, -3.0, 2.0, 0.05]) for order in (2.0, 3.0, 4.0))
    how = {"maxfev": 5000, "xatol": 1e-6, "fatol": 1e-6}
    bounds = (1, 6), (-2, 2), (-9, 1), (-1, 5), (1e-3, 0.3)
    fits = (minimize(unlikely, x, method="Nelder-Mead", bounds=bounds, options=how) for x in starts)
    found = min(fits, key=lambda one: one.fun)
    h = np.array([0.2, 0, 0, 0, 0])
    bend = (unlikely(found.x + h) - 2 * found.fun + unlikely(found.x - h)) / h[0] ** 2
    order, step, scatter, ratio_0, growth = map(float, found.x)
    return {
        "order": order,
        "order_error": float(np.sqrt(2 / bend)) if bend > 0 else 1.0,
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


def is_calibration(path: Path) -> bool:
    """Whether a file holds what `calibrate` gives."""
    try:
        return {"order", "step", "ranges"} <= set(json.loads(path.read_text(encoding="utf-8")))
    except (TypeError, ValueError):
        return False


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
    whole = sweep(count, periods)
    execute(whole, store, progress=progress)
    drifts, of_run = whole.gather(store, "c_x", "c_x_stderr")
    drift = drifts.mean(axis=2)
    between = drifts.var(axis=2, ddof=1)
    error = np.sqrt(np.maximum((of_run**2).mean(axis=2), between) / len(SEEDS))
    made = [from_tables(tables) for tables in drawn(count)]
    ends = {p.name: [p.low, p.high] for p in PARAMETERS if p.name not in ("law", "stiffness")}
    times = [properties(scene)[CONTACT_TIME] for scene in made]
    kept = (periods - transient(periods)) * len(SEEDS)
    noise = np.log(error / np.abs(drift) * np.sqrt(kept))
    return {
        **fitted(drift, error, *described(made)),
        "noise": float(np.exp(np.median(noise))),
        "fewest": STEPS[0],
        "ranges": {**ends, CONTACT_TIME: [min(times), max(times)]},
        "laws": sorted({laws(scene) for scene in made}),
        "steps": [*STEPS],
        "drift": drift.tolist(),
        "drift_error": error.tolist(),
        "code": digest(),
    }
