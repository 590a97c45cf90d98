"""The event-located reference against an independent integration.

The equations of motion are written out here from Newton's and Euler's laws, and integrated over s
with t = s^4, in which everything is smooth between switches.
"""

from itertools import product
from math import cos, inf, radians, sin, sqrt

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

import md
from md import soft_impact
from md.kernels import FREE
from md.kernels.contact import Friction, Instant, friction_of_mode

from .track import REVERSAL, SLIDE, SLIP_STICK, each_case, impact_of

ROD = md.Rod()
H, K_SQUARED = ROD.half_length, ROD.gyration_squared
STEPS = 100  # at least, of equal length in s, to the end of a head-on contact


class SoftRod:
    """One rod on a resting plate: y = way up, turn, c_x, c_z, omega, length of the spring."""

    def __init__(self, law, friction, tilt):
        self.normal, self.spring, self.mu, self.tilt = law.normal, law.spring, friction, tilt
        self.mode = 0  # -1, 1: slides with that sign of the slip (of the slider); 0: sticks

    def contact(self, y):
        """Overlap, arm to the contact point, its velocities, and the normal force."""
        way, turn, c_x, c_z, omega, _ = y
        r_x, r_z = -H * sin(self.tilt + turn), -H * cos(self.tilt) - 0.5 - way
        overlap = -2 * H * sin(self.tilt + turn / 2) * sin(turn / 2) - way
        opening, force = c_z - omega * r_x, self.normal.stiffness * overlap
        if overlap > 0:  # beyond the end, which is being located, any force that is negative
            damper = self.normal.quarter / sqrt(1 + r_x**2 / K_SQUARED)
            force *= sqrt(overlap)
            force -= damper * overlap**0.25 * opening
        return overlap, r_x, r_z, c_x + omega * r_z, opening, force

    def friction(self, y):
        """Friction, the rate of the spring, and what crosses zero as the mode ends."""
        overlap, r_x, r_z, slip, _, normal = self.contact(y)
        mass = 1 / (1 + r_z**2 / K_SQUARED)
        sliding, limit = -self.mode * self.mu * normal, self.mu * normal
        if self.spring is None:
            # the slip c_x + omega r_z stays: F + r_z (r_z F - r_x N)/k^2 - omega c_z = 0
            sticking = (y[4] * y[3] + r_z * r_x * normal / K_SQUARED) * mass
            if self.mode == 0:
                return sticking, 0.0, limit - abs(sticking)
            return sliding, 0.0, self.mode * slip
        if overlap <= 0:
            return sliding, 0.0, 1.0
        k = self.spring.root * sqrt(overlap)
        g = 2 * self.spring.damping_ratio * sqrt(k * mass)
        if self.mode == 0:
            force = -k * y[5] - g * slip
            return force, slip, limit - abs(force)
        rate = (-sliding - k * y[5]) / g
        return sliding, rate, self.mode * (slip - rate)

    def derivative(self, s, y):
        if s == 0:
            return np.zeros(6)
        _, r_x, r_z, _, _, normal = self.contact(y)
        force, rate, _ = self.friction(y)
        spin = (r_z * force - r_x * normal) / K_SQUARED
        return 4 * s**3 * np.array((y[3], y[4], force, normal, spin, rate))

    def follow(self, velocity):
        """Velocities after the contact, and the modes that it went through."""
        s, y = 0.0, np.array([0.0, 0.0, *velocity, 0.0])
        _, _, _, along, opening, _ = self.contact(y)
        width = (2.943 * (1.25 / self.normal.stiffness / sqrt(-opening)) ** 0.4) ** 0.25 / STEPS
        how = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-17, "max_step": width}
        self.mode = int(np.sign(along))
        if self.spring is not None:
            probe = solve_ivp(self.derivative, (0, width / 10), y, **how).y[:, -1]
            if self.friction(probe)[2] < 0:  # the slider would run backwards
                self.mode = 0
        ends = [lambda s, y: self.contact(y)[5] if s else 1.0, lambda _, y: self.friction(y)[2]]
        for end in ends:
            end.terminal, end.direction = True, -1
        modes = [self.mode]
        while True:
            done = solve_ivp(self.derivative, (s, inf), y, events=ends, **how)
            over, _ = done.y_events
            s, y = done.t[-1], done.y[:, -1]
            if len(over):
                return y[2:5], modes
            self.switch(y)
            modes.append(self.mode)

    def switch(self, y):
        """Stick if friction can hold the contact, else slip the way it is driven.

        A slider that stops holds: the force of spring and dashpot comes down from its limit.
        """
        before, self.mode = self.mode, 0
        force, _, spare = self.friction(y)
        if before == 0 or (spare < 0 and self.spring is None):
            self.mode = -int(np.sign(force))


