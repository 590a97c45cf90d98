"""The generated text itself, run on SymPy symbols, mpmath numbers and compiled."""

import ast

import mpmath
import numpy as np
import pytest
import sympy as sp
from numba import njit
from numpy.random import default_rng
from numpy.testing import assert_array_equal

from derivations import closed_forms, files, rewrites
from derivations.equality import random_point
from impact import compiled

from . import sampling
from .sampling import each_law
from .test_public_api import ODD


def _numbers(function):
    """Arguments at three random points, at 50 digits, and what each output is worth there."""
    body, _ = function.body
    arguments = {str(x): sp.sympify(x).subs(function.meaning) for x in function.arguments}
    values = rewrites.written_out(body, function.meaning)
    meant = {str(symbol): value for symbol, value in values.items()} | arguments
    meant |= {str(x): derived.subs(function.meaning) for x, derived in function.outputs.items()}
    outputs = " ".join(str(symbol) for symbol in body if symbol in function.outputs)
    names = function.words.get("returned", outputs).split()
    forms = [*arguments.values(), *map(meant.get, names)]
    letters = sp.Tuple(*forms).free_symbols
    with mpmath.workdps(50):
        for seed in range(3):
            point = random_point(letters, seed)
            numbers = [mpmath.mpmathify(sp.N(form.subs(point), 50)) for form in forms]
            yield numbers[: len(arguments)], numbers[len(arguments) :]


def _computing_lines(tree):
    """(function, node) of each line of the generated file that computes something."""
    for function in tree.body:
        for line in getattr(function, "body", []):
            match line:
                case ast.Return(ast.Tuple() | ast.Name()):
                    pass
                case ast.Assign() | ast.Return():
                    yield function.name, line


def test_generated_functions_are_their_derivations_and_no_line_may_change():
    """They agree at 50 digits; a change of 1e-12 in any line is seen."""
    tree = ast.parse(files.CLOSED_FORMS.read_text("utf-8"))
    functions = {function.name: function for function in closed_forms.FUNCTIONS}
    numbers = {name: list(_numbers(function)) for name, function in functions.items()}

    def right(name):
        space = {}
        exec(compile(ast.fix_missing_locations(tree), "generated", "exec"), space)
        with mpmath.workdps(50):
            return all(
                mpmath.almosteq(value, derived, 1e-20, 1e-20)
                for given, wanted in numbers[name]
                for value, derived in zip(np.atleast_1d(space[name](*given)), wanted, strict=True)
            )

    assert all(map(right, functions))
    lines = list(_computing_lines(tree))
    assert {name for name, _ in lines} == set(functions)
    for name, line in lines:
        usual = line.value
        line.value = ast.BinOp(usual, ast.Mult(), ast.Constant(1 + 1e-12))
        assert not right(name)
        line.value = usual


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
