"""Searches: which parameters of a scene give what was measured.

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
    to = 0.6                          # log = true: evenly in log

    [data]                            # or several, each [[data]]
    file = "drift.csv"                # columns: keys of the scene, the result, and `error`
    result = "c_x_cm_s"               # a row without it asks for it: it is predicted

Parameters are drawn from a Sobol sequence; every point is run at all places of the data with
all starts, by `md.sweep` into its store, so that a search goes on where it stopped. The misfit of a
point is the sum of squares of (result - datum)/error, where the error is that of the data and of
the means over the starts together. Of two contact laws, say, the one whose search ends with the
smaller misfit fits better.

Between the points each result is a polynomial of the parameters. From it follow the
estimate of each parameter, with weights exp(-misfit/2), and what is predicted with its uncertainty.
For these the error is that of the data and the distance by which the polynomial misses a point, the
scatter of its runs included. So errors are rather too large; further rounds, which look closer, and
longer runs make them smaller.

They hold if the scene can fit the data, if the truth is within the ranges, and if results are as
rough there as at the other points near the best one: beside a jump an estimate can be off by three
errors. The least misfit of this fit is told, and should be no more than about the number of data.
So should the least one of a point: where it is not, the polynomial may hide behind the scatter of
the runs that the scene does not fit. Runs that are much shorter than those of the data bring their
transient in.
"""

import csv
import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement, product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from emcee import EnsembleSampler
from scipy.stats import qmc

from .domains import InputError, RunError, held, listed, number, positive, span, tabled, whole
from .files import text_of
from .scene import changes_of, put, read_tables, scene_beside
from .simulation import MOST_PERIODS
from .sweep import Sweep, Tally, execute, point_at

_KEYS = "scene", "periods", "seeds", "points", "rounds", "set", "parameters", "data"
_SEARCHES = Path(__file__).parent / "searches"
_ENOUGH = 1.5  # points a coefficient that a polynomial needs
_WALKERS = 2**8  # that draw
_WARM_UPS, _WARM_UP, _STEPS = 6, 25, 150  # steps before draws, and of draws
_THIN = 10  # steps from draw to draw
_SEED = 1  # of all random numbers
_AS_GOOD = 10.0  # more misfit than the best point has: it may be chance


class Parameter(NamedTuple):
    """A parameter of a search: keys of the scene and the range of their value.

    name : in messages and tables
    keys : of the scene, which all take the value
    low : end of the range
    high : the other
    log : whether values lie evenly in log
    """

    name: str
    keys: tuple[str, ...]
    low: float
    high: float
    log: bool = False

    def value(self, part: Any) -> Any:
        """The value at a part of the range, from 0 to 1.

        Parameters
        ----------
        part : 0 <= part < 1, a number or an array
        """
        if self.log:
            return self.low * (self.high / self.low) ** part
        return self.low + (self.high - self.low) * part


class Target(NamedTuple):
    """One datum: the measured value of a result at one place of the scene.

    place : values of keys of the scene
    result : such as "c_x_cm_s"
    value : nan: it is only predicted
    error : standard error
    """

    place: Mapping[str, Any]
    result: str
    value: float
    error: float


@dataclass(frozen=True)
class Search:
    """A search, read and checked.

    base : tables of the scene
    periods : of each run
    seeds : starts
    parameters : that are varied
    targets : what is asked for
    points : a round
    rounds : each later one closer around the best
    """

    base: Mapping[str, Any]
    periods: int
    seeds: tuple[int, ...]
    parameters: tuple[Parameter, ...]
    targets: tuple[Target, ...]
    points: int
    rounds: int

    def misfit(self, results: np.ndarray, variance: Any) -> np.ndarray:
        """Sum over the targets of ((result - datum)/error)^2; one without a datum does not count.

        Parameters
        ----------
        results : (..., targets)
        variance : of the results
        """
        value, error = np.array([(target.value, target.error) for target in self.targets]).T
        squares = (results - value) ** 2 / (error**2 + variance)
        return np.sum(squares, axis=-1, where=~np.isnan(value))

    def values(self, parts: Iterable) -> dict[str, Any]:
        """Values of the parameters at a place in their ranges.

        Parameters
        ----------
        parts : (parameters,) or (parameters, n): parts of the ranges, 0 to 1
        """
        return {p.name: p.value(x) for p, x in zip(self.parameters, parts, strict=True)}

    def sweep(self, parts: np.ndarray) -> Sweep:
        """Sweep over points, targets and starts; a run that several targets share is made once.

        Parameters
        ----------
        parts : (points, parameters): parts of the ranges, 0 to 1

        Raises
        ------
        ValueError, TypeError
            If a point is not a scene that can run; the message names the point.
        """
        runs = []
        for row in parts.tolist():
            values = self.values(row)
            changes = {key: values[p.name] for p in self.parameters for key in p.keys}
            for target, seed in product(self.targets, self.seeds):
                changed = {**changes, **target.place, "start.seed": seed}
                runs.append(point_at(self.base, changed, {**values, **target.place}, self.periods))
        points = {"point": [*range(len(parts))]}
        axes = points, {"target": [*self.targets]}, {"start.seed": [*self.seeds]}
        return Sweep(axes, tuple(runs))


