"""Energy of rods, compiled: all forces but dashpots and friction derive from it.

Weights are those of the forces: of two ends that meet, of places between two ends (`pairs`,
`walls`).
"""

from math import sqrt

from ..cache import kernel
from .closest import between_ends, gap_vector, near_end
from .pairs import NEARER, nearer, rise, seen_through
from .state import director_of, place_of, turn_of, velocity_of, weight
from .vectors import along, dot, height, rotated
from .walls import from_above, from_axis, passes


@kernel
def spring(law, overlap):
    """Energy of a contact."""
    return 0.4 * law.stiffness * overlap * overlap * sqrt(overlap) if overlap > 0.0 else 0.0


@kernel
def of_plate(law, upper, half, place, director, plate):
    """Energy of the caps in the plate."""
    if law is None:
        return 0.0
    total = spring(law, plate + 0.5 - height(place) + half * height(director))
    if upper is None:
        return total
    return total + spring(law, plate + 0.5 - height(place) - half * height(director))


@kernel
def of_wall(wall, upper, half, place, director, side):
    """Energy in a wall; `side`: 1 the convex one, -1 the concave one."""
    total = 0.0
    if wall is None:
        return total
    for cap in range(1 if upper is None else 2):
        rho, _ = from_axis(along(place, half if cap else -half, director))
        total += spring(wall.normal, 0.5 - side * (rho - wall.radius))
    seen = from_above(place, director)
    if side > 0 and passes(seen, half, wall.radius + 0.5):
        rho, _ = from_axis(along(place, -seen[1] / seen[2], director))
        lower, _ = from_axis(along(place, -half, director))
        upper_rho, _ = from_axis(along(place, half, director))
        share = rise((lower - rho) / NEARER)[0] * rise((upper_rho - rho) / NEARER)[0]
        total += share * spring(wall.normal, 0.5 - rho + wall.radius)
    return total


@kernel
def of_crossing(law, half, apart, a, b):
    """Energy of two rods between their ends, in space."""
    if len(a) == 2:
        return 0.0
    near, inside, _ = between_ends(apart, a, b, half)
    if not inside:
        return 0.0
    distance, share = sqrt(near.square), 1.0
    for end in range(4):
        share *= nearer(near_end(apart, a, b, half, end), distance)[0]
    return share * spring(law, 1.0 - distance)


@kernel
def of_pair(law, upper, half, apart, a, b):
    """Energy of two rods in each other."""
    total = spring(law, 1.0 - sqrt(near_end(apart, a, b, half, 0).square))
    if upper is None:
        return total
    for end in range(1, 4):
        total += spring(law, 1.0 - sqrt(near_end(apart, a, b, half, end).square))
    for end in range(2):
        near = near_end(apart, a, b, half, end)
        r = gap_vector(apart, a, b, near.s, half if near.t > 0.0 else -half)
        total -= spring(law, 1.0 - sqrt(dot(r, r)))
    return total + of_crossing(law, half, apart, a, b)


@kernel
def of_pairs(between, effects, rods, listed, dt):
    """Energy of all listed pairs half a step ago."""
    total = 0.0
    if between is None:
        return total
    now = listed.turn[0]
    for k in range(listed.start[now, rods.shape[0]]):
        i, j, image = listed.index[now, k, 0], listed.index[now, k, 1], listed.index[now, k, 2]
        place, a = earlier(effects.up, rods, i, dt)
        other, b = earlier(effects.up, rods, j, dt)
        apart = seen_through(effects.period, along(place, -1.0, other), image)
        total += of_pair(between.normal, effects.upper, effects.half_length, apart, a, b)
    return total


@kernel
def earlier(up, rods, i, dt):
    """Place and director half a step ago."""
    back = -dt / 2
    director = rotated(director_of(up, rods, i), turn_of(up, rods, i), back)
    return along(place_of(up, rods, i), back, velocity_of(up, rods, i)), director


@kernel
def spinning(rolling, w, director):
    """Twice the energy of a rotation, over the moment of inertia."""
    if rolling is None:
        return dot(w, w)
    return dot(w, w) + rolling * dot(w, director) ** 2


@kernel(inline=False)
def energy(effects, rods, listed, plate, dt):
    """Kinetic, potential and elastic energy half a step ago; `plate`: its height then."""
    half, upper, up = effects.half_length, effects.upper, effects.up
    total = of_pairs(effects.between, effects, rods, listed, dt)
    for i in range(rods.shape[0]):
        place, director = earlier(up, rods, i, dt)
        c, w = velocity_of(up, rods, i), turn_of(up, rods, i)
        total += 0.5 * (dot(c, c) + spinning(effects.rolling, w, director) / effects.lightness)
        total -= dot(weight(effects.gravity, place), place)
        total += of_plate(effects.normal, upper, half, place, director, plate)
        total += of_wall(effects.inner, upper, half, place, director, 1)
        total += of_wall(effects.outer, upper, half, place, director, -1)
    return total
