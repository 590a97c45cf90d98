"""One contact, compiled: its normal force, dashpots, friction and energy losses.

Written once for rod on plate, rod on rod and rod on wall, in the plane and in space: vectors are
tuples of two numbers or three (`vectors`). Reduced units: d = m = g = 1, m the mass of the rod. A
parameter that is `None` says that its term is absent: Numba sees the type and leaves its code out.

Places are known at a step, velocities half a step before it. The force of a normal dashpot belongs
to the velocity of the step, which it changes itself: it is solved for that velocity,

    F = (elastic - c v)/(1 + c dt/(2 M)),

with v the velocity without this force and M the effective mass of the contact for it. All other
forces on the two bodies are in v as of the step before, or as far as they are known in this one.

The tangential element is a spring with a dashpot beside it, both in series with a slider that
gives way at mu F_n (`spring_friction`), or no element at all but the constraint that the slip stays
zero as long as |F_t| <= mu F_n (`constraint_friction`).
"""

from math import copysign, sqrt
from typing import Any, NamedTuple

from ..cache import kernel
from . import FREE, STICK
from .vectors import across, along, dot, nothing, spread, swing, times, torque

HALVED = 0.5, 0.5**0.5, 0.5**0.25  # what is left of `powers_of` half the overlap
EARLIER = 1 / 32  # of `gain` dt^2; springs without dashpots keep their energy with it
ALIKE = 4  # contacts that a contact of rods is solved for
LEAST = 1e-30  # d; no tangential element is taken at a smaller overlap


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
    rolling: float | None = None  # I/I_axial - 1; None: no rotation of a rod about its axis


class Kept(NamedTuple):
    """Forces and spring that a contact keeps from one step for the next."""

    force: float  # F_n, m g
    rub: tuple  # F_t, m g: across the normal
    spring: tuple  # d; length of the tangential spring, across the normal


class Memory(NamedTuple):
    """What contacts keep, a row each: numbers of `Kept`; `None` where an effect does not need it.

    A part across a normal has one number in the plane, and three in space.
    """

    forces: Any  # (contacts, 1 + part), m g: F_n and F_t
    springs: Any  # (contacts, part), d


class Meeting(NamedTuple):
    """Contact before its forces of the step: a body against another one or a surface."""

    bodies: tuple  # of each, the arm from its centre to the contact, d, and its director
    out: tuple  # unit vector from the second body or the surface to the first
    overlap: float  # d, > 0
    half: tuple  # sqrt(g d); velocity of the first body against the second half a step before
    gain: tuple  # g; acceleration of that velocity as far as known, by `kept` too
    kept: Kept  # of the step before, or as far as known
    swept: tuple  # g; acceleration of the slip by the motion of the arm; zero: neglected


class Before(NamedTuple):
    """State of a contact a step before; of a new one, halfway in time from touch to step."""

    overlap: float  # d
    force: float  # F_n, m g
    since: float  # sqrt(d/g); time since the touch, at most the last step


class Slip(NamedTuple):
    """Slip of a contact, and its acceleration."""

    half: tuple  # sqrt(g d); half a step before
    gain: tuple  # g; a step before, as far as known
    drive: tuple  # g; at the step, without the friction of this contact
    alike: tuple  # g; at the step, without the friction of all contacts that count as alike


class Instant(NamedTuple):
    """Slip of a contact at an instant, and what friction has to act on."""

    now: float  # sqrt(g d)
    drive: float  # g; its acceleration without friction
    mass: float  # m; the contact's tangential mass


class Element(NamedTuple):
    """Tangential element of a contact at one overlap, under one normal force."""

    stiffness: float  # k, m g/d
    lag: float  # sqrt(d/g); g/k, the time in which the spring relaxes as the slider gives way
    reach: float  # d; mu F_n/k, the spring that alone carries the limit


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
def powers_of(overlap, mass):
    """Overlap delta, sqrt(delta), and sqrt(M) delta^(1/4); `mass` is M."""
    root = sqrt(overlap)
    return overlap, root, sqrt(mass * root)


@kernel
def dashpot(normal, powers):
    """Dashpot constant quarter sqrt(M) delta^(1/4) + proportional delta + constant.

    It is a force per velocity.
    """
    overlap, _, fourth = powers
    c = term(normal.quarter, fourth) + term(normal.proportional, overlap)
    return c + term(normal.constant, 1.0)


