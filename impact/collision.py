"""The impact map: one frictional impact of a rigid body with a heavy plate, three laws.

The branch rule, free of divisions and good for every sign, friction and geometry: in the mirror
frame in which the contact point slips forward (u_0 >= 0), with N and T of `slip_response`,

    slide          N > 0, u_0 > 0 and u_0 N + (1 + restitution) v_0 T >= 0
    slip-stick     else, where X Z <= mu (k^2 + Z^2)
    slip reversal  else

It holds inside the Painleve region (N <= 0) too, where slip always stops and friction always
holds. Where u_0 = 0 the mirror is chosen such that X Z >= 0.
"""

from enum import IntEnum
from functools import reduce
from typing import Any, NamedTuple

import numpy as np

from . import _generated as closed
from ._arguments import FRICTION, RESTITUTION, in_blocks, real_array, result_dtype
from ._compensated import approach, responses
from .geometry import ContactGeometry, geometry_arrays

LAWS = ("newton", "poisson", "stronge")

# Friction beyond this gives the same impact to the last digit; it stands in for infinity, which
# is thereby the limit of large friction.
_HUGE_FRICTION = 2.0**960
# Plain arithmetic neither over- nor underflows while lengths and speeds lie between these and
# friction is below the last; a block that leaves them is scaled by powers of two, exactly.
_SMALL, _LARGE, _LARGE_FRICTION = 1e-70, 1e70, 1e60


class Regime(IntEnum):
    """What the contact point does during an impact."""

    INVALID = -1  # an argument is nan or out of its domain
    NO_IMPACT = 0  # the contact point does not approach the plate
    SLIDE = 1  # slips until it separates
    SLIP_STICK = 2  # stops and is held by friction
    SLIP_REVERSAL = 3  # stops and slips back


class Collision(NamedTuple):
    """State after an impact; every field has the broadcast shape of the arguments.

    Impulses and energy are per unit mass. `slip_velocity` and `normal_velocity` are those of the
    contact point, relative to the plate; `energy_change` is kinetic energy after minus before in
    the frame of the plate.
    """

    c_x: Any
    c_z: Any
    omega: Any
    regime: Any
    P_x: Any
    P_z: Any
    slip_velocity: Any
    normal_velocity: Any
    energy_change: Any


class _Approach(NamedTuple):
    """What decides the regime, in the mirror frame (side = +-1 leads back)."""

    side: Any
    X: Any
    u_0: Any
    v_0: Any
    mu: Any
    N: Any
    T: Any
    N_back: Any
    T_back: Any
    hits: Any
    slides: Any
    sticks: Any


def _approach(c_x, c_z, omega, V_z, X, Z, k, mu, epsilon) -> _Approach:
    """Mirror the impact to u_0 >= 0 and apply the branch rule."""
    u_0, v_0 = approach(c_x, c_z, omega, V_z, X, Z)
    side = np.copysign(1.0, np.where(u_0 == 0, X * Z, u_0))
    X, u_0 = side * X, np.abs(u_0)
    mu = np.minimum(mu, _HUGE_FRICTION)
    N, T, N_back, T_back = responses(X, Z, k, mu)
    hits = v_0 < 0
    slides = (u_0 * N + (1 + epsilon) * v_0 * T >= 0) & (u_0 > 0) & (N > 0)
    return _Approach(side, X, u_0, v_0, mu, N, T, N_back, T_back, hits, slides, T_back <= 0)


def _regime(a: _Approach) -> np.ndarray:
    stopped = np.where(a.sticks, Regime.SLIP_STICK, Regime.SLIP_REVERSAL)
    return np.where(a.hits, np.where(a.slides, Regime.SLIDE, stopped), Regime.NO_IMPACT)


def _final_velocity(law, a: _Approach, Z, k, epsilon, v_1):
    """Normal velocity at separation of an impact in which the slip stops."""
    if law == "newton":
        return -epsilon * a.v_0
    w_stick, r_stick = closed.stick_slopes(a.X, Z, k, a.u_0, a.N, a.T)
    w_back, r_back = closed.reverse_slopes(a.u_0, a.N, a.T, a.N_back)
    w = np.where(a.u_0 > 0, np.where(a.sticks, w_stick, w_back), 0.0)
    r = np.where(a.sticks, r_stick, r_back)
    late = np.minimum(np.maximum(v_1, 0.0), -epsilon * a.v_0)  # rounding at the slide's edge
    if law == "poisson":
        early = closed.poisson_early(epsilon, v_1, w)
        return np.where(v_1 < 0, early, closed.poisson_late(epsilon, a.v_0, late, r))
    favourable, adverse = closed.stronge_early(a.X, Z, k, epsilon, a.u_0, a.v_0, v_1, w)
    early = np.where(a.X * Z < 0, adverse, favourable)
    return np.sqrt(np.where(v_1 < 0, early, closed.stronge_late(epsilon, a.v_0, late, r)))


