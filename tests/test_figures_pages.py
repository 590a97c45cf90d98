"""Index, sliders, README and guide, movie, what is left to do: whole, of numbers that are known."""

import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import asdict
from html import unescape
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

import matplotlib.pyplot as plt
import numpy as np
import pytest
from PIL import Image

import impact
import md
from derivations import report
from derivations.registry import ENTRIES
from figures import FIGURES
from figures.__main__ import main
from figures.checks import row_size
from figures.claims import judge
from figures.cost.price_page import PRICE_PANELS
from figures.lib import runs
from figures.lib.data import keep
from figures.lib.printing import plain
from figures.pages import everything, gallery, index, movie
from figures.pages.explore import CHOICES, RANGES, ROWS, WORDS, Setting
from md.host import prepare
from md.store import Store

from .command_line import ROOT, refused
from .page import Page, stands_alone
from .quick_figures import tiny
from .test_help import ALL, GROUPS

# The front page of a folder

LENT = [name for name in FIGURES if (gallery.GALLERY / f"{name}.png").is_file()]
STRANGE = ("a <b>&\"' %23?#.gif", "javascript:alert(1).gif", f"{'x' * 200}.gif", "Größe \u202e.gif")


def picture(path: Path) -> None:
    Image.new("RGB", (30, 20), "white").save(path)


def as_read(source: str) -> str:
    """HTML without its marks."""
    return unescape(re.sub(r"<[^>]+>", "", source))


def made(out: Path) -> tuple[str, Page]:
    """The page of `out` and what is read in it; all that it names lies in the folder."""
    assert main(["index", "--out", str(out)]) == 0
    source = (out / "index.html").read_text(encoding="utf-8")
    page = Page(source)
    for link in page.links:
        assert not re.match(r"[a-z]+:|/", link), link
        path, _, label = link.partition("#")
        if path:
            assert (out / os.fsdecode(unquote_to_bytes(path))).is_file(), link
            # a link into another page leads somewhere there
            assert not label or f'id="{label}"' in (out / path).read_text(encoding="utf-8")
        else:
            assert label in page.ids
    return source, page


@pytest.fixture(scope="module")
def half(tmp_path_factory):
    """Half of the pictures, one of them at first look; a report, prices, a movie; oddities."""
    out = tmp_path_factory.mktemp("half")
    for name in list(FIGURES)[::2]:
        picture(out / f"{name}.png")
        (out / f"{name}.pdf").touch()
    np.savez(out / "fig02.npz", provenance=json.dumps({"quick": True}))
    np.savez(out / "fig05.npz", provenance=json.dumps({"quick": False}))
    (out / "fig08.npz").write_bytes(b"PK\x03\x04 no archive")
    for name in (*STRANGE, ".quasi2d.part.gif", "prices.png", "quasi2d.gif"):
        picture(out / name)
    (out / "cut.gif").write_bytes((out / "fig02.png").read_bytes()[:60])
    (out / "folder.gif").mkdir()
    (out / "broken.gif").touch()
    (out / "prices.txt").write_text(f"effect <b> & more{' far' * 99}", encoding="utf-8")
    ids = "".join(f'<i id="{report.anchor(entry.tag)}"></i>' for entry in ENTRIES)
    summary = "<h2>Verdicts</h2><p>96 entries. 2 of them not proved.</p>"
    (out / "report.html").write_text(f"{summary}{ids}", encoding="utf-8")
    return out, *made(out)


@pytest.fixture(scope="module")
def bare(tmp_path_factory):
    """Nothing but a file to show: the gallery stands in for the rest."""
    out = tmp_path_factory.mktemp("bare")
    (out / "prices.txt").touch()
    return out, *made(out)


