"""One rod and the plate: a single impact.

Reduced units: lengths in rod diameters d, masses in the rod's, accelerations in g; so velocities
are in sqrt(g d) and times in sqrt(d/g).
"""

from collections.abc import Sequence
from math import nan, pi, sin
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from . import reference
from .domains import InputError, RunError, held, hints, not_negative, number, positive
from .kernels import single
from .kernels.codes import (
    DEEP,
    DONE,
    IMPULSE,
    NOT_FINITE,
    PHASES,
    REGIMES,
    STUCK,
    TOO_DEEP,
    TURNED,
    WATCH_DEEPEST,
    WATCH_STOPPED,
    WATCHED,
)
from .kernels.rates import plate_after
from .kernels.state import Effects, Motion
from .kernels.touches import regime_of
from .laws import (
    Law,
    contact_time,
    coulomb,
    deepest_overlap,
    largest_step,
)
from .reference import Contact, Vibration
from .rod import LowerEnd, Rod, effects_of, height_of_second, lower_end
from .scene import Rods

INTEGRATORS = (*single.METHODS, "dop853")
_FINE = 100  # default steps per head-on contact time
_FINEST = 1e8  # steps of a contact that are as many as anybody waits for
_MOST_STEPS = 1e7  # of a period of the plate: they are in memory
_SLOWEST = 1e-30  # speed of an impact below which numbers run out
_STEPS_A_CALL = 10**6  # some 50 ms: signals are seen between calls
_LONGEST = 1e5  # contact times after which a contact that goes on is an error


class Impact(NamedTuple):
    """What one impact did; velocities after it, in the frame of the laboratory."""

    c_x: float  # along the plate, sqrt(g d)
    c_z: float  # across, sqrt(g d)
    omega: float  # sqrt(g/d)
    restitution: float  # -v_f/v_0 of the contact point that touched first, against the plate
    regime: str  # one of `kernels.codes.REGIMES`
    phases: dict[str, float]  # durations by name in `kernels.codes.PHASES`, sqrt(d/g)
    max_overlap: float  # in d
    contact_time: float  # from touch to the end of the force, sqrt(d/g)
    dt: float  # step; nan for the adaptive method
    steps: int  # force evaluations
    seconds: float  # run time, without compilation


def _checked_rod(rod: Rod) -> Rod:
    if not isinstance(rod, Rod):
        raise InputError(f"rod must be a md.Rod, got {rod!r}")
    allowed = hints(Rod) | hints(Rods)
    return Rod(*(held(name, value, allowed[name]) for name, value in rod._asdict().items()))


def _checked_law(law: Law | None) -> Law:
    if law is not None and not isinstance(law, Law):
        raise InputError(f"law must be made by a function of md.LAWS, as md.coulomb(), got {law!r}")
    return law or coulomb()


def _numbers(name: str, values: Any, count: int) -> tuple:
    """A sequence of so many values."""
    some = isinstance(values, Sequence | np.ndarray) and getattr(values, "ndim", 1) == 1
    if not some or len(values) != count:
        raise InputError(f"{name} must be {count} numbers, got {values!r}")
    return tuple(values)


def _checked_gravity(gravity: Any) -> tuple[float, float] | None:
    if gravity is None:
        return None
    gravity = _numbers("gravity", gravity, 2)
    g_x, g_z = (number("gravity", g, -1e6, 1e6, "two numbers up to 1e6") for g in gravity)
    return g_x, g_z


def _checked_vibration(vibration: Any) -> Vibration | None:
    if vibration is None:
        return None
    amplitude, frequency, phase = _numbers("vibration", vibration, 3)
    return Vibration(
        not_negative("amplitude", amplitude),
        positive("frequency", frequency),
        number("phase", phase, -1e6, 1e6, "a number up to 1e6"),
    )


