"""What a scene leaves out has no code in the kernel, no array, and changes no other force."""

import re

import numba
import numpy as np
import pytest

import md
from md.host import prepare
from md.kernels import plane as row
from md.scene import Box, Contact, Contacts, Gravity, Plate, Rods, Scene, Start, Step

RIGID = md.coulomb(1.0, 1e5)  # no dashpot
SPRING = md.constant_restitution(1.0, 1e5, tangential_damping=0.0)
AT_REST = {"plate": Plate(), "contacts": Contacts(plate=Contact(RIGID))}
BETWEEN = {"contacts": Contacts(rods=Contact(RIGID))}
SERIES = "series"  # not of the scene


def plate(**contact):
    """A plate at rest with another contact."""
    return AT_REST | {"contacts": Contacts(plate=Contact(**{"law": RIGID} | contact))}


# Effect: scene with it, scene without it, argument of `march` that brings it in (its place in
# `Crowd`), an instruction that only it needs, rods that it cannot touch (see `started`).
EVERY, ALOFT, GROUND = [0, 1, 2, 3], [0, 1, 3], [2, 3]
EFFECTS = {
    "gravity": ({"gravity": Gravity(z=0.0)}, {}, "crowd.0.4", None, EVERY),
    "plate": (AT_REST, {}, "crowd.0.2", r"@sqrt\(", ALOFT),
    "plate vibration": (
        AT_REST | {"plate": Plate(1e-3)},
        AT_REST,
        "crowd.0.5",
        r"[su]rem i64",
        ALOFT,
    ),
    "plate friction": (plate(friction=0.3), AT_REST, "crowd.0.3", r"= fdiv", ALOFT),
    "spring": (plate(law=SPRING, friction=0.3), plate(friction=0.3), "springs", "copysign", ALOFT),
    "dissipation": (plate(law=md.coulomb(0.65, 1e5)), AT_REST, "crowd.0.2.1", "= fdiv", ALOFT),
    "rod-rod contact": (BETWEEN, {}, "crowd.1", "pair_forces", GROUND),
    "rod-rod friction": (
        {"contacts": Contacts(rods=Contact(SPRING, 0.3))},
        BETWEEN,
        "crowd.1.1",
        "copysign",
        GROUND,
    ),
    "periodic box": (BETWEEN | {"box": Box(1e3)}, BETWEEN, "crowd.2", r"llvm\.rint", EVERY),
    "ledger": (AT_REST | {"ledger": True}, AT_REST, "ledger", None, EVERY),
    "touches": (AT_REST | {"touches": True}, AT_REST, "record", "sitofp", EVERY),
    "series": ({SERIES: True}, {}, "series", r"[su]div i64|[su]rem i64", EVERY),
}
ARRAYS = {  # of an engine, that an effect needs
    "spring": ("springs",),
    "rod-rod contact": ("listed", "scratch"),
    "ledger": ("ledger",),
    "touches": ("record",),
}


@pytest.fixture(scope="module")
def march():
    """The kernel compiled here and now: what comes from the disk cache has no text."""
    kernel = numba.njit(error_model="numpy", _nrt=False)(row.march.py_func)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(row, "march", kernel)
        yield kernel


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
    motion = engine.crowd.alone.plate
    if motion is not None:  # it vibrates by nothing, so that all have one clock
        still = motion._replace(height=motion.height[:1] * 0, velocity=motion.velocity[:1] * 0)
        alone = engine.crowd.alone._replace(plate=still)
        engine.crowd = engine.crowd._replace(alone=alone)
    engine.rods[:, 0] = 10, 10.99, 40, 80
    engine.rods[:, 1] = 20, 20.1, 1.99, 30
    engine.rods[:, 2:4] = 0, 1
    engine.rods[:, 4:] = 0.1, 0.01, 0.02
    samples = np.zeros((2, 5)), engine.rods[:, 2:4].copy()
    return engine, row.Series(*samples, engine.per, 10) if series else None


