"""Rows and annuli for several figures: scenes along axes, run through one store, and their means.

What is in the store, the file `STORE`, is not computed again, whichever figure asked for it first;
an interrupted figure goes on where it stopped.

Rows are the paper's plane scenes; the length of the box sets the tilt, L = N d/cos(tilt). As in the
paper, rods have thickness and the inertia of a thin rod, unless a figure says otherwise. They start
with random velocities up to about V_0: side by side and at rest, they may go on as one block, whose
rods cannot turn and hardly drift (Fig. 13(c)).

Annuli are the experiment's, `md/scenes/annulus.toml`; what the paper does not say is assumed there.
The number of rods sets the tilt.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import numpy as np

from impact import ContactGeometry, InputError, spherocylinder
from md.scene import Scene, from_tables, put, read_tables
from md.store import Store
from md.sweep import Measure, Point, Sweep, execute, expand

from .data import sources_of
from .style import Data

COUNT, LENGTH, GAMMA, FRICTION, RESTITUTION = 40, 9.5, 3.3, 0.3, 0.65  # of Figs. 6-8 and 13
SETTING: Data = {"friction": FRICTION, "restitution": RESTITUTION}  # of the theory
BOX = 43.0  # length of the box where the tilt is not varied
BOX_TILT = np.arccos(COUNT / BOX)  # rad
PARTS = "plate", "rods"
Changes = dict[str, Any]  # of a scene, by its keys
Tables = Mapping[str, Any]  # of a scene


def each(**options: tuple) -> Changes:
    """Changes of a scene that give the contacts of plate and of rods options of their own."""
    return {
        f"contacts.{part}.{name}": values[i]
        for i, part in enumerate(PARTS)
        for name, values in options.items()
    }


def both(**options: Any) -> Changes:
    """Changes of a scene that give the contacts of plate and rods the same options."""
    return each(**{name: (value, value) for name, value in options.items()})


SIMPLE = both(restitution=RESTITUTION, tangential_ratio=3)  # one law for plate and rods
# a 25th of a contact
_STEP_AND_START = {"step.size": 2.4e-4, "step.coarse": True, "start.speed": 0.3}
SIMPLE_ROW = put(read_tables("quasi2d"), _STEP_AND_START | SIMPLE)  # of prices
LAW_OF = {  # plate, rods: of all simulated rows and annuli; chosen once among 320 laws
    "restitution": (0.75, 0.86),
    "tangential_ratio": (7.2, 0.68),
    "tangential_damping": (0.43, 0.28),
}
LAW = each(**LAW_OF)
# another of the best laws; stiffer, so dearer
SECOND = each(restitution=(0.68, 0.89), tangential_ratio=(12, 3.1), tangential_damping=(0.73, 0.89))
RESOLVED = {"step.size": "none", "step.coarse": "none"}  # the step suits the stiffest spring
ROW = put(SIMPLE_ROW, LAW)
LAW_NAME = "plate/rods: " + ", ".join(
    f"{name.replace('_', ' ')} {plate:g}/{rods:g}" for name, (plate, rods) in LAW_OF.items()
)
TILT_SCAN_WORDS = (
    rf"$l={LENGTH}\,d$, thin inertia, $\Gamma={GAMMA}$, $\mu={FRICTION}$, 60 Hz; {LAW_NAME}"
)
_WALLS = {f"contacts.wall.{name}": plate for name, (plate, _) in LAW_OF.items()}
ASSUMED_NAME = "restitution 0.65, tangential ratio 3 of plate, rods and walls"  # before the search
SIMPLE_ANNULUS = read_tables("annulus")  # under that law
ANNULUS = put(SIMPLE_ANNULUS, LAW | _WALLS)  # walls are like the plate
ANNULUS_SCENE = from_tables(ANNULUS)
ANNULUS_COUNT = ANNULUS_SCENE.rods.count  # of Fig. 5(b), and of all that is not over this number
_ANNULUS_WORDS = (
    rf"experiment's annulus, $l={ANNULUS_SCENE.rods.length:g}\,d$, $d=0.635$ cm, solid inertia, "
    f"60 Hz; {LAW_NAME}; friction of plate, walls and rods "
    f"{ANNULUS['contacts']['plate']['friction']} (assumed), where it is not varied"
)


def starts(count: int) -> dict[str, list]:
    """Axis of a sweep: so many independent starts."""
    return {"start.seed": list(range(1, count + 1))}


SEEDS = starts(4)
SHOWN_DEG = (9, 18, 27, 34, 45)  # tilts of Fig. 8; of any scan


PLACES = {"box": "a box", "annulus": "an annulus"}


@dataclass(frozen=True)
class Row:
    """A row or an annulus whose tilt is varied, and what its figures say of it."""

    tables: Tables  # of the scene
    setting: Data  # friction and restitution of the plate, for the theory beside it
    gamma: float  # peak acceleration of the plate, in g
    words: str

    @cached_property
    def scene(self) -> Scene:
        """Scene that the tables describe, before an axis varies it."""
        return from_tables(self.tables)

    def counts(self, papers: Iterable[int]) -> list[int]:
        """Numbers of rods that stand as close in this annulus as `papers` do in the paper's."""
        here, there = (scene.annulus for scene in (self.scene, ANNULUS_SCENE))
        wider = here.middle / there.middle if here and there else 1.0
        return [round(wider * count) for count in papers]

    def rod(self, tilt: float | np.ndarray) -> ContactGeometry:
        """Contact geometry at a tilt [rad]: round tip, gyration radius of the scene's rods."""
        rods = self.scene.rods
        rod = paper_rod if rods.inertia == "thin" else spherocylinder
        return rod(tilt, rods.length)


