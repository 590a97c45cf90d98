"""One impact of one rod with the plate by soft contacts: by the steps of rows, or to 13 digits.

"verlet" is the kernel that runs rows and annuli, with one rod. "dop853" is adaptive, with every
switch located as an event: between switches (touch, slip, stick, slip back, end of the force) the
equations are smooth and the method has its full eighth order; each switch is found by integrating
up to it. The unknowns are displacements since the touch, so that the overlap keeps its digits. The
velocities in all forces are those of the moment itself.

Reduced units: lengths in rod diameters d, masses in the rod's, accelerations in g; so velocities
are in sqrt(g d) and times in sqrt(d/g).
"""

from collections.abc import Sequence
from math import atan2, cos, nan, pi, sin
from operator import itemgetter
from time import perf_counter
from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853, solve_ivp
from scipy.optimize import brentq

from .domains import InputError, RunError, held, number
from .host import at_start
from .kernels import (
    BACK,
    DEEP,
    DONE,
    FORWARD,
    FREE,
    FULL_RECORD,
    IMPULSE,
    PHASES,
    REGIMES,
    SLIDE,
    STICK,
    STUCK,
    TURNED,
    WATCH_DEEPEST,
    WATCH_STOPPED,
    WATCHED,
)
from .kernels.march import Watchers, march
from .kernels.state import Clock, Effects
from .kernels.surfaces import rates
from .kernels.touches import AFTER, LAST, new_record, regime_of
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

INTEGRATORS = "verlet", "dop853"
_FINE = 100  # default steps per head-on contact time
_FINEST = 1e8  # largest number of steps of a contact: more would take too long
_SLOWEST = 1e-30  # speed of an impact below which numbers run out
_LEAST_MOVE = 1e3  # of a rod in a step, in units in the last place of its height
_STEPS_A_CALL = 500_000  # some 50 ms: signals are seen between calls
_SWITCHES = 10_000  # of one contact at most; a soft spring that rattles at the end makes hundreds
_MOST = 500_000  # evaluations of one contact: some 10 s
_LARGE = 1e4  # friction beyond which the slip stops too soon after the touch to be followed


