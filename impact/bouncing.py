"""One rod that bounces on the plate z = A sin(Omega t) at fixed tilt: exact flights, exact impacts.

The paper leaves the mean plate velocity at landing open, V_z = alpha V_0 with a fitted alpha; here
it is computed, and with it landing phases, flight lengths and drift.

>>> from math import radians
>>> import impact
>>> from impact.bouncing import bounce
>>> rod = impact.thin_rod(radians(20))
>>> run = bounce(rod, gamma=3.3, friction=0.3, restitution=0.65, landings=500, rods=20)
>>> bool(run.drift.mean > 10 * run.drift.error)
True

What is assumed:

- The paper's closure for the flights: neighbours take all spin and hold the tilt, so that every
  impact finds omega = 0, and c_x as the impact before has left it.
- Where an impact leaves the centre slower than the plate moves (c_z' < V_z: the contact point
  separates only because the rod spins), the rod is hit again at once, with omega = 0, at the same
  phase, until it leaves or has come to rest on the plate. In the stationary translation of
  Eqs. (25), (28) this begins at X^2 = restitution k^2, for a thin rod at sin^2(phi) =
  restitution/3, whatever the friction.
- Hops shorter than `shortest_flight` are no flights: the rod rests. At rest the tilt is held, the
  plate presses with g - A Omega^2 sin(theta) per unit mass and Coulomb friction slows c_x down,
  which is what infinitely many small impacts do too. It takes off where Gamma sin(theta) = 1.

It needs Numba, and seconds to compile: import it on request. Units of results: velocities V_0 =
A Omega, times periods of the plate, phases rad with theta = 0 where the plate rises fastest.
"""

from collections.abc import Iterator
from functools import cache
from typing import Any, Generic, NamedTuple

import numpy as np

from ._arguments import Number, Numbers, count, number
from ._impacts import LARGE_FRICTION
from ._jit import kernel
from .collision import law_of
from .compiled import KERNELS, Impacts
from .flight import TURN, advance, departure, landing, lift_off, slide_to_lift
from .geometry import ContactGeometry, lengths_of, unit_lengths

__all__ = ["Bouncing", "Estimate", "Landings", "bounce", "record"]

_AT_ONCE = 1000  # impacts on the spot at most; what approach is left then, the plate absorbs
_STILL = 2.0**-44  # of the approach: slower, an impact on the spot has come to rest
_LANDINGS_A_CALL = 1000  # 0.1 s at most: signals are seen between calls
_FLIGHT_BINS = 64  # of 1/16 period; locked flights of whole periods lie in the middle of one


class Landings(NamedTuple):
    """Single landings, arrays of shape (rods, landings); several impacts on the spot are one.

    Velocities in V_0 = A Omega and in the frame of the laboratory, times in periods.

    period : whole periods since the start, exact
    phase : of the plate, theta in [0, 2 pi); its velocity is V_0 cos(theta)
    c_x : along the plate, before the landing
    c_z : across the plate, before the landing
    c_x_after : along the plate, after the landing
    c_z_after : across the plate, after the landing
    flight : time from take-off to this landing
    rest : time on the plate before that take-off
    travel : distance in x since the landing before, in V_0 times a period
    hits : impacts on the spot
    regime : of the first of these impacts, codes of `impact.Regime`
    """

    period: np.ndarray
    phase: np.ndarray
    c_x: np.ndarray
    c_z: np.ndarray
    c_x_after: np.ndarray
    c_z_after: np.ndarray
    flight: np.ndarray
    rest: np.ndarray
    travel: np.ndarray
    hits: np.ndarray
    regime: np.ndarray


class Estimate(NamedTuple, Generic[Number]):
    """Mean over independent rods and its standard error (nan for one rod).

    mean : in the unit of the estimated quantity
    error : standard error, in the same unit
    """

    mean: Number
    error: Number


class Bouncing(NamedTuple):
    """Means over the landings of many independent rods; every field an `Estimate`.

    alpha : mean plate velocity at landing over V_0; every landing counts alike
    alpha_impulse : like alpha, but landings are weighted by their vertical impulse
    falling : part of the landings that find the plate on its way down
    drift : distance over time, in V_0
    c_x : mean after a landing, in V_0
    c_z : mean after a landing, in V_0
    ratio : -c_z/c_z': mean before over mean after a landing
    flight : mean length in periods
    rest : part of the time that is spent at rest
    again : part of the landings that are hit again at once
    regimes : parts of the landings, index `impact.Regime`, shape (4,)
    phases : density of landing phases per rad, equal bins over [0, 2 pi)
    flights : density of flight lengths per period, bins around i/16, i < 64
    """

    alpha: Estimate[float]
    alpha_impulse: Estimate[float]
    falling: Estimate[float]
    drift: Estimate[float]
    c_x: Estimate[float]
    c_z: Estimate[float]
    ratio: Estimate[float]
    flight: Estimate[float]
    rest: Estimate[float]
    again: Estimate[float]
    regimes: Estimate[Numbers]
    phases: Estimate[Numbers]
    flights: Estimate[Numbers]


