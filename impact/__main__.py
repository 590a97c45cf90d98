"""Command line: what one impact costs on this machine, and the floor it stands on.

python -m impact benchmark [--impacts N] [--json]
"""

import argparse
import json
import os
import platform
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from . import ContactGeometry, collide, spherocylinder
from ._command import Parser, guarded, leave, told

IMPACT = """\
The theory of rigid impacts: what one impact costs on this machine.

Its functions are for Python (import impact). They take velocities in any unit and give them back in
it; of the lengths of a rod, their ratios alone matter.

  python -m impact benchmark
"""

BENCHMARK = """\
Time per impact, compiled and not, and one pass through memory as the floor.

  python -m impact benchmark
  python -m impact benchmark --impacts 100000 --json
"""

LAWS = ("newton", "poisson", "stronge")
RUNS = 9  # of each; the median counts
BYTES = 9 * 8 + 8 * 8 + 1  # nine numbers in; eight and a regime code out


def _whole(text: str) -> int:
    """A number of impacts."""
    if not text.isascii() or not text.isdigit() or not 1 <= int(text) <= 10**7:
        raise argparse.ArgumentTypeError(f"need a whole number from 1 to 1e7, got {text!r}")
    return int(text)


def random_impacts(n: int, seed: int = 1) -> list[np.ndarray]:
    """Columns of n impacts: velocities and friction log-uniform over six decades, all tilts."""
    rng = np.random.default_rng(seed)
    tilt, length = rng.uniform(-np.pi / 2, np.pi / 2, n), 1 + 10 ** rng.uniform(-2, 1.5, n)
    X, Z, k = spherocylinder(tilt, length)
    sizes = 10 ** rng.uniform(-3, 3, (5, n))
    c_x, c_z, spin, V_z = sizes[:4] * rng.choice([-1, 1], (4, n))
    omega = spin / k
    towards = np.where(c_z - V_z + omega * X < 0, 1.0, -1.0)  # every pair approaches
    moving = [towards * value for value in (c_x, c_z, omega, V_z)]
    return [*moving, X, Z, k, sizes[4], rng.uniform(0, 1, n)]


def _summing(kernel: Any, fastmath: Any = False) -> Callable[..., float]:
    """A loop that calls a scalar kernel and keeps nothing but one sum over all that it gave.

    `fastmath` is that of the loop's own arithmetic; the kernel's bits do not depend on it. A sum
    in the order of the loop keeps a compiler from computing several impacts at once, {"reassoc"}
    lets it.
    """
    from . import _jit

    @_jit.kernel(fastmath=fastmath)
    def run(c_x, c_z, omega, V_z, X, Z, k, mu, epsilon):
        total = 0.0
        for i in range(c_x.size):
            a, b, c, d, e, f, g, h, j = kernel(
                c_x[i], c_z[i], omega[i], V_z[i], X[i], Z[i], k[i], mu[i], epsilon[i]
            )
            total += ((a + b) + (c + d)) + ((e + f) + (g + h)) + j
        return total

    return run


def _same_bits(kernel: Any, other: Any, columns: list[np.ndarray]) -> bool:
    """Whether two scalar kernels give the same bits in every field of every impact."""
    rows = list(zip(*(column[:2000].tolist() for column in columns), strict=True))
    first, second = (np.array([f(*row) for row in rows], float) for f in (kernel, other))
    return first.tobytes() == second.tobytes()


