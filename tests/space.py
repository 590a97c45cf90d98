"""Rods in space for the tests, marched by the kernel without a host."""

import numpy as np

import md
from md.kernels.codes import (
    ANNULUS_LEDGER,
    DONE,
    PAIR_SLOTS,
    PLACE,
    SLOTS,
    SPACE_COLUMNS,
    TURN,
    VELOCITY,
)
from md.kernels.contact import ContactForces, Friction, Motion, Normal
from md.kernels.neighbours import nothing_listed
from md.kernels.plane import Watchers
from md.kernels.plate import Clock
from md.kernels.space.batch import no_contacts
from md.kernels.space.energy import energy
from md.kernels.space.forces import Scratch, SpaceEffects, State, Wall
from md.kernels.space.march import march
from md.kernels.space.touches import FLAT
from md.kernels.touches import new_record

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
    return SpaceEffects(half_length, lightness, **parts)


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
        rubs = any(part and part.friction for part in (scene.inner, scene.outer))
        springs = np.zeros((n, SLOTS, 3)) if rubs or scene.friction else None
        most, kept = 20 * n + 20, ((PAIR_SLOTS, 4), (PAIR_SLOTS, 3))
        listed = nothing_listed(n, most, True, kept) if scene.between else None
        place, found = (np.zeros(n), np.zeros((most, 3), int)) if scene.between else (None, None)
        own = rods, np.zeros((n, 6)), np.zeros((n, SLOTS, 4)), springs, listed
        flat = np.zeros((n, FLAT)) if watched else None
        self.state = State(*own, Scratch(np.zeros((n, 6)), place, found, no_contacts()), flat)
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
        return energy(self.effects, self.rods, height, self.dt)

    def moments(self):
        """Momentum, and angular momentum about the origin, half a step ago."""
        velocity, turn = self.rods[:, VELOCITY:TURN], self.rods[:, TURN:]
        place = self.rods[:, PLACE : PLACE + 3] - self.dt / 2 * velocity
        return velocity.sum(0), (np.cross(place, velocity) + turn / LIGHT).sum(0)

    def kinetic(self):
        return (
            (self.rods[:, VELOCITY:TURN] ** 2).sum() + (self.rods[:, TURN:] ** 2).sum() / LIGHT
        ) / 2
