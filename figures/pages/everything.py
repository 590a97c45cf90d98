"""All figures and claims at full quality: what is left to do, and about how long that takes."""

import json
from collections.abc import Iterable
from dataclasses import fields, is_dataclass
from heapq import heapreplace
from itertools import pairwise
from pathlib import Path
from time import thread_time
from typing import Any

import numpy as np
from joblib import Parallel, cpu_count, delayed

import impact
import md
from md.host import step_of
from md.scene import Scene, from_tables
from md.store import Store
from md.sweep import Point

from .. import FIGURES, load
from ..claims import row_numbers as measured
from ..lib.runs import ROW, store

# Seconds of the processor in full, runs of the store apart, where a step of a rod of `ROW` takes
# `STEP` seconds; of figures not named here, `USUAL`.
SECONDS = {
    "effect_prices": 200,
    "accuracy_cost_drift": 60,
    "accuracy_cost_ladder": 60,
    "scaling": 120,
    "accuracy_map": 36,
    "alpha": 47,
    "fig08_theory": 34,
    "fig02": 29,
    "accuracy_cost_impact": 19,
    "free_rod": 12,
    "accuracy_cost_theory": 14,
    "fig07": 9,
    "appendix_a": 8,
}
USUAL, MOVIE, CLAIMS, STEP = 3, 5, 15, 24.5e-9
AGAIN = "fig02", "fig05", "alpha", "appendix_a"  # whose data the claims compute once more
SAMPLES, RARE = 48, 0.05  # runs that are timed; share of the work of a kind that is not
SETTLE, TIMED = 3, 12  # periods of each


def left(out: Path) -> list[str]:
    """Figures whose files in `out` are not there, not in full, or older than a source."""
    folders = (Path(str(package.__file__)).parent for package in (md, impact, measured))
    files = (path for folder in folders for path in folder.rglob("*"))
    newest = max(p.stat().st_mtime for p in files if p.suffix in (".py", ".toml", ".mplstyle"))
    return [name for name in FIGURES if not _done(name, out, newest)]


def _done(name: str, out: Path, newest: float) -> bool:
    paths = [out / f"{name}.{kind}" for kind in ("npz", "png", "pdf")]
    if not all(path.is_file() and path.stat().st_mtime > newest for path in paths):
        return False
    with np.load(paths[0]) as stored:
        return not json.loads(str(stored["provenance"]))["quick"]


def missing() -> list[list[Point]]:
    """Runs that the store does not hold, of each sweep of the figures and claims; none twice."""
    modules = [load(name) for name in FIGURES] + [measured]
    known: set[str] = set()
    plan = []
    with Store(store()) as database:
        for sweep in (s for m in modules if hasattr(m, "sweeps") for s in m.sweeps().values()):
            new = {p.key: p for p in sweep.points if p.key not in known and not database.has(p.key)}
            known |= new.keys()
            plan.append(list(new.values()))
    return plan


def rod_steps(point: Point) -> int:
    """Steps times rods of a run; 0 where a tolerance says how long it is."""
    return point.periods * step_of(point.scene)[1] * point.scene.rods.count


def _kind(part: Any) -> Any:
    """What tells one kernel from another: all of a scene but its start and sizes of numbers."""
    if is_dataclass(part):
        names = (field.name for field in fields(part))
        return tuple(_kind(getattr(part, name)) for name in names if name not in ("start", "step"))
    if isinstance(part, tuple):
        return tuple(map(_kind, part))
    return part is None if isinstance(part, str | None) else bool(part)


def _crowding(point: Point) -> tuple[float, float]:
    """Speed of the plate and density: what decides how many rods touch."""
    scene = point.scene
    return scene.plate_speed, scene.rods.count / (scene.box.length if scene.box else 1)


