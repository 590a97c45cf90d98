"""Command line of the molecular dynamics.

python -m md impact --tilt-deg 20 --friction 0.4 --restitution 0.65 --c-x 0.5 --c-z -1
python -m md run my_rods --set rods.count=20 --set box.length_cm=15
"""

import argparse
import inspect
import json
import os
import re
import signal
import sys
import warnings
from collections.abc import Callable
from itertools import count
from math import isnan, pi, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:  # a refused argument shall cost no import
    from .laws import Law
    from .scene import Scene
    from .simulation import Result

MD = """\
Molecular dynamics of rods on a plate: one impact, a scene, a sweep of scenes.

  python -m md impact --tilt-deg 20 --c-x 0.5 --c-z -1
  python -m md run my_rods --periods 100
"""

IMPACT = """\
One soft impact of a rod's lower cap.

The plate is at rest, gravity is left out. Units are reduced: rod diameter d, rod mass and gravity g
are 1, velocities are in sqrt(g d), times in sqrt(d/g); sqrt(g d) is 25 cm/s for rods of 0.635 cm.

  python -m md impact --tilt-deg 20 --friction 0.4 --restitution 0.65 --c-x 0.5 --c-z -1
  python -m md impact --tilt-deg 60 --c-x 0.5 --c-z -1 --law appendix_a --integrator gear --json
"""

RUN = """\
Run a scene: drift, tilt, landings, energy.

A scene is a TOML file, or an example of md/scenes (quasi2d, annulus, single_rod, my_rods). Lengths
are in rod diameters, times in sqrt(d/g), velocities in sqrt(g d), accelerations in g, or in cm,
cm/s and Hz, by keys that say so: my_rods shows how.

  python -m md run quasi2d --periods 200
  python -m md run quasi2d --tolerance 0.01            # until the drift is within 1 % of its value
  python -m md run my_rods --set rods.length_cm=4 --set plate.amplitude_cm=0.03
  python -m md run quasi2d --set plate.acceleration=2 --set contacts.plate.law=coulomb --json
  python -m md run quasi2d --set contacts.plate.law=appendix_a --set contacts.plate.restitution=none
  python -m md run mine.toml --periods 10000 --checkpoint mine.npz      # Ctrl-C, and go on later
  python -m md run quasi2d --periods 5 --trajectory row.xyz --frames 24 # for OVITO

Exit codes of --tolerance: 0 reached; 3 statistically reached, bias of the step unknown; 4 not
reached. In JSON: accuracy.state, which is "reached", "bias unknown" or "not reached".
"""

KEYS = """\
keys and defaults; a part of a scene that is not named is not there. A key in cm or cm/s stands
instead of the one above it, whose place it takes under --set, and needs rods.diameter_cm beside it,
in the plate's part plate.frequency_hz:
"""

SWEEP = """\
Run a scene along axes, on all cores, into a store.

The same command goes on where it stopped. Keys of axes are those of a scene (md run --help).

  python -m md sweep drift --store drift.db
  python -m md sweep mine.toml --store mine.db --scheduler tcp://host:8786   # a Dask cluster
"""

CALIBRATE = """\
Measure anew what --tolerance knows of the step's bias (20 min).

  python -m md calibrate --store calibration.db
  python -m md calibrate --store calibration.db --out mine.json     # leave the one in use alone
"""

RESULTS = """\
Table of a store: a line a run, with the keys that differ between them.

  python -m md results drift.db
  python -m md results drift.db --cm                   # lengths in cm, velocities in cm/s
  python -m md results drift.db --csv drift.csv        # all columns
"""


def _told(text: str) -> dict[str, Any]:
    """What a command says of itself: one line in the list of commands, all of it in its help."""
    line = text.partition("\n")[0].rstrip(".")
    return {"help": line[0].lower() + line[1:], "description": text}


class Parser(argparse.ArgumentParser):
    """Help as it is written, never in colours; bad arguments cost one line and exit code 2."""

    def __init__(self, **options: Any):
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, **options)
        self.color = False  # Python 3.14 would colour a pipe where FORCE_COLOR is set
        self._negative_number_matcher = re.compile(r"-(\d|\.\d|inf|nan)")  # -1e-3 is no option

    def error(self, message: str) -> NoReturn:
        """Print one line and leave."""
        self.exit(2, f"{self.prog}: {message}\n")


