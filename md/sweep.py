"""Sweeps: one scene along axes, every point a run of its own, on all cores or on a cluster.

    scene = "quasi2d"                 # a file beside this one, or an example
    periods = 300                     # or: tolerance = 0.01, of each drift, and max_seconds = 60

    [set]                             # for all points
    "step.size" = 1e-4

    [[axes]]
    "plate.acceleration" = { from = 1.2, to = 5, count = 8 }       # log = true: evenly in log

    [[axes]]                          # zipped: they change together
    "rods.count" = [20, 40]
    "box.length" = [21.5, 43]

    [[axes]]
    "start.seed" = [1, 2, 3]

The axes multiply. joblib runs the points; this process alone writes the store.
"""

import hashlib
import itertools
import logging
import math
import warnings
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from joblib import Parallel, cpu_count, delayed, parallel_config
from joblib.externals.loky.process_executor import TerminatedWorkerError
from tqdm import tqdm

from .accuracy import CALIBRATION, MAX_SECONDS, checked, chosen_step, in_words, run
from .host import step_of
from .scene import Scene, as_dict, from_tables, put, read_tables, whole
from .soft_impact import RunError
from .sources import digest
from .store import Store

__all__ = ["Interrupted", "Measure", "Point", "Sweep", "Tally", "execute", "expand", "load_sweep"]

_SWEEPS = Path(__file__).parent / "sweeps"
_MOST = 10**6  # points of a sweep
_CRASHES = 3  # deaths of a worker in a row before the sweep gives up


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a sweep; what was finished is in the store."""


@cache
def _known() -> str:
    """Digest of the calibration, which chooses the step of a tolerance."""
    return hashlib.sha256(CALIBRATION.read_bytes()).hexdigest()


class Measure(NamedTuple):
    """What a point stores in place of the results of a run.

    function : of scene and periods, found by its name in its module; returns numbers and lists of
        numbers by name
    code : digest of its sources
    """

    function: Callable[[Scene, int], dict[str, Any]]
    code: str


@dataclass(frozen=True)
class Point:
    """One run of a sweep."""

    scene: Scene  # what runs
    periods: int  # 0 where a tolerance says how long
    tolerance: float | None = None  # of the drift, as in `md.run`
    max_seconds: float = MAX_SECONDS  # for it
    measure: Measure | None = None  # None: the results of `md.run`

    @property
    def code(self) -> str:
        """Digest of the sources that decide what the run gives."""
        return digest(annulus=self.scene.annulus is not None, tolerance=self.tolerance is not None)

    @cached_property  # which goes along to the worker
    def key(self) -> str:
        """Digest of the scene, the length of the run and the sources."""
        length = str(self.periods)
        if self.tolerance is not None:
            length = f"within {self.tolerance!r} in {self.max_seconds!r}, {_known()}"
        if self.measure is not None:
            length += f", {self.measure.function.__qualname__} {self.measure.code}"
        return hashlib.sha256(f"{self.scene!r} {length} {self.code}".encode()).hexdigest()[:24]


@dataclass(frozen=True)
class Sweep:
    """Points on a grid.

    axes : of each axis, the keys that change along it with their values
    points : in the order of the axes, the last one fastest
    """

    axes: tuple[dict[str, list], ...]
    points: tuple[Point, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values along each axis."""
        return tuple(len(next(iter(axis.values()))) for axis in self.axes)

    def values(self, key: str) -> np.ndarray:
        """Values of a key along its axis.

        Parameters
        ----------
        key : of the scene, as "plate.acceleration"; KeyError if no axis has it
        """
        for axis in self.axes:
            if key in axis:
                return np.array(axis[key])
        raise KeyError(key)

    def gather(self, store: str | Path, *names: str) -> tuple[np.ndarray, ...]:
        """Results along the axes; nan where a run is missing or has failed.

        Parameters
        ----------
        store : path of the store
        names : of results, such as "c_x" or "landings.plate_velocity.mean"

        Returns
        -------
        Arrays of the shape of the sweep, with further axes where a result is a list.
        """
        with Store(store, write=False) as database:
            results = [database.result(point.key) for point in self.points]
        return tuple(self._array([_named(result, name) for result in results]) for name in names)

    def _array(self, values: list) -> np.ndarray:
        inner = next((np.shape(v) for v in values if v is not None), ())
        blank = np.full(inner, np.nan)
        flat = np.array([blank if v is None else np.asarray(v, float) for v in values])
        return flat.reshape(self.shape + inner)


def _named(result: dict | None, name: str) -> Any:
    """A result by its dotted name."""
    for part in name.split("."):
        if result is None:
            return None
        result = result[part]
    return result


