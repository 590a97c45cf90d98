"""One soft impact against the theory of rigid ones, and the laws against their closed forms."""

from dataclasses import replace
from math import degrees, hypot, pi, sqrt

import numpy as np
import pytest

import impact
import md
from md.kernels.contact import Spring, tangential_constants
from md.laws import damping_ratio, head_on_restitution

from .sampling import power
from .track import LAWS, damped

TILTS = np.radians(np.arange(5, 90, 5))
STIFF = 1e9  # k_n in m g/d^(3/2)
ROD, FLAT = md.Rod(), md.Rod(8.0, ends="flat")
ELASTIC = replace(LAWS["elastic"], normal=damped(LAWS["elastic"].normal))
REGIMES = {"slide": 1, "slip-stick": 2, "slip-reversal": 3}


def against_theory(
    velocity=(0.5, -1.0, 0.0),
    tilts=TILTS,
    rod=ROD,
    friction=0.4,
    stiffness=STIFF,
    restitution=0.65,
    **how,
):
    """RMS length of the error of (c_x', c_z') in |c_z|, and the tilts of wrong regimes.

    The restitution of a soft contact depends on its tilt; the theory is asked at the measured one.
    """
    law, errors, wrong = md.coulomb(restitution, stiffness), [], []
    solid = impact.flat_ended_rod if rod.ends == "flat" else impact.spherocylinder
    for tilt in tilts:
        soft = md.impact(tilt, *velocity, friction=friction, rod=rod, law=law, **how)
        rigid = impact.collide(
            *velocity,
            geometry=solid(tilt, rod.length)._replace(k=sqrt(rod.gyration_squared)),
            friction=friction,
            restitution=np.clip(soft.restitution, 0, 1),  # a step's error may be beyond
        )
        errors.append(hypot(soft.c_x - rigid.c_x, soft.c_z - rigid.c_z) / abs(velocity[1]))
        if REGIMES[soft.regime] != rigid.regime:
            wrong.append(degrees(tilt))
    return sqrt(np.mean(np.square(errors))), wrong


# Against the theory, without gravity

APPROACHES = [  # c_x, c_z, omega: slip of both signs, fast, slow and none to speak of, with a spin
    (1.0, -0.5, 0.0),
    (0.5, -1.0, 0.0),
    (1 / 3, -1.0, 0.0),
    (0.05, -1.0, 0.0),
    (-0.5, -1.0, 0.0),
    (0.5, -1.0, 0.1),
    (-0.2, -1.0, -0.1),
]


CONTACT = md.laws.contact_time(md.coulomb(stiffness=STIFF), 1.0)
INTEGRATED = [
    {"integrator": "verlet", "dt": CONTACT / 100},
    {"integrator": "dop853", "tilts": TILTS[::4]},
]
OTHER_RODS = [
    md.Rod(1.0),  # a sphere
    md.Rod(1.5),
    md.Rod(1.5, ends="flat"),
    md.Rod(40.0),  # its arms are longer, its errors are not
    md.Rod(9.5, "thin"),
]


@pytest.mark.parametrize(
    "how",
    [
        # flat ends on either side of 7.1 degrees, where the centre passes the edge
        *({"velocity": v, "rod": rod} for v in APPROACHES for rod in (ROD, FLAT)),
        *({"rod": rod, **how} for rod in (ROD, FLAT) for how in INTEGRATED),
        *({"rod": rod, "tilts": TILTS[::2]} for rod in OTHER_RODS),
        {"friction": 0.0, "velocity": (0.3, -1.0, 0.2)},
        {"friction": np.inf, "velocity": (0.5, -1.0, 0.1)},
        {"restitution": 0.0},
        {"restitution": 1.0},
    ],
    ids=lambda how: " ".join(map(str, how.values()))[:60],
)
def test_every_impact_meets_the_theory(how):
    """The error is 4e-4: at k_n = 1e9 contacts are 5e-4 d deep, and arms change by as much."""
    error, wrong = against_theory(**how)
    assert error <= 4e-4
    assert not wrong


@pytest.mark.parametrize(
    ("velocity", "rod"),
    [((0.5, -1.0, 0.0), ROD), ((0.5, -1.0, 0.1), ROD), ((0.5, -1.0, 0.0), FLAT)],
)
def test_error_falls_as_overlap(velocity, rod):
    """It falls as k_n^(-2/5), the overlap by which the arms of the forces change.

    The next term is smaller by another overlap, 2e-3 d at k_n = 1e7, and bends the slope over six
    decades by no more than a few of these.
    """
    stiffnesses = np.logspace(7, 13, 7)
    errors = [against_theory(velocity, rod=rod, stiffness=one)[0] for one in stiffnesses]
    assert power(stiffnesses, errors) == pytest.approx(-0.4, abs=0.005)
    assert errors[-1] < 3e-6


def test_sphere_forgets_its_tilt():
    """A sphere's tilt changes no more than sin and cos round in every step, sqrt(steps) ulp."""
    hits = [md.impact(t, 0.5, -1.0, friction=0.05, rod=md.Rod(1.0)) for t in (0.0, 0.7, -1.5)]
    for hit in hits:
        assert hit[:4] == pytest.approx(hits[0][:4], rel=1e-13)
        assert hit.regime == "slide"


