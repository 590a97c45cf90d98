"""Places of rods in the gap of an annulus: largest tilt of a single rod, initial places of many."""

from collections.abc import Iterator
from math import acos, asin, cos, degrees, inf, pi, sin, sqrt

import numpy as np
from scipy.optimize import brentq, minimize
from scipy.spatial import cKDTree
from tqdm import tqdm

from .domains import InputError, number
from .kernels import DIRECTOR
from .kernels.vectors import IN_SPACE
from .scene import GAP, Annulus

_ROOM = 1e-5  # d; gap to which overlapping rods are pushed apart
_STEPS = 2_000  # iterations of that at most
_KEPT_DEG = 2.0  # by which rods that are pushed apart may lean otherwise than asked for


def largest_tilt(gap: Annulus, length: float) -> float:
    """Largest tilt of a single rod along the gap, in radians; pi/2 if it can lie down.

    The rod touches the inner wall at its middle and the outer wall at its ends.

    Parameters
    ----------
    gap : Annulus
    length : overall, in diameters; both ends are round

    Source: contact of a spherocylinder with the outer cylinder.
    """
    number("length", length, 1.0, inf, "at least 1")
    # Ends' centres as far from the axis as the outer wall allows; middle on the inner wall.
    reach = sqrt((gap.outer - 0.5) ** 2 - (gap.inner + 0.5) ** 2)
    half = (length - 1) / 2
    return pi / 2 if half <= reach else asin(reach / half)


def placed(
    gap: Annulus, count: int, length: float, *, tilt: float | None = None, seed: int = 0
) -> np.ndarray:
    """Place `count` rods around the gap, without overlaps; their centres and directors.

    The rods lean along the annulus and stand by turns at the inner and the outer wall, as far as
    their tilt leaves room (zig-zag). Then overlapping rods are pushed apart, the lower caps at one
    height, until all gaps are at least `scene.GAP`.

    Parameters
    ----------
    gap, length : as of `largest_tilt`
    count : of rods
    tilt : to begin with, in radians, whatever its sign; None: the one at which a zig-zag of rods
        fills the circle
    seed : of small random turns

    Returns
    -------
    (count, 6), the lower caps resting on z = 0

    Raises
    ------
    ValueError
        If the rods cannot be placed, or lean otherwise than asked for by 2 degrees on average.
    """
    radii = f"{gap.inner:g} and {gap.outer:g}"
    refused = f"rods.count {count} do not fit into the annulus of radii {radii}"
    if count > (fit := _most_upright(gap)):
        raise InputError(f"{refused}: at most {fit} do, upright")
    half, most = (length - 1) / 2, largest_tilt(gap, length)
    lean = min(_filling(gap, count, half, most) if tilt is None else abs(tilt), 0.98 * most)
    parts = (1.0, 0.97, 0.93, 0.85, 0.7, 0.4, 0.0)  # of the tilt: rods that do not fit are raised
    for part in tqdm(parts, "placing rods", unit="try", leave=False, delay=2, disable=None):
        rods = _pushed_apart(gap, _zigzag(gap, count, half, part * lean, seed), half)
        meetings = _meetings(gap, rods, half, _near(rods, half))
        left = max(deep.max(initial=-inf) for _, deep, *_ in meetings)
        if left <= -GAP:
            break
    else:
        raise InputError(
            f"{refused}: pushed apart as far as they go, overlaps of {max(left, 0.0):.2g} d are "
            "left"
        )
    leans = degrees(np.arccos(np.abs(rods[:, -1])).mean())
    if tilt is not None and abs(leans - abs(degrees(tilt))) > _KEPT_DEG:
        raise InputError(
            f"start.tilt_deg must leave {count} rods room in the annulus of radii {radii}, got "
            f"{degrees(tilt):g}: pushed apart, they lean by {leans:.3g}"
        )
    return rods


def _most_upright(gap: Annulus) -> int:
    """Upper bound of the number of rods in an annulus, with all lower caps at one height.

    In a gap below two diameters each cap has an angle around the axis to itself, which is smallest
    where its neighbour stands at the other wall, or both at the outer one; in a wider gap it has an
    area.
    """
    low, high = gap.inner + 0.5, gap.outer - 0.5
    if high - low >= 1:
        return int(4 * (gap.outer**2 - gap.inner**2))
    across = (low**2 + high**2 - 1) / (2 * low * high)  # cosine of the angle
    return int(2 * pi / acos(max(across, 1 - 0.5 / high**2)))


def _zigzag(gap: Annulus, count: int, half: float, lean: float, seed: int) -> np.ndarray:
    """Rods around the gap, (count, 6), by turns as near to either wall as their tilt allows.

    The last of an odd number stands in the middle, with as much more room beside it as it needs
    there.
    """
    low, high = _swing(gap, half, lean)
    places, radii = np.arange(count, dtype=float), np.resize([low, high], count)
    wider = 0.0  # in units of the other distances
    if count % 2:
        wider = max(_beside((high - low) / 2) / max(_beside(high - low), 0.5) - 1, 0.0)
        places[-1] += wider
        radii[-1] = (low + high) / 2
    azimuth = 2 * pi * places / (count + 2 * wider)
    outward = np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(count)])
    angle = lean + 1e-3 * np.random.default_rng(seed).uniform(-1, 1, (count, 1))
    director = np.sin(angle) * np.cross(IN_SPACE, outward) + np.cos(angle) * IN_SPACE
    return np.hstack([radii[:, None] * outward, director])


