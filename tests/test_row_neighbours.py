"""The list of pairs misses none, keeps what its entries keep, and takes linear time to build."""

from math import ceil

import numpy as np
import pytest

from md.host import prepare
from md.kernels import neighbours
from md.kernels.closest import near_end
from md.kernels.codes import COSINE, PAIR_FRICTION, ROW_DIRECTION, ROW_PLACE, SINE, SKIN, X, Z
from md.kernels.neighbours import PAIR
from md.kernels.vectors import IN_PLANE

from .rows import ELASTIC, EPS, HALF, LIGHT, SOFT, elastic, ends, forces, free, images, row


def build(rods, half, period, listed=None):
    """Entries (first, second, image) of the list of these rods."""
    n = len(rods)
    capacity = 60 * n
    listed = listed or neighbours.nothing_listed(n, capacity, False, False)
    listed.built[:] = 1e300
    found = np.zeros((capacity, 3), np.int64)
    assert neighbours.renewed(IN_PLANE, rods, half, period, listed, np.zeros(n), found)
    return listed, entries(listed)


def entries(listed):
    """Of a list in use, each once."""
    now = listed.turn[0]
    found = listed.index[now, : listed.start[now, -1]]
    assert np.all(np.diff(found[:, 0]) >= 0)
    for i, first in enumerate(listed.start[now, :-1]):
        assert np.all(found[first : listed.start[now, i + 1], 0] == i)
    unique = {tuple(map(int, entry[:3])) for entry in found}
    assert len(unique) == len(found)
    return unique


def close(rods, half, period, reach):
    """All pairs with an end nearer than `reach` to the other's axis, by brute force."""
    return {
        (i, j, n)
        for i, j, n in images(rods, half, period)
        if max(end[0] for end in ends(rods, half, i, j, n * (period or 0.0))) > 1 - reach
    }


def crowd(random, n, length, width):
    """Rods anywhere within a width, all tilts, and far outside of the box as well."""
    rods = np.zeros((n, 7))
    rods[:, X] = random.uniform(-2 * width, 2 * width, n)
    rods[:, Z] = random.uniform(0, length / 2, n)
    tilt = random.choice([0.3, 1.5, 3.0]) * random.uniform(-1, 1, n)
    rods[:, SINE], rods[:, COSINE] = np.sin(tilt), np.cos(tilt)
    return rods


# Against all pairs


@pytest.mark.parametrize(
    ("n", "length", "period"),
    [
        (12, 9.5, 60.0),
        (12, 9.5, None),
        (8, 9.5, 12.0),  # shorter than two rods
        (3, 9.5, 1.3),  # a rod beside many of its own images
        (1, 9.5, 1.1),
        (1, 9.5, None),
        (2, 1.0, 2.5),
        (20, 40.0, 45.0),
    ],
)
def test_the_list_holds_exactly_the_close_pairs(n, length, period):
    """30 random states each, the list renewed from one to the next and so sorted from any order.

    Equality within the rounding of places up to 2 `period`: none lies that near the skin's edge.
    """
    random = np.random.default_rng(n)
    half, listed, most = (length - 1) / 2, None, 0
    for _ in range(30):
        rods = crowd(random, n, length, period or 3 * length)
        listed, found = build(rods, half, period, listed)
        assert found == close(rods, half, period, 1 + SKIN)
        most = max(most, len(found))
    assert most > 0 or (n, period) == (1, None)


