"""One contact, compiled: its normal force, dashpots, friction and energy losses.

Written once for rod on plate, rod on rod and rod on wall, in the plane and in space: vectors are
tuples of two numbers or three (`vectors`). Reduced units: d = m = g = 1, m the mass of the rod. A
parameter that is `None` says that its term is absent: Numba sees the type and leaves its code out.

Places are known at a step, velocities half a step before it. A dashpot's force belongs to the
velocity of the step, which it changes itself: it is solved for that velocity,

    F = (elastic - c v)/(1 + c dt/(2 M)),

with v the velocity without this force and M the effective mass of the contact for it. All other
forces on the two bodies are in v as of the step before, or as far as they are known in this one.

The tangential element is a spring with a dashpot beside it, both in series with a slider that
gives way at mu F_n (`spring_friction`), or no element at all but the constraint that the slip stays
zero as long as |F_t| <= mu F_n (`constraint_friction`).
"""

from math import copysign, sqrt
from typing import NamedTuple

from ..cache import kernel
from .vectors import across, along, dot, nothing, spread, swing, times, torque

PHASE = 1 / 3  # part of a spring's change in a step that its force sees (`spring_friction`)


class Normal(NamedTuple):
    """Normal force of a contact: Hertz' force and up to three dashpots, `None` where absent.

    F_n = k_n delta^(3/2) - (quarter sqrt(M) delta^(1/4) + proportional delta + constant) v_n, in
    m g and never below zero. delta is the overlap in d, v_n the velocity at which the contact opens
    in sqrt(g d), M the effective mass of the contact for a normal force in m: 1/M = 1/m + X^2/I.

    stiffness : k_n, m g/d^(3/2); the paper writes m g/d
    quarter : of the dashpot that grows as delta^(1/4), sqrt(m g) d^(-3/4); it gives a restitution
        that no speed changes
    proportional : of the dashpot that grows as delta, m sqrt(g)/d^(3/2)
    constant : of the dashpot that does not grow, m sqrt(g/d)
    plastic : True: no force while the contact opens
    """

    stiffness: float
    quarter: float | None = None
    proportional: float | None = None
    constant: float | None = None
    plastic: bool | None = None


class Spring(NamedTuple):
    """Tangential spring and dashpot of a contact: terms of their constants, `None` where absent.

    F_t = -k s - g u, in m g and never beyond mu F_n. s is the length of the spring in d, u the slip
    in sqrt(g d), delta the overlap in d; the stiffness k is in m g/d, the dashpot constant g in
    m sqrt(g/d).

    proportional : k = proportional delta, m g/d^2
    root : k = root sqrt(delta), m g/d^(3/2)
    proportional_dashpot : g = proportional_dashpot delta, m sqrt(g)/d^(3/2)
    constant_dashpot : g = constant_dashpot, m sqrt(g/d)
    damping_ratio : g = 2 damping_ratio sqrt(k M), M the effective mass of the contact for a force
        along the plate, 1/M = 1/m + Z^2/I
    """

    proportional: float | None = None
    root: float | None = None
    proportional_dashpot: float | None = None
    constant_dashpot: float | None = None
    damping_ratio: float | None = None


class Friction(NamedTuple):
    """Coulomb friction of a contact; without a spring, friction is a constraint."""

    coefficient: float
    spring: Spring | None


class ContactForces(NamedTuple):
    """Normal force and friction of one kind of contact."""

    normal: Normal
    friction: Friction | None


class Inertia(NamedTuple):
    """Rotational inertia of a rod: k its gyration radius, I and I_axial its moments of inertia."""

    lightness: float  # 1/k^2, 1/d^2
    rolling: float | None  # I/I_axial - 1; None: no rotation of a rod about its axis


class Kept(NamedTuple):
    """Forces and spring that a contact keeps from one step for the next."""

    force: float  # F_n, m g
    rub: tuple  # F_t, m g: across the normal
    spring: tuple  # d; length of the tangential spring, across the normal


