"""What a long run keeps: the plate's phase, energy, momentum, contact; and how a bad one stops."""

from math import cos, inf, nan, pi

import mpmath
import numpy as np
import pytest

import md
from md.host import prepare
from md.kernels import single
from md.kernels.codes import C_X, DONE, NOT_FINITE, OMEGA, Z
from md.kernels.plate import plate_at
from md.kernels.single import State
from md.soft_impact import plate_table, stopped_run

from .track import CONTACT, FLAT, LAWS, ROD, effects, track

GRAVITY = 0.0, -1.0


# M11: phase after a million periods


def test_m11_phase_after_a_million_periods():
    """Steps are counted: the plate is where it was a million periods ago, to the last bit.

    And where it is at any step of its period differs from the sine by 1e-14 of a period at most.
    """
    vibration = md.Vibration(0.1, 2.0, 0.3)
    plate = plate_table(vibration, 1 / (2.0 * 997))
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
    scene = effects(law, 0.3, GRAVITY, vibration, dt)
    state = single.started("leapfrog", (0, 4.9, 0.2), (0.3, 0, 0), (0, -1), dt)
    ends = [
        State(*single.run(scene, state, first, 60_000, dt, None)[0])
        for first in (0, 10**6 * scene.plate.height.size)
    ]
    assert ends[0] == ends[1]
    assert ends[0].velocity[0] != 0.3  # it met the plate


# M15: energy and momentum


def residual(law, steps, part, friction, contacts):
    """Of one impact at a tilt of 20 degrees, whose touch falls on some part of a step."""
    scene = md.Scene(
        plate=md.Plate(),
        contacts=md.Contacts(plate=md.Contact(law, friction)),
        start=md.Start(tilt_deg=20, speed=0),
        step=md.Step(CONTACT / steps),
    )
    engine = prepare(scene)
    engine.rods[0, Z] += part * engine.dt
    engine.rods[0, C_X:OMEGA] = 0.5, -1.0
    before = engine.energy()
    engine.go(round(contacts * CONTACT / engine.dt))
    work, *losses = engine.ledger
    return work - sum(losses) - (engine.energy() - before)


@pytest.mark.parametrize(
    ("law", "friction"), [*((law, 0.3) for law in LAWS), ("coulomb", 0.0), ("elastic", 0.0)]
)
def test_m15_energy_ledger_closes_to_second_order(law, friction):
    """Against the energy before, (1 + 0.5^2)/2, at the worst of 16 places of the touch.

    After the contact and in the midst of it, where the overlap holds energy.
    """
    number = 200 * 2 ** np.arange(4)
    for contacts in (0.4, 2.0):
        worst = [
            max(abs(residual(LAWS[law], n, part / 16, friction, contacts)) for part in range(16))
            for n in number
        ]
        assert worst[-1] < 4e-6
        assert -np.polyfit(np.log(number), np.log(worst), 1)[0] >= 1.8


def test_m15_ledger_over_many_impacts_on_a_vibrating_plate():
    """What the plate put in is what was lost and what the rod has more, to 1e-4 of it."""
    scene = md.load(
        "single_rod",
        ["plate.acceleration=2", "plate.frequency_hz=40", "start.tilt_deg=60", "step.size=1e-5"],
    )
    energy = md.run(scene, periods=20).energy
    assert energy["plate_work"] > 0.1
    assert energy["plate_normal"] > 0
    assert energy["plate_friction"] > 0
    assert abs(energy["residual"]) < 1e-4 * energy["plate_work"]


@pytest.mark.parametrize("integrator", single.METHODS)
def test_m15_horizontal_momentum_where_nothing_acts(integrator):
    """Without friction no bit of it changes, however many impacts there are."""
    dt, steps = 4e-5, 1_000_000
    scene = effects(md.coulomb(), 0.0, GRAVITY, md.Vibration(0.05, 0.5, 0.0), dt)
    start = 0.0, 5.0, 0.1, 0.3, 0.0, 0.0
    samples = track(scene, start, dt, steps, every=1000, method=integrator)
    assert np.abs(samples[:, 5]).max() > 0.1  # it was hit
    assert np.abs(samples[:, 3] - 0.3).max() <= 1e-12
    flown = samples[-1, 0] - samples[0, 0]
    assert flown == pytest.approx(0.3 * dt * steps, rel=1e-10)  # the sum of a million parts


