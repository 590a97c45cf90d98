"""Numbers with twice the digits of a float, for sums that may cancel."""

from functools import cached_property
from typing import Any

from ._kernel import (
    carried,
    lack_of_quotient,
    split,
    two_product,
    twofold_of_product,
    twofold_sum,
)


class Twofold:
    """Number with twice the digits: the sum of a rounded number and what it lacks.

    The functions of `_generated` run on it as on any number; each number is split once. The first
    part of a sum is rounded to its last digits only when it is `carried`.
    """

    def __init__(self, high: Any, low: Any = None) -> None:
        self.high, self.low = high, 0.0 * high if low is None else low

    @cached_property
    def parts(self):
        """The rounded number with its upper and its lower half."""
        return split(self.high)

    def __getitem__(self, index):
        return Twofold(self.high[index], self.low[index])

    def __neg__(self):
        return Twofold(-self.high, -self.low)

    def __add__(self, other):
        return Twofold(*twofold_sum(self.high, self.low, other.high, other.low))

    def __sub__(self, other):
        return self + -other

    def __mul__(self, other):
        p, error = two_product(self.parts, other.parts)
        return Twofold(*twofold_of_product(p, error, self.high, self.low, other.high, other.low))

    def carried(self):
        """The same number, with its first part rounded from the whole."""
        return Twofold(*carried(self.high, self.low))


def quotient(a, b):
    """Quotient a/b of two rounded numbers, in twice the digits."""
    q = a / b
    return Twofold(q, lack_of_quotient(a, b, split(q), split(b)))
