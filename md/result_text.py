"""Results as text: one impact, a sweep, a search, the table of a store."""

from collections.abc import Iterable, Mapping, Sequence
from math import isnan, sqrt
from typing import Any

from .soft_impact import Impact
from .units import TWINS

_OF_RESULT = "accuracy.", "annulus.", "energy.", "landings.", "touches.", "turned.", "versions."


def impact_text(hit: Impact, law: str) -> str:
    """One impact, in reduced units; `law` in words."""
    phases = "  ".join(f"{name} {time:.4g}" for name, time in hit.phases.items() if time)
    steps = "evaluations" if isnan(hit.dt) else f"steps of {hit.dt:.3g}"
    lines = [
        f"regime       {hit.regime}",
        f"c_x  c_z     {hit.c_x:.6g}  {hit.c_z:.6g}   sqrt(g d)",
        f"omega        {hit.omega:.6g}   sqrt(g/d)",
        f"restitution  {hit.restitution:.6g}   measured, -v_f/v_0",
        f"phases       {phases}   of {hit.contact_time:.4g} sqrt(d/g)",
        f"max overlap  {hit.max_overlap:.4g} d",
        f"cost         {hit.steps} {steps}, {hit.seconds * 1e6:.3g} microseconds",
        f"law          {law}",
    ]
    return "\n".join(lines)


def tally_text(tally: Any) -> str:
    """What a sweep has computed."""
    same = "" if tally.distinct == tally.points else f", {tally.distinct} of them different"
    time = f"{tally.seconds:.3g} s ({tally.run_seconds:.3g} s of runs)"
    return (
        f"points    {tally.points}{same}; {tally.there} in the store before\n"
        f"computed  {tally.computed}, failed {tally.failed}, in {time}"
    )


def search_json(found: Any) -> dict[str, Any]:
    """Points of a search with their misfits, best first; estimates; what is told of each target."""
    search, told = found.search, found.estimates
    runs = zip(found.parts.tolist(), found.misfits.tolist(), strict=True)
    points = [{**search.values(parts), "misfit": misfit} for parts, misfit in runs]
    targets = []
    for i, target in enumerate(search.targets):
        table = {**target.place, **target._asdict(), "best": float(found.results[found.best, i])}
        del table["place"]
        if told.results:
            table |= {"predicted": told.results[i].value, "uncertainty": told.results[i].error}
        targets.append(table)
    estimates = {name: estimate._asdict() for name, estimate in told.parameters.items()}
    return {
        "points": sorted(points, key=lambda point: point["misfit"]),
        "estimates": estimates,
        "correlation": told.correlation.tolist(),
        "least_misfit": told.misfit,
        "targets": targets,
        "tally": vars(found.tally),
    }


def search_text(found: Any) -> str:
    """The best points of a search, the estimates, and the results at the targets."""
    told, data = search_json(found), sum(target.error > 0 for target in found.search.targets)
    lines = [tally_text(found.tally), "", "best points", *_table(told["points"][:8])]
    if estimates := told["estimates"]:
        rows = [*map(_estimate, found.search.parameters, estimates.values())]
        lines += ["", "estimates, with standard errors", *_table(rows)]
        lines.append(f"least misfit  {told['least_misfit']:.3g}, of {data} data")
        if told["least_misfit"] > data + 4 * sqrt(2 * data):
            lines.append("warning: the scene does not fit the data; the errors do not hold")
    else:
        lines += ["", "too few points near the best one for estimates: more points or rounds"]
    return "\n".join([*lines, "", "data", *_table(told["targets"])])


def _estimate(parameter: Any, estimate: dict[str, float]) -> dict[str, Any]:
    """Row of an estimate, with a note where an end of the range cuts it off."""
    low, high, reach = parameter.low, parameter.high, 2 * estimate["error"]
    within = low + reach < estimate["value"] < high - reach
    note = "" if within else f"reaches an end of its range, {low:g} to {high:g}"
    return {"parameter": parameter.name, **estimate, "note": note}


def _table(rows: Sequence[Mapping]) -> list[str]:
    """Lines of a table with the columns of the first row."""
    names = [*rows[0]] if rows else []
    cells = [names, *([_cell(row.get(name)) for name in names] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return [
        "  ".join(text.rjust(width) for text, width in zip(line, widths, strict=True))
        for line in cells
    ]


def store_text(columns: Iterable[str], rows: Sequence[dict[str, Any]]) -> str:
    """A line a run: the keys that differ between them, in the scene's own units, and the drift."""
    of_scene = (c for c in columns if "." in c and not c.startswith(_OF_RESULT) and c not in TWINS)
    differing = [c for c in of_scene if len({row.get(c) for row in rows}) > 1]
    brief = [*differing, "c_x", "c_x_stderr", "c_x_cm_s", "tilt_deg", "periods", "seconds"]
    brief += ["accuracy.state", "error"]
    brief = [c for c in brief if any(row.get(c) is not None for row in rows)]
    return "\n".join(_table([{c: row.get(c) for c in brief} for row in rows]))


def _cell(value: object) -> str:
    if value is None or value != value:  # nan: a datum that is asked for
        return ""
    return f"{value:.5g}" if isinstance(value, float) else str(value)