# Friction zero and infinite, restitution zero and one


def test_plastic():
    """It is over once a step brings it no more than 1e-12 of the overlap closer.

    On both caps, which see each other's forces a step late, a rod goes up at 0.3 % of its speed.
    """
    one, both = (
        md.impact(tilt, 0.0, -1.0, friction=0.3, law=md.coulomb(0.0)) for tilt in (0, pi / 2)
    )
    assert abs(one.restitution) <= 1e-12 * one.max_overlap / one.dt
    assert 0 <= both.restitution < 4e-3


# Restitution head on


@pytest.mark.parametrize(
    ("integrator", "restitution"),
    [
        *(("dop853", e) for e in (0.05, 0.3, 0.65, 0.9, 1.0)),
        *(("verlet", e) for e in (0.3, 0.65, 0.9)),
    ],
)
def test_restitution_is_what_was_asked(integrator, restitution):
    """It is at speeds over four decades, to the tolerance of the integration or of its steps.

    At 1 the end of the force is that of the overlap, where the signal is flat: less is located.
    """
    for law in (md.constant_restitution(restitution), md.coulomb(restitution)):
        for speed in (1e-3, 0.1, 10.0):
            dt = md.laws.contact_time(law, speed) / 1000 if integrator == "verlet" else None
            hit = md.impact(0.0, 0.0, -speed, friction=0.3, law=law, integrator=integrator, dt=dt)
            assert hit.restitution == pytest.approx(restitution, abs=5e-5)


@pytest.mark.parametrize("rod", [ROD, md.Rod(1.0)])
@pytest.mark.parametrize("restitution", [1e-6, 1e-5, 1e-4, 1e-3])
def test_a_strong_dashpot_stops_a_rod_by_the_default_step(restitution, rod):
    law = md.coulomb(restitution)
    found = md.impact(0.0, 0.0, -1.0, friction=0.3, law=law, rod=rod).restitution
    assert found == pytest.approx(restitution, rel=0.02)


def test_damping_ratio_inverts_restitution():
    for restitution in (1e-6, 0.05, 0.25, np.exp(-2), 0.65, 1 - 1e-9, 1.0):
        assert head_on_restitution(damping_ratio(restitution)) == pytest.approx(
            restitution, rel=1e-12
        )


@pytest.mark.parametrize("length", [1.0, 1.001, 2.0, 8.0, 9.5, 100.0])
def test_moment_of_inertia(length):
    """The gyration radius of the solids and of the thin rod, each found here a second time."""
    for rod, body, rounding in (
        (md.Rod(length, ends="flat"), impact.flat_ended_rod, 1e-14),
        (md.Rod(length), impact.spherocylinder, 1e-14),
        (md.Rod(length, "thin"), impact.thin_rod, 1e-15),
    ):
        k = body(0.0, length).k
        assert sqrt(rod.gyration_squared) == pytest.approx(k, rel=rounding)


# Both caps, grazing


@pytest.mark.parametrize(
    ("tilt", "rod"), [(pi / 2, ROD), (pi / 2, FLAT), (0.0, FLAT), (-0.0, FLAT)]
)
def test_both_caps_at_once(tilt, rod):
    """Rods on both caps do not turn, and overlap less by 2^(2/5), having twice the stiffness.

    A rod that comes down on both shows its whole mass to both contacts together; friction below
    acts at half a diameter and turns it only as far as the plate lets it.
    """
    flat = md.impact(tilt, 0.0, -1.0, friction=0.3, law=ELASTIC, rod=rod)
    alone = md.impact(0.0, 0.0, -1.0, friction=0.3, law=ELASTIC)
    assert flat.omega == pytest.approx(0.0, abs=1e-12)
    assert flat.c_x == pytest.approx(0.0, abs=1e-12)
    # a touch inside a step of 1/100 gains what its end loses, to its power 5/2
    assert (flat.restitution, alone.restitution) == pytest.approx((1.0, 1.0), abs=10 * 100**-2.5)
    assert flat.max_overlap == pytest.approx(alone.max_overlap * 0.5**0.4, rel=1e-3)
    assert flat.contact_time == pytest.approx(alone.contact_time * 0.5**0.4, rel=2e-2)


@pytest.mark.parametrize("law", md.LAWS)
@pytest.mark.parametrize("speed", [1e-3, 1e-6, 1e-9])
def test_grazing(law, speed):
    """An impact slowly down, quickly along, fades with its speed, and friction with it."""
    hit = md.impact(0.3, 1.0, -speed, friction=0.3, law=md.LAWS[law]())
    assert 0 <= hit.restitution <= 1 + 1e-3
    assert abs(hit.c_x - 1.0) <= 0.3 * (1 + hit.restitution) * speed
    assert hit.regime == "slide"


def test_tangential_dashpots_add_up():
    """A constant dashpot and one in proportion to the overlap, 0.5 d, add up beside the spring."""
    spring = Spring(2.0, constant_dashpot=3.0, proportional_dashpot=4.0)
    assert tangential_constants(spring, 0.5, 1.0) == (1.0, 5.0)