class Meeting(NamedTuple):
    """Contact before its forces of the step: a body against another one or a surface."""

    bodies: tuple  # of each, the arm from its centre to the contact, d, and its director
    out: tuple  # unit vector from the second body or the surface to the first
    overlap: float  # d, > 0
    half: tuple  # sqrt(g d); velocity of the first body against the second half a step before
    gain: tuple  # g; acceleration of that velocity as far as known, by `kept` too
    kept: Kept  # of the step before, or as far as known
    swept: tuple  # g; acceleration of the slip by the motion of the arm; zero: neglected
    explicit: bool | None  # True: dashpots see `now`; None: they see the velocity of their step
    now: tuple  # sqrt(g d); velocity for explicit dashpots


class Slip(NamedTuple):
    """Motion of a contact with its normal force of the step and without its friction."""

    velocity: tuple  # sqrt(g d), at the step
    drive: tuple  # g; acceleration of the velocity
    since: float  # sqrt(d/g); part of the last step since the touch
    implicit: float  # sqrt(d/g); time for which friction acts on `velocity`


class Force(NamedTuple):
    """Outcome of a contact in a step; the forces in `kept` act on its first body."""

    kept: Kept  # forces and new spring
    rate: float  # sqrt(g d), at which the contact opens (+) or closes (-) at the step
    lost: tuple[float, float]  # m g d; in the normal dashpot, and by friction


@kernel
def term(constant, factor):
    """Summand constant * factor; -0.0 without a constant, which adds nothing and has no code."""
    return -0.0 if constant is None else constant * factor


@kernel
def dashpot(normal, overlap, root, mass):
    """Dashpot constant quarter sqrt(M) delta^(1/4) + proportional delta + constant.

    It is a force per velocity. `root` is sqrt(delta), `mass` is M.
    """
    c = term(normal.quarter, sqrt(mass * root)) + term(normal.proportional, overlap)
    return c + term(normal.constant, 1.0)


@kernel
def elastic(normal, overlap):
    """Elastic force k_n delta^(3/2) of Hertz."""
    return normal.stiffness * overlap * sqrt(overlap)


@kernel
def elastic_energy(normal, overlap):
    """Energy 2/5 k_n delta^(5/2) of Hertz, m g d; 0 without an overlap."""
    return 0.4 * normal.stiffness * overlap * overlap * sqrt(overlap) if overlap > 0.0 else 0.0


@kernel
def normal_force(normal, overlap, half, free, light, implicit, dt):
    """F_n >= 0 of a contact with overlap > 0: (elastic - c v)/(1 + c t/M) with dashpots.

    `half`, `free`: velocity at which it opens, half a step before, and v, at the step but without
    F_n; `light`: 1/M; `implicit`: t, the time for which F_n acts on v, dt/2 or 0.
    """
    force, c = elastic(normal, overlap), dashpot(normal, overlap, sqrt(overlap), 1 / light)
    if normal.quarter is not None or normal.proportional is not None or normal.constant is not None:
        force = (force - c * free) / (1 + c * implicit * light)
    if normal.plastic is not None:  # at most what stops it in this step
        force = min(force, -(2 * free - half) / (light * dt))
    return max(force, 0.0)


@kernel
def turn_by(inertia, torque, director):
    """Rate of a rod's turn w by a torque: torque/k^2, restricted as in `free_turn`."""
    return free_turn(inertia.rolling, times(inertia.lightness, torque), director)


@kernel
def free_turn(rolling, w, director):
    """Turn w without its part along the director, in space and without rolling; else w."""
    if len(w) == 1:
        return w
    if rolling is None:
        return along(w, -dot(w, director), director)
    return w


@kernel
def turning(rolling, w, director):
    """Angular velocity of a rod from its turn w: w + rolling (w . director) director."""
    if rolling is None:
        return w
    return along(w, rolling * dot(w, director), director)


@kernel
def moved(inertia, bodies, force):
    """Acceleration of the first body against the second at the contact, by a force on the first.

    The opposite force acts on the second body, if there is one.
    """
    total = times(1.0 * len(bodies), force)
    for arm, director in bodies:
        w = turn_by(inertia, torque(arm, force), director)
        total = along(total, 1.0, swing(turning(inertia.rolling, w, director), arm))
    return total


@kernel
def tangential_light(inertia, bodies, out, pull):
    """1/M, M the effective mass for a force across `out`, in space for one along `pull`."""
    if len(out) == 2:
        return dot(moved(inertia, bodies, spread((1.0,), out)), spread((1.0,), out))
    square = dot(pull, pull)
    if square == 0.0:
        return 1.0 * len(bodies)
    return dot(moved(inertia, bodies, pull), pull) / square


