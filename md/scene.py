"""Scenes: what is there, as frozen dataclasses or TOML. What a scene does not name is not there.

Lengths are in rod diameters, times in sqrt(d/g), velocities in sqrt(g d); only `diameter_cm` and
`frequency_hz` are not, and turn into these at once, as do the keys in cm and cm/s that a table may
hold instead of others (`md.units`). `md/scenes/` holds examples.
"""

import hashlib
import inspect
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from math import acos, cos, degrees, hypot, inf, pi, radians, sin, sqrt
from pathlib import Path
from types import NoneType
from typing import Any, get_args, get_type_hints

from .laws import LAWS, Law, number
from .units import GRAVITY_CM, SCALES, TWINS, cm_per_s, reduced, rivals, twins

SCENES = Path(__file__).parent / "scenes"
_FORMER = {"rods.spin": "rods.rolling"}  # keys of earlier versions, and their names today


def whole(name: str, value: object, low: int, high: int) -> int:
    """`value` if it is a whole number in [low, high]."""
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError(f"{name} must be a whole number, got {value!r}")
    return int(number(name, value, low, high, f"between {low} and {high}"))


def _hold(part: object, title: str, **limits: tuple[float, float, str]) -> None:
    """Hold the named numbers of a part within their limits, as floats."""
    for name, (low, high, domain) in limits.items():
        value = getattr(part, name)
        if value is None:
            continue
        if isinstance(value, bool):
            raise TypeError(f"{title}.{name} must be a number, got {value!r}")
        object.__setattr__(part, name, number(f"{title}.{name}", value, low, high, domain))


def _parts(part: object, name: str = "") -> None:
    """Refuse what is no part of a scene where there should be one."""
    for key, kind in get_type_hints(type(part)).items():
        value = getattr(part, key)
        if kind is not float and not isinstance(value, kind):
            wanted = " or ".join(k.__name__ for k in get_args(kind) or (kind,) if k is not NoneType)
            raise TypeError(f"{name}{key} must be of the type {wanted}, got {value!r}")


@dataclass(frozen=True)
class Rods:
    """Spherocylinders of one kind."""

    count: int = 1  # up to a million
    length: float = 9.5  # overall, caps included
    inertia: str = "solid"  # of the uniform body, or "thin", the paper's length^2/12
    diameter_cm: float = 0.6  # the unit of length
    rolling: bool = False  # about their own axes, in the annulus

    def __post_init__(self) -> None:
        object.__setattr__(self, "count", whole("rods.count", self.count, 1, 10**6))
        if not isinstance(self.rolling, bool):
            raise TypeError(f"rods.rolling must be true or false, got {self.rolling!r}")
        if self.inertia not in ("solid", "thin"):
            raise ValueError(f"rods.inertia must be solid or thin, got {self.inertia!r}")
        _hold(
            self,
            "rods",
            length=(1.0, 1e3, "between 1 and 1000"),
            diameter_cm=SCALES["rods.diameter_cm"],
        )


@dataclass(frozen=True)
class Plate:
    """Horizontal plate at A sin(2 pi f t); without acceleration it is at rest."""

    acceleration: float = 0.0  # peak, in g: the paper's Gamma
    frequency_hz: float = 60.0  # > 0

    def __post_init__(self) -> None:
        _hold(
            self,
            "plate",
            acceleration=(0.0, 1e3, "between 0 and 1000"),
            frequency_hz=SCALES["plate.frequency_hz"],
        )


@dataclass(frozen=True)
class Box:
    """Everything repeats along x."""

    length: float  # after which it does, in d

    def __post_init__(self) -> None:
        _hold(self, "box", length=(1.0, 1e7, "between 1 and 1e7"))


@dataclass(frozen=True)
class Annulus:
    """Gap between two vertical cylinders. With it, rods move in space."""

    inner: float  # radius of its surface, in d
    outer: float  # at least a diameter more

    def __post_init__(self) -> None:
        domain = 1e-3, 1e6, "between 1e-3 and 1e6"
        _hold(self, "annulus", inner=domain, outer=domain)
        if not self.outer - self.inner >= 1:
            raise ValueError(
                f"annulus.outer must be at least a diameter beyond annulus.inner, "
                f"{self.inner + 1:.6g}, got {self.outer:.6g}"
            )

    @property
    def middle(self) -> float:
        """Radius half way."""
        return (self.inner + self.outer) / 2


@dataclass(frozen=True)
class Gravity:
    """In g; a plate inclined by a has x = sin a, z = -cos a."""

    x: float = 0.0  # along the plate
    z: float = -1.0  # upwards

    def __post_init__(self) -> None:
        domain = -1e3, 1e3, "up to 1000 in size"
        _hold(self, "gravity", x=domain, z=domain)


