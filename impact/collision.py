"""The impact map: one frictional impact of a rigid body with a heavy plate, under three laws."""

from collections.abc import Callable
from functools import partial, reduce
from typing import Any, Generic, NamedTuple, overload

import numpy as np

from . import _kernel as kernel
from ._arguments import Code, Codes, InputError, Number, Numbers, evaluated, shown
from ._impacts import Regime, ordinary
from .geometry import ContactGeometry, lengths_of

LAWS = {"newton": kernel.newton, "poisson": kernel.poisson, "stronge": kernel.stronge}


@shown
class Collision(NamedTuple, Generic[Number, Code]):
    """State after an impact; every field has the broadcast shape of the arguments.

    Attributes
    ----------
    c_x, c_z : velocity of the centre of mass along and across the plate
    omega : angular velocity
    regime : `Regime`, or an int8 array of its values
    P_x, P_z : impulse of the plate on the rod, per unit mass
    slip_velocity, normal_velocity : of the contact point along and across, relative to the plate
    energy_change : kinetic energy after minus before in the frame of the plate, per unit mass
    """

    c_x: Number
    c_z: Number
    omega: Number
    regime: Code
    P_x: Number
    P_z: Number
    slip_velocity: Number
    normal_velocity: Number
    energy_change: Number


def exponent(*values: Any) -> Any:
    """Exponent of the power of two just above the largest magnitude; of zeros alone, -5000."""
    powers = [np.where(value == 0, -5000, np.frexp(value)[1]) for value in values]
    return reduce(np.maximum, powers)


def _scaled(function: Callable[..., tuple], *block: Any) -> tuple[Any, ...]:
    """Evaluate a function with lengths and speeds scaled by powers of two: exact, and in range."""
    c_x, c_z, omega, V_z, X, Z, k, mu, epsilon = block
    length = exponent(X, Z, k)
    speed = np.maximum(exponent(c_x, c_z, V_z), exponent(omega) + length)
    c = [np.ldexp(value, -speed) for value in (c_x, c_z)]
    plate = np.ldexp(V_z, -speed)
    turn = np.ldexp(omega, length - speed)
    X, Z, k = (np.ldexp(value, -length) for value in (X, Z, k))
    k = np.maximum(k, 2.0**-500)  # so that its square does not vanish
    results = list(function((*c, turn, plate, X, Z, k, mu, epsilon)))
    if len(results) == 1:  # the regime alone
        return tuple(results)
    for index in (0, 1, 4, 5, 6, 7):
        results[index] = np.ldexp(results[index], speed)
    results[2] = np.ldexp(results[2], speed - length)
    results[8] = np.ldexp(results[8], 2 * speed)
    for index, before in enumerate((c_x, c_z, omega)):  # scaled, a small number may be lost
        results[index] = np.where(results[3] == Regime.NO_IMPACT, before, results[index])
    return tuple(results)


def _in_range(function: Callable[..., tuple], *block: Any) -> tuple[Any, ...]:
    """Evaluate a function on a block of impacts; impacts of unusual size are scaled."""
    usual = ordinary(block)
    if np.all(usual):
        return function(block)
    block = np.broadcast_arrays(*block)
    parts = function([value[usual] for value in block])
    others = _scaled(function, *(value[~usual] for value in block))
    results = [np.empty(usual.shape, part.dtype) for part in parts]
    for result, part, other in zip(results, parts, others, strict=True):
        result[usual], result[~usual] = part, other
    return tuple(results)


def law_of(name: str) -> Callable[..., tuple]:
    """Kernel of a law of restitution by its name; an unknown name raises `InputError`."""
    if not isinstance(name, str) or name not in LAWS:
        raise InputError(f"law must be one of {', '.join(LAWS)}, got {name!r}")
    return LAWS[name]


def arguments(
    c_x: Any,
    c_z: Any,
    omega: Any,
    geometry: ContactGeometry,
    friction: Any,
    restitution: Any,
    plate_velocity: Any,
) -> dict[str, Any]:
    """Arguments of `collide` by name, in the kernel's order."""
    return {
        "c_x": c_x,
        "c_z": c_z,
        "omega": omega,
        "plate_velocity": plate_velocity,
        **lengths_of(geometry),
        "friction": friction,
        "restitution": restitution,
    }


KINDS = [Regime if field == "regime" else None for field in Collision._fields]


@overload
def collide(
    c_x: float,
    c_z: float,
    omega: float = ...,
    *,
    geometry: ContactGeometry[float],
    friction: float,
    restitution: float,
    plate_velocity: float = ...,
    law: str = ...,
) -> Collision[float, Regime]: ...
@overload
def collide(
    c_x: Any,
    c_z: Any,
    omega: Any = ...,
    *,
    geometry: ContactGeometry,
    friction: Any,
    restitution: Any,
    plate_velocity: Any = ...,
    law: str = ...,
) -> Collision[Numbers, Codes]: ...
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

    All arguments broadcast; float32 in gives float32 out (computed in float64). With lengths in
    one unit, velocities in that unit per time, omega is in rad per that time, in and out.

    Parameters
    ----------
    c_x, c_z : velocity of the centre of mass along and across the plate, any finite number
    omega : angular velocity, positive turns the rod's top towards +x
    geometry : X, Z, k, in the unit of length of the velocities (cm for cm/s); k > 0
    friction : Coulomb coefficient, >= 0; inf is the limit of large friction, and counts as 3e150
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
        If a scalar argument is out of its domain, `law` is unknown, or two labelled arguments
        (pandas, xarray) differ in their labels.
    TypeError
        If an argument is not a real number.

    Notes
    -----
    P_z > 0 in every impact. Newton's law can create energy (`energy_restitution` says where);
    the other two cannot. The map is continuous but for one jump: inside the Painleve region
    the impulse stays finite as v_0 -> 0-, while v_0 = 0 is no impact. A k below 2**-500, 3e-151, of
    the largest length counts as that.

    Examples
    --------
    >>> from math import radians
    >>> from impact import thin_rod
    >>> hit = collide(1.0, -2.0, geometry=thin_rod(radians(20)), friction=0.4, restitution=0.65)
    >>> hit.regime.name
    'SLIP_STICK'
    """
    given = arguments(c_x, c_z, omega, geometry, friction, restitution, plate_velocity)
    block = partial(_in_range, partial(kernel.impact, law_of(law)))
    return Collision(*evaluated(block, given, KINDS))


@overload
def classify(
    c_x: float,
    c_z: float,
    omega: float = ...,
    *,
    geometry: ContactGeometry[float],
    friction: float,
    restitution: float,
    plate_velocity: float = ...,
) -> Regime: ...
@overload
def classify(
    c_x: Any,
    c_z: Any,
    omega: Any = ...,
    *,
    geometry: ContactGeometry,
    friction: Any,
    restitution: Any,
    plate_velocity: Any = ...,
) -> Codes: ...
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

    Parameters
    ----------
    c_x, c_z, omega, geometry, friction, restitution, plate_velocity : as in `collide`

    Returns
    -------
    Regime, or an int8 array of its values

    Raises
    ------
    ValueError, TypeError
        As `collide`.
    """

    def regime_alone(block: Any) -> tuple[Any, ...]:
        *_, velocities, contact = kernel.mirrored(block)
        return (kernel.regime_of(*kernel.branches(velocities, contact, block[-1])[-3:]),)

    given = arguments(c_x, c_z, omega, geometry, friction, restitution, plate_velocity)
    return evaluated(partial(_in_range, regime_alone), given, [Regime])[0]
