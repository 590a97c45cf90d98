"""Scenes drawn evenly from ranges in which rows keep their tilt, and annuli, for long tests."""

import numpy as np
from scipy.stats import qmc

import md
from md.scene import put, read_tables
from md.search import Parameter

PARTS = "plate", "rods"
COULOMB = {"contacts.plate.law": "coulomb"} | dict.fromkeys(
    (f"contacts.plate.tangential_{name}" for name in ("ratio", "damping")), "none"
)


def of_contacts(name: str, low: float, high: float, log: bool = False) -> list[Parameter]:
    """An option of the contacts of plate and rods, each by itself; walls are like the plate."""
    walls = {"plate": ("plate", "wall"), "rods": ("rods",)}
    return [
        Parameter(
            f"{name} of {part}", tuple(f"contacts.{one}.{name}" for one in of), low, high, log
        )
        for part, of in walls.items()
    ]


ROW = (
    Parameter("law", ("law",), 0, 1),  # the last quarter: friction of the plate as a constraint
    Parameter("tilt_deg", ("tilt_deg",), 15, 50),
    Parameter("plate.acceleration", ("plate.acceleration",), 1.8, 5),
    Parameter("rods.length", ("rods.length",), 5, 10),
    *of_contacts("friction", 0.1, 0.6),
    *of_contacts("restitution", 0.5, 0.95),
    *of_contacts("tangential_ratio", 0.5, 30, True),
    *of_contacts("tangential_damping", 0, 1),
)
ANNULUS = (
    Parameter("rods.count", ("rods.count",), 32, 56, integer=True),
    Parameter("plate.acceleration", ("plate.acceleration",), 2, 5),
    *of_contacts("friction", 0.1, 0.6),
    *of_contacts("restitution", 0.65, 0.9),
    *of_contacts("tangential_ratio", 0.5, 10, True),
    *of_contacts("tangential_damping", 0, 0.5),
)


def changes(parameters: tuple[Parameter, ...], parts: np.ndarray) -> dict:
    """Values at these parts of the ranges, by keys."""
    pairs = zip(parameters, parts, strict=True)
    return {key: one.value(part) for one, part in pairs for key in one.keys}


def drawn(count: int, seed: int, annulus: bool = False) -> list[md.Scene]:
    """Scenes, drawn evenly."""
    parameters = ANNULUS if annulus else ROW
    every = qmc.Sobol(len(parameters), seed=seed).random(count)
    return [(_annulus if annulus else _row)(changes(parameters, parts)) for parts in every]


def _annulus(to: dict) -> md.Scene:
    return md.scene.from_tables(put(read_tables("annulus"), {"step": "none", **to}))


def _row(to: dict) -> md.Scene:
    base = put(read_tables("quasi2d"), {"step": "none", "start.speed": 0.3})
    to = {key: value for key, value in to.items() if ".wall." not in key}
    to["box.length"] = base["rods"]["count"] / np.cos(np.radians(to.pop("tilt_deg")))
    return md.scene.from_tables(put(base, to | (COULOMB if to.pop("law") > 0.75 else {})))