def _values(name: str, given: object) -> list:
    """Values of one key along its axis."""
    if isinstance(given, Mapping):
        known = {"from", "to", "count", "log"}
        if not {"from", "to", "count"} <= set(given) <= known:
            raise ValueError(f"{name} must have from, to, count and at most log, got {dict(given)}")
        low, high, count = given["from"], given["to"], given["count"]
        if not isinstance(count, int) or not 1 <= count <= _MOST:
            raise ValueError(
                f"{name}.count must be a whole number from 1 to {_MOST}, got {count!r}"
            )
        if not all(isinstance(x, int | float) and math.isfinite(x) for x in (low, high)):
            raise ValueError(f"{name} must go from and to finite numbers, got {low!r} and {high!r}")
        if given.get("log", False):
            if not (low > 0 and high > 0):
                raise ValueError(f"{name} must have both ends > 0 in log, got {low!r} and {high!r}")
            return np.geomspace(low, high, count).tolist()
        values = np.linspace(low, high, count).tolist()
        whole = isinstance(low, int) and all(value == round(value) for value in values)
        return [round(value) for value in values] if whole else values
    if not isinstance(given, list) or not given:
        raise ValueError(
            f"{name} must be a list of values or a range, and not empty, got {given!r}"
        )
    if any(isinstance(value, float) and not math.isfinite(value) for value in given):
        raise ValueError(f"{name} must hold finite values, got {given!r}")
    return given


def _axis(number: int, table: object) -> dict[str, list]:
    """Keys and values of one axis."""
    if not isinstance(table, Mapping) or not table:
        raise ValueError(f"axes[{number}] must be a table with at least one key, got {table!r}")
    axis = {key: _values(f"axes[{number}].{key}", given) for key, given in table.items()}
    lengths = {key: len(values) for key, values in axis.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"axes[{number}]: keys of one axis must be equally long, got {lengths}")
    return axis


def expand(tables: Mapping, base: Mapping) -> Sweep:
    """A sweep from its tables and those of its scene.

    Parameters
    ----------
    tables : of the sweep: periods, or tolerance and max_seconds; set; axes
    base : tables of the scene, as `md.scene.read_tables` gives them

    Raises
    ------
    ValueError, TypeError
        If an axis is empty or holds nan, or a point is not a scene that can run; the message names
        the point.
    """
    known = {"scene", "periods", "tolerance", "max_seconds", "set", "axes"}
    for key in tables:
        if key not in known:
            raise ValueError(f"{key} is not a key of a sweep; known: {', '.join(sorted(known))}")
    periods = tables.get("periods", 200)
    if isinstance(periods, bool) or not isinstance(periods, int) or periods < 1:
        raise ValueError(f"periods must be a whole number >= 1, got {periods!r}")
    chosen = {key: tables[key] for key in ("tolerance", "max_seconds") if key in tables}
    if "tolerance" in chosen and "periods" in tables:
        raise ValueError("periods has no meaning with tolerance, which chooses the length")
    if "max_seconds" in chosen and "tolerance" not in chosen:
        raise ValueError("max_seconds has no meaning without tolerance")
    if chosen:
        checked(**chosen)
        periods = 0
    axes = tuple(_axis(i, table) for i, table in enumerate(tables.get("axes", [])))
    keys = [key for axis in axes for key in axis]
    if len(set(keys)) < len(keys):
        raise ValueError(f"a key may stand on one axis alone, got {keys}")
    size = math.prod(len(next(iter(axis.values()))) for axis in axes)
    if size > _MOST:
        raise ValueError(f"a sweep may have {_MOST} points, got {size}")
    common, points = dict(tables.get("set", {})), []
    along = [[dict(zip(a, v, strict=True)) for v in zip(*a.values(), strict=True)] for a in axes]
    for place in itertools.product(*along):
        changes = {key: value for part in place for key, value in part.items()}
        try:
            scene = from_tables(put(base, {**common, **changes}))
            step_of(chosen_step(scene, chosen["tolerance"])[0] if chosen else scene)
        except (ValueError, TypeError) as error:
            at = ", ".join(f"{key} = {value!r}" for key, value in changes.items())
            raise type(error)(f"{error} (at {at})" if at else str(error)) from None
        points.append(Point(scene, periods, **chosen))
    return Sweep(axes, tuple(points))


def load_sweep(path: str | Path) -> Sweep:
    """A sweep from a TOML file; its scene is a file beside it or an example.

    Parameters
    ----------
    path : of the file, or the name of a file in `md/sweeps/` without its ending

    Raises
    ------
    ValueError, TypeError
        As `expand`, and if a file cannot be read.
    """
    tables = read_tables(path, _SWEEPS)
    name = tables.get("scene")
    if not isinstance(name, str):
        raise ValueError(f"scene must be the name of a file or of an example, got {name!r}")
    beside = Path(path).parent / name
    return expand(tables, read_tables(beside if beside.exists() else name))


