"""Gear's fifth-order method beside leapfrog, on single soft impacts of one cap (S19).

Both take forces of known velocities; `md` solves for those that its dashpots see. The forces are
written out once more, for all tilts at once, so that both also check `md.impact`.
"""

import numpy as np
from scipy.linalg import pascal

import md
from md.laws import contact_time

from ..lib.soft_impacts import APPROACH_RATIO, IMPACT_FRICTION, PAPER_STEP, ROD, TABLE_TILTS

LIGHT = 1 / ROD.gyration_squared
# Gear's corrector for second-order equations with velocities in the force.
CORRECTOR = np.array([3 / 16, 251 / 360, 1, 11 / 18, 1 / 6, 1 / 60])[:, None, None]


def forces(law: md.Law, place, half, now, spring, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Accelerations of rods by the plate, (3, n), and their tangential springs after a step.

    Parameters
    ----------
    law : of the contact; without a spring friction stops the slip of the step if it can
    place : x, z, tilt, (3, n)
    half, now : c_x, c_z, omega, (3, n): half a step before, which friction sees, and at the step,
        which the normal dashpot sees
    spring : lengths, (n,)
    dt : step
    """
    _, z, tilt = place
    x = -ROD.half_length * np.sin(tilt)  # of the contact point, seen from the centre; it is at -z
    overlap = np.maximum(0.5 + ROD.half_length * np.cos(tilt) - z, 0)
    root, rate, slip = np.sqrt(overlap), now[1] - now[2] * x, half[0] - half[2] * z
    across, along = 1 / (1 + x**2 * LIGHT), 1 / (1 + z**2 * LIGHT)
    dashpot = (law.normal.quarter or 0.0) * np.sqrt(across * root)
    dashpot += (law.normal.proportional or 0.0) * overlap
    push = np.maximum(law.normal.stiffness * overlap * root - dashpot * rate, 0)
    limit = IMPACT_FRICTION * push
    if law.spring is None:
        rub = np.clip(-along * (slip / dt + x * z * push * LIGHT), -limit, limit)
    else:
        k = law.spring.proportional * overlap
        rubbing, length = law.spring.proportional_dashpot * overlap * slip, spring + slip * dt
        rub = np.clip(-k * length - rubbing, -limit, limit)
        spring = np.divide(-rub - rubbing, k, where=push > 0, out=np.zeros_like(k))
    return np.array([rub, push, -(z * rub + x * push) * LIGHT]), spring


def start(dt: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places, velocities, (3, tilts) each, and springs half a step before the touch."""
    n = np.ones_like(TABLE_TILTS)
    touching = np.array([0 * n, ROD.half_length * np.cos(TABLE_TILTS) + 0.5, TABLE_TILTS])
    velocity = np.array([n / APPROACH_RATIO, -n, 0 * n])
    return touching - dt / 2 * velocity, velocity, 0 * n


def leapfrog(law: md.Law, dt: float, steps: int) -> np.ndarray:
    """Velocities after impacts at `TABLE_TILTS`, the touch in the middle of the first step."""
    place, velocity, spring = start(dt)
    for _ in range(steps):
        change, spring = forces(law, place, velocity, velocity, spring, dt)
        velocity = velocity + dt * change
        place = place + dt * velocity
    return velocity


def gear(law: md.Law, dt: float, steps: int) -> np.ndarray:
    """The same by Gear's method: place and five derivatives, times dt^i/i!, are predicted."""
    place, velocity, spring = start(dt)
    rods = np.zeros((6, *place.shape))
    rods[:2] = place, dt * velocity
    predictor = pascal(6, "upper")
    for _ in range(steps):
        rods = np.tensordot(predictor, rods, 1)
        half = (rods[1] - rods[2] + 0.75 * rods[3]) / dt
        change, spring = forces(law, rods[0], half, rods[1] / dt, spring, dt)
        rods += CORRECTOR * (dt**2 / 2 * change - rods[2])
    return rods[1] / dt


def difference(law: md.Law) -> float:
    """Largest difference of (c_x', c_z') between both methods by the paper's step, over |c_z|."""
    steps = int(2 * contact_time(law, 1.0) / PAPER_STEP)  # contacts are over, and rods fly
    apart = gear(law, PAPER_STEP, steps) - leapfrog(law, PAPER_STEP, steps)
    return float(np.hypot(*apart[:2]).max())
