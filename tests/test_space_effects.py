"""What a scene in space leaves out has no code: walls, friction, spin in the compiled text."""

import re

import numba
import numpy as np
import pytest

import md
from md.kernels.contact import Friction
from md.kernels.plane import Between
from md.kernels.space import forces
from md.kernels.space import march as crowd
from md.kernels.space.pairs import no_pairs

LAW = md.constant_restitution(0.65, 1e5, tangential_ratio=3)
ROUGH = Friction(0.3, LAW.spring)
INNER, OUTER = forces.Wall(5.0, LAW.normal, None), forces.Wall(1e3, LAW.normal, None)
PLATE, PAIRS = {"normal": LAW.normal}, {"between": Between(LAW.normal, None)}
# An effect, the scene it is added to, where its numbers are in the arguments, what its code has.
EFFECTS = {
    "inner wall": ({"inner": INNER}, {}, "world.7", "sqrt"),
    "outer wall": ({"outer": OUTER}, {}, "world.8", "sqrt"),
    "wall friction": (
        {"inner": INNER._replace(friction=ROUGH)}, {"inner": INNER}, "world.7.2", "fdiv",
    ),
    "plate": (PLATE, {}, "world.5", "fdiv"),
    "plate friction": (PLATE | {"friction": ROUGH}, PLATE, "world.6", "fdiv"),
    "contacts between rods": (PAIRS, {}, "world.9", "pair_forces"),
    "rolling": (PLATE | {"spin": 15.0}, PLATE, "world.2", "fmul"),
    "gravity": ({"gravity": -1.0}, {}, "world.3", None),
}  # fmt: skip


@pytest.fixture(scope="module")
def kernel():
    """The kernel compiled here and now: what comes from the disk cache has no text."""
    return numba.njit(error_model="numpy", _nrt=False)(crowd.march.py_func)


def marched(kernel, parts):
    """Rods that touch nothing after 50 steps, and the text of the kernel that moved them."""
    scene = forces.Space(
        **{**dict.fromkeys(forces.Space._fields), "half_length": 3.5, "lightness": 0.2, **parts}
    )
    rods = np.zeros((2, crowd.COLUMNS))
    rods[:, :3] = (20, 1, 9), (-20, 3, 9)
    rods[:, 3:6] = (0.6, 0, 0.8), (0, 0, 1)
    rods[:, 6:9], rods[:, 9:12] = 0.1, ((0.3, 0.2, 0), (0.1, 0, 0))
    rubs = any(
        friction is not None for friction in (scene.friction, scene.inner and scene.inner.friction)
    )
    done, why, _ = kernel(
        *(scene, rods, np.zeros((2, 6)), np.zeros((2, forces.SINGLE, 3)) if rubs else None, None),
        *(no_pairs(2) if scene.between else None, 0.4, np.zeros((2, 6)), None, 0, 50, 1e-3),
    )
    assert (done, why) == (50, 0)
    [mine] = [s for s in kernel.signatures if s[0] == numba.typeof(scene)]
    functions = re.findall(r"^define[^\n]*\n.*?^}", kernel.inspect_llvm(mine), re.M | re.S)
    [body] = [f for f in functions if re.match(r"define[^\n]*@_ZN2md7kernels5space5march5march", f)]
    return rods, body


def looks(body, argument):
    """Instructions of a function that look at an argument."""
    code = "\n".join(line for line in body.splitlines()[1:])
    return len(re.findall(rf"%arg\.{re.escape(argument)}\b", code))


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_absent_effect_has_no_code(kernel, effect):
    """Nothing looks at its numbers and its instructions are not there; what is left is the same."""
    extra, base, argument, mark = EFFECTS[effect]
    (with_it, body), (without, bare) = marched(kernel, base | extra), marched(kernel, base)
    assert looks(body, argument) > 0
    assert looks(bare, argument) == 0
    assert len(bare.splitlines()) < len(body.splitlines())
    assert mark is None or len(re.findall(mark, bare)) < len(re.findall(mark, body))
    if effect in ("gravity", "rolling"):  # these act on rods that touch nothing
        assert np.abs(with_it - without).max() > 1e-4
    else:
        np.testing.assert_array_equal(with_it, without)


def test_a_scene_without_walls_is_the_free_rod(kernel):
    """No root but that of the speed, of the larger turns; no contact's dashpot, no springs."""
    _, bare = marched(kernel, {})
    assert len(re.findall(r"call[^\n]*sqrt", bare)) <= 3
    assert "pair_forces" not in bare
