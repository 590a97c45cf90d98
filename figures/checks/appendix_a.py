"""Readings of Appendix A: restitution over tilt and speed, and the distance from the rigid theory.

Two claims are tried on every reading: a kinematic restitution of 0.65 to 0.7 that varies slightly
with the angle, and impacts that follow the closed forms with a constant 0.65 (the scene of
Fig. 12). What the text leaves open: where the factor of the overlap belongs (as printed in the
dashpots and in the tangential spring k_t delta s; the printed units have it in neither), whether
the unit of mass is the rod's or the virtual sphere's, of which the rod then has 1 + 3 h_0/2, what
M_e is at the plate, and the inertia. "Neither" stands for a spring k_t s: its stiffness has that
value at the deepest overlap of a head-on impact, and goes as the root of the overlap before. (f):
the printed law fails because its spring is soft and almost undamped: at this speed k_t delta is
4.5 times k_n sqrt(delta), and less the stiffer the plate. It is still wound up when a rigid contact
would stick or have turned, and what it stores it gives back.
"""

from dataclasses import replace
from itertools import product
from math import sqrt

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from scipy.optimize import brentq

import md
from md.laws import STIFFNESS, deepest_overlap

from ..lib.soft_impacts import (
    ROD,
    SCENE_WORDS,
    TABLE_TILTS,
    compared,
    distance,
    from_theory,
    rigid,
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
    name_panels,
    style,
    tilt_axis,
)
from ..lib.tables import table

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
READINGS = WHERE, MASSES, INERTIAS
CLAIMED = (0.65, 0.7)
PRINTED_RATIO = 95.0
MENDED = (WHERE[0], WHERE[2])  # with the gamma that gives 0.65 head on at speed 1
DAMPINGS = (0.0, 0.1, 0.3, 1.0)  # of the tangential spring, over the critical one
_COLOURS = (BLACK, "#888888", GREEN, ORANGE, BLUE, RED)
_HEAD_ON, _TILTS = np.zeros(1), np.append(0.0, TABLE_TILTS)


def reading(where: str, mass: str, speed: float = 1.0, damping: float = 400.0) -> md.Law:
    """The law of one reading, for impacts at about this speed."""
    light, reduced = MASSES[mass]
    how = {"tangential_ratio": PRINTED_RATIO, "damping": damping, "reduced_mass": reduced}
    law = md.appendix_a(STIFFNESS * light, **how, overlap_factor=where == WHERE[0])
    if where != WHERE[2]:
        return law
    root = PRINTED_RATIO * STIFFNESS * light / sqrt(deepest_overlap(law, speed))
    return replace(law, spring=law.spring._replace(proportional=None, root=root))


def _head_on(law: md.Law, speed: float) -> float:
    return float(simulate(_HEAD_ON, law, speed=speed).restitution[0])


def _needed(where: str, claimed: float, mass: str, speed: float) -> float:
    """Gamma with which a reading has the claimed restitution head on."""

    def off(log_gamma):
        return _head_on(reading(where, mass, speed, 10**log_gamma), speed) - claimed

    return 10 ** brentq(off, 0, 7, rtol=1e-5)


def _at_both(law: md.Law, rod: md.Rod) -> tuple[float, float, float, float]:
    """RMS from theory at 0.65, regimes right there; the same at the measured restitution."""
    soft = simulate(TABLE_TILTS, law, rod=rod)
    at_constant = compared(soft, rigid(TABLE_TILTS, 0.65, rod))
    return *at_constant, *compared(soft, rigid(TABLE_TILTS, soft.restitution, rod))


def _readings(speeds: np.ndarray) -> Data:
    """Of shape (where, mass, inertia, ...), speeds and tilts last."""
    shape = tuple(map(len, READINGS))
    restitution, off = np.empty((*shape, speeds.size, _TILTS.size)), np.empty((*shape, 4))
    for at in np.ndindex(shape):
        where, mass, inertia = (list(names)[i] for names, i in zip(READINGS, at, strict=True))
        rod = ROD._replace(inertia=inertia)
        for n, speed in enumerate(speeds):
            law = reading(where, mass, speed)
            restitution[at][n] = simulate(_TILTS, law, speed=speed, rod=rod).restitution
        off[at] = _at_both(reading(where, mass), rod)
    return {"restitution": restitution, "compared": off}


def _why(ratios: np.ndarray) -> Data:
    """RMS from theory at measured restitution over stiffness and damping of the printed spring."""
    off = np.empty((len(DAMPINGS), ratios.size))
    for (i, damping), (j, ratio) in product(enumerate(DAMPINGS), enumerate(ratios)):
        law = md.appendix_a(tangential_ratio=ratio)
        spring = law.spring._replace(proportional_dashpot=None, damping_ratio=damping or None)
        off[i, j] = from_theory(replace(law, spring=spring))[0]
    root = sqrt(deepest_overlap(md.appendix_a(), 1.0))
    return {"ratio": ratios * root, "printed_ratio": np.float64(PRINTED_RATIO * root), "why": off}


