"""Judging the paper's claims: limits, verdicts, pages; on made-up numbers and tiny runs."""

import json

import numpy as np
import pytest

import md
from figures import FIGURES
from figures.__main__ import main
from figures.checks import phase_friction
from figures.claims import any_rods, judge, limits, measure_rows, over_tilt
from figures.claims.evidence import Evidence, Whole
from figures.claims.limits import CLOSE, FAILS, HOLDS, MISSING
from figures.claims.measure_annulus import begins
from figures.claims.uncertainty import Number, exponents, onset, peak, resampled
from figures.lib import runs as rows
from figures.lib.data import keep
from figures.pages import everything, gallery
from md.host import step_of
from md.store import Store

from .quick_figures import data, tiny

CLAIMS = limits.read()
IDS = [*(f"S{i}" for i in range(1, 27)), "E1", "E2", "E3"]
FIGURES_OF_CLAIMS = ("appendix_a", "fig04", "fig05", "fig08", "fig12", "fig13")
FIGURES_OF_CLAIMS += (
    "phase_friction",
    "tip_shape",
    "any_rods",
    "closure",
    "row_size",
)
KNOWN = {  # numbers that do not depend on how long the runs are
    ("E2", "slower"): 1,
    ("E3", "threshold"): pytest.approx(np.degrees(np.arctan(1 / 8)), abs=0.01),
    ("S15", "coulomb_regimes"): 17,
    ("S23", "lone_drift"): 2,
    ("S26", "limit"): pytest.approx(0.5, abs=1e-6),
    ("S26", "rate"): pytest.approx(1, abs=0.02),
    ("E3", "bounced_threshold"): pytest.approx(np.degrees(np.arctan(1 / 8)), abs=1),
}


# claims.toml


def test_every_claim_says_what_and_where_and_how_it_is_judged():
    """And is there once."""
    assert [claim["id"] for claim in CLAIMS] == IDS
    for claim in CLAIMS:
        assert all(claim[part] for part in ("says", "section", "scene", "why"))
        assert claim["figure"] in FIGURES or claim["id"] == "S25"
        assert any("holds" in row for row in claim["numbers"])
        for row in claim["numbers"]:
            assert row.get("fitted", False) <= ("holds" in row)
            if "holds" in row:
                low, high = row["holds"]
                assert low <= high
                assert -np.inf < low or high < np.inf
    assert sum(row.get("fitted", False) for claim in CLAIMS for row in claim["numbers"]) == 17


# Verdicts

LIMITS = {"holds": [0.4, 0.6]}


@pytest.mark.parametrize(
    ("expected", "numbers"),
    [
        (HOLDS, [(0.5, 0.049), (0.4, np.nan, "count"), (0.5, 0.09, "half interval")]),
        (FAILS, [(0.7, 0.049), (0.39, np.nan, "count"), (np.inf, 0.1), (-np.inf, 0.1)]),
        (CLOSE, [(0.5, 0.051), (0.7, 0.051), (0.5, 0.11, "half interval"), (0.4, np.nan)]),
        (MISSING, [(np.nan, 0.1)]),
    ],
)
def test_verdicts(expected, numbers):
    """Too close: two standard errors from a limit, or one error of another notion, or no error."""
    for value, error, *notion in numbers:
        number = Number(value, error, *(notion or ["standard error"]))
        assert judge.verdict(number, LIMITS) == expected, number
    assert judge.verdict(Number(1e300, 0.1), {"holds": [0, np.inf]}) == HOLDS


def test_deviations_are_in_allowances():
    """Around the middle of two limits, or from zero; of what is only to be large there is none."""
    assert limits.deviation(0.65, LIMITS) == pytest.approx(1.5)
    assert limits.deviation(0.35, LIMITS) == pytest.approx(-1.5)
    assert limits.deviation(0.3, {"holds": [-np.inf, 0.1]}) == pytest.approx(3)
    assert np.isnan(limits.deviation(0.3, {"holds": [0.1, np.inf]}))


# Errors


