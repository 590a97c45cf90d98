"""The paper's figures: theory, soft impacts, rows and annuli in tiny runs, made-up numbers."""

import re
from itertools import groupby

import numpy as np
import pytest
from numpy.random import default_rng
from numpy.testing import assert_allclose, assert_array_equal

import figures
import md
from derivations import function
from figures.lib import arrangement, runs
from figures.paper import fig02, fig04, fig06, fig08, fig10, fig11, fig12, fig13
from impact import (
    Regime,
    classify,
    collide,
    critical_friction,
    drift,
    landing_density,
    slide_friction,
    thin_rod,
)
from md.scene import from_tables, put

from .quick_figures import MOST_PERIODS, OWN_VALUES, check_figure, data, each_of, thick, tiny


@each_of("paper")
def test_every_figure(name):
    check_figure(name)


OF_RUNS = "fig02 fig04 fig05 fig06 fig07 fig08 fig13 phase_friction row_size states closure"


@pytest.mark.parametrize("name", OF_RUNS.split())
def test_a_place_whose_runs_are_lost_is_left_out_of_the_picture(name):
    d = dict(data(name))
    for key in [key for key in d if f"{key}_error" in d]:
        for part in (key, f"{key}_error"):
            d[part] = np.array(d[part], float)
            d[part][0] = np.nan
    with tiny():
        figures.load(name).draw(d).canvas.draw()


# Figs. 10 and 11: the theory


def test_fig10_colours_meet_its_lines():
    """Everywhere but on a line; the dashed one ends on the solid one, the last reversal at 3/4."""
    d = data("fig10")
    rod, friction = thin_rod(d["tilt"]), d["friction"][:, None]
    holds = critical_friction(rod)
    assert_allclose(d["reversal_end"], [np.arctan(2), 0.75], rtol=1e-15)
    lines = zip(d["approach_ratio"], d["regime"], d["critical_tilt"], strict=True)
    for ratio, regime, critical_tilt in lines:
        setting = {"approach_ratio": ratio, "restitution": d["restitution"]}
        slide = slide_friction(rod, **setting)
        expected = np.where(friction >= holds, Regime.SLIP_STICK, Regime.SLIP_REVERSAL)
        expected = np.where(friction < slide, Regime.SLIDE, expected)
        off_line = np.minimum(abs(friction - slide), abs(friction - holds)) > 1e-9
        assert_array_equal(regime[off_line], expected[off_line])
        assert off_line.mean() > 0.9
        assert set(np.unique(regime)) == {1, 2, 3}
        drawn = np.isfinite(critical_tilt)
        tip, critical = thin_rod(critical_tilt[drawn]), d["critical_friction"][drawn]
        assert_allclose(critical_friction(tip), critical, atol=1e-14)
        assert np.all(critical >= slide_friction(tip, **setting))
    assert np.degrees(critical_tilt[drawn][-1]) > 85  # the second root, in the last panel


@pytest.mark.parametrize("restitution", [restitution for _, restitution in OWN_VALUES])
def test_fig10_shows_the_regimes_of_its_values(restitution):
    """Their names stand at their colours, as in the panels; the last reversal, where it is one."""
    d = fig10.data(quick=True, restitution=restitution)
    picture = fig10.draw(d)
    picture.canvas.draw()
    *panels, bar = picture.axes
    end = thin_rod(np.arctan(2))
    named = {
        int(number): re.sub(r"\W", "_", text.get_text()).upper()
        for number, text in zip(bar.get_yticks(), bar.get_yticklabels(), strict=True)
    }
    assert named == {number: Regime(number).name for number in (1, 2, 3)}
    for ax, ratio, regime in zip(panels, d["approach_ratio"], d["regime"], strict=True):
        mesh = ax.collections[0]
        assert_array_equal(mesh.get_array(), regime)
        assert len(np.unique(mesh.to_rgba([*named]), axis=0)) == len(named)
        last = classify(1.0, -ratio, geometry=end, friction=0.75, restitution=restitution)
        dotted = any("3/4" in str(line.get_label()) for line in ax.lines)
        assert dotted == (last != Regime.SLIDE)
    assert rf"$\epsilon={restitution:g}$" in picture.get_supxlabel()