def _step(
    law: Law, effects: Effects, speed: float, tilt: float, dt: float | None, method: str
) -> float:
    """The step asked for, or a good one; one that is not stable is refused."""
    if speed < _SLOWEST:
        raise InputError(f"the impact must be at {_SLOWEST:g} sqrt(g d) or faster, got {speed:g}")
    deepest = deepest_overlap(law, speed)
    if not deepest < DEEP / 2:
        raise InputError(
            f"the plate is too soft for an impact at {speed:g}: overlap {deepest:.2g} d"
        )
    across, along = np.square(lower_end(effects, tilt).arm(tilt)) * effects.lightness
    caps = 2 if height_of_second(effects, tilt) < 2 * deepest else 1
    rubs = effects.friction is not None
    largest = largest_step(law, rubs, speed, along, across, method, caps)
    whole = contact_time(law, speed)
    if dt is None:
        return float(min(whole / _FINE, largest / 4))
    dt = positive("dt", dt)
    if dt > largest:
        raise InputError(
            f"dt must be at most {largest:.3g} sqrt(d/g), 1/{whole / largest:.1f} of the contact "
            f"time {whole:.3g}, to be stable; got {dt!r}"
        )
    if dt < whole / _FINEST:
        raise InputError(f"dt must be at least {whole / _FINEST:.3g} sqrt(d/g), got {dt!r}")
    return dt


def _steps_per_period(vibration: Vibration, dt: float) -> int:
    return int(np.ceil(1 / (vibration.frequency * dt) - 1e-9))


def plate_table(vibration: Vibration | None, dt: float) -> Motion | None:
    """One period of the plate, step by step; `dt` divides it."""
    if vibration is None:
        return None
    steps = _steps_per_period(vibration, dt)
    angle = 2 * pi * np.arange(steps) / steps + vibration.phase
    speed = 2 * pi * vibration.frequency * vibration.amplitude
    return Motion(vibration.amplitude * np.sin(angle), speed * np.cos(angle))


def stopped_run(why: int, state: single.State, steps: int, dt: float) -> None:
    """Raise what ended a run of one rod early."""
    if why not in (NOT_FINITE, TOO_DEEP):
        return
    text = "its state is not finite" if why == NOT_FINITE else "deeper than d/2 in the plate"
    raise RunError(
        f"rod 0: {text} at t = {steps * dt:g} sqrt(d/g); dt = {dt:g}",
        (*state.position, *state.velocity),
    )


def impact(
    tilt: float,
    c_x: float,
    c_z: float,
    omega: float = 0.0,
    *,
    friction: float,
    rod: Rod = Rod(),  # noqa: B008  (immutable)
    law: Law | None = None,
    integrator: str = "leapfrog",
    dt: float | None = None,
    offset: float = 0.5,
    vibration: Vibration | None = None,
    gravity: tuple[float, float] | None = None,
    tolerance: float = 1e-13,
) -> Impact:
    """One impact of the lower cap or corner, from its touch to the end of its force.

    Parameters
    ----------
    tilt : from the vertical, rad, -pi/2 to pi/2
    c_x, c_z, omega : velocities at the touch, sqrt(g d) and sqrt(g/d)
    friction : Coulomb coefficient, >= 0; 0: none is simulated, inf: no slip
    rod : length, inertia and ends
    law : contact law; default `coulomb(restitution=0.65)`
    integrator : "leapfrog", "verlet", "gear", or the adaptive "dop853" with located events, which
        follows one cap or corner only
    dt : step, sqrt(d/g); default a hundredth of the contact time or a quarter of the stable step
    offset : part of a step that is left at the first step until the touch, 0 to 1
    vibration : of the plate, whose phase is that of the touch; None: at rest
    gravity : (g_x, g_z) in g; None: absent
    tolerance : of "dop853", relative, per step, 1e-14 to 1e-3

    Raises
    ------
    ValueError
        If an argument is out of its domain, the contact point does not approach the plate, the
        step is not stable or the plate too soft.
    RunError
        If the contact does not end, or the state stops being finite.
    """
    rod, law = _checked_rod(rod), _checked_law(law)
    tilt = number("tilt", tilt, -pi / 2, pi / 2, "between -pi/2 and pi/2")
    given = {"c_x": c_x, "c_z": c_z, "omega": omega}
    velocity = tuple(number(k, v, -1e6, 1e6, "a number up to 1e6") for k, v in given.items())
    vibration, gravity = _checked_vibration(vibration), _checked_gravity(gravity)
    if integrator not in INTEGRATORS:
        raise InputError(f"integrator must be one of {', '.join(INTEGRATORS)}, got {integrator!r}")
    offset = number("offset", offset, 0.0, 1.0, "between 0 and 1")
    plate = plate_after(vibration, 0.0)[1]
    effects = effects_of(rod, law, friction, gravity, None)
    end = lower_end(effects, tilt)
    speed = -(velocity[1] - velocity[2] * end.arm(tilt)[0] - plate)
    if not speed > 0:
        raise InputError(
            f"c_z must bring the contact point towards the plate: it moves away at {-speed:g}"
        )
    method = "leapfrog" if integrator == "dop853" else integrator
    step = _step(law, effects, speed, tilt, dt, method)
    early = vibration
    if vibration is not None:
        least = 1 / (_MOST_STEPS * step)
        if vibration.frequency < least:
            raise InputError(
                f"frequency of the vibration must be at least {least:.3g} sqrt(g/d), which is "
                f"{_MOST_STEPS:g} steps a period; got {vibration.frequency!r}"
            )
        step = 1 / (vibration.frequency * _steps_per_period(vibration, step))
        before = 2 * pi * vibration.frequency * offset * step
        early = vibration._replace(phase=vibration.phase - before)
    effects = effects._replace(plate=plate_table(early, step))
    longest = _LONGEST * contact_time(law, speed)
    case = _Case(effects, end, vibration, tilt, velocity, speed, longest)
    if integrator == "dop853":
        return _to_the_digits(case, tolerance)
    return _by_steps(case, integrator, step, offset)


