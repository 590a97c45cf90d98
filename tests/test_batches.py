"""More contacts in a step than a batch holds: copies of a few rods move as the few do."""

import numpy as np
import pytest

import md
from md.kernels.batch import SIZE
from md.kernels.codes import ROW_COLUMNS, SPACE_COLUMNS, Z

from . import rows
from .space import LOSSY, ROUGH, Rods, Wall, effects, meeting, states

COPIES, APART = 100, 64.0  # d; along z
STEPS = 300
HEIGHT = {"row": np.eye(ROW_COLUMNS)[Z], "space": np.eye(SPACE_COLUMNS)[2]}


def row(copies):
    """Three rods that meet, in a plane, `copies` times."""
    three = (0.0, 0.0, 0.1, 0.0, 0.0, 0.0), (0.99, 0.2, 0.1, -1.0, 0.0, 0.0)
    three = *three, (1.98, 0.1, 0.12, -2.0, 0.5, 0.0)
    placed = [(x, z + APART * k, *rest) for k in range(copies) for x, z, *rest in three]
    engine = rows.free(md.constant_restitution(0.65, 1e5), placed, friction=0.3)
    engine.go(STEPS)
    return engine.rods, engine.ledger


def space(copies):
    """Three rods that meet, in space."""
    first, *others = ((0, 0, 0), (0.1, 0, 1), (0, 0, -1)), ((0.99, 0.05, 0.2), (0.1, 0.02, 1))
    three = states(first, *others, ((0.4, 0.9, 0.1), (0.12, 0, 1), (0, -1, 0)))
    placed = np.concatenate([three + APART * k * HEIGHT["space"] for k in range(copies)])
    run = Rods(meeting(), placed, watched=True).go(STEPS)
    return run.rods, run.watchers.ledger


@pytest.mark.parametrize("arrangement", [row, space])
def test_contacts_of_rods_beyond_a_batch(arrangement):
    (few, few_ledger), (many, ledger) = arrangement(1), arrangement(COPIES)
    assert np.abs(ledger).max() > 1
    np.testing.assert_allclose(ledger, COPIES * few_ledger, rtol=1e-9, atol=1e-9)
    height = APART * np.arange(COPIES)[:, None, None] * HEIGHT[arrangement.__name__]
    np.testing.assert_allclose(many.reshape(COPIES, *few.shape) - height, [few] * COPIES, atol=1e-9)


def test_contacts_of_a_wall_beyond_a_batch():
    """Rods that do not see each other, all at one place."""
    pressed = states(((0, 1.49, 0.0), (0.6, 0, 1), (0, -1, 0)))
    wall = effects(inner=Wall(1.0, LOSSY.normal, ROUGH), outer=Wall(40.0, LOSSY.normal, ROUGH))
    one, many = (Rods(wall, np.repeat(pressed, n, axis=0)).go(STEPS).rods for n in (1, 2 * SIZE))
    assert one[0, 7] > 1  # the wall has thrown it back
    np.testing.assert_array_equal(many, np.repeat(one, 2 * SIZE, axis=0))
