"""The front page of a folder, and all of it at once."""

import json
import math
import os
import re
from urllib.parse import unquote, unquote_to_bytes

import pytest
from PIL import Image

from derivations import report
from derivations.registry import ENTRIES
from figures import FIGURES
from figures.__main__ import main
from figures.checks import row_size
from figures.claims import judge
from figures.cost.price_page import PRICE_PANELS
from figures.lib import runs
from figures.lib.data import keep
from figures.lib.drawing import files_of
from figures.lib.printing import plain
from figures.pages import everything, gallery, index
from md.store import Store

from .command_line import enter, names_in, refused
from .page import Page, as_read, stands_alone
from .quick_figures import tiny

# The front page of a folder

LENT = [name for name in FIGURES if (gallery.GALLERY / f"{name}.png").is_file()]
STRANGE = ("a <b>&\"' %23?#.gif", "javascript:alert(1).gif", f"{'x' * 200}.gif", "Größe \u202e.gif")


def picture(path):
    Image.new("RGB", (30, 20), "white").save(path)


def made(out):
    """The page of `out` and what is read in it; all that it names lies in the folder."""
    enter("figures index --out", out)
    source = (out / "index.html").read_text("utf-8")
    page = Page(source)
    for link in page.links:
        assert not re.match(r"[a-z]+:|/", link)
        path, _, label = link.partition("#")
        if path:
            assert (out / os.fsdecode(unquote_to_bytes(path))).is_file()
            # a link into another page leads somewhere there
            assert not label or f'id="{label}"' in (out / path).read_text("utf-8")
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
    keep(out / "fig02.npz", "fig02", True, {})
    keep(out / "fig05.npz", "fig05", False, {})
    (out / "fig08.npz").write_bytes(b"PK\x03\x04 no archive")
    for name in (*STRANGE, ".quasi2d.part.gif", "prices.png", "quasi2d.gif"):
        picture(out / name)
    (out / "cut.gif").write_bytes((out / "fig02.png").read_bytes()[:60])
    (out / "folder.gif").mkdir()
    (out / "broken.gif").touch()
    (out / "prices.txt").write_text(f"effect <b> & more{' far' * 99}", "utf-8")
    ids = "".join(f'<i id="{report.anchor(entry.tag)}"></i>' for entry in ENTRIES)
    summary = "<h2>Verdicts</h2><p>96 entries. 2 of them not proved.</p>"
    (out / "report.html").write_text(f"{summary}{ids}", "utf-8")
    return out, *made(out)


def test_what_a_folder_lacks_is_lent(tmp_path):
    """Pictures, movie, and every statement of the claims, to a folder with a file to show."""
    (tmp_path / "prices.txt").touch()
    source, page = made(tmp_path)
    assert "report.html" not in source
    lent = {f"gallery/{path.name}" for path in (tmp_path / "gallery").iterdir()}
    for name in lent:
        assert (tmp_path / name).read_bytes() == (gallery.GALLERY.parent / name).read_bytes()
    assert lent | {"impact.html"} == {link for link in page.links if not link.startswith("#")}
    named = {"row.gif", "claims.md", "claims.json", *(f"{name}.png" for name in LENT)}
    assert {f"gallery/{name}" for name in named} <= lent
    words = index.Folder(tmp_path).text
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
        assert (f"{name}.png" in page.links) == own
        assert ("From the project’s gallery." in text) == (name in LENT and not own)
        assert ("A first look" in text) == (name == "fig02")
        assert text in page.text["prices" if name in PRICE_PANELS else "pictures"]
    sources = [image["src"] for image in page.images]
    assert len(sources) == len(set(sources))
    for image in page.images:
        with Image.open(out / unquote(image["src"])) as opened:
            assert opened.size == (int(image["width"]), int(image["height"]))
        assert image["alt"]


def test_strange_names_are_shown_and_do_no_harm(half):
    _, source, page = half
    for name in STRANGE:
        assert name in [unquote(image["src"]) for image in page.images]
        assert name.removesuffix(".gif") in page.text["movie"]
    assert "<b>&" not in source
    assert not re.search("broken.gif|cut.gif|folder.gif|[.]part", source)


def test_derivations_prices_and_movie_in_one_file(half):
    _, source, page = half
    assert "96 entries. 2 of them not proved." in page.text["derivations"]
    assert "report.html#eq-26" in page.links  # named in the caption of Fig. 11
    assert "effect <b> & more" in page.text["prices"]
    assert {"prices.png", "quasi2d.gif"} <= set(page.links)
    assert "gallery/row.gif" not in page.links
    stands_alone(source, page)


def test_without_a_gallery_the_page_does_without(tmp_path, monkeypatch):
    """As an installed package may be; a page of sliders alone is something to show."""
    monkeypatch.setattr(index, "GALLERY", tmp_path / "nowhere")
    (tmp_path / "impact.html").touch()
    _, page = made(tmp_path)
    assert page.images == []
    assert "python -m figures claims" in page.text["claims"]


