"""The list of pairs misses none, keeps what its entries keep, and takes linear time to build."""

from itertools import combinations
from math import ceil

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal

from md.host import at_start, prepare
from md.kernels import (
    PAIR_FRICTION,
    SKIN,
    neighbours,
)
from md.kernels.neighbours import PAIR
from md.kernels.vectors import IN_PLANE, IN_SPACE

from .rows import (
    ELASTIC_PLANE,
    HALF,
    SOFT,
    distance,
    elastic,
    go,
    images,
    in_plane,
    in_space,
    meetings,
    overlap,
    pushed,
    row,
    started,
)
from .sampling import EPS


def build(rods, half, period, listed):
    """Entries (first, second, image) of the list of these rods, each once."""
    listed.built[:] = 1e300
    n, found = len(rods), np.zeros((len(listed.index) // 2, 3), np.int64)
    assert neighbours.renewed(IN_PLANE, rods, half, period, listed, np.zeros(n), found)
    return entries(listed)


def entries(listed):
    """Entries (first, second, image) of a list in use, each once."""
    start = listed.start[listed.turn[0]]
    found = listed.index[listed.turn[0] :: 2][: start[-1]]
    assert_array_equal(found[:, 0], np.repeat(np.arange(len(start) - 1), np.diff(start)))
    unique = {tuple(map(int, entry[:3])) for entry in found}
    assert len(unique) == len(found)
    return unique


def close(rods, half, period, reach):
    """All pairs with an end nearer than `reach` to the other's axis, by brute force."""
    return {
        (i, j, n)
        for i, j, n in images(rods, half, period)
        if max(map(overlap, meetings(rods, i, j, half, n * period)[0])) > 1 - reach
    }


def crowd(random, n, length, width):
    """Rods anywhere within a width, all tilts, and far outside of the box as well."""
    tilt = random.choice([0.3, 1.5, 3.0]) * random.uniform(-1, 1, n)
    x, z = random.uniform(-2 * width, 2 * width, n), random.uniform(0, length / 2, n)
    return np.ascontiguousarray(in_plane(*np.column_stack([x, z, tilt])))


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
    """It does for 30 random states, renewed from one to the next and so sorted from any order.

    Equality within the rounding of places up to 2 `period`: none lies that near the skin's edge.
    """
    random, half, most = default_rng(n), (length - 1) / 2, 0
    listed = neighbours.nothing_listed(n, 60 * n, False, False)
    for _ in range(30):
        rods = crowd(random, n, length, period or 3 * length)
        found = build(rods, half, period, listed)
        assert found == close(rods, half, period or 1e6, 1 + SKIN)
        most = max(most, len(found))
    assert most > 0 or (n, period) == (1, None)


@pytest.mark.parametrize(("radius", "count"), [(30.0, 60), (3.0, 12)])
def test_neighbours_by_azimuth_are_all_close_pairs(radius, count):
    """They are those of brute force; in the second case a rod spans more than half the circle."""
    random = default_rng(4)
    azimuth = random.uniform(-np.pi, np.pi, count)
    x, y = radius * np.cos(azimuth), radius * np.sin(azimuth)
    places = np.column_stack([x, y, random.uniform(0, 5, count)])
    rods = in_space(*zip(places, random.normal(size=(count, 3)), strict=True))
    found, place = np.zeros((count**2, 3), np.int64), np.zeros(count)
    listed = neighbours.pair_up(IN_SPACE, rods, HALF, None, np.arange(count), place, found)
    every = combinations(range(count), 2)
    close = [pair for pair in every if distance(rods, *pair) < 1 + SKIN]
    assert len(close) > 10
    assert sorted(map(tuple, found[:listed, :2])) == close


@pytest.mark.parametrize(("n", "period"), [(1, 2.01), (10, 11.5), (20, 26.0)])
def test_m9_forces_are_those_of_all_pairs(n, period):
    """Every image of every pair counts once, as by brute force; some ten forces round by EPS each.

    Rods are up to three periods away from the box. In the box of 2.01 a rod touches its own
    images, which turn it upright.
    """
    random = default_rng(1)
    x = (np.arange(n) + random.uniform(-0.05, 0.05, n)) * period / n
    x += random.integers(-3, 4, n) * period
    tilt = np.arccos(n / period) + 0.005 * random.uniform(-1, 1, n) + 0.01 / n
    rods = zip(x, 5 + random.uniform(-0.1, 0.1, n), tilt, strict=True)
    rods = in_plane(*rods, (0.3, 50, 0.0))
    got, want = pushed(rods, period), elastic(rods, period=period)
    assert np.abs(want).max() > (400 if n == 1 else 1000)
    # rounding places of up to 4 periods changes an overlap by 4 EPS period
    steep = 1.5 * SOFT * 0.5 * 10
    assert_allclose(got, want, rtol=1e-12, atol=steep * 16 * EPS * period)


# While rods move


def lively():
    """A row on a plate that throws it about."""
    return prepare(row("plate.acceleration=10"))


def test_no_touching_pair_is_missed_while_rods_move():
    """The list holds all pairs with all images that touch, every twenty steps."""
    engine, touching, lists = lively(), 0, set()
    period, half = engine.effects.period, engine.effects.half_length
    for _ in range(engine.per // 10):
        go(engine, 20)
        # the list was brought up to date before the last step, of at most 1e-3 d
        touch = close(engine.rods, half, period, 1 - 1e-3)
        assert touch <= entries(engine.state.listed)
        touching = max(touching, len(touch))
        lists.add(engine.state.listed.built.tobytes())
        engine.record.count[0] = 0
    assert touching >= 3
    assert len(lists) >= 4


def same(engine, other):
    """Whether rods, springs and energies are the same to the bit."""
    assert_array_equal(engine.rods, other.rods)
    assert_array_equal(engine.state.memory.springs, other.state.memory.springs)
    assert_array_equal(engine.ledger, other.ledger)


def test_springs_and_losses_survive_a_rebuild():
    """A list renewed before every step gives the same bits as one renewed when it must be."""
    usual, often = lively(), lively()
    for _ in range(1500):
        often.state.listed.travelled[:] = np.inf
        often.state.listed.built[:, :2] = 1e300
        go(often, 1)
    assert go(usual, 1500).ledger[PAIR_FRICTION] != 0  # springs of rods on rods have worked
    same(often, usual)


TURN = 0.5 / HALF  # about a lower end at rest
CLOSING = {  # as fast as rods of a largest speed of 1 may, from a gap of 0.05 d
    "pair": [(0.0, 9.0, 0.0, 1.0, 0.0, 0.0), (1.05, 9.0, 0.0, -1.0, 0.0, 0.0)],
    "end of a touching pair": [
        (-0.004 * HALF, HALF, -0.004, 0.5, 0.0, TURN),
        (0.9915 + 0.004 * HALF, HALF + 2.0, 0.004, -0.5, 0.0, -TURN),
    ],
}


@pytest.mark.parametrize("name", CLOSING)
def test_what_sleeps_wakes_in_time(name):
    """Pairs that sleep give the bits of a run in which nothing sleeps."""
    usual, often = (started(ELASTIC_PLANE, in_plane(*CLOSING[name])) for _ in range(2))
    slept, deep = 0, []
    for _ in range(400):
        often.state.listed.asleep[:] = 0.0
        go(often, 1), go(usual, 1)
        listed = usual.state.listed
        slept += np.count_nonzero(listed.asleep[0, [1, PAIR]] > listed.travelled)
        deep.append(overlap(meetings(usual.rods)[0][1]))  # of the first rod's upper end
    assert slept > 50
    assert min(deep) < -0.04
    assert max(deep) > 0.001
    same(usual, often)


def test_a_list_that_is_full_grows():
    """It grows from one entry on, and again while contacts are open, to the same bits."""
    usual, small = lively(), lively()
    small.state = at_start(small.effects, small.rods, pairs=1)
    go(small, 200)
    assert np.any(small.state.listed.memory.springs)
    small.restore(small.arrays(), small.step, room=2)
    go(small, 200), go(usual, 400)
    assert len(small.state.listed.index) > 8
    same(small, usual)


# Time


class Counted(np.ndarray):
    """Counts how often an element is read."""

    reads = 0

    def __getitem__(self, key):
        Counted.reads += 1
        return super().__getitem__(key)


def reads(n):
    """Reads of places that it takes to build the list of n rods in a row, all drawn together."""
    spacing = 43 / 40
    x = (np.arange(n) + default_rng(0).uniform(-0.3, 0.3, n)) * spacing
    rods = in_plane(*((place, 4.5, 0.37) for place in x))
    place, found = x.view(Counted), np.zeros((20 * n, 3), np.int64)
    Counted.reads = 0
    neighbours.pair_up.py_func(IN_PLANE, rods, HALF, n * spacing, np.arange(n), place, found)
    return Counted.reads


def test_a_list_takes_time_linear_in_the_number_of_rods():
    """Each rod looks at the rods within its length, however many there are: reads are counted."""
    few, many = reads(100), reads(400)
    within = ceil((2 * HALF + 1 + SKIN) / (43 / 40)) + 2
    assert few <= 100 * (2 * within + 10)
    assert many == pytest.approx(4 * few, rel=0.02)
