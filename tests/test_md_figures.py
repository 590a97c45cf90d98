"""Figures of the soft impact: what they show, against the theory and against plain integrations."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import md
from figures.checks import appendix_a, rigid_limit
from figures.cost import accuracy_cost_impact as cost
from figures.lib import soft_impacts as soft
from figures.lib import timing
from figures.paper import fig12
from impact import ContactGeometry, collide

from .quick_figures import data


def theory(tilt, restitution, law="newton"):
    """The scene of Fig. 12 without the figures' own helper: l = 9.5, thin, mu = 0.4."""
    arms = ContactGeometry(4.25 * np.sin(tilt), 4.25 * np.cos(tilt) + 0.5, 9.5 / np.sqrt(12))
    return collide(0.5, -1.0, geometry=arms, friction=0.4, restitution=restitution, law=law)


# Fig. 12


def test_fig12_regimes_are_those_of_the_theory():
    d = data("fig12")
    tilt, regime = d["tilt"], d["regime"][0]
    np.testing.assert_array_equal(regime, theory(tilt, d["restitution"][0]).regime)
    assert set(regime) == {1, 2, 3}
    assert np.all(np.diff(tilt) > 0)
    changes = [(int(a), int(b)) for a, b in pairwise(regime) if a != b]
    assert changes == [(2, 3), (3, 1)]  # stick, reversal, slide
    np.testing.assert_array_equal(d["regimes_right"][:2], 17)
    assert d["regimes_right"][2] < 12  # as printed


