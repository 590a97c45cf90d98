"""The front page of a folder: derivations, pictures, prices, claims and movies, one HTML file.

>>> from figures.pages import index
>>> "index.html" in index.files(index.GALLERY)  # and what else the folder needs, by name
True

What the folder holds is shown, what it lacks is listed with its command. Where nothing was made
here, the project's gallery stands in, and the page says so; copies of it go to `gallery/` beside
the page, so that the folder needs nothing else and may be moved. The page is `templates/index.html`
in the look of the derivations' report, with `templates/index.css`; `impact.html`, beside it, is
that of `explore`.
"""

import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

from markupsafe import Markup
from PIL import Image

from derivations import report
from derivations.lecture import to_html
from derivations.registry import ENTRIES
from impact import InputError

from .. import FIGURES, load
from ..claims import judge
from ..cost.price_page import PRICE_PANELS
from ..lib.data import BROKEN, made
from . import explore
from .gallery import GALLERY, templates

TITLE = "Rods on a vibrated plate: derivations, pictures, prices, claims"
ABOUT = (
    "What is derived, simulated and measured here to test D. Volfson, A. Kudrolli and "
    "L. S. Tsimring, “Anisotropy driven dynamics in vibrated granular rods”."
)
BADGES = {"holds": "agrees", "does not hold": "erratum"}
TAGS = {entry.tag for entry in ENTRIES}
TEXTS = ".html", ".json", ".txt"  # files without a size


class Item(NamedTuple):
    """A file that can be shown."""

    path: Path
    address: str  # seen from the page
    own: bool  # made here, not lent
    size: tuple[int, int]  # of a picture
    width: int  # as drawn, at 96 pixels an inch


@dataclass
class Folder:
    """Files beside the page, and what the page takes from the gallery."""

    path: Path
    borrowed: set[str] = field(default_factory=set)
    own: set[str] = field(default_factory=set)  # shown from here

    def find(self, name: str) -> Item | None:
        """The folder's own file, else the gallery's; a picture only if it can be read."""
        for path in (self.path / name, GALLERY / name):
            if path.is_file() and (size := _size(path)):
                return Item(path, self.address(path), path.parent == self.path, *size)
        return None

    def address(self, path: Path) -> str:
        """Address, from the page, of the folder's own file or of the copy of the gallery's."""
        own = path.parent == self.path
        (self.own if own else self.borrowed).add(path.name)
        return f"{'' if own else 'gallery/'}{quote(os.fsencode(path.name))}"

    def links(self, stem: str) -> dict[str, str]:
        """Labels by address of the files beside the picture STEM.png that are there."""
        names = {f"{stem}.pdf": "PDF", f"{stem}.npz": "numbers"}
        return {quote(n): label for n, label in names.items() if (self.path / n).is_file()}

    def text(self, sentence: str) -> Markup:
        """A sentence as HTML; numbers of equations lead to the report, if it is there."""
        there = (self.path / "report.html").is_file()

        def link(tag: str) -> str:
            return f"report.html#{report.anchor(tag)}" if there and tag in TAGS else ""

        return Markup(to_html(" ".join(sentence.split()), link))


def _size(path: Path) -> tuple[tuple[int, int], int] | None:
    """Size of a picture in pixels, and its width as drawn; None if it cannot be read."""
    if path.suffix in TEXTS:
        return (0, 0), 0
    try:
        with Image.open(path, formats=["PNG", "GIF"]) as image:
            size, (dots, _) = image.size, image.info.get("dpi", (96, 96))
            image.verify()
    except BROKEN:
        return None
    return size, round(96 * size[0] / dots)


def _read(item: Item | None) -> str:
    """Text of a file; none if it is not there."""
    return item.path.read_text(encoding="utf-8", errors="replace") if item else ""


def caption(name: str) -> dict[str, Any]:
    """What the module of a figure says of it: in a line, its first sentence, the rest."""
    first, *rest = (" ".join(part.split()) for part in load(name).__doc__.strip().split("\n\n"))
    body, *more = rest or [""]
    start = re.match(r'.{90,}?(?<!Eq)\.(?= [A-Z("])', body)
    end = start.end() if start else len(body)
    return {"alt": first, "start": body[:end], "more": [*filter(None, (body[end:], *more))]}


def _figure(folder: Folder, name: str) -> dict[str, Any]:
    """What is shown of a figure: its picture, and what its module says of it."""
    item = folder.find(f"{name}.png")
    time = "minutes" if FIGURES[name].alone else "seconds to minutes"
    found = {"name": name, "title": FIGURES[name].title, "item": item, "time": time}
    if not item:
        return found
    return found | {
        **caption(name),
        "first_look": item.own and made(folder.path / f"{name}.npz").get("quick"),
        "links": folder.links(name) if item.own else {},
    }


def _claims(folder: Folder) -> dict[str, Any]:
    """The report of the claims with its files, or why there is none."""
    file = folder.find("claims.json")
    if not file:
        return {"file": None}
    try:
        found = judge.load(file.path)
    except (OSError, ValueError) as error:
        return {"file": file, "error": " ".join(f"{error}".split())}
    page = file.path.with_suffix(".md")  # of the same numbers
    address = folder.address(page) if page.is_file() else ""
    return {"file": file, "error": "", "report": found, "page": address}


def _movies(folder: Folder) -> list[Item]:
    films = (path.name for path in sorted(folder.path.glob("[!.]*.gif")))  # whole ones
    found = [*filter(None, map(folder.find, films))]
    return found or [*filter(None, [folder.find("row.gif")])]


def _proofs(folder: Folder) -> dict[str, Any]:
    """The report of the derivations and its outcome."""
    page = folder.find("report.html")
    outcome = re.search(r"<h2>Verdicts</h2><p>([^<]*)</p>", _read(page))
    counted = report.counted(entry.verdict for entry in ENTRIES)
    return {"page": page, "outcome": outcome[1] if outcome else "", "counted": Markup(counted)}


def files(out: Path) -> dict[str, bytes]:
    """Files to be written into the folder `out`, by name; the page comes last.

    Raises
    ------
    ValueError
        If the folder is not there or holds nothing to show, or holds the project's gallery itself.
    """
    folder = Folder(out)
    given = {
        "folder": folder,
        "badges": BADGES,
        "figures": FIGURES,
        "proofs": _proofs(folder),
        "pictures": [_figure(folder, name) for name in FIGURES if name not in PRICE_PANELS],
        "prices": [_figure(folder, name) for name in PRICE_PANELS],
        "price_page": folder.find("prices.png"),
        "price_tables": _read(folder.find("prices.txt")),
        "claims": _claims(folder),
        "movies": _movies(folder),
    }
    if not (folder.own or folder.find("impact.html")):
        raise InputError(f"out must be a folder that holds something to show, got {out}")
    if (out / "gallery").resolve() == GALLERY:
        raise InputError(f"out must not be the folder of the project's gallery, got {out}")
    main = templates.get_template("index.html").render(given)
    style = templates.get_template("index.css").render()
    page = report.document(TITLE, ABOUT, main, style)
    copies = {f"gallery/{name}": (GALLERY / name).read_bytes() for name in folder.borrowed}
    pages = {"impact.html": explore.page(explore.Setting()), "index.html": page}
    return copies | {name: text.encode("utf-8", "replace") for name, text in pages.items()}
