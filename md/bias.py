"""Bias of the drift by long steps, known from a calibration, and the step that is cheapest.

With n steps a contact, at twice the plate's peak velocity, the drift is off by a part of itself,

    bias = step (10 f/n)^order exp((tilt - 30 degrees)/growth),    f^2 = max(1, ratio/ratio_0),

as tangential springs of the plate that are stiffer than ratio_0 need shorter steps, and the drift
is small at large tilts. It was measured for scenes drawn evenly from ranges (`calibration.py`).
`step` scatters from scene to scene: its mean is taken off, its scatter is the error that is left.
Contacts softer than asked for would be cheaper still; but they change the drift by anything up to
twice its value.
"""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtrit

from .errors import InputError
from .laws import contact_time, coulomb
from .scene import Scene, Step
from .sources import digest

CALIBRATION = Path(__file__).with_name("calibration.json")
CONTACT_TIME = "contact time in periods"  # instead of a stiffness
FEWEST_RODS = 20  # rows of as many drift as larger ones do; the calibration has 40
_FREEDOM = 10  # of the scatter over scenes
_NUMBERS = np.geomspace(1, 100, 200)  # steps a contact over the fewest ones


class Bias(NamedTuple):
    """What a step does to a drift, relative to the true drift."""

    value: float
    error: float  # standard error


class Choice(NamedTuple):
    """Step that a tolerance leads to."""

    scene: Scene  # that runs
    per_contact: float  # steps a contact; nan where the bias is not known
    bias: Bias | None  # None: not known from the calibration


def steps_per_contact(scene: Scene, dt: float) -> float:
    """Steps in the shortest contact at twice the plate's peak velocity."""
    found = [c for c in (scene.contacts.plate, scene.contacts.rods) if c is not None]
    return min(contact_time(c.law, 2 * scene.plate_speed) for c in found) / dt


def properties(scene: Scene) -> dict[str, float]:
    """Values of all that the bias may depend on in a scene, as far as it has them."""
    found: dict[str, float | None] = {
        "plate.acceleration": scene.plate.acceleration if scene.plate else 0.0,
        "tilt_deg": abs(float(np.degrees(scene.tilt))),
        "rods.length": scene.rods.length,
        CONTACT_TIME: steps_per_contact(scene, 1 / scene.frequency),
    }
    for name in ("plate", "rods"):
        if (contact := getattr(scene.contacts, name)) is None:
            continue
        law, spring = contact.law, contact.law.spring
        found[f"friction of {name}"] = contact.friction
        found[f"restitution of {name}"] = law.restitution
        if spring is not None and spring.root is not None:
            found[f"tangential ratio of {name}"] = spring.root / law.normal.stiffness
            found[f"tangential damping of {name}"] = spring.damping_ratio or 0.0
    return {name: value for name, value in found.items() if value is not None}


def laws(scene: Scene) -> str:
    """Names of the laws of plate and rods."""
    pair = scene.contacts.plate, scene.contacts.rods
    return "/".join(contact.law.name if contact else "none" for contact in pair)


@cache
def calibrated() -> dict[str, Any]:
    """Calibration in use: the bias, noise, ranges of what was varied, `code` of its sources."""
    return json.loads(CALIBRATION.read_text(encoding="utf-8"))


def bias_at(scene: Scene, n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and standard errors over steps a contact."""
    known, has = calibrated(), properties(scene)
    stiff = np.sqrt(max(has.get("tangential ratio of plate", 0.0) / known["ratio"], 1))
    grown = np.exp((has["tilt_deg"] - 30) / known["growth_deg"])
    shape = grown * (10 * stiff / n) ** known["order"]
    of_order = known["step"] * np.log(10 * stiff / n) * known["order_error"]
    return known["step"] * shape, np.hypot(known["step_error"], of_order) * shape


def student(confidence: float) -> float:
    """Standard errors of a bias that hold it with this confidence.

    Student's t of ten degrees of freedom: a scatter over scenes need not be normal.
    """
    return float(stdtrit(_FREEDOM, (1 + confidence) / 2))


def outside(scene: Scene) -> tuple[str, ...]:
    """Properties of a scene that lie outside of the calibration, in words."""
    known, values, found = calibrated(), properties(scene), []
    if scene.gravity is None or (scene.gravity.x, scene.gravity.z) != (0.0, -1.0):
        found.append("gravity is not 1, downwards")
    for name, (low, high) in known["ranges"].items():
        if not low * (1 - 1e-9) <= (value := values.get(name, low)) <= high * (1 + 1e-9):
            found.append(f"{name} {value:.4g} is outside of {low:.4g} to {high:.4g}")
    if scene.rods.count < FEWEST_RODS:
        found.append(f"rods.count {scene.rods.count} is below {FEWEST_RODS}")
    if scene.box is None:
        found.append("there is no box: the row is open")
    if (named := laws(scene)) not in known["laws"]:
        found.append(f"laws {named} were not calibrated ({', '.join(known['laws'])})")
        return tuple(found)
    pair = [contact.law for contact in (scene.contacts.plate, scene.contacts.rods) if contact]
    if len({law.normal.stiffness for law in pair}) > 1:
        found.append("contacts of plate and rods differ in stiffness")
    for law in pair:  # somebody's own may have the name of another one
        e = law.restitution
        if e is None or law.normal != coulomb(e, law.normal.stiffness).normal:
            found.append(f"a law named {law.name} is not that of the calibration")
    return tuple(found)


def unknown(scene: Scene) -> tuple[str, ...]:
    """Reasons why the calibration does not hold for a scene, in words; none where it does."""
    made_with = calibrated()["code"]
    if made_with == digest():
        return outside(scene)
    return *outside(scene), f"calibrated for other sources ({made_with}, these are {digest()})"


def choose(scene: Scene, tolerance: float, confidence: float) -> Choice:
    """The cheapest step for a tolerance of the drift.

    The error of the bias takes its part of the tolerance; what is left is for statistics, and the
    number of periods goes as one over its square. Where the calibration does not hold, the scene
    gets the step that `md.run` takes if none is named.

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
    if unknown(scene):
        return Choice(replace(scene, step=Step()), np.nan, None)
    n = calibrated()["fewest"] * _NUMBERS
    value, error = bias_at(scene, n)
    room = tolerance**2 - (student(confidence) * error) ** 2
    at = np.where(room > 0, n / np.where(room > 0, room, 1.0), np.inf).argmin()
    step = Step(steps_per_contact(scene, 1.0) / n[at], coarse=True)
    return Choice(replace(scene, step=step), float(n[at]), Bias(float(value[at]), float(error[at])))
