"""Contacts and impacts in which routines are tried: every letter has a value."""

import random
from collections.abc import Iterator

import mpmath

from .routines import Situation


def numbers(seed: int, names: str, least: float = -2, most: float = 2) -> dict[str, mpmath.mpf]:
    """A number of each name between two bounds, the same for the same seed."""
    draw = random.Random(f"{names} {seed}")
    return {
        name: mpmath.mpf(draw.randrange(1, 10**9)) / 10**9 * (most - least) + least
        for name in names.split()
    }


def any_numbers(names: str) -> Iterator[Situation]:
    """Numbers of both signs."""
    return (numbers(seed, names) for seed in range(8))


_CLOSE = mpmath.mpf("1e-9")  # relative distance to an edge


def mirrored() -> Iterator[Situation]:
    """Contacts in the mirror frame: of all regimes, at the edges, in the Painleve region."""
    for seed in range(48):
        at = numbers(seed, "X Z v_0") | numbers(seed, "k mu u_0", 0.02)
        at |= numbers(seed, "epsilon", 0.1, 0.9) | {"v_0": -abs(at["v_0"])}
        kind, aside = seed % 12, 1 + (-1) ** (seed // 12) * _CLOSE
        if kind in (1, 4):
            at["X"] = mpmath.sign(at["Z"]) * abs(at["X"])
        if kind in (2, 3, 6):
            at["X"] = -mpmath.sign(at["Z"]) * abs(at["X"])
        xz = at["X"] * at["Z"]
        across, along = (at["k"] ** 2 + at[x] ** 2 for x in "XZ")
        if kind in (1, 10):
            at["u_0"] = mpmath.mpf(0)
        if kind == 10:
            at["Z"] = mpmath.mpf(0)
        elif kind in (2, 6):  # N close to 0, or below it
            at["mu"] = across / abs(xz) * (aside if kind == 2 else 2)
        elif kind in (3, 4):  # T close to 0, or T_back
            at["mu"] = along and abs(xz) / along * aside
        elif kind == 5:
            at["v_0"] = -at["v_0"]
        n, t = across + at["mu"] * xz, xz + at["mu"] * along
        if kind == 7 and n * t > 0:  # u_* close to 0
            at["v_0"] = -at["u_0"] * n / (t * (1 + at["epsilon"])) * aside
        elif kind in (8, 9) and n * t > 0:  # the slip stops late
            at["v_0"] = -at["u_0"] * n / (t * (1 + at["epsilon"] / 2))
        yield at
    yield from ON_EDGES


def _upright(**letters: float) -> Situation:
    """A rod that stands upright, with k = 1."""
    return {x: mpmath.mpf(value) for x, value in {"X": 0, "Z": -1, "k": 1, **letters}.items()}


# Nothing slips and nothing makes it: a contact that neither slides nor slips back.
AT_REST = _upright(mu=0, u_0=0, v_0=-1, epsilon=0)
# To the last digit: no approach; u_* = 0; v_1 = 0.
ON_EDGES = (
    _upright(mu=0.5, u_0=1, v_0=0, epsilon=0.5),
    _upright(mu=0.5, u_0=1, v_0=-0.5, epsilon=1),
    _upright(mu=0.5, u_0=1, v_0=-1, epsilon=0.5),
)


def whole() -> Iterator[Situation]:
    """Impacts of a rod on a moving plate, of both sides, with spins that cancel."""
    for seed, contact in enumerate(mirrored()):
        side = 1 - 2 * (seed // 12 % 2)
        at = dict(contact) | numbers(seed, "omega V_z")
        at["X"] = side * at["X"]
        if seed % 5 == 0:
            at["omega"] = at["omega"] / _CLOSE
        at["c_x"] = side * at["u_0"] + at["omega"] * at["Z"]
        at["c_z"] = at["v_0"] + at["V_z"] - at["omega"] * at["X"]
        yield at
    yield at | {"mu": mpmath.mpf(2) ** 970}  # as good as infinite
