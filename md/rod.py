"""A rod, and what a kernel takes of it."""

from math import atan2, copysign, cos, hypot, inf, sin
from typing import Annotated, Literal, NamedTuple

from .kernels.state import Effects, Motion
from .laws import Law, friction_of

Length = Annotated[float, 1.0, 1000.0]  # d
Inertia = Literal["solid", "thin"]


class Rod(NamedTuple):
    """Rod of diameter 1.

    length : overall, caps included, d, >= 1
    inertia : "solid", of the uniform body, or "thin", the paper's length^2/12
    ends : "round", or "flat" for one impact alone: in the plane an end is then an edge with two
        corners. A corner pushes by the law of a cap with the stiffness of a cap, which is an
        assumption: a sharp edge has no Hertz radius
    """

    length: Length = 9.5
    inertia: Inertia = "solid"
    ends: Literal["round", "flat"] = "round"

    @property
    def half_length(self) -> float:
        """From the centre to the centre of a cap, or to a flat end, in d."""
        return (self.length - (self.ends == "round")) / 2

    @property
    def gyration_squared(self) -> float:
        """Moment of inertia about the centre over the mass, k^2, in d^2."""
        if self.inertia == "thin":
            return self.length**2 / 12
        if self.ends == "flat":
            return self.length**2 / 12 + 1 / 16
        h = self.length - 1  # cylinder between the caps; volumes in units of pi/12
        offset = h / 2 + 3 / 16  # of the centre of mass of a half ball of radius 1/2
        ball = 1 / 10 - (3 / 16) ** 2 + offset**2
        return (3 * h * (h**2 / 12 + 1 / 16) + 2 * ball) / (3 * h + 2)

    @property
    def axial_gyration_squared(self) -> float:
        """Moment of inertia of the uniform body about its axis over its mass, in d^2.

        Cylinder of length h = l - 1 and two half spheres, diameter 1: volumes pi h/4 and pi/6,
        moments of 1/8 and 1/10 of their masses.
        """
        cylinder, caps = (self.length - 1) / 4, 1 / 6
        return (cylinder / 8 + caps / 10) / (cylinder + caps)


def effects_of(
    rod: Rod,
    law: Law | None,
    friction: float,
    gravity: tuple[float, float] | None,
    plate: Motion | None,
) -> Effects:
    """All that acts on one rod; without a law of the plate there is none."""
    half, light = rod.half_length, 1 / rod.gyration_squared
    normal, rubbing = (law.normal, friction_of(law, friction)) if law else (None, None)
    upper, flat = (True if one else None for one in (half > 0, rod.ends == "flat"))
    return Effects(half, light, normal, rubbing, gravity, plate, upper, flat)


class LowerEnd(NamedTuple):
    """What of a rod touches first."""

    reach: float  # d, from the centre of mass to the centre of a cap, or to a corner
    offset: float  # rad; the tilt of that line less the rod's
    radius: float  # d, around it

    def arm(self, tilt: float) -> tuple[float, float]:
        """Where it touches, seen from the centre of mass, at a tilt; in d."""
        lean = tilt + self.offset
        return -self.reach * sin(lean), -(self.reach * cos(lean) + self.radius)


def lower_end(effects: Effects, tilt: float) -> LowerEnd:
    """Lower cap, or lower corner of a flat end; the sign of a zero tilt chooses the corner."""
    half = effects.half_length
    if effects.flat is None:
        return LowerEnd(half, 0.0, 0.5)
    return LowerEnd(hypot(half, 0.5), -copysign(atan2(0.5, half), tilt), 0.0)


def height_of_second(effects: Effects, tilt: float) -> float:
    """How high the second cap or corner is over the one that touches first, in d."""
    corner = inf if effects.flat is None else abs(sin(tilt))
    return min(2 * effects.half_length * cos(tilt), corner)
