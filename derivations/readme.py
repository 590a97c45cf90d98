"""The tables of the README, generated from the registry between two markers."""

from collections.abc import Sequence
from pathlib import Path

from . import codegen, registry

TARGET = Path(__file__).resolve().parent.parent / "README.md"
BEGIN, END = "<!-- registry: begin -->", "<!-- registry: end -->"


def _table(header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    lines = [header, tuple("---" for _ in header), *rows]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in lines
    )


def tables() -> str:
    """Verdicts of the numbered equations in one table, every mistake in a second."""
    numbered = [
        (f"({entry.tag})", entry.what, entry.verdict)
        for entry in registry.ENTRIES
        if entry.tag.removeprefix("B").isdigit()
    ]
    mistakes = [(entry.tag, entry.what, entry.note) for entry in registry.mistakes()]
    total = len(registry.ENTRIES)
    return "\n\n".join(
        [
            f"{total} entries in all, {len(mistakes)} of them mistakes as printed in our copy:",
            _table(("where", "as printed", "what is right"), mistakes),
            "<details><summary>The numbered equations and their verdicts</summary>",
            _table(("equation", "what", "verdict"), numbered),
            "</details>",
        ]
    )


def refreshed(text: str) -> str:
    """`text` with the tables between the markers."""
    before, _, rest = text.partition(BEGIN)
    _, found, after = rest.partition(END)
    if not found:
        raise ValueError(f"{TARGET.name} must hold {BEGIN} and {END}")
    return f"{before}{BEGIN}\n{tables()}\n{END}{after}"


def refresh() -> bool:
    """Write the tables into the README; returns whether it changed."""
    return codegen.write(refreshed(TARGET.read_text(encoding="utf-8")), TARGET)
