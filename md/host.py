"""From a scene to what the kernels take: constants, arrays, and no array that no effect needs."""

from dataclasses import dataclass
from math import ceil, cos, hypot, pi, sin
from time import perf_counter
from typing import Any

import numpy as np

from .errors import InputError, RunError
from .kernels import plane as row
from .kernels.contact import Effects, Motion
from .kernels.neighbours import Listed, apart, meetings, nothing_listed, places
from .kernels.single import DEEP, DONE, NOT_FINITE, TOO_DEEP
from .kernels.touches import Record, new_record
from .laws import Law, contact_time, deepest_overlap, friction_of, largest_step
from .scene import Contact, Scene
from .soft_impact import Rod

SKIN = 0.4  # of the list of pairs, in d
_MOST = 10**7  # steps of a period
SAMPLES = 32  # of the tilt, in a period
CALL_SECONDS = 0.02  # of a call of the kernel: so long may a signal wait
_MOST_A_CALL = 500_000  # steps times rods; a flight says little about the contact behind it


def _law_step(
    name: str, contact: Contact, speed: float, along: float, across: float, caps: int, coarse: bool
) -> tuple[float, float]:
    """Largest stable step and contact time of a contact at this speed; see `laws.largest_step`."""
    deepest = deepest_overlap(contact.law, speed)
    if not deepest < DEEP / 2:
        raise InputError(
            f"{name}.stiffness {contact.law.normal.stiffness:g} is too soft for impacts at "
            f"{speed:.3g}: overlap {deepest:.2g} d"
        )
    friction = contact.friction > 0 and not coarse
    largest = largest_step(contact.law, friction, speed, along, across, "verlet", caps)
    return largest, contact_time(contact.law, speed)


def step_of(scene: Scene) -> tuple[float, int]:
    """Step and steps a period: the step asked for, or a good one, as a whole part of the period.

    Raises
    ------
    ValueError
        If the step is not stable, or a contact too soft.
    """
    rod = Rod(scene.rods.length, scene.rods.inertia)
    light, half, speed = 1 / rod.gyration_squared, rod.half_length, scene.impact_speed
    coarse, found = scene.step.coarse, []
    for name in ("plate", "wall"):
        if contact := getattr(scene.contacts, name):
            found.append(
                _law_step(
                    *(f"contacts.{name}", contact, speed),
                    *((half + 0.5) ** 2 * light, half**2 * light, 2 if half > 0 else 1, coarse),
                )
            )
    if scene.contacts.rods:
        # Across, a rod of a row turns or shifts against both neighbours, each at one end or two.
        found.append(
            _law_step(
                *("contacts.rods", scene.contacts.rods, speed),
                1 + 2 * (half + 0.5) ** 2 * light,
                *((8 if half > 0 else 4) * max(1.0, half**2 * light) - 1, 1, coarse),
            )
        )
    largest = min((limit for limit, _ in found), default=np.inf)
    whole = min((time for _, time in found), default=0.05)
    dt = scene.step.size or min(whole / 50, largest / 2)
    if dt > largest:
        raise InputError(
            f"step.size must be at most {0.995 * largest:.3g} sqrt(d/g), 1/{whole / largest:.1f} "
            f"of the contact time {whole:.3g}, to be stable; got {dt!r}"
            + ("" if coarse else " (step.coarse allows more)")
        )
    per = ceil(1 / (scene.frequency * dt) - 1e-9)
    if per > _MOST:
        raise InputError(
            f"step.size must be at least {1 / (scene.frequency * _MOST):.2g} sqrt(d/g), got {dt!r}"
        )
    return 1 / (scene.frequency * per), per


def plate_motion(scene: Scene, per: int) -> Motion | None:
    """One period of the plate, from its lowest place; None at rest."""
    if not scene.vibrates:
        return None
    angle = 2 * pi * np.arange(per) / per
    amplitude = scene.plate_speed / (2 * pi * scene.frequency)
    return Motion(-amplitude * np.cos(angle), scene.plate_speed * np.sin(angle))


def _effects(scene: Scene, per: int) -> Effects:
    rod, contact, gravity = Rod(scene.rods.length, scene.rods.inertia), scene.contacts.plate, None
    if scene.gravity is not None:
        gravity = scene.gravity.x, scene.gravity.z
    return Effects(
        *(rod.half_length, 1 / rod.gyration_squared),
        contact.law.normal if contact else None,
        friction_of(contact.law, contact.friction) if contact else None,
        *(gravity, plate_motion(scene, per), True if rod.half_length > 0 else None),
    )