def data(quick: bool = False) -> Data:
    """Restitutions and distances of 36 readings, gamma needed, and the printed law varied."""
    speeds = np.array([0.5, 1.0, 3.0]) if quick else np.array([0.5, 0.8, 1.0, 1.7, 3.0])
    ratios = PRINTED_RATIO * 10 ** np.linspace(-1, 4, 6 if quick else 11)
    ends = np.array([0.5, 1.0, 3.0])
    needed = [[[_needed(WHERE[0], e, m, v) for v in ends] for e in CLAIMED] for m in MASSES]
    gammas = [_needed(where, CLAIMED[0], "rod, M/2", 1.0) for where in MENDED]
    mended = [reading(w, "rod, M/2", damping=g) for w, g in zip(MENDED, gammas, strict=True)]
    check = [reading(*one) for one in product(WHERE, ["rod, M/2"] if quick else MASSES)]
    pairs = [[simulate(TABLE_TILTS, law, refine=n) for n in (32, 64)] for law in check]
    return {
        "tilt": _TILTS,
        "speed": speeds,
        **_readings(speeds),
        "needed_speed": ends,
        "needed": np.array(needed),
        "mended_gamma": np.array(gammas),
        "mended_head_on": np.array([[_head_on(law, v) for v in ends] for law in mended]),
        "mended_restitution": np.array([simulate(_TILTS, law).restitution for law in mended]),
        "mended_compared": np.array([_at_both(law, ROD) for law in mended]),
        **_why(ratios),
        "step_error": np.max([distance(*pair) for pair in pairs]),
    }


def miss(restitution: np.ndarray, axes) -> np.ndarray:
    """Root-mean-square distance from the claimed range."""
    off = restitution - np.clip(restitution, *CLAIMED)
    return np.sqrt(np.mean(off**2, axis=axes))


def best(d: Data) -> dict[str, tuple[int, int]]:
    """(where, mass) of thin inertia that come nearest to each claim."""
    one = int(np.argmin(abs(d["speed"] - 1)))
    off, theory = miss(d["restitution"][:, :, 0, one], -1), d["compared"][:, :, 0, 0]
    scores = {
        "restitution, |c_z| = 1": off,
        "restitution, all speeds": miss(d["restitution"][:, :, 0], (-2, -1)),
        "theory at 0.65": theory,
        "both, added in squares": np.hypot(off, theory),
        "theory at measured": d["compared"][:, :, 0, 2],
    }
    return {name: np.unravel_index(score.argmin(), score.shape) for name, score in scores.items()}


def summary(d: Data) -> str:
    """The table of readings; RMS over 17 tilts, 5 to 85 degrees."""
    one, masses = int(np.argmin(abs(d["speed"] - 1))), list(MASSES)

    def span(e: np.ndarray) -> str:
        return f"{e.min():.3f}-{e.max():.3f}"

    heads = ("overlap factor in", "unit, M_e", "e_0", "tilts", "miss", "head on", "all")
    heads += ("at 0.65", "measured", "right", "right", "solid: at 0.65", "measured")
    rows = []
    for (i, where), (j, mass) in product(enumerate(WHERE), enumerate(masses)):
        e, (thin, solid) = d["restitution"][i, j, 0], d["compared"][i, j]
        ranges = span(e[one]), miss(e[one], -1), span(e[:, 0]), span(e)
        right_of_17 = [int(n) for n in thin[1::2]]
        rows.append((where, mass, e[one, 0], *ranges, *thin[::2], *right_of_17, *solid[::2]))
    lines = [
        "-v_f/v_0 at |c_z| = 1: head on (e_0), range over tilts (0 to 85 degrees), RMS distance",
        "from 0.65-0.7; ranges over |c_z| = 0.5 to 3, head on and over all tilts; RMS of",
        "(c_x', c_z') from theory at 0.65, at measured, regimes right of 17 with either",
        table(heads, rows, (*[3] * 8, 4, 0, 0, 3, 4)),
    ]
    rows = [(claim, f"{WHERE[i]}; {masses[j]}") for claim, (i, j) in best(d).items()]
    lines += [table(("nearest to", "factor in; unit, M_e"), rows)]
    heads = [f"{e}, v = {v:g}" for e in CLAIMED for v in d["needed_speed"]]
    rows = [(mass, *row.ravel()) for mass, row in zip(masses, d["needed"], strict=True)]
    lines += ["gamma for 0.65 and 0.7 head on with the factor as printed (which is 400)"]
    lines += [table(("unit, M_e", *heads), rows, ".3g")]
    heads = "rod, M/2; factor in", "gamma", "head on, v = 0.5, 1, 3", "tilts"
    mended = (d[f"mended_{key}"] for key in ("gamma", "head_on", "restitution", "compared"))
    rows = [
        (where, gamma, ", ".join(f"{x:.3f}" for x in head_on), span(e), off[0], off[2], int(off[3]))
        for where, gamma, head_on, e, off in zip(MENDED, *mended, strict=True)
    ]
    lines += [table((*heads, "at 0.65", "measured", "right"), rows, ".4g")]
    lines += ["printed law (rod, M/2) with its spring varied, RMS from theory at measured"]
    rows = [(f"{z:g}", *row) for z, row in zip(DAMPINGS, d["why"], strict=True)]
    lines += [table(("damping; k_t d/(k_n d^(1/2))", *d["ratio"]), rows, ".3g")]
    last = f"halving the step moves velocities by at most {d['step_error']:.0e} (RMS)"
    return "\n".join([*lines, last])


