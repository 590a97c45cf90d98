"""Situations that try the code of one impact, and numbers that know their roundings.

The letters of a situation are those of the mirror frame, in which the contact slips forward; `side`
is the direction of slip outside of that frame. The numbers of a situation are sums of few powers of
two, so that edges are exact. A `Rounded` number knows what every rounding on its way would add to
it, to first order.
"""

import random
from collections.abc import Iterator, Mapping
from functools import total_ordering
from itertools import count
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from .symbols import V_z, X, Z, epsilon, k, mu, omega, u_0, v_0

Situation = Mapping[sp.Symbol, Any]  # a value of each letter

SIDE = sp.Symbol("side")
LETTERS = X, Z, k, mu, epsilon, u_0, v_0, omega, V_z, SIDE
_CLOSE = mpmath.mpf(2) ** -30  # relative distance to an edge


def numbers(seed: int, names: str, least: float = -2, most: float = 2) -> dict[str, mpmath.mpf]:
    """Random number for each name, between two bounds, reproducible by the seed."""
    draw = random.Random(f"{names} {seed}")
    return {
        name: draw.randrange(1, 2**30) * _CLOSE * (most - least) + least for name in names.split()
    }


def _contacts() -> Iterator[dict[str, Any]]:
    """Values of letters, by name: contacts of all regimes, at edges and in the Painleve region."""
    for seed in range(48):
        at = numbers(seed, "X Z v_0") | numbers(seed, "k mu u_0", 0.02)
        at |= numbers(seed, "epsilon", 0.1, 0.9) | {"v_0": -abs(at["v_0"])}
        kind, aside = seed % 12, 1 + (-1) ** (seed // 12) * _CLOSE
        if kind in (1, 2, 3, 4, 6, 11):
            side = 1 if kind in (1, 4, 11) else -1
            at["X"] = side * mpmath.sign(at["Z"]) * abs(at["X"])
        xz = at["X"] * at["Z"]
        across, along = (at["k"] ** 2 + at[x] ** 2 for x in "XZ")
        if kind in (1, 10) or seed in (11, 35, 47):
            at["u_0"] = mpmath.mpf(0)
        if kind == 10:
            at["Z"] = mpmath.mpf(0)
        elif kind in (2, 6):  # N close to 0, or below it
            at["mu"] = across / abs(xz) * (aside if kind == 2 else 2)
        elif kind in (3, 4):  # T close to 0, or T_back
            at["mu"] = along and abs(xz) / along * aside
        elif kind == 11 or seed in (1, 13, 25):  # slips back
            at["mu"] = abs(xz) / along / 2
        elif kind == 5:
            at["v_0"] = -at["v_0"]
        n, t = across + at["mu"] * xz, xz + at["mu"] * along
        if kind in (7, 8, 9) and n * t > 0:  # u_* close to 0, or the slip stops late
            divisor, near = (1, aside) if kind == 7 else (2, 1)
            at["v_0"] = -at["u_0"] * n / (t * (1 + at["epsilon"] / divisor)) * near
        yield at
    # A slip that stops late on a long lever; and, exact to the last digit: no approach; u_* = 0;
    # v_1 = 0; no slip, and nothing that starts it.
    names = "X", "Z", "k", "u_0", "v_0", "epsilon", "mu"
    for contact in (
        (1, 1, 0.015625, 1, -0.75, 0.5, 1),
        (0, -1, 1, 1, 0, 0.5, 0.5),
        (0, -1, 1, 1, -0.5, 1, 0.5),
        (0, -1, 1, 1, -1, 0.5, 0.5),
        (0, -1, 1, 0, -1, 0, 0),
    ):
        at = dict(zip(names, map(mpmath.mpf, contact), strict=True))
        yield at
    yield {**at, "mu": mpmath.mpf(2) ** 970}  # friction as good as infinite


def situations() -> Iterator[Situation]:
    """Situations of a rod on a moving plate: slip to either side, also with spins that cancel."""
    for seed, contact in enumerate(_contacts()):
        at = contact | numbers(seed, "omega V_z") | {"side": 1 - 2 * ((seed + seed // 12) % 2)}
        if seed % 5 == 0:
            at["omega"] = at["omega"] / _CLOSE
        yield {letter: at[letter.name] for letter in LETTERS}


Number = Any  # a `Rounded` one, or one of the text itself, which is exact

ROUNDINGS = 256  # twice as many as an impact has


@total_ordering
class Rounded:
    """Number with what each rounding of a run, as large as the rounded number, would add to it."""

    __slots__ = ("errors", "value")
    _names = count()

    def __init__(self, value: Number, errors: np.ndarray | float = 0.0) -> None:
        self.value, self.errors = mpmath.mpf(value), np.zeros(ROUNDINGS) + errors

    @classmethod
    def of(cls, value: Number) -> "Rounded":
        """Return a `Rounded` number as it is, any other one as exact."""
        return value if isinstance(value, cls) else cls(value)

    @property
    def error(self) -> float:
        """Most that all roundings would add, if each were as large as the number that it rounds."""
        return float(np.abs(self.errors).sum())

    def parted(self) -> tuple["Rounded", "Rounded"]:
        """Return the number rounded once more, and the part that this rounding took away."""
        rounding = np.zeros(ROUNDINGS)
        rounding[next(self._names) % ROUNDINGS] = self.value
        return Rounded(self.value, self.errors + rounding), Rounded(0, -rounding)

    def plus(self, other: Number) -> "Rounded":
        """Return the sum before it is rounded."""
        other = Rounded.of(other)
        return Rounded(self.value + other.value, self.errors + other.errors)

    def times(self, other: Number) -> "Rounded":
        """Return the product before it is rounded, its errors to first order."""
        other = Rounded.of(other)
        errors = float(other.value) * self.errors + float(self.value) * other.errors
        return Rounded(self.value * other.value, errors)

    def __neg__(self) -> "Rounded":
        return Rounded(-self.value, -self.errors)

    def __add__(self, other: Number) -> "Rounded":
        return self.plus(other).parted()[0]

    def __sub__(self, other: Number) -> "Rounded":
        return self + -Rounded.of(other)

    def __mul__(self, other: Number) -> "Rounded":
        product = self.times(other)
        exact = 1 in (abs(self.value), abs(Rounded.of(other).value))
        return product if exact else product.parted()[0]

    def __truediv__(self, other: Number) -> "Rounded":
        other = Rounded.of(other)
        q = self.value / other.value
        errors = (self.errors - float(q) * other.errors) / float(other.value)
        return Rounded(q, errors).parted()[0]

    def __rtruediv__(self, other: Number) -> "Rounded":
        return Rounded.of(other) / self

    __radd__, __rmul__ = __add__, __mul__

    def __eq__(self, other: object) -> bool:
        return self.value == Rounded.of(other).value

    def __lt__(self, other: Number) -> bool:
        return self.value < Rounded.of(other).value

    def sqrt(self) -> "Rounded":
        """Square root; nan of a negative number, and of zero if it has roundings."""
        if self.value <= 0:
            return Rounded(0 if self.value == self.error == 0 else mpmath.nan)
        root = mpmath.sqrt(self.value)
        return Rounded(root, self.errors / float(2 * root)).parted()[0]
