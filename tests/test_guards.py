"""What many rods must not do: pass through things, explode, lose the phase, go on as nan."""

from contextlib import nullcontext
from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_array_equal

import md
from md import kernels
from md.host import plate_motion, prepare
from md.kernels import (
    C_Z,
    DEEP,
    DIRECTOR,
    PLACE,
    PLATE_WORK,
    TURN,
    VELOCITY,
    touches,
)
from md.kernels.contact import ContactForces
from md.kernels.state import Motion, Walls
from md.laws import deepest_overlap

from .rows import (
    ELASTIC_PLANE,
    HALF,
    LIGHT,
    LOSSY,
    ROLLS,
    ROUGH,
    ROW_VELOCITY,
    SMOOTH,
    SOFT,
    SPACE,
    go,
    in_plane,
    in_space,
    kinetic,
    radii,
    ring,
    row,
    started,
    unit,
)
from .sampling import EPS

# M8: rods that cross, deep overlap, tunnelling


LYING = 0, 0, pi / 2
INTO_LYING = {
    "an end deep in a side": (0.0, 4.7, 0),
    "through in a step": (1.3, 5.26, 0, 0, -6e4, 0),
    "in one place": LYING,
}


@pytest.mark.parametrize("name", INTO_LYING)
def test_m8_rods_that_pass_into_one_another_are_stopped(name):
    """They are stopped at once, with rods and time, as they were when all was legal."""
    engine = started(ELASTIC_PLANE, in_plane(LYING, INTO_LYING[name]))
    why = r"rods 0 and 1: more .* at t = |rod 1: moved more than 0.25 d in a step at t = "
    with pytest.raises(md.RunError, match=why) as caught:
        go(engine, 200)
    assert engine.step <= 20
    assert np.isfinite(caught.value.state).all()


def test_m8_no_rod_may_move_by_more_than_half_the_deepest_overlap_in_a_step():
    for part in (0.99, 1.01):
        engine = started(ELASTIC_PLANE, in_plane((0, 0, 0), (20, 0, 0)), 1e-3)
        engine.rods[1, C_Z] = part * 0.5 * DEEP / engine.dt
        with nullcontext() if part < 1 else pytest.raises(md.RunError, match="rod 1: moved more"):
            go(engine, 1)


@pytest.mark.parametrize("seed", range(4))
def test_m8_crossing_rods_do_not_pass_through_each_other(seed):
    """However fast they are, they are stopped before half a diameter, or turned back.

    An axis that has come to the other side of the other one has gone through it.
    """
    random, soft = default_rng(seed), md.constant_restitution(0.65, 2e3).normal
    scene = SPACE._replace(between=ContactForces(soft, SMOOTH))
    across = random.uniform(-1, 1), 0, 1
    place = random.uniform(-2, 2), 1.2, random.uniform(-2, 2)
    for speed in (1, 5, 60):
        first = place, [1, 0.05, 0.1], (0, -speed, 0)
        flying, deep = started(scene, in_space(first, ((0, 0, 0), across), aside=20.0), 2e-4), False
        try:
            for _ in range(int(2 / speed / 2e-4 / 10)):
                one, other = go(flying, 10).rods[:, PLACE + 1]
                assert one > other + 1 - DEEP - 0.3
        except md.RunError:
            deep = True
        assert deep == (speed == 60)


@pytest.mark.parametrize(
    ("columns", "to", "words"),
    [
        (slice(PLACE, DIRECTOR), (0, 0, -1), "rod 3: more than 0.5 d deep in the plate"),
        (slice(PLACE, DIRECTOR), (-1, 0, 0), "rod 3: more than 0.5 d deep in a wall"),
        (slice(PLACE, DIRECTOR), (1, 0, 0), "rod 3: more than 0.5 d deep in a wall"),
        (slice(VELOCITY, TURN), (0, 0, 3e3), "rod 3: moved more than 0.25 d in a step"),
    ],
)
def test_m8_what_is_too_deep_or_too_fast_is_named(columns, to, words):
    engine = prepare(ring())
    outwards = engine.rods[3, :2] / np.hypot(*engine.rods[3, :2])
    engine.rods[3, columns] += (*(to[0] * outwards), to[2])
    before = engine.rods.copy()
    with pytest.raises(md.RunError, match=words) as error:
        go(engine, 10)
    if "deep" in words:
        assert_array_equal(error.value.state, before)


