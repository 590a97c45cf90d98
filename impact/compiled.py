"""The impact map compiled by Numba; import it on request (it needs Numba, and seconds to compile).

`collide_newton`, `collide_poisson` and `collide_stronge` (`KERNELS`, by law) are scalar kernels for
other compiled code: an `Impacts` of floats in, the nine fields of `impact.Collision` out as a
tuple, the regime as its code. They expect valid arguments of ordinary size (lengths and speeds
between 1e-70 and 1e70). `collide` has the contract of `impact.collide`. All of them give its
numbers bit for bit, as they are made from the same text.
"""

from functools import cache
from inspect import isfunction
from types import FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import types
from numba.extending import intrinsic

from . import _generated, _kernel
from . import collision as plain
from ._arguments import domain_of, real_arrays, typed_as
from ._impacts import Impacts, Regime, ordinary
from ._jit import kernel

__all__ = ["KERNELS", "Impacts", "collide", "collide_newton", "collide_poisson", "collide_stronge"]


@intrinsic
def _fused(typing_context, a, b, c):
    """Compute a b + c with one rounding."""

    def build(context, builder, signature, arguments):
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), build


@kernel(forceinline=True)
def _split(a):
    """Leave a number whole: `_two_product` needs no halves here."""
    return a


@kernel(forceinline=True)
def _two_product(a, b):
    """Rounded product and its error, the same as `_kernel.two_product` finds."""
    p = a * b
    return p, _fused(a, b, -p)


@kernel(forceinline=True)
def _select(condition, a, b):
    """Choose one of two numbers that are both computed."""
    return a if condition else b


_known = {
    "split": _split,
    "two_product": _two_product,
    "select": _select,
    "larger": max,
    "smaller": min,
}


def _compile(module: ModuleType) -> None:
    """Compile the functions of a module, in their order; they call those that were compiled before.

    All are inlined: a real call would return its tuple through memory and keep loops from being
    vectorised (five times slower). Nothing is compiled that no kernel calls.
    """
    for name, function in vars(module).items():
        if isfunction(function) and function.__module__ == module.__name__ and name not in _known:
            renamed = FunctionType(function.__code__, {**function.__globals__, **_known}, name)
            _known[name] = kernel(renamed, forceinline=True)


_compile(_generated)
_compile(_kernel)
_impact, _ordinary = _known["impact"], kernel(ordinary, forceinline=True)


def _scalar_kernel(law: str) -> Any:
    """Compile the impact of floats under one law."""
    restitution = _known[law]

    def collide(given: Impacts) -> tuple:
        """One impact, for compiled code; the fields of `impact.Collision` as nine numbers.

        Parameters
        ----------
        given : floats; lengths and speeds between 1e-70 and 1e70
        """
        return _impact(restitution, given)

    collide.__name__ = collide.__qualname__ = f"collide_{law}"
    return kernel(collide, forceinline=True)


KERNELS = {law: _scalar_kernel(law) for law in plain.LAWS}
collide_newton, collide_poisson, collide_stronge = KERNELS.values()
_LEFT = -2  # regime code of an impact that is left to NumPy: invalid, or of unusual size


@kernel(forceinline=True)
def _one_of(given, i):
    """Impact i of many, as floats; each field of `given` is an array."""
    c_x, c_z, omega, V_z, X, Z, k, mu, epsilon = given
    return Impacts(c_x[i], c_z[i], omega[i], V_z[i], X[i], Z[i], k[i], mu[i], epsilon[i])


@cache
def _loop(law: str):
    """Compile a loop from `Impacts` to `Collision`, of arrays; it returns how many it left out."""
    impact = KERNELS[law]

    @kernel
    def impacts(given, found):
        c_x, c_z, omega, regime, P_x, P_z, slip, normal, energy = found
        left = 0
        for i in range(regime.size):
            one = _one_of(given, i)
            if _ordinary(one):
                after = impact(one)
                c_x[i], c_z[i], omega[i], regime[i], P_x[i] = after[:5]
                P_z[i], slip[i], normal[i], energy[i] = after[5:]
            else:
                regime[i] = _LEFT
                left += 1
        return left

    return impacts


def _empty(size: int) -> plain.Collision:
    """Empty arrays for the results of `size` impacts."""
    return plain.Collision(*(np.empty(size, np.int8 if kind else float) for kind in plain.KINDS))


@typed_as(plain.collide)
def collide(
    c_x, c_z, omega=0.0, *, geometry, friction, restitution, plate_velocity=0.0, law="newton"
):
    """`impact.collide`, compiled: the same arguments, the same numbers, the same errors.

    Parameters
    ----------
    c_x, c_z, omega, geometry, friction, restitution, plate_velocity, law : as in `impact.collide`

    Returns
    -------
    Collision

    Raises
    ------
    ValueError, TypeError
        As `impact.collide`.
    """
    plain.law_of(law)
    given = plain.arguments(c_x, c_z, omega, geometry, friction, restitution, plate_velocity)
    arrays, dtype = real_arrays(given, map(domain_of, given))
    shape = np.broadcast(*arrays).shape
    with np.errstate(all="ignore"):
        arrays = [array.astype(float, copy=False) for array in arrays]
        impacts = Impacts(*(np.ravel(x if x.shape == shape else np.full(shape, x)) for x in arrays))
        results = _empty(impacts.c_x.size)
        if _loop(law)(impacts, results):
            left = results.regime == _LEFT
            rest = Impacts(*(array[left] for array in impacts)).collide(plain.collide, law)
            for result, values in zip(results, rest, strict=True):
                result[left] = values
        fields = [
            (x if kind else x.astype(dtype, copy=False)).reshape(shape)[()]
            for x, kind in zip(results, plain.KINDS, strict=True)
        ]
    after = plain.Collision(*fields)
    return after if shape else after._replace(regime=Regime(int(after.regime)))
