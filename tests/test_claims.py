"""The judge of the paper's claims: limits, verdicts, the page; on made-up numbers and tiny runs."""

import dataclasses
import json
import os
from pathlib import Path
from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import psutil
import pytest

import md
from figures import FIGURES
from figures.__main__ import main
from figures.checks import phase_friction
from figures.claims import row_numbers as measured
from figures.claims import verdicts as claims
from figures.claims.number import Number, onset, resampled
from figures.lib import runs as rows
from figures.pages import everything as paper
from md.host import step_of
from md.store import Store
from md.sweep import Sweep, execute

from .command_line import refused
from .short_runs import shortened

mpl.use("Agg")

ROOT = Path(__file__).parent.parent
CLAIMS = claims.read()
IDS = [*(f"S{i}" for i in range(1, 27)), "E1", "E2", "E3"]


# Data


def test_every_claim_is_there_once():
    assert [claim["id"] for claim in CLAIMS] == IDS
    assert all(claim["numbers"] for claim in CLAIMS)


@pytest.mark.parametrize("claim", CLAIMS, ids=IDS)
def test_a_claim_says_what_and_where_and_how_it_is_judged(claim):
    assert claim["says"].endswith((".", "?"))
    assert claim["section"]
    if claim["numbers"]:
        assert claim["figure"] in FIGURES or claim["id"] == "S25"
        assert claim["scene"]
        assert claim["why"]
        assert any("holds" in row for row in claim["numbers"])
    known = {"id", "says", "section", "figure", "scene", "why", "remark", "numbers"}
    assert set(claim) == known
    for row in claim["numbers"]:
        assert set(row) <= {"key", "name", "unit", "holds", "partly"}
        assert ("holds" in row) == ("partly" in row)
        if "holds" in row:
            (low, high), (wide, far) = row["holds"], row["partly"]
            assert wide <= low <= high <= far
            assert -np.inf < low or high < np.inf


def test_the_code_gives_what_the_data_names_and_nothing_else():
    named = {c["id"]: sorted(row["key"] for row in c["numbers"]) for c in CLAIMS if c["numbers"]}
    assert {claim: sorted(keys) for claim, (keys, _) in measured.MEASURES.items()} == named


# Verdicts

LIMITS = {"holds": [0.4, 0.6], "partly": [0.2, 0.8]}


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        *((0.5, 2), (0.4, 2), (0.6, 2), (0.39, 1), (0.2, 1), (0.8, 1), (0.81, 0), (-1.0, 0)),
        *((np.inf, 0), (-np.inf, 0), (np.nan, None)),
    ],
)
def test_grade(value, expected):
    assert claims.grade(value, LIMITS) == expected
    assert claims.grade(value, {}) is None
    assert claims.grade(1e300, {"holds": [0, np.inf], "partly": [-np.inf, np.inf]}) == 2


@pytest.mark.parametrize(
    ("grades", "expected"),
    [
        *(([2], "holds"), ([2, 2], "holds"), ([0], "does not hold"), ([0, 0], "does not hold")),
        *(([1], "holds in part"), ([2, 1], "holds in part"), ([0, 1], "holds in part")),
        *(([2, 0], "holds in part"), ([2, None], "not measured"), ([], "not measured")),
    ],
)
def test_verdict(grades, expected):
    assert claims.verdict(grades) == expected


def test_close_calls():
    """Two standard errors from a border, or one error of another notion."""

    def close(value, error, notion="standard error", limits=LIMITS):
        return claims.close(Number(value, error, notion), limits)

    assert close(0.5, 0.051)
    assert not close(0.5, 0.049)
    assert close(0.7, 0.051)
    assert close(0.9, 0.051)
    assert not close(0.5, 0.09, "half interval")
    assert close(0.5, 0.11, "half interval")
    assert not close(0.4, np.nan)
    assert not close(np.nan, 0.1)
    assert not close(np.inf, 0.1)
    assert not close(0.4, 1.0, limits={})
    assert not close(0.0, 0.1, limits={"holds": [-np.inf, 1], "partly": [-np.inf, 2]})


# Errors


