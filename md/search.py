"""Searches: which parameters of a scene give what was measured, or what is asked for.

    scene = "my_rods"                 # a file beside this one, or an example
    periods = 300
    seeds = [1, 2]                    # starts of every run
    points = 32                       # sets of parameters a round, a power of two
    rounds = 2                        # each later one looks closer, around the best

    [set]                             # for all points
    "step.size" = 1e-4

    [[parameters]]
    keys = ["contacts.plate.friction", "contacts.rods.friction"]   # which take the same value
    from = 0.1
    to = 0.6                          # log = true: evenly in log; integer = true: rounded

    [[parameters]]
    name = "law"                      # a choice: what each changes
    choices = { viscous = { "contacts.plate.law" = "constant_restitution" }, ... }

    [[parameters]]
    keys = ["contacts.plate.restitution"]
    from = 0.4
    to = 1.0
    when = { law = "viscous" }        # it has no meaning else

    [data]
    file = "drift.csv"                # columns: keys of the scene, the result, and `error`
    result = "c_x_cm_s"               # a row without it asks for it: it is predicted

    [[targets]]                       # besides data, or in their place
    result = "tilt_deg"
    at = { "box.length" = 43.0 }
    holds = [20.0, 23.0]              # limits
    error = 0.5                       # of them

No two parameters may set one key at once, the tables of choices included; `when` keeps them apart.
Parameters are drawn from a Sobol sequence; every point is run at all places of the data and targets
with all starts, by `md.sweep` into its store, so that a search goes on where it stopped. The misfit
of a point is the sum of squares of (result - limit)/error, where the error is that of the data and
of the means over the starts together.

Between the points each result is a polynomial of the parameters (`Surface`). From it follow the
estimate of each parameter, with weights exp(-misfit/2), and what is predicted with its uncertainty.
For these the error is that of the data and the distance by which the polynomial misses a point, the
scatter of its runs included. So errors are rather too large; further rounds, which look closer, and
longer runs make them smaller.

They hold if the scene can fit the data, if the truth is within the ranges, and if results are as
rough there as at the other points near the best one: beside a jump an estimate can be off by three
errors. The least misfit is told, and should be no more than about the number of data. Runs that are
much shorter than those of the data bring their transient in. Choices are not weighed against each
other: estimates are those of the best point's choices, and the least misfit of each choice is told.
"""

import csv
import math
from collections.abc import Mapping
from dataclasses import astuple, dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import qmc

from .domains import finite, held, listed, positive, tabled, whole
from .errors import InputError, RunError
from .files import empty, plain
from .scene import changes_of, read_tables, scene_beside
from .simulation import MOST_PERIODS, run
from .store import Store
from .surface import ENOUGH, Fit, box_around, misfit_of
from .sweep import Point, Sweep, Tally, execute, named, point_at

__all__ = [
    "Estimate",
    "Estimates",
    "Found",
    "Parameter",
    "Search",
    "Target",
    "expand",
    "load_search",
    "search",
]

_OF_RUNS = "scene", "periods", "seeds", "points", "rounds", "seed", "set"
_KEYS = (*_OF_RUNS, "parameters", "data", "targets")
_SEARCHES = Path(__file__).parent / "searches"


@dataclass(frozen=True)
class Parameter:
    """A range of numbers, or a choice."""

    name: str  # in messages and tables
    keys: tuple[str, ...] = ()  # of the scene, which all take the value
    low: float = 0.0  # end of the range
    high: float = 1.0  # the other
    log: bool = False  # whether values lie evenly in log
    choices: Mapping[str, Mapping[str, Any]] | None = None  # what each changes in the scene
    when: Mapping[str, str] | None = None  # choices without which the parameter has no meaning
    integer: bool = False  # whether values of the range are rounded to whole numbers

    def value(self, part: float) -> float | str:
        """The value at a part of the range, from 0 to 1.

        Parameters
        ----------
        part : 0 <= part < 1
        """
        if self.choices is not None:
            return list(self.choices)[int(part * len(self.choices))]
        if self.log:
            value = self.low * (self.high / self.low) ** part
        else:
            value = self.low + (self.high - self.low) * part
        return round(value) if self.integer else float(value)

    def changes(self, values: Mapping[str, float | str]) -> dict[str, Any]:
        """What it changes in the scene.

        Parameters
        ----------
        values : of all parameters, by name
        """
        if any(values[name] != choice for name, choice in (self.when or {}).items()):
            return {}
        value = values[self.name]
        return dict(self.choices[str(value)]) if self.choices else dict.fromkeys(self.keys, value)


