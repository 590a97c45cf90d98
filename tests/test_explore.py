"""The window of sliders: what is drawn is what `impact` says where the controls stand."""

import itertools
from dataclasses import replace

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import impact
from figures.__main__ import main
from figures.pages import explore
from figures.pages.explore import CHOICES, RANGES, TILT, Setting, Window, data, words

RODS = {"thin": impact.thin_rod, "round": impact.spherocylinder, "flat": impact.flat_ended_rod}
START = Setting()
CHANGES = [
    {},
    {"tilt_deg": 71.5},
    {"friction": 0.62},
    {"restitution": 0.9},
    {"ratio": 0.4},
    {"length": 2.5},
    {"shape": "thin"},
    {"shape": "flat", "tilt_deg": 4.0, "friction": 0.05},
    {"law": "poisson"},
    {"law": "stronge", "restitution": 0.3, "ratio": 6.0},
]


@pytest.fixture(scope="module")
def window():
    opened = Window(START)
    yield opened
    plt.close(opened.figure)


def changed(**changes) -> Setting:
    return replace(START, **changes)


def hit(s: Setting, tilt: float, friction: float) -> impact.Collision:
    """One impact of a rod that comes with speed 1."""
    rod, way = RODS[s.shape](tilt, s.length), np.arctan(s.ratio)
    given = {"geometry": rod, "friction": friction, "restitution": s.restitution, "law": s.law}
    return impact.collide(np.cos(way), -np.sin(way), **given)


