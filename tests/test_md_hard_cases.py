"""Where a straightforward simulation of a contact breaks, case by case."""

from math import cos, hypot, inf, pi

import numpy as np
import pytest
from numpy.random import default_rng

import md
from md.kernels import DONE
from md.kernels.contact import Friction, Inertia, Kept, Meeting, Normal, Spring, contact
from md.laws import contact_time, deepest_overlap, largest_step

from .sampling import power
from .track import (
    CONTACT,
    LAWS,
    ROD,
    SLIP_STICK,
    alone,
    damped,
    each_case,
    effects,
    impact_of,
    seen,
    stepped,
    track,
)

GRAVITY = 0.0, -1.0
OFFSETS = (np.arange(24) + 0.5) / 24


def velocities(case, law, steps=None, offset=0.5):
    """(c_x, c_z, omega) after an impact with so many steps a contact; None: switches located."""
    how = {"integrator": "dop853"} if steps is None else {"dt": CONTACT / steps, "offset": offset}
    return np.array(impact_of(case, law, **how)[:3])


def impact_track(law, steps=100):
    """Every step of one impact without gravity, from the touch for two contact times."""
    tilt, velocity = SLIP_STICK
    start = 0.0, ROD.half_length * cos(tilt) + 0.5, tilt, *velocity
    return track(effects(law, 0.4), start, CONTACT / steps, 2 * steps)


# M1: the touch falls inside a step


@each_case
@pytest.mark.parametrize(
    ("law", "steps", "least", "most"),
    [
        ("coulomb", 100, 1.1, 1.4),
        ("constant_restitution", 200, 1.1, 1.6),
        ("elastic", 50, 1.7, 3.0),
    ],
)
def test_m1_order_over_the_worst_offset_of_the_touch(case, law, steps, least, most):
    """Largest error over 24 offsets, against steps over a factor 16.

    The dashpot begins as time^(1/4), so a step across the touch errs by its power 5/4. Without a
    dashpot the order is two and more.
    """
    true = velocities(case, LAWS[law])
    number = steps * 2 ** np.arange(5)
    worst = [
        max(abs(velocities(case, LAWS[law], n, o) - true).max() for o in OFFSETS) for n in number
    ]
    assert least <= -power(number, worst) <= most


def test_m1_offset_is_the_part_of_a_step_before_the_touch():
    """A whole step more is the same touch, but for rounding; half a step is another one."""
    late, half, early = (velocities(SLIP_STICK, md.coulomb(), 100, o) for o in (0, 0.5, 1))
    assert late == pytest.approx(early, rel=1e-9)
    assert abs(half - late).max() > 1e-6


# M2: the end of a contact with a dashpot


@pytest.mark.parametrize("law", LAWS)
def test_m2_the_plate_never_pulls(law):
    """c_z never falls: F_n >= 0. With a dashpot the force ends before the overlap does."""
    samples = impact_track(LAWS[law], steps=400)
    gained = np.diff(samples[:, 4])
    assert gained.min() >= 0
    last = np.flatnonzero(gained)[-1] + 1
    overlap = 0.5 - samples[last, 1] + ROD.half_length * cos(samples[last, 2])
    assert (overlap > 1e-4) == (law in ("coulomb", "constant_restitution"))


@pytest.mark.parametrize("law", [md.coulomb(), md.constant_restitution()])
def test_m2_the_end_of_the_force_is_the_end_of_the_contact(law):
    """The end's time is right to a step or two, and no step is made after it."""
    true = impact_of(SLIP_STICK, law, integrator="dop853")
    for dt in (CONTACT / 200, CONTACT / 2000):
        hit = impact_of(SLIP_STICK, law, dt=dt)
        assert abs(hit.contact_time - true.contact_time) <= 2 * dt
        assert hit.steps * dt <= hit.contact_time + 2 * dt
        assert hit.restitution == pytest.approx(true.restitution, abs=2 * dt / CONTACT)


# M3: slip at the end of stick


def last_slip(law, **how):
    """Slip after the last step with a force."""
    samples = impact_track(law, **how)
    after = samples[np.flatnonzero(np.diff(samples[:, 4]))[-1] + 1]
    return after[3] - after[5] * after[1]


def test_m3_no_slip_is_left_by_the_constraint():
    """The softer the contact, the more its arm changes, by which slip is left."""
    assert abs(last_slip(md.coulomb())) <= 1e-6


def test_m3_a_spring_leaves_slip_as_one_over_its_ratio():
    """The spring lets the contact point go as fast as the limit that it follows shrinks."""
    ratios = [30.0, 300.0, 3000.0]
    slips = [
        last_slip(md.constant_restitution(tangential_ratio=ratio), steps=1000) for ratio in ratios
    ]
    assert slips == pytest.approx([0.16 / ratio for ratio in ratios], rel=0.1)


# M4: the spring's history as it is cut


