"""Command line of the molecular dynamics.

python -m md impact --tilt-deg 20 --friction 0.4 --restitution 0.65 --c-x 0.5 --c-z -1
python -m md run quasi2d --set rods.count=20 --set box.length=21.5 --periods 100
"""

import argparse
import json
import os
import re
import sys
from math import pi, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:  # a refused argument shall cost no import
    from .laws import Law
    from .runner import Result

EXAMPLE = """\
One soft impact of a rod's lower cap on a plate at rest, without gravity, in reduced units: rod
diameter, rod mass and gravity are 1, velocities are in sqrt(g d), times in sqrt(d/g).

  python -m md impact --tilt-deg 20 --friction 0.4 --restitution 0.65 --c-x 0.5 --c-z -1
  python -m md impact --tilt-deg 60 --c-x 0.5 --c-z -1 --law appendix_a --integrator gear --json
"""


RUN_EXAMPLE = """\
Run a scene: a TOML file, or an example of md/scenes (quasi2d, annulus, single_rod). Lengths are in
rod diameters, times in sqrt(d/g), velocities in sqrt(g d), accelerations in g; only
rods.diameter_cm and plate.frequency_hz are not. Your rods in cm: length = overall length over
diameter.

  python -m md run quasi2d --periods 200
  python -m md run quasi2d --tolerance 0.01            # until the drift is within 1 % of its value
  python -m md run quasi2d --set plate.acceleration=2 --set contacts.plate.law=coulomb --json
  python -m md run quasi2d --set contacts.plate.law=appendix_a --set contacts.plate.restitution=none
  python -m md run mine.toml --periods 10000 --checkpoint mine.npz      # Ctrl-C, and go on later
  python -m md run quasi2d --periods 5 --trajectory row.xyz --frames 24 # for OVITO
"""


SWEEP_EXAMPLE = """\
Run a scene along axes, on all cores, into a store; the same command goes on where it stopped.

  python -m md sweep drift --store drift.db
  python -m md sweep mine.toml --store mine.db --scheduler tcp://host:8786   # a Dask cluster
  python -m md results drift.db --csv drift.csv
"""


class Parser(argparse.ArgumentParser):
    """Bad arguments cost one line on stderr and exit code 2."""

    def __init__(self, *args: Any, **kwargs: Any):
        super().__init__(*args, **kwargs)
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
    if arguments.law == "coulomb" and arguments.tangential_ratio is not None:
        raise ValueError("tangential_ratio has no meaning under coulomb, which has no spring")
    if arguments.integrator == "dop853" and arguments.dt is not None:
        raise ValueError("dt has no meaning under dop853, which chooses its steps: use tolerance")
    if arguments.integrator != "dop853" and arguments.tolerance is not None:
        raise ValueError(f"tolerance has no meaning under {arguments.integrator}: use dt")
    chosen = {name: value for name, value in options.items() if value is not None}
    return LAWS[arguments.law](**chosen)


def _impact(arguments: argparse.Namespace) -> int:
    from .one_rod import Rod, impact

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
        from .runner import finite

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
    from .dial import Tuned, run
    from .scene import load

    if arguments.frames is not None and arguments.trajectory is None:
        raise ValueError("frames has no meaning without trajectory")
    dial = {name: getattr(arguments, name) for name in ("confidence", "floor", "max_seconds")}
    dial = {name: value for name, value in dial.items() if value is not None}
    if arguments.tolerance is None:
        if dial:
            raise ValueError(f"{next(iter(dial))} has no meaning without tolerance")
        dial["periods"] = 200 if arguments.periods is None else arguments.periods
    result = run(
        load(arguments.scene, arguments.set),
        tolerance=arguments.tolerance,
        trajectory=arguments.trajectory,
        frames=arguments.frames or 1,
        checkpoint=arguments.checkpoint,
        progress=not arguments.json,
        **dial,
    )
    if arguments.json:
        print(json.dumps(result.as_dict()))
    else:
        _print_result(result)
    if not result.finished:
        return 130
    return 0 if not isinstance(result, Tuned) or result.accuracy.reached else 1


