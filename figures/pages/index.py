"""The front page of a folder: derivations, pictures, prices, claims and movies, one HTML file.

>>> from figures.pages import index
>>> "index.html" in index.files(index.GALLERY)  # and what else the folder needs, by name
True

What the folder holds is shown, what it lacks is listed with its command. What comes with the
project stands in for what was not made here, and is said to: copies go to `gallery/` beside the
page, so that the folder needs nothing else and may be moved.
"""

import json
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote
from zipfile import BadZipFile

import numpy as np
from PIL import Image

from derivations import report
from derivations.registry import ENTRIES
from derivations.sentences import to_html

from .. import FIGURES, load
from ..claims import verdicts as claims
from ..cost.price_page import PRICE_PANELS
from .everything import SECONDS, USUAL

TITLE = "Rods on a vibrated plate: derivations, pictures, prices, claims"
ABOUT = (
    "What is derived, simulated and measured here to test D. Volfson, A. Kudrolli and "
    "L. S. Tsimring, “Anisotropy driven dynamics in vibrated granular rods”."
)
GALLERY = Path(__file__).resolve().parents[1] / "gallery"
LENT = "From the project’s gallery."
BADGES = {"holds": "agrees", "holds in part": "rewritten", "does not hold": "erratum"}
SIGNS = "✗", "~", "✓"  # of a number, by its grade
TAGS = {entry.tag for entry in ENTRIES}
UNREADABLE = (
    *(OSError, EOFError, SyntaxError, ValueError),
    *(AttributeError, LookupError, TypeError, BadZipFile),
)


class Item(NamedTuple):
    """A file that can be shown."""

    path: Path
    address: str  # seen from the page
    own: bool  # made here, not lent
    size: tuple[int, int]  # of a picture


@dataclass
class Folder:
    """What lies beside the page, and what the page takes from the gallery."""

    path: Path
    borrowed: set[str] = field(default_factory=set)
    own: set[str] = field(default_factory=set)  # shown from here

    def find(self, name: str, picture: bool = False) -> Item | None:
        """The folder's own file, else the gallery's; a picture only if it can be read."""
        for path in (self.path / name, GALLERY / name):
            if path.is_file() and (size := _size(path) if picture else (0, 0)):
                return Item(path, self.address(path), path.parent == self.path, size)
        return None

    def address(self, path: Path) -> str:
        """Of its own file, or of the copy of one of the gallery."""
        if path.parent == self.path:
            self.own.add(path.name)
            return _quoted(path.name)
        self.borrowed.add(path.name)
        return f"gallery/{_quoted(path.name)}"

    def names(self, ending: str) -> list[str]:
        """Of its own files, but for those just being written."""
        names = sorted(path.name for path in self.path.glob(f"*{ending}") if path.is_file())
        return [name for name in names if not name.startswith(".")]

    def links(self, stem: str, **labels: str) -> str:
        """To the files STEM.KIND that are there; `labels` by kind."""
        names = {f"{stem}.{kind}": label for kind, label in labels.items()}
        own = [name for name in names if (self.path / name).is_file()]
        return ", ".join(f'<a href="{_quoted(name)}">{names[name]}</a>' for name in own)

    def text(self, sentence: str) -> str:
        """A sentence as HTML; numbers of equations lead to the report, if it is there."""
        there = (self.path / "report.html").is_file()
        return to_html(
            " ".join(sentence.split()),
            lambda tag: f"report.html#{report.anchor(tag)}" if there and tag in TAGS else "",
        )


def _quoted(name: str) -> str:
    return quote(os.fsencode(name))


def _size(picture: Path) -> tuple[int, int] | None:
    try:
        with Image.open(picture, formats=["PNG", "GIF"]) as image:
            size = image.size
            image.verify()
    except UNREADABLE:
        return None
    return size


def _first_look(npz: Path) -> bool:
    """Whether a figure's numbers are those of `--quick`."""
    try:
        with npz.open("rb") as file:  # np.load(npz) leaves one open that is no archive
            return bool(json.loads(str(np.load(file)["provenance"]))["quick"])
    except UNREADABLE:
        return False


def _command(arguments: str) -> str:
    return f"<code>python -m {arguments}</code>"


def _drawn_by(name: str) -> str:
    """The command of a figure, and about how long it takes in full."""
    seconds = "about a minute" if SECONDS.get(name, USUAL) > 25 else "seconds"
    return f"{_command(f'figures draw {name}')} ({seconds if FIGURES[name].quick else 'minutes'})"


def _card(item: Item, alt: str, title: str, *words: str, name: str = "") -> str:
    """A picture with its caption, which is HTML."""
    (width, height), label = item.size, f' id="{name}"' if name else ""
    return (
        f'<figure{label}><a href="{item.address}"><img src="{item.address}" alt="{escape(alt)}" '
        f'width="{width}" height="{height}" loading="lazy"></a>'
        f"<figcaption><h3>{title}</h3>{''.join(words)}</figcaption></figure>"
    )


