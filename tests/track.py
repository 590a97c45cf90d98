"""One rod over the plate: laws, effects, and long runs by the kernel behind `md.impact`."""

from math import pi, radians

import numpy as np
import pytest

import md
from md.kernels import single
from md.kernels.codes import WATCHED
from md.kernels.state import Motion
from md.laws import contact_time, effects_of
from md.soft_impact import stopped_run

ROD = md.Rod()
LAWS = {
    "coulomb": md.coulomb(),
    "elastic": md.coulomb(1.0),
    "constant_restitution": md.constant_restitution(),
    "appendix_a": md.appendix_a(),
}
SLIDE = radians(30), (-0.5, -1.0, 0.1)  # tilt, velocities before
SLIP_STICK = radians(20), (0.5, -1.0, 0.0)
REVERSAL = radians(40), (0.5, -1.0, 0.0)
CONTACT = contact_time(md.coulomb(), 1.0)
each_integrator = pytest.mark.parametrize("integrator", single.METHODS)


def damped(normal):
    """The same normal force with a dashpot, of zero if there is none: laws share a kernel."""
    return normal._replace(quarter=normal.quarter or 0.0)


def effects(law, friction=0.0, gravity=None, plate=None, rod=ROD):
    """What acts on a rod; the plate is at rest unless it has a `Motion`."""
    return effects_of(rod, law, friction, gravity, plate)


def swinging(amplitude, steps):
    """Motion of a plate at amplitude sin(2 pi t), so many steps a period."""
    angle = 2 * pi * np.arange(steps) / steps
    return Motion(amplitude * np.sin(angle), 2 * pi * amplitude * np.cos(angle))


def track(acting, start, dt, steps, *, every=1, method="leapfrog", watched=False):
    """Every so many steps, where the rod is and how fast it was half a step before.

    Under Gear's method both are of the step before. `acting`: effects; `start`: x, z, tilt, c_x,
    c_z, omega, off the plate or just touching it. `watched`: by the kernel of `md.impact`, step by
    step, so that a contact that is over ends nothing.
    """
    fall = (*(acting.gravity or (0.0, 0.0)), 0.0)
    state = single.started(method, start[:3], start[3:], dt, fall)
    samples = [(*state.position, *state.velocity)]
    for first in range(0, steps, every):
        watch = np.zeros(WATCHED) if watched else None
        now, made, why = single.run(acting, state, first, every, dt, watch)
        state = single.State(*now)
        stopped_run(why, state, first + made, dt)
        samples.append((*state.position, *state.velocity))
    return np.array(samples)