class Target(NamedTuple):
    """What a result should be at one place; without limits it is only predicted."""

    result: str  # such as "c_x_cm_s"
    place: int  # number of its place
    low: float  # limit; nan: none
    high: float  # the other
    error: float  # standard error of both


@dataclass(frozen=True)
class Search:
    """A search, read and checked."""

    base: Mapping[str, Any]  # tables of the scene
    common: Mapping[str, Any]  # changes of all points
    periods: int  # of each run
    seeds: tuple[int, ...]  # starts
    parameters: tuple[Parameter, ...]  # that are varied
    places: tuple[Mapping[str, Any], ...]  # changes of the scene at each place of the targets
    targets: tuple[Target, ...]  # what is asked for
    points: int  # a round
    rounds: int = 1  # each later one closer around the best
    seed: int = 1  # of the Sobol sequence

    @property
    def limits(self) -> np.ndarray:
        """Lower limit, upper limit and error of each target, (targets, 3)."""
        return np.array([(t.low, t.high, t.error) for t in self.targets])

    def values(self, parts: np.ndarray) -> dict[str, float | str]:
        """Values of the parameters.

        Parameters
        ----------
        parts : (parameters,), of their ranges
        """
        return {p.name: p.value(part) for p, part in zip(self.parameters, parts, strict=True)}

    def sweep(self, parts: np.ndarray) -> Sweep:
        """Points times places times starts.

        Parameters
        ----------
        parts : (points, parameters), of their ranges

        Raises
        ------
        ValueError, TypeError
            If a point is not a scene that can run; the message names the point.
        """
        runs = []
        for row in parts:
            values = self.values(row)
            changes = dict(self.common)
            for parameter in self.parameters:
                changes |= parameter.changes(values)
            for place, seed in product(self.places, self.seeds):
                changed = {**changes, **place, "start.seed": seed}
                runs.append(point_at(self.base, changed, {**values, **place}, self.periods))
        axes = {"point": [*range(len(parts))]}, {"place": [*range(len(self.places))]}
        return Sweep((*axes, {"start.seed": [*self.seeds]}), tuple(runs))

    def draw(self, number: int = 0, box: np.ndarray | None = None) -> np.ndarray:
        """Parts of the ranges of a round's points, (points, parameters).

        Parameters
        ----------
        number : of the round
        box : (2, parameters), lowest and highest parts; None: the whole ranges
        """
        low, high = (0.0, 1.0) if box is None else box
        sobol = qmc.Sobol(len(self.parameters), seed=self.seed + number)
        return low + sobol.random(self.points) * (high - low)


class Estimate(NamedTuple):
    """A value with its standard error."""

    value: float  # mean
    error: float  # one standard deviation


class Estimates(NamedTuple):
    """What follows from the misfits of all points near the best one; empty if these are too few."""

    parameters: dict[str, Estimate]  # those that are numbers
    correlation: np.ndarray  # of them
    results: list[Estimate]  # of each target
    misfit: float  # the least; without a fit, far beyond the number of data


