"""Errors of one soft impact: those of its integration, those of its model, and what they cost."""

from contextlib import suppress

import numpy as np

import md
from md.laws import contact_time

from ..lib.impact_times import impact_call, price
from ..lib.soft_impacts import TABLE_TILTS, from_theory, one_impact

METHODS = ("leapfrog", "verlet", "gear")
TILTS_OF_REGIMES = np.radians([10, 25, 40, 65, 83, 87])  # two tilts in each regime
OFFSETS = (np.arange(24) + 0.5) / 24  # of the touch within a step
LADDERS = {  # law, values of the parameter, what it is
    "coulomb": (lambda k: md.coulomb(stiffness=k), 10.0 ** np.arange(5, 15), "k_n"),
    "constant_restitution": (
        lambda ratio: md.constant_restitution(tangential_ratio=ratio),
        np.array([1.0, 3, 10, 30, 100, 300, 1000, 3000, 10000]),
        "ratio",
    ),
    "appendix_a": (md.appendix_a, 10.0 ** np.arange(5, 15), "k_n"),
}
STEP_SHARE = 0.1  # of the model's error, left to the step


def velocities(law: md.Law, **how) -> tuple[np.ndarray, list[md.Impact]]:
    """(c_x', c_z') at `TILTS_OF_REGIMES`; nan where the step is refused or the run fails."""
    hits, found = [], np.full((TILTS_OF_REGIMES.size, 2), np.nan)
    for row, tilt in zip(found, TILTS_OF_REGIMES, strict=True):
        with suppress(ValueError, RuntimeError):
            hits.append(one_impact(tilt, law, **how))
            row[:] = hits[-1].c_x, hits[-1].c_z
    return found, hits


def fixed_steps(law: md.Law, parts: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Largest and median error, shape (2, methods, parts); nan if any impact fails."""
    whole, found = contact_time(law, 1.0), np.empty((2, len(METHODS), parts.size))
    for (i, j), _ in np.ndenumerate(found[0]):
        how = {"integrator": METHODS[i], "dt": whole / parts[j]}
        off = [velocities(law, offset=part, **how)[0] - true for part in OFFSETS]
        length = np.hypot(*np.moveaxis(off, -1, 0))
        found[:, i, j] = length.max(), np.median(length)
    return found


def order(parts: np.ndarray, error: np.ndarray) -> float:
    """Slope in log-log where the error is small; nan from fewer than three points."""
    some = error < 1e-2
    if np.sum(some) < 3:
        return np.nan
    return -np.polyfit(np.log(parts[some]), np.log(error[some]), 1)[0]


def adaptive(
    law: md.Law, tolerances: np.ndarray, true: np.ndarray, runs: int
) -> dict[str, np.ndarray]:
    """DOP853: largest and median error, shape (2, tolerances), evaluations and seconds."""
    rows = []
    for tolerance in tolerances:
        samples = [velocities(law, integrator="dop853", tolerance=tolerance) for _ in range(runs)]
        found, hits = samples[0]
        length = np.hypot(*(found - true).T)
        times = [np.mean([hit.seconds for hit in hits]) for _, hits in samples]
        evaluations = max(hit.steps for hit in hits)
        rows.append((length.max(), np.median(length), evaluations, np.median(times)))
    *error, evaluations, seconds = np.array(rows).T
    times = {"evaluations": evaluations.astype(int), "adaptive_seconds": seconds}
    return {"adaptive_error": np.array(error), **times}


def reached(parts: np.ndarray, error: np.ndarray, target: float) -> float:
    """Steps per contact time at which the error comes down to `target`; nan if it never does."""
    known = np.isfinite(error)
    parts, error = parts[known], error[known]
    below = np.flatnonzero(error <= target)
    if not below.size or below[0] == 0:
        return parts[0] if below.size else np.nan
    near = slice(below[0] - 1, below[0] + 1)
    return float(np.exp(np.interp(-np.log(target), -np.log(error[near]), np.log(parts[near]))))


def _longest_step(law: md.Law) -> tuple[float, int, float]:
    """Error of the model, regimes right, and by how much to shorten the default step for it."""
    limit, regimes = from_theory(law)
    refine = 8.0
    while refine > 1 / 16:
        try:
            if not abs(from_theory(law, refine=refine / 2)[0] / limit - 1) < STEP_SHARE:
                break
        except (ValueError, RuntimeError):  # not stable
            break
        refine /= 2
    return limit, regimes, refine


def models(every: int, runs: int) -> dict[str, np.ndarray]:
    """Along each ladder: error, regimes, step and seconds per impact."""
    found = {}
    for name, (make, values, _) in LADDERS.items():
        values = values[::every]
        laws = [make(value) for value in values]
        error, regimes, refine = map(np.array, zip(*map(_longest_step, laws), strict=True))
        usual = [[one_impact(tilt, law).dt for tilt in TABLE_TILTS[::3]] for law in laws]
        steps = usual / refine[:, None]
        calls = [
            impact_call(tilt, law, "verlet", dt)
            for law, row in zip(laws, steps, strict=True)
            for tilt, dt in zip(TABLE_TILTS[::3], row, strict=True)
        ]
        seconds, _ = price(calls, runs)
        whole = [contact_time(law, 1.0) for law in laws]
        found |= {
            f"{name}_value": values,
            f"{name}_error": error,
            f"{name}_right": regimes,
            f"{name}_dt": steps.min(1),
            f"{name}_parts": whole / steps.min(1),
            f"{name}_seconds": seconds.reshape(values.size, -1).mean(1),
        }
    return found
