"""Forces of one contact and of a rod on the plate, and vectors, compiled.

Reduced units: d = m = g = 1, m the mass of the rod. A parameter that is `None` says that its term
is absent: Numba sees the type and leaves its code out.

The tangential element is a spring with a dashpot beside it, both in series with a slider that
gives way at mu F_n (`spring_friction`), or no element at all but the constraint that the slip stays
zero as long as |F_t| <= mu F_n (`constraint_friction`). It acts on two velocities: `half`, that of
half a step before the force, from which a step leads to half a step behind it, and `now`, that of
the moment of the force, as good as the integrator knows it.
"""

from math import copysign, inf, sqrt
from typing import Any, NamedTuple

from ..cache import kernel

ZERO = (0.0, 0.0, 0.0)


class Normal(NamedTuple):
    """F_n = k_n delta^(3/2) - (dashpot) v_n, and never below zero; `None`: no such dashpot."""

    stiffness: float  # k_n, m g/d
    quarter: float | None = None  # dashpot quarter sqrt(M) delta^(1/4), M the contact's mass
    proportional: float | None = None  # dashpot proportional delta
    constant: float | None = None  # dashpot constant
    plastic: bool | None = None  # True: no force while the contact opens


class Spring(NamedTuple):
    """Tangential stiffness k and dashpot g of the contact; `None`: no such term."""

    proportional: float | None = None  # k = proportional delta
    root: float | None = None  # k = root sqrt(delta)
    proportional_dashpot: float | None = None  # g = proportional_dashpot delta
    constant_dashpot: float | None = None  # g = constant_dashpot
    damping_ratio: float | None = None  # g = 2 ratio sqrt(k M), M the contact's tangential mass


class Friction(NamedTuple):
    """Coulomb friction; without a spring, a constraint."""

    coefficient: float
    spring: Spring | None


class ContactForces(NamedTuple):
    """What acts in the contacts of rods with each other."""

    normal: Normal
    friction: Friction | None


class Motion(NamedTuple):
    """One period of the plate's height and velocity, step by step."""

    height: Any  # d
    velocity: Any  # sqrt(g d)


class Effects(NamedTuple):
    """All that acts on a rod alone; `None`: absent."""

    half_length: float  # d, from centre to centre of a cap, (l - 1)/2
    lightness: float  # 1/d^2: 1/k^2, k the gyration radius
    normal: Normal | None  # of the plate; None: no plate
    friction: Friction | None
    gravity: tuple[float, float] | None  # along x and z, g
    plate: Motion | None  # None: at rest at z = 0
    upper: bool | None = True  # None: a sphere, which has no second cap
    flat: bool | None = None  # True: flat ends, half_length to them; None: round ones


class Clock(NamedTuple):
    """Number of a step, and its size."""

    step: int
    dt: float  # sqrt(d/g)


class Moving(NamedTuple):
    """A rod over the plate in one step; velocities (c_x, c_z, omega) in sqrt(g d), sqrt(g/d)."""

    z: float  # d
    direction: tuple[float, float]  # sin, cos of the tilt
    half: tuple[float, float, float]  # velocities half a step before
    now: tuple[float, float, float]  # velocities at the step
    springs: tuple[float, float]  # d; lengths of those of the lower (-) and the upper (+) cap


class Slip(NamedTuple):
    """What friction acts on in a contact."""

    half: float  # sqrt(g d), half a step before
    now: float  # sqrt(g d), at the step
    drive: float  # g; its acceleration without friction
    mass: float  # m; the contact's tangential mass


class Touch(NamedTuple):
    """What acts at one cap."""

    overlap: float  # d
    normal: float  # F_n, m g
    rate: float  # sqrt(g d), at which the contact opens (+) or closes (-)
    a_x: float  # d; arm from the centre of mass to the contact point
    a_z: float
    tangential: float  # F_t, m g
    spring: float  # its length, d
    slip: float  # sqrt(g d), half a step before


