"""What a run records: touches of the plate and landings as tables, frames as a trajectory.

A run hands its touches to `observe` as they end; kept in a list they become one table:

>>> import md
>>> rows = []
>>> result = md.run(md.load("my_rods"), periods=20, observe=rows.append)
>>> touches = md.records.touches(rows, result)
>>> list(touches)[:4]
['rod', 'time', 'phase', 'cap']
>>> stuck = touches.c_x_after[touches.regime == "slip-stick"]
>>> stuck.units
'sqrt(g d)'
>>> landings = md.records.landings(rows, result)
>>> landings.sizes["landing"] < touches.sizes["touch"]
True
>>> table = touches.to_dataframe()  # of pandas

=============================  ===================================================================
column                         what it is
=============================  ===================================================================
rod                            number of the rod
time                           when the touch begins, in periods since the start of the run, when
                               the plate is at its lowest point
phase                          of the plate as the touch begins, rad, 0 to 2 pi; its velocity is
                               V_0 cos(phase), as in the paper's (31)
cap                            which end touches: -1 or 1, along the axis (-1: the lower one of a
                               rod that has not fallen over)
flight                         periods since the last touch of this rod ended; nan before its first
a_x, a_z                       contact point seen from the centre of mass, in d: X = -a_x, Z = -a_z
c_x_before, c_z_before         velocity of the centre of mass before, in sqrt(g d)
omega_before                   spin before, in sqrt(g/d)
c_x_after, c_z_after           the same after: of a landing, after its last touch
omega_after
plate_velocity                 V_z as the touch begins, in sqrt(g d)
v_before                       normal velocity of the contact point against the plate, in sqrt(g d)
v_after                        the same as the force ends; -v_after/v_before is the restitution of
                               one touch, and scatters widely where v_before is small: a run's is
                               -sum(v_after)/sum(v_before)
duration                       periods from the first force to the last
regime                         "slide", "slip-stick" or "slip-reversal"
pushed_by_others               part of the touch during which another rod, or a wall, pushes this
                               one, 0 to 1
max_overlap                    deepest overlap, in d
touches                        of a landing alone, in place of the five above: how many it has
=============================  ===================================================================

In an annulus x lies in the vertical plane through the rod's axis as the touch begins, horizontally
and counter-clockwise around the annulus (`md.kernels.touches`); for an upright rod it is the
direction around the annulus itself. Velocities and spin are their parts in that plane.

Trajectories are extended XYZ, with shape and orientation, for OVITO and ASE. In OVITO choose, under
Particles, the standard shape Spherocylinder; orientation and size come from the file. In ASE
`ase.io.read("row.xyz", index=":")` gives the frames, each with the columns as `arrays` and times
and units as `info`; ASE knows no species but elements, and calls a rod X.
"""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from math import atan2, cos, degrees, hypot, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from .domains import InputError
from .files import empty
from .kernels import DIRECTOR, PLACE, REGIMES, TURN, VELOCITY
from .kernels import touches as columns
from .measures import HOP, VELOCITIES, merged, phase_at
from .result import Result
from .scene import Scene
from .units import labelled

if TYPE_CHECKING:
    from xarray import Dataset


# Touches and landings

_NAMES = (  # of the columns of `kernels.touches` and `measures.merged`, in their order
    "rod",
    "time",
    "cap",
    "duration",
    "flight",
    "a_x",
    "a_z",
    *VELOCITIES,
    "plate_velocity",
    "v_before",
    "v_after",
    "regime",
    "pushed_by_others",
    "max_overlap",
    "touches",
)
_OF_TOUCHES = "duration", "v_after", "regime", "pushed_by_others", "max_overlap"
_TYPES: dict[str, Any] = {"rod": np.int64, "cap": np.int8, "touches": np.int64, "regime": "U13"}
_IN_STEPS = "time", "flight", "duration"


def touches(rows: Sequence[np.ndarray], result: Result) -> "Dataset":
    """Touches of a run, in the order of their ends.

    Parameters
    ----------
    rows : what the run handed to `observe`, one array after the other
    result : of the run

    Returns
    -------
    The columns that `md.records` names along "touch", from the start of the run on, with
    `long_name` and, but for pure numbers, `units` in their `attrs`:
    `touches.sel(touch=touches.time >= result.discarded)` are those behind the transient.
    """
    return _table("touch", _together(rows), result)


def landings(rows: Sequence[np.ndarray], result: Result) -> "Dataset":
    """Landings of a run: touches less than `measures.HOP` periods apart, merged.

    The last landing of each rod, which may go on, is left out.

    Parameters
    ----------
    rows, result : as of `touches`

    Returns
    -------
    The columns that `md.records` names along "landing", as of `touches`.
    """
    counted = np.insert(_together(rows), columns.WIDTH, 1, axis=1)  # touches of each: one
    over, _ = merged(counted, HOP * result.steps_per_period)
    return _table("landing", over, result).drop_vars(_OF_TOUCHES)


def _together(rows: Sequence[np.ndarray]) -> np.ndarray:
    """Rows of a list of arrays, or of one array, as (n, WIDTH)."""
    return np.vstack([np.empty((0, columns.WIDTH)), *rows])


def _table(along: str, rows: np.ndarray, result: Result) -> "Dataset":
    """Columns of rows by their names, times in periods."""
    found: dict[str, Any] = {}
    for name, column in zip(_NAMES, rows.T, strict=False):
        values: Any = column / result.steps_per_period if name in _IN_STEPS else column
        if name == "regime":
            values = [REGIMES[code] for code in values]
        found[name] = along, np.array(values, _TYPES.get(name, np.float64))
        if name == "time":
            part = column % result.steps_per_period / result.steps_per_period
            found["phase"] = along, phase_at(part)
    return labelled(found)


