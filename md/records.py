"""Every touch of the plate by the rods of a run, and every landing, as `xarray.Dataset`.

A run hands its touches to `observe` as they end; kept in a list they become one table:

>>> import md
>>> rows = []
>>> result = md.run(md.load("my_rods"), periods=20, observe=rows.append)
>>> touches = md.records.touches(rows, result)
>>> list(touches)[:4]
['rod', 'time', 'phase', 'cap']
>>> stuck = touches.c_x_after[touches.regime == "slip-stick"]
>>> stuck.units
'sqrt(g d)'
>>> landings = md.records.landings(rows, result)
>>> landings.sizes["landing"] < touches.sizes["touch"]
True
>>> table = touches.to_dataframe()  # of pandas

=============================  ===================================================================
column                         what it is
=============================  ===================================================================
rod                            number of the rod
time                           when the touch begins, in periods since the start of the run, when
                               the plate is at its lowest point
phase                          of the plate as the touch begins, rad, 0 to 2 pi; its velocity is
                               V_0 cos(phase), as in the paper's (31)
cap                            which end touches: -1 or 1, along the axis (-1: the lower one of a
                               rod that has not fallen over)
flight                         periods since the last touch of this rod ended; nan before its first
a_x, a_z                       contact point seen from the centre of mass, in d: X = -a_x, Z = -a_z
c_x_before, c_z_before         velocity of the centre of mass before, in sqrt(g d)
omega_before                   spin before, in sqrt(g/d)
c_x_after, c_z_after           the same after: of a landing, after its last touch
omega_after
plate_velocity                 V_z as the touch begins, in sqrt(g d)
v_before                       normal velocity of the contact point against the plate, in sqrt(g d)
v_after                        the same as the force ends; -v_after/v_before is the restitution of
                               one touch, and scatters widely where v_before is small: a run's is
                               -sum(v_after)/sum(v_before)
duration                       periods from the first force to the last
regime                         "slide", "slip-stick" or "slip-reversal"
pushed_by_others               part of the touch during which another rod, or a wall, pushes this
                               one, 0 to 1
max_overlap                    deepest overlap, in d
touches                        of a landing alone, in place of the five above: how many it has
=============================  ===================================================================

In an annulus x lies in the vertical plane through the rod's axis as the touch begins, horizontally
and counter-clockwise around the annulus (`md.kernels.touches`); for an upright rod it is the
direction around the annulus itself. Velocities and spin are their parts in that plane.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .kernels import touches as columns
from .kernels.codes import REGIMES
from .measures import HOP, VELOCITIES, merged, phase_at
from .result import Result
from .units import labelled

if TYPE_CHECKING:
    from xarray import Dataset


_BOTH = {  # columns of `kernels.touches` by their names here
    "rod": columns.ROD,
    "time": columns.STEP,
    "phase": columns.STEP,
    "cap": columns.CAP,
    "flight": columns.FLIGHT,
    "a_x": columns.A_X,
    "a_z": columns.A_Z,
    **dict(zip(VELOCITIES, range(columns.BEFORE, columns.PLATE), strict=True)),
    "plate_velocity": columns.PLATE,
    "v_before": columns.APPROACH,
}
_TOUCH = _BOTH | {
    "v_after": columns.LEAVING,
    "duration": columns.DURATION,
    "regime": columns.REGIME,
    "pushed_by_others": columns.PUSHED,
    "max_overlap": columns.DEEPEST,
}
_LANDING = _BOTH | {"touches": columns.WIDTH}
_TYPES: dict[str, Any] = {"rod": np.int64, "cap": np.int8, "touches": np.int64, "regime": "U13"}
_IN_STEPS = "time", "phase", "flight", "duration"


def touches(rows: Sequence[np.ndarray], result: Result) -> "Dataset":
    """Touches of a run, in the order of their ends.

    Parameters
    ----------
    rows : what the run handed to `observe`, one array after the other
    result : of the run

    Returns
    -------
    The columns that `md.records` names along "touch", from the start of the run on, with
    `long_name` and, but for pure numbers, `units` in their `attrs`:
    `touches.sel(touch=touches.time >= result.discarded)` are those behind the transient.
    """
    return _table("touch", _together(rows), _TOUCH, result)


def landings(rows: Sequence[np.ndarray], result: Result) -> "Dataset":
    """Landings of a run: touches less than `measures.HOP` periods apart, merged.

    The last landing of each rod, which may go on, is left out.

    Parameters
    ----------
    rows, result : as of `touches`

    Returns
    -------
    The columns that `md.records` names along "landing", as of `touches`.
    """
    counted = np.insert(_together(rows), columns.WIDTH, 1, axis=1)  # touches of each: one
    over, _ = merged(counted, HOP * result.steps_per_period)
    return _table("landing", over, _LANDING, result)


def _together(rows: Sequence[np.ndarray]) -> np.ndarray:
    """Rows of a list of arrays, or of one array, as (n, WIDTH)."""
    return np.concatenate([np.empty((0, columns.WIDTH)), *map(np.atleast_2d, rows)])


def _table(along: str, rows: np.ndarray, names: dict[str, int], result: Result) -> "Dataset":
    """Columns of rows by their names, times in periods."""
    found = {}
    for name, column in names.items():
        values: Any = rows[:, column]
        if name in _IN_STEPS:
            values = values / result.steps_per_period
        if name == "phase":
            values = phase_at(values)
        elif name == "regime":
            values = [REGIMES[code] for code in values]
        found[name] = along, np.array(values, _TYPES.get(name, np.float64))
    return labelled(found)
