"""The impact map compiled by Numba; import it on request (it needs Numba, and seconds to compile).

`collide_newton`, `collide_poisson` and `collide_stronge` are scalar kernels for other compiled
code: nine floats (c_x, c_z, omega, plate_velocity, X, Z, k, friction, restitution) in, the nine
fields of `impact.Collision` out as a tuple, the regime as its code. They expect valid arguments of
ordinary size (lengths and speeds between 1e-70 and 1e70). `collide` has the contract of
`impact.collide`. All of them give its numbers bit for bit, as they are made from the same text.
"""

from types import FunctionType
from typing import Any

from numba import njit, types
from numba.extending import intrinsic

from . import _compensated, _generated, _kernel


@intrinsic
def _fused(typing_context, a, b, c):
    """a b + c with one rounding."""

    def build(context, builder, signature, arguments):
        return builder.fma(*arguments)

    return types.float64(types.float64, types.float64, types.float64), build


@njit
def _halves(a):
    """Leave `a` whole: `_product` needs no halves here."""
    return a


@njit
def _product(a, b):
    """Rounded product and its error, the same as `_compensated._product` finds."""
    p = a * b
    return p, _fused(a, b, -p)


@njit
def _select(condition, a, b):
    """One of two numbers that are both there."""
    return a if condition else b


@njit
def _larger(a, b):
    """Maximum without a case for nan."""
    return a if a > b else b


@njit
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
    """Compile functions of `module`; what was compiled before replaces what they call by name."""
    for name in names:
        function = getattr(module, name)
        renamed = FunctionType(function.__code__, {**function.__globals__, **_known}, name)
        _known[name] = njit(error_model="numpy")(renamed)


_compile(_compensated, "_sum", "approach", "responses")
_compile(
    _generated,
    *("stop_velocity", "slide", "stick", "reverse", "energy_change"),
    *("stick_response", "slopes"),
    *("poisson_early", "poisson_late", "stronge_early", "stronge_late"),
)
_compile(_kernel, "mirrored", "regime_of", "newton", "_slopes", "poisson", "stronge")
_compile(_kernel, "_of_regime", "impact")
_impact = _known["impact"]


def _scalar_kernel(law: str):
    """The impact under one law, nine floats in, nine numbers out."""
    final_velocity = _known[law]

    def collide(c_x, c_z, omega, plate_velocity, X, Z, k, friction, restitution):
        return _impact(
            final_velocity, c_x, c_z, omega, plate_velocity, X, Z, k, friction, restitution
        )

    collide.__name__ = collide.__qualname__ = f"collide_{law}"
    return njit(error_model="numpy")(collide)


collide_newton = _scalar_kernel("newton")
collide_poisson = _scalar_kernel("poisson")
collide_stronge = _scalar_kernel("stronge")
