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
from scipy.stats import t as student

from . import simulation as runner
from .laws import contact_time, number
from .scene import Scene, Step
from .simulation import Accuracy, Result
from .sources import digest
from .statistics import transient

CALIBRATION = Path(__file__).with_name("calibration.json")
CONFIDENCE = 0.95
FLOOR = 0.05  # of the plate's peak velocity: slower drifts are judged as if they were this fast
MAX_SECONDS = 600.0
_MOST = 10**6  # periods
_FIRST, _LEAST, _LARGEST = 128, 1.1, 2.0  # periods before the first look; growth between looks
_VERDICTS = {
    "reached": "reached",
    "bias unknown": "statistically reached, bias unknown",
    "not reached": "NOT REACHED",
}
_PARTS = 8, 16, 32  # of the run: the widest of three intervals counts


@cache
def calibrated() -> dict[str, Any]:
    """Calibration in use: order, scale, ranges of what was varied, laws, `code` of its sources."""
    return json.loads(CALIBRATION.read_text(encoding="utf-8"))


def steps_per_contact(scene: Scene, dt: float) -> float:
    """Steps in the shortest contact at twice the plate's peak velocity."""
    found = [c for c in (scene.contacts.plate, scene.contacts.rods) if c is not None]
    return min(contact_time(c.law, 2 * scene.plate_speed) for c in found) / dt


def described(scene: Scene) -> dict[str, Any]:
    """Of a scene, what the bias of a step may depend on."""
    plate, rods = scene.contacts.plate, scene.contacts.rods
    both = [contact for contact in (plate, rods) if contact is not None]
    springs = [(c.law.spring, c.law.normal.stiffness) for c in both]
    ratios = [s.root / k for s, k in springs if s is not None and s.root is not None]
    return {
        "plate.acceleration": scene.plate.acceleration if scene.plate else 0.0,
        "tilt_deg": abs(float(np.degrees(scene.tilt))),
        "rods.length": scene.rods.length,
        "friction": [contact.friction for contact in both],
        "restitution": [c.law.restitution for c in both if c.law.restitution is not None],
        "tangential_ratio": ratios,
        "contact time in periods": steps_per_contact(scene, 1 / scene.frequency),
        "laws": "/".join(contact.law.name if contact else "none" for contact in (plate, rods)),
    }


def outside(scene: Scene) -> tuple[str, ...]:
    """What of a scene lies outside of the calibration, in words; nothing where it applies."""
    known, found = calibrated(), []
    if scene.gravity is None or (scene.gravity.x, scene.gravity.z) != (0.0, -1.0):
        found.append("gravity is not 1, downwards")
    for name, value in described(scene).items():
        if name == "laws":
            if value not in known["laws"]:
                found.append(f"laws {value} were not calibrated ({', '.join(known['laws'])})")
            continue
        low, high = known["ranges"][name]
        for one in np.atleast_1d(value).tolist():
            if not low * (1 - 1e-9) <= one <= high * (1 + 1e-9):
                found.append(f"{name} {one:.4g} is outside of {low:.4g} to {high:.4g}")
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
    if scene.annulus is not None:
        raise ValueError(
            "tolerance has no meaning in an annulus: rods keep the arrangement of their start, so "
            "that one run cannot tell its error; use periods, and several start.seed"
        )
    if not scene.vibrates or scene.contacts.plate is None:
        raise ValueError("tolerance needs a plate that vibrates and a contact with it")
    if outside(scene):
        return replace(scene, step=Step()), nan
    known = calibrated()
    order, scale = known["order"], known["scale"]
    share = tolerance / (1 + 2 * order)
    n = max(10 * (scale / share) ** (1 / order), known["fewest"])
    step = Step(steps_per_contact(scene, 1.0) / n, coarse=True)
    return replace(scene, step=step), scale * (10 / n) ** order


def interval(drift: np.ndarray, confidence: float = CONFIDENCE) -> tuple[float, float, int]:
    """Mean of a stationary series behind its transient, half of its interval, the transient.

    It is looked at again and again as the run goes on, so it is a wide one: the rest is cut into 8,
    16 and 32 parts, whose means give three intervals by Student's t, and the widest one counts.
    """
    cut = transient(len(drift))
    rest, half = drift[cut:], 0.0
    for parts in _PARTS:
        if len(rest) < parts:
            return float(rest.mean()) if len(rest) else nan, inf, cut
        means = rest[len(rest) % parts :].reshape(parts, -1).mean(axis=1)
        error = means.std(ddof=1) / np.sqrt(parts)
        half = max(half, float(student.ppf((1 + confidence) / 2, parts - 1) * error))
    return float(rest.mean()), half, cut


