"""An effect that a scene leaves out has no code, no memory and no part in the result."""

import re
from collections import namedtuple
from operator import attrgetter

import numba
import numpy as np
import pytest
from numpy.testing import assert_array_equal

import md
from md import host
from md.host import prepare
from md.kernels.contact import ContactForces, Friction, Inertia, Normal
from md.kernels.march import Watchers
from md.kernels.state import Walls
from md.kernels.vectors import IN_PLANE, IN_SPACE

from .rows import AT_REST, LOSSY, ROLLING, SOFT, SPACE, in_plane, ring, row, started

# The text of a compiled kernel: what it takes and what it looks at


def fresh(kernel):
    """A kernel compiled here and now: what comes from the disk cache has no text."""
    return numba.njit(error_model="numpy", _nrt=False)(kernel.py_func)


# Text of a kernel compiled for some arguments, by their names, and that of its own function.
Text = namedtuple("Text", "arguments whole body")


def text_of(kernel, **arguments):
    """The kernel's text for the first arguments of these types, which have their names there."""
    wanted = tuple(map(numba.typeof, arguments.values()))
    [mine] = [s for s in kernel.signatures if s[: len(wanted)] == wanted]
    whole = kernel.inspect_llvm(mine)
    path = [*kernel.py_func.__module__.split("."), kernel.py_func.__name__]
    own = rf"define[^\n]*@_ZN{''.join(f'{len(name)}{name}' for name in path)}"
    functions = re.findall(r"^define[^\n]*\n.*?^}", whole, re.M | re.S)
    [body] = [function for function in functions if re.match(own, function)]
    return Text(arguments, whole, body)


def place(arguments, path):
    """Numba's name of a field of a nested tuple, as "effects.0.4" for "effects.alone.gravity"."""
    name, *fields = path.split(".")
    group = arguments[name]
    for field in fields:
        name += f".{group._fields.index(field)}"
        group = getattr(group, field)
    return re.escape(name)


def passed(text, path):
    """Numbers and places that an argument hands over, absent ones left out."""
    head = text.body.split("\n", 1)[0]
    given = re.findall(rf"((?:ptr|double|i\d+)\b[^%]*)%arg\.{place(text.arguments, path)}\b", head)
    assert given
    return [one for one in given if "readnone" not in one]


def assert_absent(there, gone, paths, *marks):
    """Effects have no code in a text: nothing reads their arguments, their instructions lack.

    Numba names the kernel's arguments in its text. One that is None remains there as a pointer that
    nothing reads. `marks`: instructions that only these effects need.
    """
    code = "\n".join(line for line in gone.body.splitlines()[1:] if " call " not in line)
    for path in paths.split():
        assert passed(there, path)
        assert not passed(gone, path)
        assert not re.search(rf"%arg\.{place(gone.arguments, path)}\b", code)
    for mark in marks:
        assert re.search(mark, there.whole)
        assert not re.search(mark, gone.whole)


# Many rods


@pytest.fixture(scope="module")
def march():
    """The kernel, with its text."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(host, "march", fresh(host.march))
        yield host.march


def marched(kernel, watched=False, **acting):
    """Rods after 100 steps, and the kernel's text: 0 and 1 touch, 2 is in the plate, 3 alone."""
    turn = 0.1, 0.01, 0.02
    rods = in_plane(*((x, z, 0, *turn) for x, z in ((10, 20), (10.99, 20.1), (40, 1.99), (80, 30))))
    if (up := acting.get("up", IN_PLANE)) == IN_SPACE:
        flat, rods = rods, np.zeros((4, 12))
        rods[:, [0, 2, 3, 5, 6, 8, 10]], rods[:, 1] = flat, -20.0
    effects = host.Effects(1.5, Inertia(0.5), up=up)._replace(**acting)
    engine, series = started(effects, rods, 5e-4), None
    if watched:
        series = engine.series(1)._replace(per=2000, every=10)
    else:
        engine.watchers = Watchers(None, None, None)
    assert engine.go(100, series) == 100
    watchers = engine.watchers = engine.watchers._replace(series=series)
    return engine, text_of(kernel, effects=engine.effects, state=engine.state, watchers=watchers)


