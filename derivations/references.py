"""Cross references: what cited figures, panels and equations show by their captions.

`SHOWN` holds what the captions say; every citation in `CITATIONS` is looked up there.
"""

from dataclasses import dataclass

from .proof import Proof, Verdict

TILT, DRIFT, ACCELERATION = "tilt", "$c_x$", r"$\Gamma$"

# What each panel plots, by its caption; panels are those that the captions name.
SHOWN: dict[str, dict[str, set[str]]] = {
    "3": {"a": {"annulus geometry"}, "b": {"quasi-2D geometry"}},
    "4": {
        "a": {DRIFT, TILT},
        "b": {DRIFT, ACCELERATION},
        "c": {DRIFT, TILT, r"$\mu_{rw}$"},
        "d": {DRIFT, TILT, r"$\mu_{rb}$"},
    },
    "5": {"a": {"directors", "N = 55"}, "b": {"directors", "N = 44", "tilt 22 degrees"}},
    "6": {
        "a": {r"$\omega$", TILT},
        "b": {"$c_z$", TILT},
        "c": {DRIFT, TILT},
        "d": {"$V_z$", TILT},
    },
    "9": {"": {"rod", "plate"}},
    "11": {"": {"translation velocity", TILT}},
    "13": {"a": {DRIFT, TILT}, "b": {DRIFT, ACCELERATION}, "c": {DRIFT, "length"}},
    # equations that the captions of Figs. 11 and 13 cite
    "eq. 18": {"": {"velocity after one slip-stick impact"}},
    "eq. 24": {"": {"translation velocity", "slip-stick", "any geometry"}},
    "eq. 26": {"": {"translation velocity", "slip-stick", "thin rod"}},
}

Place = tuple[str, str]  # a figure or equation, and its panel; "" for all of it


def name(place: Place) -> str:
    """A place as the paper writes it: Fig. 3(c), eq. 24."""
    figure, panel = place
    return ("" if figure.startswith("eq") else "Fig. ") + figure + (f"({panel})" if panel else "")


@dataclass(frozen=True, slots=True)
class Citation:
    """A place in the text that cites a figure, a panel or an equation for what it should show."""

    tag: str  # section and key word
    what: str  # is said
    cited: Place  # instead of which another was meant
    subject: tuple[str, ...]  # what the cited place should show
    meant: Place | None  # the place that shows it, if there is one
    note: str  # what is right
    verdict: Verdict = "erratum"  # of all
    printed: None = None  # no equation
    contradicted_by: str = "the captions"  # always

    def prove(self) -> Proof:
        """Show that the cited panel is missing or shows something else, and the meant one fits."""
        figure, panel = self.cited
        shown, wanted = SHOWN[figure].get(panel), set(self.subject)
        wrong = shown is None or not wanted <= shown
        right = self.meant is None or wanted <= SHOWN[self.meant[0]][self.meant[1]]
        found = "no such panel" if shown is None else "shows " + ", ".join(sorted(shown))
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
        ("directors", "N = 44"),
        ("5", "b"),
        "Fig. 4 has no panel (e); the directors are in Fig. 5(b), at 22 degrees",
    ),
    Citation(
        "III: Fig. 6(a)",
        '"In Fig. 6(a) a noticeable variation of the horizontal translation velocity"',
        ("6", "a"),
        (DRIFT, TILT),
        ("6", "c"),
        "6(a) shows angular velocities; the horizontal velocity is in 6(c)",
    ),
    Citation(
        "III: Figs. 6(b,c)",
        '"Figures 6(b,c) shows the horizontal and vertical CM velocities"',
        ("6", "b"),
        (DRIFT, TILT),
        ("6", "c"),
        "the order is the other way round: (b) vertical, (c) horizontal",
    ),
    Citation(
        "III: Fig. 6(b)",
        '"horizontal translation velocities $c_x$, $c_x\'$ on the tilt angle [see Fig. 6(b)]"',
        ("6", "b"),
        (DRIFT, TILT),
        ("6", "c"),
        "6(b) shows vertical velocities",
    ),
    Citation(
        "VI: Fig. 13(b)",
        r'"2.5 times smaller than $c_x$ at $\mu_{rw} = 0$ (see Fig. 13(b))"',
        ("13", "b"),
        (DRIFT, r"$\mu_{rw}$"),
        ("4", "c"),
        r"13(b) shows $c_x$ over $\Gamma$ in the plane, where there is no wall; "
        r"$\mu_{rw}$ is in 4(c)",
    ),
    Citation(
        "Fig. 9: caption",
        '"Geometry of the collision between rod and sphere"',
        ("9", ""),
        ("rod", "sphere"),
        None,
        "rod and plate: the text introduces the figure for a rod colliding with a plate",
    ),
    Citation(
        "Fig. 11: caption",
        '"unphysical branches of the dependencies (18), (21)" of the translation velocity',
        ("eq. 18", ""),
        ("translation velocity", "slip-stick"),
        ("eq. 24", ""),
        "(18) and (21) are velocities after one impact; the curves are (24) and (27), "
        "for a thin rod (26) and (29)",
    ),
    Citation(
        "Fig. 13: caption",
        '"theory (24), (29), (31)": a thin rod\'s slip-stick branch',
        ("eq. 24", ""),
        ("translation velocity", "slip-stick", "thin rod"),
        ("eq. 26", ""),
        "(29) is the thin-rod form, (24) is not: (26) goes with (29)",
    ),
)
