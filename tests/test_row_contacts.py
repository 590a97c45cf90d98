"""Two rods: conservation, the rigid limit, continuity, and what must not happen."""

import re
from functools import cache
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

import md
from md.host import prepare
from md.kernels.codes import C_X, C_Z, OMEGA, PAIR_FRICTION, PAIR_NORMAL, ROW_VELOCITY

from .rows import ELASTIC, EPS, HALF, LIGHT, SOFT, ends, free, put, tip_on_side


def total_momentum(rods):
    """Momentum and angular momentum, in m sqrt(g d) and m d sqrt(g d)."""
    x, z, _, _, c_x, c_z, omega = rods.T
    return np.array((c_x.sum(), c_z.sum(), (z * c_x - x * c_z + omega / LIGHT).sum()))


# Conservation


@pytest.mark.parametrize("lean", [0.0, 0.3, 1.2, 1.56])
def test_momentum_and_angular_momentum_are_kept(lean):
    """With friction, springs and dashpots: a force acts on both rods at one point.

    Each of some 500 steps rounds the sum of two velocities of at most 2, the moment arms are at
    most 5: 500 * 2 * 5 * EPS = 1e-12.
    """
    states = tip_on_side(lean, 1.7)
    states = [(*states[0], 0.3, -1.0, 0.1), (*states[1], -0.2, 0.4, -0.2)]
    engine = free(md.constant_restitution(stiffness=SOFT), states, friction=0.4)
    before = total_momentum(engine.rods)
    engine.go(1)
    touched = engine.rods[:, ROW_VELOCITY].copy()
    engine.go(499)
    assert np.abs(engine.rods[:, ROW_VELOCITY] - touched).max() > 0.1
    assert engine.ledger[PAIR_NORMAL] > 0.01
    assert abs(engine.ledger[PAIR_FRICTION]) > 1e-3 or lean == 0
    np.testing.assert_allclose(total_momentum(engine.rods), before, rtol=0, atol=1e-12)


def test_a_symmetric_collision_stays_symmetric():
    """A turn of the plane by 180 degrees about the origin exchanges the two rods.

    Turned rods add up the same numbers in another order: EPS a step and a factor of 500 steps.
    """
    one = (0.49, 1.2, 0.1, -0.6, 0.2, 0.3)
    two = tuple(value if c in (2, 5) else -value for c, value in enumerate(one))
    engine = free(md.constant_restitution(stiffness=SOFT), [one, two], friction=0.4)
    engine.go(600)
    a, b = engine.rods
    assert a[4] > 0  # they have met
    turned = b * np.array((-1, -1, 1, 1, -1, -1, 1))
    np.testing.assert_allclose(a, turned, rtol=0, atol=600 * 4 * EPS)


@cache
def energy_error(dt):
    """Largest change of the kinetic energy over collisions that touch anywhere in a step."""
    worst = 0.0
    for offset in range(24):
        states = tip_on_side(0.7, 2.0, gap=(1 + offset / 24) * dt)
        states = [(*states[0], 0.0, -1.0, 0.0), (*states[1], 0.0, 0.0, 0.0)]
        engine = free(ELASTIC, states, dt=dt)
        engine.go(int(0.12 / dt))
        r = engine.rods
        assert not any(overlap > 0 for overlap, *_ in ends(r, HALF, 0, 1))
        kinetic = (r[:, C_X] ** 2 + r[:, C_Z] ** 2 + r[:, OMEGA] ** 2 / LIGHT).sum() / 2
        worst = max(worst, abs(kinetic - 0.5))
    assert engine.ledger[:].tolist() == [0] * 5
    return worst


def test_elastic_contacts_keep_energy_to_second_order():
    """Leapfrog: halving the step quarters the error, whichever part of a step the touch falls in.

    Between two steps the order may scatter; over three halvings it holds to a quarter.
    """
    errors = [energy_error(dt) for dt in (2e-3, 1e-3, 5e-4, 2.5e-4)]
    order = np.log2(errors[0] / errors[-1]) / 3
    assert order > 1.75, errors


# The rigid limit


