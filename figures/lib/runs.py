"""Rows of rods for several figures: the paper's plane scenes, along axes, from one store.

What is in the store, the file `STORE`, is not computed again, whichever figure asked for it first;
an interrupted figure goes on where it stopped. Tilts are set by the length of the box,
L = N d/cos(tilt).

As in the paper, rods have the inertia of a thin rod unless a figure says otherwise, and thickness.

The rods start with random velocities up to about V_0. Side by side and at rest, they may go on as
one block, whose rods cannot turn and hardly drift (Fig. 13(c)).
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from impact import ContactGeometry, spherocylinder
from md.scene import from_tables, put, read_tables
from md.sweep import Sweep, execute, expand

if TYPE_CHECKING:
    from impact.bouncing import Bouncing

COUNT, LENGTH, GAMMA, FRICTION, RESTITUTION = 40, 9.5, 3.3, 0.3, 0.65  # of Figs. 6-8 and 13
ROW = put(
    read_tables("quasi2d"),
    {
        "step.size": 1.2e-4,  # a fiftieth of a contact; its springs may be stiffer
        "step.coarse": True,
        "start.speed": 0.3,
        "contacts.plate.tangential_ratio": 3,
        "contacts.rods.tangential_ratio": 3,
    },
)
LAW_NAME = "constant_restitution 0.65, tangential ratio 3"
OF_TILT_SCAN = (
    rf"$l={LENGTH}\,d$, thin inertia, $\Gamma={GAMMA}$, $\mu={FRICTION}$, 60 Hz; {LAW_NAME}"
)


STORE = Path("out/rows.db")  # of all runs; what `--store` of the commands sets


def store() -> Path:
    """Path of the store of all runs; its folder is made."""
    STORE.parent.mkdir(parents=True, exist_ok=True)
    return STORE


def boxes(tilt_deg: np.ndarray, count: int = COUNT) -> list[float]:
    """Lengths of the box that give these tilts."""
    return (count / np.cos(np.radians(tilt_deg))).tolist()


def planned(
    axes: list[dict[str, list]],
    periods: int,
    changes: Mapping[str, Any] | None = None,
    base: Mapping[str, Any] = ROW,
) -> Sweep:
    """The row, or another scene, along axes, seeds last; nothing is run."""
    return expand({"periods": periods, "axes": axes, "set": dict(changes or {})}, base)


def computed(sweep: Sweep) -> Sweep:
    """The same sweep, run as far as the store does not hold it."""
    execute(sweep, store(), progress=True)
    return sweep


SEEDS = {"start.seed": [1, 2, 3, 4]}
SHOWN_DEG = (9, 18, 27, 34, 45)  # tilts of Fig. 8; of any scan


def periods_of(quick: bool) -> int:
    """Length of the runs of one figure."""
    return 60 if quick else 300


def tilts(quick: bool) -> np.ndarray:
    """Nominal tilts [deg] of Figs. 6 to 8 and 13(a)."""
    return np.array([*SHOWN_DEG, 60, 75] if quick else sorted({*range(3, 79, 3), *SHOWN_DEG}))


def tilt_plan(quick: bool) -> Sweep:
    """The row at Gamma = 3.3 along these tilts."""
    return planned([{"box.length": boxes(tilts(quick))}, SEEDS], periods_of(quick))


def tilt_scan(quick: bool) -> tuple[np.ndarray, Sweep]:
    """Both, computed."""
    return tilts(quick), computed(tilt_plan(quick))


def paper_rod(tilt: float | np.ndarray) -> ContactGeometry:
    """Round tip, and the gyration radius of a thin rod; tilt in radians."""
    return spherocylinder(tilt, LENGTH)._replace(k=LENGTH / np.sqrt(12))


@cache
def lone(quick: bool) -> tuple[np.ndarray, list["Bouncing"]]:
    """Tilts [deg], and `bounce` there: one rigid rod at fixed tilt, the theory without closure."""
    from impact.bouncing import bounce  # compiles

    tilt_deg = np.arange(0, 76, 5 if quick else 2.5)
    rods, landings = (20, 150) if quick else (100, 600)
    return tilt_deg, [
        bounce(
            paper_rod(np.radians(deg)),
            gamma=GAMMA,
            friction=FRICTION,
            restitution=RESTITUTION,
            landings=landings,
            rods=rods,
            transient=150,
            shortest_flight=0.1,
        )
        for deg in tilt_deg
    ]


def means(sweep: Sweep, names: Mapping[str, str]) -> dict[str, np.ndarray]:
    """Means over seeds of results of the store, with `name_error` beside them."""
    found = {}
    for name, values in zip(names, sweep.gather(store(), *names.values()), strict=True):
        found[name], found[f"{name}_error"] = over_seeds(values)
    return found


def over_seeds(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard error over the seeds, the last axis; nan where runs are missing."""
    found = np.isfinite(values).sum(axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.nansum(values, axis=-1) / found
        off = np.nansum((values - mean[..., None]) ** 2, axis=-1)
        return mean, np.sqrt(off / (found - 1) / found)


def measured_error(drifts: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean over seeds; the larger of the errors between the runs and, where known, within them."""
    mean, between = over_seeds(drifts)
    squares, _ = over_seeds(errors**2)
    return mean, np.fmax(between, np.sqrt(squares / drifts.shape[-1]))


def plate_speed_cm_s(gamma: float | np.ndarray = GAMMA) -> float | np.ndarray:
    """V_0 of the paper's plate."""
    scene = from_tables(ROW)
    return scene.plate_speed * scene.cm_per_s * np.asarray(gamma) / ROW["plate"]["acceleration"]