class _Case(NamedTuple):
    """An impact to compute."""

    effects: Effects
    end: LowerEnd
    vibration: Vibration | None
    tilt: float  # rad
    velocity: tuple[float, ...]  # c_x, c_z, omega
    speed: float  # of the approach, sqrt(g d)
    longest: float  # time after which a contact that goes on is an error, sqrt(d/g)

    def impact(self, done: Contact, dt: float, seconds: float) -> Impact:
        """What the contact did to the rod."""
        c_x, c_z, omega = map(float, done.velocity)
        a_x, _ = self.end.arm(done.position[2])
        v_f = c_z - omega * a_x - plate_after(self.vibration, done.end)[1]
        stuck, turned = done.impulses[STUCK], done.impulses[TURNED]
        return Impact(
            c_x=c_x,
            c_z=c_z,
            omega=omega,
            restitution=float(v_f / self.speed),
            regime=REGIMES[regime_of(done.stopped, stuck, turned)],
            phases=dict(zip(PHASES, map(float, done.durations), strict=True)),
            max_overlap=float(done.deepest),
            contact_time=float(sum(done.durations)),
            dt=dt,
            steps=done.evaluations,
            seconds=seconds,
        )


def _by_steps(case: _Case, method: str, dt: float, offset: float) -> Impact:
    """One impact with a fixed step, whose first begins `offset` steps before the touch."""
    effects, height = case.effects, -case.end.arm(case.tilt)[1]
    if case.vibration is not None:
        height += case.vibration.amplitude * sin(case.vibration.phase)
    position, velocity = np.array([0.0, height, case.tilt]), np.array(case.velocity)
    fall, early = np.array([*(effects.gravity or (0, 0)), 0.0]), offset * dt
    position = position - early * velocity + early**2 / 2 * fall
    state = single.started(method, position, velocity - early * fall, effects.gravity, dt)
    watch, most = np.zeros(WATCHED), int(min(case.longest / dt, 1e9))
    single.run(effects, state, 0, 0, dt, watch)  # compiles
    begin = perf_counter()
    steps, why = 0, DONE
    while why == DONE and steps < most:
        part = min(most - steps, _STEPS_A_CALL)
        now, made, why = single.run(effects, state, steps, part, dt, watch)
        state, steps = single.State(*now), steps + made
    seconds = perf_counter() - begin
    stopped_run(why, state, steps, dt)
    if why == DONE:
        raise RunError(
            f"the contact has not ended after {steps * dt:g} sqrt(d/g)",
            (*state.position, *state.velocity),
        )
    durations, impulses = watch[:IMPULSE], watch[IMPULSE : 2 * IMPULSE]
    stopped, deepest, end = watch[WATCH_STOPPED] > 0, watch[WATCH_DEEPEST], (steps - offset) * dt
    done = Contact(
        state.position, state.velocity, durations, impulses, stopped, deepest, steps, end
    )
    return case.impact(done, dt, seconds)


def _to_the_digits(case: _Case, tolerance: float) -> Impact:
    """One impact with every switch located."""
    tolerance = number("tolerance", tolerance, 1e-14, 1e-3, "between 1e-14 and 1e-3")
    effects, vibration = case.effects, case.vibration
    reference.compiled(effects, vibration)
    begin = perf_counter()
    done = reference.follow(effects, vibration, case.tilt, case.velocity, tolerance, case.longest)
    return case.impact(done, nan, perf_counter() - begin)
