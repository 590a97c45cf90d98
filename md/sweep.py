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

The axes multiply. joblib runs the points; this process alone writes the store. The same from
Python, a full grid of two axes and what came of it as labelled arrays:

>>> import md
>>> grid = {
...     "scene": "single_rod",
...     "periods": 20,
...     "axes": [{"plate.acceleration": [2, 3]}, {"contacts.plate.friction": [0.2, 0.3, 0.4]}],
... }
>>> sweep = md.sweep.expand(grid)
>>> tally = md.sweep.execute(sweep, "grid.db", workers=1)
>>> (c_x,) = sweep.gather("grid.db", "c_x_cm_s")
>>> c_x.shape
(2, 3)
>>> found = sweep.to_xarray("grid.db", "c_x_cm_s")  # with coordinates, units and errors
>>> list(found), found.c_x_cm_s.dims
(['c_x_cm_s', 'c_x_stderr_cm_s'], ('plate_acceleration', 'contacts_plate_friction'))
"""

import itertools
import logging
import math
import os
import threading
import warnings
from _thread import interrupt_main
from collections import ChainMap
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from joblib import Parallel, delayed, effective_n_jobs, parallel_config
from joblib.externals.loky.process_executor import TerminatedWorkerError

from . import cache
from .accuracy import checked, run, stepped
from .cache import deferred
from .domains import (
    InputError,
    RunError,
    as_dict,
    flat,
    held,
    in_notebook,
    listed,
    span,
    tabled,
    whole,
)
from .files import warn
from .host import step_of
from .scene import Scene, changes_of, from_tables, put, read_tables, scene_beside
from .simulation import MOST_PERIODS, progress_bar
from .store import Store, named
from .units import error_of, labelled

if TYPE_CHECKING:
    from xarray import Dataset


_SWEEPS = Path(__file__).parent / "sweeps"
_KEYS = "scene", "periods", "tolerance", "max_seconds", "set", "axes"
_MOST_POINTS = 10**6
PATIENCE = 60.0  # seconds in which a cluster is to have a worker


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a sweep; what was finished is in the store."""


class Measure(NamedTuple):
    """A function whose results a point stores in place of those of `md.run`.

    function : of scene and periods, found by its name in its module; returns numbers and lists of
        numbers by name
    code : digest of its sources
    """

    function: Callable[[Scene, int], dict[str, Any]]
    code: str


@dataclass(frozen=True)
class Point:
    """One run of a sweep.

    scene : what runs
    periods : 0 where a tolerance says how long
    chosen : tolerance of the drift and perhaps max_seconds, as in `md.run`; None: `periods`
    measure : None: the results of `md.run`
    """

    scene: Scene
    periods: int
    chosen: dict[str, Any] | None = None
    measure: Measure | None = None

    @property
    def length(self) -> dict[str, Any]:
        """Arguments of `md.run` that say how long the run is."""
        return self.chosen or {"periods": self.periods}

    @cached_property  # which goes along to the worker
    def key(self) -> str:
        """Key of the run in a store: `md.cache.key`, which says when it is stale."""
        return cache.key(self.scene, self.length, self.measure)