def test_what_a_folder_lacks_is_lent(bare):
    """Pictures, movie, and every statement of the claims."""
    out, source, page = bare
    assert "python -m derivations report" in page.text["derivations"]
    assert "report.html" not in source
    lent = {f"gallery/{path.name}" for path in (out / "gallery").iterdir()}
    for name in lent:
        assert (out / name).read_bytes() == (gallery.GALLERY.parent / name).read_bytes()
    assert lent | {"impact.html"} == {link for link in page.links if not link.startswith("#")}
    named = {"row.gif", "claims.md", "claims.json", *(f"{name}.png" for name in LENT)}
    assert {f"gallery/{name}" for name in named} <= lent
    assert {p.name for p in out.iterdir()} == {"gallery", "impact.html", "index.html", "prices.txt"}
    words = index.Folder(out).text
    for claim in judge.load(gallery.GALLERY / "claims.json")["claims"]:
        assert claim["id"] in page.text["claims"]
        for row in judge.statements(claim):
            shown = f"{words(row['name'])}: {words(judge.shown(row))}"
            assert as_read(shown) in page.text["claims"]


def test_every_figure_is_there_with_its_command(half):
    """What is not drawn is no broken picture."""
    out, source, page = half
    drawn = list(FIGURES)[::2]
    assert re.findall(r"\d+ of \d+ figures", source) == [f"{len(drawn)} of {len(FIGURES)} figures"]
    for name in FIGURES:
        text, own = page.text[name], name in drawn
        assert f"python -m figures draw {name}" in text
        assert "minutes)" in text
        assert (f"{name}.png" in page.links) == own
        assert ("From the project’s gallery." in text) == (name in LENT and not own)
        assert ("A first look" in text) == (name == "fig02")
        assert text in page.text["prices" if name in PRICE_PANELS else "pictures"]
    sources = [image["src"] for image in page.images]
    assert len(sources) == len(set(sources))
    assert not {f"{name}.png" for name in FIGURES if name not in drawn} & set(sources)
    for image in page.images:
        with Image.open(out / unquote(image["src"])) as opened:
            assert opened.size == (int(image["width"]), int(image["height"]))
        assert image["alt"]
        assert image["loading"] == "lazy"
        assert image["src"] in page.links


def test_strange_names_are_shown_and_do_no_harm(half):
    _, source, page = half
    for name in STRANGE:
        assert name in [unquote(image["src"]) for image in page.images]
        assert name.removesuffix(".gif") in page.text["movie"]
    assert "<b>&" not in source
    for name in ("broken.gif", "cut.gif", "folder.gif", ".part"):
        assert name not in source


def test_derivations_prices_and_movie_in_one_file(half):
    _, source, page = half
    assert "96 entries. 2 of them not proved." in page.text["derivations"]
    for verdict in {entry.verdict for entry in ENTRIES}:
        count = sum(entry.verdict == verdict for entry in ENTRIES)
        assert re.search(rf"{verdict}</span></td><td>[^<]+</td><td>{count}</td>", source)
    assert "report.html#eq-26" in page.links  # named in the caption of Fig. 11
    assert "effect <b> & more" in page.text["prices"]
    assert {"prices.png", "quasi2d.gif"} <= set(page.links)
    assert "gallery/row.gif" not in page.links
    stands_alone(source, page)
    assert "url(" not in source
    assert report.STYLE in source


def test_without_a_gallery_the_page_does_without(tmp_path, monkeypatch):
    """As an installed package may be; a page of sliders alone is something to show."""
    monkeypatch.setattr(index, "GALLERY", tmp_path / "nowhere")
    (tmp_path / "impact.html").touch()
    _, page = made(tmp_path)
    assert page.images == []
    assert "python -m figures claims" in page.text["claims"]
    assert all(f"python -m figures draw {name}" in page.text[name] for name in FIGURES)


@pytest.mark.parametrize("name", FIGURES)
def test_captions_are_words(name, tmp_path):
    """No name of a constant and no mark of another language; code stands between backquotes."""
    known = index.caption(name)
    for text in (FIGURES[name].title, known["start"], *known["more"], known["alt"]):
        shown = index.Folder(tmp_path).text(text)
        read = as_read(re.sub("<code>.*?</code>", "", shown))
        assert not re.search(r"[`$\\]|[A-Z]{2,}_", read), read


def report_of(numbers, **changes) -> str:
    claim = {"id": "S<1>", "says": "V_z < 0 & more.", "figure": ""}
    claim |= {"numbers": numbers, "trouble": "", **changes}
    return json.dumps(plain({"provenance": {"quick": True}, "claims": [claim]}))