@pytest.mark.parametrize("period", [11.5, 26.0])
def test_forces_are_those_of_all_pairs(period):
    """Every image of every pair once, by brute force; sums of some ten forces round by EPS each."""
    random = np.random.default_rng(1)
    n = 10 if period < 20 else 20
    rods = np.zeros((n, 7))
    for k in range(n):
        rods[k, X] = (k + random.uniform(-0.05, 0.05)) * period / n + random.integers(
            -3, 4
        ) * period
        rods[k, Z] = 5 + random.uniform(-0.1, 0.1)
        tilt = np.arccos(n / period) + 0.005 * random.uniform(-1, 1)
        rods[k, ROW_DIRECTION] = np.sin(tilt), np.cos(tilt)
    states = [(x, z, np.arctan2(s, c)) for x, z, s, c, *_ in rods]
    engine = free(ELASTIC, states, period=period, dt=1e-6)
    got = forces(engine, states)
    want, _ = elastic(rods, HALF, LIGHT, SOFT, period)
    assert np.abs(want).max() > 1000
    # rounding places of up to 4 periods changes an overlap by 4 EPS period
    steep = 1.5 * SOFT * 0.5 * 10
    np.testing.assert_allclose(got, want, rtol=1e-12, atol=steep * 16 * EPS * period)


def test_a_rod_touches_its_own_image():
    """In a box of 2.01, leaning: the images on both sides turn it upright; another rod is far.

    Their forces cancel, their torques do not.
    """
    states = [(0.3, 5, 1.06), (0.3, 50, 0.0)]
    tilted = forces(free(ELASTIC, states, period=2.01), states)
    rods = np.array([(x, z, np.sin(tilt), np.cos(tilt), 0, 0, 0) for x, z, tilt in states])
    want, _ = elastic(rods, HALF, LIGHT, SOFT, 2.01)
    assert tilted[0, 2] < -1
    np.testing.assert_allclose(tilted, want, atol=1e-8)
    assert np.abs(tilted[0, :2]).max() < 1e-9


# Periods added


def test_a_period_added_to_any_rod_changes_no_force():
    """M9: beyond what rounding its place does, 4 ulp of the place times the steepest slope."""
    random = np.random.default_rng(3)
    n, period = 6, 6.3
    tilt = np.arccos(n / period)
    states = [(k * period / n + 0.01 * random.normal(), 5.0, tilt) for k in range(n)]
    engine = free(ELASTIC, states, period=period, dt=1e-6)
    usual = forces(engine, states)
    assert np.abs(usual).max() > 100
    for _ in range(20):
        far = random.integers(-5, 6, n) * period
        moved = [(x + a, z, t) for (x, z, t), a in zip(states, far, strict=True)]
        ulp = np.spacing(np.abs(far).max() + period)
        steep = 1.5 * SOFT * 0.5 * 8 * 5  # eight ends of overlap below 1/4, arms of 5
        assert np.abs(forces(engine, moved) - usual).max() <= 4 * ulp * steep


# While rods move


def lively():
    """A row on a plate that throws it about."""
    return prepare(row("plate.acceleration=10"))