@dataclass
class _Chase:
    """The goal of a run: looks at its drift now and then, until it is accurate enough."""

    tolerance: float
    confidence: float
    floor: float
    bias: float  # relative; 0 where it is unknown
    max_seconds: float
    began: float = nan
    mean: float = nan
    half: float = inf
    reached: bool = False
    seconds: float = 0.0
    needed: float = nan  # seconds in all

    @property
    def size(self) -> float:
        """What errors are relative to."""
        return max(abs(self.mean), self.floor)

    def __call__(self, drift: np.ndarray) -> int:
        made = len(drift)
        if not made:
            self.began = perf_counter()
            return _FIRST
        self.seconds = perf_counter() - self.began
        self.mean, self.half, cut = interval(drift, self.confidence)
        if made < _FIRST:  # ended by Ctrl-C: too short to be judged
            self.half = inf
        room = (self.tolerance - self.bias) * self.size
        self.reached = self.half <= room
        wanted = cut + (made - cut) * (self.half / room) ** 2
        self.needed = self.seconds * wanted / made
        if self.reached:
            return made
        affordable = made * self.max_seconds / self.seconds
        hopeless = self.needed > 2 * self.max_seconds and made >= 2 * _FIRST
        if hopeless or affordable < _LEAST * made:
            return made
        return int(min(np.clip(wanted, _LEAST * made, _LARGEST * made) + 1, affordable, _MOST))


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
    options : as of `runner.run`: `periods` (200; without tolerance alone), `ledger`, `observe`,
        `trajectory`, `frames`, `checkpoint`, `progress`

    Returns
    -------
    Result; its `accuracy` is None without a tolerance

    Raises
    ------
    ValueError
        As `runner.run`, if a plate that vibrates is missing, or an argument is out of its domain.
    RunError
        As `runner.run`.
    """
    if tolerance is None:
        return runner.run(scene, **options)
    if options.get("periods") is not None:
        raise ValueError("periods has no meaning with tolerance, which chooses the length")
    if not isinstance(scene, Scene):
        raise TypeError(f"scene must be a md.Scene, as md.load gives, got {scene!r}")
    checked(tolerance, confidence, 1.0 if floor is None else floor, max_seconds)
    tuned, bias = chosen_step(scene, tolerance)
    floor = FLOOR * scene.plate_speed if floor is None else floor
    known = bias if isfinite(bias) else 0.0
    chase = _Chase(tolerance, confidence, floor, known, max_seconds)
    result = runner.run(tuned, **{**options, "periods": _MOST}, goal=chase)
    chase(result.c_x_series)  # where Ctrl-C ended it
    return replace(result, accuracy=_accuracy(chase, scene, result, bias))


def checked(
    tolerance: float,
    confidence: float = CONFIDENCE,
    floor: float = 1.0,
    max_seconds: float = MAX_SECONDS,
) -> None:
    """Refuse what is out of its domain."""
    number("tolerance", tolerance, 1e-5, 0.5, "between 1e-5 and 0.5")
    number("confidence", confidence, 0.5, 0.999, "between 0.5 and 0.999")
    number("floor", floor, 1e-12, 1e12, "between 1e-12 and 1e12")
    number("max_seconds", max_seconds, 1e-3, 1e9, "between 1e-3 and 1e9")


def _accuracy(chase: _Chase, scene: Scene, result: Result, bias: float) -> Accuracy:
    finer, rest = chosen_step(scene, chase.tolerance / 10)
    room = chase.tolerance / 10 - (rest if isfinite(bias) else 0.0)
    dearer = result.dt / (finer.step.size or result.dt)  # outside of the calibration, no dearer
    length = (chase.half / (room * chase.size)) ** 2
    reasons = unknown_bias(scene)
    bias = nan if reasons else bias
    return Accuracy(
        tolerance=chase.tolerance,
        confidence=chase.confidence,
        floor=chase.floor,
        error=chase.half + bias * chase.size,
        statistical=chase.half,
        bias=bias * chase.size,
        per_contact=steps_per_contact(scene, result.dt),
        outside=reasons,
        state="not reached" if not chase.reached else "bias unknown" if reasons else "reached",
        seconds=result.run_seconds,
        needed_seconds=chase.needed,
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
    if not isfinite(error):
        return [f"accuracy     {_VERDICTS[a.state]}: ended before {_FIRST} periods, error unknown"]
    lines = [
        f"accuracy     {_VERDICTS[a.state]}: {a.tolerance:.3g} of {of} asked for; c_x is within "
        f"{error:.2g} sqrt(g d) = {error * unit:.2g} cm/s, {error / size:.2g} of it, "
        f"at {a.confidence:.4g} confidence" + (", bias of the step apart" if a.outside else "")
    ]
    step = f"dt = {result.dt:.3g}, {a.per_contact:.3g} steps a contact"
    if a.outside:
        lines.append(f"step         {step}; its bias is unknown: {'; '.join(a.outside)}")
    else:
        lines.append(
            f"step         {step}: bias at most {a.bias / size:.2g}, by calibration; the other "
            f"{a.statistical / size:.2g} of the error are statistical"
        )
    if a.state == "not reached":
        lines.append(f"             this would take about {a.needed_seconds:.3g} s of run")
    if error / size > a.tolerance / 10:
        lines.append(
            f"next digit   {a.tolerance / 10:.3g} would take about {a.next_digit_seconds:.3g} s"
        )
    return lines