@kernel
def tangential_constants(spring, overlap, mass):
    """Stiffness k and dashpot constant g of the tangential element at an overlap; `mass` is M."""
    k = term(spring.proportional, overlap) + term(spring.root, sqrt(overlap))
    g = term(spring.proportional_dashpot, overlap) + term(spring.constant_dashpot, 1.0)
    return k, g + term(spring.damping_ratio, 2 * sqrt(k * mass))


@kernel
def touching(overlap, rate, dt):
    """Time since the touch, within the last step: dt, or less in the first step of a contact."""
    return overlap / -rate if -rate * dt > overlap else dt


@kernel
def size(v):
    """Length of a vector; absolute value of a single number."""
    return abs(v[0]) if len(v) == 1 else sqrt(dot(v, v))


@kernel
def unit(v):
    """Unit vector along a vector other than zero; sign of a single number."""
    if len(v) == 1:
        return (1.0 if v[0] > 0.0 else -1.0,)
    return times(1 / size(v), v)


@kernel
def cut(force, limit):
    """Force of the size `limit` in the direction of a force."""
    if len(force) == 1:
        return (copysign(limit, force[0]),)
    return times(limit / size(force), force)


@kernel
def spring_friction(constants, light, limit, length, stretched, slips, implicit, dt):
    """F_t of spring and dashpot in series with a slider, and the spring's new length.

    Without slip of the slider the spring follows the contact point, s' = u, and becomes `stretched`
    from its `length`. Spring k and dashpot g are solved for the slip u of their own moment; of the
    spring's change by that slip they see the part PHASE, with which an oscillation keeps its phase
    to fourth order:

        F_t = -(k (s + PHASE dt/2 (u - half)) + g u),  u = free + F_t dt/(2 M),

    `slips` are half, the slip half a step before, and free, the slip of the step without F_t. With
    slip of the slider |F_t| = limit and the element relaxes, g s' = -F_t - k s; one step of
    backward Euler, stable for any g >= 0 and, for g = 0, the spring that alone carries the limit.
    """
    (k, g), (half, free), part = constants, slips, PHASE * implicit
    force = along(times(-k, along(stretched, part, along(free, -1.0, half))), -g, free)
    force = times(1 / (1 + (g + k * part) * implicit * light), force)
    if size(force) <= limit:
        return force, stretched
    force, relaxed = cut(force, limit), 1 / (g + k * dt)
    return force, along(times(g * relaxed, length), -dt * relaxed, force)


@kernel
def stopping(compliance, a):
    """Friction force that cancels an acceleration `a` of the slip: -C^-1 a, with the compliance C.

    `compliance`: accelerations by unit forces, (xx,) in the plane and (xx, xy, yy) in space.
    """
    if len(compliance) == 1:
        return (-a[0] / compliance[0],)
    xx, xy, yy = compliance
    scale = 1.0 / (xx * yy - xy * xy)
    return scale * (xy * a[1] - yy * a[0]), scale * (xy * a[0] - xx * a[1])


@kernel
def slowing(compliance, a):
    """Acceleration along a unit vector `a` by a unit force along it: a . C a, C the compliance."""
    if len(compliance) == 1:
        return compliance[0]
    xx, xy, yy = compliance
    return xx * a[0] * a[0] + 2.0 * xy * a[0] * a[1] + yy * a[1] * a[1]


@kernel
def constraint_friction(compliance, slip, drive, limit, dt):
    """Mean F_t of a constraint over a step: slip, its stop, then stick or slip back.

    All but friction is constant over the step. `slip`: half a step before; `drive`: its
    acceleration without friction; `compliance`: as in `stopping`; `limit`: mu F_n.
    """
    stop, hold = stopping(compliance, along(drive, 1 / dt, slip)), stopping(compliance, drive)
    holds = size(hold)
    if max(size(stop), holds) <= limit:  # leaves no slip at the end of the step
        return stop
    speed, slides, a = size(slip), 0.0, times(0.0, slip)
    if speed > 0.0:
        a = unit(slip)
        slower = limit * slowing(compliance, a) - dot(a, drive)
        slides = speed / (slower * dt) if speed < slower * dt else 1.0  # part of the step
    if slides == 1.0:
        return times(-limit, a)
    rest = (1.0 - slides) * min(limit / max(holds, 1e-300), 1.0)  # sticks, or slips with the drive
    return along(times(rest, hold), -slides * limit, a)


