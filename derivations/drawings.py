"""Drawings of the report as SVG, computed from the derived expressions.

Text is set as paths, so that a drawing needs no font; `DRAWINGS` holds them all.
"""

import re
from collections.abc import Callable
from functools import partial
from io import StringIO
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
import sympy as sp
from matplotlib.figure import Figure
from matplotlib.patches import Arc

from . import kernel, slide, thin_rod
from .axioms import lever_x, lever_z
from .bodies import THIN
from .equality import components
from .lecture import TEXTS, identity
from .lookup import entry_of
from .newton import contact_change, contact_velocity
from .slip_stick import stick_margin
from .symbols import (
    F_x,
    F_z,
    P_x,
    P_z,
    V_z,
    X,
    Z,
    c_x,
    c_z,
    epsilon,
    length,
    m,
    mu,
    omega,
    phi,
    u_0,
    v_0,
)
from .trace import LEFTS
from .typeset import latex

COLORS = {"blue": "#0072b2", "orange": "#d55e00"}
BLUE, ORANGE = COLORS.values()
GREEN, PINK, GREY = "#009e73", "#cc79a7", "#5b6570"
STYLE = {
    "svg.fonttype": "path",
    "svg.hashsalt": "derivations",
    "font.size": 11,
    "mathtext.fontset": "dejavusans",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
}
MARKERS = {"newton": "o", "poisson": "s", "stronge": "^"}
RESTITUTION, FRICTION = 0.5, 0.3
TILT = sp.pi / 6  # of the rod that shows the letters
MAP = {u_0: 1, v_0: -2.0, epsilon: 0.65, length: 1}  # the landing of the map of regimes
EDGES = {"14": "blue", "16": "orange"}  # lines of the map where these entries change sign
At = dict[sp.Symbol, Any]
_NEEDLESS = re.compile(  # in a page
    r'(?s)<!--.*?-->|<metadata>.*?</metadata>| xmlns(:\w+)?="[^"]*"| (width|height)="[\d.]+pt"'
)


class Drawing(NamedTuple):
    """One drawing of the report, with its title and caption."""

    name: str
    title: str  # for readers who cannot see it
    caption: str  # sentence with formulas between dollar signs
    draw: Callable[[], Figure]

    def svg(self) -> str:
        """SVG element of the drawing for a page; its ids begin with the drawing's name."""
        with mpl.rc_context(STYLE), StringIO() as file:
            self.draw().savefig(file, format="svg", bbox_inches="tight")
            text = file.getvalue()
        text = _NEEDLESS.sub("", text[text.index("<svg") :]).replace("xlink:href", "href")
        text = re.sub(r'(id="|href="#|url\(#)', rf"\g<1>{self.name}-", text)
        label = f'<svg role="img" aria-label="{self.title}"'
        return re.sub(r"\n\s*", "\n", text.replace("<svg", label, 1).strip())


def _number(expr: Any, at: At) -> float:
    """Value of a derived expression for a thin rod.

    Length and mass are one, friction and restitution the drawings' own, unless `at` has others.
    """
    known = {mu: FRICTION, epsilon: RESTITUTION, length: 1, m: 1} | at
    return float(sp.sympify(expr).subs(THIN).subs(known))


def _along(letter: sp.Symbol) -> np.ndarray:
    """Unit vector along the axis of a letter such as x, X or F_x."""
    return np.eye(2)["xz".index(letter.name[-1].lower())]


def _top_velocity(height: float) -> np.ndarray:
    """Velocity, by a spin of one, of a point at a height above the centre of mass at rest."""
    still = {c_x: 0, c_z: 0, V_z: 0, omega: 1}
    return np.array(contact_velocity((0, height)).subs(still), dtype=float).ravel()


