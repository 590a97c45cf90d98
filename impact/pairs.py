"""Frictional impact of any two bodies that meet at a point; a rod on a plate is one such pair."""

from functools import partial
from typing import Any, Generic, NamedTuple, overload

import numpy as np

from . import _generated as closed
from . import _kernel as kernel
from ._arguments import Code, Codes, InputError, Number, Numbers, evaluated, fields_of, shown
from ._impacts import Regime
from ._select import select
from ._twofold import Twofold
from .collision import exponent, law_of

SHORT = 2.0**-100  # gyration radius over the lever; a shorter one gives the same digits


@shown
class Body(NamedTuple, Generic[Number]):
    """Rigid body that meets another one, moving in a plane; numbers or arrays that broadcast.

    Attributes
    ----------
    mass : > 0; inf for a body that keeps its velocity and spin, like a plate or a wall
    k : gyration radius, > 0
    X, Z : centre of mass as seen from the contact point, along and across the contact
    c_x, c_z : velocity of the centre of mass along and across the contact
    omega : angular velocity, positive turns +z towards +x; rad per unit of time
    """

    mass: Number
    k: Number
    X: Number
    Z: Number
    c_x: Number
    c_z: Number
    omega: Number = 0.0  # type: ignore[assignment]

    def turned(self, angle: Any) -> "Body[Number]":
        """The same body in axes turned by an angle, rad, positive from z towards x as a spin is.

        Bodies that are known in one frame and meet across a normal at this angle from its z axis
        are `turned(angle)` before `collide_pair`, and the resulting ones `turned(-angle)`.

        Parameters
        ----------
        angle : rad; broadcasts with the fields (for a type checker they stay numbers or arrays)

        Raises
        ------
        TypeError
            If an argument is not a real number.
        """

        def block(angle, X, Z, c_x, c_z):
            along, across = np.cos(angle), np.sin(angle)
            place = along * X - across * Z, across * X + along * Z
            return *place, along * c_x - across * c_z, across * c_x + along * c_z

        fields = {name: getattr(self, name) for name in ("X", "Z", "c_x", "c_z")}
        parts = evaluated(block, {"angle": angle, **fields}, [None] * len(fields))
        return self._replace(**dict(zip(fields, parts, strict=True)))


@shown
class PairCollision(NamedTuple, Generic[Number, Code]):
    """State after an impact of two bodies; fields have the broadcast shape of the arguments.

    Attributes
    ----------
    first, second : `Body` after the impact; mass, k, X, Z as they were given
    regime : `Regime`, or an int8 array of its values, of the contact point of the first body as
        seen from the second
    P_x, P_z : impulse on the first body, mass times velocity; its opposite acts on the second
    energy_change : kinetic energy of both bodies after minus before, the same in every frame (and
        the work on a body of infinite mass)
    """

    first: Body[Number]
    second: Body[Number]
    regime: Code
    P_x: Number
    P_z: Number
    energy_change: Number


