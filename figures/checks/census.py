"""Every touch of a run beside the impact map, fed what was measured just before it.

Per touch: the change of (c_x, c_z, k omega), `jump`; how far the map misses what came out,
`residual`; the same once the map is told that the contact takes time, `allowed`; and what other
rods gave meanwhile, `kick`. All are velocities, in sqrt(g d), k the gyration radius.

Allowing for the contact's time: gravity and the plate's acceleration act with one half before the
impact and the other half after it, and the arms are those of the middle of the contact. What the
plate does passes through the contact point, so the angular momentum about that point, changed by
more than gravity does, is the kick of other rods: one of its three components, the one that needs
no knowledge of the plate's force.
"""

from typing import Any, NamedTuple

import numpy as np

import md
from impact import ContactGeometry, collide
from md.kernels import touches
from md.laws import Rod
from md.measures import ratio

DISTURBED = 0.1  # kick over jump from which other rods had a say


class Census(NamedTuple):
    """One value a touch; `block` numbers what is averaged together for the standard error."""

    block: np.ndarray  # period of the touch
    blocks: int
    isolated: np.ndarray  # no other rod pushes meanwhile
    jump: np.ndarray
    residual: np.ndarray
    allowed: np.ndarray
    kick: np.ndarray
    seen: np.ndarray  # regime in the run
    mapped: np.ndarray  # regime of the map
    restitution: np.ndarray  # -v_f/v_0 as measured, not clipped; -inf if nothing approached
    duration: np.ndarray  # periods


def _mapped(before, after, arms, k, friction, plate, v_f, pull):
    """Map of what was measured: how far from the outcome, its regime, the restitution taken.

    `before`, `after` hold c_x, c_z, omega of each touch, `plate` the plate's velocities then;
    `arms` are X and Z; `pull` is what gravity and the plate's acceleration add to c_z, seen from
    the plate, in half of the contact.
    """
    c_x, c_z, omega = before.T
    x, z, turn = after.T
    towards = c_z - plate[0] + pull
    v_0 = towards + omega * arms[0]
    with np.errstate(all="ignore"):
        restitution = np.where(v_0 < 0, -v_f / v_0, -np.inf)
    hit = collide(
        c_x,
        towards,
        omega,
        geometry=ContactGeometry(*arms, k),
        friction=friction,
        restitution=np.clip(restitution, 0, 1),
    )
    miss = np.array([x - hit.c_x, z - plate[1] - pull - hit.c_z, k * (turn - hit.omega)])
    return np.linalg.norm(miss, axis=0), hit.regime, restitution


def compared(rows: np.ndarray, scene: md.Scene, dt: float, per: int) -> dict[str, np.ndarray]:
    """Fields of `Census` but the blocks, of rows as `md.run` hands them to `observe`."""
    k2 = Rod(scene.rods.length, scene.rods.inertia).gyration_squared
    k, friction = np.sqrt(k2), scene.contacts.plate.friction
    columns = rows.T
    a_x, a_z, plate = columns[[touches.A_X, touches.A_Z, touches.PLATE]]
    before, after = np.split(rows[:, touches.BEFORE : touches.PLATE], 2, axis=1)
    gain, duration = after - before, columns[touches.DURATION]
    time, end = duration * dt, (columns[touches.STEP] + duration) % per
    last = scene.plate_speed * np.sin(2 * np.pi * end / per)  # velocity of the plate
    fall = time * (scene.gravity.z if scene.gravity else 0.0)

    # At its word the map knows one velocity of the plate, that at the touch, and no gravity.
    v_f, arms, still = columns[touches.LEAVING], (-a_x, -a_z), (plate, plate)
    residual, mapped, restitution = _mapped(before, after, arms, k, friction, still, v_f, 0.0)
    turn = (before[:, 2] + gain[:, 2] / 2) * time / 2
    x, z = -a_x - (a_z + 0.5) * turn, -a_z + a_x * turn  # the cap, of radius 1/2, does not turn
    pull = (fall - (last - plate)) / 2
    v_f = after[:, 1] - last - pull + after[:, 2] * x
    allowed, *_ = _mapped(before, after, (x, z), k, friction, (plate, last), v_f, pull)
    spin = k2 * gain[:, 2] - a_z * gain[:, 0] + a_x * (gain[:, 1] - fall)
    return {
        "isolated": columns[touches.PUSHED] == 0,
        "jump": np.linalg.norm(gain * [1, 1, k], axis=1),
        "residual": residual,
        "allowed": allowed,
        "kick": np.abs(spin) / np.sqrt(k2 + a_x**2 + a_z**2),
        "seen": columns[touches.REGIME].astype(int),
        "mapped": mapped,
        "restitution": restitution,
        "duration": duration / per,
    }


def observed(scene: md.Scene, periods: int) -> tuple[np.ndarray, md.Result]:
    """Rows of the touches of a run behind its transient, and the run."""
    kept: list[np.ndarray] = []
    result = md.run(scene, periods=periods, observe=kept.append, ledger=False)
    if not result.finished:
        raise KeyboardInterrupt
    rows = np.concatenate(kept)
    first = result.discarded * result.steps_per_period
    return rows[rows[:, touches.STEP] >= first], result


def census(scene: md.Scene, periods: int) -> tuple[Census, md.Result]:
    """Touches of a run behind its transient, a block a period."""
    rows, result = observed(scene, periods)
    per, first = result.steps_per_period, result.discarded
    block = (rows[:, touches.STEP] // per - first).astype(int)
    return Census(block, periods - first, **compared(rows, scene, result.dt, per)), result


def counted(scene: md.Scene, periods: int) -> dict[str, Any]:
    """Measures of the touches of a run, (value, standard error) each, for `runs.planned`."""
    found, result = census(scene, periods)
    return {
        **measures(found),
        "tilt": (result.tilt_deg, result.tilt_stderr_deg),
        "isolated_count": int(found.isolated.sum()),
    }


def _share(c: Census, what: np.ndarray, of: np.ndarray) -> tuple[float, float]:
    """Mean of `what` with the weights `of`, and its standard error over blocks."""
    top, base = (np.bincount(c.block, weights, c.blocks) for weights in (what * of, of))
    return ratio(top, base)


def measures(c: Census) -> dict[str, tuple[float, float]]:
    """Means over all, isolated and pushed touches, weighted by the jump; standard errors."""
    size = np.where(c.jump > 0, c.jump, np.inf)
    found = {
        "shared": _share(c, ~c.isolated, c.jump),
        "disturbed": _share(c, c.kick > DISTURBED * c.jump, c.jump),
    }
    for part, members in (("", 1.0), ("isolated_", c.isolated), ("pushed_", ~c.isolated)):
        weight = c.jump * members
        for regime, name in enumerate(("slide", "stick", "reversal"), start=1):
            found[part + name] = _share(c, c.seen == regime, weight)
        for name in ("residual", "allowed", "kick"):
            found[part + name] = _share(c, getattr(c, name) / size, weight)
    return found