# M10: walls

INNER, OUTER = 5.0, 40.0  # radii of walls


@pytest.mark.parametrize(("speed", "every"), [(0.1, 40), (3.0, 20)])  # a tenth of a contact
@pytest.mark.parametrize("friction", [SMOOTH, ROUGH], ids=["smooth", "rough"])
@pytest.mark.parametrize(
    "director", [(0, 1, 0), (0, 0, 1), (0.2, 0.9, 0.5), (1, 0.3, 0.1), (1, 0, 0)]
)
@pytest.mark.parametrize("inner", [True, False], ids=["inner", "outer"])
def test_m10_no_wall_is_entered_beyond_the_soft_overlap(inner, director, friction, speed, every):
    """A rod thrown at a wall, squarely or not, by side or cap, comes back slower than it came."""
    room, side = 0.52 + abs(HALF * unit(director)[0]), 1 if inner else -1
    radius, place = (INNER, INNER + room) if inner else (OUTER, OUTER - room - 1)
    walls = Walls(LOSSY.normal, friction, INNER, OUTER)
    thrown = (place, 0, 0), director, (-side * speed, 0.2 * speed, 0.1 * speed)
    flying = started(SPACE._replace(walls=walls), in_space(thrown))
    deepest, energy = -np.inf, kinetic(flying)
    for _ in range(int(2.5 / speed / 1e-4 / every)):
        reach = side * (radii(go(flying, every).rods) - radius)
        deepest = max(deepest, 0.5 - reach.min())
    assert 0 < deepest < 1.05 * deepest_overlap(LOSSY, 1.05 * speed)
    assert kinetic(flying) < energy
    assert flying.rods[0, VELOCITY] * side > (0 if inner else -0.3 * speed)