def test_fig11_true_curve():
    """Ends and corners: (26) outside the two critical tilts, (29) between them."""
    d = data("fig11")
    lower, upper = d["critical_tilt"]
    assert_allclose(np.degrees([lower, upper]), [22.6568, 84.0424], atol=1e-4)
    between = (d["tilt"] > lower) & (d["tilt"] < upper)
    branch = np.where(between, d["reversal_c_x"], d["stick_c_x"])
    assert_allclose(d["c_x"], branch, rtol=1e-12, atol=1e-15)
    assert np.isin(d["tilt"], (lower, upper)).sum() == 2
    assert_allclose(d["c_z"][[0, -1]], [1.65 / 0.35, 1.65 / 6.35], rtol=1e-7)
    at_45 = np.interp(np.pi / 4, d["tilt"], d["stick_c_x"])  # where (26) does not hold
    assert at_45 == pytest.approx(1.65 / 4 / (1 / 4 + 0.35 / 12))


@pytest.mark.parametrize(("friction", "restitution"), OWN_VALUES)
def test_fig11_follows_its_values(friction, restitution):
    """The drift is within the panel; an arrow leads to where the contact sticks again."""
    d = fig11.data(quick=True, friction=friction, restitution=restitution)
    picture = fig11.draw(d)
    (ax,) = picture.axes
    top, upper = ax.get_ylim()[1], np.degrees(d["critical_tilt"][1])
    assert top > d["c_x"].max() or (restitution == 1 and top > fig11.HIGHEST)
    words = "\n".join(text.get_text() for text in picture.legends[0].get_texts())
    reverses = np.isfinite(upper)
    assert ("(26)" in words) == reverses
    assert (f", {upper:.2f}°" in words) == reverses
    for value in (restitution, friction):
        assert f"={value:g}$" in picture.get_supxlabel()
    assert len(ax.child_axes) == reverses
    for inset in ax.child_axes:
        tilt_deg, c_x = inset.texts[0].xy
        assert c_x == pytest.approx(np.interp(tilt_deg, np.degrees(d["tilt"]), d["c_x"]))


@pytest.mark.parametrize(
    ("friction", "curves"), [(0.0, ["rise", "slip-stick", "slip"]), (np.inf, ["drift", "rise"])]
)
def test_fig11_names_the_curves_that_it_draws(friction, curves):
    """Nothing says how fast rods drift without friction; none reverses that friction holds."""
    (ax,) = fig11.draw(fig11.data(quick=True, friction=friction)).axes
    named = {line.get_label().split()[0]: line for line in ax.lines if line.get_label()[0] != "_"}
    assert [name for name in named if name != "roots"] == curves
    assert all(np.isfinite(line.get_ydata()).any() for line in named.values())


# Fig. 12: soft impacts


def rigid(tilt, restitution, law="newton"):
    """The impact of Fig. 12, mu = 0.4."""
    return collide(0.5, -1.0, geometry=thick(tilt), friction=0.4, restitution=restitution, law=law)


def test_fig12_symbols_lie_on_the_theory_at_measured_restitution():
    d = data("fig12")
    tilt, regime = d["tilt"], d["regime"][0]
    theory = rigid(tilt, d["restitution"][0])
    assert_array_equal(regime, theory.regime)
    assert np.all(np.diff(tilt) > 0)
    assert [code for code, _ in groupby(regime)] == [2, 3, 1]  # stick, reversal, slide
    assert_array_equal(d["regimes_right"][:2], 17)
    assert d["regimes_right"][2] < 12  # as printed
    assert np.hypot(d["c_x"][0] - theory.c_x, d["c_z"][0] - theory.c_z).max() < 1.2e-3
    line = rigid(d["line_tilt"], 0.65)
    assert_allclose(d["line_c_x"], line.c_x, rtol=1e-12, atol=1e-14)
    for law, e in zip(fig12.RESTITUTION_LAWS, d["line_restitution"], strict=True):
        assert_allclose(e, rigid(d["line_tilt"], 0.65, law).normal_velocity, rtol=1e-12)
    assert d["rms_measured"][0] < 6e-4 < 1e-2 < d["rms_measured"][1] < 0.1 < d["rms_measured"][2]
    assert d["step_error"].max() < 1e-4


