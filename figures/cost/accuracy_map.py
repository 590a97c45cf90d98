"""Error of an impact in units in the last place: ours, and the paper's formulas taken literally.

A thin rod (c_x = 1, c_z = -1, omega = 0.7/l, restitution 0.8); each pixel shows the worst of
c_x' and c_z' over a few impacts inside it, the only two for which the paper prints formulas. Their
mistakes are corrected, (12), (13) and (21), but nothing is rewritten. Dotted: the Painlevé region,
where (14) takes a contact that stops and sticks for a slide of negative impulse, and no digit of
the printed formulas is right.
The largest errors over random impacts under each law stand on the page of prices.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure

from impact import collide, critical_friction, painleve_friction, slide_friction, thin_rod

from ..lib.exact_impacts import Impacts, Literal, literal, reference
from ..lib.style import Data, name_panels, style, tilt_axis

ULP_LEVELS = (0, 0.5, 1, 2, 4, 16, 256, 1e4, 1e8, 1e16, 1e21)  # of the colours, ulp


def _map(cells: tuple[int, int], samples: int) -> Data:
    """Largest errors [ulp] of both ways in the cells (friction, tilt) of a map, and its edges."""
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

    def worst(got):
        return true.ulp(got, Literal._fields).reshape(inside.shape[1:]).max(0)

    return {
        "tilt": tilt,
        "friction": 10**decade,
        "ours": worst(impacts.collide(collide)),
        "literal": worst(literal(impacts)),
    }


def _lines(points: int) -> Data:
    """Friction at the boundaries of the regimes and of the Painlevé region, over tilt."""
    tilt = np.linspace(-np.pi / 2, np.pi / 2, points)
    rod = thin_rod(tilt)
    X, Z, _ = rod
    # the ratio of the contact point stands for that of a rod without spin
    ratio = (1 - 0.7 * X) / (1 - 0.7 * Z)
    slide = slide_friction(rod, approach_ratio=ratio, restitution=0.8)
    critical = critical_friction(rod)
    left = (tilt < 0) & (Z > 1e-9)
    return {
        "line_tilt": tilt,
        "slide_friction": np.where(np.isfinite(slide) & (slide > 0), slide, np.nan),
        "critical_friction": np.where((X > 0) & (critical >= slide), critical, np.nan),
        "painleve_friction": np.where(left, painleve_friction(rod), np.nan),
    }


def data(quick: bool = False) -> Data:
    """Errors on the map, shape (friction, tilt), and its boundary lines."""
    cells, samples, points = ((45, 30), 2, 201) if quick else ((180, 120), 5, 1001)
    return _map(cells, samples) | _lines(points)


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplots(1, 2, figsize=(7.0, 3.4))
    norm = BoundaryNorm(ULP_LEVELS, 256)
    line = np.degrees(d["line_tilt"])
    titles = {"ours": "impact.collide", "literal": "formulas as printed, mistakes corrected"}
    for ax, key in zip(axes, titles, strict=True):
        fill = ax.pcolormesh(
            np.degrees(d["tilt"]), d["friction"], d[key], cmap="viridis", norm=norm, rasterized=True
        )
        ax.plot(line, d["slide_friction"], "w-", label=r"$u_*=0$, Eq. (14)")
        ax.plot(line, d["critical_friction"], "w--", label=r"$\mu(k^2+Z^2)=XZ$, Eq. (16)")
        ax.plot(line, d["painleve_friction"], "w:", label="Painlevé's friction")
        tilt_axis(ax, -90, 90, 30, yscale="log", ylim=(1e-3, 1e3))
    name_panels(axes, titles.values())
    axes[0].set_ylabel(r"friction $\mu$")
    axes[1].tick_params(labelleft=False)
    figure.colorbar(
        fill,
        ax=axes,
        label="largest error (ulp)",
        ticks=ULP_LEVELS,
        spacing="uniform",
        pad=0.01,
        format=lambda x, _: f"{x:g}" if x < 1e3 else f"$10^{{{round(np.log10(x))}}}$",
    )
    axes[0].legend(loc="lower left", labelcolor="white", frameon=False)
    return figure
