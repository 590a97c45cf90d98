"""The figures' numbers and the command that draws them; never pixels."""

import re

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.colors import rgb_to_hsv, to_rgba
from matplotlib.figure import Figure

import figures
from figures.lib.printing import printed
from figures.theory import tip_shape
from impact import (
    Regime,
    classify,
    collide,
    critical_friction,
    energy_restitution,
    slide_friction,
    thin_rod,
)

from .quick_figures import data, tiny

HUES = {"red": (0, 33), "orange": (33, 50), "yellow": (50, 65), "green": (80, 175)}  # degrees
HUES["blue"] = (190, 260)
COLOURS = {*HUES, "black", "grey"}
TOO_FEW = {"fig04", "landing_census", "states"}  # tiny runs leave some of their numbers open


def drawn_colours(picture: Figure) -> set[str]:
    """Words of `COLOURS` for what is drawn in the panels; their frames and words do not count."""
    found = []
    for ax in picture.axes:
        for line in ax.lines:
            found += [line.get_color(), line.get_markerfacecolor()]
        for many in ax.collections:
            found += [*many.get_facecolor(), *many.get_edgecolor()]
        found += [patch.get_facecolor() for patch in ax.patches]
    rgba = np.array([to_rgba(colour) for colour in found])
    hue, strong, light = rgb_to_hsv(rgba[rgba[:, 3] > 0, :3]).T
    grey = strong < 0.05
    seen = {"black": grey & (light < 0.1), "grey": grey & (light > 0.2) & (light < 0.98)}
    for word, (low, high) in HUES.items():
        seen[word] = (360 * hue >= low) & (360 * hue < high) & (strong > 0.15)
    return {word for word, there in seen.items() if there.any()}


PAIRS = [(0.05, 0.0), (0.2, 0.3), (0.5, 0.65), (0.8, 0.9), (1.2, 1.0)]  # friction, restitution


@pytest.mark.parametrize(("friction", "restitution"), PAIRS)
def test_fig11_follows_its_values(friction, restitution):
    """The drift is within the panel; an arrow leads to where the contact sticks again."""
    module = figures.load("fig11")
    d = module.data(quick=True, friction=friction, restitution=restitution)
    picture = module.draw(d)
    (ax,) = picture.axes
    top, upper = ax.get_ylim()[1], np.degrees(d["critical_tilt"][1])
    assert top > d["c_x"].max() or (restitution == 1 and top > module.HIGHEST)
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert any("(26)" in text for text in words) == np.isfinite(upper)
    assert f"{restitution:g}$, $\\mu={friction:g}$" in ax.get_legend().get_title().get_text()
    assert len(ax.child_axes) == np.isfinite(upper)
    for inset in ax.child_axes:
        tilt_deg, c_x = inset.texts[0].xy
        assert inset.get_xlim()[0] < upper < tilt_deg < 90
        assert 0 < c_x < inset.get_ylim()[1]
        assert c_x == pytest.approx(np.interp(tilt_deg, np.degrees(d["tilt"]), d["c_x"]))
    plt.close(picture)


@pytest.mark.parametrize("restitution", [restitution for _, restitution in PAIRS])
def test_fig10_names_each_regime_where_it_is(restitution):
    module = figures.load("fig10")
    d = module.data(quick=True, restitution=restitution)
    picture = module.draw(d)
    end, tilts_deg = thin_rod(d["reversal_end"][0]), np.degrees(d["tilt"])
    for ax, ratio, regime in zip(picture.axes, d["approach_ratio"], d["regime"], strict=True):
        named = {}
        for text in ax.texts:
            tilt_deg, friction = getattr(text, "xy", None) or text.get_position()
            row, column = abs(d["friction"] - friction).argmin(), abs(tilts_deg - tilt_deg).argmin()
            named[regime[row, column]] = re.sub(r"\W", "_", text.get_text()).upper()
        assert named == {number: Regime(number).name for number in np.unique(regime)}
        assert rf"\epsilon={restitution:g}" in ax.get_title(loc="left")
        how = {"friction": 0.75, "restitution": restitution}
        stops = classify(1.0, -ratio, geometry=end, **how) != Regime.SLIDE
        assert any("3/4" in str(line.get_label()) for line in ax.lines) == stops
    plt.close(picture)