def _one(point: Point) -> tuple[str, dict | None, str | None, float]:
    """Run a point: its key, what it measured, or why it failed, and how long it took."""
    begin, result, error = perf_counter(), None, None
    try:
        if point.measure is not None:
            result = point.measure.function(point.scene, point.periods)
            return point.key, result, None, perf_counter() - begin
        if point.tolerance is None:
            done = run(point.scene, periods=point.periods)
        else:
            done = run(point.scene, tolerance=point.tolerance, max_seconds=point.max_seconds)
        if not done.finished:
            raise KeyboardInterrupt
        result = {**done.as_dict(), "phases": done.phases}
        del result["scene"]
        if done.accuracy and done.accuracy.state == "not reached":
            result, error = None, " ".join(" ".join(in_words(done)).split())
    except RunError as failure:
        error = str(failure)
    return point.key, result, error, perf_counter() - begin


def _finished(points: list[Point], workers: int) -> Iterator[tuple]:
    """Results as they arrive; points are handed out a few at a time."""
    if workers == 1:
        yield from map(_one, points)
        return
    yield from Parallel(
        n_jobs=workers, batch_size=1, pre_dispatch="2*n_jobs", return_as="generator_unordered"
    )(delayed(_one)(point) for point in points)


def _survived(points: list[Point], workers: int) -> Generator[tuple, None, None]:
    """The same; where a worker dies, what was under way is begun anew."""
    left, deaths = {point.key: point for point in points}, 0
    while left:
        try:
            for done in _finished(list(left.values()), workers):
                left.pop(done[0], None)
                deaths = 0
                yield done
        except TerminatedWorkerError:
            deaths += 1
            if deaths == _CRASHES:
                raise RunError(f"a worker died {deaths} times in a row", ()) from None


@contextmanager
def _stopping(results: Generator[tuple, None, None]) -> Iterator[None]:
    """Stop the runs under way, without joblib's words, if something ends the sweep early."""
    try:
        yield
    except BaseException:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            results.close()
        raise


@dataclass
class Tally:
    """What a sweep did."""

    points: int  # of the sweep
    distinct: int  # of them
    there: int  # in the store before
    computed: int = 0  # now
    failed: int = 0  # now
    seconds: float = 0.0  # of the clock
    run_seconds: float = 0.0  # of all runs


def execute(
    sweep: Sweep,
    store: str | Path,
    *,
    workers: int = -1,
    scheduler: str | None = None,
    retry: bool = False,
    progress: bool = False,
) -> Tally:
    """Compute what the store does not hold yet.

    Parameters
    ----------
    sweep : Sweep
    store : path of the store; each result is written as it arrives
    workers : processes on this machine; -1: one for each core
    scheduler : address of a Dask cluster, which has workers of its own
    retry : whether to run again what has failed before
    progress : whether to show a progress bar, on a terminal

    Raises
    ------
    StoreError
        If the store cannot be used.
    ValueError, TypeError
        If `workers` is no number of processes, or `scheduler` no cluster, or both are given.
    RunError
        If a worker dies again and again.
    Interrupted
        On Ctrl-C; what was finished is in the store.
    """
    if whole("workers", workers, -1, 10**4) == 0:
        raise ValueError("workers must be at least 1, or -1 for one a core, got 0")
    if scheduler is not None and not isinstance(scheduler, str):
        raise TypeError(f"scheduler must be the address of a Dask cluster, got {scheduler!r}")
    if scheduler is not None and workers != -1:
        raise ValueError(f"workers has no meaning with scheduler, got {workers} and {scheduler!r}")
    points = {point.key: point for point in sweep.points}
    begin = perf_counter()
    with Store(store) as database:
        wanted = [p for key, p in points.items() if not database.has(key, failed=not retry)]
        tally = Tally(len(sweep.points), len(points), len(points) - len(wanted))
        bar = tqdm(total=len(wanted), unit=" runs", disable=None if progress else True)
        count = 0 if scheduler else _cores(workers, len(wanted))
        results = _survived(wanted, count or -1)
        try:
            with bar, _backend(scheduler), _stopping(results):
                for key, result, error, seconds in results:
                    made = (result or {}).get("periods", points[key].periods)
                    about = {"code": points[key].code, "seconds": seconds, "periods": made}
                    scene = points[key].scene
                    about |= {"scene": as_dict(scene), "seed": scene.start.seed}
                    database.put(key, about, result, error)
                    tally.computed += error is None
                    tally.failed += error is not None
                    tally.run_seconds += seconds
                    bar.update()
        except KeyboardInterrupt:
            done = tally.computed + tally.failed
            raise Interrupted(f"{done} of {len(wanted)} runs done and stored") from None
    tally.seconds = perf_counter() - begin
    return tally


def _cores(workers: int, tasks: int) -> int:
    """Processes to use, no more than there is work for."""
    return max(min(cpu_count() if workers == -1 else workers, tasks), 1)


@contextmanager
def _backend(scheduler: str | None) -> Iterator[None]:
    """Where joblib sends the runs."""
    if scheduler is None:
        with parallel_config("loky"):
            yield
        return
    try:
        from distributed import Client
    except ImportError:
        raise ValueError("scheduler needs dask.distributed: pip install distributed") from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # it logs what it raises
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise ValueError(
            f"scheduler must be the address of a Dask cluster, got {scheduler!r}: {error}"
        ) from None
    with client, parallel_config("dask", client=client):
        yield