@dataclass(frozen=True, repr=False)
class Sweep:
    """Points on a grid.

    axes : of each axis, the keys that change along it with their values
    points : in the order of the axes, the last one fastest
    """

    axes: tuple[dict[str, list], ...]
    points: tuple[Point, ...]

    def __repr__(self) -> str:
        axes = (f"{n} {next(iter(axis))}" for n, axis in zip(self.shape, self.axes, strict=True))
        return f"<Sweep: {' x '.join(axes) or '1 point'}>"

    def __str__(self) -> str:
        lines = [f"{key} = {values}" for axis in self.axes for key, values in axis.items()]
        return "\n".join([f"{len(self.points)} points", *lines])

    _repr_html_ = in_notebook

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
        return np.array(ChainMap(*self.axes)[key])

    def gather(self, store: str | Path, *names: str) -> tuple[np.ndarray, ...]:
        """Results along the axes; nan where a run is missing or has failed.

        Parameters
        ----------
        store : path of the store
        names : of results, such as "c_x" or "landings.plate_velocity.mean"

        Returns
        -------
        Arrays of the shape of the sweep, with further axes where a result is a list. Of texts they
        are arrays of texts, empty where a run is missing.

        Raises
        ------
        ValueError
            If the results have no such name.
        """
        results = self._results(store)
        return tuple(self._array(results, name) for name in names)

    def to_xarray(self, store: str | Path, *names: str) -> "Dataset":
        """Results with their coordinates, units and errors; `.to_dataframe()` makes a table.

        Parameters
        ----------
        store : path of the store
        names : of results, as in `gather`; their standard errors come along: "c_x_stderr_cm_s" with
            "c_x_cm_s", "landings.plate_velocity.stderr" with "landings.plate_velocity.mean"

        Returns
        -------
        `xarray.Dataset` with a dimension for each axis, which has the name of the axis' first key;
        its other keys are coordinates along it. In all names dots are underscores:
        `plate_acceleration`. `attrs` of each array are `units` and `long_name`, which plots show.
        It warns of runs that are missing or have failed: their values are nan.

        Raises
        ------
        ValueError
            As `gather`.
        """
        dims = [next(iter(axis)) for axis in self.axes]
        coords = {key: (next(iter(axis)), axis[key]) for axis in self.axes for key in axis}
        results, variables = self._results(store), {}
        if missing := results.count(None):
            warn(f"{missing} of {len(results)} runs are missing in {store}, or have failed")
        known = {name for result in results for name in flat(result or {})}
        lacking = {*map(error_of, known)} - known
        for name in [*names, *(error for error in map(error_of, names) if error not in lacking)]:
            array = self._array(results, name)
            inner = [f"{name}.{i}" for i in range(array.ndim - len(dims))]
            variables[name] = (*dims, *inner), array
        return labelled(variables, coords)

    def _results(self, store: str | Path) -> list[dict[str, Any] | None]:
        """Results of the points; None where a run is missing or has failed."""
        with Store(store, write=False) as database:
            return [database.result(point.key) for point in self.points]

    def _array(self, results: list[dict[str, Any] | None], name: str) -> np.ndarray:
        """Array of one result along the axes."""
        values = [named(result, name) for result in results]
        first = next((value for value in values if value is not None), math.nan)
        kind = str if isinstance(first, str) else float
        blank = "" if kind is str else np.full_like(first, math.nan, float)
        found = np.array([blank if value is None else value for value in values], kind)
        return found.reshape(self.shape + found.shape[1:])


def _values(name: str, given: object) -> list:
    """Values of one key along its axis, from a list or a range."""
    if isinstance(given, Mapping):
        tabled(name, given, ("from", "to", "count"), ("log",))
        low, high, log = span(name, given)
        count = whole(f"{name}.count", given["count"], 2, _MOST_POINTS)
        spaced = (np.geomspace if log else np.linspace)(low, high, count)
        # 20, not 20.000000000000004
        return [round(x) if abs(x - round(x)) <= 4 * math.ulp(x) else x for x in spaced.tolist()]
    values = listed(given)
    if not values:
        raise InputError(f"{name} must be a list of values, not empty, or a range, got {given!r}")
    return values


def _axis(number: int, table: object) -> dict[str, list]:
    """Keys and values of one axis."""
    if not isinstance(table, Mapping) or not table:
        raise InputError(f"axes[{number}] must be a table with at least one key, got {table!r}")
    if any(isinstance(x, Mapping) and "from" not in x and "to" not in x for x in table.values()):
        raise InputError(f'axes[{number}] must hold "key" = values, keys in quotes, got {table!r}')
    axis = {key: _values(f"axes[{number}].{key}", given) for key, given in table.items()}
    lengths = {key: len(values) for key, values in axis.items()}
    if len(set(lengths.values())) > 1:
        raise InputError(f"axes[{number}]: keys of one axis must be equally long, got {lengths}")
    return axis


