"""Numbers of a row over its tilt under one contact law: claims S2, S3, S10-S14, S16, S21 and S22.

`judge` takes them of the paper's row, `over_laws` of every contact law.
"""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from impact import drift, landing_density, thin_rod
from md.sweep import Sweep

from ..lib.runs import SETTING, drift_and_tilt, means, plate_speed_cm_s
from .uncertainty import Number, crossing, measures, resampled, rms

SMALL_DEG, LARGE_DEG = 20, 30  # a small tilt is below the one, a large one above the other
CLEAR = 3.0  # standard errors from which on a drift counts as one

BOTH_SIDES = [f"{name}_{side}" for name in ("c_x", "c_z", "omega") for side in ("before", "after")]
STORED = {  # name in a table: name in the store; landings: `landing_`, flight, falling, touches
    "tilt": "tilt_deg",
    "c_x": "c_x_cm_s",
    **{name: f"touches.{name}.mean" for name in BOTH_SIDES},
    **{f"landing_{name}": f"landings.{name}.mean" for name in BOTH_SIDES},
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


def table(sweep: Sweep, nominal: np.ndarray) -> dict[str, np.ndarray]:
    """Means over the starts of a sweep over tilt, with their standard errors.

    The errors of drift and tilt are those between the starts or within them, whichever is larger.

    Parameters
    ----------
    sweep : rows over the length of the box, then over starts
    nominal : tilts [deg] that the lengths of the box give
    """
    scene = sweep.points[0].scene
    size = {"half_length": np.array(scene.rods.length / 2), "speed": np.array(scene.plate_speed)}
    return {"nominal": nominal, **size, **means(sweep, STORED), **drift_and_tilt(sweep)}


@cache
def _theory() -> tuple[np.ndarray, np.ndarray]:
    """Tilts [deg], and the drift [cm/s] of a thin rod there, with V_z = V_0/2."""
    tilt = np.linspace(0.5, 89.5, 357)
    return tilt, drift(thin_rod(np.radians(tilt)), **SETTING).c_x * plate_speed_cm_s() / 2


def theory(tilt_deg: np.ndarray) -> np.ndarray:
    """Drift of the theory [cm/s] at these tilts."""
    return np.interp(tilt_deg, *_theory())


def _small(d: Table, name: str) -> float:
    return d[name][d["nominal"] < SMALL_DEG].mean()


def _large(d: Table, name: str) -> float:
    return d[name][d["nominal"] > LARGE_DEG].mean()


def change_tilt(d: Table) -> float:
    """Tilt at which flights pass half way from the longest to one period; inf if they never do."""
    flight = d["flight"]
    if flight[0] <= 1 or not np.isfinite(flight).all():
        return np.inf
    return crossing(d["nominal"], flight, (flight[0] + 1) / 2)


def _sharp(d: Table) -> float:
    """Part of the change of flights that happens between 25 and 35 degrees."""
    before, after = np.interp([25, 35], d["nominal"], d["flight"])
    return (before - after) / (d["flight"].max() - 1)


def bump(nominal: np.ndarray, c_x: np.ndarray) -> tuple[float, int, int]:
    """Largest rise of the drift with tilt between 20 and 45 degrees, and the places of its ends.

    It is negative where the drift only falls.
    """
    inner = np.flatnonzero((nominal > 20) & (nominal <= 45)).tolist()
    return max((c_x[j] - c_x[i], i, j) for n, j in enumerate(inner) for i in inner[:n])


def _turned(kind: str) -> Callable[[Table], np.ndarray]:
    return lambda d: -d[f"{kind}c_z_before"] / d[f"{kind}c_z_after"]


def _kept(kind: str) -> Callable[[Table], float]:
    return lambda d: rms(1 - d[f"{kind}c_x_before"] / d[f"{kind}c_x_after"])


_touches, _landings = _turned(""), _turned("landing_")


@measures("S14")
def phases(data: Any) -> dict[str, Number]:
    """Share of the touches that would have to move to give the paper's density of phases."""
    d = data.figure("fig08")
    H = landing_density(d["phase"])
    return {"distance": resampled(d, lambda d: np.pi * np.abs(d["density"] - H).mean())}


NUMBERS: dict[str, Callable[[Table], Any]] = {  # claim and key, as in claims.toml
    "S2.rms": lambda d: rms(d["tilt"] - d["nominal"]),
    "S2.largest": lambda d: np.abs(d["tilt"] - d["nominal"]).max(),
    "S3.forward": lambda d: np.mean(d["c_x"] > CLEAR * d["c_x_error"]),
    "S10.spin": lambda d: rms(d["omega_before"]) * d["half_length"] / d["speed"],
    "S10.kept": lambda d: rms(d["omega_before"]) / rms(d["omega_after"]),
    "S10.touches": _kept(""),
    "S10.landings": _kept("landing_"),
    "S11.touches": lambda d: rms(1 - _touches(d)),
    "S11.landings": lambda d: rms(1 - _landings(d)),
    "S11.smallest": lambda d: _touches(d).min(),
    "S11.largest": lambda d: _touches(d).max(),
    "S12.mean": lambda d: d["V_z"].mean(),
    "S12.spread": lambda d: np.ptp(d["V_z"]),
    "S12.by_speed": lambda d: d["V_z_by_speed"].mean(),
    "S13.small": lambda d: _small(d, "flight"),
    "S13.large": lambda d: rms(d["flight"][d["nominal"] > LARGE_DEG] - 1),
    "S13.change": change_tilt,
    "S13.sharp": _sharp,
    "S14.small": lambda d: _small(d, "falling"),
    "S14.large": lambda d: _large(d, "falling"),
    "S14.less": lambda d: _small(d, "falling") - _large(d, "falling"),
    "S16.distance": lambda d: rms(d["c_x"] - theory(d["tilt"])) / rms(theory(d["tilt"])),
    "S16.peak": lambda d: d["c_x"].max() / _theory()[1].max(),
    "S16.bump": lambda d: bump(d["nominal"], d["c_x"])[0],
    "S21.largest": lambda d: d["slide"].max(),
    "S21.mean": lambda d: d["slide"][d["nominal"] > 12].mean(),
    "S22.contact": lambda d: d["contact"].mean(),
    "S22.pushed": lambda d: d["pushed"].mean(),
    "S22.touches": lambda d: d["touches"].mean(),
}
