"""Rods in space for the tests, marched by the kernel without a host."""

import numpy as np

import md
from md.host import at_start
from md.kernels.codes import ANNULUS_LEDGER, DONE, PLACE, SPACE_COLUMNS, TURN, VELOCITY
from md.kernels.contact import ContactForces, Friction, Normal
from md.kernels.energy import energy
from md.kernels.march import Watchers, march
from md.kernels.neighbours import renewed
from md.kernels.state import Clock, Effects, Motion, Wall
from md.kernels.touches import new_record
from md.kernels.vectors import IN_SPACE

HALF, LIGHT = 4.25, 12 / 9.5**2
LOSSY = md.constant_restitution(0.65, 1e5, tangential_ratio=3)
ROUGH = Friction(0.3, LOSSY.spring)
SMOOTH, ELASTIC = ROUGH._replace(coefficient=0.0), Normal(1e5, 0.0)
NOBODY = Watchers(None, None, None)
FAR = {  # what nothing touches, nor pulls: the kernel of an annulus serves most tests
    **{"gravity": 0.0, "plate": Motion(np.full(1, -1e3), np.zeros(1))},
    **{"normal": LOSSY.normal, "friction": ROUGH, "between": ContactForces(LOSSY.normal, ROUGH)},
    **{"inner": Wall(1.0, LOSSY.normal, ROUGH), "outer": Wall(1e3, LOSSY.normal, ROUGH)},
}


def effects(half_length=HALF, lightness=LIGHT, **parts):
    """Nothing but what is named."""
    upper = True if half_length > 0 else None
    return Effects(half_length, lightness, upper=upper, up=IN_SPACE, **parts)


def within(**parts):
    """An annulus; what is not named is far away."""
    return effects(**FAR | parts)


def meeting(normal=LOSSY.normal, friction=ROUGH, rolling=None):
    """Rods that only meet each other."""
    return effects(between=ContactForces(normal, friction), rolling=rolling)


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v)


def tuples(*vectors):
    return [tuple(map(float, v)) for v in vectors]


def states(*rods):
    """States of rods, each (place, director, velocity): the director is made a unit vector."""
    found = np.zeros((len(rods), SPACE_COLUMNS))
    for rod, (place, director, *velocity) in zip(found, rods, strict=True):
        rod[:VELOCITY] = *place, *unit(director)
        rod[VELOCITY:TURN] = velocity[0] if velocity else 0.0
    return found


class Rods:
    """Rods under way."""

    def __init__(self, scene, rods, dt=1e-4, kernel=march, watched=False):
        n, self.effects, self.dt, self.step, self.kernel = len(rods), scene, dt, 0, kernel
        self.state = at_start(scene, rods)
        record = new_record(n, 4096) if scene.normal else None
        self.watchers = Watchers(np.zeros(ANNULUS_LEDGER), record, None) if watched else NOBODY

    @property
    def rods(self):
        return self.state.rods

    def march(self, steps):
        """Steps made, and why they ended."""
        clock = Clock(self.step, self.dt)
        done, why, _ = self.kernel(self.effects, self.state, self.watchers, clock, steps)
        self.step += done
        return done, why

    def go(self, steps):
        assert self.march(steps) == (steps, DONE)
        return self

    def energy(self):
        """Half a step ago; the plate is at rest."""
        height = self.effects.plate.height[0] if self.effects.plate else 0.0
        listed, (*_, place, found, _) = self.state.listed, self.state.scratch
        if listed:
            assert renewed(
                IN_SPACE, self.rods, self.effects.half_length, None, listed, place, found
            )
        return energy(self.effects, self.rods, listed, height, self.dt)

    def moments(self):
        """Momentum, and angular momentum about the origin, half a step ago."""
        velocity, turn = self.rods[:, VELOCITY:TURN], self.rods[:, TURN:]
        place = self.rods[:, PLACE : PLACE + 3] - self.dt / 2 * velocity
        return velocity.sum(0), (np.cross(place, velocity) + turn / LIGHT).sum(0)

    def kinetic(self):
        return (
            (self.rods[:, VELOCITY:TURN] ** 2).sum() + (self.rods[:, TURN:] ** 2).sum() / LIGHT
        ) / 2