def _law(arguments: argparse.Namespace) -> "Law":
    from .laws import LAWS

    options = {"stiffness": arguments.stiffness}
    options |= {name: getattr(arguments, name) for name in ("tangential_ratio", "restitution")}
    if arguments.law == "appendix_a" and arguments.restitution is not None:
        raise ValueError("restitution cannot be chosen under appendix_a, whose damping is fixed")
    if arguments.integrator == "dop853" and arguments.dt is not None:
        raise ValueError("dt has no meaning under dop853, which chooses its steps: use tolerance")
    if arguments.integrator != "dop853" and arguments.tolerance is not None:
        raise ValueError(f"tolerance has no meaning under {arguments.integrator}: use dt")
    chosen = {name: value for name, value in options.items() if value is not None}
    make = LAWS[arguments.law]
    for name in chosen:
        if name not in inspect.signature(make).parameters:
            raise ValueError(f"{name} has no meaning under {arguments.law}")
    return make(**chosen)


def _impact(arguments: argparse.Namespace) -> int:
    from .soft_impact import Rod, impact

    tilt_deg = arguments.tilt_deg
    if not -90 <= tilt_deg <= 90:
        raise ValueError(f"tilt-deg must be between -90 and 90, got {tilt_deg:g}")
    law = _law(arguments)
    hit = impact(
        pi / 2 * (tilt_deg / 90) if abs(tilt_deg) == 90 else radians(tilt_deg),
        arguments.c_x,
        arguments.c_z,
        arguments.omega,
        friction=arguments.friction,
        rod=Rod(arguments.length, arguments.inertia),
        law=law,
        integrator=arguments.integrator,
        dt=arguments.dt,
        tolerance=arguments.tolerance or 1e-13,
    )
    result = hit._asdict()
    if arguments.json:
        from .simulation import finite

        given = {key: value for key, value in vars(arguments).items() if key not in _NOT_GIVEN}
        result |= {"stiffness": law.normal.stiffness, "arguments": given}
        print(json.dumps(finite(result)))
        return 0
    print(f"regime       {hit.regime}")
    print(f"c_x  c_z     {hit.c_x:.6g}  {hit.c_z:.6g}   sqrt(g d)")
    print(f"omega        {hit.omega:.6g}   sqrt(g/d)")
    print(f"restitution  {hit.restitution:.6g}   measured, -v_f/v_0")
    parts = "  ".join(f"{name} {time:.4g}" for name, time in hit.phases.items() if time)
    print(f"phases       {parts}   of {hit.contact_time:.4g} sqrt(d/g)")
    print(f"max overlap  {hit.max_overlap:.4g} d")
    by = "evaluations" if hit.dt != hit.dt else f"steps of {hit.dt:.3g}"
    print(f"cost         {hit.steps} {by}, {hit.seconds * 1e6:.3g} microseconds")
    print(f"law          {law.name}, k_n = {law.normal.stiffness:g} m g/d, {arguments.integrator}")
    return 0


def _run(arguments: argparse.Namespace) -> int:
    from .accuracy import run
    from .files import NotWritten, distinct
    from .scene import load

    written = {name: getattr(arguments, name) for name in ("trajectory", "checkpoint")}
    distinct(scene=arguments.scene, **written)
    if arguments.frames is not None and arguments.trajectory is None:
        raise ValueError("frames has no meaning without trajectory")
    frames = 1 if arguments.frames is None else arguments.frames
    chosen = {name: getattr(arguments, name) for name in ("confidence", "floor", "max_seconds")}
    chosen = {name: value for name, value in chosen.items() if value is not None}
    if arguments.tolerance is None:
        if chosen:
            raise ValueError(f"{next(iter(chosen))} has no meaning without tolerance")
        chosen["periods"] = 200 if arguments.periods is None else arguments.periods
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotWritten)  # said after the result
        result = run(
            load(arguments.scene, arguments.set),
            tolerance=arguments.tolerance,
            frames=frames,
            progress=not arguments.json,
            **written,
            **chosen,
        )
    if arguments.json:
        print(json.dumps(result.as_dict() | _in_cm(result)))
    else:
        _print_scene(result.scene)
        _print_result(result)
    if result.unwritten:
        raise OSError("; ".join(result.unwritten))
    if not result.finished:
        return 130
    return _ENDS[result.accuracy.state] if result.accuracy else 0


def _in_cm(result: "Result") -> dict[str, Any]:
    """For JSON, what a result in its own units is in cm and s."""
    from .scene import as_dict
    from .simulation import finite
    from .units import in_cm

    cm, speed = result.scene.rods.diameter_cm, result.scene.cm_per_s
    period = cm / speed / result.scene.frequency
    units = {"length_cm": cm, "velocity_cm_s": speed, "time_s": cm / speed, "period_s": period}
    error = {"c_x_stderr_cm_s": result.c_x_stderr * speed}
    return finite(error) | {"units": units, "scene_in_cm": in_cm(as_dict(result.scene))}


