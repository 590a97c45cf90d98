"""Why the drift depends on the contact law: where energy and momentum of the row go.

Top: parts of the plate's work that are lost at the plate and between rods, normally and
tangentially; a panel a law. Where they do not add up to all of it, the row has not settled.

Middle: mean force along x on a rod, in its weight: in touches of the plate in which no neighbour
pushes (by the plate alone), in pushed touches (by plate and neighbours), and between touches (by
neighbours alone). In the mean the three cancel, and so do the forces between rods: what the plate
gives to free rods it takes from pushed ones, and what neighbours give to pushed rods they take from
flying ones.

Bottom: drift over tilt, and of the theory at V_z = V_0/2 (grey); drift, velocity of the plate at a
touch and length of flights over the part of the work that is lost between rods, joined in the order
of the tilt, the smallest one open. If this part decided, all laws would lie on one curve. Flights:
touches less than 0.2 periods apart taken as one landing.

V_0 is the largest velocity of the plate. Tilts are measured. All is behind the transient: means
over independent starts, with standard errors.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from impact import drift
from md.sweep import Sweep

from ..lib.runs import (
    LAW,
    PRINTED,
    SEEDS,
    SETTING,
    SIMPLE,
    SIMPLE_ROW,
    TILT_SCAN_WORDS,
    boxes,
    gathered,
    larger_error,
    over_seeds,
    paper_rod,
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
from ..lib.tables import columned, pairs
from .contact_laws import LAW_TILTS_DEG, QUICK_DEG
from .flows import LOSSES, WAYS, flows

FLOW_LAWS = {  # what a law changes in `runs.SIMPLE_ROW`
    "law of the figures": LAW,
    "Appendix A as printed": PRINTED,
    "0.65, ratio 3": SIMPLE,
}
MEASURED = ("power", *LOSSES, "rods", *WAYS, "together", "carried", "mobilised", "free_touches")
MEASURED += ("c_x", "tilt", "V_z", "flight")
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
LAW_LOOKS = (BLACK, "o-"), (ORANGE, "s-"), (BLUE, "^-"), (GREEN, "D-"), (RED, "v-")
ACROSS = {
    "c_x": r"drift $c_x/V_0$",
    "V_z": r"plate at a touch $V_z/V_0$",
    "flight": "flight (periods)",
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
    fine = np.radians(np.linspace(1, 89, 177))
    theory = drift(paper_rod(fine), **SETTING, plate_velocity=0.5).c_x
    return {
        "law": np.array([*runs]),
        "nominal": np.array(QUICK_DEG if quick else LAW_TILTS_DEG),
        **found,
        "fine_deg": np.degrees(fine),
        "theory": theory,
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


def _over_tilt(ax: Axes, d: Data, name: str, law: int, label: str, colour: str, form: str) -> None:
    y, error = d[name][law], d[f"{name}_error"][law]
    points(ax, d["tilt"][law], y, error, colour, label=label, form=form)


def _draw_momentum(ax: Axes, d: Data, law: int) -> None:
    ax.axhline(0, color="0.7", lw=0.6)
    for name, look in WAY_LOOKS.items():
        _over_tilt(ax, d, name, law, *look)


def _draw_drift(ax: Axes, d: Data) -> None:
    ax.plot(d["fine_deg"], d["theory"], color="0.6", lw=0.8)
    ax.axhline(0, color="0.7", lw=0.6)
    for n, law in enumerate(d["law"].tolist()):
        _over_tilt(ax, d, "c_x", n, law, *LAW_LOOKS[n])
    tilt_axis(ax, 0, 75)
    ax.set_ylabel(ACROSS["c_x"])


def _draw_across(ax: Axes, d: Data, name: str) -> None:
    """One point a law and tilt, over what is lost between rods; the smallest tilt is open."""
    for n, (colour, form) in enumerate(LAW_LOOKS[: len(d["law"])]):
        x, y, error = d["rods"][n], d[name][n], d[f"{name}_error"][n]
        points(ax, x, y, error, colour, form=form, xerr=d["rods_error"][n], lw=0.4)
        ax.plot(x[0], y[0], form[0], color=colour, mfc="white", ms=3, mew=0.7, zorder=3)
    ax.set(xlabel="lost between rods / work", ylabel=ACROSS[name], xlim=(0, None))


@style
def draw(d: Data) -> plt.Figure:
    laws = d["law"].tolist()
    figure = plt.figure(figsize=(7.2, 6.8))
    parts = figure.subfigures(3, 1)
    shared = {"sharex": True, "sharey": True, "squeeze": False}
    losses, momentum = (part.subplots(1, len(laws), **shared)[0] for part in parts[:2])
    for n in range(len(laws)):
        _draw_losses(losses[n], d, n)
        _draw_momentum(momentum[n], d, n)
    for ax in (*losses, *momentum):
        tilt_axis(ax, 0, 75)
    losses[0].set_ylabel("part of the plate's work")
    momentum[0].set_ylabel(r"force along $x$ ($mg$)")
    for part, row in zip(parts, (losses, momentum), strict=False):
        legend_above(part, row[0], ncols=4)
    bottom = parts[2].subplots(1, 1 + len(ACROSS))
    _draw_drift(bottom[0], d)
    for ax, name in zip(bottom[1:], ACROSS, strict=True):
        _draw_across(ax, d, name)
    legend_above(parts[2], bottom[0], ncols=len(laws))
    name_panels([*losses, *momentum, *bottom], [*laws, *laws, *[""] * len(bottom)])
    figure.supxlabel(f"{TILT_SCAN_WORDS} (the law of the figures)")
    return figure


def summary(d: Data) -> str:
    """Three tables of each law: energy, momentum, motion; a row a tilt."""
    lines = ["parts of the plate's work, forces in the weight, velocities in V_0; ± one s.e."]
    for n, law in enumerate(d["law"]):
        tilt = {"tilt": d["nominal"]}
        energy = {"work/(weight V_0)": "power", **{LOSS_LOOKS[k][0]: k for k in LOSSES}}
        energy |= {"rods": "rods"}
        found = {head: pairs(d, name, n) for head, name in energy.items()}
        found |= {"change": d["change"][n], "residual": d["residual"][n]}
        lines += [f"{law}: energy", columned(tilt | found, 4)]
        momentum = {"free: plate": "free", "pushed": "pushed", "between": "aloft"}
        momentum |= {"sum": "together", "weight carried free": "carried"}
        momentum |= {"friction/normal force, free": "mobilised", "touches free": "free_touches"}
        found = {head: pairs(d, name, n) for head, name in momentum.items()}
        lines += [f"{law}: momentum along x", columned(tilt | found, 4)]
        motion = {"measured tilt": "tilt", "c_x": "c_x", "V_z": "V_z", "flight (periods)": "flight"}
        found = {head: pairs(d, name, n) for head, name in motion.items()}
        lines += [f"{law}: motion", columned(tilt | found, 3)]
    return "\n".join(lines)
