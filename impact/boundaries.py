"""Boundaries between the regimes of an impact, over tilt and friction."""

from typing import Any, overload

import numpy as np

from . import _generated as closed
from ._arguments import LARGEST, Number, Numbers, evaluated
from .geometry import ContactGeometry, lengths_of, unit_lengths


def _critical(X: Any, Z: Any, k: Any) -> Any:
    """Critical friction |X Z|/(k^2 + Z^2); X may differ from the other lengths by any factor."""
    (_, own), (_, others) = np.frexp(X), np.frexp(np.maximum(np.abs(Z), k))
    near_one = np.ldexp(X, -own), np.ldexp(Z, -others), np.ldexp(k, -others)
    return np.ldexp(np.abs(closed.critical_friction(*near_one)), own - others)


@overload
def critical_tilts(friction: float) -> tuple[float, float]: ...
@overload
def critical_tilts(friction: Any) -> tuple[Numbers, Numbers]: ...
def critical_tilts(friction: Any) -> tuple[Any, Any]:
    """Both critical tilts of a thin rod, Eq. (23): between them a stopped contact slips back.

    Parameters
    ----------
    friction : Coulomb coefficient, >= 0

    Returns
    -------
    (lower, upper) : tilts in rad, both roots of mu (k^2 + Z^2) = X Z; tan(lower) tan(upper) = 4.
        nan for friction > 3/4, where the contact sticks at every tilt; at 3/4 both are arctan 2.

    Raises
    ------
    ValueError
        If a scalar friction is negative.
    """

    def block(mu):
        root = np.sqrt((3 - 4 * mu) * (3 + 4 * mu))  # nan beyond the end, mu = 3/4
        a, b, c = closed.critical_tangents(mu, root)
        return np.arctan2(a, b), np.arctan2(b, c)

    return evaluated(block, {"friction": friction}, (None, None))


def critical_friction(geometry: ContactGeometry[Number]) -> Number:
    """Friction below which a stopped contact slips back, |X Z|/(k^2 + Z^2); Eqs. (16), (20).

    Parameters
    ----------
    geometry : any X, Z, and k > 0

    Returns
    -------
    Dimensionless; nan for array elements out of their domain.

    Raises
    ------
    ValueError
        If k is a scalar <= 0.
    """
    return evaluated(lambda X, Z, k: (_critical(X, Z, k),), lengths_of(geometry))[0]


def painleve_friction(geometry: ContactGeometry[Number]) -> Number:
    """Least friction at which a slipping contact is pressed into the plate: Painleve's paradox.

    It is (k^2 + X^2)/|X Z|, for the slip that friction opposes towards the centre of mass: to -x
    where X Z > 0. Not in the paper; derived in `derivations.optimum`.

    Parameters
    ----------
    geometry : any X, Z, and k > 0

    Returns
    -------
    Dimensionless; inf where XZ = 0, nan for array elements out of their domain. For a thin rod
        never below 4/3, which it is at a tilt of arctan(1/2).

    Raises
    ------
    ValueError
        If k is a scalar <= 0.
    """
    # (k^2 + X^2)/|X Z| is one over the critical friction of a body with X and Z exchanged
    return evaluated(lambda X, Z, k: (1 / _critical(Z, X, k),), lengths_of(geometry))[0]


@overload
def slide_friction(
    geometry: ContactGeometry[float], *, approach_ratio: float, restitution: float
) -> float: ...
@overload
def slide_friction(
    geometry: ContactGeometry, *, approach_ratio: Any, restitution: Any
) -> Numbers: ...
def slide_friction(geometry: ContactGeometry, *, approach_ratio: Any, restitution: Any) -> Any:
    """Largest friction at which the contact slides until it separates: u_* = 0 in Eq. (14).

    Parameters
    ----------
    geometry : any X, Z, and k > 0
    approach_ratio : -c_z/c_x > 0 of a rod without spin (omega = 0, c_x > 0) on a plate at rest
    restitution : between 0 and 1; the three laws agree about a slide

    Returns
    -------
    Dimensionless; 0 where the slip stops at every friction, inf where it never does.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain.
    """

    def block(X, Z, k, ratio, epsilon):
        gain = np.minimum((1 + epsilon) * ratio, LARGEST)  # 0 times inf is no number
        above, below = closed.slide_friction(*unit_lengths(X, Z, k), gain)
        return (np.where(below > 0, np.maximum(above, 0.0) / below, np.inf),)

    given = {"approach_ratio": approach_ratio, "restitution": restitution}
    return evaluated(block, {**lengths_of(geometry), **given})[0]


@overload
def energy_restitution(geometry: ContactGeometry[float], friction: float) -> float: ...
@overload
def energy_restitution(geometry: ContactGeometry, friction: Any) -> Numbers: ...
def energy_restitution(geometry: ContactGeometry, friction: Any) -> Any:
    """Restitution above which Newton's kinematic law can create energy.

    Above it there is an approach (u_0, v_0) after which the rod has more energy than before;
    at or below it there is none. Not in the paper; derived in `derivations.laws`.

    Parameters
    ----------
    geometry : any X, Z, and k > 0
    friction : Coulomb coefficient, >= 0

    Returns
    -------
    Dimensionless, at most 1; 1 where even full restitution creates none (no friction, or XZ = 0).
        For a thin rod it is 4/sqrt(16 + 9 sin(2 tilt)^2) where the contact sticks: never below
        4/5.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain.
    """

    def block(X, Z, k, mu):
        x, z, k = unit_lengths(np.abs(X), np.abs(Z), k)  # A, B, C are times k^2, D times k^4
        A, B, C = k * k + x * x, x * z, k * k + z * z
        reverses = mu * C < B
        mu = np.where(reverses, mu, 0.0)
        root_a, root_c = np.hypot(k, x), np.hypot(k, z)
        sticking = closed.energy_restitution_stick(root_a, root_c, k * np.hypot(root_a, z))
        kappa = closed.energy_threshold_back(B, C, mu, root_a, np.sqrt(A - mu * mu * C))
        return (np.where(reverses, (1 - kappa) / (1 + kappa), sticking),)

    return evaluated(block, {**lengths_of(geometry), "friction": friction})[0]
