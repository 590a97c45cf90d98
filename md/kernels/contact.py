"""Forces of one contact and of a rod on the plate, compiled; an absent effect has no code.

Reduced units: d = m = g = 1, m the mass of the rod. A parameter that is `None` says that its term
is absent: Numba sees the type and leaves the branch out.

The tangential element is a spring with a dashpot beside it, both in series with a slider that
gives way at mu F_n (`pull`), or no element at all but the constraint that the slip stays zero as
long as |F_t| <= mu F_n (`hold`). It acts on two velocities: `half`, that of half a step before the
force, from which a step leads to half a step behind it, and `now`, that of the moment of the force,
as good as the integrator knows it.
"""

from math import copysign, inf, sqrt
from typing import Any, NamedTuple

from ..cache import kernel


class Normal(NamedTuple):
    """F_n = k_n delta^(3/2) - (dashpot) v_n, and never below zero; `None`: no such dashpot."""

    stiffness: float  # k_n
    quarter: float | None = None  # dashpot quarter sqrt(M) delta^(1/4), M the contact's mass
    proportional: float | None = None  # dashpot proportional delta
    constant: float | None = None  # dashpot constant
    plastic: bool | None = None  # True: no force while the contact opens


class Spring(NamedTuple):
    """Tangential stiffness k and dashpot g of the contact; `None`: no such term."""

    proportional: float | None = None  # k = proportional delta
    root: float | None = None  # k = root sqrt(delta)
    drag: float | None = None  # g = drag delta
    constant_drag: float | None = None  # g = constant_drag
    ratio: float | None = None  # g = 2 ratio sqrt(k M), M the contact's tangential mass


class Friction(NamedTuple):
    """Coulomb friction; without a spring, a constraint."""

    coefficient: float
    spring: Spring | None


class Motion(NamedTuple):
    """One period of the plate's height and velocity, step by step."""

    height: Any
    velocity: Any


class Effects(NamedTuple):
    """All that acts on the rod; `None`: absent."""

    half_length: float  # centre to centre of a cap, (l - 1)/2
    lightness: float  # 1/k^2, k the gyration radius
    normal: Normal
    friction: Friction | None
    gravity: tuple[float, float] | None
    plate: Motion | None  # at rest at z = 0
    upper: bool | None = True  # None: a sphere, which has no second cap


class Touch(NamedTuple):
    """What acts at one cap."""

    overlap: float
    normal: float  # F_n
    tangential: float  # F_t
    spring: float  # its length
    slip: float  # u, half a step before
    rate: float  # at which the contact opens (+) or closes (-)
    a_x: float  # arm from the centre of mass to the contact point
    a_z: float


@kernel
def dashpot(quarter, proportional, constant, overlap, root, mass):
    """Normal force per velocity; `root` is sqrt(overlap)."""
    c = 0.0
    if quarter is not None:
        c += quarter * sqrt(mass * root)
    if proportional is not None:
        c += proportional * overlap
    if constant is not None:
        c += constant
    return c


@kernel
def largest(plastic, rate, mass, dt):
    """Largest F_n of a step; a plastic contact does no more than stop."""
    if plastic is None:
        return inf
    return -rate * mass / dt


@kernel
def push(normal, overlap, rate, mass, dt):
    """F_n >= 0 of a contact with overlap > 0 that opens with the velocity `rate`."""
    root = sqrt(overlap)
    c = dashpot(normal.quarter, normal.proportional, normal.constant, overlap, root, mass)
    force = normal.stiffness * overlap * root - c * rate
    return max(min(force, largest(normal.plastic, rate, mass, dt)), 0.0)


@kernel
def elastic(proportional, root, overlap):
    """Tangential stiffness k."""
    k = 0.0
    if proportional is not None:
        k += proportional * overlap
    if root is not None:
        k += root * sqrt(overlap)
    return k


@kernel
def viscous(drag, constant_drag, ratio, overlap, stiffness, mass):
    """Tangential dashpot g."""
    g = 0.0
    if drag is not None:
        g += drag * overlap
    if constant_drag is not None:
        g += constant_drag
    if ratio is not None:
        g += 2 * ratio * sqrt(stiffness * mass)
    return g


@kernel
def tangential_constants(spring, overlap, mass):
    """Stiffness k and dashpot g of the tangential element at this overlap."""
    k = elastic(spring.proportional, spring.root, overlap)
    return k, viscous(spring.drag, spring.constant_drag, spring.ratio, overlap, k, mass)


@kernel
def pull(k, g, length, half, now, limit, dt):
    """F_t of spring and dashpot in series with a slider, and the spring's new length.

    Without slip the spring follows the contact point, s' = u. With slip |F_t| = limit and the
    element relaxes, g s' = -F_t - k s; one step of backward Euler, stable for any g >= 0 and, for
    g = 0, the spring that alone carries the limit.
    """
    stretched = length + half * dt
    force = -(k * stretched + g * now)
    if abs(force) <= limit:
        return force, stretched
    force = copysign(limit, force)
    return force, (g * length - force * dt) / (g + k * dt)


