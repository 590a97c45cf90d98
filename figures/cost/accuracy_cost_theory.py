"""What the accuracy of one impact costs: largest and median error against time per impact.

Random impacts under Newton's law, velocities and friction log-uniform over six decades; errors
relative to the largest velocity that takes part. Vertical line: the bytes in and out of an impact,
copied once. The compiled loop fills given arrays, `collide` makes fresh ones; float32 saves memory
only, since the work is done in float64. "As printed": the paper's formulas, mistakes corrected.
mpmath takes about as long for 100 digits, whose error is that much smaller, as for 15.
"""

from statistics import median
from time import perf_counter

import matplotlib.pyplot as plt
import mpmath
import numpy as np

from impact import collide
from impact.benchmark import BYTES, random_impacts

from ..lib.style import BLACK, BLUE, GREEN, RED, Data, style
from ..lib.timing import medians, repeated
from .exact_impacts import FIELDS, Impacts, exact, literal, reference

DIGITS = (15, 30, 60, 100)
TIMED_RUNS = 7
_SERIES = (  # label, colour, marker, where the numbers are
    ("NumPy, float64", BLACK, "o", "array", 0),
    ("NumPy, float32 in and out", BLACK, "s", "array", 1),
    ("compiled, float64", BLUE, "o", "array", 2),
    ("compiled, float32 in and out", BLUE, "s", "array", 3),
    ("compiled loop alone, float64", BLUE, "D", "array", 4),
    ("as printed, float64", RED, "^", "array", 5),
    (f"mpmath, {DIGITS[0]} digits", GREEN, "v", "mpmath", slice(None)),
)
ARRAYS = [label for label, *_, group, _ in _SERIES if group == "array"]


def _arrays(n: int, checked: int) -> Data:
    """Times [s] and errors, shape (2, ...), of everything that takes whole arrays."""
    from impact import compiled

    impacts = random_impacts(n, seed=5)
    singles = Impacts(*(column.astype(np.float32) for column in impacts))
    results = compiled._empty(n)
    start = perf_counter()
    Impacts(*(column[:1] for column in impacts)).collide(compiled.collide)
    compile_seconds = perf_counter() - start
    loop = compiled._loop("newton")

    def bare():
        loop(impacts, results)
        return results

    calls = [  # of `ARRAYS`
        lambda: impacts.collide(collide),
        lambda: singles.collide(collide),
        lambda: impacts.collide(compiled.collide),
        lambda: singles.collide(compiled.collide),
        bare,
        lambda: literal(impacts),
    ]
    true, true_of_singles = (
        reference(Impacts(*(column[:checked].astype(float) for column in given)))
        for given in (impacts, singles)
    )
    errors = []
    for name, call in zip(ARRAYS, calls, strict=True):
        got = call()
        fields = tuple(field for field in FIELDS if hasattr(got, field))
        error = (true_of_singles if "float32" in name else true).error(got, fields)
        errors.append((error.max(), np.median(error)))
    source = np.zeros(BYTES * n // 2 + 1, np.uint8)
    target = np.empty_like(source)
    calls.append(lambda: np.copyto(target, source))
    *seconds, copy = medians([repeated(call) for call in calls], TIMED_RUNS)
    return {
        "array_seconds": np.array(seconds) / n,
        "array_error": np.array(errors).T,
        "memory_seconds": np.float64(copy / n),
        "compile_seconds": np.float64(compile_seconds),
    }


def _many_digits(n: int) -> Data:
    """The generated forms on mpmath numbers, against themselves at 150 digits."""
    rows = list(zip(*(column.tolist() for column in random_impacts(n, seed=6)), strict=True))
    scales = reference(random_impacts(n, seed=6)).scale
    with mpmath.workdps(150):
        true = [exact([mpmath.mpf(x) for x in row])[1] for row in rows]
    seconds, errors = [], []
    for digits in DIGITS:
        with mpmath.workdps(digits):
            numbers = [[mpmath.mpf(x) for x in row] for row in rows]
            every = repeated(lambda numbers=numbers: [*map(exact, numbers)])
            seconds.append(medians([every], TIMED_RUNS)[0] / n)
            got = [exact(row)[1] for row in numbers]
        with mpmath.workdps(150):
            worst = [
                max(float(abs(a - b) / s) for a, b, s in zip(x, y, size, strict=True))
                for x, y, size in zip(got, true, scales.T, strict=True)
            ]
        errors.append((max(worst), median(worst)))
    return {"mpmath_seconds": np.array(seconds), "mpmath_error": np.array(errors).T}


def data(quick: bool = False) -> Data:
    """Seconds per impact, largest and median error."""
    n = 100_000 if quick else 1_000_000
    return {
        "impacts": np.int64(n),
        **_arrays(n, 2_000 if quick else 20_000),
        **_many_digits(40 if quick else 400),
    }


@style
def draw(d: Data) -> plt.Figure:
    figure, ax = plt.subplots(figsize=(7.0, 3.6))
    lowest = 1e-18
    for label, colour, marker, group, part in _SERIES:
        time = np.atleast_1d(1e9 * d[f"{group}_seconds"][part])
        worst, middle = (np.atleast_1d(row[part]) for row in d[f"{group}_error"])
        shown = middle > lowest
        ax.vlines(time[shown], middle[shown], worst[shown], color=colour, lw=0.5)
        chain = "-" if shown.sum() > 1 else ""
        size = 7 if label == "compiled, float64" else 4.5  # may lie under the loop's diamond
        look = {"color": colour, "lw": 0.6, "ms": size}
        ax.plot(time[shown], worst[shown], marker + chain, label=label, **look)
        ax.plot(time[shown], middle[shown], marker, mfc="white", **look)
    unit = {f"half an ulp of {kind}": np.finfo(kind).eps / 2 for kind in ("float32", "float64")}
    for words, at in unit.items():
        ax.axhline(at, color="0.55", lw=0.8, ls=":")
        ax.text(6e3, 1.3 * at, words, fontsize=6.5, ha="center", va="bottom")
    ax.axvline(1e9 * d["memory_seconds"], color="0.55", lw=0.8, ls="--")
    upright = {"fontsize": 6.5, "rotation": 90, "va": "center"}
    ax.text(1.35e9 * d["memory_seconds"], 1e-3, "one pass through memory", **upright)
    more = 1e9 * np.median(d["mpmath_seconds"][1:])
    arrow = {"arrowprops": {"arrowstyle": "->", "color": GREEN}, "color": GREEN, "fontsize": 6.5}
    beyond = f"{DIGITS[1]} to {DIGITS[-1]} digits: below the axis"
    ax.annotate(beyond, (more, 1.2 * lowest), (0.7 * more, 8e-18), ha="right", va="center", **arrow)
    ax.set(xscale="log", yscale="log", xlim=(2, 1e6), ylim=(lowest, 1e5))
    ax.set(xlabel="time per impact (ns)", ylabel="relative error")
    words = "filled: largest error\nopen: median"
    figure.legend(loc="outside right center", title=words, title_fontsize=7)
    return figure
