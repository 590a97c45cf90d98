"""Data of figures in tiny sizes, each computed once for all tests of a process."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

import figures
from figures.checks import landing_census, row_motion, states
from figures.claims import any_rods, measure_rows
from figures.cost import (
    accuracy_cost_drift,
    accuracy_cost_ladder,
    effect_prices,
    price_page,
    scaling,
)
from figures.cost.scene_variants import GROUPS
from figures.lib import arrangement, runs
from figures.paper import fig02, fig04, fig05, fig07, fig08
from md.scene import load
from md.sweep import execute, expand

MOST_PERIODS = 8  # of a run of the paper's figures
FEW_EFFECTS = {
    "effect": ("gravity", "series of means"),
    "instead": ("inertia: solid",),
    "off": ("off: acceleration of the plate",),
}
FEW_TOUCHES = {"gamma": 2.0, "lossy": 0.5}
ESTIMATE = SimpleNamespace(mean=1.0, error=0.0)
RIGID = SimpleNamespace(flight=ESTIMATE, falling=ESTIMATE)
FEW = {
    **{"count": [24, 32, 40], "rolling": [24, 40], "narrow": [24], "rest": [24, 40]},
    **{"gamma": [1.6, 2.0, 3.3], "wall": [0.1, 0.3], "plate": [0.1, 0.3]},
    **{"plane": [15, 45], "seeds": [1, 2], "few_seeds": [1, 2]},
    **dict.fromkeys(("periods", "gamma_periods"), MOST_PERIODS),
}
SIZES = {
    any_rods: {"SETS": {True: 2}, "PERIODS": {True: MOST_PERIODS}},
    row_motion: {"ENDS_DEG": (20.0, 20.8), "WINDOW": 2},
    states: {"MAP": {True: ((9,), (runs.GAMMA,), 12)}, "LIVES": {True: ((9,), 2, 20)}},
    runs: {"SEEDS": {"start.seed": [1, 2]}},
    fig02: {"MAP_COUNTS": {True: (34, 24)}, "MAP_GAMMAS": {True: (1.2, 3.3)}},
    fig04: {
        "SIZES": {name: (few, few) for name, few in FEW.items()},
        "GAMMA_COUNTS": (40, 34, 24),
        "ANNULUS_COUNT": 32,
    },
    arrangement: {"EVERY": 2},
    fig05: {"EVERY": 2, "SHOWN_COUNTS": (32, 24)},
    fig07: {"TRANSIENT": 2, "lone": lambda _: (np.array([0.0]), [RIGID])},
    fig08: {"lone": lambda _: (np.array([0.0]), [RIGID])},
    measure_rows: {"FREQUENCY_TILTS_DEG": (21, 40)},
    landing_census: {
        "VARIED": {
            name: (key, (), (FEW_TOUCHES.get(name, 40.15),))
            for name, (key, *_) in landing_census.VARIED.items()
        }
    },
    accuracy_cost_drift: {
        **{
            "CUT": 20,
            "LONG_PERIODS": {True: 300},
            "PER_CONTACT": (16, 18, 25, 36, 40),
            "PAPER_STEP": 1e-4,
        },
        **{"DRIFT_TOLERANCES": (0.4,)},
        "asked": lambda: dict.fromkeys(("row", "other", "mine", "annulus"), load("quasi2d")),
        "seconds_per_period": lambda scenes: np.array([1e-3 / s.step.size for s in scenes]),
    },
    accuracy_cost_ladder: {
        **{"LADDER_PERIODS": {True: 4}, "TRUSTED_PERIODS": {True: 4}, "LANDINGS": (30,)},
        **{"STEPS_PER_CONTACT": 13, "TRUSTED_STEPS": 13, "TRUSTED_STARTS": 3},
        **{"STEPS": (13,), "ROWS": {"rods": {"N=5": {"rods.count": 5, "box.length": 5.375}}}},
    },
    effect_prices: {
        **{"PLACES": 2, "PART": 400, "WARM_STEPS": 1},
        **{"ROUNDS": {True: 6}, "PRICE_SETTLE": {True: 1, False: 4}},
        **{"DRIFT_SEEDS": {True: 2}, "DRIFT_PERIODS": {True: 4}},
        "GROUPS": {group: {n: GROUPS[group][n] for n in few} for group, few in FEW_EFFECTS.items()},
    },
    scaling: {
        **{"ROW_SIZES": {True: (4, 8)}, "LEAST": 8, "RUNS_PER_CORE": 1, "SWEEP_PERIODS": 1},
        **{"SCALING_ROUNDS": {True: 3}, "SCALING_SETTLE": {True: 1}, "REPEATS": {True: 2}},
    },
    price_page: {"IMPACTS": 1000, "CHECKED": 200},
}


@contextmanager
def tiny() -> Iterator[pytest.MonkeyPatch]:
    """Small sizes and short runs, in this process; a run that fails is an error."""

    def short(tables, base):
        return expand({**tables, "periods": min(tables["periods"], MOST_PERIODS)}, base)

    def alone(sweep, store, **options):
        tally = execute(sweep, store, **{**options, "workers": 1})
        assert not tally.failed
        return tally

    with pytest.MonkeyPatch.context() as patch:
        for module, sizes in SIZES.items():
            for name, size in sizes.items():
                patch.setattr(module, name, size)
        patch.setattr(runs, "expand", short)
        patch.setattr(runs, "execute", alone)
        yield patch


@cache
def data(name: str) -> dict[str, np.ndarray]:
    """Data of a figure in the small size; tests must not change them."""
    with tiny():
        return figures.load(name).data(quick=True)
