"""What the accuracy of one impact costs: largest and median error against time per impact.

Random impacts under Newton's law, velocities and friction log-uniform over six decades; errors
relative to the largest velocity that takes part. Vertical line: the bytes in and out of an impact,
copied once. The compiled loop fills given arrays, `collide` makes fresh ones.
"As printed": the paper's formulas, mistakes corrected.
"""

import matplotlib.pyplot as plt
import mpmath
import numpy as np

from impact import collide
from impact.benchmark import random_impacts

from ..lib.style import BLACK, BLUE, GREEN, RED, Data, style
from ..lib.timing import medians, repeated
from .exact_impacts import FIELDS, Impacts, exact, literal, reference

TIMED_RUNS = 7
DIGITS = 15  # of mpmath
WAYS = (  # label, colour, marker
    ("NumPy, float64", BLACK, "o"),
    ("compiled, float64", BLUE, "o"),
    ("compiled loop alone, float64", BLUE, "D"),
    ("as printed, float64", RED, "^"),
    (f"mpmath, {DIGITS} digits", GREEN, "v"),
)


def _arrays(n: int, checked: int) -> Data:
    """Times [s] and errors, shape (2, ways), of everything that takes whole arrays."""
    from impact import compiled

    impacts = random_impacts(n, seed=5)
    results = compiled._empty(n)
    loop = compiled._loop("newton")

    def bare():
        loop(impacts, results)
        return results

    calls = [  # of `WAYS`
        lambda: impacts.collide(collide),
        lambda: impacts.collide(compiled.collide),
        bare,
        lambda: literal(impacts),
    ]
    true, errors = reference(Impacts(*(column[:checked] for column in impacts))), []
    for call in calls:
        got = call()
        fields = tuple(field for field in FIELDS if hasattr(got, field))
        error = true.error(got, fields)
        errors.append((error.max(), np.median(error)))
    bytes_moved = 9 * 8 + 8 * 8 + 1  # nine numbers in; eight and a regime code out
    source = np.zeros(bytes_moved * n // 2 + 1, np.uint8)  # a copy reads it and writes as much
    target = np.empty_like(source)
    calls.append(lambda: np.copyto(target, source))
    *seconds, copy = medians([repeated(call) for call in calls], TIMED_RUNS)
    return {
        "seconds": np.array(seconds) / n,
        "error": np.array(errors).T,
        "memory_seconds": np.float64(copy / n),
    }


def _in_digits(n: int) -> tuple[float, tuple[float, float]]:
    """Seconds and errors of the generated forms on mpmath numbers."""
    impacts = random_impacts(n, seed=6)
    rows = list(zip(*(column.tolist() for column in impacts), strict=True))
    with mpmath.workdps(DIGITS):
        numbers = [[mpmath.mpf(x) for x in row] for row in rows]
        every = repeated(lambda: [exact(row)[1] for row in numbers])
        seconds = medians([every], TIMED_RUNS)[0] / n
        got = every(1)
    with mpmath.workdps(50):
        true = [exact([mpmath.mpf(x) for x in row])[1] for row in rows]
        off = np.array(got) - np.array(true)
    errors = np.max(np.abs(off.astype(float)) / reference(impacts).scale.T, axis=1)
    return seconds, (errors.max(), np.median(errors))


def data(quick: bool = False) -> Data:
    """Seconds per impact, largest and median error, over `WAYS`."""
    n = 100_000 if quick else 1_000_000
    found = _arrays(n, 2_000 if quick else 20_000)
    seconds, error = _in_digits(40 if quick else 400)
    found["seconds"] = np.append(found["seconds"], seconds)
    found["error"] = np.column_stack([found["error"], error])
    return found


@style
def draw(d: Data) -> plt.Figure:
    figure, ax = plt.subplots(figsize=(7.0, 3.6))
    lowest = 1e-18
    for i, (label, colour, marker) in enumerate(WAYS):
        time, (worst, middle) = 1e9 * d["seconds"][i], d["error"][:, i]
        ax.vlines(time, middle, worst, color=colour, lw=0.5)
        look = {"color": colour, "ms": 7 if label == "compiled, float64" else 4.5}  # may lie under
        ax.plot(time, worst, marker, ls="", label=label, **look)
        ax.plot(time, middle, marker, mfc="white", **look)
    half_ulp = np.finfo(float).eps / 2
    ax.axhline(half_ulp, color="0.55", lw=0.8, ls=":")
    ax.text(6e3, 1.3 * half_ulp, "half an ulp", ha="center", va="bottom")
    ax.axvline(1e9 * d["memory_seconds"], color="0.55", lw=0.8, ls="--")
    upright = {"rotation": 90, "va": "center"}
    ax.text(1.35e9 * d["memory_seconds"], 1e-3, "one pass through memory", **upright)
    ax.set(xscale="log", yscale="log", xlim=(2, 1e6), ylim=(lowest, 1e5))
    ax.set(xlabel="time per impact (ns)", ylabel="relative error")
    words = "filled: largest error\nopen: median"
    figure.legend(loc="outside right center", title=words)
    return figure