def test_errors_of_what_is_made_of_measured_points():
    d = {"y": np.arange(4.0), "y_error": np.full(4, 0.2), "z": np.ones(4)}
    mean = resampled(d, lambda d: (d["y"] + d["z"]).mean(), "y")
    assert mean.value == 2.5
    assert mean.error == pytest.approx(0.1, rel=0.15)
    assert mean == resampled(d, lambda d: (d["y"] + d["z"]).mean(), "y")
    assert np.isnan(resampled(d, lambda d: np.nan, "y").error)


def test_onset_lies_between_two_points_of_the_grid():
    gamma = np.array([1.2, 1.6, 2.0, 3.0])

    def found(*begun):
        return onset(gamma, np.array(begun, bool))[:2]

    assert found(0, 0, 1, 1) == pytest.approx((1.8, 0.2))
    assert found(1, 0, 0, 1) == pytest.approx((2.5, 0.5))
    assert found(1, 1, 1, 1) == pytest.approx((1.1, 0.1))
    assert found(1, 1, 1, 0)[0] == np.inf


# Page


def fake(claim, value=None):
    """A measurement that meets all limits."""

    def middle(row):
        low, high = (np.clip(x, -1e3, 1e3) for x in row.get("holds", (0, 0)))
        return Number((low + high) / 2 if value is None else value)

    keys = tuple(row["key"] for row in claim["numbers"])
    return keys, lambda quick: [middle(row) for row in claim["numbers"]]


def fakes(**other):
    return {c["id"]: fake(c) for c in CLAIMS if c["numbers"]} | other


def test_trouble_with_one_claim_leaves_the_others(monkeypatch):
    def lost(quick):
        raise ValueError("no such\nrun")

    keys = fakes()["S2"][0]
    short = fakes()["S9"][0], lambda quick: [Number(1.0)]
    blank = fake(CLAIMS[IDS.index("S24")], np.nan)
    made = fakes(S2=(keys, lost), S9=short, S24=blank)
    monkeypatch.setattr(measured, "MEASURES", made)
    report = claims.judge(quick=True)
    found = {claim["id"]: claim["verdict"] for claim in report["claims"]}
    missing = dict.fromkeys(("S2", "S9", "S24"), "not measured")
    assert found == {**dict.fromkeys(IDS, "holds"), **missing}
    page, lines = claims.page(report), claims.brief(report).splitlines()
    assert "No verdict: ValueError: no such run." in page
    assert "holds: 26, not measured: 3" in page
    assert lines[1].split() == ["S2", *["not", "measured", "ValueError:", "no", "such", "run"]]
    assert len(lines) == len(IDS) + 1
    assert "no data" in next(line for line in page.splitlines() if line.startswith("| [S24]"))


def test_numbers_are_shown_to_the_digits_of_their_errors():
    def shown(value, error=np.nan, **more):
        return claims.shown({"value": value, "error": error, **more})

    assert shown(1.23456, 0.012) == "1.235 ± 0.012"
    assert shown(123.456, 7.0, unit="deg") == "123.5 ± 7.0 deg"
    assert shown(1234.5, 120.0) == "1234 ± 120"
    assert shown(0.72103, 0.00056) == "0.72103 ± 0.00056"
    assert shown(0.5, 1e-9) == "0.5 ± 1e-09"
    assert shown(3.0) == "3"
    assert shown(np.inf) == "never"
    assert shown(np.nan) == "no data"


@pytest.fixture
def tiny(tmp_path, monkeypatch):
    """Short runs of few rows, in a store of their own."""
    shortened(monkeypatch, tmp_path)
    monkeypatch.setattr(measured, "FREQUENCY_TILTS_DEG", (21, 40))
    measured.table.cache_clear()
    yield tmp_path
    measured.table.cache_clear()


