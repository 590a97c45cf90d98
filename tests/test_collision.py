"""The impact map against the independent integration, and the laws that it must obey."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import impact
from impact import Regime

from . import sampling

LAWS = ("newton", "poisson", "stronge")


@pytest.mark.parametrize("law", LAWS)
def test_impulse_is_compressive_and_in_the_friction_cone(law):
    """In every regime, and in the Painleve region."""
    impacts = sampling.wide(200_000, seed=13)
    hit = impacts.collide(law)
    slip = np.sign(impacts.c_x - impacts.omega * impacts.Z)
    painleve = impacts.k**2 + impacts.X**2 + slip * impacts.friction * impacts.X * impacts.Z <= 0
    assert min(*np.bincount(hit.regime), painleve.sum()) > 5000
    happens = hit.regime > Regime.NO_IMPACT
    assert (hit.P_z[happens] > 0).all()
    slack = 16 * np.finfo(float).eps * (np.abs(hit.P_x) + np.abs(impacts.c_x) + np.abs(impacts.c_z))
    assert (np.abs(hit.P_x) <= impacts.friction * hit.P_z + slack + 1e-12 * hit.P_z).all()


@pytest.mark.parametrize("law", ["poisson", "stronge"])
def test_these_laws_never_create_energy(law):
    impacts = sampling.wide(200_000, seed=14)
    hit = impacts.collide(law)
    scale = sum(np.square(v) for v in (hit.P_x, hit.P_z, impacts.c_x, impacts.c_z))
    scale += np.square(impacts.plate_velocity) + np.square(impacts.omega * impacts.k)
    assert (hit.energy_change <= 64 * np.finfo(float).eps * scale).all()


def test_thin_rod_creates_energy_only_above_four_fifths():
    rod = impact.thin_rod(np.linspace(0, np.pi / 2, 2001)[:, None])
    threshold = impact.energy_restitution(rod, np.linspace(0, 2, 401))
    assert threshold.min() == pytest.approx(0.8, abs=1e-12)
    assert (threshold <= 1).all()
    sticks = np.linspace(0, 2, 401) >= impact.critical_friction(rod)
    closed = 4 / np.sqrt(16 + 9 * np.sin(2 * np.linspace(0, np.pi / 2, 2001)) ** 2)
    expected = np.broadcast_to(closed[:, None], threshold.shape)[sticks]
    np.testing.assert_allclose(threshold[sticks], expected, rtol=1e-14)


def numbers(low, high):
    """Floats far from underflow, where halving and doubling are exact."""
    return st.floats(low, high).filter(lambda number: number == 0 or abs(number) > 1e-60)


finite = numbers(-1e6, 1e6)
impacts = st.fixed_dictionaries(
    {
        "c_x": finite,
        "c_z": finite,
        "omega": finite,
        "X": numbers(-2, 2),
        "Z": numbers(-2, 2),
        "k": st.floats(0.5, 2),
        "friction": numbers(0, 1e3),
        "restitution": numbers(0, 1),
        "plate_velocity": finite,
        "law": st.sampled_from(LAWS),
    }
)


def _hit(row, **changed):
    row = {**row, **changed}
    return impact.collide(geometry=impact.ContactGeometry(*map(row.pop, ("X", "Z", "k"))), **row)


@given(impacts)
@settings(max_examples=300)
def test_mirror_symmetry_bit_for_bit(row):
    hit = _hit(row)
    mirrored = _hit(row, X=-row["X"], c_x=-row["c_x"], omega=-row["omega"])
    odd = ("c_x", "omega", "P_x", "slip_velocity")
    for name in hit._fields:
        value = getattr(mirrored, name)
        assert getattr(hit, name) == (-value if name in odd else value)


@given(impacts, st.integers(-40, 40), st.integers(-40, 40))
@settings(max_examples=200)
def test_units_of_length_and_time_do_not_matter(row, length, speed):
    """Powers of two change nothing but exponents."""
    a, b = 2.0**length, 2.0**speed
    hit = _hit(row)
    scales = {"X": a, "Z": a, "k": a, "c_x": b, "c_z": b, "omega": b / a, "plate_velocity": b}
    other = _hit(row, **{name: scale * row[name] for name, scale in scales.items()})
    assert other.regime == hit.regime
    for name, scale in {"c_x": b, "c_z": b, "omega": b / a, "energy_change": b * b}.items():
        assert getattr(other, name) == scale * getattr(hit, name)


@given(impacts)
@settings(max_examples=300)
def test_energy_change_is_the_change_of_kinetic_energy(row):
    hit = _hit(row)
    k2, plate = row["k"] ** 2, row["plate_velocity"]
    before = row["c_x"] ** 2 + (row["c_z"] - plate) ** 2 + k2 * row["omega"] ** 2
    after = hit.c_x**2 + (hit.c_z - plate) ** 2 + k2 * hit.omega**2
    size = before + after + row["c_z"] ** 2 + plate**2
    assert abs((after - before) / 2 - hit.energy_change) <= 1e-13 * size


@given(impacts, st.floats(-1e-9, 1e-9))
@settings(max_examples=300)
def test_map_is_continuous_in_friction(row, step):
    """Across all regime boundaries; a bounded slope times the step."""
    friction = row["friction"] * (1 + step)
    here, there = _hit(row), _hit(row, friction=friction)
    size = max(1e-300, *(abs(row[n]) for n in ("c_x", "c_z", "omega", "plate_velocity")))
    size = max(size, 2 * abs(row["omega"]), abs(here.P_z), abs(here.P_x))
    assert abs(here.c_x - there.c_x) <= 1e-4 * size
    assert abs(here.c_z - there.c_z) <= 1e-4 * size


def test_the_laws_agree_about_the_regime_and_about_a_slide():
    i = sampling.wide(20_000, seed=17)
    regime = impact.classify(**i.arguments())
    slide, P_z = regime == Regime.SLIDE, i.collide().P_z
    assert regime.dtype == np.int8
    for hit in map(i.collide, LAWS):
        np.testing.assert_array_equal(hit.regime, regime)
        np.testing.assert_array_equal(hit.P_z[slide], P_z[slide])
