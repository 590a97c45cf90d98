"""Soft impacts of the molecular dynamics beside the theory of rigid ones, for several figures.

The scene is that of the paper's Fig. 12: mu = 0.4, -c_z/c_x = 2, l = 9.5 d, a thin rod's inertia,
plate at rest, no gravity. Theory and simulation have the same arms and the same gyration radius;
velocities are in units of |c_z|.
"""

from functools import partial
from typing import Any, NamedTuple

import numpy as np

import md
from impact import Collision, ContactGeometry, Regime, collide

from .style import ANOTHER, PRINTED_LAW, SIMULATED

ROD = md.Rod(9.5, "thin")
IMPACT_FRICTION, APPROACH_RATIO = 0.4, 2.0
PAPER_STEP = 2e-5  # sqrt(d/g)
TABLE_TILTS = np.radians(np.arange(5, 86, 5))  # of the tables
LAW_WORDS = {
    "coulomb": "friction as a constraint",
    "constant_restitution": "friction as a spring",
    "appendix_a": "Appendix A",
}
CONTACT_COLOURS = {
    "coulomb": SIMULATED,
    "constant_restitution": ANOTHER,
    "appendix_a": PRINTED_LAW,
}


def scene_words(friction: float = IMPACT_FRICTION, length: float = ROD.length) -> str:
    """Friction, velocities and rod of the impacts in words, for a picture."""
    speeds = r"$-c_z/c_x=2$, $|c_z|=1\,(gd)^{1/2}$"
    return rf"$\mu={friction:g}$, {speeds}, $l={length:g}\,d$, thin inertia"


class Soft(NamedTuple):
    """Simulated impacts, one an element; velocities over |c_z|."""

    c_x: np.ndarray
    c_z: np.ndarray
    restitution: np.ndarray  # -v_f/v_0, measured
    regime: np.ndarray  # of `impact.Regime`


def one_impact(tilt: float, law: md.Law, **how: Any) -> md.Impact:
    """The impact at one tilt [rad] with c_z = -1 [sqrt(g d)]; `how` as in `md.impact`."""
    how = {"friction": IMPACT_FRICTION, "rod": ROD, **how}
    return md.impact(tilt, 1 / APPROACH_RATIO, -1.0, law=law, **how)


def simulate(
    tilt: np.ndarray,
    law: md.Law,
    *,
    integrator: str = "verlet",
    refine: int = 32,
    **scene: Any,
) -> Soft:
    """Simulated impacts at each tilt [rad], as `one_impact`.

    The step is the default one, at most a hundredth of the contact time, over `refine`; with
    "dop853" every switch is located instead. `scene`: rod or friction, if they are others.
    """
    hit = partial(one_impact, law=law, integrator=integrator, **scene)
    if integrator == "dop853":
        hits = [hit(phi, tolerance=1e-12) for phi in tilt]
    else:
        hits = [hit(phi, dt=hit(phi).dt / refine) for phi in tilt]
    rows = [(h.c_x, h.c_z, h.restitution) for h in hits]
    regimes = [Regime[h.regime.upper().replace("-", "_")] for h in hits]
    return Soft(*np.array(rows).T, np.array(regimes, np.int8))


def rigid(
    tilt: np.ndarray,
    restitution: np.ndarray | float,
    rod: md.Rod = ROD,
    law: str = "newton",
    friction: float = IMPACT_FRICTION,
) -> Collision:
    """Rigid impacts at tilts [rad], velocities over |c_z|; -v_f/v_0 is `normal_velocity`."""
    half, k = rod.half_length, np.sqrt(rod.gyration_squared)
    return collide(
        1 / APPROACH_RATIO,
        -1.0,
        geometry=ContactGeometry(half * np.sin(tilt), half * np.cos(tilt) + 0.5, k),
        friction=friction,
        restitution=np.clip(restitution, 0.0, 1.0),  # a measured one may end above 1
        law=law,
    )


def distance(a: Soft | Collision, b: Soft | Collision) -> np.ndarray:
    """Root-mean-square length of the difference of (c_x', c_z') over the last axis."""
    return np.sqrt(np.mean((a.c_x - b.c_x) ** 2 + (a.c_z - b.c_z) ** 2, axis=-1))


def compared(soft: Soft, theory: Collision) -> tuple[np.ndarray, np.ndarray]:
    """`distance` of simulated impacts from the theory's, and how many regimes agree."""
    return distance(soft, theory), np.sum(soft.regime == theory.regime, axis=-1)


def from_theory(law: md.Law, **how: Any) -> tuple[np.ndarray, np.ndarray]:
    """Impacts at `TABLE_TILTS`, `compared` with the theory at the restitution of each.

    Parameters
    ----------
    law : of the contact
    how : of `simulate`
    """
    soft = simulate(TABLE_TILTS, law, **how)
    return compared(soft, rigid(TABLE_TILTS, soft.restitution))
