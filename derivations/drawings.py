"""Drawings of the report as SVG, computed from the derived expressions.

Text is set as paths, so that a drawing needs no font; `DRAWINGS` holds them all.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from io import StringIO
from typing import Any

import matplotlib as mpl
import numpy as np
import sympy as sp
from matplotlib.figure import Figure
from matplotlib.patches import Arc

from . import laws, slide, slip_stick, thin_rod
from .bodies import THIN
from .lecture import TEXTS
from .newton import contact_change
from .symbols import NAMED, P_1, F_z, P_x, P_z, epsilon, k, length, m, mu, phi, u_0, v_0
from .trace import LEFTS

BLUE, ORANGE, GREEN, PINK, GREY = "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#5b6570"
STYLE = {
    "svg.fonttype": "path",
    "svg.hashsalt": "derivations",
    "font.size": 11,
    "mathtext.fontset": "dejavusans",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
}
LAWS = {"newton": ("o", "Newton"), "poisson": ("s", "Poisson"), "stronge": ("^", "Stronge")}
RESTITUTION = 0.5
ROD = {length: 1, m: 1}  # a thin rod of length and mass one
FRICTION = 0.3
MAP = {"approach": 2.0, "restitution": 0.65}  # -c_z/c_x, and restitution, of the map


@dataclass(frozen=True)
class Drawing:
    """One drawing, with the words that go with it."""

    name: str
    title: str  # for who cannot see it
    caption: str  # sentence with formulas between dollar signs
    draw: Callable[[], Figure]

    @cached_property
    def svg(self) -> str:
        """The drawing as an element of a page, its ids begun with its name."""
        with mpl.rc_context(STYLE), StringIO() as file:
            nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
            self.draw().savefig(file, format="svg", bbox_inches="tight", metadata=nothing)
            text = file.getvalue()
        text = re.sub(
            r"<!--.*?-->|<metadata>.*?</metadata>", "", text[text.index("<svg") :], flags=re.S
        )
        text = re.sub(r' xmlns(:\w+)?="[^"]*"| (width|height)="[\d.]+pt"', "", text)
        text = text.replace("xlink:href", "href")
        text = re.sub(r'(id="|href="#|url\(#)', rf"\g<1>{self.name}-", text)
        label = f'<svg role="img" aria-label="{self.title}"'
        return re.sub(r"\n\s*", "\n", text.replace("<svg", label, 1).strip())


def _number(expr: Any, **values: Any) -> float:
    """A derived expression of the thin rod as a number; `phi` is in degrees."""
    at = {phi: sp.pi * values.pop("phi") / 180, mu: FRICTION, epsilon: RESTITUTION} | ROD
    at |= {NAMED[name]: value for name, value in values.items()}
    return float(sp.sympify(expr).subs(THIN).subs(at))


def geometry() -> Figure:
    """A tilted rod on the plate, with the letters of its place, motion and forces."""
    figure = Figure(figsize=(4.6, 3.6))
    axes = figure.subplots()
    x, z = (2 * _number(THIN[part], phi=30) for part in THIN if part != k)
    axes.plot([0, 2 * x], [0, 2 * z], color=GREY, lw=9, solid_capstyle="round", alpha=0.55)
    axes.plot([x], [z], "o", color="black", ms=5)
    axes.plot([0, x, x], [z, z, 0], ":", color=GREY, lw=1)
    axes.axhline(0, color="black", lw=2)
    axes.axvline(0, ls="--", color=GREY, lw=1)
    axes.add_patch(Arc((0, 0), 1.1, 1.1, theta1=60, theta2=90))
    # what an arrow shows: where it starts and ends, its colour, where its letter stands
    for word, start, end, color, place in (
        ("$F_z$", (0, 0), (0, 0.42), BLUE, (-0.17, 0.36)),
        ("$F_x$", (0, 0), (-0.28, 0), BLUE, (-0.3, -0.16)),
        ("$z$", (-0.75, 0.1), (-0.75, 0.5), "black", (-0.84, 0.5)),
        ("$x$", (-0.75, 0.1), (-0.35, 0.1), "black", (-0.33, 0.12)),
        ("$V_z$ (plate)", (-0.6, -0.45), (-0.6, -0.08), ORANGE, (-0.55, -0.36)),
        (r"$\omega$", (x, z + 0.3), (x + 0.28, z + 0.1), PINK, (x + 0.3, z + 0.12)),
    ):
        curved = {"connectionstyle": "arc3,rad=-0.4"} if color == PINK else {}
        style = {"arrowstyle": "-|>", "color": color, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", end, start, arrowprops=style | curved)
        axes.text(*place, word)
    for place, word in {
        (0.12, 0.66): r"$\phi$",
        (x / 2, z + 0.06): "$X$",
        (x + 0.05, z / 2): "$Z$",
        (x + 0.38, z + 0.3): r"$(c_x, c_z)$",
        (0.06, -0.17): "contact point: $u$ along $x$, $v$ along $z$",
        (2 * x + 0.06, 2 * z - 0.06): "length $l$",
    }.items():
        axes.text(*place, word)
    axes.set(aspect="equal", xlim=(-0.95, 1.75), ylim=(-0.55, 2 * z + 0.12))
    axes.set_axis_off()
    return figure


# regime: tilt in degrees and u_0, under v_0 = -1; whether friction then holds it or it slips back
IMPACTS = {"slide": (30, 2.2), "slip-stick": (12, 1.1), "slip reversal": (45, 0.8)}


def path(regime: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Corner of a path in the plane of impulses, and its end under each law, for v_0 = -1."""
    tilt, slip = IMPACTS[regime]
    at = {"phi": tilt, "u_0": slip, "v_0": -1}
    if regime == "slide":
        end = np.array([_number(part, **at) for part in slide.impulse()])
        return end, dict.fromkeys(LAWS, end)
    stop_x, stop_z, v_1 = (_number(part, **at) for part in slide.stop())
    later = "stick" if regime == "slip-stick" else "back"
    slip_slope, slope = (_number(laws.slopes()[phase], **at) for phase in ("slip", later))
    held = slip_stick.sticking_force() / F_z if later == "stick" else mu
    known = {v_0: -1, epsilon: RESTITUTION, P_1: stop_z, laws.a_1: slip_slope, laws.a_2: slope}
    ends = {}
    for law in LAWS:
        v_f = laws.final_velocity(law, "early" if v_1 < 0 else "late").subs(known)
        more = (float(v_f) - v_1) / slope
        ends[law] = np.array([stop_x + _number(held, **at) * more, stop_z + more])
    return np.array([stop_x, stop_z]), ends


