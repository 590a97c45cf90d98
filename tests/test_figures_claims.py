"""Judging the paper's claims: limits, verdicts, pages; on made-up numbers and tiny runs."""

import re
from functools import partial
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest
from numpy.random import default_rng

import md
from figures import FIGURES
from figures.claims import any_rods, gear, judge, limits, measure_annulus, measure_rows, over_tilt
from figures.claims.evidence import Evidence, Whole
from figures.claims.limits import CLOSE, FAILS, HOLDS, MISSING
from figures.claims.uncertainty import Number, count, onset, peak, resampled, standard
from figures.lib import arrangement, runs
from figures.lib.data import keep
from figures.lib.soft_impacts import PAPER_STEP, TABLE_TILTS, one_impact
from figures.pages import gallery
from md.host import step_of
from md.laws import contact_time

from .command_line import enter, names_in
from .quick_figures import data, tiny

CLAIMS = limits.read()
IDS = [*(f"S{i}" for i in range(1, 27)), "E1", "E2", "E3"]
KNOWN = {  # numbers that do not depend on how long the runs are
    # Middle at the inner wall, ends at the outer one: asin(sqrt(8.815^2 - 7.915^2)/4.445), in cm
    "E1.round": pytest.approx(60.805, abs=0.01),
    "E2.slower": 1,
    "E3.threshold": pytest.approx(7.125, abs=0.01),  # arctan(1/8): there it drifts nowhere
    "S15.coulomb_regimes": 17,
    "S19.coulomb": 0,
    "S19.printed": 1,
    "S23.lone_drift": 2,
    "S26.limit": pytest.approx(0.5, abs=1e-6),
    "S26.rate": pytest.approx(1, abs=0.02),
    "E3.bounced_threshold": pytest.approx(7.125, abs=1),
}


# claims.toml


def test_every_claim_says_what_and_where_and_how_it_is_judged():
    """And is there once; each statement can fail."""
    assert [claim["id"] for claim in CLAIMS] == IDS
    for claim in CLAIMS:
        assert all(claim[part] for part in ("says", "section", "scene", "why"))
        assert claim["figure"] in FIGURES or claim["id"] == "S25"
        limits_of = [row["holds"] for row in judge.statements(claim)]
        assert limits_of
        assert all(low <= high and np.isfinite([low, high]).any() for low, high in limits_of)


# Verdicts

LIMITS = {"holds": [0.4, 0.6]}
half_interval = partial(Number, notion="half interval")


@pytest.mark.parametrize(
    ("expected", "numbers"),
    [
        (HOLDS, [standard(0.5, 0.049), count(0.4), standard(0.4, 0.0), half_interval(0.5, 0.09)]),
        (HOLDS, [half_interval((0.4 + x) / 2, (x - 0.4) / 2) for x in np.linspace(0.41, 0.6, 9)]),
        (FAILS, [half_interval((0.6 + x) / 2, (x - 0.6) / 2) for x in np.linspace(0.61, 0.9, 9)]),
        (FAILS, [standard(0.7, 0.049), count(0.39), standard(np.inf, 0.1), standard(-np.inf, 0.1)]),
        (CLOSE, [standard(0.5, 0.051), standard(0.7, 0.051), half_interval(0.5, 0.11)]),
        (CLOSE, [standard(0.4, np.nan)]),
        (MISSING, [standard(np.nan, 0.1)]),
    ],
)
def test_verdicts(expected, numbers):
    """Too close: two standard errors from a limit, or less than one of another notion, or none."""
    for number in numbers:
        assert judge.verdict(number, LIMITS) == expected
    assert judge.verdict(Number(1e300, 0.1), {"holds": [0, np.inf]}) == HOLDS


def test_deviations_are_in_allowances():
    """Around the middle of two limits, or from zero; of what is only to be large there is none."""
    assert limits.deviation(0.35, LIMITS) == pytest.approx(-1.5)
    assert limits.deviation(0.3, {"holds": [-np.inf, 0.1]}) == pytest.approx(3)
    assert np.isnan(limits.deviation(0.3, {"holds": [0.1, np.inf]}))


