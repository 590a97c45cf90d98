"""Trajectories as extended XYZ, with shape and orientation: OVITO draws spherocylinders from it."""

from collections.abc import Iterator
from math import acos, atan2, cos, degrees, hypot, sin, sqrt
from pathlib import Path
from typing import TextIO

import numpy as np

from .scene import Scene

__all__ = ["read_frames", "write_frame"]

_COLUMNS = "id:I:1:pos:R:3:orientation:R:4:aspherical_shape:R:3:velo:R:3:omega:R:1:tilt:R:1"


def write_frame(file: TextIO, scene: Scene, rods: np.ndarray, time: float, height: float) -> None:
    """Append a frame.

    Parameters
    ----------
    file : open for writing
    scene : of the run
    rods : (N, 7), as in `row.march`, or (N, 12), as in `space.crowd.march`
    time : periods since the start
    height : of the plate, in d

    Lengths are in d, velocities in sqrt(g d); beside the time stand d in cm and sqrt(g d) in cm/s.
    Columns: number; place x, y, z; orientation as a quaternion x, y, z, w that turns the z axis
    into the rod's; radius, radius and length of the cylinder between the caps (OVITO: particle
    shape spherocylinder); velocity; angular velocity; tilt in degrees.
    """
    wide, deep = scene.box.length if scene.box else 1e3, 1.0
    if scene.annulus is not None:
        wide = deep = 2 * scene.annulus.outer
    cell = f"{wide!r} 0 0 0 {deep!r} 0 0 0 {scene.rods.length + 10!r}"
    file.write(
        f'{len(rods)}\nLattice="{cell}" Properties={_COLUMNS} '
        f'pbc="{"T" if scene.box else "F"} F F" Time={time!r} '
        f"diameter_cm={scene.rods.diameter_cm!r} cm_per_s={scene.cm_per_s!r} plate={height!r}\n"
    )
    for i, (place, turn, velocity, omega, tilt) in enumerate(_in_space(rods)):
        numbers = [*place, *turn, 0.5, 0.5, scene.rods.length - 1, *velocity, omega, tilt]
        file.write(f"{i} {' '.join(f'{number:.9g}' for number in numbers)}\n")


def _in_space(rods: np.ndarray) -> Iterator[tuple]:
    """Of each rod place, quaternion, velocity, angular velocity and tilt [deg]."""
    for row in rods.tolist():
        if len(row) == 7:
            x, z, sine, cosine, c_x, c_z, omega = row
            phi = atan2(sine, cosine)
            turn = 0.0, sin(phi / 2), 0.0, cos(phi / 2)
            yield (x, 0.0, z), turn, (c_x, 0.0, c_z), omega, degrees(phi)
            continue
        x, y, z, a, b, c, c_x, c_y, c_z, w_x, w_y, w_z = row
        phi, across = acos(min(max(c, -1.0), 1.0)), hypot(a, b) or 1.0
        part = sin(phi / 2) / across
        turn = -b * part, a * part, 0.0, cos(phi / 2)
        size = sqrt(w_x * w_x + w_y * w_y + w_z * w_z)
        yield (x, y, z), turn, (c_x, c_y, c_z), size, degrees(phi)


def read_frames(path: str | Path) -> list[dict]:
    """Frames of a trajectory: `time`, `plate`, and arrays x, z, tilt [rad].

    Parameters
    ----------
    path : of a file that `write_frame` wrote

    Returns
    -------
    A dictionary for each frame: time in periods, lengths in d.
    """
    frames = []
    with Path(path).open() as file:
        while line := file.readline():
            count, comment = int(line), file.readline()
            after = comment.split("Time=")[1]
            table = np.loadtxt(file, max_rows=count, ndmin=2)
            frames.append(
                {
                    "time": float(after.split()[0]),
                    "plate": float(after.split("plate=")[1]),
                    "x": table[:, 1],
                    "z": table[:, 3],
                    "tilt": np.radians(table[:, -1]),
                }
            )
    return frames
