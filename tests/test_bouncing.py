"""The bouncing rod against exact results, the NumPy map and the closed forms."""

from math import asin, cos, pi, radians, sqrt

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal

import impact
from impact import ContactGeometry, collide, thin_rod
from impact.bouncing import TURN, Landings, bounce, record
from impact.flight import slide_to_lift

from .sampling import each_law

SPHERE = impact.spherocylinder(0.0, 1.0)
INELASTIC = {"friction": 0.3, "restitution": 0.0}
PAPER = {"friction": 0.3, "restitution": 0.65}
ONE_PERIOD = sqrt(1 + pi**2)  # of the flight of a perfectly inelastic rod


# Phase after many periods (M11)


def test_rests_take_off_at_the_same_phase_for_ever():
    """Gamma 1.5, no restitution: one landing a period, bit for bit the same after 10^6."""
    run = record(SPHERE, gamma=1.5, **INELASTIC, landings=1_000_000, transient=10)
    assert np.all(run.phase == run.phase[0, 0])
    assert_array_equal(np.diff(run.period[0]), 1)
    assert run.flight[0, 0] + run.rest[0, 1] == pytest.approx(1, abs=1e-15)


def test_onset():
    """V_z/V_0 = -sin(x) with x -> 3 sqrt(2 (gamma - 1)): -x^2/6 alone is 3 (gamma - 1) of it."""
    for excess in (1e-3, 1e-5, 1e-7):
        alpha = bounce(SPHERE, gamma=1 + excess, **INELASTIC, landings=2).alpha.mean
        excess = (1 + excess) - 1  # as represented
        assert abs(alpha / (-3 * sqrt(2 * excess)) - 1) < 4 * excess + 1e-8
    # ends, and one rod has no error
    assert np.isnan(bounce(SPHERE, gamma=1 + 2**-52, **INELASTIC, landings=2).alpha.error)


# Hit again at once; rest (M12)


@pytest.mark.parametrize(
    ("tilt_deg", "gamma", "restitution"),
    [
        *((5, 3.3, 0.65), (20, 3.3, 0.65), (25, 2.2, 0.65), (34, 3.3, 0.65), (70, 4, 0.65)),
        *((0, gamma, 0.0) for gamma in (1.05, 1.5, 1.7048, 2.0, 3.0, ONE_PERIOD, 3.5)),
    ],
)
def test_landings_follow_from_one_another(tilt_deg, gamma, restitution):
    """Every landing again from `impact.collide`, every flight from the parabola.

    Without restitution it lands at 1.7048 where the plate turns round, at sqrt(1 + pi^2) after one
    period, and beyond it goes on at once where the plate drops.
    """
    setting = {"friction": 0.3, "restitution": restitution}
    rod = thin_rod(radians(tilt_deg))
    run = record(rod, gamma=gamma, **setting, landings=300, rods=4, transient=0)
    plate = np.cos(run.phase)
    c_x, v = run.c_x, run.c_z - plate
    hits = 0
    assert_array_equal(run.regime, impact.classify(c_x, v, geometry=rod, **setting))
    while np.any(again := v < -1e-12):  # what leaves comes back unchanged
        hits += again
        c_x, v, *_ = collide(c_x, v, geometry=rod, **setting)
    assert_allclose(run.c_x_after, c_x, atol=1e-11)
    assert_allclose(run.c_z_after - plate, np.maximum(v, 0), atol=1e-11)
    assert_array_equal(run.hits > 1, hits > 1)
    assert np.all(run.c_z_after - plate > -1e-15)
    assert run.hits.max() < 1000

    before, after = (Landings(*(x[:, part] for x in run)) for part in (np.s_[:-1], np.s_[1:]))
    rests = after.rest > 0

    @np.vectorize
    def until_lift(speed, phase, rest):
        return slide_to_lift(speed, phase, gamma, 0.3) if rest else (0.0, speed, 0.0)

    wait, c_x, slid = until_lift(gamma * before.c_x_after, before.phase, rests)
    assert_allclose(after.rest, wait / TURN, atol=1e-15)
    assert_allclose(after.c_x, c_x / gamma, rtol=1e-15, atol=1e-15)
    slid += c_x * TURN * after.flight
    assert_allclose(after.travel, slid / (gamma * TURN), rtol=1e-15, atol=1e-14)
    t, lift = TURN * after.flight, asin(1 / gamma)
    rise = np.where(rests, gamma * cos(lift), gamma * before.c_z_after)
    fallen = gamma * np.sin(np.where(rests, lift, before.phase)) + rise * t - t * t / 2
    assert_allclose(gamma * after.c_z, rise - t, atol=1e-12)
    assert_allclose(gamma * np.sin(after.phase), fallen, atol=1e-12)
    assert_allclose(np.diff(run.period + run.phase / TURN), after.flight + after.rest, atol=1e-11)
    if restitution == 0:
        assert_array_equal(rests, gamma * np.sin(before.phase) <= 1)
    if gamma == ONE_PERIOD:
        assert_allclose(after.flight, 1, rtol=1e-14)


