"""Command line of the theory: `python -m impact --help`."""

import json

import click

from .command_line import Commands


@click.group(cls=Commands, name="python -m impact")
@click.version_option(package_name="rod-impact", message="%(package)s %(version)s")
def main() -> None:
    """The theory of rigid impacts: the time of one impact on this machine.

    Its functions are for Python (import impact). They take velocities in any unit and give them
    back in it; of the lengths of a rod, their ratios alone matter.

    \b
    python -m impact benchmark
    """


@main.command()
@click.option(
    "--impacts",
    type=click.IntRange(1, 10**7),
    default=10**6,
    metavar="N",
    help="Number of random impacts, 1 to 1e7.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def benchmark(impacts: int, as_json: bool) -> None:
    """Time per impact, compiled and not.

    \b
    python -m impact benchmark
    python -m impact benchmark --impacts 100000 --json
    """
    from . import benchmark as timing  # late: help needs no Numba

    result = timing.benchmark(impacts)
    print(json.dumps(result) if as_json else timing.table(result))


if __name__ == "__main__":
    main.program()
