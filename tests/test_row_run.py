"""Whole runs of rods: energy, momentum, extremes, turns and landings."""

from dataclasses import replace
from math import pi, sin, sqrt

import numpy as np
import pytest

import md
from md.host import prepare
from md.kernels import touches as landings
from md.kernels.codes import (
    C_X,
    C_Z,
    COSINE,
    FELL,
    OMEGA,
    PAIR_FRICTION,
    PLATE_FRICTION,
    PLATE_NORMAL,
    PLATE_WORK,
    ROW_VELOCITY,
    SINE,
    UPRIGHT,
    VELOCITY,
    X,
    Z,
)
from md.scene import Contact, Contacts, Gravity, Plate, Rods, Scene, Start, Step

from .rows import EPS, SOFT, row


def turnover(result):
    """All the energy that went in, out and over."""
    return sum(abs(value) for kind, value in result.energy.items() if kind != "residual")


def closed(result):
    """All is finite, and the energy accounts for itself to 2e-3 of its turnover.

    The ledger is of second order in the step, a fiftieth of a contact: 50^-2 = 4e-4, a few times.
    """
    assert np.isfinite(result.rods).all()
    assert np.isfinite(result.c_x_series).all()
    part = 2e-3 * turnover(result)
    assert abs(result.energy["residual"]) <= part + 1e-9, result.energy
    for kind in ("plate_normal", "rods_normal"):
        assert result.energy[kind] >= -part
    return result


# Energy and momentum


def test_the_ledger_closes_as_the_step_shrinks():
    """Residual over turnover, five rods for two periods: second order.

    Losses go with the velocities of their step. The runs part ways at contacts, which scatters
    single halvings; over three of them the order holds to a quarter.
    """
    found = []
    for step in (3.6e-4, 1.8e-4, 9e-5, 4.5e-5):
        result = md.run(row(f"step.size={step}", "start.speed=0.5"), periods=2)
        found.append(abs(result.energy["residual"]) / turnover(result))
    assert np.log2(found[0] / found[-1]) / 3 > 1.75, found
    assert found[0] < 1e-3, found


STARTS = {"row": row(), "open row": row("box=none", "start.tilt_deg=30"), "annulus": "annulus"}


@pytest.mark.parametrize("kind", STARTS)
def test_rods_start_apart_and_with_no_momentum(kind):
    """In the first step nothing but gravity acts: where rods touch, rounding pushes them.

    Seeded velocities have no mean along the plate, or around the annulus.
    """
    scene = md.load("annulus") if kind == "annulus" else STARTS[kind]
    scene = replace(scene, gravity=None, start=replace(scene.start, speed=0.3))
    engine = prepare(scene)
    before = engine.rods.copy()
    engine.go(1)
    velocity = slice(VELOCITY, None) if kind == "annulus" else ROW_VELOCITY
    np.testing.assert_array_equal(engine.rods[:, velocity], before[:, velocity])
    along = before[:, C_X]
    if kind == "annulus":
        x, y = before[:, 0], before[:, 1]
        along = (x * before[:, VELOCITY + 1] - y * before[:, VELOCITY]) / np.hypot(x, y)
    assert np.abs(along).max() > 0.1
    assert abs(along.mean()) < EPS


def lone(restitution, stiffness, size, gravity=0.0, acceleration=1e-12, **start):
    """An engine of a rod of length 4 just over a plate; all have one kernel."""
    scene = Scene(
        rods=Rods(1, 4.0),
        plate=Plate(acceleration),
        contacts=Contacts(plate=Contact(md.coulomb(restitution, stiffness), 0.3)),
        gravity=Gravity(z=gravity),
        start=Start(**{"tilt_deg": 0.0, "speed": 0.0} | start),
        step=Step(size),
    )
    return prepare(scene)


def test_each_part_of_the_ledger_is_what_the_closed_form_says():
    """A rod that bounces upright loses (1 - e^2) v^2/2; one that slides flat, all its c_x^2/2.

    First order: steps of 1e-4, contacts of about 0.03.
    """
    e, v = 0.65, 1.0
    engine = lone(e, SOFT, 1e-4, drop=1e-6)
    engine.rods[0, C_Z] = -v
    engine.go(1000)
    assert engine.ledger[PLATE_NORMAL] == pytest.approx((1 - e * e) * v * v / 2, rel=3e-3)
    assert abs(engine.ledger[[PLATE_WORK, PLATE_FRICTION]]).max() < 1e-12

    engine = lone(e, SOFT, 1e-4, gravity=-1.0, tilt_deg=90.0)
    deep = (1 / (2 * SOFT)) ** (2 / 3)  # two caps carry the weight
    engine.rods[0, Z] -= deep
    engine.rods[0, C_X] = 0.1
    engine.go(10_000)
    assert abs(engine.rods[0, C_X]) < 1e-6  # it rocks a little still
    assert engine.ledger[PLATE_FRICTION] == pytest.approx(0.1**2 / 2, rel=3e-3)
    stopped_after = 0.1**2 / (2 * 0.3)
    assert engine.rods[0, X] - 0.5 * 4 == pytest.approx(stopped_after, abs=0.1 * 1e-4 * 2)