@kernel
def elastic(normal, powers):
    """Elastic force k_n delta^(3/2) of Hertz."""
    return normal.stiffness * powers[0] * powers[1]


@kernel
def elastic_energy(normal, overlap):
    """Energy 2/5 k_n delta^(5/2) of Hertz, m g d; 0 without an overlap."""
    return 0.4 * normal.stiffness * overlap * overlap * sqrt(overlap) if overlap > 0.0 else 0.0


@kernel
def normal_force(normal, powers, half, free, light, implicit, dt):
    """F_n >= 0 of a contact with overlap > 0: (elastic - c v)/(1 + c t/M) with dashpots.

    `half`, `free`: velocity at which it opens, half a step before, and v, at the step but without
    F_n; `light`: 1/M; `implicit`: t, the time for which F_n acts on v, dt/2; None: it does not.
    """
    force, c = elastic(normal, powers), dashpot(normal, powers)
    if normal.quarter is not None or normal.proportional is not None or normal.constant is not None:
        force -= c * free
        if implicit is not None:
            force /= 1 + c * implicit * light
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
def before_of(normal, powers, closing, free, light, last, dt):
    """`Before` of a contact with F_n = `last` a step before; the rest as of `normal_force`."""
    overlap = powers[0]
    since = overlap / -closing if -closing * dt > overlap else dt  # the touch, at most a step ago
    halved = HALVED[0] * overlap, HALVED[1] * powers[1], HALVED[2] * powers[2]
    halfway = normal_force(normal, halved, closing, free, light, None, dt)
    if since < dt:
        return Before(halved[0], halfway, since)
    return Before(overlap + closing * dt, last, since)


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
def element(friction, overlap, force, mass):
    """`Element` at an overlap, under a normal force; `mass` is M."""
    k, g = tangential_constants(friction.spring, max(overlap, LEAST), mass)
    return Element(k, g / k, friction.coefficient * force / k)


@kernel
def relaxed(lag, reach, last, strain, length, dt):
    """Length of the spring after a time dt in which the slider gives way: lag s' = reach - s.

    The reach, `last` at the end, has the direction of `strain`. For a steady rate r' of the reach,
    the solution s = reach - lag r' is kept exactly; what differs from it decays, as
    1/(1 + dt/lag + (dt/lag)^2/2). The length is a mean with weights >= 0, at any lag.
    """
    first, second, third = lag * lag, dt * lag, 0.5 * dt * dt
    share = 1 / (first + second + third)
    length = times(share * first, length)
    return along(length, share * (second * reach + third * last), unit(strain))


@kernel
def followed(lag, reach, last, length, slip, dt):
    """Length of the spring after a time dt of known slip; `reach` in the middle, `last` after."""
    strain = along(length, 0.5 * dt + lag, slip)
    if size(strain) <= reach:
        return along(length, dt, slip)
    return relaxed(lag, reach, last, strain, length, dt)


@kernel
def within(strain, reach):
    """Strain of an element, at most its reach."""
    return strain if size(strain) <= reach else cut(strain, reach)


