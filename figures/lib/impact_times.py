"""How long one soft impact takes: the compiled call, many times over, without Python around it."""

from collections.abc import Callable
from math import cos

import numpy as np

import md
from impact import compiled
from md.cache import kernel
from md.kernels import single as integrators
from md.kernels.codes import WATCHED
from md.kernels.single import run
from md.rod import effects_of

from .soft_impacts import APPROACH_RATIO, IMPACT_FRICTION, ROD, TABLE_TILTS, arms
from .timing import medians, repeated

MOST_STEPS = 10**9  # the contact ends long before


@kernel(inline=False)
def repeated_impact(effects, state, dt, times, watch):
    """The same impact `times` times over; velocity after the last one, and its steps."""
    velocity, steps = state.velocity, 0
    for _ in range(times):
        for i in range(WATCHED):
            watch[i] = 0.0
        after, steps, _ = run(effects, state, 0, MOST_STEPS, dt, watch)
        velocity = after[2]
    return velocity, steps


def impact_call(tilt: float, law: md.Law, integrator: str, dt: float):
    """The impact of `soft_impacts.simulate`, as often as asked; touch in the middle of a step."""
    effects = effects_of(ROD, law, IMPACT_FRICTION, None, None)
    position = np.array([0.0, ROD.half_length * cos(tilt) + 0.5, tilt])
    velocity = np.array([1 / APPROACH_RATIO, -1.0, 0.0])
    start = position - dt / 2 * velocity
    state, watch = integrators.started(integrator, start, velocity, None, dt), np.zeros(WATCHED)
    return lambda times=1: repeated_impact(effects, state, dt, times, watch)


def price(calls: list[Callable], runs: int) -> tuple[np.ndarray, np.ndarray]:
    """Seconds and steps of the impacts of `impact_call`: medians of `runs` samples in turn."""
    return medians(calls, runs), np.array([call()[1] for call in calls])


def rigid_seconds(runs: int, n: int = 20_000) -> float:
    """Of one impact by the compiled rigid map, in arrays."""
    rods = arms(np.resize(TABLE_TILTS, n))
    how = {"geometry": rods, "friction": IMPACT_FRICTION, "restitution": 0.65}
    call = repeated(lambda: compiled.collide(1 / APPROACH_RATIO, -1.0, **how))
    return float(medians([call], runs)[0] / n)