def _draw_tilts(ax: Axes, d: Data, i: int) -> None:
    one = int(np.argmin(abs(d["speed"] - 1)))
    ax.axhspan(*CLAIMED, color="0.85", lw=0)
    for mass, e, colour in zip(MASSES, d["restitution"][i, :, 0, one], _COLOURS, strict=True):
        ax.plot(np.degrees(d["tilt"]), e, color=colour, label=mass)
    ax.set_ylim(0, 1.03)
    tilt_axis(ax, step=30)


def _draw_speeds(ax: Axes, d: Data) -> None:
    ax.axhspan(*CLAIMED, color="0.85", lw=0)
    for j, colour in enumerate(_COLOURS):
        for i, dashes in ((0, ":"), (1, "-")):
            ax.plot(d["speed"], d["restitution"][i, j, 0, :, 0], dashes, color=colour)
    ax.plot(d["needed_speed"], d["mended_head_on"][0], "k--o", mfc="w")
    gamma = d["mended_gamma"][0] / 1e5
    beside = {"fontsize": 6, "transform": ax.transAxes, "ha": "right", "va": "center"}
    ax.text(0.97, 0.93 / 1.03, "factor as printed", **beside)
    ax.text(0.97, 0.405 / 1.03, rf"the same, $\gamma={gamma:.1f}\times10^5$", **beside)
    ax.text(0.97, 0.13 / 1.03, "no factor in the dashpot", **beside)
    ax.set(xscale="log", ylim=(0, 1.03), xlim=(0.47, 3.2), ylabel="restitution, head on")
    ax.set_xticks([0.5, 1, 2, 3], labels=["0.5", "1", "2", "3"])
    ax.set_xticks([], minor=True)
    ax.set_xlabel(r"speed $|c_z|/(gd)^{1/2}$")


def _draw_distances(ax: Axes, d: Data) -> None:
    for i, (where, marker) in enumerate(zip(WHERE, "osD", strict=True)):
        for j, colour in enumerate(_COLOURS):
            at_constant, _, at_measured, _ = d["compared"][i, j, 0]
            ax.plot(at_constant, at_measured, marker, color=colour, mfc="none", mew=1)
        ax.plot([], [], marker, color="0.3", mfc="none", label=where)
    ax.plot([0.02, 1], [0.02, 1], "-", color="0.7", lw=0.6)
    ax.set(xscale="log", yscale="log", xlim=(0.03, 0.7), ylim=(3e-5, 0.5))
    ax.set_xticks([0.05, 0.1, 0.2, 0.5], labels=["0.05", "0.1", "0.2", "0.5"])
    ax.set_xticks([], minor=True)
    ax.set(xlabel=r"RMS, $\epsilon=0.65$", ylabel=r"RMS, measured $\epsilon$")
    ax.legend(fontsize=5.5, loc="lower left", title="overlap factor in", title_fontsize=5.5)


def _draw_why(ax: Axes, d: Data) -> None:
    for z, row, colour in zip(DAMPINGS, d["why"], (RED, ORANGE, GREEN, BLUE), strict=True):
        ax.plot(d["ratio"], row, color=colour, label=f"{z:g}")
    printed = d["compared"][0, 0, 0, 2]
    ax.plot(d["printed_ratio"], printed, "k*", ms=8, label="printed")
    ax.set(xscale="log", yscale="log", ylim=(3e-5, 0.5), ylabel=r"RMS, measured $\epsilon$")
    ax.set_xlabel(r"$k_t\delta/(k_n\delta^{1/2})$, deepest overlap")
    ax.legend(fontsize=5.5, title="damping ratio", title_fontsize=5.5, loc="lower left")


@style
def draw(d: Data) -> plt.Figure:
    figure, axes = plt.subplots(2, 3, figsize=(7.0, 4.9))
    for i, ax in enumerate(axes[0]):
        _draw_tilts(ax, d, i)
    axes[0, 0].set_ylabel(r"restitution $-v_f/v_0$")
    for ax, panel in zip(axes[1], (_draw_speeds, _draw_distances, _draw_why), strict=True):
        panel(ax, d)
    titles = "factor as printed", "factor in the spring alone", "no overlap factor"
    titles += "head on", "velocities from theory", "printed spring varied"
    name_panels(axes.flat, titles)
    words = r"unit of mass (rod or virtual sphere) and $M_e$ ($M$ rod, $m$ sphere)"
    legend_above(figure, axes[0, 0], ncols=6, title=words, title_fontsize=7)
    law = r"appendix_a: $k_n=5\times10^6$, $k_t=95\,k_n$, $\gamma=400$"
    figure.supxlabel(f"{law}; {SCENE_WORDS}; grey: the claimed 0.65-0.7")
    return figure
