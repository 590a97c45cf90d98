"""One rod over the plate for a long time, by the kernel behind `md.impact`."""

import numpy as np

from md.kernels import single
from md.kernels.single import State
from md.soft_impact import stopped_run


def track(scene, start, dt, steps, *, every=1, method="leapfrog"):
    """Every so many steps, where the rod is and how fast it was half a step before.

    Under Gear's method both are of the step before. `scene`: effects; `start`: x, z, tilt, c_x,
    c_z, omega, off the plate or just touching it.
    """
    state = single.started(method, start[:3], start[3:], scene.gravity, dt)
    samples = [(*state.position, *state.velocity)]
    for first in range(0, steps, every):
        now, made, why = single.run(scene, state, first, every, dt, None)
        state = State(*now)
        stopped_run(why, state, first + made, dt)
        samples.append((*state.position, *state.velocity))
    return np.array(samples)
