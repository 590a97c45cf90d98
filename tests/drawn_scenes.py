"""Scenes drawn evenly from ranges in which rows keep their tilt, and annuli, for long tests."""

from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

import md
from md.scene import put, read_tables

COULOMB = {"contacts.plate.law": "coulomb"} | dict.fromkeys(
    (f"contacts.plate.tangential_{name}" for name in ("ratio", "damping")), "none"
)


class Range(NamedTuple):
    """Values of some keys of a scene, evenly from `low` to `high`, or evenly in log."""

    keys: tuple[str, ...]
    low: float
    high: float
    log: bool = False

    def value(self, part: float) -> float:
        """At a part of the range."""
        if self.log:
            return self.low * (self.high / self.low) ** part
        return self.low + (self.high - self.low) * part


def of_contacts(name: str, low: float, high: float, log: bool = False) -> list[Range]:
    """An option of the contacts of plate and rods, each by itself; walls are like the plate."""
    plate = f"contacts.plate.{name}", f"contacts.wall.{name}"
    return [Range(keys, low, high, log) for keys in (plate, (f"contacts.rods.{name}",))]


ROW = (
    Range(("law",), 0, 1),  # the last quarter: friction of the plate as a constraint
    Range(("tilt_deg",), 15, 50),
    Range(("plate.acceleration",), 1.8, 5),
    Range(("rods.length",), 5, 10),
    *of_contacts("friction", 0.1, 0.6),
    *of_contacts("restitution", 0.5, 0.95),
    *of_contacts("tangential_ratio", 0.5, 30, True),
    *of_contacts("tangential_damping", 0, 1),
)
ANNULUS = (
    Range(("rods.count",), 32, 56),
    Range(("plate.acceleration",), 2, 5),
    *of_contacts("friction", 0.1, 0.6),
    *of_contacts("restitution", 0.65, 0.9),
    *of_contacts("tangential_ratio", 0.5, 10, True),
    *of_contacts("tangential_damping", 0, 0.5),
)


def drawn(count: int, seed: int, annulus: bool = False) -> list[md.Scene]:
    """Scenes, drawn evenly."""
    ranges, make = (ANNULUS, _annulus) if annulus else (ROW, _row)
    scenes = []
    for parts in qmc.Sobol(len(ranges), seed=seed).random(count):
        pairs = zip(ranges, parts, strict=True)
        scenes.append(make({key: one.value(float(x)) for one, x in pairs for key in one.keys}))
    return scenes


def _annulus(to: dict) -> md.Scene:
    to["rods.count"] = round(to["rods.count"])
    return md.scene.from_tables(put(read_tables("annulus"), {"step": "none", **to}))


def _row(to: dict) -> md.Scene:
    base = put(read_tables("quasi2d"), {"step": "none", "start.speed": 0.3})
    to = {key: value for key, value in to.items() if ".wall." not in key}
    to["box.length"] = base["rods"]["count"] / np.cos(np.radians(to.pop("tilt_deg")))
    return md.scene.from_tables(put(base, to | (COULOMB if to.pop("law") > 0.75 else {})))