def geometry() -> Figure:
    """A tilted rod on the plate, with the letters of its place, motion and forces.

    An arrow or a length lies along the axis of the letter that stands beside it.
    """
    figure = Figure(figsize=(4.6, 3.6))
    axes = figure.subplots()
    at = {phi: TILT, length: 2}
    place = {letter: _number(THIN[letter], at) * _along(letter) for letter in (X, Z)}
    centre = place[X] + place[Z]
    axes.plot(*np.transpose([0 * centre, 2 * centre]), color=GREY, lw=9, alpha=0.55)
    axes.plot(*centre, "o", color="black", ms=5)
    axes.axhline(0, color="black", lw=2)
    axes.axvline(0, ls="--", color=GREY, lw=1)
    axes.add_patch(Arc((0, 0), 1.1, 1.1, theta1=90 - float(sp.deg(TILT)), theta2=90))
    words = {
        latex(phi): 0.66 * np.array([sp.sin(TILT / 2), sp.cos(TILT / 2)]),
        latex(length): 2.03 * centre,
    }
    for letter, side in place.items():
        axes.plot(*np.transpose([centre - side, centre]), ":", color=GREY, lw=1)
        words[latex(letter)] = centre - side / 2
    push, above = 0.4, np.array([0, 0.36])
    arrows: tuple[Any, ...] = (
        (F_z, (0, 0), push, BLUE),
        (F_x, (0, 0), _number(slide.friction(push, 1), {mu: 0.7}), BLUE),
        (lever_z, (-0.85, 0.3), 0.4, "black"),
        (lever_x, (-0.85, 0.3), 0.4, "black"),
        (V_z, (-0.6, -0.5), 0.3, ORANGE),
        (c_x, centre, 0.4, GREEN),
        (c_z, centre, 0.2, GREEN),
        (omega, centre + above, _top_velocity(above[1]) - above / 2, PINK),
    )
    for letter, start, way, color in arrows:
        end = start + (way if letter == omega else way * _along(letter))
        style = {"arrowstyle": "-|>", "color": color, "lw": 1.6, "shrinkA": 0, "shrinkB": 0}
        style["connectionstyle"] = "arc3,rad=-0.4" if letter == omega else "arc3"
        axes.annotate("", end, start, arrowprops=style)
        words[latex(letter)] = end
    for word, corner in words.items():
        x, y = corner + 0.03
        axes.text(x, y, f"${word}$")
    lefts = zip(LEFTS["newton.contact_velocity"], (lever_x, lever_z), strict=True)
    along = ", ".join(f"${left}$ along ${axis}$" for left, axis in lefts)
    axes.text(0.06, -0.17, f"contact point: {along}")
    axes.set(aspect="equal", xlim=(-0.95, 1.75), ylim=(-0.55, 2 * centre[1] + 0.12))
    axes.set_axis_off()
    return figure


# Impacts that are drawn, by regime: tilt in degrees and u_0, with v_0 = -1.
IMPACTS = {"slide": (30, 2.2), "slip-stick": (12, 1.1), "slip reversal": (45, 0.8)}


def _at(regime: str) -> At:
    tilt, slip = IMPACTS[regime]
    return {phi: sp.rad(tilt), u_0: slip, v_0: -1}