def test_onset_lies_between_two_points_of_the_grid():
    gamma = np.array([1.2, 1.6, 2.0, 3.0])
    found = {
        begun: onset(gamma, np.array([*begun]) == "1")[:2] for begun in ("0011", "1001", "1111")
    }
    expected = {"0011": (1.8, 0.2), "1001": (2.5, 0.5), "1111": (1.1, 0.1)}
    assert all(found[begun] == pytest.approx(expected[begun]) for begun in expected)
    assert onset(gamma, gamma < 3)[0] == np.inf


def test_arrays_that_are_read_vary_within_their_errors():
    d = {"x": np.arange(4.0), "y": np.ones(4), "y_error": np.full(4, 0.2), "z": np.ones(4)}
    d["z_error"] = d["y_error"]
    one = resampled(d, lambda d: (d["x"] + d["y"]).mean())
    assert one.value == 2.5
    assert one.error == resampled(d, lambda d: (d["z"] + d["y"]).mean(), "y").error
    assert one.error == pytest.approx(0.1, rel=0.15)
    both = resampled(d, lambda d: (d["z"] + d["y"]).mean())
    assert both.error == pytest.approx(0.1 * 2**0.5, rel=0.15)
    assert np.isnan(resampled(d, lambda d: np.nan, "y").error)
    d["y_error"] = np.full(4, np.nan)
    assert np.isnan(resampled(d, lambda d: d["y"].mean()).error)


def test_a_place_among_others_is_no_better_known_than_they_lie_apart():
    d = {"x": np.array([3.0, 1.0, 2.0]), "y": np.array([0.0, 1.0, 9.0])}
    assert peak(d, "x", "y")[:2] == (2.0, 0.5)


@pytest.mark.parametrize(
    ("c_x", "error"),
    [([1.0, np.nan, 3.0], [0.1, np.nan, 0.1]), ([1.0, 2.0, 3.0], [0.1, np.nan, 0.1])],
    ids=["all starts", "all but one"],
)
def test_what_has_not_run_is_not_taken_for_no_drift(c_x, error):
    d = {"gamma": np.array([1.1, 2, 3]), "c_x": np.array(c_x), "c_x_error": np.array(error)}
    whole = Whole(d)
    for read in (begins, lambda d, name: resampled(d, lambda d: np.mean(d[name] > 0))):
        with pytest.raises(md.RunError, match="c_x: runs are missing"):
            read(whole, "c_x")
    ran = Whole(d | {"c_x": np.array([0, 1, 9.0]), "c_x_error": np.full(3, 0.1)})
    assert begins(ran, "c_x")["onset"][:2] == pytest.approx((1.55, 0.45))


def test_the_error_within_runs_is_that_of_those_that_ran():
    _, error = rows.larger_error(np.array([[2.0, np.nan]]), np.array([[0.1, np.nan]]))
    assert error == pytest.approx(0.1)


def test_flights_change_half_way():
    d = {"nominal": np.array([9, 20, 30, 45]), "flight": np.array([2.0, 2.0, 1.0, 1.0])}
    assert over_tilt.change_tilt(d) == pytest.approx(25)
    assert over_tilt.change_tilt({**d, "flight": np.full(4, 0.9)}) == np.inf


# Pages


def test_a_bump_is_what_a_bell_adds_to_a_parabola():
    nominal = np.arange(9, 70, 3.0)
    off = (nominal - 30) / 15
    parabola = 8 - off + 0.5 * off**2
    for height in (0.8, 0.0, -0.4):
        bell = height * np.exp(-(((nominal - 30) / 4) ** 2) / 2)
        d = {"nominal": nominal, "c_x": np.where(abs(off) > 1, 99, parabola + bell)}
        assert over_tilt.NUMBERS["S16.bump"](d) == pytest.approx(height / 8, abs=1e-9)


def test_an_exponent_is_that_of_a_power():
    x = np.array([0.1, 0.3, 1.0])
    np.testing.assert_allclose(exponents(x, 5 * x**-0.7), -0.7)
    assert np.isnan(exponents(x, np.array([1.0, 0.0, 1.0]))).all()


