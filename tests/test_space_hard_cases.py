"""Hard cases in space: nothing passes through anything, nonsense ends a run, narrow gaps work."""

import numpy as np
import pytest

import md
from md.host import prepare
from md.kernels import walls as geometry
from md.kernels.closest import between_ends
from md.kernels.codes import DEEP, DIRECTOR, DONE, PLACE, PLATE_WORK, TURN, VELOCITY
from md.kernels.state import Motion, Wall
from md.laws import deepest_overlap

from .space import HALF, LOSSY, ROUGH, SMOOTH, Rods, meeting, states, tuples, unit, within
from .test_annulus import ring

INNER, OUTER = 5.0, 40.0  # radii of walls
LYING, UPRIGHT, SLANTED = (0, 1, 0), (0, 0, 1), (0.2, 0.9, 0.5)


def reach(rods):
    """Least and largest distance of the first rod from the axis of the walls."""
    seen = geometry.from_above(*tuples(rods[0, PLACE:DIRECTOR], rods[0, DIRECTOR:VELOCITY]))
    ends = [geometry.beyond(seen, s) for s in (-HALF, HALF)]
    least = min(ends)
    if geometry.passes(seen, HALF, np.sqrt(least)):
        least = geometry.beyond(seen, -seen[1] / seen[2])
    return np.sqrt(least), np.sqrt(max(ends))


@pytest.mark.parametrize("speed", [0.1, 3.0])
@pytest.mark.parametrize("friction", [SMOOTH, ROUGH], ids=["smooth", "rough"])
@pytest.mark.parametrize(
    "director", [LYING, UPRIGHT, (0, 0, -1), SLANTED, (1, 0.3, 0.1), (1, 0, 0)]
)
@pytest.mark.parametrize("wall", ["inner", "outer"])
def test_m10_no_wall_is_entered_beyond_the_soft_overlap(wall, director, friction, speed):
    """Side or cap, thrown at it squarely or not; the rod comes back, slower than it came."""
    half = HALF * unit(director)
    radius = INNER if wall == "inner" else OUTER
    room = 0.52 + abs(half[0]) + (0 if wall == "inner" else 0.5)
    place = (radius + room, 0, 0) if wall == "inner" else (radius - room - 0.5, 0, 0)
    velocity = (-speed if wall == "inner" else speed, 0.2 * speed, 0.1 * speed)
    scene = within(**{wall: Wall(radius, LOSSY.normal, friction)})
    flying = Rods(scene, states((place, director, velocity)), dt=1e-4)
    deepest, energy = -np.inf, flying.kinetic()
    for _ in range(int(2.5 / speed / 1e-4 / 20)):
        flying.go(20)
        least, largest = reach(flying.rods)
        deepest = max(deepest, INNER + 0.5 - least if wall == "inner" else largest + 0.5 - OUTER)
    assert 0 < deepest < 1.05 * deepest_overlap(LOSSY, 1.05 * speed)
    assert flying.kinetic() < energy
    out = flying.rods[0, VELOCITY]
    assert out > 0 if wall == "inner" else out < 0.3 * speed


def test_m7_the_distance_of_nearly_parallel_rods_is_exact():
    """To 4 units in the last place of their lengths, down to the angle from which ends alone count.

    Where they are closest is known to a rounding over the squared angle, no better.
    """
    random = np.random.default_rng(8)
    for angle in 10.0 ** np.random.default_rng(1).uniform(-9, 0, 200):
        a, b = np.array([1.0, 0, 0]), np.array([np.cos(angle), 0, np.sin(angle)])
        s, t = random.uniform(-1, 1, 2)
        apart = np.array([0, 0.97, 0]) - s * a + t * b
        near, inside, skew = between_ends(*tuples(apart, a, b), HALF)
        if angle < 0.9e-6:
            assert not inside
        elif angle > 1.1e-6:
            assert inside
            assert abs(np.linalg.norm(near.gap) - 0.97) <= 4 * np.spacing(HALF)
            assert abs(near.s - s) < 4e-15 / skew


@pytest.mark.parametrize("seed", range(4))
def test_m8_crossing_rods_do_not_pass_through_each_other(seed):
    """However fast: stopped before half a diameter, or turned back.

    An axis that has come to the other side of the other one has gone through it.
    """
    random = np.random.default_rng(seed)
    soft = md.constant_restitution(0.65, 2e3, tangential_ratio=3)
    scene = meeting(soft.normal, SMOOTH)
    across = [random.uniform(-1, 1), 0, 1]
    place = random.uniform(-2, 2), 1.2, random.uniform(-2, 2)
    for speed in (1, 5, 60):
        first = place, [1, 0.05, 0.1], (0, -speed, 0)
        second = (0, 0, 0), across
        flying = Rods(scene, states(first, second), dt=2e-4)
        why = DONE
        for _ in range(int(2 / speed / 2e-4 / 10)):
            _, why = flying.march(10)
            if why != DONE:
                break
            assert flying.rods[0, PLACE + 1] > flying.rods[1, PLACE + 1] + 1 - DEEP - 0.3
        assert (why == DONE) == (speed < 60)