def _row_of_rods(scene: Scene, lowest: float) -> np.ndarray:
    """Rods side by side, alike in tilt, their lower caps `drop` over the plate."""
    n, tilt = scene.rods.count, scene.tilt
    half = (scene.rods.length - 1) / 2
    touching = min(1 / max(cos(tilt), 1e-9), 2 * half * abs(sin(tilt)) + 1)
    spacing = scene.box.length / n if scene.box else touching
    random = np.random.default_rng(scene.start.seed)
    rods = np.zeros((n, row.COLUMNS))
    rods[:, 0] = (np.arange(n) + 0.5) * spacing
    rods[:, 1] = lowest + 0.5 + half * abs(cos(tilt)) + scene.start.drop
    rods[:, 2:4] = sin(tilt), cos(tilt)
    rods[:, 4:6] = scene.start.speed * random.uniform(-1, 1, (n, 2))
    return rods


def _springs(law: Law | None, friction: float) -> bool:
    return law is not None and law.spring is not None and friction > 0


class Marching:
    """Steps in calls of the kernel of about `CALL_SECONDS`; signals are seen between calls."""

    pace = 1  # steps of a call

    def go(self, steps: int, series: Any = None) -> int:
        """Up to `steps` steps, fewer if the record is full; steps made.

        Raises
        ------
        RunError
            If the state stops being finite or a contact is deeper than d/2.
        """
        made = 0
        while True:
            begin = perf_counter()
            done, why, where = self._march(min(self.pace, steps - made), series)
            seconds = perf_counter() - begin
            if done:
                most = min(4 * self.pace, _MOST_A_CALL // len(self.rods))
                self.pace = max(min(int(done * CALL_SECONDS / max(seconds, 1e-9)), most), 1)
            self.step += done
            made += done
            if why == row.FULL_LIST:
                self._grow()
            elif why not in (DONE, row.FULL_RECORD):
                self._stop(why, where)
            elif why == row.FULL_RECORD or made == steps:
                return made


@dataclass
class Engine(Marching):
    """A scene under way; `None` for what it does without."""

    scene: Scene
    crowd: row.Crowd
    rods: np.ndarray
    before: np.ndarray  # accelerations of the last step
    springs: np.ndarray | None
    listed: Listed | None
    scratch: tuple[np.ndarray, np.ndarray] | None
    total: np.ndarray
    ledger: np.ndarray | None
    record: Record | None
    dt: float
    per: int
    step: int = 0

    @property
    def plate(self) -> Motion | None:
        """One period of the plate; None at rest."""
        return self.crowd.alone.plate

    def tables(self, periods: int):
        """For what is measured."""
        from .measures import Tables  # which needs this module

        return Tables(self, periods)

    def _march(self, steps: int, series: row.Series | None) -> tuple[int, int, int]:
        """One call of the kernel: steps made, why it ended, where."""
        finite = np.isfinite(self.rods).all(axis=1)
        if not finite.all():
            return 0, NOT_FINITE, int(np.argmin(finite))
        return row.march(
            *(self.crowd, self.rods, self.before, self.springs, self.listed, self.scratch),
            self.total,
            *(self.ledger, self.record, series, self.step, steps, self.dt),
        )

    def _grow(self) -> None:
        """A list of pairs twice as long."""

        def doubled(array):
            return (
                np.concatenate([array, np.zeros_like(array)], axis=1) if array is not None else None
            )

        listed = self.listed
        self.listed = listed._replace(
            index=doubled(listed.index),
            springs=doubled(listed.springs),
            losses=doubled(listed.losses),
        )
        place, found = self.scratch
        self.scratch = place, np.zeros((2 * len(found), 3), np.int64)

    def _stop(self, why: int, where: int) -> None:
        """Raise what ended the run before its time."""
        at = f"at t = {self.step / self.per:.6g} periods (step {self.step} of {self.dt:g})"
        state = self.rods.copy()
        if why == NOT_FINITE:
            raise RunError(f"rod {where}: its state is not finite {at}", state)
        if why == row.TOO_FAST:
            half, speed = self.crowd.alone.half_length, np.abs(state[:, 4:])
            where = np.argmax(speed @ (1, 1, half))
            raise RunError(f"rod {where}: moved more than {DEEP / 2} d in a step {at}", state)
        if why == TOO_DEEP:
            height = (
                self.crowd.alone.plate.height[self.step % self.per] if self.scene.vibrates else 0
            )
            z, cosine = state[where, 1], state[where, 3]
            deep = height + 0.5 - z + self.crowd.alone.half_length * abs(cosine)
            raise RunError(f"rod {where}: overlap {deep:.3g} d with the plate {at}", state)
        now = self.listed.turn[0]
        i, j, image, _ = self.listed.index[now, where]
        deep = max(self.overlaps(state, i, j, image))
        raise RunError(f"rods {i} and {j}: overlap {deep:.3g} d with each other {at}", state)

    def overlaps(self, rods: np.ndarray, i: int, j: int, image: int) -> list[float]:
        """Of the ends of a pair."""
        dx = rods[i, 0] - rods[j, 0] - image * (self.crowd.period or 0.0)
        dz, half = rods[i, 1] - rods[j, 1], self.crowd.alone.half_length
        a, b = tuple(rods[i, 2:4]), tuple(rods[j, 2:4])
        ends = (places(dx, dz, a, b, half, end) for end in range(meetings(self.crowd.alone.upper)))
        return [1 - hypot(*apart(dx, dz, a, b, s, t)) for s, t in ends]

    def energy(self) -> float:
        """Kinetic, potential and elastic energy half a step ago, in m g d."""
        effects, rods = self.crowd.alone, self.rods.copy()
        velocity = rods[:, 4:]
        angle = np.arctan2(rods[:, 2], rods[:, 3]) - velocity[:, 2] * self.dt / 2
        rods[:, :2] -= velocity[:, :2] * self.dt / 2
        rods[:, 2], rods[:, 3] = np.sin(angle), np.cos(angle)
        total = (velocity[:, :2] ** 2).sum() / 2 + (
            velocity[:, 2] ** 2
        ).sum() / effects.lightness / 2
        if effects.gravity:
            total -= effects.gravity[0] * rods[:, 0].sum() + effects.gravity[1] * rods[:, 1].sum()
        if effects.normal:
            height = 0.0
            if effects.plate:
                before, now = (effects.plate.height[(self.step + s) % self.per] for s in (-1, 0))
                height = (before + now) / 2
            for cap in (-1, 1) if effects.upper else (-1,):
                deep = height + 0.5 - rods[:, 1] - cap * effects.half_length * rods[:, 3]
                total += 0.4 * effects.normal.stiffness * (np.maximum(deep, 0) ** 2.5).sum()
        if self.listed:
            now, stiffness = self.listed.turn[0], self.crowd.between.normal.stiffness
            for i, j, image, _ in self.listed.index[now, : self.listed.start[now, -1]]:
                deep = np.maximum(self.overlaps(rods, i, j, image), 0)
                total += 0.4 * stiffness * (deep**2.5).sum()
        return float(total)

    def arrays(self) -> dict[str, np.ndarray]:
        """All that changes as the run goes on, by name."""
        names = "rods", "before", "springs", "ledger"
        found: dict[str, Any] = {name: getattr(self, name) for name in names}
        for name, group in (("listed", self.listed), ("record", self.record)):
            if group is not None:
                found |= {f"{name}.{key}": value for key, value in group._asdict().items()}
        return {name: value for name, value in found.items() if value is not None}

    def restore(self, arrays: dict[str, np.ndarray], step: int) -> None:
        """Go on from the arrays of another run of the same scene."""
        self.step = step
        while self.listed is not None and arrays["listed.index"].shape != self.listed.index.shape:
            self._grow()
        for name, value in self.arrays().items():
            value[...] = arrays[name]


def prepare(scene: Scene, *, ledger: bool = True, landings: bool = True) -> Engine:
    """All that a run of the scene needs, at its start; a `space.engine.Ring` in an annulus.

    Parameters
    ----------
    scene : Scene
    ledger : whether to account for the energy
    landings : whether to record the landings
    """
    if scene.annulus is not None:
        from . import annulus_host as space  # which takes parts of this module

        return space.prepare(scene)
    dt, per = step_of(scene)
    effects, n, between = _effects(scene, per), scene.rods.count, None
    lowest = effects.plate.height[0] if effects.plate else 0.0
    pair, plate = scene.contacts.rods, scene.contacts.plate
    listed = scratch = None
    if pair is not None:
        between = row.Between(pair.law.normal, friction_of(pair.law, pair.friction))
        capacity = 8 * n + 56
        listed = nothing_listed(n, capacity, between.friction is not None, ledger)
        scratch = np.zeros(n), np.zeros((capacity, 3), np.int64)
    box = scene.box.length if scene.box and pair is not None else None
    return Engine(
        scene,
        row.Crowd(effects, between, box, SKIN if pair is not None else None),
        _row_of_rods(scene, lowest),
        np.zeros((n, 3)),
        np.zeros((n, 2)) if plate and _springs(plate.law, plate.friction) else None,
        *(listed, scratch, np.zeros((n, 3))),
        np.zeros(5) if ledger else None,
        new_record(n, 4096) if landings and plate is not None else None,
        *(dt, per),
    )
