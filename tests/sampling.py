"""Random impacts and their comparison with the independent integration."""

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_array_equal

import impact
from impact import compiled

from .reference import error_in_ulp, reference_collide

LAWS = "newton", "poisson", "stronge"
EPS = np.finfo(float).eps
each_law = pytest.mark.parametrize("law", LAWS)


class Impacts(compiled.Impacts):
    """Arguments of many impacts, one array each, as compiled kernels take them."""

    def collide(self, law="newton", collide=impact.collide):
        """What `impact`, or another implementation, says about them."""
        return super().collide(collide, law)

    def row(self, index):
        """Arguments of one of them, as the integration takes them."""
        return {name: float(column[index]) for name, column in self._asdict().items()}

    def reference(self, index, law="newton"):
        """What the integration says about one of them."""
        return reference_collide(**self.row(index), law=law)


def ulps(got, want):
    """Distance in units in the last place of the exact value."""
    return abs(want - got) / np.spacing(abs(float(want)))


def power(x, y):
    """Power of x as which y goes."""
    return np.polyfit(np.log(x), np.log(y), 1)[0]


def geometries(rng, n):
    """X, Z, k of thin, round and flat-ended rods of all tilts, from spheres to l = 30 d."""
    tilt = rng.uniform(-np.pi / 2, np.pi / 2, n)
    length = 1 + 10 ** rng.uniform(-2, 1.5, n)
    shapes = impact.thin_rod, impact.spherocylinder, impact.flat_ended_rod
    rods = np.array([shape(tilt, length) for shape in shapes])
    return rods[rng.integers(0, len(shapes), n), :, np.arange(n)].T


def everyday(n, seed):
    """Velocities of order one, all signs; friction 0 to 10."""
    rng = default_rng(seed)
    X, Z, k = geometries(rng, n)
    c_x, c_z, spin, plate = rng.uniform(-2, 2, (4, n))
    return Impacts(c_x, c_z, spin / k, plate, X, Z, k, rng.uniform(0, 10, n), rng.uniform(0, 1, n))


def wide(n, seed):
    """Velocities and friction log-uniform over six decades, all signs."""
    rng = default_rng(seed)
    X, Z, k = geometries(rng, n)
    *speeds, friction = 10 ** rng.uniform(-3, 3, (5, n))
    c_x, c_z, spin, plate = speeds * rng.choice([-1, 1], (4, n))
    return Impacts(c_x, c_z, spin / k, plate, X, Z, k, friction, rng.uniform(0, 1, n))


def simple(n, seed):
    """Halves and whole numbers: many impacts lie on an edge of a regime, many without slip."""
    numbers = default_rng(seed).integers(-4, 5, (9, n)) / 2
    c_x, c_z, omega, X, Z, k, friction, restitution, plate = numbers
    bounded = np.abs(k) + 0.5, np.abs(friction), np.abs(restitution) / 2
    return Impacts(c_x, c_z, omega, plate, X, Z, *bounded)


def every(**values):
    """All combinations of values; what is not named is that of a thin rod at 30 degrees."""
    given = {
        "c_x": 1.0,
        "c_z": -1.0,
        "omega": 0.0,
        "plate_velocity": 0.0,
        "friction": 0.3,
        "restitution": 0.5,
        "tilt": np.radians(30),
        "length": 1.0,
        **values,
    }
    grids = np.meshgrid(*given.values())
    columns = dict(zip(given, map(np.ravel, grids), strict=True))
    rod = impact.thin_rod(columns.pop("tilt"), columns.pop("length"))
    return Impacts(**(rod._asdict() | columns))


def compare(impacts, law="newton", collide=impact.collide, digits=53):
    """Largest error of each impact in ulp, and the indices of wrong regimes.

    A regime within 1e-13 of a boundary is not counted as wrong; values are, everywhere.
    """
    got = impacts.collide(law, collide)
    errors, wrong = np.zeros(len(impacts.c_x)), []
    for index in range(len(errors)):
        reference = impacts.reference(index, law)
        one = got._make(part[index] for part in got)
        errors[index] = error_in_ulp(one, reference, **impacts.row(index), digits=digits)
        if one.regime != reference.regime and min(reference.margins) > 1e-13:
            wrong.append(index)
    return errors, wrong


def assert_mirror_symmetric(impacts, law="newton", collide=impact.collide):
    """Check that mirror images have mirrored outcomes, bit for bit."""
    image = impacts._replace(c_x=-impacts.c_x, omega=-impacts.omega, X=-impacts.X)
    hit, mirrored = (i.collide(law, collide) for i in (impacts, image))
    odd = {"c_x", "omega", "P_x", "slip_velocity"}
    for name, here, there in zip(hit._fields, hit, mirrored, strict=True):
        assert_array_equal(here, -there if name in odd else there)
