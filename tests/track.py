"""One rod over the plate for a long time, by the kernel behind `md.impact`."""

import numpy as np

from md import soft_impact as one_rod
from md.kernels import single as integrators
from md.kernels.single import State


def track(scene, start, dt, steps, *, every=1, method="leapfrog"):
    """Every so many steps, where the rod is and how fast it was half a step before.

    Under Gear's method both are of the step before. `scene`: effects; `start`: x, z, tilt, c_x,
    c_z, omega, off the plate or just touching it.
    """
    state = integrators.started(method, start[:3], start[3:], scene.gravity, dt)
    samples = [(*state.position, *state.velocity)]
    for first in range(0, steps, every):
        now, made, why = integrators.run(scene, state, first, every, dt, None)
        state = State(*now)
        one_rod._stopped_run(why, state, first + made, dt)
        samples.append((*state.position, *state.velocity))
    return np.array(samples)