# ---- sections ---------------------------------------------------------------------------------


def _derivations(folder: Folder) -> str:
    said = f"Not written yet: {_command('derivations report')} proves everything and writes it."
    if page := folder.find("report.html"):
        text = page.path.read_text(encoding="utf-8", errors="replace")
        outcome = re.search(r"<h2>Verdicts</h2><p>([^<]*)</p>", text)
        said = (
            f'<a href="{page.address}">Every equation as printed and as derived</a>, with its '
            f"verdict and its proof. {outcome[1] if outcome else ''}"
        )
    return f"<p>{said}</p>{report.counted(entry.verdict for entry in ENTRIES)}"


def _figure(folder: Folder, name: str, item: Item) -> str:
    """Its picture, the beginning of what its module says of it, and the rest behind `More`."""
    first, *rest = load(name).__doc__.strip().split("\n\n")
    body = [" ".join(part.split()) for part in rest] or [""]
    start = re.match(r'.{90,}?(?<!Eq)\.(?= [A-Z("])', body[0])
    end = start.end() if start else len(body[0])
    more = "".join(f"<p>{folder.text(part)}</p>" for part in (body[0][end:], *body[1:]) if part)
    how, files = _drawn_by(name), ""
    if not item.own:
        how = f"{LENT} To draw it here: {how}"
    else:
        if _first_look(folder.path / f"{name}.npz"):
            how = f"A first look, by <code>--quick</code>; in full: {how}"
        files = folder.links(name, pdf="PDF", npz="numbers")
    return _card(
        item,
        " ".join(first.split()),
        to_html(FIGURES[name].title),
        f"<p>{folder.text(body[0][:end])}</p>",
        f"<details><summary>More</summary>{more}</details>" if more else "",
        f"<p>{how}{', ' * bool(files)}{files}</p>",
        name=name,
    )


def _figures(folder: Folder, names: Iterable[str], before: str = "") -> str:
    """Those of which there is a picture, the others as a list."""
    found = {name: folder.find(f"{name}.png", picture=True) for name in names}
    drawn = sum(item is not None and item.own for item in found.values())
    cards = "".join(_figure(folder, name, item) for name, item in found.items() if item)
    missing = "".join(
        f'<li id="{name}">{to_html(FIGURES[name].title)}<br>{_drawn_by(name)}</li>'
        for name, item in found.items()
        if not item
    )
    missing = missing and f'<h3>Not drawn yet</h3><ul class="missing">{missing}</ul>'
    return (
        f"<p>{drawn} of {len(found)} figures are drawn.</p>"
        f'<div class="cards">{before}{cards}</div>{missing}'
    )


def _pictures(folder: Folder) -> str:
    return _figures(folder, [name for name in FIGURES if name not in PRICE_PANELS])


def _prices(folder: Folder) -> str:
    words = f"<p>Measured anew, in ten minutes at most: {_command('figures prices')}</p>"
    page, tables, card = folder.find("prices.png", picture=True), folder.find("prices.txt"), ""
    if page:
        card = _card(page, "All prices on one page", "All prices on one page")
    if tables:
        text = escape(tables.path.read_text(encoding="utf-8", errors="replace"))
        words += f"<details><summary>As tables</summary><pre>{text}</pre></details>"
    return words + _figures(folder, [name for name in FIGURES if name in PRICE_PANELS], card)


def _claim(folder: Folder, claim: dict[str, Any]) -> str:
    """A line of the table: claim, verdict, the numbers that were judged."""
    numbers = "".join(
        f"<li>{'?' if row['grade'] is None else SIGNS[row['grade']]} {to_html(row['name'])}: "
        f"<b>{to_html(claims.shown(row))}</b>{' (close call)' if row['close'] else ''}</li>"
        for row in claims.judged_rows(claim)
    )
    see = f' <a href="#{claim["figure"]}">picture</a>' if claim["figure"] in FIGURES else ""
    return (
        f'<tr><th>{escape(claim["id"])}</th><td><span class="badge '
        f'{BADGES.get(claim["verdict"], "assumed")}">{escape(claim["verdict"])}</span></td>'
        f"<td>{folder.text(claim['says'])}{see}</td>"
        f"<td><ul>{numbers}</ul>{escape(claim['trouble'])}</td></tr>"
    )