# What holds for any rods


@pytest.fixture
def surveyed():
    """Made-up numbers of 64 kinds of rods: the first follows the plate's restitution."""
    kinds, names = 64, [*any_rods.JUDGED]
    random = np.random.default_rng(3)
    found = {name: random.random(kinds) for name in any_rods.PROPERTIES}
    value = np.full((kinds, len(names)), np.inf)
    value[:, names.index("S2.rms")] = 3 * found["restitution, plate"]
    nominal = np.array([9, 28, 45])
    theory = np.ones((kinds, 3))
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
    middle = np.percentile(plate[plate <= 0.5], [25, 75])
    assert rms["follows"] == {
        "property": "restitution, plate",
        "rank": pytest.approx(1),
        "middle": pytest.approx(middle),
    }
    assert told["numbers"]["S2.largest"] == {"share": 0, "follows": None}
    assert told["over_theory"] == [[0.5] * 3, [2.0] * 3]
    few = {**surveyed, "tilt_off": np.where(np.arange(64) < 60, 5.0, 1.0)}
    assert any_rods.told(few)["numbers"]["S2.rms"]["follows"] is None
    unknown = {**surveyed, "value": np.full_like(surveyed["value"], np.nan)}
    assert any_rods.told(unknown)["numbers"]["S2.rms"]["share"] is None


def test_kinds_of_rods_fill_their_ranges_and_run():
    """Plate and rods apart; every step resolves the springs."""
    sweep, drawn = any_rods.sweeps()["sets"], any_rods.drawn()
    assert len(sweep.points) == len(drawn["length"]) * len(any_rods.TILTS_DEG[False])
    for name, of in any_rods.PROPERTIES.items():
        part = (drawn[name] - of.low) / (of.high - of.low)
        if of.log:
            part = np.log(drawn[name] / of.low) / np.log(of.high / of.low)
        assert np.histogram(part, 4, (-1e-9, 1 + 1e-9))[0] == pytest.approx(64, abs=8), name
    for i in (0, 77, 255):
        scene = sweep.points[7 * i + 3].scene
        plate, rods = scene.contacts.plate, scene.contacts.rods
        assert plate.law.restitution == drawn["restitution, plate"][i]
        assert (rods.friction, plate.friction) == tuple(
            drawn[f"friction, {part}"][i] for part in ("rods", "plate")
        )
        assert scene.rods.count == drawn["number of rods"][i]
        assert np.degrees(scene.tilt) == pytest.approx(28, abs=2e-3)
        assert step_of(scene)[0] > 0
        assert not scene.step.coarse


# Pages


def middle(row):
    low, high = (np.clip(x, -1e3, 1e3) for x in row.get("holds", (0, 0)))
    return (low + high) / 2


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
    page, lines = gallery.claims_page(report), judge.brief(report).splitlines()
    assert "Not measured: LinAlgError: no such run." in page
    judged = sum(len(judge.statements(claim)) for claim in CLAIMS)
    assert lines[-2:] == [
        f"of {judged - 17} predicted statements holds: {judged - 20}, not measured: 3",
        "of 17 fitted statements holds: 17",
    ]
    assert " ".join(lines[1].split()).startswith("S2 0 of 2 hold rms no data ?,")
    assert len(lines) == len(IDS) + 2
    assert "no data" in next(line for line in page.splitlines() if line.startswith("| [S24]"))
    troubles["S9"] = KeyError("a mistake of ours")
    with pytest.raises(KeyError):
        judge.judge(quick=True)


def test_statements_are_grouped_by_the_rods_that_obey_them(surveyed):
    """Without those of the claim by which rows were chosen."""
    names = [*any_rods.JUDGED]
    surveyed["value"][:, names.index("S13.small")] = 9.0
    surveyed["value"][::2, names.index("S10.spin")] = 0.0
    report = {"claims": CLAIMS, "any_rods": any_rods.told(surveyed)}
    found = {name: {row["id"] for row in of} for name, of in judge.regions(report).items()}
    assert found["all"] >= {"S13"}
    assert found["some"] == {"S10"}
    assert found["none"] >= {"S21", "S22"}
    assert "S2" not in set.union(*found.values())


