"""An effect that a scene leaves out has no code, no memory and no part in the result."""

import re
from math import cos
from typing import NamedTuple

import numpy as np
import pytest

import md
from md.kernels import single
from md.kernels.codes import WATCHED

from . import llvm
from .track import ROD, effects, track

GRAVITY = (0.0, -1.0)
LOOP = llvm.fresh(single.run)  # of code from the disk cache there is no text
VIBRATION = md.Vibration(0.05, 1.0, 0.0)


def scene_of(law=None, friction=0.0, gravity=None, vibration=None, rod=ROD, dt=1e-3):
    """By default nothing but Hertz's force."""
    return effects(law or md.coulomb(1.0), friction, gravity, vibration, dt, rod)


class Code(NamedTuple):
    """What stands in a compiled loop, counted in numbers, not in vectors of them."""

    roots: int
    divisions: int
    remainders: int
    signs_copied: int
    numbers: int  # handed over as arguments
    arguments: int  # of any kind; what is absent is one empty address


def operations(text: str, pattern: str) -> int:
    """Occurrences, one on a vector of n counted n times."""
    found = re.findall(pattern, text)
    return sum(int(width) if width else 1 for width in found)


def compiled(method="leapfrog", watch=None, **scene) -> Code:
    """The loop over steps for one scene, without the wrapper that Python calls."""
    made = scene_of(**scene)
    state = single.started(method, (0, 9, 0), (0, 0, 0), made.gravity, 1e-3)
    LOOP(made, state, 0, 0, 1e-3, watch)
    _, body = llvm.text(LOOP, made, state, 0, 0, 1e-3, watch)
    head, body = body.split("\n", 1)
    return Code(
        roots=operations(body, r"call[^\n]* @(?:llvm\.)?sqrt(?:\.v(\d+)f64)?"),
        divisions=operations(body, r"fdiv (?:<(\d+) x )?double"),
        remainders=operations(body, r"[su]rem (?:<(\d+) x )?i64"),
        signs_copied=operations(body, r"call[^\n]* @llvm\.copysign(?:\.v(\d+)f64)?"),
        numbers=head.count("double %arg."),
        arguments=head.count("%arg."),
    )


@pytest.fixture(scope="module")
def bare() -> Code:
    return compiled()


def test_hertz_alone_has_roots_and_no_division(bare):
    """overlap^(3/2) needs them; masses, dashpots and friction, which divide, are absent."""
    assert bare.roots > 0
    assert bare.divisions == bare.remainders == bare.signs_copied == 0


def test_a_sphere_has_one_cap(bare):
    assert 2 * compiled(rod=md.Rod(1.0)).roots == bare.roots


def test_dissipation_costs_its_root_and_its_mass(bare):
    code = compiled(law=md.coulomb(0.65))
    assert code.roots > bare.roots  # of the overlap to 1/4
    assert code.divisions > 0  # 1/M
    assert code.numbers == bare.numbers + 1


def test_friction_is_there_only_if_there_is_some(bare):
    rubbing = compiled(friction=0.3)
    assert rubbing.divisions > 0
    assert rubbing.numbers == bare.numbers + 1
    assert compiled(law=md.constant_restitution(1.0), friction=0.0) == bare


def test_a_spring_is_there_only_if_the_law_has_one():
    """Cutting it at the limit copies the sign of the force; a constraint has no such step."""
    constraint = compiled(friction=0.3)
    spring = compiled(law=md.constant_restitution(1.0), friction=0.3)
    assert constraint.signs_copied == 0
    assert spring.signs_copied > 0
    assert spring.numbers == constraint.numbers + 2  # its stiffness and its damping
    undamped = compiled(law=md.constant_restitution(1.0, tangential_damping=0.0), friction=0.3)
    assert undamped.numbers == spring.numbers - 1
    assert undamped.roots < spring.roots  # of k M


def test_a_plate_that_vibrates_is_read_from_its_table(bare):
    """The step's number modulo the period's: one remainder for a step, none without the table."""
    code = compiled(vibration=VIBRATION)
    assert code.remainders > 0
    assert code.numbers == bare.numbers
    assert code.arguments > bare.arguments + 2  # two arrays


def test_gravity_is_two_numbers(bare):
    code = compiled(gravity=GRAVITY)
    assert code.numbers == bare.numbers + 2
    assert code[:4] == bare[:4]


def test_what_is_not_asked_for_is_not_recorded(bare):
    assert compiled(watch=np.zeros(WATCHED)).arguments > bare.arguments


def test_gear_alone_carries_derivatives(bare):
    assert compiled("gear").numbers == bare.numbers + 9
    assert compiled("verlet").numbers == bare.numbers


def test_absent_effects_have_no_memory():
    scene = scene_of()
    assert scene.plate is scene.friction is scene.gravity is None
    assert scene.normal[1:] == (None, None, None, None)
    assert scene_of(rod=md.Rod(1.0)).upper is None
    plate = scene_of(vibration=VIBRATION).plate
    assert plate.height.size == plate.velocity.size == 1000


def thrown(method="leapfrog", law=None, friction=0.3, **how):
    """Every step of a rod that is thrown at the plate."""
    scene = scene_of(law or md.coulomb(), friction, dt=1e-5, **how)
    start = 0.0, ROD.half_length * cos(0.3) + 0.5 + 1e-3, 0.3, 0.5, -1.0, 0.1
    return track(scene, start, 1e-5, 5000, method=method)


@pytest.mark.parametrize(
    ("absent", "naught"),
    [
        ({"gravity": None}, {"gravity": (0.0, 0.0)}),
        ({"vibration": None}, {"vibration": md.Vibration(0.0, 20.0, 0.0)}),
        ({"friction": 0.0}, {"friction": 1e-300}),
        ({"law": md.coulomb(1.0)}, {"law": md.coulomb(1 - 1e-16)}),
        (
            {"law": md.constant_restitution(tangential_damping=0.0)},
            {"law": md.constant_restitution(tangential_damping=1e-300)},
        ),
    ],
    ids=["gravity", "vibration", "friction", "dissipation", "tangential damping"],
)
def test_what_is_absent_does_as_what_is_naught(absent, naught):
    """All other forces are the same; a product with zero, and no more, is left out."""
    without, with_naught = thrown(**absent), thrown(**naught)
    np.testing.assert_allclose(without, with_naught, rtol=0, atol=1e-13)
    assert without[-1, 4] > 0  # it has met the plate


@pytest.mark.parametrize("law", [md.coulomb(), md.constant_restitution(), md.appendix_a()])
@pytest.mark.parametrize("integrator", single.METHODS)
def test_no_friction_no_tangential_impulse(integrator, law):
    """Not a bit of c_x changes; Gear's method multiplies and divides it by dt in every step."""
    samples = thrown(integrator, law, friction=0.0)
    rounding = 5000 * 2**-53 if integrator == "gear" else 0.0
    assert np.abs(samples[:, 3] - 0.5).max() <= rounding
    assert samples[-1, 4] > 0
