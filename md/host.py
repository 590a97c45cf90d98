"""Simulation of a scene: effects and arrays for the kernels, and the calls that advance it.

Arrays are allocated only for the effects that the scene has.
"""

from dataclasses import dataclass
from math import ceil, cos, pi, sin
from time import perf_counter
from typing import Any

import numpy as np

from .domains import InputError, RunError, as_dict, flat
from .kernels import (
    ANNULUS_LEDGER,
    ANNULUS_SERIES,
    C_X,
    C_Z,
    COSINE,
    DEEP,
    DIRECTOR,
    DONE,
    FULL_LIST,
    FULL_RECORD,
    LEDGER_COLUMNS,
    NOT_FINITE,
    PAIR_TOO_DEEP,
    PLACE,
    ROW_COLUMNS,
    ROW_SERIES,
    SAMPLES_A_PERIOD,
    SINE,
    SLOTS,
    SPACE_COLUMNS,
    TOO_DEEP,
    TOO_FAST,
    TURN,
    VELOCITY,
    WALL_TOO_DEEP,
    X,
    Z,
)
from .kernels.batch import no_contacts
from .kernels.contact import ContactForces
from .kernels.march import Series, Watchers, energy, march
from .kernels.neighbours import new_memory, nothing_listed
from .kernels.state import Clock, Effects, Motion, Scratch, State, Walls
from .kernels.touches import Record, new_record
from .kernels.vectors import IN_SPACE
from .laws import Rod, contact_time, effects_of, friction_of, largest_step
from .placement import placed
from .scene import GAP, Annulus, Contact, Scene

STEPS_PER_CONTACT = 24  # at twice the plate's peak velocity
UPRIGHT = cos(pi / 10)  # rods over the length of their box, in d, from which on they stand so
_MOST_STEPS = 10**7  # of a period
CALL_SECONDS = 0.02  # duration of a call of the kernel, for which a signal may have to wait
_MOST_A_CALL = 500_000  # steps times rods; a flight says little about the contact behind it


def _rod(scene: Scene) -> Rod:
    return Rod(scene.rods.length, scene.rods.inertia)


def _forces(contact: Contact | None) -> ContactForces | None:
    """Normal force and friction of a contact for the kernels; None without the contact."""
    if contact is None:
        return None
    return ContactForces(contact.law.normal, friction_of(contact.law, contact.friction))


def upright(scene: Scene) -> bool:
    """Whether rods rub on each other that lean less than 18 degrees in their box."""
    box, rods = scene.box, scene.contacts.rods
    return bool(box and rods and rods.friction and scene.rods.count > UPRIGHT * box.length)


def stable_step(scene: Scene) -> tuple[float, float]:
    """Longest stable step of a scene and duration of its shortest contact, in sqrt(d/g).

    Raises
    ------
    ValueError
        If a contact is too soft.
    """
    rod, speed = _rod(scene), scene.impact_speed
    light, half = 1 / rod.gyration_squared, rod.half_length
    along = (half + 0.5) ** 2 * light
    across = half**2 * light
    caps = 2 if half > 0 else 1
    # A rod turns or shifts against both neighbours, which it touches at one end or two.
    pressed = 2 * caps
    between = 1 + 2 * along, 2 * pressed * max(1.0, across) - 1, 1
    if scene.annulus is not None:  # there they also rub as it leans across the row, and rolls
        rolls = 0.25 / rod.axial_gyration_squared if scene.rods.rolling else 0.0
        between = 1 + 2 * max(along, across + rolls), pressed * max(1.0, across), pressed
    near = {
        "plate": (along, across, caps, None, None),
        "wall": (along, across, caps, caps, None),
        "rods": (*between, pressed, 0.0 if upright(scene) else 0.9),  # 0: they stick in time
    }
    limits, times = [], []
    for name, contact in vars(scene.contacts).items():
        if contact is not None:
            rubs, key = contact.friction > 0 and not scene.step.coarse, f"contacts.{name}."
            limits.append(largest_step(contact.law, rubs, speed, *near[name], key=key))
            times.append(contact_time(contact.law, speed))
    return min(limits, default=np.inf), min(times, default=0.05)


