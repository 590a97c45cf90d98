"""Two ends that meet: one place, without a jump on the way to two."""

from functools import cache
from math import cos, pi, sin

import numpy as np
import pytest

import md
from md.kernels.codes import PAIR_FRICTION, PAIR_NORMAL

from .rows import ELASTIC, HALF, LIGHT, SOFT, corners, elastic, ends, forces, free

LOSSY = md.constant_restitution(stiffness=SOFT)
DEEP = 0.02  # overlap; ends reach each other up to 0.2 along the axes


def beside(beyond, turn=0.0, overlap=DEEP):
    """A rod along z, and one beside it that overlaps it by `beyond` along the axes."""
    side, up = 1 - overlap, 2 * HALF - beyond
    x, z = side + HALF * sin(turn), up - HALF + HALF * cos(turn)
    return [(0.0, 0.0, 0.0), (x, z, turn)]


def round_the_end(place):
    """A rod along z, and one that leans and goes round its upper end at the overlap DEEP.

    First its end is on the first one's side, `place` < 0 from the end; then end on end, over an
    arc; then the first one's end is on its side.
    """
    lean, reach = 2.0, 1 - DEEP
    arc = reach * (pi - lean)
    angle = pi / 2 - min(max(place, 0.0), arc) / reach
    x, z = reach * sin(angle), HALF + reach * cos(angle) + min(place, 0.0)
    along = HALF - max(place - arc, 0.0)
    return [(0.0, 0.0, 0.0), (x + along * sin(lean), z + along * cos(lean), lean)]


def test_rods_side_by_side_touch_at_two_places_in_full():
    """From where the ends do not reach each other; end to end, and clamped, at one."""
    engine, one = free(ELASTIC, beside(1.0)), SOFT * DEEP**1.5
    for beyond, count in ((4.0, 2), (0.201, 2), (0.0, 1)):
        found = forces(engine, beside(beyond))
        assert found[:, 0] == pytest.approx([-count * one, count * one], rel=1e-9)
        assert np.abs(found[:, 1]).max() < 1e-9 * one
    for place in (0.1, 0.6, 1.1):  # neither end has a foot on the other rod
        found = forces(engine, round_the_end(place))
        assert np.hypot(*found[1, :2]) == pytest.approx(one, rel=1e-9)


def test_ends_a_diameter_apart_to_rounding_push_as_ends_that_are_not_near():
    """Their squared distance is less than 1 as the sum of two squares, and not as it is found."""
    other = 0, 0, 0.2853928232566878
    states = [(0.9494358832968327, -0.9836358090748183, 0.1728756875894829), other]
    engine = free(ELASTIC, states)
    expected = elastic(engine.rods, HALF, LIGHT, SOFT)[0]
    assert forces(engine, states) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("beyond", [1e-3, 0.05, 0.15, 0.5])
def test_an_end_on_a_side_is_one_contact_however_near_the_sides_end(beyond):
    states = [(0.0, 0.0, pi / 2), (HALF - beyond, HALF + 1 - DEEP, 0.0)]
    found = forces(free(ELASTIC, states), states)
    assert found[1] == pytest.approx([0.0, SOFT * DEEP**1.5, 0.0], abs=1e-9 * SOFT)


@pytest.mark.parametrize(
    ("path", "places"),
    [
        pytest.param(beside, np.linspace(-0.2, 0.4, 1201), id="slide past"),
        pytest.param(lambda a: beside(0.1, a), np.linspace(-0.01, 0.01, 1201), id="turn over"),
        pytest.param(lambda a: beside(1e-3, a), np.linspace(-0.01, 0.01, 1201), id="at the end"),
        pytest.param(round_the_end, np.linspace(-0.3, 1.4, 3401), id="round the end"),
    ],
)
def test_no_force_jumps(path, places):
    """Steps of force and torque halve with those of the path: no jump, however small."""
    engine = free(ELASTIC, path(places[0]))
    found = np.array([forces(engine, path(p)) for p in places])
    fine, coarse = (np.abs(np.diff(found[::n], axis=0)).max() for n in (1, 2))
    assert np.abs(found).max() > 50
    assert fine < 0.52 * coarse


def passing(dt, law, friction=0.0, offset=0.0):
    """Two rods that are pressed together while they slide past each other's end."""
    states = beside(0.12 + 10 * offset * dt, 1e-3, overlap=-1e-3)
    states = [(*states[0], 0.0, 0.0, 0.0), (*states[1], -2.0, 10.0, 0.0)]
    return free(law, states, dt=dt, friction=friction)


def test_the_path_of_the_next_tests_leads_from_two_places_to_one():
    engine, seen = passing(1e-4, ELASTIC), set()
    for _ in range(600):
        engine.go(1)
        touching = sum(overlap > 0 for overlap, *_ in ends(engine.rods, HALF, 0, 1))
        seen.add((touching, any(found[0] > 0 for found in corners(engine.rods, HALF, 0, 1))))
    assert seen >= {(2, False), (2, True), (0, False)}, seen


@cache
def energy_error(dt, law, friction=0.0):
    """Largest change of energy and losses over passes that begin anywhere in a step."""
    worst = 0.0
    for offset in range(12):
        engine = passing(dt, law, friction, offset / 12)
        engine.go(1)
        before = engine.energy() + engine.ledger.sum()
        engine.go(int(0.06 / dt))
        assert not any(found[0] > 0 for found in ends(engine.rods, HALF, 0, 1))
        worst = max(worst, abs(engine.energy() + engine.ledger.sum() - before))
    return worst


def test_rods_that_slide_past_each_other_keep_energy_to_second_order():
    errors = [energy_error(dt, ELASTIC) for dt in (2e-4, 1e-4, 5e-5, 2.5e-5)]
    assert np.log2(errors[0] / errors[-1]) / 3 > 1.75, errors


def test_the_ledger_closes_on_the_way():
    """Dashpots and friction act: what is lost is counted once, to the order of the force's end."""
    errors = [energy_error(dt, LOSSY, 0.3) for dt in (1e-4, 5e-5, 2.5e-5)]
    engine = passing(5e-5, LOSSY, 0.3)
    engine.go(1200)
    assert engine.ledger[PAIR_NORMAL] > 0.01
    assert engine.ledger[PAIR_FRICTION] > 0.01
    assert errors[-1] < 0.4 * errors[0]
    assert errors[-1] < 2e-3 * engine.ledger.sum()


def test_one_spring_goes_round_the_end():
    """As end on side becomes end on end, and that side on end, friction neither ends nor doubles.

    The rods are at rest: the spring keeps its length. In a step of 1e-7 they stay so, to the 2e-4
    by which a dashpot lessens the force.
    """
    places, stretched = np.linspace(-0.3, 1.4, 1701), 1e-3
    engine = free(LOSSY, round_the_end(places[0]), friction=10.0, dt=1e-7)
    forces(engine, round_the_end(places[0]))
    listed = engine.state.listed
    touching = [overlap > 0 for overlap, *_ in ends(engine.rods, HALF, 0, 1)]
    listed.springs[listed.turn[0], 0, :, 0] = stretched * np.array(touching)
    found = np.array([forces(engine, round_the_end(place)) for place in places])
    one = np.hypot(SOFT * DEEP**1.5, LOSSY.spring.root * DEEP**0.5 * stretched)
    assert np.hypot(*found[:, 0, :2].T) == pytest.approx(one, rel=3e-4)
    assert np.ptp(np.hypot(*found[:, 0, :2].T)) < 3e-4 * one
