"""Keys of a scene in cm and cm/s, each for a key in reduced units; units of measured quantities.

A length or a speed needs `rods.diameter_cm` beside it; an amplitude or a peak velocity of the plate
stands for its acceleration, and needs `plate.frequency_hz`. All are converted once, when the tables
of a scene are read.

>>> import md
>>> md.load("my_rods").rods.length == 5.08 / 0.635  # length_cm = 5.08, diameter_cm = 0.635
True
>>> round(md.load("my_rods", ["plate.amplitude_cm=0.05"]).plate.acceleration, 3)  # (2 pi f)^2 A/g
7.244

Units and long names of results, columns of records and keys stand in units.toml.
"""

import re
import tomllib
from collections.abc import Callable, Mapping
from functools import cache
from math import pi, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

from .domains import InputError, flat, held, not_negative

if TYPE_CHECKING:
    from xarray import Dataset

GRAVITY_CM = 981.0  # cm/s^2
Diameter = Annotated[float, 1e-6, 1e6]
Frequency = Annotated[float, 1e-3, 1e6]
SCALES = {"rods.diameter_cm": Diameter, "plate.frequency_hz": Frequency}  # units of other keys


class Twin(NamedTuple):
    """Meaning of a key in cm or cm/s."""

    key: str  # key for which it stands, in reduced units
    scale: str  # key that it needs beside it
    unit: Callable[[float], float]  # one unit of `key` in cm or cm/s, given the scale


def cm_per_s(diameter: float) -> float:
    """Unit of velocity, sqrt(g d), given the diameter in cm."""
    return sqrt(GRAVITY_CM * diameter)


_LENGTHS = "rods.length", "box.length", "annulus.inner", "annulus.outer", "start.drop"
TWINS = {
    "plate.amplitude_cm": Twin(
        "plate.acceleration", "plate.frequency_hz", lambda f: GRAVITY_CM / (2 * pi * f) ** 2
    ),
    "plate.velocity_cm_s": Twin(
        "plate.acceleration", "plate.frequency_hz", lambda f: GRAVITY_CM / (2 * pi * f)
    ),
    "start.speed_cm_s": Twin("start.speed", "rods.diameter_cm", cm_per_s),
    **{f"{key}_cm": Twin(key, "rods.diameter_cm", float) for key in _LENGTHS},
}


def rivals(key: str) -> list[str]:
    """Other keys for the same quantity, which cannot stand beside a key."""
    own = TWINS[key].key if key in TWINS else key
    same = own, *(name for name, twin in TWINS.items() if twin.key == own)
    return [name for name in same if name != key]


def reduced(tables: Mapping) -> tuple[dict[str, float], dict[str, str]]:
    """Values of a scene's tables that are given in cm and cm/s, in reduced units.

    Returns
    -------
    Changes of the tables, as `scene.put` takes them, and for each of their keys a text that says
    how it was given.

    Raises
    ------
    ValueError, TypeError
        If two keys say the same, a key lacks the one that it needs, or a value is out of its
        domain.
    """
    changes, said, given = {}, {}, flat(tables)
    for name, (key, scale, unit) in TWINS.items():
        if name not in given:
            continue
        for other in rivals(name):
            if other in given:
                raise InputError(f"{name} and {other} say the same: give one of them, not both")
        if (part := scale.partition(".")[0]) in given:
            raise InputError(f"{part} must be a table, got {given[part]!r}")
        if scale not in given:
            raise InputError(f"{scale} is missing: {name} needs it")
        one = unit(held(scale, given[scale], SCALES[scale]))
        changes[key] = not_negative(name, given[name]) / one
        said[key] = f"{name} = {given[name]!r}, in units of {one:.6g}"
    return changes, said


def in_cm(tables: Mapping) -> dict[str, float]:
    """Values of the keys in cm and cm/s, from tables in reduced units (`domains.as_dict`)."""
    given = flat(tables)
    return {
        name: given[key] * unit(given[scale])
        for name, (key, scale, unit) in TWINS.items()
        if key in given
    }


@cache
def _measured() -> dict[str, tuple[str, str]]:
    """Unit and long name of each measured quantity, by its name."""
    tables = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    return {name: (unit, text) for unit, names in tables.items() for name, text in names.items()}


def error_of(name: str) -> str:
    """Name of the standard error of a result; the name itself if there is none."""
    return re.sub("^(c_x|tilt)(?=(_cm_s|_deg)?$)", r"\1_stderr", name.replace(".mean", ".stderr"))


def labelled(*given: Mapping) -> "Dataset":
    """`xarray.Dataset` with units and long names; dots in names become underscores.

    Parameters
    ----------
    given : variables and coordinates, as `xarray.Dataset` takes them
    """
    from xarray import Dataset  # late: no run needs it

    found, about = Dataset(*given), _measured()
    for name, array in found.variables.items():
        key = name.replace(".stderr", ".mean").replace("_stderr", "")
        error = "standard error: " * (key != name)
        while key and key not in about:
            key = key.partition(".")[2]
        unit, text = about.get(key, ("", name))
        array.attrs = {"long_name": error + text} | ({"units": unit} if unit else {})
    return found.rename({name: name.replace(".", "_") for name in {*found.variables, *found.dims}})
