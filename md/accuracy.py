"""Runs to a tolerance: step and length follow from the error that the drift may have.

The error has two parts. The statistical one is estimated as the run goes on, which ends as soon as
it is small enough. The bias of the step comes from a calibration (`calibration.py`): for scenes
that span a range, the drift at long steps against that at a short one. It is bounded by

    |bias| <= scale (10/n)^order |c_x|,    n steps per contact at twice the plate's peak velocity,

with the largest scale of all scenes. Of a tolerance r, the step gets r/(1 + 2 order), which makes
the run cheapest where the number of periods goes as 1/(r - bias)^2 and their price as n.
"""

import json
from dataclasses import dataclass, replace
from functools import cache
from math import inf, isfinite, nan
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from scipy.special import stdtrit

from . import simulation
from .domains import number
from .errors import InputError
from .laws import contact_time
from .scene import Scene, Step
from .simulation import Accuracy, Result
from .sources import digest
from .statistics import transient

CALIBRATION = Path(__file__).with_name("calibration.json")
DOMAINS = {
    "tolerance": (1e-5, 0.5),
    "confidence": (0.5, 0.999),
    "floor": (1e-12, 1e12),
    "max_seconds": (1e-3, 1e9),
}
CONFIDENCE = 0.95
FLOOR = 0.05  # of the plate's peak velocity: slower drifts are judged as if they were this fast
MAX_SECONDS = 600.0
LONGEST = 10**6  # periods of a run
FIRST_LOOK = 128  # periods
GROWTH = 1.1, 2.0  # least and largest, of the run from one look to the next
PARTS = 8, 16, 32  # of the run: the widest of three intervals counts
_SAID = {"bias unknown": "statistically reached, bias unknown", "not reached": "NOT REACHED"}


@cache
def calibrated() -> dict[str, Any]:
    """Calibration in use: order, scale, ranges of what was varied, laws, `code` of its sources."""
    return json.loads(CALIBRATION.read_text(encoding="utf-8"))


def steps_per_contact(scene: Scene, dt: float) -> float:
    """Steps in the shortest contact at twice the plate's peak velocity."""
    found = [c for c in (scene.contacts.plate, scene.contacts.rods) if c is not None]
    return min(contact_time(c.law, 2 * scene.plate_speed) for c in found) / dt


def described(scene: Scene) -> dict[str, list]:
    """Values of all that the bias of a step may depend on in a scene."""
    pair = scene.contacts.plate, scene.contacts.rods
    both = [contact for contact in pair if contact is not None]
    springs = [(c.law.spring, c.law.normal.stiffness) for c in both]
    return {
        "plate.acceleration": [scene.plate.acceleration if scene.plate else 0.0],
        "tilt_deg": [abs(float(np.degrees(scene.tilt)))],
        "rods.length": [scene.rods.length],
        "friction": [contact.friction for contact in both],
        "restitution": [c.law.restitution for c in both if c.law.restitution is not None],
        "tangential_ratio": [s.root / k for s, k in springs if s and s.root is not None],
        "contact time in periods": [steps_per_contact(scene, 1 / scene.frequency)],
        "laws": ["/".join(contact.law.name if contact else "none" for contact in pair)],
    }


def outside(scene: Scene) -> tuple[str, ...]:
    """Properties of a scene that lie outside of the calibration, in words."""
    known, values = calibrated(), described(scene)
    (laws,) = values.pop("laws")
    found = []
    if scene.gravity is None or (scene.gravity.x, scene.gravity.z) != (0.0, -1.0):
        found.append("gravity is not 1, downwards")
    for name, (low, high) in known["ranges"].items():
        for one in values[name]:
            if not low * (1 - 1e-9) <= one <= high * (1 + 1e-9):
                found.append(f"{name} {one:.4g} is outside of {low:.4g} to {high:.4g}")
    if laws not in known["laws"]:
        found.append(f"laws {laws} were not calibrated ({', '.join(known['laws'])})")
    return tuple(dict.fromkeys(found))


def unknown_bias(scene: Scene) -> tuple[str, ...]:
    """Reasons why the bias of the step is unknown, in words; none where the calibration holds."""
    made_with = calibrated()["code"]
    if made_with == digest():
        return outside(scene)
    return *outside(scene), f"calibrated for other sources ({made_with}, these are {digest()})"


