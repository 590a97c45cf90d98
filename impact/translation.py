"""Stationary translation of bouncing rods, Section V, Eqs. (24)-(31)."""

from collections.abc import Callable
from typing import Any, Generic, NamedTuple, overload

import numpy as np

from . import _generated as closed
from ._arguments import (
    POSITIVE,
    Code,
    Codes,
    InputError,
    Number,
    Numbers,
    count,
    evaluated,
    real_array,
    shown,
)
from ._impacts import Regime
from .geometry import ContactGeometry, lengths_of, unit_lengths


@shown
class Drift(NamedTuple, Generic[Number, Code]):
    """Stationary drift: velocity of the centre of mass, the same at every landing.

    c_x : along the plate, in the unit of the plate's velocity
    c_z : upwards after a landing, in the same unit; before it -c_z
    regime : `Regime`, or an int8 array of its values
    """

    c_x: Number
    c_z: Number
    regime: Code


@overload
def drift(
    geometry: ContactGeometry[float],
    *,
    friction: float,
    restitution: float,
    plate_velocity: float = ...,
) -> Drift[float, Regime]: ...
@overload
def drift(
    geometry: ContactGeometry, *, friction: Any, restitution: Any, plate_velocity: Any = ...
) -> Drift[Numbers, Codes]: ...
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

    def block(X, Z, k, mu, epsilon, V_z):
        x, z, k = unit_lengths(np.abs(X), np.abs(Z), k)
        k = np.maximum(k, 1e-153)  # x^2 stays; below it c_x is the same and c_z next to nothing
        x, z = x / k, z / k
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
        "friction": friction,
        "restitution": restitution,
        "plate_velocity": plate_velocity,
    }
    return Drift(*evaluated(block, given, (None, None, Regime), plate_velocity=POSITIVE))


@overload
def relaxation(
    geometry: ContactGeometry[float], *, friction: float, restitution: float
) -> float: ...
@overload
def relaxation(geometry: ContactGeometry, *, friction: Any, restitution: Any) -> Numbers: ...
def relaxation(geometry: ContactGeometry, *, friction: Any, restitution: Any) -> Any:
    """Number of landings in which a small deviation from the stationary drift falls by e.

    -1/ln(rho), with rho the largest modulus of the eigenvalues of what one landing makes of
    (c_x, c_z), by the closure of `drift`. Never negative: the stationary landing is stable. Not in
    the paper; derived in `derivations.optimum`.

    Parameters
    ----------
    geometry : any X, Z, and k > 0
    friction : Coulomb coefficient, >= 0
    restitution : between 0 and 1 (kinematic)

    Returns
    -------
    Number of landings, in the mean over many: a deviation may oscillate as it falls. inf where a
        deviation stays: without friction, and for a vertical rod at restitution 1.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain.

    Notes
    -----
    Continuous over tilt and friction. Where two eigenvalues meet it has a corner with a vertical
    side, at which half of the digits are left.

    Examples
    --------
    >>> float(relaxation((0.1, 0.5, 0.3), friction=0.3, restitution=0.65).round(3))
    2.607
    """

    def block(X, Z, k, mu, epsilon):
        x, z, k = unit_lengths(np.abs(X), np.abs(Z), k)
        k = np.maximum(k, 1e-70)  # k^4 stays; there the contact sticks, or a deviation does
        held = np.minimum(mu / closed.critical_friction(x, z, k), 1.0)
        response = closed.landing_response(x, z, k, epsilon, held)
        steady, alternating, shrinking, apart, coupling = response
        turn, apart = np.sqrt(coupling), np.abs(apart)
        least = np.minimum(steady, alternating)  # 1 - tr + det where the larger is positive
        root = np.sqrt((apart - turn) * (apart + turn))
        gap = np.where(apart < turn, shrinking, 2 * least / (least + shrinking + root))
        landings = np.where(apart < turn, -2.0, -1.0) / np.log1p(-np.minimum(gap, 1.0))
        return (np.where(mu > 0, landings, np.inf),)

    given = {"friction": friction, "restitution": restitution}
    return evaluated(block, {**lengths_of(geometry), **given})[0]


@shown
class Optimum(NamedTuple, Generic[Number, Code]):
    """Tilt at which a thin rod drifts fastest, and that drift.

    tilt : rad
    c_x : drift of the rod, over the plate's velocity at landing
    regime : `Regime`, or an int8 array of its values
    """

    tilt: Number
    c_x: Number
    regime: Code


