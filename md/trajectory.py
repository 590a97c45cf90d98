"""Trajectories as extended XYZ, with shape and orientation, for OVITO and ASE.

In OVITO choose, under Particles, the standard shape Spherocylinder; orientation and size come from
the file. In ASE `ase.io.read("row.xyz", index=":")` gives the frames, each with the columns as
`arrays` and times and units as `info`; ASE knows no species but elements, and calls a rod X.
"""

import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from math import acos, atan2, cos, degrees, hypot, sin
from pathlib import Path

import numpy as np

from .domains import InputError
from .files import plain, writable
from .kernels.codes import DIRECTOR, PLACE, TURN, VELOCITY
from .measures import phase_at
from .scene import Scene

__all__ = ["Trajectory", "checked"]

# Names that OVITO knows, but for tilt; Z = 0, no element, lets ASE read a species that is none.
_COLUMNS = "species:S:1:pos:R:3:Z:I:1:id:I:1:orientation:R:4:aspherical_shape:R:3:velo:R:3"
_COLUMNS += ":omega:R:3:tilt:R:1"


def checked(path: str | Path) -> Path:
    """Path of a trajectory to be written, refused where the file holds anything else.

    Parameters
    ----------
    path : of the file, which is not changed

    Raises
    ------
    ValueError
        If the file holds anything else, or cannot be written.
    """
    writable("trajectory", path, _is_trajectory, "one of frames")
    return plain(path)


class Trajectory:
    """Open file of frames of a run.

    A run that goes on from a checkpoint keeps the frames before it and makes the later ones again.

    Parameters
    ----------
    path : of the file: a new one, or one of frames
    scene : of the run
    per_period : frames of a period
    begin : periods made before
    end : periods to be made in all

    Raises
    ------
    ValueError
        If the file holds anything else, frames of a longer run that would be lost, of another scene
        or others than the run had so far, if it would hold none, or if it cannot be written. It is
        not changed.
    """

    def __init__(self, path: str | Path, scene: Scene, per_period: int, begin: float, end: int):
        self.path, self.scene, self.per_period = checked(path), scene, per_period
        self.kept: int | None = 0  # bytes, until the first frame follows them
        there, times = "", list[float]()
        if begin > 0 and self.path.exists():
            self.kept, times, there = _frames_before(begin, self.path)
        before = [time for time in times if time < begin]
        wanted = (begin - before[0]) * per_period if before else 0.0
        wrong = ""
        if there not in ("", _of_scene(_head(scene, 0.0, 0.0))):
            wrong = "is of another scene"
        elif times and times[-1] > end:
            wrong = f"goes on to period {times[-1]:.6g}, beyond the {end} asked for"
        elif before and not -0.5 < len(before) - wanted < 2:  # a frame is up to a step late
            wrong = f"has {len(before)} frames before period {begin:.6g}, not {wanted:.0f}"
        elif not before and begin >= end:
            wrong = f"would hold no frame, as {begin:.6g} periods are made already"
        if wrong:
            remedy = f"{'name a new file' if before else 'ask for more'}, or remove the checkpoint"
            raise InputError(f"trajectory {str(path)!r} {wrong}: {remedy} to start again")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self.path.touch()
        self.file = self.path.open("r+", encoding="utf-8")

    def write(self, rods: np.ndarray, time: float, height: float) -> None:
        """Append a frame.

        Parameters
        ----------
        rods : (N, 7), columns as in `kernels.codes`, or (N, 12) in an annulus
        time : periods since the start, at which the plate is at its lowest point
        height : of the plate, in d

        Lengths are in d, velocities in sqrt(g d); beside the time stand the plate's phase in rad, d
        in cm and sqrt(g d) in cm/s. Columns: species (rod); place x, y, z; 0 (no element); number;
        orientation as a quaternion x, y, z, w that turns the z axis into the rod's; radius, radius
        and length of the cylinder between the caps; velocity; angular velocity; tilt in degrees.
        """
        if self.kept is not None:
            self.file.truncate(self.file.seek(self.kept))
            self.kept = None
        self.file.write(_head(self.scene, time, height))
        for i, (place, turn, velocity, omega, tilt) in enumerate(_in_space(rods)):
            numbers = [*turn, 0.5, 0.5, self.scene.rods.length - 1, *velocity, *omega, tilt]
            self.file.write(f"rod {_text(place)} 0 {i} {_text(numbers)}\n")

    def flush(self) -> None:
        """Hand all frames to the operating system."""
        self.file.flush()

    def close(self) -> None:
        """Close the file; a full disk raises nothing here."""
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


def _of_scene(head: str) -> str:
    """First two lines of a frame without what changes from frame to frame of a scene."""
    return re.sub(r" (Time|phase|plate)=\S+", "", head)


def _frames_before(begin: float, path: Path) -> tuple[int | None, list[float], str]:
    """Read the frames of a file.

    Returns the bytes of those before `begin`, the times of all frames in periods, and the scene as
    `_of_scene` tells it.
    """
    kept, place = 0, 0
    times, scene, count = [], "", b""
    with path.open("rb") as lines:
        for line in lines:
            place += len(line)
            if head := re.search(rb" Time=([\d.e+-]+) ", line):
                times.append(float(head[1]))
                scene = _of_scene((count + line).decode())
            elif line.startswith(b"rod ") and times[-1] < begin:
                kept = place
            count = line  # if a head follows
    return kept, times, scene


def _is_trajectory(path: Path) -> bool:
    """Whether a file begins with a frame that a `Trajectory` has written."""
    with path.open("rb") as file:
        file.readline(100)
        return f" Properties={_COLUMNS} ".encode() in file.readline(1000)


def _in_space(rods: np.ndarray) -> Iterator[tuple]:
    """Place, quaternion, velocity, angular velocity and tilt [deg] of each rod."""
    for row in rods.tolist():
        if len(row) == 7:
            x, z, sine, cosine, c_x, c_z, omega = row
            phi = atan2(sine, cosine)
            turn = 0.0, sin(phi / 2), 0.0, cos(phi / 2)
            yield (x, 0.0, z), turn, (c_x, 0.0, c_z), (0.0, omega, 0.0), degrees(phi)
            continue
        a, b, c = row[DIRECTOR:VELOCITY]
        phi, across = acos(min(max(c, -1.0), 1.0)), hypot(a, b) or 1.0
        part = sin(phi / 2) / across
        turn = -b * part, a * part, 0.0, cos(phi / 2)
        yield row[PLACE:DIRECTOR], turn, row[VELOCITY:TURN], row[TURN:], degrees(phi)
