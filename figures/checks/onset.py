"""Reverse drift near Gamma = 1 under four contact laws, and whether V_z explains it.

Top: drift of the row over the plate's acceleration, linear within the floor of Fig. 2 (grey),
logarithmic beyond; bottom: mean velocity of the plate at a touch, each weighted by its speed of
approach, over the largest velocity of the plate. The paper's explanation asks that rows drift
backwards where this is negative. A column a tilt; means and standard errors over starts. Rods of
uniform density, l = 9.5 d.
"""

import matplotlib.pyplot as plt
import numpy as np

from md.sweep import Sweep

from ..lib.runs import (
    LAW,
    LENGTH,
    PRINTED,
    RESOLVED,
    SECOND,
    SIMPLE,
    SIMPLE_ROW,
    boxes,
    drift_and_tilt,
    means,
    planned,
)
from ..lib.style import BLACK, BLUE, GREEN, RED, Data, curve, legend_above, name_panels, style
from ..lib.tables import table
from ..paper.fig02 import AT_TOUCH, FLOOR_CM_S, ONSET, classify

LAWS = {  # what a law changes in `runs.SIMPLE_ROW`
    "law of the figures": LAW,
    "another of the best laws": SECOND | RESOLVED,
    "0.65, ratio 3": SIMPLE,
    "Appendix A as printed": PRINTED,
}
LOOKS = ((BLACK, "o-"), (GREEN, "^-"), (BLUE, "s-"), (RED, "D-"))
ONSET_DEG = {True: (20, 40), False: (9, 20, 40)}
ONSET_GAMMAS = {True: (1.05, 1.2, 1.6), False: (1.02, 1.05, 1.1, 1.15, 1.2, 1.3, 1.4, ONSET)}


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Of each law: over Gamma, over tilt, over starts."""
    axes = [{"plate.acceleration": [*ONSET_GAMMAS[quick]]}, {"box.length": boxes(ONSET_DEG[quick])}]
    axes.append({"start.seed": [1, 2] if quick else [1, 2, 3]})
    solid, periods = {"rods.inertia": "solid"}, 40 if quick else 300
    return {
        law: planned(axes, periods, changes | solid, SIMPLE_ROW) for law, changes in LAWS.items()
    }


def data(quick: bool = False) -> Data:
    """Drift [cm/s] and V_z/V_0 with standard errors, (laws, Gamma, tilt)."""
    runs = sweeps(quick).values()
    of_laws = [drift_and_tilt(sweep) | means(sweep, {"V_z": AT_TOUCH}) for sweep in runs]
    return {
        "gamma": np.array(ONSET_GAMMAS[quick]),
        "nominal_deg": np.array(ONSET_DEG[quick], float),
        **{name: np.array([of[name] for of in of_laws]) for name in of_laws[0]},
    }


@style
def draw(d: Data) -> plt.Figure:
    columns = len(d["nominal_deg"])
    figure, axes = plt.subplots(2, columns, figsize=(7.0, 4.2), sharex=True, sharey="row")
    for j in range(columns):
        for i, (law, (colour, form)) in enumerate(zip(LAWS, LOOKS, strict=True)):
            for ax, name in zip(axes[:, j], ("c_x", "V_z"), strict=True):
                curve(ax, d, "gamma", name, colour, law, at=(i, ..., j), form=form, ms=3)
    name_panels(axes.flat, [rf"$\phi={tilt:g}$°" for tilt in d["nominal_deg"]] * 2)
    for above, below in axes.T:
        above.set_yscale("symlog", linthresh=FLOOR_CM_S)
        above.set(xlabel=r"acceleration $\Gamma$", yticks=[-1, -0.1, -0.01, 0, 0.01, 0.1, 1, 10])
        above.axhspan(-FLOOR_CM_S, FLOOR_CM_S, color="0.88", lw=0)
        below.axhline(0, color="0.6", lw=0.6)
        below.set(xlabel=r"acceleration $\Gamma$")
    axes[0, 0].set_ylabel(r"drift $c_x$ (cm/s)")
    axes[1, 0].set_ylabel(r"plate at a touch $V_z/V_0$")
    legend_above(figure, axes[0, 0], ncols=2)
    figure.supxlabel(rf"$l={LENGTH}\,d$, solid inertia, 60 Hz")
    return figure


def summary(d: Data) -> str:
    """Of each law: points that drift backwards, points where V_z is negative, signs that agree."""
    kind, down = classify(d["c_x"], d["c_x_error"]), d["V_z"] < 0
    rows = []
    for i, law in enumerate(LAWS):
        moving, back = kind[i] != 0, kind[i] < 0
        agree = np.mean((kind[i] > 0)[moving] == ~down[i][moving]) if moving.any() else np.nan
        counts = (n.sum() for n in (back, back & down[i], down[i], moving))
        rows.append([law, *counts, agree, np.nanmin(d["c_x"][i]), np.nanmin(d["V_z"][i])])
    heads = ("law", "backwards", "with V_z < 0", "V_z < 0", "drift at all", "signs agree")
    heads += ("lowest c_x (cm/s)", "lowest V_z/V_0")
    title = f"points a law; backwards: beyond 3 standard errors and {FLOOR_CM_S} cm/s"
    return f"{d['c_x'][0].size} {title}\n{table(heads, rows, (0, 0, 0, 0, 0, 2, 4, 3))}"
