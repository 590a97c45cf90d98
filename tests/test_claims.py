"""Judging the paper's claims: limits, verdicts, pages; on made-up numbers and tiny runs."""

import json

import numpy as np
import pytest

import md
from figures import FIGURES
from figures.__main__ import main
from figures.checks import phase_friction
from figures.claims import across_laws, judge, limits, measure_rows, over_laws, over_tilt
from figures.claims.evidence import Evidence, Whole
from figures.claims.measure_annulus import begins
from figures.claims.over_laws import FITTED
from figures.claims.uncertainty import Number, onset, peak, resampled
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
    "which_law",
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


AWAITED = {"S7", "S26"}  # of stationary states now; the report judges runs of one length

# claims.toml


def test_every_claim_says_what_and_where_and_how_it_is_judged():
    """And is there once; the contact laws are judged by the limits of the claims."""
    heads = {name for name, row in over_laws.JUDGED.items() if "head" in row}
    assert [claim["id"] for claim in CLAIMS] == IDS
    for claim in CLAIMS:
        assert all(claim[part] for part in ("says", "section", "scene", "why"))
        assert claim["figure"] in FIGURES or claim["id"] == "S25"
        assert any("holds" in row for row in claim["numbers"])
        for row in claim["numbers"]:
            assert ("head" in row) == ("paper" in row) == (f"{claim['id']}.{row['key']}" in heads)
            assert ("holds" in row) == ("partly" in row)
            if "holds" in row:
                (low, high), (wide, far) = row["holds"], row["partly"]
                assert wide <= low <= high <= far
                assert -np.inf < low or high < np.inf


# Verdicts

LIMITS = {"holds": [0.4, 0.6], "partly": [0.2, 0.8]}


def test_grade():
    values = (0.5, 0.4, 0.6, 0.39, 0.2, 0.8, 0.81, -1.0, np.inf, -np.inf, np.nan)
    found = [limits.grade(value, LIMITS) for value in values]
    assert found == [2, 2, 2, 1, 1, 1, 0, 0, 0, 0, None]
    assert limits.grade(0.5, {}) is None
    assert limits.grade(1e300, {"holds": [0, np.inf], "partly": [-np.inf, np.inf]}) == 2


VERDICTS = {
    "holds": ([2], [2, 2]),
    "holds in part": ([1], [2, 1], [0, 1], [2, 0]),
    "does not hold": ([0], [0, 0]),
    "not measured": ([2, None], []),
}


@pytest.mark.parametrize("expected", VERDICTS)
def test_verdict(expected):
    assert {limits.verdict(grades) for grades in VERDICTS[expected]} == {expected}


def test_close_calls():
    """Two standard errors from a limit, or one error of another notion; an error not known."""
    one_sided, other = {"holds": [-np.inf, 1], "partly": [-np.inf, 2]}, "half interval"
    near = [(0.5, 0.051), (0.7, 0.051), (0.9, 0.051), (0.5, 0.11, other), (0.4, np.nan)]
    far = [(0.5, 0.049), (0.5, 0.09, other), (0.4, np.nan, "count"), (np.nan, 0.1), (np.inf, 0.1)]
    for numbers, expected in ((near, True), (far, False)):
        for value, error, *notion in numbers:
            number = Number(value, error, *(notion or ["standard error"]))
            assert judge.close(number, LIMITS) == expected, number
    assert not judge.close(Number(0.4, 1.0), {})
    assert not judge.close(Number(0.0, 0.1), one_sided)


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


@pytest.mark.parametrize(("c_x", "rise"), [([9, 7, 4, 6, 5, 9], 2), ([9, 8, 7, 5, 4, 9], -1)])
def test_a_bump_is_a_rise_between_20_and_45_degrees(c_x, rise):
    d = {"nominal": np.array([15, 22, 28, 34, 45, 60]), "c_x": np.array(c_x, float)}
    assert over_tilt.NUMBERS["S16.bump"](d) == rise


