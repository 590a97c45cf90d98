"""The paper's impact as one would first write it down: what the hard cases break.

Equations (8)-(22) with their misprints corrected and both signs of the slip allowed for, but
nothing rewritten. It is here so that every hard case can be seen to fail on something.
"""

import numpy as np

from impact import Collision


def collide(
    c_x, c_z, omega=0.0, *, geometry, friction, restitution, plate_velocity=0.0, law="newton"
):
    """Newton's law only, whatever `law` says."""
    X, Z, k = map(np.asarray, geometry)
    mu, e = np.asarray(friction), restitution
    slip, v_0 = c_x - omega * Z, c_z - plate_velocity + omega * X
    side, u_0 = np.sign(slip), np.abs(slip)
    XZ = side * X * Z
    across, along = k**2 + X**2, k**2 + Z**2
    forward = across + mu * XZ
    stop = mu * along + XZ
    back = across - mu * XZ
    whole = across + Z**2
    bracket = (1 + e) * v_0 + forward / stop * u_0

    slides = u_0 + stop / forward * v_0 * (1 + e) > 0
    sticks = mu * along > XZ
    slide_z = -v_0 * (1 + e) * k**2 / forward
    stop_z = u_0 * k**2 / stop
    stick_z = stop_z - bracket * along / whole
    stick_x = -mu * stop_z - bracket * XZ / whole
    back_z = stop_z - k**2 / back * bracket
    back_x = -mu * stop_z - mu * k**2 / back * bracket
    P_z = np.where(slides, slide_z, np.where(sticks, stick_z, back_z))
    P_x = side * np.where(slides, -mu * slide_z, np.where(sticks, stick_x, back_x))
    spin = (X * P_z - Z * P_x) / k**2
    u_f = slip + P_x - Z * spin
    v_f = v_0 + P_z + X * spin
    energy = (P_x * (slip + u_f) + P_z * (v_0 + v_f)) / 2
    regime = np.where(slides, 1, np.where(sticks, 2, 3))
    return Collision(c_x + P_x, c_z + P_z, omega + spin, regime, P_x, P_z, u_f, v_f, energy)


def critical_tilts(friction):
    """Eq. (23) as printed; only its one root."""
    cosine = (np.sqrt(9 - 16 * friction**2) - 5 * friction**2) / (3 * (1 + friction**2))
    return np.arccos(cosine) / 2, np.nan


def drift(geometry, *, friction, restitution):
    """Eqs. (24) and (27) as printed, over the plate's velocity: for X Z > 0 the smaller holds."""
    X, Z, k = geometry
    pushed = np.minimum(2 * X * Z, friction * (k**2 + Z**2) + X * Z)
    return ((1 + restitution) * pushed / (k**2 * (1 - restitution) + 2 * X**2),)
