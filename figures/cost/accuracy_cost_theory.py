"""What the accuracy of one impact costs: largest and median error against time per impact.

Random impacts under Newton's law, velocities and friction log-uniform over six decades; errors
relative to the largest velocity that takes part. Vertical line: the bytes in and out of an impact,
copied once. "As printed": the paper's formulas, mistakes corrected.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from impact import collide

from ..lib.exact_impacts import FIELDS, Impacts, literal, random_impacts, reference
from ..lib.style import BLACK, BLUE, GUIDE, RED, Data, log_log, note, style
from ..lib.timing import machine_line, measured_here, medians

TIMED_RUNS = 7
WAYS = (  # label, colour, marker
    ("NumPy, float64", BLACK, "o"),
    ("compiled, float64", BLUE, "o"),
    ("as printed, float64", RED, "^"),
)


def data(quick: bool = False) -> Data:
    """Seconds per impact, largest and median error, over `WAYS`."""
    from impact import compiled

    here = measured_here()
    n, checked = (100_000, 1_000) if quick else (1_000_000, 20_000)
    impacts = random_impacts(n, seed=5)
    calls = [  # of `WAYS`
        lambda: impacts.collide(collide),
        lambda: impacts.collide(compiled.collide),
        lambda: literal(impacts),
    ]
    true, errors = reference(Impacts(*(column[:checked] for column in impacts))), []
    for call in calls:
        got = call()
        fields = tuple(field for field in FIELDS if hasattr(got, field))
        error = true.error(got, fields, true.scale)
        errors.append((error.max(), np.median(error)))
    bytes_moved = 9 * 8 + 8 * 8 + 1  # nine numbers in; eight and a regime code out
    source = np.zeros(bytes_moved * n // 2 + 1, np.uint8)  # a copy reads it and writes as much
    target = np.empty_like(source)
    calls.append(lambda: np.copyto(target, source))
    *seconds, copy = medians(calls, TIMED_RUNS)
    return {
        "seconds": np.array(seconds) / n,
        "error": np.array(errors).T,
        "memory_seconds": copy / n,
        **here,
    }


@style
def draw(d: Data) -> Figure:
    figure, ax = plt.subplots(figsize=(7.0, 3.6))
    for i, (label, colour, marker) in enumerate(WAYS):
        time, (worst, middle) = 1e9 * d["seconds"][i], d["error"][:, i]
        ax.vlines(time, middle, worst, color=colour, lw=0.5)
        ax.plot(time, worst, marker, ls="", color=colour, ms=4.5, label=label)
        ax.plot(time, middle, marker, mfc="white", color=colour, ms=4.5)
    half_ulp = np.finfo(float).eps / 2
    ax.axhline(half_ulp, **GUIDE, ls=":")
    ax.text(2.3, 1.3 * half_ulp, "half an ulp", va="bottom")
    ax.axvline(1e9 * d["memory_seconds"], **GUIDE, ls="--")
    ax.text(1.35e9 * d["memory_seconds"], 1e-3, "one pass through memory", rotation=90, va="center")
    log_log(
        ax,
        xlabel="time per impact (ns)",
        xlim=(2, 1e4),
        ylabel="relative error",
        ylim=(1e-18, 1e5),
    )
    figure.legend(loc="outside right center", title="filled: largest error\nopen: median")
    note(figure, machine_line(d))
    return figure
