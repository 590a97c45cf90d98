"""Scenes: rods and what acts on them, as frozen dataclasses or TOML. An absent part has no effect.

Lengths are in rod diameters, times in sqrt(d/g), velocities in sqrt(g d); only `diameter_cm` and
`frequency_hz` are not. They are converted when a scene is made, as are the keys in cm and cm/s that
a table may hold (`md.units`). `md/scenes/` holds examples. A key's domain stands in its type hint.
"""

import hashlib
import inspect
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from copy import deepcopy
from dataclasses import dataclass, is_dataclass
from difflib import get_close_matches
from math import acos, cos, degrees, floor, hypot, inf, pi, radians, sin, sqrt
from operator import attrgetter
from pathlib import Path
from typing import Annotated, Any, get_args

from .domains import InputError, Part, as_dict, hints, in_notebook, listed
from .files import text_of
from .laws import LAWS, Law, Length, Mass
from .units import GRAVITY_CM, TWINS, Diameter, Frequency, cm_per_s, in_cm, reduced, rivals

SCENES = Path(__file__).parent / "scenes"
_NARROWEST = 1.0001  # d; gap of an annulus in which rods can be placed
GAP = 1e-6  # d, between rods and over the plate at the start: if they touched, rounding would push
_NEEDS = {
    "plate": "contacts.plate",
    "annulus": "contacts.wall",
    "contacts.plate": "plate",
    "contacts.wall": "annulus",
    "rods.rolling": "annulus",
}


@dataclass(frozen=True)
class Rods(Part):
    """Spherocylinders of one kind.

    A rod longer than 1 by less than an overlap or two touches with both ends at once, and bounces
    less than the restitution asked for: 0.55 for 0.65 at length 1.0001.

    count : number of rods
    length : overall, caps included, d
    inertia : "solid", of the uniform body, or "thin", the paper's m length^2/12
    diameter_cm : d in cm, the unit of length
    rolling : whether they turn about their own axes, in the annulus
    """

    count: Annotated[int, 1, 10**6] = 1
    length: Length = 9.5
    inertia: Mass = "solid"
    diameter_cm: Diameter = 0.6
    rolling: bool = False


@dataclass(frozen=True)
class Plate(Part):
    """Horizontal plate, which vibrates as a sine; without acceleration it is at rest.

    Its velocity is V_0 cos(phase) with V_0 = acceleration/(2 pi f). A run starts with it at its
    lowest point: phase = 2 pi f t - pi/2.

    acceleration : peak, in g: the paper's Gamma
    frequency_hz : f, in Hz
    """

    acceleration: Annotated[float, 0.0, 1000.0] = 0.0
    frequency_hz: Frequency = 60.0


@dataclass(frozen=True)
class Box(Part):
    """Box that repeats along x. Rods side by side in it lean by cos(tilt) = count d/length.

    length : after which it repeats, d
    """

    length: Annotated[float, 1.0, 1e7]


@dataclass(frozen=True)
class Annulus(Part):
    """Gap between two vertical cylinders. With it, rods move in space.

    inner : radius of the inner wall, d
    outer : radius of the outer wall, d, at least 1.0001 more
    shaken : both walls move with the plate; else they are at rest
    """

    inner: Annotated[float, 1e-3, 1e6]
    outer: Annotated[float, 1e-3, 1e6]
    shaken: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.outer - self.inner >= _NARROWEST - GAP:  # GAP: rounding
            least = f"{_NARROWEST} beyond annulus.inner, {self.inner + _NARROWEST:.12g}"
            raise InputError(f"annulus.outer must be at least {least}, got {self.outer:.12g}")

    @property
    def middle(self) -> float:
        """Radius half way between the walls, in d."""
        return (self.inner + self.outer) / 2


@dataclass(frozen=True)
class Gravity(Part):
    """Gravity in g; a plate inclined by a has x = sin a, z = -cos a.

    x : along the plate, g
    z : upwards, g
    """

    x: Annotated[float, -1000.0, 1000.0] = 0.0
    z: Annotated[float, -1000.0, 1000.0] = -1.0


@dataclass(frozen=True)
class Contact(Part):
    """Contact of two surfaces: its law and friction; a coefficient of 0 is no friction at all.

    law : made by a function of `md.LAWS`
    friction : Coulomb coefficient mu, >= 0
    """

    law: Law
    friction: Annotated[float, 0.0, inf] = 0.0


@dataclass(frozen=True)
class Contacts(Part):
    """Materials, one for each pair of surfaces that may touch; an absent pair does not.

    plate : contact of a rod with the plate
    rods : contact of two rods
    wall : contact of a rod with the cylinders of the annulus
    """

    plate: Contact | None = None
    rods: Contact | None = None
    wall: Contact | None = None


