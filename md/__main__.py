"""Command line of the molecular dynamics, `python -m md --help`, and its results as text."""

import json
import signal
import sys
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from math import isnan, radians, sqrt
from operator import itemgetter
from typing import Any

import click

from . import accuracy, soft_impact
from .cache import deferred
from .command_line import Commands
from .domains import InputError
from .laws import LAWS, Law, Rod
from .result import finite, result_json
from .scene import keys, load, options_of
from .soft_impact import Impact
from .store import table, write_csv
from .units import TWINS

_OF_RESULT = "accuracy.", "energy.", "landings.", "touches.", "versions."


def impact_text(hit: Impact, law: str) -> str:
    """Text of one impact, in reduced units; `law` is said in words."""
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
    """Text of what a sweep has computed."""
    same = "" if tally.distinct == tally.points else f", {tally.distinct} of them different"
    time = f"{tally.seconds:.3g} s ({tally.run_seconds:.3g} s of runs)"
    return (
        f"points    {tally.points}{same}; {tally.there} in the store before\n"
        f"computed  {tally.computed}, failed {tally.failed}, in {time}"
    )


def search_json(found: Any) -> dict[str, Any]:
    """A search for JSON: points with misfits, best first; estimates; data and predictions."""
    search, told, best = found.search, found.estimates, found.misfits.argmin()
    runs = zip(found.parts.tolist(), found.misfits.tolist(), strict=True)
    points = [{**search.values(parts), "misfit": misfit} for parts, misfit in runs]
    targets = []
    for i, target in enumerate(search.targets):
        table = {**target.place, **target._asdict(), "best": float(found.results[best, i])}
        del table["place"]
        if told.results:
            table["predicted"], table["uncertainty"] = told.results[i]
        targets.append(table)
    return {
        "points": sorted(points, key=itemgetter("misfit")),
        "estimates": {name: estimate._asdict() for name, estimate in told.parameters.items()},
        "correlation": told.correlation.tolist(),
        "least_misfit": told.misfit,
        "targets": targets,
        "tally": vars(found.tally),
    }


def search_text(found: Any) -> str:
    """Text of a search: best points, estimates, and the results at the data."""
    told = search_json(found)
    data = sum(not isnan(target.value) for target in found.search.targets)
    lines = [tally_text(found.tally), "", "best points", *_table(told["points"][:8])]
    if estimates := found.estimates.parameters:
        rows = []
        for parameter in found.search.parameters:
            value, error = estimates[parameter.name]
            note = f"reaches an end of its range, {parameter.low:g} to {parameter.high:g}"
            if parameter.low + 2 * error < value < parameter.high - 2 * error:
                note = ""
            rows.append({"parameter": parameter.name, "value": value, "error": error, "note": note})
        lines += ["", "estimates, with standard errors", *_table(rows)]
        drawn = found.misfits.min()
        lines.append(
            f"least misfit  {told['least_misfit']:.3g}, of {data} data; of a point run {drawn:.3g}"
        )
        if drawn > data + 4 * sqrt(2 * data):
            lines.append(
                "warning: no point fits the data; the errors hold only where longer runs, more "
                "starts or more points give one"
            )
    else:
        lines += ["", "too few points near the best one for estimates: more points or rounds"]
    return "\n".join([*lines, "", "data", *_table(told["targets"])])


def _table(rows: Sequence[Mapping], names: Iterable[str] = ()) -> list[str]:
    """Lines of a table with the columns of these names, or those of the first row."""
    columns = []
    for name in names or rows[0]:
        cells = [name, *(_cell(row.get(name)) for row in rows)]
        width = max(map(len, cells))
        columns.append([cell.rjust(width) for cell in cells])
    return [*map("  ".join, zip(*columns, strict=True))]


def store_text(columns: Iterable[str], rows: Sequence[dict[str, Any]]) -> str:
    """Text of a store, a line a run: keys that differ, in the scene's own units, and the drift."""
    of_scene = (c for c in columns if "." in c and not c.startswith(_OF_RESULT) and c not in TWINS)
    differing = [c for c in of_scene if len({row.get(c) for row in rows}) > 1]
    brief = [*differing, "c_x", "c_x_stderr", "c_x_cm_s", "tilt_deg", "periods", "seconds"]
    brief += ["accuracy.state", "error"]
    brief = [c for c in brief if any(row.get(c) is not None for row in rows)]
    return "\n".join(_table(rows, brief))


def _cell(value: object) -> str:
    if value is None or value != value:  # nan: a datum that is asked for
        return ""
    return f"{value:.5g}" if isinstance(value, float) else str(value)


_WIDTH = max(map(len, dict(keys())))
_KEYS = """\b
Keys and their defaults; what a scene does not name is not there. A key in cm
or cm/s takes the place of the one above it, also under --set; it needs
rods.diameter_cm, and in the plate's part plate.frequency_hz:
""" + "\n".join(f"  {key:{_WIDTH}}  {default}" for key, default in keys())
_number = partial(click.option, type=float)
_dumps = partial(json.dumps, allow_nan=False)
_json = click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")


