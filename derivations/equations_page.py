"""EQUATIONS.md: tables of the mistakes, of the new results and of the numbered equations."""

from collections.abc import Iterable
from pathlib import Path

from .files import write
from .proof import told
from .registry import ENTRIES, mistakes

TARGET = Path(__file__).with_name("EQUATIONS.md")


def table(header: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    """Return a table in Markdown; a cell is one line."""
    lines = [header, tuple("---" for _ in header), *rows]
    cells = ([" ".join(cell.replace("|", "\\|").split()) for cell in row] for row in lines)
    return "\n".join(f"| {' | '.join(row)} |" for row in cells)


def source() -> str:
    """Return the text of the page."""
    new = [entry for entry in ENTRIES if entry.verdict == "new"]
    noted = [entry for entry in ENTRIES if entry.verdict == "noted"]
    numbered = [entry for entry in ENTRIES if entry.tag.removeprefix("B").isdigit()]
    tables = {
        "Mistakes as printed in our copy": table(
            ("where", "as printed", "what is right"),
            ((entry.tag, entry.what, told(entry)) for entry in mistakes()),
        ),
        "New results": table(
            ("where", "what", "note"), ((entry.tag, entry.what, told(entry)) for entry in new)
        ),
        "Noted: words and citations": table(
            ("where", "quoted", "what it does not fit"),
            ((entry.tag, entry.what, told(entry)) for entry in noted),
        ),
        "Numbered equations": table(
            ("equation", "what", "verdict"),
            ((f"({entry.tag})", entry.what, entry.verdict) for entry in numbered),
        ),
    }
    return (
        "# Equations\n\n<!-- written by `python -m derivations generate`; do not edit -->\n\n"
        f"{len(ENTRIES)} entries in all: {len(mistakes())} are mistakes of equations, numbers and "
        f"signs as printed in our copy, {len(new)} are not in the paper, {len(noted)} are words "
        "and "
        "citations, quoted and not proved. `python -m derivations check` proves the others; "
        "`python -m derivations report` writes all formulas.\n"
        + "".join(f"\n## {title}\n\n{text}\n" for title, text in tables.items())
    )


def refresh() -> bool:
    """Write the page; return whether it changed."""
    return write(source(), TARGET)
