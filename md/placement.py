"""Where rods can be in the gap of an annulus: the largest tilt of one, and a start for many."""

from math import asin, cos, hypot, pi, sin, sqrt

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from .errors import InputError
from .kernels.codes import DIRECTOR, DONE, SPACE_COLUMNS, TOO_FAST, TURN, VELOCITY
from .kernels.contact import Clock, ContactForces, Normal
from .kernels.plane import Watchers
from .kernels.space.batch import no_contacts
from .kernels.space.forces import SpaceEffects, State, Wall
from .kernels.space.geometry import beyond, from_above, passes
from .kernels.space.march import march
from .kernels.space.pairs import nearest, no_pairs
from .scene import Annulus

_TOUCHING = 1e-4  # d; so deep, the paper's contacts push with five times a rod's weight
_STEPS = 8_000


def largest_tilt(gap: Annulus, length: float, *, flat: bool = False) -> float:
    """Largest tilt of a single rod along the gap, in radians; pi/2 if it can lie down.

    The rod touches the inner wall at its middle and the outer wall at its ends.

    Parameters
    ----------
    gap : Annulus
    length : overall, in diameters
    flat : whether one end is flat, and the other round, as those of the experiment; else both are
        round

    Source: contact of a spherocylinder, or of the rim of a flat end, with the outer cylinder.
    """
    if not length >= 1:
        raise InputError(f"length must be at least 1, got {length!r}")
    if flat:
        return _largest_flat(gap, length)
    # Ends' centres as far from the axis as the outer wall allows; middle on the inner wall.
    reach = sqrt((gap.outer - 0.5) ** 2 - (gap.inner + 0.5) ** 2)
    half = (length - 1) / 2
    return pi / 2 if half <= reach else asin(reach / half)


def _largest_flat(gap: Annulus, length: float) -> float:
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
    gap: Annulus, count: int, length: float, *, tilt: float | None = None, seed: int = 0
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
    for part in (1.0, 0.97, 0.93, 0.85, 0.7, 0.4, 0.0):  # what does not fit is tried steeper
        rods = _zigzag(gap, count, half, part * lean, np.random.default_rng(seed))
        left = _relax(gap, rods, half)
        if left < _TOUCHING:
            return rods[:, :VELOCITY]
    radii = f"{gap.inner:g} and {gap.outer:g}"
    why = f": overlaps of {left:.2g} d are left after relaxation" if np.isfinite(left) else ""
    raise InputError(f"rods.count {count} do not fit into the annulus of radii {radii}{why}")


def _zigzag(
    gap: Annulus, count: int, half: float, lean: float, random: np.random.Generator
) -> np.ndarray:
    """Rods around the gap, by turns as near to either wall as their tilt allows.

    An odd one stands in the middle, with as much more room beside it as it needs there: two rods
    that are apart by `across` need sqrt(1 - across^2) along the gap, two at one wall a diameter.
    """
    low, high = _swing(gap, half, lean)
    beside, turn = (sqrt(1 - min(across, 1) ** 2) for across in ((high - low) / 2, high - low))
    wider = count % 2 * max(beside / max(turn, 0.5) - 1, 0.0)  # in distances of the others
    rods = np.zeros((count, SPACE_COLUMNS))
    for i in range(count):
        odd_one = count % 2 == 1 and i == count - 1
        azimuth = 2 * pi * (i + odd_one * wider) / (count + 2 * wider)
        radius = (low + high) / 2 if odd_one else (low, high)[i % 2]
        angle = lean + 1e-3 * random.uniform(-1, 1)
        rods[i, :2] = radius * cos(azimuth), radius * sin(azimuth)
        flat = -sin(angle) * sin(azimuth), sin(angle) * cos(azimuth)
        rods[i, DIRECTOR:VELOCITY] = *flat, cos(angle)
    return rods


def _swing(gap: Annulus, half: float, tilt: float) -> tuple[float, float]:
    """Smallest and largest radius of the middle of a rod that leans along the annulus."""
    reach = half * sin(tilt)
    low, high = gap.inner + 0.5, sqrt(max((gap.outer - 0.5) ** 2 - reach**2, 0.0))
    return low, max(low, high)


def _filling(gap: Annulus, count: int, half: float, most: float) -> float:
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


def _relax(gap: Annulus, rods: np.ndarray, half: float) -> float:
    """Push overlapping rods apart, downhill; the largest overlap left.

    Velocities are dropped whenever they lead up.
    """
    soft, n = Normal(100.0), len(rods)
    light = 1 / (0.1 + (2 * half + 1) ** 2 / 12)
    inner, outer = (Wall(radius, soft, None) for radius in (gap.inner, gap.outer))
    between = ContactForces(soft, None)
    effects = SpaceEffects(half, light, inner=inner, outer=outer, between=between)
    force = np.zeros((n, 6))
    state = State(rods, np.zeros((n, 6)), None, no_pairs(n), None, force, batch=no_contacts())
    for step in range(_STEPS):
        rods[:, 2] = 0.5 + half * np.abs(rods[:, DIRECTOR + 2])
        rods[:, VELOCITY + 2] = 0
        if step % 100 == 0 and (left := overlap(gap, rods, half)) < _TOUCHING:
            break
        _, why, _ = march(effects, state, Watchers(None, None, None), Clock(step, 0.02), 1)
        if why not in (DONE, TOO_FAST):
            return np.inf
        velocity, turn = rods[:, VELOCITY:TURN], rods[:, TURN:]
        if (force[:, :3] * velocity).sum() + (force[:, 3:] * turn).sum() < 0:
            rods[:, VELOCITY:] = 0
    rods[:, VELOCITY:] = 0
    return left


def overlap(gap: Annulus, rods: np.ndarray, half: float) -> float:
    """Largest overlap of rods with each other and with the walls, in diameters."""
    parts = [(tuple(rod[:DIRECTOR]), tuple(rod[DIRECTOR:VELOCITY])) for rod in rods.tolist()]
    deepest = -np.inf
    for i, (x, a) in enumerate(parts):
        seen = from_above(x, a)
        squares = [beyond(seen, side * half) for side in (-1, 1)]
        outermost = np.sqrt(max(squares))
        if passes(seen, half, np.sqrt(min(squares))):
            squares.append(max(beyond(seen, -seen[1] / seen[2]), 0.0))
        innermost = np.sqrt(min(squares))
        deepest = max(deepest, gap.inner + 0.5 - innermost, outermost - gap.outer + 0.5)
        for y, b in parts[:i]:
            apart = x[0] - y[0], x[1] - y[1], x[2] - y[2]
            if apart[0] ** 2 + apart[1] ** 2 + apart[2] ** 2 < (2 * half + 1) ** 2:
                deepest = max(deepest, 1 - nearest(apart, a, b, half))
    return deepest