@dataclass(frozen=True)
class Found:
    """What a search has found."""

    search: Search  # that was made
    parts: np.ndarray  # (n, parameters): of the ranges, all rounds
    results: np.ndarray  # (n, targets): means over the starts
    errors: np.ndarray  # (targets,): standard errors of these means
    tally: Tally  # of all rounds

    @cached_property
    def misfits(self) -> np.ndarray:
        """Of each point; inf where a run failed."""
        found = misfit_of(self.search.limits, self.results, self.errors**2)
        return np.where(np.isnan(found), np.inf, found)

    @property
    def best(self) -> int:
        """Number of the point with the least misfit."""
        return int(np.argmin(self.misfits))

    @cached_property
    def estimates(self) -> Estimates:
        """Means near the best point, of draws with weights exp(-misfit/2)."""
        search, box = self.search, box_around(self.parts, self.misfits)
        chosen = search.values(self.parts[self.best])
        near = ((self.parts >= box[0]) & (self.parts <= box[1])).all(axis=1)
        near &= np.isfinite(self.results).all(axis=1)
        free = []
        for i, parameter in enumerate(search.parameters):
            if parameter.choices:
                values = [parameter.value(part) for part in self.parts[:, i]]
                near &= np.array(values) == chosen[parameter.name]
            elif parameter.changes(chosen):
                free.append(i)
        if not free or near.sum() < ENOUGH * (len(free) + 1):
            return Estimates({}, np.empty((0, 0)), [], math.nan)
        low, size = box[0][free], np.ptp(box, axis=0)[free]
        fit = Fit(
            2 * (self.parts[near][:, free] - low) / size - 1, self.results[near], search.limits
        )
        places = fit.draw(search.seed)
        results, variances, misfits = fit(places)
        parts = low + (places + 1) / 2 * size
        numbers = {
            search.parameters[i].name: np.array([search.parameters[i].value(x) for x in column])
            for i, column in zip(free, parts.T, strict=True)
        }
        spread = np.sqrt(results.var(axis=0) + variances.mean(axis=0))
        return Estimates(
            {name: Estimate(float(x.mean()), float(x.std())) for name, x in numbers.items()},
            np.atleast_2d(np.corrcoef([*numbers.values()])),
            [Estimate(*pair) for pair in np.column_stack([results.mean(axis=0), spread]).tolist()],
            float(misfits.min()),
        )


def search(given: Search, store: str | Path, **how: Any) -> Found:
    """Search, round by round; what the store holds is not run again.

    Parameters
    ----------
    given : Search
    store : path of the store
    how : workers, scheduler, retry, progress, as in `md.sweep.execute`

    Raises
    ------
    As `md.sweep.execute`, ValueError if a target is not a number in the results of a run, RunError
    if no point has results at all targets.
    """
    box, whole_tally = None, Tally(0, 0, 0)
    parts, results, variances = [], [], []
    for number in range(given.rounds):
        parts.append(given.draw(number, box))
        sweep = given.sweep(parts[-1])
        if number == 0:
            _check_results(given, sweep.points[0], store)
        tally = execute(sweep, store, **how)
        whole_tally = Tally(
            *(a + b for a, b in zip(astuple(whole_tally), astuple(tally), strict=True))
        )
        runs = _at_targets(given, sweep, store)
        results.append(runs.mean(axis=-1))
        variances.append(runs.var(axis=-1, ddof=1) if len(given.seeds) > 1 else 0 * results[-1])
        known = np.concatenate(variances)
        count = np.maximum(np.isfinite(known).sum(axis=0), 1) * len(given.seeds)
        errors = np.sqrt(np.nansum(known, axis=0) / count)
        found = Found(given, np.concatenate(parts), np.concatenate(results), errors, whole_tally)
        if not np.isfinite(found.misfits).any():
            raise RunError(f"no point has all results at the targets; {tally.failed} runs failed")
        box = box_around(found.parts, found.misfits)
    return found


def _check_results(given: Search, point: Point, store: str | Path) -> None:
    """Refuse a target that is not a number in the results of a run.

    What the store holds shows it, else one period, before a search of hours.
    """
    results = None
    if not empty(store):
        with Store(store, write=False) as database:
            results = database.result(point.key)
    if results is None:
        try:
            shown = run(point.scene, periods=1)
        except (InputError, RunError):
            return
        if not shown.finished:
            raise KeyboardInterrupt
        results = shown.as_dict()
    for name in sorted({target.result for target in given.targets}):
        if not isinstance(named(results, name), int | float | None):
            raise InputError(f"targets ask for {name}, which is no number in the results of a run")


