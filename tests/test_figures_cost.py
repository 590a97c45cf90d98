"""Figures of accuracy and price, and the page of prices; no test asserts a time."""

import json
from functools import partial
from itertools import combinations, count
from types import SimpleNamespace
from unittest.mock import Mock

import mpmath
import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal

import figures
import md
from figures.cost import (
    accuracy_cost_drift,
    accuracy_cost_ladder,
    effect_prices,
    scaling,
)
from figures.cost.price_page import PRICE_PANELS
from figures.cost.scene_variants import FULL, Variant
from figures.lib import exact_impacts, timing
from figures.lib.data import keep, made
from figures.lib.drawing import files_of
from md.accuracy import steps_per_contact

from .command_line import enter, names_in
from .quick_figures import SIZES, check_figure, data, each_of, tiny
from .sampling import LAWS, Impacts, each_law


@each_of("cost")
def test_every_figure(name):
    check_figure(name)


# Impacts: errors in many digits


@each_law
def test_exact_values_are_those_of_the_integration(law):
    """The figures' many digits against an integration that shares no formula with them."""
    impacts = exact_impacts.random_impacts(60, seed=2)
    integrated = Impacts(*impacts)
    true = exact_impacts.reference(impacts, law)
    assert set(true.regime) == {1, 2, 3}
    for i, row in enumerate(zip(*impacts, strict=True)):
        with mpmath.workdps(50):
            regime, values = exact_impacts.exact([mpmath.mpf(x) for x in row], law)
            expected = integrated.reference(i, law)
            assert regime == true.regime[i] == expected.regime
            for field, value, scale in zip(
                exact_impacts.FIELDS, values, true.scale[:, i], strict=True
            ):
                assert abs(value - getattr(expected, field)) < mpmath.mpf(10) ** -40 * scale


def test_error_is_counted_in_units_in_the_last_place():
    """Results moved by three units of the scale come out as 3, nan as infinitely wrong."""
    true = exact_impacts.reference(exact_impacts.random_impacts(50, seed=8))
    exact = dict(zip(exact_impacts.FIELDS, true.high, strict=True))
    for j, field in enumerate(exact_impacts.FIELDS):
        moved = {field: true.high[j] + 3 * np.spacing(true.scale[j])}
        rounding = 2 if field == "omega" else 0.51  # omega' may be larger than its scale
        assert_allclose(true.ulp(SimpleNamespace(**exact | moved)), 3, atol=rounding)
    unknown = SimpleNamespace(c_z=np.full(50, np.nan))
    assert np.all(np.isinf(true.ulp(unknown, ("c_z",))))


def test_the_map_is_right_everywhere_and_printed_formulas_are_not():
    """These beyond Painleve's friction, where the rod leans against its slip."""
    d = data("accuracy_map")
    assert d["ours"].max() <= 16
    tilt = (d["tilt"][1:] + d["tilt"][:-1]) / 2
    wrong = d["literal"] > 1e8
    assert 0.1 < wrong.mean() < 0.4
    assert not np.any(wrong[:, tilt > 0])
    limit = np.interp(d["tilt"], d["line_tilt"], np.nan_to_num(d["painleve_friction"], nan=1e9))
    row, column = np.nonzero(wrong)
    assert np.all(d["friction"][row + 1] > np.fmin(limit[column], limit[column + 1]))


def test_errors_are_where_the_digits_of_each_way_end():
    *ours, printed = data("accuracy_cost_theory")["error"][0]
    assert max(ours) < 16 * 2.0**-52
    assert printed > 1e-3  # sticking in the Painleve region, taken for a slide


# Soft impacts: errors of the integration


def test_integration_errors_fall_with_the_step():
    """To an order of 5/4; located switches reach what no step does."""
    d = data("accuracy_cost_impact")
    worst, middle = d["fixed_error"]
    assert d["offsets"].size >= 24
    assert np.all(middle <= worst)
    assert 1.15 < d["order"] < 1.3
    assert worst[list(d["parts"]).index(160)] < 1e-3
    located, middle = d["adaptive_error"]
    assert np.all(middle <= located)
    assert np.all(np.diff(located) < 0)
    assert max(located[-1], d["floor"]) < 1e-12
    assert d["evaluations"][-1] <= 3000