def _print_scene(scene: "Scene") -> None:
    """What was there, in cm and Hz."""
    from .scene import as_dict
    from .units import in_cm

    cm = {key: f"{value:.4g}" for key, value in in_cm(as_dict(scene)).items()}
    print(f"rods         {scene.rods.count} of {cm['rods.length_cm']}", end="")
    print(f" by {scene.rods.diameter_cm:.4g} cm", end="")
    if scene.box is not None:
        print(f", in a box of {cm['box.length_cm']} cm that repeats", end="")
    if scene.annulus is not None:
        radii = f"{cm['annulus.inner_cm']} and {cm['annulus.outer_cm']}"
        print(f", between cylinders with radii of {radii} cm", end="")
    print()
    if scene.plate is not None and scene.vibrates:
        print(f"plate        {scene.plate.frequency_hz:g} Hz, Gamma = ", end="")
        print(f"{scene.plate.acceleration:.4g}, amplitude {cm['plate.amplitude_cm']} cm,", end="")
        print(f" V_0 = {cm['plate.velocity_cm_s']} cm/s")


def _print_result(r: "Result") -> None:
    """What a run measured, for people."""
    from .accuracy import in_words
    from .statistics import FEWEST, transient

    unit, n = r.scene.cm_per_s, r.scene.rods.count
    print(f"drift        c_x = {_with_error(r.c_x, r.c_x_stderr)} sqrt(g d)", end="")
    print(f" = {_with_error(r.c_x * unit, r.c_x_stderr * unit)} cm/s")
    if isnan(r.c_x_stderr):
        enough = next(n for n in count(FEWEST) if n - transient(n) >= FEWEST)
        why = f"from {enough} periods on one run can tell it"
        if r.scene.annulus is not None:
            why = "rods keep their arrangement: only other starts tell it (start.seed)"
        print(f"             error unknown: {why}")
    print(f"tilt         {_with_error(r.tilt_deg, r.tilt_stderr_deg)} degrees", end="")
    print("".join(f", {name.replace('_', ' ')} {k} times" for name, k in r.turned.items() if k))
    if r.landings and r.landings["per_rod_and_period"]["mean"] > 0:
        mean = {name: pair["mean"] for name, pair in r.landings.items()}
        print(f"landings     {mean['per_rod_and_period']:.3g} per rod and period", end="")
        if "slide" in mean:  # landings are told one by one in the plane alone
            print(f": slide {mean['slide']:.0%}, slip-stick {mean['slip_stick']:.0%},", end="")
            print(f" slip reversal {mean['slip_reversal']:.0%};", end="")
            print(f" not isolated {mean['not_isolated']:.0%}", end="")
        print(f"\nat landing   V_z/V_0 = {mean['plate_velocity']:.3g}", end="")
        if "slide" in mean:
            print(f", restitution {mean['restitution']:.3g},", end="")
            print(f" flight {mean['flight_periods']:.3g}", end="")
            print(f" and contact {mean['contact_periods']:.2g} periods", end="")
        print()
    if r.energy:
        lost = sum(v for k, v in r.energy.items() if k not in ("plate_work", "change", "residual"))
        print(f"energy       plate {r.energy['plate_work']:.4g}, lost {lost:.4g},", end="")
        print(f" gained {r.energy['change']:.3g}, residual {r.energy['residual']:.1e} m g d")
    span = "periods" if r.scene.vibrates else "sqrt(d/g)"  # where nothing moves
    seconds = r.periods / r.scene.frequency * r.scene.rods.diameter_cm / unit
    print(f"{span:12} {r.periods} = {seconds:.4g} s, of which the first {r.discarded}", end="")
    print(" are not in the means", end="")
    print("" if r.finished else "; interrupted")
    if r.scene.annulus is not None and r.periods < _SETTLING:
        print(f"warning      not equilibrated: an annulus needs {_SETTLING} periods or more")
    print(f"cost         {r.rod_steps:.3g} rod-steps of dt = {r.dt:.3g} sqrt(d/g)", end="")
    print(f" ({n} rod{'s' * (n > 1)},", end="")
    print(f" {r.steps_per_period} steps each) in {r.run_seconds:.3g} s,", end="")
    print(f" {r.run_seconds / max(r.rod_steps, 1) * 1e9:.3g} ns each; compiled in", end="")
    print(f" {r.compile_seconds:.2g} s")
    for line in in_words(r):
        print(line)


def _with_error(value: float, error: float) -> str:
    return f"{value:.4g}" if isnan(error) else f"{value:.4g} +- {error:.2g}"


