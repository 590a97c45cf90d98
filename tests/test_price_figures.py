"""Prices of effects and of rods, on one page; no test asserts a time."""

import dataclasses
import json
import tempfile

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import figures
import md
from figures.__main__ import main
from figures.cost import effect_prices, kernel_times, scaling
from figures.cost import price_page as price_list
from figures.cost.scene_variants import EFFECTS, FULL, GROUPS, NOTHING, OFF, Variant, variants
from figures.lib import timing
from md.kernels import plane as row
from md.scene import Scene, Start

mpl.use("Agg")

FEW = {
    "effect": ("gravity", "series of means"),
    "instead": ("inertia: solid",),
    "off": ("off: acceleration of the plate",),
}
TINY = {
    effect_prices: {
        **{
            "PLACES": 2,
            "PART": 400,
            "WARM_STEPS": 1,
            "PRICE_BLOCKS": {True: 3},
            "ROUNDS": {True: 2},
        },
        **{
            "PRICE_SETTLE": {True: 1, False: 4},
            "DRIFT_SEEDS": {True: 2},
            "DRIFT_PERIODS": {True: 4},
        },
        "GROUPS": {group: {n: GROUPS[group][n] for n in names} for group, names in FEW.items()},
    },
    scaling: {
        **{"ROW_SIZES": {True: (4, 8)}, "LEAST": 8, "RUNS_PER_CORE": 1, "SWEEP_PERIODS": 1},
        **{"SCALING_BLOCKS": {True: 3}, "SCALING_SETTLE": {True: 1}, "REPEATS": {True: 2}},
    },
    kernel_times: {"SAMPLE_STEPS": 20, "ANNULUS_PERIODS": 0.01},
    price_list: {"IMPACTS": 1000, "CHECKED": 200},
}


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """What `prices` leaves behind in tiny sizes, and the numbers in it."""
    folder = tmp_path_factory.mktemp("prices") / "new"
    with pytest.MonkeyPatch.context() as patch:
        for module, sizes in TINY.items():
            for name, size in sizes.items():
                patch.setattr(module, name, size)
        few = {"effect_prices": "prices", "scaling": "time"}
        patch.setattr(price_list, "PRICE_PANELS", few)
        assert main(["prices", "--out", str(folder)]) == 0
        found = {}
        for name in ("effect_prices", "scaling"):
            with np.load(folder / f"{name}.npz") as stored:
                found[name] = {key: stored[key] for key in stored if key != "provenance"}
        yield folder, found


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

    def __init__(self, times, slowed, noise=0.03):
        self.times, self.slowed, self.noise = times, slowed, noise
        self.now, self.random = 0, np.random.default_rng(5)

    def calls(self, _):
        return [lambda place, time=time: self.pass_by(time * (1 + place)) for time in self.times]

    def pass_by(self, time):
        self.now += 1
        late = self.random.exponential(20 * time) if self.random.random() < 0.05 else 0
        return time * self.slowed(self.now) * (1 + self.noise * self.random.normal()) + late


TIMES = (30.0, 29.6, 30.0, 8.0, 5.0)
BLOCKS, ROUNDS, PLACES = 30, 5, 2
ALL = BLOCKS * ROUNDS * PLACES * len(TIMES)


@pytest.mark.parametrize(
    "slowed",
    [
        lambda now: 1.0,
        lambda now: 1.0 if now <= ALL // 2 else 1.6,  # somebody else begins half way
        lambda now: 1 + 0.5 * now / ALL,
        lambda now: 1 + 0.1 * (now % len(TIMES)) / len(TIMES),  # as fast as a round
    ],
    ids=["steady", "half way", "drift", "in step"],
)
def test_differences_are_found_on_a_machine_that_slows_down(slowed):
    """Each within its own error, which is small; in proportion to what is left of the speed."""
    machine = Machine(TIMES, slowed)
    samples = timing.interleaved(machine.calls, BLOCKS, ROUNDS, PLACES, seed=3)
    assert samples.shape == (BLOCKS, ROUNDS, PLACES, len(TIMES))
    times = timing.steady(samples)
    scale = timing.estimate(times[..., 0]).value / 45  # mean of both places
    assert 0.97 < scale < 1.35
    for first in range(len(TIMES)):
        for second in range(first):
            true = 1.5 * (TIMES[first] - TIMES[second]) * scale
            value, error, spread = timing.estimate(times[..., first] - times[..., second])
            assert abs(value - true) < 4 * error + 2e-3 * abs(true)
            assert error < 0.5
            assert spread > error


