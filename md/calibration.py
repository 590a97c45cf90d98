"""Bias of the drift by the step: measured, fitted, and kept in `calibration.json`.

Its `code` says for which sources it was measured. After an edit that keeps the bits of all runs,
set it by hand to what `md.sources.digest()` gives; after any other edit, measure again
(`python -m md calibrate`).
"""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from .accuracy import described, steps_per_contact
from .scene import Scene, Step, both, from_tables, put, read_tables
from .sources import digest
from .sweep import Point, Sweep, execute

STEPS = 16, 20, 26, 40, 80  # a contact; the last one is next to free of bias
_SEEDS, _PERIODS = (1, 2, 3, 4), 1500


SCENES: dict[str, dict[str, Any]] = {  # changes of the row
    "tangential ratio 30": {},
    "tangential ratio 3": both(tangential_ratio=3),
    "Gamma 1.8": {"plate.acceleration": 1.8},
    "Gamma 5": {"plate.acceleration": 5},
    "tilt 17": {"box.length": 41.8},
    "tilt 30": {"box.length": 46.2},
    "tilt 40": {"box.length": 52.2},
    "tilt 48": {"box.length": 60},
    "restitution 0.5": both(restitution=0.5),
    "restitution 0.9": both(restitution=0.9),
    "friction 0.1": both(friction=0.1),
    "friction 0.6": both(friction=0.6),
    "length 5": {"rods.length": 5},
    "length 10": {"rods.length": 10},
    "stiffness 5e5": both(stiffness=5e5),
    "Coulomb on the plate": {"contacts.plate.law": "coulomb"},
}


def _calibrated(changes: Mapping[str, Any]) -> Scene:
    common = {"step": "none", "start.speed": 0.3}
    return from_tables(put(read_tables("quasi2d"), {**common, **changes}))


def calibration_sweep(periods: int = _PERIODS) -> Sweep:
    """The scenes at all steps, from several starts."""
    points = [
        Point(replace(scene, step=step, start=replace(scene.start, seed=seed)), periods)
        for scene in map(_calibrated, SCENES.values())
        for step in (Step(steps_per_contact(scene, 1.0) / n, coarse=True) for n in STEPS)
        for seed in _SEEDS
    ]
    axes = {"scene": list(SCENES)}, {"per_contact": list(STEPS)}, {"seed": list(_SEEDS)}
    return Sweep(axes, tuple(points))


def fitted(drift: np.ndarray, error: np.ndarray) -> dict[str, Any]:
    """Order and scales of c(n) = c_0 (1 + s (10/n)^order) from drifts (scenes, steps), with errors.

    One order for all scenes, a scale s of each; `chi_squared` is per degree of freedom.
    """
    n, scenes = np.array(STEPS, float), len(drift)

    def misfit(parameters: np.ndarray) -> np.ndarray:
        order, fine, scale = parameters[0], *np.split(parameters[1:], 2)
        curve = fine[:, None] * (1 + scale[:, None] * (10 / n) ** order)
        return ((drift - curve) / error).ravel()

    start = np.concatenate([[3.0], drift[:, -1], np.full(scenes, -0.1)])
    fit = least_squares(misfit, start, x_scale="jac")
    spread = np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))
    scale, scale_error = fit.x[1 + scenes :], spread[1 + scenes :]
    return {
        "order": float(fit.x[0]),
        "order_error": float(spread[0]),
        "scales": scale.tolist(),
        "scale_errors": scale_error.tolist(),
        "scale": float(np.max(np.abs(scale) + 2 * scale_error)),
        "chi_squared": float(np.sum(fit.fun**2) / (fit.fun.size - fit.x.size)),
    }


def is_calibration(path: Path) -> bool:
    """Whether a file holds what `calibrate` gives."""
    try:
        return {"order", "scale", "scenes"} <= set(json.loads(path.read_text(encoding="utf-8")))
    except (TypeError, ValueError):
        return False


def calibrate(store: str | Path, *, periods: int = _PERIODS, progress: bool = False) -> dict:
    """Measure the bias of the drift by the step; runs that the store holds are not repeated.

    Returns
    -------
    Content of `calibration.json`: the fit, the drifts behind it, the ranges of the scenes.
    """
    sweep = calibration_sweep(periods)
    execute(sweep, store, progress=progress)
    drifts, within = sweep.gather(store, "c_x", "c_x_stderr")
    drift, error = drifts.mean(axis=2), np.sqrt((within**2).mean(axis=2) / len(_SEEDS))
    parts = [described(_calibrated(changes)) for changes in SCENES.values()]
    ranges = {}
    for name in (name for name in parts[0] if name != "laws"):
        values = [value for part in parts for value in part[name]]
        ranges[name] = [min(values), max(values)]
    return {
        **fitted(drift, error),
        "fewest": STEPS[0],
        "ranges": ranges,
        "laws": sorted({part["laws"][0] for part in parts}),
        "steps": list(STEPS),
        "scenes": list(SCENES),
        "drift": drift.tolist(),
        "drift_error": error.tolist(),
        "periods": periods * len(_SEEDS),
        "code": digest(),
    }
