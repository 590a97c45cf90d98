"""Figures in tiny sizes: their data, computed once in a process, and their pictures."""

import re
import tomllib
from contextlib import contextmanager
from copy import deepcopy
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex, to_rgba_array
from matplotlib.text import Text
from numpy.testing import assert_equal

import figures
from figures.checks import landing_census, row_motion
from figures.cost import (
    accuracy_cost_drift,
    effect_prices,
)
from figures.cost.scene_variants import GROUPS
from figures.lib import runs, style, timing
from figures.lib.printing import printed
from figures.paper import fig04, fig07, fig08
from impact import ContactGeometry
from md import simulation
from md.host import prepare
from md.scene import load
from md.sweep import execute, expand

from .rows import HALF, unread

MOST_PERIODS = 8  # of a run of the paper's figures
TOO_FEW = {"fig04", "landing_census", "states"}  # tiny runs leave some of their numbers open
COLOURS = {
    getattr(style, word.upper()).lower(): word
    for word in ("black", "blue", "green", "orange", "red")
}
OTHER_KERNELS = {"rods.rolling", "annulus.shaken"}  # each takes ten seconds to compile
OWN_VALUES = [(0.05, 0.0), (0.2, 0.3), (0.5, 0.65), (0.8, 0.9), (1.2, 1.0)]  # friction, restitution
LONE = {"lone": lambda *_: (np.zeros(1), np.ones(1))}  # of one rod that bounces, in no time
TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text())


def _in_small(effect):
    """An effect whose price in the full scene is that in a small one, which compiles quickly."""
    return effect if effect.drifts else effect._replace(within=effect.alone)


SHORT = "rods.count=10", "box.length=10.75"  # a row of ten rods in place of forty


def _short_row(dt, seed=1):
    """The short row with a step and a start of its own."""
    how = f"start.speed=0.3 start.seed={seed} step.size={dt} step.coarse=true"
    return load("quasi2d", [*SHORT, *how.split()])


def watched_engine(scene, **_):
    """An engine with ledger, record and series, which change no bit: all runs share its kernel."""
    engine = prepare(scene)
    go, samples = engine.go, unread(engine)
    engine.go = lambda steps, series=None: go(steps, series or samples)
    return engine


MADE = {
    simulation: {"prepare": watched_engine},
    timing: {"prepare": watched_engine},
    row_motion: {"prepare": watched_engine},
    fig04: {"SIZES": {name: (few, few) for name, few in TABLES["few"].items()}},
    fig07: LONE,
    fig08: LONE,
    landing_census: {
        "CONTACTS": dict.fromkeys(landing_census.CONTACTS, landing_census.CONTACTS["constraint"])
    },
    accuracy_cost_drift: {
        "_scene": _short_row,
        "asked": lambda: dict.fromkeys(("row", "other", "mine", "annulus"), load("quasi2d", SHORT)),
        "seconds_per_period": lambda scenes: np.array([1e-3 / s.step.size for s in scenes]),
    },
    effect_prices: {
        "GROUPS": {
            group: {name: _in_small(GROUPS[group][name]) for name in few}
            for group, few in TABLES["effects"].items()
        }
    },
}


def _by_size(value):
    """A value of the table; by whether it is quick for `quick` and `full`."""
    if not isinstance(value, dict):
        return value
    quick = {"quick": True, "full": False}
    return {quick.get(key, key): _by_size(inner) for key, inner in value.items()}


SIZES = {import_module(name): _by_size(sizes) for name, sizes in TABLES["modules"].items()}


@contextmanager
def tiny():
    """Small sizes and short runs, in this process; a run that fails is an error."""

    def short(tables, base):
        changes = {key: to for key, to in tables["set"].items() if key not in OTHER_KERNELS}
        periods = min(tables["periods"], MOST_PERIODS)
        return expand({**tables, "periods": periods, "set": changes}, base)

    def alone(sweep, store, **options):
        tally = execute(sweep, store, **options | {"workers": 1})
        assert not tally.failed
        return tally

    with pytest.MonkeyPatch.context() as patch:
        for module, sizes in (*SIZES.items(), *MADE.items()):
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


def thick(tilt):
    """The paper's rod without the figures' own helper: round tip, inertia l^2/12."""
    return ContactGeometry(HALF * np.sin(tilt), HALF * np.cos(tilt) + 0.5, 9.5 / np.sqrt(12))


def each_of(room):
    """A test for each figure of a room, by its name."""
    names = [name for name, entry in figures.FIGURES.items() if entry.room == room]
    return pytest.mark.parametrize("name", names)


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
        assert not key.endswith("seconds") or np.min(value) > 0
    before = deepcopy(d)
    with tiny():
        picture = module.draw(d)
    assert all(ax.get_xlabel() or ax.get_ylabel() for ax in picture.axes)
    picture.canvas.draw()
    shown = (text for text in picture.findobj(Text) if text.get_text() and text.get_visible())
    assert min(text.get_fontsize() for text in shown) >= 8
    named = re.findall(r"\b(black|blue|green|red|orange|yellow|grey)\b", module.__doc__)
    assert set(named) <= _drawn_colours(picture)
    text = printed(d)
    assert all(re.search(rf"\b{key}\b", text) for key in d if not key.endswith("_error"))
    assert_equal(d, before)
