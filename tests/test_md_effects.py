"""An effect that a scene leaves out has no code, no memory and no part in the result."""

import re
from math import cos

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


def compiled(method="leapfrog", watch=None, **scene):
    """The loop over steps for one scene, without the wrapper that Python calls."""
    made = scene_of(**scene)
    state = single.started(method, (0, 9, 0), (0, 0, 0), made.gravity, 1e-3)
    LOOP(made, state, 0, 0, 1e-3, watch)
    given = {"effects": made, "state": state, "first": 0, "steps": 0, "dt": 1e-3, "watch": watch}
    return llvm.text(LOOP, **given)


RUBBING = {"friction": 0.3, "vibration": VIBRATION}
SPRING = {"law": md.constant_restitution(1.0)}
UNDAMPED = {"law": md.constant_restitution(1.0, tangential_damping=0.0)}
EFFECTS = {  # the loop with them, without them; arguments, and an instruction that only it needs
    "dissipation, gravity and record": (
        {"law": md.coulomb(0.65), "gravity": GRAVITY, "watch": np.zeros(WATCHED)},
        {},
        {"effects.normal.quarter": "fdiv", "effects.gravity": "", "watch": ""},
    ),
    "friction and vibration": (
        RUBBING,
        {},
        {"effects.friction": "fdiv", "effects.plate": "[su]rem (?:<.*> )?i64"},
    ),
    "flat ends": ({"rod": md.Rod(8.0, ends="flat")}, {}, {"effects.flat": ""}),
    "tangential spring": (
        RUBBING | UNDAMPED,
        RUBBING,
        {"effects.friction.spring": r"llvm\.copysign"},
    ),
    "tangential damping": (
        RUBBING | SPRING,
        RUBBING | UNDAMPED,
        {"effects.friction.spring.damping_ratio": ""},
    ),
}


@pytest.mark.parametrize(("there", "gone", "marks"), EFFECTS.values(), ids=EFFECTS)
def test_absent_effects_have_no_code(there, gone, marks):
    llvm.assert_absent(compiled(**there), compiled(**gone), marks)


def roots(**scene):
    """Roots in the loop, a first step peeled off it left out; one of n numbers counts n times."""
    mark = r"call[^\n]* @(?:llvm\.)?sqrt(?:\.v(\d+)f64)?\((?![^\n]*peel)"
    found = re.findall(mark, compiled(**scene).body)
    return sum(int(width or 1) for width in found)


def test_gear_alone_carries_derivatives():
    heads = (compiled(method).body.split("\n", 1)[0] for method in ("leapfrog", "verlet", "gear"))
    n, verlet, gear = (head.count("double %arg.") for head in heads)
    assert (verlet, gear) == (n, n + 9)


def test_a_sphere_has_one_cap():
    assert 2 * roots(rod=md.Rod(1.0)) == roots() > 0


def test_absent_effects_have_no_memory():
    scene = scene_of()
    assert scene.plate is scene.friction is scene.gravity is None
    assert scene.normal[1:] == (None, None, None, None)
    assert scene.flat is None
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


@pytest.mark.parametrize("law", [md.coulomb(), md.appendix_a()])
@pytest.mark.parametrize("integrator", single.METHODS)
def test_no_friction_no_tangential_impulse(integrator, law):
    """Not a bit of c_x changes; Gear's method multiplies and divides it by dt in every step."""
    samples = thrown(integrator, law, friction=0.0)
    rounding = 5000 * 2**-53 if integrator == "gear" else 0.0
    assert np.abs(samples[:, 3] - 0.5).max() <= rounding
    assert samples[-1, 4] > 0
