"""Window of sliders: one impact, and the drift that follows, at any setting.

(a) Regimes over tilt and friction. (b) Velocities after one impact over tilt, in units of the speed
before; k omega' is that of a point at the gyration radius. (c) Drift under the paper's closure:
Newton's restitution, no landing slides through. The rod comes without spin and leans the way it
moves. Rings mark the setting, diamonds the tilts at which friction begins or ceases to hold a
contact that has stopped. The key 'r' goes back to the start.

A move of a slider takes about 60 ms, 3 of them for computing; drawn in full it would be 165 (two
shared cores of an AMD EPYC, load 3; Matplotlib 3.11, in memory, medians of 41).
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.backend_bases import FigureManagerBase
from matplotlib.patches import Patch
from matplotlib.widgets import RadioButtons, Slider

import impact
from impact import InputError, Regime

from ..lib.style import (
    BLACK,
    BLUE,
    GREEN,
    RED,
    REGIME_MAP,
    RESTITUTION_LAWS,
    SHAPES,
    map_regimes,
    name_panels,
    shade,
    style,
    tilt_axis,
)

TILT = np.linspace(0, np.pi / 2, 1801)  # of the curves; colours take every tenth
FRICTION = np.linspace(0, 1, 101)
_RODS = {"thin": impact.thin_rod, "round": impact.spherocylinder, "flat": impact.flat_ended_rod}
WORDS = {
    Regime.SLIDE: "Slide: the contact point slips until it leaves the plate.",
    Regime.SLIP_STICK: "Slip-stick: the contact point slips, stops, and friction holds it.",
    Regime.SLIP_REVERSAL: "Slip reversal: the contact point slips, stops, and slips back.",
}
RANGES = {  # ends of a slider, its name, its digits
    "tilt_deg": (0, 90, r"tilt $\phi$ (deg)", "%.2f"),
    "friction": (0, 1, r"friction $\mu$", "%.3f"),
    "restitution": (0, 1, r"restitution $\epsilon$", "%.3f"),
    "ratio": (0.1, 10, r"approach $-c_z/c_x$", "%.2f"),
    "length": (1, 20, "length $l/d$", "%.2f"),
}
CHOICES = {"shape": SHAPES, "law": {law: law.title() for law in RESTITUTION_LAWS}}


@dataclass(frozen=True, slots=True)
class Setting:
    """Values of the controls; the length of a thin rod changes nothing that is drawn."""

    tilt_deg: float = 30.0
    friction: float = 0.3
    restitution: float = 0.65
    ratio: float = 2.0
    length: float = 8.0
    shape: str = "round"
    law: str = "newton"

    def __post_init__(self):
        for name, (low, high, *_) in RANGES.items():
            if not low <= (value := getattr(self, name)) <= high:
                raise InputError(f"{name} must be between {low:g} and {high:g}, got {value!r}")
        for name, choices in CHOICES.items():
            if (value := getattr(self, name)) not in choices:
                raise InputError(f"{name} must be one of {', '.join(choices)}, got {value!r}")


def _crossings(x: np.ndarray, y: np.ndarray, level: float) -> np.ndarray:
    """Where a curve of short straight pieces crosses a level."""
    i = np.flatnonzero(np.diff(y > level))
    return x[i] + (level - y[i]) / (y[i + 1] - y[i]) * (x[i + 1] - x[i])


def data(setting: Setting) -> dict[str, np.ndarray]:
    """Arrays of the panels; those over tilt [rad] end with the value at the setting's tilt."""
    s, tilt = setting, np.append(TILT, np.radians(setting.tilt_deg))
    rod, columns = (_RODS[s.shape](some, s.length) for some in (tilt, TILT[::10]))
    c_x, c_z = np.array([1, -s.ratio]) / np.hypot(1, s.ratio)
    plate, loss = {"friction": s.friction}, {"restitution": s.restitution}
    hit = impact.collide(c_x, c_z, geometry=rod, law=s.law, **plate, **loss)
    moves = impact.drift(rod, **plate, **loss)
    holds = impact.critical_friction(rod)
    rows = {"geometry": columns, "friction": FRICTION[:, None], **loss}
    return {
        "tilt": tilt,
        "c_x_before": np.full(tilt.shape, c_x),
        "c_x": hit.c_x,
        "c_z": hit.c_z,
        "spin": hit.omega * rod.k,
        "energy_change": hit.energy_change,
        "regime": hit.regime,
        "regimes": impact.classify(c_x, c_z, **rows),
        "drift": moves.c_x,
        "drift_regime": np.ma.masked_equal(moves.regime, Regime.INVALID),  # without friction
        "sticking": impact.drift(rod, friction=np.inf, **loss).c_x,
        "critical_friction": holds,
        "slide_friction": impact.slide_friction(rod, approach_ratio=s.ratio, **loss),
        "critical_tilts": _crossings(TILT, holds[:-1], s.friction),
    }


