"""Which contact law gives what the paper says of its row: a search over laws.

Laws are drawn evenly from ranges of their parameters, of plate and rods apart: a dashpot of
constant restitution with tangential spring and dashpot, or Appendix A's, with and without its
factor of the overlap, in masses of the rod or of the tip's sphere (its M_e is a factor of the
damping). Each is simulated at seven tilts and scored by the numbers that are fitted: one within the
limits of its claim counts one, one that holds in part a half. A second round lies between the best
laws of the first. Of both the best, their parameters rounded to two digits, are simulated again
from four other starts, at the tilts of Figs. 6 to 8, twice as long and with half the step, and two
known laws with them; what is said of them comes from these runs alone.

(a) Score over each parameter; orange: second round; the line is the mean of an eighth of the laws
of the first. (b) Drift of the best laws over tilt, with standard errors, and the theory. (c) The
numbers of the best laws, the best on top: green holds, yellow in part, red does not. Those right of
the gap are held out: they have no part in the score. After each law its score, with its spread as
the numbers vary within their errors; then the score that it had in the search. Thin rods,
l = 9.5 d, Gamma = 3.3, mu = 0.3; springs are resolved: steps are at most a fiftieth of a contact.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from ..claims.over_laws import (
    APPENDIX,
    FITTED,
    HEADED,
    JUDGED,
    KNOWN,
    PARAMETERS,
    data,
    later,
    laws_of,
    sweeps,
)
from ..lib.runs import PARTS
from ..lib.style import BLACK, BLUE, ORANGE, Data, name_panels, style

__all__ = ["data", "draw", "later", "sweeps"]
EIGHTHS = 8  # parts of a range, whose means are drawn


def eighths(x: np.ndarray, score: np.ndarray) -> np.ndarray:
    """Medians of x and mean scores of an eighth of the laws each, in the order of x."""
    parts = np.array_split(np.argsort(x), EIGHTHS)
    return np.transpose([(np.median(x[of]), score[of].mean()) for of in parts if of.size])


def _draw_parameters(axes: np.ndarray, d: Data) -> None:
    laws, score, even = laws_of(d["parts"]), d["score"], d["round"] == 0
    numbers = [p for p in PARAMETERS if p.choices is None]
    for ax, parameter in zip(axes.flat, numbers, strict=True):
        x = np.array([law.get(parameter.name, np.nan) for law in laws], float)
        known = np.flatnonzero(even & np.isfinite(x))
        ax.plot(x[~even], score[~even], ".", color=ORANGE, markersize=2.5)
        ax.plot(x[known], score[known], ".", color=BLUE, markersize=2.5)
        ax.plot(*eighths(x[known], score[known]), color=BLACK)
        ax.set_xscale("log" if parameter.log else "linear")
        ax.set_xlim(parameter.low, parameter.high)
        ax.set_xlabel(parameter.name.replace(", ", ",\n", 1), fontsize=6)
        ax.set_ylim(score.min() - 1, score.max() + 1)
        ax.tick_params(labelsize=6)
    for ax in axes[:, 0]:
        ax.set_ylabel(f"score of {FITTED.sum()}", fontsize=6.5)


def short(law: dict[str, float | str]) -> str:
    """Form, then the values as plate/rods."""
    if law["form"] == APPENDIX:
        damping = "damping by overlap" if law["overlap factor"] == "with" else "damping"
        return f"A {law['overlap factor']}, {law['mass']}, {_pair(law, damping)}"
    names = "restitution", "tangential ratio", "tangential damping"
    return ", ".join(_pair(law, name) for name in names)


def _pair(law: dict[str, float | str], name: str) -> str:
    """Values of plate and rods to two digits: 120/1.1."""
    values = (float(f"{law[f'{name}, {part}']:.2g}") for part in PARTS)
    return "/".join(f"{value:g}" for value in values)


def names_of(d: Data) -> list[str]:
    """Of the confirmed laws."""
    found = [short(law) for law in laws_of(d["best_parts"])]
    return [*found[: len(d["best"])], *KNOWN]


def _searched(d: Data, law: int) -> str:
    """The score that a confirmed law had in the search, if it comes from there."""
    return f"{d['score'][d['best'][law]]:g}" if law < len(d["best"]) else ""


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
            text = f"{d['best_value'][law, j]:.2g}"
            ax.text(x, i, text, ha="center", va="center", fontsize=5)
    for i, law in enumerate(rows):
        scores = f"{d['best_score'][law]:g}±{d['best_spread'][law]:.1f}"
        ax.text(at[-1] + 0.8, i, scores, ha="left", va="center", fontsize=5.5)
        ax.text(at[-1] + 3.2, i, _searched(d, law), ha="left", va="center", fontsize=5.5)
    names = names_of(d)
    ax.set_yticks(range(len(rows)), [names[i] for i in rows], fontsize=5.5)
    numbers = list(JUDGED.items())
    heads = [f"{numbers[j][0].partition('.')[0]} {numbers[j][1]['head']}" for j in columns]
    heads += ["score", "in the search"]
    words = {"fontsize": 5.5, "rotation": 90, "ha": "center", "linespacing": 1}
    ax.set_xticks([*at, at[-1] + 1.4, at[-1] + 3.4], heads, **words)
    ax.tick_params(length=0, labelbottom=False, labeltop=True)
    ax.set_xlim(-0.5, at[-1] + 4.2)
    ax.invert_yaxis()
    ax.spines[:].set_visible(False)
    label = "(c) law: restitution, tangential ratio, tangential damping, as plate/rods"
    ax.set_xlabel(label, fontsize=6.5)


@style
def draw(d: Data) -> plt.Figure:
    figure = plt.figure(figsize=(7.4, 8.2))
    top, bottom = figure.subfigures(2, 1, height_ratios=(1, 1))
    left, right = top.subfigures(1, 2, width_ratios=(2.2, 1))
    axes = left.subplots(2, 5, sharey=True)
    _draw_parameters(axes, d)
    ax, names = right.subplots(), names_of(d)
    name_panels((axes[0, 0], ax), ("", ""))
    for law, form in zip(_order(d), "os^", strict=False):
        error = d["best_c_x_error"][law]
        ax.errorbar(d["best_nominal"], d["best_c_x"][law], error, fmt=form, label=names[law])
    ax.plot(d["best_nominal"], d["best_theory"], color=BLACK, label="theory, $V_z=V_0/2$")
    ax.set(xlabel=r"tilt $\phi$ (deg)", ylabel=r"drift $c_x$ (cm/s)")
    ax.set_ylim(min(0, d["best_c_x"].min()), 1.3 * d["best_theory"].max())
    ax.legend(fontsize=5)
    _draw_matrix(bottom.subplots(), d)
    return figure
