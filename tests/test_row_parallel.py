"""Two rods side by side: forces without a jump, distances to rounding, forces from an energy."""

from math import cos, pi, sin, sqrt

import mpmath
import numpy as np
import pytest

from md.kernels.closest import near_end

from .rows import ELASTIC, EPS, HALF, LIGHT, SOFT, elastic, ends, forces, free, tip_on_side


def lipschitz(overlap):
    """Largest change of force or torque per displacement of any end, four ends at most.

    Force: 3/2 k sqrt(d) along the normal and k d^(3/2)/r across it; torque: arms of at most
    HALF + 1/2 and what the arm itself moves.
    """
    force = SOFT * overlap**1.5
    steep = 1.5 * SOFT * sqrt(overlap) + force / (1 - overlap)
    return 4 * (steep * (HALF + 0.5) + 2 * force) * LIGHT + 4 * steep


@pytest.mark.parametrize("shift", [0.0, 0.5, 3.0, 8.3, 8.5])
def test_force_and_torque_are_continuous_across_parallel(shift):
    """The closest point jumps by a rod's length at 1e-8 rad; the four ends' forces do not.

    A turn by a moves an end by HALF a. Rounding of places of size HALF moves it by HALF EPS.
    """
    angles = np.concatenate([-np.logspace(-6, -12, 25), [0.0], np.logspace(-12, -6, 25)])
    rods = [[(0.0, 0.0, 0.3), (0.99, shift, 0.3 + a)] for a in angles]
    for states in rods:  # apart across the axis, not along x
        x = 0.99 * cos(0.3) + shift * sin(0.3)
        states[1] = (x, shift * cos(0.3) - 0.99 * sin(0.3), states[1][2])
    engine = free(ELASTIC, rods[0])
    found = np.array([forces(engine, states) for states in rods])
    assert np.abs(found).max() > 1
    moved = HALF * np.diff(angles) + 8 * HALF * EPS
    steps = np.abs(np.diff(found, axis=0)).max(axis=(1, 2))
    assert np.all(steps <= lipschitz(0.02) * moved)


def test_a_cap_slides_past_the_other_rods_end_without_a_jump():
    """Cap on side becomes cap on cap: force and torque follow every displacement of 1e-3 d."""
    places_along = np.linspace(3.5, 5.5, 2001)
    engine = free(ELASTIC, tip_on_side(0.4, 0.0))
    found = np.array([forces(engine, tip_on_side(0.4, p, -0.02)) for p in places_along])
    steps = np.abs(np.diff(found, axis=0)).max(axis=(1, 2))
    assert np.abs(found[0]).max() > 100
    assert not found[-1].any()
    assert np.all(steps <= lipschitz(0.02) * np.diff(places_along) * (1 + 1e-9))


def test_distances_of_nearly_parallel_rods_are_accurate():
    """Each end's distance against 50 digits, to 4 ulp of the largest number that cancels."""
    random = np.random.default_rng(5)
    worst = 0.0
    for _ in range(400):
        tilt = random.uniform(-pi, pi)
        turn = random.choice([0, 1e-16, 1e-12, 1e-8, 1e-4, 1]) * random.uniform(-1, 1)
        a, b = (sin(tilt), cos(tilt)), (sin(tilt + turn), cos(tilt + turn))
        along, off = random.uniform(-9, 9), random.uniform(0.5, 1.5)
        dx, dz = along * a[0] + off * a[1], along * a[1] - off * a[0]
        for end in range(4):
            got = np.hypot(*near_end((dx, dz), a, b, HALF, end).gap)
            worst = max(worst, abs(got - exact_distance(dx, dz, a, b, end)))
    assert worst <= 4 * EPS * 9


def exact_distance(dx, dz, a, b, end):
    """From an end of one segment to the other segment, 50 digits."""
    with mpmath.workdps(50):
        dx, dz, half = mpmath.mpf(dx), mpmath.mpf(dz), mpmath.mpf(HALF)
        mine, other = ([mpmath.mpf(v) for v in axis] for axis in ((a, b) if end < 2 else (b, a)))
        if end >= 2:
            dx, dz = -dx, -dz
        side = half if end & 1 else -half
        x, z = dx + side * mine[0], dz + side * mine[1]
        foot = (x * other[0] + z * other[1]) / (other[0] ** 2 + other[1] ** 2)
        foot = min(max(foot, -half), half)
        return float(mpmath.hypot(x - foot * other[0], z - foot * other[1]))


def test_force_is_minus_the_gradient_of_the_energy():
    """Central differences of a brute-force energy; h = 1e-6 errs by h^2 k and EPS E/h."""
    random = np.random.default_rng(2)
    engine, touching = free(ELASTIC, [(0, 0, 0), (0, 0, 0)]), 0
    for number in range(80):
        lean, other = random.uniform(-pi, pi), random.choice([1e-9, 1e-3, 1]) * random.normal()
        off, along = random.uniform(0.95, 1.0), random.uniform(-9, 9)
        if number % 2:  # ends that meet
            along = np.copysign(random.uniform(8.2, 8.6), along)
        place = (off * cos(lean) + along * sin(lean), along * cos(lean) - off * sin(lean))
        state = np.array([(0.0, 0.0, lean), (*place, lean + other)])
        if max(overlap for overlap, *_ in ends(rods_at(state), HALF, 0, 1)) > 0.3:
            continue
        got = forces(engine, state)
        touching += bool(got.any())
        for rod in range(2):
            for c in range(3):
                h = np.zeros((2, 3))
                h[rod, c] = 1e-6
                up, down = energy_at(state + h), energy_at(state - h)
                slope = -(up - down) / 2e-6 * (LIGHT if c == 2 else 1)
                size = SOFT * 1e-9 + np.abs(got).max() * 1e-7
                assert got[rod, c] == pytest.approx(slope, abs=size)
    assert touching > 40


def rods_at(state):
    """Rods at rest there."""
    return np.array([(x, z, sin(t), cos(t), 0, 0, 0) for x, z, t in state])


def energy_at(state):
    """Elastic energy there."""
    return elastic(rods_at(state), HALF, LIGHT, SOFT)[1]
