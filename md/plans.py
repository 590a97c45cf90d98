"""What a run to a tolerance will take, and in words what it has reached and taken."""

from math import isfinite, isnan, nan, sqrt
from os import cpu_count
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from . import simulation
from .accuracy import CONFIDENCE, CUT, FIRST_LOOK, MOST_WORKERS, UNLIKELY, checked, slower
from .bias import Choice, calibrated, choose, student
from .domains import whole
from .host import step_of
from .scene import Scene
from .simulation import Result

CALIBRATE = "calibrate SCENE --out FILE, and --calibration FILE: bias measured once, for all runs"
NOTHING = 1e-6  # of the plate's peak velocity: a slower drift is none


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


def in_words(result: Result) -> list[str]:
    """Lines on step and error of a run with a tolerance, and on the price of the next digit."""
    a, unit = result.accuracy, result.scene.cm_per_s
    if a is None:
        return []
    verdict = f"accuracy     {a.state if a.state == 'reached' else a.state.upper()}"
    if not isfinite(a.error):
        return [f"{verdict}: ended too early to tell the error"]
    if abs(result.c_x) + a.error < NOTHING * result.scene.plate_speed:
        return [f"{verdict}: nothing drifts; c_x is below {NOTHING:g} of the plate's velocity"]
    size = max(abs(result.c_x), a.floor)
    of = "c_x" if abs(result.c_x) >= a.floor else f"the floor {a.floor:.3g} sqrt(g d)"
    known = "calibrated" if not a.outside else f"measured in place: {'; '.join(a.outside)}"
    taken = f"{a.bias / size:+.2g} +- {a.bias_error / size:.1g} is taken off ({known})"
    lines = [
        f"{verdict}: {a.tolerance:.3g} of {of} asked for; c_x is within {a.error:.2g} sqrt(g d) = "
        f"{a.error * unit:.2g} cm/s, {a.error / size:.2g} of it, at {a.confidence:.4g} confidence",
        f"step         dt = {result.dt:.3g}, {a.per_contact:.3g} steps a contact; its bias "
        f"{taken}; the statistical error is {a.statistical / size:.2g}",
    ]
    if a.outside:
        lines.append(f"             {CALIBRATE}")
    annulus = result.scene.annulus is not None
    if a.starts > 1:
        lines.append(
            f"starts       {a.starts}, {a.made} periods in all, for c_x; all else is of the first"
        )
        if a.chance < UNLIKELY[annulus]:
            lines.append(
                "             they differ: the scene has several states; their scatter counts; "
                "more --workers tell it better"
            )
    elif annulus:
        lines.append(
            "starts       1: the error is about its arrangement of rods; --workers pools more"
        )
    if fell := result.turned.get("fell"):
        lines.append(
            f"rods         fell over {fell} times: one that does leans the other way, and the "
            "drift dies away slowly; other starts show by how much (--workers)"
        )
    elif a.state == "not settled":
        lines.append("             the drift still trends; the error is the change that is seen")
    if a.state == "not reached" and not isnan(a.needed_seconds):
        never = "the bias alone is known no better"
        takes = f"this would take about {a.needed_seconds:.3g} s of run time"
        lines.append(f"             {takes if isfinite(a.needed_seconds) else never}")
    if a.error / size > a.tolerance / 10 and isfinite(a.next_digit_seconds):
        lines.append(
            f"next digit   {a.tolerance / 10:.3g} would take about {a.next_digit_seconds:.3g} s"
        )
    return lines
