"""The event-located reference against an independent integration in 30 digits.

The equations of motion are written out here from Newton's and Euler's laws, and integrated over s
with t = s^4, in which everything is smooth between switches, by Gragg's method (modified midpoint
steps, extrapolated). The step is short enough for 14 digits, which halving it proves.
"""

from itertools import product
from math import inf, pi, radians

import mpmath
import pytest
from mpmath import mp, mpf, sqrt
from scipy.optimize import brentq

import md

DIGITS = 30
ROD = md.Rod()
SEQUENCE = range(2, 22, 2)  # midpoint steps of one step of Gragg's method
STEPS = {True: 32, False: 16}  # of equal length in s, to the end of a head-on contact, by spring


class SoftRod:
    """One rod on a resting plate: y = z, tilt, c_x, c_z, omega, length of the spring."""

    def __init__(self, law, friction, restitution):
        self.h = mpf(ROD.half_length)
        self.k_squared = mpf(ROD.gyration_squared)
        self.stiffness, self.mu, self.spring = mpf(law.normal.stiffness), mpf(friction), law.spring
        self.zeta = mpmath.findroot(
            lambda z: mpmath.exp(-2 * z * mpmath.acos(z) / sqrt(1 - z * z)) - mpf(restitution), 0.15
        )
        self.mode = 0  # -1, 1: slides with that sign of the slip (of the slider); 0: sticks

    def contact(self, y):
        """Overlap, arm to the contact point, its velocities, and the normal force."""
        z, tilt, c_x, c_z, omega, _ = y
        r_x, r_z = -self.h * mp.sin(tilt), -z
        overlap = mpf(1) / 2 - (z - self.h * mp.cos(tilt))
        along, opening = c_x + omega * r_z, c_z - omega * r_x
        if overlap <= 0:  # beyond the end, which is being located
            return overlap, r_x, r_z, along, opening, self.stiffness * overlap
        mass = 1 / (1 + r_x**2 / self.k_squared)
        damper = 2 * self.zeta * sqrt(mpf(5) / 4 * mass * self.stiffness)
        normal = self.stiffness * overlap * sqrt(overlap)
        normal -= damper * sqrt(sqrt(overlap)) * opening
        return overlap, r_x, r_z, along, opening, normal

    def element(self, overlap, r_z):
        """Stiffness and dashpot of the tangential element."""
        mass = 1 / (1 + r_z**2 / self.k_squared)
        stiffness = self.spring.root * sqrt(overlap)
        return stiffness, 2 * self.spring.damping_ratio * sqrt(stiffness * mass)

    def friction(self, y):
        """Friction, the rate of the spring, and what crosses zero as the mode ends."""
        overlap, r_x, r_z, along, _, normal = self.contact(y)
        _, _, _, c_z, omega, length = y
        if self.spring is None:
            # the slip c_x + omega r_z stays: F + r_z (r_z F - r_x N)/k^2 - omega c_z = 0
            sticking = omega * c_z + r_z * r_x * normal / self.k_squared
            sticking /= 1 + r_z**2 / self.k_squared
            if self.mode == 0:
                return sticking, mpf(0), self.mu * normal - abs(sticking)
            return -self.mode * self.mu * normal, mpf(0), self.mode * along
        if overlap <= 0:
            return -self.mode * self.mu * normal, mpf(0), mpf(1)
        k, g = self.element(overlap, r_z)
        if self.mode == 0:
            force = -k * length - g * along
            return force, along, self.mu * normal - abs(force)
        force = -self.mode * self.mu * normal
        rate = (-force - k * length) / g
        return force, rate, self.mode * (along - rate)

    def derivative(self, s, y):
        if s == 0:
            return [mpf(0)] * 6
        _, r_x, r_z, _, _, normal = self.contact(y)
        force, rate, _ = self.friction(y)
        spin = (r_z * force - r_x * normal) / self.k_squared
        of_t = (y[3], y[4], force, normal, spin, rate)
        return [4 * s**3 * part for part in of_t]

    def step(self, s, y, width):
        """Gragg's method."""
        rows = []
        for n in SEQUENCE:
            h = width / n
            before, now = y, [a + h * d for a, d in zip(y, self.derivative(s, y), strict=True)]
            for i in range(1, n):
                slope = self.derivative(s + i * h, now)
                before, now = now, [a + 2 * h * d for a, d in zip(before, slope, strict=True)]
            slope = self.derivative(s + width, now)
            ends = zip(before, now, slope, strict=True)
            row = [[(a + b + h * d) / 2 for a, b, d in ends]]
            for j, coarser in enumerate(rows[-1] if rows else []):
                ratio = mpf(n) / SEQUENCE[len(rows) - 1 - j]
                row.append(
                    [
                        fine + (fine - coarse) / (ratio**2 - 1)
                        for fine, coarse in zip(row[j], coarser, strict=True)
                    ]
                )
            rows.append(row)
        return rows[-1][-1]

    def start(self, y, width):
        """The mode just after the touch, where forces are but begun."""
        _, _, _, along, _, _ = self.contact(y)
        self.mode = int(mpmath.sign(along))
        if self.spring is not None:
            probe = self.step(mpf(0), y, width / 1000)
            if self.friction(probe)[2] < 0:  # the slider would run backwards
                self.mode = 0

    def follow(self, tilt, velocity, parts):
        """Velocities after the contact, and the modes that it went through."""
        z = self.h * mp.cos(mpf(tilt)) + mpf(1) / 2
        y = [z, mpf(tilt), *map(mpf, velocity), mpf(0)]
        speed = -self.contact([z + 0, *y[1:]])[4]
        whole = mpf(2.943) * (mpf(5) / 4 / self.stiffness / sqrt(speed)) ** mpf("0.4")
        width, s = sqrt(sqrt(whole)) / parts, mpf(0)
        self.start(y, width)
        modes = [self.mode]
        while True:
            part = min(width, s) if s else width / 64  # the overlap's roots begin steeply
            after = self.step(s, y, part)
            over = self.signals(after)[0] <= 0
            if over:
                part, after = self.located(s, y, part, 0)
            turned = self.signals(after)[1] < 0
            if turned and s > 0 and self.signals(y)[1] < mpf("1e-20"):  # a mode's first step
                part, after, turned, over = *self.begun(s, y, part), False, False
            if turned:
                part, after = self.located(s, y, part, 1)
            s, y = s + part, after
            if turned:
                self.switch(y)
                modes.append(self.mode)
            elif over:
                return y[2:5], modes

    def begun(self, s, y, width):
        """A step short enough for the signal of a mode to rise over the zero that it began at."""
        for _ in range(30):
            width = width / 2
            after = self.step(s, y, width)
            if self.signals(after)[1] > 0:
                return width, after
        raise AssertionError("the mode does not begin")

    def signals(self, y):
        """What crosses zero at the end of the force and of the mode."""
        return self.contact(y)[5], self.friction(y)[2]

    def located(self, s, y, width, which):
        """Part of a step to the zero of a signal, to 16 digits, and the state there."""

        def signal(part):
            return float(self.signals(self.step(s, y, mpf(part)))[which])

        part = mpf(brentq(signal, 0.0, float(width), xtol=1e-20, rtol=1e-15))
        return part, self.step(s, y, part)

    def switch(self, y):
        """Stick if friction can hold the contact, else slip the way it is driven.

        A slider that stops holds: the force of spring and dashpot comes down from its limit.
        """
        before, self.mode = self.mode, 0
        force, _, spare = self.friction(y)
        if before == 0 or (spare < 0 and self.spring is None):
            self.mode = -int(mpmath.sign(force))


