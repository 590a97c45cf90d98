"""Figures of accuracy and cost, their many digits, and the benchmark; no test asserts a time."""

import json
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

from figures.cost import accuracy_cost_theory
from figures.cost import exact_impacts as precise
from impact import Regime, collide, thin_rod
from impact.__main__ import main
from impact.benchmark import random_impacts, table
from impact.compiled import KERNELS as LAWS

from .quick_figures import data
from .reference import reference_collide


@pytest.mark.parametrize("law", LAWS)
def test_exact_values_are_those_of_the_integration(law):
    """The figures' many digits against an integration that shares no formula with them."""
    impacts = random_impacts(60, seed=2)
    true = precise.reference(impacts, law)
    assert set(true.regime) == {1, 2, 3}
    for i, row in enumerate(zip(*(column.tolist() for column in impacts), strict=True)):
        names = ("plate_velocity", "X", "Z", "k", "friction", "restitution")
        given = dict(zip(names, row[3:], strict=True))
        with mpmath.workdps(50):
            regime, values = precise.exact([mpmath.mpf(x) for x in row], law)
            expected = reference_collide(*row[:3], **given, law=law, dps=50)
            assert regime == true.regime[i] == expected.regime
            for value, field, scale in zip(values, precise.FIELDS, true.scale[:, i], strict=True):
                assert abs(value - getattr(expected, field)) < mpmath.mpf(10) ** -40 * scale


def test_printed_formulas_are_only_repaired():
    """In 50 digits they agree with the exact values, regime by regime."""
    formula = precise._printed("mpmath")
    rows = zip(*(column.tolist() for column in random_impacts(80, seed=4)), strict=True)
    tags = {Regime.SLIDE: "12 13", Regime.SLIP_STICK: "18 19", Regime.SLIP_REVERSAL: "21 22"}
    seen = set()
    with mpmath.workdps(50):
        for c_x, c_z, omega, V_z, X, *rest in rows:
            side = -1 if c_x - omega * rest[0] < 0 else 1
            row = [*map(mpmath.mpf, (side * c_x, c_z, side * omega, V_z, side * X, *rest))]
            regime, values = precise.exact(row)
            seen.add(regime)
            for tag, value in zip(tags[regime].split(), values[:2], strict=True):
                scale = max(map(abs, (*row[:2], row[3], *values[:4])))
                assert abs(formula[tag](*row) - value) < mpmath.mpf(10) ** -40 * scale, tag
    assert len(seen) == 3


def test_error_is_counted_in_units_in_the_last_place():
    """Results moved by three units of the scale come out as 3, nan as infinitely wrong."""
    impacts = random_impacts(50, seed=8)
    true = precise.reference(impacts)
    moved = true.high + 3 * np.spacing(true.scale)
    for j, field in enumerate(precise.FIELDS):
        got = dict(zip(precise.FIELDS, true.high.copy(), strict=True)) | {field: moved[j]}
        error = true.ulp(SimpleNamespace(**got))
        rounding = 2 if field == "omega" else 0.51  # omega' may be larger than its scale
        np.testing.assert_allclose(error, 3, atol=rounding)
    got["c_z"] = np.full(50, np.nan)
    assert np.all(np.isinf(true.ulp(SimpleNamespace(**got), ("c_z",))))


def test_map_is_right_everywhere_and_printed_formulas_are_not():
    d = data("accuracy_map")
    assert d["ours"].shape == d["literal"].shape == (40, 60)
    assert d["ours"].max() <= d["ours_all_fields"].max() <= 16
    tilt = (d["tilt"][1:] + d["tilt"][:-1]) / 2
    wrong = d["literal"] > 1e8
    assert 0.1 < wrong.mean() < 0.4
    assert not np.any(wrong[:, tilt > 0])  # only where the rod leans against its slip
    limit = np.interp(d["tilt"], d["line_tilt"], np.nan_to_num(d["painleve_friction"], nan=1e9))
    row, column = np.nonzero(wrong)
    assert np.all(d["friction"][row + 1] > np.fmin(limit[column], limit[column + 1]))


def test_boundaries_on_the_map_part_the_regimes():
    """The label changes across the slide line, and across the stick line."""
    d = data("accuracy_map")
    for line, below, above in (("slide_friction", 1, (2, 3)), ("critical_friction", 3, (2,))):
        drawn = np.isfinite(d[line]) & (d[line] < 1e3)
        assert drawn.sum() > 50
        for factor, labels in ((1 - 1e-6, (below,)), (1 + 1e-6, above)):
            how = {"friction": d[line][drawn] * factor, "restitution": 0.8}
            hit = collide(1.0, -1.0, 0.7, geometry=thin_rod(d["line_tilt"][drawn]), **how)
            assert np.mean(np.isin(hit.regime, labels)) > 0.98


def test_cost():
    """Errors are where each way's digits end."""
    d = data("accuracy_cost_theory")
    *ours, printed, many_digits = d["error"][0]
    assert max(ours) < 16 * 2.0**-52
    assert printed > 1e-3  # sticking in the Painleve region, taken for a slide
    assert 10.0 ** (-accuracy_cost_theory.DIGITS - 4) < many_digits < 1e-12


def test_benchmark(capsys):
    """Every time is there and positive, those of compiling apart."""
    assert main(["benchmark", "--impacts", "300", "--json"]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""
    result = json.loads(printed.out)
    ways = {f"{way} {law}" for way in ("numpy", "compiled") for law in LAWS}
    assert set(result["ns_per_impact"]) == ways | {"copy"}
    assert set(result["compile_seconds"]) == set(LAWS)
    times = *result["ns_per_impact"].values(), *result["compile_seconds"].values()
    assert all(time > 0 for time in times)
    assert result["ns_per_impact"]["numpy newton"] > 1
    assert (result["impacts"], result["runs"]) == (300, 9)
    text = table(result)
    assert all(name in text for name in ways)