# Frames

# Names that OVITO knows, but for tilt; Z = 0, no element, lets ASE read a species that is none.
_FRAME = "species:S:1:pos:R:3:Z:I:1:id:I:1:orientation:R:4:aspherical_shape:R:3:velo:R:3"
_FRAME += ":omega:R:3:tilt:R:1"
_END = 1000  # bytes of the end of the last frame by which a checkpoint knows the file


class Trajectory:
    """File of frames of a run; it is opened for the first frame.

    Parameters
    ----------
    path : of the file, a plain one, as `files.writable` gives it
    scene : of the run
    per_period : frames of a period
    before : `place` of the run that a checkpoint continues, whose frames are kept while later ones
        are made again; ("", 0) if it wrote none; None: a run from its start

    Raises
    ------
    ValueError
        If a checkpoint is continued, and the file holds other frames than those before it. It is
        not changed.
    """

    def __init__(
        self, path: Path, scene: Scene, per_period: int, before: tuple[str, int] | None = None
    ):
        self.path, self.scene, self.per_period = path, scene, per_period
        self.place = "", 0  # end of the last frame, which tells it from others; its end in bytes
        self.file: BinaryIO | None = None
        if before is not None and not empty(path):
            self.place = end, kept = before
            with path.open("rb") as file:
                file.seek(kept - len(end))
                found = file.read(len(end)).decode(errors="replace")
            if not found or found != end:
                raise InputError(
                    f"trajectory {str(path)!r} does not hold the frames before the checkpoint: "
                    "name a new file, or remove the checkpoint to start again"
                )

    def write(self, rods: np.ndarray, time: float, height: float, rolling: float = 0.0) -> None:
        """Append a frame.

        Parameters
        ----------
        rods : (N, 7), columns as in `kernels`, or (N, 12) in an annulus
        time : periods since the start, at which the plate is at its lowest point
        height : of the plate, in d
        rolling : as of `kernels.contact.Inertia`; 0: rods do not turn about their axes

        Lengths are in d, velocities in sqrt(g d); beside the time stand the plate's phase in rad, d
        in cm and sqrt(g d) in cm/s. Columns: species (rod); place x, y, z; 0 (no element); number;
        orientation as a quaternion x, y, z, w that turns the z axis into the rod's; radius, radius
        and length of the cylinder between the caps; velocity; angular velocity; tilt in degrees.
        """
        if self.file is None:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self.file = self.path.open("ab")
            self.file.truncate(self.file.seek(self.place[1]))
        lines = [_head(self.scene, time, height)]
        for i, (place, turn, velocity, omega, tilt) in enumerate(_in_space(rods, rolling)):
            numbers = [*turn, 0.5, 0.5, self.scene.rods.length - 1, *velocity, *omega, tilt]
            lines.append(f"rod {_text(place)} 0 {i} {_text(numbers)}\n")
        frame = "".join(lines)
        self.file.write(frame.encode())
        self.place = frame[-_END:], self.file.tell()

    def flush(self) -> None:
        """Hand all frames to the operating system."""
        if self.file is not None:
            self.file.flush()

    def close(self) -> None:
        """Close the file; a full disk raises nothing here."""
        if self.file is not None:
            with suppress(OSError):
                self.file.close()


def _text(numbers: Iterable[float]) -> str:
    return " ".join(f"{number:.9g}" for number in numbers)


def _head(scene: Scene, time: float, height: float) -> str:
    """First two lines of a frame: number of rods, and its head."""
    wide, deep, left = scene.box.length if scene.box else 1e3, 1.0, 0.0
    if scene.annulus is not None:
        left = -scene.annulus.outer
        wide = deep = -2 * left
    cell = f"{wide!r} 0 0 0 {deep!r} 0 0 0 {scene.rods.length + 10!r}"
    corner = f"{left!r} {-deep / 2!r} 0"
    return (
        f'{scene.rods.count}\nLattice="{cell}" Origin="{corner}" Properties={_FRAME} '
        f'pbc="{"T" if scene.box else "F"} F F" Time={time!r} phase={phase_at(time):.9g} '
        f"diameter_cm={scene.rods.diameter_cm!r} cm_per_s={scene.cm_per_s!r} plate={height!r}\n"
    )


def is_trajectory(path: Path) -> bool:
    """Whether a file begins with a frame that a `Trajectory` has written.

    Parameters
    ----------
    path : of the file
    """
    with path.open("rb") as file:
        file.readline(100)
        return f" Properties={_FRAME} ".encode() in file.readline(1000)


def _in_space(rods: np.ndarray, rolling: float = 0.0) -> Iterator[tuple]:
    """Place, quaternion, velocity, angular velocity and tilt [deg] of each rod."""
    plane = rods.shape[1] == 7
    for row in np.insert(rods, [1, 3, 5, 6, 7] if plane else [], 0.0, axis=1):
        a, b, c = director = row[DIRECTOR:VELOCITY]
        across = a if plane else hypot(a, b)  # in a row tilts have a sign
        phi = atan2(across, c)
        if not across:  # points straight up or down, and may turn about any level axis
            a = across = 1.0
        part = sin(phi / 2) / across
        turn = 0.0 - b * part, a * part, 0.0, cos(phi / 2)
        spin = row[TURN:] + rolling * np.dot(row[TURN:], director) * director
        yield row[PLACE:DIRECTOR], turn, row[VELOCITY:TURN], spin, degrees(phi)
