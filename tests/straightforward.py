"""The paper's impact as one would first write it down: what the hard cases break.

Its equations as they are derived, misprints corrected and both signs of the slip allowed for, but
nothing rewritten. It is here so that every hard case can be seen to fail on something.
"""

from functools import cache

import numpy as np

from derivations import function
from impact import Collision

AFTER = ("12", "18", "21"), ("13", "19", "22")  # c_x' and c_z' of each regime


@cache
def formula(tag):
    """An equation of the paper as a function, and the letters that it takes."""
    equation = function(tag)
    return equation, [*equation.__signature__.parameters]


def collide(
    c_x, c_z, omega=0.0, *, geometry, friction, restitution, plate_velocity=0.0, law="newton"
):
    """Newton's law only, whatever `law` says."""
    X, Z, k = map(np.asarray, geometry)
    slip, approach = c_x - omega * Z, c_z - plate_velocity + omega * X
    side = np.sign(slip)
    letters = {
        "X": side * X,
        "Z": Z,
        "k": k,
        "mu": friction,
        "epsilon": restitution,
        "c_x": side * c_x,
        "c_z": c_z,
        "omega": side * omega,
        "V_z": plate_velocity,
        "u_0": side * slip,
        "v_0": approach,
    }

    def value(tag):
        equation, names = formula(tag)
        return equation(*(letters[name] for name in names))

    regime = np.where(value("14") > 0, 1, np.where(value("16"), 2, 3))
    after_x, after_z = (np.choose(regime - 1, [*map(value, tags)]) for tags in AFTER)
    P_x, P_z = side * after_x - c_x, after_z - c_z
    spin = (X * P_z - Z * P_x) / k**2
    u_f, v_f = slip + P_x - Z * spin, approach + P_z + X * spin
    energy = (P_x * (slip + u_f) + P_z * (approach + v_f)) / 2
    return Collision(c_x + P_x, after_z, omega + spin, regime, P_x, P_z, u_f, v_f, energy)


def critical_tilts(friction):
    """Eq. (23) as printed; only its one root."""
    return formula("23")[0](friction), np.nan


def drift(geometry, *, friction, restitution):
    """Eqs. (24) and (27) as printed, over the plate's velocity: for X Z > 0 the smaller holds."""
    given = dict(zip("XZk", geometry, strict=True)) | {"epsilon": restitution, "V_z": 1.0}
    slip_stick, slip_reversal = formula("24")[0](**given), formula("27")[0](**given, mu=friction)
    return (np.minimum(slip_stick, slip_reversal),)
