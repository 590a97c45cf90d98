"""Numbers in twice the digits, for sums that may cancel."""

from ._kernel import twofold_product, twofold_quotient, twofold_sum


class Twofold:
    """A number as the sum of a rounded one and what that lacks.

    The functions of `_generated` run on it as on any number.
    """

    def __init__(self, high, low=None):
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


def quotient(a, b):
    """a/b of two rounded numbers."""
    return Twofold(*twofold_quotient(a, b))