LAWS = [md.coulomb(), md.constant_restitution()]
NO_SLIP = 0.0, -1.0, 0.0
each_law = pytest.mark.parametrize("law", LAWS)


@each_law
@pytest.mark.parametrize(
    ("case", "friction", "regime"),
    [
        (SLIDE, 0.4, "slide"),
        (SLIP_STICK, 0.4, "slip-stick"),
        (REVERSAL, 0.4, "slip-reversal"),
        ((radians(20), NO_SLIP), 0.3, "slip-stick"),
        ((radians(-20), NO_SLIP), 10.0, "slip-stick"),
        ((radians(70), NO_SLIP), 3.0, "slip-stick"),
    ],
)
def test_twelve_digits(law, case, friction, regime):
    """It has twelve digits of |c_z| = 1 in 3000 evaluations, rounding being that of a thousand."""
    tilt, velocity = case
    hit = md.impact(tilt, *velocity, friction=friction, law=law, integrator="dop853")
    assert (hit.regime, hit.steps <= 3000) == (regime, True)
    wanted, modes = SoftRod(law, friction, tilt).follow(velocity)
    assert_allclose(hit[:3], wanted, rtol=0, atol=1e-12)
    assert (0 in modes) == (
        regime == "slip-stick" or (regime != "slide" and law.spring is not None)
    )


def test_a_contact_too_stiff_to_follow_ends_in_one_line(monkeypatch):
    """Its first step fails, or its evaluations are too many."""
    stiff = md.constant_restitution(tangential_damping=1e20)
    for law in (stiff, md.coulomb()):
        with pytest.raises(md.RunError, match="cannot follow so stiff a contact; verlet can"):
            md.impact(0.35, 0.5, -1.0, friction=0.3, law=law, integrator="dop853")
        monkeypatch.setattr(soft_impact, "_MOST", 100)


@each_law
@each_case
def test_tolerance_is_kept(law, case):
    """A looser tolerance is cheaper, and gives nearly the digits that were asked for.

    The errors of some forty steps add up, and a switch that moves carries them on.
    """
    best = impact_of(case, law, integrator="dop853", tolerance=1e-13)
    for tolerance in (1e-11, 1e-9, 1e-7, 1e-5):
        found = impact_of(case, law, integrator="dop853", tolerance=tolerance)
        assert_allclose(found[:3], best[:3], rtol=0, atol=100 * tolerance)
        assert found.steps < best.steps


def test_every_contact_ends():
    """It ends with switches nearer to each other, or to the force's end, than the tolerance."""
    laws = [*LAWS, md.constant_restitution(tangential_ratio=1.0, tangential_damping=0.1)]
    for law, tilt, friction, tolerance in product(
        laws, (0, 5, 20, 45, 76), (0.1, 0.4, 1e4), (1e-12, 1e-9, 1e-6)
    ):
        how = {"integrator": "dop853", "tolerance": tolerance}
        hit = md.impact(radians(tilt), 0.5, -1.0, friction=friction, law=law, **how)
        assert 0.3 < hit.restitution < 1


def test_there_is_no_friction_before_the_first_mode():
    """As `kernels` says of FREE; a rod without slip is followed so for its first moment."""
    slip = Instant(now=0.1, drive=0.0, mass=1.0)
    friction = friction_of_mode(Friction(0.4, None), FREE, 1e-3, 1.0, 0.0, slip)
    assert friction == (0.0, 0.0, 1.0)