class Impact(NamedTuple):
    """Outcome of one impact; velocities after it, in the frame of the plate.

    c_x : along the plate, sqrt(g d)
    c_z : across the plate, sqrt(g d)
    omega : spin, sqrt(g/d)
    restitution : -v_f/v_0 of the contact point that touched first, against the plate
    regime : one of `kernels.REGIMES`
    phases : durations by name in `kernels.PHASES`, sqrt(d/g)
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


class Outcome(NamedTuple):
    """Outcome of one contact."""

    tilt: float  # at the end
    velocity: np.ndarray  # c_x, c_z, omega
    watch: np.ndarray  # columns of a watched contact in `kernels`
    evaluations: int  # of the forces
    seconds: float  # run time, without compilation


# Fixed steps


def _step(law: Law, effects: Effects, speed: float, tilt: float, dt: float | None) -> float:
    """Step asked for, or a good one, in sqrt(d/g); a step that is not stable is refused."""
    if speed < _SLOWEST:
        raise InputError(f"the impact must be at {_SLOWEST:g} sqrt(g d) or faster, got {speed:g}")
    across, along = np.square(lower_end(effects, tilt).arm(tilt)) * effects.inertia.lightness
    caps = 2 if height_of_second(effects, tilt) < 2 * deepest_overlap(law, speed) else 1
    largest = largest_step(law, effects.friction is not None, speed, along, across, caps)
    whole = contact_time(law, speed)
    if dt is None:
        return float(min(whole / _FINE, largest / 4))
    least = whole / _FINEST
    stable = f"{largest:.3g} sqrt(d/g), 1/{whole / largest:.1f} of the contact time {whole:.3g}"
    return number("dt", dt, least, largest, f"between {least:.3g} and {stable}, to be stable")


def _by_steps(
    effects: Effects, place: Sequence[float], velocity: Sequence[float], dt: float, offset: float
) -> Outcome:
    """Follow one contact with a fixed step, from `offset` steps before the touch.

    Parameters
    ----------
    effects : what acts on the rod, the plate included
    place, velocity : (x, z, tilt) and (c_x, c_z, omega) at the touch
    dt, offset : as of `impact`
    """
    x, z, tilt = np.subtract(place, offset * dt * np.array(velocity))
    state = at_start(effects, np.array([[x, z, sin(tilt), cos(tilt), *velocity]]))
    record, steps, why = new_record(1, 1), 0, DONE
    watchers = Watchers(None, record, None)  # which is full after one touch
    march(effects, state, watchers, Clock(0, dt), 0)  # compiles
    begin = perf_counter()
    while why == DONE:
        made, why, _ = march(effects, state, watchers, Clock(steps, dt), _STEPS_A_CALL)
        steps += made
    seconds = perf_counter() - begin
    if why != FULL_RECORD:
        at = f"at t = {steps * dt:g} sqrt(d/g); dt = {dt:g}"
        raise RunError(f"rod 0: {DEEP} d deep in the plate, or not finite, {at}", state.rods[0])
    _, _, sine, cosine, *_, omega = state.rods[0]
    tilt = atan2(sine, cosine) - omega * dt  # the last step was free, and does not count
    return Outcome(
        tilt, record.rows[0, AFTER : AFTER + 3], record.open[0, LAST:], steps - 1, seconds
    )


# Every switch located


class _Contact:
    """Equations of motion of one contact, mode after mode, with a count of evaluations.

    They are integrated over s with t = s^4: the overlap starts as t, so that its roots in the
    force, delta^(3/2) and delta^(1/4), are smooth functions of s where they are not of t.
    """

    def __init__(self, effects: Effects, tilt: float, velocity: Sequence[float], tolerance: float):
        end = lower_end(effects, tilt)  # a corner is a cap of radius 0 at another tilt
        a_x, a_z = end.arm(tilt)
        lean, speed = tilt + end.offset, abs(velocity[1] - velocity[2] * a_x)
        assert effects.normal is not None
        self.setting = effects._replace(half_length=end.reach), (sin(lean), cos(lean), -a_z)
        self.friction = effects.friction
        self.rigid = effects.friction is not None and effects.friction.spring is None
        self.mode, self.evaluations, self.rest = FREE, 0, 0.0
        self.side = 1.0  # of the slip at the touch
        deep = (1.25 * speed * speed / effects.normal.stiffness) ** 0.4
        sizes = np.array([deep, deep, deep, speed, speed, speed, deep, speed])
        self.accuracy = {"rtol": max(tolerance, 3e-14), "atol": tolerance * sizes}
        self.early = (1e-7 * deep / speed) ** 0.25

    def derivative(self, s: float, y: np.ndarray) -> np.ndarray:
        self.evaluations += 1
        return 4 * s**3 * np.array(rates(*self.setting, self.mode, y)[0])

    def signals(self, y: np.ndarray) -> tuple[float, float, float, float]:
        """Signals that fall to zero as the force, the mode, the first slip ends; the overlap."""
        _, (left, spare, overlap, slip) = rates(*self.setting, self.mode, y)
        return left, spare - self.rest, self.side * slip, overlap

    def choose(self, y: np.ndarray) -> None:
        """Choose the next mode: stick where friction can hold, else slip the way that it gives."""
        if self.friction is None:
            return
        before, self.mode = self.mode, STICK
        change, (_, spare, _, slip) = rates(*self.setting, self.mode, y)
        if before == FREE and slip != 0 and self.rigid:
            self.mode = FORWARD if slip > 0 else BACK
        elif before == STICK or (spare < 0 and (self.rigid or before == FREE)):
            self.mode = BACK if change[3] > 0 else FORWARD
        # else it sticks: of a slider, the force has come down from its limit
        self.rest = 0.0
        self.rest = min(self.signals(y)[1], 0.0)  # error of the location where a mode begins

    def stepped(self, s: float, y: np.ndarray, end: float) -> np.ndarray:
        """State at `end`, integrated from s, at most one step away."""
        if not end > s:
            return y
        steps = solve_ivp(
            self.derivative, (s, end), y, "DOP853", first_step=end - s, **self.accuracy
        )
        return steps.y[:, -1]

    def located(self, solver: DOP853, which: int, end: float) -> tuple[float, np.ndarray]:
        """Place s and state at which signal `which` falls to zero in the step just made.

        A mode may begin where its signal is zero: the zero wanted is a later one.
        """
        s, y = solver.t_old, solver.y_old

        def signal(x: float) -> float:
            return self.signals(self.stepped(s, y, x))[which]

        starts = (s, *(s + (end - s) / 2**k for k in range(1, 30)))
        start = next((x for x in starts if signal(x) > 0), None)
        if start is None:
            return s, y
        if signal(end) <= 0:
            end = brentq(signal, start, end, xtol=1e-18, rtol=1e-15, maxiter=1000)  # also of a jump
        return end, self.stepped(s, y, end)

    def first(
        self, solver: DOP853, signals: tuple[float, ...], others: tuple[int, ...]
    ) -> tuple[float, np.ndarray, int]:
        """Place s, state and number of the signal that is the first to fall to zero in a step.

        Beyond the end of the force the other signals have no meaning.
        """
        end, places = solver.t, []
        if signals[0] < 0:
            end, y = self.located(solver, 0, end)
            signals, places = self.signals(y), [(end, y, 0)]
        places += [(*self.located(solver, i, end), i) for i in others if signals[i] < 0]
        return min(places, key=itemgetter(0))


def follow(
    effects: Effects,
    tilt: float,
    velocity: Sequence[float],
    tolerance: float = 1e-13,
) -> Outcome:
    """Integrate one contact of the lower cap or corner from its touch to the end of its force.

    Parameters
    ----------
    effects : `kernels.state.Effects`, on a plate at rest and without gravity
    tilt : at the touch, rad
    velocity : (c_x, c_z, omega) at the touch
    tolerance : relative, of each step; 1e-13 is where rounding begins

    Raises
    ------
    ValueError
        If another cap or corner touches too, or a tangential spring has no dashpot beside it.
    RunError
        If friction switches without an end, or a dashpot is too stiff.
    """
    spring = effects.friction.spring if effects.friction else None
    if spring and not any(spring[2:]):  # its dashpots
        raise InputError("dop853 needs a dashpot beside the tangential spring")
    contact = _Contact(effects, tilt, velocity, tolerance)
    s, y = 0.0, np.array([0.0, 0.0, 0.0, *velocity, 0.0, 0.0])
    contact.signals(y)  # compiles
    start = perf_counter()
    contact.choose(contact.stepped(s, y, contact.early))
    contact.side = np.sign(contact.signals(y)[2])
    stopped, watch = contact.side == 0, np.zeros(WATCHED)
    for _ in range(_SWITCHES):
        begin, pushed = s, y[7]
        solver = DOP853(contact.derivative, s, y, np.inf, **contact.accuracy)
        others: tuple[int, ...] = (1,) if stopped or contact.rigid else (1, 2)
        going = True
        while going:
            if solver.step() or contact.evaluations > _MOST:
                raise RunError("dop853 cannot follow so stiff a contact; verlet can")
            signals = left, *_, overlap = contact.signals(solver.y)
            watch[WATCH_DEEPEST] = max(watch[WATCH_DEEPEST], overlap)
            if overlap > height_of_second(effects, tilt + solver.y[2]):
                raise InputError(
                    "dop853 follows one cap or corner, and here the second touches the plate"
                )
            going = left >= 0 and all(signals[i] >= 0 for i in others)
        if left < 0 and solver.t - begin < 1e-5 * solver.t:
            others = ()  # the spring rattles as the force ends: a last 1e-10 of its impulse
        s, y, which = contact.first(solver, signals, others)
        phase = SLIDE if not stopped else STUCK if contact.mode == STICK else TURNED
        watch[phase] += s**4 - begin**4
        watch[IMPULSE + phase] += y[7] - pushed
        if which == 0:
            break
        if which == 1:
            contact.choose(y)
        stopped = stopped or which == 2 or contact.rigid
    else:
        raise RunError(f"the contact has switched {_SWITCHES} times without an end")
    watch[WATCH_STOPPED] = stopped
    return Outcome(tilt + y[2], y[3:6], watch, contact.evaluations, perf_counter() - start)


# Either


def impact(
    tilt: float,
    c_x: float,
    c_z: float,
    omega: float = 0.0,
    *,
    friction: float,
    rod: Rod = Rod(),  # noqa: B008  (immutable)
    law: Law | None = None,
    integrator: str = "verlet",
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
    integrator : "verlet", the fixed steps of rows, or the adaptive "dop853" with located events,
        which follows one cap or corner only, with a friction up to 10,000
    dt : step, sqrt(d/g); default a hundredth of the contact time or a quarter of the stable step
    offset : part of a step that is left at the first step until the touch, 0 to 1; "dop853", which
        begins at the touch, makes no use of it
    tolerance : of "dop853", relative, per step, 1e-14 to 1e-3, default 1e-13

    Raises
    ------
    ValueError
        If an argument is out of its domain or has no meaning, the contact point does not approach
        the plate, the step is not stable or the plate too soft.
    RunError
        If the state stops being finite, the overlap exceeds d/2, or friction switches without an
        end.
    """
    rod = held("rod", rod, Rod)
    law = coulomb() if law is None else held("law", law, Law)
    tilt = number("tilt", tilt, -pi / 2, pi / 2, "between -pi/2 and pi/2")
    given = {"c_x": c_x, "c_z": c_z, "omega": omega}
    velocity = tuple(number(name, value, -1e6, 1e6) for name, value in given.items())
    if integrator not in INTEGRATORS:
        raise InputError(f"integrator must be one of {', '.join(INTEGRATORS)}, got {integrator!r}")
    adaptive = integrator == "dop853"
    useless, value = ("dt", dt) if adaptive else ("tolerance", tolerance)
    if value is not None:
        raise InputError(f"{useless} has no meaning under {integrator}, got {value!r}")
    offset = number("offset", offset, 0.0, 1.0)
    effects = effects_of(rod, law, friction, None, None)
    if adaptive and friction > _LARGE:
        raise InputError(f"friction must be at most {_LARGE:g} under dop853, got {friction!r}")
    end = lower_end(effects, tilt)
    a_x, a_z = end.arm(tilt)
    speed = -(velocity[1] - velocity[2] * a_x)
    if not speed > 0:
        raise InputError(
            f"c_z must bring the contact point towards the plate: it moves away at {-speed:g}"
        )
    step = _step(law, effects, speed, tilt, dt)
    if adaptive:
        tolerance = number("tolerance", 1e-13 if tolerance is None else tolerance, 1e-14, 1e-3)
        done = follow(effects, tilt, velocity, tolerance)
        step = nan
    else:
        if speed < (slowest := _LEAST_MOVE * np.spacing(-a_z) / step):
            raise InputError(
                f"the impact must be at {slowest:.2g} sqrt(g d) or faster at dt = {step:.3g}, or "
                f"under dop853; got {speed:g}"
            )
        done = _by_steps(effects, (0.0, -a_z, tilt), velocity, step, offset)
    c_x, c_z, omega = map(float, done.velocity)
    v_f = c_z - omega * end.arm(done.tilt)[0]
    durations = done.watch[:IMPULSE]
    return Impact(
        c_x,
        c_z,
        omega,
        restitution=v_f / speed,
        regime=REGIMES[regime_of(done.watch)],
        phases=dict(zip(PHASES, durations.tolist(), strict=True)),
        max_overlap=float(done.watch[WATCH_DEEPEST]),
        contact_time=float(sum(durations)),
        dt=step,
        steps=done.evaluations,
        seconds=done.seconds,
    )