def step_of(scene: Scene) -> tuple[float, int]:
    """Step in sqrt(d/g), asked for or chosen, as a whole part of a period; and steps per period.

    Raises
    ------
    ValueError
        If the step is not stable, or a contact too soft.
    """
    largest, whole = stable_step(scene)
    dt = scene.step.size or min(whole / STEPS_PER_CONTACT, 0.9 * largest)
    if dt > largest:
        raise InputError(
            f"step.size must be at most {0.995 * largest:.3g} sqrt(d/g), {largest / whole:.2g} "
            f"of the contact time {whole:.3g}, to be stable; got {dt!r}"
            + ("" if scene.step.coarse else " (step.coarse allows more)")
        )
    if dt < (least := 1 / (scene.frequency * _MOST_STEPS)):
        asked = "the step that stiffness and plate.frequency_hz ask for"
        what = "step.size" if scene.step.size else asked
        raise InputError(f"{what} must be at least {least:.2g} sqrt(d/g), got {dt!r}")
    per = ceil(1 / (scene.frequency * dt) - 1e-9)
    return 1 / (scene.frequency * per), per


def plate_motion(scene: Scene, per: int) -> Motion | None:
    """Motion of the plate over one period, from its lowest place; None if it is at rest."""
    if not scene.vibrates:
        return None
    angle = 2 * pi * np.arange(per) / per
    amplitude = scene.plate_speed / (2 * pi * scene.frequency)
    return Motion(-amplitude * np.cos(angle), scene.plate_speed * np.sin(angle))


