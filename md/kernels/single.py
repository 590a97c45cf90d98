"""Fixed-step integrators of one rod, compiled: leapfrog, velocity Verlet, Gear's fifth order.

All three compute one set of forces per step, at the positions of step n. They differ in the
velocity that normal dashpots see:

=========  =============================================  ==========================
name       positions and velocities kept                  velocity in the dashpots
=========  =============================================  ==========================
leapfrog   positions at n, velocities at n - 1/2          that of n - 1/2
verlet     the same (velocity Verlet, one force a step)   that of n, solved for
gear       positions and five derivatives at n            predicted at n
=========  =============================================  ==========================

A step's friction is found from the slip half a step before it, in all three
(`contact.constraint_friction`, `contact.spring_friction`). Leapfrog is thus of first order where
there are normal dashpots, Verlet of second; Gear's order is that of the force's smoothness, and at
the start and the end of a contact that is low.
"""

from math import cos, sin
from typing import Any, NamedTuple

from ..cache import kernel
from .codes import DEEP, DONE, FREE, NOT_FINITE, OPENED, STICK, TOO_DEEP
from .contact import Kept, dashpot, powers_of, tangential_constants
from .state import Moving, field
from .surfaces import plate_at, plate_forces
from .touches import watched
from .vectors import ZERO, along, times, turned

METHODS = ("leapfrog", "verlet", "gear")

# Gear's fifth-order corrector for second-order equations with velocities in the force.
_C0, _C1, _C3, _C4, _C5 = 3 / 16, 251 / 360, 11 / 18, 1 / 6, 1 / 60


class State(NamedTuple):
    """State of one rod between steps; the types of `higher` and `explicit` tell which method it is.

    `higher` is a tuple in Gear's method alone, `explicit` is `None` in Verlet's alone. Velocities
    are those at n - 1/2, or, for Gear's method, everything is at n - 1.
    """

    position: tuple[float, float, float]  # x, z in d, tilt in rad
    direction: tuple[float, float]  # sin and cos of the tilt, turned along with it
    velocity: tuple[float, float, float]  # c_x, c_z in sqrt(g d), omega in sqrt(g/d)
    acceleration: tuple[float, float, float]  # at n - 1, in g and g/d
    # fields of `Kept` of the lower (-) and the upper (+) cap, plain as all that leaves Numba
    kept: tuple[tuple, tuple]
    higher: tuple | None  # derivatives i = 3, 4, 5 times dt^i/i!
    explicit: bool | None


@kernel
def accelerations(effects, state, position, direction, half, now, step, dt):
    """Acceleration (a_x, a_z, angular) of a rod, and the `Touch`es of its lower and upper cap.

    `half`, `now`: velocities half a step before and at the step.
    """
    motion, velocity = (now[:2], now[2:]), half[:2]
    rod = Moving(position[:2], direction, velocity, half[2:], state.explicit, motion)
    plate, others = plate_at(effects.plate, step), (field(effects, velocity), (0.0,))
    kept = Kept(*state.kept[0]), Kept(*state.kept[1])
    (f, torque), caps = plate_forces(effects, rod, kept, plate, others, dt)
    return (f[0], f[1], effects.lightness * torque[0]), caps


@kernel
def leap(effects, state, step, dt):
    """Make step n of leapfrog or Verlet: forces, kick, drift.

    Returns the state, the velocity at n, and the `Touch`es of both caps.
    """
    position, direction, half, _, _, higher, explicit = state
    a, caps = accelerations(effects, state, position, direction, half, half, step, dt)
    velocity = along(half, dt, a)
    kept = caps[0].kept[:], caps[1].kept[:]
    direction = turned(direction, velocity[2] * dt)
    following = along(position, dt, velocity)
    after = State(following, direction, velocity, a, kept, higher, explicit)
    return after, along(half, dt / 2, a), caps


@kernel
def gear(effects, state, higher, step, dt):
    """Make step n of Gear's method: predict, evaluate, correct.

    Returns the state, the velocity at n, and the `Touch`es of both caps.
    """
    r0, direction, r1, r2, _, _, explicit = state
    tilt = r0[2]
    r1, r2 = times(dt, r1), times(dt * dt / 2, r2)
    r3, r4, r5 = higher
    r0 = along(along(along(along(along(r0, 1, r1), 1, r2), 1, r3), 1, r4), 1, r5)
    direction = turned(direction, r0[2] - tilt)
    r1 = along(along(along(along(r1, 2, r2), 3, r3), 4, r4), 5, r5)
    r2 = along(along(along(r2, 3, r3), 6, r4), 10, r5)
    r3 = along(along(r3, 4, r4), 10, r5)
    r4 = along(r4, 5, r5)
    now = times(1 / dt, r1)
    half = along(along(now, -1 / dt, r2), 0.75 / dt, r3)
    a, caps = accelerations(effects, state, r0, direction, half, now, step, dt)
    change = along(times(dt * dt / 2, a), -1, r2)
    r0, velocity = along(r0, _C0, change), along(now, _C1 / dt, change)
    r3, r4, r5 = along(r3, _C3, change), along(r4, _C4, change), along(r5, _C5, change)
    kept = caps[0].kept[:], caps[1].kept[:]
    direction = turned(direction, change[2] * _C0)
    state = State(r0, direction, velocity, a, kept, (r3, r4, r5), explicit)
    return state, velocity, caps