def test_m8_what_is_too_deep_is_named():
    engine = prepare(ring())
    engine.rods[3, :VELOCITY] = engine.rods[1, :VELOCITY] + 1e-3
    with pytest.raises(md.RunError, match=r"rods 1 and 3: overlap 0\.99\d d with each other"):
        engine.go(10)
    engine = prepare(ring("rods.count=2"))
    engine.rods[1, PLACE + 2] -= 1
    before = engine.rods.copy()
    with pytest.raises(md.RunError, match=r"rod 1: overlap 1 d with the plate") as error:
        engine.go(10)
    np.testing.assert_array_equal(error.value.state, before)
    engine = prepare(ring())
    engine.rods[4, VELOCITY:TURN] = 0, 0, 3e3
    with pytest.raises(md.RunError, match=r"rod 4: moved more than 0.25 d in a step at t = "):
        engine.go(10)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e200])
def test_m16_nonsense_ends_the_run_in_the_step_in_which_it_appears(bad):
    engine = prepare(ring("rods.count=2"))
    engine.go(5)
    before = engine.rods.copy()
    engine.rods[1, VELOCITY + 1] = bad
    with pytest.raises(md.RunError, match="rod 1: its state is not finite") as error:
        engine.go(1000)
    assert engine.step == 5
    np.testing.assert_array_equal(error.value.state[0], before[0])


def test_a_gap_barely_wider_than_a_rod():
    """Rods stay in it, upright and along it; a gap narrower than a rod is refused."""
    narrow = ("annulus.outer=3.0", "annulus.inner=1.99", "rods.count=4", "plate.acceleration=4")
    result = md.run(ring(*narrow), periods=5)
    rho = np.hypot(*result.rods[:, :2].T)
    assert np.abs(rho - 2.495).max() < 0.02
    assert result.tilt_deg < 10
    with pytest.raises(ValueError, match=r"annulus.outer must be at least a diameter beyond"):
        ring("annulus.outer=2.98", "annulus.inner=1.99")


@pytest.mark.parametrize(
    ("place", "director"),
    [((5.499, 0, 0), (0, 0, 1)), ((5.499, 0, 0), (0, 0.6, 0.8)), ((7.501, 0, 0), (0, 0, 1))],
    ids=["caps, inner wall", "beside the inner wall", "caps, outer wall"],
)
@pytest.mark.parametrize("shaken", [True, None])
def test_a_rod_that_rises_with_shaken_walls_feels_no_friction(place, director, shaken):
    """Exactly, as long as it touches; walls at rest slow it."""
    walls = {n: Wall(r, LOSSY.normal, ROUGH) for n, r in (("inner", 5.0), ("outer", 8.0))}
    scene = within(**walls, plate=Motion(np.full(1, -1e3), np.full(1, 0.1)), shaken=shaken)
    rod = Rods(scene, states((place, director, (0, 0, 0.1)))).go(30)
    assert abs(rod.rods[0, VELOCITY]) > 1e-3
    assert (rod.rods[0, VELOCITY + 2] == 0.1) == bool(shaken)


@pytest.mark.parametrize("rough", ["inner", "outer"])
def test_a_rod_pressed_between_shaken_walls_moves_with_them(rough):
    """Without the plate, by friction of one wall, whose work is the rod's kinetic energy."""
    radii, friction = {"inner": 5.0, "outer": 5.99}, ROUGH._replace(coefficient=10.0)
    walls = {n: Wall(r, LOSSY.normal, friction if n == rough else SMOOTH) for n, r in radii.items()}
    quarter, dt = 20_000, 1e-4
    turn = np.arange(4 * quarter) * np.pi / 2 / quarter
    plate = Motion(np.full(4 * quarter, -1e3), 0.2 * np.sin(turn))
    still = states(((5.495, 0, 0), (0, 0, 1)))
    rod = Rods(within(**walls, plate=plate, shaken=True), still, dt, watched=True).go(quarter)
    assert rod.rods[0, VELOCITY + 2] == pytest.approx(0.2, rel=2e-3)
    assert rod.watchers.ledger[PLATE_WORK] == pytest.approx(0.2**2 / 2, rel=4e-3)


def test_rods_that_lie_down_and_rods_that_cross_go_on():
    """One on the plate, one dropped across it in a wide gap: finite, and at rest in the end."""
    wide = {n: Wall(r, LOSSY.normal, ROUGH) for n, r in (("inner", 1.0), ("outer", 20.0))}
    scene = within(**wide, plate=Motion(np.zeros(1), np.zeros(1)), gravity=-1.0)
    lying, crossing = ((9, 0, 0.51), [0, 1, 0]), ((9, 0, 1.55), [1, 0, 0], (0, 0, -0.5))
    two = Rods(scene, states(lying, crossing)).go(100_000)
    assert np.isfinite(two.rods).all()
    assert two.kinetic() < 1e-3
    assert (two.rods[:, PLACE + 2] - HALF * np.abs(two.rods[:, DIRECTOR + 2]) > 0.49).all()