@dataclass(frozen=True)
class Start(Part):
    """Rods in a row, alike in tilt, with small random velocities whose mean along the plate is 0.

    They start a millionth of a diameter over the plate and, where the box sets the tilt, apart.

    tilt_deg : degrees; None: acos(count d/length of the box), side by side; in an annulus the tilt
        at which rods fill the circle
    seed : of the random velocities
    speed : largest value of each component of them, sqrt(g d)
    drop : height of the caps over the plate, d
    """

    tilt_deg: Annotated[float, -90.0, 90.0] | None = None
    seed: Annotated[int, 0, 2**63 - 1] = 0
    speed: Annotated[float, 0.0, 1000.0] = 1e-3
    drop: Annotated[float, 0.0, 1000.0] = 0.0


@dataclass(frozen=True)
class Step(Part):
    """Time step.

    size : in sqrt(d/g); None: 24 a contact at twice the plate's peak velocity, more if these are
        not stable
    coarse : allow steps too long for the tangential springs, whose force then chatters within
        mu F_n, up to the limit of the normal force; upright rows drift several times as fast then
        (`md.accuracy`)
    """

    size: Annotated[float, 1e-12, 1000.0] | None = None
    coarse: bool = False


@dataclass(frozen=True)
class Scene(Part):
    """Rods and what acts on them.

    rods, plate, box, annulus, gravity : parts; None: absent
    contacts, start, step : how surfaces touch, how rods start, the time step

    Raises
    ------
    ValueError
        If a value is out of its domain or the parts do not fit together: the rods into the box at
        the tilt, a plate without its contact, friction as a constraint between rods.
    TypeError
        If a value is of the wrong type.
    """

    KEY = ""

    rods: Rods = Rods()
    plate: Plate | None = None
    box: Box | None = None
    annulus: Annulus | None = None
    gravity: Gravity | None = None
    contacts: Contacts = Contacts()
    start: Start = Start()
    step: Step = Step()

    def __post_init__(self) -> None:
        super().__post_init__()
        for one, other in _NEEDS.items():
            if attrgetter(one)(self) and not attrgetter(other)(self):
                raise InputError(f"{other} is missing: the scene names {one}, and needs both")
        for name in ("rods", "wall"):
            contact = getattr(self.contacts, name)
            if contact and contact.friction > 0 and contact.law.spring is None:
                raise InputError(
                    f"contacts.{name}.law must have a tangential spring, got {contact.law.name!r}: "
                    "friction as a constraint is for the plate"
                )
        rods = self.contacts.rods
        if rods and rods.law.normal.plastic:  # each contact of a rod would stop it for all others
            raise InputError("contacts.rods.restitution must be above 0, got a plastic contact")
        if self.annulus is None:
            if self.start.tilt_deg is None and self.box is None:
                raise InputError("start.tilt_deg is missing: without a box it has no default")
        elif self.box is not None:
            raise InputError("box must be absent from an annulus, which closes on itself")
        elif self.gravity is not None and self.gravity.x != 0:
            raise InputError(f"gravity.x must be 0 in an annulus, got {self.gravity.x:g}")
        elif self.annulus.shaken and not self.vibrates:
            raise InputError("annulus.shaken must be false without a plate that vibrates, got true")
        self._fit()

    def _fit(self) -> None:
        """Refuse rods that would overlap at the start."""
        rods, box = self.rods, self.box
        if box is None or self.contacts.rods is None:
            return
        n, tilt = rods.count, self.tilt
        if box.length < n:
            raise InputError(f"box.length must be at least {n} for {n} rods, got {box.length:g}")
        most, spacing = floor(1e4 * degrees(acos(n / box.length))) / 1e4, box.length / n
        beyond = max(spacing * abs(sin(tilt)) - (rods.length - 1), 0.0)  # along the axes
        if hypot(beyond, spacing * cos(tilt)) < 1 - 1e-12:
            raise InputError(
                f"start.tilt_deg must be between {0 - most:g} and {most:g} for {n} rods in a box "
                f"of {box.length:g}, got {degrees(tilt):.6g}"
            )

    @property
    def tilt(self) -> float:
        """Tilt at the start, rad."""
        if self.start.tilt_deg is not None:
            return radians(self.start.tilt_deg)
        if self.box is None:
            return 0.0
        return acos(min((1 + GAP) * self.rods.count / self.box.length, 1.0))

    @property
    def vibrates(self) -> bool:
        """Whether the plate moves."""
        return self.plate is not None and self.plate.acceleration > 0

    @property
    def frequency(self) -> float:
        """Frequency of the plate, sqrt(g/d); 1 if nothing vibrates: a period is then sqrt(d/g)."""
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
        """Speed of the impacts to expect from plate, drop and start, in sqrt(g d)."""
        pull = hypot(self.gravity.x, self.gravity.z) if self.gravity else 0.0
        fall = sqrt(2 * pull * self.start.drop)
        return max(2 * self.plate_speed + fall + self.start.speed, 0.1)

    def __repr__(self) -> str:
        words = str(self).replace("\n", "; ").split()
        return f"<Scene: {' '.join(words)}>"

    def __str__(self) -> str:
        """Rods, box or annulus, and plate, in cm and Hz."""
        cm = {key: f"{value:.4g}" for key, value in in_cm(as_dict(self)).items()}
        size, where = f"{cm['rods.length_cm']} by {self.rods.diameter_cm:.4g} cm", ""
        if self.box is not None:
            where = f", in a box of {cm['box.length_cm']} cm that repeats"
        if self.annulus is not None:
            radii = f"{cm['annulus.inner_cm']} and {cm['annulus.outer_cm']}"
            where = f", between cylinders with radii of {radii} cm"
        text = f"rods         {self.rods.count} of {size}{where}"
        if self.plate is not None and self.vibrates:
            gamma = f"{self.plate.frequency_hz:g} Hz, Gamma = {self.plate.acceleration:.4g}"
            speed = f"V_0 = {cm['plate.velocity_cm_s']} cm/s"
            text += f"\nplate        {gamma}, amplitude {cm['plate.amplitude_cm']} cm, {speed}"
        return text

    _repr_html_ = in_notebook

    @property
    def contents(self) -> str:
        """Text of all values to the last digit, which tells the scene from others."""
        return f"Scene({', '.join(f'{name}={part!r}' for name, part in vars(self).items())})"

    def digest(self) -> str:
        """Twelve hexadecimal digits that stand for the scene."""
        return hashlib.sha256(self.contents.encode()).hexdigest()[:12]


