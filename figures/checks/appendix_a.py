"""Readings of Appendix A: restitution over tilt, and the distance from the rigid theory.

Two claims are tried on every reading: a kinematic restitution of 0.65 to 0.7 that varies slightly
with the angle, and impacts that follow the closed forms with a constant 0.65 (the scene of
Fig. 12). What the text leaves open: where the factor of the overlap belongs (as printed in the
dashpots and in the tangential spring k_t delta s; the printed units have it in neither), whether
the unit of mass is the rod's or the virtual sphere's, of which the rod then has 1 + 3 h_0/2, what
M_e is at the plate, and the inertia. "Neither" stands for a spring k_t s: its stiffness has that
value at the deepest overlap of a head-on impact, and goes as the root of the overlap before. (e):
the printed law fails because its spring is soft and almost undamped: at this speed k_t delta is
4.5 times k_n sqrt(delta), and less the stiffer the plate. It is still wound up when a rigid contact
would stick or have turned, and what it stores it gives back.
"""

from dataclasses import replace
from itertools import product
from math import sqrt

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

import md
from md.laws import STIFFNESS, deepest_overlap

from ..lib.soft_impacts import (
    ROD,
    TABLE_TILTS,
    distance,
    from_theory,
    rigid,
    scene_words,
    simulate,
)
from ..lib.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    RED,
    Data,
    legend_above,
    log_log,
    name_panels,
    note,
    shades,
    style,
    tilt_axis,
)

WHERE = ("dashpots and spring", "spring alone", "neither")  # the factor of the overlap
ROD_MASS = 1 + 1.5 * (ROD.length - 1)  # in masses of the sphere
MASSES = {  # unit of mass, M_e: k_n and M_e in masses of the rod
    "rod, M/2": (1.0, 0.5),
    "rod, M": (1.0, 1.0),
    "sphere, M/2": (1 / ROD_MASS, 0.5),
    "sphere, M": (1 / ROD_MASS, 1.0),
    "sphere, m/2": (1 / ROD_MASS, 0.5 / ROD_MASS),
    "sphere, m": (1 / ROD_MASS, 1.0 / ROD_MASS),
}
INERTIAS = ("thin", "solid")
CLAIMED = (0.65, 0.7)
PRINTED_RATIO = 95.0
DAMPINGS = (0.0, 0.1, 0.3, 1.0)  # of the tangential spring, over the critical one
COLOURS = BLACK, "#888888", GREEN, ORANGE, BLUE, RED  # of `MASSES`
WIDE = 4.2, 3.4, 2.6, 1.9, 1.2, 0.6  # where curves coincide, all show
TILTS = np.append(0.0, TABLE_TILTS)


def reading(where: str, mass: str) -> md.Law:
    """The law of one reading."""
    light, reduced = MASSES[mass]
    factor = where == WHERE[0]
    law = md.appendix_a(STIFFNESS * light, reduced_mass=reduced, overlap_factor=factor)
    if where != WHERE[2]:
        return law
    root = PRINTED_RATIO * STIFFNESS * light / sqrt(deepest_overlap(law, 1.0))
    return replace(law, spring=law.spring._replace(proportional=None, root=root))


def _measured(where: str, mass: str, inertia: str) -> tuple[np.ndarray, list[np.ndarray]]:
    """Restitution; RMS distance from theory at the claimed 0.65, and at the measured one."""
    law, rod = reading(where, mass), replace(ROD, inertia=inertia)
    soft = simulate(TABLE_TILTS, law, rod=rod)
    taken = CLAIMED[0], soft.restitution
    off = [distance(soft, rigid(TABLE_TILTS, restitution, rod)) for restitution in taken]
    return simulate(TILTS, law, rod=rod).restitution, off


def _why(ratios: np.ndarray) -> Data:
    """RMS from theory at measured restitution over stiffness and damping of the printed spring."""
    off = []
    for damping, ratio in product(DAMPINGS, ratios):
        law = md.appendix_a(tangential_ratio=ratio)
        spring = law.spring._replace(proportional_dashpot=None, damping_ratio=damping or None)
        off.append(from_theory(replace(law, spring=spring))[0])
    root = sqrt(deepest_overlap(md.appendix_a(), 1.0))
    why = np.reshape(off, (len(DAMPINGS), -1))
    return {"ratio": ratios * root, "printed_ratio": PRINTED_RATIO * root, "why": why}


