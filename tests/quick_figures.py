"""Figures in tiny sizes: their data, computed once in a process, and their pictures."""

import re
from contextlib import contextmanager
from functools import cache
from types import SimpleNamespace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import to_hex, to_rgba_array
from matplotlib.text import Text

import figures
from figures.checks import landing_census, row_motion, states, two_codes
from figures.claims import any_rods, measure_rows
from figures.cost import (
    accuracy_cost_drift,
    accuracy_cost_ladder,
    effect_prices,
    price_page,
    scaling,
)
from figures.cost.scene_variants import GROUPS
from figures.lib import arrangement, runs, style
from figures.lib.printing import printed
from figures.paper import fig02, fig04, fig05, fig07, fig08
from md import simulation
from md.host import prepare
from md.scene import load
from md.sweep import execute, expand

MOST_PERIODS = 8  # of a run of the paper's figures
TOO_FEW = {"fig04", "landing_census", "states"}  # tiny runs leave some of their numbers open
COLOUR_WORDS = "black", "blue", "green", "orange", "red"
COLOURS = {getattr(style, word.upper()).lower(): word for word in COLOUR_WORDS}
OTHER_KERNELS = {"rods.rolling", "annulus.shaken"}  # each takes ten seconds to compile
FEW_EFFECTS = {
    "effect": ("gravity", "series of means"),
    "instead": ("inertia: solid",),
    "off": ("off: acceleration of the plate",),
}
FEW_TOUCHES = {"gamma": 2.0, "lossy": 0.5}
OWN_VALUES = [(0.05, 0.0), (0.2, 0.3), (0.5, 0.65), (0.8, 0.9), (1.2, 1.0)]  # friction, restitution
ESTIMATE = SimpleNamespace(mean=1.0, error=0.0)
RIGID = SimpleNamespace(flight=ESTIMATE, falling=ESTIMATE)
FEW = {
    "count": [24, 32, 40],
    "rolling": [24, 40],
    "narrow": [24],
    "rest": [24, 40],
    "gamma": [2.0, 3.3],
    "wall": [0.1, 0.3],
    "plate": [0.1, 0.3],
    "plane": [15, 45],
    "seeds": [1, 2],
    "few_seeds": [1, 2],
    **dict.fromkeys(("periods", "gamma_periods"), MOST_PERIODS),
}


def _in_small(effect):
    """An effect whose price in the full scene is that in a small one, which compiles quickly."""
    return effect if effect.drifts else effect._replace(within=effect.alone)


def _short_row(dt, seed=1):
    """The row of ten rods in place of forty."""
    short = ["rods.count=10", "box.length=10.75", "start.speed=0.3", f"start.seed={seed}"]
    return load("quasi2d", [*short, f"step.size={dt}", "step.coarse=true"])


def _watched(scene, **_):
    """An engine with ledger and record, which change no bit: all runs share its kernel."""
    return prepare(scene)


