"""Forces of the plate on a rod, compiled: at both of its caps or corners."""

from typing import NamedTuple

from ..cache import kernel
from .contact import Meeting, contact, losses, turn_by, turning
from .state import Kept, inertia_of, nothing_kept, point
from .vectors import (
    along,
    cross,
    dot,
    height,
    nothing,
    raised,
    spread,
    swing,
    times,
    torque,
    upward,
)


class Moving(NamedTuple):
    """Motion of a rod over the plate in one step."""

    z: float  # d
    director: tuple
    velocity: tuple  # sqrt(g d); half a step before
    turn: tuple  # sqrt(g/d); half a step before
    explicit: bool | None  # True: the dashpots see `now`; None: the velocities of the step
    now: tuple  # velocity and turn for explicit dashpots


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
    """`Touch` of the cap or corner `cap` of `end_at`, still with its force of the step before."""
    end, radius = end_at(effects.flat, effects.half_length, cap, rod.director)
    arm = raised(end, plate[0] - rod.z - height(end))
    half = raised(point(effects, rod.velocity, rod.turn, rod.director, arm), -plate[1])
    overlap = plate[0] + radius - (rod.z + height(end))
    if overlap <= 0.0:
        kept = nothing_kept(effects.up)
    return Touch(overlap, end, arm, half, kept, height(half), (0.0, 0.0))


@kernel
def facing_above(upper, effects, rod, plate, kept):
    """`Touch` of the upper cap, still with its last force; open if there is no second cap."""
    if upper is None:
        centre = nothing(rod.velocity)
        return Touch(-1.0, centre, centre, rod.velocity, nothing_kept(effects.up), 0.0, (0.0, 0.0))
    return facing(effects, rod, plate, 1.0, kept)


@kernel
def force_on(touch):
    """Force vector of the plate at one cap."""
    return raised(spread(touch.kept.rub, upward(touch.arm)), touch.kept.force)


@kernel
def both(forces, lower, upper):
    """Force and torque on a rod: `forces` by all else, plus those of the plate at both caps."""
    f, g = force_on(lower), force_on(upper)
    turned = along(along(forces[1], 1.0, torque(lower.arm, f)), 1.0, torque(upper.arm, g))
    return along(along(forces[0], 1.0, f), 1.0, g), turned


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
    director, normal, inertia = rod.director, upward(arm), inertia_of(effects)
    gain = point(effects, forces[0], turn_by(inertia, forces[1], director), director, arm)
    now = raised(point(effects, rod.now[0], rod.now[1], director, arm), -plate[1])
    sweep = swept(effects.rolling, rod, arm, end, plate)
    meeting = Meeting(
        ((arm, director),), normal, overlap, half, gain, kept.force, kept.rub, kept.spring,
        sweep, rod.explicit, now,
    )  # fmt: skip
    found = contact(effects.normal, effects.friction, inertia, meeting, dt)
    lost, kept = (
        losses(effects.normal, meeting, found, dt),
        Kept(found.normal, found.rub, found.spring),
    )
    return Touch(overlap, end, arm, half, kept, found.rate, lost)


@kernel
def plate_forces(effects, rod, kept, plate, others, dt):
    """Force and torque on a rod by everything, and the `Touch` of its lower (-) and upper (+) cap.

    `kept`: of both caps, `plate`: height and velocity of the plate, `others`: force and torque by
    all but the plate. The lower cap sees the upper one's last force, the upper one the lower one's
    of this step. What is kept of a contact is forgotten as it opens.
    """
    lower = facing(effects, rod, plate, -1.0, kept[0])
    upper = facing_above(effects.upper, effects, rod, plate, kept[1])
    lower = pressed(effects, rod, lower, plate, both(others, lower, upper), dt)
    upper = pressed(effects, rod, upper, plate, both(others, lower, upper), dt)
    return both(others, lower, upper), lower, upper


@kernel
def plate_at(plate, step):
    """Height and velocity of the plate after any number of steps, without rounding of the phase."""
    if plate is None:
        return 0.0, 0.0
    i = step % plate.height.size
    return plate.height[i], plate.velocity[i]


@kernel
def plate_before(plate, step):
    """Velocity of the plate half a step before a step."""
    if plate is None:
        return 0.0
    return 0.5 * (plate_at(plate, step - 1)[1] + plate_at(plate, step)[1])
