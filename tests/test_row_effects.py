"""What a scene leaves out has no code in the kernel, no array, and changes no other force."""

import re
from operator import attrgetter

import numpy as np
import pytest

import md
from md.host import prepare
from md.kernels import plane
from md.kernels.codes import ROW_DIRECTION, ROW_VELOCITY, X, Z
from md.scene import Box, Contact, Contacts, Gravity, Plate, Rods, Scene, Start, Step

from . import llvm

RIGID = md.coulomb(1.0, 1e5)  # no dashpot
SPRING = md.constant_restitution(1.0, 1e5, tangential_damping=0.0)
AT_REST = {"plate": Plate(), "contacts": Contacts(plate=Contact(RIGID))}
BETWEEN = {"contacts": Contacts(rods=Contact(RIGID))}
SERIES = "series"  # not of the scene


def plate(**contact):
    """A plate at rest with another contact."""
    return AT_REST | {"contacts": Contacts(plate=Contact(**{"law": RIGID} | contact))}


# Effect: scene with it, scene without it, argument of `march` that brings it in,
# an instruction that only it needs, rods that it cannot touch (see `started`).
EVERY, ALOFT, GROUND = [0, 1, 2, 3], [0, 1, 3], [2, 3]
EFFECTS = {
    "gravity": ({"gravity": Gravity(z=0.0)}, {}, "effects.alone.gravity", None, EVERY),
    "plate": (AT_REST, {}, "effects.alone.normal", r"@sqrt\(", ALOFT),
    "plate vibration": (
        AT_REST | {"plate": Plate(1e-3)},
        AT_REST,
        "effects.alone.plate",
        r"[su]rem i64",
        ALOFT,
    ),
    "plate friction": (plate(friction=0.3), AT_REST, "effects.alone.friction", r"= fdiv", ALOFT),
    "spring": (
        plate(law=SPRING, friction=0.3),
        plate(friction=0.3),
        "state.springs",
        "copysign",
        ALOFT,
    ),
    "dissipation": (
        plate(law=md.coulomb(0.65, 1e5)),
        AT_REST,
        "effects.alone.normal.quarter",
        "= fdiv",
        ALOFT,
    ),
    "rod-rod contact": (BETWEEN, {}, "effects.between", "pair_forces", GROUND),
    "rod-rod friction": (
        {"contacts": Contacts(rods=Contact(SPRING, 0.3))},
        BETWEEN,
        "effects.between.friction",
        "copysign",
        GROUND,
    ),
    "periodic box": (BETWEEN | {"box": Box(1e3)}, BETWEEN, "effects.period", r"llvm\.rint", EVERY),
    "ledger": (AT_REST | {"ledger": True}, AT_REST, "watchers.ledger", None, EVERY),
    "touches": (AT_REST | {"touches": True}, AT_REST, "watchers.record", "sitofp", EVERY),
    "series": ({SERIES: True}, {}, "watchers.series", r"[su]div i64|[su]rem i64", EVERY),
}
ARRAYS = {  # of an engine, that an effect needs
    "spring": ("state.springs",),
    "rod-rod contact": ("state.listed", "state.scratch.place", "state.scratch.found"),
    "ledger": ("watchers.ledger",),
    "touches": ("watchers.record",),
}


@pytest.fixture(scope="module")
def march():
    """The kernel, with its text."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plane, "march", llvm.fresh(plane.march))
        yield plane.march


def started(parts):
    """An engine and series: rods 0 and 1 touch, 2 rests deep in the plate, 3 is alone."""
    parts = dict(parts)
    asked = {name: parts.pop(name, False) for name in ("ledger", "touches", SERIES)}
    series = asked.pop(SERIES)
    scene = Scene(
        **{"rods": Rods(4, 4.0), "start": Start(tilt_deg=10.0), "step": Step(5e-4, True)} | parts
    )
    engine = prepare(scene, **asked)
    engine.dt, engine.per = 5e-4, 2000
    motion = engine.plate
    if motion is not None:  # it vibrates by nothing, so that all have one clock
        still = motion._replace(height=motion.height[:1] * 0, velocity=motion.velocity[:1] * 0)
        replace(engine, alone={"plate": still})
    engine.rods[:, X] = 10, 10.99, 40, 80
    engine.rods[:, Z] = 20, 20.1, 1.99, 30
    engine.rods[:, ROW_DIRECTION] = 0, 1
    engine.rods[:, ROW_VELOCITY] = 0.1, 0.01, 0.02
    samples = engine.series(1) if series else None
    return engine, samples and samples._replace(every=10)


def replace(engine, alone=None, **values):
    """Replace parts of an engine's effects."""
    if alone is not None:
        values["alone"] = engine.effects.alone._replace(**alone)
    engine.effects = engine.effects._replace(**values)