@overload
def optimal_tilt(*, friction: float, restitution: float) -> Optimum[float, Regime]: ...
@overload
def optimal_tilt(*, friction: Any, restitution: Any) -> Optimum[Numbers, Codes]: ...
def optimal_tilt(*, friction: Any, restitution: Any) -> Optimum:
    """Tilt of a thin rod's largest stationary drift, and that drift, in closed form.

    The best tilt is that of slip-stick, that of slip reversal, or the critical tilt between them
    (a corner of the drift); not in the paper, derived in `derivations.optimum`.

    Parameters
    ----------
    friction : Coulomb coefficient, >= 0
    restitution : between 0 and 1 (kinematic)

    Returns
    -------
    Optimum
        tilt in rad, c_x in units of the plate's velocity at landing; at the corner, where friction
        just holds, the regime is slip-stick. At restitution 1 the drift grows without bound as
        the tilt goes to 0: tilt 0 and an infinite c_x. Without friction the drift is not
        determined: nan and INVALID.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain.

    Examples
    --------
    >>> best = optimal_tilt(friction=0.3, restitution=0.65)
    >>> float(np.degrees(best.tilt).round(2)), float(best.c_x.round(3)), best.regime.name
    (13.21, 3.32, 'SLIP_STICK')
    """

    def block(mu, epsilon):
        mu, a, b = np.where(mu > 0, mu, np.nan), 1 - epsilon, 7 - epsilon
        weak = np.minimum(mu, 0.75)  # beyond it the contact sticks at every tilt
        back, along_back = closed.optimum_back(
            weak, epsilon, np.hypot(weak * (9 - epsilon), np.sqrt(a * b))
        )
        stick = np.sqrt(a) / np.sqrt(b)
        above, below, _ = closed.critical_tangents(weak, np.sqrt((3 - 4 * weak) * (3 + 4 * weak)))
        critical = np.where(mu > 0.75, np.inf, above / below)
        reverses = critical < back
        tangent = np.where(reverses, back, np.minimum(stick, critical))
        corner = closed.thin_drift_stick(epsilon, tangent)
        along_stick = closed.optimum_stick(epsilon, np.sqrt(a), np.sqrt(b))
        along = np.where(reverses, along_back, np.where(stick < critical, along_stick, corner))
        regime = np.where(reverses, Regime.SLIP_REVERSAL, Regime.SLIP_STICK)
        return np.arctan(tangent), along, np.where(mu > 0, regime, Regime.INVALID)

    given = {"friction": friction, "restitution": restitution}
    return Optimum(*evaluated(block, given, (None, None, Regime)))


def landing_phases(q: Any) -> tuple[Any, Any]:
    """First and last phase, in rad, of the landings of rods that fall with q <= 1 times V_0."""
    away = np.arcsin(q)  # the last is pi/2 + away
    low, high = away, np.pi + away  # of pi/2 less the first phase
    for _ in range(60):
        middle = (low + high) / 2
        swept = 2 * np.sin((middle - away) / 2) * np.sin((middle + away) / 2)
        short = swept < q * (2 * np.pi - middle - away)
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return np.pi / 2 - high, np.pi / 2 + away


@overload
def landing_density(phase: float, *, fall_speed: float = ...) -> float: ...
@overload
def landing_density(phase: Any, *, fall_speed: Any = ...) -> Numbers: ...
def landing_density(phase: Any, *, fall_speed: Any = 1.0) -> Any:
    """Density of landing phases in proportion to the velocity of approach, (31), Fig. 8.

    Rods that fall with q times the plate's largest velocity meet it in proportion to
    q + cos(theta), each at its first contact: below q = 1 the plate runs away from them and
    overtakes them again, and no rod lands between. At q = 1 it is the paper's
    H = (1 + cos(theta))/(2 pi); the rest is derived in `derivations.landing_phases`.

    Parameters
    ----------
    phase : theta, rad, any real numbers; the plate rises fastest at 0
    fall_speed : q = |c_z|/V_0 of the rod before it lands, > 0

    Returns
    -------
    Density per rad; nan where the phase is not finite.

    Raises
    ------
    ValueError
        If the fall speed is a scalar <= 0.
    TypeError
        If an argument is not a real number or an array of them.
    """

    def block(theta, q):
        start, end = landing_phases(np.minimum(q, 1.0))
        since = np.mod(theta - start, 2 * np.pi)
        met = (q >= 1) | (since <= end - start)
        approach = np.maximum(1 + np.cos(theta) / q, 0.0)  # rounding at the last phase
        return (np.where(met | ~np.isfinite(theta), approach / (2 * np.pi), 0.0),)

    return evaluated(block, {"phase": phase, "fall_speed": fall_speed})[0]


@overload
def mean_plate_velocity(
    density: Callable[[Numbers], Any] = ..., plate_speed: float = ..., *, points: int = ...
) -> float: ...
@overload
def mean_plate_velocity(
    density: Callable[[Numbers], Any] = ..., plate_speed: Any = ..., *, points: int = ...
) -> Numbers: ...
def mean_plate_velocity(
    density: Callable[[Numbers], Any] = landing_density,
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
    points : nodes of the periodic midpoint rule, at least 3; n of them are exact for
        trigonometric densities up to the degree n - 2; converges as 1/n where the density jumps

    Returns
    -------
    V_z in the unit of `plate_speed`; 1/2 of it for the paper's density.

    Raises
    ------
    ValueError
        If the density is negative, not finite, or zero everywhere, or `points` < 3.
    """
    nodes = count("points", points, 3)
    phase = 2 * np.pi * (np.arange(nodes) + 0.5) / nodes
    weight = np.broadcast_to(real_array("density", density(phase)), phase.shape)
    if not np.all(np.isfinite(weight)) or weight.min() < 0 or weight.max() == 0:
        raise InputError("density must be finite, not negative, and not zero everywhere")
    mean = np.average(np.cos(phase), weights=weight / weight.max())
    return evaluated(lambda speed: (speed * mean,), {"plate_speed": plate_speed})[0]