def expand(tables: Mapping, base: Mapping | None = None) -> Sweep:
    """Make a sweep from its tables and those of its scene.

    Parameters
    ----------
    tables : of the sweep: scene; periods, or tolerance and max_seconds; set; axes
    base : tables of the scene, as `md.scene.read_tables` gives them; None: of the one that `tables`
        names

    Raises
    ------
    ValueError, TypeError
        If an axis is empty, or a point is not a scene that can run; the message names
        the point.
    """
    tabled("a sweep", tables, (), _KEYS)
    base = base or scene_beside("", tables)
    periods = whole("periods", tables.get("periods", 200), 1, MOST_PERIODS)
    chosen = {key: tables[key] for key in ("tolerance", "max_seconds") if key in tables}
    if chosen:
        chosen = checked(periods=tables.get("periods"), **chosen)
        periods = 0
    given = held("axes", tables.get("axes", []), list)
    axes = tuple(_axis(i, table) for i, table in enumerate(given))
    common = changes_of("set", tables.get("set", {}))
    keys = [*common, *itertools.chain(*axes)]
    if twice := {key for key in keys if keys.count(key) > 1}:
        raise InputError(f"{', '.join(sorted(twice))} may stand on one axis alone, or under set")
    shape = Sweep(axes, ()).shape
    if (size := math.prod(shape)) > _MOST_POINTS:
        raise InputError(f"a sweep may have {_MOST_POINTS} points, got {size}")
    points = []
    for place in np.ndindex(shape):
        values: dict[str, Any] = {}
        for axis, number in zip(axes, place, strict=True):
            values |= {key: along[number] for key, along in axis.items()}
        changes = changes_of("axes", values)
        points.append(point_at(base, {**common, **changes}, changes, periods, chosen))
    return Sweep(axes, tuple(points))


def point_at(
    base: Mapping, changes: Mapping, place: Mapping, periods: int, chosen: dict | None = None
) -> Point:
    """Make a point of a sweep or a search; one that cannot run is refused by its place.

    Parameters
    ----------
    base : tables of the scene
    changes : of the scene
    place : values that tell the point from others, for the message
    periods, chosen : as `Point` has them
    """
    try:
        scene = from_tables(put(base, changes))
        step_of(stepped(scene, chosen["tolerance"])[0] if chosen else scene)
    except InputError as error:
        at = ", ".join(f"{key} = {value!r}" for key, value in place.items())
        raise InputError(f"{error} (at {at})" if at else str(error)) from None
    return Point(scene, periods, chosen)


def load_sweep(path: str | Path) -> Sweep:
    """Read a sweep from a TOML file; its scene is a file beside it or an example.

    Parameters
    ----------
    path : of the file, or the name of a file in `md/sweeps/` without its ending

    Raises
    ------
    ValueError, TypeError
        As `expand`, and if a file cannot be read.
    """
    tables = read_tables(path, _SWEEPS)
    return expand(tables, scene_beside(path, tables))


def _of_run(point: Point) -> dict:
    """Results of `md.run`, as a store holds them."""
    done = run(point.scene, **point.length)
    if not done.finished:
        raise KeyboardInterrupt
    if (found := done.accuracy) and found.state != "reached":
        raise RunError(
            f"{found.state.upper()}: {found.tolerance:.3g} of the drift asked for; c_x is "
            f"{done.c_x:.4g} +- {found.error:.2g} sqrt(g d) after {found.made} periods; "
            f"this would take about {found.needed_seconds:.3g} s"
        )
    results = done.as_dict() | {"phases": done.phases}
    del results["scene"]
    return results


def _one(point: Point) -> tuple[str, dict | None, str | None, float]:
    """Run a point: its key, its result or why it failed, and its seconds."""
    begin, measure = perf_counter(), point.measure
    result = error = None
    try:
        result = measure.function(point.scene, point.periods) if measure else _of_run(point)
    except (InputError, RunError) as failure:
        error = str(failure)
    return point.key, result, error, perf_counter() - begin


@contextmanager
def pool(tasks: list, workers: int, **how: Any) -> Iterator[Generator[Any, None, None]]:
    """Pool of workers, as a generator of results; an exception ends the runs without a warning.

    Parameters
    ----------
    tasks : delayed calls of joblib
    workers : processes
    how : further options of `joblib.Parallel`

    Raises
    ------
    RunError
        If a worker dies.
    """
    with warnings.catch_warnings(), ExitStack() as ending:
        warnings.filterwarnings("ignore", "A worker stopped")  # it idled; another takes its place
        if "PYTHONWARNINGS" not in os.environ:
            # what joblib's process that cleans up would say after a signal, below our one line
            os.environ["PYTHONWARNINGS"] = "ignore:resource_tracker"
            ending.callback(os.environ.pop, "PYTHONWARNINGS")
        try:
            with deferred():  # half a pool would leave semaphores behind
                made = Parallel(workers, batch_size=1, return_as="generator_unordered", **how)
                results = made(tasks)
                ending.callback(results.close)
                ending.callback(warnings.simplefilter, "ignore")
            yield results
        except TerminatedWorkerError:
            raise RunError(
                "a worker process died, for want of memory perhaps; what was finished is kept: "
                "the same command goes on"
            ) from None


