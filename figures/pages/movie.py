r"""A scene as an animation: rods of true width, the plate, and what the tip of one rod does.

>>> import md
>>> from figures.pages import movie
>>> film = movie.record(md.load("quasi2d"), periods=2, frames=8)
>>> movie.write(film, "row.gif")

The ends of a box meet: a rod that leaves on the right comes back on the left. An annulus is shown
rolled out: rods at their place around it, as they lean along it. One rod is marked, with its path
behind it, which shows the drift. The lower panel shows its lowest point (red) and the plate (grey):
both move by a small part of a rod's width. The picture of the README, 1.4 MB:

    python -m figures movie quasi2d --set rods.count=20 --set box.length=24 --set step.size=4e-5 \
        --periods 24 --frames 4 --out figures/gallery/row.gif
"""

from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patheffects import Normal, Stroke
from PIL import Image
from tqdm import tqdm

import md
from impact import InputError
from impact._arguments import count
from md.host import prepare

from ..lib.style import RED, style
from ..lib.timing import onward

DURATION = 40  # of a picture, in ms
LARGEST = 5000  # pictures
COLOURS = 16  # of all pictures
TRACE = 32  # points a period of the lower panel, at least
WINDOW = 4.0  # periods in the lower panel
INCHES, DPI = 6.0, 100
OUTLINE = 0.06  # d
DARK, PALE, GREY = "0.25", "#BFD7EA", "0.6"


class Film(NamedTuple):
    """States of a run, at more times than there are pictures."""

    scene: md.Scene
    time: np.ndarray  # (T,), periods
    plate: np.ndarray  # (T,), height
    x: np.ndarray  # (T, N), without the box's jumps
    z: np.ndarray
    tilt: np.ndarray  # rad
    every: int  # from picture to picture

    @property
    def length(self) -> float | None:
        """Length of the box, or around the annulus at its middle; None without either."""
        if self.scene.annulus:
            return 2 * np.pi * self.scene.annulus.middle
        return self.scene.box.length if self.scene.box else None

    @property
    def pictures(self) -> int:
        """Number of pictures."""
        return len(self.time) // self.every

    @property
    def tips(self) -> np.ndarray:
        """Lowest point of each rod."""
        half = (self.scene.rods.length - 1) / 2
        return self.z - half * np.abs(np.cos(self.tilt)) - 0.5