# The drift of rows


def test_errors_of_parts():
    """Of independent values: sigma/sqrt(n) and the distance of the truth, squares added."""
    series = 2 + default_rng(1).normal(size=200_000)
    n = np.array([1, 10, 100, 10**5])
    parts = accuracy_cost_drift.parts(series, n)
    errors = accuracy_cost_drift.rms_of_parts(parts, 2.0)
    assert_allclose(errors[:3], n[:3] ** -0.5, rtol=4 / np.sqrt(2 * 2000))
    assert np.isnan(errors[3])  # fewer than eight parts
    shifted = accuracy_cost_drift.rms_of_parts(parts, 2.5)[:3]
    assert_allclose(shifted, np.hypot(n[:3] ** -0.5, 0.5), rtol=0.03)


def test_accuracy_of_the_drift_against_time(monkeypatch):
    d = data("accuracy_cost_drift")
    with tiny():
        run = md.run(accuracy_cost_drift._scene(d["dt"][-1]), periods=120)
    assert (1 + d["bias"][-1]) * d["truth"] == pytest.approx(run.c_x_series[20:].mean())
    assert [run["tolerance"] for run in accuracy_cost_drift.runs(d)] == 4 * [0.4]
    monkeypatch.setattr(md, "run", None)  # all is in the store
    with tiny():
        again = accuracy_cost_drift.data(quick=True)
    assert_array_equal(again["rms"], d["rms"])


def test_the_ladder():
    """Bars: scatter of independent starts."""
    d, ladder = data("accuracy_cost_ladder"), accuracy_cost_ladder
    off, *_ = ladder.deviations(d)
    assert_allclose((off + 1) * d["trusted"][0], d["answer"])
    few = SIZES[ladder]["ROWS"]["rods"]["N=5"]
    starts = [md.run(ladder.scene(13, few, seed), periods=4).c_x for seed in range(1, 9)]
    last = d["answer"][-1], d["scatter"][-1], d["error"][-1]
    scatter = np.std(starts, ddof=1)
    assert last == pytest.approx((np.mean(starts), scatter, scatter / np.sqrt(8)))


@pytest.mark.parametrize(
    "changes", [{}, accuracy_cost_ladder.PRINTED, accuracy_cost_ladder.CONSTRAINT]
)
def test_steps_of_the_ladder_are_parts_of_a_contact(changes):
    scene = accuracy_cost_ladder.scene(20, changes)
    assert steps_per_contact(scene, scene.step.size) == pytest.approx(20)


# Prices of effects


def test_prices_belong_to_what_they_say():
    """What looks on changes no bit, gravity does; an effect of size zero is the same kernel."""
    d = data("effect_prices")
    with tiny():
        names, words = [*effect_prices.rows()], effect_prices.changes(d)
    same_rods, same_kernel = (
        {name for name, same in zip(names, d[key], strict=True) if same}
        for key in ("same_rods", "same_kernel")
    )
    assert "series of means" in same_rods - same_kernel
    assert "off: acceleration of the plate" in same_kernel
    assert "gravity" not in same_rods
    (full, *changed), _ = d["drift"]
    assert_array_equal(np.isfinite(changed), [0, 0, 1, 0])
    assert words[:2] == ["-", "0, same bits"]
    assert float(words[2].split()[0]) == pytest.approx(changed[2] - full, abs=6e-3)
    assert words[3] == "same kernel"
    starts = ({"start.seed": seed, "start.speed": 0.3} for seed in (1, 2))
    runs = [md.run(Variant(start).scene, periods=4).c_x for start in starts]
    drifts = np.array(runs) * FULL.scene.cm_per_s
    half = abs(drifts[0] - drifts[1]) / 2
    assert tuple(d["drift"][:, 0]) == pytest.approx((drifts.mean(), half))


def test_scaling_is_of_whole_rows():
    few, many = scaling._row(80), scaling._row(5000)
    assert few.rods.count / few.box.length == pytest.approx(40 / 43)
    assert few.tilt == pytest.approx(many.tilt)


