"""Forces of the plate in space, compiled; its friction may be a constraint."""

from math import sqrt

from ...cache import kernel
from ..codes import DIRECTOR, PLACE, PLATE_CAPS, PLATE_FRICTION, TURN, VELOCITY
from ..contact import ZERO, along, put, vector
from .forces import At, Rubbing, across, act, forget, lose, surface, tangential, turning
from .geometry import UP, cross, dot, times


@kernel
def gained(effects, arm, director, force, torque):
    """Acceleration of a point of the rod by force and torque, but for that towards the centre."""
    alpha = across(effects.rolling, times(effects.lightness, torque), director)
    return along(force, 1.0, cross(turning(effects.rolling, alpha, director), arm))


@kernel
def swept(rolling, gain, w, director, arm):
    """Acceleration of a point of a rod, and that by which its rolling turns with the director."""
    if rolling is None:
        return gain
    return along(gain, rolling * dot(w, director), cross(cross(w, director), arm))


@kernel
def stopping(compliance, u, v):
    """Force along the plate that undoes an acceleration (u, v) of the contact."""
    xx, xy, yy = compliance
    scale = 1.0 / (xx * yy - xy * xy)
    return scale * (xy * v - yy * u), scale * (xy * u - xx * v)


@kernel
def constraint_friction(compliance, slip, drive, limit, dt):
    """Mean F_t over a step, as `contact.constraint_friction` has it, for vectors; and its size.

    `compliance`: xx, xy, yy of the accelerations by a force of one; `drive`: by all else.
    """
    x, y = stopping(compliance, slip[0] / dt + drive[0], slip[1] / dt + drive[1])
    size, (u, v) = sqrt(x * x + y * y), stopping(compliance, drive[0], drive[1])
    holds = sqrt(u * u + v * v)
    if max(size, holds) <= limit:  # leaves no slip at the end of the step
        return (x, y, 0.0), size
    speed, slides, a, b = sqrt(slip[0] * slip[0] + slip[1] * slip[1]), 0.0, 0.0, 0.0
    if speed > 0.0:
        a, b = slip[0] / speed, slip[1] / speed
        xx, xy, yy = compliance
        slower = limit * (xx * a * a + 2.0 * xy * a * b + yy * b * b) - a * drive[0] - b * drive[1]
        slides = speed / (slower * dt) if speed < slower * dt else 1.0  # part of the step
    if slides == 1.0:
        return (-limit * a, -limit * b, 0.0), limit
    rest = (1.0 - slides) * min(limit / max(holds, 1e-300), 1.0)  # sticks, or slips with the drive
    x, y = rest * u - slides * limit * a, rest * v - slides * limit * b
    return (x, y, 0.0), sqrt(x * x + y * y)


@kernel
def hold(friction, effects, state, i, touch, plate, dt):
    """Both touches with the plate's friction, which is added, if it is a constraint."""
    if friction is None:
        return touch
    return held(friction.spring, friction.coefficient, effects, state, i, touch, plate, dt)


@kernel
def held(spring, coefficient, effects, state, i, touch, plate, dt):
    """The same, of any friction.

    What holds one end of a rod that lies turns the other: without the upper cap's force of the step
    before, kept as its spring, the rod would creep.
    """
    if spring is not None:
        return touch
    (lower, upper), half, kept = touch, effects.half_length, ZERO
    if lower[1].force > 0.0 and upper[1].force > 0.0:
        kept = vector(state.springs[i], PLATE_CAPS + 1, 0)
    act(state.scratch, i, upper[0], kept)
    lower, _ = held_at(coefficient, effects, state, i, -half, lower, plate, dt)
    act(state.scratch, i, upper[0], times(-1.0, kept))
    upper, f = held_at(coefficient, effects, state, i, half, upper, plate, dt)
    put(state.springs[i], PLATE_CAPS + 1, 0, f)
    return lower, upper


@kernel
def held_at(coefficient, effects, state, i, s, touch, plate, dt):
    """Add a constraint's force at place s of the axis; the touch with it, and the force."""
    arm, rubbing, _ = touch
    if rubbing.force <= 0.0:
        return touch, ZERO
    rods, total = state.rods, state.scratch
    director, w = vector(rods, i, DIRECTOR), vector(rods, i, TURN)
    moved = cross(w, director)
    rate = s * moved[0], s * moved[1], plate[1] - rods[i, VELOCITY + 2]  # of the arm
    drive = gained(effects, arm, director, vector(total, i, 0), vector(total, i, 3))
    drive = along(drive, 1.0, cross(turning(effects.rolling, w, director), rate))
    drive = swept(effects.rolling, drive, w, director, arm)
    x, y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    x = gained(effects, arm, director, x, cross(arm, x))
    y = gained(effects, arm, director, y, cross(arm, y))
    slip, limit = tangential(rubbing.half, UP), coefficient * rubbing.force
    f, size = constraint_friction((x[0], x[1], y[1]), slip, drive, limit, dt)
    act(total, i, arm, f)
    lose(state.lost, PLATE_FRICTION, i, arm, f)
    return (arm, rubbing, size), f


@kernel
def at_cap(law, effects, state, i, s, slot, plate, dt):
    """Add the plate's forces at a cap; its arm, what friction acts on, the size of friction."""
    reach = state.rods[i, PLACE + 2] + s * state.rods[i, DIRECTOR + 2] - plate[0]
    if reach >= 0.5:
        forget(state.springs, i, slot)
        return ZERO, Rubbing(UP, 0.5 - reach, 0.0, ZERO, ZERO), 0.0
    at = At(s, reach, UP, plate[1], 1.0, slot)
    return surface(law, effects.friction, effects, state, i, at, dt)


@kernel
def on_plate(law, effects, state, i, plate, dt):
    """Add the plate's forces at both caps; what acts at each."""
    half, closed = effects.half_length, (ZERO, Rubbing(UP, -1.0, 0.0, ZERO, ZERO), 0.0)
    if law is None:
        return closed, closed
    lower, upper = at_cap(law, effects, state, i, -half, PLATE_CAPS, plate, dt), closed
    if half > 0.0:
        upper = at_cap(law, effects, state, i, half, PLATE_CAPS + 1, plate, dt)
    return hold(effects.friction, effects, state, i, (lower, upper), plate, dt)
