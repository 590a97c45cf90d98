"""The generated text, compiled: the bits that NumPy gives."""

import numpy as np
import pytest
from numba import njit
from numpy.random import default_rng
from numpy.testing import assert_array_equal

from impact import compiled

from . import sampling
from .sampling import each_law
from .test_public_api import ODD


def _same_bits(a, b):
    for left, right in zip(a, b, strict=True):
        assert_array_equal(left, right, strict=True)  # also of one type


@each_law
def test_compiled_map_gives_the_same_bits(law):
    i = sampling.wide(100_000, seed=21)
    _same_bits(i.collide(law, compiled.collide), i.collide(law))


@each_law
def test_scalar_kernel_gives_the_same_bits(law):
    i = sampling.everyday(200, seed=22)
    want = i.collide(law)
    kernel = getattr(compiled, f"collide_{law}")
    for n in range(200):
        assert kernel(compiled.Impacts(**i.row(n))) == tuple(part[n] for part in want)


@pytest.mark.parametrize(("size", "c_z"), [(1e-70, -1.0), (1.0, -1e-40), (1e70, -1e-10)])
def test_scalar_kernel_takes_infinite_friction(size, c_z):
    given = compiled.Impacts(3.0, c_z, 0.0, 0.0, size, size, size, np.inf, 0.5)
    assert compiled.collide_newton(given)[4] == pytest.approx(1.5 * c_z, rel=1e-15, abs=0)


def test_kernel_keeps_its_bits_in_a_loop_that_may_reorder_its_own_sums():
    """The loop's flags are not the kernel's, though it is inlined."""
    kernel = compiled.collide_newton

    @njit(error_model="numpy", fastmath={"reassoc"})
    def run(given, P_z):
        total = 0.0
        for n in range(P_z.size):
            P_z[n] = kernel(compiled._one_of(given, n))[5]
            total += P_z[n]
        return total

    i = sampling.wide(10_000, seed=23)
    P_z = np.empty(10_000)
    run(i, P_z)
    assert_array_equal(P_z, i.collide().P_z)


def test_compiled_map_keeps_the_contract_on_odd_arguments():
    """It gives NumPy's bits for scalars, float32, empty arrays, nan, inf, huge and tiny numbers."""
    rng, some = default_rng(24), sampling.everyday(12, seed=25)
    single = some._make(map(np.float32, some))
    for i in (
        some._make(rng.choice(np.delete(ODD, [2, 3]), (300, 100)) for _ in some),  # none subnormal
        sampling.Impacts(**some.row(0)),
        some._replace(c_x=ODD[:, None]),
        single,
        single._replace(c_x=np.float32(1e25), c_z=np.full(12, -1e25, np.float32)),
        some._make(column[:0] for column in some),
        some._replace(c_x=np.array(["1e400"], np.longdouble)),
    ):
        with np.errstate(all="raise"):
            _same_bits(i.collide(collide=compiled.collide), i.collide())
