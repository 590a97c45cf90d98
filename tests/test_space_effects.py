"""What a scene in space leaves out has no code: walls, friction, rolling in the compiled text."""

import re

import numpy as np
import pytest

from md.kernels.codes import DIRECTOR, PLACE, SPACE_COLUMNS, TURN, VELOCITY
from md.kernels.contact import ContactForces, Friction
from md.kernels.march import march
from md.kernels.state import Motion, Wall

from . import llvm
from .space import LOSSY, ROUGH, Rods, effects

NORMAL = LOSSY.normal
INNER, OUTER = Wall(5.0, NORMAL, None), Wall(1e3, NORMAL, None)
ROUGH_INNER = INNER._replace(friction=ROUGH)
PAIRS, PLATED = ContactForces(NORMAL, None), {"inner": INNER, "normal": NORMAL}
PLATE = Motion(np.zeros(4), np.full(4, 0.1))
SHAKEN = {**PLATED, "inner": ROUGH_INNER, "plate": PLATE, "watched": True}
# Effects: what is there, to what it is added, what its code has; does it move rods that fly?
EFFECTS = {
    "inner wall and plate": (PLATED, {}, "sqrt|fdiv", False),
    "friction on both": ({"inner": ROUGH_INNER, "friction": ROUGH}, PLATED, "fdiv", False),
    "friction as a constraint": ({"friction": Friction(0.3, None)}, PLATED, "fdiv", False),
    "shaken walls": ({"shaken": True}, SHAKEN, "fsub|fmul", False),
    "outer wall and rods": ({"outer": OUTER, "between": PAIRS}, {}, "sqrt|pair_forces", False),
    "gravity and rolling": ({"gravity": -1.0, "rolling": 15.0}, PLATED, "fmul", True),
    "ledger and record": ({"watched": True}, PLATED, "sitofp|fmul", False),
}
PATHS = {  # of what stands deeper
    "innerfriction": ["effects.inner.friction", "effects.friction"],
    "watched": ["watchers.ledger", "watchers.record"],
}


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
    watched, acting = "watched" in parts, {k: v for k, v in parts.items() if k != "watched"}
    scene = effects(half_length=3.5, lightness=0.2, **acting)
    flying = Rods(scene, rods, 1e-3, kernel, watched).go(50)
    names = ("effects", "state", "watchers")
    return flying, llvm.text(kernel, **{name: getattr(flying, name) for name in names})


@pytest.mark.parametrize(("extra", "base", "marks", "moves"), EFFECTS.values(), ids=EFFECTS)
def test_absent_effects_have_no_code(kernel, extra, base, marks, moves):
    """Nothing reads their numbers and their instructions are not there; the rest is the same."""
    (with_it, text), (without, bare) = marched(kernel, base | extra), marched(kernel, base)
    paths = PATHS.get("".join(extra)) or [f"effects.{path}" for path in extra]
    llvm.assert_absent(text, bare, dict.fromkeys(paths, ""))
    for mark in marks.split("|"):
        assert text.whole.count(mark) > bare.whole.count(mark)
    assert (np.abs(with_it.rods - without.rods).max() > 1e-4) == moves
    assert moves or (with_it.rods == without.rods).all()


def test_a_scene_without_walls_is_the_free_rod(kernel):
    """No root but those of speed and turn, side by side and alone, and of the larger turns."""
    _, (_, _, bare) = marched(kernel, {})
    assert len(re.findall(r"call[^\n]*sqrt", bare)) <= 5
    assert "pair_forces" not in bare
