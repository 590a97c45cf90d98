"""The tables of the README, generated from the registry between two markers."""

from collections.abc import Sequence
from pathlib import Path

from . import codegen, registry

TARGET = Path(__file__).resolve().parent.parent / "README.md"


def table(header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    """In Markdown."""
    lines = [header, tuple("---" for _ in header), *rows]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in lines
    )


def tables() -> str:
    """Every mistake, what is new, and the verdicts of the numbered equations."""
    numbered = [
        (f"({entry.tag})", entry.what, entry.verdict)
        for entry in registry.ENTRIES
        if entry.tag.removeprefix("B").isdigit()
    ]
    mistakes = [(entry.tag, entry.what, entry.note) for entry in registry.mistakes()]
    new = [e for e in registry.ENTRIES if e.verdict == "new"]
    told = [(entry.tag, entry.what, entry.note) for entry in new]
    return "\n\n".join(
        [
            f"{len(registry.ENTRIES)} entries in all, {len(mistakes)} of them mistakes as printed"
            f" in our copy, {len(new)} not in the paper.",
            *_folded("The mistakes", ("where", "as printed", "what is right"), mistakes),
            *_folded("What follows that the paper does not say", ("where", "what", "note"), told),
            *_folded("The numbered equations", ("equation", "what", "verdict"), numbered),
        ]
    )


def _folded(title: str, header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> list[str]:
    return [f"<details><summary>{title}</summary>", table(header, rows), "</details>"]


def filled(text: str, name: str, content: str) -> str:
    """`text` with `content` between the markers of that name.

    Raises
    ------
    ValueError
        If it does not hold both.
    """
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    before, _, rest = text.partition(begin)
    _, found, after = rest.partition(end)
    if not found:
        raise ValueError(f"{TARGET.name} must hold {begin} and {end}")
    return f"{before}{begin}\n{content}\n{end}{after}"


def refreshed(text: str) -> str:
    """`text` with the tables between the markers."""
    return filled(text, "registry", tables())


def refresh() -> bool:
    """Write the tables into the README; returns whether it changed."""
    return codegen.write(refreshed(TARGET.read_text(encoding="utf-8")), TARGET)