def _many_runs(command: Callable) -> Callable:
    """Add the options of a command that makes many runs, into a store."""
    for option in (
        _json,
        click.option("--retry", is_flag=True, help="Run again what failed before."),
        click.option("--scheduler", metavar="ADDRESS", help="Of a Dask cluster, for the runs."),
        click.option("--workers", default=-1, help="Processes; -1: one a core."),
        click.option("--store", required=True, metavar="FILE", help="SQLite, made if missing."),
    ):
        command = option(command)
    return command


@click.group(cls=Commands, name="python -m md", no_args_is_help=False)
@click.version_option(package_name="rod-impact", message="%(package)s %(version)s")
def main() -> None:
    """Molecular dynamics of rods on a plate: one impact, a scene, a sweep of scenes.

    \b
    python -m md impact --tilt-deg 20 --c-x 0.5 --c-z -1
    python -m md run my_rods --periods 100
    """


@main.command()
@click.option(
    "--tilt-deg", type=click.FloatRange(-90, 90), required=True, help="From the vertical."
)
@_number("--c-x", required=True, help="Horizontal velocity of the centre before.")
@_number("--c-z", required=True, help="Vertical velocity of the centre before.")
@_number("--omega", default=0.0, help="Angular velocity before.")
@_number("--friction", default=0.3, help="Coulomb coefficient; inf: no slip.")
@_number(
    "--restitution",
    help="Of a head-on impact, 0 or 1e-6 to 1 (default 0.65); appendix_a has its own.",
)
@_number("--length", default=9.5, help="Of the rod, caps included.")
@click.option(
    "--inertia", type=click.Choice(["solid", "thin"]), default="solid", help="Of the rod."
)
@click.option(
    "--ends",
    type=click.Choice(["round", "flat"]),
    default="round",
    help="Of the rod; a flat one lands on a corner.",
)
@click.option("--law", type=click.Choice([*LAWS]), default="coulomb", help="Of the contact.")
@_number("--stiffness", help="k_n in m g/d^(3/2) (default 5e6).")
@_number("--tangential-ratio", help="Stiffness of the tangential spring over k_n.")
@click.option(
    "--integrator",
    type=click.Choice(soft_impact.INTEGRATORS),
    default="verlet",
    help="The steps of rows, or every switch located (dop853).",
)
@_number("--dt", help="Step (default a hundredth of the contact time, or less to be stable).")
@_number("--tolerance", help="Of dop853 (default 1e-13).")
@_json
def impact(as_json: bool, **given: Any) -> None:
    """One soft impact of a rod's lower cap or corner.

    The plate is at rest, gravity is left out. Units are reduced: rod diameter d, rod mass and
    gravity g are 1, velocities are in sqrt(g d), times in sqrt(d/g); sqrt(g d) is 25 cm/s for rods
    of 0.635 cm.

    \b
    python -m md impact --tilt-deg 20 --friction 0.4 --restitution 0.65 --c-x 0.5 --c-z -1
    python -m md impact --tilt-deg 60 --c-x 0.5 --c-z -1 --law appendix_a --json
    """
    law = _law(given)
    hit = soft_impact.impact(
        radians(given["tilt_deg"]),
        rod=Rod(**_given(given, "length", "inertia", "ends")),
        law=law,
        **_given(given, "c_x", "c_z", "omega", "friction", "integrator", "dt", "tolerance"),
    )
    if as_json:
        found = hit._asdict() | {"stiffness": law.normal.stiffness, "arguments": given}
        print(_dumps(finite(found)))
    else:
        words = f"{law.name}, k_n = {law.normal.stiffness:g} m g/d^(3/2), {given['integrator']}"
        print(impact_text(hit, words))


def _given(options: dict[str, Any], *names: str) -> dict[str, Any]:
    """Options of these names that were given."""
    return {name: options[name] for name in names if options[name] is not None}


def _law(given: dict[str, Any]) -> Law:
    """Make the contact law of the options given; options that it does not take are refused."""
    law = given["law"]
    options = _given(given, "stiffness", "tangential_ratio", "restitution")
    for name in options.keys() - options_of(law):
        raise InputError(f"{name} has no meaning under {law}, got {options[name]:g}")
    return LAWS[law](**options)


