"""One contact to the last digits: adaptive DOP853 with every switch located as an event.

Between switches (touch, slip, stick, slip back, end of the force) the equations are smooth and the
method has its full eighth order; each switch is found by integrating up to it. The unknowns are
displacements since the touch, so that the overlap keeps its digits. The velocities in all forces
are those of the moment itself.
"""

from collections.abc import Sequence
from math import cos, sin
from time import perf_counter
from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

from .domains import InputError, RunError
from .kernels.codes import BACK, FORWARD, FREE, SLIDE, STICK, STUCK, TURNED
from .kernels.single import rates
from .kernels.state import Effects
from .laws import height_of_second, lower_end

_SWITCHES = 10_000  # of one contact at most; a soft spring that rattles at the end makes hundreds
LARGE = 1e4  # friction beyond which the slip stops too soon after the touch to be followed


class Outcome(NamedTuple):
    """Outcome of one contact; durations and normal impulses of its phases (see `codes`)."""

    position: Sequence[float] | np.ndarray  # x, z, tilt at the end
    velocity: Sequence[float] | np.ndarray  # c_x, c_z, omega
    durations: Sequence[float] | np.ndarray  # of the phases, sqrt(d/g)
    impulses: Sequence[float] | np.ndarray  # normal impulses of the phases, m sqrt(g d)
    stopped: bool  # whether the slip stopped at all
    deepest: float  # overlap, d
    evaluations: int  # of the forces
    seconds: float  # run time, without compilation


class _Contact:
    """Equations of motion of one contact, mode after mode, with a count of evaluations.

    They are integrated over s with t = s^4: the overlap starts as t, so that its roots in the
    force, delta^(3/2) and delta^(1/4), are smooth functions of s where they are not of t.
    """

    def __init__(
        self,
        effects: Effects,
        tilt: float,
        speed: float,
        tolerance: float,
    ):
        end = lower_end(effects, tilt)  # a corner is a cap of radius 0 at another tilt
        lean, height = tilt + end.offset, -end.arm(tilt)[1]
        assert effects.normal is not None
        longer = effects._replace(half_length=end.reach)
        self.setting = longer, (sin(lean), cos(lean), height)
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
        out = np.empty(8)
        rates(*self.setting, self.mode, y, out)
        return 4 * s**3 * out

    def signals(self, y: np.ndarray) -> tuple[float, float, float, float]:
        """Signals that fall to zero as the force, the mode, the first slip ends; the overlap."""
        left, spare, overlap, slip = rates(*self.setting, self.mode, y, np.empty(8))
        return left, spare - self.rest, self.side * slip, overlap

    def choose(self, y: np.ndarray) -> None:
        """Choose the next mode: stick where friction can hold, else slip the way that it gives."""
        if self.friction is None:
            return
        before, self.mode = self.mode, STICK
        out = np.empty(8)
        _, spare, _, slip = rates(*self.setting, STICK, y, out)
        if before == FREE and slip != 0 and self.friction.spring is None:
            self.mode = FORWARD if slip > 0 else BACK
        elif before in (FORWARD, BACK) and self.friction.spring is not None:
            pass  # the force came down from its limit
        elif before == STICK or spare < 0:
            self.mode = BACK if out[3] > 0 else FORWARD
        self.rest = 0.0
        self.rest = min(self.signals(y)[1], 0.0)  # error of the location where a mode begins

    def solver(self, s: float, y: np.ndarray, end: float = np.inf, **steps: float) -> DOP853:
        return DOP853(self.derivative, s, y, end, **steps, **self.accuracy)

    def stepped(self, s: float, y: np.ndarray, end: float) -> np.ndarray:
        """State at `end`, integrated from s, at most one step away."""
        if not end > s:
            return y
        solver = self.solver(s, y, end, first_step=end - s)
        while solver.status == "running":
            solver.step()
        return solver.y

    def located(self, solver: DOP853, which: int, end: float) -> tuple[float, np.ndarray]:
        """Place s and state at which signal `which` falls to zero in the step just made.

        A mode may begin where its signal is zero: the zero wanted is a later one.
        """
        s, y, dense = solver.t_old, solver.y_old, solver.dense_output()

        def signal(x: float) -> float:
            return self.signals(dense(x))[which]

        starts = (s, *(s + (end - s) / 2**k for k in range(1, 30)))
        start = next((x for x in starts if signal(x) > 0), None)
        if start is None:
            return s, y
        if signal(end) > 0:
            return end, self.stepped(s, y, end)
        root, width = brentq(signal, start, end, xtol=1e-18, rtol=1e-15), 1e-3 * (end - s)
        for _ in range(2):  # the interpolant is of lower order than the step
            slope = (signal(root) - signal(root - width)) / width
            error = self.signals(self.stepped(s, y, root))[which] / slope
            root = min(max(root - error, s), end)
        return root, self.stepped(s, y, root)

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
        return min(places, key=lambda place: place[0])


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
        If another cap or corner touches too, a tangential spring has no dashpot beside it, or the
        coefficient of friction is beyond LARGE.
    RunError
        If friction switches without an end.
    """
    spring = effects.friction.spring if effects.friction else None
    if spring and not any(spring[2:]):  # its dashpots
        raise InputError("dop853 needs a dashpot beside the tangential spring")
    if effects.friction and effects.friction.coefficient > LARGE:
        raise InputError(f"dop853 needs a friction of at most {LARGE:g}")
    a_x = lower_end(effects, tilt).arm(tilt)[0]
    speed = abs(velocity[1] - velocity[2] * a_x)
    contact = _Contact(effects, tilt, speed, tolerance)
    s, y = 0.0, np.array([0.0, 0.0, 0.0, *velocity, 0.0, 0.0])
    contact.signals(y)  # compiles
    start = perf_counter()
    contact.choose(contact.stepped(s, y, contact.early))
    contact.side = np.sign(contact.signals(y)[2])
    stopped, which, deepest = contact.side == 0, 1, 0.0
    durations, impulses, switches = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0
    while which != 0:
        if switches == _SWITCHES:
            raise RunError(f"the contact has switched {switches} times without an end")
        switches += 1
        begin, pushed, solver = s, y[7], contact.solver(s, y)
        others: tuple[int, ...] = (1,) if stopped or contact.rigid else (1, 2)
        going = True
        while going:
            solver.step()
            signals = left, *_, overlap = contact.signals(solver.y)
            deepest = max(deepest, overlap)
            if effects.upper and overlap > height_of_second(effects, tilt + solver.y[2]):
                raise InputError(
                    "dop853 follows one cap or corner, and here the second touches the plate"
                )
            going = left >= 0 and all(signals[i] >= 0 for i in others)
        if left < 0 and solver.t - begin < 1e-5 * solver.t:
            others = ()  # the spring rattles as the force ends: a last 1e-10 of its impulse
        s, y, which = contact.first(solver, signals, others)
        phase = SLIDE if not stopped else STUCK if contact.mode == STICK else TURNED
        durations[phase] += s**4 - begin**4
        impulses[phase] += y[7] - pushed
        if which == 1:
            contact.choose(y)
        stopped = stopped or which == 2 or (which == 1 and contact.rigid)
    position = np.array([y[0], contact.setting[1][2] + y[1], tilt + y[2]])
    calls, seconds = contact.evaluations, perf_counter() - start
    return Outcome(position, y[3:6], durations, impulses, stopped, deepest, calls, seconds)