@pytest.mark.parametrize(
    ("shown", "value", "error"),
    [
        ("1234 ± 120", 1234.4, 120.0),
        ("0.721 ± 0.001", 0.72103, 0.00056),
        ("0.721", 0.72103, 0.00046),
        ("0.001 ± 0.020", 0.0012, 0.02),
        ("0.500", 0.5, 1e-9),
        ("3", 3.0, np.nan),
        ("never", np.inf, np.nan),
        ("no data", np.nan, np.nan),
    ],
)
def test_numbers_are_shown_to_the_digits_of_their_errors(shown, value, error):
    assert judge.shown({"value": value, "error": error}) == shown


# Errors


def test_onset_lies_between_two_points_of_the_grid():
    gamma = np.array([1.2, 1.6, 2.0, 3.0])
    for begun, expected in {
        "0011": (1.8, 0.2),
        "1001": (2.5, 0.5),
        "1111": (1.1, 0.1),
    }.items():
        assert onset(gamma, np.array([*begun]) == "1")[:2] == pytest.approx(expected)
    assert onset(gamma, gamma < 3)[0] == np.inf


def test_arrays_that_are_read_vary_within_their_errors():
    d = {"x": np.arange(4.0), "y": np.ones(4), "y_error": np.full(4, 0.2), "z": np.ones(4)}
    d["z_error"] = d["y_error"]

    def mean(d):
        return (d["x"] + d["y"] + d["z"]).mean()

    spread = pytest.approx(0.1 * 2**0.5, rel=0.15)
    assert resampled(d, mean) == (3.5, spread, "standard error")
    assert np.isnan(resampled(d, lambda d: np.nan).error)
    d["y_error"] = np.full(4, np.nan)
    assert np.isnan(resampled(d, mean).error)


def test_a_place_among_others_is_no_better_known_than_they_lie_apart():
    d = {"x": np.array([3.0, 1.0, 2.0]), "y": np.array([0.0, 1.0, 9.0])}
    assert peak(d, "x", "y")[:2] == (2.0, 0.5)


@pytest.mark.parametrize("lost", [np.nan, 2.0], ids=["all starts", "all but one"])
def test_what_has_not_run_is_not_taken_for_no_drift(lost):
    gamma, error = np.array([1.1, 2, 3]), np.array([0.1, np.nan, 0.1])
    whole = Whole({"gamma": gamma, "c_x": np.array([1.0, lost, 3.0]), "c_x_error": error})
    for read in (
        lambda: measure_annulus.begins(whole, "c_x"),
        lambda: resampled(whole, lambda d: np.mean(d["c_x"] > 0)),
    ):
        with pytest.raises(md.RunError, match="c_x: runs are missing"):
            read()
    ran = Whole(whole | {"c_x": np.array([0, 1, 9.0]), "c_x_error": np.full(3, 0.1)})
    assert measure_annulus.begins(ran, "c_x")["onset"][:2] == pytest.approx((1.55, 0.45))


def test_slippery_rows_that_have_not_run_are_missing(monkeypatch):
    """Their numbers stand beside the largest drift, which has a figure of its own."""
    lost = {"stationary": np.array([np.nan, 1]), "stationary_error": np.array([np.nan, 0.1])}
    monkeypatch.setattr(runs, "means", lambda *_: lost)
    drift = {"friction": np.ones(2), "restitution": np.ones(1)}
    drift |= {"c_x": np.ones((2, 1)), "c_x_error": np.ones((2, 1))}
    slippery = measure_rows._slippery(SimpleNamespace(quick=True, figure=lambda _: drift))
    with pytest.raises(md.RunError, match="stationary: runs are missing"):
        resampled(slippery, lambda d: d["stationary"][0] / d["largest"])


# What is read from data


def test_flights_change_half_way():
    d = {"nominal": np.array([9, 20, 30, 45]), "flight": np.array([2.0, 2.0, 1.0, 1.0])}
    assert over_tilt.change_tilt(d) == pytest.approx(25)
    late = {"nominal": np.array([3, *d["nominal"]]), "flight": np.array([1.2, *d["flight"]])}
    assert over_tilt.change_tilt(late) == pytest.approx(25)
    assert over_tilt.change_tilt({**d, "flight": np.full(4, 0.9)}) == np.inf


