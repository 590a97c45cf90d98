"""Every equation and every checked statement, in the order in which the paper brings them.

`ENTRIES` holds them all, `SECTIONS` the same under titles.

>>> from derivations import registry
>>> (entry,) = (entry for entry in registry.ENTRIES if entry.tag == "10")
>>> entry.verdict, entry.prove().ok
('agrees', True)
>>> entry.derive()
P_x/m + c_x
"""

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from typing import TypeAlias

from . import (
    appendix,
    axioms,
    bodies,
    drift,
    kernel,
    landing_phases,
    laws,
    newton,
    optimum,
    pairs,
    references,
    slide,
    slip_reversal,
    slip_stick,
    statements,
    thin_rod,
    transport,
)
from .kernel import Code
from .proof import Equation, Verdict
from .references import Citation
from .sentences import to_text
from .statements import Reading

__all__ = [
    "ENTRIES",
    "SECTIONS",
    "Citation",
    "Code",
    "Equation",
    "Reading",
    "Row",
    "check",
    "mistakes",
]

Entry: TypeAlias = Equation | Citation | Reading | Code

# section title, entries
SECTIONS: tuple[tuple[str, tuple[Entry, ...]], ...] = (
    ("Assumptions", axioms.EQUATIONS),
    ("Newton's laws and the contact point", newton.EQUATIONS),
    ("Slide", slide.EQUATIONS),
    ("Slip-stick", slip_stick.EQUATIONS),
    ("Slip reversal", slip_reversal.EQUATIONS),
    ("Bodies", bodies.EQUATIONS),
    ("Regime boundaries and the thin rod", thin_rod.EQUATIONS),
    ("Other laws of restitution, and energy", laws.EQUATIONS),
    ("Two bodies that meet", pairs.EQUATIONS),
    ("One impact as assignments", (*kernel.EQUATIONS, *kernel.CODE)),
    ("Stationary translation", drift.EQUATIONS),
    ("Best tilt, stability, Painlevé's paradox", optimum.EQUATIONS),
    ("Landing phases by the flux of impacts", landing_phases.EQUATIONS),
    ("Short rods, and energy", transport.EQUATIONS),
    ("Appendix A: dimensions", appendix.EQUATIONS),
    ("Sentences of the text", statements.EQUATIONS),
    ("Readings: places of the text that differ", statements.READINGS),
    ("Cross references", references.CITATIONS),
)

ENTRIES: tuple[Entry, ...] = tuple(e for _, group in SECTIONS for e in group)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One line of the table that `check` prints."""

    tag: str  # the paper's equation number, or the section and a key word
    what: str  # is stated
    verdict: Verdict  # on the printed form
    proved: bool  # whether the verdict stood
    note: str  # what is right, where the paper is not
    evidence: str  # what the proof found
    computed: bool  # whether nothing stopped its computation
    contradicted_by: str  # tags of printed equations that give the derived form
    repair: str  # what makes the printed form right
    mistake: str  # or by which the printed value comes out
    rests_on: tuple[str, ...]  # tags of the axioms that the derivation used

    def as_dict(self) -> dict[str, str | bool | tuple[str, ...]]:
        """Return the fields for JSON, the sentences as plain text."""
        return {
            name: to_text(value) if isinstance(value, str) else value
            for name, value in asdict(self).items()
        }


def check(progress: Callable[[Iterable], Iterable] = iter) -> list[Row]:
    """Prove every entry.

    Parameters
    ----------
    progress : may wrap the iteration in a progress bar

    Returns
    -------
    A row for each of `ENTRIES`, in their order.
    """
    rows = []
    for entry in progress(ENTRIES):
        proof = entry.prove()
        same = ("tag", "what", "verdict", "note", "contradicted_by")
        told = {name: getattr(entry, name) for name in same}
        equation = isinstance(entry, Equation)
        rows.append(
            Row(
                proved=proof.ok,
                evidence=proof.evidence,
                computed=proof.computed,
                repair="; ".join(repair.what for repair in entry.repair) if equation else "",
                mistake=entry.mistake if equation else "",
                rests_on=entry.rests_on if equation and proof.ok else (),
                **told,
            )
        )
    return rows


def mistakes() -> tuple[Entry, ...]:
    """The entries whose printed form is wrong."""
    return tuple(entry for entry in ENTRIES if entry.verdict == "erratum")