def _sweep(arguments: argparse.Namespace) -> int:
    from .files import distinct
    from .sweep import execute, load_sweep

    distinct(sweep=arguments.sweep, store=arguments.store)
    tally = execute(
        load_sweep(arguments.sweep),
        arguments.store,
        workers=arguments.workers,
        scheduler=arguments.scheduler,
        retry=arguments.retry,
        progress=not arguments.json,
    )
    if arguments.json:
        print(json.dumps(vars(tally)))
        return 0
    same = "" if tally.distinct == tally.points else f", {tally.distinct} of them different"
    print(f"points    {tally.points}{same}; {tally.there} in the store before")
    print(f"computed  {tally.computed}, failed {tally.failed}", end="")
    print(f", in {tally.seconds:.3g} s ({tally.run_seconds:.3g} s of runs)")
    return 0


def _calibrate(arguments: argparse.Namespace) -> int:
    from .accuracy import CALIBRATION
    from .calibration import calibrate, is_calibration
    from .files import distinct, replacing, writable

    path = Path(arguments.out or CALIBRATION)  # beside the sources, perhaps read-only
    distinct(store=arguments.store, out=path)
    writable("out", path, is_calibration, "one of a calibration")
    found = calibrate(arguments.store, progress=True)
    with replacing(path) as part:
        part.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(
        f"order     {found['order']:.3g} +- {found['order_error']:.2g}, chi^2 a degree of freedom",
        end="",
    )
    print(f" {found['chi_squared']:.3g}")
    print(f"scale     {found['scale']:.3g}, bias at ten steps a contact; largest of the scenes:")
    for name, s, error in zip(found["scenes"], found["scales"], found["scale_errors"], strict=True):
        print(f"  {name:22} {s:+.4f} +- {error:.4f}")
    print(f"written   {path}")
    return 0