def row_of(scene: str | None) -> Row:
    """The paper's row, or one of one's own, with the theory of its plate.

    Parameters
    ----------
    scene : file, or name of an example of `md`; None: the paper's

    Raises
    ------
    ValueError
        If it is not a row on a plate that vibrates, under a law with a restitution.
    """
    return Row(ROW, SETTING, GAMMA, TILT_SCAN_WORDS) if scene is None else _own(scene, "box")


def annulus_of(scene: str | None) -> Row:
    """The experiment's annulus, or one of one's own; as `row_of`."""
    if scene is None:
        return Row(ANNULUS, SETTING, ANNULUS["plate"]["acceleration"], _ANNULUS_WORDS)
    return _own(scene, "annulus")


def _own(scene: str, place: str) -> Row:
    """Row or annulus of one's own: a scene by its file or name, its tilt left to vary."""
    tables = read_tables(scene)
    found = from_tables(tables)
    rods, plate, contact = found.rods, found.plate, found.contacts.plate
    if (
        not (getattr(found, place) and plate and contact and found.vibrates)
        or contact.law.restitution is None
    ):
        kind = "on a plate that vibrates, under a law with a restitution"
        raise InputError(f"scene must be rods in {PLACES[place]} {kind}, got {scene}")
    setting = {"friction": contact.friction, "restitution": contact.law.restitution}
    words = (
        rf"{Path(scene).stem}: {rods.count} rods, $l={rods.length:.3g}\,d$, {rods.inertia} inertia,"
        rf" $\Gamma={plate.acceleration:.3g}$, {plate.frequency_hz:g} Hz; of the plate:"
        rf" $\mu={contact.friction:g}$, restitution {contact.law.restitution:g}"
    )
    varied = put(tables, {"start.tilt_deg": "none"})
    return Row(varied, setting, plate.acceleration, words)


Function = Callable[[Any, int], Data]  # of scene and periods, for a measure
Sweeps = dict[str, Sweep]  # that a figure needs, by name
STORE = Path("out/rows.db")  # of all runs; what `--store` of the commands sets


