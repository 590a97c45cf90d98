"""One rod and the plate: a single impact.

Reduced units: lengths in rod diameters d, masses in the rod's, accelerations in g; so velocities
are in sqrt(g d) and times in sqrt(d/g).
"""

from collections.abc import Sequence
from math import cos, pi, sin
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from . import reference
from .domains import not_negative, number, positive
from .errors import InputError, RunError
from .kernels import single as integrators
from .kernels.contact import Effects, Friction, Motion
from .kernels.single import DONE, METHODS, STUCK, TURNED, State
from .laws import (
    Law,
    contact_time,
    coulomb,
    deepest_overlap,
    friction_of,
    largest_step,
)
from .reference import Vibration

INTEGRATORS = (*METHODS, "dop853")
REGIMES = ("slide", "slip-stick", "slip-reversal")
PHASES = ("slide", "stick", "reversal")
_FINE = 100  # default steps per head-on contact time
_FINEST = 1e8  # steps of a contact that are as many as anybody waits for
_SLOWEST = 1e-30  # speed of an impact below which numbers run out
_STEPS_A_CALL = 10**6  # some 50 ms: signals are seen between calls
_LONGEST = 1e5  # contact times after which a contact that goes on is an error


class Rod(NamedTuple):
    """Spherocylinder of diameter 1.

    length : overall, caps included, >= 1
    inertia : "solid", of the uniform body, or "thin", the paper's length^2/12
    """

    length: float = 9.5
    inertia: str = "solid"

    @property
    def half_length(self) -> float:
        """From the centre to the centre of a cap."""
        return (self.length - 1) / 2

    @property
    def gyration_squared(self) -> float:
        """Moment of inertia about the centre over the mass."""
        if self.inertia == "thin":
            return self.length**2 / 12
        h = self.length - 1  # cylinder between the caps; volumes in units of pi/12
        offset = h / 2 + 3 / 16  # of the centre of mass of a half ball of radius 1/2
        ball = 1 / 10 - (3 / 16) ** 2 + offset**2
        return (3 * h * (h**2 / 12 + 1 / 16) + 2 * ball) / (3 * h + 2)


class Impact(NamedTuple):
    """What one impact did; velocities after it, in the frame of the laboratory."""

    c_x: float  # along the plate, sqrt(g d)
    c_z: float  # across, sqrt(g d)
    omega: float  # sqrt(g/d)
    restitution: float  # -v_f/v_0 of the contact point of the lower cap against the plate
    regime: str  # one of REGIMES
    phases: dict[str, float]  # durations, names in PHASES
    max_overlap: float  # in d
    contact_time: float  # from touch to the end of the force, sqrt(d/g)
    dt: float  # step; nan for the adaptive method
    steps: int  # force evaluations
    seconds: float  # run time, without compilation


def _checked_rod(rod: Rod) -> Rod:
    if not isinstance(rod, Rod):
        raise InputError(f"rod must be a md.Rod, got {rod!r}")
    length = number("length", rod.length, 1.0, 1e3, "between 1 and 1000")
    if rod.inertia not in ("solid", "thin"):
        raise InputError(f"inertia must be solid or thin, got {rod.inertia!r}")
    return Rod(length, rod.inertia)


def _checked_law(law: Law | None) -> Law:
    if law is not None and not isinstance(law, Law):
        raise InputError(f"law must be made by a function of md.LAWS, as md.coulomb(), got {law!r}")
    return law or coulomb()


def _numbers(name: str, values: object, count: int) -> tuple:
    """A sequence of so many values."""
    if not isinstance(values, Sequence | np.ndarray) or len(values) != count:
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


def _speed(rod: Rod, tilt: float, velocity: Sequence[float], vibration: Vibration | None) -> float:
    """Velocity with which the lower cap approaches the plate."""
    plate = reference.plate_after(vibration, 0.0)[1]
    return -(velocity[1] + velocity[2] * rod.half_length * sin(tilt) - plate)