def chosen_step(scene: Scene, tolerance: float) -> tuple[Scene, float]:
    """The scene with the cheapest step for a tolerance, and the bound of its relative bias.

    Outside of the calibration the scene gets the step that `md.run` takes if none is named, and
    the bound is nan.

    Raises
    ------
    ValueError
        If nothing vibrates, no plate is touched, or rods stand in an annulus.
    """
    if not isinstance(scene, Scene):
        raise InputError(f"scene must be a md.Scene, as md.load gives, got {scene!r}")
    if scene.annulus is not None:
        raise InputError(
            "tolerance has no meaning in an annulus: rods keep the arrangement of their start, so "
            "that one run cannot tell its error; use periods, and several start.seed"
        )
    if not scene.vibrates or scene.contacts.plate is None:
        raise InputError("tolerance needs a plate that vibrates and a contact with it")
    if outside(scene):
        return replace(scene, step=Step()), nan
    known = calibrated()
    order, scale = known["order"], known["scale"]
    share = tolerance / (1 + 2 * order)
    n = max(10 * (scale / share) ** (1 / order), known["fewest"])
    step = Step(steps_per_contact(scene, 1.0) / n, coarse=True)
    return replace(scene, step=step), scale * (10 / n) ** order


def interval(drift: np.ndarray, confidence: float = CONFIDENCE) -> tuple[float, float, int]:
    """Mean of a stationary series after its transient, half of its interval, the transient.

    The run is judged several times as it goes on, so the interval is a wide one: the series is cut
    into 8, 16 and 32 parts, whose means give three intervals by Student's t; the widest counts.
    """
    cut = transient(len(drift))
    rest, half = drift[cut:], 0.0
    for parts in PARTS:
        if len(rest) < parts:
            return float(rest.mean()) if len(rest) else nan, inf, cut
        means = rest[len(rest) % parts :].reshape(parts, -1).mean(axis=1)
        error = means.std(ddof=1) / np.sqrt(parts)
        half = max(half, float(stdtrit(parts - 1, (1 + confidence) / 2) * error))
    return float(rest.mean()), half, cut


@dataclass
class _Goal:
    """Goal of a run: looks at the drift now and then, until it is accurate enough."""

    tolerance: float
    confidence: float
    floor: float
    bias: float  # relative; 0 where it is unknown
    max_seconds: float
    began: float = nan  # by the clock
    mean: float = nan
    half: float = inf  # of the interval
    reached: bool = False
    needed: float = nan  # seconds in all

    @property
    def size(self) -> float:
        """Velocity that errors are relative to."""
        return max(abs(self.mean), self.floor)

    def __call__(self, drift: np.ndarray) -> int:
        """Periods to make in all, given the drift of each one made so far."""
        made = len(drift)
        if not made:
            self.began = perf_counter()
            return FIRST_LOOK
        seconds = perf_counter() - self.began
        self.mean, self.half, cut = interval(drift, self.confidence)
        if made < FIRST_LOOK:  # ended by Ctrl-C: too short to be judged
            self.half = inf
        room = (self.tolerance - self.bias) * self.size
        self.reached = self.half <= room
        wanted = cut + (made - cut) * (self.half / room) ** 2
        self.needed = seconds * wanted / made
        affordable = made * self.max_seconds / seconds
        hopeless = self.needed > 2 * self.max_seconds and made >= 2 * FIRST_LOOK
        if self.reached or hopeless or affordable < GROWTH[0] * made:
            return made
        grown = np.clip(wanted, GROWTH[0] * made, GROWTH[1] * made) + 1
        return int(min(grown, affordable, LONGEST))


