"""Forces of the plate in space, compiled; its friction may be a constraint."""

from typing import NamedTuple

from ...cache import kernel
from ..codes import (
    DIRECTOR,
    PLACE,
    PLATE_CAPS,
    PLATE_FRICTION,
    PLATE_NORMAL,
    PLATE_WORK,
    TURN,
    VELOCITY,
)
from ..contact import Meeting, contact, free_turn, losses, swung, turning
from ..vectors import UP, ZERO, along, cross, dot, times, vector
from .forces import act, forget, inertia_of, keeps, keeps_forces, kept, kept_number, moving


class Cap(NamedTuple):
    """What acts at a cap."""

    s: float  # d; its place on the axis
    overlap: float  # d
    arm: tuple[float, float, float]  # d, from the centre to the contact
    half: tuple[float, float, float]  # sqrt(g d); velocity against the plate half a step before
    force: float  # F_n, m g
    rub: tuple[float, float, float]  # F_t, m g
    spring: tuple[float, float, float]  # d
    rate: float  # sqrt(g d), at which the contact opens (+) or closes (-)
    lost: tuple[float, float]  # m g d; by the dashpot of F_n and by friction in this step


OPEN = Cap(0.0, -1.0, ZERO, ZERO, 0.0, ZERO, ZERO, 0.0, (0.0, 0.0))


@kernel
def facing(effects, state, i, s, slot, plate):
    """How the cap at place s of the axis stands to the plate, with its force of the step before."""
    director = vector(state.rods, i, DIRECTOR)
    reach = state.rods[i, PLACE + 2] + s * director[2] - plate[0]
    if reach >= 0.5:
        forget(state.forces, state.springs, i, slot)
        return Cap(s, 0.5 - reach, ZERO, ZERO, 0.0, ZERO, ZERO, 0.0, (0.0, 0.0))
    arm = along(times(s, director), -reach, UP)
    half = along(moving(effects, state, i, director, arm), -plate[1], UP)
    force, rub = kept_number(state.forces, i, slot), kept(state.forces, i, slot, 1)
    spring = kept(state.springs, i, slot, 0)
    return Cap(s, 0.5 - reach, arm, half, force, rub, spring, half[2], (0.0, 0.0))


@kernel
def arm_sweeps(effects, state, i, s, arm, plate):
    """Acceleration of a slip by the motion of its arm, rolling that turns with the rod included."""
    director, w = vector(state.rods, i, DIRECTOR), vector(state.rods, i, TURN)
    turned = cross(w, director)
    rate = s * turned[0], s * turned[1], plate[1] - state.rods[i, VELOCITY + 2]
    return rolled(
        effects.rolling, cross(turning(effects.rolling, w, director), rate), w, director, arm
    )


@kernel
def rolled(rolling, sweep, w, director, arm):
    """The same with that by which the rolling turns with the director."""
    if rolling is None:
        return sweep
    return along(sweep, rolling * dot(w, director), cross(cross(w, director), arm))


@kernel
def whole(cap):
    """The plate's force at a cap."""
    return along(cap.rub, cap.force, UP)


@kernel
def pressed(effects, state, i, cap, other, others, plate, dt):
    """A cap with its force of the step; `others`: force and torque by all but the plate."""
    s, overlap, arm, half, force, rub, spring, _, _ = cap
    if overlap <= 0.0:
        return cap
    director = vector(state.rods, i, DIRECTOR)
    total = along(along(others[0], 1.0, whole(cap)), 1.0, whole(other))
    torque = along(others[1], 1.0, cross(arm, whole(cap)))
    torque = along(torque, 1.0, cross(other.arm, whole(other)))
    w = free_turn(effects.rolling, times(effects.lightness, torque), director)
    gain = along(total, 1.0, swung(effects.rolling, w, director, arm))
    swept = arm_sweeps(effects, state, i, s, arm, plate)
    meeting = Meeting(
        ((arm, director),), UP, overlap, half, gain, force, rub, spring, swept, None, half
    )
    found = contact(effects.normal, effects.friction, inertia_of(effects), meeting, dt)
    lost = losses(effects.normal, meeting, found, dt)
    return Cap(s, overlap, arm, half, found.normal, found.rub, found.spring, found.rate, lost)


@kernel
def kept_cap(state, ledger, i, slot, cap, plate, dt):
    """Add the force of a cap, and keep it for the next step."""
    if cap.overlap <= 0.0:
        return
    act(state.scratch.total, i, cap.arm, whole(cap))
    keeps_forces(state.forces, i, slot, cap.force, cap.rub)
    keeps(state.springs, i, slot, cap.spring)
    if ledger is not None:
        ledger[PLATE_WORK] += dt * cap.force * plate[1]
        ledger[PLATE_NORMAL] += cap.lost[0]
        ledger[PLATE_FRICTION] += cap.lost[1]


@kernel
def on_plate(law, effects, state, ledger, i, plate, dt):
    """Add the plate's forces at both caps; what acts at each.

    Each force sees the others of its rod, as in the plane (`kernels.plate.plate_forces`).
    """
    if law is None:
        return OPEN, OPEN
    half, total = effects.half_length, state.scratch.total
    others = vector(total, i, 0), vector(total, i, 3)
    low, high = facing(effects, state, i, -half, PLATE_CAPS, plate), OPEN
    if half > 0.0:
        high = facing(effects, state, i, half, PLATE_CAPS + 1, plate)
    if low.overlap <= 0.0 and high.overlap <= 0.0:
        return low, high
    lower = pressed(effects, state, i, low, high, others, plate, dt)
    upper = pressed(effects, state, i, high, lower, others, plate, dt)
    kept_cap(state, ledger, i, PLATE_CAPS, lower, plate, dt)
    kept_cap(state, ledger, i, PLATE_CAPS + 1, upper, plate, dt)
    return lower, upper
