"""Aligned tables for the summaries of figures, as text or as Markdown; values for JSON."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

Digits = int | str  # decimals, or a format such as ".3g"


def pairs(d: dict[str, np.ndarray], name: str, at: Any = ...) -> list[tuple[float, float]]:
    """Values of an array with errors, for cells of a table.

    Parameters
    ----------
    d : data of a figure; holds `name` and `name_error`
    name : of the values
    at : index into both arrays
    """
    return list(zip(d[name][at], d[f"{name}_error"][at], strict=True))


def text_of(cell: Any, digits: Digits = 2) -> str:
    """Text of one cell: a value, or a tuple of a value and its error, joined by ±; nan is a dash.

    Parameters
    ----------
    cell : number, text or (value, error)
    digits : of numbers that are not whole, or their format
    """
    if isinstance(cell, tuple):
        known = [part for part in cell if np.isfinite(part)] or [np.nan]
        return " ± ".join(text_of(float(part), digits) for part in known)
    if isinstance(cell, str | int | np.integer | np.str_):
        return str(cell)
    if np.isnan(cell):
        return "-"
    return format(float(cell), digits if isinstance(digits, str) else f".{digits}f")


def table(
    heads: Sequence[Any],
    rows: Iterable[Sequence[Any]],
    digits: Digits | Sequence[Digits] = 2,
    *,
    markdown: bool = False,
) -> str:
    """Lay out rows under heads: text to the left, numbers to the right.

    Parameters
    ----------
    heads : of the columns; a number has the digits of its column
    rows : of cells, as `text_of` takes them; at least one
    digits : of all numbers, or of each column
    markdown : whether to write a Markdown table
    """
    rows = list(rows)
    given = [digits] * len(heads) if isinstance(digits, int | str) else digits
    lines = [[text_of(*pair) for pair in zip(row, given, strict=True)] for row in (heads, *rows)]
    if markdown:
        lines.insert(1, ["---", *["---:"] * (len(heads) - 1)])
        return "\n".join(f"| {' | '.join(line)} |" for line in lines)
    sides = [str.ljust if isinstance(cell, str) else str.rjust for cell in rows[0]]
    columns = [
        [side(cell, max(map(len, column))) for cell in column]
        for side, column in zip(sides, zip(*lines, strict=True), strict=True)
    ]
    return "\n".join("  ".join(line).rstrip() for line in zip(*columns, strict=True))


def columned(
    columns: Mapping[str, Iterable[Any]], digits: Digits | Sequence[Digits] = 2, **how: bool
) -> str:
    """Lay out columns under their heads, as `table` does.

    Parameters
    ----------
    columns : cells by head
    digits, how : of `table`
    """
    return table([*columns], zip(*columns.values(), strict=True), digits, **how)


def plain(value: Any) -> Any:
    """A value for JSON: arrays as lists, null for nan and inf."""
    value = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value