# dtypes of the fields of `Landings`: counts and codes are whole numbers.
_KINDS = [np.int64, *[float] * 8, np.int64, np.int8]


class _Held(NamedTuple):
    """Rod at held tilt, and the plate under it."""

    gamma: float  # A Omega^2/g
    X: float  # of one unit of length with Z and k
    Z: float
    k: float
    friction: float
    restitution: float
    shortest: float  # flight, rad of the plate's phase


@cache
def _loop(law: str):
    """Compile the motion of one rod under one law; Omega = g = 1."""
    collide = KERNELS[law]

    @kernel
    def once(c_x, v, held):
        """Impact without spin, in the frame of the plate: c_x and c_z after it, and its regime."""
        c_x, v, _, regime, _, _, _, _, _ = collide(
            Impacts(c_x, v, 0.0, 0.0, held.X, held.Z, held.k, held.friction, held.restitution)
        )
        return c_x, v, regime

    @kernel
    def meet(c_x, v_0, held):
        """Repeat impacts at one phase until the rod leaves or rests."""
        c_x, v, regime = once(c_x, v_0, held)
        hits = 1
        while v < _STILL * v_0 and hits < _AT_ONCE:
            c_x, v, _ = once(c_x, v, held)
            hits += 1
        return c_x, max(v, 0.0), hits, regime

    @kernel
    def rod(state, held, out):
        """Fill `out`, shape (landings, fields of `Landings`); return the next call's `state`."""
        phase, speed, c_x, period = state
        gamma, shortest = held.gamma, held.shortest
        lift, free = lift_off(gamma)
        for j in range(out.shape[0]):
            rest = slid = t = v_0 = 0.0
            d = departure(speed, phase, gamma)
            if 2 * speed > -shortest * d.lift:  # else the hop is shorter, or there is none
                t, v_0 = landing(d, phase, gamma)
            if t < shortest:
                rest, c_x, slid = slide_to_lift(c_x, phase, gamma, held.friction)
                period += phase >= np.pi / 2
                phase = lift
                t, v_0 = landing(free, phase, gamma)
            turns, phase = advance(phase, t)
            period += turns
            before = c_x
            c_x, speed, hits, regime = meet(before, v_0, held)
            plate = gamma * np.cos(phase)
            one = (
                period,
                phase,
                before / gamma,
                (v_0 + plate) / gamma,
                c_x / gamma,
                (speed + plate) / gamma,
                t / TURN,
                rest / TURN,
                (slid + before * t) / (gamma * TURN),
                float(hits),
                float(regime),
            )
            for i in range(len(one)):  # an assignment of all at once compiles 2 s longer
                out[j, i] = one[i]
        return phase, speed, c_x, period

    def whole(start, held, transient, out):
        """Follow a rod from its start, in calls short enough for signals."""
        state = *start, 0.0
        forgotten = np.empty((_LANDINGS_A_CALL, out.shape[1]))
        for left in range(transient, 0, -_LANDINGS_A_CALL):
            state = rod(state, held, forgotten[:left])
        for first in range(0, len(out), _LANDINGS_A_CALL):
            state = rod(state, held, out[first : first + _LANDINGS_A_CALL])

    return whole


def _runs(
    geometry, gamma, friction, restitution, law, shortest_flight, counts: tuple[Any, ...]
) -> Iterator[Landings]:
    """Yield the landings of each rod, once all arguments are in their domains."""
    law_of(law)
    lengths = (number(name, length) for name, length in lengths_of(geometry).items())
    gamma = number("gamma", gamma)
    X, Z, k = map(float, unit_lengths(*lengths))
    mu = min(number("friction", friction), LARGE_FRICTION)
    epsilon = number("restitution", restitution)
    shortest = number("shortest_flight", shortest_flight) * TURN
    least = {"landings": 1, "rods": 1, "seed": 0, "transient": 0}
    landings, rods, seed, transient = map(count, least, counts, least.values())
    held = _Held(gamma, X, Z, k, mu, epsilon, shortest)
    for rod in range(rods):
        out = np.empty((landings, len(Landings._fields)))
        _loop(law)(_start(seed, rod, gamma), held, transient, out)
        yield Landings(*(column.astype(kind) for column, kind in zip(out.T, _KINDS, strict=True)))


def _start(seed: int, rod: int, gamma: float) -> tuple[float, float, float]:
    """Draw the initial state of one rod: phase, take-off velocity over the plate's, c_x."""
    stream = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(rod,)))
    phase, speed, c_x = stream.random(3)
    return TURN * phase, 2 * gamma * speed, gamma * (2 * c_x - 1)


def _density(values: np.ndarray, bins: int, high: float) -> np.ndarray:
    """Histogram over [0, high), as a density; values above are not counted in any bin."""
    counts, _ = np.histogram(values, bins, (0, high))
    return counts * (bins / (high * values.size))