def compiled(march, parts):
    """Rods after 100 steps of the kernel that these parts need, its function and whole text."""
    engine, series = started(parts)
    engine.go(100, series)
    engine.watchers = engine.watchers._replace(series=series)
    whole, body = llvm.text(march, engine.effects, engine.state, engine.watchers)
    return engine, body, whole


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_absent_effect_costs_nothing(march, effect):
    """Not read, its instructions not there, fewer instructions; no array; the others as they were.

    Numba names the kernel's arguments in its LLVM text. One that is None remains there as a pointer
    that nothing reads.
    """
    there, gone, path, marker, untouched = EFFECTS[effect]
    engine, body, text = compiled(march, there)
    without, bare, plain = compiled(march, gone)
    argument = llvm.place(getattr(engine, path.split(".")[0]), path)
    assert llvm.passed(body, argument)
    assert not llvm.passed(bare, argument)
    assert llvm.looks(bare, argument) == 0
    if marker:
        assert re.search(marker, text)
        assert not re.search(marker, plain)
    if effect != "spring":  # without which friction is a constraint, with code of its own
        assert len(plain.splitlines()) < len(text.splitlines())
    for name in map(attrgetter, ARRAYS.get(effect, ())):
        assert name(engine) is not None
        assert name(without) is None
    if effect == "rod-rod friction":
        assert engine.state.listed.springs is not None
        assert without.state.listed.springs is None
    np.testing.assert_array_equal(engine.rods[untouched], without.rods[untouched])
    assert len(engine.arrays()) >= len(without.arrays())


def test_what_is_absent_everywhere_needs_next_to_nothing():
    """Of a million rods that only fly: places, directions, velocities and accelerations."""
    engine, _ = started({})
    state, watchers = engine.state, engine.watchers
    assert [state.springs, state.listed, *state.scratch[1:], *watchers] == [None] * 7
    assert list(engine.arrays()) == ["rods", "before"]
    assert (engine.effects.between, engine.effects.period) == (None, None)


def test_no_friction_is_the_same_as_a_coefficient_of_zero():
    """And a plate that does not accelerate the same as one at rest: no code for either."""
    free = prepare(Scene(**plate(friction=0.0), start=Start(tilt_deg=0.0)))
    assert free.effects.alone.friction is None
    assert free.state.springs is None
    assert free.effects.alone.plate is None
    assert prepare(Scene(rods=Rods(1, 1.0), start=Start(tilt_deg=0.0))).effects.alone.upper is None


@pytest.mark.slow
def test_leaving_one_effect_out_of_all_changes_no_other_force():
    """The whole scene less one part, 200 steps: rods that the part cannot reach keep every bit."""
    law = md.constant_restitution(stiffness=1e5)
    parts = {
        "plate": Plate(1e-3),
        "gravity": Gravity(z=0.0),
        "box": Box(1e3),
        "contacts": Contacts(Contact(law, 0.3), Contact(law, 0.3)),
        "ledger": True,
        "touches": True,
    }

    def less(change):
        engine, series = started(parts | {SERIES: True})
        change(engine)
        engine.go(200, series)
        return engine.rods

    def without(**values):
        return lambda engine: replace(engine, **values)

    def unseen(name):
        def change(engine):
            engine.watchers = engine.watchers._replace(**{name: None})

        return change

    def smooth(engine):
        replace(engine, between=engine.effects.between._replace(friction=None))

    whole = less(lambda engine: None)
    assert np.abs(whole[:3, 4:6] - (0.1, 0.01)).max(axis=1).min() > 1e-3  # three rods were pushed
    for change, untouched in (
        (without(alone={"gravity": None}), EVERY),
        (without(alone={"plate": None}), EVERY),
        (without(alone={"friction": None}), ALOFT),
        (without(alone={"normal": law.normal._replace(quarter=None)}), ALOFT),
        (without(period=None), EVERY),
        (smooth, GROUND),
        (without(between=None), GROUND),
        (unseen("ledger"), EVERY),
        (unseen("record"), EVERY),
    ):
        np.testing.assert_array_equal(less(change)[untouched], whole[untouched])
