"""Numbers of a row over its tilt under one contact law: claims S2, S3, S10-S14, S16, S21 and S22.

`judge` takes them of the paper's row, `any_rods` of rows of rods of many kinds.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from impact import drift, landing_density, thin_rod
from md.sweep import Sweep

from ..lib.runs import SETTING, Read, drift_and_tilt, gathered, means
from ..lib.style import Data
from .limits import ONE_STATE_DEG, read
from .uncertainty import Numbers, crossing, measures, rms

SMALL_DEG, LARGE_DEG = 20, 30  # a small tilt is below the one, a large one above the other
BUMP_DEG, BUMP_WIDTH_DEG, BUMP_REACH_DEG = 30, 4, 15  # place, width and what is looked at around it
CLEAR = 3.0  # standard errors from which on a drift counts as one

BOTH_SIDES = [f"{name}_{side}" for name in ("c_x", "c_z", "omega") for side in ("before", "after")]
OF_BOTH_SIDES = {
    **{name: f"touches.{name}.mean" for name in BOTH_SIDES},
    **{f"landing_{name}": f"landings.{name}.mean" for name in BOTH_SIDES},
}
STORED = {  # name in a table: name in the store; landings: `landing_`, flight, falling, touches
    "tilt": "tilt_deg",
    "c_x": "c_x_cm_s",
    **OF_BOTH_SIDES,
    "V_z": "touches.plate_velocity.mean",
    "V_z_by_speed": "touches.plate_velocity_by_speed.mean",
    "restitution": "touches.restitution.mean",
    "slide": "touches.slide.mean",
    "pushed": "touches.pushed_by_others.mean",
    "contact": "touches.contact_periods.mean",
    "flight": "landings.flight_periods.mean",
    "falling": "landings.falling.mean",
    "touches": "landings.touches.mean",
}
Table = Mapping[str, np.ndarray]


def table(sweep: Sweep, nominal: np.ndarray, own: bool = False, read: Read = gathered) -> Data:
    """Means over the starts of a sweep over tilt, with their standard errors; the theory's drift.

    The errors of drift and tilt are those between the starts or within them, whichever is larger.

    Parameters
    ----------
    sweep : rows over the length of the box, then over starts
    nominal : tilts [deg] that the lengths of the box give
    own : whether the theory has the friction and restitution of the row's plate, else the paper's
    read : `runs.gathered`, or `runs.along_lean`
    """
    scene = sweep.points[0].scene
    setting, plate = SETTING, scene.contacts.plate
    if own and plate:
        setting = {"friction": plate.friction, "restitution": plate.law.restitution}
    tilt = np.linspace(0.5, 89.5, 357)
    c_x = drift(thin_rod(np.radians(tilt)), **setting).c_x * scene.plate_speed * scene.cm_per_s / 2
    return {
        "nominal": nominal,
        "half_length": scene.rods.length / 2,
        "speed": scene.plate_speed,
        "theory_tilt": tilt,
        "theory_c_x": c_x,
        **means(sweep, STORED, read),
        **drift_and_tilt(sweep, read=read),
    }


def theory(d: Table, tilt_deg: np.ndarray) -> np.ndarray:
    """Drift [cm/s] of a thin rod at these tilts, with V_z = V_0/2."""
    return np.interp(tilt_deg, d["theory_tilt"], d["theory_c_x"])


def _mean(name: str, above: float = 0, below: float = 90) -> Callable[[Table], float]:
    """Mean of an array of a table over the tilts between two, in degrees."""
    return lambda d: d[name][(d["nominal"] > above) & (d["nominal"] < below)].mean()


def change_tilt(d: Table) -> float:
    """Tilt at which flights pass half way from the longest to one period; inf if they never do."""
    longest = np.argmax(d["flight"])  # a nan counts as the largest
    tilt, flight = d["nominal"][longest:], d["flight"][longest:]
    if not flight[0] > 1:
        return np.inf
    return crossing(tilt, flight, (flight[0] + 1) / 2)


def _sharp(d: Table) -> float:
    """Part of the change of flights that happens between 25 and 35 degrees."""
    before, after = np.interp([25, 35], d["nominal"], d["flight"])
    return (before - after) / (d["flight"].max() - 1)


def bump(d: Table) -> float:
    """Height of a bump at 30 degrees over the drift around it: a fit.

    Fitted is a parabola over tilt and a bell, from 15 to 45 degrees; both numbers are linear in the
    drift, so that their errors follow from its errors.
    """
    off = d["nominal"] - BUMP_DEG
    near = np.abs(off) <= BUMP_REACH_DEG
    x, c_x = off[near] / BUMP_REACH_DEG, d["c_x"][near]
    bell = np.exp(-((off[near] / BUMP_WIDTH_DEG) ** 2) / 2)
    level, _, _, height = np.linalg.lstsq(np.stack([x**0, x, x**2, bell]).T, c_x, rcond=None)[0]
    return height / level


def _turned(d: Table, kind: str = "") -> np.ndarray:
    return -d[f"{kind}c_z_before"] / d[f"{kind}c_z_after"]


def _kept(d: Table, kind: str = "") -> float:
    return rms(1 - d[f"{kind}c_x_before"] / d[f"{kind}c_x_after"])


def _off_theory(d: Table) -> float:
    expected = theory(d, d["tilt"])
    return rms(d["c_x"] - expected) / rms(expected)


@measures("S14", "fig08")
def phases(d: Table) -> Numbers:
    """Share of the touches that would have to move to give the paper's density of phases."""
    return {"distance": lambda d: np.pi * np.abs(d["density"] - landing_density(d["phase"])).mean()}


