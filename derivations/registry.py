"""Every equation and every checked statement: the paper's way first, then what is new.

`ENTRIES` holds all of them, `SECTIONS` groups them under titles.

>>> from derivations import registry
>>> (entry,) = (entry for entry in registry.ENTRIES if entry.tag == "10")
>>> entry.verdict, entry.prove().ok
('agrees', True)
>>> entry.derive()
P_x/m + c_x
"""

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from typing import Any, TypeAlias

from . import (
    axioms,
    bodies,
    drift,
    kernel,
    landing_phases,
    laws,
    newton,
    optimum,
    pairs,
    paper,
    slide,
    slip_reversal,
    slip_stick,
    statements,
    texts,
    thin_rod,
)
from .kernel import Code
from .lecture import to_text
from .proof import Equation, Noted, Verdict, told

__all__ = ["ENTRIES", "SECTIONS", "Code", "Equation", "Noted", "Row", "check", "mistakes", "proved"]

Entry: TypeAlias = Equation | Noted | Code
Progress: TypeAlias = Callable[[Iterable], Iterable]

# The way from the assumptions to (31); the sentences on it stand in a section of their own.
_PATH = (
    ("Assumptions", axioms.EQUATIONS),
    ("Newton's laws and the contact point", newton.EQUATIONS),
    ("Slide", slide.EQUATIONS),
    ("Slip-stick", slip_stick.EQUATIONS),
    ("Slip reversal", slip_reversal.EQUATIONS),
    ("Regime boundaries of a thin rod", (*bodies.EQUATIONS, *thin_rod.EQUATIONS)),
    ("Stationary translation", drift.EQUATIONS),
)
_SENTENCES = tuple(e for _, group in _PATH for e in group if e.tag in paper.SENTENCES)

_TEXTS = Code(
    tag="texts",
    what="Numbers of equations, dimensions of letters, and units in sentences are those of what "
    "was computed; all other words are those that were read beside their forms",
    shown=(),
    wrong=lambda _: texts.wrong([x for x in ENTRIES if isinstance(x, Equation)]),
    tried="sentences of steps, entries and functions, prose, the table of letters and left sides",
)

# section title, entries
SECTIONS: tuple[tuple[str, tuple[Entry, ...]], ...] = (
    *((title, tuple(e for e in group if e not in _SENTENCES)) for title, group in _PATH),
    ("More of landings", drift.BEYOND),
    ("Best tilt, stability, Painlevé's paradox", optimum.EQUATIONS),
    ("Landing phases by the flux of impacts", landing_phases.EQUATIONS),
    ("Other laws of restitution, and energy", laws.EQUATIONS),
    ("Bodies", bodies.BEYOND),
    ("Two bodies that meet", pairs.EQUATIONS),
    ("One impact as assignments", (*kernel.EQUATIONS, *kernel.CODE)),
    ("What the page says", (_TEXTS,)),
    ("Sentences of the text", (*_SENTENCES, *statements.EQUATIONS)),
    ("Appendix A: dimensions", statements.DIMENSIONS),
    ("Noted", tuple(Noted(**x) for x in paper.NOTED)),
)

ENTRIES: tuple[Entry, ...] = tuple(e for _, group in SECTIONS for e in group)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One line of the table that `check` prints.

    tag : the paper's equation number, or the section and a key word
    what : what is stated
    verdict : on the printed form
    proved : whether the verdict stood; False for what is noted
    note : what is right, where the paper is not
    evidence : what the proof found
    computed : whether nothing stopped the proof's computation
    contradicted_by : tags of printed formulas that give the derived form
    repair : what makes the printed form right
    mistake : by what mistake the printed value comes out, if there is no repair
    rests_on : tags of the axioms that the derivation used
    """

    tag: str
    what: str
    verdict: Verdict
    proved: bool
    note: str
    evidence: str
    computed: bool
    contradicted_by: tuple[str, ...]
    repair: str
    mistake: str
    rests_on: tuple[str, ...]

    @property
    def failed(self) -> bool:
        """Whether the verdict should have been proved, and was not."""
        return not self.proved and self.verdict != "noted"

    def as_dict(self) -> dict[str, Any]:
        """Return the fields for JSON, the sentences as plain text."""
        return {
            name: to_text(value) if isinstance(value, str) else value
            for name, value in asdict(self).items()
        }


def proved(number: int) -> Row:
    """Prove one entry; its row for the table.

    Parameters
    ----------
    number : place of the entry in `ENTRIES`
    """
    entry: Any = ENTRIES[number]
    proof = entry.prove()
    equation = isinstance(entry, Equation)
    return Row(
        tag=entry.tag,
        what=entry.what if proof.computed else entry.tag,
        verdict=entry.verdict,
        proved=proof.ok and entry.verdict != "noted",
        note=told(entry) if proof.computed else "",
        evidence=proof.evidence,
        computed=proof.computed,
        contradicted_by=entry.contradicted_by if equation else (),
        repair=entry.repairs if equation else "",
        mistake=entry.mistake if equation else "",
        rests_on=entry.rests_on if equation and proof.ok else (),
    )


def check(progress: Progress = iter, over: Any = map) -> list[Row]:
    """Prove every entry.

    Parameters
    ----------
    progress : may wrap the iteration in a progress bar
    over : maps a function over numbers, as `map` does; with `imap` of a pool, processes prove side
        by side

    Returns
    -------
    A row for each of `ENTRIES`, in their order.
    """
    backwards = range(len(ENTRIES))[::-1]  # what takes longest stands near the end
    rows = [row for _, row in zip(progress(backwards), over(proved, backwards), strict=True)]
    return rows[::-1]


def mistakes() -> tuple[Equation, ...]:
    """The equations, numbers and signs that are printed wrong; nothing that is only noted."""
    return tuple(e for e in ENTRIES if isinstance(e, Equation) and e.verdict == "erratum")