def test_fig12_symbols_lie_on_the_theory_at_measured_restitution():
    d = data("fig12")
    rigid = theory(d["tilt"], d["restitution"][0])
    off = np.hypot(d["c_x"][0] - rigid.c_x, d["c_z"][0] - rigid.c_z)
    assert off.max() < 1.2e-3
    np.testing.assert_allclose(d["measured_c_x"][0], rigid.c_x, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(d["measured_c_z"][0], rigid.c_z, rtol=1e-12, atol=1e-14)
    line = theory(d["line_tilt"], 0.65)
    np.testing.assert_allclose(d["line_c_x"], line.c_x, rtol=1e-12, atol=1e-14)
    np.testing.assert_array_equal(d["line_regime"], line.regime)
    for law, e in zip(("newton", "poisson", "stronge"), d["line_restitution"], strict=True):
        np.testing.assert_allclose(e, theory(d["line_tilt"], 0.65, law).normal_velocity, rtol=1e-12)
    assert 0.03 < d["rms_constant"][0] < 0.07  # the constant 0.65 is right to 5 % of |c_z|
    assert d["rms_measured"][0] < 6e-4 < 1e-2 < d["rms_measured"][1] < 0.1 < d["rms_measured"][2]
    assert d["step_error"].max() < 1e-4


def test_one_constant_is_best_in_the_energetic_law():
    """Head on 0.65 and never more: the loss by the dashpot is shared out by compression's work."""
    d = data("fig12")
    nearest = np.sqrt(np.mean(d["off"] ** 2, axis=1)).argmin()
    assert nearest == fig12.RESTITUTION_LAWS.index("stronge")
    assert d["restitution"][0, 0] == pytest.approx(0.65, abs=1e-3)
    assert 0.53 < d["restitution"][0].min() < 0.56


# Appendix A


def head_on(normal_force):
    """Restitution of m d'' = -F(d, d'), m = 1, by a general-purpose solver."""

    def ends(t, y):
        return min(normal_force(*y), y[0]) if t > 1e-6 else 1.0

    ends.terminal = True
    how = {"rtol": 1e-10, "atol": 1e-13, "events": ends, "max_step": 1e-5}
    done = solve_ivp(lambda t, y: (y[1], -normal_force(*y)), (0, 0.1), (0.0, 1.0), **how)
    return -done.y[1, -1]


def test_restitution_of_readings_head_on():
    """Of the printed law and of the one without the overlap's factor, for the rod and M/2.

    The figure's impacts have friction, which turns the rod a little even at tilt 0.
    """
    d = data("appendix_a")
    one = list(d["speed"]).index(1.0)
    printed = head_on(lambda x, v: 5e6 * abs(x) ** 1.5 + 200 * x * v)
    plain = head_on(lambda x, v: 5e6 * abs(x) ** 1.5 + 200 * v)
    assert d["restitution"][0, 0, 0, one, 0] == pytest.approx(printed, abs=3e-4)
    for where in (1, 2):
        assert d["restitution"][where, 0, 0, one, 0] == pytest.approx(plain, abs=3e-4)
    assert printed > 0.999
    assert 0.5 < plain < 0.55


def test_no_reading_does_what_the_paper_says():
    d = data("appendix_a")
    shape = len(appendix_a.WHERE), len(appendix_a.MASSES), len(appendix_a.INERTIAS)
    assert d["restitution"].shape == (*shape, d["speed"].size, 18)
    assert d["compared"].shape == (*shape, 4)
    one = list(d["speed"]).index(1.0)
    e = d["restitution"][..., one, :]
    assert not np.any(np.all((e > 0.65 - 0.02) & (e < 0.7 + 0.02), axis=-1))
    assert np.all(d["compared"][0, ..., 2] > 0.1)  # as printed
    assert np.all(d["compared"][2, ..., 2] < 0.03)  # the units' reading: near the rigid theory
    nearest = np.unravel_index(d["compared"][:, :, 0, 0].argmin(), shape[:2])
    assert nearest == (2, list(appendix_a.MASSES).index("sphere, m"))


def test_why_the_printed_law_fails():
    """Its spring is soft and undamped: stiffness and damping each bring it nearer, throughout."""
    d = data("appendix_a")
    assert d["printed_ratio"] == pytest.approx(4.5, abs=0.1)
    assert np.all(np.diff(d["why"], axis=1) < 0)
    assert np.all(np.diff(d["why"], axis=0) < 0)
    stiff = d["why"][0, -3:]
    np.testing.assert_allclose(stiff[1:] / stiff[:-1], 10**-0.5, rtol=0.25)


# Rigid limit


def test_coulomb_goes_to_the_rigid_theory_as_predicted():
    d = data("rigid_limit")
    slope, error = d["slope"]
    assert abs(slope + 0.4) < max(3 * error, 1e-3)
    np.testing.assert_array_equal(d["right"][0], 17)
    np.testing.assert_allclose(d["located"], d["error"][0, ::3], rtol=2e-3)
    assert d["error"][0, -1] < 1e-6
    assert np.all(d["half_step"] < 2e-2)


def test_springs_stop_at_floors_that_fall_as_the_root_of_their_stiffness():
    d = data("rigid_limit")
    names = list(rigid_limit.BY_STIFFNESS)
    springs = d["error"][["constant" in name for name in names]]
    assert np.all(np.diff(springs[:, -1]) < 0)
    np.testing.assert_allclose(springs[:, -2], springs[:, -1], rtol=0.02)
    for slope, error in d["slope_by_ratio"][1:]:
        assert abs(slope + 0.5) < max(3 * error, 2e-3)
    printed = d["error"][names.index("appendix_a")]
    assert printed.min() > 0.1  # stiffness alone does not help
    assert printed[-1] > printed[0]
    undamped, damped = d["error_by_ratio"][2], d["error_by_ratio"][1]
    assert np.all(undamped > 2.5 * damped)


# Accuracy and cost


@pytest.mark.parametrize("integrator", cost.METHODS)
def test_timed_impact_is_the_impact(integrator):
    """The bits of `md.impact`, once or many times over."""
    tilt, law, dt = 0.7, md.coulomb(), 7e-5
    hit = soft.one_impact(tilt, law, integrator=integrator, dt=dt)
    call = cost.impact_call(tilt, integrator, dt)
    for times in (1, 3):
        velocity, steps = call(times)
        assert velocity == (hit.c_x, hit.c_z, hit.omega)
        assert steps == hit.steps


def test_price_is_of_one_call_of_many(monkeypatch):
    """Seconds of a sample over its repetitions; a clock that counts repetitions gives one."""
    clock, asked = [0.0], []

    def call(times):
        clock[0] += 1e-5 * times
        asked.append(times)

    def timed(task, number):
        begin = clock[0]
        task()
        return clock[0] - begin

    monkeypatch.setattr(timing, "timeit", timed)
    np.testing.assert_allclose(timing.medians([call], 3), 1e-5, rtol=1e-9)
    assert asked == [1, 1, 100, 100, 100]


def test_orders_come_back():
    parts = 10.0 * 2.0 ** np.arange(8)
    assert cost.order(parts, 3 * parts**-1.25) == pytest.approx(1.25)
    assert np.isnan(cost.order(parts, np.full(8, np.nan)))


def test_integration_errors_fall_with_the_step():
    d = data("accuracy_cost_impact")
    assert d["offsets"].size >= 24
    worst, middle = d["fixed_error"]
    assert worst.shape == (3, d["parts"].size) == d["fixed_seconds"].shape
    assert np.isnan(worst).sum() <= 1  # Gear's coarsest step is refused
    assert np.isfinite(worst[:2]).all()
    falls = np.diff(np.log10(worst))
    assert np.all(falls[np.isfinite(falls)] < -0.5)
    assert np.all((middle <= worst) | np.isnan(worst))
    for found, (low, high) in zip(d["order"], ((1.0, 1.2), (1.15, 1.3), (0.95, 1.2)), strict=True):
        assert low < found < high
    np.testing.assert_allclose(d["fixed_steps"][:, -1] / d["fixed_steps"][:, -2], 4, rtol=1e-2)
    assert worst[1, list(d["parts"]).index(160)] < 1e-3


def test_errors_are_over_all_tilts_and_offsets():
    """One step of one method, impact by impact, against a reference of its own."""
    d = data("accuracy_cost_impact")
    scene = {"friction": 0.4, "rod": md.Rod(9.5, "thin"), "law": md.coulomb()}
    dt, errors = 2.943275 * (1.25 / 5e6) ** 0.4 / 40, []
    for tilt in np.radians([10, 25, 40, 65, 83, 87]):
        true = md.impact(tilt, 0.5, -1.0, integrator="dop853", tolerance=1e-13, **scene)
        for offset in d["offsets"]:
            hit = md.impact(tilt, 0.5, -1.0, integrator="verlet", dt=dt, offset=offset, **scene)
            errors.append(np.hypot(hit.c_x - true.c_x, hit.c_z - true.c_z))
    worst, middle = d["fixed_error"][:, 1, 1]
    assert worst == pytest.approx(max(errors), rel=1e-6)
    assert middle == pytest.approx(np.median(errors), rel=1e-6)


def test_located_switches_reach_what_no_step_does():
    d = data("accuracy_cost_impact")
    worst, middle = d["adaptive_error"]
    assert np.all(middle <= worst)
    assert worst[-1] < 1e-12
    assert np.all(np.diff(worst) < 0)
    assert d["evaluations"][-1] <= 3000
    assert d["floor"] < 1e-12
    assert np.nanmin(d["fixed_error"][0]) > 1e3 * worst[-1]


def test_gear_is_leapfrog_at_the_papers_step():
    found = cost.gear_from_leapfrog()
    assert found.shape == (2, 2)
    assert 1e-8 < found[1].max() < 1e-5  # Appendix A
    assert found.max() < 3e-3