def record(scene: md.Scene, periods: int = 20, frames: int = 8, progress: bool = False) -> Film:
    """Film of a scene that is run now, with `frames` pictures a period.

    Raises
    ------
    ValueError
        If there would be none, or more than `LARGEST`; and as `md.run`.
    """
    count("periods", periods, 1)
    count("frames", frames, 1)
    if periods * frames > LARGEST:
        raise InputError(f"periods times frames must be at most {LARGEST}, got {periods * frames}")
    every = -(-TRACE // frames)
    engine, states, plate = prepare(scene), [], []  # as a run has it: one kernel for both
    series = engine.series(periods)
    steps = np.arange(periods * frames * every) * engine.per // (frames * every)
    for step in tqdm(steps.tolist(), unit=" shots", delay=2, disable=None if progress else True):
        onward(engine, step - engine.step, series)
        states.append(_places(scene, engine.rods))
        plate.append(engine.plate_height)
    x, z, tilt = np.moveaxis(states, 1, 0)
    if scene.annulus:  # azimuths jump once around
        x = np.unwrap(x, axis=0, period=2 * np.pi * scene.annulus.middle)
    return Film(scene, steps / engine.per, np.array(plate), x, z, tilt, every)


def _places(scene: md.Scene, rods: np.ndarray) -> np.ndarray:
    """Places x, z [d] and tilts [rad] of rods, (3, rods); in an annulus along its middle."""
    if not scene.annulus:
        x, z, sine, cosine, *_ = rods.T
        return np.array([x, z, np.arctan2(sine, cosine)])
    x, y, z, u_x, u_y, u_z = rods[:, :6].T
    azimuth = np.arctan2(y, x)
    lean = np.cos(azimuth) * u_y - np.sin(azimuth) * u_x
    return np.array([scene.annulus.middle * azimuth, z, np.arctan2(lean, u_z)])


def _window(film: Film) -> tuple[float, float, float, float]:
    """Left, right, bottom and top end of the picture, in d."""
    if film.length:
        left, right = 0.0, film.length
    else:
        beside = film.scene.rods.length / 2 + 0.5
        left, right = film.x.min() - beside, film.x.max() + beside
    bottom = min(film.plate.min(), film.tips.min()) - 0.8
    return left, right, bottom, (2 * film.z - film.tips).max() + 0.3


def segments(film: Film, i: int) -> tuple[np.ndarray, np.ndarray]:
    """Axes of the rods at a time, (n, 2, 2), with their images at both ends; their numbers."""
    half, number, x = (film.scene.rods.length - 1) / 2, np.arange(film.x.shape[1]), film.x[i]
    if film.length:
        x = np.concatenate([x % film.length + side * film.length for side in (-1, 0, 1)])
        number = np.tile(number, 3)
    z, tilt = film.z[i][number], film.tilt[i][number]
    middle, up = np.stack([x, z], -1), half * np.stack([np.sin(tilt), np.cos(tilt)], -1)
    return np.stack([middle - up, middle + up], 1), number


class Picture:
    """Figure of a film, redrawn for each time."""

    def __init__(self, film: Film):
        self.film, self.marked = film, film.x.shape[1] // 2
        left, right, bottom, top = _window(film)
        tall = min(INCHES * (top - bottom) / (right - left), 6.0)
        below = 1.1 if film.scene.plate else 0.1
        whole = tall + below + 0.3
        self.figure = plt.figure(figsize=(INCHES, whole), dpi=DPI, layout="none")
        row = self.figure.add_axes((0, below / whole, 1, tall / whole))
        row.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
        row.axis("off")
        row.apply_aspect()  # a high picture does not fill the width
        self.words = self.figure.text(0.01, 1 - 0.06 / whole, "", va="top", fontsize=10)
        (start, _), (end, _) = row.transData.transform([(0, 0), (1, 0)])
        points = 72 / DPI * (end - start)  # of a length of 1
        outlined = [Stroke(linewidth=points, foreground=DARK), Normal()]
        inside = points * (1 - 2 * OUTLINE)
        self.rods = LineCollection(
            [], linewidths=inside, path_effects=outlined, capstyle="round", zorder=3
        )
        self.trail = LineCollection([], colors=RED, linewidths=1.2, zorder=4, alpha=0.8)
        for artist in (self.rods, self.trail):
            row.add_collection(artist, autolim=False)
        if film.scene.plate:
            self.plate = row.axhspan(bottom - 1, 0, color=GREY, lw=0, zorder=2)
            self._lower(below / whole)

    def _lower(self, share: float) -> None:
        """Draw the lower panel: plate and tip over the last periods."""
        film = self.film
        ax = self.trace = self.figure.add_axes((0.11, 0.4 * share, 0.87, 0.56 * share))
        tip = film.tips[:, self.marked]
        ax.plot(film.time, film.plate, color="0.5", lw=1.5)
        ax.plot(film.time, tip, color=RED, lw=1.2)
        high = max(film.plate.max(), min(tip.max(), film.plate.max() + 2))
        ax.set(ylim=(film.plate.min() - 0.06, high + 0.06), ylabel="height / d")
        time = "periods of the plate" if film.scene.vibrates else r"time / $\sqrt{d/g}$"
        ax.set_xlabel(time, labelpad=1)
        self.now = ax.axvline(0, color="k", lw=0.8)

    def show(self, picture: int) -> None:
        """Draw picture number `picture`."""
        film, i = self.film, picture * self.film.every
        time = film.time[i]
        axes, number = segments(film, i)
        self.rods.set_segments(axes)
        self.rods.set_color(np.where(number == self.marked, RED, PALE))
        self.trail.set_segments(self._path(i))
        unit = "periods" if film.scene.vibrates else r"$\sqrt{d/g}$"
        words = [f"t = {time:5.1f} {unit}", f"tilt {np.degrees(film.tilt[i].mean()):.1f}°"]
        if i:
            moved = (film.x[i] - film.x[0]).mean()
            seconds = time / film.scene.frequency
            drift = moved / seconds * film.scene.cm_per_s
            words += [f"drift {drift:+.1f} cm/s", f"moved {moved:+.2f} d"]
        self.words.set_text("    ".join(words))
        if film.scene.plate:
            self.plate.set_height(film.plate[i] - self.plate.get_y())
            middle = max(time, WINDOW / 2)
            self.trace.set_xlim(middle - WINDOW / 2, middle + WINDOW / 2)
            self.now.set_xdata([time] * 2)

    def _path(self, i: int) -> list[np.ndarray]:
        """Path of the centre of the marked rod, cut where the box ends."""
        x, z = self.film.x[: i + 1, self.marked], self.film.z[: i + 1, self.marked]
        length = self.film.length
        if length is None:
            return [np.stack([x, z], -1)]
        cuts = np.flatnonzero(np.diff(x // length)) + 1
        return np.split(np.stack([x % length, z], -1), cuts)

    def shot(self, picture: int) -> Image.Image:
        """Picture number `picture`, in all its colours."""
        self.show(picture)
        self.figure.canvas.draw()
        return Image.fromarray(np.asarray(self.figure.canvas.buffer_rgba())).convert("RGB")


@style
def write(film: Film, path: str | Path, progress: bool = False) -> None:
    """Write a film as a GIF that repeats.

    It has one palette for all pictures, of the middle one: half of the size of one palette each.
    """
    picture = Picture(film)
    numbers = tqdm(range(film.pictures), unit=" frames", disable=None if progress else True)
    try:
        palette = picture.shot(film.pictures // 2).quantize(COLOURS, Image.Quantize.MAXCOVERAGE)
        plain = Image.Dither.NONE
        first, *rest = (picture.shot(n).quantize(palette=palette, dither=plain) for n in numbers)
        first.save(path, save_all=True, append_images=rest, duration=DURATION, loop=0, disposal=1)
    finally:
        plt.close(picture.figure)
