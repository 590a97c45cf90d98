"""Numbers with twice the digits of a float, for sums that may cancel."""

from typing import Any

from ._kernel import carried, twofold_product, twofold_sum


class Twofold:
    """Number with twice the digits: the sum of a rounded number and what it lacks.

    The functions of `_generated` run on it as on any number. The first part of a sum is rounded to
    its last digits only when it is `carried`.
    """

    def __init__(self, high: Any, low: Any = None) -> None:
        self.high, self.low = high, 0.0 * high if low is None else low

    def __getitem__(self, index):
        return Twofold(self.high[index], self.low[index])

    def __neg__(self):
        return Twofold(-self.high, -self.low)

    def __add__(self, other):
        return Twofold(*twofold_sum(self.high, self.low, other.high, other.low))

    def __sub__(self, other):
        return self + -other

    def __mul__(self, other):
        return Twofold(*twofold_product(self.high, self.low, other.high, other.low))

    def carried(self):
        """The same number, with its first part rounded from the whole."""
        return Twofold(*carried(self.high, self.low))