@pytest.mark.parametrize(("friction", "restitution"), PAIRS)
def test_tip_shape_cuts_no_drift(friction, restitution, monkeypatch):
    quick = data("tip_shape")
    monkeypatch.setattr(tip_shape, "_bounced", lambda *_: {})
    monkeypatch.setattr(tip_shape, "_one_impact", lambda *_: {})
    d = {**quick, **tip_shape.data(True, friction, restitution)}
    drifts = np.abs([*d["thin"], *d["round"], *d["flat"], *d["flat_by_length"]])
    picture = tip_shape.draw(d)
    for ax in picture.axes[:2]:
        top = ax.get_ylim()[1]
        assert top > drifts.max() or (restitution == 1 and top > tip_shape.HIGHEST)
        assert top < 2 * drifts.max()
        assert all(abs(text.get_position()[1]) < top for text in ax.texts)
    plt.close(picture)


@pytest.mark.parametrize("name", figures.FIGURES)
def test_every_figure(name):
    """Numbers without objects, axes with names; drawing and printing leave the numbers as they are.

    Numbers are not all nan; a .npz file need not pickle them; times are positive. Colours that the
    caption names are drawn.
    """
    d, module = data(name), figures.load(name)
    for key, value in d.items():
        kind = np.asarray(value).dtype.kind
        assert kind in "fiU", key
        assert kind == "U" or np.any(np.isfinite(value)) or name in TOO_FEW, key
        assert not key.endswith("seconds") or np.all(np.asarray(value) > 0), key
    before = {key: np.copy(value) for key, value in d.items()}
    with tiny():
        picture = module.draw(d)
        try:
            assert all(ax.get_xlabel() or ax.get_ylabel() for ax in picture.axes)
            picture.canvas.draw()
            named = {word for word in COLOURS if re.search(rf"\b{word}\b", module.__doc__)}
            assert named <= drawn_colours(picture)
        finally:
            plt.close(picture)
    text = printed(d)
    assert all(re.search(rf"\b{key}\b", text) for key in d if not key.endswith("_error"))
    for key, value in d.items():
        np.testing.assert_array_equal(value, before[key])


def test_fig10_colours_meet_its_lines():
    """Regimes on the map against the closed forms, everywhere but on a line itself."""
    d = data("fig10")
    rod, friction = thin_rod(d["tilt"]), d["friction"][:, None]
    holds = critical_friction(rod)
    for ratio, regime in zip(d["approach_ratio"], d["regime"], strict=True):
        slide = slide_friction(rod, approach_ratio=ratio, restitution=d["restitution"])
        expected = np.where(friction >= holds, Regime.SLIP_STICK, Regime.SLIP_REVERSAL)
        expected = np.where(friction < slide, Regime.SLIDE, expected)
        off_line = (np.abs(friction - slide) > 1e-9) & (np.abs(friction - holds) > 1e-9)
        np.testing.assert_array_equal(regime[off_line], expected[off_line])
        assert off_line.mean() > 0.9
        assert set(np.unique(regime)) == {1, 2, 3}


def test_fig10_lines():
    """The dashed line ends on the solid one; the last reversal is at 3/4, arctan 2."""
    d = data("fig10")
    np.testing.assert_allclose(d["reversal_end"], [np.arctan(2), 0.75], rtol=1e-15)
    for tilt, ratio in zip(d["critical_tilt"], d["approach_ratio"], strict=True):
        drawn = np.isfinite(tilt)
        assert 0 < drawn.sum() < drawn.size
        friction, rod = d["critical_friction"][drawn], thin_rod(tilt[drawn])
        np.testing.assert_allclose(critical_friction(rod), friction, atol=1e-14)
        slide = slide_friction(rod, approach_ratio=ratio, restitution=d["restitution"])
        assert np.all(friction >= slide)
        assert friction[-1] - slide[-1] < 0.02
    assert np.degrees(tilt[drawn][-1]) > 85  # the second root, in the last panel


def test_fig11_true_curve():
    """Ends and corners: (26) outside the two critical tilts, (29) between them."""
    d = data("fig11")
    np.testing.assert_allclose(np.degrees(d["critical_tilt"]), [22.6568, 84.0424], atol=1e-4)
    lower, upper = d["critical_tilt"]
    between = (d["tilt"] > lower) & (d["tilt"] < upper)
    branch = np.where(between, d["reversal_c_x"], d["stick_c_x"])
    np.testing.assert_allclose(d["c_x"], branch, rtol=1e-12, atol=1e-15)
    for edge in (lower, upper):  # both branches meet there
        here = d["tilt"] == edge
        np.testing.assert_allclose(d["reversal_c_x"][here], d["stick_c_x"][here], rtol=1e-12)
    np.testing.assert_allclose([d["c_z"][0], d["c_z"][-1]], [1.65 / 0.35, 1.65 / 6.35])
    np.testing.assert_allclose([d["c_x"][0], d["c_x"][-1]], 0, atol=1e-15)
    np.testing.assert_allclose(
        [d["reversal_c_x"][0], d["reversal_c_x"][-1]], [1.65 * 1.2 / 0.35, 1.65 * 0.3 / 6.35]
    )