@kernel
def spring_friction(now, then, light, many, since, length, slip, dt):
    """Mean F_t of spring and dashpot in series with a slider, and the spring's new length.

    The strain s + lag u makes the force, F_t = -k (s + lag u). Up to the reach the spring follows
    the contact point, s' = u; beyond it the slider gives way: the strain is the reach, and the
    spring relaxes. The force of a step acts until half a step later, so that a slider that stops
    within the step would be felt late. F_t is the mean of the forces a quarter of a step before and
    after it, each with a reach of its own, so that it never exceeds mu F_n, and the spring follows
    the slip up to the step in two halves. The dashpot is solved for the slip of its moment, with
    the friction of `many` contacts. The earlier strain lacks `EARLIER` dt^2 times the acceleration
    of the step before, by which springs without dashpots keep their energy.

    `now`, `then`: `Element` at the step and of `Before`; `light`: 1/M; `many`: contacts that rub
    alike, this one included; `since`: of `Before`; `length`: of the spring.
    """
    half, quarter, lag = 0.5 * dt, 0.25 * dt, 0.5 * (now.lag + then.lag)
    early, late = along(slip.half, -quarter, slip.gain), along(slip.half, quarter, slip.gain)
    reach, grown = now.reach, 0.25 * (now.reach - then.reach)  # in a quarter of a step, or less
    start, follows = followed(lag, reach - 3 * grown, reach - 2 * grown, length, early, half), half
    middle, grown = reach - grown, max(grown, -reach)  # no reach is below 0
    if since < dt:
        start, follows, middle, lag = length, since, then.reach, then.lag
    new, held = followed(lag, middle, reach, start, late, follows), along(start, follows, late)
    square = light * now.stiffness  # k/M
    part = quarter * now.lag
    share, known = 1 / (1 + part * many * square), times(part, slip.alike)
    first = along(along(held, now.lag - quarter, slip.half), -EARLIER * dt * dt, slip.gain)
    first = within(times(share, along(first, 1.0, known)), reach - grown)
    pulled = along(slip.half, half, along(slip.drive, -square, first))
    damped = along(slip.half, half, along(slip.alike, -many * square, first))
    second = along(along(new, quarter, pulled), now.lag, damped)
    second = within(times(share, along(second, 1.0, known)), reach + grown)
    return times(-0.5 * now.stiffness, along(first, 1.0, second)), new


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
def element_friction(friction, spring, inertia, meeting, drive, force, before, dt):
    """F_t under a normal force, and the spring's new length, which a constraint leaves as it is.

    A rod in a row touches both neighbours at both ends, and where it slips, these contacts rub
    alike. Each sees the others a step late, which would make neighbours with stiff dashpots shake:
    the dashpot of a contact of rods is solved as if `ALIKE` contacts changed their friction by as
    much.
    """
    n, bodies, half = meeting.out, meeting.bodies, meeting.half
    if spring is None:
        drive, limit = along(drive, 1.0, meeting.swept), friction.coefficient * force
        return constrained(inertia, bodies, half, limit, drive, dt), meeting.kept.spring
    length = across(meeting.kept.spring, n)  # it turns from step to step
    half, drive, many = across(half, n), across(drive, n), 1
    pull = along(along(length, dt, half), 0.5 * dt * dt, drive)
    light, alike = tangential_light(inertia, bodies, n, pull), drive
    if len(bodies) == 2:
        many, alike = ALIKE, along(drive, -(ALIKE - 1) * light, meeting.kept.rub)
    now = element(friction, meeting.overlap, force, 1 / light)
    then = element(friction, before.overlap, before.force, 1 / light)
    slip = Slip(half, across(meeting.gain, n), drive, alike)
    return spring_friction(now, then, light, many, before.since, length, slip, dt)


@kernel
def friction_force(friction, inertia, meeting, drive, force, before, dt):
    """F_t under a normal force, and the spring's new length; without friction F_t is zero."""
    if friction is None:
        return nothing(meeting.kept.rub), meeting.kept.spring
    spring = friction.spring
    return element_friction(friction, spring, inertia, meeting, drive, force, before, dt)


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
    implicit = dt / 2  # how long a force acts on the velocity that dashpots see
    velocity = along(meeting.half, implicit, meeting.gain)
    push = moved(inertia, bodies, n)  # acceleration of the contact by a unit normal force
    light, closing = dot(push, n), dot(meeting.half, n)
    free = dot(velocity, n) - implicit * light * last.force
    there = powers_of(overlap, 1 / light)
    force = normal_force(normal, there, closing, free, light, implicit, dt)
    before = before_of(normal, there, closing, free, light, last.force, dt)
    change = times(force - last.force, push)
    change = along(change, -1.0, moved_by(friction, inertia, bodies, n, last.rub))
    drive = along(meeting.gain, 1.0, change)
    rub, spring = friction_force(friction, inertia, meeting, drive, force, before, dt)
    change = along(change, 1.0, moved_by(friction, inertia, bodies, n, rub))
    now = along(velocity, implicit, change)
    rate = dot(now, n)
    lost = dt * rate * (elastic(normal, there) - force), -dt * dot(rub, across(now, n))
    return Force(Kept(force, rub, spring), rate, lost)


# Friction between two of its switches


@kernel
def in_mode(spring, mode, overlap, limit, length, slip):
    """F_t, the rate of the spring's length, and a signal that falls to zero as the mode changes.

    The signal is the friction or the slip that is left. `mode`: `STICK` or its neighbours in
    `md.kernels`; `limit`: mu F_n; `length`: of the spring.
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
