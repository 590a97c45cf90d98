"""Trajectories as extended XYZ, with shape and orientation, for OVITO and ASE.

In OVITO choose, under Particles, the standard shape Spherocylinder; orientation and size come from
the file. In ASE `ase.io.read("row.xyz", index=":")` gives the frames, each with the columns as
`arrays` and times and units as `info`; ASE knows no species but elements, and calls a rod X.
"""

import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import suppress
from math import acos, atan2, cos, degrees, hypot, sin
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from .domains import InputError
from .files import empty, plain, same
from .kernels.codes import DIRECTOR, PLACE, TURN, VELOCITY
from .measures import phase_at
from .scene import Scene

__all__ = ["Trajectory", "check_continues", "is_trajectory", "read_frames"]

# Names that OVITO knows, but for tilt; Z = 0, no element, lets ASE read a species that is none.
_COLUMNS = "species:S:1:pos:R:3:Z:I:1:id:I:1:orientation:R:4:aspherical_shape:R:3:velo:R:3"
_COLUMNS += ":omega:R:3:tilt:R:1"
_LAST = 2**20  # bytes before its end that hold the head of the last frame
_TAIL = 2**16  # bytes before its end by which a file is known again


class Trajectory:
    """File of frames of a run under way, and its state for a checkpoint.

    Parameters
    ----------
    path : of the file; frames beyond the checkpoint are cut off
    per_period : frames of a period
    kept : state that the checkpoint holds; None: the file is new
    """

    def __init__(self, path: str | Path, per_period: int, kept: dict[str, Any] | None = None):
        self.path, self.per_period = plain(path), per_period
        self.count = kept["frames"] if kept else 0
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self.path.touch()
        self.file = self.path.open("r+", encoding="utf-8")
        self.file.truncate(self.file.seek(kept["size"] if kept else 0))

    def write(self, scene: Scene, rods: np.ndarray, time: float, height: float) -> None:
        """Append a frame.

        Parameters
        ----------
        scene : of the run
        rods : (N, 7), columns as in `kernels.codes`, or (N, 12) in an annulus
        time : periods since the start, at which the plate is at its lowest point
        height : of the plate, in d

        Lengths are in d, velocities in sqrt(g d); beside the time stand the plate's phase in rad, d
        in cm and sqrt(g d) in cm/s. Columns: species (rod); place x, y, z; 0 (no element); number;
        orientation as a quaternion x, y, z, w that turns the z axis into the rod's; radius, radius
        and length of the cylinder between the caps; velocity; angular velocity; tilt in degrees.
        """
        wide, deep, left = scene.box.length if scene.box else 1e3, 1.0, 0.0
        if scene.annulus is not None:
            left = -scene.annulus.outer
            wide = deep = -2 * left
        cell = f"{wide!r} 0 0 0 {deep!r} 0 0 0 {scene.rods.length + 10!r}"
        corner = f"{left!r} {-deep / 2!r} 0"
        self.file.write(
            f'{len(rods)}\nLattice="{cell}" Origin="{corner}" Properties={_COLUMNS} '
            f'pbc="{"T" if scene.box else "F"} F F" Time={time!r} phase={phase_at(time):.9g} '
            f"diameter_cm={scene.rods.diameter_cm!r} cm_per_s={scene.cm_per_s!r} plate={height!r}\n"
        )
        for i, (place, turn, velocity, omega, tilt) in enumerate(_in_space(rods)):
            numbers = [*turn, 0.5, 0.5, scene.rods.length - 1, *velocity, *omega, tilt]
            self.file.write(f"rod {_text(place)} 0 {i} {_text(numbers)}\n")
        self.count += 1

    def state(self) -> dict[str, Any]:
        """State by which the file is known again: path, size, frames, digest of its end."""
        self.file.flush()
        size = os.fstat(self.file.fileno()).st_size
        found = {"path": str(self.path), "size": size, "frames": self.count}
        return {**found, "per_period": self.per_period, "tail": _tail(self.path, size)}

    def close(self) -> None:
        """Close the file; a full disk is no error here."""
        with suppress(OSError):
            self.file.close()


