"""What a scene in space leaves out has no code: walls, friction, rolling in the compiled text."""

import re

import numpy as np
import pytest

from md.kernels.codes import DIRECTOR, PLACE, SPACE_COLUMNS, TURN, VELOCITY
from md.kernels.contact import ContactForces
from md.kernels.space.forces import Wall
from md.kernels.space.march import march

from . import llvm
from .space import LOSSY, ROUGH, Rods, effects

NORMAL = LOSSY.normal
INNER, OUTER = Wall(5.0, NORMAL, None), Wall(1e3, NORMAL, None)
PLATE, PAIRS = {"normal": NORMAL}, {"between": ContactForces(NORMAL, None)}
# An effect, those it is added to, where it is in the kernel's arguments, what its code has.
EFFECTS = {
    "inner wall": ({"inner": INNER}, {}, "inner", "sqrt"),
    "outer wall": ({"outer": OUTER}, {}, "outer", "sqrt"),
    "wall friction": (
        {"inner": INNER._replace(friction=ROUGH)}, {"inner": INNER}, "inner.friction", "fdiv",
    ),
    "plate": (PLATE, {}, "normal", "fdiv"),
    "plate friction": (PLATE | {"friction": ROUGH}, PLATE, "friction", "fdiv"),
    "contacts between rods": (PAIRS, {}, "between", "pair_forces"),
    "rolling": (PLATE | {"rolling": 15.0}, PLATE, "rolling", "fmul"),
    "gravity": ({"gravity": -1.0}, {}, "gravity", None),
}  # fmt: skip


@pytest.fixture(scope="module")
def kernel():
    """The kernel, with its text."""
    return llvm.fresh(march)


def marched(kernel, parts):
    """Rods that touch nothing after 50 steps, and the text of the kernel that moved them."""
    rods = np.zeros((2, SPACE_COLUMNS))
    rods[:, PLACE:DIRECTOR] = (20, 1, 9), (-20, 3, 9)
    rods[:, DIRECTOR:VELOCITY] = (0.6, 0, 0.8), (0, 0, 1)
    rods[:, VELOCITY:TURN], rods[:, TURN:] = 0.1, ((0.3, 0.2, 0), (0.1, 0, 0))
    flying = Rods(effects(half_length=3.5, lightness=0.2, **parts), rods, 1e-3, kernel).go(50)
    _, body = llvm.text(kernel, flying.effects, flying.state)
    return flying, body


def looks(body, argument):
    """Instructions of a function that look at an argument or hand it on."""
    code = "\n".join(body.splitlines()[1:])
    return len(re.findall(rf"%arg\.{re.escape(argument)}\b", code))


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_absent_effect_has_no_code(kernel, effect):
    """Nothing looks at its numbers and its instructions are not there; what is left is the same."""
    extra, base, path, mark = EFFECTS[effect]
    (with_it, body), (without, bare) = marched(kernel, base | extra), marched(kernel, base)
    argument = llvm.place(with_it.effects, f"effects.{path}")
    assert looks(body, argument) > 0
    assert looks(bare, argument) == 0
    assert len(bare.splitlines()) < len(body.splitlines())
    assert mark is None or len(re.findall(mark, bare)) < len(re.findall(mark, body))
    if effect in ("gravity", "rolling"):  # these act on rods that touch nothing
        assert np.abs(with_it.rods - without.rods).max() > 1e-4
    else:
        np.testing.assert_array_equal(with_it.rods, without.rods)


def test_a_scene_without_walls_is_the_free_rod(kernel):
    """No root but that of the speed, of the larger turns; no contact's dashpot, no springs."""
    _, bare = marched(kernel, {})
    assert len(re.findall(r"call[^\n]*sqrt", bare)) <= 3
    assert "pair_forces" not in bare
