"""Why the drift depends on the contact law: where energy and momentum of the row go.

Top: parts of the plate's work that are lost at the plate and between rods, normally and
tangentially; a panel a law. Where they do not add up to all of it, the row has not settled.

Bottom: mean force along x on a rod, in its weight: in touches of the plate in which no neighbour
pushes (by the plate alone), in pushed touches (by plate and neighbours), and between touches (by
neighbours alone). In the mean the three cancel, and so do the forces between rods: what the plate
gives to free rods it takes from pushed ones, and what neighbours give to pushed rods they take from
flying ones.

Tilts are measured. All is behind the transient: means over independent starts, with standard
errors.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from md.sweep import Sweep

from ..claims.over_laws import LAW_TILTS_DEG, QUICK_DEG
from ..lib.runs import (
    LAW,
    PRINTED,
    SEEDS,
    SIMPLE,
    SIMPLE_ROW,
    TILT_SCAN_WORDS,
    boxes,
    gathered,
    larger_error,
    over_seeds,
    periods_of,
    planned,
)
from ..lib.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    RED,
    Data,
    legend_above,
    name_panels,
    points,
    style,
    tilt_axis,
)
from .flows import LOSSES, WAYS, flows

FLOW_LAWS = {  # what a law changes in `runs.SIMPLE_ROW`
    "law of the figures": LAW,
    "Appendix A as printed": PRINTED,
    "0.65, ratio 3": SIMPLE,
}
MEASURED = (*LOSSES, "rods", *WAYS, "carried", "tilt")
LOSS_LOOKS = {
    "plate_normal": ("plate, normal", BLUE, ""),
    "plate_friction": ("plate, tangential", GREEN, ""),
    "rods_normal": ("rods, normal", RED, "////"),
    "rods_friction": ("rods, tangential", ORANGE, "////"),
}
WAY_LOOKS = {
    "free": ("free touches: plate", BLUE, "o-"),
    "pushed": ("pushed touches: plate and neighbours", RED, "s-"),
    "aloft": ("between touches: neighbours", BLACK, "^-"),
}


def sweeps(quick: bool = False) -> dict[str, Sweep]:
    """Of each law: flows over tilt, and over starts."""
    axes = [{"box.length": boxes(QUICK_DEG if quick else LAW_TILTS_DEG)}, SEEDS]
    how = SIMPLE_ROW, flows
    return {law: planned(axes, periods_of(quick), of, *how) for law, of in FLOW_LAWS.items()}


def data(quick: bool = False) -> Data:
    """Of each law, over the nominal tilts: `flows.flows`, with errors over starts."""
    runs, found = sweeps(quick), {}
    for name in MEASURED:
        of_laws = [
            larger_error(*np.moveaxis(*gathered(sweep, name), -1, 0)) for sweep in runs.values()
        ]
        found[name], found[f"{name}_error"] = np.moveaxis(of_laws, 1, 0)
    for name in ("change", "residual"):
        found[name] = np.array([over_seeds(*gathered(sweep, name))[0] for sweep in runs.values()])
    return {
        "law": np.array([*runs]),
        "nominal": np.array(QUICK_DEG if quick else LAW_TILTS_DEG),
        **found,
    }


def _draw_losses(ax: Axes, d: Data, law: int) -> None:
    """Bars of the parts of the work, those below zero downwards."""
    ax.axhline(1, color="0.7", lw=0.6, zorder=0)
    top, bottom = np.zeros((2, d["nominal"].size))
    for name, (label, colour, hatch) in LOSS_LOOKS.items():
        part = d[name][law]
        look = {"color": colour, "hatch": hatch, "edgecolor": "white", "lw": 0.4}
        ax.bar(d["tilt"][law], part, 4, np.where(part < 0, bottom, top), label=label, **look)
        top, bottom = top + np.maximum(part, 0), bottom + np.minimum(part, 0)


def _draw_momentum(ax: Axes, d: Data, law: int) -> None:
    ax.axhline(0, color="0.7", lw=0.6)
    for name, (label, colour, form) in WAY_LOOKS.items():
        error = d[f"{name}_error"][law]
        points(ax, d["tilt"][law], d[name][law], error, colour, label=label, form=form)


@style
def draw(d: Data) -> plt.Figure:
    laws = d["law"].tolist()
    figure = plt.figure(figsize=(7.2, 4.8))
    parts, shared = figure.subfigures(2, 1), {"sharex": True, "sharey": True}
    losses, momentum = (part.subplots(1, len(laws), **shared) for part in parts)
    for n in range(len(laws)):
        _draw_losses(losses[n], d, n)
        _draw_momentum(momentum[n], d, n)
    for ax in (*losses, *momentum):
        tilt_axis(ax, 0, 75)
    losses[0].set_ylabel("part of the plate's work")
    momentum[0].set_ylabel(r"force along $x$ ($mg$)")
    for part, row in zip(parts, (losses, momentum), strict=True):
        legend_above(part, row[0], ncols=4)
    name_panels([*losses, *momentum], [*laws, *laws])
    figure.supxlabel(f"{TILT_SCAN_WORDS} (the law of the figures)")
    return figure