def _impact(law, c_x, c_z, omega, V_z, X, Z, k, mu, epsilon):
    """All regimes of a block of valid impacts, then the right one of each."""
    a = _approach(c_x, c_z, omega, V_z, X, Z, k, mu, epsilon)
    X, u_0, v_0, mu = a.X, a.u_0, a.v_0, a.mu
    slips = u_0 > 0
    v_1 = np.where(slips, closed.stop_velocity(u_0, v_0, a.N, a.T), v_0)
    T = np.where(slips, a.T, 1.0)  # without slip nothing is divided by T, which may be 0
    v_stop = _final_velocity(law, a, Z, k, epsilon, v_1)

    slide = closed.slide(X, Z, k, mu, epsilon, u_0, v_0, a.N, a.T)
    back = closed.reverse(X, Z, k, mu, u_0, v_1, v_stop, T, a.N_back, a.T_back)
    P_x, P_z, spin = closed.stick(X, Z, k, u_0, v_0, v_stop)
    # The contact cannot end with less impulse than it took to stop; keeps P_z > 0 in rounding.
    P_z = np.where(X * Z > 0, np.maximum(P_z, k * k * u_0 / T), P_z)

    def select(when_sliding, when_sticking, when_reversing):
        stopped = np.where(a.sticks, when_sticking, when_reversing)
        return np.where(a.slides, when_sliding, stopped)

    P_x = select(slide[0], P_x, back[0])
    P_z = select(slide[1], P_z, back[1])
    spin = select(slide[2], spin, back[2])
    u_f = select(np.maximum(slide[3], 0.0), 0.0, np.minimum(back[3], 0.0))
    v_f = np.where(a.slides, -epsilon * v_0, v_stop)
    energy = closed.energy_change(P_x, P_z, u_0, v_0, u_f, v_f)
    P_x, P_z, spin, energy = (np.where(a.hits, part, 0.0) for part in (P_x, P_z, spin, energy))
    return (
        c_x + a.side * P_x,
        c_z + P_z,
        omega + a.side * spin,
        _regime(a),
        a.side * P_x,
        P_z,
        a.side * np.where(a.hits, u_f, u_0),
        np.where(a.hits, v_f, v_0),
        energy,
    )


def _exponent(*values):
    """Power of two just above the largest magnitude."""
    return np.frexp(reduce(np.maximum, map(np.abs, values)))[1]


def _scaled(function, c_x, c_z, omega, V_z, X, Z, k, mu, epsilon):
    """`function` with lengths and speeds scaled by powers of two: exact, and in range."""
    length = _exponent(X, Z, k)
    spin, spin_exponent = np.frexp(omega)
    speed = np.maximum(_exponent(c_x, c_z, V_z), np.where(spin == 0, -5000, spin_exponent + length))
    c = [np.ldexp(value, -speed) for value in (c_x, c_z)]
    plate = np.ldexp(V_z, -speed)
    turn = np.ldexp(spin, spin_exponent + length - speed)
    sizes = [np.ldexp(value, -length) for value in (X, Z, k)]
    results = list(function(*c, turn, plate, *sizes, mu, epsilon))
    powers = {0: speed, 1: speed, 2: speed - length, 4: speed, 5: speed, 6: speed, 7: speed}
    if len(results) > 1:
        for index, power in {**powers, 8: 2 * speed}.items():
            results[index] = np.ldexp(results[index], power)
    return tuple(results)


def _guarded(function, *arguments):
    """`function` on the valid elements of a block; nan and INVALID for the others."""
    if _ordinary(*arguments):
        return function(*arguments)
    *moving, mu, epsilon = arguments
    valid = (moving[-1] > 0) & FRICTION.holds(mu) & RESTITUTION.holds(epsilon)
    for value in moving:
        valid &= np.isfinite(value)
    moving = [np.where(valid, value, 1.0) for value in moving]
    mu, epsilon = (np.where(valid, value, 0.5) for value in (mu, epsilon))
    return tuple(
        np.where(valid, part, np.nan if part.dtype.kind == "f" else Regime.INVALID)
        for part in _scaled(function, *moving, mu, epsilon)
    )


