"""What a long run keeps: the plate's phase, energy, momentum, contact; and how a bad one stops."""

from math import cos, inf, nan, pi

import mpmath
import numpy as np
import pytest

import md
from md import integrators, one_rod
from md.contact import plate_at
from md.laws import contact_time, friction_of

ROD = md.Rod()
LAWS = {
    "coulomb": md.coulomb(),
    "elastic": md.coulomb(1.0),
    "constant_restitution": md.constant_restitution(),
    "appendix_a": md.appendix_a(),
}
CONTACT = contact_time(md.coulomb(), 1.0)
FLAT = (0.0, 0.5, pi / 2), (0.0, 0.0, 0.0)  # just touching, at rest


# M11: phase after a million periods


def test_m11_phase_after_a_million_periods():
    """Steps are counted: the plate is where it was a million periods ago, to the last bit.

    And where it is at any step of its period differs from the sine by 1e-14 of a period at most.
    """
    vibration = md.Vibration(0.1, 2.0, 0.3)
    plate = one_rod._plate_table(vibration, 1 / (2.0 * 997))
    size = plate.height.size
    assert size == 997
    for i in (0, 1, 400, 996):
        assert plate_at(plate, 10**6 * size + i) == (plate.height[i], plate.velocity[i])
        with mpmath.workdps(30):
            angle = 2 * mpmath.pi * i / size + mpmath.mpf(vibration.phase)
            error = plate.height[i] - vibration.amplitude * mpmath.sin(angle)
        assert abs(error) <= vibration.amplitude * 2 * pi * 1e-14


def test_m11_a_run_a_million_periods_later_is_the_same():
    """The same rod let go at step 0 and at step 1e6 periods: bit for bit."""
    vibration, law = md.Vibration(0.05, 0.5, 0.0), md.coulomb()
    dt = 1 / (0.5 * 20_000)
    plate = one_rod._plate_table(vibration, dt)
    rubbing = friction_of(law, 0.3)
    scene = one_rod._scene(ROD, law, rubbing, (0.0, -1.0), plate)
    state = integrators.started("leapfrog", (0, 4.9, 0.2), (0.3, 0, 0), (0, -1), dt)
    ends = [
        integrators.run(scene, state, first, 60_000, dt, None, None, None, 1)[0]
        for first in (0, 10**6 * plate.height.size)
    ]
    assert ends[0] == ends[1]
    assert ends[0].velocity[0] != 0.3  # it met the plate


# M15: energy and momentum


def residual(law, integrator, steps, part, friction, contacts):
    """Of one impact at a tilt of 20 degrees, whose touch falls on some part of a step."""
    dt = CONTACT / steps
    return md.follow(
        *((0.0, ROD.half_length * cos(0.35) + 0.5 + part * dt, 0.35), (0.5, -1.0, 0.0)),
        **{"friction": friction, "law": law, "integrator": integrator, "dt": dt, "gravity": None},
        **{"duration": contacts * CONTACT, "ledger": True},
    ).residual


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("integrator", ["leapfrog", "verlet"])
@pytest.mark.parametrize("law", LAWS)
def test_m15_energy_ledger_closes_to_second_order(law, integrator, friction):
    """Against the energy before, (1 + 0.5^2)/2, at the worst of 16 places of the touch.

    After the contact and in the midst of it, where the overlap holds energy.
    """
    number = 200 * 2 ** np.arange(5)
    for contacts in (0.4, 2.0):
        worst = [
            max(
                abs(residual(LAWS[law], integrator, n, part / 16, friction, contacts))
                for part in range(16)
            )
            for n in number
        ]
        assert worst[-1] < 1e-6
        assert -np.polyfit(np.log(number), np.log(worst), 1)[0] >= 1.8


def test_m15_ledger_over_many_impacts_on_a_vibrating_plate():
    """What the plate put in is what was lost and what the rod has more, to 1e-4 of it."""
    track = md.follow(
        *((0.0, 1.2, pi / 2 - 0.05), (0.2, 0.0, 0.0)),
        **{"friction": 0.3, "duration": 20, "vibration": md.Vibration(0.03, 1.0, 0.0)},
        **{"dt": 1e-5, "ledger": True, "integrator": "verlet", "every": 1000},
    )
    assert track.plate_work > 0.1
    assert track.normal_loss > 0
    assert track.friction_loss > 0
    assert abs(track.residual) < 1e-4 * track.plate_work


@pytest.mark.parametrize("integrator", integrators.METHODS)
def test_m15_horizontal_momentum_where_nothing_acts(integrator):
    """Without friction no bit of it changes, however many impacts there are."""
    track = md.follow(
        *((0.0, 5.0, 0.1), (0.3, 0.0, 0.0)),
        **{"friction": 0.0, "duration": 20, "vibration": md.Vibration(0.05, 0.5, 0.0)},
        **{"integrator": integrator, "every": 1000},
    )
    assert np.abs(track.samples[:, 5]).max() > 0.1  # it was hit
    assert np.abs(track.samples[:, 3] - 0.3).max() <= 1e-12
    flown = 0.3 * track.time[-1] / 0.5
    assert track.samples[-1, 0] == pytest.approx(flown, rel=1e-10)  # the sum of a million parts