def words(d: dict[str, np.ndarray]) -> str:
    """Sentences on the impact and the drift at the setting."""
    here = {name: values[-1] for name, values in d.items() if values.shape == d["tilt"].shape}
    lost, slides, c_x = -200 * here["energy_change"], here["slide_friction"], here["drift"]
    through = f"below friction {slides:.3f}" if np.isfinite(slides) else "at every friction"
    way = "the way the rod leans" if c_x > 0 else "against the way the rod leans"
    tilts = ", ".join(f"{tilt:.2f}°" for tilt in np.degrees(d["critical_tilts"])) or "none"
    size = "without bound" if np.isinf(c_x) else f"{abs(c_x):.4g} of the plate's velocity"
    drifts = f"{size}, {way}" if abs(c_x) >= 5e-4 else "none"
    rise = f"{abs(here['c_z']):.3f} {'up' if here['c_z'] >= 0 else 'down'}"
    never = "at no value of the friction"
    return (
        f"{WORDS[here['regime']]}\n"
        f"After it the centre moves at {here['c_x']:+.3f} along the plate and {rise}, spin times k "
        f"is {here['spin']:+.3f}, in units of the speed before; "
        f"{abs(lost):.1f} % of the energy {'lost' if lost > -0.05 else 'GAINED'}.\n"
        f"At this tilt the contact slides through {through if slides else never}, and "
        f"slips back, once stopped, below {here['critical_friction']:.3f}. "
        f"Critical tilts at this friction: {tilts}.\n"
        f"Drift: {'not determined without friction' if np.isnan(c_x) else drifts}."
    )


# Ends of the drift's axis, so that it mostly stands still; without losses there is no bound.
STEPS = np.array([0.05, 0.5, 1, 2, 4, 6, 10])


def _ends(c_x: np.ndarray) -> tuple[float, float]:
    """Ends of the drift's axis, one of few values so that the axis seldom moves."""
    finite = c_x[np.isfinite(c_x)]
    sizes = -np.min(finite, initial=0), np.max(finite, initial=0.5)
    below, above = STEPS[np.searchsorted(STEPS[:-1], sizes)]
    return float(-below), float(above)


