"""Prices of effects and of rods, on one page; no test asserts a time."""

import dataclasses
import json
from unittest.mock import Mock

import numpy as np
import pytest

import figures
import md
from figures.__main__ import main
from figures.cost import effect_prices, price_page, scaling
from figures.cost.scene_variants import EFFECTS, FULL, GROUPS, NOTHING, OFF, Variant, variants
from figures.lib import timing
from md.scene import Scene, Start

from .quick_figures import FEW_EFFECTS, SIZES, data, tiny

NAMES = "effect_prices", "scaling"


@pytest.fixture
def small():
    """Two of the figures, whose data are there; the rest of the command in small sizes."""
    with tiny() as patch:
        patch.setattr(price_page, "PRICE_PANELS", dict.fromkeys(NAMES, "time"))
        for name in NAMES:
            patch.setattr(figures.load(name), "data", Mock(return_value=data(name)))
        yield


def kinds(variant: Variant) -> set[tuple]:
    """Every part of an engine that is there, by its path."""
    engine, found = variant.engine(), set()

    def look(path, part):
        if part is None:
            return
        found.add(path)
        for name, inner in getattr(part, "_asdict", dict)().items():
            look((*path, name), inner)

    for name in ("effects", "state", "watchers"):
        look((name,), getattr(engine, name))
    return found | {("series",)} & {(name,) for name in variant.diagnostics}


def test_every_part_of_a_scene_has_its_price():
    """Whatever may be absent in the full scene is switched by some row, alone and within."""
    named = {key.split(".")[0] for one in variants(EFFECTS.values()) for key in one.changes}
    parts = {field.name for field in dataclasses.fields(Scene)}
    assert parts - {"rods", "step", "annulus"} <= named  # space is another kernel
    for key in ("alone", "within"):
        switched = set()
        for effect in EFFECTS.values():
            there, gone = map(kinds, getattr(effect, key))
            assert there > gone
            switched |= there - gone
        assert switched >= kinds(FULL) - kinds(Variant(NOTHING, frozenset())) - {("series",)}
        assert {("series",), ("watchers", "ledger"), ("watchers", "record")} <= switched


@pytest.mark.parametrize("name", OFF)
def test_an_effect_of_size_zero_is_no_effect(name):
    for zero, unnamed in OFF[name][:2]:
        assert zero != unnamed
        kernels = [effect_prices._kernel(one.engine(), one) for one in (zero, unnamed)]
        assert kernels[0] == kernels[1]
        assert kinds(zero) < kinds(FULL)


def test_variants_share_the_step_and_no_table():
    """A scene made of another one leaves it as it was."""
    every = variants(effect for group in GROUPS.values() for effect in group.values())
    before = repr(every)
    for variant in every:
        assert variant.engine().dt == pytest.approx(FULL.engine().dt, rel=1e-3)
    assert repr(every) == before
    assert every[0] == FULL


class Machine:
    """A clock of its own: calls with known times, noise, and a speed that changes."""

    def __init__(self, times, slowed):
        self.times, self.slowed = times, slowed
        self.now, self.random = 0, np.random.default_rng(5)

    def calls(self):
        return [lambda time=time: self.pass_by(time) for time in self.times]

    def pass_by(self, time):
        self.now += 1
        late = self.random.exponential(20 * time) if self.random.random() < 0.05 else 0
        return time * self.slowed(self.now) * (1 + 0.03 * self.random.normal()) + late


TIMES = (30.0, 29.6, 30.0, 8.0, 5.0)
ROUNDS = 300
ALL = ROUNDS * len(TIMES)


