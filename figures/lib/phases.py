"""Panels of landing phases over the plate's cycle, and estimates of rods that bounce."""

from collections.abc import Iterable, Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from impact import landing_density

from .style import RED, Data, name_panels, tilt_axis

EXPECTED = 0.5 - 1 / np.pi  # part of H = (1 + cos(theta))/2 pi while the plate falls


def middles(bins: int) -> np.ndarray:
    """Phases [rad] in the middle of equal bins over the cycle."""
    return 2 * np.pi * (np.arange(bins) + 0.5) / bins


def estimates(name: str, values: list) -> Data:
    """Means and errors of `impact.bouncing.Estimate`s, as `name` and `name_error`."""
    means, errors = zip(*values, strict=True)
    return {name: np.array(means), f"{name}_error": np.array(errors)}


def phase_panels(axes: np.ndarray, top: float) -> Iterator[Axes]:
    """Yield all panels but the last, to be drawn into; then add what they have in common."""
    fine = np.linspace(0, 360, 361)
    for ax in axes.flat[:-1]:
        ax.axvspan(90, 270, color="0.93", lw=0)
        yield ax
        ax.plot(fine, landing_density(np.radians(fine)), color=RED, label=r"$H(\theta)$")
        ax.set(xlim=(0, 360), ylim=(0, top), xticks=range(0, 361, 90))
        ax.set(xlabel=r"phase $\theta$ of the plate (deg)")
    for ax in axes[:, 0]:
        ax.set_ylabel("density of landings (1/rad)")
    axes[0, 0].text(180, 0.95 * top, "plate falls", ha="center", va="top", color="0.3")
    axes[0, 0].legend(loc="upper center", bbox_to_anchor=(0.5, 0.9))


def share_panel(figure: Figure, tilt_deg: Iterable[float], last_deg: float, step: float) -> Axes:
    """Name all panels, by tilts, and set up the last one: the share of landings on the way down."""
    *_, last = figure.axes
    last.axhline(EXPECTED, color=RED, label=r"$H(\theta)$")
    tilt_axis(last, 0, last_deg, step)
    last.set(ylabel="landings while the plate falls")
    name_panels(figure.axes, [*(rf"$\phi={t:.0f}$°" for t in tilt_deg), "share on the way down"])
    return last
