"""Cross references: what cited figures, panels and equations show by their captions.

`SHOWN` holds what the captions say; every citation in `CITATIONS` is looked up there.
"""

from dataclasses import dataclass

from .proof import Proof, Verdict

TILT, DRIFT = "tilt", "c_x"

# What each panel plots, by its caption; panels are those that the captions name.
SHOWN: dict[str, dict[str, set[str]]] = {
    "3": {"a": {"annulus geometry"}, "b": {"quasi-2D geometry"}},
    "4": {
        "a": {DRIFT, TILT},
        "b": {DRIFT, "Gamma"},
        "c": {DRIFT, TILT, "mu_rw"},
        "d": {DRIFT, TILT, "mu_rb"},
    },
    "5": {"a": {"directors", "N = 55"}, "b": {"directors", "N = 44", "tilt 22 degrees"}},
    "6": {
        "a": {"omega", TILT},
        "b": {"c_z", TILT},
        "c": {DRIFT, TILT},
        "d": {"V_z", TILT},
    },
    "9": {"": {"rod", "plate"}},
    "11": {"": {"translation velocity", TILT}},
    "13": {"a": {DRIFT, TILT}, "b": {DRIFT, "Gamma"}, "c": {DRIFT, "length"}},
    # equations that the captions of Figs. 11 and 13 cite
    "eq. 18": {"": {"velocity after one slip-stick impact"}},
    "eq. 24": {"": {"translation velocity", "slip-stick", "any geometry"}},
    "eq. 26": {"": {"translation velocity", "slip-stick", "thin rod"}},
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Citation:
    """A place in the text that cites `figure`(`panel`) for `subject`."""

    tag: str  # section and key word
    what: str  # is said
    figure: str  # that is cited: a number, or "eq. 24"
    panel: str  # of it; "" for all
    subject: frozenset[str]  # what it should show
    meant: tuple[str, str]  # figure and panel that do show it; ("", "") if none does
    note: str  # what is right
    verdict: Verdict = "erratum"  # of all
    symbol: str = ""  # none
    printed: None = None  # no equation
    contradicted_by: str = "the captions"  # always

    def prove(self) -> Proof:
        """The cited panel is missing or shows something else; the one that is meant shows it."""
        panels = SHOWN[self.figure]
        shown = panels.get(self.panel)
        wrong = shown is None or not self.subject <= shown
        figure, panel = self.meant
        right = not figure or self.subject <= SHOWN[figure][panel]
        found = "no such panel" if shown is None else "shows " + ", ".join(sorted(shown))
        where = f"({self.panel})" if self.panel else ""
        name = self.figure if self.figure.startswith("eq") else f"Fig. {self.figure}"
        return Proof(ok=wrong and right, evidence=f"{name}{where}: {found}")


def _cites(
    tag: str,
    what: str,
    cited: tuple[str, str],
    subject: set[str],
    meant: tuple[str, str],
    note: str,
) -> Citation:
    return Citation(
        tag=tag,
        what=what,
        figure=cited[0],
        panel=cited[1],
        subject=frozenset(subject),
        meant=meant,
        note=note,
    )


CITATIONS = (
    _cites(
        "III: Fig. 3(c)",
        '"varied the length of the container, thereby changing the tilt [see Figure 3(c)]"',
        ("3", "c"),
        {"quasi-2D geometry"},
        ("3", "b"),
        "Fig. 3 has panels (a) and (b) only",
    ),
    _cites(
        "III: Fig. 4(e)",
        '"at 25 degrees it involves roughly half of the rods [Fig. 4(e)]"',
        ("4", "e"),
        {"directors", "N = 44"},
        ("5", "b"),
        "Fig. 4 has no panel (e); the directors are in Fig. 5(b), at 22 degrees",
    ),
    _cites(
        "III: Fig. 6(a)",
        '"In Fig. 6(a) a noticeable variation of the horizontal translation velocity"',
        ("6", "a"),
        {DRIFT, TILT},
        ("6", "c"),
        "6(a) shows angular velocities; the horizontal velocity is in 6(c)",
    ),
    _cites(
        "III: Figs. 6(b,c)",
        '"Figures 6(b,c) shows the horizontal and vertical CM velocities"',
        ("6", "b"),
        {DRIFT, TILT},
        ("6", "c"),
        "the order is the other way round: (b) vertical, (c) horizontal",
    ),
    _cites(
        "III: Fig. 6(b)",
        '"horizontal translation velocities c_x, c_x\' on the tilt angle [see Fig. 6(b)]"',
        ("6", "b"),
        {DRIFT, TILT},
        ("6", "c"),
        "6(b) shows vertical velocities",
    ),
    _cites(
        "VI: Fig. 13(b)",
        '"2.5 times smaller than c_x at mu_rw = 0 (see Fig. 13(b))"',
        ("13", "b"),
        {DRIFT, "mu_rw"},
        ("4", "c"),
        "13(b) shows c_x over Gamma in the plane, where there is no wall; mu_rw is in 4(c)",
    ),
    _cites(
        "Fig. 9: caption",
        '"Geometry of the collision between rod and sphere"',
        ("9", ""),
        {"rod", "sphere"},
        ("", ""),
        "rod and plate: the text introduces the figure for a rod colliding with a plate",
    ),
    _cites(
        "Fig. 11: caption",
        '"unphysical branches of the dependencies (18), (21)" of the translation velocity',
        ("eq. 18", ""),
        {"translation velocity", "slip-stick"},
        ("eq. 24", ""),
        "(18) and (21) are velocities after one impact; the curves are (24) and (27), "
        "for a thin rod (26) and (29)",
    ),
    _cites(
        "Fig. 13: caption",
        '"theory (24), (29), (31)": a thin rod\'s slip-stick branch',
        ("eq. 24", ""),
        {"translation velocity", "slip-stick", "thin rod"},
        ("eq. 26", ""),
        "(29) is the thin-rod form, (24) is not: (26) goes with (29)",
    ),
)
