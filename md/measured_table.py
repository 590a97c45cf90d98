"""Measured results at places of a scene, read from a CSV."""

import csv
import math
from itertools import zip_longest
from pathlib import Path
from typing import Any

from .domains import finite, positive
from .errors import InputError
from .files import plain


def read_rows(path: Path, result: str) -> list[tuple[dict[str, Any], str, float, float]]:
    """Rows of a CSV: place, result, value, error; lines that begin with # are comments.

    Parameters
    ----------
    path : of the file; its columns are keys of a scene, the result, and `error`
    result : its name; a row without a value asks for it

    Raises
    ------
    ValueError
        If the file cannot be read or a cell is not what it must be; the message names its line.
    """
    try:
        lines = plain(path).read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as failure:
        reason = getattr(failure, "strerror", None) or failure
        raise InputError(f"data.file: {path} cannot be read ({reason})") from None
    numbered = [(i, x) for i, x in enumerate(lines, 1) if x.strip() and not x.startswith("#")]
    cells = [[cell.strip() for cell in row] for row in csv.reader(x for _, x in numbered)]
    heads, *rows = cells or [[]]
    if not rows or not {result, "error"} < set(heads) or len(set(heads)) < len(heads):
        raise InputError(
            f"{path} must have columns {result}, error and keys of the scene, each once, with "
            f"commas between them, and rows; got {', '.join(heads) or 'nothing'}"
        )
    found = []
    for (i, _), row in zip(numbered[1:], rows, strict=False):
        where = f"{path}, line {i}"
        if len(row) > len(heads):
            raise InputError(f"{where} must have at most {len(heads)} cells, got {len(row)}")
        padded = zip_longest(heads, row, fillvalue="")
        numbers = {key: _number(f"{where}, {key}", text) for key, text in padded}
        value, error = numbers.pop(result), numbers.pop("error")
        error = math.nan if math.isnan(value) else positive(f"{where}, error", error)
        whole_numbers = {k: int(x) if x.is_integer() else x for k, x in numbers.items()}
        found.append((whole_numbers, result, value, error))
    return found


def _number(name: str, text: str) -> float:
    """A cell; nan if it is empty."""
    try:
        number = float(text or "nan")
    except ValueError:
        raise InputError(f"{name} must be a number or empty, got {text!r}") from None
    return finite(name, number) if text else number