SHOWN = {
    "1.23 ± 0.01": (1.23456, 0.012),
    "1234 ± 120": (1234.4, 120.0),
    "0.721 ± 0.001": (0.72103, 0.00056),
    "0.721": (0.72103, 0.00046),
    "0.001 ± 0.020": (0.0012, 0.02),
    "0.500": (0.5, 1e-9),
    "3": (3.0, np.nan),
    "never": (np.inf, np.nan),
    "no data": (np.nan, np.nan),
}


def test_numbers_are_shown_to_the_digits_of_their_errors():
    for text, (value, error) in SHOWN.items():
        assert judge.shown({"value": value, "error": error}) == text
    assert judge.shown({"value": 123.456, "error": 7.0, "unit": "deg"}) == "123 ± 7 deg"


@pytest.fixture
def small():
    """Short runs of few rows."""
    with tiny():
        yield


def test_the_command_judges_claims(small, tmp_path, monkeypatch, capsys):
    """Stored figures are read, as far as the folder holds them."""
    kind, ones = np.array([[-1, 0], [1, 1], [1, 1]]), np.ones((3, 2))
    one = {"c_x": 0.5 * kind, "c_x_error": 0.1 * ones, "kind": kind, "V_z": -ones}
    grid = {"gamma": np.array([1.2, 2, 3]), **one, **{f"ring_{n}": x for n, x in one.items()}}
    alpha = {"gamma_alpha_impulse": np.array([[-0.5, 0.5]]), "gamma_drift": np.array([[2.0, 3.0]])}
    alpha |= {f"{name}_error": np.full((1, 2), 0.25) for name in alpha}
    figures = {name: data(name) for name in FIGURES_OF_CLAIMS} | {"alpha": alpha, "fig02": grid}
    for name, d in figures.items():
        keep(tmp_path / f"{name}.npz", name, True, d)
    keys, measure = {}, judge.measure

    def noted(claim, evidence):
        return keys.setdefault(claim, measure(claim, evidence))

    monkeypatch.setattr(judge, "measure", noted)
    command = ["claims", "--quick", "--out", str(tmp_path), "--store", str(rows.STORE)]
    assert main(command) == 0
    made = {path.name for path in tmp_path.iterdir()}
    assert made == {*(f"{name}.npz" for name in figures), "claims.json", "claims.md"}
    report = json.loads((tmp_path / "claims.json").read_text(encoding="utf-8"))
    found = {claim["id"]: claim for claim in report["claims"]}
    for claim in CLAIMS:
        assert not found[claim["id"]]["trouble"] or claim["id"] == "S4"  # of too few tilts
        assert {row["key"] for row in claim["numbers"]} == keys[claim["id"]].keys()
    two = {name for name, claim in found.items() if "assumed" in claim}
    assert two == {"S4", "S5", "S6", "S8", "S18", "S20", "E1"}
    numbers = {(c["id"], row["key"]): row for c in report["claims"] for row in c["numbers"]}
    assert numbers["S12", "mean"]["error"] > 0
    assert 0 <= numbers["S22", "pushed"]["value"] <= 1
    for key, value in KNOWN.items():
        assert numbers[key]["value"] == value, key
    assert report["provenance"]["quick"] is True
    page = (tmp_path / "claims.md").read_text(encoding="utf-8")
    assert "`--quick`" in page
    assert all(claim["says"] in page for claim in CLAIMS)
    assert f"Under {rows.ASSUMED_NAME}: drift" in page
    printed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in printed[:-2]] == list(found)


