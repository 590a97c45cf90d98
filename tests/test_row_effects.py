"""What a scene leaves out has no code in the kernel, no array, and changes no other force."""

from operator import attrgetter

import numpy as np
import pytest

import md
from md import host
from md.host import prepare
from md.kernels.codes import ROW_DIRECTION, ROW_VELOCITY, X, Z
from md.kernels.state import Motion
from md.scene import Box, Contact, Contacts, Gravity, Plate, Rods, Scene, Start, Step

from . import llvm

RIGID = md.coulomb(1.0, 1e5)  # no dashpot
SPRING, LOSSY = (md.constant_restitution(e, 1e5, tangential_damping=0.0) for e in (1.0, 0.65))


def scene(plate=None, rods=None, **parts):
    """Parts of a scene with contacts, each (law, friction)."""
    contacts = Contacts(*(pair and Contact(*pair) for pair in (plate, rods)))
    return ({"plate": Plate()} if plate else {}) | {"contacts": contacts} | parts


REST, TOUCHING = scene(plate=(RIGID, 0.0)), scene(rods=(RIGID, 0.0))
SHAKEN = scene(plate=(RIGID, 0.3)) | {"plate": Plate(1e-3)}
# Effects: scene with them, scene without them, what of an engine each is, which is an argument of
# `march` as well, an instruction that only it needs, and rods that none of them touches (see
# `started`).
EVERY, ALOFT, GROUND = [0, 1, 2, 3], [0, 1, 3], [2, 3]
EFFECTS = {
    "plate": (REST, {}, {"effects.normal": r"@sqrt\("}, ALOFT),
    "gravity and what is measured": (
        REST | {"gravity": Gravity(z=0.0), "ledger": True, "touches": True, "series": True},
        REST,
        {
            "effects.gravity": "",
            "watchers.ledger": "",
            "watchers.record": "sitofp",
            "watchers.series": "[su]div i64|[su]rem i64",
        },
        EVERY,
    ),
    "plate's vibration and friction": (
        SHAKEN,
        REST,
        {"effects.plate": "[su]rem i64", "effects.friction": "= fdiv"},
        ALOFT,
    ),
    "plate's spring and dissipation": (
        SHAKEN | {"contacts": Contacts(Contact(LOSSY, 0.3))},
        SHAKEN,
        {"state.springs": "copysign", "effects.normal.quarter": ""},
        ALOFT,
    ),
    "rod-rod contact": (
        TOUCHING,
        {},
        {
            "effects.between": "pair_forces",
            "state.listed": "",
            "state.scratch.place": "",
            "state.scratch.found": "",
            "state.scratch.batch": "",
        },
        GROUND,
    ),
    "rod-rod friction and box": (
        scene(rods=(SPRING, 0.3), box=Box(1e3)),
        TOUCHING,
        {
            "effects.between.friction": "copysign",
            "state.listed.springs": "",
            "effects.period": r"llvm\.rint",
        },
        GROUND,
    ),
}


@pytest.fixture(scope="module")
def march():
    """The kernel, with its text."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(host, "march", llvm.fresh(host.march))
        yield host.march


def started(ledger=False, touches=False, series=False, **parts):
    """An engine and series: rods 0 and 1 touch, 2 rests deep in the plate, 3 is alone."""
    rods = {"rods": Rods(4, 4.0), "start": Start(tilt_deg=10.0), "step": Step(5e-4, True)}
    engine = prepare(Scene(**rods | parts), ledger=ledger, touches=touches)
    engine.dt, engine.per = 5e-4, 2000
    if engine.plate is not None:  # it vibrates by nothing, so that all have one clock
        at_rest = Motion(np.zeros(1), np.zeros(1))
        engine.effects = engine.effects._replace(plate=at_rest)
    engine.rods[:, X] = 10, 10.99, 40, 80
    engine.rods[:, Z] = 20, 20.1, 1.99, 30
    engine.rods[:, ROW_DIRECTION] = 0, 1
    engine.rods[:, ROW_VELOCITY] = 0.1, 0.01, 0.02
    return engine, engine.series(1)._replace(every=10) if series else None


def compiled(march, parts):
    """Rods after 100 steps of the kernel that these parts need, and its text."""
    engine, series = started(**parts)
    engine.go(100, series)
    engine.watchers = engine.watchers._replace(series=series)
    names = ("effects", "state", "watchers")
    return engine, llvm.text(march, **{name: getattr(engine, name) for name in names})


@pytest.mark.parametrize(("there", "gone", "arguments", "untouched"), EFFECTS.values(), ids=EFFECTS)
def test_absent_effects_cost_nothing(march, there, gone, arguments, untouched):
    """Not read, their instructions not there; no array; the others as they were."""
    (engine, text), (without, bare) = compiled(march, there), compiled(march, gone)
    llvm.assert_absent(text, bare, arguments)
    for path in arguments:
        assert attrgetter(path)(engine) is not None
        assert attrgetter(path)(without) is None
    np.testing.assert_array_equal(engine.rods[untouched], without.rods[untouched])
    assert len(engine.arrays()) >= len(without.arrays())


def test_what_is_absent_everywhere_needs_next_to_nothing():
    """Of a million rods that only fly: places, directions, velocities and accelerations."""
    engine, _ = started()
    state, watchers = engine.state, engine.watchers
    absent = state.forces, state.springs, state.listed, *state.scratch[2:], *watchers
    assert [*absent] == [None] * 9
    assert list(engine.arrays()) == ["rods", "before"]
    assert (engine.effects.between, engine.effects.period) == (None, None)


def test_no_friction_is_the_same_as_a_coefficient_of_zero():
    """And a plate that does not accelerate the same as one at rest: no code for either."""
    free, _ = started(**REST)
    assert free.effects.friction is free.state.springs is free.effects.plate is None
    sphere, _ = started(rods=Rods(4, 1.0))
    assert sphere.effects.upper is None