@dataclass(frozen=True)
class Contact:
    """How a pair of surfaces touches; a coefficient of friction of 0 is no friction at all."""

    law: Law  # made by a function of `md.LAWS`
    friction: float = 0.0  # Coulomb coefficient, >= 0

    def __post_init__(self) -> None:
        _parts(self, "contact.")
        _hold(self, "contact", friction=(0.0, inf, ">= 0"))


@dataclass(frozen=True)
class Contacts:
    """Materials, one for each pair of surfaces that may touch; an absent pair does not."""

    plate: Contact | None = None  # of a rod with the plate
    rods: Contact | None = None  # of two rods
    wall: Contact | None = None  # of a rod with the cylinders of the annulus

    def __post_init__(self) -> None:
        _parts(self, "contacts.")


@dataclass(frozen=True)
class Start:
    """Rods in a row, alike in tilt, the lower caps on the plate, with small random velocities."""

    tilt_deg: float | None = None  # None: acos(count/length of the box), side by side
    seed: int = 0  # of the velocities
    speed: float = 1e-3  # largest of each component
    drop: float = 0.0  # height of the caps over the plate

    def __post_init__(self) -> None:
        object.__setattr__(self, "seed", whole("start.seed", self.seed, 0, 2**63 - 1))
        _hold(
            self,
            "start",
            tilt_deg=(-90.0, 90.0, "between -90 and 90"),
            speed=(0.0, 1e3, "between 0 and 1000"),
            drop=(0.0, 1e3, "between 0 and 1000"),
        )


@dataclass(frozen=True)
class Step:
    """Time step.

    size : in sqrt(d/g); None: a fiftieth of a contact at twice the plate's peak velocity
    coarse : allow steps too long for the tangential springs, whose force then chatters within
        mu F_n, up to the limit of the normal force; what it does to the drift is measured
        (`md.calibration`)
    """

    size: float | None = None
    coarse: bool = False

    def __post_init__(self) -> None:
        _hold(self, "step", size=(1e-12, 1e3, "between 1e-12 and 1000"))


@dataclass(frozen=True)
class Scene:
    """Rods and what acts on them.

    rods, plate, box, annulus, gravity : what is there; None is not
    contacts, start, step : how surfaces touch, how rods start, the time step

    Raises
    ------
    ValueError
        If a value is out of its domain or the parts do not fit together: the rods into the box at
        the tilt, a plate without its contact, friction as a constraint between rods.
    TypeError
        If a value is of the wrong type.
    """

    rods: Rods = field(default_factory=Rods)
    plate: Plate | None = None
    box: Box | None = None
    annulus: Annulus | None = None
    gravity: Gravity | None = None
    contacts: Contacts = field(default_factory=Contacts)
    start: Start = field(default_factory=Start)
    step: Step = field(default_factory=Step)

    def __post_init__(self) -> None:
        _parts(self)
        plate, between = self.contacts.plate, self.contacts.rods
        if (plate is None) != (self.plate is None):
            there, missing = ("contacts.plate", "plate")[:: 1 if plate else -1]
            raise ValueError(f"{missing} is missing: the scene names {there}, and needs both")
        if between is not None and between.friction > 0 and between.law.spring is None:
            raise ValueError(
                f"contacts.rods.law must have a tangential spring, got {between.law.name!r}: "
                "friction as a constraint is for the plate"
            )
        if self.annulus is not None or self.contacts.wall is not None or self.rods.rolling:
            self._in_space()
        elif self.start.tilt_deg is None and self.box is None:
            raise ValueError("start.tilt_deg is missing: without a box it has no default")
        self._fit()

    def _in_space(self) -> None:
        """Refuse what is not for the annulus."""
        if self.annulus is None:
            raise ValueError("annulus is missing: the scene names contacts.wall or rods.rolling")
        if self.contacts.wall is None:
            raise ValueError("contacts.wall is missing: the scene names annulus, and needs both")
        if self.box is not None:
            raise ValueError("box must be absent from an annulus, which closes on itself")
        if self.gravity is not None and self.gravity.x != 0:
            raise ValueError(f"gravity.x must be 0 in an annulus, got {self.gravity.x:g}")
        for name in ("plate", "wall"):
            contact = getattr(self.contacts, name)
            if contact is not None and contact.friction > 0 and contact.law.spring is None:
                raise ValueError(
                    f"contacts.{name}.law must have a tangential spring in an annulus, got "
                    f"{contact.law.name!r}"
                )

    def _fit(self) -> None:
        """Refuse rods that would overlap at the start."""
        rods, box = self.rods, self.box
        if box is None or self.contacts.rods is None:
            return
        if box.length < rods.count:
            raise ValueError(
                f"box.length must be at least {rods.count} for {rods.count} rods, got "
                f"{box.length:g}"
            )
        steepest = degrees(acos(rods.count / box.length))
        spacing, tilt = box.length / rods.count, self.tilt
        beyond = max(spacing * abs(sin(tilt)) - (rods.length - 1), 0.0)  # along the axes
        if hypot(beyond, spacing * cos(tilt)) < 1 - 1e-12:
            raise ValueError(
                f"start.tilt_deg must be at most {steepest:.6g} for {rods.count} rods in a box of "
                f"{box.length:g}, got {degrees(tilt):.6g}"
            )

    @property
    def tilt(self) -> float:
        """Tilt at the start, rad."""
        if self.start.tilt_deg is not None:
            return radians(self.start.tilt_deg)
        if self.box is None:
            return 0.0
        return acos(min(self.rods.count / self.box.length, 1.0))

    @property
    def vibrates(self) -> bool:
        """Whether the plate moves."""
        return self.plate is not None and self.plate.acceleration > 0

    @property
    def frequency(self) -> float:
        """Of the plate, in sqrt(g/d); 1 where nothing vibrates, so that a period is sqrt(d/g)."""
        if self.plate is None or not self.vibrates:
            return 1.0
        return self.plate.frequency_hz * sqrt(self.rods.diameter_cm / GRAVITY_CM)

    @property
    def plate_speed(self) -> float:
        """Peak velocity of the plate, V_0, in sqrt(g d)."""
        return self.plate.acceleration / (2 * pi * self.frequency) if self.plate else 0.0

    @property
    def cm_per_s(self) -> float:
        """Unit of velocity, sqrt(g d)."""
        return cm_per_s(self.rods.diameter_cm)

    @property
    def impact_speed(self) -> float:
        """Speed of the impacts to expect: of the plate and of the fall at the start."""
        pull = hypot(self.gravity.x, self.gravity.z) if self.gravity else 0.0
        fall = sqrt(2 * pull * self.start.drop)
        return max(2 * self.plate_speed + fall + self.start.speed, 0.1)

    def digest(self) -> str:
        """Twelve hexadecimal digits that stand for the scene."""
        return hashlib.sha256(repr(self).encode()).hexdigest()[:12]