LAWS = [md.coulomb(), md.constant_restitution()]
CASES = [  # tilt in degrees, (c_x, c_z, omega), friction, regime
    (30, (-0.5, -1.0, 0.1), 0.4, "slide"),
    (20, (0.5, -1.0, 0.0), 0.4, "slip-stick"),
    (40, (0.5, -1.0, 0.0), 0.4, "slip-reversal"),
]
each_regime = pytest.mark.parametrize(("tilt_deg", "velocity", "friction", "regime"), CASES)
each_law = pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)


def in_thirty_digits(law, tilt_deg, velocity, friction, finer=1):
    """(c_x, c_z, omega) after the contact, and the modes met."""
    with mpmath.workdps(DIGITS):
        steps = finer * STEPS[law.spring is not None]
        return SoftRod(law, friction, 0.65).follow(radians(tilt_deg), velocity, steps)


def difference(a, b):
    return max(float(abs(p - q)) for p, q in zip(a, b, strict=True))


@each_law
@each_regime
def test_twelve_digits(law, tilt_deg, velocity, friction, regime):
    """Of |c_z| = 1, in at most 3000 evaluations; rounding is that of a thousand of them."""
    hit = md.impact(radians(tilt_deg), *velocity, friction=friction, law=law, integrator="dop853")
    assert (hit.regime, hit.steps <= 3000) == (regime, True)
    wanted, modes = in_thirty_digits(law, tilt_deg, velocity, friction)
    assert difference(wanted, hit[:3]) <= 1e-12
    assert (0 in modes) == (
        regime == "slip-stick" or (regime != "slide" and law.spring is not None)
    )