def compiled(march, parts):
    """The text of the kernel that these parts need, and the rods after 100 of its steps."""
    engine, series = started(parts)
    engine.go(100, series)
    signature = numba.typeof(engine.crowd)
    arrays = (engine.springs, engine.listed, engine.ledger, engine.record, series)
    kinds = [numba.typeof(array) for array in arrays]
    [mine] = [
        s
        for s in march.signatures
        if s[0] == signature and [s[k] for k in (3, 4, 7, 8, 9)] == kinds
    ]
    text = march.inspect_llvm(mine)
    functions = re.findall(r"^define[^\n]*\n.*?^}", text, re.M | re.S)
    [body] = [f for f in functions if re.match(r"define[^\n]*@_ZN2md7kernels5plane5march", f)]
    return engine, body, text


def uses(body, argument):
    """Instructions of a function that look at an argument, not those that hand it on."""
    code = [line for line in body.splitlines()[1:] if " call " not in line]
    return len(re.findall(rf"%arg\.{re.escape(argument)}\b", "\n".join(code)))


def passed(body, argument):
    """Numbers and places that an argument hands over, absent ones left out."""
    head = body.split("\n", 1)[0]
    given = re.findall(rf"((?:ptr|double|i\d+)\b[^%]*)%arg\.{re.escape(argument)}\b", head)
    assert given
    return [one for one in given if "readnone" not in one]


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_absent_effect_costs_nothing(march, effect):
    """Not read, its instructions not there, fewer instructions; no array; the others as they were.

    Numba names the kernel's arguments in its LLVM text. One that is None remains there as a pointer
    that nothing reads.
    """
    there, gone, argument, marker, untouched = EFFECTS[effect]
    engine, body, text = compiled(march, there)
    without, bare, plain = compiled(march, gone)
    assert passed(body, argument)
    assert not passed(bare, argument)
    assert uses(bare, argument) == 0
    if marker:
        assert re.search(marker, text)
        assert not re.search(marker, plain)
    if effect != "spring":  # without which friction is a constraint, with code of its own
        assert len(plain.splitlines()) < len(text.splitlines())
    for name in ARRAYS.get(effect, ()):
        assert getattr(engine, name) is not None
        assert getattr(without, name) is None
    if effect == "rod-rod friction":
        assert engine.listed.springs is not None
        assert without.listed.springs is None
    np.testing.assert_array_equal(engine.rods[untouched], without.rods[untouched])
    assert len(engine.arrays()) >= len(without.arrays())


def test_what_is_absent_everywhere_needs_next_to_nothing():
    """Of a million rods that only fly: places, directions, velocities and accelerations."""
    engine, _ = started({})
    held = [engine.springs, engine.listed, engine.scratch, engine.ledger, engine.record]
    assert held == [None] * 5
    assert list(engine.arrays()) == ["rods", "before"]
    assert (engine.crowd.between, engine.crowd.period, engine.crowd.skin) == (None, None, None)


def test_no_friction_is_the_same_as_a_coefficient_of_zero():
    """And a plate that does not accelerate the same as one at rest: no code for either."""
    free = prepare(Scene(**plate(friction=0.0), start=Start(tilt_deg=0.0)))
    assert free.crowd.alone.friction is None
    assert free.springs is None
    assert free.crowd.alone.plate is None
    assert prepare(Scene(rods=Rods(1, 1.0), start=Start(tilt_deg=0.0))).crowd.alone.upper is None


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

    def alone(**values):
        def change(engine):
            crowd = engine.crowd
            engine.crowd = crowd._replace(alone=crowd.alone._replace(**values))

        return change

    def crowd(**values):
        def change(engine):
            engine.crowd = engine.crowd._replace(**values)

        return change

    def field(name):
        return lambda engine: setattr(engine, name, None)

    def smooth(engine):
        between = engine.crowd.between._replace(friction=None)
        engine.crowd = engine.crowd._replace(between=between)

    def apart(engine):
        crowd(between=None)(engine)
        engine.listed = engine.scratch = None

    whole = less(lambda engine: None)
    assert np.abs(whole[:3, 4:6] - (0.1, 0.01)).max(axis=1).min() > 1e-3  # three rods were pushed
    for change, untouched in (
        (alone(gravity=None), EVERY),
        (alone(plate=None), EVERY),
        (alone(friction=None), ALOFT),
        (alone(normal=law.normal._replace(quarter=None)), ALOFT),
        (crowd(period=None), EVERY),
        (smooth, GROUND),
        (apart, GROUND),
        (field("ledger"), EVERY),
        (field("record"), EVERY),
    ):
        np.testing.assert_array_equal(less(change)[untouched], whole[untouched])
