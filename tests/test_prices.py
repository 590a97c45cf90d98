"""Prices of effects: none is missing, places are comparable, and what an error costs in time."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from figures.cost import accuracy_cost_drift, effect_prices
from figures.cost.scene_variants import EFFECTS, FULL


def parts(thing, path=""):
    """Names of all that there is in the kernel of a scene."""
    if thing is None:
        return set()
    fields = getattr(thing, "_asdict", dict)().items()
    return {path}.union(*(parts(inner, f"{path}.{name}") for name, inner in fields))


def parts_of(variant):
    """Names of all that there is in a variant, with the series that is sampled."""
    engine = variant.engine()
    found = parts(engine.effects) | parts(engine.state) | parts(engine.watchers)
    return found | ({"series"} & variant.diagnostics)


@pytest.mark.parametrize("key", ["alone", "within"])
def test_every_part_of_a_scene_has_its_price(key):
    """What may be absent is switched by some row of the table."""
    pairs = [map(parts_of, getattr(effect, key)) for effect in EFFECTS.values()]
    switched = set().union(*(there - gone for there, gone in pairs))
    assert switched >= parts_of(FULL) - parts_of(effect_prices.BARE)
    assert {"series", ".ledger", ".record"} <= switched


def test_places_are_seen_from_the_plate(monkeypatch):
    """A plate at rest is under rods as the moving one was, and as fast; the list stays good."""
    monkeypatch.setattr(effect_prices, "PLACES", 3)
    plate = FULL.engine().plate
    for (there, step), (seen, same) in zip(*effect_prices._settled(1), strict=True):
        off = there["rods"] - seen["rods"]
        now = [column[step % plate.height.size] for column in plate]
        assert step == same
        assert_allclose(off[:, [1, 5]], np.tile(now, (len(off), 1)), atol=1e-12)
        assert not off[:, [0, 2, 3, 4, 6]].any()
        moved = [arrays["rods"][:, :2] - arrays["listed.built"][:, :2] for arrays in (there, seen)]
        assert_allclose(*moved, atol=1e-12)
        assert_array_equal(there["memory.springs"], seen["memory.springs"])


def test_time_to_reach_an_error():
    """Bias and noise add; a bias that is lost in its error counts as none."""
    d = {
        "bias": np.array([0.02, 0.006, 0.006]),
        "bias_error": np.array([0.001, 0.001, 0.004]),
        "noise": np.full(3, 0.2),
        "seconds": np.array([1e-3, 2e-3, 4e-3]),
    }
    wanted = np.inf, 0.04 / (1e-4 - 3.6e-5) * 2e-3, 0.04 / 1e-4 * 4e-3
    assert_allclose(accuracy_cost_drift.to_reach(d, 0.01), wanted)
