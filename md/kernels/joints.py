"""Two ends that meet, compiled: one place, though it is the end contact of either rod.

Each end of two rods has a contact with the other rod's axis. Between an end of one and an end of
the other the energy of a contact at the distance of the two, U(ends), is taken off again:

    V = sum over ends U(end to axis) - sum over two ends that are near U(end to end).

Where an end finds the other rod's end nearest, its energy is U(ends) as well and drops out: one
contact is left of cap on cap, and of an end on a side close to the side's own end. Rods that lie
side by side touch at two places, in full once they overlap by more than sqrt(2 overlap): there the
ends no longer reach each other. As they slide off each other, the two places become one without a
jump. No length is chosen, and V has continuous forces.

What is taken off is divided between the two contacts, so that dashpot and friction, too, count the
place once: by the squares of how far each foot lies from the end, which is how U(ends) differs
from either energy. At the one place, where the shares add up to 1, there is one spring.
"""

from math import sqrt
from typing import NamedTuple

from ..cache import kernel

BELOW_ONE = 1.0 - 2.0**-53  # next to 1


class Joint(NamedTuple):
    """An end of a rod near an end of another."""

    force: float  # in units of the stiffness; of a contact at the distance of the two ends
    part: float  # of it that is taken off the first contact; the rest, off the second
    first: float  # share of the contact that remains to the first rod's end
    second: float  # to the second's


@kernel
def joint(square, first, second):
    """What two ends with the squared distance `square` < 1 share.

    `first`, `second`: how far the foot of the first rod's end lies from the other end along the
    second axis, and the reverse, in d.
    """
    square = min(square, BELOW_ONE)  # a rounding may have told that they touch
    first, second = first * first, second * second
    total = first + second
    part = second / total if total > 0.0 else 0.5
    overlap = 1.0 - sqrt(square)
    ratio, other = overlap / (1.0 - sqrt(square - first)), overlap / (1.0 - sqrt(square - second))
    return Joint(
        overlap * sqrt(overlap),
        part,
        1.0 - part * ratio * sqrt(ratio),
        1.0 - (1.0 - part) * other * sqrt(other),
    )
