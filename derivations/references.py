"""Cross references: what cited figures, panels and equations show.

Panels and their subjects are read off the captions' own words (`CAPTIONS`); what an equation can be
plotted against, off its letters. What remains a reader's judgement is which words to look for.
"""

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources

import sympy as sp

from . import drift, slip_stick
from .proof import Proof, Verdict
from .symbols import V_z, epsilon, mu, phi

_TEXTS = tomllib.loads(resources.files(__package__).joinpath("statements.toml").read_text("utf-8"))
CAPTIONS: dict[str, str] = _TEXTS["captions"]
_PANEL = re.compile(r"\(([a-e])\)")

# What a curve over tilt, of given friction and restitution, in units of V_z, may depend on.
CURVE = {phi, mu, epsilon, V_z}
_EQUATIONS = {entry.tag: entry for entry in (*slip_stick.EQUATIONS, *drift.EQUATIONS)}

Place = Sequence[str]  # a figure and its panel ("" for all of it), or "eq" and an equation's tag


def panels(figure: str) -> dict[str, str]:
    """Words of each panel of a figure by its caption; "" holds what stands before the first."""
    before, *parts = _PANEL.split(CAPTIONS[figure])
    return {"": before, **dict(zip(parts[::2], parts[1::2], strict=True))}


def letters(tag: str) -> set[sp.Symbol]:
    """Letters of a derived equation."""
    return set(_EQUATIONS[tag].readable().free_symbols)


def name(place: Place) -> str:
    """A place as the paper writes it: Fig. 3(c), (24)."""
    figure, panel = place
    return f"({panel})" if figure == "eq" else f"Fig. {figure}" + (f"({panel})" if panel else "")


def shows(place: Place, subject: Sequence[str]) -> bool:
    """Whether a place shows a subject: its words in the caption, or a curve of that equation."""
    figure, panel = place
    if figure == "eq":
        return letters(panel) <= CURVE
    text = panels(figure).get(panel)
    return text is not None and all(word in text for word in subject)


@dataclass(frozen=True, slots=True, kw_only=True)
class Citation:
    """A place in the text that cites a figure, a panel or an equation for what it should show."""

    tag: str  # section and key word
    what: str  # is said
    cited: Place  # instead of which another was meant
    subject: Sequence[str]  # words for what the cited place should show
    meant: Place | None = None  # the place that shows it, if there is one
    note: str  # what is right
    verdict: Verdict = "erratum"  # of all
    printed: None = None  # no equation
    contradicted_by: str = "the captions"  # always

    def prove(self) -> Proof:
        """Show that the cited place is missing or shows something else, and the meant one fits."""
        wrong = not shows(self.cited, self.subject)
        right = self.meant is None or shows(self.meant, self.subject)
        figure, panel = self.cited
        if figure == "eq":
            others = ", ".join(f"${sp.latex(x)}$" for x in sorted(letters(panel) - CURVE, key=str))
            found = f"depends on {others}"
        else:
            text = panels(figure).get(panel)
            found = "no such panel" if text is None else f'"{text.strip(" ;,-")}"'
        meant = f"; meant: {name(self.meant)}" if self.meant else ""
        return Proof(ok=wrong and right, evidence=f"{name(self.cited)}: {found}{meant}")


CITATIONS = tuple(Citation(tag=tag, **words) for tag, words in _TEXTS["citations"].items())
