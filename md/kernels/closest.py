"""Closest points of rods, compiled: rod and rod, in the plane and in space.

A rod's axis is the segment of all centre + s director, |s| <= half. Each of the four ends of two
rods, 0 and 1 the first one's, has a closest point on the other axis, and is a contact of its own.
Rods that cross in space are closest between their ends.
"""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ..cache import kernel
from .vectors import along, dot

CHORD = 0.4142  # less than sqrt(2) - 1


class Near(NamedTuple):
    """A place on the axis of each of two rods."""

    s: float  # d; from the first centre
    t: float  # d; from the second
    gap: tuple  # d; from the second place to the first
    square: float  # d^2; of that distance


@kernel
def at_end(apart, a, b, half, end):
    """Places s, t on both axes of the contact at one of four ends.

    `apart` leads from the second centre to the first; `a`, `b` are the directors.
    """
    across, side = dot(a, b), half if end & 1 else -half
    if end < 2:
        return side, min(max(dot(apart, b) + side * across, -half), half)
    return min(max(side * across - dot(apart, a), -half), half), side


@kernel
def gap_vector(apart, a, b, s, t):
    """From a place on the second axis to one on the first."""
    return along(along(apart, s, a), -t, b)


@kernel
def near_end(apart, a, b, half, end):
    """`Near` of the contact at one of four ends."""
    s, t = at_end(apart, a, b, half, end)
    r = gap_vector(apart, a, b, s, t)
    return Near(s, t, r, dot(r, r))


@kernel
def between_ends(apart, a, b, half):
    """`Near` of the closest points of both lines, and whether they lie inside of both rods.

    Third, the squared sine between the lines. The first place is the nearest to the second, however
    far that is off where lines are nearly parallel: their distance is hardly wrong.
    """
    across = dot(a, b)
    skew = 1.0 - across * across
    if skew < 1e-12:
        return Near(0.0, 0.0, apart, np.inf), False, 0.0
    p, q = dot(apart, a), dot(apart, b)
    t = (q - across * p) / skew
    s = across * t - p
    r = gap_vector(apart, a, b, s, t)
    return Near(s, t, r, dot(r, r)), abs(s) < half and abs(t) < half, skew


@kernel
def nearest(apart, a, b, half):
    """Squared distance of two axes, which do not cross in the plane."""
    least = np.inf
    for end in range(4):
        least = min(least, near_end(apart, a, b, half, end).square)
    if len(a) == 3:
        near, inside, _ = between_ends(apart, a, b, half)
        if inside:
            least = min(least, near.square)
    return least


@kernel
def clearance(apart, a, b, half):
    """How far beyond 1 two axes are apart: a quick lower bound, below zero where there is none.

    In the plane all of the second axis is so far off the first one's line.
    """
    if len(a) == 2:
        off = abs(apart[0] * a[1] - apart[1] * a[0])
        return off - half * abs(a[0] * b[1] - a[1] * b[0]) - 1.0
    near, inside, _ = between_ends(apart, a, b, half)
    return sqrt(near.square) - 1.0 if inside else -1.0


@kernel
def open_at_least(square):
    """A lower bound of a distance beyond 1, given its square >= 1: a chord of the root."""
    return CHORD * (min(square, 2.0) - 1.0)