@kernel
def advance(effects, state, higher, step, dt):
    """Make one step: of leapfrog or Verlet's method if `higher` is None, else of Gear's."""
    if higher is None:
        return leap(effects, state, step, dt)
    return gear(effects, state, higher, step, dt)


@kernel(entry=True)
def run(effects, state, first, steps, dt, watch):
    """Make up to `steps` steps from number `first` on; return state, steps made and stop code.

    The state is returned as a plain tuple: Numba would make a `State` by calling Python. `watch` is
    an array to fill or `None`, without which the end of a contact does not end the run.
    """
    for n in range(steps):
        step = first + n
        good = state
        state, velocity, caps = advance(effects, state, state.higher, step, dt)
        if not abs(velocity[0] + velocity[1] + velocity[2]) < 1e100:
            return good[:], n, NOT_FINITE
        if max(caps[0].overlap, caps[1].overlap) > DEEP:
            return good[:], n, TOO_DEEP
        if watch is not None and watched(watch, effects, caps, (1.0, 0.0), dt):
            return good[:], n, OPENED
    return state[:], steps, DONE


def started(method: str, position: Any, velocity: Any, dt: float, fall: Any = ZERO) -> State:
    """Initial state of a rod without contact, for its place and velocity at the first step."""
    position, velocity = tuple(map(float, position)), tuple(map(float, velocity))
    higher: tuple | None = None
    if method == "gear":  # this method keeps everything at the step before
        position = along(along(position, -dt, velocity), dt * dt / 2, fall)
        velocity, higher = along(velocity, -dt, fall), (ZERO, ZERO, ZERO)
    else:
        velocity = along(velocity, -dt / 2, fall)
    direction = sin(position[2]), cos(position[2])
    explicit = None if method == "verlet" else True
    forgotten = 0.0, (0.0,), (0.0,)
    return State(position, direction, velocity, fall, (forgotten, forgotten), higher, explicit)


class Slip(NamedTuple):
    """Slip of a contact and what friction has to act on."""

    now: float  # sqrt(g d)
    drive: float  # g; its acceleration without friction
    mass: float  # m; the contact's tangential mass


@kernel
def in_mode(spring, mode, overlap, limit, length, slip):
    """F_t, the rate of the spring's length, and a signal that falls to zero as the mode changes.

    The signal is the friction or the slip that is left. `mode`: a mode of `codes`; `limit`: mu F_n;
    `length`: of the spring.
    """
    if spring is None:
        stick = -slip.drive * slip.mass
        if mode == STICK:
            return stick, 0.0, limit - abs(stick)
        return -mode * limit, 0.0, mode * slip.now
    k, g = tangential_constants(spring, overlap, slip.mass)
    free = -(k * length + g * slip.now)
    if mode == STICK:
        return free, slip.now, limit - abs(free)
    return -mode * limit, (mode * limit - k * length) / g, -mode * free - limit


@kernel
def friction_of_mode(friction, mode, overlap, force, length, slip):
    """F_t, rate of the spring's length and signal as of `in_mode`; without friction 0, 0, 1."""
    if friction is None or mode == FREE:
        return 0.0, 0.0, 1.0
    return in_mode(friction.spring, mode, overlap, friction.coefficient * force, length, slip)


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
    if overlap > 0:
        powers = powers_of(overlap, 1 / (1 + a_x * a_x * effects.lightness))
        (_, root, _), normal = powers, effects.normal
        c = dashpot(normal, powers)
        left = overlap - c * rate / (normal.stiffness * root)
        force = max(normal.stiffness * root * left, 0.0)
        left = left if normal.plastic is None else -rate  # a plastic contact ends as it rests
        drive = -a_x * force * effects.lightness * a_z - y[5] * y[4]
        seen = Slip(slip, drive, 1 / (1 + a_z * a_z * effects.lightness))
        rub, stretch, spare = friction_of_mode(effects.friction, mode, overlap, force, y[6], seen)
    turning = (a_z * rub - a_x * force) * effects.lightness
    change = (y[3], y[4], y[5], rub, force, turning, stretch, force)
    return change, (left, spare, overlap, slip)
