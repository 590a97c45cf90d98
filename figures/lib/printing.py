"""Numbers of figures as text, and as values for JSON."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

LONGEST, MOST = 40, 400  # arrays of more numbers along the last axis, or in all, are summed up
ABREAST = 6  # columns of a table


def _cells(values: np.ndarray, errors: np.ndarray | None) -> list[str]:
    """Numbers to four digits, with their standard errors to two; text as it is."""
    if values.dtype.kind not in "fc":
        return [str(value) for value in values]
    if errors is None:
        return [f"{value:.4g}" for value in values]
    return [f"{v:.4g} ± {e:.2g}" for v, e in zip(values, errors, strict=True)]


def printed(d: Mapping[str, Any]) -> str:
    """What the `data` of a figure returns, as tables of arrays of one length.

    Of a larger array the shape, the smallest and the largest number; of one with several axes a
    column for each place on all but the last.

    Parameters
    ----------
    d : arrays by name; `name_error` are the standard errors of `name`
    """
    lines: list[str] = []
    tables: dict[int, list[list[str]]] = {}
    for name, array in d.items():
        if name.endswith("_error") and name.removesuffix("_error") in d:
            continue
        values, errors = np.atleast_1d(array), d.get(f"{name}_error")
        if values.size > MOST or values.shape[-1] > LONGEST:
            known = values[np.isfinite(values)] if values.dtype.kind in "fi" else values[:0]
            ends = f", {known.min():.4g} to {known.max():.4g}" if known.size else ""
            lines.append(f"{name}: {' x '.join(map(str, values.shape))} values{ends}")
            continue
        for at in np.ndindex(values.shape[:-1]):
            of = None if errors is None else np.atleast_1d(errors)[at]
            head = f"{name}{list(at)}" if at else name
            tables.setdefault(values.shape[-1], []).append([head, *_cells(values[at], of)])
    for columns in tables.values():
        for first in range(0, len(columns), ABREAST):
            part = columns[first : first + ABREAST]
            widths = [max(map(len, column)) for column in part]
            for row in zip(*part, strict=True):
                cells = [cell.rjust(width) for cell, width in zip(row, widths, strict=True)]
                lines.append("  ".join(cells))
    return "\n".join(lines)


def plain(value: Any) -> Any:
    """A value for JSON: arrays as lists, null for nan and inf."""
    text = json.dumps(value, default=lambda array: array.tolist())
    return json.loads(text, parse_constant=lambda _: None)
