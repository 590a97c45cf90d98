"""A rod, and what a kernel takes of it."""

from typing import NamedTuple

from .kernels.contact import Effects, Motion
from .laws import Law, friction_of


class Rod(NamedTuple):
    """Spherocylinder of diameter 1.

    length : overall, caps included, >= 1
    inertia : "solid", of the uniform body, or "thin", the paper's length^2/12
    """

    length: float = 9.5
    inertia: str = "solid"

    @property
    def half_length(self) -> float:
        """From the centre to the centre of a cap."""
        return (self.length - 1) / 2

    @property
    def gyration_squared(self) -> float:
        """Moment of inertia about the centre over the mass."""
        if self.inertia == "thin":
            return self.length**2 / 12
        h = self.length - 1  # cylinder between the caps; volumes in units of pi/12
        offset = h / 2 + 3 / 16  # of the centre of mass of a half ball of radius 1/2
        ball = 1 / 10 - (3 / 16) ** 2 + offset**2
        return (3 * h * (h**2 / 12 + 1 / 16) + 2 * ball) / (3 * h + 2)

    @property
    def axial_gyration_squared(self) -> float:
        """Moment of inertia of the uniform body about its axis over its mass.

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
    return Effects(half, light, normal, rubbing, gravity, plate, True if half > 0 else None)
