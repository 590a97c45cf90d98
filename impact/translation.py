"""Stationary translation of bouncing rods, Section V, Eqs. (24)-(31)."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from . import _generated as closed
from ._arguments import (
    ANY,
    FRICTION,
    POSITIVE,
    RESTITUTION,
    InputError,
    count,
    evaluated,
    real_array,
    result_dtype,
)
from ._kernel import Regime, as_regime
from .geometry import ContactGeometry, lengths_of


class Drift(NamedTuple):
    """Velocity of the centre of mass that repeats itself from landing to landing."""

    c_x: Any  # along the plate, in the unit of its velocity
    c_z: Any  # after a landing, upwards; before it -c_z
    regime: Any  # `Regime`, or an int8 array of its values


def drift(
    geometry: ContactGeometry, *, friction: Any, restitution: Any, plate_velocity: Any = 1.0
) -> Drift:
    """Stationary drift under the paper's closure, Eqs. (24)-(30), for any contact geometry.

    The closure: every landing finds the rod without spin, with the c_x of the landing before,
    and with the c_z that the last landing gave it, turned downwards.

    Parameters
    ----------
    geometry : any X, Z, and k > 0; positive X is a tilt towards +x
    friction : Coulomb coefficient, >= 0
    restitution : between 0 and 1 (kinematic)
    plate_velocity : V_z of the plate at landing, > 0

    Returns
    -------
    Drift
        In the unit of `plate_velocity`. c_x has the sign of XZ: a flat-ended rod below its
        threshold tilt drifts backwards. Without friction c_x is not determined: nan, with c_z
        finite and the regime INVALID. At restitution 1 and X = +-0 (a vertical rod)
        both velocities are infinite, c_x with the sign of XZ: the limit of small tilt.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain; in particular a plate velocity <= 0, with
        which the closure has no impact at all, so that it cannot explain a reverse drift.
    """

    def block(X: Any, Z: Any, k: Any, mu: Any, epsilon: Any, V_z: Any) -> tuple[Any, ...]:
        x, z = np.abs(X) / k, np.abs(Z) / k
        stick, back = closed.drift_grips(x, z, mu)
        sticks = ~(back < stick)
        along, up = closed.drift(x, z, epsilon, np.where(sticks, stick, back))
        # 0/0 where a vertical rod bounces without loss: 2 (1 + epsilon) z/(2 x) -> infinity
        along = np.where((x == 0) & (epsilon == 1) & (z > 0), np.inf, along)
        c_x = np.copysign(1.0, X) * np.copysign(1.0, Z) * along * V_z
        regime = np.where(sticks, Regime.SLIP_STICK, Regime.SLIP_REVERSAL)
        c_x, regime = np.where(mu > 0, c_x, np.nan), np.where(mu > 0, regime, Regime.INVALID)
        return c_x, up * V_z, regime

    given = {
        **lengths_of(geometry),
        "friction": (friction, FRICTION),
        "restitution": (restitution, RESTITUTION),
        "plate_velocity": (plate_velocity, POSITIVE),
    }
    c_x, c_z, regime = evaluated(block, given, (None, None, np.int8))
    return Drift(c_x, c_z, as_regime(regime))


def landing_density(phase: Any) -> Any:
    """The paper's density of landing phases, H = (1 + cos(theta))/(2 pi), Fig. 8.

    Parameters
    ----------
    phase : theta, rad, any real numbers; the plate rises fastest at 0

    Returns
    -------
    Density per rad, of the shape of `phase`; nan where that is not finite.

    Raises
    ------
    TypeError
        If the phase is not a real number or an array of them.
    """

    def block(theta: Any) -> tuple[Any, ...]:
        return ((1 + np.cos(theta)) / (2 * np.pi),)

    return evaluated(block, {"phase": (phase, ANY)})[0]


def mean_plate_velocity(
    density: Callable[[np.ndarray], Any] = landing_density,
    plate_speed: Any = 1.0,
    *,
    points: int = 4096,
) -> Any:
    """Mean plate velocity at landing, Eq. (31): the mean of V_0 cos(theta) over the phases.

    Parameters
    ----------
    density : function of the phase theta in [0, 2 pi), rad, with theta = 0 where the plate moves
        up fastest; not negative; need not be normalised
    plate_speed : V_0, the plate's largest velocity
    points : nodes of the periodic midpoint rule, which is exact for trigonometric densities and
        converges as points^-1 where the density jumps

    Returns
    -------
    V_z in the unit of `plate_speed`; 1/2 of it for the paper's density.

    Raises
    ------
    ValueError
        If the density is negative, not finite, or zero everywhere, or `points` < 1.
    """
    speed = real_array("plate_speed", plate_speed)
    nodes = count("points", points, 1)
    phase = 2 * np.pi * (np.arange(nodes) + 0.5) / nodes
    weight = np.broadcast_to(real_array("density", density(phase)), phase.shape)
    if not np.all(np.isfinite(weight)) or weight.min() < 0 or weight.max() == 0:
        raise InputError("density must be finite, not negative, and not zero everywhere")
    weight = weight / weight.max()
    mean = np.sum(weight * np.cos(phase)) / weight.sum()
    known = np.where(np.isfinite(speed), speed, np.nan)
    return (known * mean).astype(result_dtype([plate_speed]))[()]
