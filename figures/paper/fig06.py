"""Fig. 6: velocities of the row's rods before and after a landing, and of the plate, over tilt.

Dots: every touch of the plate, mean and standard error over independent starts. Squares: touches
less than 0.2 periods apart taken as one landing. Lines: the theory's closure at V_z = V_0/2
(c_x' = c_x, c_z' = -c_z, no spin) for the same rod.

Look at (a): before a landing there is hardly any spin. Below some 13 degrees there is none after it
either: the row bounces as one block. In (b) and (c) the two kinds of mean part company: a rod that
is hit again at once does not fall in between.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from impact import drift

from ..claims.over_tilt import OF_BOTH_SIDES
from ..lib.runs import along_lean, means, row_of, tilt_plan, tilt_sweeps
from ..lib.style import (
    BLACK,
    ORANGE,
    RIGID,
    THEORY,
    Data,
    curve,
    name_panels,
    note,
    style,
    tilt_axis,
    zero_line,
)

VELOCITY_MEANS = {  # name here: name in the store
    **OF_BOTH_SIDES,
    "plate": "touches.plate_velocity.mean",
    "plate_by_speed": "touches.plate_velocity_by_speed.mean",
    "landing_plate": "landings.plate_velocity.mean",
    "tilt_deg": "tilt_deg",
}

sweeps = tilt_sweeps


def data(quick: bool = False, scene: str | None = None) -> Data:
    """Means over touches and over landings; cm/s and rad/s, the plate's velocity in V_0."""
    row = row_of(scene)
    found = means(tilt_plan(quick, scene=scene), VELOCITY_MEANS, along_lean)
    cm_per_s, plate = row.scene.cm_per_s, row.scene.plate
    second = plate.frequency_hz / row.scene.frequency  # in sqrt(d/g)
    for part, unit in {"c_x": cm_per_s, "c_z": cm_per_s, "omega": second}.items():
        found |= {name: found[name] * unit for name in found if part in name}
    fine, half = np.radians(np.linspace(1, 89, 177)), row.scene.plate_speed * cm_per_s / 2
    line = drift(row.rod(fine), **row.setting, plate_velocity=half)
    return {
        **found,
        "fine_deg": np.degrees(fine),
        "line_c_x": line.c_x,
        "line_c_z": line.c_z,
        "words": row.words,
    }


def _pair(ax, d, name: str, label: str, sign: int = 1):
    """Draw a velocity before (black) and after (orange), of touches and of landings."""
    before = "before", BLACK, sign, f"-{label}" if sign < 0 else label
    for side, colour, turn, symbol in (before, ("after", ORANGE, 1, f"{label}'")):
        for prefix, form, kind in (("", "o-", "touches"), ("landing_", "s-", "landings")):
            curve(
                ax,
                d,
                "tilt_deg",
                f"{prefix}{name}_{side}",
                colour,
                f"${symbol}$, {kind}",
                form=form,
                scale=turn,
                hollow=bool(prefix),
                ms=2.7,
            )


@style
def draw(d: Data) -> Figure:
    figure, axes = plt.subplots(2, 2, figsize=(7.0, 5.0))
    (a, b), (c, e) = axes
    _pair(a, d, "omega", r"\omega")
    a.set_ylabel(r"angular velocity (rad/s)")
    _pair(b, d, "c_z", "c_z", -1)
    b.plot(d["fine_deg"], d["line_c_z"], color=THEORY, label=r"(25), (28), $V_0/2$")
    b.set_ylabel("vertical velocity (cm/s)")
    _pair(c, d, "c_x", "c_x")
    c.plot(d["fine_deg"], d["line_c_x"], color=THEORY, label=r"(24), (27), $V_0/2$")
    c.set_ylabel("horizontal velocity (cm/s)")
    curve(e, d, "tilt_deg", "plate", BLACK, "touches, each alike")
    curve(e, d, "tilt_deg", "plate_by_speed", RIGID, r"touches, as their $v_0$", form="^-")
    curve(e, d, "tilt_deg", "landing_plate", BLACK, "landings", form="s-", hollow=True)
    e.axhline(0.5, color=THEORY, label="(31): 1/2")
    bottom = min(0, d["plate"].min() - 0.05) - 0.2  # with room for the legend
    e.set(ylabel=r"plate at landing, $V_z/V_0$", ylim=(bottom, 1))
    for ax in axes.flat:
        tilt_axis(ax)
        zero_line(ax)
        ax.legend()
    name_panels(axes.flat, [""] * 4)
    note(figure, d["words"])
    return figure
