"""One rigid rod with round tips at held tilt, bounced over grids, for several figures."""

from typing import Any

import numpy as np

from impact import InputError, spherocylinder


def bounced(
    tilt: np.ndarray, gamma: Any, length: float, shape: Any = spherocylinder, **options: Any
) -> np.ndarray:
    """Results of `impact.bouncing.bounce` at tilts [rad] and accelerations, which broadcast.

    Parameters
    ----------
    tilt, gamma, length : of the rod, of the plate, of the rod
    shape : function of tilt and length
    options : of `bounce`
    """
    if options["friction"] == 0:
        raise InputError("friction must be > 0, else rods keep their first velocity; got 0")
    from impact.bouncing import bounce  # compiles

    run = np.vectorize(
        lambda tilt, gamma: bounce(shape(tilt, length), gamma=gamma, **options), otypes=[object]
    )
    return run(tilt, gamma)


def estimates(runs: np.ndarray, field: str) -> np.ndarray:
    """Mean and standard error of one field of `Bouncing`, arrays of the shape of `runs`."""
    values = [getattr(run, field) for run in runs.flat]
    return np.transpose(values).reshape(2, *runs.shape)
