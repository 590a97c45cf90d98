'''Molecular dynamics of rods on a plate: soft contacts with friction, only the effects asked for.

>>> from math import radians
>>> import md
>>> hit = md.impact(radians(20), 0.5, -1.0, friction=0.4, law=md.coulomb(restitution=0.65))
>>> hit.regime
'slip-stick'

>>> scene = md.load("quasi2d", ["rods.count=10", "box.length=10.75", "step.size=4e-5"])
>>> result = md.run(scene, periods=20)
>>> result.c_x > 0  # rods drift the way they lean
True

One's own rods, in cm and Hz (`md/scenes/my_rods.toml`: copy it, change its numbers):

>>> mine = md.load("my_rods", ["plate.acceleration=3"])
>>> result = md.run(mine, periods=130)
>>> drift, error = (mine.cm_per_s * value for value in (result.c_x, result.c_x_stderr))
>>> print(f"{drift:.2f} +- {error:.2f} cm/s")  # doctest: +ELLIPSIS
5... +- 0... cm/s

`LAWS` holds the contact laws and `INTEGRATORS` the names of the methods, both for one impact. Many
runs along axes are `md.sweep`, their results `md.store`, the frames of a run `md.trajectory`.

Reduced units throughout: rod diameter d, mass of a rod and gravity are 1; scenes take cm, cm/s and
Hz as well, and `Scene.cm_per_s` is one unit of velocity. Nothing here is taken from the theory of
rigid impacts in `impact`, which it is there to test.

Files, as one reads them
------------------------
scene, units                        what is there: `Scene`, also in cm and Hz; examples in scenes/
contact, laws                       forces of one contact, compiled; what sets their constants
integrators, reference, one_rod     `impact`: fixed steps, or every switch located
neighbours, row, landings           rods in a plane, compiled: pairs, forces and steps, landings
engine, measures, statistics        a scene under way; what is measured of it, with errors
runner, trajectory, files           a run: periods, checkpoints, frames; what may be replaced
space/geometry, pairs, forces, crowd, placement, engine    the same in an annulus
dial, dial/calibration              `run`: step and length from a tolerance
sweep, store, cache, __main__       many runs, their results, compiled kernels, the command line
interrupt                           signals that wait until a call is over

Edits make stored runs stale (`cache.digest`), but for those of the files in `cache._APART`.

To add an effect: drag by the air
---------------------------------
1. md/row.py, after the line `skin: float | None`: what acts, `None` if it does not
    air: float | None = None  # drag over mass and velocity

2. md/row.py, after the function `full`: what it does, of which Numba leaves no code for `None`
    @kernel
    def dragged(air, a, rods, before, i, dt):
        """Accelerations of rod i with those by the air, at the velocity of the moment."""
        if air is None:
            return a
        c_x, c_z = rods[i, C_X] + before[i, 0] * dt / 2, rods[i, C_Z] + before[i, 1] * dt / 2
        return a[0] - air * c_x, a[1] - air * c_z, a[2]

3. md/row.py, before the line `c_x = rods[i, C_X] + dt * a[0]`: in `march`
    a = dragged(crowd.air, a, rods, before, i, dt)

4. md/scene.py, after the class `Gravity`: the key of the scene, and its domain
    @dataclass(frozen=True)
    class Air:
        """At rest; its drag is linear."""

        drag: float  # over mass and velocity, in sqrt(g/d)

        def __post_init__(self) -> None:
            _hold(self, "air", drag=(0.0, 1e3, "between 0 and 1000"))

5. md/scene.py, after the line `gravity: Gravity | None = None`
    air: Air | None = None  # around the rods

6. md/scene.py, first in the function `_in_space`: the annulus has a kernel of its own
    if self.air is not None:
        raise ValueError("air must be absent from an annulus, where it is not simulated")

7. md/engine.py, for the line that begins `row.Crowd(effects`: handed over, but not if it is zero
    row.Crowd(
        *(effects, between, box, SKIN if pair is not None else None),
        (scene.air.drag or None) if scene.air else None,
    ),

8. tests/test_row_effects.py, last in `EFFECTS`: its absence costs nothing
    "air": ({"air": md.scene.Air(0.1)}, {}, "crowd.4", None, []),

9. figures/effects.py, last in `EFFECTS`: its presence has a price
    "air": _instead(NOTHING | {"air.drag": 0.1}, NOTHING, {"air.drag": 0.1}),

Try it: one rod falls for three units of time.

    import math, md
    scene = md.load("single_rod", ["plate=none", "contacts=none", "start.speed=0", "air.drag=0.5"])
    assert abs(md.run(scene, periods=3).rods[0, 5] + (1 - math.exp(-1.5)) / 0.5) < 1e-6

    python -m pytest tests/test_row_effects.py tests/test_price_figures.py

What it takes of the energy is the ledger's residual, until it has a column: `row.PLATE_WORK`,
`engine.prepare`, `runner._result`. `Air` belongs into the list of names below.

To add a contact law: a constant dashpot
----------------------------------------
1. md/laws.py, after the function `coulomb`
    def constant_dashpot(damping: float = 100.0, stiffness: float = STIFFNESS) -> Law:
        """Hertz with a dashpot of constant `damping`, m sqrt(g/d); friction as a constraint."""
        k, dashpot = positive("stiffness", stiffness), not_negative("damping", damping)
        return Law("constant_dashpot", Normal(k, constant=dashpot or None), None)

2. md/laws.py, last in `LAWS`: where scenes and the command line find it
    "constant_dashpot": constant_dashpot,

Try it: a little loss is as the contact's duration, which goes as speed^(-1/5).

    import md
    law = md.LAWS["constant_dashpot"](damping=1)
    slow, fast = (1 - md.impact(0, 0, -v, friction=0, law=law).restitution for v in (1, 32))
    assert abs(slow / fast - 2) < 0.01

    python -m pytest tests/test_md_command.py tests/test_md_hard_cases.py

A term that `contact.Normal` lacks is a field there, a line in `contact.dashpot` and in its calls by
`push` and `reference.rates`, and its part of `laws.largest_step`. That springs are Hertz's is known
to `deepest_overlap`, `contact_time`, `Engine.energy` and the ledger in `row`.
'''

from .dial import Accuracy, Tuned, run
from .laws import LAWS, Law, appendix_a, constant_restitution, coulomb
from .one_rod import INTEGRATORS, Impact, Rod, RunError, impact
from .reference import Vibration
from .runner import Result
from .scene import Annulus, Box, Contact, Contacts, Gravity, Plate, Rods, Scene, Start, Step, load

__all__ = [
    "INTEGRATORS",
    "LAWS",
    "Accuracy",
    "Annulus",
    "Box",
    "Contact",
    "Contacts",
    "Gravity",
    "Impact",
    "Law",
    "Plate",
    "Result",
    "Rod",
    "Rods",
    "RunError",
    "Scene",
    "Start",
    "Step",
    "Tuned",
    "Vibration",
    "appendix_a",
    "constant_restitution",
    "coulomb",
    "impact",
    "load",
    "run",
]
