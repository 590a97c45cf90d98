"""The drift at which the impact map keeps its balance, for a mean landing and touch by touch.

In the stationary row the mean change of a velocity in a touch is undone between the touches. The
map says which c_x goes with a given change of it, once all else is known: the theory's drift (24),
(29), where the change is zero, no rod spins, c_z is turned round and V_z is half of the plate's
peak velocity. Velocities are in sqrt(g d); c_x is the mean of before and after.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

import md
from impact import ContactGeometry, collide
from md.kernels import touches
from md.rod import Rod
from md.statistics import ratio

ENOUGH = 30  # touches in which nobody pushes, for means over them


class Landing(NamedTuple):
    """What the map takes: numbers, or arrays of one value a touch."""

    c_x: Any
    c_z: Any
    omega: Any
    V_z: Any
    rod: ContactGeometry
    friction: float
    restitution: float

    def gain(self, faster: float = 0.0) -> Any:
        """Change of c_x by the map, at so much more c_x."""
        c_x = self.c_x + faster
        hit = collide(
            c_x,
            self.c_z,
            self.omega,
            geometry=self.rod,
            friction=self.friction,
            restitution=self.restitution,
            plate_velocity=self.V_z,
        )
        return hit.c_x - c_x


def balancing(landing: Landing, gain: float) -> float:
    """How much more c_x gives this mean change of c_x; nan where friction cannot give it."""
    sizes = landing.c_x, landing.c_z, landing.V_z, landing.omega * landing.rod.k
    far = 1e3 * sum(np.max(np.abs(size)) for size in sizes)

    def excess(faster: float) -> float:
        return float(np.mean(landing.gain(faster)) - gain)

    if not (excess(-far) > 0 > excess(far)):
        return np.nan
    return float(brentq(excess, -far, far, xtol=1e-13))


def mean_drift(
    rod: ContactGeometry,
    friction: float,
    *,
    restitution: float,
    V_z: float,
    turned: float = 1.0,
    gain: float = 0.0,
    spin: float = 0.0,
) -> float:
    """Drift of the theory, of all landings alike, under any closure.

    Parameters
    ----------
    rod : contact geometry
    friction, restitution : of the plate
    V_z : velocity of the plate at the landing
    turned : -c_z/c_z', before over after
    gain : change of c_x in a landing, which is undone between landings
    spin : omega before the landing

    Returns
    -------
    Mean of c_x before and after; nan where there is no such landing.
    """
    x, z = rod.X / rod.k, rod.Z / rod.k
    # v_f = -restitution v_0 with both impulses known: P_x = gain, P_z = (1 + turned) c_z'
    pushed = (1 + restitution) * (V_z - spin * rod.X) + x * z * gain
    rise = pushed / (1 - restitution * turned + (1 + turned) * x**2)
    landing = Landing(0.0, -turned * rise, spin, V_z, rod, friction, restitution)
    return balancing(landing, gain) + gain / 2


def _in_time(rows: np.ndarray) -> float:
    """Mean of c_x over the time of flights and touches, taken to change evenly in each."""
    rows = rows[np.lexsort((rows[:, touches.STEP], rows[:, touches.ROD]))]
    before, after = rows[:, touches.BEFORE], rows[:, touches.AFTER]
    same = np.diff(rows[:, touches.ROD]) == 0
    flight, touch = rows[1:, touches.FLIGHT][same], rows[:, touches.DURATION]
    way = flight @ (after[:-1] + before[1:])[same] + touch @ (before + after)
    return float(way / 2 / (flight.sum() + touch.sum()))


def measures(rows: np.ndarray, scene: md.Scene, per: int) -> dict[str, Any]:
    """What touches tell of the closure.

    Parameters
    ----------
    rows : touches behind the transient, as `md.run` hands them to `observe`
    scene : in which they were made
    per : steps of a period

    Returns
    -------
    (value, standard error) of means over all touches, each alike, periods being the blocks; drifts
    without error:
    each: every touch by itself; soft: corrected by what the map misses where nobody pushes;
    pushed: as it is at the touches; in_time: over time; isolated, isolated_pushed: `each` and
    `pushed` of the touches in which nobody pushes, nan where there are fewer than `ENOUGH`
    """
    rows = rows[np.isfinite(rows[:, touches.FLIGHT])]
    alone = rows[:, touches.PUSHED] == 0
    enough = alone.sum() >= ENOUGH
    among = alone if enough else np.ones(len(rows), bool)
    block = (rows[:, touches.STEP] // per).astype(int)
    block -= block.min()

    def share(top: np.ndarray, base: np.ndarray) -> tuple[float, float]:
        return ratio(np.bincount(block, top), np.bincount(block, base))

    before = rows[:, touches.BEFORE : touches.AFTER]
    after = rows[:, touches.AFTER : touches.PLATE]
    gain, each = after - before, np.ones(len(rows))
    approach, leaving = rows[:, touches.APPROACH], rows[:, touches.LEAVING]
    restitution = share(leaving * among, -approach * among)

    k = float(np.sqrt(Rod(scene.rods.length, scene.rods.inertia).gyration_squared))
    assert scene.contacts.plate is not None
    friction, cut = scene.contacts.plate.friction, float(np.clip(restitution[0], 0, 1))

    def landing(those: np.ndarray) -> Landing:
        some = rows[those]
        rod = ContactGeometry(-some[:, touches.A_X], -some[:, touches.A_Z], k)
        c_x, c_z, omega = before[those].T
        return Landing(c_x, c_z, omega, some[:, touches.PLATE], rod, friction, cut)

    whole, middle = landing(each > 0), (before + after)[:, 0] / 2
    c_x, change = float(middle.mean()), float(gain[:, 0].mean())
    found = {"each": c_x + balancing(whole, change), "isolated": np.nan, "isolated_pushed": np.nan}
    missed = 0.0
    if enough:
        free, own = landing(alone), float(middle[alone].mean())
        shift = balancing(free, float(gain[alone, 0].mean()))
        missed = float(np.mean(gain[alone, 0] - free.gain()) / gain[alone, 1].mean())
        found |= {"isolated": own + shift, "isolated_pushed": own}
    found["soft"] = c_x + balancing(whole, change - missed * float(gain[:, 1].mean()))
    names = [f"{name}_{side}" for side in ("before", "after") for name in ("c_x", "c_z", "omega")]
    sides = zip(names, [*before.T, *after.T], strict=True)
    return {
        **found,
        "pushed": c_x,
        "in_time": _in_time(rows),
        **{name: share(column, each) for name, column in sides},
        "V_z": share(rows[:, touches.PLATE], each),
        "restitution": restitution,
        "alone": share(alone.astype(float), each),
    }


def balanced(scene: md.Scene, periods: int) -> dict[str, Any]:
    """`measures` of a run, its drift and its tilt, for `runs.planned`."""
    kept: list[np.ndarray] = []
    result = md.run(scene, periods=periods, observe=kept.append, ledger=False)
    if not result.finished:
        raise KeyboardInterrupt
    rows = np.concatenate(kept)
    rows = rows[rows[:, touches.STEP] >= result.discarded * result.steps_per_period]
    return {
        **measures(rows, scene, result.steps_per_period),
        "drift": (result.c_x, result.c_x_stderr),
        "tilt": (result.tilt_deg, result.tilt_stderr_deg),
    }
