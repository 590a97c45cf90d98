"""Which contact law gives what the paper says of its row: a search over laws.

Laws are drawn evenly from ranges of their parameters: a dashpot of constant restitution, or
Appendix A's, with and without its factor of the overlap, of plate and rods apart. Each is simulated
at seven tilts and scored by the claims that are fitted: a number within the limits of its claim
counts one, one that holds in part a half. (a) Score over each parameter; the line is the mean of an
eighth of the laws. (b) Drift of the best laws over tilt, with standard errors, and the theory.
(c) The numbers of the best laws, the best on top: green holds, yellow in part, red does not. Those
right of the gap are held out: they have no part in the score. Thin rods, l = 9.5 d, Gamma = 3.3,
mu = 0.3; steps of a fiftieth of a contact, tangential springs resolved.
"""

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from md.laws import STIFFNESS
from md.scene import both, put
from md.search import Parameter, Search
from md.sweep import Sweep

from ..claims import over_tilt
from ..claims.judge import grade
from ..lib.runs import LENGTH, ROW, boxes, computed
from ..lib.style import BLACK, BLUE, Data, style
from ..lib.tables import table, text_of
from .contact_laws import COLUMNS, LAW_TILTS_DEG, NUMBERS, QUICK_DEG

HELD_OUT = ("S2", "S3")  # of the claims that a law is judged by; all others are fitted
BEST, EIGHTHS = 10, 8
SIZE: dict[bool, dict[str, Any]] = {  # of the search: in full, and quick
    False: {"periods": 150, "seeds": (1, 2), "points": 256},
    True: {"periods": 40, "seeds": (1, 2), "points": 4},
}
CONSTANT, APPENDIX = "constant restitution", "Appendix A"
_FORMS = {
    CONSTANT: {},
    APPENDIX: both(law="appendix_a", restitution="none"),
}
_FACTOR = {"with": both(overlap_factor=True), "without": both(overlap_factor=False)}
_SPHERE = 1 / (1 + 1.5 * (LENGTH - 1))  # mass of the tip's sphere in masses of the rod
_MASS = {
    "rod": {},
    "sphere": both(stiffness=STIFFNESS * _SPHERE, reduced_mass=_SPHERE / 2),
}
_RANGES = {  # name: option of a contact, where it has a meaning, ends, whether evenly in log
    "restitution": ("restitution", {"form": CONSTANT}, 0.4, 1.0, False),
    "tangential ratio": ("tangential_ratio", {"form": CONSTANT}, 0.3, 300.0, True),
    "tangential damping": ("tangential_damping", {"form": CONSTANT}, 0.0, 1.0, False),
    "damping": ("damping", {"form": APPENDIX, "overlap factor": "without"}, 5.0, 600.0, True),
    "damping by overlap": (
        "damping",
        {"form": APPENDIX, "overlap factor": "with"},
        400.0,
        4e5,
        True,
    ),
}


def _parameters() -> tuple[Parameter, ...]:
    """Form of the law, then options of both contacts under it."""
    found = [
        Parameter("form", choices=_FORMS),
        Parameter("overlap factor", choices=_FACTOR, when={"form": APPENDIX}),
        Parameter("mass", choices=_MASS, when={"form": APPENDIX}),
    ]
    for name, (option, when, low, high, log) in _RANGES.items():
        for part in ("plate", "rods"):
            keys = (f"contacts.{part}.{option}",)
            found.append(Parameter(f"{name}, {part}", keys, low, high, log, None, when))
    return tuple(found)


PARAMETERS = _parameters()


def search(quick: bool = False) -> Search:
    """The search, without targets of its own."""
    places = tuple({"box.length": box} for box in boxes(QUICK_DEG if quick else LAW_TILTS_DEG))
    base = put(ROW, {"step.size": "none", "step.coarse": "none"})
    return Search(base, {}, parameters=PARAMETERS, places=places, targets=(), **SIZE[quick])


def _by_law(whole: Sweep) -> list[Sweep]:
    """The runs of each law: over tilt, then over starts."""
    _, *axes = whole.axes
    each = math.prod(whole.shape[1:])
    starts = range(0, len(whole.points), each)
    return [Sweep(tuple(axes), whole.points[i : i + each]) for i in starts]


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """All runs."""
    given = search(quick)
    return {"laws": given.sweep(given.draw())}


def data(quick: bool = False) -> Data:
    """Of each law: parameters as parts of their ranges, numbers, grades, drift over tilt."""
    nominal = np.array(QUICK_DEG if quick else LAW_TILTS_DEG)
    whole = computed(sweeps(quick)["laws"])
    tables = [over_tilt.table(sweep, nominal) for sweep in _by_law(whole)]
    value = np.array([[NUMBERS[name](d) for name in COLUMNS] for d in tables])
    grades = [[grade(v, c) for v, c in zip(row, COLUMNS.values(), strict=True)] for row in value]
    return {
        "parts": search(quick).draw(),
        "value": value,
        "grade": np.array(grades, float),  # None, of a run that failed: nan
        "nominal": nominal,
        "theory": over_tilt.theory(nominal),
        "c_x": np.array([d["c_x"] for d in tables]),
        "c_x_error": np.array([d["c_x_error"] for d in tables]),
    }


_FITTED = np.array([name.partition(".")[0] not in HELD_OUT for name in COLUMNS])


def scores(d: Data) -> np.ndarray:
    """Of each law: numbers of the fitted claims that hold, those in part counted half."""
    return np.nan_to_num(d["grade"][:, _FITTED]).sum(axis=1) / 2