def options_of(law: str) -> Mapping[str, inspect.Parameter]:
    """Options of a contact law, by its name in `LAWS`."""
    return inspect.signature(LAWS[law]).parameters


def _contact(name: str, table: Mapping) -> Contact:
    """Make a contact from its table: law, friction, and the options of the law."""
    options = dict(table)
    law, friction = options.pop("law", "constant_restitution"), options.pop("friction", 0.0)
    if not isinstance(law, str) or law not in LAWS:
        raise InputError(f"{name}.law must be one of {', '.join(LAWS)}, got {law!r}")
    takes = options_of(law)
    for key in [one for one in options if one not in takes]:
        of_another = any(key in options_of(other) for other in LAWS)
        near = get_close_matches(key, ["law", "friction", *takes], 1)
        if near and not of_another:
            raise InputError(f"{name}.{key} is not a key: do you mean {name}.{near[0]}?")
        raise InputError(
            f"{name}.{key} is not for the law {law}, which takes {', '.join(takes)}: "
            f"take it out (--set {name}.{key}=none)"
        )
    try:
        return Contact(LAWS[law](**options), friction)
    except InputError as error:
        raise InputError(
            f"{name}.{str(error).removeprefix('contact.').removeprefix('normal.')}"
        ) from None


def _part(hint: Any) -> Any:
    """Class of the part of a scene that a type hint names, or None."""
    return next((kind for kind in (hint, *get_args(hint)) if is_dataclass(kind)), None)


def _build(kind: Any, name: str, table: object) -> Any:
    """Make a part of a scene from its table."""
    if not isinstance(table, Mapping):
        raise InputError(f"{name} must be a table, got {table!r}")
    if kind is Contact:
        return _contact(name, table)
    known, parts = hints(kind), {}
    for key, value in table.items():
        path = f"{name}.{key}".lstrip(".")
        if key not in known:
            twins = (twin.partition(".")[2] for twin in TWINS if twin.startswith(f"{name}."))
            there = ", ".join([*known, *twins])
            raise InputError(f"{path} is not a key of a scene; known there: {there}")
        inner = _part(known[key])
        parts[key] = _build(inner, path, value) if inner else value
    for key in known:
        if key not in parts and not hasattr(kind, key):  # a default is an attribute of the class
            raise InputError(f"{name}.{key} is missing")
    return kind(**parts)


