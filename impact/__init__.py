'''The theory of a rod's frictional impact with a plate, as numbers.

>>> from math import radians
>>> import impact
>>> rod = impact.thin_rod(tilt=radians(30))
>>> hit = impact.collide(1.0, -2.0, geometry=rod, friction=0.3, restitution=0.65)
>>> hit.regime.name
'SLIP_REVERSAL'

Lengths are in one unit of your choice, velocities in that unit per time; spins are in rad per that
time, those given and those that come out. Nothing can check it: with lengths in mm and velocities
in m/s spins are in rad per millisecond. Arrays are paired by position; labelled ones (pandas,
xarray) are refused where their labels differ, and results are plain arrays.

Closed forms derived from Newton's laws by `derivations`; needs NumPy alone. On request, with Numba:
`impact.compiled` (the map as kernels), `impact.bouncing` (a rod at fixed tilt), `impact.falling` (a
rod that is let go).

Files, as one reads them
------------------------
_generated                          closed forms; written by `derivations`, never edited
_arguments                          arguments of all functions: domains, dtypes, blocks
geometry                            where the centre of mass stands over the contact point
_kernel, _compensated               one impact, as one body for arrays and for Numba
collision                           the impact map: `collide`, `classify`
boundaries, translation             boundaries of the regimes; the drift
compiled                            the map as Numba kernels, the same bits
flight, bouncing, falling           exact flights over the plate, and rods that make them
_jit, _interrupt                    compiled as all of it is; signals that wait
__main__, _handwritten, _command    the benchmark; errors of command lines

To add a function: the rebound of `help(derivations)`
-----------------------------------------------------
1. impact/translation.py, at the end
    def rebound(geometry: ContactGeometry, restitution: Any) -> Any:
        """Speed that a fall without spin and friction leaves the centre of mass, -c_z'/c_z.

        Parameters
        ----------
        geometry : any X, Z, and k > 0
        restitution : between 0 and 1

        Returns
        -------
        Dimensionless, negative where the centre goes on falling; nan for array elements out of
        their domain, of which scalars raise `ValueError`.
        """

        def block(X: Any, Z: Any, k: Any, epsilon: Any) -> tuple[Any, ...]:
            valid = valid_lengths(X, Z, k) & RESTITUTION.holds(epsilon)
            return (np.where(valid, closed.rebound(np.abs(X) / k, epsilon), np.nan),)

        arguments = {**lengths_of(geometry), "restitution": (restitution, RESTITUTION)}
        arrays, dtype = real_arrays(arguments)
        return in_blocks(block, arrays, [dtype])[0]

2. impact/__init__.py, for the line that begins `from .translation import`
    from .translation import Drift, drift, landing_density, mean_plate_velocity, rebound

3. impact/__init__.py, after the line `"mean_plate_velocity",`
    "rebound",

4. tests/test_public_api.py, after the line `"drift": HIT,`: arguments to start from
    "rebound": {"geometry": ROD, "restitution": 0.65},

5. tests/test_public_api.py, last in `OUT_OF_DOMAIN`: what is refused
    ("rebound", "restitution", 1.01),

Try it, against the impact map:

    import impact
    rod = impact.spherocylinder(0.3, 8.0)
    hit = impact.collide(0.0, -1.0, geometry=rod, friction=0.0, restitution=0.65)
    assert abs(impact.rebound(rod, 0.65) - hit.c_z) < 1e-15

    python -m pytest tests/test_public_api.py tests/test_documentation.py
'''  # noqa: D214, D215  (sections within examples)

from ._arguments import InputError
from ._kernel import Regime
from .boundaries import critical_friction, critical_tilts, energy_restitution, slide_friction
from .collision import Collision, classify, collide
from .geometry import ContactGeometry, flat_ended_rod, spherocylinder, thin_rod
from .translation import Drift, drift, landing_density, mean_plate_velocity

__all__ = [
    "Collision",
    "ContactGeometry",
    "Drift",
    "InputError",
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
