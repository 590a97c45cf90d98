"""The search over contact laws again, with the friction of plate and rods free.

Laws of constant restitution, drawn evenly from ranges of the restitution and the friction of plate
and rods; tangential springs and dashpots are those of the figures' law, which matter little (figure
`which_law`). Score: numbers of the fitted claims that hold, those in part counted half, as there;
the theory that some of them compare with keeps the friction 0.3 of the plate. (a) to (d): score
over each parameter; the line is the mean of an eighth of the laws; the diamond the law of the
figures, which has the paper's friction, 0.3 everywhere. (e): the same laws over both frictions,
score by colour. Thin rods, l = 9.5 d, Gamma = 3.3.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

from md.scene import put
from md.search import Parameter, Search
from md.sweep import Sweep

from ..claims.over_laws import FITTED, JUDGED, LAW_TILTS_DEG, QUICK_DEG, judged, part_of, search
from ..lib.runs import FRICTION, LAW_OF, PARTS, RESOLVED, ROW
from ..lib.style import BLACK, BLUE, ORANGE, Data, name_panels, style
from ..lib.tables import columned, table
from .which_law import eighths

_RANGES = {"restitution": (0.6, 1.0, False), "friction": (0.03, 1.0, True)}
FREE = tuple(
    Parameter(f"{name} of {part}", (f"contacts.{part}.{name}",), low, high, log)
    for name, (low, high, log) in _RANGES.items()
    for part in PARTS
)
OF_FIGURES = (*LAW_OF["restitution"], FRICTION, FRICTION)  # values of `FREE`
POINTS = {False: 128, True: 4}


def _search(quick: bool) -> tuple[Search, np.ndarray]:
    """The search, and its laws with that of the figures last, as parts of the ranges."""
    base = put(ROW, RESOLVED)
    given = replace(search(quick), base=base, parameters=FREE, points=POINTS[quick])
    last = [part_of(p, value) for p, value in zip(FREE, OF_FIGURES, strict=True)]
    return given, np.vstack([given.draw(), last])


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """All runs."""
    given, parts = _search(quick)
    return {"laws": given.sweep(parts)}


def data(quick: bool = False) -> Data:
    """Values of the parameters, numbers, grades and score of each law; the last is the figures'."""
    _, parts = _search(quick)
    values = np.array([[p.value(x) for p, x in zip(FREE, row, strict=True)] for row in parts])
    tilts = QUICK_DEG if quick else LAW_TILTS_DEG
    return {"parameters": values, **judged(sweeps(quick)["laws"], tilts)}


@style
def draw(d: Data) -> plt.Figure:
    figure = plt.figure(figsize=(7.0, 3.6))
    left, right = figure.subfigures(1, 2, width_ratios=(1.5, 1))
    score, values = d["score"], d["parameters"]
    axes = left.subplots(2, 2, sharey=True)
    for n, (ax, parameter) in enumerate(zip(axes.flat, FREE, strict=True)):
        x = values[:, n]
        ax.plot(x[:-1], score[:-1], ".", color=BLUE, markersize=3)
        ax.plot(*eighths(x[:-1], score[:-1]), color=BLACK)
        ax.plot(x[-1], score[-1], "D", color=ORANGE, markeredgecolor=BLACK, markersize=4)
        ax.set_xscale("log" if parameter.log else "linear")
        ax.set(xlabel=parameter.name, xlim=(parameter.low, parameter.high))
    for ax in axes[:, 0]:
        ax.set_ylabel(f"score of {FITTED.sum()}")
    ax = right.subplots()
    shown = ax.scatter(values[:, 2], values[:, 3], c=score, s=14, cmap="viridis")
    ax.plot(*values[-1, 2:], "D", mfc="none", mec=ORANGE, markersize=7)
    right.colorbar(shown, ax=ax, label="score", pad=0.02)
    ax.set(xscale="log", yscale="log", xlabel=FREE[2].name, ylabel=FREE[3].name)
    ax.set(xlim=(FREE[2].low, FREE[2].high), ylim=(FREE[3].low, FREE[3].high))
    name_panels([*axes.flat, ax], [""] * 5)
    return figure


def summary(d: Data) -> str:
    """The best laws; in how many laws each fitted number holds."""
    grades = d["grade"][:-1]
    best = np.argsort(-d["score"][:-1], kind="stable")[:5]
    rows = [
        [f"{d['score'][i]:g}±{d['spread'][i]:.1f}", *d["parameters"][i]]
        for i in (*best, len(grades))
    ]
    holds, partly = (np.mean(grades >= grade, axis=0)[FITTED] for grade in (2, 1))
    names = np.array([*JUDGED])[FITTED]
    return "\n".join([
        f"{len(grades)} laws; the best five, then that of the figures",
        table((f"score of {FITTED.sum()}", *(p.name for p in FREE)), rows),
        columned({"number": names, "laws in which it holds": holds, "or holds in part": partly}),
    ])  # fmt: skip