@pytest.mark.parametrize("changes", CHANGES, ids=str)
def test_drawn_is_what_impact_says(window, changes):
    """Each control moves what it should: curves, rings, colours, by calls for one point each."""
    s = changed(**changes)
    window.move(START)
    for name, value in changes.items():
        if name in RANGES:
            window.sliders[name].set_val(value)
        else:
            window.buttons[name].set_active([*CHOICES[name]].index(value))
    assert window.setting() == s
    for i in (1, 300, 900, 1500, 1800):
        one, rod = hit(s, TILT[i], s.friction), RODS[s.shape](TILT[i], s.length)
        moves = impact.drift(rod, friction=s.friction, restitution=s.restitution)
        slide = impact.slide_friction(rod, approach_ratio=s.ratio, restitution=s.restitution)
        expected = {"c_x": one.c_x, "c_z": one.c_z, "spin": one.omega * rod.k, "drift": moves.c_x}
        expected |= {"critical_friction": impact.critical_friction(rod), "slide_friction": slide}
        for name, value in expected.items():
            drawn = window.curves[name].get_data()
            assert drawn[0][i] == pytest.approx(np.degrees(TILT[i]))
            assert drawn[1][i] == pytest.approx(value, rel=1e-9, abs=1e-12), name
        if i % 10 == 0:
            assert window.shades["regime"].get_array()[0, i // 10] == one.regime
            assert window.shades["drift_regime"].get_array()[0, i // 10] == moves.regime
            for row in (3, 40, 95):
                regime = hit(s, TILT[i], row / 100).regime
                assert window.map.get_array().reshape(101, 181)[row, i // 10] == regime
    tilt = np.radians(s.tilt_deg)
    here, rod = hit(s, tilt, s.friction), RODS[s.shape](tilt, s.length)
    rings = {"c_x": here.c_x, "c_z": here.c_z, "spin": here.omega * rod.k}
    for name, value in rings.items():
        (tilt_deg,), (height,) = window.rings[name].get_data()
        assert (tilt_deg, height) == pytest.approx((s.tilt_deg, value), rel=1e-9)
    assert window.here.get_data() == ([s.tilt_deg], [s.friction])
    numbers = ",  ".join(f"{value:.3f}" for value in rings.values())
    assert window.numbers[1].get_text() == numbers
    text, lost = window.words.get_text(), -200 * here.energy_change
    name = {1: "Slide:", 2: "Slip-stick:", 3: "Slip reversal:"}[here.regime]
    assert text.startswith(name)
    assert f"{lost:.1f} % of the energy lost" in text
    assert f"{here.c_x:+.3f} along" in text
    assert f"{abs(here.c_z):.3f} {'up' if here.c_z >= 0 else 'down'}" in text


def test_every_regime_is_among_the_settings():
    assert {data(changed(**changes))["regime"][-1] for changes in CHANGES} == {1, 2, 3}


@pytest.mark.parametrize("friction", [0.01, 0.3, 0.6, 0.7, 0.745, 0.76])
def test_critical_tilts(window, friction):
    """Those of a thin rod are the closed form's; diamonds stand on them, words name them."""
    window.move(changed(shape="thin", friction=friction))
    exact = np.degrees(impact.critical_tilts(friction))
    exact = exact[np.isfinite(exact)]
    for marks in window.corners:
        np.testing.assert_allclose(marks.get_xdata(), exact, atol=1e-4)
    named = ", ".join(f"{tilt:.2f}°" for tilt in exact) or "none"
    assert f"Critical tilts at this friction: {named}." in window.words.get_text()


def test_critical_tilts_of_a_flat_end():
    """Around arctan(d/l) friction holds a stopped contact, however small it is."""
    d = data(changed(shape="flat", length=3.0, friction=0.2))
    rod = impact.flat_ended_rod(d["critical_tilts"], 3.0)
    np.testing.assert_allclose(impact.critical_friction(rod), 0.2, atol=1e-6)
    first, second = d["critical_tilts"]
    assert first < np.arctan(1 / 3) < second


@pytest.mark.parametrize(
    ("said", "changes"),
    [
        ("against the way", {"shape": "flat", "tilt_deg": 4.0}),
        ("GAINED", {"shape": "thin", "restitution": 1.0, "ratio": 10, "friction": 0.6}),
        ("not determined without friction", {"friction": 0.0}),
        ("without bound", {"tilt_deg": 0.0, "restitution": 1.0}),
        ("Drift: none", {"length": 1.0}),
        ("slides through at every friction", {"tilt_deg": 80, "ratio": 0.3}),
        ("slides through at no value of the friction", {}),
    ],
)
def test_words_at_the_ends(said, changes):
    assert said in words(data(changed(**changes)))


def test_ends_of_all_sliders(window):
    """No warning (they are errors here), finite axes, and numbers in every curve."""
    ends = {name: (low, high) for name, (low, high, *_) in RANGES.items()}
    for values in itertools.product(*ends.values(), CHOICES["shape"]):
        s = changed(**dict(zip((*ends, "shape"), values, strict=True)))
        d = data(s)
        assert np.isfinite([d["c_x"], d["c_z"], d["spin"], d["critical_friction"]]).all()
        assert set(np.unique(d["regimes"])) <= {1, 2, 3}
    for low_or_high in (0, 1):
        window.move(changed(**{name: pair[low_or_high] for name, pair in ends.items()}))
        window.figure.canvas.draw()
        for ax in window.figure.axes:
            assert np.isfinite([*ax.get_xlim(), *ax.get_ylim()]).all()


def test_ends_of_the_drift_axis(window):
    window.move(changed(friction=0.0))
    assert window.panels[2].get_ylim() == (-0.05, 0.5)
    window.move(changed(shape="flat", restitution=1.0))
    assert window.panels[2].get_ylim() == (-10, 10)
    window.move(START)
    assert window.panels[2].get_ylim() == (-0.05, 4)


def test_no_redraw_leaves_a_trace(window):
    """What is painted onto the picture of the still parts is a full draw, but for ticks' roots."""
    canvas = window.figure.canvas
    for s in (changed(tilt_deg=70.0), changed(shape="flat", restitution=0.9, law="poisson")):
        window.move(START)
        window.move(s)
        assert window.still is not None
        painted = np.array(canvas.buffer_rgba()).astype(int)
        canvas.draw()
        assert window.still is None
        difference = np.abs(painted - np.array(canvas.buffer_rgba())).max(axis=-1)
        assert difference.max() <= 40
        assert np.count_nonzero(difference) < 100


def test_mouse_drags_a_slider_and_a_key_goes_back_to_the_start(window):
    window.move(changed(law="stronge", shape="flat"))
    canvas, slider = window.figure.canvas, window.sliders["friction"]
    x, y = slider.ax.transAxes.transform((0.2, 0.5))
    for name in ("button_press_event", "button_release_event"):
        canvas.callbacks.process(name, mpl.backend_bases.MouseEvent(name, canvas, x, y, 1))
    assert window.here.get_ydata() == pytest.approx([0.2])
    for key, friction in (("x", 0.2), ("r", START.friction)):
        canvas.callbacks.process("key_press_event", mpl.backend_bases.KeyEvent("", canvas, key))
        assert window.setting().friction == pytest.approx(friction)
    assert window.setting() == START


def test_out_writes_a_picture(tmp_path, capsys):
    path, before = tmp_path / "new" / "here.png", plt.get_fignums()
    assert main(["explore", "--tilt-deg", "12", "--shape", "flat", "--out", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}\n"
    assert plt.imread(path).shape == (1320, 2200, 4)
    assert [p.name for p in path.parent.iterdir()] == ["here.png"]
    assert plt.get_fignums() == before


def test_options_are_the_start(monkeypatch):
    seen = []
    monkeypatch.setattr(explore, "run", lambda start: not seen.append(start))
    names = [f"--{name.replace('_', '-')}" for name in (*RANGES, *CHOICES)]
    values = ("1", "0.2", "0.3", "4", "5", "flat", "stronge")
    assert main(["explore", *itertools.chain(*zip(names, values, strict=True))]) == 0
    assert main(["explore"]) == 0
    assert seen == [Setting(1, 0.2, 0.3, 4, 5, "flat", "stronge"), START]