# Figs. 2, 6, 7, 8 and 13: rows

SPEED_CM_S = 3.3 * 981 / (2 * np.pi * 60)  # of the plate, at most


def test_rows_are_shown_in_the_units_of_the_axes():
    """cm/s and rad/s: the store's means times sqrt(g d) and over sqrt(d/g); theory at V_0/2."""
    six = data("fig06")
    names = "touches.c_x_after.mean", "touches.omega_before.mean"
    with tiny():
        c_x, omega = np.mean(runs.gathered(runs.tilt_plan(True), *names), axis=-1)
    assert_allclose(six["c_x_after"], c_x * np.sqrt(981 * 0.6))
    assert_allclose(six["omega_before"], omega * np.sqrt(981 / 0.6))
    rod = thick(np.radians(six["fine_deg"]))
    line = drift(rod, friction=0.3, restitution=0.65, plate_velocity=SPEED_CM_S / 2)
    assert_allclose(six["line_c_x"], line.c_x, rtol=1e-12)


@pytest.mark.parametrize(("panel", "line"), [(1, "line_c_z"), (2, "line_c_x")])
def test_lines_of_the_theory_name_their_equations(panel, line):
    """In slip-stick and, at large tilts, in slip reversal; (26), (29), (30) are of thin rods."""
    six = data("fig06")
    labels = fig06.draw(six).axes[panel].get_legend_handles_labels()[1]
    (label,) = (label for label in labels if "V_0/2" in label)
    rod = thick(np.radians(six["fine_deg"]))._asdict()
    known = rod | {"mu": 0.3, "epsilon": 0.65, "V_z": SPEED_CM_S / 2}
    forms = []
    for tag in re.findall(r"\((\d+)\)", label):
        form = function(tag)
        forms.append(form(**{x: known[x] for x in form.__signature__.parameters}))
    off = np.abs(np.array(forms) / six[line] - 1)
    assert_allclose(off.min(axis=0), 0, atol=1e-12)


def test_densities_of_phases_integrate_to_one():
    """And the paper's density is found again."""
    sums = data("fig08")["density"].sum(axis=1)
    assert_allclose(sums * 2 * np.pi / fig08.BINS_DRAWN, 1)
    edges = np.linspace(0, 2 * np.pi, 65)
    counts = np.diff(edges + np.sin(edges))
    middle = 2 * np.pi * (np.arange(fig08.BINS_DRAWN) + 0.5) / fig08.BINS_DRAWN
    assert_allclose(fig08.densities(counts), landing_density(middle), atol=1e-3)
    assert fig08.falling(counts) == pytest.approx(fig08.EXPECTED, rel=1e-12)


def test_tips_stay_above_the_plate_and_meet_it():
    d = data("fig07")
    gap = d["tips"] - d["plate"][:, None]
    assert -0.01 < gap.min() < 0.001  # cm
    assert gap.max() > 0.02
    assert d["plate"].max() == pytest.approx(SPEED_CM_S / (2 * np.pi * 60), rel=1e-3)


def test_drift_is_told_from_none():
    mean = np.array([1.0, 1.0, -1.0, -1.0, 0.001, -0.001, 0.0, 0.03, np.nan])
    error = np.array([0.1, 0.4, 0.1, 0.4, 1e-5, 1e-5, 0.0, 0.009, 0.1])
    assert_array_equal(fig02.classify(mean, error), [1, 0, -1, 0, 0, 0, 0, 1, 0])


def test_fits_find_what_was_put_in():
    gamma = np.array([1.05, 1.1, 1.2, 1.4, 2, 3, 4, 5.0])
    c_x = np.where(gamma < 1.5, 3 * (gamma - 1) ** 1.5, 2.5 * (gamma - 1.3))
    d = {"gamma": gamma, "gamma_c_x": c_x, "gamma_c_x_error": np.full(8, 1e-3)}
    f = fig13.fits(d)
    assert f["power"] == pytest.approx(1.5, abs=1e-6)
    assert (f["line_slope"], f["line_from"]) == pytest.approx((2.5, 1.3))
    lost = {**d, "gamma_c_x": np.where(gamma == 4, np.nan, c_x)}
    assert fig13.fits(lost)["line_slope"] == pytest.approx(2.5)
    in_mm = fig13.fits(d | {name: 10 * d[name] for name in ("gamma_c_x", "gamma_c_x_error")})
    assert in_mm["power_error"] == pytest.approx(f["power_error"])


