"""Forces of surfaces on a rod, compiled: of the plate, and of the cylindrical walls of an annulus.

The plate touches a rod at both of its caps or corners; `rates` are the equations of one contact
between switches, of a rod alone on a plate at rest. A wall touches a rod with its ends; a rod
that lies along the convex inner wall touches it between them as well, with a weight as of rods that
cross (`pairs`). `side` is 1 of the inner wall, -1 of the outer one.
"""

from math import cos, sin, sqrt
from typing import NamedTuple

from ..cache import kernel
from . import DEEP, INNER, OUTER, PLATE_WORK, WALL_NORMAL
from .batch import FORCE, MOST, ONE, Alike, Given, acted, enter, get
from .contact import (
    Instant,
    Kept,
    Meeting,
    contact,
    dashpot,
    elastic_energy,
    friction_of_mode,
    powers_of,
    turn_by,
    turning,
)
from .pairs import NEARER, moving, rise
from .state import forget, nothing_kept, point, pull, rod_of
from .vectors import (
    IN_SPACE,
    along,
    cross,
    dot,
    height,
    raised,
    spread,
    swing,
    times,
    torque,
    upward,
)

# The plate


class Touch(NamedTuple):
    """Contact of one cap or corner with the plate; open unless the overlap is > 0."""

    overlap: float  # d
    end: tuple  # d; from the centre of mass to the centre of the cap, or to the corner
    arm: tuple  # d; from the centre of mass to the contact point
    half: tuple  # sqrt(g d); velocity of that point against the plate half a step before
    kept: Kept  # forces and spring of this step
    rate: float  # sqrt(g d), at which the contact opens (+) or closes (-)
    lost: tuple[float, float]  # m g d; by the dashpot of F_n and by friction in this step


@kernel
def end_at(flat, half, cap, director):
    """Centre of a cap from the centre of mass, and its radius; of a flat end, a corner and 0.

    `cap` is -1 or 1: of round ends along the axis, of the corners of the lower flat end across it.
    Of a flat-ended rod that lies rather than stands the other corner is the upper end's.
    """
    if flat is None:
        return times(cap * half, director), 0.5
    sine, cosine = director
    along_axis, side = -half, 0.5 * cap
    if cap * sine < 0 and abs(sine) > 2 * half * cosine:
        along_axis, side = half, -side
    return (along_axis * sine + side * cosine, along_axis * cosine - side * sine), 0.0


@kernel
def facing(effects, rod, plate, cap, kept):
    """`Touch` of the cap or corner `cap` of `end_at`, still with its force of the step before.

    A sphere touches with its lower cap alone.
    """
    end, radius = end_at(effects.flat, effects.half_length, cap, rod.director)
    z = height(rod.place)
    arm = raised(end, plate[0] - z - height(end))
    half = raised(point(effects.inertia, rod.velocity, rod.turn, rod.director, arm), -plate[1])
    overlap = plate[0] + radius - (z + height(end))
    if effects.upper is None and cap > 0:
        overlap = -1.0
    if overlap <= 0.0:
        kept = nothing_kept(effects.up)
    return Touch(overlap, end, arm, half, kept, height(half), (0.0, 0.0))


@kernel
def with_cap(forces, touch):
    """Force and torque on a rod: `forces`, plus those of the plate at one cap."""
    f = raised(spread(touch.kept.rub, upward(touch.arm)), touch.kept.force)
    return along(forces[0], 1.0, f), along(forces[1], 1.0, torque(touch.arm, f))


@kernel
def swept(rolling, rod, arm, end, plate):
    """Acceleration of the slip by the motion of its arm, and of the axis of its rolling."""
    lift = plate[1] - height(rod.velocity)
    if len(arm) == 2:
        return swing(rod.turn, (0.0, lift))
    w, turned = rod.turn, cross(rod.turn, end)
    sweep = cross(turning(rolling, w, rod.director), (turned[0], turned[1], lift))
    if rolling is None:
        return sweep
    bent = cross(cross(w, rod.director), arm)
    return along(sweep, rolling * dot(w, rod.director), bent)


@kernel
def pressed(effects, rod, touch, plate, forces, dt):
    """`Touch` of one cap with its force of the step.

    `forces`: force and torque on the rod by everything, the cap's last force included.
    """
    overlap, end, arm, half, kept, _, _ = touch
    if overlap <= 0.0:
        return touch
    director, normal, inertia = rod.director, upward(arm), effects.inertia
    gain = point(inertia, forces[0], turn_by(inertia, forces[1], director), director, arm)
    sweep = swept(inertia.rolling, rod, arm, end, plate)
    meeting = Meeting(((arm, director),), normal, overlap, half, gain, kept, sweep)
    found = contact(effects.normal, effects.friction, inertia, meeting, dt)
    return Touch(overlap, end, arm, half, found.kept, found.rate, found.lost)