@kernel
def along(a, s, b):
    """a + s b."""
    return a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]


@kernel
def vector(array, i, first):
    """Three numbers of row i."""
    return array[i, first], array[i, first + 1], array[i, first + 2]


@kernel
def add(array, i, first, v):
    """Add a vector to row i."""
    array[i, first] += v[0]
    array[i, first + 1] += v[1]
    array[i, first + 2] += v[2]


@kernel
def put(array, i, first, v):
    """Put a vector into row i."""
    array[i, first], array[i, first + 1], array[i, first + 2] = v


@kernel
def term(constant, factor):
    """A product to add; where its constant is absent, -0.0, which adds nothing and has no code."""
    return -0.0 if constant is None else constant * factor


@kernel
def dashpot(normal, overlap, root, mass):
    """Normal force per velocity; `root` is sqrt(overlap)."""
    c = term(normal.quarter, sqrt(mass * root)) + term(normal.proportional, overlap)
    return c + term(normal.constant, 1.0)


@kernel
def largest(plastic, rate, mass, dt):
    """Largest F_n of a step; a plastic contact does no more than stop."""
    if plastic is None:
        return inf
    return -rate * mass / dt


@kernel
def normal_force(normal, overlap, rate, mass, dt):
    """F_n >= 0 of a contact with overlap > 0 that opens with the velocity `rate`."""
    root = sqrt(overlap)
    force = normal.stiffness * overlap * root - dashpot(normal, overlap, root, mass) * rate
    return max(min(force, largest(normal.plastic, rate, mass, dt)), 0.0)


@kernel
def tangential_constants(spring, overlap, mass):
    """Stiffness k and dashpot g of the tangential element at this overlap."""
    k = term(spring.proportional, overlap) + term(spring.root, sqrt(overlap))
    g = term(spring.proportional_dashpot, overlap) + term(spring.constant_dashpot, 1.0)
    return k, g + term(spring.damping_ratio, 2 * sqrt(k * mass))


@kernel
def spring_friction(k, g, length, slip, limit, dt):
    """F_t of spring and dashpot in series with a slider, and the spring's new length.

    Without slip the spring follows the contact point, s' = u. With slip |F_t| = limit and the
    element relaxes, g s' = -F_t - k s; one step of backward Euler, stable for any g >= 0 and, for
    g = 0, the spring that alone carries the limit.
    """
    stretched = length + slip.half * dt
    force = -(k * stretched + g * slip.now)
    if abs(force) <= limit:
        return force, stretched
    force = copysign(limit, force)
    return force, (g * length - force * dt) / (g + k * dt)


@kernel
def constraint_friction(slip, limit, dt):
    """Mean F_t over a step in which all else is constant: slip, its stop, then stick or slip back.

    Without friction the slip of the contact's mass would gain `slip.drive` per time.
    """
    side = 1.0 if slip.half > 0 else -1.0
    momentum, drive = side * slip.mass * slip.half / dt, side * slip.mass * slip.drive
    stop = -momentum - drive  # leaves no slip at the end of the step
    if stop <= -limit:
        return -side * limit
    if -drive <= limit:
        return side * stop
    slides = momentum / (limit - drive)  # part of the step
    return side * limit * (1 - 2 * slides)


@kernel
def friction_force(spring, limit, overlap, length, slip, dt):
    """F_t up to `limit`, and the spring's new length; a constraint has none."""
    if spring is not None:
        k, g = tangential_constants(spring, overlap, slip.mass)
        return spring_friction(k, g, length, slip, limit, dt)
    return constraint_friction(slip, limit, dt), 0.0


@kernel
def end_at(effects, cap, direction):
    """Centre of a cap from the centre of mass, and its radius; or a corner of a flat end.

    `cap` is -1 or 1: of round ends along the axis, of the corners of the lower flat end across it.
    Of a flat-ended rod that lies rather than stands the other corner is the upper end's.
    """
    sine, cosine = direction
    half = effects.half_length
    if effects.flat is None:
        return cap * half * sine, cap * half * cosine, 0.5
    along_axis, across = -half, 0.5 * cap
    if cap * sine < 0 and abs(sine) > 2 * half * cosine:
        along_axis, across = half, -across
    return along_axis * sine + across * cosine, along_axis * cosine - across * sine, 0.0