def as_dict(part: Any) -> Any:
    """The scene, or a part, as plain dictionaries without what is absent."""
    if is_dataclass(part):
        part = {f.name: getattr(part, f.name) for f in fields(part)}
    elif hasattr(part, "_asdict"):
        part = part._asdict()
    else:
        return part
    return {name: as_dict(value) for name, value in part.items() if value is not None}


def _contact(name: str, table: Mapping) -> Contact:
    """A contact from its table: law, friction, and the options of the law."""
    options = dict(table)
    law, friction = options.pop("law", "constant_restitution"), options.pop("friction", 0.0)
    if not isinstance(law, str) or law not in LAWS:
        raise ValueError(f"{name}.law must be one of {', '.join(LAWS)}, got {law!r}")
    known = inspect.signature(LAWS[law]).parameters
    for key, value in options.items():
        if key not in known and any(key in inspect.signature(m).parameters for m in LAWS.values()):
            raise ValueError(
                f"{name}.{key} is not for the law {law}: take it out (--set {name}.{key}=none)"
            )
        if key not in known:
            raise ValueError(_unknown(f"{name}.{key}", ("law", "friction", *known)))
        if isinstance(value, bool) != isinstance(known[key].default, bool):
            wanted = "true or false" if isinstance(known[key].default, bool) else "a number"
            raise TypeError(f"{name}.{key} must be {wanted}, got {value!r}")
    try:
        return Contact(LAWS[law](**options), friction)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name}.{str(error).removeprefix('contact.')}") from None


def _unknown(key: str, known: Iterable[str]) -> str:
    if key in _FORMER:
        return f"{key} is a key of an earlier version: write {_FORMER[key]} in its place"
    return f"{key} is not a key of a scene; known there: {', '.join(known)}"