# M16: a state that is no longer one


def test_m16_too_deep_stops_with_the_last_good_state():
    """A rod at 900 sqrt(g d) comes 0.53 d deep, and is stopped before it is."""
    how = {"friction": 0.3, "duration": 1.0, "dt": 1e-6, "law": md.coulomb(1.0)}
    with pytest.raises(md.RunError, match="sinks deeper than d/2 into the plate") as error:
        md.follow((0.0, 5.0, 0.0), (0.0, -900.0, 0.0), **how)
    _, z, tilt, c_x, c_z, _ = error.value.state
    assert abs(z - ROD.half_length * cos(tilt)) < 1000 * 1e-6  # the limit, to the way of a step
    assert -900 < c_z < 0
    assert c_x == 0


@pytest.mark.parametrize("bad", [nan, inf, -inf, 1e300])
@pytest.mark.parametrize("integrator", integrators.METHODS)
def test_m16_not_finite_stops_at_once(integrator, bad):
    """In the step in which it appears, with the state that it found."""
    scene = one_rod._scene(ROD, md.coulomb(), None, (0.0, -1.0), None)
    state = integrators.started(integrator, (0, 9, 0), (0, 0, 0), (0, -1), 1e-4)
    state, steps, why = integrators.run(scene, state, 0, 10, 1e-4, None, None, None, 1)
    assert (steps, why) == (10, integrators.DONE)
    sick = state._replace(velocity=(bad, 0.0, 0.0))
    after, steps, why = integrators.run(scene, sick, 10, 1000, 1e-4, None, None, None, 1)
    assert (steps, why) == (0, integrators.NOT_FINITE)
    with pytest.raises(md.RunError, match="not finite") as error:
        one_rod._stopped_run(why, after, steps, 1e-4)
    assert error.value.state[:3] == state.position


@pytest.mark.parametrize("bad", [nan, inf, -inf])
@pytest.mark.parametrize("place", range(6))
def test_m16_no_run_starts_from_nonsense(place, bad):
    start = [0.0, 5.0, 0.1, 0.0, 0.0, 0.0]
    start[place] = bad
    name = ("x", "z", "tilt", "c_x", "c_z", "omega")[place]
    with pytest.raises(ValueError, match=f"^{name} must be a number"):
        md.follow(start[:3], start[3:], friction=0.3, duration=1.0)


# A contact that lasts


@pytest.mark.parametrize("law", ["coulomb", "constant_restitution"])
def test_a_rod_rests_on_a_vibrating_plate_below_its_gravity(law):
    """Gamma = 0.5, a hundred periods: never off the plate, as deep as its load asks for.

    F_n = 1 + 0.5 sin up to the rod's own oscillation on the contact, a thousand times faster.
    """
    vibration = md.Vibration(0.5 / (2 * pi) ** 2, 1.0, 0.0)
    track = md.follow(
        *((0.0, 0.5, pi / 2), (0.0, 2 * pi * vibration.amplitude, 0.0)),
        **{"friction": 0.3, "law": LAWS[law], "duration": 100, "vibration": vibration},
        **{"speed": 0.1, "every": 7, "dt": 6e-5},
    )
    late = track.time > 10
    plate = vibration.amplitude * np.sin(2 * pi * track.time[late])
    overlap = 0.5 + plate - track.samples[late, 1]
    load = 2 * LAWS[law].normal.stiffness * np.maximum(overlap, 0) ** 1.5
    assert overlap.min() > 0
    assert load == pytest.approx(1 - 0.5 * np.sin(2 * pi * track.time[late]), abs=0.02)
    assert np.ptp(track.samples[late, 0]) < 1e-10


def test_a_rod_leaves_a_plate_above_its_gravity():
    """Gamma = 1.5: there is a flight in every period."""
    vibration = md.Vibration(1.5 / (2 * pi) ** 2, 1.0, 0.0)
    track = md.follow(*FLAT, friction=0.3, duration=20, vibration=vibration, speed=0.5, every=7)
    gap = track.samples[:, 1] - 0.5 - vibration.amplitude * np.sin(2 * pi * track.time)
    for period in range(1, 20):
        assert gap[(track.time >= period) & (track.time < period + 1)].max() > 1e-3


def test_a_contact_without_an_end_is_an_error_that_says_so():
    """An upright rod with weight does not leave; after 1e5 contact times the run gives up."""
    with pytest.raises(md.RunError, match="has not ended after") as error:
        md.impact(0.0, 0.0, -1e-3, friction=0.3, gravity=(0.0, -1.0))
    resting = (1 / 5e6) ** (2 / 3)  # overlap
    assert error.value.state[1] == pytest.approx(ROD.half_length + 0.5 - resting, rel=1e-9)
