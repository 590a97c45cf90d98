"""Time per impact on this machine: NumPy and the compiled map."""

import os
import platform
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter
from timeit import repeat
from typing import Any

import numba
import numpy as np

from . import collision, compiled
from ._impacts import Impacts
from .geometry import spherocylinder

RUNS = 9  # of each; the median counts


def random_impacts(n: int, seed: int = 1) -> Impacts:
    """Arrays of n impacts: velocities and friction log-uniform over six decades, all tilts."""
    rng = np.random.default_rng(seed)
    tilt, length = rng.uniform(-np.pi / 2, np.pi / 2, n), 1 + 10 ** rng.uniform(-2, 1.5, n)
    X, Z, k = spherocylinder(tilt, length)
    sizes = 10 ** rng.uniform(-3, 3, (5, n))
    c_x, c_z, spin, V_z = sizes[:4] * rng.choice([-1, 1], (4, n))
    omega = spin / k
    towards = np.where(c_z - V_z + omega * X < 0, 1.0, -1.0)  # every pair approaches
    c_x, c_z, omega, V_z = (towards * value for value in (c_x, c_z, omega, V_z))
    return Impacts(c_x, c_z, omega, V_z, X, Z, k, sizes[4], rng.uniform(0, 1, n))


def machine() -> dict[str, Any]:
    """Processor, cores and versions of this machine."""
    cpuinfo = Path("/proc/cpuinfo")
    lines = cpuinfo.read_text(encoding="utf-8").splitlines() if cpuinfo.is_file() else []
    named = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return {
        "processor": named[0] if named else platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "numba": numba.__version__,
    }


def benchmark(n: int) -> dict[str, Any]:
    """Median time of an impact over `RUNS` passes, in ns, and time to compile the laws, in s.

    Parameters
    ----------
    n : number of random impacts in a pass
    """
    impacts, begin, tasks = random_impacts(n), perf_counter(), {}
    for law in compiled.KERNELS:
        tasks[f"numpy {law}"] = partial(impacts.collide, collision.collide, law)
        tasks[f"compiled {law}"] = partial(impacts.collide, compiled.collide, law)
        tasks[f"compiled {law}"]()
    compiling = perf_counter() - begin
    seconds = {name: median(repeat(task, repeat=RUNS, number=1)) for name, task in tasks.items()}
    return {
        "impacts": n,
        "runs": RUNS,
        "ns_per_impact": {name: 1e9 * time / n for name, time in seconds.items()},
        "compile_seconds": compiling,
        "machine": machine(),
    }


def table(result: dict[str, Any]) -> str:
    """Text of the result of `benchmark`."""
    this = result["machine"]
    times = sorted(result["ns_per_impact"].items())
    return "\n".join(
        [
            f"{this['processor']}, {this['cores']} cores; python {this['python']}, "
            f"numpy {this['numpy']}, numba {this['numba']}",
            f"{result['impacts']} random impacts on one core, median of {result['runs']} passes",
            *(f"{name:20}{time:10.2f} ns/impact" for name, time in times),
            f"compiling, once: {result['compile_seconds']:.1f} s",
        ]
    )
