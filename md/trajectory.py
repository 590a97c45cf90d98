"""Trajectories as extended XYZ, with shape and orientation, for OVITO and ASE.

In OVITO choose, under Particles, the standard shape Spherocylinder; orientation and size come from
the file. In ASE `ase.io.read("row.xyz", index=":")` gives the frames, each with the columns as
`arrays` and times and units as `info`; ASE knows no species but elements, and calls a rod X.
"""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from math import atan2, cos, degrees, hypot, sin
from pathlib import Path
from typing import BinaryIO

import numpy as np

from .domains import InputError
from .files import empty
from .kernels.codes import DIRECTOR, PLACE, TURN, VELOCITY
from .measures import phase_at
from .scene import Scene

# Names that OVITO knows, but for tilt; Z = 0, no element, lets ASE read a species that is none.
_COLUMNS = "species:S:1:pos:R:3:Z:I:1:id:I:1:orientation:R:4:aspherical_shape:R:3:velo:R:3"
_COLUMNS += ":omega:R:3:tilt:R:1"
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
        rods : (N, 7), columns as in `kernels.codes`, or (N, 12) in an annulus
        time : periods since the start, at which the plate is at its lowest point
        height : of the plate, in d
        rolling : as of `kernels.state.Effects`; 0: rods do not turn about their axes

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
        f'{scene.rods.count}\nLattice="{cell}" Origin="{corner}" Properties={_COLUMNS} '
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
        return f" Properties={_COLUMNS} ".encode() in file.readline(1000)


def _in_space(rods: np.ndarray, rolling: float = 0.0) -> Iterator[tuple]:
    """Place, quaternion, velocity, angular velocity and tilt [deg] of each rod."""
    plane = rods.shape[1] == 7
    for row in np.insert(rods, [1, 3, 5, 6, 7] if plane else [], 0.0, axis=1):
        a, b, c = director = row[DIRECTOR:VELOCITY]
        across = a if plane else hypot(a, b)  # in a row tilts have a sign
        phi = atan2(across, c)
        part = sin(phi / 2) / (across or 1.0)
        turn = 0.0 - b * part, a * part, 0.0, cos(phi / 2)
        spin = row[TURN:] + rolling * np.dot(row[TURN:], director) * director
        yield row[PLACE:DIRECTOR], turn, row[VELOCITY:TURN], spin, degrees(phi)
