"""Claims about the plane row as numbers, each from the table of one law over tilt, with limits.

A table holds arrays over tilt: `nominal`, `tilt` [deg], `c_x`, `c_x_error`, `theory` [cm/s], means
over touches (`V_z` in V_0, `c_x_before`, `c_x_after`, `omega_before`, `restitution`, `slide`,
`shared`, `contact` in periods), and over landings with hops left out (`flight` in periods,
`falling`, `ratio` = -c_z/c_z'); `half_length` and `speed` = V_0.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

SMALL_DEG, LARGE_DEG = 20, 30  # "small tilt" is below the one, "large" above the other


@dataclass(frozen=True)
class Claim:
    """A number, and where it must lie: within `good` the claim holds, within `fair` in part."""

    name: str
    paper: str
    number: Callable[[dict], float]
    good: tuple[float, float]
    fair: tuple[float, float]
    digits: int = 2

    def verdict(self, value: float) -> int:
        """2 holds, 1 in part, 0 does not hold."""
        return sum(low <= value <= high for low, high in (self.good, self.fair))


def _small(d: dict, name: str) -> float:
    return d[name][d["nominal"] < SMALL_DEG].mean()


def _large(d: dict, name: str) -> float:
    return d[name][d["nominal"] > LARGE_DEG].mean()


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def _sinking(d: dict) -> float:
    return rms(d["tilt"] - d["nominal"])


def _forward(d: dict) -> float:
    return np.mean(d["c_x"] > 3 * d["c_x_error"])


def _change_of_c_x(d: dict) -> float:
    return rms(1 - d["c_x_before"] / d["c_x_after"])


def _spin(d: dict) -> float:
    """Spin before a landing, as the speed of the tip over V_0."""
    return rms(d["omega_before"] * d["half_length"]) / float(d["speed"])


def change_tilt(d: dict) -> float:
    """Tilt at which flights fall through the middle between the longest and one period."""
    flight = d["flight"]
    level = (flight[0] + 1) / 2
    below = np.flatnonzero(flight < level)
    if not len(below) or flight[0] <= 1:
        return np.nan
    j = below[0]
    return float(np.interp(level, flight[[j, j - 1]], d["nominal"][[j, j - 1]]))


def _less_falling(d: dict) -> float:
    """Landings while the plate falls: part at small tilt less the part at large tilt."""
    return _small(d, "falling") - _large(d, "falling")


def _distance(d: dict) -> float:
    return rms(d["c_x"] - d["theory"]) / rms(d["theory"])


CLAIMS = (
    Claim(
        "S1 restitution\nof touches",
        "0.65",
        lambda d: d["restitution"].mean(),
        (0.6, 0.75),
        (0.5, 0.8),
    ),
    Claim("S2 $\\phi-$acos$(dN/L)$\nrms (deg)", "0", _sinking, (0, 1.5), (0, 4), 1),
    Claim("S3 tilts with\nforward drift", "all", _forward, (0.99, 1), (0.8, 1)),
    Claim("S10 $1-c_x/c_x'$\nrms", "small", _change_of_c_x, (0, 0.15), (0, 0.3)),
    Claim("S10 $\\omega l/2V_0$\nbefore, rms", "small", _spin, (0, 0.1), (0, 0.2)),
    Claim("S11 $-c_z/c_z'$\nsmallest", "> 0.5", lambda d: d["ratio"].min(), (0.5, 1.5), (0.3, 2)),
    Claim("S12 $V_z/V_0$\nmean", "0.5", lambda d: d["V_z"].mean(), (0.4, 0.6), (0.3, 0.7)),
    Claim("S12 $V_z/V_0$\nmax - min", "small", lambda d: np.ptp(d["V_z"]), (0, 0.15), (0, 0.3)),
    Claim("S13 flight < 20°\n(periods)", "> 1", lambda d: _small(d, "flight"), (1.3, 9), (1.1, 9)),
    Claim(
        "S13 flight > 30°\n(periods)", "1", lambda d: _large(d, "flight"), (0.9, 1.1), (0.75, 1.25)
    ),
    Claim("S13 change at\n(deg)", "30", change_tilt, (25, 35), (18, 42), 0),
    Claim("S14 falling,\n< 20°", "often", lambda d: _small(d, "falling"), (0.12, 1), (0.06, 1)),
    Claim("S14 the same,\nless at > 30°", "> 0", _less_falling, (0.08, 1), (0.03, 1)),
    Claim("S16 $c_x$ - theory\nrms, rel.", "small", _distance, (0, 0.25), (0, 0.5)),
    Claim("S21 slide,\nlargest part", "0", lambda d: d["slide"].max(), (0, 0.02), (0, 0.15)),
    Claim("S22 contact\n(periods)", "short", lambda d: d["contact"].mean(), (0, 0.03), (0, 0.1), 3),
    Claim(
        "S22 touches with\nothers pushing", "0", lambda d: d["shared"].mean(), (0, 0.1), (0, 0.5)
    ),
)