@each_case
@pytest.mark.parametrize("law", ["constant_restitution", "appendix_a"])
def test_m4_a_cut_spring_keeps_the_order(law, case):
    """It is 0.9 or more from the coarsest stable step to one 64 times finer, without a floor."""
    number = 60 * 2 ** np.arange(7)
    true = velocities(case, LAWS[law], 200_000)
    errors = [
        np.median([hypot(*(velocities(case, LAWS[law], n, o) - true)) for o in OFFSETS])
        for n in number
    ]
    assert -power(number, errors) >= 0.9
    assert (errors <= 2 * errors[0] * (60 / number) ** 0.9).all()


def drawn_touches():
    """(tilt, velocity) of impacts at speed 1 whose slip stops, or nearly so."""
    random = default_rng(5)
    for _ in range(12):
        tilt, slip, omega = random.uniform((0.4, -0.3, -0.3), (0.9, 0.6, 0.3))
        arm = -ROD.half_length * np.sin(tilt), -ROD.half_length * cos(tilt) - 0.5
        yield tilt, (slip - omega * arm[1], omega * arm[0] - 1.0, omega)


@pytest.mark.parametrize(
    ("ratio", "damping", "restitution"),
    [(0.6, 0.36, 0.7), (0.6, 0.36, 0.999), (1.4, 0.02, 0.8), (30.0, 1.0, 0.65), (50.0, 0.1, 0.65)],
)
def test_m4_a_slider_that_gives_way_or_stops_within_a_step(ratio, damping, restitution):
    """Averaged over the phases of the step, the error is below 1/steps^2, and of second order."""
    law = md.constant_restitution(restitution, tangential_ratio=ratio, tangential_damping=damping)
    number, errors = np.array([24, 48, 96]), []
    for case in drawn_touches():
        true = velocities(case, law)
        found = [[velocities(case, law, n, o) for o in OFFSETS[::2]] for n in number]
        errors.append(np.mean(found, axis=1) - true)
    size = np.sqrt(np.mean(np.square(errors), axis=(0, 2)))
    assert -power(number, size) > 1.5  # nearer to the second order than to the first
    assert (size < 1 / number**2).all()


def test_m4_a_spring_without_dashpot_keeps_its_energy():
    """A ball rolls to and fro on it for 250 periods of 20 steps: its slip keeps its size to 1 %."""
    ball, law = md.Rod(1.0), md.constant_restitution(tangential_damping=0.0)
    deep = (1 / law.normal.stiffness) ** (2 / 3)
    dt = np.sqrt(0.1 / (3.5 * law.spring.root * np.sqrt(deep)))
    start = 0.0, 0.5 - deep, 0.0, 1e-5, 0.0, 0.0
    samples = track(effects(law, inf, GRAVITY, rod=ball), start, dt, 5000)
    slip = samples[:, 3] - (0.5 - deep) * samples[:, 5]
    assert np.std(slip[-200:]) == pytest.approx(np.std(slip[1:201]), rel=0.01)


# M5: creep