ALOFT, GROUND = [0, 1, 3], [2, 3]
RIGID, CONSTRAINT = Normal(SOFT), Friction(0.3, None)  # no dashpot, no spring
SPRING = Friction(0.3, md.constant_restitution(1.0, SOFT, tangential_damping=0.0).spring)
REST, TOUCHING = {"normal": RIGID}, {"between": ContactForces(RIGID, None)}
SHAKEN = REST | {"plate": AT_REST, "friction": CONSTRAINT}
WALLS = {"up": IN_SPACE, "walls": Walls(RIGID, None, 5.0, 1e3), **REST, **TOUCHING}
# Effects: what is there with them, without them; rods that none of them touches; arguments of
# `march` that are theirs; instructions that only they need.
EFFECTS = {
    "plate": (REST, {}, ALOFT, "effects.normal", r"@sqrt\("),
    "gravity and what is measured": (
        REST | {"gravity": (0.0, 0.0), "watched": True},
        REST,
        [0, 1, 2, 3],
        "effects.gravity watchers.ledger watchers.record watchers.series",
        "sitofp",  # of the record
        "[su]div i64|[su]rem i64",  # of the series
    ),
    "plate's vibration and friction": (
        SHAKEN,
        REST,
        ALOFT,
        "effects.plate effects.friction",
        "[su]rem i64",
        "= fdiv",
    ),
    "plate's spring and dissipation": (
        SHAKEN | {"normal": LOSSY.normal, "friction": SPRING},
        SHAKEN,
        ALOFT,
        "state.memory.springs effects.normal.quarter",
        "copysign",
    ),
    "spring's dissipation": (
        SHAKEN | {"friction": Friction(0.3, md.constant_restitution(1.0, SOFT).spring)},
        SHAKEN | {"friction": SPRING},
        ALOFT,
        "effects.friction.spring.damping_ratio",
    ),
    "flat ends": (REST | {"flat": True}, REST, ALOFT, "effects.flat"),
    "rod-rod contact": (
        TOUCHING,
        {},
        GROUND,
        "effects.between state.listed state.scratch.place state.scratch.found state.scratch.batch",
        "joined_ends",
    ),
    "rod-rod friction and box": (
        {"between": ContactForces(RIGID, SPRING), "period": 1e3},
        TOUCHING,
        GROUND,
        "effects.between.friction state.listed.memory.springs effects.period",
        "copysign",
        r"llvm\.floor",
    ),
    "walls and contacts in space": (
        WALLS,
        {"up": IN_SPACE},
        [3],
        "effects.walls effects.between",
        "at_wall",
        "joined_ends",
    ),
    "rolling on the plate": (
        REST | {"up": IN_SPACE, "inertia": Inertia(0.5, 15.0), "friction": CONSTRAINT},
        {"up": IN_SPACE},
        ALOFT,
        "effects.inertia.rolling effects.normal effects.friction",
    ),
    "friction, gravity and shaking in space": (
        SPACE._asdict() | {"watched": True},  # as in other tests: parts of it are compiled
        WALLS,
        [3],
        "effects.walls.friction effects.friction effects.between.friction state.memory.springs"
        " effects.gravity effects.shaken effects.plate watchers.record",
        "sitofp",
    ),
}


@pytest.mark.parametrize("effect", EFFECTS)
def test_absent_effects_cost_nothing(march, effect):
    """Absent effects are not read, have no instructions or arrays, and leave other rods alone."""
    there, gone, untouched, paths, *marks = EFFECTS[effect]
    (engine, text), (without, bare) = marched(march, **there), marched(march, **gone)
    assert_absent(text, bare, paths, *marks)
    for mark in ("fmul", "call "):
        assert text.whole.count(mark) > bare.whole.count(mark)
    for path in paths.split():
        assert attrgetter(path)(without) is None
    assert_array_equal(engine.rods[untouched], without.rods[untouched])
    assert len(engine.arrays()) >= len(without.arrays())


def test_a_scene_without_walls_is_the_free_rod(march):
    """It has no root but those of speed and turn, in pairs and alone, and of larger turns."""
    _, (_, whole, body) = marched(march, up=IN_SPACE)
    assert len(re.findall(r"call[^\n]*sqrt", body)) <= 5
    assert not re.search("joined_ends|at_wall", whole)


def test_what_is_absent_everywhere_needs_next_to_nothing():
    """Rods that only fly have places, directions, velocities and accelerations alone."""
    engine = prepare(md.Scene(start=md.Start(tilt_deg=10.0)), ledger=False, touches=False)
    state, watchers = engine.state, engine.watchers
    absent = *state.memory, state.listed, *state.scratch[2:], *watchers
    assert [*absent] == [None] * 9
    assert list(engine.arrays()) == ["rods", "before"]
    assert set(engine.effects[2:6] + engine.effects[7:10] + engine.effects[11:]) == {None}


def test_no_friction_is_the_same_as_a_coefficient_of_zero():
    """It has no code, and neither has a plate that does not accelerate: it is one at rest."""
    still = "contacts.plate.friction=0", "plate.acceleration=0"
    engine = prepare(row(*still, "rods.length=1", "box=none", "start.tilt_deg=0"))
    assert engine.effects.friction is engine.state.memory.springs is engine.effects.plate is None
    assert engine.effects.upper is engine.effects.period is None
    smooth = [f"contacts.{part}.friction=0" for part in ("plate", "rods", "wall")]
    state = prepare(ring(*smooth)).state
    assert state.memory.springs is state.listed.memory.springs is None
    alone = "contacts.rods=none", "rods.count=1", "start.tilt_deg=10"
    engine = prepare(ring("annulus.shaken=false", *alone))
    assert engine.effects.between is engine.effects.shaken is engine.state.listed is None
    assert engine.effects.inertia.rolling is None
    assert prepare(ring(*ROLLING)).effects.inertia.rolling > 0