SIZES = {
    any_rods: {"SETS": {True: 2}, "PERIODS": {True: MOST_PERIODS}},
    row_motion: {"ENDS_DEG": (20.0, 20.8), "WINDOW": 2, "prepare": _watched},
    simulation: {"prepare": _watched},
    states: {"MAP": {True: ((9,), (runs.GAMMA,), 12)}, "LIVES": {True: ((9,), 2, 20)}},
    runs: {"SEEDS": {"start.seed": [1, 2]}},
    fig02: {"MAP_COUNTS": {True: (34, 24)}, "MAP_GAMMAS": {True: (1.2, 3.3)}},
    fig04: {
        "SIZES": {name: (few, few) for name, few in FEW.items()},
        "GAMMA_COUNTS": (40, 32, 24),
        "ANNULUS_COUNT": 32,
    },
    arrangement: {"EVERY": 2, "prepare": _watched},
    fig05: {"EVERY": 2, "SHOWN_COUNTS": (32, 24)},
    fig07: {"TRANSIENT": 2, "lone": lambda *_: (np.array([0.0]), [RIGID])},
    fig08: {"lone": lambda *_: (np.array([0.0]), [RIGID])},
    measure_rows: {"FREQUENCY_TILTS_DEG": (21, 40)},
    two_codes: {"SEEDS": {"start.seed": [1, 2]}},
    landing_census: {
        "CONTACTS": dict.fromkeys(landing_census.CONTACTS, landing_census.CONTACTS["constraint"]),
        "VARIED": {
            name: (key, (), (FEW_TOUCHES.get(name, 40.15),))
            for name, (key, *_) in landing_census.VARIED.items()
        },
    },
    accuracy_cost_drift: {
        "CUT": 20,
        "LONG_PERIODS": {True: 300},
        "PER_CONTACT": (16, 18, 25, 36, 40),
        "PAPER_STEP": 1e-4,
        "DRIFT_TOLERANCES": (0.4,),
        "_scene": _short_row,
        "asked": lambda: dict.fromkeys(("row", "other", "mine", "annulus"), load("quasi2d")),
        "seconds_per_period": lambda scenes: np.array([1e-3 / s.step.size for s in scenes]),
    },
    accuracy_cost_ladder: {
        "LADDER_PERIODS": {True: 4},
        "TRUSTED_PERIODS": {True: 4},
        "LANDINGS": (30,),
        "STEPS_PER_CONTACT": 13,
        "TRUSTED_STEPS": 13,
        "TRUSTED_STARTS": 3,
        "STEPS": (13,),
        "ROWS": {"rods": {"N=5": {"rods.count": 5, "box.length": 5.375}}},
    },
    effect_prices: {
        "PLACES": 2,
        "PART": 400,
        "WARM_STEPS": 1,
        "ROUNDS": {True: 6},
        "PRICE_SETTLE": {True: 1, False: 4},
        "DRIFT_SEEDS": {True: 2},
        "DRIFT_PERIODS": {True: 4},
        "GROUPS": {
            group: {name: _in_small(GROUPS[group][name]) for name in few}
            for group, few in FEW_EFFECTS.items()
        },
    },
    scaling: {
        "ROW_SIZES": {True: (4, 8)},
        "LEAST": 8,
        "RUNS_PER_CORE": 1,
        "SWEEP_PERIODS": 1,
        "SCALING_ROUNDS": {True: 3},
        "SCALING_SETTLE": {True: 1},
        "REPEATS": {True: 2},
    },
    price_page: {"IMPACTS": 1000, "CHECKED": 200},
}


@contextmanager
def tiny():
    """Small sizes and short runs, in this process; a run that fails is an error."""

    def short(tables, base):
        changes = {key: to for key, to in tables["set"].items() if key not in OTHER_KERNELS}
        periods = min(tables["periods"], MOST_PERIODS)
        return expand({**tables, "periods": periods, "set": changes}, base)

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
def data(name):
    """Data of a figure in the small size; tests must not change them."""
    with tiny():
        return figures.load(name).data(quick=True)


def of_room(room):
    """Names of the figures of a room."""
    return [name for name, entry in figures.FIGURES.items() if entry.room == room]


def _drawn_colours(picture):
    """Words for the colours of lines and surfaces in the panels; frames and words do not count."""
    found = []
    for ax in picture.axes:
        for line in ax.lines:
            found += [line.get_color(), line.get_markerfacecolor()]
        for many in ax.collections:
            found += [*many.get_facecolor(), *many.get_edgecolor()]
        found += [patch.get_facecolor() for patch in ax.patches]
    rgba = to_rgba_array(found)
    grey = np.ptp(rgba[:, :3], axis=1) < 0.02
    grey &= (rgba[:, 0] > 0.2) & (rgba[:, 0] < 0.98)
    return {COLOURS.get(to_hex(colour)) for colour in rgba} | ({"grey"} if grey.any() else set())


def check_figure(name):
    """Fail unless the data are numbers, all of them printed, none changed by the drawing.

    Not all nan; times are positive. Axes have names; colours that the caption names are drawn; no
    type is smaller than 8 pt.
    """
    d, module = data(name), figures.load(name)
    for key, value in d.items():
        kind = np.asarray(value).dtype.kind
        assert kind in "fiU"
        assert kind == "U" or np.any(np.isfinite(value)) or name in TOO_FEW
        assert not key.endswith("seconds") or np.all(np.asarray(value) > 0)
    before = {key: np.copy(value) for key, value in d.items()}
    with tiny():
        picture = module.draw(d)
    try:
        assert all(ax.get_xlabel() or ax.get_ylabel() for ax in picture.axes)
        picture.canvas.draw()
        shown = [text for text in picture.findobj(Text) if text.get_text() and text.get_visible()]
        assert all(text.get_fontsize() >= 8 for text in shown)
        named = re.findall(r"\b(black|blue|green|red|orange|yellow|grey)\b", module.__doc__)
        assert set(named) <= _drawn_colours(picture)
    finally:
        plt.close(picture)
    text = printed(d)
    assert all(re.search(rf"\b{key}\b", text) for key in d if not key.endswith("_error"))
    for key, value in d.items():
        np.testing.assert_array_equal(value, before[key])