def _at_targets(given: Search, sweep: Sweep, store: str | Path) -> np.ndarray:
    """Results at the targets, (points, targets, starts)."""
    names = sorted({target.result for target in given.targets})
    tables = dict(zip(names, sweep.gather(store, *names), strict=True))
    return np.stack([tables[t.result][:, t.place] for t in given.targets], axis=1)


# ---- reading ----------------------------------------------------------------------------------


_Asked = tuple[dict[str, Any], str, float, float, float]  # place, result, limits, error


def _parameter(name: str, table: Any) -> Parameter:
    """A parameter from its table."""
    if isinstance(table, Mapping) and "choices" in table:
        tabled(name, table, ("choices",), ("name", "when"))
    else:
        tabled(name, table, ("keys", "from", "to"), ("name", "when", "log", "integer"))
    when = changes_of(f"{name}.when", table.get("when", {}))
    if "choices" in table:
        choices = table["choices"]
        if not isinstance(choices, Mapping) or len(choices) < 2:
            raise InputError(f"{name}.choices must be two tables or more, got {choices!r}")
        choices = {c: changes_of(f"{name}.choices.{c}", x) for c, x in choices.items()}
        return Parameter(str(table.get("name", name)), choices=choices, when=when)
    log, integer = (held(f"{name}.{x}", table.get(x, False), bool) for x in ("log", "integer"))
    keys = listed(table["keys"])
    if not keys or not all(isinstance(key, str) for key in keys):
        raise InputError(f"{name}.keys must be a list of keys of the scene, got {table['keys']!r}")
    limited = positive if log else finite
    low, high = limited(f"{name}.from", table["from"]), limited(f"{name}.to", table["to"])
    if not low < high:
        raise InputError(f"{name}.from must be less than to, got {low:g} and {high:g}")
    title = str(table.get("name", keys[0]))
    return Parameter(title, tuple(keys), low, high, log, None, when, integer)


def _measured(path: Path, result: str) -> list[_Asked]:
    """Rows of a CSV with measured results; lines that begin with # are comments.

    A row without a result is predicted: its limits and its error are nan.
    """
    try:
        lines = plain(path).read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as failure:
        reason = getattr(failure, "strerror", None) or failure
        raise InputError(f"data.file: {path} cannot be read ({reason})") from None
    rows = csv.reader("" if line.startswith("#") else line.strip() for line in lines)
    heads = [cell.strip() for cell in next(filter(None, rows), [])]
    asked = []
    for row in filter(None, rows):
        where = f"{path}, line {rows.line_num}"
        if len(row) > len(heads):
            raise InputError(f"{where} must have at most {len(heads)} cells, got {len(row)}")
        cells = dict.fromkeys(heads, "") | dict(zip(heads, row, strict=False))
        numbers = {key: _number(f"{where}, {key}", text.strip()) for key, text in cells.items()}
        value, error = numbers.pop(result, math.nan), numbers.pop("error", math.nan)
        error = math.nan if math.isnan(value) else positive(f"{where}, error", error)
        place = {key: int(x) if x.is_integer() else x for key, x in numbers.items()}
        asked.append((place, result, value, value, error))
    if not asked or not {result, "error"} < set(heads) or len(set(heads)) < len(heads):
        raise InputError(
            f"{path} must have columns {result}, error and keys of the scene, each once, with "
            f"commas between them, and rows; got {', '.join(heads) or 'nothing'}"
        )
    return asked


def _number(name: str, text: str) -> float:
    """A cell; nan if it is empty."""
    try:
        return finite(name, float(text)) if text else math.nan
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name} must be a number or empty, got {text!r}") from None


def _target(name: str, table: Any) -> _Asked:
    """A target from its table."""
    tabled(name, table, ("result", "holds", "error"), ("at",))
    holds = listed(table["holds"]) or []
    numbers = all(type(end) in (int, float) for end in holds)
    if not numbers or len(holds) != 2 or not holds[0] <= holds[1]:
        raise InputError(
            f"{name}.holds must be two numbers, the lower one first, got {table['holds']!r}"
        )
    error = positive(f"{name}.error", table["error"])
    place = changes_of(f"{name}.at", table.get("at", {}))
    return place, str(table["result"]), float(holds[0]), float(holds[1]), error


