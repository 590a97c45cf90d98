"""The theory of a rod's frictional impact with a plate, as numbers.

>>> from math import radians
>>> import impact
>>> rod = impact.thin_rod(tilt=radians(30))
>>> hit = impact.collide(1.0, -2.0, geometry=rod, friction=0.3, restitution=0.65)
>>> hit.regime.name
'SLIP_REVERSAL'

Closed forms derived from Newton's laws by `derivations`; needs NumPy alone. On request, with Numba:
`impact.compiled` (the map as kernels), `impact.bouncing` (a rod at fixed tilt), `impact.falling` (a
rod that is let go).
"""

from ._kernel import Regime
from .boundaries import critical_friction, critical_tilts, energy_restitution, slide_friction
from .collision import Collision, classify, collide
from .geometry import ContactGeometry, flat_ended_rod, spherocylinder, thin_rod
from .translation import Drift, drift, landing_density, mean_plate_velocity

__all__ = [
    "Collision",
    "ContactGeometry",
    "Drift",
    "Regime",
    "classify",
    "collide",
    "critical_friction",
    "critical_tilts",
    "drift",
    "energy_restitution",
    "flat_ended_rod",
    "landing_density",
    "mean_plate_velocity",
    "slide_friction",
    "spherocylinder",
    "thin_rod",
]