def _text(numbers: Iterable[float]) -> str:
    return " ".join(f"{number:.9g}" for number in numbers)


def _tail(path: Path, size: int) -> str:
    """Digest of the last bytes of the first `size` ones of a file."""
    with path.open("rb") as file:
        file.seek(max(size - _TAIL, 0))
        return hashlib.sha256(file.read(min(size, _TAIL))).hexdigest()


def _last_time(path: Path) -> float:
    """Time of the last whole head of a frame in a file, in periods."""
    with path.open("rb") as file:
        file.seek(max(path.stat().st_size - _LAST, 0))
        times = re.findall(rb" Time=([\d.e+-]+) ", file.read())
    return float(times[-1]) if times else 0.0


def check_continues(
    path: str | Path | None,
    per_period: int,
    periods: int,
    kept: dict[str, Any] | None,
    checkpoint: str | Path,
) -> None:
    """Refuse a trajectory that a resumed run cannot continue; no file is changed.

    Parameters
    ----------
    path, per_period : of the trajectory asked for; None: none
    periods : asked for
    kept : state of the trajectory in the checkpoint; None: it was saved without one
    checkpoint : path, for the message

    Raises
    ------
    ValueError
        If these are different trajectories, or the frames in the file were changed.
    """
    why, name = "", repr(str(path))
    size = 0 if path is None or empty(path) else Path(path).stat().st_size
    if path is None or kept is None:
        if kept is not None:
            why = f"trajectory is missing: name {kept['path']!r}, which belongs to it"
        elif size:
            why = f"trajectory must be a new file, got {name}: before, there was none"
    elif not same(path, kept["path"]) and Path(kept["path"]).exists():  # else it was moved
        why = f"trajectory must be {kept['path']!r}, got {name}"
    elif per_period != kept["per_period"]:
        why = f"frames must be {kept['per_period']} as before, got {per_period}"
    elif size < kept["size"] or (size and _tail(Path(path), kept["size"]) != kept["tail"]):
        why = f"trajectory {name} was changed: its first {kept['frames']} frames are not as before"
    elif size > kept["size"] and (last := _last_time(Path(path))) > periods:
        # Frames after those of the checkpoint, of a run that was killed, are written again.
        why = f"trajectory {name} goes on to period {last:.6g}, beyond the {periods} asked for"
    if why:
        raise InputError(f"{why}; or remove checkpoint {checkpoint} to start again")


def is_trajectory(path: Path) -> bool:
    """Whether a file begins with a frame of a `Trajectory`.

    Parameters
    ----------
    path : of the file
    """
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


def read_frames(path: str | Path) -> list[dict]:
    """Frames of a trajectory: `time`, `plate`, and arrays x, z, tilt [rad].

    Parameters
    ----------
    path : of the file of a `Trajectory`

    Returns
    -------
    A dictionary for each frame: time in periods, lengths in d.

    Raises
    ------
    ValueError
        If the file is not a trajectory, or ends in the middle of a frame.
    """
    frames: list[dict] = []
    try:
        with plain(path).open(encoding="utf-8") as file:
            while line := file.readline():
                frames.append(_frame(int(line), file))
    except (ValueError, IndexError):
        raise InputError(
            f"{path} is not a trajectory of md, or cut short: frame {len(frames)} cannot be read"
        ) from None
    return frames


def _frame(count: int, file: TextIO) -> dict:
    """Next frame of a file, with `count` rods."""
    after = file.readline().split("Time=")[1]
    lines = [file.readline() for _ in range(count)]
    if not lines[-1].endswith("\n"):
        raise InputError("cut short")
    table = np.loadtxt(lines, ndmin=2, usecols=(1, 3, -1))
    return {
        "time": float(after.split()[0]),
        "plate": float(after.split("plate=")[1]),
        "x": table[:, 0],
        "z": table[:, 1],
        "tilt": np.radians(table[:, 2]),
    }
