"""Times of a step by each kernel: the same rods in the plane and in space, and an annulus.

The rods of a row that has settled, without its box, are put into space at y = 0: the kernel of
space finds the same contacts and forces. Each sample starts there again, so that both do the same
work; the annulus starts where it has settled, too.
"""

from collections.abc import Callable
from time import thread_time
from typing import Any

import numpy as np

from md.host import Engine, prepare
from md.kernels.codes import PAIR_SLOTS, PLATE_CAPS, SLOTS, SPACE_COLUMNS
from md.kernels.contact import Clock
from md.kernels.plane import Watchers
from md.kernels.space.batch import no_contacts
from md.kernels.space.forces import SpaceEffects, State
from md.kernels.space.march import march
from md.kernels.space.pairs import no_pairs
from md.scene import from_tables, put

from ..lib.runs import ANNULUS_SCENE, SIMPLE_ROW
from ..lib.timing import onward

NAMES = "plane kernel", "space kernel, the same rods", "annulus"
PLANE_COLUMNS = [0, 2, 3, 5, 6, 8, 10]  # of x, z, sin, cos, c_x, c_z, omega in the state in space
SAMPLE_STEPS = 1500
SETTLE_PERIODS, ANNULUS_PERIODS = 3.0, 12.0  # before: of the row, of the annulus


def _settled() -> Engine:
    """The row without its box, after some landings, when it is still a crowd."""
    changes = {"box": "none", "start.tilt_deg": 20.0, "start.drop": 0.01}
    engine = prepare(from_tables(put(SIMPLE_ROW, changes)))
    engine.go(round(SETTLE_PERIODS * engine.per))
    return engine


def _again(engine: Any) -> Callable[[int], float]:
    """Seconds of a step of a rod, each time from where the engine is now."""
    arrays, step = {name: part.copy() for name, part in engine.arrays().items()}, engine.step

    def sample(_: int) -> float:
        engine.restore({name: part.copy() for name, part in arrays.items()}, step)
        engine.go(1)  # makes the list of pairs
        return onward(engine, SAMPLE_STEPS) / SAMPLE_STEPS / len(engine.rods)

    return sample


def lifted(engine: Engine) -> Callable[[int], tuple[float, np.ndarray]]:
    """Seconds of a step of a rod, and the rods, of the same steps in space."""
    alone, n, step, dt = engine.effects.alone, len(engine.rods), engine.step, engine.dt
    shared = {name: getattr(alone, name) for name in ("plate", "normal", "friction")}
    shared |= {"gravity": alone.gravity[1], "between": engine.effects.between}
    effects = SpaceEffects(alone.half_length, alone.lightness, **shared)
    first, before = np.zeros((n, SPACE_COLUMNS)), np.zeros((n, 6))
    first[:, PLANE_COLUMNS], before[:, [0, 2, 4]] = engine.rods, engine.state.before
    springs = np.zeros((n, SLOTS, 3))
    if engine.state.springs is not None:
        springs[:, PLATE_CAPS : PLATE_CAPS + 2, 0] = engine.state.springs

    def sample(_: int) -> tuple[float, np.ndarray]:
        pair_springs = np.zeros((n * (n - 1) // 2, PAIR_SLOTS, 3))
        own = first.copy(), before.copy(), springs.copy()
        state = State(*own, no_pairs(n), pair_springs, np.zeros((n, 6)), batch=no_contacts())
        nobody = Watchers(None, None, None)
        march(effects, state, nobody, Clock(step, dt), 1)
        begin = thread_time()
        march(effects, state, nobody, Clock(step + 1, dt), SAMPLE_STEPS)
        return (thread_time() - begin) / SAMPLE_STEPS / n, state.rods

    return sample


def calls() -> list[Callable[[int], float]]:
    """Times of a step of a rod, as `NAMES` says."""
    row, annulus = _settled(), prepare(ANNULUS_SCENE, ledger=False, touches=False)
    annulus.go(round(ANNULUS_PERIODS * annulus.per))
    above = lifted(row)
    found = [_again(row), lambda place: above(place)[0], _again(annulus)]
    for call in found:
        call(0)  # compiles
    return found
