"""Figures of the theory: alpha, the stationary landing, shapes of tips; gains of energy."""

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal

from figures.theory import stationary
from impact import collide, energy_restitution, thin_rod

from .quick_figures import check_figure, data, each_of


@each_of("theory")
def test_every_figure(name):
    check_figure(name)


@pytest.mark.parametrize("offset", [-1e-4, 1e-4])
def test_search_finds_the_energy_threshold(offset):
    """Energy is gained just above the closed form's restitution, and not just below it.

    Under Newton's law, over all ratios of the slip to the approach.
    """
    tilt, friction = default_rng(1).uniform((0.1, 0.1), (1.5, 1), (300, 2)).T
    restitution = energy_restitution(thin_rod(tilt), friction) + offset
    inside = restitution <= 1
    hit = collide(
        np.tan(np.radians(np.linspace(-80, 80, 5001)))[:, None],
        -1.0,
        geometry=thin_rod(tilt[inside]),
        friction=friction[inside],
        restitution=restitution[inside],
    )
    assert np.all(hit.energy_change.max(axis=0) * offset > 0)
    assert inside.sum() > 200


def test_the_stationary_landing_where_its_dots_stand():
    """1/2 is where a rod falls as fast as the plate moves; the best tilt is the cheapest."""
    d = data("stationary")
    for half, fast, slow in zip(d["half"], d["consistent"], d["slower"], strict=True):
        whole = np.where(np.isnan(slow), fast, slow)
        assert np.interp(half, d["tilt"], whole) == pytest.approx(0.5, abs=1e-4)
        assert np.nanmax(fast) < 0.5 < np.nanmin(slow)
    cheapest = np.nanmin(d["cost"][[0, -1]], axis=1)  # slip reversal, slip-stick
    assert_allclose(cheapest, d["best_cost"][[0, -1]], rtol=1e-3)
    assert d["painleve"][0].min() == pytest.approx(4 / 3, rel=1e-3)


def test_no_tilt_of_one_half_is_drawn_where_there_is_none():
    assert stationary.draw(stationary.data(quick=True, restitution=0.0)).axes


def test_flat_end_turns_at_arctan_d_over_l():
    """By the closed form, landing by landing, and in the soft impact."""
    d = data("tip_shape")
    tilt, flat = d["tilt"], d["flat"]
    assert np.degrees(d["flat_threshold"]) == pytest.approx(7.125, abs=1e-3)
    positive = ~np.signbit(tilt)
    assert_array_equal(flat[positive] > 0, tilt[positive] > d["flat_threshold"])
    before, after = flat[tilt == 0]
    assert before == -after > 2
    assert_array_equal(np.sign(d["round"]), np.sign(tilt))
    bounced = d["flat_bounced"] > 3 * d["flat_bounced_error"]
    assert_array_equal(bounced, d["bounced_tilt"] > d["flat_threshold"])
    landed = np.sign(d["soft_tilt"]) * d["soft"]  # upright on both corners: nothing
    assert_array_equal(landed > 0, np.abs(d["soft_tilt"]) > d["flat_threshold"])
    # Both corners see each other a step late: an error of second order in the step.
    assert d["soft"][d["soft_tilt"] == 0] == pytest.approx(0, abs=3e-6)
