"""A rod over the plate in the plane, compiled: both caps or corners, and what else acts on it."""

from typing import NamedTuple

from ..cache import kernel
from .contact import Inertia, Meeting, contact, losses
from .vectors import along


class Clock(NamedTuple):
    """Number of a step, and its size."""

    step: int
    dt: float  # sqrt(d/g)


class Kept(NamedTuple):
    """What a cap keeps of a step for the next one."""

    force: tuple[float, float]  # F_t, F_n; m g
    spring: tuple[float]  # its length, d


FORGOTTEN = Kept((0.0, 0.0), (0.0,))


class Moving(NamedTuple):
    """A rod over the plate in one step; velocities (c_x, c_z, omega) in sqrt(g d), sqrt(g/d)."""

    z: float  # d
    direction: tuple[float, float]  # sin, cos of the tilt
    half: tuple[float, float, float]  # velocities half a step before
    kept: tuple[Kept, Kept]  # of the lower (-) and the upper (+) cap
    explicit: bool | None  # True: the dashpots see the velocities `now`; None: those of the step
    now: tuple[float, float, float]


class Touch(NamedTuple):
    """What acts at one cap."""

    overlap: float  # d
    arm: tuple[float, float]  # d, from the centre of mass to the contact point
    force: tuple[float, float]  # F_t, F_n; m g
    spring: tuple[float]  # its length, d
    rate: float  # sqrt(g d), at which the contact opens (+) or closes (-)
    slip: float  # sqrt(g d), half a step before
    lost: tuple[float, float]  # m g d; by the dashpot of F_n and by friction in this step


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
def facing(effects, rod, plate, cap, kept):
    """How the cap or corner `cap` of `end_at` stands to the plate, with its last force."""
    a_x, rise, radius = end_at(effects, cap, rod.direction)
    arm = a_x, plate[0] - rod.z
    v_x, v_z = point(rod.half, arm)
    overlap = plate[0] + radius - (rod.z + rise)
    if overlap <= 0.0:
        kept = FORGOTTEN
    return Touch(overlap, arm, kept.force, kept.spring, v_z - plate[1], v_x, (0.0, 0.0))


@kernel
def facing_above(upper, effects, rod, plate, kept):
    """The same for the upper cap, which stays open if there is none."""
    if upper is None:
        arm = 0.0, plate[0] - rod.z
        slip = point(rod.half, arm)[0]
        return Touch(-1.0, arm, (0.0, 0.0), (0.0,), 0.0, slip, (0.0, 0.0))
    return facing(effects, rod, plate, 1.0, kept)


@kernel
def point(motion, arm):
    """Velocity of a point of a rod, or its acceleration but for that towards the centre."""
    return motion[0] + motion[2] * arm[1], motion[1] - motion[2] * arm[0]


@kernel
def by_cap(touch, lightness):
    """Accelerations (x, z, angular) by the plate's forces at a cap."""
    (a_x, a_z), (f_x, f_z) = touch.arm, touch.force
    return f_x, f_z, (a_z * f_x - a_x * f_z) * lightness


@kernel
def pressed(effects, rod, touch, plate, pushes, dt):
    """The touch of one cap with its force of the step.

    `pushes`: accelerations of the rod by all, by the cap's last force too.
    """
    overlap, arm, (rub, force), spring, closing, slip, _ = touch
    if overlap <= 0.0:
        return touch
    up, swept = (0.0, 1.0), (rod.half[2] * (plate[1] - rod.half[1]), 0.0)
    now = along(point(rod.now, arm), -plate[1], up)
    meeting = Meeting(
        ((arm, arm),), up, overlap, (slip, closing), point(pushes, arm), force, (rub,), spring,
        swept, rod.explicit, now,
    )  # fmt: skip
    found = contact(effects.normal, effects.friction, Inertia(effects.lightness, None), meeting, dt)
    lost = losses(effects.normal, meeting, found, dt)
    return Touch(overlap, arm, (found.rub[0], found.normal), found.spring, found.rate, slip, lost)


@kernel
def by_caps(others, lower, upper, lightness):
    """Accelerations (x, z, angular) by all, the plate's forces at both caps included."""
    return along(along(others, 1.0, by_cap(lower, lightness)), 1.0, by_cap(upper, lightness))


@kernel
def plate_forces(effects, rod, plate, others, dt):
    """(a_x, a_z, angular), and what acts at the lower (-) and at the upper (+) cap.

    `rod` is a `Moving`, `plate` height and velocity of the plate, `others` the accelerations by all
    but the plate. The lower cap sees the upper one's last force, the upper one the lower one's of
    this step. What is kept of a contact is forgotten as it opens.
    """
    light, (first, second) = effects.lightness, rod.kept
    lower = facing(effects, rod, plate, -1.0, first)
    upper = facing_above(effects.upper, effects, rod, plate, second)
    lower = pressed(effects, rod, lower, plate, by_caps(others, lower, upper, light), dt)
    upper = pressed(effects, rod, upper, plate, by_caps(others, lower, upper, light), dt)
    return by_caps(others, lower, upper, light), lower, upper


@kernel
def keeps(touch):
    """What a cap keeps for the next step."""
    return Kept(touch.force, touch.spring)


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
def plate_before(plate, step):
    """Velocity of the plate half a step before."""
    if plate is None:
        return 0.0
    return 0.5 * (plate_at(plate, step - 1)[1] + plate_at(plate, step)[1])