def rigid(states, e):
    """Velocities after a frictionless impact with restitution e at the contact point, closed form.

    J = -(1 + e) v_n / (1/m_1 + 1/m_2 + (r_1 x n)^2/I_1 + (r_2 x n)^2/I_2).
    """
    rods = np.array([(x, z, sin(t), cos(t), *v) for x, z, t, *v in states])
    _, normal, p, q = max(ends(rods, HALF, 0, 1), key=lambda end: end[0])
    touch = (p + q) / 2
    arms = [touch - rod[:2] for rod in rods]
    levers = [arm[1] * normal[0] - arm[0] * normal[1] for arm in arms]
    speeds = [rod[4:6] @ normal + rod[6] * lever for rod, lever in zip(rods, levers, strict=True)]
    rate = speeds[0] - speeds[1]
    impulse = -(1 + e) * rate / (2 + (levers[0] ** 2 + levers[1] ** 2) * LIGHT)
    after = rods[:, ROW_VELOCITY].copy()
    for rod, (sign, lever) in enumerate(zip((1, -1), levers, strict=True)):
        after[rod] += sign * impulse * np.array((*normal, lever * LIGHT))
    return after


@pytest.mark.parametrize("restitution", [1.0, 0.65])
def test_stiff_contacts_collide_as_rigid_rods(restitution):
    """The rods turn and slide by the overlap during the contact: the error falls as k_n^(-2/5).

    Other powers of the overlap, at most 0.05, bend the line by as much.
    """
    errors = []
    stiffnesses = (1e4, 1e5, 1e6, 1e7)
    for stiffness in stiffnesses:
        contact = 3 * (1.25 / stiffness) ** 0.4
        states = tip_on_side(0.7, 2.0)
        states = [(*states[0], 0.3, -1.0, 0.1), (*states[1], 0.0, 0.2, 0.05)]
        law = md.coulomb(restitution=restitution, stiffness=stiffness)
        engine = free(law, states, dt=contact / 2400)
        engine.go(5600)
        errors.append(np.abs(engine.rods[:, ROW_VELOCITY] - rigid(states, restitution)).max())
    slope = np.polyfit(np.log(stiffnesses), np.log(errors), 1)[0]
    assert errors[-1] < 1e-4
    assert slope == pytest.approx(-0.4, abs=0.02), errors


@pytest.mark.parametrize("e", [0.2, 0.65, 0.9])
def test_a_head_on_collision_has_the_restitution_asked_for(e):
    """A cap on the middle of a side turns neither rod: e at every stiffness, to the step's order.

    500 steps a contact, first order where the force ends: 1/500 of the velocity at most.
    """
    states = tip_on_side(0.0, 0.0)
    states = [(*states[0], 0.0, -0.5, 0.0), (*states[1], 0.0, 0.5, 0.0)]
    engine = free(md.coulomb(restitution=e, stiffness=SOFT), states, dt=6e-5)
    engine.go(3000)
    after = engine.rods[0, C_Z] - engine.rods[1, C_Z]
    assert after == pytest.approx(e, abs=2e-3)
    assert np.abs(engine.rods[:, OMEGA]).max() < 1e-12
    lost = (1 - e * e) / 4  # half the reduced mass times the velocity squared
    assert engine.ledger[PAIR_NORMAL] == pytest.approx(lost, abs=2e-3)


# What must not happen


@pytest.mark.parametrize(
    "states",
    [
        pytest.param([(0, 0, pi / 2), (0.0, 4.7, 0)], id="an end deep in a side"),
        pytest.param([(0, 0, pi / 2), (0.0, 5.26, 0, 0, -700.0, 0)], id="fast into a side"),
        pytest.param([(0, 0, pi / 2), (1.3, 5.26, 0, 0, -6e4, 0)], id="through in a step"),
        pytest.param([(0, 0, 0.2), (0, 0, 0.2)], id="in one place"),
    ],
)
def test_rods_that_pass_into_one_another_are_stopped(states):
    """At once, with the rods, the time and the overlap, and as they were when all was legal."""
    engine, why = free(ELASTIC, states), r"rods 0 and 1: overlap .* at t = |rod 1: moved .* at t = "
    with pytest.raises(md.RunError, match=why) as caught:
        engine.go(200)
    assert engine.step <= 20
    assert np.isfinite(caught.value.state).all()
    put(engine, [(0, 0, pi / 2), (0, 5.26, 0)])
    assert engine.go(5) == 5


