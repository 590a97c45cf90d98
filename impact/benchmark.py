"""Time per impact on this machine: arrays, compiled loops, a kernel written by hand, the floor.

The hand-written kernel is what the generated one is measured against. `collide` gives the bits of
`compiled.collide_newton`, as it does the same arithmetic in the same order. `collide_plain` leaves
out the error-free sums and products and the low parts, and so shows what the last digits cost. Both
are compiled with the options of the generated kernel. The floor is one pass through memory.
"""

import os
import platform
from collections.abc import Callable
from functools import partial
from math import copysign
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numba
import numpy as np
from tqdm import tqdm

from . import collision, compiled
from ._impacts import Impacts
from ._jit import kernel
from ._kernel import HUGE_FRICTION
from .geometry import spherocylinder

RUNS = 9  # of each; the median counts
BYTES = 9 * 8 + 8 * 8 + 1  # nine numbers in; eight and a regime code out


@kernel(forceinline=True)
def _plain_approach(c_x, c_z, omega, V_z, X, Z):
    return c_x - omega * Z, (c_z - V_z) + omega * X, 0.0, 0.0


@kernel(forceinline=True)
def _plain_responses(X, Z, k, mu):
    across, along, xz = k * k + X * X, k * k + Z * Z, X * Z
    press, hold = mu * xz, mu * along
    K = across + Z * Z
    return across + press, xz + hold, across - press, xz - hold, K, along, 0.0, 0.0


@kernel(forceinline=True)
def _not_lacking(q, a_low, b, b_low):
    return 0.0


def _handwritten(approach, responses, lacking):
    """Scalar kernel of one impact under Newton's law, given how its sums are made."""

    @kernel(forceinline=True)
    def collide(given):
        c_x, c_z, omega, V_z, X, Z, k, mu, e = given
        u, v, u_low, v_low = approach(c_x, c_z, omega, V_z, X, Z)
        side = copysign(1.0, X * Z if u == 0 else u)
        X, u, u_low = side * X, abs(u), side * u_low
        mu = mu if mu < HUGE_FRICTION else HUGE_FRICTION
        N, T, N_back, T_back, K, K_z, N_low, T_low = responses(X, Z, k, mu)
        v_f = -e * v
        gain = v_f - v
        gain_low = (v_f - (gain + v)) - (1 + e) * v_low

        j_slide = gain / N
        j_low = lacking(j_slide, gain_low, N, N_low)
        u_slide = (u - T * j_slide) + ((u_low - T_low * j_slide) - T * j_low)
        j_slide += j_low
        hits, sticks = v < 0, T_back <= 0
        slides = (u_slide >= 0) & (u > 0) & (N > 0)

        T = T if u > 0 else 1.0
        j_stop = u / T
        j_low = lacking(j_stop, u_low, T, T_low)
        rest = (gain - N * j_stop) + (gain_low - (N_low * j_stop + N * j_low))
        rest = rest if rest > 0 else 0.0
        j_stop += j_low

        j_2 = rest / (K if sticks else N_back)
        u_back = -(T_back if T_back > 0 else 0.0) * j_2
        j_1 = j_slide if slides else j_stop
        j_2 = 0.0 if slides else j_2

        lift = k * k
        push = lift * mu
        P_x = (X * Z if sticks else push) * j_2 - push * j_1
        P_z = (K_z if sticks else lift) * j_2 + lift * j_1
        spin = (X if sticks else X - Z * mu) * j_2 + (X + Z * mu) * j_1
        P_x = P_x if hits else 0.0
        P_z = P_z if hits else 0.0
        spin = spin if hits else 0.0
        u_f = u_slide if slides else u_back
        u_f = u_f if hits else u
        v_f = v_f if hits else v
        stopped = 2 if sticks else 3
        regime = 1 if slides else stopped
        regime = regime if hits else 0
        energy = 0.5 * (P_x * (u + u_f) + P_z * (v + v_f))
        P_x, spin, slip = side * P_x, side * spin, side * u_f
        return c_x + P_x, c_z + P_z, omega + spin, regime, P_x, P_z, slip, v_f, energy

    return collide


collide = _handwritten(
    *(compiled._known[name] for name in ("contact_velocity", "responses", "lacking"))
)
collide_plain = _handwritten(_plain_approach, _plain_responses, _not_lacking)
SCALAR = {**compiled.KERNELS, "handwritten": collide, "uncompensated": collide_plain}


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
    """Processor, versions and threads of this machine."""
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