def boxes(tilt_deg: Iterable[float], count: int = COUNT) -> list[float]:
    """Lengths [d] of the box in which a row of `count` rods has these tilts [deg]."""
    return (count / np.cos(np.radians([*tilt_deg]))).tolist()


def planned(
    axes: list[dict[str, list]],
    periods: int,
    changes: Changes | None = None,
    base: Tables = ROW,
    measure: Function | None = None,
) -> Sweep:
    """A sweep along axes, seeds last; nothing is run.

    Parameters
    ----------
    axes : keys of the scene and their values, as `md.sweep.expand` takes them
    periods : length of each run
    changes : of the scene, for all points
    base : tables of the scene, such as `ROW` or `ANNULUS`
    measure : what to store in place of the results of `md.run`: a function, found by its name in
        its module, of scene and periods, which returns numbers and lists by name
    """
    sweep = expand({"periods": periods, "axes": axes, "set": changes or {}}, base)
    return sweep if measure is None else measured_by(sweep, measure)


def measured_by(sweep: Sweep, measure: Function) -> Sweep:
    """Sweep whose points store what a function of scene and periods measures."""
    how = Measure(measure, sources_of(measure))
    return replace(sweep, points=tuple(replace(point, measure=how) for point in sweep.points))


def lacking(points: Iterable[Point]) -> list[Point]:
    """Points of runs that the store does not hold, each once."""
    with Store(STORE) as database:
        distinct = {point.key: point for point in points}
        return [point for key, point in distinct.items() if not database.has(key)]


def computed(sweep: Sweep, workers: int = -1) -> Sweep:
    """Run a sweep as far as the store does not hold it; returns the sweep."""
    execute(sweep, STORE, workers=workers, progress=True)
    return sweep


def gathered(sweep: Sweep, *names: str) -> tuple[np.ndarray, ...]:
    """Results along the axes of a sweep, which is run as far as the store does not hold it."""
    return computed(sweep).gather(STORE, *names)


_MIRRORED = re.compile(r"tilt_deg|c_x_cm_s|.+\.(c_x|omega)_(before|after)\.mean")


def along_lean(sweep: Sweep, *names: str) -> list[np.ndarray]:
    """Results as of `gathered`; of rows that have turned over to -x, those of the mirror image.

    Where gravity points along x, the mirror image is another row.
    """
    if any(point.scene.gravity and point.scene.gravity.x for point in sweep.points):
        return [*gathered(sweep, *names)]
    tilt, *found = gathered(sweep, "tilt_deg", *names)
    side = np.where(tilt < 0, -1, 1)
    return [
        values * side if _MIRRORED.fullmatch(name) else values
        for name, values in zip(names, found, strict=True)
    ]


