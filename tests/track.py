"""One rod over the plate: laws, effects, and long runs."""

from math import radians

import numpy as np
import pytest

import md
from md.host import at_start
from md.kernels import DONE
from md.kernels.march import Watchers, march
from md.kernels.state import Clock
from md.laws import contact_time, effects_of

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
each_case = pytest.mark.parametrize("case", [SLIDE, SLIP_STICK, REVERSAL])
CONTACT = contact_time(md.coulomb(), 1.0)


def impact_of(case, law, **how):
    """One soft impact of the paper's rod at this tilt and these velocities, with friction 0.4."""
    tilt, velocity = case
    return md.impact(tilt, *velocity, friction=0.4, law=law, **how)


def damped(normal):
    """The same normal force with a dashpot, of zero if there is none: laws share a kernel."""
    return normal._replace(quarter=normal.quarter or 0.0)


def effects(law, friction=0.0, gravity=None, plate=None, rod=ROD):
    """What acts on a rod; the plate is at rest unless it has a `Motion`."""
    return effects_of(rod, law, friction, gravity, plate)


def alone(acting, start):
    """State of one rod at (x, z, tilt, c_x, c_z, omega), its velocities of half a step before."""
    x, z, tilt, *velocity = start
    return at_start(acting, np.array([[x, z, np.sin(tilt), np.cos(tilt), *velocity]], float))


def stepped(acting, state, dt, steps, first=0):
    """Make steps of `alone` rods that nobody watches: how many were made, and why they ended."""
    return march(acting, state, Watchers(None, None, None), Clock(first, dt), steps)[:2]


def seen(state):
    """The rod as (x, z, tilt, c_x, c_z, omega)."""
    x, z, sine, cosine, *velocity = state.rods[0]
    return np.array([x, z, np.arctan2(sine, cosine), *velocity])


def track(acting, start, dt, steps, *, every=1):
    """Every so many steps, where the rod is and how fast it was half a step before.

    `acting`: effects; `start`: as of `alone` but for velocities at the start itself, off the plate
    or just touching it.
    """
    fall = acting.gravity or (0.0, 0.0)
    state = alone(acting, start - dt / 2 * np.array([0, 0, 0, *fall, 0]))
    samples = [seen(state)]
    for first in range(0, steps, every):
        assert stepped(acting, state, dt, every, first) == (every, DONE)
        samples.append(seen(state))
    return np.array(samples)
