"""A single impact of one rod with the plate, by soft contacts.

Reduced units: lengths in rod diameters d, masses in the rod's, accelerations in g; so velocities
are in sqrt(g d) and times in sqrt(d/g).
"""

from math import nan, pi
from time import perf_counter
from typing import NamedTuple

import numpy as np

from . import reference
from .domains import InputError, RunError, held, number, positive
from .kernels import single
from .kernels.codes import (
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
from .kernels.state import Effects
from .kernels.touches import regime_of
from .laws import (
    Law,
    Rod,
    contact_time,
    coulomb,
    deepest_overlap,
    effects_of,
    height_of_second,
    largest_step,
    lower_end,
)
from .reference import Outcome

INTEGRATORS = (*single.METHODS, "dop853")
_ROUGH = 10.0  # friction as a constraint beyond which Gear's method, which predicts slip, is wrong
_FINE = 100  # default steps per head-on contact time
_FINEST = 1e8  # largest number of steps of a contact: more would take too long
_SLOWEST = 1e-30  # speed of an impact below which numbers run out
_STEPS_A_CALL = 10**6  # some 50 ms: signals are seen between calls


class Impact(NamedTuple):
    """Outcome of one impact; velocities after it, in the frame of the plate.

    c_x : along the plate, sqrt(g d)
    c_z : across the plate, sqrt(g d)
    omega : spin, sqrt(g/d)
    restitution : -v_f/v_0 of the contact point that touched first, against the plate
    regime : one of `kernels.codes.REGIMES`
    phases : durations by name in `kernels.codes.PHASES`, sqrt(d/g)
    max_overlap : deepest overlap, d
    contact_time : from touch to the end of the force, sqrt(d/g)
    dt : step, sqrt(d/g); nan for the adaptive method
    steps : force evaluations
    seconds : run time, s, without compilation
    """

    c_x: float
    c_z: float
    omega: float
    restitution: float
    regime: str
    phases: dict[str, float]
    max_overlap: float
    contact_time: float
    dt: float
    steps: int
    seconds: float


def _step(
    law: Law, effects: Effects, speed: float, tilt: float, dt: float | None, method: str
) -> float:
    """Step asked for, or a good one, in sqrt(d/g); a step that is not stable is refused."""
    if speed < _SLOWEST:
        raise InputError(f"the impact must be at {_SLOWEST:g} sqrt(g d) or faster, got {speed:g}")
    across, along = np.square(lower_end(effects, tilt).arm(tilt)) * effects.lightness
    caps = 2 if height_of_second(effects, tilt) < 2 * deepest_overlap(law, speed) else 1
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


def stopped_run(why: int, state: single.State, steps: int, dt: float) -> None:
    """Raise `RunError` if a run of one rod ended by a state that is not finite or too deep."""
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
    tolerance: float | None = None,
) -> Impact:
    """Simulate one impact of the lower cap or corner, from its touch to the end of its force.

    The plate is at rest and gravity is left out: a plate that moves is one at rest in its frame.

    Parameters
    ----------
    tilt : from the vertical, rad, -pi/2 to pi/2
    c_x, c_z, omega : velocities at the touch, sqrt(g d) and sqrt(g/d)
    friction : Coulomb coefficient, >= 0; 0: none is simulated, inf: no slip
    rod : length, inertia and ends
    law : contact law; default `coulomb(restitution=0.65)`
    integrator : "leapfrog", "verlet", "gear", or the adaptive "dop853" with located events, which
        follows one cap or corner only; "gear" takes no plastic contact, and friction as a
        constraint up to 10
    dt : step, sqrt(d/g); default a hundredth of the contact time or a quarter of the stable step
    offset : part of a step that is left at the first step until the touch, 0 to 1
    tolerance : of "dop853", relative, per step, 1e-14 to 1e-3, default 1e-13

    Raises
    ------
    ValueError
        If an argument is out of its domain or has no meaning, the contact point does not approach
        the plate, the step is not stable or the plate too soft.
    RunError
        If the state stops being finite, or friction switches without an end.
    """
    rod = held("rod", rod, Rod)
    law = coulomb() if law is None else held("law", law, Law)
    tilt = number("tilt", tilt, -pi / 2, pi / 2, "between -pi/2 and pi/2")
    given = {"c_x": c_x, "c_z": c_z, "omega": omega}
    velocity = tuple(number(name, value, -1e6, 1e6) for name, value in given.items())
    if integrator not in INTEGRATORS:
        raise InputError(f"integrator must be one of {', '.join(INTEGRATORS)}, got {integrator!r}")
    useless, value = ("dt", dt) if integrator == "dop853" else ("tolerance", tolerance)
    if value is not None:
        raise InputError(f"{useless} has no meaning under {integrator}, got {value!r}")
    offset = number("offset", offset, 0.0, 1.0)
    effects = effects_of(rod, law, friction, None, None)
    if integrator == "gear":
        if law.normal.plastic:
            raise InputError("gear needs a restitution above 0, got a plastic contact")
        if law.spring is None and friction > _ROUGH:
            limit = f"at most {_ROUGH:g} under gear, as a constraint"
            raise InputError(f"friction must be {limit}, got {friction!r}")
    end = lower_end(effects, tilt)
    speed = -(velocity[1] - velocity[2] * end.arm(tilt)[0])
    if not speed > 0:
        raise InputError(
            f"c_z must bring the contact point towards the plate: it moves away at {-speed:g}"
        )
    method = "leapfrog" if integrator == "dop853" else integrator
    step = _step(law, effects, speed, tilt, dt, method)
    if integrator == "dop853":
        tolerance = number("tolerance", 1e-13 if tolerance is None else tolerance, 1e-14, 1e-3)
        done = reference.follow(effects, tilt, velocity, tolerance)
        step = nan
    else:
        position = np.array([0.0, -end.arm(tilt)[1], tilt])
        done = _by_steps(effects, position, np.array(velocity), integrator, step, offset)
    c_x, c_z, omega = map(float, done.velocity)
    v_f = c_z - omega * end.arm(done.position[2])[0]
    stuck, turned = done.impulses[STUCK], done.impulses[TURNED]
    return Impact(
        c_x=c_x,
        c_z=c_z,
        omega=omega,
        restitution=float(v_f / speed),
        regime=REGIMES[regime_of(done.stopped, stuck, turned)],
        phases=dict(zip(PHASES, map(float, done.durations), strict=True)),
        max_overlap=float(done.deepest),
        contact_time=float(sum(done.durations)),
        dt=step,
        steps=done.evaluations,
        seconds=done.seconds,
    )


def _by_steps(
    effects: Effects,
    position: np.ndarray,
    velocity: np.ndarray,
    method: str,
    dt: float,
    offset: float,
) -> Outcome:
    """Follow one contact with a fixed step, from `offset` steps before the touch.

    Parameters
    ----------
    effects : what acts on the rod, the plate included
    position, velocity : at the touch
    method, dt, offset : as of `impact`
    """
    state = single.started(method, position - offset * dt * velocity, velocity, dt)
    watch, steps, why = np.zeros(WATCHED), 0, DONE
    single.run(effects, state, 0, 0, dt, watch)  # compiles
    begin = perf_counter()
    while why == DONE:
        now, made, why = single.run(effects, state, steps, _STEPS_A_CALL, dt, watch)
        state, steps = single.State(*now), steps + made
    stopped_run(why, state, steps, dt)
    return Outcome(
        state.position,
        state.velocity,
        durations=watch[:IMPULSE],
        impulses=watch[IMPULSE : 2 * IMPULSE],
        stopped=watch[WATCH_STOPPED] > 0,
        deepest=watch[WATCH_DEEPEST],
        evaluations=steps,
        seconds=perf_counter() - begin,
    )
