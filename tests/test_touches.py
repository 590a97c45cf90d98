"""Touches of the plate: what every step shows, who pushes, their means, and landings."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import md
from md.host import prepare
from md.kernels import C_Z, COSINE, OMEGA, SINE, WATCH_TOUCHED, Z
from md.kernels.touches import (
    _LEFT,
    A_X,
    AFTER,
    APPROACH,
    BEFORE,
    CAP,
    DURATION,
    FLIGHT,
    LEAVING,
    PLATE,
    PUSHED,
    ROD,
    STEP,
    WIDTH,
    new_record,
    since_touch,
)
from md.measures import HOP, Tables, merged

from .rows import (
    DRIVEN,
    ROW_VELOCITY,
    go,
    recorded,
    ring,
    row,
)

# Single touches


def test_a_rod_that_touches_does_so_since_its_touch_began():
    record = new_record(2, 6)
    record.watch[1, WATCH_TOUCHED] = 1
    record.open[:, _LEFT] = 990, np.nan
    record.open[:, STEP] = 980, 5
    assert since_touch(record, 1000).tolist() == [10, 995]


def test_touches_are_those_that_every_step_shows():
    """The plate pushes in each step of a touch and in no other; others do in the pushed steps.

    Cap, arm, velocities before and after, approach and departure are those of the states. The
    kernel leaves the accelerations of its last step and the forces of the plate in it.
    """
    engine, states, by_plate, by_others = prepare(row("box.length=6.5")), [], [], []
    engine.rods[::2, [SINE, COSINE]] *= -1  # their upper caps are below
    for _ in range(20 * engine.per):
        states.append(engine.rods.copy())
        state = go(engine, 1).state
        of_plate = state.memory.forces[:, 1].reshape(2, -1).sum(axis=0)
        by_plate.append(of_plate != 0)
        by_others.append(np.abs(state.before[:, 0] - of_plate) > 1e-9)
    rows = recorded(engine)
    rows = rows[np.lexsort((rows[:, STEP], rows[:, ROD]))]
    rod, begun, duration = rows[:, [ROD, STEP, DURATION]].astype(int).T
    ended, touching = begun + duration, engine.record.watch[:, WATCH_TOUCHED] > 0
    counts = np.insert(np.cumsum([by_plate, by_others], axis=1), 0, 0, axis=1)
    touched, pushed = counts[:, ended, rod] - counts[:, begun, rod]
    assert_array_equal(touched, duration)
    lasting = touching * since_touch(engine.record, engine.step)
    assert_array_equal(np.bincount(rod, duration) + lasting, counts[0, -1])
    assert_allclose(rows[:, PUSHED], pushed / duration)
    assert 0.1 < (pushed == 0).mean() < 0.9

    flights = np.r_[np.nan, begun[1:] - ended[:-1]]
    flights[np.diff(rod, prepend=-1) > 0] = np.nan
    assert_array_equal(rows[:, FLIGHT], flights)
    cap, plate, half = np.where(rod % 2, -1, 1), engine.plate, engine.effects.half_length
    assert_array_equal(rows[:, CAP], cap)
    for motion, speed, steps in ((BEFORE, APPROACH, begun), (AFTER, LEAVING, ended)):
        at, moving = np.array(states)[steps, rod], plate.velocity[steps % engine.per]
        assert_array_equal(rows[:, motion : motion + 3], at[:, ROW_VELOCITY])
        a_x, a_z = cap * half * at[:, SINE], plate.height[steps % engine.per] - at[:, Z]
        normal = at[:, C_Z] - at[:, OMEGA] * a_x - moving
        assert_allclose(rows[:, speed], normal, rtol=0, atol=1e-13)
        if steps is begun:
            assert_allclose(rows[:, A_X:BEFORE].T, [a_x, a_z])
            assert_array_equal(rows[:, PLATE], moving)


@pytest.mark.parametrize("lean", [0, 1e-9, -1e-9, 0.1, -0.1])
def test_a_touch_is_seen_in_the_plane_of_the_rod(lean):
    """Its x leads around the annulus, for an upright rod as for one that leans either way."""
    engine, up = prepare(ring(DRIVEN, "start.speed=0")), np.cos(lean)
    engine.rods[:, 2] += 20  # all but one are out of the way
    engine.rods[0] = 1.9, 0, engine.plate_height + 2.1, 0, np.sin(lean), up, 0.1, 0.3, -1, 0, 0, 0
    while not engine.record.count[0]:
        go(engine, 100)
    touch = engine.record.rows[0]
    assert touch[BEFORE] == pytest.approx(0.3, abs=5e-3)  # its plane turns as it flies
    assert touch[A_X] == pytest.approx(-1.5 * np.sin(lean), abs=1e-12)
    assert np.abs(touch[BEFORE:]).max() < 20


# Touches merged into landings


def touches(rod, steps, flights):
    """Rows of a record as `merged` reads them: a touch of 3 steps each."""
    table, number = np.zeros((len(steps), WIDTH + 1)), np.arange(len(steps))
    table[:, ROD], table[:, STEP] = rod, steps
    table[:, FLIGHT], table[:, DURATION] = flights, 3
    table[:, PLATE], table[:, -1] = number, 1
    table[:, BEFORE:PLATE] = number[:, None] + (0, 10, 20, 100, 110, 120)
    return table


def test_short_hops_belong_to_the_landing_before():
    """Flights above 20 steps part landings; the last of each rod may go on."""
    one = touches(0, [50, 150, 160, 175, 400], [np.nan, 95, 5, 10, 220])
    rows = np.concatenate([one, touches(1, [60, 70, 300], [80, 5, 150])])
    rows = rows[rows[:, STEP].argsort()]
    over, open_ = merged(rows, 20)
    landings = {
        STEP: [50, 60, 150],  # as the next ones begin
        ROD: [0, 1, 0],
        -1: [1, 2, 3],
        BEFORE: [0, 0, 1],  # of the first touch
        AFTER: [100, 101, 103],  # of the last
        PLATE: [0, 0, 1],
    }
    for column, expected in landings.items():
        assert_array_equal(over[:, column], expected)
    assert_array_equal(open_[:, STEP], [400, 300])
    assert len(merged(rows, 0)[0]) == 6
    assert [len(part) for part in merged(rows[:0], 20)] == [0, 0]


def test_touches_of_one_phase_are_counted_whatever_their_number():
    tables, many = Tables(prepare(row()), 1), 2**16 + 1
    tables.add(touches(0, np.full(many, 1), 5)[:, :-1])
    assert max(tables.results(0, 1)["phases"]) == many


# Means of a run


@pytest.fixture(scope="module", params=[row, ring])
def made(request):
    rows = []
    result = md.run(request.param(DRIVEN), periods=30, observe=rows.append)
    return rows, result


@pytest.mark.parametrize("kind", ["touches", "landings"])
def test_records_have_the_means_and_phases_of_the_run(made, kind):
    """Plate velocities are V_0 cos(phase); counts over the cycle are those of the run."""
    rows, result = made
    read, speed = getattr(md.records, kind), result.scene.plate_speed
    found = read(rows, result)
    assert np.isnan(found.flight).any()
    [along] = found.dims
    behind = (found.time >= result.discarded) & np.isfinite(found.flight)
    part = found.sel({along: behind})
    assert part.sizes[along] > 40
    wanted = {name: value["mean"] for name, value in getattr(result, kind).items()}
    means = {name: part[name].mean() for name in part if name in wanted}
    each, least = md.records.touches(rows, result), HOP if kind == "landings" else -1
    begun = ((each.time >= result.discarded) & (each.flight > least)).sum()
    counted = result.scene.rods.count * (result.periods - result.discarded)
    means |= {
        "per_rod_and_period": begun / counted,
        "flight_periods": part.flight.mean(),
        "plate_velocity": part.plate_velocity.mean() / speed,
        "falling": (part.plate_velocity < 0).mean(),
    }
    if kind == "touches":
        means |= {
            "restitution": -part.v_after.sum() / part.v_before.sum(),
            "contact_periods": part.duration.mean(),
            "slip_stick": (part.regime == "slip-stick").mean(),
            "pushed_by_others": (part.pushed_by_others > 0).mean(),
        }
        counts, _ = np.histogram(part.phase, len(result.phases), (0, 2 * np.pi))
        assert_array_equal(counts, result.phases)
    assert len(means) > 8
    assert means == pytest.approx({name: wanted[name] for name in means}, rel=1e-10)
    step = 2 * np.pi / result.steps_per_period  # in which the plate's velocity is taken once
    at_phases = speed * np.cos(found.phase)
    assert_allclose(found.plate_velocity, at_phases, atol=1.01 * step * speed)
    late = np.concatenate(rows)
    assert read(late, result).equals(found)
    late[:, STEP] += 10**6 * result.steps_per_period
    assert_allclose(read(late, result).phase, found.phase, atol=1e-13)
    assert read([], result).sizes == {along: 0}