class Estimate(NamedTuple):
    """A value with its standard error.

    value : mean
    error : one standard deviation
    """

    value: float
    error: float


class Estimates(NamedTuple):
    """Estimates from all points near the best one; empty if there are too few of them.

    parameters : estimates by the names of the parameters
    correlation : matrix of the parameters' correlations
    results : predicted result of each target
    misfit : least misfit of the fit; far beyond the number of data where no scene fits them
    """

    parameters: dict[str, Estimate]
    correlation: np.ndarray
    results: list[Estimate]
    misfit: float


@dataclass(frozen=True)
class Found:
    """Outcome of a search: points, results of their runs, misfits and estimates.

    search : that was made
    parts : (n, parameters): points of all rounds as parts of the ranges
    runs : (n, targets, starts): results; nan where a run failed
    tally : of all rounds
    """

    search: Search
    parts: np.ndarray
    runs: np.ndarray
    tally: Tally

    @property
    def results(self) -> np.ndarray:
        """Results as means over the starts, (n, targets)."""
        return self.runs.mean(axis=-1)

    @cached_property
    def misfits(self) -> np.ndarray:
        """Misfit of each point, (n,); inf where a run failed."""
        starts = self.runs.shape[-1]
        scatter = self.runs.var(axis=-1, ddof=int(starts > 1))  # of one start: none
        variance = np.nanmean(scatter, axis=0) / starts
        return np.nan_to_num(self.search.misfit(self.results, variance), nan=np.inf)

    @property
    def box(self) -> np.ndarray:
        """Ends of a box around the best quarter of the points and some way beyond, (2, parameters).

        Where no point lies beyond them, it goes on to the end of the range.
        Points that are as good as the best one belong to the best, however many they are.
        """
        parts, misfits = self.parts, self.misfits
        good = np.sum(misfits < misfits.min() + _AS_GOOD)
        few = max(len(parts) // 4, 2 * (parts.shape[1] + 1), good)
        near = parts[np.argsort(misfits)[:few]]
        low, high = near.min(axis=0), near.max(axis=0)
        margin = (high - low) / 4
        low = (low - margin) * (low > parts.min(axis=0))
        high = 1 - (1 - high - margin) * (high < parts.max(axis=0))
        return np.clip([low, high], 0, 1)

    @cached_property
    def estimates(self) -> Estimates:
        """Estimates near the best point: means over draws with weights exp(-misfit/2)."""
        search, (low, high) = self.search, self.box
        middle, half = (low + high) / 2, (high - low) / 2
        places = (self.parts - middle) / half
        near = (np.abs(places) <= 1).all(axis=1) & np.isfinite(self.results).all(axis=1)
        if near.sum() < _ENOUGH * (len(half) + 1):
            return Estimates({}, np.empty((0, 0)), [], math.nan)
        predicted, variance = _surfaces(places[near], self.results[near])

        def misfit(places: np.ndarray) -> np.ndarray:
            return search.misfit(predicted(places), variance)

        draws = _draws(misfit, len(half))
        values = search.values((middle + half * draws).T)
        results = predicted(draws)
        spread = np.sqrt(results.var(axis=0) + variance)
        return Estimates(
            {name: Estimate(float(x.mean()), float(x.std())) for name, x in values.items()},
            np.atleast_2d(np.corrcoef([*values.values()])),
            [*map(Estimate, results.mean(axis=0).tolist(), spread.tolist())],
            float(misfit(draws).min()),
        )


def search(given: Search, store: str | Path, **how: Any) -> Found:
    """Make a search round by round; runs that the store holds are not made again.

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
    held("given", given, Search)
    parts, runs, low, high = [], [], 0.0, 1.0
    tally: Counter[str] = Counter()
    for made in range(given.rounds):
        drawn = qmc.Sobol(len(given.parameters), seed=_SEED + made).random(given.points)
        parts.append(low + drawn * (high - low))
        sweep = given.sweep(parts[-1])
        tally.update(vars(execute(sweep, store, **how)))
        runs.append(_at_targets(given, sweep, store))
        found = Found(given, np.concatenate(parts), np.concatenate(runs), Tally(**tally))
        if not np.isfinite(found.results).all(axis=1).any():
            raise RunError(
                f"no point has all results at the targets; {found.tally.failed} runs failed"
            )
        low, high = found.box
    return found


def _at_targets(given: Search, sweep: Sweep, store: str | Path) -> np.ndarray:
    """Results of a round at the targets, (points, targets, starts); nan where a run failed."""
    found = sweep.gather(store, *(target.result for target in given.targets))
    for target, results in zip(given.targets, found, strict=True):
        if results.shape != sweep.shape or results.dtype != float:
            raise InputError(f"data ask for {target.result}, which is no number")
    return np.einsum("tpts->pts", found)  # of each target's results those at its own place


# ---- from results to estimates ------------------------------------------------------------------


def _surfaces(places: np.ndarray, results: np.ndarray) -> tuple[Callable, np.ndarray]:
    """Polynomials of coordinates between -1 and 1, one fitted to each result.

    Their degree is the highest one for which there are enough points. They may be off at any place
    by as much as they miss a point that is left out of the fit: how far a result is from a
    polynomial does not average out, and what else scatters them is not told from that.

    Parameters
    ----------
    places : (n, coordinates), enough for polynomials of degree 1
    results : (n, targets)

    Returns
    -------
    Function of places, (m, coordinates), that gives the values of the polynomials, (m, targets),
    and their variances, (targets,).
    """
    degree = max(k for k in (1, 2, 3) if len(places) >= _ENOUGH * math.comb(places.shape[1] + k, k))
    terms = _terms(places, degree)
    inverse = np.linalg.pinv(terms)
    weights = inverse @ results
    own = np.sum(terms * inverse.T, axis=1)  # weight of each point in the value at its place
    missed = (results - terms @ weights) / np.maximum(1 - own, 1e-9)[:, None]
    return lambda places: _terms(places, degree) @ weights, np.mean(missed**2, axis=0)


def _terms(places: np.ndarray, degree: int) -> np.ndarray:
    """Products of up to `degree` coordinates, a column each; the first one is 1."""
    factors = np.insert(places, 0, 1.0, axis=1)  # by ones, products of fewer coordinates
    chosen = [*combinations_with_replacement(range(factors.shape[1]), degree)]
    return factors.take(chosen, axis=1).prod(axis=2)


def _draws(misfit: Callable[[np.ndarray], np.ndarray], coordinates: int) -> np.ndarray:
    """Draw places between -1 and 1 with weights exp(-misfit/2), (n, coordinates).

    By emcee's stretch move, which needs no smaller moves along a ridge (Goodman and Weare, Commun.
    Appl. Math. Comput. Sci. 5, 65, 2010). Walkers begin at evenly spread places; before draws
    begin, the worse half of them goes to where the better half is, so that none is held in a lesser
    minimum.

    Parameters
    ----------
    misfit : of places, (n, coordinates) to (n,)
    coordinates : their number
    """

    def log_weight(places: np.ndarray) -> np.ndarray:
        return np.where((np.abs(places) <= 1).all(axis=1), -misfit(places) / 2, -np.inf)

    walkers = 2 * qmc.Sobol(coordinates, seed=_SEED).random(_WALKERS) - 1
    sampler = EnsembleSampler(_WALKERS, coordinates, log_weight, vectorize=True)
    sampler.random_state = np.random.RandomState(_SEED).get_state()
    for _ in range(_WARM_UPS):
        state = sampler.run_mcmc(walkers, _WARM_UP, store=False, skip_initial_state_check=True)
        better = state.coords[np.argsort(state.log_prob)[_WALKERS // 2 :]]
        walkers = np.concatenate([better, better])
    sampler.run_mcmc(walkers, _STEPS, skip_initial_state_check=True)
    return sampler.get_chain(thin=_THIN, flat=True)


# ---- reading ----------------------------------------------------------------------------------


def _parameter(name: str, table: Any) -> Parameter:
    """Make a parameter from its table."""
    tabled(name, table, ("keys", "from", "to"), ("name", "log"))
    keys = listed(table["keys"]) or []
    if {*map(type, keys)} != {str}:
        raise InputError(f"{name}.keys must be a list of keys of the scene, got {table['keys']!r}")
    found = Parameter(str(table.get("name", keys[0])), tuple(keys), *span(name, table))
    if not found.low < found.high:
        raise InputError(f"{name}.from must be less than to, got {found.low:g} and {found.high:g}")
    return found


def _measured(path: Path, result: str) -> list[Target]:
    """Read the targets of a CSV file; lines whose first letter is # are comments.

    A row without a result is predicted: its value is nan.
    """
    lines = (line for line in text_of(path).splitlines() if line.partition("#")[0].strip())
    try:
        heads, *rows = [[cell.strip() for cell in row] for row in csv.reader(lines)] or [[]]
    except csv.Error as why:  # a cell of a hundred thousand letters
        raise InputError(f"{path}: {why}") from None
    if not rows or not {result, "error"} < set(heads) or len(set(heads)) < len(heads):
        raise InputError(
            f"{path} must have columns {result}, error and keys of the scene, each once, and rows; "
            f"got {', '.join(heads)}"
        )
    targets = []
    for count, row in enumerate(rows, 1):
        where = f"{path}, row {count}"
        try:
            if "nan" in ",".join(row).lower():  # an empty cell asks, a failed measurement does not
                raise ValueError
            cells = dict(zip(heads, (float(cell or "nan") for cell in row), strict=True))
        except ValueError:
            raise InputError(
                f"{where}, must have {len(heads)} numbers or empty cells, got {', '.join(row)}"
            ) from None
        value, error = cells.pop(result), cells.pop("error")
        if not math.isnan(value):
            number(f"{where}, {result}", value, -1e100, 1e100)
            positive(f"{where}, error", error)
        place = {key: int(x) if x.is_integer() else x for key, x in cells.items()}
        targets.append(Target(place, result, value, error))
    return targets


def expand(tables: Mapping, base: Mapping, folder: Path = Path()) -> Search:
    """Make a search from its tables and those of its scene.

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
    targets: list[Target] = []
    data = tables.get("data", [])
    for table in data if isinstance(data, list) else [data]:
        tabled("data", table, ("file", "result"))
        targets += _measured(folder / str(table["file"]), str(table["result"]))
    if all(math.isnan(target.value) for target in targets):
        raise InputError("a search needs data: there are none")
    ranges = held("parameters", tables.get("parameters", []), list)
    parameters = tuple(_parameter(f"parameters[{i}]", table) for i, table in enumerate(ranges))
    names = [parameter.name for parameter in parameters]
    if not names or len({*names, "misfit"}) <= len(names):  # the misfit is a column beside them
        raise InputError(
            f"parameters must be one or more, with different names other than misfit, got {names}"
        )
    common = changes_of("set", tables.get("set", {}))
    places = dict.fromkeys(key for target in targets for key in target.place)
    varied = [key for parameter in parameters for key in parameter.keys]
    for key, times in Counter(["start.seed", *common, *places, *varied]).items():
        if times > 1:
            raise InputError(f"{key} is set twice at once, by set, parameters, data or seeds")
    given = listed(tables.get("seeds", [1, 2])) or []
    seeds = tuple(whole("seeds", seed, 0, 2**32) for seed in given)
    if not seeds or len(set(seeds)) < len(seeds):
        raise InputError(f"seeds must be a list of different starts, got {tables['seeds']!r}")
    points = whole("points", tables.get("points", 32), 4, 2**16)
    if points.bit_count() > 1:
        raise InputError(f"points must be a power of two, for a Sobol sequence, got {points}")
    return Search(
        base=put(base, common),
        periods=whole("periods", tables.get("periods", 200), 1, MOST_PERIODS),
        seeds=seeds,
        parameters=parameters,
        targets=tuple(targets),
        points=points,
        rounds=whole("rounds", tables.get("rounds", 1), 1, 100),
    )


def load_search(path: str | Path) -> Search:
    """Read a search from a TOML file; its data and its scene, or an example, are files beside it.

    Parameters
    ----------
    path : of the file, or the name of a file in `md/searches/` without its ending

    Raises
    ------
    ValueError, TypeError
        As `expand`, and if a file cannot be read.
    """
    folder = Path(path).parent if Path(path).exists() else _SEARCHES
    tables = read_tables(path, _SEARCHES)
    return expand(tables, scene_beside(path, tables), folder)