_falling_small = _mean("falling", below=SMALL_DEG)
_falling_large = _mean("falling", above=LARGE_DEG)
NUMBERS: dict[str, Callable[[Table], Any]] = {  # claim and key, as in claims.toml
    "S2.rms": lambda d: rms(d["tilt"] - d["nominal"]),
    "S2.largest": lambda d: np.abs(d["tilt"] - d["nominal"]).max(),
    "S3.forward": lambda d: np.mean(d["c_x"] > CLEAR * d["c_x_error"]),
    "S10.spin": lambda d: rms(d["omega_before"]) * d["half_length"] / d["speed"],
    "S10.kept": lambda d: rms(d["omega_before"]) / rms(d["omega_after"]),
    "S10.touches": _kept,
    "S10.landings": lambda d: _kept(d, "landing_"),
    "S11.touches": lambda d: rms(1 - _turned(d)),
    "S11.landings": lambda d: rms(1 - _turned(d, "landing_")),
    "S11.smallest": lambda d: _turned(d).min(),
    "S11.largest": lambda d: _turned(d).max(),
    "S12.mean": _mean("V_z"),
    "S12.spread": lambda d: np.ptp(d["V_z"][d["nominal"] >= ONE_STATE_DEG]),
    "S12.by_speed": _mean("V_z_by_speed"),
    "S13.small": _mean("flight", below=SMALL_DEG),
    "S13.large": lambda d: rms(d["flight"][d["nominal"] > LARGE_DEG] - 1),
    "S13.change": change_tilt,
    "S13.sharp": _sharp,
    "S14.small": _falling_small,
    "S14.large": _falling_large,
    "S14.less": lambda d: _falling_small(d) - _falling_large(d),
    "S16.distance": _off_theory,
    "S16.peak": lambda d: d["c_x"].max() / d["theory_c_x"].max(),
    "S16.peak_single": lambda d: (
        d["c_x"][d["nominal"] >= ONE_STATE_DEG].max() / d["theory_c_x"].max()
    ),
    "S16.bump": bump,
    "S21.largest": lambda d: d["slide"].max(),
    "S21.mean": _mean("slide", above=12),
    "S22.contact": _mean("contact"),
    "S22.pushed": _mean("pushed"),
    "S22.touches": _mean("touches"),
}
JUDGED = {  # their statements, with what the paper says
    name: {"id": claim["id"], "says": claim["says"], **row}
    for claim in read()
    for row in claim["numbers"]
    if "holds" in row and (name := f"{claim['id']}.{row['key']}") in NUMBERS
}
OF_MANY_TILTS = {"S16.bump"}  # numbers that need tilts close together