class Window:
    """The figure and its controls; `show` brings all panels up to date.

    Words and axes take most of the time of a full draw: `still` is a picture of all that stands
    still, onto which the rest is drawn.
    """

    @style
    def __init__(self, start: Setting):
        self.start, self.still = start, None
        self.figure = plt.figure(figsize=(11, 6.6), layout="none")
        self.words = self.figure.text(0.015, 0.98, "", va="top", fontsize=9, linespacing=1.5)
        place = {"left": 0.05, "right": 0.985, "bottom": 0.42, "top": 0.8, "wspace": 0.22}
        self.panels = self.figure.subplots(1, 3, gridspec_kw=place)
        self._regimes(data(start))
        self._lines()
        self.sliders, self.buttons = self._sliders(), self._buttons()
        controls = (*self.sliders.values(), *self.buttons.values())
        for control in controls:
            control.drawon = False  # `show` draws it
        axes = (*self.panels, *(control.ax for control in controls))
        moving = [artist for ax in axes for artist in (*ax.collections, *ax.patches, *ax.lines)]
        moving += [edge for ax in self.panels for edge in ax.spines.values()]  # over the colours
        moving += [self.words, *self.numbers, *(slider.valtext for slider in self.sliders.values())]
        self.moving = sorted(moving, key=lambda artist: artist.zorder)
        self.figure.canvas.mpl_connect("key_press_event", self._key)
        self.figure.canvas.mpl_connect("draw_event", self._forget)
        self.show()

    def _regimes(self, d: dict[str, np.ndarray]) -> None:
        """Make the coloured panels and their legend."""
        left, *others = self.panels
        columns_deg, edges_deg = np.degrees(TILT[::10]), np.linspace(-0.25, 90.25, 182)
        self.map = map_regimes(left, columns_deg, FRICTION, d["regimes"])
        names = ("regime", "drift_regime")
        self.shades = {
            n: shade(ax, edges_deg, d[n][:-1:10]) for ax, n in zip(others, names, strict=True)
        }
        names = (text.partition(":")[0].lower() for text in WORDS.values())
        patches = [Patch(color=c, label=n) for c, n in zip(REGIME_MAP.colors, names, strict=True)]
        self.figure.legend(handles=patches, loc="upper right")

    def _lines(self) -> None:
        """Make curves, marks and axes."""
        left, middle, right = self.panels
        self.curves, self.rings = {}, {}
        for ax, name, colour, dashes, label in (
            (left, "slide_friction", BLACK, "-", "slides through below"),
            (left, "critical_friction", BLACK, "--", "slips back below, once stopped"),
            (middle, "c_x", BLACK, "-", "$c_x'$"),
            (middle, "c_z", BLUE, "--", "$c_z'$"),
            (middle, "spin", GREEN, "-.", r"$k\,\omega'$"),
            (middle, "c_x_before", BLACK, ":", "$c_x$ before"),
            (right, "drift", BLACK, "-", "$c_x/V_z$"),
            (right, "sticking", BLUE, "--", "if it always stuck"),
        ):
            look = {"color": colour, "label": label}
            (self.curves[name],) = ax.plot(np.degrees(TILT), 0 * TILT, dashes, **look)
            (self.rings[name],) = ax.plot([], [], "o", color=colour, mfc="w")
        ring = {"color": RED, "mfc": "w", "ms": 7, "mew": 1.5, "zorder": 3, "label": "here"}
        (self.here,) = left.plot([], [], "o", **ring)
        corner = {"color": RED, "ls": "", "marker": "D", "label": "critical tilts"}
        self.corners = [ax.plot([], [], **corner)[0] for ax in (left, right)]
        thin = {"color": "0.4", "lw": 0.6, "ls": ":"}
        self.level, self.uprights = left.axhline(**thin), [ax.axvline(**thin) for ax in self.panels]
        left.set(ylabel=r"friction $\mu$", ylim=(0, 1))
        middle.set(ylabel="velocity / speed before", ylim=(-1.05, 1.05))
        right.set_ylabel("drift / plate velocity")
        self.numbers = []
        titles = ("regimes; critical friction", r"afterwards $c_x',\ c_z',\ k\,\omega'$", "drift")
        name_panels(self.panels, titles)
        for ax in self.panels:
            tilt_axis(ax)
            ax.tick_params(direction="out", top=False, right=False)  # not under the colours
            ax.legend(loc="upper left", bbox_to_anchor=(-0.02, -0.16), ncols=2)
            self.numbers.append(ax.text(1, 1.03, "", transform=ax.transAxes, ha="right"))

    def _sliders(self) -> dict[str, Slider]:
        sliders = {}
        for row, (name, (low, high, label, form)) in enumerate(RANGES.items()):
            ax = self.figure.add_axes((0.14, 0.2 - 0.04 * row, 0.42, 0.03))
            look = {"valfmt": form, "handle_style": {"size": 8}, "color": BLUE}
            sliders[name] = Slider(ax, label, low, high, valinit=getattr(self.start, name), **look)
            sliders[name].on_changed(self.show)
        return sliders

    def _buttons(self) -> dict[str, RadioButtons]:
        buttons = {}
        for column, (name, labels) in enumerate(CHOICES.items()):
            ax = self.figure.add_axes((0.68 + 0.15 * column, 0.04, 0.13, 0.17))
            ax.set_title(name, loc="left")
            active = list(labels).index(getattr(self.start, name))
            buttons[name] = RadioButtons(ax, list(labels.values()), active, useblit=False)
            buttons[name].on_clicked(self.show)
        return buttons

    def _key(self, event: Any) -> None:
        if event.key == "r":
            self.move(self.start)

    def _forget(self, _: Any) -> None:
        self.still = None  # the window may have another size

    def move(self, setting: Setting) -> None:
        """Set the controls, and draw once."""
        for name, control in (self.sliders | self.buttons).items():
            value, control.eventson = getattr(setting, name), False
            if name in RANGES:
                control.set_val(value)
            else:
                control.set_active(list(CHOICES[name]).index(value))
            control.eventson = True
        self.show()

    def setting(self) -> Setting:
        """Setting that the controls show."""
        numbers = {name: float(slider.val) for name, slider in self.sliders.items()}
        keys = {label: key for labels in CHOICES.values() for key, label in labels.items()}
        chosen = {name: keys[button.value_selected] for name, button in self.buttons.items()}
        return Setting(**numbers, **chosen)

    def show(self, _: Any = None) -> None:
        """Bring all panels up to date with the controls."""
        setting = self.setting()
        d, tilt_deg, friction = data(setting), setting.tilt_deg, setting.friction
        self.words.set_text(words(d))
        self.map.set_array(d["regimes"])
        for name, mesh in self.shades.items():
            mesh.set_array(d[name][None, :-1:10])
        for name, curve in self.curves.items():
            curve.set_ydata(d[name][:-1])
            self.rings[name].set_data([tilt_deg], d[name][-1:])
        for upright in self.uprights:
            upright.set_xdata([tilt_deg] * 2)
        self.level.set_ydata([friction] * 2)
        self.here.set_data([tilt_deg], [friction])
        corners = d["critical_tilts"]
        heights = 0 * corners + friction, np.interp(corners, TILT, d["drift"][:-1])
        for marks, height in zip(self.corners, heights, strict=True):
            marks.set_data(np.degrees(corners), height)
        shown = ("critical_friction",), ("c_x", "c_z", "spin"), ("drift",)
        for number, names in zip(self.numbers, shown, strict=True):
            number.set_text(",  ".join(f"{d[name][-1]:.3f}" for name in names))
        right, ends = self.panels[-1], _ends(d["drift"])
        if right.get_ylim() != ends:
            right.set_ylim(ends)
            self.still = None
        self._paint()

    def _paint(self) -> None:
        """Draw all that moves onto the picture of all that does not."""
        canvas = self.figure.canvas
        if not canvas.supports_blit:
            canvas.draw_idle()
            return
        if self.still is None:
            for artist in self.moving:
                artist.set_animated(True)
            self.figure.draw(canvas.get_renderer())
            self.still = canvas.copy_from_bbox(self.figure.bbox)
            for artist in self.moving:
                artist.set_animated(False)  # or a picture that the user saves lacks it
        canvas.restore_region(self.still)
        for artist in self.moving:
            self.figure.draw_artist(artist)
        canvas.blit(self.figure.bbox)


@style
def write(start: Setting, path: Path) -> None:
    """Write the picture of a setting."""
    window = Window(start)
    try:
        window.figure.savefig(path, dpi=200)
    finally:
        plt.close(window.figure)


@style
def run(start: Setting) -> bool:
    """Open the window until it is closed; False where Matplotlib has none to open."""
    try:
        window = Window(start)
    except ImportError:  # Matplotlib's: the backend that was asked for finds no display
        return False
    try:
        if opens := type(window.figure.canvas.manager) is not FigureManagerBase:
            plt.show()
        return opens
    finally:
        plt.close(window.figure)