def _summing(impact: Any, fastmath: Any = False) -> Callable[..., float]:
    """A loop that calls a scalar kernel and keeps one sum over all its results.

    `fastmath` is that of the loop's own arithmetic; the kernel's bits do not depend on it. A sum
    in the order of the loop keeps a compiler from computing several impacts at once, {"reassoc"}
    lets it.
    """

    @kernel(fastmath=fastmath)
    def run(given):
        total = 0.0
        for i in range(given.c_x.size):
            a, b, c, d, e, f, g, h, j = impact(compiled._one_of(given, i))
            total += ((a + b) + (c + d)) + ((e + f) + (g + h)) + j
        return total

    return run


def _same_bits(impacts: Impacts) -> bool:
    """Whether the generated and the hand-written kernel give the same bits in every field."""
    rows = zip(*(column[:2000].tolist() for column in impacts), strict=True)
    singles = [Impacts(*row) for row in rows]
    kernels = compiled.collide_newton, collide
    first, second = (np.array([one(single) for single in singles], float) for one in kernels)
    return first.tobytes() == second.tobytes()


def _once(function: Callable[[], Any]) -> float:
    """Seconds that one call takes."""
    start = perf_counter()
    function()
    return perf_counter() - start


def _in_parts(function: Callable, *groups: Any) -> None:
    """Call a compiled loop on a million impacts at a time: signals are seen between calls."""
    for first in range(0, groups[0].c_x.size, 10**6):
        part = slice(first, first + 10**6)
        function(*(compiled._part_of(group, part) for group in groups))


def _tasks(impacts: Impacts) -> dict[str, Callable[[], Any]]:
    """Calls to time, by name."""
    n = impacts.c_x.size
    results = compiled._empty(n)
    half = np.zeros(BYTES * n // 2 + 1, np.uint8)  # a copy reads it and writes as much
    other = np.empty_like(half)
    tasks: dict[str, Callable[[], Any]] = {}
    for law in compiled.KERNELS:
        tasks[f"numpy {law}"] = partial(impacts.collide, collision.collide, law)
        tasks[f"compiled {law}"] = partial(impacts.collide, compiled.collide, law)
        tasks[f"loop {law}"] = partial(_in_parts, compiled._loop(law), impacts, results)
    for name, scalar in SCALAR.items():
        tasks[f"scalar {name}"] = partial(_in_parts, _summing(scalar), impacts)
    any_order = _summing(compiled.collide_newton, fastmath={"reassoc"})
    tasks["scalar newton, any order"] = partial(_in_parts, any_order, impacts)
    tasks["copy"] = partial(np.copyto, other, half)
    return tasks


def benchmark(n: int) -> dict[str, Any]:
    """Time all tasks in turn, `RUNS` times over; times per impact in ns."""
    small = random_impacts(1)
    compiling = {
        law: _once(partial(small.collide, compiled.collide, law)) for law in compiled.KERNELS
    }
    impacts = random_impacts(n)
    tasks = _tasks(impacts)
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
        "same_bits": _same_bits(impacts),
        "machine": machine(),
    }


def table(result: dict[str, Any]) -> str:
    """The result of `benchmark` as text."""
    ns, rate, on = (result[key] for key in ("ns_per_impact", "million_per_second", "machine"))
    compiling = ", ".join(f"{law} {s:.1f} s" for law, s in result["compile_seconds"].items())
    return "\n".join(
        [
            f"{on['processor']}, {on['cores']} cores, {on['threads']} thread used; "
            f"python {on['python']}, numpy {on['numpy']}, numba {on['numba']}",
            f"{result['impacts']} random impacts, median of {result['runs']} runs",
            f"{'':26}{'ns/impact':>10}{'million/s':>11}",
            *(f"{name:26}{ns[name]:10.2f}{rate[name]:11.1f}" for name in sorted(ns)),
            f"compile, first call      {compiling} (the first compiles what all share)",
            f"generated/hand-written   {result['generated_over_handwritten']:.2f}, "
            f"{'the same' if result['same_bits'] else 'DIFFERENT'} bits",
            f"loop/copy                {result['loop_over_floor']:.2f}, the copy moving the "
            f"{result['bytes_per_impact']} bytes in and out of an impact",
        ]
    )
