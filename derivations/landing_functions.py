"""Generated functions of the stationary landing: its stability, its cost."""

import sympy as sp

from . import optimum, transport
from .rewrites import Body, Function, recast
from .symbols import X, Z, epsilon, k, mu

_x, _z, _grip = sp.symbols("x z grip", positive=True)  # |X|/k, |Z|/k
_lost, _gained, _tilt, _pull = sp.symbols("lost gained tilt pull", real=True)
_rest, _push, _K, _R, _S = sp.symbols("rest push K R S", real=True)

_DETAIL = (
    "$1 - tr + det$, $1 + tr + det$, $1 - det$; the difference of the diagonal entries; $-4$ times "
    r"the product of the others. For $XZ \ge 0$."
)


def _response(case: str) -> Body:
    """What the eigenvalues of a landing's response are made of."""
    a, b, c, d = optimum.jacobian(case)
    names = sp.symbols("steady alternating shrinking apart coupling", real=True)
    return dict(zip(names, (*optimum.stability_margins(case), a - d, -4 * b * c), strict=True))


def _cost() -> Body:
    """Per length k."""
    cost = transport.cost_of_transport("back").subs({X: _x * k, Z: _z * k})
    return {sp.Symbol("cost", real=True): cost.subs(mu, _grip * _x / (1 + _z**2))}


FUNCTIONS: tuple[Function, ...] = (
    Function(
        name="transport_cost",
        summary="Work of the plate per weight and distance, with the grip of `drift_grips`.",
        detail="Lengths in units of $k$: $x = |X|/k$, $z = |Z|/k$.",
        arguments=(_x, _z, epsilon, _grip),
        derived=_cost,
        rules=(
            recast(
                "divide by $x$",
                "$x^2$ cannot underflow",
                cost=((1 - epsilon) / _x + 2 * _x) / ((1 + epsilon) * (_z + _grip)),
            ),
        ),
    ),
    Function(
        name="response_stick",
        summary="Response of a stationary landing in slip-stick to a deviation.",
        detail=_DETAIL,
        arguments=(X, Z, k, epsilon),
        derived=lambda: _response("stick"),
        rules=(
            recast(
                "sums of positive terms",
                "a slow return keeps its digits; the discriminant is a difference of two squares",
                lost=1 - epsilon,
                gained=1 + epsilon,
                K=k**2 + X**2 + Z**2,
                steady=(_lost * k**2 + 2 * X**2) / _K,
                alternating=_gained * (k**2 + 2 * Z**2) / _K,
                shrinking=(k**2 + X**2 + _lost * Z**2) / _K,
                apart=(X**2 + _lost * Z**2 - epsilon * k**2) / _K,
                tilt=X * Z / _K,
                coupling=4 * _gained * _tilt**2,
            ),
        ),
    ),
    Function(
        name="response_back",
        summary="Response of a stationary landing in slip reversal to a deviation.",
        detail=_DETAIL,
        arguments=(X, Z, k, mu, epsilon),
        derived=lambda: _response("back"),
        rules=(
            recast(
                "sums of positive terms",
                "a slow return keeps its digits; the discriminant is a difference of two squares",
                lost=1 - epsilon,
                gained=1 + epsilon,
                R=k**2 + X * (X - mu * Z),
                S=X * Z + mu * (k**2 + Z**2),
                rest=2 * X * Z * (X**2 - mu**2 * (k**2 + Z**2)) + _lost * k**2 * Z * (X + mu * Z),
                push=_gained * mu * k**4,
                steady=2 * mu * k**2 * (_lost * k**2 + 2 * X**2) / (_R * _S),
                alternating=2 * _gained * k**2 * Z * (X + mu * Z) / (_R * _S),
                shrinking=(_rest + _push) / (_R * _S),
                apart=(_rest - _push) / (_R * _S),
                pull=mu * k**2 / _R,
                coupling=8 * _gained * X * Z * _pull**2 / _S,
            ),
        ),
    ),
)