@each_law
@each_regime
def test_tolerance_is_kept(law, tilt_deg, velocity, friction, regime):
    """A looser tolerance is cheaper, and gives nearly the digits that were asked for.

    The errors of some forty steps add up, and a switch that moves carries them on.
    """

    def hit(tolerance):
        return md.impact(
            *(radians(tilt_deg), *velocity),
            **{"friction": friction, "law": law, "integrator": "dop853", "tolerance": tolerance},
        )

    best = hit(1e-13)
    for tolerance in (1e-11, 1e-9, 1e-7, 1e-5):
        found = hit(tolerance)
        assert difference(best[:3], found[:3]) <= 100 * tolerance
        assert found.steps < best.steps


def test_every_contact_ends():
    """Switches that lie nearer to one another, or to the end of the force, than the tolerance."""
    laws = [*LAWS, md.constant_restitution(tangential_ratio=1.0, tangential_damping=0.1)]
    for law, tilt, friction, tolerance in product(
        laws, (0, 5, 20, 45, 76), (0.1, 0.4, 1e4), (1e-12, 1e-9, 1e-6)
    ):
        hit = md.impact(
            *(radians(tilt), 0.5, -1.0),
            **{"friction": friction, "law": law, "integrator": "dop853", "tolerance": tolerance},
        )
        assert 0.3 < hit.restitution < 1


def test_what_the_reference_cannot_follow():
    """Slip that stops at the touch itself, and a second cap."""
    with pytest.raises(ValueError, match="friction of at most"):
        md.impact(0.3, 0.5, -1.0, friction=inf, integrator="dop853")
    with pytest.raises(ValueError, match="one cap"):
        md.impact(pi / 2, 0.5, -1.0, friction=0.3, integrator="dop853")


@pytest.mark.parametrize("phase", [0.3, 2.5])
def test_a_plate_that_vibrates_is_that_of_the_fixed_steps(phase):
    """Its velocity at the touch, and how it changes during the contact."""
    given = {"friction": 0.4, "law": md.coulomb(stiffness=1e4), "vibration": (0.02, 5.0, phase)}
    exact = md.impact(radians(20), 0.5, -2.0, integrator="dop853", **given)
    steps = md.impact(radians(20), 0.5, -2.0, integrator="verlet", dt=1e-6, **given)
    assert exact[:3] == pytest.approx(steps[:3], abs=1e-4)
    assert exact.restitution == pytest.approx(steps.restitution, abs=1e-4)


@pytest.mark.slow
@each_law
@each_regime
def test_step_is_short_enough(law, tilt_deg, velocity, friction, regime):
    """Half of it gives the same, to far less than the twelve digits that it is compared to."""
    wanted, modes = in_thirty_digits(law, tilt_deg, velocity, friction)
    again, same = in_thirty_digits(law, tilt_deg, velocity, friction, finer=2)
    assert modes == same
    assert difference(wanted, again) <= 1e-14