def test_the_command_judges_all_claims(tiny, capsys):
    out = tiny / "out"
    assert main(["claims", "--quick", "--out", str(out)]) == 0
    made = {path.name for path in out.iterdir() if not path.name.startswith("rows.db-")}
    assert made == {"claims.json", "claims.md", "rows.db"}
    assert not (tiny / "rows.db").exists()
    report = json.loads((out / "claims.json").read_text(encoding="utf-8"))
    found = {claim["id"]: claim for claim in report["claims"]}
    assert list(found) == IDS
    for name, claim in found.items():
        assert claim["verdict"] != claims.UNBUILT, name
        assert "Error" not in claim["trouble"], claim["trouble"]
    rows_of = {name: {r["key"]: r for r in c["numbers"]} for name, c in found.items()}
    assert rows_of["E3"]["threshold"]["value"] == pytest.approx(np.degrees(np.arctan(1 / 8)))
    assert rows_of["S15"]["coulomb_regimes"]["value"] == 17
    assert rows_of["S26"]["limit"]["value"] == pytest.approx(0.5, abs=1e-6)
    assert rows_of["S26"]["rate"]["value"] == pytest.approx(1, abs=0.02)
    assert 0 <= rows_of["S22"]["pushed"]["value"] <= 1
    assert rows_of["S12"]["mean"]["error"] > 0
    assert report["provenance"]["quick"] is True
    page = (out / "claims.md").read_text(encoding="utf-8")
    assert "`--quick`" in page
    for claim in CLAIMS:
        assert claim["says"] in page
    printed = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in printed[:-1]] == IDS


def test_runs_go_to_the_store_asked_for(tiny):
    """And come from it the next time."""
    out, path = tiny / "out", tiny / "runs.db"
    command = ["draw", "phase_friction", "--quick", "--out", str(out), "--store", str(path)]
    runs, written = phase_friction.sweeps(quick=True)["grid"].points, []
    for _ in range(2):
        assert main(command) == 0
        with Store(path, write=False) as database:
            assert all(database.has(point.key) for point in runs)
            written.append([row["written"] for row in database.rows()])
    assert written[0] == written[1]
    assert {path.suffix for path in out.iterdir()} == {".npz", ".png", ".pdf"}
    assert not (tiny / "rows.db").exists()


def test_the_committed_page_is_of_these_claims():
    page = (ROOT / "figures" / "gallery" / "claims.md").read_text(encoding="utf-8")
    assert "from full runs" in page
    lines = [line for line in page.splitlines() if line.startswith(("| S", "| E", "| [S", "| [E"))]
    assert [line.split("]")[0].strip("|[ ").split()[0] for line in lines] == IDS
    for claim in CLAIMS:
        for part in ("says", "why", "remark", "scene"):
            assert claim[part] in page, f"{claim['id']}: make the page anew"
        for row in claim["numbers"]:
            assert row["name"] in page
    verdicts = [line.split(" | ")[-1].strip(" |") for line in lines]
    assert "not measured" not in verdicts
    counted = f"**{claims.counts({'claims': [{'verdict': of} for of in verdicts]})}**"
    assert counted in page
    assert counted in (ROOT / "README.md").read_text(encoding="utf-8")


# Commands


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["claims", "--out", "FILE"], "FILE"),
        (["claims", "--store", "FILE"], "FILE"),
        (["claims", "--fast"], "--fast"),
        (["paper", "--out", "FILE"], "FILE"),
        (["paper", "--store", "FILE"], "FILE"),
        (["draw", "fig10", "--store", "FILE"], "FILE"),
        (["prices", "--store", "FILE"], "FILE"),
        (["prices", "--store", "no/folder.db"], "no such folder"),
        (["claims", "--store", "out/claims.json"], "store must be another file"),
        (["paper", "--store", "out/fig13.npz"], "store must be another file"),
        (["draw", "fig10", "--out", "new.db", "--store", "./new.db"], "store must be another file"),
    ],
)
def test_nonsense_costs_one_line(arguments, word, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "FILE").write_text("no store")
    refused(lambda: main(arguments), word, capsys)
    assert (tmp_path / "FILE").read_text() == "no store"
    assert not [path for path in tmp_path.rglob("*") if path.is_file() and path.name != "FILE"]