def _machine() -> dict[str, Any]:
    """Processor, versions, threads."""
    import numba

    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        named = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    except OSError:
        named = []
    return {
        "processor": named[0] if named else platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "threads": 1,  # nothing here runs in parallel
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def _once(function: Callable[[], Any]) -> float:
    """Seconds of one call."""
    start = perf_counter()
    function()
    return perf_counter() - start


def _collider(function: Callable, columns: list[np.ndarray], law: str) -> Callable[[], Any]:
    """A call of `function`, with the signature of `collide`."""
    c_x, c_z, omega, V_z, X, Z, k, mu, epsilon = columns
    given = {"geometry": ContactGeometry(X, Z, k), "friction": mu, "restitution": epsilon}
    return lambda: function(c_x, c_z, omega, plate_velocity=V_z, law=law, **given)


def _in_parts(function: Callable, *columns: np.ndarray) -> None:
    """Call a compiled loop on a million impacts at a time: signals are seen between calls."""
    for first in range(0, columns[0].size, 10**6):
        function(*(column[first : first + 10**6] for column in columns))


def _tasks(columns: list[np.ndarray]) -> dict[str, Callable[[], Any]]:
    """What is timed, by name."""
    from . import _handwritten as hand
    from . import compiled

    n = columns[0].size
    results = [np.empty(n, np.int8 if i == 3 else np.float64) for i in range(9)]
    half = np.zeros(BYTES * n // 2 + 1, np.uint8)  # a copy reads it and writes as much
    other = np.empty_like(half)
    kernels = {law: getattr(compiled, f"collide_{law}") for law in LAWS}
    kernels |= {"handwritten": hand.collide, "uncompensated": hand.collide_plain}
    tasks: dict[str, Callable[[], Any]] = {}
    for law in LAWS:
        tasks[f"numpy {law}"] = _collider(collide, columns, law)
        tasks[f"compiled {law}"] = _collider(compiled.collide, columns, law)
        loop = compiled._loop(law)
        tasks[f"loop {law}"] = partial(_in_parts, loop, *columns, *results)
    for name, kernel in kernels.items():
        run = _summing(kernel)
        tasks[f"scalar {name}"] = partial(_in_parts, run, *columns)
    any_order = _summing(compiled.collide_newton, fastmath={"reassoc"})
    tasks["scalar newton, any order"] = partial(_in_parts, any_order, *columns)
    tasks["copy"] = lambda: np.copyto(other, half)
    return tasks


def benchmark(n: int) -> dict[str, Any]:
    """Time everything in turn, `RUNS` times over; numbers per impact, in ns."""
    from tqdm import tqdm

    from . import _handwritten, compiled

    small = [column[:1] for column in random_impacts(1)]
    compiling = {law: _once(_collider(compiled.collide, small, law)) for law in LAWS}
    columns = random_impacts(n)
    tasks = _tasks(columns)
    for task in tasks.values():  # compiles what is left, and touches all memory
        task()
    seconds: dict[str, list[float]] = {name: [] for name in tasks}
    for _ in tqdm(range(RUNS), desc="timing", unit="run", disable=None, leave=False):
        for name, task in tasks.items():
            seconds[name].append(_once(task))
    ns = {name: 1e9 * median(times) / n for name, times in seconds.items()}
    return {
        "impacts": n,
        "runs": RUNS,
        "ns_per_impact": ns,
        "compile_seconds": compiling,
        "million_per_second": {name: 1e3 / time for name, time in ns.items()},
        "generated_over_handwritten": ns["scalar newton"] / ns["scalar handwritten"],
        "loop_over_floor": ns["loop newton"] / ns["copy"],
        "bytes_per_impact": BYTES,
        "same_bits": _same_bits(compiled.collide_newton, _handwritten.collide, columns),
        "machine": _machine(),
    }


def _table(result: dict[str, Any]) -> str:
    """The result as text."""
    ns, rate, machine = (result[key] for key in ("ns_per_impact", "million_per_second", "machine"))
    lines = [
        f"{machine['processor']}, {machine['cores']} cores, {machine['threads']} thread used; "
        f"python {machine['python']}, numpy {machine['numpy']}, numba {machine['numba']}",
        f"{result['impacts']} random impacts, median of {result['runs']} runs",
        f"{'':26}{'ns/impact':>10}{'million/s':>11}",
    ]
    lines += [f"{name:26}{ns[name]:10.2f}{rate[name]:11.1f}" for name in sorted(ns)]
    compiling = ", ".join(f"{law} {s:.1f} s" for law, s in result["compile_seconds"].items())
    lines += [
        f"compile, first call      {compiling} (the first compiles what all share)",
        f"generated/hand-written   {result['generated_over_handwritten']:.2f}, "
        f"{'the same' if result['same_bits'] else 'DIFFERENT'} bits",
        f"loop/copy                {result['loop_over_floor']:.2f}, the copy moving the "
        f"{result['bytes_per_impact']} bytes in and out of an impact",
    ]
    return "\n".join(lines)


def _benchmark(arguments: argparse.Namespace) -> int:
    result = benchmark(arguments.impacts)
    print(json.dumps(result) if arguments.json else _table(result))
    return 0


def _parser() -> Parser:
    parser = Parser(prog="python -m impact", description=IMPACT)
    commands = parser.add_subparsers(dest="command", required=True)
    timing = commands.add_parser("benchmark", **told(BENCHMARK))
    timing.add_argument(
        "--impacts", type=_whole, default=1_000_000, metavar="N", help="at random (default 1000000)"
    )
    timing.add_argument("--json", action="store_true", help="one JSON object on standard output")
    timing.set_defaults(run=_benchmark)
    commands.metavar = " | ".join(commands.choices)
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    arguments = _parser().parse_args(argv)
    return guarded(f"python -m impact {arguments.command}", lambda: arguments.run(arguments))


if __name__ == "__main__":
    leave("python -m impact", main)