def _check_apart(parameters: tuple[Parameter, ...], places: list[dict[str, Any]]) -> None:
    """Refuse a key that is set twice under some choices, and a choice that is none."""
    choices = {p.name: [*p.choices] for p in parameters if p.choices}
    for parameter in parameters:
        for name, choice in (parameter.when or {}).items():
            if choice not in choices.get(name, []):
                raise InputError(f"{parameter.name}: when.{name} = {choice!r} is not a choice")
    given = ["start.seed", *(key for place in places for key in place)]
    for chosen in product(*choices.values()):
        values = {p.name: p.low for p in parameters} | dict(zip(choices, chosen, strict=True))
        setters = dict.fromkeys(given, "data, targets or seeds")
        for parameter in parameters:
            for key in parameter.changes(values):
                if key in setters:
                    both = f"{setters[key]} and by {parameter.name}"
                    raise InputError(f"{key} is set by {both} at once")
                setters[key] = parameter.name


def expand(tables: Mapping, base: Mapping, folder: Path = Path()) -> Search:
    """A search from its tables and those of its scene.

    Parameters
    ----------
    tables : of the search, as the module says
    base : tables of the scene, as `md.scene.read_tables` gives them
    folder : where the data are

    Raises
    ------
    ValueError, TypeError
        If something is missing or out of its domain; the message names it.
    """
    tabled("a search", tables, (), _KEYS)
    asked = []
    if "data" in tables:
        data = tabled("data", tables["data"], ("file", "result"))
        asked += _measured(folder / str(data["file"]), str(data["result"]))
    for i, table in enumerate(held("targets", tables.get("targets", []), list)):
        asked.append(_target(f"targets[{i}]", table))
    if all(math.isnan(error) for *_, error in asked):
        raise InputError("a search needs data, or targets: there are none")
    places: list[dict[str, Any]] = []
    for place, *_ in asked:
        if "start.seed" in place:
            raise InputError("start.seed must not stand in data or targets: seeds names the starts")
        if place not in places:
            places.append(place)
    ranges = held("parameters", tables.get("parameters", []), list)
    parameters = tuple(_parameter(f"parameters[{i}]", table) for i, table in enumerate(ranges))
    names = [parameter.name for parameter in parameters]
    if not names or len(set(names)) < len(names):
        raise InputError(f"parameters must be there, with different names, got {names}")
    _check_apart(parameters, places)
    seeds = listed(tables.get("seeds", [1, 2]))
    if not seeds or len(set(map(str, seeds))) < len(seeds):
        raise InputError(f"seeds must be a list of different starts, got {tables['seeds']!r}")
    points = whole("points", tables.get("points", 32), 4, 2**16)
    if points & (points - 1):
        raise InputError(
            f"points must be a power of two, as a Sobol sequence is even in these, got {points}"
        )
    return Search(
        base=base,
        common=changes_of("set", tables.get("set", {})),
        periods=whole("periods", tables.get("periods", 200), 1, MOST_PERIODS),
        seeds=tuple(whole("seeds", seed, 0, 2**32) for seed in seeds),
        parameters=parameters,
        places=tuple(places),
        targets=tuple(Target(r, places.index(p), low, high, e) for p, r, low, high, e in asked),
        points=points,
        rounds=whole("rounds", tables.get("rounds", 1), 1, 100),
        seed=whole("seed", tables.get("seed", 1), 0, 2**32),
    )


def load_search(path: str | Path) -> Search:
    """A search from a TOML file; its scene and data are files beside it, or the scene an example.

    Parameters
    ----------
    path : of the file, or the name of a file in `md/searches/` without its ending

    Raises
    ------
    ValueError, TypeError
        As `expand`, and if a file cannot be read.
    """
    found = Path(path)
    if not found.exists() and (_SEARCHES / f"{path}.toml").exists():
        found = _SEARCHES / f"{path}.toml"
    tables = read_tables(found, _SEARCHES)
    return expand(tables, scene_beside(found, tables), found.parent)