def _beside(across: float) -> float:
    """Least distance along the gap of two upright rods that are so far apart across it."""
    return sqrt(1 - min(across, 1.0) ** 2)


def _swing(gap: Annulus, half: float, tilt: float) -> tuple[float, float]:
    """Smallest and largest radius of the middle of a rod that leans along the annulus."""
    reach = half * sin(tilt)
    low, high = gap.inner + 0.5, sqrt(max((gap.outer - 0.5) ** 2 - reach**2, 0.0))
    return low, max(low, high)


def _filling(gap: Annulus, count: int, half: float, most: float) -> float:
    """Tilt at which neighbours of a zig-zag touch all around the circle; else the largest one."""

    def excess(tilt: float) -> float:
        low, high = _swing(gap, half, tilt)
        return count * _beside(high - low) / cos(tilt) - pi * (low + high)

    if excess(0.0) >= 0:
        return 0.0
    if excess(0.999 * most) <= 0:
        return most
    return brentq(excess, 0.0, 0.999 * most)


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Scalar products of two arrays of vectors."""
    return (a * b).sum(axis=1)


def _meetings(
    gap: Annulus, rods: np.ndarray, half: float, pairs: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]]:
    """Overlaps of rods with each wall and with one another, for the given pairs.

    Yields
    ------
    Numbers of rods; their overlaps, in d; unit vectors along which they come free; and from their
    centres along their axes to the closest points, in d.
    """
    place, director = rods[:, :DIRECTOR], rods[:, DIRECTOR:]
    everyone, from_above = np.arange(len(rods)), np.array([1.0, 1.0, 0.0])
    seen, along = place * from_above, director * from_above
    nearest = -_dot(seen, along) / np.maximum(_dot(along, along), 1e-12)
    for side, lever in (1, np.clip(nearest, -half, half)), (-1, half), (-1, -half):
        lever = np.broadcast_to(lever, len(rods))
        point = seen + lever[:, None] * along
        radius = np.linalg.norm(point, axis=1)
        deep = gap.inner + 0.5 - radius if side > 0 else radius + 0.5 - gap.outer
        yield everyone, deep, side * point / radius[:, None], lever
    i, j = pairs.T
    a, b, apart = director[i], director[j], place[i] - place[j]
    across, p, q = _dot(a, b), _dot(apart, a), _dot(apart, b)
    s = np.clip((across * q - p) / np.maximum(1 - across**2, 1e-12), -half, half)
    t = np.clip(q + s * across, -half, half)
    s = np.clip(t * across - p, -half, half)
    apart = apart + s[:, None] * a - t[:, None] * b
    distance = np.linalg.norm(apart, axis=1)
    outward = apart / np.maximum(distance, 1e-12)[:, None]
    yield i, 1 - distance, outward, s
    yield j, 1 - distance, -outward, t


def _near(rods: np.ndarray, half: float) -> np.ndarray:
    """Pairs of rods that may touch, even after they have moved by a diameter."""
    return cKDTree(rods[:, :DIRECTOR]).query_pairs(2 * half + 3, output_type="ndarray")


def _pushed_apart(gap: Annulus, rods: np.ndarray, half: float) -> np.ndarray:
    """Minimise the sum of the squares of all overlaps, with the lower caps on the plate."""
    n, pairs = len(rods), _near(rods, half)

    def standing(unknown: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rods on the plate, and the lengths of the vectors that become their directors."""
        flat, axis = unknown[: 2 * n].reshape(n, 2), unknown[2 * n :].reshape(n, 3)
        length = np.linalg.norm(axis, axis=1, keepdims=True)
        director = axis / length
        height = 0.5 + half * np.abs(director[:, 2])
        return np.column_stack([flat, height, director]), length

    def energy(unknown: np.ndarray) -> tuple[float, np.ndarray]:
        """Sum of the squares of all overlaps, and its gradient."""
        rods, length = standing(unknown)
        director, total = rods[:, DIRECTOR:], 0.0
        force, turn = np.zeros((2, n, 3))
        for rod, overlap, outward, lever in _meetings(gap, rods, half, pairs):
            deep = np.maximum(overlap + _ROOM, 0)
            total += (deep**2).sum()
            push = 2 * deep[:, None] * outward
            np.add.at(force, rod, push)
            np.add.at(turn, rod, lever[:, None] * push)
        turn[:, 2] += force[:, 2] * half * np.sign(director[:, 2])
        turn -= _dot(turn, director)[:, None] * director
        return total, -np.concatenate([force[:, :2].ravel(), (turn / length).ravel()])

    start = np.concatenate([rods[:, :2].ravel(), rods[:, DIRECTOR:].ravel()])
    options = {"maxiter": _STEPS, "maxfun": 2 * _STEPS, "ftol": 0.0, "gtol": 1e-9}
    found = minimize(energy, start, jac=True, method="L-BFGS-B", options=options)
    return standing(found.x)[0]