def over_seeds(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard error over the seeds, the last axis; nan where runs are missing."""
    found = np.isfinite(values).sum(axis=-1)
    with np.errstate(all="ignore"):
        mean = np.nansum(values, axis=-1) / found
        off = np.nansum((values - mean[..., None]) ** 2, axis=-1)
        return mean, np.sqrt(off / (found - 1) / found)


def larger_error(values: np.ndarray, errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean over seeds; the larger of the errors between the runs and, where known, within them."""
    mean, between = over_seeds(values)
    squares, _ = over_seeds(errors**2)
    return mean, np.fmax(between, np.sqrt(squares / np.isfinite(errors).sum(axis=-1)))


def nearest(values: np.ndarray, value: float) -> int:
    """Index of the value on a grid that is nearest to another one."""
    return int(np.abs(values - value).argmin())


def with_error(name: str, mean: np.ndarray, error: np.ndarray) -> Data:
    """A mean by its name, and its standard error as `name_error`."""
    return {name: mean, f"{name}_error": error}


def seed_means(results: Data) -> Data:
    """Means of arrays over the seeds, their last axis, with `name_error` beside them."""
    found: Data = {}
    for name, values in results.items():
        found |= with_error(name, *over_seeds(values))
    return found


Read = Callable[..., Iterable[np.ndarray]]  # `gathered` or `along_lean`


def means(sweep: Sweep, names: Mapping[str, str], read: Read = gathered) -> Data:
    """Means over seeds of results of a sweep, with `name_error` beside them."""
    return seed_means(dict(zip(names, read(sweep, *names.values()), strict=True)))


DRIFT_AND_TILT = "c_x_cm_s", "c_x_stderr_cm_s", "tilt_deg", "tilt_stderr_deg"  # of a run


def drift_and_tilt(sweep: Sweep, prefix: str = "", read: Read = gathered) -> Data:
    """Drift `c_x` [cm/s] and `tilt` [deg] of a sweep, with `larger_error`."""
    c_x, c_x_in, tilt, tilt_in = read(sweep, *DRIFT_AND_TILT)
    return {
        **with_error(f"{prefix}c_x", *larger_error(c_x, c_x_in)),
        **with_error(f"{prefix}tilt", *larger_error(tilt, tilt_in)),
    }


def periods_of(quick: bool) -> int:
    """Periods of the plate in each run of a figure of rows."""
    return 60 if quick else 300


def tilts(quick: bool) -> np.ndarray:
    """Nominal tilts [deg] of Figs. 6 to 8 and 13(a)."""
    return np.array([*SHOWN_DEG, 60, 75] if quick else sorted({*range(3, 79, 3), *SHOWN_DEG}))


def tilt_plan(
    quick: bool,
    changes: Changes | None = None,
    scene: str | None = None,
    seeds: dict[str, list] | None = None,
) -> Sweep:
    """A row along the nominal tilts, the paper's or one's own, some keys of the scene changed."""
    row = row_of(scene)
    along = {"box.length": boxes(tilts(quick), row.scene.rods.count)}
    return planned([along, seeds or SEEDS], periods_of(quick), changes, row.tables)


def tilt_sweeps(quick: bool = False) -> Sweeps:
    """The paper's row over tilt, as `sweeps` of a figure."""
    return {"tilt": tilt_plan(quick)}


def paper_rod(tilt: float | np.ndarray, length: float = LENGTH) -> ContactGeometry:
    """Contact geometry of the paper's rod at a tilt [rad]: round tip, a thin rod's gyration."""
    return spherocylinder(tilt, length)._replace(k=length / np.sqrt(12))


def lone(field: str, quick: bool, scene: str | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Tilts [deg], and means there of one field of `bounce`: one rigid rod at fixed tilt.

    This is the theory without its closure.
    """
    tilt_deg, runs = _lone(quick, scene, row_of(scene).scene.digest())
    return tilt_deg, np.array([getattr(run, field).mean for run in runs])


@cache
def _lone(quick: bool, scene: str | None, _: str) -> tuple[np.ndarray, list]:
    """Tilts and runs of `lone`, kept by the digest of the scene: its file may be edited."""
    from impact.bouncing import bounce  # compiles

    row, tilt_deg = row_of(scene), np.arange(0, 76, 5 if quick else 2.5)
    gravity = row.scene.gravity
    if gravity is None or gravity.x or gravity.z >= 0:
        raise InputError(f"scene must have gravity across the plate alone, got {gravity}")
    rods, landings = (20, 150) if quick else (100, 600)
    return tilt_deg, [
        bounce(
            row.rod(np.radians(deg)),
            gamma=row.gamma / -gravity.z,
            **row.setting,
            landings=landings,
            rods=rods,
            transient=150,
            shortest_flight=0.1,
        )
        for deg in tilt_deg
    ]


def plate_speed_cm_s(gamma: float | np.ndarray = GAMMA) -> float | np.ndarray:
    """Peak velocity V_0 [cm/s] of the paper's plate at a peak acceleration `gamma` [g]."""
    scene = from_tables(ROW)
    return scene.plate_speed * scene.cm_per_s * np.asarray(gamma) / GAMMA