@pytest.mark.parametrize("name", FIGURES)
def test_captions_are_words(name, tmp_path):
    """No name of a constant and no mark of another language; code stands between backquotes."""
    known = index.caption(name)
    for text in (FIGURES[name].title, known["start"], *known["more"], known["alt"]):
        shown = index.Folder(tmp_path).text(text)
        read = as_read(re.sub("<code>.*?</code>", "", shown))
        assert not re.search(r"[`$\\]|[A-Z]{2,}_", read)


def report_of(numbers):
    claim = {
        "id": "S<1>",
        "says": "V_z < 0 & more.",
        "figure": "",
        "numbers": numbers,
        "trouble": "",
    }
    return json.dumps(plain({"provenance": {"quick": True}, "claims": [claim]}))


def test_claims_of_the_folder_come_first(tmp_path):
    row = {"key": "a", "name": "drift", "unit": "cm/s", "holds": [0, 1], "notion": "exact"}
    numbers = [
        {**row, "value": 1.234, "error": 0.1, "verdict": "too close to call"},
        {**row, "name": "onset", "value": math.inf, "error": math.inf, "verdict": "does not hold"},
        {**row, "name": "rate", "value": math.nan, "error": 0.0, "verdict": "not measured"},
        {"key": "b", "name": "aside", "value": 2.0, "error": 0.0},
    ]
    (tmp_path / "claims.json").write_text(report_of(numbers), "utf-8")
    source, page = made(tmp_path)
    for words in (
        "does not hold: 1, too close to call: 1, not measured: 1",
        "of short and coarse runs.",
        "too close to call drift: 1.23 ± 0.10 cm/s",
    ):
        assert words in page.text["claims"]
    assert "aside" not in page.text["claims"]
    assert "V_z &lt; 0 &amp; more." in source
    assert not any("claims" in link for link in page.links if link.startswith("gallery"))


@pytest.mark.parametrize(
    "text",
    ["{", "[]", '{"claims": ["a"]}', report_of([{"name": "n", "holds": [0, 1], "value": "x<y>"}])],
)
def test_claims_that_cannot_be_read_cost_a_line(text, tmp_path):
    (tmp_path / "claims.json").write_text(text, "utf-8")
    _, page = made(tmp_path)
    _, line = page.text["claims"].strip().split("\n")
    assert line.startswith("claims.json cannot be read (")


def test_folders_that_are_left_alone(tmp_path, monkeypatch):
    """Without anything to show, or that of the gallery itself."""
    (tmp_path / "rows.db").touch()
    refused("something to show", "figures index --out", tmp_path)
    monkeypatch.setattr(index, "GALLERY", tmp_path / "gallery")
    (tmp_path / "gallery").mkdir()
    picture(tmp_path / "fig10.png")
    refused("gallery", "figures index --out", tmp_path)
    assert names_in(tmp_path) == {"rows.db", "gallery", "fig10.png"}


# All of it


def test_the_page_comes_last_of_all(tmp_path, monkeypatch):
    done = []
    for name in ("draw", "movie", "claims"):
        monkeypatch.setattr(main.commands[name], "callback", lambda n=name, **_: done.append(n))
    monkeypatch.setattr(everything, "left", lambda out: done.clear() or ["fig10"])
    monkeypatch.setattr(everything, "estimate", lambda out: "")
    monkeypatch.setattr(index, "files", lambda out: done.append("index") or {})
    enter("figures paper --out", tmp_path)
    assert done == ["draw", "movie", "claims", "index"]


def test_figures_are_left_to_draw_if_not_whole_or_of_other_sources(tmp_path, monkeypatch):
    assert everything.left(tmp_path) == list(FIGURES)
    for name, quick in (("fig10", False), ("fig11", True), ("fig12", False)):
        keep(tmp_path / f"{name}.npz", name, quick, {})
    for file in files_of("fig10", "fig11", "fig12", "alpha"):
        (tmp_path / file).touch()
    (tmp_path / "fig12.pdf").unlink()
    with monkeypatch.context() as patch:
        patch.setattr("figures.lib.data.sources", lambda name: "others")
        keep(tmp_path / "alpha.npz", "alpha", False, {})
    assert set(FIGURES) - set(everything.left(tmp_path)) == {"fig10"}


def test_runs_of_the_store_are_left_out_of_the_estimate_and_not_run_again(tmp_path):
    out, path, written = tmp_path / "out", tmp_path / "runs.db", []
    drawn = "figures draw row_size --quick --out", out, "--store", path
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
            enter(*drawn)
            with Store(path, write=False) as database:
                assert all(database.has(point.key) for point in points)
                written.append([row["written"] for row in database.rows()])
        patch.setattr(row_size, "sweeps", lambda: some)
        assert everything.estimate(tmp_path).startswith("0 runs that the store lacks: 0 s")
    assert written[0] == written[1]