def _laws(d: Data) -> list[dict[str, float | str]]:
    """Values of the parameters that have a meaning in each law."""
    every = [
        {p.name: p.value(x) for p, x in zip(PARAMETERS, row, strict=True)} for row in d["parts"]
    ]
    return [{p.name: v[p.name] for p in PARAMETERS if p.choices or p.changes(v)} for v in every]


def _draw_parameters(axes: np.ndarray, d: Data) -> None:
    laws, score = _laws(d), scores(d)
    numbers = [p for p in PARAMETERS if p.choices is None]
    for ax, parameter in zip(axes.flat, numbers, strict=True):
        of = np.array([parameter.name in law for law in laws])
        x = np.array([law[parameter.name] for law in laws if parameter.name in law], float)
        ax.plot(x, score[of], ".", color=BLUE, markersize=2.5)
        parts = [part for part in np.array_split(np.argsort(x), EIGHTHS) if part.size]
        ax.plot(
            [np.median(x[part]) for part in parts],
            [score[of][part].mean() for part in parts],
            color=BLACK,
        )
        ax.set_xscale("log" if parameter.log else "linear")
        ax.set_xlim(parameter.low, parameter.high)
        ax.set_xlabel(parameter.name.replace(" ", "\n", 1), fontsize=6.5)
        ax.set_ylim(0, _FITTED.sum())
        ax.tick_params(labelsize=6)
    for ax in axes[:, 0]:
        ax.set_ylabel(f"score of {_FITTED.sum()}", fontsize=6.5)
    axes[0, 0].set_title("(a)", loc="left")


def _short(law: dict[str, float | str]) -> str:
    """Form, then the values as plate/rods."""
    if law["form"] == APPENDIX:
        damping = "damping by overlap" if law["overlap factor"] == "with" else "damping"
        pair = "/".join(f"{law[f'{damping}, {part}']:.2g}" for part in ("plate", "rods"))
        return f"A {law['overlap factor']}, {law['mass']}, {pair}"
    names = "restitution", "tangential ratio", "tangential damping"
    pairs = ("/".join(f"{law[f'{n}, {part}']:.2g}" for part in ("plate", "rods")) for n in names)
    return ", ".join(pairs)


def _draw_matrix(ax: Axes, d: Data, best: np.ndarray) -> None:
    """Grades of the best laws; fitted numbers, a gap, numbers that are held out."""
    order = [*np.flatnonzero(_FITTED), *np.flatnonzero(~_FITTED)]
    at = np.arange(len(order)) + 0.6 * ~_FITTED[order]
    colours = ListedColormap(["#EDA677", "#FBF5BE", "#A6DBA0"])
    for j, x in zip(order, at, strict=True):
        column = d["grade"][best, j][:, None]
        ends = [x - 0.5, x + 0.5], np.arange(len(best) + 1) - 0.5
        ax.pcolormesh(*ends, column, cmap=colours, vmin=-0.5, vmax=2.5, edgecolors="white")
        for i, law in enumerate(best):
            ax.text(x, i, text_of(d["value"][law, j], ".2g"), ha="center", va="center", fontsize=5)
    laws = _laws(d)
    ax.set_yticks(range(len(best)), [_short(laws[i]) for i in best], fontsize=5.5)
    heads = [f"{name.partition('.')[0]} {column['head']}" for name, column in COLUMNS.items()]
    ax.set_xticks(
        at, [heads[j] for j in order], fontsize=5, rotation=60, ha="left", rotation_mode="anchor"
    )
    ax.tick_params(length=0, labelbottom=False, labeltop=True)
    ax.invert_yaxis()
    ax.spines[:].set_visible(False)
    ax.set_xlabel(
        "(c) law: restitution, tangential ratio, tangential damping, as plate/rods", fontsize=6.5
    )


@style
def draw(d: Data) -> plt.Figure:
    figure = plt.figure(figsize=(7.4, 8.2))
    top, bottom = figure.subfigures(2, 1, height_ratios=(1, 1))
    left, right = top.subfigures(1, 2, width_ratios=(2.2, 1))
    _draw_parameters(left.subplots(2, 5, sharey=True), d)
    best = np.argsort(-scores(d), kind="stable")[:BEST]
    ax = right.subplots()
    for n, law in enumerate(best[:3]):
        ax.errorbar(
            d["nominal"], d["c_x"][law], d["c_x_error"][law], fmt="os^"[n], label=f"best, {n + 1}"
        )
    ax.plot(d["nominal"], d["theory"], color=BLACK, label="theory, $V_z=V_0/2$")
    ax.set_title("(b)", loc="left")
    ax.set_xlabel(r"tilt $\phi$ (degrees)")
    ax.set_ylabel(r"drift $c_x$ (cm/s)")
    ax.legend(fontsize=6)
    _draw_matrix(bottom.subplots(), d, best)
    return figure


def summary(d: Data) -> str:
    """The best laws with their scores; how many laws each number holds in."""
    laws, score = _laws(d), scores(d)
    best = np.argsort(-score, kind="stable")[:BEST]
    rows = [[f"{score[i]:g}", _short(laws[i])] for i in best]
    shares = [
        [
            name,
            "held out" if not fitted else "fitted",
            f"{np.mean(column == 2):.2f}",
            f"{np.mean(column == 0):.2f}",
        ]
        for name, fitted, column in zip(COLUMNS, _FITTED, d["grade"].T, strict=True)
    ]
    heads = "number", "in the search", "laws in which it holds", "in which it does not"
    return "\n".join(
        [
            f"{len(laws)} laws; best scores of {_FITTED.sum()}",
            table(("score", "restitution, ratio, damping; plate/rods"), rows),
            table(heads, shares),
        ]
    )