# M16: a state that is no longer one


def test_m16_too_deep_stops_with_the_last_good_state():
    """A rod at 900 sqrt(g d) comes 0.53 d deep, and is stopped before it is."""
    start = 0.0, 5.0, 0.0, 0.0, -900.0, 0.0
    with pytest.raises(md.RunError, match="deeper than d/2 in the plate") as error:
        track(effects(md.coulomb(1.0), 0.3, GRAVITY), start, 1e-6, 10**6, every=100)
    _, z, tilt, c_x, c_z, _ = error.value.state
    assert abs(z - ROD.half_length * cos(tilt)) < 1000 * 1e-6  # the limit, to the way of a step
    assert -900 < c_z < 0
    assert c_x == 0


@pytest.mark.parametrize("bad", [nan, inf, -inf, 1e300])
@pytest.mark.parametrize("integrator", single.METHODS)
def test_m16_not_finite_stops_at_once(integrator, bad):
    """In the step in which it appears, with the state that it found."""
    scene = effects(md.coulomb(), 0.0, GRAVITY)
    state = single.started(integrator, (0, 9, 0), (0, 0, 0), (0, -1), 1e-4)
    now, steps, why = single.run(scene, state, 0, 10, 1e-4, None)
    assert (steps, why) == (10, DONE)
    state = State(*now)
    sick = state._replace(velocity=(bad, 0.0, 0.0))
    after, steps, why = single.run(scene, sick, 10, 1000, 1e-4, None)
    assert (steps, why) == (0, NOT_FINITE)
    with pytest.raises(md.RunError, match="not finite") as error:
        stopped_run(why, State(*after), steps, 1e-4)
    assert error.value.state[:3] == state.position


# A contact that lasts


@pytest.mark.parametrize("law", ["coulomb", "constant_restitution"])
def test_a_rod_rests_on_a_vibrating_plate_below_its_gravity(law):
    """Gamma = 0.5, a hundred periods: never off the plate, as deep as its load asks for.

    F_n = 1 + 0.5 sin up to the rod's own oscillation on the contact, a thousand times faster.
    """
    vibration = md.Vibration(0.5 / (2 * pi) ** 2, 1.0, 0.0)
    dt, every = 1 / 17_000, 77
    start = 0.0, 0.5, pi / 2, 0.0, 2 * pi * vibration.amplitude, 0.0
    scene = effects(LAWS[law], 0.3, GRAVITY, vibration, dt)
    samples = track(scene, start, dt, 1_700_000, every=every)
    time = every * dt * np.arange(len(samples))
    late = time > 10
    plate = vibration.amplitude * np.sin(2 * pi * time[late])
    overlap = 0.5 + plate - samples[late, 1]
    load = 2 * LAWS[law].normal.stiffness * np.maximum(overlap, 0) ** 1.5
    assert overlap.min() > 0
    assert load == pytest.approx(1 - 0.5 * np.sin(2 * pi * time[late]), abs=0.02)
    assert np.ptp(samples[late, 0]) < 1e-10


def test_a_rod_leaves_a_plate_above_its_gravity():
    """Gamma = 1.5: there is a flight in every period."""
    vibration = md.Vibration(1.5 / (2 * pi) ** 2, 1.0, 0.0)
    scene = effects(md.coulomb(), 0.3, GRAVITY, vibration, 1e-4)
    samples = track(scene, FLAT, 1e-4, 200_000, every=100)
    time = 1e-2 * np.arange(len(samples))
    gap = samples[:, 1] - 0.5 - vibration.amplitude * np.sin(2 * pi * time)
    for period in range(1, 20):
        assert gap[(time >= period) & (time < period + 1)].max() > 1e-3


def test_a_contact_without_an_end_is_an_error_that_says_so():
    """An upright rod with weight does not leave; after 1e5 contact times the run gives up."""
    with pytest.raises(md.RunError, match="has not ended after") as error:
        md.impact(0.0, 0.0, -1e-3, friction=0.3, gravity=(0.0, -1.0))
    resting = (1 / 5e6) ** (2 / 3)  # overlap
    assert error.value.state[1] == pytest.approx(ROD.half_length + 0.5 - resting, rel=1e-9)
