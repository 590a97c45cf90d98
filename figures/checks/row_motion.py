"""How the rods of a row move among each other, period by period: measures for `runs.planned`.

Four times a period the row is looked at. `common`: share of its vertical motion that all rods have
in common, the square of the mean vertical velocity over the mean square; 1 if the row bounces as
one block. `height_spread`, `tilt_spread`: departures of lower ends' heights and of tilts from the
row's mean, root mean squares in d, tilts times half the length between the caps' centres.
`height_order`, `tilt_order`: correlations of neighbours' departures; -1 if they alternate.
`fallen`: share of the rods that lean against the row or lie with their upper end down.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from md.host import Engine, prepare
from md.kernels import C_Z, COSINE, SINE, X, Z
from md.measures import standard_error, transient
from md.scene import Scene

from ..lib.arrangement import departures

LOOKS = 4  # at the row in a period
WINDOW = 10  # periods that `followed` takes together
SEEN = "common", "height_spread", "height_order", "tilt_spread", "tilt_order", "tilt_deg", "fallen"
ENDS_DEG = 3.0, 75.0  # tilts between which `driven` goes


def seen(states: np.ndarray, half: float) -> tuple[float, ...]:
    """Measures that `SEEN` names, from some looks at a row.

    Parameters
    ----------
    states : (looks, rods, columns)
    half : length between the caps' centres, halved
    """
    rise, tilt = states[..., C_Z], np.arctan2(states[..., SINE], states[..., COSINE])
    common = (rise.mean(axis=-1) ** 2).mean() / max((rise**2).mean(), 1e-300)
    lowest = states[..., Z] - half * np.abs(states[..., COSINE]) - 0.5
    heights, tilts = departures(lowest), departures(half * tilt)
    fallen = ((tilt < 0) | (tilt > np.pi / 2)).mean()
    return common, *heights, *tilts, np.degrees(tilt.mean()), fallen


def stretched(engine: Engine, box: float) -> None:
    """Give a row another length of its box: places scale with it, velocities and springs stay."""
    engine.rods[:, X] *= box / engine.effects.period
    engine.effects = engine.effects._replace(period=box)
    engine.state.listed.travelled[0] = np.inf  # neighbours are looked for again


def watched(
    scene: Scene, periods: int, box: Callable[[int], float] | None = None
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Drift `c_x` [cm/s] and what `SEEN` names of each period of a run; the rods at its end.

    Parameters
    ----------
    scene : a row in a periodic box
    periods : of the plate
    box : length of the box in each period; None: that of the scene
    """
    engine = prepare(scene, ledger=False, touches=False)
    half, drift, rows = engine.effects.half_length, [], []
    for period in range(periods):
        if box is not None:
            stretched(engine, box(period))
        before, states = engine.rods[:, X].mean(), []
        for look in range(1, LOOKS + 1):
            engine.go(period * engine.per + look * engine.per // LOOKS - engine.step)
            states.append(engine.rods.copy())
        rows.append(seen(np.array(states), half))
        drift.append(engine.rods[:, X].mean() - before)
    c_x = np.array(drift) / (engine.dt * engine.per) * scene.cm_per_s
    return dict(zip(SEEN, np.array(rows).T, strict=True)) | {"c_x": c_x}, engine.rods


def averaged(scene: Scene, periods: int) -> dict[str, Any]:
    """Means of `c_x` [cm/s] and of what `SEEN` names over a run behind its transient."""
    found, _ = watched(scene, periods)
    late = {name: values[transient(periods) :] for name, values in found.items()}
    errors = {f"{name}_stderr": standard_error(late[name]) for name in ("c_x", "tilt_deg")}
    return {name: values.mean() for name, values in late.items()} | errors


def followed(
    scene: Scene, periods: int, box: Callable[[int], float] | None = None
) -> dict[str, Any]:
    """Means over windows of a run, standard error of the second half's drift; as `watched`."""
    found, _ = watched(scene, periods, box)
    parts = np.array_split(np.arange(periods), max(periods // WINDOW, 1))
    return {
        **{name: [values[part].mean() for part in parts] for name, values in found.items()},
        "middle": [part.mean() + 0.5 for part in parts],
        "late_c_x_stderr": standard_error(found["c_x"][periods // 2 :]),
    }


def driven(scene: Scene, periods: int) -> dict[str, Any]:
    """`followed` while the box takes the row from its tilt to the farther one of `ENDS_DEG`."""
    first = np.degrees(np.arccos(scene.rods.count / scene.box.length))
    last = max(ENDS_DEG, key=lambda end: abs(end - first))
    tilt = np.radians(np.linspace(first, last, periods))
    return followed(scene, periods, lambda period: scene.rods.count / np.cos(tilt[period]))