def largest_gain(tilt, friction, restitution):
    """Largest energy change under Newton's law over all u_0, in units of v_0^2, by search."""
    given = np.broadcast_arrays(tilt, friction, restitution)
    tilt, friction, restitution = np.stack(given)[..., None]
    centre, half = np.zeros(tilt.shape), np.radians(80)  # of arctan(u_0/|v_0|)
    how = {"geometry": thin_rod(tilt), "friction": friction, "restitution": restitution}
    for points in (161, 41, 41):
        angle = centre + half * np.linspace(-1, 1, points)
        gain = collide(np.tan(angle), -1.0, **how).energy_change
        centre = np.take_along_axis(angle, gain.argmax(-1)[..., None], -1)
        half *= 2 / (points - 1)
    return gain.max(-1)


@pytest.mark.parametrize("offset", [-1e-4, 1e-4])
def test_search_finds_the_energy_threshold(offset):
    """Energy is gained just above the closed form's restitution, and not just below it."""
    tilt, friction = np.random.default_rng(1).uniform((0.1, 0.1), (1.5, 1), (300, 2)).T
    restitution = energy_restitution(thin_rod(tilt), friction) + offset
    inside = restitution <= 1
    gain = largest_gain(tilt[inside], friction[inside], restitution[inside])
    assert np.all(gain * offset > 0)
    assert inside.sum() > 200


def test_laws_differ_only_where_the_slip_stops():
    d = data("restitution_laws")
    assert d["threshold"].min() >= d["floor_threshold"] == pytest.approx(0.8)
    np.testing.assert_allclose(d["floor"], [np.pi / 4, 0.6])
    slides = d["friction"][:, None] < d["slide_friction"] - 1e-9
    assert np.all(d["difference"][slides] < 1e-12)
    assert 0.3 < d["difference"].max() < 0.4
    row = np.abs(d["friction"] - d["line_friction"]).argmin()
    newton_to_poisson = np.hypot(d["c_x"][0] - d["c_x"][1], d["c_z"][0] - d["c_z"][1])
    assert newton_to_poisson.max() == pytest.approx(d["difference"][row].max(), rel=0.05)


def test_the_stationary_landing_where_its_dots_stand():
    """1/2 is where a rod falls as fast as the plate moves; the best tilt is the cheapest."""
    d = data("stationary")
    for half, fast, slow in zip(d["half"], d["consistent"], d["slower"], strict=True):
        whole = np.where(np.isnan(slow), fast, slow)
        assert np.interp(half, d["tilt"], whole) == pytest.approx(0.5, abs=1e-4)
        assert np.nanmax(fast) < 0.5 < np.nanmin(slow)
    cheapest = np.nanmin(d["cost"][[0, -1]], axis=1)  # slip reversal, slip-stick
    np.testing.assert_allclose(cheapest, d["best_cost"][[0, -1]], rtol=1e-3)
    assert d["painleve"][0].min() == pytest.approx(4 / 3, rel=1e-3)


def test_flat_end_turns_at_arctan_d_over_l():
    d = data("tip_shape")
    tilt, flat = d["tilt"], d["flat"]
    assert np.degrees(d["flat_threshold"]) == pytest.approx(7.125, abs=1e-3)
    positive = ~np.signbit(tilt)
    np.testing.assert_array_equal(flat[positive] > 0, tilt[positive] > d["flat_threshold"])
    before, after = flat[tilt == 0]
    assert before == -after > 2
    assert np.sum(np.sign(d["round"]) != np.sign(tilt)) == 0
    np.testing.assert_array_equal(
        d["flat_bounced"] > 3 * d["flat_bounced_error"], d["bounced_tilt"] > d["flat_threshold"]
    )
    landed = np.sign(d["soft_tilt"]) * d["soft"]  # upright on both corners: nothing
    np.testing.assert_array_equal(landed > 0, np.abs(d["soft_tilt"]) > d["flat_threshold"])
    assert d["soft"][d["soft_tilt"] == 0] == pytest.approx(0, abs=1e-12)


def test_drift_over_length():
    """Nothing for a sphere, a thin rod's for a long rod, saturated at three diameters."""
    d = data("tip_shape")
    thin = d["thin_by_length"][0]
    assert d["round_by_length"][0] == 0
    np.testing.assert_allclose([d["round_by_length"][-1], d["flat_by_length"][-1]], thin, rtol=0.03)
    assert np.all(np.abs(d["round_by_length"][d["lengths"] > 3] / thin - 1) < 0.06)
    np.testing.assert_array_equal(d["flat_by_length"] > 0, d["lengths"] > d["flat_length"])
