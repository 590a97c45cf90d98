"""Results as text: one impact, a run of a scene, a sweep, the table of a store."""

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite, isnan, sqrt
from typing import Any

from .accuracy import UNLIKELY
from .measures import wedged_periods
from .scene import Scene, as_dict
from .simulation import Result
from .soft_impact import Impact
from .statistics import FEWEST
from .units import TWINS, in_cm

NOTHING = 1e-6  # of the plate's peak velocity: a slower drift is none
SETTLING = 400  # periods; rods in an annulus rearrange for two hundred (Fig. 5)
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


def scene_text(scene: Scene) -> str:
    """What was there, in cm and Hz."""
    cm = {key: f"{value:.4g}" for key, value in in_cm(as_dict(scene)).items()}
    size, where = f"{cm['rods.length_cm']} by {scene.rods.diameter_cm:.4g} cm", ""
    if scene.box is not None:
        where = f", in a box of {cm['box.length_cm']} cm that repeats"
    if scene.annulus is not None:
        radii = f"{cm['annulus.inner_cm']} and {cm['annulus.outer_cm']}"
        where = f", between cylinders with radii of {radii} cm"
    text = f"rods         {scene.rods.count} of {size}{where}"
    if scene.plate is not None and scene.vibrates:
        gamma = f"{scene.plate.frequency_hz:g} Hz, Gamma = {scene.plate.acceleration:.4g}"
        speed = f"V_0 = {cm['plate.velocity_cm_s']} cm/s"
        text += f"\nplate        {gamma}, amplitude {cm['plate.amplitude_cm']} cm, {speed}"
    return text


def result_text(result: Result) -> str:
    """What a run measured, and what it cost."""
    lines = [*_drift(result), *_touches(result)]
    if energy := result.energy:
        work, change, residual = (energy[name] for name in ("plate_work", "change", "residual"))
        balance = f"gained {change:.3g}, residual {residual:.1e} m g d"
        lost = work - change - residual
        lines.append(f"energy       plate {work:.4g}, lost {lost:.4g}, {balance}")
    return "\n".join([*lines, *_cost(result), *accuracy_lines(result)])


def _with_error(value: float, error: float) -> str:
    return f"{value:.4g}" if isnan(error) else f"{value:.4g} +- {error:.2g}"


def _drift(r: Result) -> list[str]:
    unit = r.scene.cm_per_s
    cm = _with_error(r.c_x * unit, r.c_x_stderr * unit)
    lines = [f"drift        c_x = {_with_error(r.c_x, r.c_x_stderr)} sqrt(g d) = {cm} cm/s"]
    if isnan(r.c_x_stderr):
        why = "rods keep their arrangement: only other starts tell it (start.seed)"
        if r.scene.annulus is None:
            why = f"from {FEWEST * 5 // 4 - 1} periods on one run can tell it"
        lines.append(f"             error unknown: {why}")
    turned = (f", {name.replace('_', ' ')} {k} times" for name, k in r.turned.items() if k)
    tilt = _with_error(r.tilt_deg, r.tilt_stderr_deg)
    return [*lines, f"tilt         {tilt} degrees{''.join(turned)}"]


def _touches(r: Result) -> list[str]:
    if not r.touches or r.touches["per_rod_and_period"]["mean"] <= 0:
        return []
    mean = {name: pair["mean"] for name, pair in r.touches.items()}
    return [
        f"touches      {mean['per_rod_and_period']:.3g} per rod and period: "
        f"slide {mean['slide']:.0%}, slip-stick {mean['slip_stick']:.0%}, slip reversal "
        f"{mean['slip_reversal']:.0%}; pushed by others {mean['pushed_by_others']:.0%}",
        f"at touch     V_z/V_0 = {mean['plate_velocity']:.3g}, restitution "
        f"{mean['restitution']:.3g}, flight {mean['flight_periods']:.3g} and contact "
        f"{mean['contact_periods']:.2g} periods",
    ]


