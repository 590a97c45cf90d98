"""Where rods can be in the gap of an annulus: the largest tilt of one, and a start for many."""

from dataclasses import dataclass
from math import asin, cos, hypot, pi, sin, sqrt

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from ..contact import Normal
from ..row import Between
from . import crowd


@dataclass(frozen=True)
class Gap:
    """Between two cylinders about the same vertical axis; radii in rod diameters."""

    inner: float
    outer: float

    def __post_init__(self) -> None:
        if not 0 < self.inner < self.outer < 1e6:
            raise ValueError(f"annulus must have 0 < inner < outer, got {self.inner}, {self.outer}")
        if not self.outer - self.inner >= 1:
            raise ValueError(
                f"annulus must be at least a diameter wide, got {self.outer - self.inner:.6g}"
            )

    @property
    def middle(self) -> float:
        """Radius half way."""
        return (self.inner + self.outer) / 2


def largest_tilt(gap: Gap, length: float, *, flat: bool = False) -> float:
    """Largest tilt of a single rod along the gap, in radians; pi/2 if it can lie down.

    The rod touches the inner wall at its middle and the outer wall at its ends.

    Parameters
    ----------
    gap : Gap
    length : overall, in diameters
    flat : whether one end is flat, and the other round, as those of the experiment; else both are
        round

    Source: contact of a spherocylinder, or of the rim of a flat end, with the outer cylinder.
    """
    if not length >= 1:
        raise ValueError(f"length must be at least 1, got {length!r}")
    if flat:
        return _largest_flat(gap, length)
    # Ends' centres as far from the axis as the outer wall allows; middle on the inner wall.
    reach = sqrt((gap.outer - 0.5) ** 2 - (gap.inner + 0.5) ** 2)
    half = (length - 1) / 2
    return pi / 2 if half <= reach else asin(reach / half)


def _largest_flat(gap: Gap, length: float) -> float:
    """One end a disc across the axis, the other a cap; its middle on the inner wall."""
    off, turn = gap.inner + 0.5, np.linspace(0, 2 * pi, 721)

    def room(tilt: float) -> float:
        """What the outer wall leaves at the worse end, for the best place along the annulus."""
        rim_x, rim_y = 0.5 * np.cos(turn) * cos(tilt), off + 0.5 * np.sin(turn)

        def tightness(shift: float) -> float:
            disc = np.hypot(shift + length / 2 * sin(tilt) + rim_x, rim_y).max()
            cap = 0.5 + hypot(shift - (length / 2 - 0.5) * sin(tilt), off)
            return max(disc, cap)

        return gap.outer - minimize_scalar(tightness, (-0.1, 0.1), options={"xtol": 1e-12}).fun

    return pi / 2 if room(pi / 2) >= 0 else float(brentq(room, 0.0, pi / 2, xtol=1e-10))


def placed(
    gap: Gap, count: int, length: float, *, tilt: float | None = None, seed: int = 0
) -> np.ndarray:
    """Centres and directors of `count` rods around the gap, none in another or in a wall.

    The rods lean along the annulus and stand by turns at the inner and the outer wall, as far as
    their tilt leaves room (zig-zag); what overlaps then is relaxed, with soft contacts and no
    friction, the lower caps at one height.

    Parameters
    ----------
    gap, length : as of `largest_tilt`
    count : of rods
    tilt : to begin with, in radians; None: the one at which a zig-zag of rods fills the circle
    seed : of small random turns

    Returns
    -------
    (count, 6), the lower caps resting on z = 0

    Raises
    ------
    ValueError
        If the rods cannot be placed.
    """
    half, most = (length - 1) / 2, largest_tilt(gap, length)
    lean = min(_filling(gap, count, half, most) if tilt is None else tilt, 0.98 * most)
    room = _swing(gap, half, lean)
    random, rods = np.random.default_rng(seed), np.zeros((count, crowd.COLUMNS))
    for i in range(count):
        azimuth = 2 * pi * i / count
        low, high = room
        radius = (low, high)[i % 2] if i < count - count % 2 else (low + high) / 2
        angle = lean + 1e-3 * random.uniform(-1, 1)
        radial, ring = (cos(azimuth), sin(azimuth)), (-sin(azimuth), cos(azimuth))
        rods[i, :2] = radius * radial[0], radius * radial[1]
        rods[i, 3:6] = sin(angle) * ring[0], sin(angle) * ring[1], cos(angle)
    _relax(gap, rods, half)
    return rods[:, :6]


def _swing(gap: Gap, half: float, tilt: float) -> tuple[float, float]:
    """Smallest and largest radius of the middle of a rod that leans along the annulus."""
    reach = half * sin(tilt)
    low, high = gap.inner + 0.5, sqrt(max((gap.outer - 0.5) ** 2 - reach**2, 0.0))
    return low, max(low, high)


def _filling(gap: Gap, count: int, half: float, most: float) -> float:
    """Tilt at which neighbours of a zig-zag touch all around the circle."""

    def excess(tilt: float) -> float:
        low, high = _swing(gap, half, tilt)
        across = min(high - low, 1.0)
        return count * sqrt(1 - across**2) / cos(tilt) - pi * (low + high)

    if excess(0.0) >= 0:
        return 0.0
    if excess(0.999 * most) <= 0:
        return 0.98 * most
    return float(brentq(excess, 0.0, 0.999 * most))


def _relax(gap: Gap, rods: np.ndarray, half: float) -> None:
    """Push overlapping rods apart, downhill: velocities are dropped whenever they lead up."""
    soft = Normal(100.0)
    wall = [crowd.Wall(radius, soft, None) for radius in (gap.inner, gap.outer)]
    light = 1 / (0.1 + (2 * half + 1) ** 2 / 12)
    world = crowd.Space(half, light, None, None, None, None, None, *wall, Between(soft, None))
    n = len(rods)
    pairs, total, before = crowd.no_pairs(n), np.zeros((n, 6)), np.zeros((n, 6))
    left = np.inf
    for step in range(40_000):
        rods[:, 2] = 0.5 + half * np.abs(rods[:, 5])
        rods[:, 8] = 0
        _, why, _ = crowd.march(
            *(world, rods, before, None, None, pairs, 0.4, total, None, step, 1, 0.02),
        )
        if why not in (crowd.DONE, crowd.TOO_FAST):
            break
        left = np.abs(total).max()
        if left < 1e-5:  # overlaps of 2e-5 d
            rods[:, 6:] = 0
            return
        power = (total[:, :3] * rods[:, 6:9]).sum() + (total[:, 3:] * rods[:, 9:12]).sum()
        if power < 0:
            rods[:, 6:] = 0
    raise ValueError(
        f"rods.count {n} do not fit into the annulus of radii {gap.inner:g} and {gap.outer:g}: "
        f"forces of {left:.2g} k d are left after relaxation"
    )