def path(regime: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Corner of a path in the plane of impulses, and its end under each law, for v_0 = -1.

    ValueError if the impact is of another regime.
    """
    at = _at(regime)
    conditions = slide.slide_excess(), stick_margin(), 1
    found = next(x for x, form in zip(IMPACTS, conditions, strict=True) if _number(form, at) > 0)
    if found != regime:
        raise ValueError(f"the impact of {regime} is one of {found}")
    code = kernel.SLIDE + list(IMPACTS).index(regime)
    *stop, v_1 = (_number(part, at) for part in slide.stop())
    order = "early" if v_1 < 0 else "late"
    ends = {
        law: np.array([_number(part, at) for part in kernel.impulse(law, code, order)[:2]])
        for law in MARKERS
    }
    return ends["newton"] if code == kernel.SLIDE else np.array(stop), ends


def impulses(regime: str) -> Figure:
    """Figure of Routh's plane of impulses: path of one impact, and where it ends under each law."""
    figure = Figure(figsize=(3.4, 4.2), layout="constrained")
    axes = figure.subplots()
    corner, ends = path(regime)
    last = max(ends.values(), key=lambda end: end[1])
    top = (2 if regime == "slide" else 1.25) * last[1]
    reach = np.array([0, top])
    du, dv = contact_change(P_x, P_z)
    for step, line, color, style, there in (
        ("slide.slip_velocity", u_0 + du, PINK, "--", "no slip"),
        ("slide.normal_velocity", v_0 + dv, GREY, "-.", "deepest"),
    ):
        left = LEFTS[step][0]
        (across,) = sp.solve(line, P_x)
        at = [_number(across, _at(regime) | {P_z: p}) for p in reach]
        axes.plot(at, reach, style, color=color, lw=1.4, label=f"${left} = 0$: {there}")
    for direction in (1, -1):
        edge = slide.friction(P_z, direction)
        slope = _number(edge / P_z, {})
        axes.plot(slope * reach, reach, ":", color=BLUE, lw=1.2, label=f"$P_x = {latex(edge)}$")
    axes.plot(*np.transpose([(0, 0), corner, last]), color="black", lw=2, label="path")
    for law, marker in MARKERS.items():
        label = f"end: {law.title()}"
        axes.plot(*ends[law], marker, ms=8, mfc="none", mec=ORANGE, mew=1.8, label=label)
    x, y = (left.partition("(")[0] for left in LEFTS["slide.impulse"])  # as the places of `path`
    axes.set(
        title=f"{regime}, {IMPACTS[regime][0]}°",
        xlabel=f"${x} / (m |v_0|)$",
        ylabel=f"${y} / (m |v_0|)$",
        xlim=(-0.36 * top, 0.36 * top),
        ylim=(0, top),
    )
    figure.legend(loc="outside lower center", ncols=2, fontsize=9)
    return figure


def regimes() -> Figure:
    """Map of a thin rod's regimes over tilt and friction.

    On one edge the slip just stops, on the other friction just holds the contact.
    """
    figure = Figure(figsize=(5.4, 3.8))
    axes = figure.subplots()
    tilt, friction = np.meshgrid(np.linspace(0.05, 89.95, 300), np.linspace(0.002, 1.1, 200))
    regime = np.full(tilt.shape, len(EDGES))
    for code, (tag, color) in enumerate(EDGES.items()):
        (form,) = components(entry_of(tag).derive())
        side = sp.lambdify((phi, mu), form.subs(THIN).subs(MAP))(np.radians(tilt), friction)
        edge = np.ma.masked_where(regime < code, side)  # where no condition before it holds
        axes.contour(tilt, friction, edge, levels=[0], colors=COLORS[color], linewidths=2)
        regime[(regime > code) & (side >= 0)] = code
    shades = "#cfe3f3", "#f4f4f4", "#fbdcc6"
    axes.contourf(tilt, friction, regime, levels=[-0.5, 0.5, 1.5, 2.5], colors=shades, zorder=0)
    largest, tangent = map(float, thin_rod.largest_reversal_friction())
    axes.plot(np.degrees(np.arctan(tangent)), largest, "o", color=ORANGE)
    for x, y in ((20, 0.6), (52, 0.42), (82, 0.2)):
        nearest = np.hypot((tilt - x) / 90, friction - y).argmin()
        axes.text(x, y, list(IMPACTS)[regime.flat[nearest]], ha="center")
    axes.set(
        xlabel=f"${latex(phi)}$ (degrees)", ylabel=f"${latex(mu)}$", xlim=(0, 90), ylim=(0, 1.1)
    )
    return figure


_DRAWN: dict[str, Callable[[], Figure]] = {
    "geometry": geometry,
    **{f"path-{x.replace(' ', '-')}": partial(impulses, x) for x in IMPACTS},
    "regimes": regimes,
}


def _pushed(direction: int, *words: str) -> str:
    """Pick the first word if friction in a slip of this direction points to -x, else the second."""
    return words[_number(slide.friction(sp.S.One, direction), {}) > 0]


_HOLDS = _number(stick_margin(), {phi: sp.atan(2)}) > 0  # between the critical tilts
_N, _T = r"(k^2 + X^2 + \mu XZ)", r"(XZ + \mu (k^2 + Z^2))"
WORDS = {
    "slips": ("between", "outside of")[_HOLDS],
    "sticks": ("outside of", "between")[_HOLDS],
    "edge": _pushed(1, "left", "right"),
    "back": _pushed(-1, "left", "right"),
    "against": _pushed(1, "against", "along"),
    "push": _pushed(-1, "backward", "forward"),
    "sum_z": identity(f"k^2 (k^2 + X^2 + Z^2) = (k^2 + Z^2) {_N} - XZ {_T}"),
    "sum_x": identity(rf"\mu k^2 (k^2 + X^2 + Z^2) = (k^2 + X^2) {_T} - XZ {_N}"),
    "friction": FRICTION,
    "restitution": RESTITUTION,
    "approach": -MAP[v_0] / MAP[u_0],
    "landing": MAP[epsilon],
    "ahead": "+x" if _top_velocity(1)[0] > 0 else "-x",
    "edges": "; ".join(f"{color}: {entry_of(tag).what} ({tag})" for tag, color in EDGES.items()),
}
DRAWINGS = {
    name: Drawing(name, words["title"], words["caption"] % WORDS, _DRAWN[name])
    for name, words in TEXTS["drawings"].items()
}