def _build(kind: type, name: str, table: object) -> Any:
    """A part of a scene from its table."""
    if not isinstance(table, Mapping):
        raise TypeError(f"{name} must be a table, got {table!r}")
    if kind is Contact:
        return _contact(name, table)
    hints, parts = get_type_hints(kind), {}
    for key, value in table.items():
        if key not in hints:
            also = (twin.partition(".")[2] for twin in TWINS if twin.startswith(f"{name}."))
            raise ValueError(_unknown(f"{name}.{key}" if name else key, (*hints, *also)))
        kinds: tuple[Any, ...] = hints[key], *get_args(hints[key])
        inner: Any = next((kind for kind in kinds if is_dataclass(kind)), None)
        path = f"{name}.{key}" if name else key
        parts[key] = _build(inner, path, value) if inner else value
    missing = [key for key in inspect.signature(kind).parameters if key not in parts]
    required = [
        k for k in missing if inspect.signature(kind).parameters[k].default is inspect._empty
    ]
    if required:
        raise ValueError(f"{name}.{required[0]} is missing")
    return kind(**parts)


def keys() -> list[tuple[str, str]]:
    """Keys of a scene and their defaults, contacts with the options of their laws."""
    found = []
    for name, hint in get_type_hints(Scene).items():
        kind = next(t for t in (hint, *get_args(hint)) if is_dataclass(t))
        for part in fields(kind) if kind is not Contacts else ():
            default = "required" if part.default is MISSING else part.default
            key = f"{name}.{part.name}"
            found.append((key, "-" if default is None else str(default)))
            found += [(twin, f"instead of {key}") for twin in twins(key)]
    laws = {law: inspect.signature(make).parameters.values() for law, make in LAWS.items()}
    found += [("contacts.plate.law (.rods, .wall)", "constant_restitution")]
    found += [("contacts.plate.friction (.rods, .wall)", "0.0")]
    for law, options in laws.items():
        found += [(f"  under {law}: {option.name}", f"{option.default}") for option in options]
    return found


def _parsed(assignment: str) -> tuple[str, Any]:
    """Key and value of KEY=VALUE, the value as in TOML or a bare word."""
    if not isinstance(assignment, str):
        raise TypeError(f"assignments must be texts KEY=VALUE, got {assignment!r}")
    key, equals, text = assignment.partition("=")
    if not equals or not key.strip():
        raise ValueError(f"--set needs KEY=VALUE, got {assignment!r}")
    try:
        return key.strip(), tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return key.strip(), text.strip()


def put(tables: Mapping, changes: Mapping[str, Any]) -> dict:
    """A copy of a scene's tables with the values of some dotted keys changed; "none" removes.

    What is changed takes the place of what said the same before: an amplitude that of an
    acceleration, say.
    """
    changed = deepcopy(dict(tables))
    for key, value in changes.items():
        table = changed
        *path, last = key.split(".")
        for part in path:
            table = table.setdefault(part, {})
            if not isinstance(table, dict):
                raise ValueError(f"--set {key}: {part} is a value, not a table")
        if value == "none":
            table.pop(last, None)
        else:
            for other in rivals(key):
                if other not in changes:
                    table.pop(other.partition(".")[2], None)
            table[last] = value
    return changed


def both(**options: Any) -> dict[str, Any]:
    """Changes for `put` that give the contacts of plate and rods the same options."""
    return {f"contacts.{part}.{key}": v for part in ("plate", "rods") for key, v in options.items()}


def read_tables(source: str | Path, examples: Path = SCENES) -> dict:
    """Tables of a TOML file, or of the example of that name.

    Raises
    ------
    ValueError
        If there is no such file, or it is not TOML.
    """
    path = Path(source)
    if not path.exists() and (examples / f"{source}.toml").exists():
        path = examples / f"{source}.toml"
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"{source}: {error}") from None
    except (OSError, UnicodeDecodeError) as error:
        names = ", ".join(sorted(p.stem for p in examples.glob("*.toml")))
        reason = getattr(error, "strerror", None) or error
        what = "cannot be read" if path.exists() else "no such scene"
        raise ValueError(f"{source}: {what} ({reason}); examples: {names}") from None


def from_tables(tables: Mapping) -> Scene:
    """A scene from nested tables.

    Raises
    ------
    ValueError, TypeError
        If they hold what is not a scene.
    """
    tables, said = reduced(tables)
    try:
        return _build(Scene, "", tables)
    except (TypeError, ValueError) as error:
        given = [words for key, words in said.items() if key in str(error)]
        raise type(error)(f"{error} ({'; '.join(given)})" if given else str(error)) from None


def load(source: str | Path, assignments: Sequence[str] = ()) -> Scene:
    """A scene from a TOML file, or the example of that name, with some keys set anew.

    Parameters
    ----------
    source : path of a file, or the name of a file in `md/scenes/` without its ending
    assignments : "rods.count=20", ...; "box=none" takes a part out of the scene

    Raises
    ------
    ValueError, TypeError
        If the file cannot be read or holds what is not a scene.
    """
    if isinstance(assignments, str):
        assignments = [assignments]
    return from_tables(put(read_tables(source), dict(map(_parsed, assignments))))