def test_claims_of_the_folder_come_first(tmp_path):
    row = {"key": "a", "name": "drift", "unit": "cm/s", "holds": [0, 1], "notion": "exact"}
    numbers = [
        {**row, "value": 1.234, "error": 0.1, "verdict": "too close to call"},
        {**row, "name": "onset", "value": math.inf, "error": math.inf, "verdict": "does not hold"},
        {**row, "name": "rate", "value": math.nan, "error": 0.0, "verdict": "not measured"},
        {"key": "b", "name": "aside", "value": 2.0, "error": 0.0},
    ]
    (tmp_path / "claims.json").write_text(report_of(numbers), encoding="utf-8")
    source, page = made(tmp_path)
    for words in (
        "does not hold: 1, too close to call: 1, not measured: 1",
        "of short and coarse runs.",
        "S<1>",
        "too close to call drift: 1.23 ± 0.10 cm/s",
        "does not hold onset: never",
        "not measured rate: no data",
    ):
        assert words in page.text["claims"]
    assert "aside" not in page.text["claims"]
    assert "V_z &lt; 0 &amp; more." in source
    assert "claims.json" in page.links
    assert not any("claims" in link for link in page.links if link.startswith("gallery"))


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "[]",
        '{"claims": [{}]}',
        '{"claims": []}',
        '{"claims": ["a"]}',
        report_of([], says=5),
        report_of([{"name": "n", "holds": [0, 1], "value": "x<y>", "close": 0}]),
    ],
)
def test_claims_that_cannot_be_read_cost_a_line(text, tmp_path):
    (tmp_path / "claims.json").write_text(text, encoding="utf-8")
    _, page = made(tmp_path)
    _, line = page.text["claims"].strip().split("\n")
    assert line.startswith("claims.json cannot be read (")
    assert line.endswith("To make it again: python -m figures claims")
    assert all(name in page.ids for name in FIGURES)


def test_folders_that_are_left_alone(tmp_path, monkeypatch, capsys):
    """Without anything to show, or that of the gallery itself."""
    refused(lambda: main(["index", "--out", str(tmp_path / "typo")]), "typo", capsys)
    (tmp_path / "rows.db").touch()
    refused(lambda: main(["index", "--out", str(tmp_path)]), "something to show", capsys)
    monkeypatch.setattr(index, "GALLERY", tmp_path / "gallery")
    (tmp_path / "gallery").mkdir()
    picture(tmp_path / "fig10.png")
    refused(lambda: main(["index", "--out", str(tmp_path)]), "gallery", capsys)
    assert {path.name for path in tmp_path.iterdir()} == {"rows.db", "gallery", "fig10.png"}


# All of it


def test_the_page_comes_last_of_all(tmp_path, monkeypatch, capsys):
    done = []
    for name in ("draw", "movie", "claims"):
        monkeypatch.setattr(main.commands[name], "callback", lambda n=name, **_: done.append(n))
    monkeypatch.setattr(everything, "left", lambda out: done.clear() or ["fig10"])
    monkeypatch.setattr(everything, "estimate", lambda out: "")
    monkeypatch.setattr(index, "files", lambda out: done.append("index") or {})
    assert main(["paper", "--out", str(tmp_path)]) == 0
    assert done == ["draw", "movie", "claims", "index"]
    assert capsys.readouterr().out.endswith("took 0 s\n")
    rule = (ROOT / "Makefile").read_text().split("\nfigures:")[1]
    assert rule.split("\n\n")[0].endswith("-m figures index")


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


