"""Molecular dynamics of rods on a plate: soft contacts with friction, only the effects asked for.

>>> from dataclasses import replace
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
>>> result  # doctest: +ELLIPSIS
<Result: 5... +- 0... cm/s at 3... degrees, 130 periods>

A contact law of your own is a `Law` of terms that the kernels know, a `Normal` force and a
tangential `Spring`. It is numbers alone, so a store knows it and other processes run it:

>>> law = md.Law("mine", md.Normal(5e6, constant=300.0), md.Spring(root=1.5e7, damping_ratio=1.0))
>>> hit = md.impact(radians(20), 0.5, -1.0, friction=0.4, law=law)
>>> plate = md.Contact(law, friction=0.4)
>>> own = replace(md.load("single_rod"), contacts=md.Contacts(plate=plate))  # for `md.run`

After `md.LAWS["mine"] = function`, which returns a `Law`, "mine" is a value of the key
`contacts.plate.law` in this process, and the arguments of the function are keys beside it: in
`md.load`, `md.sweep` and `md.search`, whatever processes make their runs, but not in the commands.
A force that is no sum of such terms, with another power of the overlap, say, needs a change of
the kernels (`md.laws`).

`LAWS` holds the contact laws and `INTEGRATORS` the names of the methods, both for one impact. Many
runs along axes are `md.sweep`, parameters from measurements `md.search`, results in `md.store`, the
touches of a run one by one, and its frames, `md.records`.

Reduced units throughout: rod diameter d, mass of a rod and gravity are 1; scenes take cm, cm/s and
Hz as well, and `Scene.cm_per_s` is one unit of velocity. Nothing here is taken from the theory of
rigid impacts in `impact`, which it is there to test.

Files, as one reads them
------------------------
scene, units, laws                  what is there: `Scene`, also in cm and Hz; contact laws, rods
domains                             values held to what is allowed; errors
kernels/vectors, contact            compiled: the forces of every contact, in the plane and in space
kernels/state, march                compiled: rods of a row or an annulus, their steps, their energy
kernels/neighbours                  compiled: closest points of rods; which rods may touch
kernels/batch, pairs, surfaces      compiled: contacts side by side; of rods, with plate and walls
kernels/touches                     compiled: touches of the plate
soft_impact                         `impact`: one rod by these steps, or every switch located
host, placement                     the engine of a scene: arrays of the kernels, initial places
measures                            means and errors of a run
result                              the result of a run, as numbers and as text
records                             touches of a run one by one; its frames
simulation, files                   a run: periods, checkpoints, files
accuracy                            `run`: step and length from a tolerance
sweep, store                        many runs and their results; what a store's columns are
search                              parameters from measured results, by many runs
cache                               stored compiled kernels; what decides whether a run is stale
command_line, __main__              the commands, and signals from the first import on

To add a contact law: `md.laws`. To add an effect: `md.kernels`, where stop codes and columns are.
"""

from . import command_line  # noqa: F401  (before slow imports)

# isort: split
from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from . import records as records
from .accuracy import run
from .domains import InputError, RunError
from .kernels.contact import Normal, Spring
from .laws import LAWS, Law, Rod, appendix_a, constant_restitution, coulomb
from .result import Accuracy, Result
from .scene import Annulus, Box, Contact, Contacts, Gravity, Plate, Rods, Scene, Start, Step, load
from .soft_impact import INTEGRATORS, Impact, impact

if TYPE_CHECKING:
    from . import search as search
    from . import store as store
    from . import sweep as sweep

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
    "Normal",
    "Plate",
    "Result",
    "Rod",
    "Rods",
    "RunError",
    "Scene",
    "Spring",
    "Start",
    "Step",
    "appendix_a",
    "constant_restitution",
    "coulomb",
    "impact",
    "load",
    "run",
]


def __getattr__(name: str) -> Any:
    """Load the version, and modules that need joblib or SciPy's statistics, only when asked for."""
    if name == "__version__":
        return version("rod-impact")
    if name in ("search", "store", "sweep"):
        return import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