@kernel
def hold(slip, drive, mass, limit, dt):
    """Mean F_t over a step in which all else is constant: slip, its stop, then stick or slip back.

    Without friction the slip of the contact's mass would gain `drive` per time.
    """
    side = 1.0 if slip > 0 else -1.0
    slip, drive = side * mass * slip / dt, side * mass * drive
    stop = -slip - drive  # leaves no slip at the end of the step
    if stop <= -limit:
        return -side * limit
    if -drive <= limit:
        return side * stop
    slides = slip / (limit - drive)  # part of the step
    return side * limit * (1 - 2 * slides)


@kernel
def resist(spring, coefficient, overlap, force, length, half, now, drive, mass, dt):
    """F_t and the spring's new length; a constraint has none."""
    limit = coefficient * force
    if spring is not None:
        k, g = tangential_constants(spring, overlap, mass)
        return pull(k, g, length, half, now, limit, dt)
    return hold(half, drive, mass, limit, dt), 0.0


@kernel
def pressed(scene, cap, height, velocity, z, sine, cosine, motion, dt):
    """Overlap, arm (a_x, a_z), F_n and opening rate at the cap `cap` = -1 or 1 along the axis."""
    a_x, a_z = cap * scene.half_length * sine, height - z
    overlap = height + 0.5 - (z + cap * scene.half_length * cosine)
    _, c_z, omega = motion
    rate = c_z - omega * a_x - velocity
    force = 0.0
    if overlap > 0:
        mass = 1 / (1 + a_x * a_x * scene.lightness)
        force = push(scene.normal, overlap, rate, mass, dt)
    return overlap, a_x, a_z, force, rate


@kernel
def pressed_above(upper, scene, height, velocity, z, sine, cosine, motion, dt):
    """The same at the upper cap, which stays open if there is none."""
    if upper is None:
        return -1.0, 0.0, 0.0, 0.0, 0.0
    return pressed(scene, 1.0, height, velocity, z, sine, cosine, motion, dt)


@kernel
def rubbed(friction, lightness, overlap, a_z, force, climb, length, half, now, pushes, dt):
    """F_t at one cap, its spring and its slip; `pushes`: all other accelerations so far."""
    a_x, spin = pushes
    slip = half[0] + half[2] * a_z
    if friction is None:
        return 0.0, 0.0, slip
    if force <= 0:
        return 0.0, 0.0, slip
    drive = a_x + spin * a_z + half[2] * climb  # the arm shortens by the rod's fall
    mass = 1 / (1 + a_z * a_z * lightness)
    current = now[0] + now[2] * a_z
    tangential, length = resist(
        friction.spring,
        friction.coefficient,
        *(overlap, force, length, slip, current, drive, mass, dt),
    )
    return tangential, length, slip


@kernel
def weight(gravity):
    """Accelerations by gravity."""
    if gravity is None:
        return 0.0, 0.0, 0.0
    return gravity[0], gravity[1], 0.0


@kernel
def plate_at(plate, step):
    """Height and velocity of the plate after a number of steps, exact for ever."""
    if plate is None:
        return 0.0, 0.0
    i = step % plate.height.size
    return plate.height[i], plate.velocity[i]


@kernel
def accelerations(scene, others, plate, z, direction, half, now, springs, dt):
    """(a_x, a_z, angular), and what acts at the lower (-) and at the upper (+) cap.

    `others` are the accelerations by all but the plate, `plate` its height and velocity,
    `direction` (sin, cos) of the tilt, `half` and `now` (c_x, c_z, omega). A spring is forgotten
    as its contact opens.
    """
    a_x, a_z, spin = others
    height, velocity = plate
    sine, cosine = direction
    overlap, arm, rise, force, rate = pressed(
        scene, -1.0, height, velocity, z, sine, cosine, now, dt
    )
    overlap_2, arm_2, _, force_2, rate_2 = pressed_above(
        scene.upper, scene, height, velocity, z, sine, cosine, now, dt
    )
    spin -= (arm * force + arm_2 * force_2) * scene.lightness
    climb = velocity - half[1]
    drag, spring, slip = rubbed(
        *(scene.friction, scene.lightness, overlap, rise, force, climb),
        *(springs[0], half, now, (a_x, spin), dt),
    )
    a_x, spin = a_x + drag, spin + rise * drag * scene.lightness
    drag_2, spring_2, slip_2 = rubbed(
        *(scene.friction, scene.lightness, overlap_2, rise, force_2, climb),
        *(springs[1], half, now, (a_x, spin), dt),
    )
    a_x, spin = a_x + drag_2, spin + rise * drag_2 * scene.lightness
    return (
        (a_x, a_z + force + force_2, spin),
        Touch(overlap, force, drag, spring, slip, rate, arm, rise),
        Touch(overlap_2, force_2, drag_2, spring_2, slip_2, rate_2, arm_2, rise),
    )