def test_a_bump_is_what_a_bell_adds_to_a_parabola():
    nominal = np.arange(9, 70, 3.0)
    off = (nominal - 30) / 15
    parabola = 8 - off + 0.5 * off**2
    for height in (0.8, 0.0, -0.4):
        bell = height * np.exp(-(((nominal - 30) / 4) ** 2) / 2)
        d = {"nominal": nominal, "c_x": np.where(abs(off) > 1, 99, parabola + bell)}
        assert over_tilt.NUMBERS["S16.bump"](d) == pytest.approx(height / 8, abs=1e-9)


@pytest.mark.parametrize("time", [100, 800, 10_000])
def test_a_slow_start_tells_what_it_comes_to(time):
    """Stationary value and time from a run three times as long; from a shorter one, the slope."""
    series = -3 * np.expm1(-(np.arange(3000) + 0.5) / time)
    series += 0.1 * default_rng(1).normal(size=3000)
    value, found = measure_rows.relaxation(series)
    if time < 1000:
        assert (value, found) == (pytest.approx(3, rel=0.02), pytest.approx(time, rel=0.03))
    assert value / found == pytest.approx(3 / time, rel=0.04)


def values_of(claim, d):
    """Numbers of a claim where every figure has these data, each hardly in error."""
    small = {f"{name}_error": np.full_like(value, 1e-6, float) for name, value in d.items()}
    numbers = judge.measure(claim, SimpleNamespace(figure=lambda name: {**small, **d}))
    return {key: number.value for key, number in numbers.items()}


def test_numbers_of_the_annulus_find_what_was_put_in():
    """Friction of the walls, acceleration, the zig-zag's region."""
    gamma = np.array([1.2, 1.6, 2.0, 3.0, 4.0])
    moving, slower = 2 * np.clip(gamma - 1.5, 0, None), np.clip(gamma - 1.7, 0, None)
    wall = {"wall": np.array([0, 0.3, 1.0]), "wall_c_x": np.array([10, 4, 0.5])}
    assert values_of("S6", wall) == pytest.approx(
        {"rise": np.log(8) / np.log(0.3), "all": 0.05, "paper": 2.5}
    )
    d = {"gamma": gamma, "gamma_c_x": np.stack([moving] * 3, axis=1), "rest_gamma_c_x": slower}
    assert values_of("S5", d) == pytest.approx(
        {"onset": 1.4, "visible": 1.4, "rest": 1.8, "bend": 0, "slope": 2, "zero": 1.5}, abs=1e-9
    )
    d = {
        "count": np.array([56, 50, 44]),
        "mean": np.array([10.0, 16, 24]),
        "zigzag": np.array([1, 0.8, 0.2]),
        "contrast": np.array([1.0, 3, 9]),
        "share": np.array([0, 0.1, 0.5]),
        "spread": np.array([1.0, 2, 6]),
    }
    assert set(arrangement.MEASURED) < set(d)
    expected = {
        "order": 1,
        "tilt": 10,
        "leaning": 24,
        "broken": 20,
        "appears": 16 + 8 / 3,
        "share": 0.5,
        "contrast": 9,
        "spread": 6,
    }
    found = values_of("S8", d)
    assert {key: found[key] for key in expected} == pytest.approx(expected)


# What holds for any rods


@pytest.fixture
def surveyed():
    """Made-up numbers of 64 kinds of rods: the first follows the plate's restitution."""
    kinds, names = 64, [*any_rods.JUDGED]
    random = default_rng(3)
    found = {name: random.random(kinds) for name in any_rods.PROPERTIES}
    value = np.full((kinds, len(names)), np.inf)
    value[:, names.index("S2.rms")] = 3 * found["restitution, plate"]
    nominal, theory = np.array([9, 28, 45]), np.ones((kinds, 3))
    return {
        **found,
        "number": np.array(names),
        "value": value,
        "nominal": nominal,
        "theory": theory,
        "c_x": theory * np.where(nominal > 30, 2.0, 0.5),
        "tilt_off": np.where(np.arange(kinds) < 16, 5.0, 1.0),
    }


