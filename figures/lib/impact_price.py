"""What one soft impact costs: the compiled call, many times over, without Python around it."""

from collections.abc import Callable
from math import cos
from statistics import median
from time import perf_counter

import numpy as np

import md
from impact import ContactGeometry, compiled
from md.cache import kernel
from md.kernels import single as integrators
from md.kernels.codes import WATCHED
from md.kernels.single import run
from md.rod import effects_of

from .soft_impacts import APPROACH_RATIO, FRICTION, ROD, TILTS

LONG_ENOUGH = 1e-3  # seconds of one sample
MOST = 10**9  # steps: the contact ends long before


@kernel(inline=False)
def repeated(effects, state, dt, times, watch):
    """The same impact `times` times over; velocity after the last one, and its steps."""
    velocity, steps = state.velocity, 0
    for _ in range(times):
        for i in range(WATCHED):
            watch[i] = 0.0
        after, steps, _ = run(effects, state, 0, MOST, dt, watch)
        velocity = after[2]
    return velocity, steps


def impact_call(tilt: float, law: md.Law, integrator: str, dt: float, speed: float = 1.0):
    """The impact of `soft.simulate` as a function of how often; touch in the middle of a step."""
    effects = effects_of(ROD, law, FRICTION, None, None)
    position = np.array([0.0, ROD.half_length * cos(tilt) + 0.5, tilt])
    velocity = np.array([speed / APPROACH_RATIO, -speed, 0.0])
    start = position - dt / 2 * velocity
    state, watch = integrators.started(integrator, start, velocity, None, dt), np.zeros(WATCHED)
    return lambda times=1: repeated(effects, state, dt, times, watch)


def price(calls: list[Callable], runs: int) -> tuple[np.ndarray, np.ndarray]:
    """Seconds and steps of each call: medians of `runs` samples, taken in turn."""
    steps, often = [], []
    for call in calls:
        call()  # compiles
        start = perf_counter()
        steps.append(call()[1])
        often.append(max(1, round(LONG_ENOUGH / (perf_counter() - start))))
    samples = []
    for _ in range(runs):
        samples.append([])
        for call, times in zip(calls, often, strict=True):
            start = perf_counter()
            call(times)
            samples[-1].append((perf_counter() - start) / times)
    return np.array([median(of_one) for of_one in zip(*samples, strict=True)]), np.array(steps)


def rigid_seconds(runs: int, n: int = 20_000) -> float:
    """Of one impact by the compiled rigid map, in arrays."""
    tilt = np.resize(TILTS, n)
    half, k = ROD.half_length, np.sqrt(ROD.gyration_squared)
    arms = ContactGeometry(half * np.sin(tilt), half * np.cos(tilt) + 0.5, k)

    def call(_=1):
        compiled.collide(
            1 / APPROACH_RATIO, -1.0, geometry=arms, friction=FRICTION, restitution=0.65
        )
        return None, n

    return price([call], runs)[0][0] / n
