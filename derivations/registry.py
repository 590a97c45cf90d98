"""Every equation and every checked statement, in the order in which the paper brings them."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass

from . import (
    appendix,
    bodies,
    drift,
    laws,
    newton,
    references,
    slide,
    slip_reversal,
    slip_stick,
    thin_rod,
)
from .proof import Equation
from .references import Citation

# section title, entries
SECTIONS: tuple[tuple[str, tuple[Equation | Citation, ...]], ...] = (
    ("Newton's laws and the contact point", newton.EQUATIONS),
    ("Slide", slide.EQUATIONS),
    ("Slip-stick", slip_stick.EQUATIONS),
    ("Slip reversal", slip_reversal.EQUATIONS),
    ("Bodies", bodies.EQUATIONS),
    ("Regime boundaries and the thin rod", thin_rod.EQUATIONS),
    ("Other laws of restitution, and energy", laws.EQUATIONS),
    ("Stationary translation", drift.EQUATIONS),
    ("Appendix A: dimensions", appendix.EQUATIONS),
    ("Cross references", references.CITATIONS),
)

ENTRIES: tuple[Equation | Citation, ...] = tuple(e for _, group in SECTIONS for e in group)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One line of the table that `check` prints."""

    tag: str
    what: str
    verdict: str
    proved: bool
    note: str
    evidence: str
    contradicted_by: str

    as_dict = asdict


def check(progress: Callable[[Iterator], Iterator] = iter) -> list[Row]:
    """Prove every entry; `progress` may wrap the iteration in a progress bar."""
    rows = []
    for entry in progress(ENTRIES):
        proof = entry.prove()
        rows.append(
            Row(
                tag=entry.tag,
                what=entry.what,
                verdict=entry.verdict,
                proved=proof.ok,
                note=entry.note,
                evidence=proof.evidence,
                contradicted_by=entry.contradicted_by,
            )
        )
    return rows


def mistakes() -> tuple[Equation | Citation, ...]:
    """The entries whose printed form is wrong."""
    return tuple(entry for entry in ENTRIES if entry.verdict == "erratum")
