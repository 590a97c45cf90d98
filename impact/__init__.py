"""The theory of a rod's frictional impact with a plate, as numbers.

>>> from math import radians
>>> import impact
>>> rod = impact.thin_rod(tilt=radians(30))
>>> hit = impact.collide(1.0, -2.0, geometry=rod, friction=0.3, restitution=0.65)
>>> hit.regime.name
'SLIP_REVERSAL'

Lengths are in one unit of your choice, velocities in that unit per time; spins are in rad per that
time, in arguments and results. No function can check units: with lengths in mm and velocities in
m/s spins are in rad per millisecond. Arrays are paired by position; labelled ones (pandas, xarray)
are refused where their labels differ, and results are plain arrays.

Closed forms derived from Newton's laws by `derivations`; needs NumPy alone. On request, with Numba:
`impact.compiled` (the map as kernels), `impact.bouncing` (a rod at fixed tilt).

Files, as one reads them
------------------------
_generated                          closed forms, written by `derivations`, never edited
_kernel                             one impact, as one text for arrays and for Numba; `derivations`
                                    proves it and makes C and JavaScript of it
_arguments                          arguments of all functions: domains, dtypes, blocks
geometry                            where the centre of mass stands over the contact point
_impacts, _twofold, _select         regimes, arguments of impacts; twice the digits; `select`
collision                           the impact map: `collide`, `classify`
pairs                               two bodies of any masses that meet: `collide_pair`
boundaries, translation             regime boundaries; the drift, its stability, the best tilt
compiled                            the map as Numba kernels, the same bits
flight, bouncing                    exact flights over the plate, and a rod that makes them
_jit, _interrupt                    Numba's compiler; signals that wait until it is done

To add a function
-----------------
1. Derive its closed form in `derivations` and write `_generated.py` (`help(derivations)`).
2. Put the function beside similar ones: a `block` that calls the closed form, and the arguments by
   name; `_arguments.evaluated` does what all functions do with them. A name has one domain,
   in `_arguments.DOMAINS`.
3. List it here, in the imports and in `__all__`.
4. Give `tests/test_public_api.py` its arguments and what it refuses.
"""

from importlib import import_module
from typing import Any

from ._arguments import InputError
from ._impacts import Regime
from .boundaries import (
    critical_friction,
    critical_tilts,
    energy_restitution,
    painleve_friction,
    slide_friction,
)
from .collision import Collision, classify, collide
from .geometry import ContactGeometry, flat_ended_rod, spherocylinder, thin_rod
from .pairs import Body, PairCollision, collide_pair
from .translation import (
    Drift,
    Optimum,
    drift,
    landing_density,
    mean_plate_velocity,
    optimal_tilt,
    relaxation,
)

__all__ = [
    "Body",
    "Collision",
    "ContactGeometry",
    "Drift",
    "InputError",
    "Optimum",
    "PairCollision",
    "Regime",
    "classify",
    "collide",
    "collide_pair",
    "critical_friction",
    "critical_tilts",
    "drift",
    "energy_restitution",
    "flat_ended_rod",
    "landing_density",
    "mean_plate_velocity",
    "optimal_tilt",
    "painleve_friction",
    "relaxation",
    "slide_friction",
    "spherocylinder",
    "thin_rod",
]


def __getattr__(name: str) -> Any:
    """Load the version, and modules that need Numba, only when asked for."""
    if name == "__version__":
        from importlib.metadata import version  # late: a fifth of the time of import impact

        return version("rod-impact")
    if name in ("bouncing", "compiled"):
        return import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