@pytest.mark.parametrize(("length", "contacts"), [(1.0, 1), (3.0, 2)])
def test_caps_head_on(length, contacts):
    """Spheres and rods end to end have the restitution asked for, the ends' contacts one half each.

    Once they are open, their last forces are forgotten: the next touch begins without.
    """
    law = md.coulomb(restitution=0.65, stiffness=SOFT)
    states = [(0, 0, pi / 2, 0.5, 0, 0), (length, 0, pi / 2, -0.5, 0, 0)]
    engine = free(law, states, length=length, dt=6e-5)
    engine.go(300)
    assert np.count_nonzero(engine.state.listed.forces) == contacts
    engine.go(2700)
    assert not engine.state.listed.forces.any()
    assert engine.rods[1, C_X] - engine.rods[0, C_X] == pytest.approx(0.65, abs=2e-3)
    assert engine.ledger[PAIR_NORMAL] == pytest.approx((1 - 0.65**2) / 4, abs=2e-3)


def crossed(rods):
    """Whether the axes of two rods cross."""

    def side(of, point):
        (x, z), (sine, cosine) = point - of[:2], of[2:4]
        return np.sign(x * cosine - z * sine)

    tips = [[rod[:2] + s * HALF * rod[2:4] for s in (-1, 1)] for rod in rods]
    return all(side(rods[i], tips[1 - i][0]) * side(rods[i], tips[1 - i][1]) < 0 for i in (0, 1))


def test_no_rod_passes_through_another_one():
    """100 throws of any violence, looked at after every step: the run ends before axes cross."""
    random, stopped = np.random.default_rng(0), 0
    for _ in range(100):
        lean, turn = random.uniform(-pi, pi, 2)
        way = random.uniform(-pi, pi)
        speed = 10 ** random.uniform(1, 5)
        velocity = speed * sin(way), speed * cos(way), speed / HALF * random.uniform(-1, 1)
        states = [(0, 0, lean), (-10 * sin(way), -10 * cos(way), turn, *velocity)]
        engine = free(ELASTIC, states)
        try:
            for _ in range(100):
                engine.go(1)
                assert not crossed(engine.rods)
        except md.RunError:
            stopped += 1
    assert stopped > 30


GUIDE = Path(md.__file__).parents[1] / "figures/gallery/GUIDE.md"
OF_PAIRS = re.search(r"\| restitution of the law \|(.*)\n.*\n((?:\|.*\n)+)", GUIDE.read_text())
OVERLAPPED = {"end on": 0, "side by side": 1, "3/4": 3 / 4, "1/2": 1 / 2, "1/4": 1 / 4}


def restitution_of_rods(law: float, overlapped: float) -> float:
    """Of two upright rods that meet along a part of their axes; 0: end on."""
    changes = [
        *("plate=none", "contacts.plate=none", "gravity=none", "box=none", "rods.count=2"),
        *("start.tilt_deg=0", "start.speed=0", "step.size=1e-5", "contacts.rods.friction=0"),
    ]
    scene = md.load("quasi2d", [*changes, f"contacts.rods.restitution={law}"])
    engine, axis = prepare(scene), scene.rods.length - 1
    shift, speed = (1 - overlapped) * axis, 0.35
    across, along = (1 + 1e-6, shift) if overlapped else (0.0, axis + 1 + 1e-6)
    engine.rods[:] = [(0, 0, 0, 1, 0, 0, 0), (across, along, 0, 1, 0, 0, 0)]
    moves = C_X if overlapped else C_Z
    engine.rods[:, moves] = speed, -speed
    engine.go(15_000)
    apart = engine.rods[1] - engine.rods[0]
    turned = shift / 2 * engine.rods[:, OMEGA].sum() if overlapped else 0.0
    return float(apart[moves] - turned) / (2 * speed)


@pytest.mark.parametrize("place", OF_PAIRS[1].strip(" |").split(" | "))
def test_the_restitution_of_a_law_is_that_of_one_contact_point(place):
    """As the guide's table says, to its last digit."""
    column = OF_PAIRS[1].strip(" |").split(" | ").index(place) + 1
    (overlapped,) = (part for name, part in OVERLAPPED.items() if place.startswith(name))
    for line in OF_PAIRS[2].splitlines():
        law, *_ = told = [float(cell) for cell in line.strip(" |").split(" | ")]
        assert restitution_of_rods(law, overlapped) == pytest.approx(told[column], abs=0.0075)
