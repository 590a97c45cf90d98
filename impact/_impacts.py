"""Regimes of an impact, and its arguments."""

from collections.abc import Callable
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from .geometry import ContactGeometry

# Plain arithmetic neither over- nor underflows while lengths and speeds lie between the first two
# and friction is below the last.
SMALL, LARGE, LARGE_FRICTION = 1e-70, 1e70, 1e60


class Regime(IntEnum):
    """What the contact point does during an impact."""

    INVALID = -1  # an argument is nan or out of its domain
    NO_IMPACT = 0  # the contact point does not approach the plate
    SLIDE = 1  # slips until it separates
    SLIP_STICK = 2  # stops and is held by friction
    SLIP_REVERSAL = 3  # stops and slips back


class Impacts(NamedTuple):
    """Arguments of one impact, or of many as arrays; a unit of length and one of time of choice.

    c_x : length/time
    c_z : length/time
    omega : rad/time
    plate_velocity : length/time
    X : length
    Z : length
    k : length
    friction : Coulomb coefficient
    restitution : 0 to 1
    """

    c_x: Any
    c_z: Any
    omega: Any
    plate_velocity: Any
    X: Any
    Z: Any
    k: Any
    friction: Any
    restitution: Any

    def collide(self, function: Callable, law: str = "newton") -> Any:
        """Call a function with the signature of `impact.collide` with these arguments.

        Parameters
        ----------
        function : `impact.collide` or its like
        law : of restitution
        """
        c_x, c_z, omega, V_z, *arms, mu, epsilon = self
        given = {"geometry": ContactGeometry(*arms), "friction": mu, "restitution": epsilon}
        return function(c_x, c_z, omega, plate_velocity=V_z, law=law, **given)


def ordinary(given: Any) -> Any:
    """Whether an impact is valid and far from over- and underflow; false if there is a nan."""
    c_x, c_z, omega, V_z, X, Z, k, mu, epsilon = given
    size = np.abs(X) + np.abs(Z) + k
    speed = np.abs(c_x) + np.abs(c_z) + np.abs(V_z) + np.abs(omega) * size
    sized = (k > SMALL) & (size < LARGE) & (speed > SMALL) & (speed < LARGE)
    return sized & (mu >= 0) & (mu < LARGE_FRICTION) & (epsilon >= 0) & (epsilon <= 1)
