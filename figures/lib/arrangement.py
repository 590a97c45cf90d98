"""How rods are arranged among each other, in the gap of an annulus followed over a run."""

from typing import Any

import numpy as np

from md.scene import Scene
from md.simulation import Run

MORE_DEG = 3.0  # beyond the mean tilt: rods that `share` counts
EVERY = 5  # periods from one look to the next
MEASURED = ("mean", "spread", "zigzag", "contrast", "share")


def in_order(rods: np.ndarray) -> np.ndarray:
    """The rods of a final state by azimuth; columns: centre, director and what follows."""
    return rods[np.argsort(np.arctan2(rods[:, 1], rods[:, 0]))]


def tilts_deg(rods: np.ndarray) -> np.ndarray:
    """Angle of each rod with the vertical, in degrees."""
    return np.degrees(np.arctan2(np.hypot(rods[:, 3], rods[:, 4]), np.abs(rods[:, 5])))


def departures(values: np.ndarray) -> tuple[float, float]:
    """Spread of values around their mean, and correlation of neighbours.

    Parameters
    ----------
    values : (..., rods), rods in the order in which they stand; the last is beside the first
    """
    off = values - values.mean(axis=-1, keepdims=True)
    square = (off**2).mean()
    together = (off * np.roll(off, 1, axis=-1)).mean()
    return np.sqrt(square), together / max(square, 1e-300)


def zigzag(rods: np.ndarray) -> float:
    """Order of the zig-zag: 1 if rods stand by turns at either wall, about 0 if at random.

    Minus the correlation of neighbours' distances from the axis, in order of azimuth.
    """
    _, together = departures(np.hypot(*in_order(rods)[:, :2].T))
    return -together


def contrast(tilt: np.ndarray) -> float:
    """How much more the steepest place around the annulus leans than the least, unit of `tilt`.

    Tilts are smoothed over three rods, so that the difference between rods at the inner and the
    outer wall, which stand by turns and lean differently, drops out.
    """
    return np.ptp(tilt / 2 + (np.roll(tilt, 1) + np.roll(tilt, -1)) / 4)


def arrangement(rods: np.ndarray) -> tuple[float, ...]:
    """Measures that `MEASURED` names, of one state: tilts in degrees, orders and a share."""
    tilt = tilts_deg(in_order(rods))
    share = np.mean(tilt > tilt.mean() + MORE_DEG)
    return tilt.mean(), tilt.std(), zigzag(rods), contrast(tilt), share


def followed(scene: Scene, periods: int) -> dict[str, Any]:
    """Drift, tilt, arrangement every few periods, final state; a measure for `runs.planned`.

    Drift and tilt are those of `md.run`.
    """
    seen = []
    with Run(scene, periods) as running:
        for period in range(EVERY, periods + EVERY, EVERY):
            running.march(min(period, periods), lambda: False)
            seen.append(arrangement(running.engine.rods))
        found = running.result(finished=True)
    names = "c_x_cm_s", "c_x_stderr_cm_s", "tilt_deg", "tilt_stderr_deg"
    of_run = {name: getattr(found, name) for name in names}
    return of_run | {"series": seen, "rods": found.rods[:, :6].tolist()}
