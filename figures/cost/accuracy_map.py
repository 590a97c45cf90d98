"""Error of an impact in units in the last place: ours, and the paper's formulas taken literally.

Top: a thin rod (c_x = 1, c_z = -1, omega = 0.7/l, restitution 0.8); each pixel shows the worst of
c_x' and c_z' over a few impacts inside it, the only two for which the paper prints formulas. Their
mistakes are corrected, (12), (13) and (21), but nothing is rewritten. Dotted: the Painleve region,
where (14) takes a contact that stops and sticks for a slide of negative impulse, and no digit of
the printed formulas is right. Beneath: all results (velocities, spin, impulses) over random impacts
of any sign, velocities and friction log-uniform over six decades, from near-spheres to long
spherocylinders.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import BoundaryNorm

from impact import collide, critical_friction, slide_friction, thin_rod
from impact.benchmark import random_impacts

from ..lib.style import RESTITUTION_LAWS, Data, name_panels, style, tilt_axis
from .exact_impacts import SLIP_REGIMES, Impacts, literal, painleve_sum, reference

ULP_LEVELS = (0, 0.5, 1, 2, 4, 16, 256, 1e4, 1e8, 1e16)  # of the colours, ulp
PRINTED_FIELDS = ("c_x", "c_z")  # what the paper has formulas for
_NAMES = ("slide", "slip-stick", "slip reversal")


def _map(cells: tuple[int, int], samples: int) -> Data:
    """Largest error of both in every cell of a map over tilt and log10 of friction."""
    rng = np.random.default_rng(0)
    tilt = np.linspace(-np.pi / 2, np.pi / 2, cells[0] + 1)
    decade = np.linspace(-3, 3, cells[1] + 1)
    inside = rng.uniform(size=(2, samples, cells[1], cells[0]))
    phi = tilt[:-1] + inside[0] * np.diff(tilt)
    friction = 10 ** (decade[:-1, None] + inside[1] * np.diff(decade)[:, None])
    rod = thin_rod(phi)
    columns = np.broadcast_arrays(1.0, -1.0, 0.7, 0.0, *rod, friction, 0.8)
    impacts = Impacts(*(column.ravel() for column in columns))
    true = reference(impacts)

    def worst(got, *fields):
        return true.ulp(got, *fields).reshape(inside.shape[1:]).max(0)

    ours = impacts.collide(collide)
    return {
        "tilt": tilt,
        "friction": 10**decade,
        "ours": worst(ours, PRINTED_FIELDS),
        "ours_all_fields": worst(ours),
        "literal": worst(literal(impacts), PRINTED_FIELDS),
    }


def _lines(points: int) -> Data:
    """Friction at the boundaries of the regimes and of the Painleve region, over tilt."""
    tilt = np.linspace(-np.pi / 2, np.pi / 2, points)
    rod = thin_rod(tilt)
    X, Z, k = rod
    # the ratio of the contact point stands for that of a rod without spin
    ratio = (1 - 0.7 * X) / (1 - 0.7 * Z)
    slide = slide_friction(rod, approach_ratio=ratio, restitution=0.8)
    holds = np.where((X > 0) & (critical_friction(rod) >= slide), critical_friction(rod), np.nan)
    left = (tilt < 0) & (Z > 1e-9)
    painleve = np.full(points, np.nan)
    painleve[left] = (k[left] ** 2 + X[left] ** 2) / -(X * Z)[left]
    return {
        "line_tilt": tilt,
        "slide_friction": np.where(np.isfinite(slide) & (slide > 0), slide, np.nan),
        "critical_friction": holds,
        "painleve_friction": painleve,
    }


def table(n: int) -> Data:
    """Largest and mean error over random impacts, shape (laws, regimes)."""
    impacts, laws = random_impacts(n, seed=3), len(RESTITUTION_LAWS)
    newton, *_ = true = [reference(impacts, law) for law in RESTITUTION_LAWS]
    got = [impacts.collide(collide, law) for law in RESTITUTION_LAWS]
    errors = [exact.ulp(found) for exact, found in zip(true, got, strict=True)]
    errors += [newton.ulp(found, PRINTED_FIELDS) for found in (got[0], literal(impacts))]
    parts = [(error, True) for error in errors] + [(errors[-1], painleve_sum(impacts) > 0)]
    here = [newton.regime == regime for regime in SLIP_REGIMES]  # under any law
    found = [[error[kept & one] for one in here] for error, kept in parts]
    largest, mean = (np.array([[f(x) for x in row] for row in found]) for f in (np.max, np.mean))
    return {
        "count": np.sum(here, axis=1),
        "table_max": largest[:laws],
        "table_mean": mean[:laws],
        "compared": np.stack([largest[laws:], mean[laws:]], axis=1),
    }


def data(
    quick: bool = False,
    cells: tuple[int, int] | None = None,
    samples: int | None = None,
    impacts: int | None = None,
) -> Data:
    """Errors on the map, shape (friction, tilt), its boundary lines, and the table."""
    cells = cells or ((60, 40) if quick else (180, 120))
    return {
        **_map(cells, samples or (2 if quick else 5)),
        **_lines(201 if quick else 1001),
        **table(impacts or (2_000 if quick else 100_000)),
    }


def _cell(value: float) -> str:
    return f"{value:.2f}" if value < 1e3 else f"{value:.1e}"


def _rows(d: Data) -> list[list[str]]:
    """The table: one row a law, largest and mean by regime."""
    names = [f"all results, {law}" for law in RESTITUTION_LAWS]
    names += ["c_x', c_z', newton", "the same, as printed", "as printed, no Painleve"]
    highs = [*d["table_max"], *d["compared"][:, 0]]
    rows = zip(names, highs, [*d["table_mean"], *d["compared"][:, 1]], strict=True)
    return [
        [name, *(_cell(x) for pair in zip(high, mean, strict=True) for x in pair)]
        for name, high, mean in rows
    ]


def _draw_table(ax: plt.Axes, d: Data) -> None:
    columns = [f"{name}\n{what}" for name in _NAMES for what in ("largest", "mean")]
    rows = _rows(d)
    names = [row[0].replace("c_x', c_z'", "$c_x'$, $c_z'$") for row in rows]
    look = {"cellLoc": "center", "edges": "horizontal", "bbox": (0.12, 0, 0.88, 1)}
    table = ax.table([row[1:] for row in rows], rowLabels=names, colLabels=columns, **look)
    table.auto_set_font_size(False)
    table.set_fontsize(7)
    for (row, _), cell in table.get_celld().items():
        cell.set_linewidth(0.4)
        cell.set_height(0.25 if row == 0 else 0.15)
    ax.set(xticks=[], yticks=[])
    ax.set_xlabel(f"error in ulp over {d['count'].sum()} random impacts", labelpad=6)
    ax.spines[:].set_visible(False)


@style
def draw(d: Data) -> plt.Figure:
    figure, axes = plt.subplot_mosaic("ab;cc", figsize=(7.0, 4.8), height_ratios=(2.1, 1))
    *axes, below = axes.values()
    norm = BoundaryNorm(ULP_LEVELS, 256)
    line = np.degrees(d["line_tilt"])
    titles = {"ours": "impact.collide", "literal": "formulas as printed, mistakes corrected"}
    for ax, key in zip(axes, titles, strict=True):
        look = {"cmap": "viridis", "norm": norm, "rasterized": True}
        worst = np.minimum(d[key], 0.99e16)
        fill = ax.pcolormesh(np.degrees(d["tilt"]), d["friction"], worst, **look)
        ax.plot(line, d["slide_friction"], "w-", label=r"$u_*=0$, Eq. (14)")
        ax.plot(line, d["critical_friction"], "w--", label=r"$\mu(k^2+Z^2)=XZ$, Eq. (16)")
        ax.plot(line, d["painleve_friction"], "w:", label=r"$k^2+X^2+\mu XZ=0$")
        ax.set(yscale="log", ylim=(1e-3, 1e3))
        tilt_axis(ax, -90, 90, 30)
    name_panels(axes, titles.values())
    axes[0].set_ylabel(r"friction $\mu$")
    axes[1].tick_params(labelleft=False)
    look = {"label": "largest error (ulp)", "ticks": ULP_LEVELS, "spacing": "uniform", "pad": 0.01}
    look["format"] = lambda x, _: f"{x:g}" if x < 1e3 else f"$10^{{{round(np.log10(x))}}}$"
    figure.colorbar(fill, ax=axes, **look)
    axes[0].legend(loc="lower left", labelcolor="white", fontsize=6)
    _draw_table(below, d)
    return figure