def test_where_a_statement_holds_is_told(surveyed):
    """Of the kinds that keep their tilt; a number that is the same for all follows nothing."""
    told = any_rods.told(surveyed)
    assert (told["sets"], told["kept"]) == (64, 48)
    plate = surveyed["restitution, plate"][16:]
    rms = told["numbers"]["S2.rms"]
    assert rms["share"] == np.mean(plate <= 0.5)
    assert rms["follows"] == {
        "property": "restitution, plate",
        "rank": pytest.approx(1),
        "middle": pytest.approx(np.percentile(plate[plate <= 0.5], [25, 75])),
    }
    largest = told["numbers"]["S2.largest"]
    assert (largest["share"], largest["follows"]) == (0, None)
    assert rms["quartiles"] == pytest.approx(np.percentile(3 * plate, [25, 50, 75]))
    assert told["ranges"]["restitution, plate"] == [0.3, 0.97]
    assert told["over_theory"] == [[0.5] * 3, [2.0] * 3]
    assert told["within_two"] == [1, 1]
    slower = {**surveyed, "c_x": 0.98 * surveyed["c_x"]}
    assert any_rods.told(slower)["within_two"] == [0, 1]
    few = {**surveyed, "tilt_off": np.where(np.arange(64) < 60, 5.0, 1.0)}
    assert any_rods.told(few)["numbers"]["S2.rms"]["follows"] is None
    unknown = {**surveyed, "value": np.full_like(surveyed["value"], np.nan)}
    assert any_rods.told(unknown)["numbers"]["S2.rms"]["share"] is None


def test_kinds_of_rods_fill_their_ranges_and_run():
    """Plate and rods apart; every step resolves the springs."""
    sweep, drawn = any_rods.sweeps()["sets"], any_rods.drawn()
    assert len(sweep.points) == len(drawn["length"]) * len(any_rods.TILTS_DEG[False])
    for name, of in any_rods.PROPERTIES.items():
        middle = (of.low * of.high) ** 0.5 if of.log else (of.low + of.high) / 2
        assert (drawn[name] > middle).sum() == pytest.approx(128, abs=8)
        assert of.low <= drawn[name].min() < drawn[name].max() <= of.high
    for i in (0, 77, 255):
        scene = sweep.points[7 * i + 3].scene
        contacts = scene.contacts
        found = contacts.plate.law.restitution, contacts.rods.friction, scene.rods.count
        names = "restitution, plate", "friction, rods", "number of rods"
        assert found == tuple(drawn[name][i] for name in names)
        assert np.degrees(scene.tilt) == pytest.approx(28, abs=2e-3)
        assert step_of(scene)[0] > 0


# Pages


def middle(row):
    return np.clip(row.get("holds", 0), -1e3, 1e3).mean()


def test_a_claim_without_data_leaves_the_others(monkeypatch, surveyed):
    def measure(claim, evidence):
        if claim in troubles:
            raise troubles[claim]
        rows = CLAIMS[IDS.index(claim)]["numbers"]
        return {row["key"]: Number(np.nan if claim == "S24" else middle(row)) for row in rows}

    troubles = {"S2": np.linalg.LinAlgError("no such\nrun")}
    monkeypatch.setattr(judge, "measure", measure)
    monkeypatch.setattr(Evidence, "figure", lambda *_: surveyed)
    report = judge.judge(quick=True)
    for claim in report["claims"]:
        expected = {MISSING} if claim["id"] in ("S2", "S24") else {HOLDS}
        assert {row["verdict"] for row in judge.statements(claim)} == expected
    page = gallery.claims_page(report)
    assert "Not measured: LinAlgError: no such run." in page
    runs_of_fig06 = r"draw fig06.*its runs, starts x periods: tilt 4 x 60\.$"  # of quick ones
    assert re.search(runs_of_fig06, page, re.MULTILINE)
    judged = sum(len(judge.statements(claim)) for claim in CLAIMS)
    assert judge.brief(report).splitlines()[-3:] == [
        f"of {judged - 32} statements predicted holds: {judged - 35}, not measured: 3",
        "of 15 statements fitted holds: 15",
        "of 17 statements under laws of their own, or none holds: 17",
    ]
    troubles["S9"] = KeyError("a mistake of ours")
    with pytest.raises(KeyError):
        judge.judge(quick=True)


