"""From a scene in an annulus to what the kernels take, and what is measured there."""

from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np

from .errors import InputError, RunError
from .host import SAMPLES, Marching, plate_motion, step_of
from .kernels.contact import Friction, Motion
from .kernels.plane import PAIR_TOO_DEEP, TOO_FAST, Between
from .kernels.single import DEEP, NOT_FINITE, TOO_DEEP
from .kernels.space import march as crowd
from .kernels.space.forces import DIRECTOR, SINGLE, TURN, VELOCITY, Space, Wall
from .kernels.space.pairs import Pairs, nearest, no_pairs
from .laws import friction_of
from .placement import placed
from .scene import Contact, Scene
from .soft_impact import Rod

SKIN = 0.4  # of the list of pairs, in d
_MOST = 2000  # rods: every two have springs of their own


def axial_gyration_squared(length: float) -> float:
    """Moment of inertia of a uniform spherocylinder about its axis, over its mass.

    Cylinder of length h = l - 1 and two half spheres, diameter 1: volumes pi h/4 and pi/6, moments
    of 1/8 and 1/10 of their masses.
    """
    cylinder, caps = (length - 1) / 4, 1 / 6
    return (cylinder / 8 + caps / 10) / (cylinder + caps)


def _rubbing(contact: Contact | None) -> Friction | None:
    return friction_of(contact.law, contact.friction) if contact else None


def space_of(scene: Scene, per: int) -> Space:
    """All that acts."""
    rod, plate = Rod(scene.rods.length, scene.rods.inertia), scene.contacts.plate
    lightness, pair = 1 / rod.gyration_squared, scene.contacts.rods
    spin = None
    if scene.rods.rolling:
        spin = rod.gyration_squared / axial_gyration_squared(scene.rods.length) - 1
    wall = scene.contacts.wall
    walls = [
        Wall(radius, wall.law.normal, _rubbing(wall))
        for radius in (scene.annulus.inner, scene.annulus.outer)
    ]
    return Space(
        *(rod.half_length, lightness, spin, scene.gravity.z if scene.gravity else None),
        *(plate_motion(scene, per), plate.law.normal if plate else None, _rubbing(plate), *walls),
        Between(pair.law.normal, _rubbing(pair)) if pair else None,
    )


@dataclass
class Ring(Marching):
    """A scene in an annulus under way; as `md.host.Engine`."""

    scene: Scene
    world: Space
    rods: np.ndarray
    before: np.ndarray
    springs: np.ndarray | None
    pair_springs: np.ndarray | None
    pairs: Pairs | None
    total: np.ndarray
    dt: float
    per: int
    step: int = 0
    ledger: None = None  # energy is not accounted for
    record: None = None  # touches of the plate are counted, not kept one by one

    @property
    def plate(self) -> Motion | None:
        """One period of the plate; None at rest."""
        return self.world.plate

    def _march(self, steps: int, samples: crowd.Samples | None) -> tuple[int, int, int]:
        """One call of the kernel: steps made, why it ended, where."""
        return crowd.march(
            *(self.world, self.rods, self.before, self.springs, self.pair_springs, self.pairs),
            *(SKIN, self.total, samples, self.step, steps, self.dt),
        )

    def _stop(self, why: int, where: int) -> None:
        """Raise what ended the run before its time."""
        at = f"at t = {self.step / self.per:.6g} periods (step {self.step} of {self.dt:g})"
        state, half = self.rods.copy(), self.world.half_length
        if why == TOO_FAST:
            speed = np.linalg.norm(state[:, VELOCITY:TURN], axis=1)
            where = np.argmax(speed + half * np.linalg.norm(state[:, TURN:], axis=1))
            raise RunError(f"rod {where}: moved more than {DEEP / 2} d in a step {at}", state)
        if why == PAIR_TOO_DEEP:
            i, j, _ = self.pairs.index[where]
            x, a, b = state[i, :3] - state[j, :3], state[i, 3:6], state[j, 3:6]
            deep = 1 - nearest(*(tuple(v.tolist()) for v in (x, a, b)), half)
            raise RunError(f"rods {i} and {j}: overlap {deep:.3g} d with each other {at}", state)
        what = {
            NOT_FINITE: "its state is not finite",
            TOO_DEEP: f"more than {DEEP} d deep in the plate",
            crowd.WALL_TOO_DEEP: f"more than {DEEP} d deep in a wall",
        }
        raise RunError(f"rod {where}: {what[why]} {at}", state)

    def arrays(self) -> dict[str, np.ndarray]:
        """All that changes as the run goes on, by name."""
        names = "rods", "before", "springs", "pair_springs"
        found: dict[str, Any] = {name: getattr(self, name) for name in names}
        if self.pairs is not None:
            found |= {f"pairs.{key}": value for key, value in self.pairs._asdict().items()}
        return {name: value for name, value in found.items() if value is not None}

    def restore(self, arrays: dict[str, np.ndarray], step: int) -> None:
        """Go on from the arrays of another run of the same scene."""
        self.step = step
        for name, value in self.arrays().items():
            value[...] = arrays[name]

    def tables(self, periods: int) -> "RingTables":
        """For what is measured."""
        return RingTables(self, periods)


