"""Rest, clock and step of a run, and that states which are none stop it."""

from dataclasses import replace
from math import pi

import mpmath
import numpy as np
import pytest

import md
from md.host import plate_motion, prepare
from md.kernels import touches as landings
from md.kernels.codes import X, Z
from md.scene import Contact, Contacts, Gravity, Plate, Rods, Scene, Start, Step

from .rows import EPS, SOFT, free, row

# Rest


@pytest.mark.parametrize(
    "law",
    [md.coulomb(0.5, 1e3), md.constant_restitution(0.5, 1e3, tangential_ratio=2.0)],
    ids=["constraint", "spring"],
)
def test_a_rod_that_lies_and_is_pushed_does_not_creep(law):
    """Pushed with 0.9 mu m g for 1000 sqrt(d/g): below 1e-10 d once the spring is stretched."""
    mu = 0.3
    scene = Scene(
        rods=Rods(1, 4.0),
        plate=Plate(),
        contacts=Contacts(plate=Contact(law, mu)),
        gravity=Gravity(x=0.9 * mu),
        start=Start(tilt_deg=90.0, speed=0.0),
        step=Step(5e-3),
    )
    engine = prepare(scene)
    engine.rods[0, Z] -= (1 / (2 * law.normal.stiffness)) ** (2 / 3)
    engine.go(100 * engine.per)  # settles
    place = engine.rods[0, X]
    engine.go(1000 * engine.per)
    assert abs(engine.rods[0, X] - place) < 1e-10
    assert abs(place - 2.0) < 0.1
    # pushed with more than that it goes
    engine.effects = engine.effects._replace(gravity=(1.1 * mu, -1.0))
    engine.go(10 * engine.per)
    assert engine.rods[0, X] - place == pytest.approx(0.1 * mu * 10**2 / 2, rel=0.1)


# Clock and step


def test_the_phase_is_exact_for_ever():
    """A period is a whole number of steps; after a million of them the plate is where it was."""
    scene = row("step.size=3e-4")
    late, early = prepare(scene), prepare(scene)
    per = early.per
    motion = plate_motion(scene, per)
    assert early.dt * scene.frequency * per == pytest.approx(1, abs=2 * EPS)
    amplitude = scene.plate_speed / (2 * pi * scene.frequency)
    with mpmath.workdps(40):
        for i in range(0, per, per // 50):
            exact = -mpmath.mpf(amplitude) * mpmath.cos(2 * mpmath.pi * i / per)
            assert abs(motion.height[i] - exact) < 4 * pi * EPS * amplitude
    late.step = 10**6 * per
    for engine in (early, late):
        engine.go(per + 17)
    np.testing.assert_array_equal(early.rods, late.rods)
    assert late.record.rows[0, landings.STEP] == 10**6 * per + early.record.rows[0, landings.STEP]


def largest(scene):
    """The largest step that the refusal of a larger one names."""
    with pytest.raises(ValueError, match=r"step.size must be at most .* got 0.5") as caught:
        prepare(replace(scene, step=replace(scene.step, size=0.5)))
    return float(str(caught.value).split("at most ")[1].split()[0])


def test_a_step_that_is_not_stable_is_refused_with_the_largest_that_is():
    """And the one it names is taken; coarse steps are beyond what springs allow."""
    limit, coarse = (largest(row(f"step.coarse={coarse}")) for coarse in ("false", "true"))
    assert coarse > 1.5 * limit
    assert prepare(row(f"step.size={limit}", "step.coarse=false")).dt <= limit
    with pytest.raises(ValueError, match="at most"):
        prepare(row(f"step.size={1.02 * limit}", "step.coarse=false"))
    assert md.run(row(f"step.size={coarse}"), periods=20).finished
    with pytest.raises(ValueError, match="stiffness 1 is too soft"):
        prepare(row("contacts.plate.stiffness=1"))


def test_the_largest_step_is_stable_for_a_row_pressed_together():
    """Rods side by side, elastic, touching both neighbours at both ends: the stiffest they get.

    Pressed by as much as the impacts that the step is made for. No energy from nothing: by 5 %
    in 200 steps at most, which at the border only bounded oscillations of the ledger's energy take.
    """
    n, length = 6, 9.5
    law = md.coulomb(1.0, SOFT)
    scene = Scene(
        rods=Rods(n, length),
        contacts=Contacts(rods=Contact(law)),
        start=Start(tilt_deg=0.0, speed=0.5),
    )
    deep = (1.25 * 0.5**2 / SOFT) ** 0.4
    random = np.random.default_rng(3)
    states = [(k * (1 - deep / 2), 0.0, 0.0, *(0.01 * random.uniform(-1, 1, 3))) for k in range(n)]
    engine = free(law, states, length=length, dt=0.999 * largest(scene))
    engine.go(1)
    before = engine.energy()
    engine.go(200)
    assert engine.energy() < 1.2 * before


# States that are none


@pytest.mark.parametrize("column", range(7))
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_state_that_is_not_finite_stops_the_run_at_once(column, value):
    """In any number of any rod; what is given back is what there was, all rods of one moment."""
    engine = prepare(row())
    engine.go(50)
    before = engine.rods.copy()
    engine.rods[2, column] = value
    with pytest.raises(md.RunError, match="rod 2: its state is not finite") as caught:
        engine.go(2)
    np.testing.assert_array_equal(np.delete(caught.value.state, 2, 0), np.delete(before, 2, 0))
