"""Bias of the drift by long steps, known from a calibration, and the step that is cheapest.

With n steps a contact, at twice the plate's peak velocity, the drift is off by a part of itself,

    bias = [step (10 f/n)^order + scatter (10 f/n)^scatter_order] exp((tilt - 30 degrees)/growth),
    f^2 = max(1, ratio/ratio_0),

as tangential springs of the plate that are stiffer than ratio_0 need shorter steps, and the drift
is small at large tilts. It was measured for rows and annuli drawn evenly from ranges
(`calibration.py`); in annuli the tilt does not count, nor does f for a scene with a calibration of
its own. `step` is the same for all scenes and is taken off; `scatter` is another number in each
scene and the error that is left. It falls more slowly than the mean as steps get shorter.
Contacts softer than asked for would be cheaper still; but they change the drift by anything up to
twice its value.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtrit

from .errors import InputError
from .files import plain
from .host import stable_step
from .laws import contact_time, coulomb
from .scene import Scene, Step, as_dict
from .sources import digest

CALIBRATION = Path(__file__).with_name("calibration.json")
CONTACT_TIME = "contact time in periods"  # instead of a stiffness
FEWEST_RODS = 20  # rows of as many drift as larger ones do; the calibration has 40
FREEDOM = 5  # of Student's t, which the scatter over scenes follows better than a normal one
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
    outside: tuple[str, ...]  # why not, in words


def steps_per_contact(scene: Scene, dt: float) -> float:
    """Steps in the shortest contact at twice the plate's peak velocity.

    Raises
    ------
    ValueError
        If nothing vibrates.
    """
    if not scene.vibrates:
        raise InputError("tolerance and calibrate need plate.acceleration > 0: nothing vibrates")
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
    if scene.annulus is not None:
        found |= {f"annulus.{name}": value for name, value in vars(scene.annulus).items()}
        found["rods.count"] = scene.rods.count
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


def _read(path: Path) -> dict[str, Any]:
    """Content of the file of a calibration."""
    try:
        found = json.loads(plain(path).read_text(encoding="utf-8"))
        if {"order", "step", "ranges"} <= set(found):
            return found
    except (OSError, TypeError, ValueError) as error:
        raise InputError(f"calibration {path} cannot be read: {error}") from None
    raise InputError(f"calibration {path} is not one, as `md calibrate` writes it")


def is_calibration(path: Path) -> bool:
    """Whether a file holds what `calibrate` gives."""
    try:
        return bool(_read(path))
    except InputError:
        return False


def own_tables(scene: Scene) -> dict[str, Any]:
    """All of a scene that its calibration is for, by dotted names: not its step, nor its seed."""
    found: dict[str, Any] = {}

    def flat(part: Any, prefix: str) -> None:
        for name, value in part.items():
            if isinstance(value, dict):
                flat(value, f"{prefix}{name}.")
            else:
                found[prefix + name] = value

    flat(json.loads(json.dumps(as_dict(replace(scene, step=Step())))), "")
    return {name: x for name, x in found.items() if name not in ("start.seed", "step.coarse")}


def calibrated(scene: Scene | None = None, path: str | Path | None = None) -> dict[str, Any]:
    """Calibration for a scene: the bias, noise, ranges of what was varied, `code` of its sources.

    Parameters
    ----------
    scene : what it is for; None: a row
    path : of its file; None: the shipped one

    Raises
    ------
    ValueError
        If the file is none, or of another scene.
    """
    known = _read(Path(path or CALIBRATION))
    if scene is None:
        return known
    if "scene" in known:
        there, here = known["scene"], own_tables(scene)
        for name in sorted({*there, *here}):
            if there.get(name) != here.get(name):
                raise InputError(
                    f"calibration {path} is of another scene: {name} was "
                    f"{there.get(name, 'none')}, it is {here.get(name, 'none')}"
                )
    return known | (known.get("annulus", {}) if scene.annulus is not None else {})


def lengths_of(
    scene: Scene, n: np.ndarray, known: dict[str, Any]
) -> tuple[np.ndarray, np.floating]:
    """10 f/n over steps a contact n, and the factor of the tilt."""
    has = properties(scene)
    stiff = np.sqrt(max(has.get("tangential ratio of plate", 0.0) / known["ratio"], 1))
    return 10 * stiff / n, np.exp((has["tilt_deg"] - 30) / known["growth_deg"])


def bias_at(scene: Scene, n: np.ndarray, known: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Values and standard errors over steps a contact, from a calibration."""
    length, grown = lengths_of(scene, n, known)
    value = known["step"] * length ** known["order"] * grown
    scatter = known["step_error"] * length ** known["scatter_order"] * grown
    return value, np.hypot(scatter, value * np.log(length) * known["order_error"])