def _strata(points: list[Point]) -> list[list[Point]]:
    """Runs much alike, each list about as much work; kinds that are rare stay out."""
    kinds: dict[Any, list[Point]] = {}
    for point in sorted(points, key=_crowding):
        kinds.setdefault(_kind(point.scene), []).append(point)
    work = {kind: sum(map(rod_steps, alike)) for kind, alike in kinds.items()}
    rank = sorted(kinds, key=lambda kind: work[kind])
    most = {kinds[kind][0].scene.annulus is None: kind for kind in rank}
    strata = []
    for kind, alike in kinds.items():
        share = work[kind] / max(sum(work.values()), 1)
        if share >= RARE or kind in most.values():
            count = min(max(round(SAMPLES * share), 1), len(alike))
            edges = np.linspace(0, len(alike), count + 1).astype(int).tolist()
            strata += [alike[i:j] for i, j in pairwise(edges)]
    return strata


def timed(scene: Scene) -> tuple[float, float]:
    """Seconds until its kernel is there, and processor seconds of a period of a run under way."""
    seconds = []
    try:
        ready = md.run(scene, periods=1).compile_seconds
        for periods in (SETTLE, SETTLE + TIMED):
            begin = thread_time()
            md.run(scene, periods=periods)
            seconds.append(thread_time() - begin)
    except md.RunError:  # will fail as soon in the sweep
        return 0.0, 0.0
    return ready, max(seconds[1] - seconds[0], 0.0) / TIMED


def run_seconds(points: list[Point]) -> tuple[dict[str, float], float]:
    """Processor seconds of each run, by its key, and of compiling what is not compiled yet.

    One run of each stratum, drawn at random, is timed for a few periods, on all cores at once; its
    step of a rod stands for the others'. A rare kind takes the mean of its arrangement.
    """
    strata, random = _strata(points), np.random.default_rng(1)
    drawn = [alike[random.integers(len(alike))].scene for alike in strata]
    kinds = [_kind(scene) for scene in drawn]
    order = sorted(range(len(drawn)), key=lambda i: kinds.index(kinds[i]) < i)  # kernels first
    found = Parallel(n_jobs=-1, batch_size=1)(delayed(timed)(drawn[i]) for i in order)
    step, ready = dict[str, Any](), dict[Any, float]()  # by key, by kind
    for i, (compiled, period) in zip(order, found, strict=True):
        of_rod = period / (step_of(drawn[i])[1] * drawn[i].rods.count)
        step |= {point.key: of_rod for point in strata[i]}
        ready[kinds[i]] = max(ready.get(kinds[i], 0.0), compiled)
    for plane in (True, False):
        alike = [p for p in points if (p.scene.annulus is None) is plane]
        usual = np.mean([step[p.key] for p in alike if p.key in step] or [0.0])
        step = {p.key: usual for p in alike} | step
    rare = {_kind(point.scene) for point in points} - ready.keys()
    seconds = {point.key: rod_steps(point) * step[point.key] for point in points}
    return seconds, len(rare) * min(ready.values(), default=0.0)


def _span(seconds: Iterable[float], cores: int) -> float:
    """From the first to the last of runs that begin in this order, each where a core is free."""
    free = [0.0] * cores
    for run in seconds:
        heapreplace(free, free[0] + run)
    return max(free)


def estimate(out: Path) -> str:
    """What is left, in words."""
    plan, names, cores = missing(), left(out), cpu_count()
    seconds, compiling = run_seconds([point for points in plan for point in points])
    runs = compiling + sum(_span((seconds[p.key] for p in points), cores) for points in plan)
    others = sum(SECONDS.get(name, USUAL) for name in (*names, *AGAIN))
    here = from_tables(ROW)
    period = np.median([timed(here)[1] for _ in range(5)])
    others = (others + MOVIE + CLAIMS) * period / (step_of(here)[1] * here.rods.count) / STEP
    return (
        f"{len(seconds)} runs that the store lacks: {_minutes(runs)} on {cores} cores; "
        f"{len(names)} figures of {len(FIGURES)}, movie and claims: {_minutes(others)}; "
        f"in all about {_minutes(runs + others)}, if nothing else runs"
    )


def _minutes(seconds: float) -> str:
    return f"{seconds / 60:.0f} min" if seconds > 90 else f"{seconds:.0f} s"