def impulses(regime: str) -> Figure:
    """Routh's plane of impulses: path of one impact, and where it ends under each law."""
    figure = Figure(figsize=(3.4, 4.2), layout="constrained")
    axes = figure.subplots()
    tilt, slip = IMPACTS[regime]
    corner, ends = path(regime)
    top = (2 if regime == "slide" else 1.25) * max(end[1] for end in ends.values())
    reach = np.array([0, top])
    du, dv = contact_change(P_x, P_z)
    for step, line, color, style, word in (
        ("slide.slip_velocity", u_0 + du, PINK, "--", "no slip"),
        ("slide.normal_velocity", v_0 + dv, GREY, "-.", "deepest"),
    ):
        (across,) = sp.solve(line, P_x)
        at = [_number(across, phi=tilt, u_0=slip, v_0=-1, P_z=p) for p in reach]
        axes.plot(at, reach, style, color=color, lw=1.4, label=f"${LEFTS[step][0]} = 0$: {word}")
    axes.plot(-FRICTION * reach, reach, ":", color=BLUE, lw=1.2)
    axes.plot(FRICTION * reach, reach, ":", color=BLUE, lw=1.2, label=r"$|P_x| = \mu P_z$")
    last = max(ends.values(), key=lambda end: end[1])
    axes.plot(*np.array([(0, 0), corner, last]).T, color="black", lw=2, label="path")
    for law, (marker, name) in LAWS.items():
        axes.plot(*ends[law], marker, ms=8, mfc="none", mec=ORANGE, mew=1.8, label=f"end: {name}")
    axes.set(title=f"{regime}, {tilt}°", xlabel="$P_x / (m |v_0|)$", ylabel="$P_z / (m |v_0|)$")
    axes.set(xlim=(-0.36 * top, 0.36 * top), ylim=(0, top))
    figure.legend(loc="outside lower center", ncols=2, fontsize=9)
    return figure


def regimes() -> Figure:
    """Regimes of a thin rod over tilt and friction."""
    figure = Figure(figsize=(5.4, 3.8))
    axes = figure.subplots()
    tilt, friction = np.meshgrid(np.linspace(0.05, 89.95, 300), np.linspace(0.002, 1.1, 200))
    at = {u_0: 1, v_0: -MAP["approach"], epsilon: MAP["restitution"], length: 1}
    left, margin = (
        sp.lambdify((phi, mu), form.subs(THIN).subs(at), "numpy")(np.radians(tilt), friction)
        for form in (slide.slide_excess(), slip_stick.stick_margin())
    )
    regime = np.where(left >= 0, 0, np.where(margin >= 0, 1, 2))
    axes.contourf(
        tilt,
        friction,
        regime,
        levels=[-0.5, 0.5, 1.5, 2.5],
        colors=["#cfe3f3", "#f4f4f4", "#fbdcc6"],
    )
    axes.contour(tilt, friction, left, levels=[0], colors=BLUE, linewidths=2)
    held = np.ma.masked_where(left >= 0, margin)
    axes.contour(tilt, friction, held, levels=[0], colors=ORANGE, linewidths=2)
    largest, tangent = (float(x) for x in thin_rod.largest_reversal_friction())
    axes.plot(np.degrees(np.arctan(tangent)), largest, "o", color=ORANGE)
    for place in ((20, 0.6), (52, 0.42), (82, 0.2)):
        nearest = np.hypot((tilt - place[0]) / 90, friction - place[1]).argmin()
        axes.text(*place, list(IMPACTS)[regime.flat[nearest]], ha="center")
    axes.set(xlabel=r"tilt $\phi$ (degrees)", ylabel=r"friction $\mu$", xlim=(0, 90), ylim=(0, 1.1))
    return figure


_DRAWN: dict[str, Callable[[], Figure]] = {
    "geometry": geometry,
    "path-slide": partial(impulses, "slide"),
    "path-slip-stick": partial(impulses, "slip-stick"),
    "path-slip-reversal": partial(impulses, "slip reversal"),
    "regimes": regimes,
}
_NUMBERS = {
    "friction": FRICTION,
    "restitution": RESTITUTION,
    "approach": MAP["approach"],
    "landing": MAP["restitution"],
}
DRAWINGS = {
    name: Drawing(name, words["title"], words["caption"] % _NUMBERS, _DRAWN[name])
    for name, words in TEXTS["drawings"].items()
}
