"""Cheap soft scenes of many rods for the tests, and forces by brute force."""

from itertools import product
from math import cos, pi, sin

import numpy as np

import md
from md.host import Engine, prepare
from md.kernels.codes import ROW_DIRECTION, ROW_PLACE, ROW_VELOCITY, X
from md.rod import Rod
from md.scene import Box, Contact, Contacts, Rods, Scene, Start, Step

EPS = np.finfo(float).eps
SOFT = 1e5  # k_n of most tests: contacts fifty times as long as the paper's allow long steps
ELASTIC = md.coulomb(restitution=1.0, stiffness=SOFT)
HALF = 4.25  # of the paper's rods
LIGHT = 1 / Rod(9.5).gyration_squared
ROW = (  # rods of the paper's row, few and soft
    *("rods.count=5", "rods.length=5", "box.length=5.5", "step.size=none", "start.speed=0.1"),
    "step.coarse=true",
    *(f"contacts.{part}.stiffness={SOFT}" for part in ("plate", "rods")),
)


def row(*assignments: str) -> Scene:
    """The row with some keys set anew."""
    return md.load("quasi2d", [*ROW, *assignments])


def free(law, states, *, length=9.5, dt=1e-4, friction=0.0, period=None) -> Engine:
    """Rods without plate and gravity, each (x, z, tilt, c_x, c_z, omega), under a contact law."""
    scene = Scene(
        rods=Rods(len(states), length),
        box=Box(period) if period else None,
        contacts=Contacts(rods=Contact(law, friction)),
        start=Start(tilt_deg=0.0, speed=0.5),
        step=Step(dt),
    )
    engine = prepare(scene)
    put(engine, states)
    return engine


def put(engine: Engine, states) -> None:
    """Place the rods anew; nothing is kept of what they touched."""
    for rod, (x, z, tilt, *velocity) in zip(engine.rods, states, strict=True):
        rod[:] = x, z, sin(tilt), cos(tilt), *(velocity or (0.0, 0.0, 0.0))
    engine.state.before[:] = 0
    engine.state.listed.travelled[:] = np.inf
    engine.state.listed.forces[:] = 0


def tip_on_side(lean, place, gap=1e-12):
    """Rod 0's lower cap `gap` off rod 1, which lies along x, at x = `place`."""
    reach = 1 + gap
    return [(place + HALF * sin(lean), reach + HALF * cos(lean), lean), (0.0, 0.0, pi / 2)]


def forces(engine: Engine, states) -> np.ndarray:
    """Accelerations (x, z, angular) of rods at rest there, from one step of the engine."""
    put(engine, states)
    engine.go(1)
    return engine.rods[:, ROW_VELOCITY] / engine.dt


def ends(rods: np.ndarray, half: float, i: int, j: int, shift: float = 0.0):
    """(overlap, normal towards i, point on the axis of i, of j) at each of four ends.

    Written without a look at the engine: the nearest point of a segment is the foot of the
    perpendicular, held between its ends. Rod j stands `shift` further along x.
    """
    found = []
    tails = [rods[i, ROW_PLACE], rods[j, ROW_PLACE] + (shift, 0.0)]
    axes = [rods[i, ROW_DIRECTION], rods[j, ROW_DIRECTION]]
    for mine in (0, 1):
        for side in (-half, half):
            end = tails[mine] + side * axes[mine]
            other, axis = tails[1 - mine], axes[1 - mine]
            foot = other + np.clip((end - other) @ axis / (axis @ axis), -half, half) * axis
            p, q = (end, foot) if mine == 0 else (foot, end)
            gap = np.hypot(*(p - q))
            found.append((1 - gap, (p - q) / gap, p, q))
    return found


def images(rods: np.ndarray, half: float, period: float | None):
    """Every pair (i, j, n) of which rod j, n periods further along x, might touch rod i."""
    n = len(rods)
    for i in range(n):
        for j in range(i, n):
            apart = rods[i, X] - rods[j, X]
            reach = 2 * half + 3
            if period is None:
                if i != j and abs(apart) < reach:
                    yield i, j, 0
                continue
            for image in range(
                int(np.ceil((apart - reach) / period)), int((apart + reach) // period) + 1
            ):
                if i != j or image > 0:
                    yield i, j, image


def corners(rods: np.ndarray, half: float, i: int, j: int, shift: float = 0.0):
    """(overlap, normal towards i, end of i, end of j) of every two ends."""
    tails = rods[i, ROW_PLACE], rods[j, ROW_PLACE] + (shift, 0.0)
    for mine, theirs in product((-half, half), repeat=2):
        p, q = tails[0] + mine * rods[i, ROW_DIRECTION], tails[1] + theirs * rods[j, ROW_DIRECTION]
        yield 1 - np.hypot(*(p - q)), (p - q) / np.hypot(*(p - q)), p, q


def elastic(rods: np.ndarray, half: float, light: float, stiffness: float, period=None):
    """Accelerations and energy of all pairs without dashpots, by brute force.

    The contacts of all ends with the other axis, less those of all ends with each other.
    """
    total, energy = np.zeros((len(rods), 3)), 0.0
    for i, j, image in images(rods, half, period):
        shift = np.array((image * period if image else 0.0, 0.0))
        contacts = [(1, *found) for found in ends(rods, half, i, j, shift[0])]
        contacts += [(-1, *found) for found in corners(rods, half, i, j, shift[0])]
        for count, overlap, normal, p, q in contacts:
            if overlap <= 0:
                continue
            force = count * stiffness * overlap**1.5 * normal
            energy += count * 0.4 * stiffness * overlap**2.5
            touch = (p + q) / 2
            for rod, centre, sign in (
                (i, rods[i, ROW_PLACE], 1),
                (j, rods[j, ROW_PLACE] + shift, -1),
            ):
                x, z = touch - centre
                total[rod] += sign * np.array((*force, light * (z * force[0] - x * force[1])))
    return total, energy