def student(confidence: float) -> float:
    """Standard errors of a bias that hold it with this confidence.

    By Student's t: a scatter over scenes need not be normal.
    """
    return float(stdtrit(FREEDOM, (1 + confidence) / 2))


def outside(scene: Scene, known: dict[str, Any]) -> tuple[str, ...]:
    """Properties of a scene that lie outside of a calibration, in words."""
    values, found, contacts = properties(scene), [], scene.contacts
    if "scene" in known:  # `calibrated` has compared all
        return ()
    if scene.gravity is None or (scene.gravity.x, scene.gravity.z) != (0.0, -1.0):
        found.append("gravity is not 1, downwards")
    for name, (low, high) in known["ranges"].items():
        if not low * (1 - 1e-9) <= (value := values.get(name, low)) <= high * (1 + 1e-9):
            found.append(f"{name} {value:.4g} is outside of {low:.4g} to {high:.4g}")
    if scene.annulus is not None:
        if contacts.wall != contacts.plate:
            found.append("contacts of wall and plate differ")
        if scene.rods.rolling:
            found.append("rods roll about their axes")
    else:
        if scene.rods.count < FEWEST_RODS:
            found.append(f"rods.count {scene.rods.count} is below {FEWEST_RODS}")
        if scene.box is None:
            found.append("there is no box: the row is open")
    if (named := laws(scene)) not in known["laws"]:
        found.append(f"laws {named} were not calibrated ({', '.join(known['laws'])})")
        return tuple(found)
    pair = [contact.law for contact in (contacts.plate, contacts.rods) if contact]
    if len({law.normal.stiffness for law in pair}) > 1:
        found.append("contacts of plate and rods differ in stiffness")
    for law in pair:  # somebody's own may have the name of another one
        e = law.restitution
        if e is None or law.normal != coulomb(e, law.normal.stiffness).normal:
            found.append(f"a law named {law.name} is not that of the calibration")
    return tuple(found)


def unknown(scene: Scene, known: dict[str, Any]) -> tuple[str, ...]:
    """Reasons why a calibration does not hold for a scene, in words; none where it does."""
    made_with, here = known["code"], digest(annulus=scene.annulus is not None)
    if made_with == here:
        return outside(scene, known)
    return *outside(scene, known), f"calibrated for other sources ({made_with}, these are {here})"


def choose(
    scene: Scene, tolerance: float, confidence: float, path: str | Path | None = None
) -> Choice:
    """The cheapest stable step for a tolerance of the drift.

    The error of the bias takes its part of the tolerance; what is left is for statistics, and the
    number of periods goes as one over its square. Where the calibration does not hold, the scene
    gets the step that `md.run` takes if none is named.

    Parameters
    ----------
    scene, tolerance, confidence : as of `md.run`
    path : of a calibration for this scene; None: the shipped one

    Raises
    ------
    ValueError
        If nothing vibrates, or `path` holds no calibration for this scene and these sources.
    """
    if not isinstance(scene, Scene):
        raise InputError(f"scene must be a md.Scene, as md.load gives, got {scene!r}")
    known = calibrated(scene, path)
    if reasons := unknown(scene, known):
        if path is not None:
            raise InputError(f"calibration {path} does not hold for the scene: {reasons[0]}")
        return Choice(replace(scene, step=Step()), np.nan, None, reasons)
    n, contact = known["fewest"] * _NUMBERS, steps_per_contact(scene, 1.0)
    longest, _ = stable_step(replace(scene, step=Step(coarse=True)))
    value, error = bias_at(scene, n, known)
    room = tolerance**2 - (student(confidence) * error) ** 2
    fine = (room > 0) & (contact / n <= longest)
    at = np.where(fine, n / np.where(fine, room, 1.0), np.inf).argmin()
    step = Step(contact / n[at], coarse=True)
    bias = Bias(float(value[at]), float(error[at]))
    return Choice(replace(scene, step=step), float(n[at]), bias, ())
