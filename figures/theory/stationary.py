"""The stationary landing: its phase, the plate's velocity there, its stability, its cost.

Derived, not in the paper; for a thin rod but in (f); in (d) and (e) epsilon = 0.65. (a) Landing
phases in proportion to the velocity of approach, of rods that fall at q times the plate's
largest velocity V_0; the paper's density is q = 1. (b) The mean velocity of the plate at
landing, which follows: 1/2 of V_0 at q = 1 alone; a rod lands at its first contact, and slow
rods near the top. (c) The same of a thin rod that falls as fast as the closure has it rise, q =
V_z/V_0 c_z'/V_z: solid where it is faster than the plate, dots where they are equally fast, so
that 1/2 holds; the dashed lines end where the rod is hit again at once. Look how far from 1/2
upright rods are. (d) How many landings it takes until a small deviation has fallen by the
factor e: in slip-stick (black, whatever the friction) and between the critical tilts of a
friction in slip reversal; corners with a vertical side are where it begins, or ceases, to
oscillate. (e) Work of the plate per weight and distance: friction makes transport cheaper up to
where the contact holds; dots: the best tilt, one for 0.3 and 0.5. (f) Friction from which on
the contact of a slipping rod is pressed into the plate, Painlevé's paradox; dot: the least of a
thin rod, 4/3.
"""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from derivations import function
from impact import (
    Regime,
    drift,
    flat_ended_rod,
    landing_density,
    optimal_tilt,
    painleve_friction,
    relaxation,
    spherocylinder,
    thin_rod,
)
from impact.translation import landing_phases

from ..lib.style import (
    BLACK,
    BLUE,
    SHAPE_COLOURS,
    THEORY,
    Data,
    note,
    painted,
    shades,
    style,
    tilt_axis,
)

FALLS = np.array([0.5, 1.0, 2.0])  # over the plate's largest velocity
RESTITUTIONS = np.array([0.5, 0.65, 0.8])
FRICTIONS = np.array([0.1, 0.3, 0.5])
FORMS = "--", "-", "-."


def alpha_of_fall(fall: np.ndarray) -> np.ndarray:
    """V_z/V_0 of rods that fall with `fall` times V_0, on both branches."""
    speed = np.minimum(fall, 1)
    start, end = landing_phases(speed)
    fast = function("V: alpha by flux")(np.maximum(fall, 1))
    slow = function("V: alpha by flux, slow")(q=speed, theta_0=end, theta_s=start)
    return np.where(fall >= 1, fast, slow)


def data(
    quick: bool = False,
    friction: float | None = None,
    restitution: float | None = None,
    length: float = 9.5,
) -> Data:
    """Phases in rad over fall speeds; the rest over tilt in rad, of thin rods but for (f).

    `friction`, `restitution`: the only ones of (c)-(e); `length`: of the longer round rod of (f).
    """
    n = 181 if quick else 1081
    frictions = FRICTIONS if friction is None else np.array([friction])
    restitutions = RESTITUTIONS if restitution is None else np.array([restitution])
    phase, fall = np.linspace(-np.pi, np.pi, n), np.linspace(0.01, 3, n)
    tilt = np.radians(np.linspace(0, 90, n))
    rod = thin_rod(tilt)
    bounce = drift(rod, friction=1.0, restitution=restitutions[:, None]).c_z
    consistent, least = function("V: alpha and closure")(bounce)
    slow = np.linspace(0.01, 1, 2001)
    alpha = alpha_of_fall(slow)
    slower = np.interp(bounce, slow / alpha, alpha)
    usual = 0.65 if restitution is None else restitution
    setting = {"friction": np.append(frictions, np.inf)[:, None], "restitution": usual}
    steady = drift(rod, **setting)
    with np.errstate(all="ignore"):
        half = np.arcsin(np.sqrt(function("V: tilt of one half")(restitutions)))
        cost = 1 / np.abs(steady.c_x)
    shown = steady.regime == Regime.SLIP_REVERSAL
    shown[-1] = True  # the last friction holds at every tilt
    best = optimal_tilt(friction=frictions, restitution=usual)
    shapes = rod, spherocylinder(tilt, length), spherocylinder(tilt, 3.0), flat_ended_rod(tilt, 8.0)
    return {
        "frictions": frictions,
        "restitutions": restitutions,
        "restitution": usual,
        "length": length,
        "phase": phase,
        "density": landing_density(phase, fall_speed=FALLS[:, None]),
        "fall": fall,
        "alpha": alpha_of_fall(fall),
        "tilt": tilt,
        "consistent": np.where(bounce >= least, consistent, np.nan),
        "slower": np.where((bounce < least) & (bounce >= 1), slower, np.nan),
        "half": half,
        "landings": np.where(shown, relaxation(rod, **setting), np.nan),
        "cost": np.where(shown, cost, np.nan),
        "best_tilt": best.tilt,
        "best_cost": 1 / best.c_x,
        "painleve": np.stack([painleve_friction(shape) for shape in shapes]),
    }


