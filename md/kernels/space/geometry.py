"""Closest points in space, compiled: rod and rod, rod and cylindrical wall.

A rod's axis is the segment of all centre + s director, |s| <= half. Each of the four ends of two
rods has a closest point on the other axis, and is a contact of its own, as in the plane. Rods that
cross touch between their ends as well. As they turn parallel, or slide off each other's end, that
contact becomes one with an end's, and counts by how much nearer it is than each of the four, so
 that no force jumps. The same holds for a rod that lies along the convex inner wall.
"""

from math import sqrt

from ...cache import kernel
from ..vectors import along, dot

NEARER = 0.1  # d; by so much nearer than all ends, a contact between them counts in full


@kernel
def at_end(apart, a, b, half, end):
    """Places s, t on both axes of the contact at one of four ends, 0 and 1 the first rod's.

    `apart` leads from the second centre to the first; `a`, `b` are the directors.
    """
    across, side = dot(a, b), half if end & 1 else -half
    if end < 2:
        return side, min(max(dot(apart, b) + side * across, -half), half)
    return min(max(side * across - dot(apart, a), -half), half), side


@kernel
def between_ends(apart, a, b, half):
    """Places of the closest points of both lines, and whether they lie inside of both rods.

    Third, the squared sine between the lines. The first place is the nearest to the second, however
    far that is off where lines are nearly parallel: their distance is hardly wrong.
    """
    across = dot(a, b)
    skew = 1.0 - across * across
    if skew < 1e-12:
        return 0.0, 0.0, 0.0, False
    p, q = dot(apart, a), dot(apart, b)
    t = (q - across * p) / skew
    s = across * t - p
    return s, t, skew, abs(s) < half and abs(t) < half


@kernel
def gap_vector(apart, a, b, s, t):
    """From a place on the second axis to one on the first."""
    return along(along(apart, s, a), -t, b)


@kernel
def rise(x):
    """From 0 at 0 to 1 at 1 without a kink, and its slope."""
    if x <= 0.0:
        return 0.0, 0.0
    if x >= 1.0:
        return 1.0, 0.0
    return x * x * (3.0 - 2.0 * x), 6.0 * x * (1.0 - x)


@kernel
def from_above(place, director):
    """Of a rod seen from above: x.x, x.u and u.u of its centre x and its director u."""
    x, y, u, v = place[0], place[1], director[0], director[1]
    return x * x + y * y, x * u + y * v, u * u + v * v


@kernel
def beyond(seen, s):
    """Squared distance of a place of the rod from the axis of the annulus."""
    return seen[0] + s * (2.0 * seen[1] + s * seen[2])


@kernel
def passes(seen, half, distance):
    """Whether the rod comes closer than that to the axis of the annulus between its ends.

    It is closest at s = -x.u/u.u.
    """
    square, slope, flat = seen
    if abs(slope) >= half * flat or flat < 1e-12:
        return False
    return (square - distance * distance) * flat < slope * slope


@kernel
def from_axis(point):
    """Horizontal distance of a point from the axis of the annulus, and the direction outwards."""
    rho = sqrt(point[0] * point[0] + point[1] * point[1])
    return rho, (point[0] / rho, point[1] / rho, 0.0)