@dataclass
class Tally:
    """Numbers of points and runs of a sweep, and the time that they took.

    points : of the sweep
    distinct : runs that these points need
    there : of these runs, in the store before
    computed : with a result
    failed : without one
    seconds : of the clock
    run_seconds : of all runs
    """

    points: int
    distinct: int
    there: int
    computed: int = 0
    failed: int = 0
    seconds: float = 0.0
    run_seconds: float = 0.0


def execute(
    sweep: Sweep,
    store: str | Path,
    *,
    workers: int = -1,
    scheduler: str | None = None,
    retry: bool = False,
    progress: bool = False,
) -> Tally:
    """Run the points that the store does not hold yet.

    Parameters
    ----------
    sweep : Sweep
    store : path of the store; each result is written as it arrives
    workers : processes on this machine; -1: one for each core
    scheduler : address of a Dask cluster, which has workers of its own, the first within a
        minute
    retry : whether to run again what has failed before
    progress : whether to show a progress bar, on a terminal

    Raises
    ------
    StoreError
        If the store cannot be used.
    ValueError, TypeError
        If `workers` is not a number of processes, `scheduler` not a cluster, or both are given.
    RunError
        If a worker dies, or the cluster has no worker or is gone; what was finished is kept.
    Interrupted
        On Ctrl-C; what was finished is in the store.
    """
    held("sweep", sweep, Sweep)
    if whole("workers", workers, -1, 10**4) == 0:
        raise InputError("workers must be at least 1, or -1 for one a core, got 0")
    held("scheduler", scheduler, str | None)
    if scheduler is not None and workers != -1:
        raise InputError(f"workers has no meaning with scheduler, got {workers} and {scheduler!r}")
    points = {point.key: point for point in sweep.points}
    begin = perf_counter()
    with _backend(scheduler), Store(store) as database:  # refused before there is a store
        wanted = [p for key, p in points.items() if not database.has(key, failed=not retry)]
        tally = Tally(len(sweep.points), len(points), len(points) - len(wanted))
        bar = progress_bar(total=len(wanted), unit=" runs", disable=None if progress else True)
        jobs = -1 if scheduler else min(effective_n_jobs(workers), len(wanted) or 1)
        try:
            with bar, pool([*map(delayed(_one), wanted)], jobs) as results:
                for key, result, error, seconds in results:
                    point = points[key]
                    about = {
                        "scene": as_dict(point.scene),
                        "periods": point.periods or (result or {}).get("periods", 0),
                        "seed": point.scene.start.seed,
                        "code": cache.digest(),
                        "seconds": seconds,
                    }
                    database.put(key, about, result, error)
                    tally.computed += error is None
                    tally.failed += error is not None
                    tally.run_seconds += seconds
                    bar.update()
        except KeyboardInterrupt:
            raise Interrupted(
                f"{tally.computed + tally.failed} of {len(wanted)} runs done and stored"
            ) from None
    tally.seconds = perf_counter() - begin
    return tally


@contextmanager
def _backend(scheduler: str | None) -> Iterator[None]:
    """Backend of joblib: processes of this machine, or a cluster."""
    if scheduler is None:
        with parallel_config("loky"):
            yield
        return
    try:
        from distributed import Client  # late: an extra that a sweep on one machine does not need
    except ImportError:
        raise InputError("scheduler needs dask.distributed: pip install distributed") from None
    for logger in ("distributed", "distributed.client"):  # they log what is raised
        logging.getLogger(logger).setLevel(logging.CRITICAL)
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError(
            f"scheduler must be the address of a Dask cluster, got {scheduler!r}: {error}"
        ) from None
    ended = threading.Event()

    def watch() -> None:
        """Interrupt a sweep whose scheduler is gone, as it would wait without end."""
        while not ended.wait(1.0):
            if client.status == "closed":
                interrupt_main()
                return

    with client:
        threading.Thread(target=watch, daemon=True).start()
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
            with parallel_config("dask", client=client):
                yield
        except (Exception, KeyboardInterrupt) as error:
            gone = client.status != "running"
            if gone or type(error).__module__.startswith("distributed"):
                why = "is gone" if gone else f"failed ({' '.join(str(error).split())})"
                raise RunError(
                    f"the scheduler {scheduler} {why}; what was finished is kept"
                ) from None
            raise
        finally:
            ended.set()
