"""What a run adds up over its landings and samples, a row a period, and means of it."""

from typing import Any

import numpy as np

from . import landings
from .engine import Engine
from .statistics import ratio

_PHASES = 64  # parts of a period

# What is summed over the landings of each period.
SUMS = (
    *("landings", "plate", "c_x_before", "c_x_after", "c_z_before", "c_z_after", "omega_before"),
    *("approach", "leaving", "flight", "flights", "duration", "slide", "stick", "reversal"),
    *("shared", "pushing", "omega_after", "flight_squared"),
)
MEANS = {  # what follows from them; plate_velocity over the plate's peak velocity, V_z/V_0
    "plate_velocity": ("plate", "landings"),
    "plate_velocity_by_speed": ("pushing", "approach"),  # each landing counts as its v_0
    "c_x_before": ("c_x_before", "landings"),
    "c_x_after": ("c_x_after", "landings"),
    "c_z_before": ("c_z_before", "landings"),
    "c_z_after": ("c_z_after", "landings"),
    "omega_before": ("omega_before", "landings"),
    "omega_after": ("omega_after", "landings"),
    "restitution": ("leaving", "approach"),  # of all landings together
    "flight_periods": ("flight", "flights"),
    "flight_seen_periods": ("flight_squared", "flight"),  # mean of the flights met at a random time
    "contact_periods": ("duration", "landings"),
    "slide": ("slide", "landings"),
    "slip_stick": ("stick", "landings"),
    "slip_reversal": ("reversal", "landings"),
    "not_isolated": ("shared", "landings"),
}


class Tables:
    """Samples of each period and sums over its landings."""

    def __init__(self, engine: Engine, periods: int):
        self.per, self.speed = engine.per, engine.scene.plate_speed or 1.0
        self.series = np.zeros((periods + 1, 5))
        self.sides = engine.rods[:, 2:4].copy()
        self.sums = np.zeros((periods + 1, len(SUMS)))
        self.phases = np.zeros((periods + 1, _PHASES), np.uint16)

    def add(self, rows: np.ndarray) -> None:
        """Landings; a rod's first is not one if it began on the plate."""
        rows = rows[np.isfinite(rows[:, landings.FLIGHT])]
        period = (rows[:, landings.STEP] // self.per).astype(int)
        flight = rows[:, landings.FLIGHT]
        regime = rows[:, landings.REGIME]
        before, after = landings.BEFORE, landings.AFTER
        columns = (
            *(np.ones(len(rows)), rows[:, landings.PLATE] / self.speed),
            *(rows[:, before], rows[:, after], rows[:, before + 1], rows[:, after + 1]),
            rows[:, before + 2],
            *(-rows[:, landings.APPROACH], rows[:, landings.LEAVING]),
            *(flight / self.per, np.ones(len(rows))),
            rows[:, landings.DURATION] / self.per,
            *(regime == 1, regime == 2, regime == 3, rows[:, landings.SHARED] > 0),
            -rows[:, landings.APPROACH] * rows[:, landings.PLATE] / self.speed,
            *(rows[:, after + 2], (flight / self.per) ** 2),
        )
        part = (rows[:, landings.STEP] % self.per * _PHASES // self.per).astype(int)
        np.add.at(self.phases, (period, part), 1)
        np.add.at(self.sums, period, np.array(columns, float).T)

    def means(self, first: int, last: int, rods: int) -> dict[str, Any]:
        """Of the landings of some periods."""
        part = dict(zip(SUMS, self.sums[first:last].T, strict=True))
        found = {name: ratio(part[top], part[base]) for name, (top, base) in MEANS.items()}
        found["per_rod_and_period"] = ratio(part["landings"], np.full(last - first, rods))
        return {name: {"mean": m, "stderr": e} for name, (m, e) in found.items()}

    def cycle(self, first: int, last: int) -> list[int]:
        """Landings over the plate's cycle; a run begins at its lowest place, a quarter before."""
        counts = self.phases[first:last].sum(axis=0, dtype=np.int64)
        return np.roll(counts, -(_PHASES // 4)).tolist()