# Times


TIMES = (30.0, 29.6, 30.0, 8.0, 5.0)
ROUNDS = 300
ALL = ROUNDS * len(TIMES)


@pytest.mark.parametrize(
    ("slowed", "scale"),
    [
        (lambda now: 1.0 if now <= ALL // 2 else 1.6, 1.0),  # somebody else begins half way
        (lambda now: 1 + 0.5 * now / ALL, 1.12),  # times are those of the quieter half
        (lambda now: 1 + 0.1 * (now % len(TIMES)) / len(TIMES), 1.04),  # as fast as a round
    ],
    ids=["half way", "drift", "in step"],
)
def test_differences_are_found_on_a_machine_that_slows_down(slowed, scale):
    """Each within its own error, which is small; in proportion to what is left of the speed.

    Of calls with known times, noise, and a speed that changes from one to the next.
    """
    numbers, random = count(1), default_rng(5)

    def pass_by(time):
        late = random.exponential(20 * time) if random.random() < 0.05 else 0
        return time * slowed(next(numbers)) * (1 + 0.03 * random.normal()) + late

    calls = [partial(pass_by, time) for time in TIMES]
    times = timing.steady(timing.in_turn(calls, ROUNDS, seed=3))
    left = timing.estimate(times[:, 0]).value / TIMES[0]
    assert left == pytest.approx(scale, rel=0.03)
    for first, second in combinations(range(len(TIMES)), 2):
        true = (TIMES[first] - TIMES[second]) * left
        value, error, spread = timing.estimate(times[:, first] - times[:, second])
        assert abs(value - true) < 4 * error + 2e-3 * abs(true)
        assert error < min(0.5, spread)


def test_a_price_is_of_one_call_of_many(monkeypatch):
    """Seconds of a sample over its repetitions; a clock that counts repetitions gives one."""
    asked = []

    def timed(task, number):
        asked.append(number)
        return 1e-5 * number

    monkeypatch.setattr(timing, "timeit", timed)
    assert_allclose(timing.medians([lambda: asked.append(0)], 3), 1e-5, rtol=1e-9)
    assert asked == [0, 1, 100, 100, 100]  # once before, to compile


# The page of prices


def test_the_command_writes_the_page_and_the_figures(tmp_path):
    """Numbers are those of the figures, and what one impact costs, in time and in digits.

    What was measured in full is not measured again quickly. The figures' data are there; the rest
    of the command runs in small sizes.
    """
    first, *others = PRICE_PANELS
    full = data(first) | {"load": np.float64(1e4), "machine": "another machine"}
    archive = tmp_path / f"{first}.npz"
    keep(archive, first, False, full)
    kept = archive.read_bytes()
    with tiny() as patch:
        for name in PRICE_PANELS:
            patch.setattr(figures.load(name), "data", Mock(return_value=data(name)))
        enter("figures prices --out", tmp_path)
    assert archive.read_bytes() == kept
    assert all(made(tmp_path / f"{name}.npz")["quick"] for name in others)
    names = {*files_of(*others), archive.name, "prices.txt", "prices.json", "prices.png"}
    assert names_in(tmp_path) == names
    words = (tmp_path / "prices.txt").read_text("utf-8")
    titles = [figures.FIGURES[name].title for name in PRICE_PANELS]
    for word in (*titles, "alone[0]", "within[0]", "row[0]", "sweep[0]"):
        assert word in words
    text = (tmp_path / "prices.json").read_text("utf-8")
    assert "another machine; load 10000.0" in text
    numbers = json.loads(text)
    alone = data("effect_prices")["alone"][:, :2].tolist()
    assert [effect["alone"] for effect in numbers["effects"]] == alone
    assert numbers["cores"][0] == {"count": 1, "gain": 1.0}
    ways = {f"{way} {law}" for way in ("numpy", "compiled") for law in LAWS}
    assert numbers["impact_ns"].keys() == ways
    assert min(numbers["impact_ns"].values()) > 0
    assert all(0 < ulp < 6 for law in numbers["impact_ulp"] for ulp in law["largest"])
