"""Command line of the molecular dynamics.

python -m md impact --tilt-deg 20 --friction 0.4 --restitution 0.65 --c-x 0.5 --c-z -1
"""

import argparse
import json
import os
import sys
from math import pi, radians

EXAMPLE = """\
One soft impact of a rod's lower cap on a plate at rest, without gravity, in reduced units: rod
diameter, rod mass and gravity are 1, velocities are in sqrt(g d), times in sqrt(d/g).

  python -m md impact --tilt-deg 20 --friction 0.4 --restitution 0.65 --c-x 0.5 --c-z -1
  python -m md impact --tilt-deg 60 --c-x 0.5 --c-z -1 --law appendix_a --integrator gear --json
"""


class Parser(argparse.ArgumentParser):
    """Bad arguments cost one line on stderr and exit code 2."""

    def error(self, message: str):
        """Print one line and leave."""
        self.exit(2, f"{self.prog}: {message}\n")


def _law(arguments: argparse.Namespace):
    from .laws import LAWS

    options = {"stiffness": arguments.stiffness}
    options |= {name: getattr(arguments, name) for name in ("tangential_ratio", "restitution")}
    if arguments.law == "appendix_a" and arguments.restitution is not None:
        raise ValueError("restitution cannot be chosen under appendix_a, whose damping is fixed")
    if arguments.law == "coulomb" and arguments.tangential_ratio is not None:
        raise ValueError("tangential_ratio has no meaning under coulomb, which has no spring")
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
        tolerance=arguments.tolerance,
    )
    result = hit._asdict()
    if arguments.json:
        given = {key: value for key, value in vars(arguments).items() if key not in _NOT_GIVEN}
        result["dt"] = hit.dt if hit.dt == hit.dt else None
        print(json.dumps({**result, "stiffness": law.normal.stiffness, "arguments": given}))
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


_NOT_GIVEN = ("run", "json", "command")


def _parser() -> Parser:
    from .laws import LAWS
    from .one_rod import INTEGRATORS

    parser = Parser(prog="python -m md", description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True, metavar="impact")
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
    add("--restitution", type=float, help="of a head-on impact (default 0.65)")
    add("--length", type=float, default=9.5, help="rod length, caps included (default 9.5)")
    add("--inertia", choices=("solid", "thin"), default="solid", help="default: solid")
    add("--law", choices=tuple(LAWS), default="coulomb", help="default: coulomb")
    add("--stiffness", type=float, help="k_n in m g/d (default 5e6)")
    add("--tangential-ratio", type=float, help="stiffness of the tangential spring")
    add("--integrator", choices=INTEGRATORS, default="leapfrog", help="default: leapfrog")
    add("--dt", type=float, help="step (default: a hundredth of the contact time)")
    add("--tolerance", type=float, default=1e-13, help="of dop853 (default 1e-13)")
    add("--json", action="store_true", help="one JSON object on standard output")
    one.set_defaults(run=_impact)
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    try:
        arguments = _parser().parse_args(argv)
        return arguments.run(arguments)
    except ValueError as error:
        print(f"md: {error}", file=sys.stderr)
        return 2
    except RuntimeError as error:
        print(f"md: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


if __name__ == "__main__":
    code = main()
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(code)