def data(quick: bool = False) -> Data:
    """Restitutions (where, mass, inertia, tilt) and distances of 36 readings, and why."""
    shape = len(WHERE), len(MASSES), len(INERTIAS), -1
    found = [_measured(*one) for one in product(WHERE, MASSES, INERTIAS)]
    restitution, off = zip(*found, strict=True)
    checked = [reading(*one) for one in product(WHERE, ["rod, M/2"] if quick else MASSES)]
    halved = [[simulate(TABLE_TILTS, law, refine=n) for n in (32, 64)] for law in checked]
    return {
        "tilt": TILTS,
        "restitution": np.reshape(restitution, shape),
        "compared": np.reshape(off, shape),
        **_why(PRINTED_RATIO * 10 ** np.linspace(-1, 4, 6 if quick else 11)),
        "step_error": np.max([distance(*pair) for pair in halved]),
    }


def miss(restitution: np.ndarray) -> np.ndarray:
    """Root-mean-square distance from the claimed range, over the tilts, the last axis."""
    off = restitution - np.clip(restitution, *CLAIMED)
    return np.sqrt(np.mean(off**2, axis=-1))


def _draw_tilts(ax, d, where: int):
    ax.axhspan(*CLAIMED, color="0.85", lw=0)
    ax.set_prop_cycle(color=COLOURS, lw=WIDE)
    ax.plot(np.degrees(d["tilt"]), d["restitution"][where, :, 0].T, label=[*MASSES])
    tilt_axis(ax, step=30, ylim=(0, 1.03))


def _draw_distances(ax, d):
    for where, marker, off in zip(WHERE, "osD", d["compared"][:, :, 0], strict=True):
        ax.scatter(*off.T, 12, marker=marker, facecolor="none", edgecolor=COLOURS)
        ax.plot([], [], marker, color="0.3", mfc="none", label=where)
    ax.plot([0.02, 1], [0.02, 1], "-", color="0.7", lw=0.6)
    log_log(
        ax,
        xlabel=r"RMS, $\epsilon=0.65$",
        xlim=(0.03, 0.7),
        ylabel=r"RMS, measured $\epsilon$",
        ylim=(3e-5, 0.5),
    )
    ax.set_xticks([0.05, 0.1, 0.2, 0.5], labels=["0.05", "0.1", "0.2", "0.5"])
    ax.set_xticks([], minor=True)
    ax.legend(loc="lower left", title="overlap factor in")


def _draw_why(ax, d):
    ax.set_prop_cycle(color=shades(len(DAMPINGS)))
    ax.plot(d["ratio"], d["why"].T, label=[f"{z:g}" for z in DAMPINGS])
    ax.plot(d["printed_ratio"], d["compared"][0, 0, 0, 1], "k*", ms=8, label="printed")
    log_log(
        ax,
        xlabel=r"$k_t\delta/(k_n\delta^{1/2})$, deepest overlap",
        ylabel=r"RMS, measured $\epsilon$",
        ylim=(3e-5, 0.5),
    )
    ax.legend(title="damping ratio", loc="lower left")


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplot_mosaic("aabbcc;dddeee", figsize=(7.0, 4.9))
    for where, panel in enumerate("abc"):
        _draw_tilts(axes[panel], d, where)
    axes["a"].set_ylabel(r"restitution $-v_f/v_0$")
    _draw_distances(axes["d"], d)
    _draw_why(axes["e"], d)
    titles = "factor as printed", "factor in the spring alone", "no overlap factor"
    name_panels(axes.values(), (*titles, "velocities from theory", "printed spring varied"))
    words = r"unit of mass (rod or virtual sphere) and $M_e$ ($M$ rod, $m$ sphere)"
    legend_above(figure, axes["a"], ncols=6, title=words)
    law = r"Appendix A: $k_n=5\times10^6$, $k_t=95\,k_n$, $\gamma=400$"
    note(figure, f"{law}; grey: the claimed 0.65-0.7; {scene_words()}")
    return figure
