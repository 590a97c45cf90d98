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

from impact import drift

from ..lib.row_runs import (
    FRICTION,
    OF_TILT_SCAN,
    RESTITUTION,
    ROW,
    means,
    paper_rod,
    plate_speed_cm_s,
    tilt_scan,
)
from ..lib.style import BLACK, BLUE, RED, name_panel, style, tilt_axis

VELOCITIES = [f"{name}_{side}" for name in ("c_x", "c_z", "omega") for side in ("before", "after")]
MEANS = {  # name here: name in the store
    **{name: f"touches.{name}.mean" for name in VELOCITIES},
    **{f"merged_{name}": f"landings.{name}.mean" for name in VELOCITIES},
    "plate": "touches.plate_velocity.mean",
    "plate_by_speed": "touches.plate_velocity_by_speed.mean",
    "merged_plate": "landings.plate_velocity.mean",
    "tilt_deg": "tilt_deg",
}


def data(quick: bool = False) -> dict[str, np.ndarray]:
    """Means over touches and over landings; cm/s and rad/s, the plate's velocity in V_0."""
    from md.scene import from_tables

    scene = from_tables(ROW)
    nominal, sweep = tilt_scan(quick)
    found = {"nominal_deg": nominal, **means(sweep, MEANS)}
    per_second = scene.frequency  # in reduced units: sqrt(d/g) lasts frequency/60 s
    for name, values in found.items():
        if "c_x" in name or "c_z" in name:
            found[name] = values * scene.cm_per_s
        if "omega" in name:
            found[name] = values * scene.plate.frequency_hz / per_second
    fine = np.radians(np.linspace(1, 89, 177))
    line = drift(
        paper_rod(fine),
        friction=FRICTION,
        restitution=RESTITUTION,
        plate_velocity=plate_speed_cm_s() / 2,
    )
    return {
        **found,
        "speed": np.float64(plate_speed_cm_s()),
        "fine_deg": np.degrees(fine),
        "line_c_x": line.c_x,
        "line_c_z": line.c_z,
    }


def _pair(ax, d: dict, name: str, sign: int = 1, label: str = "") -> None:
    """Before in black, after in red; a touch each, and landings."""
    for side, colour, turn in (("before", BLACK, sign), ("after", RED, 1)):
        for prefix, marker, size in (("", "o", 2.6), ("merged_", "s", 2.8)):
            key = f"{prefix}{name}_{side}"
            if key in d:
                look = {"mfc": "white" if prefix else colour, "mew": 0.7, "lw": 0.5}
                prime = "'" if side == "after" else ""
                minus = "-" if turn < 0 else ""
                text = rf"${minus}{label}{prime}$, " + ("landings" if prefix else "touches")
                ax.errorbar(
                    *(d["tilt_deg"], turn * d[key], d[f"{key}_error"]),
                    fmt=f"{marker}-",
                    color=colour,
                    ms=size,
                    elinewidth=0.6,
                    label=text,
                    **look,
                )


@style
def draw(d: dict[str, np.ndarray]) -> plt.Figure:
    figure, axes = plt.subplots(2, 2, figsize=(7.0, 5.0))
    (a, b), (c, e) = axes
    _pair(a, d, "omega", 1, r"\omega")
    a.set_ylabel(r"angular velocity (rad/s)")
    _pair(b, d, "c_z", -1, "c_z")
    b.plot(d["fine_deg"], d["line_c_z"], color=BLUE, label=r"(30), $V_0/2$")
    b.set_ylabel("vertical velocity (cm/s)")
    _pair(c, d, "c_x", 1, "c_x")
    c.plot(d["fine_deg"], d["line_c_x"], color=BLUE, label=r"(24), (29), $V_0/2$")
    c.set_ylabel("horizontal velocity (cm/s)")
    for key, look in (
        ("plate", {"fmt": "o-", "color": BLACK, "label": "touches, each alike"}),
        ("plate_by_speed", {"fmt": "^-", "color": RED, "label": r"touches, as their $v_0$"}),
        ("merged_plate", {"fmt": "s-", "color": BLACK, "mfc": "white", "label": "landings"}),
    ):
        e.errorbar(d["tilt_deg"], d[key], d[f"{key}_error"], ms=2.6, lw=0.5, elinewidth=0.6, **look)
    e.axhline(0.5, color=BLUE, label="(31): 1/2")
    e.set(ylabel=r"plate at landing, $V_z/V_0$", ylim=(min(0, d["plate"].min() - 0.05), 1))
    for letter, ax in zip("abcd", axes.flat, strict=True):
        tilt_axis(ax)
        ax.axhline(0, color="0.7", lw=0.6)
        ax.legend(fontsize=5.5)
        name_panel(ax, letter)
    figure.supxlabel(OF_TILT_SCAN, fontsize=7)
    return figure


def summary(d: dict[str, np.ndarray]) -> str:
    """Both kinds of means, a row a tilt."""
    lines = [
        "Fig. 6. Touches; in brackets landings (touches within 0.2 periods as one); +- one s.e.",
        " tilt   omega   omega'  |  c_x (cm/s)    c_x' (cm/s)  |  -c_z/c_z'        V_z/V_0",
    ]
    for i, tilt in enumerate(d["tilt_deg"]):
        ratio = -d["c_z_before"][i] / d["c_z_after"][i]
        merged = -d["merged_c_z_before"][i] / d["merged_c_z_after"][i]
        lines.append(
            f"{tilt:5.1f} {d['omega_before'][i]:7.2f} {d['omega_after'][i]:7.2f}  | "
            + " ".join(
                f"{d[n][i]:6.2f}+-{d[f'{n}_error'][i]:.2f} ({d[f'merged_{n}'][i]:.2f})"
                for n in ("c_x_before", "c_x_after")
            )
            + f" | {ratio:5.2f} ({merged:.2f})  "
            f"{d['plate'][i]:.3f}+-{d['plate_error'][i]:.3f} ({d['merged_plate'][i]:.3f})"
        )
    return "\n".join(lines)
