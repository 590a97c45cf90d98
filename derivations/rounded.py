"""Numbers that know what every rounding on their way would add to them, to first order."""

from collections.abc import Mapping
from functools import total_ordering
from itertools import count
from typing import Any

import mpmath

Number = Any  # a `Rounded` one, or one of the text itself, which is exact


@total_ordering
class Rounded:
    """A number, and what each rounding, by its whole size, would add to it."""

    __slots__ = ("errors", "value")
    _names = count()

    def __init__(self, value: Number, errors: Mapping[int, Number] | None = None) -> None:
        self.value, self.errors = mpmath.mpf(value), dict(errors or {})

    @classmethod
    def of(cls, value: Number) -> "Rounded":
        """A number as it is; one of the text is exact."""
        return value if isinstance(value, cls) else cls(value)

    @property
    def error(self) -> Number:
        """Most that its roundings would add, if each were as large as the number it rounds."""
        return sum(map(abs, self.errors.values()))

    def parted(self) -> tuple["Rounded", "Rounded"]:
        """The number rounded once more, and what that took away."""
        name = next(self._names)
        low = Rounded(0, {name: -self.value})
        return Rounded(self.value, {**self.errors, name: self.value}), low

    def _exactly(self, own: Number, other: "Rounded", its: Number, value: Number) -> "Rounded":
        """The number `value`, to which both numbers' errors come with these weights."""
        errors = {name: own * size for name, size in self.errors.items()}
        for name, size in other.errors.items():
            errors[name] = errors.get(name, 0) + its * size
        return Rounded(value, errors)

    def plus(self, other: Number) -> "Rounded":
        """The sum before it is rounded."""
        other = Rounded.of(other)
        return self._exactly(1, other, 1, self.value + other.value)

    def times(self, other: Number) -> "Rounded":
        """The product before it is rounded."""
        other = Rounded.of(other)
        return self._exactly(other.value, other, self.value, self.value * other.value)

    def __neg__(self) -> "Rounded":
        return Rounded(-self.value, {name: -size for name, size in self.errors.items()})

    def __add__(self, other: Number) -> "Rounded":
        return self.plus(other).parted()[0]

    def __sub__(self, other: Number) -> "Rounded":
        return self + -Rounded.of(other)

    def __rsub__(self, other: Number) -> "Rounded":
        return Rounded.of(other) - self

    def __mul__(self, other: Number) -> "Rounded":
        exact = 1 in (abs(self.value), abs(Rounded.of(other).value))
        return self.times(other) if exact else self.times(other).parted()[0]

    def __truediv__(self, other: Number) -> "Rounded":
        other = Rounded.of(other)
        q = self.value / other.value
        return self._exactly(1 / other.value, other, -q / other.value, q).parted()[0]

    def __rtruediv__(self, other: Number) -> "Rounded":
        return Rounded.of(other) / self

    __radd__, __rmul__ = __add__, __mul__

    def __eq__(self, other: object) -> bool:
        return bool(self.value == Rounded.of(other).value)

    def __lt__(self, other: Number) -> bool:
        return bool(self.value < Rounded.of(other).value)

    def sqrt(self) -> "Rounded":
        """Square root; nan of what is no square, or of zero if that is rounded."""
        if self.value <= 0:
            return Rounded(0 if self.value == self.error == 0 else mpmath.nan)
        root = mpmath.sqrt(self.value)
        return self._exactly(1 / (2 * root), self, 0, root).parted()[0]