@kernel
def pressed(effects, rod, plate, cap, dt):
    """Normal contact of the cap or corner `cap` of `end_at`, before its friction."""
    height, velocity = plate
    a_x, rise, radius = end_at(effects, cap, rod.direction)
    a_z = height - rod.z
    overlap = height + radius - (rod.z + rise)
    rate = rod.now[1] - rod.now[2] * a_x - velocity
    force = 0.0
    if overlap > 0:
        mass = 1 / (1 + a_x * a_x * effects.lightness)
        force = normal_force(effects.normal, overlap, rate, mass, dt)
    return Touch(overlap, force, rate, a_x, a_z, 0.0, 0.0, rod.half[0] + rod.half[2] * a_z)


@kernel
def pressed_above(upper, effects, rod, plate, dt):
    """Normal contact of the upper cap, which stays open if there is none."""
    if upper is None:
        a_z = plate[0] - rod.z
        return Touch(-1.0, 0.0, 0.0, 0.0, a_z, 0.0, 0.0, rod.half[0] + rod.half[2] * a_z)
    return pressed(effects, rod, plate, 1.0, dt)


@kernel
def rubbed(friction, lightness, rod, touch, length, others, climb, dt):
    """The touch of one cap with F_t and its spring.

    `others`: horizontal and angular acceleration by all else so far; `climb`: velocity of the plate
    against the rod, at which the arm shortens.
    """
    if friction is None:
        return touch
    overlap, normal, rate, a_x, a_z, _, _, slip = touch
    if normal <= 0:
        return touch
    drive = others[0] + others[1] * a_z + rod.half[2] * climb
    mass = 1 / (1 + a_z * a_z * lightness)
    seen = Slip(slip, rod.now[0] + rod.now[2] * a_z, drive, mass)
    limit = friction.coefficient * normal
    force, length = friction_force(friction.spring, limit, overlap, length, seen, dt)
    return Touch(overlap, normal, rate, a_x, a_z, force, length, slip)


@kernel
def gravity(g):
    """Accelerations by gravity."""
    if g is None:
        return 0.0, 0.0, 0.0
    return g[0], g[1], 0.0


@kernel
def field(effects, velocity):
    """Accelerations (x, z, angular) of a rod by all but contacts; `velocity`: c_x, c_z, omega."""
    return gravity(effects.gravity)


@kernel
def plate_at(plate, step):
    """Height and velocity of the plate after any number of steps, without rounding."""
    if plate is None:
        return 0.0, 0.0
    i = step % plate.height.size
    return plate.height[i], plate.velocity[i]


@kernel
def accelerations(effects, rod, plate, others, dt):
    """(a_x, a_z, angular), and what acts at the lower (-) and at the upper (+) cap.

    `rod` is a `Moving`, `plate` height and velocity of the plate, `others` the accelerations by all
    but the plate. A spring is forgotten as its contact opens.
    """
    a_x, a_z, angular = others
    light, climb = effects.lightness, plate[1] - rod.half[1]
    low = pressed(effects, rod, plate, -1.0, dt)
    high = pressed_above(effects.upper, effects, rod, plate, dt)
    angular -= (low.a_x * low.normal + high.a_x * high.normal) * light
    low = rubbed(effects.friction, light, rod, low, rod.springs[0], (a_x, angular), climb, dt)
    a_x, angular = a_x + low.tangential, angular + low.a_z * low.tangential * light
    high = rubbed(effects.friction, light, rod, high, rod.springs[1], (a_x, angular), climb, dt)
    a_x, angular = a_x + high.tangential, angular + high.a_z * high.tangential * light
    return (a_x, a_z + low.normal + high.normal, angular), low, high