SEARCHED = {"laws": 9, "of": 5, "best": 3.0, "score": 3.0, "spread": 0.5, "as_good": 1}
SEARCHED["next"] = [2.5, 0.4]
SEARCHED["known"] = {"simple": 2.0}
SPUN = {"parameter": "restitution, rods", "rank": -0.85, "middle": [0.7, 0.9]}
TOLD = {
    "numbers": {
        "S2.rms": {"counts": [8, 0, 0], "follows": None},
        "S13.small": {"counts": [38, 2, 0], "follows": None},
        "S10.spin": {"counts": [37, 2, 1], "follows": SPUN},
        "S21.largest": {"counts": [2, 9, 29], "follows": {**SPUN, "middle": []}},
    },
    "excluded": [("S10.spin", "S21.largest", 9.4)],
    "forms": {"Appendix A": [3, 4]},
    "over_theory": {"law": [0.5, 0.9, 1.0, 1.1], "laws": [0.6, 0.7]},
}


def test_a_claim_without_data_leaves_the_others(monkeypatch):
    def middle(row):
        low, high = (np.clip(x, -1e3, 1e3) for x in row.get("holds", (0, 0)))
        return (low + high) / 2

    def measure(claim, evidence):
        if claim in troubles:
            raise troubles[claim]
        rows = CLAIMS[IDS.index(claim)]["numbers"]
        return {row["key"]: Number(np.nan if claim == "S24" else middle(row)) for row in rows}

    troubles = {"S2": np.linalg.LinAlgError("no such\nrun")}
    monkeypatch.setattr(judge, "measure", measure)
    monkeypatch.setattr(Evidence, "figure", lambda *_: {})
    monkeypatch.setattr(across_laws, "told", lambda _: TOLD)
    monkeypatch.setattr(over_laws, "outcome", lambda _: SEARCHED)
    report = judge.judge(quick=True)
    found = {claim["id"]: claim["verdict"] for claim in report["claims"]}
    missing = dict.fromkeys(("S2", "S24"), "not measured")
    assert found == {**dict.fromkeys(IDS, "holds"), **missing}
    page, lines = gallery.claims_page(report), judge.brief(report).splitlines()
    assert "No verdict: LinAlgError: no such run." in page
    assert "holds: 27, not measured: 2" in page
    assert " ".join(lines[1].split()) == "S2 not measured LinAlgError: no such run"
    assert len(lines) == len(IDS) + 1
    assert judge.score(report) == (FITTED.sum() - 1,) * 2  # S1 is of another law
    groups = judge.trust(report)
    assert {name: [row["id"] for row in of] for name, of in groups.items()} == {
        "all": ["S13"],  # S2 chooses the laws
        "some": ["S10"],
        "none": ["S21"],
    }
    spin, slide = (judge.numbers(report)[key][1]["name"] for key in ("S10.spin", "S21.largest"))
    cells = "≤ 0.1 | 37/2/1 | restitution, rods: -0.85 | 0.7 to 0.9"
    assert f"| S10 | {spin} | {cells} |" in page
    assert f"- S10, {spin}; S21, {slide} (9)" in page
    assert "3 of 4 of Appendix A" in page
    assert "no data" in next(line for line in page.splitlines() if line.startswith("| [S24]"))
    troubles["S9"] = KeyError("a mistake of ours")
    with pytest.raises(KeyError):
        judge.judge(quick=True)


SHOWN = {
    "1.235 ± 0.012": (1.23456, 0.012),
    "1234 ± 120": (1234.5, 120.0),
    "0.72103 ± 0.00056": (0.72103, 0.00056),
    "0.5 ± 1e-09": (0.5, 1e-9),
    "3": (3.0, np.nan),
    "never": (np.inf, np.nan),
    "no data": (np.nan, np.nan),
}


def test_numbers_are_shown_to_the_digits_of_their_errors():
    for text, (value, error) in SHOWN.items():
        assert judge.shown({"value": value, "error": error}) == text
    assert judge.shown({"value": 123.456, "error": 7.0, "unit": "deg"}) == "123.5 ± 7.0 deg"


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
    assert f"Under {rows.ASSUMED_NAME}: {found['S18']['assumed']['verdict']}. drift" in page
    printed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in printed[:-1]] == list(found)


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
    parts = "key", "name", "unit", "holds", "partly"
    for found, claim in zip(report["claims"], CLAIMS, strict=True):
        assert found["verdict"] in limits.GRADES
        if claim["id"] in AWAITED:
            continue
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
    monkeypatch.setattr(phase_friction, "later", lambda: [*some["grid"].points[:1]], raising=False)
    assert everything.estimate(tmp_path).startswith("1 runs")


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
