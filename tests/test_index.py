"""The front page of a folder: all it names is there, whatever else the folder holds."""

import json
import math
import os
import re
from html import unescape
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

import numpy as np
import pytest
from PIL import Image

from derivations import report
from derivations.registry import ENTRIES
from figures import FIGURES
from figures.__main__ import main
from figures.claims import judge
from figures.cost.price_page import PRICE_PANELS
from figures.lib.printing import plain
from figures.pages import everything, index

from .command_line import refused
from .page import Page, stands_alone

LENT = [name for name in FIGURES if (index.GALLERY / f"{name}.png").is_file()]
STRANGE = ("a <b>&\"' %23?#.gif", "javascript:alert(1).gif", f"{'x' * 200}.gif", "Größe \u202e.gif")


def picture(path: Path, size=(30, 20)) -> None:
    Image.new("RGB", size, "white").save(path)


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
    for name in (*STRANGE, ".quasi2d.part.gif", "prices.png"):
        picture(out / name)
    (out / "cut.gif").write_bytes((out / "fig02.png").read_bytes()[:60])
    (out / "folder.gif").mkdir()
    picture(out / "quasi2d.gif")
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
    out, source, page = bare
    assert "python -m derivations report" in page.text["derivations"]
    assert "report.html" not in source
    lent = set()
    for path in (out / "gallery").iterdir():
        assert path.read_bytes() == (index.GALLERY / path.name).read_bytes()
        lent.add(f"gallery/{path.name}")
    own = {"impact.html"}
    assert lent | own == {link for link in page.links if not link.startswith("#")}
    assert {"gallery/row.gif", "gallery/claims.md", "gallery/claims.json"} < lent
    assert {f"gallery/{name}.png" for name in LENT} < lent
    assert {p.name for p in out.iterdir()} == {"gallery", "impact.html", "index.html", "prices.txt"}


def test_every_figure_is_there_with_its_command(half):
    _, source, page = half
    drawn = len(list(FIGURES)[::2])
    assert re.findall(r"\d+ of \d+ figures", source) == [f"{drawn} of {len(FIGURES)} figures"]
    for place, name in enumerate(FIGURES):
        text, own = page.text[name], place % 2 == 0
        assert f"python -m figures draw {name}" in text
        assert "minutes)" in text
        assert (f"{name}.png" in page.links) == own
        assert ("From the project’s gallery." in text) == (name in LENT and not own)
        assert ("A first look" in text) == (name == "fig02")
        assert text in page.text["prices" if name in PRICE_PANELS else "pictures"]


def test_what_is_not_drawn_is_no_broken_picture(half):
    out, _, page = half
    missing = [n for n in list(FIGURES)[1::2] if n not in LENT]
    sources = [image["src"] for image in page.images]
    assert not {f"{name}.png" for name in missing} & set(sources)
    assert len(sources) == len(set(sources))
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


def test_a_name_that_is_no_text(tmp_path):
    try:
        picture(tmp_path / os.fsdecode(b"\xff.gif"))
    except OSError as error:
        pytest.skip(f"no such names on this file system: {error}")
    source, _ = made(tmp_path)
    assert '<img src="%FF.gif" alt="The scene ?"' in source


def test_derivations_prices_and_movie(half):
    _, source, page = half
    assert "96 entries. 2 of them not proved." in page.text["derivations"]
    for verdict in {entry.verdict for entry in ENTRIES}:
        count = sum(entry.verdict == verdict for entry in ENTRIES)
        assert re.search(rf"{verdict}</span></td><td>[^<]+</td><td>{count}</td>", source)
    assert "report.html#eq-26" in page.links  # named in the caption of Fig. 11
    assert "effect <b> & more" in page.text["prices"]
    assert {"prices.png", "quasi2d.gif"} <= set(page.links)
    assert "gallery/row.gif" not in page.links


def test_needs_nothing_from_outside(half):
    _, source, page = half
    stands_alone(source, page)
    assert "url(" not in source
    assert report.STYLE in source


def test_without_a_gallery_the_page_does_without(tmp_path, monkeypatch):
    """As an installed package may be."""
    monkeypatch.setattr(index, "GALLERY", tmp_path / "nowhere")
    (tmp_path / "prices.txt").touch()
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


# Claims


def told(numbers, **changes) -> str:
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
    (tmp_path / "claims.json").write_text(told(numbers), encoding="utf-8")
    source, page = made(tmp_path)
    text = page.text["claims"]
    assert "does not hold: 1, too close to call: 1, not measured: 1" in text
    assert "of short and coarse runs." in text
    assert "S<1>" in text
    assert "too close to call drift: 1.23 ± 0.10 cm/s" in text
    assert "does not hold onset: never" in text
    assert "not measured rate: no data" in text
    assert "aside" not in text
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
        told([], says=5),
        told([{"name": "n", "holds": [0, 1], "value": "x<y>", "close": 0}]),
    ],
)
def test_claims_that_cannot_be_read_cost_a_line(text, tmp_path):
    (tmp_path / "claims.json").write_text(text, encoding="utf-8")
    _, page = made(tmp_path)
    _, line = page.text["claims"].strip().split("\n")
    assert line.startswith("claims.json cannot be read (")
    assert line.endswith("To make it again: python -m figures claims")
    assert all(name in page.ids for name in FIGURES)


def test_all_claims_of_the_gallery_are_shown(bare):
    out, _, page = bare
    words = index.Folder(out).text
    for claim in judge.load(index.GALLERY / "claims.json")["claims"]:
        assert claim["id"] in page.text["claims"]
        for row in judge.statements(claim):
            shown = f"{words(row['name'])}: {words(judge.shown(row))}"
            assert as_read(shown) in page.text["claims"]


# The command


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
    rule = (Path(__file__).parent.parent / "Makefile").read_text().split("\nfigures:")[1]
    assert rule.split("\n\n")[0].endswith("-m figures index")


def test_the_old_page_stays_until_the_new_one_is_whole(tmp_path, monkeypatch, capsys):
    (tmp_path / "prices.txt").touch()
    old = f"<title>{index.TITLE}</title>old"
    (tmp_path / "index.html").write_text(old)

    def full(path, content):
        with path.open("wb") as file:
            file.write(content[: len(content) // 2])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(index, "GALLERY", tmp_path / "nowhere")
    monkeypatch.setattr(Path, "write_bytes", full)
    refused(lambda: main(["index", "--out", str(tmp_path)]), "No space left", capsys)
    assert (tmp_path / "index.html").read_text() == old
    assert {path.name for path in tmp_path.iterdir()} == {"index.html", "prices.txt"}


def test_a_page_of_sliders_alone_is_something_to_show(tmp_path):
    (tmp_path / "impact.html").touch()
    assert b"impact.html" in index.files(tmp_path)["index.html"]


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