def _impact(final_velocity: Any, *block: Any) -> tuple[Any, ...]:
    """Velocities of both bodies, regime code, impulse and energy change.

    Lengths of each body, speeds and masses are scaled by powers of two, which changes no digit. The
    contact velocity and the mobilities are summed in twice the digits; the kernel then sees one
    impact.
    """
    *given, mu, epsilon = block
    numbers = np.empty((7, 2, *np.broadcast(*block).shape))  # fields of both bodies
    for index, values in enumerate(given):
        numbers[index % 7, index // 7] = values
    both = Body(*numbers)
    mass, fixed = both.mass, np.isinf(both.mass)
    mass[fixed] = 1.0  # the inverse of inf is set below
    size = exponent(both.X, both.Z, both.k)
    speed = np.maximum(exponent(both.c_x, both.c_z), exponent(both.omega) + size).max(0)
    mass, power = np.frexp(mass)
    power = np.where(fixed, power[::-1], power)
    light = np.ldexp(mass, power - power.max(0))[::-1]  # 1/mass, up to 1
    light = select(fixed, 0.0, light)
    mass, power = mass.prod(0), power.min(0)  # in units of mass 2^power

    k = np.maximum(np.ldexp(both.k, -size), SHORT)
    levers = np.ldexp(numbers[2:4], -size)
    c_x, c_z = (Twofold(np.ldexp(speeds, -speed)) for speeds in (both.c_x, both.c_z))
    # centres and spins apart: bodies that move alike must not lose their small difference
    turn = Twofold(np.ldexp(both.omega, size - speed))
    lift, turned = (Twofold(lever) * turn for lever in levers)
    u = ((c_x[0] - c_x[1]) + (turned[1] - turned[0])).carried()
    v = ((c_z[0] - c_z[1]) + (lift[0] - lift[1])).carried()
    ratios = Twofold(*kernel.twofold_quotient(levers, k))
    parts = Twofold(light), ratios[0], ratios[1]
    *seen, cross = closed.pair_mobility(*(part[i] for i in range(2) for part in parts))
    A, B, C = (part.carried() for part in seen)
    D = closed.pair_determinant(light[0], light[1], A.high, C.high, cross.high + cross.low)
    side = np.copysign(1.0, np.where(u.high == 0, B.high, u.high))
    mu = np.minimum(mu, kernel.HUGE_FRICTION)
    B = Twofold(side * B.high, side * B.low)
    factor = Twofold(mu)
    held, freed = factor * B, factor * C
    N, T = (A + held).carried(), (B + freed).carried()
    N_back = (A.high - held.high) + (A.low - held.low)
    T_back = (B.high - freed.high) + (B.low - freed.low)
    contact = N.high, T.high, N_back, T_back, D, C.high, N.low, T.low
    velocities = np.abs(u.high), v.high, side * u.low, v.low

    j_1, j_2, u_f, v_f, *branch = kernel.phases(final_velocity, velocities, contact, 1.0, epsilon)
    hits, _, sticks = branch
    P_x = kernel.added(hits, sticks, j_1, j_2, -mu, mu, B.high)
    P_z = kernel.added(hits, sticks, j_1, j_2, 1.0, 1.0, C.high)
    energy = closed.energy_change(P_x, P_z, *velocities[:2], u_f, v_f)
    P_x = side * P_x
    s, x, z = (part.high for part in parts)
    s[1] *= -1  # the opposite impulse acts on the second body
    *change, turned = closed.pair_change(s, x, z, P_x, P_z)
    c_x, c_z = (old + np.ldexp(d, speed) for old, d in zip(both[4:6], change, strict=True))
    omega = both.omega + np.ldexp(turned / k, speed - size)
    after = (part[i] for i in range(2) for part in (c_x, c_z, omega))
    code = kernel.regime_of(*branch)
    stuck = hits & fixed.all(0)  # all other results are nan, as no body can give way
    if np.ndim(stuck) == 0 and stuck:
        raise InputError("first.mass and second.mass must not both be inf where they close")
    code = np.where(stuck, Regime.INVALID, code)
    impulses = (np.ldexp(mass * part, power + speed) for part in (P_x, P_z))
    return *after, code, *impulses, np.ldexp(mass * energy, power + 2 * speed)


@overload
def collide_pair(
    first: Body[float], second: Body[float], *, friction: float, restitution: float, law: str = ...
) -> PairCollision[float, Regime]: ...
@overload
def collide_pair(
    first: Body, second: Body, *, friction: Any, restitution: Any, law: str = ...
) -> PairCollision[Numbers, Codes]: ...
def collide_pair(
    first: Body, second: Body, *, friction: Any, restitution: Any, law: str = "newton"
) -> PairCollision:
    """State of two rigid bodies after one frictional impact at a point, in a plane.

    All arguments broadcast; float32 in gives float32 out (computed in float64). The contact point
    is the origin, x along the contact and z across it, from the second body to the first. With
    lengths in one unit, velocities in that unit per time, spins are in rad per that time.

    Parameters
    ----------
    first, second : `Body`, or (mass, k, X, Z, c_x, c_z, omega) in its order
    friction : Coulomb coefficient, >= 0; inf is the limit of large friction
    restitution : between 0 and 1, in the sense of `law`
    law : "newton", "poisson" or "stronge", as in `collide`

    Returns
    -------
    PairCollision
        Bodies that do not close come back unchanged, as NO_IMPACT. Array elements out of their
        domain, two infinite masses that close, and nan or inf anywhere (but infinite mass or
        friction) give nan and INVALID, without a warning.

    Raises
    ------
    ValueError
        If a scalar argument is out of its domain, two bodies of infinite mass close, `law` is
        unknown, or two labelled arguments (pandas, xarray) differ in their labels.
    TypeError
        If an argument is not a real number, or a body not a `Body`.

    Notes
    -----
    Derived in `derivations.pairs`. The impact is that of the rod on a plate that has the same 2 x 2
    matrix of inverse masses at the contact point; if the second body is infinitely heavy, it is
    that of `collide`. Which body is the first does not matter: exchanged, and turned by half a
    turn, they give the same result. A k below 1e-30 of its body's lever counts as 1e-30 of it.

    Examples
    --------
    Two equal balls; the one at rest takes over all the speed, and starts to turn the other way:

    >>> ball = Body(mass=1.0, k=0.63, X=0.0, Z=1.0, c_x=0.0, c_z=-1.0, omega=2.0)
    >>> rest = Body(mass=1.0, k=0.63, X=0.0, Z=-1.0, c_x=0.0, c_z=0.0)
    >>> hit = collide_pair(ball, rest, friction=0.3, restitution=1.0)
    >>> hit.regime.name, float(hit.second.c_z), round(float(hit.second.omega), 2)
    ('SLIP_STICK', -1.0, -0.72)
    """
    given = {
        **fields_of("first", first, Body),
        **fields_of("second", second, Body),
        "friction": friction,
        "restitution": restitution,
    }
    kinds = [None] * 6 + [Regime] + [None] * 3
    block = partial(_impact, law_of(law))
    *velocities, regime, P_x, P_z, energy = evaluated(block, given, kinds)
    one, other = Body(*first[:4], *velocities[:3]), Body(*second[:4], *velocities[3:])
    return PairCollision(one, other, regime, P_x, P_z, energy)