def test_a_figure_is_drawn_again_if_a_source_is_newer(tmp_path):
    assert paper.left(tmp_path) == list(FIGURES)
    for kind in ("npz", "png", "pdf"):
        (tmp_path / f"fig10.{kind}").touch()
        (tmp_path / f"fig11.{kind}").touch()
        (tmp_path / f"alpha.{kind}").touch()
    for name, quick in (("fig10", False), ("fig11", True), ("alpha", False)):
        np.savez(tmp_path / f"{name}.npz", provenance=json.dumps({"quick": quick}))
    os.utime(tmp_path / "alpha.png", (0, 0))
    assert set(FIGURES) - set(paper.left(tmp_path)) == {"fig10"}


def test_estimate_counts_what_the_store_lacks(tiny, monkeypatch):
    monkeypatch.setattr(paper, "FIGURES", {"phase_friction": FIGURES["phase_friction"]})
    monkeypatch.setattr(paper, "load", lambda name: phase_friction)
    monkeypatch.setattr(paper, "measured", SimpleNamespace(__file__=measured.__file__))
    some = phase_friction.sweeps(quick=True)
    monkeypatch.setattr(phase_friction, "sweeps", lambda: some)
    assert list(map(len, paper.missing())) == [len(some["grid"].points)]
    assert paper.estimate(tiny).startswith(f"{len(some['grid'].points)} runs")
    rows.computed(some["grid"])
    assert paper.missing() == [[]]
    assert paper.estimate(tiny).startswith("0 runs that the store lacks: 0 s")


def test_rows_and_annulus_are_estimated_each_at_its_rate(monkeypatch):
    """And a rare kernel, of which no run is timed, is still to be compiled."""

    def rate(scene):
        return 130e-9 if scene.annulus else 30e-9

    def timed(scene):
        return 7.0, rate(scene) * step_of(scene)[1] * scene.rods.count

    def serial(**_):
        return lambda tasks: [function(*given) for function, given, _ in tasks]

    monkeypatch.setattr(paper, "timed", timed)
    monkeypatch.setattr(paper, "Parallel", serial)
    seeds = [{"start.seed": list(range(60))}]
    slippery = {"contacts.plate.friction": 0}
    sweeps = (
        *(rows.planned(seeds, 300), rows.planned(seeds, 400, base=rows.ANNULUS)),
        rows.planned([{"start.seed": [1]}], 300, slippery),
    )
    points = [point for sweep in sweeps for point in sweep.points]
    seconds, compiling = paper.run_seconds(points)
    assert compiling == 7.0
    expected = {p.key: p.periods * timed(p.scene)[1] for p in points}
    assert seconds == pytest.approx(expected)
    assert paper.run_seconds([]) == ({}, 0.0)


@pytest.mark.parametrize(
    ("seconds", "cores", "whole"),
    [([], 2, 0), ([3], 4, 3), ([1, 1, 1], 2, 2), ([4, 1, 1, 1], 2, 4), ([1, 1, 4], 2, 5)],
)
def test_runs_share_the_cores(seconds, cores, whole):
    assert paper._span(seconds, cores) == whole


@pytest.mark.slow
def test_runs_take_the_time_that_was_estimated(tmp_path):
    """Of the processor, for a part of the plan, rows and annulus, none of it in the store."""
    me = psutil.Process()

    def spent():
        workers = me.children(recursive=True)
        return sum(os.times()[:4]) + sum(sum(worker.cpu_times()[:2]) for worker in workers)

    points, random = [p for part in paper.missing() for p in part], np.random.default_rng(1)
    chosen = []
    for plane, count in ((True, 30), (False, 10)):
        alike = [point for point in points if (point.scene.annulus is None) is plane]
        places = random.choice(len(alike), count, replace=False)
        chosen += [dataclasses.replace(alike[place], periods=80) for place in places]
    for point in chosen:
        md.run(point.scene, periods=1)  # compiles
    seconds, compiling = paper.run_seconds(chosen)
    assert compiling < 5
    before = spent()
    tally = execute(Sweep(({"": chosen},), tuple(chosen)), tmp_path / "rows.db")
    assert tally.computed == len(chosen)
    assert sum(seconds.values()) == pytest.approx(spent() - before, rel=0.3)
