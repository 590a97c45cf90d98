"""What flows through a row behind its transient: energy, and momentum along x.

Energy: the ledger of a run, period by period. The plate's work is lost in four places, at the
plate and between rods, normally and tangentially. The tangential springs hold little; what they
store counts as lost until they give it back.

Momentum: the touches of a run. A rod gains c_x from the plate alone in a free touch, from the plate
and its neighbours in a pushed one, and from its neighbours alone between two touches. Summed over
a long time the three cancel. So do the forces between rods, summed over the rods: the plate takes
from pushed rods what it gives to free ones, and neighbours take from rods on the plate what they
give to rods in flight.
"""

from typing import Any

import numpy as np

from md import Scene
from md.host import Engine, prepare
from md.kernels import touches
from md.measures import Tables, tables_of
from md.statistics import ratio, transient

LOSSES = ("plate_normal", "plate_friction", "rods_normal", "rods_friction")  # as in the ledger
WAYS = ("free", "pushed", "aloft")  # touches of both kinds, and between two touches


def marched(engine: Engine, tables: Tables, periods: int) -> tuple[np.ndarray, np.ndarray]:
    """March on by whole periods; touches that ended, and what each period adds to the ledger.

    Parameters
    ----------
    engine : of a row, with ledger and record
    tables : of that engine, to which is added
    periods : to make
    """
    assert engine.record is not None
    assert engine.ledger is not None
    rows, ledger = [np.zeros((0, touches.WIDTH))], [engine.ledger.copy()]
    for _ in range(periods):
        made = 0
        while made < engine.per:
            made += engine.go(engine.per - made, tables.series)
            rows.append(engine.record.rows[: engine.record.count[0]].copy())
            engine.record.count[0] = 0
            tables.add(rows[-1])
        ledger.append(engine.ledger.copy())
    return np.concatenate(rows), np.diff(ledger, axis=0)


def gains(rows: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Touches, those of a rod in a row; what each adds to c_x of its rod, and the time before.

    Parameters
    ----------
    rows : of the record, in any order

    Returns
    -------
    The rows in their new order, and by `WAYS` a value a touch, in sqrt(g d); `aloft` is of the time
    since the touch before, 0 at the first touch of a rod.
    """
    rows = rows[np.lexsort((rows[:, touches.STEP], rows[:, touches.ROD]))]
    before, after = rows[:, touches.BEFORE], rows[:, touches.AFTER]
    free = rows[:, touches.PUSHED] == 0
    aloft = before - np.roll(after, 1)
    aloft[np.diff(rows[:, touches.ROD], prepend=-1) != 0] = 0.0
    gain = after - before
    return rows, {"free": gain * free, "pushed": gain * ~free, "aloft": aloft}


def _momentum(rows: np.ndarray, scene: Scene, engine: Engine, first: int) -> dict[str, Any]:
    """Forces along x on a rod by `WAYS`, in its weight; what free touches carry, and how."""
    rows, gained = gains(rows)
    late = rows[:, touches.STEP] >= first * engine.per
    rows, gained = rows[late], {way: values[late] for way, values in gained.items()}
    periods = engine.step // engine.per - first
    block = rows[:, touches.STEP].astype(int) // engine.per - first
    free = rows[:, touches.PUSHED] == 0
    fall = (scene.gravity.z if scene.gravity else 0.0) * engine.dt * rows[:, touches.DURATION]
    lift = rows[:, touches.AFTER + 1] - rows[:, touches.BEFORE + 1] - fall

    def summed(values: np.ndarray) -> np.ndarray:
        return np.bincount(block, values, periods)

    time = np.full(periods, scene.rods.count / scene.frequency)
    found = {way: ratio(summed(values), time) for way, values in gained.items()}
    found["together"] = ratio(summed(sum(gained.values(), np.zeros(len(rows)))), time)
    found["carried"] = ratio(summed(lift * free), time)
    return found


def flows(scene: Scene, periods: int) -> dict[str, Any]:
    """Flows of a row behind its transient, (value, standard error) each, for `runs.planned`.

    Parameters
    ----------
    scene : of a row on a vibrating plate
    periods : of the run, transient included

    Returns
    -------
    `LOSSES` : parts of that work; `rods`: both between rods
    change, residual : of the energy, and what the ledger misses; parts of the work, no error
    `WAYS` : mean force along x on a rod, in its weight; `together`: their sum
    carried : part of the weight that free touches carry
    tilt : of the rods, deg
    """
    engine = prepare(scene)
    tables, cut = tables_of(engine, periods), transient(periods)
    early, _ = marched(engine, tables, cut)
    before = engine.energy()
    rows, ledger = marched(engine, tables, periods - cut)
    work, *lost = ledger.T
    found: dict[str, Any] = {}
    for name, loss in zip(LOSSES, lost, strict=True):
        found[name] = ratio(loss, work)
    found["rods"] = ratio(lost[2] + lost[3], work)
    found["change"] = float((engine.energy() - before) / work.sum())
    found["residual"] = float(1 - sum(lost).sum() / work.sum() - found["change"])
    found |= _momentum(np.concatenate([early, rows]), scene, engine, cut)
    tilt_deg = tables.tilt_deg(periods)[cut:]
    found["tilt"] = float(tilt_deg.mean()), tables.error(tilt_deg)
    return found