@dataclass
class Engine:
    """Simulation of a scene, advanced in calls of a kernel; signals are seen between calls."""

    scene: Scene
    effects: Effects
    state: State
    watchers: Watchers
    plate: Motion | None  # one period of it; None at rest
    dt: float  # sqrt(d/g)
    per: int  # steps of a period
    step: int = 0
    pace: int = 1  # steps of a call of the kernel

    @property
    def rods(self) -> np.ndarray:
        """State of the rods, one row each; columns in `kernels`."""
        return self.state.rods

    @property
    def record(self) -> Record | None:
        """Record of the touches of the plate; None if there is none."""
        return self.watchers.record

    @property
    def ledger(self) -> np.ndarray | None:
        """Work and losses so far, in m g d; columns in `kernels`; None without an account."""
        return self.watchers.ledger

    @property
    def plate_height(self) -> float:
        """Height of the plate at the present step, in d."""
        return float(self.plate.height[self.step % self.per]) if self.plate else 0.0

    def series(self, periods: int) -> Series:
        """Create an empty series for the samples of `periods` periods."""
        place, director, *_ = self._parts(self.rods)
        columns, last = ROW_SERIES, director[:, 1]
        if len(self.effects.up) == 3:
            columns, last = ANNULUS_SERIES, np.arctan2(place[:, 1], place[:, 0])
        every = max(self.per // SAMPLES_A_PERIOD, 1)
        return Series(np.zeros((periods + 1, columns)), last.copy(), self.per, every)

    def go(self, steps: int, series: Any = None) -> int:
        """Make up to `steps` steps, fewer if the record is full; return the number of steps made.

        Raises
        ------
        RunError
            If the state stops being finite or a contact is deeper than d/2.
        """
        made, finite = 0, np.isfinite(self.rods).all(axis=1)
        if not finite.all():
            raise self._stopped(NOT_FINITE, int(np.argmin(finite)))
        while True:
            watchers, clock = self.watchers._replace(series=series), Clock(self.step, self.dt)
            part, begin = min(self.pace, steps - made), perf_counter()
            done, why, where = march(self.effects, self.state, watchers, clock, part)
            if done:
                wanted = done * CALL_SECONDS / max(perf_counter() - begin, 1e-9)
                most = _MOST_A_CALL // len(self.rods)
                self.pace = max(min(int(wanted), 4 * self.pace, most), 1)
            self.step += done
            made += done
            if why == FULL_LIST:
                self.restore(self.arrays(), self.step, room=2)
            elif why not in (DONE, FULL_RECORD):
                raise self._stopped(why, where)
            elif why == FULL_RECORD or made == steps:
                return made

    def _stopped(self, why: int, where: int) -> RunError:
        """Error that says what ended the run early, with a copy of the state."""
        at = f"at t = {self.step / self.per:.6g} periods (step {self.step} of {self.dt:g})"
        state, listed = self.rods.copy(), self.state.listed
        if why == PAIR_TOO_DEEP and listed is not None:
            i, j, *_ = listed.index[where]
            return RunError(f"rods {i} and {j}: more than {DEEP} d deep in each other {at}", state)
        if why == TOO_FAST:  # by upper bounds of the speeds of all points
            _, _, velocity, turn = (np.linalg.norm(part, axis=1) for part in self._parts(state))
            where = int(np.argmax(velocity + self.effects.half_length * turn))
        what = {
            NOT_FINITE: "its state is not finite",
            TOO_DEEP: f"more than {DEEP} d deep in the plate",
            WALL_TOO_DEEP: f"more than {DEEP} d deep in a wall",
            TOO_FAST: f"moved more than {DEEP / 2} d in a step",
        }
        return RunError(f"rod {where}: {what[why]} {at}", state)

    def energy(self) -> float:
        """Kinetic, potential and elastic energy half a step ago, in m g d."""
        height = 0.0  # of the plate then
        if self.plate is not None:
            steps = self.step - 1, self.step
            height = self.plate.height.take(steps, mode="wrap").mean()
        return float(energy(self.effects, self.rods, self.state.listed, height, self.dt))

    def _parts(self, rods: np.ndarray) -> list[np.ndarray]:
        """Places, directors, velocities and turns in an array of rods."""
        dimensions = len(self.effects.up)
        return np.hsplit(rods, [dimensions, 2 * dimensions, 3 * dimensions])

    def arrays(self) -> dict[str, np.ndarray]:
        """Arrays that change as the run goes on, by dotted name; without scratch arrays."""
        return flat(as_dict(self.state) | {"scratch": {}} | as_dict(self.watchers))

    def restore(self, arrays: dict[str, np.ndarray], step: int, room: int = 1) -> None:
        """Take over the arrays and the step of another run of the same scene.

        `room`: factor by which the list of pairs is to be longer than in that run.
        """
        self.step = step
        if self.state.listed is not None:
            pairs = room * len(arrays["listed.index"]) // 2
            self.state = at_start(self.effects, self.rods, pairs)
        for name, value in self.arrays().items():
            there = tuple(map(slice, arrays[name].shape))
            value[there] = arrays[name]


def _rods_in_row(scene: Scene, lowest: float) -> np.ndarray:
    """State of a row at its start: equal tilts, caps over the plate."""
    n, tilt = scene.rods.count, scene.tilt
    half = _rod(scene).half_length
    touching = min(1 / max(cos(tilt), 1e-9), 2 * half * abs(sin(tilt)) + 1)
    spacing = scene.box.length / n if scene.box else touching * (1 + GAP)
    rods = np.zeros((n, ROW_COLUMNS), order="F")
    rods[:, X] = (np.arange(n) + 0.5) * spacing
    rods[:, Z] = lowest + 0.5 + half * abs(cos(tilt)) + GAP + scene.start.drop
    rods[:, SINE : COSINE + 1] = sin(tilt), cos(tilt)
    rods[:, C_X : C_Z + 1] = _velocities(scene, np.tile([1.0, 0.0], (n, 1)))
    return rods


def _rods_in_annulus(scene: Scene, gap: Annulus, lowest: float) -> np.ndarray:
    """State of the rods in an annulus at their start."""
    n, tilt = scene.rods.count, None if scene.start.tilt_deg is None else scene.tilt
    rods = np.zeros((n, SPACE_COLUMNS))
    rods[:, :VELOCITY] = placed(gap, n, scene.rods.length, tilt=tilt, seed=scene.start.seed)
    if scene.tilt < 0:
        rods[:, [PLACE + 1, DIRECTOR + 1]] *= -1  # its mirror image
    rods[:, PLACE + 2] += lowest + GAP + scene.start.drop
    around = np.cross(IN_SPACE, rods[:, PLACE:DIRECTOR])
    around /= np.linalg.norm(around, axis=1, keepdims=True)
    rods[:, VELOCITY:TURN] = _velocities(scene, around)
    return rods


def _velocities(scene: Scene, along: np.ndarray) -> np.ndarray:
    """Random velocities at the start, whose mean along the plate is 0.

    A mean would last: where friction is small, nothing else would be measured. `along`: a unit
    vector for each rod, in the direction in which rods drift.
    """
    velocity = np.random.default_rng(scene.start.seed).uniform(-1, 1, along.shape)
    velocity *= scene.start.speed
    return velocity - (velocity * along).sum(axis=1).mean() * along


def all_effects(scene: Scene, per: int) -> Effects:
    """`Effects` on the rods of a scene, with `per` steps a period."""
    rod, gap, gravity, plate = _rod(scene), scene.annulus, scene.gravity, scene.contacts.plate
    between, wall = map(_forces, (scene.contacts.rods, scene.contacts.wall))
    law, friction = (plate.law, plate.friction) if plate else (None, 0.0)
    pull = (gravity.x, gravity.z) if gravity else None
    period = scene.box.length if scene.box and between else None
    alone = effects_of(rod, law, friction, pull, plate_motion(scene, per))
    effects = alone._replace(between=between, period=period)
    if gap is None:
        return effects
    assert wall is not None
    rolling = rod.gyration_squared / rod.axial_gyration_squared - 1 if scene.rods.rolling else None
    return effects._replace(
        inertia=effects.inertia._replace(rolling=rolling),
        up=IN_SPACE,
        gravity=gravity.z if gravity else None,
        walls=Walls(*wall, gap.inner, gap.outer),
        shaken=gap.shaken or None,
    )


def at_start(effects: Effects, rods: np.ndarray, pairs: int | None = None) -> State:
    """`State` of rods before their first contact.

    `pairs`: of them that a list has room for; None: 8 a rod, and 56.
    """
    n, space, between, walls = len(rods), len(effects.up) == 3, effects.between, effects.walls
    springs = any(rub and rub.spring for rub in (effects.friction, walls and walls.friction))
    slots, part, columns = (SLOTS, 3, 6) if space else (2, 1, 3)
    order: Any = "C" if space else "F"  # the faster order; an array of one rod in a row has both
    listed = place = found = None
    if between is not None:
        pairs = pairs or 8 * n + 56
        listed = nothing_listed(n, pairs, between.friction is not None, space)
        place, found = np.zeros(n), np.zeros((pairs, 3), np.int64)
    batch = no_contacts() if between or walls else None
    return State(
        rods=rods,
        before=np.zeros((n, columns), order=order),
        memory=new_memory(slots * n, part, effects.normal or walls, springs),
        listed=listed,
        scratch=Scratch(np.zeros((n, columns), order=order), np.zeros(n), place, found, batch),
    )


def prepare(scene: Scene, *, ledger: bool = True, touches: bool = True) -> Engine:
    """Create the engine of a scene at its start.

    Parameters
    ----------
    scene : Scene
    ledger : whether to account for the energy
    touches : whether to record the touches of the plate

    Raises
    ------
    ValueError
        If the rods do not fit into the annulus, or the step is not stable.
    """
    dt, per = step_of(scene)
    effects, gap = all_effects(scene, per), scene.annulus
    lowest = effects.plate.height[0] if effects.plate else 0.0
    rods = _rods_in_annulus(scene, gap, lowest) if gap else _rods_in_row(scene, lowest)
    record = new_record(len(rods), 4096 + len(rods)) if touches and effects.normal else None
    columns = ANNULUS_LEDGER if gap else LEDGER_COLUMNS
    watchers = Watchers(np.zeros(columns) if ledger else None, record, None)
    return Engine(scene, effects, at_start(effects, rods), watchers, effects.plate, dt, per)
