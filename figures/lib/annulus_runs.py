"""Rods in the annulus for several figures: scenes along axes, and how rods are arranged in the gap.

The scene is `md/scenes/annulus.toml`, the experiment's annulus and rods; what the paper does not
say is assumed there. The number of rods sets the tilt. Runs share the store of the plane rows.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from md.scene import from_tables, read_tables
from md.sweep import Sweep

from . import row_runs as rows

BASE = read_tables("annulus")
SCENE = from_tables(BASE)
GAMMA, FRICTION = SCENE.plate.acceleration, SCENE.contacts.plate.friction
COUNT = SCENE.rods.count  # of Fig. 5(b), and of all that is not over the number of rods
LAW_NAME = "constant_restitution 0.65, tangential ratio 3 (assumed)"
SAID = (
    rf"experiment's annulus, $l={SCENE.rods.length:g}\,d$, $d=0.635$ cm, solid inertia, 60 Hz; "
    f"{LAW_NAME};\n"
    rf"friction of plate, walls and rods {FRICTION} (assumed), where it is not varied"
)


def planned(
    axes: list[dict[str, list]], periods: int, changes: Mapping[str, Any] | None = None
) -> Sweep:
    """The annulus along axes, seeds last; nothing is run."""
    return rows.planned(axes, periods, changes, BASE)


def plane(tilt_deg: list[float], periods: int, seeds: dict[str, list]) -> Sweep:
    """Plane rows of the annulus's rods, without walls, at these tilts."""
    same = {f"rods.{name}": BASE["rods"][name] for name in ("length", "inertia", "diameter_cm")}
    return rows.planned([{"box.length": rows.boxes(np.array(tilt_deg))}, seeds], periods, same)


def measured(sweep: Sweep, prefix: str) -> dict[str, np.ndarray]:
    """Drift [cm/s] and tilt [deg] of a sweep, with errors: between runs or within, the larger."""
    names = ("c_x_cm_s", "c_x_stderr", "tilt_deg", "tilt_stderr_deg")
    c_x, c_x_in, tilt, tilt_in = rows.computed(sweep).gather(rows.store(), *names)
    found, per = {}, sweep.points[0].scene.cm_per_s
    for name, values, inside in (("c_x", c_x, c_x_in * per), ("tilt", tilt, tilt_in)):
        found[f"{prefix}_{name}"], found[f"{prefix}_{name}_error"] = rows.measured_error(
            values, inside
        )
    return found


def in_order(rods: np.ndarray) -> np.ndarray:
    """The rods of a final state by azimuth; columns: centre, director and what follows."""
    return rods[np.argsort(np.arctan2(rods[:, 1], rods[:, 0]))]


def tilts_deg(rods: np.ndarray) -> np.ndarray:
    """Angle of each rod with the vertical, in degrees."""
    return np.degrees(np.arctan2(np.hypot(rods[:, 3], rods[:, 4]), np.abs(rods[:, 5])))


def zigzag(rods: np.ndarray) -> float:
    """Order of the zig-zag: 1 if rods stand by turns at either wall, about 0 if at random.

    Minus the correlation of neighbours' distances from the axis, in order of azimuth.
    """
    radius = np.hypot(*in_order(rods)[:, :2].T)
    off = radius - radius.mean()
    return float(-(off * np.roll(off, 1)).mean() / max((off**2).mean(), 1e-300))


def contrast(tilt: np.ndarray) -> float:
    """How much more the steepest place around the ring leans than the least, in the unit of `tilt`.

    Tilts are smoothed over three rods, so that the difference between rods at the inner and the
    outer wall, which stand by turns and lean differently, drops out.
    """
    return float(np.ptp(tilt / 2 + (np.roll(tilt, 1) + np.roll(tilt, -1)) / 4))