@main.command(epilog=_KEYS)
@click.argument("scene")
@click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change a key of the scene; VALUE none takes it out, box=none a whole part.",
)
@click.option("--periods", type=int, help="Of the plate (default 200); not with --tolerance.")
@_number(
    "--tolerance",
    metavar="R",
    help="Choose step and length so that the drift is within R of its value: 0.01 for 1 %.",
)
@_number("--confidence", help="Of the interval that --tolerance asks for (default 0.95).")
@_number(
    "--floor", help="Slower drifts count as this fast, in sqrt(g d) (default a twentieth of V_0)."
)
@_number(
    "--max-seconds",
    help="Longest time that --tolerance may take (default 600), but for the first 320 periods, in "
    "an annulus 640, which are made in any case.",
)
@click.option("--workers", type=int, help="With --tolerance: starts at once (default 2).")
@click.option(
    "--measure-bias",
    is_flag=True,
    help="With --tolerance: measure what the step does to the drift, by steps twice as long.",
)
@click.option("--trajectory", metavar="FILE", help="Write extended XYZ, for OVITO and ASE.")
@click.option("--frames", type=int, help="Of the trajectory, per period (default 1).")
@click.option("--checkpoint", metavar="FILE", help="Save here; go on from it if it is there.")
@_json
def run(scene: str, changes: tuple[str, ...], as_json: bool, **given: Any) -> int:
    """Run a scene: drift, tilt, landings, energy.

    SCENE is a TOML file, or an example of md/scenes (quasi2d, annulus, single_rod, my_rods).
    Lengths are in rod diameters, times in sqrt(d/g), velocities in sqrt(g d), accelerations in g,
    or in cm, cm/s and Hz, by keys that say so: my_rods shows how.

    \b
    python -m md run quasi2d --periods 200
    python -m md run quasi2d --tolerance 0.01         # until the drift is within 1 % of its value
    python -m md run annulus --tolerance 0.03 --workers 4  # of four arrangements of the rods
    python -m md run my_rods --set rods.length_cm=4 --set plate.amplitude_cm=0.03
    python -m md run quasi2d --set plate.acceleration=2 --set contacts.plate.law=coulomb --json
    python -m md run quasi2d --set contacts.plate.law=appendix_a --set contacts.plate.restitution=none
    python -m md run mine.toml --periods 10000 --checkpoint mine.npz       # Ctrl-C, and go on later
    python -m md run quasi2d --periods 5 --trajectory row.xyz --frames 24  # for OVITO

    Exit codes of --tolerance: 0 reached; 4 not reached, or not settled. In JSON: accuracy.state,
    which is "reached", "not reached" or "not settled".
    """  # noqa: E501  (an example)
    result = accuracy.run(load(scene, changes), progress=not as_json, **_given(given, *given))
    print(_dumps(result_json(result)) if as_json else result)
    if not result.finished:
        return 130
    return 0 if result.accuracy is None or result.accuracy.state == "reached" else 4


@main.command()
@click.argument("sweep")
@_many_runs
def sweep(sweep: str, store: str, as_json: bool, **how: Any) -> None:
    """Run a scene along axes, on all cores, into a store.

    SWEEP is a TOML file, or the name of an example (drift), with scene, periods, [set] and
    [[axes]]; the keys of axes are those of a scene (md run --help). The same command goes on where
    it stopped.

    \b
    python -m md sweep drift --store drift.db
    python -m md sweep mine.toml --store mine.db --scheduler tcp://host:8786   # a Dask cluster
    """
    with deferred():  # imports of others lose signals
        from . import sweep as sweeps  # late: help needs no joblib

    tally = sweeps.execute(sweeps.load_sweep(sweep), store, progress=not as_json, **how)
    print(_dumps(vars(tally)) if as_json else tally_text(tally))


@main.command()
@click.argument("search")
@_many_runs
def search(search: str, store: str, as_json: bool, **how: Any) -> None:
    """Find the parameters of a scene that give what was measured.

    SEARCH is a TOML file, or the name of an example (friction), with scene, parameters and data
    (help(md.search)). The same command goes on where it stopped.

    \b
    python -m md search friction --store fit.db
    python -m md search mine.toml --store mine.db --json
    """
    with deferred():  # imports of others lose signals
        from . import search as searches  # late: help needs no joblib

    found = searches.search(searches.load_search(search), store, progress=not as_json, **how)
    print(_dumps(finite(search_json(found))) if as_json else search_text(found))


@main.command()
@click.argument("store")
@click.option(
    "--csv", metavar="OUT", help="Write all columns to a file, keys and drift in both units."
)
def results(store: str, csv: str | None) -> None:
    """Table of a store: a line a run, with what differs.

    STORE is the SQLite file of a sweep. Keys are shown in units of d and g, whatever an axis gave.

    \b
    python -m md results drift.db
    python -m md results drift.db --csv drift.csv   # all columns; keys also in cm and cm/s
    """
    columns, rows = table(store)
    if csv is None:
        print(store_text(columns, rows) if rows else "no runs yet")
    else:
        write_csv(csv, columns, rows)
        print(f"{len(rows)} runs written to {csv}")


if __name__ == "__main__":
    warnings.showwarning = lambda text, *_: print(f"{main.name}: {text}", file=sys.stderr)
    main.program(signal.default_int_handler)  # which `md.run` takes over
