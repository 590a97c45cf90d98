"""Fig. 12: one soft impact over tilt against the closed forms, and what restitution it shows.

mu = 0.4, -c_z/c_x = 2, |c_z| = 1 sqrt(g d), l = 9.5 d, thin inertia, k_n = 5e6 m g/d^(3/2). (a)
friction as a constraint, the law under which the paper's figure comes out: symbols on the lines,
and on the theory at the restitution measured at each tilt they cannot be told apart. (b)
Appendix A as printed: neither. (c) the restitution of a soft contact is not constant, although its
dashpot gives 0.65 head on at every speed: friction adds to or takes from the work of compression.
(d) one constant in Stronge's (energetic) law explains that best.
"""

from dataclasses import replace
from functools import partial

import numpy as np
from matplotlib.figure import Figure

import md
from impact import Collision

from ..lib.soft_impacts import (
    CONTACT_COLOURS,
    IMPACT_FRICTION,
    LAW_WORDS,
    ROD,
    TABLE_TILTS,
    Soft,
    compared,
    distance,
    rigid,
    scene_words,
    simulate,
)
from ..lib.style import (
    CENTRED,
    LAW_COLOURS,
    REGIME_LOOK,
    REGIME_WORDS,
    RESTITUTION_LAWS,
    RIGID,
    SIMULATED,
    THEORY,
    Data,
    legend_above,
    note,
    painted,
    style,
    tilt_axis,
)

EPSILON = 0.65


def data(
    quick: bool = False,
    friction: float = IMPACT_FRICTION,
    restitution: float = EPSILON,
    length: float = ROD.length,
) -> Data:
    """Velocities over |c_z| and restitution; MD arrays are of shape (3 laws, tilts)."""
    scene = {"friction": friction, "rod": replace(ROD, length=length)}
    laws = md.coulomb(restitution), md.constant_restitution(restitution), md.appendix_a()
    tilt = np.radians(np.arange(0, 90, 5 if quick else 1))
    edges = np.radians(np.linspace(0, 90, 181 if quick else 1801))
    line = (edges[1:] + edges[:-1]) / 2

    rigid_at = partial(rigid, **scene)

    def of_laws(tilt: np.ndarray, **how: int) -> Soft:
        impacts = [simulate(tilt, law, **scene, **how) for law in laws]
        return Soft(*map(np.array, zip(*impacts, strict=True)))

    soft, coarse = of_laws(tilt), of_laws(TABLE_TILTS)
    rms, right = compared(coarse, rigid_at(TABLE_TILTS, coarse.restitution))
    lines = [rigid_at(line, restitution, law=law) for law in RESTITUTION_LAWS]
    newton, *_ = lines
    at_measured = rigid_at(tilt, soft.restitution)

    def off(theory: Collision) -> np.ndarray:
        return np.hypot(soft.c_x - theory.c_x, soft.c_z - theory.c_z)[0]

    return {
        "tilt": tilt,
        "line_tilt": line,
        "line_edges": edges,
        "epsilon": restitution,
        "words": scene_words(friction, length),
        **soft._asdict(),
        "measured_c_x": at_measured.c_x,
        "measured_c_z": at_measured.c_z,
        "line_c_x": newton.c_x,
        "line_c_z": newton.c_z,
        "line_regime": newton.regime,
        "line_restitution": np.array([law.normal_velocity for law in lines]),
        # distance of the first law's symbols from each theory at the constant, and at the measured
        "off": np.array([off(rigid_at(tilt, restitution, law=law)) for law in RESTITUTION_LAWS]),
        "off_measured": off(at_measured),
        "step_error": distance(soft, of_laws(tilt, refine=64)),
        "rms_constant": distance(coarse, rigid_at(TABLE_TILTS, restitution)),
        "rms_measured": rms,
        "regimes_right": right,
    }


def _draw_velocities(ax, d, i: int):
    deg = np.degrees(d["tilt"])
    ax.pcolormesh(
        np.degrees(d["line_edges"]),
        [0, 1],
        d["line_regime"][None],
        transform=ax.get_xaxis_transform(),
        alpha=0.5,
        **REGIME_LOOK,
    )
    for part, marker in (("c_x", "o"), ("c_z", "s")):
        ax.plot(deg, d[f"measured_{part}"][i], color=RIGID, lw=3, alpha=0.4)
        ax.plot(np.degrees(d["line_tilt"]), d[f"line_{part}"], color=THEORY)
        ax.plot(
            deg,
            d[part][i],
            marker,
            markevery=1 if deg.size < 50 else 3,
            color=SIMULATED,
            mfc="none",
            ms=3,
            mew=0.7,
            label=f"${part}'$, simulated",
        )
    tilt_axis(ax, ylabel=r"velocity / $|c_z|$", ylim=(-1.2, 1.3))


def _draw_restitution(ax, d):
    # the first two nearly coincide
    ax.set_prop_cycle(color=[*CONTACT_COLOURS.values()], lw=[2.4, 1, 1.2])
    ax.plot(np.degrees(d["tilt"]), d["restitution"].T, label=[*LAW_WORDS.values()])
    for (law, colour), e in zip(LAW_COLOURS.items(), d["line_restitution"], strict=True):
        ax.plot(np.degrees(d["line_tilt"]), e, "--", color=colour, lw=1, label=law.title())
    tilt_axis(ax, ylabel=r"restitution $-v_f/v_0$", ylim=(None, 1.45))
    ax.legend(ncols=2, loc="upper center")


def _draw_off(ax, d):
    deg = np.degrees(d["tilt"])
    for (law, colour), off in zip(LAW_COLOURS.items(), d["off"], strict=True):
        ax.plot(deg, off, "--", color=colour, label=rf"{law.title()}, $\epsilon={d['epsilon']:g}$")
    ax.plot(deg, d["off_measured"], color=RIGID, label=r"Newton, measured $\epsilon$")
    tilt_axis(ax, yscale="log", ylim=(3e-5, 3), ylabel=r"$|\Delta\mathbf{c}'|/|c_z|$")
    ax.legend(ncols=2, loc="upper center")


@style
def draw(d: Data) -> Figure:
    panels = {
        "friction as a constraint": partial(_draw_velocities, i=0),
        "Appendix A as printed": partial(_draw_velocities, i=2),
        "measured restitution": _draw_restitution,
        "simulated (a) from theory": _draw_off,
    }
    figure = painted(d, panels, 5.8, rows=2)
    first, *_ = figure.axes
    for number, word in REGIME_WORDS.items():
        here = np.degrees(d["line_tilt"][d["line_regime"] == number])
        if here.size:
            words = word.replace(" ", "\n").replace("-", "-\n")
            first.text(here.mean(), -1.0, words if np.ptp(here) < 15 else word, **CENTRED)
    epsilon = rf"$\epsilon={d['epsilon']:g}$"
    first.plot([], [], color=THEORY, label=f"theory, {epsilon}")
    first.plot([], [], color=RIGID, lw=3, alpha=0.4, label=r"theory, measured $\epsilon$")
    legend_above(figure, first, ncols=4)
    note(
        figure,
        rf"{d['words']}, $k_n=5\times10^6\,mg/d^{{3/2}}$;"
        rf" head on {epsilon}; spring: tangential ratio 30, damping 1;"
        r" Appendix A: $k_t=95\,k_n$, $\gamma=400$, $M_e=1/2$",
    )
    return figure