def _step(
    law: Law,
    friction: Friction | None,
    speed: float,
    arms: np.ndarray,
    dt: float | None,
    method: str,
    caps: int,
) -> float:
    """The step asked for, or a good one; one that is not stable is refused."""
    if speed < _SLOWEST:
        raise InputError(f"the impact must be at {_SLOWEST:g} sqrt(g d) or faster, got {speed:g}")
    deepest = deepest_overlap(law, speed)
    if not deepest < integrators.DEEP / 2:
        raise InputError(
            f"the plate is too soft for an impact at {speed:g}: overlap {deepest:.2g} d"
        )
    along, across = arms
    largest = largest_step(law, friction is not None, speed, along, across, method, caps)
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


def _plate_table(vibration: Vibration | None, dt: float) -> Motion | None:
    """One period of the plate, step by step; `dt` divides it."""
    if vibration is None:
        return None
    steps = _steps_per_period(vibration, dt)
    angle = 2 * pi * np.arange(steps) / steps + vibration.phase
    speed = 2 * pi * vibration.frequency * vibration.amplitude
    return Motion(vibration.amplitude * np.sin(angle), speed * np.cos(angle))


def _scene(
    rod: Rod,
    law: Law,
    friction: Friction | None,
    gravity: tuple[float, float] | None,
    plate: Motion | None,
) -> Effects:
    upper = True if rod.half_length > 0 else None
    return Effects(
        *(rod.half_length, 1 / rod.gyration_squared, law.normal, friction, gravity, plate, upper)
    )