def test_plate_work_of_an_elastic_bounce():
    """On a plate that rises with u a rod that falls with v leaves with v + 2 u."""
    engine = lone(1 - 1e-9, 1e7, 1e-5, acceleration=3.0)
    engine.step = engine.per // 6  # it rises
    motion = engine.plate
    engine.rods[0, Z] = motion.height[engine.step] + 2.0 + 1e-9
    engine.rods[0, C_Z] = -0.5
    before = engine.energy()
    engine.go(engine.per // 6)
    change, leaves = engine.energy() - before, 0.5 + 2 * motion.velocity[engine.per // 6]
    assert engine.rods[0, C_Z] == pytest.approx(leaves, rel=0.05)
    assert change > 0.1
    assert engine.ledger[PLATE_WORK] == pytest.approx(change, rel=1e-3)
    assert abs(engine.ledger[1:]).max() < 1e-8


def test_nothing_pushes_the_row_along_a_smooth_plate():
    """Friction between rods only: horizontal momentum to 1e-12 over 2000 steps of five rods.

    EPS a rod and step on velocities of order one, 2000 * 5 * EPS = 2e-12 at most, in m sqrt(g d).
    """
    scene = row("contacts.plate.friction=0", "plate.acceleration=6", "start.speed=0.3")
    engine = prepare(scene)
    before = engine.rods[:, C_X].sum()
    engine.go(2000, engine.series(2000 // engine.per))
    assert engine.ledger[PLATE_WORK] != 0
    assert abs(engine.ledger[PAIR_FRICTION]) > 1e-4
    assert engine.rods[:, C_X].sum() == pytest.approx(before, abs=1e-12)


# Extremes


@pytest.mark.parametrize(
    "changes",
    [
        ["plate.acceleration=10"],
        ["box.length=57.4"],  # 85 degrees
        ["box.length=5"],  # upright
        ["rods.count=1", "box.length=1.05"],
        ["rods.count=2", "box.length=2.2"],
        ["rods.length=1"],
        ["rods.length=40", "rods.count=3", "box.length=3.2"],
        ["contacts.plate.friction=5", "contacts.rods.friction=5"],
        ["contacts.plate.friction=0"],
        ["box=none", "start.tilt_deg=30", "plate.acceleration=0"],
    ],
    ids=lambda changes: " ".join(changes),
)
def test_extremes_run_and_account_for_their_energy(changes):
    """Two periods of the row; all stays finite and the ledger closes."""
    result = closed(md.run(row(*changes), periods=2))
    assert result.finished


def test_falls_and_passes_through_the_vertical_are_counted():
    """A rod that spins freely once around passes upright twice and the horizontal twice."""
    scene = Scene(rods=Rods(1, 4.0), start=Start(tilt_deg=10.0, speed=0.0))
    engine = prepare(replace(scene, step=Step(1e-3)))
    series = engine.series(7)._replace(every=10)
    engine.rods[0, OMEGA] = 2 * pi / 4  # once in four periods
    engine.go(4 * engine.per, series)
    assert series.rows[:, FELL].sum() == 2
    assert series.rows[:, UPRIGHT].sum() == 2
    assert engine.rods[0, SINE] == pytest.approx(sin(np.radians(10)), abs=1e-9)
    assert sqrt(engine.rods[0, SINE] ** 2 + engine.rods[0, COSINE] ** 2) == pytest.approx(
        1, abs=4 * EPS
    )


# Landings


def test_landings_are_those_that_every_step_shows():
    """One rod, step by step: the plate pushes where the velocity gains on free fall.

    Touch, duration, cap, velocities before and after, approach and departure, from the states.
    """
    scene = md.load("single_rod", ["contacts.plate.stiffness=1e5", "start.tilt_deg=35"])
    engine = prepare(scene)
    half, dt, per = engine.effects.half_length, engine.dt, engine.per
    plate = engine.effects.plate
    states = [engine.rods[0].copy()]
    for _ in range(8 * per):
        engine.go(1)
        states.append(engine.rods[0].copy())
    states = np.array(states)
    pushed = np.abs(np.diff(states[:, C_Z]) + dt) > 1e-12 * dt * SOFT
    begins = np.flatnonzero(pushed & ~np.append(False, pushed[:-1]))
    stops = np.flatnonzero(~pushed & np.append(False, pushed[:-1]))
    begins = begins[: len(stops)]
    rows = engine.record.rows[: engine.record.count[0]]
    assert len(rows) >= 3
    np.testing.assert_array_equal(rows[:, landings.STEP], begins)
    np.testing.assert_array_equal(rows[:, landings.DURATION], stops - begins)
    np.testing.assert_array_equal(rows[1:, landings.FLIGHT], begins[1:] - stops[:-1])
    assert np.isnan(rows[0, landings.FLIGHT])
    for columns, at in ((landings.BEFORE, begins), (landings.AFTER, stops)):
        np.testing.assert_array_equal(rows[:, columns : columns + 3], states[at, ROW_VELOCITY])
    height, velocity = plate.height[begins % per], plate.velocity[begins % per]
    first, last = states[begins], states[stops]
    cap = np.where(first[:, COSINE] > 0, -1, 1)
    np.testing.assert_array_equal(rows[:, landings.CAP], cap)
    a_x, a_z = cap * half * first[:, SINE], height - first[:, Z]
    np.testing.assert_allclose(rows[:, [landings.A_X, landings.A_Z]], np.array([a_x, a_z]).T)
    np.testing.assert_array_equal(rows[:, landings.PLATE], velocity)
    np.testing.assert_allclose(
        rows[:, landings.APPROACH], first[:, C_Z] - first[:, OMEGA] * a_x - velocity, atol=1e-13
    )
    leaves = (
        last[:, C_Z] - last[:, OMEGA] * cap * half * last[:, SINE] - plate.velocity[stops % per]
    )
    np.testing.assert_allclose(rows[:, landings.LEAVING], leaves, atol=1e-13)
    assert np.all(rows[:, landings.PUSHED] == 0)