def keys() -> Iterator[tuple[str, str]]:
    """Yield the keys of a scene and their defaults, and the options of the contact laws."""
    for name, hint in hints(Scene).items():
        kind = _part(hint)
        for part in hints(kind) if name != "contacts" else ():
            key, default = f"{name}.{part}", getattr(kind, part, "required")
            yield key, "-" if default is None else str(default)
            for twin in rivals(key):
                yield twin, f"instead of {key}"
    yield "contacts.plate.law (.rods, .wall)", "constant_restitution"
    yield "contacts.plate.friction (.rods, .wall)", "0.0"
    for law in LAWS:
        for option in options_of(law).values():
            yield f"  under {law}: {option.name}", str(option.default)


def _parsed(assignment: str) -> tuple[str, Any]:
    """Key and value of KEY=VALUE: the value as TOML or Python writes it, or a bare word."""
    key, equals, text = map(str.strip, str(assignment).partition("="))
    if not equals or not key or "\n" in text:
        raise InputError(f"assignments (--set) must be KEY=VALUE, got {assignment!r}")
    try:
        return key, tomllib.loads(f"value = {text}")["value"]
    except (ValueError, RecursionError):  # no TOML, or a whole number of thousands of digits
        plain = {"true": True, "false": False, "none": "none"}  # in any case
        with suppress(ValueError):  # .03, which TOML writes as 0.03
            return key, float(text)
        return key, plain.get(text.lower(), text)


def put(tables: Mapping, changes: Mapping[str, Any]) -> dict:
    """A copy of a scene's tables with the values of some dotted keys changed; "none" removes.

    A changed key replaces the keys that say the same: an amplitude, say, an acceleration; one that
    is removed takes them along.
    """
    changed = deepcopy(dict(tables))
    for key, value in changes.items():
        table = changed
        *path, last = key.split(".")
        first = key.partition(".")[0]
        if value == "none" and first in hints(Scene) and first not in changed:
            continue  # it makes no part to take something out of it
        for part in path:
            table = table.setdefault(part, {})
            if not isinstance(table, dict):
                raise InputError(f"--set {key}: {part} is a value, not a table")
        for other in rivals(key):
            if other not in changes:
                table.pop(other.partition(".")[2], None)
        table[last] = value
        if value == "none":
            del table[last]
    return changed


def changes_of(name: str, table: object) -> dict[str, Any]:
    """Changes for `put` from a table; a table in place of a value would drop the keys beside it."""
    if not isinstance(table, Mapping) or any(
        not isinstance(key, str) or isinstance(value, Mapping) for key, value in table.items()
    ):
        raise InputError(f'{name} must hold "key" = value, keys in quotes, got {table!r}')
    return dict(table)


def read_tables(source: str | Path, examples: Path = SCENES) -> dict:
    """Tables of a TOML file, or of the example of that name.

    Raises
    ------
    ValueError
        If there is no such file, or it is not TOML.
    """
    if not isinstance(source, str | Path):
        raise InputError(f"source must be the path of a file or a name, got {source!r}")
    path = Path(source)
    if not path.exists():
        path = examples / f"{source}.toml"
    if not path.exists():
        names = ", ".join(sorted(path.stem for path in examples.glob("*.toml")))
        raise InputError(f"{source}: no such file or example; examples: {names}")
    text = text_of(path)
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"{source}: {error}") from None


def scene_beside(path: str | Path, tables: Mapping) -> dict:
    """Tables of the scene that a sweep or a search names: a file beside it, or an example."""
    name = tables.get("scene")
    if not isinstance(name, str):
        raise InputError(f"scene must be the name of a file or of an example, got {name!r}")
    beside = Path(path).parent / name
    return read_tables(beside if beside.exists() else name)


def from_tables(tables: Mapping) -> Scene:
    """A scene from nested tables.

    Raises
    ------
    ValueError, TypeError
        If they do not make a scene.
    """
    changes, said = reduced(tables)
    try:
        return _build(Scene, "", put(tables, changes))
    except InputError as error:
        given = [words for key, words in said.items() if key in str(error)]
        raise InputError(f"{error} ({'; '.join(given)})" if given else str(error)) from None


def load(source: str | Path, assignments: Sequence[str] = ()) -> Scene:
    """A scene from a TOML file, or the example of that name, with some keys changed.

    Parameters
    ----------
    source : path of a file, or the name of a file in `md/scenes/` without its ending
    assignments : "rods.count=20", ...; "box=none" takes a part out of the scene

    Raises
    ------
    ValueError, TypeError
        If the file cannot be read or does not hold a scene.
    """
    given = listed(assignments)
    changes = map(_parsed, [assignments] if given is None else given)
    return from_tables(put(read_tables(source), dict(changes)))