class RingTables:
    """Samples of each period; as `md.measures.Tables`."""

    def __init__(self, engine: Ring, periods: int):
        self.periods, self.per, self.speed = periods, engine.per, engine.scene.plate_speed or 1.0
        self.middle = engine.scene.annulus.middle
        self.series = np.zeros((periods + 1, crowd.SERIES))
        self.azimuth = np.arctan2(engine.rods[:, 1], engine.rods[:, 0])
        self.resting = np.zeros(len(engine.rods), np.int8)

    def sampled(self, engine: Ring) -> crowd.Samples:
        """What the kernel adds to."""
        every = max(engine.per // SAMPLES, 1)
        return crowd.Samples(self.series, self.azimuth, self.resting, engine.per, every)

    def arrays(self, periods: int) -> dict[str, np.ndarray]:
        """All that a checkpoint needs, by name."""
        parts = {"azimuth": self.azimuth, "resting": self.resting}
        return {"series": self.series[: periods + 1], **parts}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Take them out again."""
        for name in ("series", "azimuth", "resting"):
            part = arrays.pop(name)
            getattr(self, name)[: len(part)] = part

    def drift(self, engine: Ring, periods: int) -> np.ndarray:
        """Mean velocity around the annulus, at its middle radius, of each period made."""
        return self.series[:periods, crowd.ADVANCE] * self.middle / (engine.dt * engine.per)

    def tilt_deg(self, periods: int) -> np.ndarray:
        """Mean tilt of each period made."""
        part = self.series[:periods]
        return np.degrees(part[:, crowd.TILTS] / part[:, crowd.SAMPLES])

    @staticmethod
    def error(series: np.ndarray) -> float:
        """Unknown from one run: the rods keep their arrangement, another one at each start."""
        return nan

    def results(self, engine: Ring, first: int, periods: int) -> dict[str, Any]:
        """What a `Result` tells of the periods behind the transient but for drift and tilt."""
        part = self.series[first:periods].sum(axis=0)
        touches, n = part[crowd.TOUCHES], engine.scene.rods.count * (periods - first)
        found = {
            "plate_velocity": (part[crowd.PLATE_SUM] / self.speed, touches),
            "plate_velocity_by_speed": (part[crowd.PUSHING] / self.speed, part[crowd.APPROACH]),
            "lean_deg": (np.degrees(part[crowd.LEANS]), part[crowd.SAMPLES]),
            "per_rod_and_period": (touches, n),
        }
        seen = {
            name: {"mean": float(top / base) if base > 0 else nan, "stderr": nan}
            for name, (top, base) in found.items()
        }
        return {
            "landings": seen if periods else None,
            "merged": None,
            "turned": {},
            "phases": [],
        }


def prepare(scene: Scene) -> Ring:
    """All that a run of the scene needs, at its start.

    Raises
    ------
    ValueError
        If the rods do not fit into the annulus, or the step is not stable.
    """
    n = scene.rods.count
    if n > _MOST:
        raise InputError(f"rods.count must be at most {_MOST} in an annulus, got {n}")
    dt, per = step_of(scene)
    world = space_of(scene, per)
    tilt = None if scene.start.tilt_deg is None else abs(scene.tilt)
    rods = np.zeros((n, crowd.COLUMNS))
    rods[:, :6] = placed(scene.annulus, n, scene.rods.length, tilt=tilt, seed=scene.start.seed)
    if scene.start.tilt_deg is not None and scene.tilt < 0:
        rods[:, DIRECTOR : DIRECTOR + 2] *= -1
    lowest = world.plate.height[0] if world.plate else 0.0
    rods[:, 2] += lowest + scene.start.drop
    random = np.random.default_rng(scene.start.seed)
    rods[:, VELOCITY : VELOCITY + 3] = scene.start.speed * random.uniform(-1, 1, (n, 3))
    rubs = world.friction or world.inner.friction
    pairs = world.between is not None
    return Ring(
        *(scene, world, rods, np.zeros((n, 6))),
        np.zeros((n, SINGLE, 3)) if rubs else None,
        np.zeros((n * (n - 1) // 2, 5, 3)) if pairs and world.between.friction else None,
        no_pairs(n) if pairs else None,
        *(np.zeros((n, 6)), dt, per),
    )
