"""Which contact law gives what the paper says of its row: a search over laws.

Laws are drawn evenly from ranges of their parameters, of plate and rods apart: a dashpot of
constant restitution with tangential spring and dashpot, or Appendix A's, with and without its
factor of the overlap, in masses of the rod or of the tip's sphere (its M_e is a factor of the
damping). Each law is simulated at seven tilts and scored by the numbers that are fitted: one that
lies within the limits of its claim counts one, one that does in part a half. The best laws, their
parameters rounded to two digits, are simulated again from other starts, twice as long, at more
tilts and with half the step; what is said of them comes from these runs alone.

(a) Score over each parameter; the line is the mean of an eighth of the laws. (b) Drift of the best
laws over tilt, with standard errors, and the theory. (c) The numbers of the best laws, the best on
top: green holds, yellow in part, red does not. Those right of the gap are held out: they have no
part in the score. After each law its score, with its spread as the numbers vary within their
errors; then the score that it had in the search. Thin rods, l = 9.5 d, Gamma = 3.3, mu = 0.3;
springs are resolved: steps are at most a fiftieth of a contact.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from md.host import step_of
from md.laws import STIFFNESS
from md.scene import both, put
from md.search import Parameter, Search
from md.sweep import Point, Sweep

from ..claims import over_tilt
from ..claims.judge import claim_of, grade, read
from ..lib.runs import LENGTH, ROW, boxes, computed
from ..lib.style import BLACK, BLUE, Data, style
from ..lib.tables import table, text_of
from .contact_laws import LAW_TILTS_DEG, NUMBERS, QUICK_DEG

JUDGED = {  # numbers with limits that every law has
    name: row
    for claim in read()
    for row in claim["numbers"]
    if "holds" in row and (name := f"{claim['id']}.{row['key']}") in NUMBERS
}
HEADED = np.array(["head" in row for row in JUDGED.values()])  # numbers of the matrix
FITTED = HEADED & [claim_of(name)["fitted"] for name in JUDGED]  # and of the score
BEST, EIGHTHS, DRAWS = 10, 8, 100  # laws that are confirmed; parts of a range; of a score
KEPT_DEG = 2  # a row that keeps its tilt is as near to acos(dN/L), at every tilt
TILTS_DEG = (3, *range(9, 76, 6))  # where the best laws are confirmed
CONFIRMED: dict[bool, dict[str, Any]] = {  # runs of the best laws, in full and quick
    False: {"periods": 300, "seeds": (3, 4), "tilts": TILTS_DEG, "best": BEST},
    True: {"periods": 40, "seeds": (3, 4), "tilts": QUICK_DEG, "best": 2},
}
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
    """Runs of the search; the best laws are known behind them."""
    given = search(quick)
    return {"laws": given.sweep(given.draw())}


def _two_digits(parameter: Parameter, part: float) -> float:
    """The part of a range whose value is that of `part`, rounded to two digits."""
    if parameter.choices is not None:
        return part
    value, low, high = float(f"{parameter.value(part):.2g}"), parameter.low, parameter.high
    if parameter.log:
        return math.log(value / low) / math.log(high / low)
    return (value - low) / (high - low)


def confirming(parts: np.ndarray, quick: bool = False) -> Sweep:
    """Runs of laws from other starts, longer, at more tilts, with half the step."""
    given = CONFIRMED[quick]
    places = tuple({"box.length": box} for box in boxes(given["tilts"]))
    again = replace(search(quick), places=places, seeds=given["seeds"], periods=given["periods"])

    def halved(point: Point) -> Point:
        scene = point.scene
        half = replace(scene.step, size=step_of(scene)[0] / 2)
        return replace(point, scene=replace(scene, step=half))

    whole = again.sweep(parts)
    return replace(whole, points=tuple(map(halved, whole.points)))


def _judged(whole: Sweep, tilts: Sequence[int], prefix: str = "") -> Data:
    """Of each law: numbers, grades, score with its spread, drift over tilt."""
    nominal = np.array(tilts)
    tables = [over_tilt.table(sweep, nominal) for sweep in _by_law(computed(whole))]
    value = np.array([[NUMBERS[name](d) for name in JUDGED] for d in tables])
    grades = np.array([_grades(row) for row in value])
    random = np.random.default_rng(1)
    found = {
        "value": value,
        "grade": grades,
        "score": score_of(grades),
        "spread": np.array(
            [np.std([score_of(_varied(d, random)) for _ in range(DRAWS)]) for d in tables]
        ),
        "nominal": nominal,
        "theory": over_tilt.theory(nominal),
        "c_x": np.array([d["c_x"] for d in tables]),
        "c_x_error": np.array([d["c_x_error"] for d in tables]),
        "tilt_off": np.array([np.abs(d["tilt"] - nominal).max() for d in tables]),
    }
    return {prefix + name: values for name, values in found.items()}


def _grades(values: np.ndarray) -> np.ndarray:
    """Of each number; nan where it is not known."""
    return np.array([grade(v, c) for v, c in zip(values, JUDGED.values(), strict=True)], float)


def _varied(d: Data, random: np.random.Generator) -> np.ndarray:
    """Grades, if the measured means of one law vary within their errors."""
    measured = [name for name in d if f"{name}_error" in d]
    moved = {n: random.normal(d[n], np.nan_to_num(d[f"{n}_error"])) for n in measured}
    return _grades(np.array([NUMBERS[name]({**d, **moved}) for name in JUDGED]))


def score_of(grades: np.ndarray) -> np.ndarray:
    """Numbers of the fitted claims that hold, those in part counted half; (..., numbers)."""
    return np.nan_to_num(grades)[..., FITTED].sum(axis=-1) / 2


def data(quick: bool = False) -> Data:
    """Of all laws, then of the best ones: parameters as parts of their ranges, and `_judged`."""
    parts = search(quick).draw()
    found = _judged(sweeps(quick)["laws"], QUICK_DEG if quick else LAW_TILTS_DEG)
    given = CONFIRMED[quick]
    best = np.argsort(-found["score"], kind="stable")[: given["best"]]
    rounded = np.array(
        [[_two_digits(p, x) for p, x in zip(PARAMETERS, row, strict=True)] for row in parts[best]]
    )
    again = _judged(confirming(rounded, quick), given["tilts"], "best_")
    return {"parts": parts, **found, "best": best, "best_parts": rounded, **again}


def laws_of(parts: np.ndarray) -> list[dict[str, float | str]]:
    """Values of the parameters that have a meaning in each law."""
    every = [{p.name: p.value(x) for p, x in zip(PARAMETERS, row, strict=True)} for row in parts]
    return [
        {p.name: v[p.name] for p in PARAMETERS if (p.when or {}).items() <= v.items()}
        for v in every
    ]


def _draw_parameters(axes: np.ndarray, d: Data) -> None:
    laws, score = laws_of(d["parts"]), d["score"]
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
        ax.set_xlabel(parameter.name.replace(", ", ",\n", 1), fontsize=6)
        ax.set_ylim(0, FITTED.sum())
        ax.tick_params(labelsize=6)
    for ax in axes[:, 0]:
        ax.set_ylabel(f"score of {FITTED.sum()}", fontsize=6.5)
    axes[0, 0].set_title("(a)", loc="left")


def short(law: dict[str, float | str]) -> str:
    """Form, then the values as plate/rods."""
    if law["form"] == APPENDIX:
        damping = "damping by overlap" if law["overlap factor"] == "with" else "damping"
        pair = "/".join(f"{law[f'{damping}, {part}']:.2g}" for part in ("plate", "rods"))
        return f"A {law['overlap factor']}, {law['mass']}, {pair}"
    names = "restitution", "tangential ratio", "tangential damping"
    pairs = ("/".join(f"{law[f'{n}, {part}']:.2g}" for part in ("plate", "rods")) for n in names)
    return ", ".join(pairs)


def _order(d: Data) -> np.ndarray:
    """Places of the confirmed laws, the best first."""
    return np.argsort(-d["best_score"], kind="stable")


def _draw_matrix(ax: Axes, d: Data) -> None:
    """Grades of the best laws; fitted numbers, a gap, numbers that are held out."""
    columns = [*np.flatnonzero(FITTED), *np.flatnonzero(HEADED & ~FITTED)]
    at = np.arange(len(columns)) + 0.6 * ~FITTED[columns]
    colours, rows = ListedColormap(["#EDA677", "#FBF5BE", "#A6DBA0"]), _order(d)
    for j, x in zip(columns, at, strict=True):
        ends = [x - 0.5, x + 0.5], np.arange(len(rows) + 1) - 0.5
        column = d["best_grade"][rows, j][:, None]
        ax.pcolormesh(*ends, column, cmap=colours, vmin=-0.5, vmax=2.5, edgecolors="white")
        for i, law in enumerate(rows):
            text = text_of(d["best_value"][law, j], ".2g")
            ax.text(x, i, text, ha="center", va="center", fontsize=5)
    for i, law in enumerate(rows):
        scores = f"{d['best_score'][law]:g}±{d['best_spread'][law]:.1f}"
        before = f"{d['score'][d['best'][law]]:g}"
        ax.text(at[-1] + 0.8, i, scores, ha="left", va="center", fontsize=5.5)
        ax.text(at[-1] + 3.2, i, before, ha="left", va="center", fontsize=5.5)
    laws = laws_of(d["best_parts"])
    ax.set_yticks(range(len(rows)), [short(laws[i]) for i in rows], fontsize=5.5)
    names = list(JUDGED)
    heads = [f"{names[j].partition('.')[0]} {JUDGED[names[j]]['head']}" for j in columns]
    heads += ["score", "in the search"]
    ax.set_xticks(
        [*at, at[-1] + 1.4, at[-1] + 3.4],
        heads,
        fontsize=5,
        rotation=60,
        ha="left",
        rotation_mode="anchor",
    )
    ax.tick_params(length=0, labelbottom=False, labeltop=True)
    ax.set_xlim(-0.5, at[-1] + 4.2)
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
    ax, laws = right.subplots(), laws_of(d["best_parts"])
    for n, law in enumerate(_order(d)[:3]):
        ax.errorbar(
            d["best_nominal"],
            d["best_c_x"][law],
            d["best_c_x_error"][law],
            fmt="os^"[n],
            label=short(laws[law]),
        )
    ax.plot(d["best_nominal"], d["best_theory"], color=BLACK, label="theory, $V_z=V_0/2$")
    ax.set_title("(b)", loc="left")
    ax.set_xlabel(r"tilt $\phi$ (degrees)")
    ax.set_ylabel(r"drift $c_x$ (cm/s)")
    ax.set_ylim(top=1.45 * d["best_theory"].max())
    ax.legend(fontsize=5)
    _draw_matrix(bottom.subplots(), d)
    return figure


def verdicts(d: Data) -> dict[str, dict[str, Any]]:
    """Of each claim with such numbers: which ones, and under how many laws it has which verdict.

    `all`: counts of laws under which these numbers hold, hold in part, do not; `kept`: the same of
    the laws under which the row keeps its tilt.
    """
    kept, found = d["tilt_off"] <= KEPT_DEG, {}
    for claim in read():
        mine = [j for j, name in enumerate(JUDGED) if name.startswith(f"{claim['id']}.")]
        if not mine:
            continue
        known = d["grade"][:, mine]
        of = np.where(known.min(axis=1) == 2, 0, np.where(known.max(axis=1) == 0, 2, 1))
        of[np.isnan(known).any(axis=1)] = -1
        found[claim["id"]] = {
            "numbers": [list(JUDGED)[j].partition(".")[2] for j in mine],
            "all": [int((of == k).sum()) for k in range(3)],
            "kept": [int((of[kept] == k).sum()) for k in range(3)],
        }
    return found


def excluded(d: Data) -> list[tuple[str, str]]:
    """Pairs of numbers that hold each in a twentieth of the laws and more, together in none."""
    holds, names = d["grade"] == 2, list(JUDGED)
    often = np.flatnonzero(holds.mean(axis=0) >= 0.05)
    return [
        (names[i], names[j])
        for i, j in combinations(often, 2)
        if not (holds[:, i] & holds[:, j]).any()
    ]


def summary(d: Data) -> str:
    """The best laws with their scores; in how many laws each number holds; what excludes what."""
    laws = laws_of(d["best_parts"])
    rows = [
        [
            f"{d['best_score'][i]:g}±{d['best_spread'][i]:.1f}",
            f"{d['score'][d['best'][i]]:g}±{d['spread'][d['best'][i]]:.1f}",
            short(laws[i]),
        ]
        for i in _order(d)
    ]
    shares = [
        [
            name,
            "in the score" if fitted else "held out",
            f"{np.mean(column == 2):.2f}",
            f"{np.mean(column == 0):.2f}",
        ]
        for name, fitted, column in zip(JUDGED, FITTED, d["grade"].T, strict=True)
    ]
    heads = "number", "", "laws in which it holds", "in which it does not"
    of = [
        [p.name, choice, f"{score.max():.1f}", f"{score.mean():.1f}"]
        for p in PARAMETERS
        if p.choices
        for choice in p.choices
        if len(score := d["score"][[law.get(p.name) == choice for law in laws_of(d["parts"])]])
    ]
    return "\n".join(
        [
            f"{len(d['parts'])} laws; scores of {FITTED.sum()}",
            table(("confirmed", "in the search", "restitution, ratio, damping; plate/rods"), rows),
            table(("choice", "", "best score", "mean"), of),
            table(heads, shares),
            "numbers that never hold together: "
            + (", ".join(f"{a} and {b}" for a, b in excluded(d)) or "none"),
        ]
    )