def test_runs_go_to_the_store_asked_for(small, tmp_path):
    """And come from it the next time; `figures paper` counts those that it lacks."""
    out, path = tmp_path / "out", tmp_path / "runs.db"
    command = ["draw", "phase_friction", "--quick", "--out", str(out), "--store", str(path)]
    runs, written = phase_friction.sweeps(quick=True)["grid"].points, []
    for _ in range(2):
        assert main(command) == 0
        with Store(path, write=False) as database:
            assert all(database.has(point.key) for point in runs)
            written.append([row["written"] for row in database.rows()])
    assert written[0] == written[1]
    assert {path.suffix for path in out.iterdir()} == {".npz", ".png", ".pdf"}


def test_the_committed_report_is_of_these_claims():
    """Words and limits are those of claims.toml; `figures pages` makes its page."""
    report = judge.load(gallery.GALLERY / "claims.json")
    assert not report["quick"]
    parts = "key", "name", "unit", "holds", "fitted"
    for found, claim in zip(report["claims"], CLAIMS, strict=True):
        for row in judge.statements(found):
            number = Number(row["value"], row["error"], row["notion"])
            assert row["verdict"] == judge.verdict(number, row)
        rows, known = ([[r.get(p) for p in parts] for r in c["numbers"]] for c in (found, claim))
        assert rows == known, f"{claim['id']}: judge the claims again"
        words = {part: claim[part] for part in claim if part != "numbers"}
        assert found.items() >= words.items(), f"{claim['id']}: judge the claims again"


# All of it


def test_figures_are_left_to_draw_if_not_whole_or_of_other_sources(tmp_path, monkeypatch):
    assert everything.left(tmp_path) == list(FIGURES)
    for name, quick in (("fig10", False), ("fig11", True), ("alpha", False), ("fig12", False)):
        keep(tmp_path / f"{name}.npz", name, quick, {})
        (tmp_path / f"{name}.png").touch()
        (tmp_path / f"{name}.pdf").touch()
    (tmp_path / "fig12.pdf").unlink()
    with monkeypatch.context() as patch:
        patch.setattr("figures.lib.data.sources", lambda name: "others")
        keep(tmp_path / "alpha.npz", "alpha", False, {})
    assert set(FIGURES) - set(everything.left(tmp_path)) == {"fig10"}


def test_estimate_counts_what_the_store_lacks(small, tmp_path, monkeypatch):
    monkeypatch.setattr(rows, "STORE", tmp_path / "rows.db")
    monkeypatch.setattr(everything, "FIGURES", {"phase_friction": FIGURES["phase_friction"]})
    monkeypatch.setattr(everything, "load", lambda name: phase_friction)
    monkeypatch.setattr(everything, "OF_CLAIMS", ())
    some = phase_friction.sweeps(quick=True)
    monkeypatch.setattr(phase_friction, "sweeps", lambda: some)
    assert len(everything.missing()) == len(some["grid"].points)
    assert everything.estimate(tmp_path).startswith(f"{len(some['grid'].points)} runs")
    rows.computed(some["grid"])
    assert everything.missing() == []
    assert everything.estimate(tmp_path).startswith("0 runs that the store lacks: 0 s")


def test_rows_and_annulus_are_estimated_each_at_its_rate():
    seeds = [{"start.seed": list(range(60))}]
    row, ring = rows.planned(seeds, 300).points, rows.planned(seeds, 400, base=rows.ANNULUS).points
    expected = sum(
        p.periods * step_of(p.scene)[1] * p.scene.rods.count * ns * 1e-9
        for points, ns in ((row, 20), (ring, 60))
        for p in points
    )
    assert everything.run_seconds([*row, *ring]) == pytest.approx(expected)
    assert everything.run_seconds([]) == 0


@pytest.mark.parametrize("time", [100, 800, 10_000])
def test_a_slow_start_tells_what_it_comes_to(time):
    """Stationary value and time from a run three times as long; from a shorter one, the slope."""
    series = -3 * np.expm1(-(np.arange(3000) + 0.5) / time)
    noise = 0.1 * np.random.default_rng(1).normal(size=3000)
    value, found = measure_rows.relaxation(series + noise)
    if time < 1000:
        assert (value, found) == (pytest.approx(3, rel=0.02), pytest.approx(time, rel=0.03))
    assert value / found == pytest.approx(3 / time, rel=0.04)
