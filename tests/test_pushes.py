"""Touches of a row know who pushed: what plate and neighbours give each rod, step by step."""

import numpy as np

from md.host import prepare
from md.kernels import touches
from md.kernels.codes import C_X
from md.kernels.neighbours import current
from md.kernels.pairs import pair_forces

from .rows import row

PERIODS = 125
CLOSE = {"rtol": 0, "atol": 1e-10}


def followed():
    """Touches, and what plate and neighbours give each rod along x, summed over the steps.

    The kernel leaves the accelerations of its last step; those between rods are computed from the
    same state beforehand. Sums begin with 0, before the first step.
    """
    engine = prepare(row("box.length=6.5"))
    effects, (*_, listed, scratch) = engine.effects, engine.state
    start, every, others, kept = engine.rods[:, C_X].sum(), [], [], []
    for _ in range(PERIODS * engine.per):
        place = effects.half_length, effects.period, listed, scratch.place, scratch.found
        assert current(effects.up, engine.rods, *place)  # the list of pairs
        springs, forces = listed.springs.copy(), listed.forces.copy()
        scratch.total[:] = 0
        pair_forces(effects, engine.state, None, engine.dt)
        others.append(scratch.total[:, 0] * engine.dt)
        listed.springs[:], listed.forces[:] = springs, forces
        engine.go(1)
        every.append(engine.state.before[:, 0] * engine.dt)
        kept.append(engine.record.rows[: engine.record.count[0]].copy())
        engine.record.count[0] = 0
    given = np.array([np.subtract(every, others), others]).cumsum(axis=1)
    plate, neighbours = np.insert(given, 0, 0.0, axis=1)
    np.testing.assert_allclose(neighbours.sum(axis=1), 0, **CLOSE)  # forces between rods cancel
    np.testing.assert_allclose(plate[-1].sum(), engine.rods[:, C_X].sum() - start, atol=1e-9)
    return np.concatenate(kept), plate, neighbours


def test_touches_tell_who_gave_the_momentum():
    """Free touches: the plate alone; between touches: neighbours alone; in pushed ones: both."""
    rows, plate, neighbours = followed()
    rows = rows[np.lexsort((rows[:, touches.STEP], rows[:, touches.ROD]))]
    rod, begun = rows[:, touches.ROD].astype(int), rows[:, touches.STEP].astype(int)
    ended, free = begun + rows[:, touches.DURATION].astype(int), rows[:, touches.PUSHED] == 0
    before, after = rows[:, touches.BEFORE], rows[:, touches.AFTER]
    assert 0.1 < free.mean() < 0.9
    by_plate, by_others = (given[ended, rod] - given[begun, rod] for given in (plate, neighbours))
    np.testing.assert_allclose(after - before, by_plate + by_others, **CLOSE)
    np.testing.assert_allclose(by_others[free], 0, **CLOSE)
    assert np.abs(by_others[~free]).max() > 0.01
    last = np.flatnonzero(np.diff(rod) == 0)
    start, end, rod = ended[last], begun[last + 1], rod[last]
    by_plate, by_others = (given[end, rod] - given[start, rod] for given in (plate, neighbours))
    np.testing.assert_allclose(by_plate, 0, **CLOSE)
    np.testing.assert_allclose(before[last + 1] - after[last], by_others, **CLOSE)
