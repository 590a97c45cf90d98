"""The impact map over random impacts: the laws that it must obey."""

import mpmath
import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_array_equal

from impact import Regime

from . import sampling
from .reference import reference_collide
from .sampling import EPS, each_law


@pytest.fixture(params=[sampling.wide, sampling.simple])
def impacts(request):
    """Impacts over six decades, or on the edges of regimes."""
    return request.param(250_000, seed=13)


@each_law
def test_impulse_and_energy(impacts, law):
    """The impulse is a push and makes no energy, but by Newton's law.

    In every regime and in the Painleve region; the energy is that of the velocities.
    """
    hit = impacts.collide(law)
    slip = np.sign(impacts.c_x - impacts.omega * impacts.Z)
    painleve = impacts.k**2 + impacts.X**2 + slip * impacts.friction * impacts.X * impacts.Z <= 0
    assert min(*np.bincount(hit.regime), painleve.sum()) > 5000
    assert (hit.P_z[hit.regime > Regime.NO_IMPACT] > 0).all()
    speeds = impacts.c_x, impacts.c_z, impacts.plate_velocity, impacts.omega * impacts.k
    rounding = 8 * EPS * np.square([*speeds, hit.P_x, hit.P_z]).sum(0)
    assert law == "newton" or (hit.energy_change <= rounding).all()
    before, after = (
        x.c_x**2 + (x.c_z - impacts.plate_velocity) ** 2 + (impacts.k * x.omega) ** 2
        for x in (impacts, hit)
    )
    assert (np.abs((after - before) / 2 - hit.energy_change) <= rounding).all()


@each_law
def test_units_of_length_and_time_do_not_matter(impacts, law):
    """Units that are powers of two change exponents alone, out to 1e-135 and 1e135."""
    length, speed = default_rng(15).integers(-450, 451, (2, impacts.c_x.size))
    powers = {
        **dict.fromkeys(("X", "Z", "k"), length),
        **dict.fromkeys(("c_x", "c_z", "plate_velocity"), speed),
        "omega": speed - length,
        "energy_change": 2 * speed,
    }
    scaled, hit = (
        {name: np.ldexp(getattr(x, name), by) for name, by in powers.items() if hasattr(x, name)}
        for x in (impacts, impacts.collide(law))
    )
    other = impacts._replace(**scaled).collide(law)
    for name, wanted in hit.items():
        assert_array_equal(getattr(other, name), wanted)


@each_law
def test_small_impulses_have_digits_of_their_own(law):
    """On levers up to 1000 k, P_z loses no more than the last digits of c_x and c_z change it."""
    X, Z = 10 ** default_rng(16).uniform(1, 3, (2, 300))
    none = np.zeros(300)
    impacts = sampling.everyday(300, seed=16)._replace(
        X=X, Z=Z, k=np.ones(300), omega=none, plate_velocity=none
    )
    with mpmath.workdps(60):
        more = 1 + mpmath.mpf(10) ** -20
        for index, got in enumerate(impacts.collide(law).P_z):
            row, want = impacts.row(index), impacts.reference(index, law).P_z
            size = want
            for speed in ("c_x", "c_z"):
                near = reference_collide(**row | {speed: more * row[speed]}, law=law)
                size += abs(near.P_z - want) / (more - 1)
            assert abs(got - want) <= 4 * EPS * size
