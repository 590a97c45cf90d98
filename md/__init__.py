"""Molecular dynamics of rods on a plate: soft contacts with friction, only the effects asked for.

>>> from math import radians
>>> import md
>>> hit = md.impact(radians(20), 0.5, -1.0, friction=0.4, law=md.coulomb(restitution=0.65))
>>> hit.regime
'slip-stick'

>>> scene = md.load("quasi2d", ["rods.count=10", "box.length=10.75", "step.size=4e-5"])
>>> result = md.run(scene, periods=20)
>>> result.c_x > 0  # rods drift the way they lean
True

Your rods, in cm and Hz (`md/scenes/my_rods.toml`: copy it, change its numbers):

>>> mine = md.load("my_rods", ["plate.acceleration=3"])
>>> result = md.run(mine, periods=130)
>>> drift, error = (mine.cm_per_s * value for value in (result.c_x, result.c_x_stderr))
>>> print(f"{drift:.2f} +- {error:.2f} cm/s")  # doctest: +ELLIPSIS
5... +- 0... cm/s

`LAWS` holds the contact laws and `INTEGRATORS` the names of the methods, both for one impact. Many
runs along axes are `md.sweep`, parameters from measurements `md.search`, results in `md.store`, the
frames of a run `md.trajectory`.

Reduced units throughout: rod diameter d, mass of a rod and gravity are 1; scenes take cm, cm/s and
Hz as well, and `Scene.cm_per_s` is one unit of velocity. Nothing here is taken from the theory of
rigid impacts in `impact`, which it is there to test.

Files, as one reads them
------------------------
scene, units, laws, domains         what is there: `Scene`, also in cm and Hz; the contact laws
kernels/codes, rates                stop codes, columns, regimes; rates of an exact contact
kernels/contact, single             compiled: forces of one contact; one rod on the plate
kernels/plane                       compiled: a row, forces between its rods, its steps
kernels/neighbours, touches         compiled: which rods may touch; touches of the plate
kernels/joints                      compiled: two ends that meet, one contact
kernels/space                       compiled: an annulus; `pairs` has the forces between its rods
rod, reference, soft_impact         `impact`: every switch located, or fixed steps
host, placement                     a scene under way: constants and arrays of the kernels
measures, statistics                what a run measures, with errors
simulation, trajectory, files       a run: periods, checkpoints, frames, files
accuracy, calibration               `run`: step and length from a tolerance; bias of the step
sweep, store                        many runs and their results; `Point.key` says which is stale
search, surface                     parameters from measured results, by many runs
sources                             digest of the sources of a run, a part of that key
cache, interrupt, errors            compiled kernels kept, signals, errors
result_text, command_line, __main__  results as text; the commands

To add a contact law: `md.laws`. To add an effect: `md.kernels`.
"""

from .accuracy import run
from .errors import InputError, RunError
from .laws import LAWS, Law, appendix_a, constant_restitution, coulomb
from .reference import Vibration
from .rod import Rod
from .scene import Annulus, Box, Contact, Contacts, Gravity, Plate, Rods, Scene, Start, Step, load
from .simulation import Accuracy, Result
from .soft_impact import INTEGRATORS, Impact, impact

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
    "InputError",
    "Law",
    "Plate",
    "Result",
    "Rod",
    "Rods",
    "RunError",
    "Scene",
    "Start",
    "Step",
    "Vibration",
    "appendix_a",
    "constant_restitution",
    "coulomb",
    "impact",
    "load",
    "run",
]