def run(
    scene: Scene,
    *,
    tolerance: float | None = None,
    confidence: float = CONFIDENCE,
    floor: float | None = None,
    max_seconds: float = MAX_SECONDS,
    **options: Any,
) -> Result:
    """Run a scene and measure it: for a number of periods, or until its drift is accurate.

    Parameters
    ----------
    scene : Scene
    tolerance : total error of the drift over its size, 1e-5 to 0.5; the step and the length of the
        run follow (128 periods at least), the scene's own step is not used; not in an annulus.
        None: `periods` are made, at the scene's step
    confidence : with which the interval holds the long-run drift, 0.5 to 0.999
    floor : drifts below it, in sqrt(g d), are judged as if they were this fast (default: a
        twentieth of the plate's peak velocity)
    max_seconds : of the run, without compiling; where it will take more than twice as long, it
        ends early, with `accuracy.state` "not reached"
    options : as of `simulation.run`: `periods` (200; without tolerance alone), `ledger`, `observe`,
        `trajectory`, `frames`, `checkpoint`, `progress`

    Returns
    -------
    Result; its `accuracy` is None without a tolerance

    Raises
    ------
    ValueError
        As `simulation.run`, if no plate vibrates, or an argument is out of its domain.
    RunError
        As `simulation.run`.
    """
    if tolerance is None:
        return simulation.run(scene, **options)
    own = {"confidence": confidence, "floor": floor, "max_seconds": max_seconds}
    checked(tolerance=tolerance, periods=options.get("periods"), **own)
    chosen, bias = chosen_step(scene, tolerance)
    floor = FLOOR * scene.plate_speed if floor is None else floor
    goal = _Goal(tolerance, confidence, floor, bias if isfinite(bias) else 0.0, max_seconds)
    result = simulation.run(chosen, **{**options, "periods": LONGEST}, goal=goal)
    goal(result.c_x_series)  # where Ctrl-C ended it
    return replace(result, accuracy=_accuracy(goal, scene, result, bias))


def checked(*, periods: int | None = None, **options: float | None) -> None:
    """Hold the options of a tolerance to their domains."""
    if periods is not None:
        raise InputError("periods has no meaning with tolerance, which chooses the length")
    if "tolerance" not in options:
        raise InputError(f"{next(iter(options))} has no meaning without tolerance")
    for name, value in options.items():
        if value is not None:
            number(name, value, *DOMAINS[name])


def _accuracy(goal: _Goal, scene: Scene, result: Result, bias: float) -> Accuracy:
    finer, rest = chosen_step(scene, goal.tolerance / 10)
    room = goal.tolerance / 10 - (rest if isfinite(bias) else 0.0)
    dearer = result.dt / (finer.step.size or result.dt)  # outside of the calibration, no dearer
    length = (goal.half / (room * goal.size)) ** 2
    reasons = unknown_bias(scene)
    bias = nan if reasons else bias
    return Accuracy(
        tolerance=goal.tolerance,
        confidence=goal.confidence,
        floor=goal.floor,
        error=goal.half + bias * goal.size,
        statistical=goal.half,
        bias=bias * goal.size,
        per_contact=steps_per_contact(scene, result.dt),
        outside=reasons,
        state="not reached" if not goal.reached else "bias unknown" if reasons else "reached",
        seconds=result.run_seconds,
        needed_seconds=goal.needed,
        next_digit_seconds=result.run_seconds * length * dearer,
    )


def in_words(result: Result) -> list[str]:
    """Lines on step and error of a run with a tolerance, and on the price of the next digit."""
    a, unit = result.accuracy, result.scene.cm_per_s
    if a is None:
        return []
    size = max(abs(result.c_x), a.floor)
    of = "c_x" if abs(result.c_x) >= a.floor else f"the floor {a.floor:.3g} sqrt(g d)"
    error = a.statistical if a.outside else a.error
    verdict = f"accuracy     {_SAID.get(a.state, a.state)}"
    if not isfinite(error):
        return [f"{verdict}: ended before {FIRST_LOOK} periods, error unknown"]
    apart, bias = "", f": bias at most {a.bias / size:.2g}, by calibration; the other "
    bias += f"{a.statistical / size:.2g} of the error are statistical"
    if a.outside:
        apart, bias = ", bias of the step apart", f"; its bias is unknown: {'; '.join(a.outside)}"
    lines = [
        f"{verdict}: {a.tolerance:.3g} of {of} asked for; c_x is within {error:.2g} sqrt(g d) = "
        f"{error * unit:.2g} cm/s, {error / size:.2g} of it, at {a.confidence:.4g} confidence"
        + apart,
        f"step         dt = {result.dt:.3g}, {a.per_contact:.3g} steps a contact{bias}",
    ]
    if a.state == "not reached":
        lines.append(f"             this would take about {a.needed_seconds:.3g} s of run")
    if error / size > a.tolerance / 10:
        lines.append(
            f"next digit   {a.tolerance / 10:.3g} would take about {a.next_digit_seconds:.3g} s"
        )
    return lines