@pytest.mark.parametrize(
    ("law", "apart", "off"),
    [(md.appendix_a(), (1e-8, 1e-5), 3e-6), (md.coulomb(), (1e-5, 3e-3), 3e-4)],
)
def test_two_methods_of_the_papers_time_meet_the_impact(law, apart, off):
    """Their forces are written out for them; they differ from `md.impact` as their step does."""
    least, most = apart
    assert least < gear.difference(law) < most
    dt = PAPER_STEP / 4
    steps = int(2 * contact_time(law, 1.0) / dt)
    hits = [one_impact(tilt, law, dt=dt)[:3] for tilt in TABLE_TILTS]
    for method in (gear.leapfrog, gear.gear):
        assert np.abs(method(law, dt, steps) - np.transpose(hits)).max() < off


def test_the_command_judges_claims(tmp_path, monkeypatch):
    """Stored figures are read, as far as the folder holds them; every number is registered."""
    kind, ones = np.array([[-1, 0], [1, 1], [1, 1]]), np.ones((3, 2))
    one = {"c_x": 0.5 * kind, "c_x_error": 0.1 * ones, "kind": kind, "V_z": -ones}
    grid = {"gamma": np.array([1.2, 2, 3]), **one, **{f"ring_{n}": x for n, x in one.items()}}
    alpha = {"gamma_alpha_impulse": np.array([[-0.5, 0.5]]), "gamma_drift": np.array([[2.0, 3.0]])}
    alpha |= {f"{name}_error": np.full((1, 2), 0.25) for name in alpha}
    for name, d in (("alpha", alpha), ("fig02", grid)):
        keep(tmp_path / f"{name}.npz", name, True, d)
    keys, measure = {}, judge.measure

    def noted(claim, evidence):
        return keys.setdefault(claim, measure(claim, evidence))

    monkeypatch.setattr(judge, "measure", noted)
    with tiny() as patch:
        patch.setattr(gear, "difference", lambda law: float(law.name == "appendix_a"))
        patch.setattr("figures.lib.data.load", lambda name: Mock(data=lambda quick: data(name)))
        enter("figures claims --quick --out", tmp_path, "--store", runs.STORE)
    assert names_in(tmp_path) == {"alpha.npz", "fig02.npz", "claims.json", "claims.md"}
    report = judge.load(tmp_path / "claims.json")
    for claim in report["claims"]:
        assert not claim["trouble"] or claim["id"] == "S4"  # of too few tilts
        assert {row["key"] for row in claim["numbers"]} == keys[claim["id"]].keys()
    two = {claim["id"] for claim in report["claims"] if "assumed" in claim}
    assert two == {"S4", "S5", "S6", "S8", "S18", "S20", "E1"}
    values = {name: row["value"] for name, row in judge.numbers(report).items()}
    assert {name: values[name] for name in KNOWN} == KNOWN
    assert 45 < values["E1.flat"] < values["E1.round"]
    assert 0 <= values["S22.pushed"] <= 1
    page = (tmp_path / "claims.md").read_text("utf-8")
    for words in ("`--quick`", f"Under {runs.ASSUMED_NAME}: drift", *(c["says"] for c in CLAIMS)):
        assert words in page


def test_the_committed_report_is_of_these_claims():
    """Words and limits are those of claims.toml; `figures pages` makes its page."""
    report = judge.load(gallery.GALLERY / "claims.json")
    assert not report["quick"]
    for found, claim in zip(report["claims"], CLAIMS, strict=True):
        for row in judge.statements(found):
            number = Number(row["value"], row["error"], row["notion"])
            assert row["verdict"] == judge.verdict(number, row)
        for row, known in zip(found["numbers"], claim["numbers"], strict=True):
            assert row.items() >= known.items()
        assert found == {**found, **claim, "numbers": found["numbers"]}