def _stopped_run(why: int, state: Any, n: int, dt: float, cap: str = "rod 0") -> None:
    """Raise what ended a run before its time."""
    if why == integrators.NOT_FINITE:
        text = f"{cap}: state is not finite after t = {n * dt:g} sqrt(d/g)"
    elif why == integrators.TOO_DEEP:
        text = f"{cap}: sinks deeper than d/2 into the plate at t = {n * dt:g} sqrt(d/g)"
    else:
        return
    raise RunError(f"{text}; dt = {dt:g}", (*state.position, *state.velocity))


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
    """One impact of the lower cap, from its touch to the end of its force.

    Parameters
    ----------
    tilt : from the vertical, rad, -pi/2 to pi/2
    c_x, c_z, omega : velocities at the touch, sqrt(g d) and sqrt(g/d)
    friction : Coulomb coefficient, >= 0; 0: none is simulated, inf: no slip
    rod : length and inertia
    law : contact law; default `coulomb(restitution=0.65)`
    integrator : "leapfrog", "verlet", "gear", or the adaptive "dop853" with located events, which
        follows one cap only
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
    names = ("c_x", "c_z", "omega")
    velocity = tuple(
        number(name, value, -1e6, 1e6, "a number up to 1e6")
        for name, value in zip(names, (c_x, c_z, omega), strict=True)
    )
    vibration, gravity = _checked_vibration(vibration), _checked_gravity(gravity)
    if integrator not in INTEGRATORS:
        raise InputError(f"integrator must be one of {', '.join(INTEGRATORS)}, got {integrator!r}")
    offset = number("offset", offset, 0.0, 1.0, "between 0 and 1")
    speed = _speed(rod, tilt, velocity, vibration)
    if not speed > 0:
        raise InputError(
            f"c_z must bring the contact point towards the plate: it moves away at {-speed:g}"
        )
    rubbing = friction_of(law, friction)
    light = 1 / rod.gyration_squared
    arms = np.array([rod.half_length * cos(tilt) + 0.5, rod.half_length * sin(tilt)])
    flat = rod.half_length * cos(tilt) < deepest_overlap(law, speed)
    method = "leapfrog" if integrator == "dop853" else integrator
    step = _step(law, rubbing, speed, arms**2 * light, dt, method, 2 if flat else 1)
    early, height = vibration, arms[0]
    if vibration is not None:
        step = 1 / (vibration.frequency * _steps_per_period(vibration, step))
        height += vibration.amplitude * sin(vibration.phase)
        early = vibration._replace(
            phase=vibration.phase - 2 * pi * vibration.frequency * offset * step
        )
    plate = _plate_table(early, step)
    scene = _scene(rod, law, rubbing, gravity, plate)
    if integrator == "dop853":
        return _to_the_digits(scene, vibration, rod, tilt, velocity, speed, law, tolerance)
    return _by_steps(scene, vibration, integrator, height, tilt, velocity, speed, law, step, offset)


def _result(
    durations: Any,
    impulses: Any,
    stopped: bool,
    v_f: float,
    speed: float,
    velocity: Any,
    **rest: Any,
) -> Impact:
    regime = 0 if not stopped else 1 if impulses[STUCK] >= impulses[TURNED] else 2
    c_x, c_z, omega = map(float, velocity)
    return Impact(
        c_x=c_x,
        c_z=c_z,
        omega=omega,
        restitution=float(v_f / speed),
        regime=REGIMES[regime],
        phases=dict(zip(PHASES, map(float, durations), strict=True)),
        contact_time=float(sum(durations)),
        **rest,
    )


def _by_steps(
    scene: Effects,
    vibration: Vibration | None,
    method: str,
    height: float,
    tilt: float,
    before: Sequence[float],
    speed: float,
    law: Law,
    dt: float,
    offset: float,
) -> Impact:
    """One impact with a fixed step, whose first begins `offset` steps before the touch."""
    position, velocity = np.array([0.0, height, tilt]), np.array(before)
    fall, early = np.array([*(scene.gravity or (0, 0)), 0.0]), offset * dt
    state = integrators.started(
        method,
        position - early * velocity + early**2 / 2 * fall,
        velocity - early * fall,
        *(scene.gravity, dt),
    )
    watch, most = (
        np.zeros(integrators.WATCHED),
        int(min(_LONGEST * contact_time(law, speed) / dt, 1e9)),
    )

    integrators.run(scene, state, 0, 0, dt, watch)  # compiles
    begin = perf_counter()
    steps, why = 0, DONE
    while why == DONE and steps < most:
        part = min(most - steps, _STEPS_A_CALL)
        now, made, why = integrators.run(scene, state, steps, part, dt, watch)
        state, steps = State(*now), steps + made
    seconds = perf_counter() - begin
    _stopped_run(why, state, steps, dt)
    if why == DONE:
        raise RunError(
            f"the contact has not ended after {steps * dt:g} sqrt(d/g)",
            (*state.position, *state.velocity),
        )
    a_x = -scene.half_length * sin(state.position[2])
    plate = reference.plate_after(vibration, (steps - offset) * dt)[1]
    v_f = state.velocity[1] - state.velocity[2] * a_x - plate
    return _result(
        *(watch[:3], watch[3:6], watch[integrators.STOPPED] > 0, v_f, speed, state.velocity),
        max_overlap=float(watch[integrators.DEEPEST]),
        dt=dt,
        steps=steps,
        seconds=seconds,
    )


def _to_the_digits(
    scene: Effects,
    vibration: Vibration | None,
    rod: Rod,
    tilt: float,
    velocity: Sequence[float],
    speed: float,
    law: Law,
    tolerance: float,
) -> Impact:
    """One impact with every switch located."""
    tolerance = number("tolerance", tolerance, 1e-14, 1e-3, "between 1e-14 and 1e-3")
    longest = _LONGEST * contact_time(law, speed)
    reference.compiled(scene, vibration)
    begin = perf_counter()
    done = reference.follow(scene, vibration, tilt, velocity, tolerance, longest)
    seconds = perf_counter() - begin
    a_x = -rod.half_length * sin(done.position[2])
    plate = reference.plate_after(vibration, done.end)[1]
    v_f = done.velocity[1] - done.velocity[2] * a_x - plate
    return _result(
        *(done.durations, done.impulses, done.stopped, v_f, speed, done.velocity),
        max_overlap=float(done.deepest),
        dt=float("nan"),
        steps=done.evaluations,
        seconds=seconds,
    )
