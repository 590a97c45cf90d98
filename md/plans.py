"""What a run to a tolerance will take: its step, its length and its price."""

from math import nan, sqrt
from os import cpu_count
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from . import simulation
from .accuracy import CALIBRATE, CONFIDENCE, CUT, FIRST_LOOK, MOST_WORKERS, checked, slower
from .bias import Choice, calibrated, choose, student
from .domains import whole
from .host import step_of
from .scene import Scene


class Plan(NamedTuple):
    """What a tolerance will take."""

    tolerance: float
    choice: Choice
    bias_error: float  # half of the interval of the bias, relative
    periods: float  # of all starts; nan where the calibration does not hold
    seconds: float  # of the run with these workers on idle cores, without compiling


def plan(
    scene: Scene,
    *,
    tolerance: float,
    confidence: float = CONFIDENCE,
    workers: int = 1,
    calibration: str | Path | None = None,
) -> Plan:
    """Step, length and price of a run to a tolerance, which is not made; a short one is timed.

    Parameters
    ----------
    scene : Scene
    tolerance, confidence, workers, calibration : as of `run`

    Raises
    ------
    ValueError
        As `run`.
    """
    checked(tolerance=tolerance, confidence=confidence)
    workers = whole("workers", workers, 1, MOST_WORKERS)
    chosen = choose(scene, tolerance, confidence, calibration)
    if chosen.bias is None:
        return Plan(tolerance, chosen, nan, nan, nan)
    z = float(ndtri((1 + confidence) / 2))
    left = student(confidence) * chosen.bias.error
    room = sqrt(tolerance**2 - left**2)
    kept = (z * calibrated(scene, calibration)["noise"] / room) ** 2
    each = kept / workers
    least, most, look = (slower(scene.annulus is not None) * n for n in (*CUT, FIRST_LOOK))
    made = workers * max(each + float(np.clip(each / 4, least, most)), look)
    simulation.run(chosen.scene, periods=1, ledger=False)  # compiles
    timed = simulation.run(chosen.scene, periods=20, ledger=False)
    seconds = made / min(workers, cpu_count() or 1) * timed.run_seconds / timed.periods
    return Plan(tolerance, chosen, left, made, seconds)


def plan_in_words(planned: Plan) -> str:
    """Lines that say what a run to a tolerance will take."""
    dt, per = step_of(planned.choice.scene)
    lines = [f"step         dt = {dt:.3g}, {per} a period"]
    if (bias := planned.choice.bias) is None:
        lines.append(f"bias         measured in place: {'; '.join(planned.choice.outside)}")
        lines += [f"             {CALIBRATE}", "price        unknown before it runs"]
        return "\n".join(lines)
    lines[0] += f", {planned.choice.per_contact:.3g} steps a contact"
    lines.append(f"bias         {bias.value:+.2g} +- {planned.bias_error:.1g}, taken off")
    lines.append(
        f"price        {planned.tolerance:.3g} of c_x takes about {planned.periods:.3g} periods, "
        f"{planned.seconds:.2g} s"
    )
    return "\n".join(lines)
