"""All figures and claims at full quality: what is left to do, and about how long that takes."""

import json
from pathlib import Path

import numpy as np
from joblib import cpu_count

import impact
import md
from md.cache import digest
from md.engine import step_of
from md.store import Store
from md.sweep import Point

from . import FIGURES, load, measured
from .rows import planned, store

# Seconds in full, runs of the store apart, as measured on two cores of a busy AMD EPYC; of figures
# not named here, `USUAL`.
SECONDS = {
    "effect_prices": 420,
    "accuracy_cost_drift": 400,
    "landing_census": 250,
    "fig05": 300,
    "accuracy_cost_ladder": 150,
    "scaling": 120,
    "accuracy_map": 65,
    "alpha": 50,
    "fig08_theory": 40,
    "fig02": 35,
    "accuracy_cost_impact": 25,
    "free_rod": 20,
    "accuracy_cost_theory": 20,
    "rigid_limit": 12,
}
USUAL, MOVIE, CLAIMS = 5, 5, 120


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


def missing() -> list[Point]:
    """Runs of the figures' and the claims' sweeps that the store does not hold."""
    modules = [load(name) for name in FIGURES] + [measured]
    sweeps = [s for m in modules if hasattr(m, "sweeps") for s in m.sweeps().values()]
    points = {point.key: point for sweep in sweeps for point in sweep.points}
    with Store(store()) as database:
        return [point for key, point in points.items() if not database.has(key)]


def rod_step_seconds() -> float:
    """Of all runs of the store together; if there is none, of a short run made now."""
    with Store(store()) as database:
        runs = [run for run in database.rows() if run["result"] and run["code"] == digest()]
    if runs:
        return sum(r["seconds"] for r in runs) / sum(r["result"]["rod_steps"] for r in runs)
    scene = planned([{"start.seed": [1]}], 1).points[0].scene
    md.run(scene, periods=1)  # compiles
    result = md.run(scene, periods=20)
    return result.run_seconds / result.rod_steps


def estimate(out: Path) -> str:
    """What is left, in words."""
    points, names = missing(), left(out)
    steps = sum(p.periods * step_of(p.scene)[1] * p.scene.rods.count for p in points)
    rows = steps * rod_step_seconds() / cpu_count() if points else 0.0
    others = sum(SECONDS.get(name, USUAL) for name in names) + CLAIMS + MOVIE
    return (
        f"{len(points)} runs that the store lacks: {_minutes(rows)} on {cpu_count()} cores; "
        f"{len(names)} figures of {len(FIGURES)}, movie and claims: {_minutes(others)}; "
        f"in all about {_minutes(rows + others)}"
    )


def _minutes(seconds: float) -> str:
    return f"{seconds / 60:.0f} min" if seconds > 90 else f"{seconds:.0f} s"