def _cost(r: Result) -> list[str]:
    unit = "periods" if r.scene.vibrates else "sqrt(d/g)"
    seconds = r.periods / r.scene.frequency * r.scene.rods.diameter_cm / r.scene.cm_per_s
    transient = f"of which the first {r.discarded} are not in the means"
    but = " but c_x" if r.accuracy else ""
    ended = "" if r.finished else "; interrupted"
    lines = [f"{unit:12} {r.periods} = {seconds:.4g} s, {transient}{but}{ended}"]
    if r.scene.vibrates and r.accuracy is None:
        if r.settled is False:
            few = "not settled: drift or falls trend behind the transient; ask for more periods"
            lines.append(f"warning      {few}")
        elif r.scene.annulus is not None and r.periods < SETTLING:
            lines.append(f"warning      an annulus needs {SETTLING} periods or more to settle")
    if r.annulus and (share := r.annulus["wedged"]["mean"]) > 0:
        since = f"the plate for {wedged_periods(r.scene):.0f} periods"
        lines.append(f"warning      wedged: {share:.0%} of the rods have not touched {since}")
    n, each = r.scene.rods.count, r.run_seconds / max(r.rod_steps, 1) * 1e9
    steps = f"{r.rod_steps:.3g} rod-steps of dt = {r.dt:.3g} sqrt(d/g)"
    rods = f"{n} rod{'s' * (n > 1)}, {r.steps_per_period} steps each"
    time = f"{r.run_seconds:.3g} s, {each:.3g} ns each; compiled in {r.compile_seconds:.2g} s"
    return [*lines, f"cost         {steps} ({rods}) in {time}"]


def accuracy_lines(result: Result) -> list[str]:
    """Lines on step and error of a run with a tolerance, and on the price of the next digit."""
    a, unit = result.accuracy, result.scene.cm_per_s
    if a is None:
        return []
    verdict = f"accuracy     {a.state if a.state == 'reached' else a.state.upper()}"
    if not isfinite(a.error):
        return [f"{verdict}: ended too early to tell the error"]
    if abs(result.c_x) + a.error < NOTHING * result.scene.plate_speed:
        return [f"{verdict}: nothing drifts; c_x is below {NOTHING:g} of the plate's velocity"]
    size = max(abs(result.c_x), a.floor)
    of = "c_x" if abs(result.c_x) >= a.floor else f"the floor {a.floor:.3g} sqrt(g d)"
    bias = f"its bias is within {a.bias_error / size:.1g}"
    if a.bias_measured:
        taken = f"{a.bias / size:+.2g} +- {a.bias_error / size:.1g}"
        bias = f"its bias {taken}, measured by steps twice as long, is taken off"
    lines = [
        f"{verdict}: {a.tolerance:.3g} of {of} asked for; c_x is within {a.error:.2g} sqrt(g d) = "
        f"{a.error * unit:.2g} cm/s, {a.error / size:.2g} of it, at {a.confidence:.4g} confidence",
        f"step         dt = {result.dt:.3g}, {a.per_contact:.3g} steps a contact; {bias}; "
        f"the statistical error is {a.statistical / size:.2g}",
        f"starts       {a.starts}, {a.made} periods in all, for c_x; all else is of the first",
    ]
    if a.chance < UNLIKELY[result.scene.annulus is not None]:
        several = "they differ: the scene has several states; their scatter counts"
        lines.append(f"             {several}; more --workers tell it better")
    if a.fell:
        unseen = "a decay of the drift that is slower than the run cannot be seen"
        lines.append(f"warning      rods fell over {a.fell} times: {unseen}")
    if a.state == "not settled":
        lines.append("             drift or falls still trend; the error is the change seen")
    if a.state == "not reached" and isfinite(a.needed_seconds):
        lines.append(f"             this would take about {a.needed_seconds:.3g} s of run time")
    if a.error / size > a.tolerance / 10 and isfinite(a.next_digit_seconds):
        dearer = f"{a.tolerance / 10:.3g} would take about {a.next_digit_seconds:.3g} s"
        lines.append(f"next digit   {dearer}")
    return lines


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


def result_json(r: Result) -> dict[str, Any]:
    """A run for JSON: in its own units, and what it takes to read it in cm and s."""
    cm, speed = r.scene.rods.diameter_cm, r.scene.cm_per_s
    period = cm / speed / r.scene.frequency
    units = {"length_cm": cm, "velocity_cm_s": speed, "time_s": cm / speed, "period_s": period}
    return {**r.as_dict(), "units": units, "scene_in_cm": in_cm(as_dict(r.scene))}