@kernel
def plate_forces(effects, rod, kept, plate, others, dt):
    """Force and torque on a rod by everything, and both `Touch`es: lower (-) and upper (+) cap.

    `kept`: of both caps, `plate`: height and velocity of the plate, `others`: force and torque by
    all but the plate. The lower cap sees the upper one's last force, the upper one the lower one's
    of this step. What is kept of a contact is forgotten as it opens.
    """
    lower = facing(effects, rod, plate, -1.0, kept[0])
    upper = facing(effects, rod, plate, 1.0, kept[1])
    lower = pressed(effects, rod, lower, plate, with_cap(with_cap(others, lower), upper), dt)
    others = with_cap(others, lower)
    upper = pressed(effects, rod, upper, plate, with_cap(others, upper), dt)
    return with_cap(others, upper), (lower, upper)


@kernel
def plate_at(plate, step):
    """Height and velocity of the plate after any number of steps, without rounding of the phase."""
    if plate is None:
        return 0.0, 0.0
    i = step % plate.height.size
    return plate.height[i], plate.velocity[i]


@kernel(entry=True)
def rates(effects, start, mode, y):
    """Derivatives of y = (x, z and tilt since the touch, c_x, c_z, omega, spring, P_z); signals.

    The signals: of the end of the force, and what is left before the mode changes; the overlap and
    the slip. `start`: sin and cos of the tilt and height over the contact point at the touch.
    """
    sine, cosine, height = start
    bend, lag = sin(y[2] / 2), cos(y[2] / 2)
    lean = sine * lag + cosine * bend  # sin(tilt_0 + turn/2)
    overlap = -y[1] - 2 * effects.half_length * lean * bend
    a_x = -effects.half_length * (sine * cos(y[2]) + cosine * sin(y[2]))
    a_z = -y[1] - height
    rate = y[4] - y[5] * a_x
    slip = y[3] + y[5] * a_z
    force, left, rub, stretch, spare = 0.0, overlap, 0.0, 0.0, 1.0
    light = effects.inertia.lightness
    if overlap > 0:
        powers = powers_of(overlap, 1 / (1 + a_x * a_x * light))
        (_, root, _), normal = powers, effects.normal
        c = dashpot(normal, powers)
        left = overlap - c * rate / (normal.stiffness * root)
        force = max(normal.stiffness * root * left, 0.0)
        left = left if normal.plastic is None else -rate  # a plastic contact ends as it rests
        drive = -a_x * force * light * a_z - y[5] * y[4]
        seen = Instant(slip, drive, 1 / (1 + a_z * a_z * light))
        rub, stretch, spare = friction_of_mode(effects.friction, mode, overlap, force, y[6], seen)
    turning = (a_z * rub - a_x * force) * light
    change = (y[3], y[4], y[5], rub, force, turning, stretch, force)
    return change, (left, spare, overlap, slip)


# Walls of an annulus


class At(NamedTuple):
    """Contact of a rod with a wall: place on the axis, distance, direction and weight."""

    s: float  # d; place on the axis, from the centre
    reach: float  # d; from there to the wall
    out: tuple[float, float, float]  # unit vector from the wall to the rod
    share: float  # weight of the contact, 0 to 1


@kernel
def from_above(place, director):
    """Products x.x, x.u and u.u of the horizontal parts of a rod's centre x and director u."""
    x, y, u, v = place[0], place[1], director[0], director[1]
    return x * x + y * y, x * u + y * v, u * u + v * v


@kernel
def passes(seen, half, distance):
    """Whether a rod comes closer than `distance` to the axis of the annulus between its ends.

    It is closest at s = -x.u/u.u. `seen`: the products of `from_above`.
    """
    square, slope, flat = seen
    if abs(slope) >= half * flat or flat < 1e-12:
        return False
    return (square - distance * distance) * flat < slope * slope


@kernel
def from_axis(point):
    """Horizontal distance of a point from the axis of the annulus, and the unit vector outwards."""
    rho = sqrt(point[0] * point[0] + point[1] * point[1])
    return rho, (point[0] / rho, point[1] / rho, 0.0)