def test_a_rod_pressed_between_shaken_walls_moves_with_them():
    """Friction of both moves it alike, without the plate; its work is the kinetic energy."""
    walls = Walls(LOSSY.normal, ROUGH._replace(coefficient=10.0), 5.0, 5.99)
    quarter = 20_000
    turn = np.arange(4 * quarter) * pi / 2 / quarter
    plate = Motion(np.full(4 * quarter, -1e3), 0.2 * np.sin(turn))
    rod = started(SPACE._replace(walls=walls, plate=plate), in_space(((5.495, 0, 0), (0, 0, 1))))
    rubs = go(rod, quarter // 2).state.memory.forces[:, 3]
    inner, outer = (rubs[slot : slot + 2].sum() for slot in (kernels.INNER, kernels.OUTER))
    assert 0 < inner == pytest.approx(outer, rel=1e-3)
    assert go(rod, quarter // 2).rods[0, VELOCITY + 2] == pytest.approx(0.2, rel=2e-3)
    assert rod.ledger[PLATE_WORK] == pytest.approx(0.2**2 / 2, rel=4e-3)


# M6: the largest stable step


def largest(scene):
    """The largest step that the refusal of a larger one names."""
    with pytest.raises(ValueError, match=r"step.size must be at most .* got 0.5") as caught:
        prepare(replace(scene, step=replace(scene.step, size=0.5)))
    return float(str(caught.value).split("at most ")[1].split()[0])


def test_m6_a_step_that_is_not_stable_is_refused_with_the_largest_that_is():
    """The step that the refusal names is taken; coarse ones are beyond what springs allow."""
    limit, coarse = (largest(row(f"step.coarse={coarse}")) for coarse in ("false", "true"))
    assert coarse > 1.5 * limit
    assert prepare(row(f"step.size={limit}", "step.coarse=false")).dt <= limit
    with pytest.raises(ValueError, match="at most"):
        prepare(row(f"step.size={1.02 * limit}", "step.coarse=false"))
    assert md.run(row(f"step.size={coarse}"), periods=20).finished


def test_m6_the_largest_step_is_stable_for_a_row_pressed_together():
    """Elastic rods that touch both neighbours at both ends are the stiffest, and make no energy.

    Pressed by as much as the impacts that the step is made for. No energy from nothing: by 5 %
    in 200 steps at most, which at the border only bounded oscillations of the ledger's energy take.
    """
    n, law = 6, md.coulomb(1.0, SOFT)
    scene = md.Scene(
        rods=md.scene.Rods(n, 9.5),
        contacts=md.Contacts(rods=md.scene.Contact(law)),
        start=md.Start(tilt_deg=0.0, speed=0.5),
    )
    x = np.arange(n) * (1 - deepest_overlap(law, 0.5) / 2)
    rods = in_plane(*((place, 0.0, 0.0) for place in x))
    rods[:, ROW_VELOCITY] = 0.01 * default_rng(3).uniform(-1, 1, (n, 3))
    engine = go(started(ELASTIC_PLANE, rods, 0.999 * largest(scene)), 1)
    before = engine.energy()
    assert go(engine, 200).energy() < 1.2 * before


@pytest.mark.parametrize("rolling", [False, True])
def test_m6_the_largest_step_is_stable_for_rods_side_by_side(rolling):
    """Upright rods that touch both neighbours at both ends stay at rest as friction holds.

    They overlap as deep as impacts go, and are held where they are, as they would buckle.
    """
    asked = ring(f"rods.rolling={rolling}", "rods.length=9.5", "step.coarse=false")
    deep = deepest_overlap(LOSSY, asked.impact_speed)
    rods = in_space(*(((i * (1 - deep), 0, 0), (0, 0, 1)) for i in range(5)), aside=20.0)
    rods[:, VELOCITY:] = default_rng(2).uniform(-1e-6, 1e-6, (5, 6))
    rods[:, TURN + 2] *= rolling
    top = 1 / (LIGHT * md.Rod(9.5).axial_gyration_squared) - 1
    scene = ROLLS._replace(inertia=ROLLS.inertia._replace(rolling=top)) if rolling else SPACE
    held = ContactForces(LOSSY.normal, ROUGH._replace(coefficient=1e3))
    engine = started(scene._replace(between=held), rods, largest(asked))
    held_at = rods[:, :VELOCITY].copy()
    for _ in range(200):
        go(engine, 1)
        engine.rods[:, :VELOCITY], engine.rods[:, VELOCITY] = held_at, 0
    assert np.abs(engine.rods[:, VELOCITY:]).max() < 1e-5


# M11: the phase


def test_m11_the_plate_follows_the_sine():
    """Where it is at any step of its period differs from the sine by rounding alone."""
    scene, per = row(), 6739
    amplitude, plate = scene.plate_speed / (2 * pi * scene.frequency), plate_motion(scene, per)
    turn = 2 * np.arccos(np.longdouble(-1)) * np.arange(per) / per
    assert np.abs(plate.height + amplitude * np.cos(turn)).max() <= amplitude * 4 * pi * EPS


def test_m11_a_run_a_million_periods_later_is_the_same():
    """Steps are counted: the plate is where it was a million periods ago, to the last bit."""
    late, early = (prepare(row("step.size=3e-4")) for _ in range(2))
    assert early.dt * early.scene.frequency * early.per == pytest.approx(1, abs=2 * EPS)
    late.step = 10**6 * early.per
    go(late, early.per + 17), go(early, early.per + 17)
    assert_array_equal(early.rods, late.rods)
    since = late.record.rows[0, touches.STEP] - early.record.rows[0, touches.STEP]
    assert since == 10**6 * early.per


# M16: a state that is no longer one


@pytest.mark.parametrize("value", [np.nan, -np.inf, 1e200])
@pytest.mark.parametrize("scene", [row("start.drop=0.1"), ring()], ids=["row", "annulus"])
def test_m16_a_state_that_is_not_finite_stops_the_run_at_once(scene, value):
    """A bad number in any rod stops it; given back is what there was, all rods of one moment."""
    engine = go(prepare(scene), 25)
    before = engine.rods.copy()
    first = 0 if not np.isfinite(value) else 2 * len(engine.effects.up)  # of the velocities
    for column in range(first, before.shape[1]):
        engine.rods[:] = before
        engine.rods[2, column] = value
        with pytest.raises(md.RunError, match="rod 2: its state is not finite") as caught:
            go(engine, 1000)
        assert engine.step == 25
        assert_array_equal(np.delete(caught.value.state, 2, 0), np.delete(before, 2, 0))