def _results(arguments: argparse.Namespace) -> int:
    from .files import distinct
    from .store import table, write_csv
    from .units import TWINS

    beside = {f"store{end}": f"{arguments.store}{end}" for end in ("", "-wal", "-shm", "-journal")}
    distinct(**beside, csv=arguments.csv)
    columns, rows = table(arguments.store)
    if arguments.csv is not None:
        write_csv(arguments.csv, columns, rows)
        print(f"{len(rows)} runs written to {arguments.csv}")
        return 0
    drift, other = ["c_x", "c_x_stderr"], set(TWINS)
    if arguments.cm:
        drift, other = [f"{name}_cm_s" for name in drift], {twin.key for twin in TWINS.values()}
    of_scene = (c for c in columns if _of_scene(c) and c not in other)
    brief = [
        *(c for c in of_scene if len({row.get(c) for row in rows}) > 1),
        *(*drift, "tilt_deg", "periods", "seconds", "accuracy.state", "error"),
    ]
    brief = [c for c in brief if any(row.get(c) is not None for row in rows)]
    cells = [brief, *([_cell(row.get(c)) for c in brief] for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for line in cells:
        print("  ".join(cell.rjust(w) for cell, w in zip(line, widths, strict=True)))
    return 0


def _of_scene(column: str) -> bool:
    return "." in column and not column.startswith(_OF_RESULT)


def _cell(value: object) -> str:
    return "" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)


_SETTLING = 400  # periods; rods in an annulus rearrange for two hundred (Fig. 5)
_ENDS = {"reached": 0, "bias unknown": 3, "not reached": 4}  # exit codes of --tolerance
_NOT_GIVEN = ("run", "json", "command")
_OF_RESULT = "accuracy.", "energy.", "landings.", "merged.", "turned.", "versions."


def _parser() -> Parser:
    from .laws import LAWS
    from .scene import keys
    from .soft_impact import INTEGRATORS

    parser = Parser(prog="python -m md", description=MD)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("impact", **_told(IMPACT))
    add = one.add_argument
    add("--tilt-deg", type=float, required=True, help="from the vertical, -90 to 90")
    add("--c-x", type=float, required=True, help="horizontal velocity of the centre before")
    add("--c-z", type=float, required=True, help="vertical velocity of the centre before")
    add("--omega", type=float, default=0.0, help="angular velocity before (default 0)")
    add(
        "--friction",
        type=float,
        default=0.3,
        help="Coulomb coefficient (default 0.3; inf: no slip)",
    )
    add(
        "--restitution",
        type=float,
        help="of a head-on impact, 0 or 1e-6 to 1 (default 0.65); appendix_a has its own",
    )
    add("--length", type=float, default=9.5, help="rod length, caps included (default 9.5)")
    add("--inertia", choices=("solid", "thin"), default="solid", help="default: solid")
    add("--law", choices=tuple(LAWS), default="coulomb", help="default: coulomb")
    add("--stiffness", type=float, help="k_n in m g/d (default 5e6)")
    add("--tangential-ratio", type=float, help="stiffness of the tangential spring")
    add("--integrator", choices=INTEGRATORS, default="leapfrog", help="default: leapfrog")
    add("--dt", type=float, help="step (default: a hundredth of the contact time)")
    add("--tolerance", type=float, help="of dop853 (default 1e-13)")
    add("--json", action="store_true", help="one JSON object on standard output")
    one.set_defaults(run=_impact)
    known = keys()
    width = max(len(key) for key, _ in known)
    table = "\n".join(f"  {key:{width}}  {default}" for key, default in known)
    many = commands.add_parser("run", **_told(RUN), epilog=f"{KEYS}{table}")
    add = many.add_argument
    add("scene", help="TOML file, or the name of an example")
    add(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="change a key of the scene; VALUE none takes it out",
    )
    length = many.add_mutually_exclusive_group()
    length.add_argument("--periods", type=int, help="of the plate (default 200)")
    length.add_argument(
        "--tolerance",
        type=float,
        metavar="R",
        help="choose step and length so that the drift is within R of its value: 0.01 for 1 %%",
    )
    add("--confidence", type=float, help="of the interval that --tolerance asks for (0.95)")
    add("--floor", type=float, help="drifts below it count as this fast (a twentieth of V_0)")
    add("--max-seconds", type=float, help="most that --tolerance may take (600)")
    add("--trajectory", metavar="FILE", help="write extended XYZ, for OVITO")
    add("--frames", type=int, help="of the trajectory, per period (default 1)")
    add("--checkpoint", metavar="FILE", help="save here; go on from it if it is there")
    add("--json", action="store_true", help="one JSON object on standard output")
    many.set_defaults(run=_run)
    grid = commands.add_parser("sweep", **_told(SWEEP))
    add = grid.add_argument
    add(
        "sweep",
        help="TOML file, or the name of an example (drift): scene, periods, [set], [[axes]]",
    )
    add("--store", required=True, metavar="FILE", help="SQLite file, made if it is not there")
    add("--workers", type=int, default=-1, help="processes (default: one a core)")
    add("--scheduler", metavar="ADDRESS", help="of a Dask cluster, which then runs the points")
    add("--retry", action="store_true", help="run again what failed before")
    add("--json", action="store_true", help="one JSON object on standard output")
    grid.set_defaults(run=_sweep)
    steps = commands.add_parser("calibrate", **_told(CALIBRATE))
    add = steps.add_argument
    add("--store", required=True, metavar="FILE", help="SQLite file, goes on from it")
    add("--out", metavar="FILE", help="default: the one that --tolerance reads")
    steps.set_defaults(run=_calibrate)
    found = commands.add_parser("results", **_told(RESULTS))
    found.add_argument("store", help="SQLite file of a sweep")
    found.add_argument("--cm", action="store_true", help="in cm and cm/s")
    found.add_argument("--csv", metavar="OUT", help="write all columns to a file, in both units")
    found.set_defaults(run=_results)
    commands.metavar = " | ".join(commands.choices)
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    program = "python -m md"
    try:
        arguments = _parser().parse_args(argv)
        program += f" {arguments.command}"
        return arguments.run(arguments)
    except (ValueError, TypeError) as error:
        said, code = str(error), 2
    except RuntimeError as error:
        said, code = str(error), 1
    except MemoryError as error:
        said, code = f"not enough memory: {error}", 1
    except KeyboardInterrupt as stop:
        said, code = f"interrupted: {stop}" if str(stop) else "interrupted", 130
    except BrokenPipeError:  # the reader has seen enough
        return 0
    except OSError as error:
        said, code = f"cannot write: {error}", 2
    print(f"{program}: {said}", file=sys.stderr)
    return code


def leave(main: Callable[[], int]) -> NoReturn:
    """End the process; output that nobody takes any more is dropped without a traceback."""
    if sys.stdout is None:
        print("python -m md: cannot write: standard output is closed", file=sys.stderr)
        sys.exit(2)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # it is Ctrl-C
    warnings.showwarning = lambda text, *_: print(f"python -m md: {text}", file=sys.stderr)
    try:
        code = main()
    except SystemExit as end:  # after help, or bad arguments
        code = int(end.code or 0)
    try:
        sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            print(f"python -m md: cannot write: {error}", file=sys.stderr)
            code = code or 2
    sys.exit(code)


if __name__ == "__main__":
    leave(main)