def _summary(run: Landings, bins: int) -> dict[str, Any]:
    """Means of one rod; names as in `Bouncing`."""
    plate, impulse = np.cos(run.phase), run.c_z_after - run.c_z
    time, c_z = run.flight.sum() + run.rest.sum(), run.c_z_after.mean()
    return {
        "alpha": plate.mean(),
        "alpha_impulse": (plate * impulse).sum() / impulse.sum(),
        "falling": (plate < 0).mean(),
        "drift": run.travel.sum() / time,
        "c_x": run.c_x_after.mean(),
        "c_z": c_z,
        "ratio": -run.c_z.mean() / c_z,
        "flight": run.flight.mean(),
        "rest": run.rest.sum() / time,
        "again": (run.hits > 1).mean(),
        "regimes": np.bincount(run.regime, minlength=4) / run.regime.size,
        "phases": _density(run.phase, bins, TURN),
        "flights": _density(run.flight + 1 / 32, _FLIGHT_BINS, _FLIGHT_BINS / 16),
    }


def _estimate(values: np.ndarray) -> Estimate:
    """Mean over the first axis and its standard error."""
    rods = len(values)
    error = values.std(0, ddof=1) / np.sqrt(rods) if rods > 1 else np.full_like(values[0], np.nan)
    return Estimate(values.mean(0)[()], error[()])


def record(
    geometry: ContactGeometry,
    *,
    gamma: float,
    friction: float,
    restitution: float,
    landings: int,
    rods: int = 1,
    seed: int = 0,
    law: str = "newton",
    transient: int = 100,
    shortest_flight: float = 1e-6,
) -> Landings:
    """Record every landing of many rods; `bounce` gives their means.

    Parameters
    ----------
    geometry, gamma, friction, restitution, landings, rods : as in `bounce`
    seed, law, transient, shortest_flight : as in `bounce`

    Returns
    -------
    Landings
        Arrays of shape (rods, landings).

    Raises
    ------
    ValueError, TypeError
        As `bounce`.
    """
    counts = landings, rods, seed, transient
    runs = _runs(geometry, gamma, friction, restitution, law, shortest_flight, counts)
    return Landings(*map(np.stack, zip(*runs, strict=True)))


def bounce(
    geometry: ContactGeometry,
    *,
    gamma: float,
    friction: float,
    restitution: float,
    landings: int,
    rods: int = 1,
    seed: int = 0,
    law: str = "newton",
    transient: int = 100,
    shortest_flight: float = 1e-6,
    bins: int = 36,
) -> Bouncing:
    """Landing phases, plate velocity at landing, flight lengths and drift of bouncing rods.

    Parameters
    ----------
    geometry : X, Z, k in any unit of length (it cancels); k > 0
    gamma : A Omega^2/g, > 1 and at most 1e6; up to 1 the plate never falls away from a rod at rest
    friction : Coulomb coefficient, >= 0, inf allowed
    restitution : between 0 and 1, in the sense of `law`
    landings : landings of each rod that count, >= 1
    rods : independent rods, >= 1. Each starts from the plate at a random phase, with 0 to 2 V_0
        upwards relative to the plate and -V_0 to V_0 along it
    seed : >= 0; a rod is given by `seed` and its number, whatever `rods` is
    law : "newton", "poisson" or "stronge", as in `impact.collide`
    transient : landings of each rod before the first that counts, >= 0. Without rest c_x forgets
        its start over some XZ/(2 friction k^2) landings
    shortest_flight : 1e-12 to 0.1 periods. A hop that is shorter counts as rest: it ends a sequence
        of ever smaller hops. `alpha`, in which every small hop counts, depends on it, as does
        `flight`; `alpha_impulse` and `drift` do far less
    bins : of the landing phases, >= 1

    Returns
    -------
    Bouncing
        Means over rods with standard errors; where rods settle on different orbits, the error
        says how well their mix is known.

    Raises
    ------
    ValueError
        If an argument is out of its domain, nan included, or `law` is unknown.
    TypeError
        If an argument is not a single real number.

    Notes
    -----
    Section V closes Eqs. (24)-(30) by c_z' = -c_z and V_z = alpha V_0; here only omega = 0 is kept
    of the closure. At restitution 1 a vertical rod has no stationary state: it gains height without
    end, as in Fermi's accelerator. A rod that is thrown may bounce without end, once a period (a
    vertical one from gamma = pi (1 - restitution)/(1 + restitution) on). Such orbits coexist with
    rest a little above gamma = 1, where some of the rods, thrown at the start, find them.
    """
    bins = count("bins", bins, 1)
    counts = landings, rods, seed, transient
    runs = _runs(geometry, gamma, friction, restitution, law, shortest_flight, counts)
    means = [_summary(run, bins) for run in runs]
    return Bouncing(
        **{name: _estimate(np.array([mean[name] for mean in means])) for name in means[0]}
    )