# Figs. 4 and 5: the annulus


def test_two_maxima_and_a_slowdown_are_found():
    tilt = np.array([50, 3, 6, 9, 12, 15, 18, 22, 26, 30, 35, 40, 45.0])
    shape = fig04.shape(tilt, np.array([0.2, 1, 2, 3, 4, 5, 6, 5, 3, 4, 5, 3, 1]))
    expected = {"early": 18, "late": 35, "dip": 0.4, "bend": 0, "slope": 1 / 3, "end": 0.2 / 6}
    assert shape == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("assumed", [False, True])
def test_the_assumed_law_differs_in_the_contacts_alone(assumed):
    """Restitution 0.65 of plate, rods and walls, those of the plane row as well."""
    with tiny():
        plans = fig04.sweeps(True, assumed)
    simple = from_tables(runs.SIMPLE_ANNULUS).contacts.plate.law
    assert simple.restitution == 0.65
    for name, sweep in plans.items():
        contacts = sweep.points[0].scene.contacts
        parts = (contacts.plate, contacts.rods, *([] if name == "plane" else [contacts.wall]))
        assert ({part.law for part in parts} == {simple}) == assumed


def test_drift_tilt_and_arrangement_are_those_of_a_run():
    d = data("fig05")
    scene = from_tables(put(runs.ANNULUS, {"rods.count": 32}))
    result = md.run(scene, periods=MOST_PERIODS)
    with tiny():
        followed = arrangement.followed(scene, MOST_PERIODS)
    assert followed["c_x_cm_s"] == pytest.approx(result.c_x * np.sqrt(981 * 0.635))
    assert followed["tilt_deg"] == result.tilt_deg
    assert_array_equal(d["rods_32"], result.rods[:, :6])
    assert d["time"].tolist() == [2, 4, 6, 8]
    assert_allclose(d["mean"], d["series"][:, :, 2:, 0].mean(axis=(1, 2)))


def placed(radii, tilts=20.0):
    """Rods in any order around an annulus, leaning along it."""
    azimuth = 2 * np.pi * np.arange(len(radii)) / len(radii)
    lean = np.radians(tilts) + 0 * azimuth
    columns = [
        radii * np.cos(azimuth),
        radii * np.sin(azimuth),
        0 * azimuth,
        -np.sin(lean) * np.sin(azimuth),
        np.sin(lean) * np.cos(azimuth),
        np.cos(lean),
    ]
    return default_rng(1).permutation(np.transpose(columns))


def test_order_of_a_zigzag():
    """None at random, as offsets of 40 sum to zero; one where it is perfect, little less if not."""
    random = default_rng(3)
    orders = [arrangement.zigzag(placed(random.uniform(6.2, 6.9, 40))) for _ in range(200)]
    assert np.mean(orders) == pytest.approx(1 / 40, abs=0.03)
    assert np.std(orders) == pytest.approx(1 / np.sqrt(40), rel=0.2)
    radii = np.tile([6.2, 6.9], 20)
    assert arrangement.zigzag(placed(radii)) == pytest.approx(1)
    radii[20:] = radii[20:][::-1]  # one defect
    assert 0.85 < arrangement.zigzag(placed(radii)) < 0.95


def test_a_region_of_larger_tilt_is_told_from_scattered_tilts():
    for tilts, expected in (
        (np.repeat([15.0, 35.0], 20), (25, 10, 20, 0.5)),
        (np.tile([15.0, 35.0], 20), (25, 10, 0, 0.5)),
        (np.tile([19.0, 21.0], 20), (20, 1, 0, 0)),  # nobody leans much more
    ):
        mean, spread, _, contrast, share = arrangement.arrangement(placed(np.full(40, 6.5), tilts))
        assert (mean, spread, contrast, share) == pytest.approx(expected, abs=1e-9)