def test_runs_of_the_store_are_left_out_of_the_estimate_and_not_run_again(tmp_path):
    out, path, written = tmp_path / "out", tmp_path / "runs.db", []
    command = ["draw", "row_size", "--quick", "--out", str(out), "--store", str(path)]
    with tiny() as patch:
        some = row_size.sweeps(quick=True)
        points = [point for sweep in some.values() for point in sweep.points]
        patch.setattr(runs, "STORE", path)
        patch.setattr(everything, "FIGURES", {"row_size": FIGURES["row_size"]})
        patch.setattr(everything, "OF_CLAIMS", ())
        with patch.context() as full:
            full.setattr(row_size, "sweeps", lambda: some)
            assert everything.estimate(tmp_path).startswith(f"{len(points)} runs")
        for _ in range(2):
            assert main(command) == 0
            with Store(path, write=False) as database:
                assert all(database.has(point.key) for point in points)
                written.append([row["written"] for row in database.rows()])
        patch.setattr(row_size, "sweeps", lambda: some)
        assert everything.estimate(tmp_path).startswith("0 runs that the store lacks: 0 s")
    assert written[0] == written[1]


# The page of sliders

NODE = shutil.which("node")
RODS = {"thin": impact.thin_rod, "round": impact.spherocylinder, "flat": impact.flat_ended_rod}
START = asdict(Setting())
CHANGES = [
    {},
    {"tilt_deg": 71.5},
    {"friction": 0.62},
    {"restitution": 0.9},
    {"ratio": 0.4},
    {"length": 2.5},
    {"shape": "thin"},
    {"shape": "flat", "tilt_deg": 4.0, "friction": 0.05},
    {"law": "poisson"},
    {"law": "stronge", "restitution": 0.3, "ratio": 6.0},
    {"friction": 0.0},
    {"length": 1.0},
    {"tilt_deg": 0.0, "restitution": 1.0},
    {"shape": "thin", "restitution": 1.0, "ratio": 10.0, "friction": 0.6},
    {"ratio": 0.4, "tilt_deg": 60.0},
    {"spin": -1.5},
    {"spin": 2.0, "ratio": 0.2, "tilt_deg": 80.0},  # no impact
]
PHASES = (
    "Before: the rod comes to the plate.",
    "Compression: the contact point slips to the right.",
    "Compression: the contact point stands.",
    "Largest compression: the contact point slips back to the left.",
    "Restitution: the contact point slips back to the left.",
    "After: the rod leaves the plate.",
)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "new" / "here.html"
    assert main(["explore", "--html", str(path)]) == 0
    assert [other.name for other in path.parent.iterdir()] == ["here.html"]
    return path


def check(changes: dict, shown: dict[str, str]) -> None:
    """Numbers and words of the page, against calls of `impact`."""
    s = START | changes
    tilt, size = math.radians(s["tilt_deg"]), math.hypot(1, s["ratio"])
    rod = RODS[s["shape"]](tilt, s["length"])
    before = 1 / size, -s["ratio"] / size, s["spin"] / rod.k
    losses = {name: s[name] for name in ("friction", "restitution", "law")}
    hit = impact.collide(*before, geometry=rod, **losses)
    slip, fall = before[0] - before[2] * rod.Z, before[1] + before[2] * rod.X
    expected = {"before": (*before[:2], s["spin"], slip, fall)}
    after = hit.c_x, hit.c_z, hit.omega * rod.k, hit.slip_velocity, hit.normal_velocity
    expected |= {"after": after, "now": after}
    for column, values in expected.items():
        read = [shown[f"{name}-{column}"].replace("\N{MINUS SIGN}", "-") for name in ROWS]
        assert [*map(float, read)] == pytest.approx(values, abs=5.1e-4), column
    words = shown["words"]
    assert words.startswith(WORDS[hit.regime])
    lost = -200 * hit.energy_change / (1 + s["spin"] ** 2)
    if hit.regime > 0:
        (part,) = re.findall(r"([\d.]+) % of the energy", words)
        assert float(part) == pytest.approx(abs(lost), abs=0.051)
        assert ("GAINED" in words) == (lost < -0.05)
    critical = impact.critical_friction(rod)
    assert float(re.search(r"friction (\d\.\d+)", words)[1]) == pytest.approx(critical, abs=5.1e-4)
    c_x = impact.drift(rod, friction=s["friction"], restitution=s["restitution"]).c_x
    way = "the way the rod leans" if c_x > 0 else "against the way the rod leans"
    if math.isnan(c_x):
        drifts = "not determined without friction"
    elif math.isinf(c_x):
        drifts = f"without bound, {way}"
    else:
        drifts = f"{abs(c_x):.3f} of the plate’s velocity, {way}" if abs(c_x) >= 5e-4 else "none"
    assert words.endswith(f"Drift: {drifts}.")