@pytest.mark.parametrize(
    ("more", "periods", "every"),
    [
        ([], 2, 20),
        pytest.param(
            ["rods.count=10", "rods.length=9.5", "box.length=11.5"], 200, 97, marks=pytest.mark.slow
        ),
    ],
)
def test_no_touching_pair_is_missed_while_rods_move(more, periods, every):
    """All pairs with all images against the list, every so many steps."""
    engine, touching, lists = prepare(row("plate.acceleration=10", *more)), 0, set()
    period, half = engine.effects.period, engine.effects.half_length
    for _ in range(periods * engine.per // every):
        engine.go(every)
        # the list was brought up to date before the last step, of at most 1e-3 d
        touch = close(engine.rods, half, period, 1 - 1e-3)
        assert touch <= entries(engine.state.listed)
        touching = max(touching, len(touch))
        lists.add(engine.state.listed.built.tobytes())
        engine.record.count[0] = 0
    assert touching >= 3
    assert len(lists) >= 4


def test_springs_and_losses_survive_a_rebuild():
    """A list renewed before every step gives the same bits as one renewed when it must be."""
    usual, often = lively(), lively()
    for _ in range(1500):
        often.state.listed.travelled[:] = np.inf
        often.state.listed.built[:, :2] = 1e300
        for engine in (usual, often):
            engine.go(1)
    assert usual.ledger[PAIR_FRICTION] != 0  # springs of rods on rods have worked
    np.testing.assert_array_equal(often.rods, usual.rods)
    np.testing.assert_array_equal(often.state.springs, usual.state.springs)
    np.testing.assert_array_equal(often.ledger, usual.ledger)


TURN = 0.5 / HALF  # about a lower end at rest
CLOSING = {  # as fast as rods of a largest speed of 1 may, from a gap of 0.05 d
    "pair": [(0.0, 9.0, 0.0, 1.0, 0.0, 0.0), (1.05, 9.0, 0.0, -1.0, 0.0, 0.0)],
    "end of a touching pair": [
        (-0.004 * HALF, HALF, -0.004, 0.5, 0.0, TURN),
        (0.9915 + 0.004 * HALF, HALF + 2.0, 0.004, -0.5, 0.0, -TURN),
    ],
}


@pytest.mark.parametrize("states", CLOSING.values(), ids=CLOSING)
def test_what_sleeps_wakes_in_time(states):
    """To the bits of a run in which nothing sleeps."""
    usual, often = (free(ELASTIC, states) for _ in range(2))
    slept, wide = 0, []
    for _ in range(400):
        often.state.listed.asleep[:] = 0.0
        for engine in (usual, often):
            engine.go(1)
        listed = usual.state.listed
        slept += np.count_nonzero(listed.asleep[0, [1, PAIR]] > listed.travelled)
        (x, a), (y, b) = ((rod[ROW_PLACE], tuple(rod[ROW_DIRECTION])) for rod in usual.rods)
        wide.append(1 - np.sqrt(near_end(tuple(x - y), a, b, HALF, 1).square))
    assert slept > 50
    assert min(wide) < -0.04
    assert max(wide) > 0.001
    np.testing.assert_array_equal(usual.rods, often.rods)


def test_a_list_that_is_full_grows():
    """From one entry on, and once more while contacts are open; to the same bits."""
    usual, small = lively(), lively()
    n = len(small.rods)
    small.state = small.state._replace(
        listed=neighbours.nothing_listed(n, 1, True, False),
        scratch=small.state.scratch._replace(found=np.zeros((1, 3), np.int64)),
    )
    usual.go(800)
    small.go(400)
    assert np.any(small.state.listed.springs)
    small._grow()
    small.go(400)
    assert small.state.listed.index.shape[1] > 4
    np.testing.assert_array_equal(small.rods, usual.rods)
    np.testing.assert_array_equal(small.ledger, usual.ledger)


# Time


class Counted(np.ndarray):
    """Counts how often an element is read."""

    reads = 0

    def __getitem__(self, key):
        Counted.reads += 1
        return super().__getitem__(key)


def reads(n):
    """Reads of places that it takes to build the list of n rods in a row, all drawn together."""
    random = np.random.default_rng(0)
    rods, spacing = np.zeros((n, 7)), 43 / 40
    rods[:, X] = (np.arange(n) + random.uniform(-0.3, 0.3, n)) * spacing
    rods[:, Z], rods[:, SINE], rods[:, COSINE] = 4.5, np.sin(0.37), np.cos(0.37)
    place, order = rods[:, X].copy().view(Counted), np.arange(n)
    found = np.zeros((20 * n, 3), np.int64)
    Counted.reads = 0
    neighbours.pair_up.py_func(IN_PLANE, rods, HALF, n * spacing, order, place, found)
    return Counted.reads


def test_a_list_takes_time_linear_in_the_number_of_rods():
    """Counted, not timed: each rod looks at the rods within its length, however many there are."""
    few, many = reads(100), reads(400)
    within = ceil((2 * HALF + 1 + SKIN) / (43 / 40)) + 2
    assert few <= 100 * (2 * within + 10)
    assert many == pytest.approx(4 * few, rel=0.02)