@pytest.mark.parametrize("law", ["coulomb", "constant_restitution"])
def test_m5_a_rod_pushed_with_less_than_friction_does_not_creep(law):
    """A thousand periods at 60 Hz and d = 0.6 cm last 674 sqrt(d/g); a twentieth of it settles."""
    scene, steps = effects(LAWS[law], 0.3, (0.29, -1.0)), round(674 * 1.05 / 6e-5)
    lying = 0.0, 0.5, pi / 2, 0.0, 0.0, 0.0  # just touching, at rest
    samples = track(scene, lying, 6e-5, steps, every=1000)
    settled = samples[len(samples) // 20 :, 0]
    assert settled[0] > 1e-7  # as the spring or the first bounces let it
    assert np.ptp(settled) < 1e-10


# M6: the largest stable step


def largest_at(tilt, law, friction=True, caps=1):
    """The largest step of an impact at speed 1."""
    arms = np.square([ROD.half_length * cos(tilt) + 0.5, ROD.half_length * np.sin(tilt)])
    return largest_step(law, friction, 1.0, *arms / ROD.gyration_squared, caps)


@pytest.mark.parametrize("law", LAWS)
def test_m6_too_large_a_step_is_refused_with_the_largest(law):
    law = LAWS[law]
    largest = largest_at(SLIP_STICK[0], law)
    impact_of(SLIP_STICK, law, dt=0.999 * largest)
    with pytest.raises(ValueError, match=f"dt must be between .* and {largest:.3g}"):
        impact_of(SLIP_STICK, law, dt=1.001 * largest)


def rests(law, part, tilt, friction):
    """Whether a rod pressed to the overlap of an impact at speed 1 stays there.

    `part`: of the step that is called the largest. Upright on one cap, or flat on both.
    """
    caps, deep = (2 if tilt else 1), deepest_overlap(law, 1.0)
    dt = part * largest_at(tilt, law, friction > 0, caps)
    gravity = 0.0, -law.normal.stiffness * deep**1.5 * caps
    scene = effects(law, friction, gravity)._replace(normal=damped(law.normal))
    start = 0.0, ROD.half_length * cos(tilt) + 0.5 - deep, tilt
    push = 1e-7 if friction else 0.0, 1e-7, 1e-7 if tilt else 0.0
    state = alone(scene, (*start, *push))
    _, why = stepped(scene, state, dt, 20_000)
    return why == DONE and np.abs(seen(state)[:3] - start).max() < 1e-3 * deep


@pytest.mark.parametrize(
    ("law", "tilt", "friction"),
    [
        ("coulomb", 0.0, 0.0),
        ("coulomb", pi / 2, 0.0),
        ("elastic", pi / 2, 0.0),
        ("constant_restitution", pi / 2, 0.4),
    ],
)
def test_m6_stable_just_below_the_largest_and_not_far_above(law, tilt, friction):
    """The limit is right to 5 percent where normal forces act alone, with a spring on the safe
    side: by less than four times.
    """
    assert rests(LAWS[law], 0.98, tilt, friction)
    assert not rests(LAWS[law], 4.0 if friction else 1.05, tilt, friction)


def growth(law, bodies, n, dt):
    """Factor by which the slip of n contacts alike grows in a step at most, under a steady load.

    Each sees the others' friction as of the step before.
    """
    arms = ((0.0, -1.0), (0.0, 1.0))[:bodies]
    deep, light, nothing = deepest_overlap(law, 1.0), 2.0 * bodies, (0.0, 0.0)
    force, friction = law.normal.stiffness * deep**1.5, Friction(1e60, law.spring)

    def step(slip, spring, rub):
        kept, gain = Kept(force, (rub,), (spring,)), (n * light * rub, 0.0)
        bodies = tuple((arm, arm) for arm in arms)
        meeting = Meeting(bodies, (0.0, 1.0), deep, (slip, 0.0), gain, kept, nothing)
        found = contact(law.normal, friction, Inertia(1.0, None), meeting, dt).kept
        return slip + dt * n * light * found.rub[0], found.spring[0], found.rub[0]

    return abs(np.linalg.eigvals(np.transpose([step(*unit) for unit in np.eye(3)]))).max()


@pytest.mark.parametrize("damping", [1e-9, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0, 3.0])
@pytest.mark.parametrize("rods", [False, True])
def test_m6_contacts_that_rub_alike_are_stable_at_the_largest_step(rods, damping):
    """Up to three of a rod with walls, up to four with rods, to two percent.

    Not at four times the step; with rods not at 1.1 times, unless dashpots are critical.
    """
    law = md.constant_restitution(1.0, tangential_ratio=1e4, tangential_damping=damping)
    bodies, most, damped, beyond = (2, 4, 0.9, 1.1) if rods else (1, 3, None, 4.0)
    grown = []
    for n in range(1, most + 1):
        largest = largest_step(law, True, 1.0, 2.0 * bodies - 1, 1.0, n, late=n, damped=damped)
        assert growth(law, bodies, n, 0.98 * largest) < 1 + 1e-9
        grown.append(growth(law, bodies, n, beyond * largest))
    if not rods:
        assert min(grown) > 1
    elif damping < 1:
        assert max(grown) > 1


# Long steps


def test_a_long_step_has_the_restitution_asked_for_on_average():
    """Spheres head on at 10 steps a contact, over 24 offsets of the touch: 0.65 to 0.0015.

    With dashpots that see an extrapolated velocity it would be 0.636.
    """
    law, sphere = md.constant_restitution(0.65), md.Rod(1.0)
    found = [
        md.impact(
            0.0, 0.0, -1.0, friction=0.0, law=law, rod=sphere,
            dt=contact_time(law, 1.0) / 10, offset=offset,
        ).restitution
        for offset in OFFSETS
    ]  # fmt: skip
    assert np.mean(found) == pytest.approx(0.65, abs=1.5e-3)


@pytest.mark.parametrize("overlap", [0.0, 1e-10, 1e-8])
def test_a_new_spring_is_as_long_as_the_slip_at_most(overlap):
    """Also one that relaxes in 4e3 steps and more, and at an overlap of 0, as rounding makes it.

    The contact closes as fast as it slips.
    """
    friction = Friction(0.3, Spring(proportional=4.75e8, constant_dashpot=200.0))
    arm, nothing, kept = (0.0, -1.0), (0.0, 0.0), Kept(0.0, (0.0,), (0.0,))
    new = Meeting(((arm, arm),), (0.0, 1.0), overlap, (1.0, -1.0), nothing, kept, nothing)
    found = contact(Normal(5e6, constant=200.0), friction, Inertia(1.0, None), new, 2.4e-4)
    assert 0 <= found.kept.spring[0] <= overlap


# M16: a state that is no longer one


def test_m16_an_impact_that_is_too_deep_says_so():
    """A rod touches at speed 1; its other cap, at 79, is 0.5 d deep before the touch is over."""
    spin = 39.0 / ROD.half_length
    with pytest.raises(md.RunError, match=r"^rod 0: 0\.5 d deep in the plate, or"):
        md.impact(pi / 2 - 1e-6, 0.0, -40.0, spin, friction=0.0, law=md.coulomb(1.0, 1e4))
