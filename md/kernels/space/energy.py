"""Energy of rods in space, compiled: all forces but dashpots and friction derive from it.

Weights are those of the forces: of places between two ends (`pairs.shared`, `walls.beside`), and
of two ends that meet (`pairs.joined`).
"""

from math import sqrt

from ...cache import kernel
from ..codes import DIRECTOR, PLACE, TURN, VELOCITY
from ..vectors import along, dot, vector
from .forces import ends
from .geometry import NEARER, between_ends, from_above, from_axis, gap_vector, passes, rise
from .march import rotated
from .pairs import end_gaps, nearer


@kernel
def spring(law, overlap):
    """Energy of a contact."""
    return 0.4 * law.stiffness * overlap * overlap * sqrt(overlap) if overlap > 0.0 else 0.0


@kernel
def of_plate(law, half, place, director, height):
    """Energy of the caps in the plate."""
    total = 0.0
    if law is not None:
        for cap in range(ends(half)):
            s = half if cap else -half
            total += spring(law, height + 0.5 - place[2] - s * director[2])
    return total


@kernel
def of_wall(wall, half, place, director, side):
    """Energy in a wall; `side`: 1 the convex one, -1 the concave one."""
    total = 0.0
    if wall is None:
        return total
    for cap in range(ends(half)):
        rho, _ = from_axis(along(place, half if cap else -half, director))
        total += spring(wall.normal, 0.5 - side * (rho - wall.radius))
    seen = from_above(place, director)
    if side > 0 and passes(seen, half, wall.radius + 0.5):
        rho, _ = from_axis(along(place, -seen[1] / seen[2], director))
        lower, _ = from_axis(along(place, -half, director))
        upper, _ = from_axis(along(place, half, director))
        weight = rise((lower - rho) / NEARER)[0] * rise((upper - rho) / NEARER)[0]
        total += weight * spring(wall.normal, 0.5 - rho + wall.radius)
    return total


@kernel
def of_pair(law, half, apart, a, b):
    """Energy of two rods in each other."""
    found = end_gaps(apart, a, b, half)
    total = spring(law, 1.0 - sqrt(found[0][3]))
    if half == 0.0:
        return total
    for end in range(1, 4):
        total += spring(law, 1.0 - sqrt(found[end][3]))
    for end in range(2):
        s, t, _, _ = found[end]
        r = gap_vector(apart, a, b, s, half if t > 0.0 else -half)
        total -= spring(law, 1.0 - sqrt(dot(r, r)))
    s, t, _, inside = between_ends(apart, a, b, half)
    if inside:
        r = gap_vector(apart, a, b, s, t)
        distance = sqrt(dot(r, r))
        weight = nearer(found[0], distance)[0] * nearer(found[1], distance)[0]
        weight *= nearer(found[2], distance)[0] * nearer(found[3], distance)[0]
        total += weight * spring(law, 1.0 - distance)
    return total


@kernel
def of_pairs(between, half, rods, dt):
    """Energy of all pairs half a step ago."""
    total = 0.0
    if between is None:
        return total
    for i in range(rods.shape[0]):
        place, director = earlier(rods, i, dt)
        for j in range(i):
            apart = along(place, -1.0, vector(rods, j, PLACE))
            if dot(apart, apart) < (2.0 * half + 2.0) ** 2:
                other, b = earlier(rods, j, dt)
                apart = along(place, -1.0, other)
                total += of_pair(between.normal, half, apart, director, b)
    return total


@kernel
def earlier(rods, i, dt):
    """Place and director half a step ago."""
    back = -dt / 2
    director = rotated(vector(rods, i, DIRECTOR), vector(rods, i, TURN), back)
    return along(vector(rods, i, PLACE), back, vector(rods, i, VELOCITY)), director


@kernel
def axial(rolling, w, director):
    """Share of a rod's rotation about its axis in the square of w."""
    if rolling is None:
        return 0.0
    return rolling * dot(w, director) ** 2


@kernel
def falling(gravity, z):
    """Energy of a height."""
    return 0.0 if gravity is None else -gravity * z


@kernel(inline=False)
def energy(effects, rods, height, dt):
    """Kinetic, potential and elastic energy half a step ago; `height`: of the plate then."""
    half, total = effects.half_length, of_pairs(effects.between, effects.half_length, rods, dt)
    for i in range(rods.shape[0]):
        place, director = earlier(rods, i, dt)
        c, w = vector(rods, i, VELOCITY), vector(rods, i, TURN)
        spinning = dot(w, w) + axial(effects.rolling, w, director)
        total += 0.5 * dot(c, c) + 0.5 * spinning / effects.lightness
        total += falling(effects.gravity, place[2])
        total += of_plate(effects.normal, half, place, director, height)
        total += of_wall(effects.inner, half, place, director, 1)
        total += of_wall(effects.outer, half, place, director, -1)
    return total