@kernel
def collect(effects, state, n, i, at, row, climb, dt):
    """Store a contact of rod i with a wall at place n of the batch; return the contact count.

    `row`: of the memory; `climb`: velocity of a shaken wall half a step before, and at the step.
    """
    director = rod_of(IN_SPACE, state.rods, i).director
    arm = along(times(at.s, director), -at.reach, at.out)
    half, gain = moving(effects, state, i, arm)
    if effects.shaken is not None:
        before, now = climb
        half, gain = raised(half, -before), raised(gain, (before - now) * 2 / dt)
    # a rounding may have told a touch
    gap = times(0.5 + min(at.reach, 0.5), at.out)
    given = Given((i, i, row), gap, ((arm, director),), half, gain, at.share)
    return enter(state.scratch.batch, n, given, state.memory, IN_SPACE)


@kernel
def act(effects, state, ledger, climb, count, dt):
    """Compute the collected contacts and add their forces to rods; return 0, as none is left."""
    scratch = state.scratch
    alike = Alike(effects.walls, ONE, effects.inertia, IN_SPACE, WALL_NORMAL)
    acted(alike, state.memory, scratch.total, scratch.batch, ledger, count, dt)
    worked(effects.shaken, ledger, scratch.batch.numbers, climb[1] * dt, count)
    return 0


@kernel
def worked(shaken, ledger, numbers, climbed, count):
    """Add the work of shaken walls to the ledger, by friction alone: the normal is level."""
    if shaken is not None and ledger is not None:
        for c in range(count):
            ledger[PLATE_WORK] += climbed * get(numbers, FORCE + 2, c)


@kernel
def weight_by(place, director, s, rho):
    """Weight of a contact at `rho` from the axis by the end s of a rod, its slope, and outwards."""
    end, out = from_axis(along(place, s, director))
    return *rise((end - rho) * (1 / NEARER)), out


@kernel
def beside(radius, place, director, half, s):
    """`At` of a rod on the convex wall, between its ends; `weight_by` its lower and upper end."""
    rho, out = from_axis(along(place, s, director))
    lower = weight_by(place, director, -half, rho)
    upper = weight_by(place, director, half, rho)
    return At(s, rho - radius, out, lower[0] * upper[0]), lower, upper


@kernel
def keep_energy(law, total, i, half, director, at, lower, upper):
    """Add the forces on rod i by the slopes of the weight of `beside`."""
    (w_l, slope_l, out_l), (w_u, slope_u, out_u) = lower, upper
    if slope_l + slope_u != 0.0:
        energy = elastic_energy(law, 0.5 - at.reach) * (1 / NEARER)
        pulled = energy * (slope_l * w_u + w_l * slope_u)
        pull(total, i, times(at.s, director), times(pulled, at.out))
        pull(total, i, times(-half, director), times(-energy * slope_l * w_u, out_l))
        pull(total, i, times(half, director), times(-energy * w_l * slope_u, out_u))


@kernel(inline=False)
def at_wall(radius, effects, state, ledger, side, climb, n, dt):
    """Collect contacts of all rods with a wall; return their count, and a rod too deep or -1."""
    rods, half, slot = state.rods, effects.half_length, INNER if side > 0 else OUTER
    touching, count = radius + 0.5 * side, rods.shape[0]
    for i in range(count):
        place, director = rod_of(IN_SPACE, rods, i)[:2]
        seen = from_above(place, director)
        if n > MOST:
            n = act(effects, state, ledger, climb, n, dt)
        for cap in range(1 if effects.upper is None else 2):
            s, row = half if cap else -half, (slot + cap) * count + i
            square = seen[0] + s * (2.0 * seen[1] + s * seen[2])  # d^2; of the end, from the axis
            if side * (square - touching**2) >= 0:
                forget(IN_SPACE, state.memory, row)
                continue
            rho, out = from_axis(along(place, s, director))
            reach = side * (rho - radius)
            if not 0.5 - reach <= DEEP:
                return n, i
            at = At(s, reach, times(side, out), 1.0)
            n = collect(effects, state, n, i, at, row, climb, dt)
        if side > 0:
            row = (slot + 2) * count + i
            if passes(seen, half, touching):
                at, lower, upper = beside(radius, place, director, half, -seen[1] / seen[2])
                if not 0.5 - at.reach <= DEEP:
                    return n, i
                law, total = effects.walls.normal, state.scratch.total
                keep_energy(law, total, i, half, director, at, lower, upper)
                n = collect(effects, state, n, i, at, row, climb, dt)
            else:
                forget(IN_SPACE, state.memory, row)
    return n, -1


@kernel
def wall_forces(walls, effects, state, ledger, climb, dt):
    """Add the forces of the walls, if there are any; return a rod too deep in one, or -1."""
    if walls is None:
        return -1
    n, deep = at_wall(walls.inner, effects, state, ledger, 1.0, climb, 0, dt)
    if deep < 0:
        n, deep = at_wall(walls.outer, effects, state, ledger, -1.0, climb, n, dt)
    act(effects, state, ledger, climb, n, dt)
    return deep
