"""Arithmetics in which a routine is run for its proof: what its primitives do in each.

EXACT    plain numbers (mpmath's): what the text says if nothing is rounded
ROUNDED  `Rounded` numbers, with what every rounding on the way adds to them, to first order
SHORT    arrays of `Short` floating-point numbers, of so few binary digits that all can be tried
"""

from collections.abc import Mapping
from functools import total_ordering
from itertools import count
from typing import Any

import mpmath
import numpy as np

Number = Any  # of one of these arithmetics
Primitives = Mapping[str, Any]  # functions and constants


@total_ordering
class Rounded:
    """A number, and what each rounding, by its whole size, would add to it."""

    __slots__ = ("errors", "value")
    _names = count()

    def __init__(self, value: Number, errors: Mapping[int, Number] | None = None) -> None:
        self.value, self.errors = value, dict(errors or {})

    @classmethod
    def of(cls, value: Number) -> "Rounded":
        """A number as it is; one of the text itself is exact."""
        return value if isinstance(value, cls) else cls(mpmath.mpf(value))

    def parted(self) -> tuple["Rounded", "Rounded"]:
        """The number rounded once more, and what that took away."""
        name = next(self._names)
        low = Rounded(mpmath.mpf(0), {name: -self.value})
        return Rounded(self.value, {**self.errors, name: self.value}), low

    def exactly(self, own: Number, other: "Rounded", its: Number, value: Number) -> "Rounded":
        """The number `value`, to which both numbers' errors come with these weights."""
        errors = {name: own * size for name, size in self.errors.items()}
        for name, size in other.errors.items():
            errors[name] = errors.get(name, 0) + its * size
        return Rounded(value, errors)

    def plus(self, other: Number) -> "Rounded":
        """The sum before it is rounded."""
        other = Rounded.of(other)
        return self.exactly(1, other, 1, self.value + other.value)

    def times(self, other: Number) -> "Rounded":
        """The product before it is rounded."""
        other = Rounded.of(other)
        return self.exactly(other.value, other, self.value, self.value * other.value)

    def over(self, other: "Rounded") -> "Rounded":
        """The quotient before it is rounded."""
        q = self.value / other.value
        return self.exactly(1 / other.value, other, -q / other.value, q)

    def __neg__(self) -> "Rounded":
        return Rounded(-self.value, {name: -size for name, size in self.errors.items()})

    def __add__(self, other: Number) -> "Rounded":
        return self.plus(other).parted()[0]

    def __sub__(self, other: Number) -> "Rounded":
        return self + -Rounded.of(other)

    def __rsub__(self, other: Number) -> "Rounded":
        return Rounded.of(other) - self

    def __mul__(self, other: Number) -> "Rounded":
        product = self.times(other)
        signs = (x.value in (-1, 1) and not x.errors for x in (self, Rounded.of(other)))
        return product if any(signs) else product.parted()[0]

    def __truediv__(self, other: Number) -> "Rounded":
        return self.over(Rounded.of(other)).parted()[0]

    def __rtruediv__(self, other: Number) -> "Rounded":
        return Rounded.of(other) / self

    __radd__, __rmul__ = __add__, __mul__

    def __eq__(self, other: object) -> bool:
        return bool(self.value == Rounded.of(other).value)

    def __lt__(self, other: Number) -> bool:
        return bool(self.value < Rounded.of(other).value)

    def __abs__(self) -> "Rounded":
        return self if self >= 0 else -self

    def sqrt(self) -> "Rounded":
        """Square root; of what is not a square, which no branch then takes, nan."""
        root = mpmath.sqrt(self.value) if self.value > 0 else mpmath.nan
        return self.exactly(1 / (2 * root), self, 0, root).parted()[0]


class Short:
    """Arrays of floating-point numbers of `digits` binary digits, rounded to nearest even."""

    digits = 7

    def __init__(self, value: Any) -> None:
        mantissa, power = np.frexp(value)
        self.value = np.ldexp(np.rint(np.ldexp(mantissa, self.digits)), power - self.digits)

    def __neg__(self) -> "Short":
        return Short(-self.value)

    def __add__(self, other: "Short") -> "Short":
        return Short(self.value + other.value)

    def __sub__(self, other: "Short") -> "Short":
        return Short(self.value - other.value)

    def __mul__(self, other: "Short") -> "Short":
        return Short(self.value * other.value)


def _chosen(condition: bool, a: Number, b: Number) -> Number:
    return a if condition else b


def _tied(a: Number, b: Number) -> Number:
    """Of two equal numbers the one with more roundings, whichever comes first."""

    def roundings(x: Number) -> tuple[bool, Number]:
        known = isinstance(x, Rounded)  # else a number of the text
        return known, sum(map(abs, x.errors.values())) if known else 0

    return max(a, b, key=roundings)


_SHARED: Primitives = {
    "select": _chosen,
    "larger": lambda a, b: _tied(a, b) if a == b else _chosen(a > b, a, b),
    "smaller": lambda a, b: _tied(a, b) if a == b else _chosen(a < b, a, b),
    "copysign": lambda size, sign: _chosen(sign < 0, -size, size),
    "abs": abs,
    "split": lambda a: a,
}
EXACT: Primitives = {
    **_SHARED,
    "sqrt": lambda a: mpmath.sqrt(a) if a > 0 else mpmath.nan,
    "two_sum": lambda a, b: (a + b, 0),
    "two_product": lambda a, b: (a * b, 0),
}
ROUNDED: Primitives = {
    **_SHARED,
    "sqrt": Rounded.sqrt,
    "two_sum": lambda a, b: a.plus(b).parted(),
    "two_product": lambda a, b: Rounded.of(a).times(b).parted(),
}
# Seven digits part into three and three, as a sign is a digit, too: 53 into 26 and 26.
SHORT: Primitives = {"SPLIT": Short(2.0**4 + 1)}
ARITHMETICS = {"exact": EXACT, "rounded": ROUNDED, "short": SHORT}
