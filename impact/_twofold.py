"""Numbers with twice the digits of a float, for sums that may cancel."""

from functools import cached_property
from typing import Any

from ._kernel import (
    carried,
    lack_of_quotient,
    split,
    two_product,
    two_sum,
    twofold_of_product,
    twofold_sum,
)


class Twofold:
    """Number with twice the digits: the sum of a rounded number and what it lacks.

    The functions of `_generated` run on it as on any number. An exact number lacks nothing, and
    operations leave out what would change no digit; each number is split once. The first part of a
    sum is rounded to its last digits only when it is `carried`.
    """

    def __init__(self, high: Any, low: Any = None) -> None:
        self.high, self.exact = high, low is None
        self.low: Any = 0.0 if low is None else low

    @cached_property
    def parts(self):
        """The rounded number with its upper and its lower half."""
        return split(self.high)

    def __getitem__(self, index):
        found = Twofold(self.high[index], None if self.exact else self.low[index])
        if "parts" in vars(self):
            found.parts = tuple(part[index] for part in self.parts)
        return found

    def __neg__(self):
        return Twofold(-self.high, None if self.exact else -self.low)

    def __add__(self, other):
        if self.exact and other.exact:
            return Twofold(*two_sum(self.high, other.high))
        return Twofold(*twofold_sum(self.high, self.low, other.high, other.low))

    def __sub__(self, other):
        return self + -other

    def __mul__(self, other):
        if other.exact and not self.exact:
            return other * self
        p, error = two_product(self.parts, other.parts)
        if self.exact:
            return Twofold(p, error if other.exact else error + self.high * other.low)
        return Twofold(*twofold_of_product(p, error, self.high, self.low, other.high, other.low))

    def carried(self):
        """The same number, with its first part rounded from the whole."""
        return Twofold(*carried(self.high, self.low))


def quotient(a, b):
    """Quotient a/b of two rounded numbers, in twice the digits."""
    found = Twofold(a / b)
    found.low, found.exact = lack_of_quotient(a, b, found.parts, split(b)), False
    return found