def _ordinary(c_x, c_z, omega, V_z, X, Z, k, mu, epsilon) -> bool:
    """Whether a whole block is valid and far from over- and underflow; false if there is a nan."""
    size = np.maximum(np.maximum(np.abs(X), np.abs(Z)), k)
    speed = np.maximum(np.abs(c_x), np.abs(c_z)) + np.abs(V_z) + np.abs(omega) * size
    return (
        k.min() > 0
        and size.min() > _SMALL
        and size.max() < _LARGE
        and speed.min() > _SMALL
        and speed.max() < _LARGE
        and mu.min() >= 0
        and mu.max() < _LARGE_FRICTION
        and epsilon.min() >= 0
        and epsilon.max() <= 1
    )


def _prepare(c_x, c_z, omega, geometry, friction, restitution, plate_velocity):
    """Arguments as arrays in the kernels' order, and the dtype of the results."""
    arrays = [
        real_array("c_x", c_x),
        real_array("c_z", c_z),
        real_array("omega", omega),
        real_array("plate_velocity", plate_velocity),
        *geometry_arrays(geometry),
        real_array("friction", friction, FRICTION),
        real_array("restitution", restitution, RESTITUTION),
    ]
    values = (c_x, c_z, omega, plate_velocity, *geometry, friction, restitution)
    return arrays, result_dtype(values)


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
) -> Collision:
    """State of a rod after one frictional impact with the plate, Eqs. (7)-(22), (B1)-(B12).

    All arguments broadcast; float32 in gives float32 out (computed in float64).

    Parameters
    ----------
    c_x, c_z : velocity of the centre of mass along and across the plate, any finite number
    omega : angular velocity, positive turns the rod's top towards +x
    geometry : X, Z, k; units of length that make omega X a velocity; k > 0
    friction : Coulomb coefficient, >= 0; inf is the limit of large friction
    restitution : between 0 and 1, in the sense of `law`
    plate_velocity : V_z of the plate, across itself
    law : "newton" (the paper's kinematic restitution, v_f = -restitution v_0), "poisson"
        (impulse after over impulse before the end of compression) or "stronge" (its square is
        the part of the work of compression that is given back)

    Returns
    -------
    Collision
        A pair that does not approach (v_0 >= 0) comes back unchanged, as NO_IMPACT. Array
        elements out of their domain, and nan or inf anywhere (but infinite friction), give nan
        and INVALID, without a warning.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain, or `law` is unknown.
    TypeError
        If an argument is not a real number.

    Notes
    -----
    P_z > 0 in every impact. Newton's law can create energy (`energy_restitution` says where);
    the other two cannot. The map is continuous but for one jump: inside the Painleve region
    the impulse stays finite as v_0 -> 0-, while v_0 = 0 is no impact.

    Examples
    --------
    >>> from math import radians
    >>> hit = collide(1.0, -2.0, geometry=thin_rod(radians(20)), friction=0.4, restitution=0.65)
    >>> hit.regime.name
    'SLIP_STICK'
    """
    if law not in LAWS:
        raise ValueError(f"law must be one of {', '.join(LAWS)}, got {law!r}")
    arrays, dtype = _prepare(c_x, c_z, omega, geometry, friction, restitution, plate_velocity)

    def kernel(*block):
        return _impact(law, *block)

    def blocks(*block):
        return _guarded(kernel, *block)

    dtypes = [dtype] * 3 + [np.dtype(np.int8)] + [dtype] * 5
    results = list(in_blocks(blocks, arrays, dtypes))
    if np.ndim(results[3]) == 0:
        results[3] = Regime(int(results[3]))
    return Collision(*results)


def classify(
    c_x: Any,
    c_z: Any,
    omega: Any = 0.0,
    *,
    geometry: ContactGeometry,
    friction: Any,
    restitution: Any,
    plate_velocity: Any = 0.0,
) -> Any:
    """Regime of an impact without computing its outcome; the same for all three laws.

    Parameters and errors as in `collide`.

    Returns
    -------
    Regime, or an int8 array of its values
    """
    arrays, _ = _prepare(c_x, c_z, omega, geometry, friction, restitution, plate_velocity)

    def kernel(*block):
        return (_regime(_approach(*block)),)

    def blocks(*block):
        return _guarded(kernel, *block)

    (regime,) = in_blocks(blocks, arrays, [np.dtype(np.int8)])
    return Regime(int(regime)) if np.ndim(regime) == 0 else regime