def _density(ax, d):
    ax.set_prop_cycle(color=shades(len(FALLS)), ls=FORMS)
    ax.plot(np.degrees(d["phase"]), d["density"].T, label=[f"{q:g}" for q in FALLS])
    ax.set(
        xlabel=r"phase $\theta$ (deg)",
        xlim=(-180, 180),
        xticks=range(-180, 181, 90),
        ylabel=r"density $H$ (1/rad)",
        ylim=(0, 0.6),
    )
    ax.legend(title=r"fall speed $q=|c_z|/V_0$", ncols=3, loc="upper center")


def _alpha(ax, d):
    fall, alpha = d["fall"], d["alpha"]
    slow = fall <= 1
    ax.plot(fall[slow], alpha[slow], "--", color=BLUE, label="slower than the plate")
    ax.plot(fall[~slow], alpha[~slow], color=BLACK, label="faster, $1/(2q)$")
    ax.plot(1, 0.5, "o", color=THEORY, label="the paper's 1/2")
    ax.set(
        xlabel=r"fall speed $q=|c_z|/V_0$",
        xlim=(0, 3),
        ylabel=r"$\alpha=V_z/V_0$",
        ylim=(0, 1),
    )
    ax.legend()


def _closure(ax, d):
    tilt_deg, half = np.degrees(d["tilt"]), np.degrees(d["half"])
    for row, colour in enumerate(shades(len(half))):
        place = f", 1/2 at {half[row]:.1f}°" if half[row] >= 0 else ""
        label = f"{d['restitutions'][row]:g}{place}"
        ax.plot(tilt_deg, d["consistent"][row], color=colour, label=label)
        ax.plot(tilt_deg, d["slower"][row], "--", color=colour)
        ax.plot(half[row], 0.5, "o", color=colour)
    tilt_axis(ax, 0, 60, ylabel=r"$\alpha=V_z/V_0$", ylim=(0, 0.8))
    ax.legend(title=r"restitution $\epsilon$", loc="lower right")


def _regimes(ax, d, name: str, frictions: int, **look: Any):
    """Draw slip-stick in black; in colour the smallest frictions where they reverse."""
    tilt_deg = np.degrees(d["tilt"])
    ax.plot(tilt_deg, d[name][-1], color=BLACK, label="slip-stick")
    mus = d["frictions"]
    rows = zip(d[name], mus[:frictions], shades(len(mus)), FORMS, strict=False)
    for y, mu, colour, form in rows:
        ax.plot(tilt_deg, y, form, color=colour, label=rf"reversal, $\mu={mu:g}$")
    tilt_axis(ax, **look)
    ax.legend()


def _landings(ax, d):
    _regimes(ax, d, "landings", 2, ylabel="landings to fall by $e$", ylim=(0, 11))


def _cost(ax, d):
    words = "work / (weight × distance)"
    _regimes(ax, d, "cost", 3, ylabel=words, yscale="log", ylim=(0.2, 100))
    ax.scatter(np.degrees(d["best_tilt"]), d["best_cost"], s=16, c=BLACK, zorder=3)


def _painleve(ax, d):
    names = "thin rod", f"round, $l={d['length']:g}d$", "round, $l=3d$", "flat ends, $l=8d$"
    colours = [SHAPE_COLOURS[shape] for shape in ("thin", "round", "round", "flat")]
    ax.set_prop_cycle(color=colours, ls=["-", "-", "-.", "-"])
    ax.plot(np.degrees(d["tilt"]), d["painleve"].T, label=names)
    ax.plot(np.degrees(np.arctan(0.5)), 4 / 3, "o", color=BLACK)
    tilt_axis(ax, ylabel=r"friction $\mu_P$", ylim=(0, 8))
    ax.legend(loc="upper center", handlelength=1.6)


@style
def draw(d: Data) -> Figure:
    panels = {
        "landing phases": _density,
        "plate at landing": _alpha,
        "thin rods by the closure": _closure,
        "approach to the drift": _landings,
        "cost of transport": _cost,
        "Painlevé's friction": _painleve,
    }
    figure = painted(d, panels, 5.4, rows=2)
    note(figure, rf"(d, e): $\epsilon={d['restitution']:g}$")
    return figure