@kernel
def constrained(inertia, bodies, half, limit, drive, dt):
    """F_t of a constraint, for one body on a level surface; arguments as in `Meeting`."""
    slip, drive = half[:-1], drive[:-1]
    if len(half) == 2:
        x = moved(inertia, bodies, (1.0, 0.0))
        return constraint_friction((x[0],), slip, drive, limit, dt)
    x = moved(inertia, bodies, (1.0, 0.0, 0.0))
    y = moved(inertia, bodies, (0.0, 1.0, 0.0))
    f = constraint_friction((x[0], x[1], y[1]), slip, drive, limit, dt)
    return f[0], f[1], 0.0


@kernel
def element_friction(spring, inertia, meeting, slip, limit, dt):
    """F_t up to `limit`, and the spring's new length, which a constraint leaves as it is.

    Two rods side by side touch at both ends, which slip alike: the spring of a pair is solved as if
    the other contact exerted the same friction.
    """
    n, bodies = meeting.out, meeting.bodies
    if spring is None:
        drive = along(slip.drive, 1.0, meeting.swept)
        return constrained(inertia, bodies, meeting.half, limit, drive, dt), meeting.kept.spring
    half, free, many = across(meeting.half, n), across(slip.velocity, n), len(bodies)
    length = across(meeting.kept.spring, n)  # it turns from step to step
    stretched = along(length, slip.since, half)
    light = tangential_light(inertia, bodies, n, along(stretched, dt, free))
    constants = tangential_constants(spring, meeting.overlap, 1 / light)
    free = along(free, -slip.implicit * (many - 1) * light, meeting.kept.rub)
    light *= many
    return spring_friction(
        constants, light, limit, length, stretched, (half, free), slip.implicit, dt
    )


@kernel
def friction_force(friction, inertia, meeting, slip, force, dt):
    """F_t under a normal force, and the spring's new length; without friction F_t is zero."""
    if friction is None:
        return nothing(meeting.kept.rub), meeting.kept.spring
    limit = friction.coefficient * force
    return element_friction(friction.spring, inertia, meeting, slip, limit, dt)


@kernel
def moved_by(friction, inertia, bodies, out, rub):
    """Acceleration of the contact by its friction force; zero without friction.

    In the plane it follows from that by a unit force.
    """
    if friction is None:
        return nothing(out)
    if len(out) == 2:
        return times(rub[0], moved(inertia, bodies, spread((1.0,), out)))
    return moved(inertia, bodies, rub)


@kernel
def contact(normal, friction, inertia, meeting, dt):
    """Compute the `Force` of a `Meeting`: first F_n, with the last F_t, then F_t under this F_n."""
    n, overlap, bodies, last = meeting.out, meeting.overlap, meeting.bodies, meeting.kept
    velocity, implicit = meeting.now, 0.0  # what dashpots see; how long a force acts on it
    if meeting.explicit is None:
        velocity, implicit = along(meeting.half, dt / 2, meeting.gain), dt / 2
    push = moved(inertia, bodies, n)  # acceleration of the contact by a unit normal force
    light, closing = dot(push, n), dot(meeting.half, n)
    free = dot(velocity, n) - implicit * light * last.force
    force = normal_force(normal, overlap, closing, free, light, implicit, dt)
    change = times(force - last.force, push)
    change = along(change, -1.0, moved_by(friction, inertia, bodies, n, last.rub))
    velocity, drive = along(velocity, implicit, change), along(meeting.gain, 1.0, change)
    slip = Slip(velocity, drive, touching(overlap, closing, dt), implicit)
    rub, spring = friction_force(friction, inertia, meeting, slip, force, dt)
    now = along(velocity, implicit, moved_by(friction, inertia, bodies, n, rub))
    rate = dot(now, n)
    lost = dt * rate * (elastic(normal, overlap) - force), -dt * dot(rub, across(now, n))
    return Force(Kept(force, rub, spring), rate, lost)
