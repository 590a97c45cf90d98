"""Random impacts and their comparison with the independent integration."""

from typing import NamedTuple

import numpy as np

import impact

from .reference import Reference, error_in_ulp, reference_collide


class Impacts(NamedTuple):
    """Arguments of many impacts, one array each."""

    c_x: np.ndarray
    c_z: np.ndarray
    omega: np.ndarray
    X: np.ndarray
    Z: np.ndarray
    k: np.ndarray
    friction: np.ndarray
    restitution: np.ndarray
    plate_velocity: np.ndarray

    def arguments(self, dtype=np.float64) -> dict:
        """As `impact` takes them."""
        given = {name: column.astype(dtype) for name, column in self._asdict().items()}
        return given | {"geometry": impact.ContactGeometry(*map(given.pop, ("X", "Z", "k")))}

    def collide(self, law="newton", dtype=np.float64):
        """What `impact` says about them."""
        return impact.collide(**self.arguments(dtype), law=law)

    def row(self, index: int) -> dict[str, float]:
        """Arguments of one of them, as the integration takes them."""
        return {name: float(column[index]) for name, column in self._asdict().items()}

    def reference(self, index: int, law="newton") -> Reference:
        """What the integration says about one of them."""
        return reference_collide(**self.row(index), law=law)


def geometries(rng: np.random.Generator, n: int) -> tuple[np.ndarray, ...]:
    """X, Z, k of thin, round and flat-ended rods of all tilts, from spheres to l = 30 d."""
    tilt = rng.uniform(-np.pi / 2, np.pi / 2, n)
    length = 1 + 10 ** rng.uniform(-2, 1.5, n)
    shapes = (
        impact.thin_rod(tilt, length),
        impact.spherocylinder(tilt, length),
        impact.flat_ended_rod(tilt, length),
    )
    shape = rng.integers(0, len(shapes), n)
    return tuple(np.choose(shape, parts) for parts in zip(*shapes, strict=True))


def everyday(n: int, seed: int) -> Impacts:
    """Velocities of order one, all signs; friction 0 to 10."""
    rng = np.random.default_rng(seed)
    X, Z, k = geometries(rng, n)
    c_x, c_z, spin, plate = rng.uniform(-2, 2, (4, n))
    return Impacts(c_x, c_z, spin / k, X, Z, k, rng.uniform(0, 10, n), rng.uniform(0, 1, n), plate)


def wide(n: int, seed: int) -> Impacts:
    """Velocities and friction log-uniform over six decades, all signs."""
    rng = np.random.default_rng(seed)
    X, Z, k = geometries(rng, n)
    sizes = 10 ** rng.uniform(-3, 3, (5, n))
    c_x, c_z, spin, plate = sizes[:4] * rng.choice([-1, 1], (4, n))
    return Impacts(c_x, c_z, spin / k, X, Z, k, sizes[4], rng.uniform(0, 1, n), plate)


def compare(impacts: Impacts, law="newton") -> tuple[np.ndarray, list[int]]:
    """Largest error of each impact in ulp, and the indices of wrong regimes.

    A regime within 1e-13 of a boundary is not counted as wrong; values are, everywhere.
    """
    got = impacts.collide(law)
    errors, wrong = np.zeros(len(impacts.c_x)), []
    for index in range(len(errors)):
        reference = impacts.reference(index, law)
        row = impacts.row(index)
        del row["friction"], row["restitution"]
        values = {name: getattr(got, name)[index] for name in got._fields if name != "regime"}
        errors[index] = error_in_ulp(values, reference, **row)["maximum"]
        if got.regime[index] != reference.regime and min(reference.margins) > 1e-13:
            wrong.append(index)
    return errors, wrong