def _print_result(r: "Result") -> None:
    """What a run measured, for people."""
    from .dial import Tuned, in_words

    unit, n = r.scene.cm_per_s, r.scene.rods.count
    print(f"drift        c_x = {_with_error(r.c_x, r.c_x_stderr)} sqrt(g d)", end="")
    print(f" = {_with_error(r.c_x * unit, r.c_x_stderr * unit)} cm/s")
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
    print(f"{span:12} {r.periods}, of which the first {r.discarded} are not in the means", end="")
    print("" if r.finished else "; interrupted")
    print(
        f"cost         {r.rod_steps:.3g} rod-steps of dt = {r.dt:.3g} ({n} rod{'s' * (n > 1)},",
        end="",
    )
    print(f" {r.steps_per_period} steps each) in {r.run_seconds:.3g} s,", end="")
    print(f" {r.run_seconds / max(r.rod_steps, 1) * 1e9:.3g} ns each; compiled in", end="")
    print(f" {r.compile_seconds:.2g} s")
    if isinstance(r, Tuned):
        print("\n".join(in_words(r)))


def _with_error(value: float, error: float) -> str:
    return f"{value:.4g} +- {error:.2g}" if error == error else f"{value:.4g} (error unknown)"


def _sweep(arguments: argparse.Namespace) -> int:
    from .sweep import execute, load_sweep

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
    from .dial import CALIBRATION
    from .dial.calibration import calibrate
    from .runner import _writable

    path = Path(arguments.out or CALIBRATION)
    _writable("out", path)  # the default is beside the sources, which may be read-only
    found = calibrate(arguments.store, progress=True)
    part = path.with_name(f"{path.name}.part")
    part.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    part.replace(path)
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
    from .store import table, write_csv

    columns, rows = table(arguments.store)
    if arguments.csv:
        write_csv(arguments.csv, columns, rows)
        print(f"{len(rows)} runs written to {arguments.csv}")
        return 0
    brief = [
        *(c for c in columns if _of_scene(c) and len({row.get(c) for row in rows}) > 1),
        *("c_x", "c_x_stderr", "tilt_deg", "periods", "seconds", "error"),
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


_NOT_GIVEN = ("run", "json", "command")
_OF_RESULT = "energy.", "landings.", "merged.", "turned.", "versions."


def _parser() -> Parser:
    from .laws import LAWS
    from .one_rod import INTEGRATORS
    from .scene import keys

    parser = Parser(prog="python -m md", description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(
        dest="command", required=True, metavar="impact | run | sweep | calibrate | results"
    )
    one = commands.add_parser(
        "impact",
        help="one soft impact: velocities, phases, regime, price",
        description=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
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
    many = commands.add_parser(
        "run",
        help="run a scene: drift, tilt, landings, energy",
        description=RUN_EXAMPLE,
        epilog=f"keys and defaults; a part of a scene that is not named is not there:\n{table}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
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
    grid = commands.add_parser(
        "sweep",
        help="many runs along axes, into a store",
        description=SWEEP_EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = grid.add_argument
    add("sweep", help="TOML file: scene, periods, [set], [[axes]]")
    add("--store", required=True, metavar="FILE", help="SQLite file, made if it is not there")
    add("--workers", type=int, default=-1, help="processes (default: one a core)")
    add("--scheduler", metavar="ADDRESS", help="of a Dask cluster, which then runs the points")
    add("--retry", action="store_true", help="run again what failed before")
    add("--json", action="store_true", help="one JSON object on standard output")
    grid.set_defaults(run=_sweep)
    steps = commands.add_parser(
        "calibrate", help="measure anew what --tolerance knows of the step's bias (20 min)"
    )
    steps.add_argument(
        "--store", required=True, metavar="FILE", help="SQLite file, goes on from it"
    )
    steps.add_argument("--out", metavar="FILE", help="default: the one that --tolerance reads")
    steps.set_defaults(run=_calibrate)
    found = commands.add_parser("results", help="table of a store")
    found.add_argument("store", help="SQLite file of a sweep")
    found.add_argument("--csv", metavar="OUT", help="write all columns to a file")
    found.set_defaults(run=_results)
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    try:
        arguments = _parser().parse_args(argv)
        return arguments.run(arguments)
    except (ValueError, TypeError) as error:
        print(f"md: {error}", file=sys.stderr)
        return 2
    except RuntimeError as error:
        print(f"md: {error}", file=sys.stderr)
        return 1
    except MemoryError as error:
        print(f"md: not enough memory: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt as stop:
        print(f"interrupted: {stop}" if str(stop) else "interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        print(f"md: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    code = main()
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(code)
