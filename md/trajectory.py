"""Trajectories as extended XYZ, with shape and orientation: OVITO draws spherocylinders from it."""

from pathlib import Path
from typing import TextIO

import numpy as np

from .scene import Scene

_COLUMNS = "id:I:1:pos:R:3:orientation:R:4:aspherical_shape:R:3:velo:R:3:omega:R:1:tilt:R:1"


def write_frame(file: TextIO, scene: Scene, rods: np.ndarray, time: float, height: float) -> None:
    """Append a frame.

    Parameters
    ----------
    file : open for writing
    scene : of the run
    rods : (N, 7), as in `row.march`
    time : periods since the start
    height : of the plate, in d

    Columns: number; place x, y, z; orientation as a quaternion x, y, z, w that turns the z axis
    into the rod's; radius, radius and length of the cylinder between the caps (OVITO: particle
    shape spherocylinder); velocity; angular velocity; tilt in degrees.
    """
    period = f"{scene.box.length!r}" if scene.box else repr(1e3)
    tilt = np.arctan2(rods[:, 2], rods[:, 3])
    reach = repr(scene.rods.length + 10)
    file.write(
        f'{len(rods)}\nLattice="{period} 0 0 0 1 0 0 0 {reach}" Properties={_COLUMNS} '
        f'pbc="{"T" if scene.box else "F"} F F" Time={time!r} plate={height!r}\n'
    )
    for i, (row, phi) in enumerate(zip(rods, tilt, strict=True)):
        x, z, _, _, c_x, c_z, omega = row
        file.write(
            f"{i} {x:.9g} 0 {z:.9g} 0 {np.sin(phi / 2):.9g} 0 {np.cos(phi / 2):.9g} "
            f"0.5 0.5 {scene.rods.length - 1:.9g} {c_x:.9g} 0 {c_z:.9g} {omega:.9g} "
            f"{np.degrees(phi):.9g}\n"
        )


def read_frames(path: str | Path) -> list[dict]:
    """Frames of a trajectory: `time`, `plate`, and arrays x, z, tilt [rad]."""
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