def _claims(folder: Folder) -> str:
    command, file = _command("figures claims"), folder.find("claims.json")
    if not file:
        return f"<p>Not judged yet: {command} (minutes)</p>"
    try:
        found = claims.restored(json.loads(file.path.read_text(encoding="utf-8")))
        lines = "".join(_claim(folder, claim) for claim in found["claims"])
        counts, quick = escape(claims.counts(found)), found["provenance"]["quick"]
    except UNREADABLE as error:
        reason = escape(" ".join(f"{type(error).__name__}: {error}".split()))
        return f"<p>claims.json cannot be read ({reason}). To make it anew: {command}</p>"
    page, words = file.path.with_suffix(".md"), ""  # of the same numbers
    if page.is_file():
        words = f'<a href="{folder.address(page)}">Limits, reasons, remarks</a>, '
    how = f"{'' if file.own else f'{LENT} '}To judge them here: {command} (minutes)"
    return (
        f"<p><b>{counts}</b>, of {'short and coarse' if quick else 'full'} runs. {words}"
        f'<a href="{file.address}">numbers</a>. {how}</p><p>✓ within the limits of the claim, '
        f'~ within wider ones, ✗ beyond both.</p><table class="claims"><thead><tr><th>Claim</th>'
        "<th>Verdict</th><th>The paper says</th><th>Measured</th></tr></thead>"
        f"<tbody>{lines}</tbody></table>"
    )


def _movies(folder: Folder) -> str:
    found, cards = [folder.find(name, picture=True) for name in folder.names(".gif")], ""
    for item in filter(None, found if any(found) else [folder.find("row.gif", picture=True)]):
        stem, title, words = item.path.stem, "A row of rods drifts the way it leans", LENT
        if item.own:
            title, words = f"The scene {stem}", folder.links(stem, mp4="MP4")
        cards += _card(item, title, escape(title), f"<p>{words}</p>" if words else "")
    how = f"Of any scene, in seconds: {_command('figures movie quasi2d --periods 4')}"
    return f'<p>{how}</p><div class="cards">{cards}</div>'


def _others(folder: Folder) -> str:
    """Pictures that the commands above do not make."""
    known = {f"{name}.png" for name in (*FIGURES, "prices")}
    found = {n: folder.find(n, picture=True) for n in folder.names(".png") if n not in known}
    cards = "".join(_card(item, name, escape(name)) for name, item in found.items() if item)
    return f'<div class="cards">{cards}</div>' if cards else ""


SECTIONS = {
    "Derivations": _derivations,
    "Pictures": _pictures,
    "Prices": _prices,
    "Claims": _claims,
    "Movie": _movies,
    "Others": _others,
}


def files(out: Path) -> dict[str, bytes]:
    """What is to be written into the folder `out`, by name; the page comes last.

    Raises
    ------
    ValueError
        If the folder is not there or holds nothing to show, or holds the project's gallery itself.
    """
    folder = Folder(out)
    made = {title: section(folder) for title, section in SECTIONS.items()}
    if not folder.own:
        raise ValueError(f"out must be a folder that holds something to show, got {out}")
    if (out / "gallery").resolve() == GALLERY:
        raise ValueError(f"out must not be the folder of the project's gallery, got {out}")
    made = {title: inner for title, inner in made.items() if inner}
    links = ", ".join(f'<a href="#{title.lower()}">{title}</a>' for title in made)
    main = "".join(
        f'<section id="{title.lower()}"><h2>{title}</h2>{inner}</section>'
        for title, inner in made.items()
    )
    main = (
        f"<p>What is missing stands with its command; {_command('figures index')} then brings this "
        f'page up to date.</p><nav aria-label="Contents">{links}</nav>{main}'
    )
    page = report.document(TITLE, ABOUT, main, STYLE)
    copies = {f"gallery/{name}": (GALLERY / name).read_bytes() for name in folder.borrowed}
    return copies | {"index.html": page.encode("utf-8", "replace")}


STYLE = """
.cards { display: grid; gap: 2rem 1.5rem; margin: 1rem 0; align-items: start;
  grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); }
figure { margin: 0; min-width: 0; max-width: 44rem; scroll-margin-top: .5rem; }
img { display: block; width: 100%; height: auto; border: 1px solid var(--rule); }
figcaption { padding-top: .5rem; }
figure p, details { font-size: .93rem; }
summary { color: var(--link); cursor: pointer; }
pre { padding: .6rem; overflow-x: auto; border: 1px solid var(--rule); font-size: .8rem; }
.missing { columns: 24rem 2; padding: 0; list-style: none; font-size: .93rem; }
.missing li { margin: 0 0 .6rem; break-inside: avoid; scroll-margin-top: .5rem; }
.claims :is(th, td) { padding-right: 1rem; text-align: left; }
.claims ul { margin: 0; padding: 0; list-style: none; }
.claims li { margin: 0; padding-left: 1.1em; text-indent: -1.1em; }
.claims li > * { text-indent: 0; }
@media (min-width: 44.01rem) { .claims td:nth-child(n + 3) { width: 42%; } }
@media (max-width: 44rem) {
  .claims thead { display: none; }
  .claims tr { display: block; padding: .5rem 0; border-bottom: 1px solid var(--rule); }
  .claims :is(th, td) { display: block; padding-right: 0; border: 0; }
  .claims :is(th, td):nth-child(-n + 2) { display: inline-block; padding-right: .6rem; }
}
"""