def test_half_way_does_not_change_the_unit():
    """Times are those of the quieter half."""
    samples = timing.interleaved(
        Machine(TIMES, lambda now: 1.0 if now <= ALL // 2 else 1.6).calls, BLOCKS, ROUNDS, PLACES
    )
    fly = timing.estimate(timing.steady(samples)[..., 4])
    assert fly.value == pytest.approx(7.5, rel=0.03)


def test_error_counts_blocks():
    """What shifts a whole block is no more certain for many rounds of it."""
    random = np.random.default_rng(2)
    shifts = random.normal(0, 1, (40, 1, 1))
    few = timing.estimate(shifts + random.normal(0, 0.1, (40, 2, 3)))
    many = timing.estimate(shifts + random.normal(0, 0.1, (40, 200, 3)))
    assert few.error == pytest.approx(many.error, rel=0.3)
    assert many.error == pytest.approx(1.25 / 40**0.5, rel=0.4)


def test_code_comes_back_after_reloading():
    """Whatever happens meanwhile."""
    usual, seen = row.march, []

    def broken():
        with timing.reloading() as again:
            again()
            seen.append(row.march)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        broken()
    assert seen[0] is not usual
    assert row.march is usual


def test_command_writes_the_page_and_the_figures(out):
    folder, _ = out
    names = {f"{name}.{kind}" for name in ("effect_prices", "scaling") for kind in ("npz", "png")}
    names |= {
        "effect_prices.pdf",
        "scaling.pdf",
        "prices.txt",
        "prices.json",
        "prices.png",
        "rows.db",
    }
    names.add("rows.db")  # runs of the drift
    assert {p.name for p in folder.iterdir() if not p.name.startswith("rows.db-")} == names
    assert (folder / "prices.png").read_bytes().startswith(b"\x89PNG")
    words = (folder / "prices.txt").read_text(encoding="utf-8")
    for name in ("effect_prices", "scaling"):
        assert figures.FIGURES[name].title in words
    for word in ("numba", "gravity", "inertia: solid", "same kernel", "times one core"):
        assert word in words
    assert "nan" not in words


def test_numbers_for_other_programs(out):
    """Those of the figures; and what one impact costs, in time and in digits."""
    folder, found = out
    made = json.loads((folder / "prices.json").read_text(encoding="utf-8"))
    alone = found["effect_prices"]["alone"][:, :2].tolist()
    assert [effect["alone"] for effect in made["effects"]] == alone
    assert [kernel["name"] for kernel in made["kernels"]] == list(kernel_times.NAMES)
    assert made["cores"][0] == {"count": 1, "gain": 1.0}
    assert made["impact_ns"]["numpy newton"] > made["impact_ns"]["loop newton"] > 0
    assert [law["law"] for law in made["impact_ulp"]] == ["newton", "poisson", "stronge"]
    assert all(0 < ulp < 6 for law in made["impact_ulp"] for ulp in law["largest"])
    assert "numba" in made["machine"]


def test_prices_belong_to_what_they_say(out):
    """What looks on changes no bit, gravity does; an effect of size zero is the same kernel."""
    _, found = out
    d = found["effect_prices"]
    rows = {name: i for i, name in enumerate(name for group in FEW.values() for name in group)}
    assert d["alone"].shape == d["within"].shape == (len(rows), 3)
    number = len(
        variants(e for group in TINY[effect_prices]["GROUPS"].values() for e in group.values())
    )
    assert d["samples"].shape == (3, 2, 2, number)
    assert d["same_rods"][rows["series of means"]] == 1
    assert d["same_rods"][rows["gravity"]] == 0
    assert d["same_kernel"][rows["off: acceleration of the plate"]] == 1
    assert d["same_kernel"][rows["series of means"]] == 0
    np.testing.assert_array_equal(np.isfinite(d["drift"][0]), [1, 0, 0, 1, 0])
    changes = effect_prices._changes(d)
    assert changes[:2] == ["-", "0, same bits"]
    assert float(changes[2].split()[0]) == pytest.approx(
        d["drift"][0, 3] - d["drift"][0, 0], abs=6e-3
    )
    assert changes[3] == "same kernel"


def test_drift_is_that_of_runs(out):
    _, found = out
    runs = [
        md.run(dataclasses.replace(FULL.scene, start=Start(seed=seed, speed=0.3)), periods=4)
        for seed in (1, 2)
    ]
    drift = np.array([run.c_x for run in runs]) * FULL.scene.cm_per_s
    mean, error = found["effect_prices"]["drift"][:, 0]
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


def test_pictures_say_what_they_show(out):
    _, found = out
    picture = effect_prices.draw(found["effect_prices"])
    (ax,) = picture.axes
    assert [label.get_text() for label in ax.get_yticklabels()] == [
        *FEW["effect"],
        "inertia: solid instead",
        *FEW["off"],
    ]
    assert "ns" in ax.get_xlabel()
    widths = np.array([[bar.get_width() for bar in group] for group in ax.containers[::2]])
    prices = [found["effect_prices"][key][:, 0] for key in ("alone", "within")]
    np.testing.assert_array_equal(widths, prices)
    assert len(ax.get_legend().get_texts()) == 2
    plt.close(picture)
    picture = scaling.draw(found["scaling"])
    assert all(ax.get_xlabel() and ax.get_ylabel() and ax.get_legend() for ax in picture.axes)
    plt.close(picture)
    page = price_list.draw(found)
    assert [bool(ax.get_xlabel()) for ax in page.axes] == [True, True]
    plt.close(page)


def test_rods_lifted_into_space_do_the_same(monkeypatch):
    """But for the springs between rods, which they left behind."""
    monkeypatch.setattr(kernel_times, "SAMPLE_STEPS", 200)
    engine = kernel_times._settled()
    before = engine.rods.copy()
    rods = kernel_times.lifted(engine)(0)[1][:, kernel_times.PLANE_COLUMNS]
    engine.go(201)
    assert np.abs(engine.rods - before).max() > 0.05
    assert np.abs(rods - engine.rods).max() < 5e-3


def test_scaling_is_of_whole_rows(out):
    _, found = out
    d = found["scaling"]
    np.testing.assert_array_equal(d["counts"], [4, 8])
    assert d["row_samples"].shape == (3, 1, 1, 2)
    assert d["workers"][0] == 1
    assert np.all(np.diff(d["workers"]) > 0)
    assert d["sweep_samples"].shape == (2, 1, 1, len(d["workers"]))
    one = scaling._row(80)
    assert one.rods.count / one.box.length == pytest.approx(40 / 43)
    assert one.tilt == pytest.approx(scaling._row(5000).tilt)


@pytest.mark.parametrize("bad", ["FILE", "FILE/deeper"])
def test_nowhere_to_write_costs_one_line(bad, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "FILE").touch()
    assert main(["prices", "--out", bad]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert "FILE" in printed.err
    assert [path.name for path in tmp_path.iterdir()] == ["FILE"]


def test_a_folder_that_takes_no_file_is_found_at_once(tmp_path, monkeypatch, capsys):
    def refused(**_):
        raise PermissionError("Permission denied")

    monkeypatch.setattr(tempfile, "TemporaryFile", refused)
    monkeypatch.setattr(effect_prices, "data", lambda quick: pytest.fail("began to measure"))
    assert main(["prices", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_interrupted_keeps_what_was_finished(out, tmp_path, monkeypatch, capsys):
    _, found = out
    monkeypatch.setattr(effect_prices, "data", lambda quick: found["effect_prices"])

    def interrupted(quick):
        raise KeyboardInterrupt

    monkeypatch.setattr(scaling, "data", interrupted)
    assert main(["prices", "--out", str(tmp_path)]) == 130
    kept = {path.name for path in tmp_path.iterdir()}
    assert kept == {f"effect_prices.{kind}" for kind in ("npz", "png", "pdf")}
    assert capsys.readouterr().err.count("\n") == 1