@pytest.mark.skipif(not NODE, reason="no node to run the script")
def test_a_slider_shows_what_impact_says(path):
    words = [NODE, str(Path(__file__).with_name("browser.js")), str(path), json.dumps(CHANGES)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    address, *lines, played, keys = map(json.loads, done.stdout.splitlines())
    assert address == [4, START["tilt_deg"]]  # of nonsense nothing is taken
    assert keys == [START["tilt_deg"] + 0.5, START["friction"] - 0.01, False, True]
    assert played[:6] == [0, "Pause", 0.5, "Pause", 1, "Play"]
    phases, slips, falls = zip(*played[6:], strict=True)
    assert phases == PHASES
    assert slips[1] == slips[0] != slips[2] == falls[3] == "0.000"
    for changes, shown in zip(CHANGES, lines, strict=True):
        check(changes, shown)
        for name in ("rod", "plane", "map", "drift"):
            assert shown[name].startswith("<")
            assert not re.search("NaN|undefined|Infinity", shown[name])
        kept = dict(part.split("=") for part in shown["hash"].strip("#").split("&") if part)
        assert kept == {
            name: f"{value:g}" if name in RANGES else value for name, value in changes.items()
        }
    heard = " ".join(shown["words"] for shown in lines)
    ends = "GAINED", "not determined", "without bound", "Drift: none", "leans.", "against the way"
    assert all(text in heard for text in (*WORDS.values(), *ends))


def test_every_control_is_labelled_and_has_its_range(path):
    source = path.read_text(encoding="utf-8")
    labelled = set(re.findall(r'<label[^>]* for="([^"]+)"', source))
    labelled |= set(re.findall(r'<label><input [^>]*id="([^"]+)"', source))
    inputs = [
        dict(re.findall(r'([\w-]+)="([^"]*)"', one))
        for one in re.findall("<input ([^>]*)>", source)
    ]
    assert len(inputs) == 2 * len(RANGES) + sum(map(len, CHOICES.values())) + 1
    for one in inputs:
        by = one.get("aria-labelledby")
        assert one["id"] in labelled or one.get("aria-label") or f'id="{by}"' in source
        name = one["id"].removesuffix("-number")
        if name in RANGES:
            assert (float(one["min"]), float(one["max"])) == RANGES[name][:2]
    assert all(re.findall(r"<button[^>]*>([^<]*)</button>", source))
    assert "prefers-reduced-motion" in source
    stands_alone(source, Page(source), scripts=True)


def test_the_options_are_the_start(tmp_path):
    path = tmp_path / "a.html"
    given = START | {name: low for name, (low, *_) in RANGES.items()} | {"shape": "flat"}
    given["law"] = "stronge"
    words = [f"--{name.replace('_', '-')}={value}" for name, value in given.items()]
    assert main(["explore", *words, "--html", str(path)]) == 0
    start = json.loads(re.search(r"const PAGE = (.*);\n", path.read_text())[1])["start"]
    assert start == given


# README and guide

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
GUIDE = (gallery.GALLERY / "GUIDE.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", TEXT, re.DOTALL)
SCRIPTS = re.findall(r"```python\n(.*?)```", GUIDE, re.DOTALL)
COMMANDS, LONGER = (
    re.findall(r"^    python -m (.*?)(?: {2,}#.*)?$", text, re.M) for text in (TEXT, GUIDE)
)
# The second needs what the first leaves; a test of claims runs the third in a smaller form.
SLOW = ("sweep", "search", "results", "claims")


def test_pages_are_of_the_numbers_in_the_gallery():
    for path, text in gallery.pages().items():
        assert path.read_text(encoding="utf-8") == text, path.name


def test_the_readme_is_short_and_measures_nothing_itself():
    """No times, percentages or errors but those of generated parts and outputs of examples."""
    assert len(TEXT.splitlines()) <= 150
    assert len(TEXT.split()) <= 1500
    text = re.sub(r"<!-- (\w+): begin -->.*?<!-- \1: end -->", "", TEXT + GUIDE, flags=re.DOTALL)
    text = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    found = re.findall(r"\d[\d.]*(?:e-?\d+)? ?(?:%|ns|ms|s|microseconds|cm/s)(?![\w/])|±.*", text)
    assert set(found) <= {"5 %"}  # of an example
    assert (len(EXAMPLES), len(SCRIPTS)) == (len(re.findall("```python", TEXT)), 3) == (3, 3)
    assert len(COMMANDS) > 2


@pytest.mark.parametrize("code, output", EXAMPLES)  # noqa: PT006
def test_examples_print_what_stands_below(code, output, capsys):
    """To the letter; a simulated number, which rounding may change, within four of its errors."""
    exec(compile(code, "README.md", "exec"), {})
    printed = capsys.readouterr().out
    if "+-" not in output:
        assert printed == output
        return
    (now, error, *_), (then, before, *_) = (re.findall(r"[\d.]+", t) for t in (printed, output))
    assert abs(float(now) - float(then)) <= 4 * max(float(error), float(before))
    assert float(now) > 3 * float(error) > 0


@pytest.mark.parametrize("code", SCRIPTS)
def test_scripts_of_the_guide_run(code, tmp_path, monkeypatch):
    """In an empty folder, short; a law that one adds is gone behind it."""
    for extra, module in {"md": "xarray", "cluster": "distributed"}.items():
        if f"[{extra}]" not in code.splitlines()[0]:
            monkeypatch.setitem(sys.modules, module, None)  # as if it were not installed
    monkeypatch.chdir(tmp_path)
    laws = {**md.LAWS}
    try:
        exec(compile(code.replace("130", "5"), "GUIDE.md", "exec"), {})
    finally:
        plt.close("all")
        for added in md.LAWS.keys() - laws.keys():
            del md.LAWS[added]


@pytest.mark.parametrize("command", [c for c in COMMANDS if not set(SLOW) & set(c.split())])
def test_commands_run(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    package, *words = shlex.split(command)
    assert GROUPS[package](words) == 0
    assert capsys.readouterr().out


@pytest.mark.slow
def test_longer_commands_run(tmp_path, monkeypatch, capsys):
    for command in LONGER:
        test_commands_run(command, tmp_path, monkeypatch, capsys)
    assert len((tmp_path / "drift.csv").read_text().splitlines()) == 22


def test_commands_and_targets_that_are_named_exist():
    named = set(re.findall(r"python -m (\w+) (\w+)", TEXT + GUIDE))
    assert len(named) > 8
    assert named <= {tuple(name.split()) for name in ALL}
    for target in re.findall(r"(?:^    |`)make (\w+)", TEXT + GUIDE, re.M):
        assert subprocess.run(["make", "-n", target], cwd=ROOT, capture_output=True).returncode == 0


@pytest.mark.parametrize("page", [ROOT / "README.md", *sorted(gallery.GALLERY.glob("*.md"))])
def test_links_lead_somewhere(page):
    text = page.read_text(encoding="utf-8")
    for target, label in re.findall(r"\]\((?!http)([^)#]*)(?:#([^)]+))?\)", text):
        other = (page.parent / target).resolve() if target else page
        assert other.is_file(), target
        heads = re.findall(r"^#+ (.*)$", other.read_text(encoding="utf-8"), re.M) if label else []
        assert not label or label in [
            re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in heads
        ]


def test_hard_cases_are_where_it_says():
    """The files hold tests of the names that the table gives them."""
    found = set()
    for names, file in re.findall(r"\[([TM]\d[TM\d, -]*)\]\(../../(tests/\w+\.py)\)", GUIDE):
        numbers = [int(number) for number in re.findall(r"\d+", names)]
        if "-" in names:
            numbers = range(numbers[0], numbers[1] + 1)
        text = (ROOT / file).read_text(encoding="utf-8")
        for name in (f"{names[0]}{number}" for number in numbers):
            assert re.search(rf"\b(test_)?{name.lower()}_|\b{name}\b", text), (name, file)
            found.add(name)
    assert len(found) > 20


# The movie


@pytest.fixture(scope="module")
def film():
    """Fast rods in a short box: each of them passes its end."""
    settings = ["rods.count=5", "box.length=7", "step.size=none", "plate.acceleration=6"]
    laws = ["contacts.plate.tangential_ratio=5", "contacts.rods.tangential_ratio=5"]
    return movie.record(md.load("quasi2d", settings + laws), periods=45, frames=2)


def test_film_is_the_run(film):
    """The same rods as a run without a film leaves, and none below the plate."""
    engine = prepare(film.scene, ledger=False, touches=False)
    engine.go(29 * engine.per)
    at = np.flatnonzero(film.time == 29)[0]
    np.testing.assert_array_equal(film.x[at], engine.rods[:, 0])
    np.testing.assert_array_equal(film.z[at], engine.rods[:, 1])
    np.testing.assert_allclose(np.tan(film.tilt[at]), engine.rods[:, 2] / engine.rods[:, 3])
    assert film.pictures == 90
    assert np.all(film.tips.min(axis=1) > film.plate - 0.02)
    amplitude = film.scene.plate_speed / (2 * np.pi * film.scene.frequency)
    assert np.ptp(film.plate) == pytest.approx(2 * amplitude, rel=0.02)


def test_picture_shows_each_rod_where_it_is(film):
    """Images fill the box; lengths and widths are true; the trail does not cross the picture."""
    picture = movie.Picture(film)
    try:
        picture.show(80)
        axes, number = movie.segments(film, 80 * film.every)
        picture.figure.canvas.draw()
        drawn = np.array(picture.rods.get_segments())
        trail = picture.trail.get_segments()
        (width,) = picture.outline.get_linewidths()
        (left, _), (right, _) = picture.row.transData.transform([(0, 0), (1, 0)])
        words = picture.words.get_text()
    finally:
        plt.close(picture.figure)
    assert width == pytest.approx((right - left) * 72 / movie.DPI, rel=0.01)
    np.testing.assert_allclose(drawn, axes)
    np.testing.assert_allclose(np.linalg.norm(axes[:, 1] - axes[:, 0], axis=1), 8.5)
    centres = axes.mean(axis=1)[:, 0]
    off = (centres - film.x[80 * film.every][number]) / 7
    np.testing.assert_allclose(off, np.round(off), atol=1e-9)
    assert sorted(number[(centres >= 0) & (centres < 7)]) == [0, 1, 2, 3, 4]
    assert len(trail) > 1
    assert all(np.all(np.abs(np.diff(part[:, 0])) < 1) for part in trail)
    assert f"t =  40.0    tilt {np.degrees(film.tilt[80 * film.every].mean()):.1f}°" in words


def test_command_writes_a_gif_that_loops(tmp_path, capsys):
    out = tmp_path / "row.gif"
    settings = ["--set", "rods.count=4", "--set", "box.length=5", "--set", "step.size=4e-5"]
    command = ["movie", "quasi2d", *settings, "--periods", "3", "--frames", "4"]
    assert main([*command, "--out", str(out)]) == 0
    assert capsys.readouterr() == (f"{out}  12 frames\n", "")
    with Image.open(out) as gif:
        assert (gif.n_frames, gif.info["loop"], gif.size[0]) == (12, 0, 600)
        colours = {colour for _, colour in gif.convert("RGB").getcolors()}
    assert {(255, 255, 255), (191, 215, 234), (213, 94, 0)} <= colours
    assert list(tmp_path.iterdir()) == [out]
    assert main([*command, "--out", str(tmp_path / "folder")]) == 0
    assert (tmp_path / "folder" / "quasi2d.gif").exists()


def test_movie_of_what_has_no_plate():
    settings = ["plate=none", "contacts.plate=none", "contacts.rods=none", "rods.count=3"]
    scene = md.load("quasi2d", settings)
    picture = movie.Picture(movie.record(scene, periods=1, frames=1))
    picture.show(0)
    plt.close(picture.figure)
    assert picture.plate is picture.trace is None
