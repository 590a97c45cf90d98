"""The impact map compiled by Numba; import it on request (it needs Numba, and seconds to compile).

`collide_newton`, `collide_poisson` and `collide_stronge` (`KERNELS`, by law) are scalar kernels for
other compiled code: nine floats (c_x, c_z, omega, plate_velocity, X, Z, k, friction, restitution)
in, the nine fields of `impact.Collision` out as a tuple, the regime as its code. They expect valid
arguments of ordinary size (lengths and speeds between 1e-70 and 1e70). `collide` has the contract
of `impact.collide`. All of them give its numbers bit for bit, as they are made from the same text.
"""

from functools import cache
from types import FunctionType
from typing import Any

import numpy as np
from numba import types
from numba.extending import intrinsic

from . import _compensated, _generated, _kernel
from . import collision as plain
from ._jit import kernel
from .geometry import ContactGeometry

__all__ = ["KERNELS", "collide", "collide_newton", "collide_poisson", "collide_stronge"]


@intrinsic
def _fused(typing_context, a, b, c):
    """Compute a b + c with one rounding."""

    def build(context, builder, signature, arguments):
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), build


@kernel(forceinline=True)
def _halves(a):
    """Leave a number whole: `_product` needs no halves here."""
    return a


@kernel(forceinline=True)
def _product(a, b):
    """Rounded product and its error, the same as `_compensated._product` finds."""
    p = a * b
    return p, _fused(a, b, -p)


@kernel(forceinline=True)
def _select(condition, a, b):
    """Choose one of two numbers that are both computed."""
    return a if condition else b


@kernel(forceinline=True)
def _larger(a, b):
    """Maximum without a case for nan."""
    return a if a > b else b


@kernel(forceinline=True)
def _smaller(a, b):
    """Minimum without a case for nan."""
    return a if a < b else b


_known: dict[str, Any] = {
    "_halves": _halves,
    "_product": _product,
    "select": _select,
    "larger": _larger,
    "smaller": _smaller,
}


def _compile(module, *names: str) -> None:
    """Compile functions of a module; they call those that were compiled before.

    All are inlined: a real call would return its tuple through memory and keep loops from being
    vectorised (five times slower).
    """
    for name in names:
        function = getattr(module, name)
        renamed = FunctionType(function.__code__, {**function.__globals__, **_known}, name)
        _known[name] = kernel(renamed, forceinline=True)


_compile(_compensated, "_sum", "_total", "lacking", "approach", "responses")
_compile(
    _generated,
    *("slide", "stop", "reverse", "slip", "stick", "energy_change"),
    *("stick_response", "slopes"),
    *("poisson_early", "poisson_late", "stronge_early", "stronge_late"),
)
_compile(
    _kernel,
    "ordinary",
    "mirrored",
    "regime_of",
    "newton",
    "_slopes",
    "_gain",
    "poisson",
    "stronge",
    "impact",
)
_impact, _ordinary = _known["impact"], _known["ordinary"]


def _scalar_kernel(law: str) -> Any:
    """Compile the impact under one law: nine floats in, nine numbers out."""
    final_velocity = _known[law]

    def collide(
        c_x: float,
        c_z: float,
        omega: float,
        plate_velocity: float,
        X: float,
        Z: float,
        k: float,
        friction: float,
        restitution: float,
    ) -> tuple:
        """One impact, for compiled code; the fields of `impact.Collision` as nine numbers.

        Parameters
        ----------
        c_x, c_z, omega, plate_velocity, friction, restitution : as in `impact.collide`, floats
        X, Z, k : of the contact geometry; lengths and speeds are between 1e-70 and 1e70
        """
        return _impact(
            final_velocity, c_x, c_z, omega, plate_velocity, X, Z, k, friction, restitution
        )

    collide.__name__ = collide.__qualname__ = f"collide_{law}"
    return kernel(collide, forceinline=True)


collide_newton = _scalar_kernel("newton")
collide_poisson = _scalar_kernel("poisson")
collide_stronge = _scalar_kernel("stronge")

KERNELS = {"newton": collide_newton, "poisson": collide_poisson, "stronge": collide_stronge}
_IMPACTS_A_CALL = 1 << 18  # some 20 ms: signals are seen between calls
_LEFT = -2  # regime code of an impact that is left to plain NumPy: invalid, or of unusual size


@cache
def _loop(law: str):
    """Compile a loop over impacts under one law; it returns how many it left out."""
    impact = KERNELS[law]

    # fmt: off
    def impacts(
        c_x, c_z, omega, V_z, X, Z, k, mu, epsilon,
        c_x_, c_z_, omega_, regime, P_x, P_z, slip, normal, energy,
    ):
        left = 0
        for i in range(regime.size):
            if _ordinary(c_x[i], c_z[i], omega[i], V_z[i], X[i], Z[i], k[i], mu[i], epsilon[i]):
                (
                    c_x_[i], c_z_[i], omega_[i], regime[i], P_x[i], P_z[i],
                    slip[i], normal[i], energy[i],
                ) = impact(c_x[i], c_z[i], omega[i], V_z[i], X[i], Z[i], k[i], mu[i], epsilon[i])
            else:
                regime[i] = _LEFT
                left += 1
        return left
    # fmt: on

    return kernel(impacts)


def collide(
    c_x: Any,
    c_z: Any,
    omega: Any = 0.0,
    *,
    geometry: ContactGeometry,
    friction: Any,
    restitution: Any,
    plate_velocity: Any = 0.0,
    law: str = "newton",
) -> plain.Collision:
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
    arrays, dtype = plain.prepare(
        c_x, c_z, omega, geometry, friction, restitution, plate_velocity, law
    )
    arrays = [array.astype(np.float64, copy=False) for array in arrays]
    shape = np.broadcast_shapes(*(array.shape for array in arrays))
    size = int(np.prod(shape))
    columns = [
        np.broadcast_to(array, size if array.ndim == 0 else shape).reshape(size) for array in arrays
    ]
    results = [np.empty(size, np.int8 if i == 3 else np.float64) for i in range(9)]
    parts = [slice(first, first + _IMPACTS_A_CALL) for first in range(0, size, _IMPACTS_A_CALL)]
    loop = _loop(law)
    if sum(loop(*(array[part] for array in (*columns, *results))) for part in parts):
        left = results[3] == _LEFT
        rest = plain.from_arrays([column[left] for column in columns], law)
        for result, part in zip(results, rest, strict=True):
            result[left] = part
    return plain.collision([result.reshape(shape) for result in results], dtype)
