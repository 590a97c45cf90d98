"""Cross references: what cited figures, panels and equations show.

Panels and their subjects are read off the captions' own words (`CAPTIONS`); what an equation can be
plotted against, off its letters. What remains a reader's judgement is which words to look for.
"""

import re
from dataclasses import dataclass

import sympy as sp

from . import drift, slip_stick
from .proof import Proof, Verdict
from .symbols import V_z, epsilon, mu, phi

# Words of the captions, as far as they say what is shown.
CAPTIONS = {
    "3": "geometry used in simulations: (a) - annulus geometry, (b) - quasi-2D geometry with "
    "periodic boundary conditions along x",
    "4": "results of simulations in the annular geometry: (a) - average translational velocity of "
    "rods as a function of tilt; (b) - idem as a function of Gamma for a number of tilt angles; "
    "(c) - idem and average tilt as a function of the coefficient of friction between the rods "
    "and the walls; (d) - idem and average tilt as a function of the coefficient of friction "
    "between the rods and the bottom",
    "5": "horizontal projections of the rods' directors for two numbers of rods (a) N = 55, "
    "(b) N = 44, the mean tilts are 9 and 22 degrees",
    "6": "mean CM velocities as a function of inclination angle: (a) angular velocities; "
    "(b) vertical CM velocities; (c) horizontal CM velocities; (d) the mean plate velocity at the "
    "time of collision",
    "9": "Geometry of the collision between rod and sphere",
    "13": "quasi-2D geometry: (a) - average horizontal velocity of rods as a function of the "
    "inclination angle; (b) - average horizontal velocity of rods and average tilt as a function "
    "Gamma; (c) average horizontal velocity of rods and average tilt as a function of the length "
    "of rods",
}
_PANEL = re.compile(r"\(([a-e])\)")

# What a curve over tilt, of given friction and restitution, in units of V_z, may depend on.
CURVE = {phi, mu, epsilon, V_z}
_EQUATIONS = {entry.tag: entry for entry in (*slip_stick.EQUATIONS, *drift.EQUATIONS)}

Place = tuple[str, str]  # a figure and its panel ("" for all of it), or "eq" and an equation's tag


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


def shows(place: Place, subject: tuple[str, ...]) -> bool:
    """Whether a place shows a subject: its words in the caption, or a curve of that equation."""
    figure, panel = place
    if figure == "eq":
        return letters(panel) <= CURVE
    text = panels(figure).get(panel)
    return text is not None and all(word in text for word in subject)


@dataclass(frozen=True, slots=True)
class Citation:
    """A place in the text that cites a figure, a panel or an equation for what it should show."""

    tag: str  # section and key word
    what: str  # is said
    cited: Place  # instead of which another was meant
    subject: tuple[str, ...]  # words for what the cited place should show
    meant: Place | None  # the place that shows it, if there is one
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


CITATIONS = (
    Citation(
        "III: Fig. 3(c)",
        '"varied the length of the container, thereby changing the tilt [see Figure 3(c)]"',
        ("3", "c"),
        ("quasi-2D geometry",),
        ("3", "b"),
        "Fig. 3 has panels (a) and (b) only",
    ),
    Citation(
        "III: Fig. 4(e)",
        '"at 25 degrees it involves roughly half of the rods [Fig. 4(e)]"',
        ("4", "e"),
        ("N = 44",),
        ("5", "b"),
        "Fig. 4 has no panel (e); the directors are in Fig. 5(b), at 22 degrees",
    ),
    Citation(
        "III: Fig. 6(a)",
        '"In Fig. 6(a) a noticeable variation of the horizontal translation velocity"',
        ("6", "a"),
        ("horizontal CM velocities",),
        ("6", "c"),
        "6(a) shows angular velocities; the horizontal velocity is in 6(c)",
    ),
    Citation(
        "III: Figs. 6(b,c)",
        '"Figures 6(b,c) shows the horizontal and vertical CM velocities"',
        ("6", "b"),
        ("horizontal CM velocities",),
        ("6", "c"),
        "the order is the other way round: (b) vertical, (c) horizontal",
    ),
    Citation(
        "III: Fig. 6(b)",
        '"horizontal translation velocities $c_x$, $c_x\'$ on the tilt angle [see Fig. 6(b)]"',
        ("6", "b"),
        ("horizontal CM velocities",),
        ("6", "c"),
        "6(b) shows vertical velocities",
    ),
    Citation(
        "VI: Fig. 13(b)",
        r'"2.5 times smaller than $c_x$ at $\mu_{rw} = 0$ (see Fig. 13(b))"',
        ("13", "b"),
        ("friction", "walls"),
        ("4", "c"),
        r"13(b) shows $c_x$ over $\Gamma$ in the plane, where there is no wall; "
        r"$\mu_{rw}$ is in 4(c)",
    ),
    Citation(
        "Fig. 9: caption",
        '"Geometry of the collision between rod and sphere"',
        ("9", ""),
        ("rod", "plate"),
        None,
        "rod and plate: the text introduces the figure for a rod colliding with a plate",
    ),
    Citation(
        "Fig. 11: caption",
        '"unphysical branches of the dependencies (18), (21)" of the translation velocity',
        ("eq", "18"),
        (),
        ("eq", "26"),
        "(18) and (21) are velocities after one impact; the curves are (24) and (27), "
        "for a thin rod (26) and (29)",
    ),
    Citation(
        "Fig. 13: caption",
        '"theory (24), (29), (31)": a thin rod\'s slip-stick branch',
        ("eq", "24"),
        (),
        ("eq", "26"),
        "(29) is the thin-rod form, (24) is not: (26) goes with (29)",
    ),
)