@pytest.mark.parametrize(
    ("slowed", "scale"),
    [
        (lambda now: 1.0, 1.0),
        (lambda now: 1.0 if now <= ALL // 2 else 1.6, 1.0),  # somebody else begins half way
        (lambda now: 1 + 0.5 * now / ALL, 1.12),  # times are those of the quieter half
        (lambda now: 1 + 0.1 * (now % len(TIMES)) / len(TIMES), 1.04),  # as fast as a round
    ],
    ids=["steady", "half way", "drift", "in step"],
)
def test_differences_are_found_on_a_machine_that_slows_down(slowed, scale):
    """Each within its own error, which is small; in proportion to what is left of the speed."""
    machine = Machine(TIMES, slowed)
    samples = timing.in_turn(machine.calls(), ROUNDS, seed=3)
    assert samples.shape == (ROUNDS, len(TIMES))
    times = timing.steady(samples)
    left = timing.estimate(times[:, 0]).value / TIMES[0]
    assert left == pytest.approx(scale, rel=0.03)
    for first in range(len(TIMES)):
        for second in range(first):
            true = (TIMES[first] - TIMES[second]) * left
            value, error, spread = timing.estimate(times[:, first] - times[:, second])
            assert abs(value - true) < 4 * error + 2e-3 * abs(true)
            assert error < 0.5
            assert spread > error


def test_the_error_of_a_median():
    """That of medians of many draws of as many normal values."""
    draws = np.random.default_rng(2).normal(5, 2, (400, 200))
    errors = [timing.estimate(values).error for values in draws]
    assert np.mean(errors) == pytest.approx(np.median(draws, axis=1).std(), rel=0.1)


def test_the_command_writes_the_page_and_the_figures(small, tmp_path):
    """Numbers are those of the figures, and what one impact costs, in time and in digits."""
    assert main(["prices", "--out", str(tmp_path)]) == 0
    names = {f"{name}.{kind}" for name in NAMES for kind in ("npz", "png", "pdf")}
    names |= {f"prices.{kind}" for kind in ("txt", "json", "png")}
    assert {path.name for path in tmp_path.iterdir()} == names
    assert (tmp_path / "prices.png").read_bytes().startswith(b"\x89PNG")
    words = (tmp_path / "prices.txt").read_text(encoding="utf-8")
    titles = [figures.FIGURES[name].title for name in NAMES]
    for word in (*titles, "alone[0]", "within[0]", "row[0]", "sweep[0]"):
        assert word in words
    made = json.loads((tmp_path / "prices.json").read_text(encoding="utf-8"))
    alone = data("effect_prices")["alone"][:, :2].tolist()
    assert [effect["alone"] for effect in made["effects"]] == alone
    assert made["cores"][0] == {"count": 1, "gain": 1.0}
    assert made["impact_ns"]["numpy newton"] > made["impact_ns"]["compiled newton"] > 0
    assert [law["law"] for law in made["impact_ulp"]] == ["newton", "poisson", "stronge"]
    assert all(0 < ulp < 6 for law in made["impact_ulp"] for ulp in law["largest"])
    assert "numba" in made["machine"]


def test_prices_belong_to_what_they_say():
    """What looks on changes no bit, gravity does; an effect of size zero is the same kernel."""
    d, groups = data("effect_prices"), SIZES[effect_prices]["GROUPS"]
    names = [name for group in FEW_EFFECTS.values() for name in group]
    number = len(variants(effect for group in groups.values() for effect in group.values()))
    assert d["alone"].shape == d["within"].shape == (len(names), 3)
    assert d["samples"].shape == (6, number)
    for key, name, expected in (
        ("same_rods", "series of means", 1),
        ("same_rods", "gravity", 0),
        ("same_kernel", "off: acceleration of the plate", 1),
        ("same_kernel", "series of means", 0),
    ):
        assert d[key][names.index(name)] == expected
    np.testing.assert_array_equal(np.isfinite(d["drift"][0]), [1, 0, 0, 1, 0])
    with tiny():
        changes = effect_prices._changes(d)
    assert changes[:2] == ["-", "0, same bits"]
    change = d["drift"][0, 3] - d["drift"][0, 0]
    assert float(changes[2].split()[0]) == pytest.approx(change, abs=6e-3)
    assert changes[3] == "same kernel"


def test_drift_is_that_of_runs():
    runs = [
        md.run(dataclasses.replace(FULL.scene, start=Start(seed=seed, speed=0.3)), periods=4)
        for seed in (1, 2)
    ]
    drift = np.array([run.c_x for run in runs]) * FULL.scene.cm_per_s
    mean, error = data("effect_prices")["drift"][:, 0]
    assert mean == pytest.approx(drift.mean())
    assert error == pytest.approx(abs(drift[0] - drift[1]) / 2)


def test_places_are_seen_from_the_plate(monkeypatch):
    """At rest a plate is under the rods as the moving one was, and as fast; the list stays good."""
    monkeypatch.setattr(effect_prices, "PLACES", 3)
    motion = FULL.engine().plate
    moving, still = effect_prices._settled(1)
    for (there, step), (seen, same) in zip(moving[:2], still[:2], strict=True):
        height, velocity = (column[step % len(column)] for column in motion)
        assert (same, abs(height) > 1e-3, abs(velocity) > 1e-3) == (step, True, True)
        off = there["rods"] - seen["rods"]
        np.testing.assert_allclose(off[:, 1], height, atol=1e-12)
        np.testing.assert_allclose(off[:, 5], velocity, atol=1e-12)
        assert not off[:, [0, 2, 3, 4, 6]].any()
        moved = [arrays["rods"][:, :2] - arrays["listed.built"][:, :2] for arrays in (there, seen)]
        np.testing.assert_allclose(*moved, atol=1e-12)
        np.testing.assert_array_equal(there["springs"], seen["springs"])


def test_scaling_is_of_whole_rows():
    d = data("scaling")
    np.testing.assert_array_equal(d["counts"], [4, 8])
    assert d["workers"][0] == 1
    assert np.all(np.diff(d["workers"]) > 0)
    assert d["row"].shape == (2, 3)
    assert d["sweep"].shape == (len(d["workers"]), 3)
    one = scaling._row(80)
    assert one.rods.count / one.box.length == pytest.approx(40 / 43)
    assert one.tilt == pytest.approx(scaling._row(5000).tilt)


def test_interrupted_keeps_what_was_finished(small, tmp_path, monkeypatch, capsys):
    def interrupted(quick):
        raise KeyboardInterrupt

    monkeypatch.setattr(scaling, "data", interrupted)
    assert main(["prices", "--out", str(tmp_path)]) == 130
    kept = {path.name for path in tmp_path.iterdir()}
    assert kept == {f"effect_prices.{kind}" for kind in ("npz", "png", "pdf")}
    assert capsys.readouterr().err.count("\n") == 1