@pytest.mark.parametrize(("gamma", "restitution"), [(1.02, 0.65), (1.05, 0.9), (1.2, 0.5)])
def test_chattering_ends_in_rest(gamma, restitution):
    """Hops shrink to rest in finitely many landings, every period.

    Where it all happens while the plate presses, each hop is at most e times its predecessor's
    velocity; gaps between rests are then bounded by log(shortest/longest)/log(e) landings.
    """
    setting = {"friction": 0.3, "restitution": restitution}
    run = record(SPHERE, gamma=gamma, **setting, landings=2000, rods=5, transient=2000)
    gaps = np.concatenate([np.diff(np.flatnonzero(rests)) for rests in run.rest > 0])
    assert gaps.max() <= 2 + np.log(1e-6 * 1e-3) / np.log(restitution)


# The interface


@each_law
def test_any_rod_goes_on(law):
    """Odd geometries, jammed contacts, no losses: it ends, every number finite, nothing below."""
    random = default_rng(8)
    for _ in range(300):
        run = record(
            ContactGeometry(*random.normal(size=2), 10 ** random.uniform(-1.5, 0.5)),
            gamma=1 + 10 ** random.uniform(-12, 2),
            friction=random.choice([0, 0.1, 1, 10, np.inf]),
            restitution=random.choice([0, 0.5, 1]),
            landings=30,
            law=law,
            transient=20,
        )
        assert all(np.all(np.isfinite(column)) for column in run)
        assert np.all(run.flight > 0)
        assert np.all(run.rest >= 0)
        assert np.all(run.c_z - np.cos(run.phase) <= 1e-12)


def test_rods_do_not_depend_on_their_number():
    """Landings of a rod are the same among more rods, and wherever the count begins."""
    setting = {**PAPER, "gamma": 2.7, "geometry": thin_rod(0.2)}
    few, many, other, later = (
        record(**setting, rods=rods, seed=seed, landings=150 - transient, transient=transient)
        for rods, seed, transient in ((2, 11, 0), (7, 11, 0), (2, 12, 0), (2, 11, 30))
    )
    assert_array_equal(few, np.array(many)[:, :2])
    assert_array_equal(np.array(few)[..., 30:], later)
    assert not np.any(few.phase == other.phase)
    assert np.unique(many.c_x[:, 0]).size == 7


def test_means_are_those_of_the_landings():
    setting = {**PAPER, "gamma": 3.3, "landings": 200, "rods": 30}
    run, raw = bounce(thin_rod(0.45), **setting), record(thin_rod(0.45), **setting)
    plate, impulse = np.cos(raw.phase), raw.c_z_after - raw.c_z
    time = (raw.flight + raw.rest).sum(1)
    for name, rods in {
        "alpha": plate.mean(1),
        "alpha_impulse": np.average(plate, axis=1, weights=impulse),
        "falling": (plate < 0).mean(1),
        "drift": raw.travel.sum(1) / time,
        "ratio": -raw.c_z.mean(1) / raw.c_z_after.mean(1),
        "rest": raw.rest.sum(1) / time,
        "again": (raw.hits > 1).mean(1),
    }.items():
        wanted = rods.mean(), rods.std(ddof=1) / sqrt(30)
        assert_allclose(getattr(run, name), wanted, rtol=1e-12)
    for name, values, bins, width in (
        ("phases", raw.phase, 36, TURN / 36),
        ("flights", raw.flight + 1 / 32, 64, 1 / 16),
        ("regimes", raw.regime, 4, 1),
    ):
        counts, _ = np.histogram(values, np.arange(bins + 1) * width)
        density = counts / (width * values.size)
        assert_allclose(getattr(run, name).mean, density)


def test_scale_of_lengths_cancels():
    one, *others = (
        record(thin_rod(0.4, length), gamma=2.5, **PAPER, landings=20)
        for length in (1.0, 2.0**300, 2.0**-900)
    )
    for run in others:
        assert_array_equal(run.c_x_after, one.c_x_after)
