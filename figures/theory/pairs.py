"""Two bodies that meet: what a landing hands from rod to rod, and a ball on a bat.

(a) Parallel rods of a row (l = 9.5 d), each touching the next, fall straight down without spin; one
lands first (epsilon = 0.65, mu = 0.3). What it gains along the row from the plate, and what its
lower end then hands to the rod behind it and its upper end to the one ahead, each hit taken alone
(epsilon = 0.9 between rods, mu = 0.3 or none). From 25 degrees on the tip slips back. (b), (c) A
baseball of 145 g comes at 40 m/s, without friction, as a fast ball (1800 rpm backspin) and as a
curve ball (1800 rpm topspin), and is met by a bat of 0.9 kg at 30 m/s; friction 0.3, restitution
0.5. Both are seen along the bat, which counts as a free cylinder. The offset is that of the ball's
centre over the bat's axis; beyond the kinks the ball slips off.
"""

from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from impact import Body, collide, collide_pair, spherocylinder

from ..lib.style import BLACK, BLUE, RED, Data, name_panels, style, tilt_axis

LENGTH = 9.5  # of the rods, over the diameter
PLATE = {"friction": 0.3, "restitution": 0.65}
RODS_RESTITUTION, RODS_FRICTION = 0.9, (0.0, 0.3)
BALL = 0.145, 0.0366, 0.0366 * np.sqrt(2 / 5)  # mass in kg, radius and k in m: solid sphere
BAT = 0.9, 0.033, 0.033 * np.sqrt(1 / 2)  # solid cylinder
SPEEDS = 40.0, 30.0  # of ball and bat, m/s
SPIN = 1800 * np.pi / 30  # rad/s
BAT_RESTITUTION, BAT_FRICTION = 0.5, 0.3
PITCHES = {"fast": (SPIN, BAT_FRICTION), "curve": (-SPIN, BAT_FRICTION), "smooth": (0.0, 0.0)}


def meeting(normal: tuple, first: tuple, second: tuple, **how: Any) -> tuple[Any, Any, Any]:
    """Change of velocity along x and z, and of spin, of the first body.

    Parameters
    ----------
    normal : unit vector (x, z) from the second body to the first
    first, second : mass, k, centre of mass from the contact point, velocity (both x, z), spin
    """
    n_x, n_z = normal

    def body(mass, k, centre, velocity, omega):
        turned = ((x * n_z - z * n_x, x * n_x + z * n_z) for x, z in (centre, velocity))
        return Body(mass, k, *next(turned), *next(turned), omega)

    one = body(*first)
    hit = collide_pair(one, body(*second), **how)
    along, across = hit.P_x / one.mass, hit.P_z / one.mass
    return along * n_z + across * n_x, across * n_z - along * n_x, hit.first.omega - one.omega


def _row(n: int) -> Data:
    """Velocities along the row, in |c_z|, over tilt [rad]."""
    tilt = np.linspace(0, np.radians(75), n)
    rod = spherocylinder(tilt, LENGTH)
    landed = collide(0.0, -1.0, geometry=rod, **PLATE)
    sin, cos = np.sin(tilt), np.cos(tilt)
    half, shift = (LENGTH - 1) / 2, np.tan(tilt)  # of neighbours along themselves
    handed: dict[str, list] = {"behind": [], "ahead": []}
    for side, found in zip((-1, 1), handed.values(), strict=True):
        # from the contact point: the neighbour by half a diameter, the rod by its end
        across, end = side * cos / 2, side * half
        own = -across - end * sin, side * sin / 2 - end * cos
        reach = side * shift - end
        other = across + reach * sin, -side * sin / 2 + reach * cos
        falling = (1.0, rod.k, other, (0.0, -1.0), 0.0)
        landing = (1.0, rod.k, own, (landed.c_x, landed.c_z), landed.omega)
        for friction in RODS_FRICTION:
            how = {"friction": friction, "restitution": RODS_RESTITUTION}
            found.append(meeting((side * cos, -side * sin), falling, landing, **how)[0])
    return {"tilt": tilt, "plate": landed.c_x, **{k: np.array(v) for k, v in handed.items()}}


def _bat(n: int) -> Data:
    """Speed [m/s], launch angle [rad] and spin [rad/s] of the batted ball over the offset [m]."""
    (ball, radius, k), (bat, bat_radius, bat_k), (speed, bat_speed) = BALL, BAT, SPEEDS
    n_z = np.linspace(0, 0.9, n)
    n_x, d = np.sqrt(1 - n_z**2), {"offset": n_z * (radius + bat_radius)}
    met = bat, bat_k, (-bat_radius * n_x, -bat_radius * n_z), (bat_speed, 0.0), 0.0
    for name, (omega, friction) in PITCHES.items():
        pitched = ball, k, (radius * n_x, radius * n_z), (-speed, 0.0), omega
        how = {"friction": friction, "restitution": BAT_RESTITUTION}
        dc_x, dc_z, turn = meeting((n_x, n_z), pitched, met, **how)
        d[f"{name}_speed"] = np.hypot(dc_x - speed, dc_z)
        d[f"{name}_angle"] = np.arctan2(dc_z, dc_x - speed)
        d[f"{name}_backspin"] = -(omega + turn)
    return d


def data(quick: bool = False) -> Data:
    """What rods of a row hand on over tilt, and a batted ball over the offset of the hit."""
    n = 61 if quick else 401
    return _row(n) | _bat(n)


def _draw_row(ax, d: Data) -> None:
    tilt_deg = np.degrees(d["tilt"])
    ax.plot(tilt_deg, d["plate"], color=BLACK, label="from the plate")
    for name, colour in (("behind", BLUE), ("ahead", RED)):
        smooth, rough = d[name]
        ax.plot(tilt_deg, rough, color=colour, label=f"to the rod {name}")
        ax.plot(tilt_deg, smooth, "--", color=colour)
    ax.plot([], [], "--", color="0.5", label="the same, smooth rods")
    ax.axhline(0, color="0.5", lw=0.6)
    ax.set(ylabel=r"gain of velocity $c_x$ / $|c_z|$", ylim=(-0.4, 0.95))
    ax.legend()
    tilt_axis(ax, 0, 75)


@style
def draw(d: Data) -> plt.Figure:
    figure, axes = plt.subplots(1, 3, figsize=(7.0, 2.6))
    _draw_row(axes[0], d)
    looks = {"fast": (RED, "-", "fast ball"), "curve": (BLUE, "-", "curve ball")}
    looks["smooth"] = (BLACK, "--", "no friction, no spin")
    for name, (colour, form, label) in looks.items():
        look = {"color": colour, "ls": form, "label": label}
        axes[1].plot(1e3 * d["offset"], d[f"{name}_speed"], **look)
        axes[2].plot(1e3 * d["offset"], d[f"{name}_backspin"] * 30 / np.pi / 1e3, **look)
    axes[1].set(ylabel="speed of the batted ball (m/s)")
    axes[2].set(ylabel="its backspin (1000 rpm)")
    axes[2].axhline(0, color="0.5", lw=0.6)
    axes[1].legend(loc="lower left")
    for ax in axes[1:]:
        ax.set(xlabel="offset of the hit (mm)", xlim=(0, 65))
    name_panels(axes, ("rods of a row", "ball on a bat", "ball on a bat"))
    return figure
